//! Help for tests of the users of the store.

pub(crate) mod memory;
pub(crate) mod small_disk;
