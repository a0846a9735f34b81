//! Previews and plots of the stored tables.
//!
//! Invariant: nothing is rendered on a caller's thread or on the fitting pool, and no adapter is opened before the
//! first picture is rendered.

mod get;
mod picture;
mod probe;
mod queue;
mod ranking;
mod rate;
mod rates;
mod render_thread;
mod request;
#[cfg(test)]
mod tests;
mod threads;
mod waiting;

pub(super) use get::Pictures;
pub use get::{PendingPicture, PictureReply};
pub use picture::{PictureError, PictureFile, Subject};
