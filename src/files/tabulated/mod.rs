//! Tabulated BRDFs as safetensors files. Reading reports all errors at once.
//!
//! | tensor | type | shape |
//! |---|---|---|
//! | `alpha`, optional | f32 or f64 | roughnesses |
//! | `ratio`, optional | f32 or f64 | ratios of roughnesses, for anisotropic surfaces |
//! | `theta_o`, `theta_i`, `phi` | f32 or f64 | angles in radians |
//! | `phi_o`, for anisotropic surfaces | f32 or f64 | angles in radians |
//! | `value` | f32 or f64 | `alpha`, `ratio`, `theta_o`, `phi_o`, `theta_i`, `phi`, without those that are left out |
//!
//! Metadata is ignored. [`TabulatedBrdf`] documents the meaning and the bounds of the numbers.

mod find;

use std::sync::Arc;

use safetensors::{
    Dtype, SafeTensors, serialize,
    tensor::{Metadata, TensorView},
};

use crate::{digest::Digest, strict::Strict, tensor::Tensor, text::other_form};
use ltcforge_fit::{TabulatedAxes, TabulatedBrdf, TabulatedFile};

pub use find::{FindBrdf, Located, kept_name, locate, no_files};

/// Maximum size of a tabulated BRDF's file: twice the size of the largest allowed BRDF in f64.
pub const TABULATED_LIMIT_BYTES: u64 = 64 << 20;

/// Maximum size of the header. Seven tensors need a few hundred bytes.
pub const TABULATED_HEADER_LIMIT_BYTES: u64 = 64 << 10;

/// Maximum length of an unknown tensor's name in a message.
const LONGEST_ECHO: usize = 100;

const VALUE: &str = "value";
/// The axes that a file may leave out.
const OPTIONAL: [&str; 3] = ["alpha", "ratio", "phi_o"];

/// The bytes are not a tabulated BRDF; lists every error.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("not a tabulated BRDF: {}", .0.join("; "))]
pub struct TabulatedError(pub Vec<String>);

/// Reads a tabulated BRDF and its digest. Hostile bytes give an error, never a panic.
///
/// # Errors
/// All errors at once: of the container, of tensors that are missing, unknown, or of another type or shape,
/// and of axes and values, see [`TabulatedBrdf::new`].
pub fn decode(bytes: &[u8]) -> Result<TabulatedFile, TabulatedError> {
    let brdf = read(bytes).map_err(|faults| TabulatedError(other_form(bytes).map_or(faults, |form| vec![form])))?;
    Ok(TabulatedFile::new(*Digest::of(bytes).as_bytes(), Arc::new(brdf)))
}

/// Whether the header at the beginning of a file is that of a tabulated BRDF. Numbers are not checked.
#[must_use]
pub fn is_tabulated(start: &[u8]) -> bool {
    let Some(length) = header_length(start).filter(|length| *length <= TABULATED_HEADER_LIMIT_BYTES) else {
        return false;
    };
    let header = start.get(8..8 + length as usize).and_then(|header| serde_json::from_slice::<Metadata>(header).ok());
    let known = TabulatedAxes::default().named().map(|(name, _)| name);
    header.is_some_and(|header| {
        let names = header.tensors();
        names.contains_key(VALUE) && names.keys().all(|name| name == VALUE || known.contains(&name.as_str()))
    })
}

/// The length of the header, from the first eight bytes of a file.
fn header_length(start: &[u8]) -> Option<u64> {
    Some(u64::from_le_bytes(*start.first_chunk()?))
}

fn read(bytes: &[u8]) -> Result<TabulatedBrdf, Vec<String>> {
    if bytes.len() as u64 > TABULATED_LIMIT_BYTES {
        return Err(vec![format!("{} bytes; allowed: at most {TABULATED_LIMIT_BYTES}", bytes.len())]);
    }
    let length = header_length(bytes).unwrap_or_default();
    if length > TABULATED_HEADER_LIMIT_BYTES {
        return Err(vec![format!("a header of {length} bytes; allowed: at most {TABULATED_HEADER_LIMIT_BYTES}")]);
    }
    let file = SafeTensors::deserialize(bytes).map_err(|error| vec![format!("not a safetensors file: {error}")])?;
    if let Err(error) = serde_json::from_slice::<Strict>(&bytes[8..8 + length as usize]) {
        return Err(vec![format!("the header is invalid: {error}; name each tensor once")]);
    }
    let mut faults = Vec::new();
    let names = TabulatedAxes::default().named().map(|(name, _)| name);
    let mut found = file.names();
    found.sort_unstable();
    for name in found.into_iter().filter(|name| *name != VALUE && !names.contains(name)) {
        let name: String = name.chars().take(LONGEST_ECHO).collect();
        faults.push(format!("tensor «{name}»: unknown; allowed: {}, {VALUE}", names.join(", ")));
    }
    let mut tensor = |name: &str, is_needed: bool| {
        let Ok(tensor) = file.tensor(name) else {
            if is_needed {
                faults.push(format!("tensor «{name}»: missing"));
            }
            return Default::default();
        };
        let Some(numbers) = numbers(&tensor) else {
            faults.push(format!("tensor «{name}»: type {:?}; allowed: F32, F64", tensor.dtype()));
            return Default::default();
        };
        (tensor.shape().to_vec(), numbers)
    };
    let axes = names.map(|name| (name, tensor(name, !OPTIONAL.contains(&name))));
    let (shape, values) = tensor(VALUE, true);
    for (name, (shape, _)) in axes.iter().filter(|(_, (shape, _))| shape.len() > 1) {
        faults.push(format!("tensor «{name}»: shape {shape:?}; allowed: one axis"));
    }
    let is_left_out = |name: &str| OPTIONAL.contains(&name) && file.tensor(name).is_err();
    for (name, _) in
        axes.iter().filter(|(name, (_, nodes))| OPTIONAL.contains(name) && nodes.is_empty() && !is_left_out(name))
    {
        let contents = if *name == OPTIONAL[0] { "roughness" } else { "nodes" };
        faults.push(format!("tensor «{name}»: no {contents}; leave the tensor out for a surface without {name}"));
    }
    let there = axes.iter().filter(|(name, _)| !is_left_out(name));
    let wanted: Vec<usize> = there.map(|(_, (_, nodes))| nodes.len()).collect();
    if !shape.is_empty() && shape != wanted {
        faults.push(format!("tensor «{VALUE}»: shape {shape:?}; the axes have {wanted:?}"));
    }
    let [alpha, ratio, theta_o, phi_o, theta_i, phi] = axes.map(|(_, (_, nodes))| nodes);
    let axes = TabulatedAxes { alpha, ratio, theta_o, phi_o, theta_i, phi };
    // A shape that does not match the axes is reported above in more detail.
    let is_reported = |tensor: &str| faults.iter().any(|fault| fault.starts_with(&format!("tensor «{tensor}»:")));
    match TabulatedBrdf::new(axes, values) {
        Ok(brdf) if faults.is_empty() => Ok(brdf),
        Ok(_) => Err(faults),
        Err(more) => {
            let more = more.into_iter().filter(|fault| !(is_reported(fault.tensor) && fault.is_of_count()));
            let more: Vec<String> = more.map(|fault| fault.to_string()).collect();
            faults.extend(more);
            Err(faults)
        }
    }
}

/// The numbers of a tensor; `None` for another type.
fn numbers(tensor: &TensorView) -> Option<Vec<f64>> {
    match tensor.dtype() {
        Dtype::F32 => Some(tensor.data().as_chunks::<4>().0.iter().map(|x| f32::from_le_bytes(*x).into()).collect()),
        Dtype::F64 => Some(tensor.data().as_chunks::<8>().0.iter().map(|x| f64::from_le_bytes(*x)).collect()),
        _ => None,
    }
}

/// The file of a tabulated BRDF: axes in f64, values in f32.
///
/// # Errors
/// The error of the container. Valid axes and values cause no error.
pub fn encode(brdf: &TabulatedBrdf) -> Result<Vec<u8>, TabulatedError> {
    let axes = brdf.axes();
    let named = axes.named().into_iter().filter(|(_, nodes)| !nodes.is_empty());
    let shape: Vec<usize> = named.clone().map(|(_, nodes)| nodes.len()).collect();
    let mut tensors: Vec<(String, Tensor)> = named
        .map(|(name, nodes)| {
            let bytes = nodes.iter().flat_map(|x| x.to_le_bytes()).collect();
            (name.to_owned(), Tensor { dtype: Dtype::F64, shape: vec![nodes.len()], bytes })
        })
        .collect();
    let bytes = brdf.values().iter().flat_map(|x| (*x as f32).to_le_bytes()).collect();
    tensors.push((VALUE.to_owned(), Tensor { dtype: Dtype::F32, shape, bytes }));
    serialize(tensors, None).map_err(|error| TabulatedError(vec![error.to_string()]))
}

#[cfg(test)]
mod tests;
