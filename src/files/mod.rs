//! Documents and containers: recipes, tables as files, digests.

pub mod digest;
pub mod export;
pub mod job;
pub mod manifest;
pub mod recipe;
pub mod replace;
