//! Pictures of tables: previews, plots of their numbers and errors, and the trade-off between speed and accuracy.

pub mod parameters;
pub mod picture;
pub mod plan;
pub mod plots;
pub mod preview;
pub mod tradeoff;

#[cfg(test)]
mod tests;
