//! The clocks of the embedded queue.

use std::{
    fmt,
    time::{Duration, Instant},
};

use jiff::Timestamp;

/// The time of day, and a steady clock that determines when leases expire.
pub(in crate::queue) struct Clock {
    pub(in crate::queue) wall: Box<dyn Fn() -> Timestamp + Send + Sync>,
    pub(in crate::queue) steady: Box<dyn Fn() -> Duration + Send + Sync>,
}

impl Default for Clock {
    fn default() -> Self {
        let start = Instant::now();
        Self { wall: Box::new(Timestamp::now), steady: Box::new(move || start.elapsed()) }
    }
}

impl fmt::Debug for Clock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Clock")
    }
}
