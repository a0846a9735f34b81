//! Tables as files.

mod in_memory;
mod npy;
mod safetensors;

pub use self::{
    npy::{NPY_MAGIC, NpyError, NpyTable, decode_npy},
    safetensors::{TableFile, TableFileError, decode, encode},
};
