//! Work on a thread of its own, which the machine may lack for a moment.

use std::{io, panic::resume_unwind, thread};

#[cfg(test)]
use std::sync::atomic::{AtomicU32, Ordering};

/// Starts threads for a piece of work.
#[derive(Debug, Default)]
pub(super) struct Threads {
    /// How many threads more the machine does not have.
    #[cfg(test)]
    pub(super) lacking: AtomicU32,
}

impl Threads {
    /// Runs `work` on a thread called `name` and waits for it. A panic is passed on.
    ///
    /// # Errors
    /// When the system has no thread: it may have one later.
    #[cfg_attr(not(test), allow(clippy::unused_self, reason = "tests let it lack threads"))]
    pub(super) fn run<T: Send>(&self, name: &str, work: impl FnOnce() -> T + Send) -> io::Result<T> {
        #[cfg(test)]
        if self.lacking.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |lacking| lacking.checked_sub(1)).is_ok() {
            return Err(io::Error::from_raw_os_error(rustix::io::Errno::AGAIN.raw_os_error()));
        }
        let done = thread::scope(|scope| {
            let started = thread::Builder::new().name(name.to_owned()).spawn_scoped(scope, work)?;
            Ok::<_, io::Error>(started.join())
        });
        Ok(done?.unwrap_or_else(|panic| resume_unwind(panic)))
    }
}
