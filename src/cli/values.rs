//! Option values that several commands share: threads, numbers with a maximum, and names.

use std::{num::NonZeroUsize, str::FromStr, thread};

use clap::{
    Args,
    builder::{PossibleValuesParser, TypedValueParser},
};
use serde::Deserialize;

use super::{CommandFailure, failed};

/// Threads of a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Args)]
pub struct Threads {
    /// Threads to use, 1 to 512 [default: one per core]
    #[arg(long, env = "LTCFORGE_THREADS", value_name = "N")]
    pub threads: Option<ThreadCount>,
}

impl Threads {
    /// The number of threads.
    pub(crate) fn count(self) -> NonZeroUsize {
        self.threads.map_or_else(cores, ThreadCount::count)
    }

    /// A pool with this number of threads.
    ///
    /// # Errors
    /// When the system cannot start the threads.
    pub(crate) fn pool(self) -> Result<rayon::ThreadPool, CommandFailure> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.count().get()).build();
        pool.map_err(failed)
    }
}

/// A whole number from 1 to `MOST`, on the command line or in the configuration file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(try_from = "u64")]
pub struct UpTo<const MOST: u64>(pub(crate) u64);

/// Threads of a command. More than 512 only slow each other down, and thousands can make a machine unusable.
pub(crate) type ThreadCount = UpTo<512>;

impl<const MOST: u64> TryFrom<u64> for UpTo<MOST> {
    type Error = String;

    fn try_from(number: u64) -> Result<Self, String> {
        let is_allowed = (1..=MOST).contains(&number);
        is_allowed.then_some(Self(number)).ok_or_else(|| format!("use a number from 1 to {MOST}"))
    }
}

impl<const MOST: u64> FromStr for UpTo<MOST> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::try_from(text.parse().unwrap_or(0))
    }
}

impl<const MOST: u64> UpTo<MOST> {
    /// As a count.
    pub(crate) fn count(self) -> NonZeroUsize {
        NonZeroUsize::new(self.0 as usize).unwrap_or(NonZeroUsize::MIN)
    }
}

/// Cores that the process may use.
pub(crate) fn cores() -> NonZeroUsize {
    thread::available_parallelism().unwrap_or(NonZeroUsize::MIN)
}

/// A parser that turns a name into the list item with this name.
pub(crate) fn named<T: Copy + Send + Sync + 'static>(
    all: &'static [T],
    name: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    let named = move |text: String| all.iter().copied().find(|item| name(*item) == text).ok_or("unknown name");
    PossibleValuesParser::new(all.iter().map(move |item| name(*item))).try_map(named)
}
