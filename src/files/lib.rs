//! Documents and containers: recipes, tables as files and as textures, digests.

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
pub mod tabulated;
mod tensor;
pub mod text;
