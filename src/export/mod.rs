//! Tables as files.

mod safetensors;

pub use self::safetensors::{TableFile, TableFileError, decode, encode};
