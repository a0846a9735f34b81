//! Tables as files.

mod in_memory;
mod lut;
mod npy;
mod safetensors;

pub use self::{
    lut::{AnyFile, LutFile, decode_any, encode_lut},
    npy::{NPY_MAGIC, NpyError, NpyTable, decode_npy},
    safetensors::{TableFile, TableFileError, decode, encode},
};
