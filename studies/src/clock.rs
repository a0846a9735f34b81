//! Processor time.

use std::time::Instant;

/// A start time. It includes the processor time, if the system reports it.
pub struct Clock {
    wall: Instant,
    counted: Counted,
    then: Option<f64>,
}

#[derive(Clone, Copy)]
enum Counted {
    Thread,
    Process,
}

impl Clock {
    /// Counts the time of this thread.
    #[must_use]
    pub fn of_thread() -> Self {
        Self::new(Counted::Thread)
    }

    /// Counts the time of all threads of the process.
    #[must_use]
    pub fn of_process() -> Self {
        Self::new(Counted::Process)
    }

    fn new(counted: Counted) -> Self {
        Self { wall: Instant::now(), counted, then: processor_seconds(counted) }
    }

    /// Processor seconds since the start, or wall-clock seconds if the system does not report them.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        let since = |then: f64| processor_seconds(self.counted).map(|now| now - then);
        self.then.and_then(since).unwrap_or_else(|| self.wall.elapsed().as_secs_f64())
    }
}

#[cfg(unix)]
#[expect(clippy::unnecessary_wraps, reason = "other systems return None")]
fn processor_seconds(counted: Counted) -> Option<f64> {
    use rustix::time::{ClockId, clock_gettime};
    let time = clock_gettime(match counted {
        Counted::Thread => ClockId::ThreadCPUTime,
        Counted::Process => ClockId::ProcessCPUTime,
    });
    Some(time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64)
}

#[cfg(not(unix))]
fn processor_seconds(_: Counted) -> Option<f64> {
    None
}
