//! Runs async work for blocking callers.

use std::io;

use tokio::runtime::{Builder, Runtime};

/// A thread that runs async work. Dropping the value ends the thread, even in an async task.
#[derive(Debug)]
pub(super) struct Threads(Option<Runtime>);

impl Threads {
    pub(super) fn start(name: &str) -> io::Result<Self> {
        Builder::new_multi_thread()
            .worker_threads(1)
            .thread_name(name)
            .enable_all()
            .build()
            .map(|runtime| Self(Some(runtime)))
    }

    /// Runs `work` to completion and blocks the calling thread until then.
    pub(super) fn block_on<T>(&self, work: impl Future<Output = T>) -> T {
        // Only `drop` removes the runtime.
        self.0.as_ref().unwrap_or_else(|| unreachable!("the storage was used after it was dropped")).block_on(work)
    }
}

impl Drop for Threads {
    fn drop(&mut self) {
        if let Some(runtime) = self.0.take() {
            runtime.shutdown_background();
        }
    }
}
