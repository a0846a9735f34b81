//! Documents and containers: recipes, table files, compact forms, tabulated BRDFs, digests.

pub mod bounded;
pub mod compact;
pub mod container;
pub mod digest;
pub mod hex;
pub mod job;
pub mod json_size;
pub mod manifest;
pub mod recipe_document;
pub mod replace;
pub mod strict;
pub mod tabulated;
mod tensor;
pub mod text;
