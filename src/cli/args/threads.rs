//! Threads of a command.

use std::{num::NonZeroUsize, thread};

use clap::Args;

use super::super::{CommandFailure, Exit};

/// Threads of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Args)]
pub struct Threads {
    /// Threads to use, 1 to 512 [default: one for each core]
    #[arg(long, env = "LTCFORGE_THREADS", value_name = "N", value_parser = threads)]
    pub threads: Option<NonZeroUsize>,
}

impl Threads {
    /// The number of threads.
    pub(crate) fn count(self) -> NonZeroUsize {
        self.threads.unwrap_or_else(cores)
    }

    /// A pool of them.
    ///
    /// # Errors
    /// When the system has no more threads.
    pub(crate) fn pool(self) -> Result<rayon::ThreadPool, CommandFailure> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.count().get()).build();
        pool.map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))
    }
}

/// The most threads of a command: more only slow each other down, and thousands can make a machine unusable.
const MOST_THREADS: usize = 512;

pub(super) fn threads(text: &str) -> Result<NonZeroUsize, String> {
    let count = text.parse().ok().filter(|count: &NonZeroUsize| count.get() <= MOST_THREADS);
    count.ok_or_else(|| format!("it is a number from 1 to {MOST_THREADS}"))
}

/// Cores that the process may use.
pub(crate) fn cores() -> NonZeroUsize {
    thread::available_parallelism().unwrap_or(NonZeroUsize::MIN)
}
