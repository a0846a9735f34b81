//! Documents and containers: recipes, tables as files, digests.

pub mod digest;
pub mod export;
pub mod job;
pub mod recipe;
