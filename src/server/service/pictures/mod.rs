//! Previews and plots of the stored tables.
//!
//! Invariant: nothing is rendered on a caller's thread or on the fitting pool, and no adapter is opened before the
//! first picture is rendered.

mod get;
mod picture;
mod queue;
mod ranking;
mod render_loop;
mod renderer;
#[cfg(test)]
mod tests;

pub use get::PictureReply;
pub(super) use get::Pictures;
pub use picture::{PictureError, PictureFile, Subject};
pub use queue::PendingPicture;
