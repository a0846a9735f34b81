//! Numbers of accessors: positions, normals, tangents, texture coordinates and indices.

use std::collections::BTreeMap;

use meshoptimizer_rs::{
    Error as MeshoptError, Workspace,
    codec::{self, Filter, Mode},
};
use rayon::prelude::*;

use super::{
    container::Container,
    document::{Accessor, Buffer, Document, Meshopt, Sparse, SparsePart},
    error::SceneError,
    extensions::extension,
};

/// The end of the names of the extensions that compress by meshopt.
const MESHOPT: &str = "_meshopt_compression";
/// Maximum bytes of all decoded buffer views.
const MOST_DECODED: usize = 1 << 26;

/// Maximum number of elements of one accessor.
const MOST_ELEMENTS: u64 = 1 << 26;
/// Minimum number of elements that a thread reads at once.
const LEAST_READ: usize = 1 << 14;
/// Maximum number of elements of a sparse accessor without a buffer view. No bytes of a file bound them.
const MOST_ZEROS: u64 = 1 << 22;

/// The buffers of a scene and their document. Domain: indices of accessors that `check` has checked.
#[derive(Debug)]
pub(super) struct Buffers<'a> {
    document: &'a Document,
    /// The bytes of each buffer, at least as many as the document states, or why they are missing.
    read: Vec<Result<Vec<u8>, String>>,
    /// The buffer views that meshopt compresses.
    decoded: BTreeMap<usize, Vec<u8>>,
}

impl<'a> Buffers<'a> {
    /// Reads all buffers that the document names.
    pub(super) fn read(document: &'a Document, container: &mut Container) -> Result<Self, SceneError> {
        let mut bytes_of = |(index, buffer): (usize, &Buffer)| {
            let bytes = match &buffer.uri {
                Some(uri) => container.named(&format!("/buffers/{index}/uri"), uri)?,
                None => container.binary.take_if(|_| index == 0).unwrap_or_default(),
            };
            if (bytes.len() as u64) < buffer.byte_length {
                let why = format!("buffer {index} has {} of {} bytes", bytes.len(), buffer.byte_length);
                return Err(SceneError::Missing(why));
            }
            Ok(bytes)
        };
        let buffers = document.buffers.iter().enumerate().map(|buffer| SceneError::split(bytes_of(buffer)));
        let mut read = Self { document, read: buffers.collect::<Result<_, _>>()?, decoded: BTreeMap::new() };
        let mut left = MOST_DECODED;
        for (index, view) in document.buffer_views.iter().enumerate() {
            if let Some(name) = view.extensions.keys().find(|name| name.ends_with(MESHOPT)) {
                let place = format!("/bufferViews/{index}");
                let compressed: Meshopt = extension(&place, &view.extensions, name)?;
                if let Ok(bytes) =
                    SceneError::split(read.decoded(&format!("{place}/extensions/{name}"), &compressed, &mut left))?
                {
                    read.decoded.insert(index, bytes);
                }
            }
        }
        Ok(read)
    }

    /// Decodes a buffer view within the bytes that are `left`.
    fn decoded(&self, place: &str, view: &Meshopt, left: &mut usize) -> Result<Vec<u8>, SceneError> {
        let fault = |error: MeshoptError| match error {
            MeshoptError::UnsupportedVersion => SceneError::Missing(error.to_string()),
            _ => SceneError::fault(place, error.to_string()),
        };
        let source = self.bytes(place, view.buffer, [view.byte_offset, view.byte_length])?;
        let filter = view.filter.as_deref().map_or(Ok(Filter::None), Filter::parse).map_err(fault)?;
        let mode = Mode::parse(&view.mode).map_err(fault)?;
        let layout = codec::BufferView::new(mode, filter, view.count, view.byte_stride).map_err(fault)?;
        let rest = left.checked_sub(layout.byte_length());
        *left = rest.ok_or_else(|| SceneError::Missing(format!("it decodes to more than {MOST_DECODED} bytes")))?;
        layout.decode(source, &mut Workspace::default()).map_err(fault)
    }

    /// A part of a buffer: its first byte and its length.
    fn bytes(&self, place: &str, index: usize, [start, length]: [u64; 2]) -> Result<&[u8], SceneError> {
        let end = start.saturating_add(length);
        if self.document.buffers.get(index).is_none_or(|buffer| end > buffer.byte_length) {
            return Err(SceneError::fault(place, format!("bytes {start} to {end} are outside of buffer {index}")));
        }
        let bytes = self.read[index].as_ref().map_err(|why| SceneError::Missing(why.clone()))?;
        Ok(&bytes[start as usize..end as usize])
    }

    /// The bytes of a buffer view.
    pub(super) fn view(&self, index: usize) -> Result<&[u8], SceneError> {
        let place = format!("/bufferViews/{index}");
        let view = self.document.buffer_views.get(index);
        let view = view.ok_or_else(|| SceneError::fault(&place, "there is no such buffer view"))?;
        match (self.decoded.get(&index), view.extensions.keys().find(|name| name.ends_with(MESHOPT))) {
            (Some(bytes), _) => Ok(bytes),
            (None, Some(name)) => Err(SceneError::Missing(format!("its bytes by {name} are missing or too many"))),
            (None, None) => self.bytes(&place, view.buffer, [view.byte_offset, view.byte_length]),
        }
    }

    /// The elements of an accessor of `N` numbers each. Normalized integers are scaled.
    pub(super) fn numbers<const N: usize>(&self, index: usize) -> Result<Vec<[f32; N]>, SceneError> {
        let accessor = &self.document.accessors[index];
        self.elements::<N, _>(index, [0.0; N], |bytes| {
            let size = bytes.len() / N;
            std::array::from_fn(|i| number(accessor, &bytes[i * size..][..size]))
        })
    }

    /// The indices of an accessor.
    pub(super) fn indices(&self, index: usize) -> Result<Vec<u32>, SceneError> {
        self.elements::<1, _>(index, 0, whole)
    }

    /// The elements of an accessor, with those that a sparse accessor replaces.
    fn elements<const N: usize, T: Copy + Send + Sync>(
        &self,
        index: usize,
        zero: T,
        read: impl Fn(&[u8]) -> T + Sync,
    ) -> Result<Vec<T>, SceneError> {
        let fault = |detail: String| Err(SceneError::fault(format!("/accessors/{index}"), detail));
        let accessor = &self.document.accessors[index];
        let Some(Sparse { count, indices, values }) = accessor.sparse.as_deref() else {
            return self.stored::<N, _>(index, accessor, &read);
        };
        let mut elements = if accessor.buffer_view.is_some() {
            self.stored::<N, _>(index, accessor, &read)?
        } else {
            SceneError::above(format!("/accessors/{index}/count"), accessor.count, MOST_ZEROS)?;
            vec![zero; accessor.count as usize]
        };
        let of = |part: &SparsePart, component_type: u32, shape: &str| Accessor {
            buffer_view: Some(part.buffer_view),
            byte_offset: part.byte_offset,
            component_type,
            count: *count,
            shape: shape.to_owned(),
            ..Accessor::default()
        };
        let replaced = of(indices, indices.component_type.unwrap_or(5125), "SCALAR");
        let replaced = self.stored::<1, _>(index, &replaced, &whole)?;
        let values = self.stored::<N, _>(index, &of(values, accessor.component_type, &accessor.shape), &read)?;
        for (at, value) in replaced.into_iter().zip(values) {
            let Some(element) = elements.get_mut(at as usize) else {
                return fault(format!("sparse index {at} of {} elements", accessor.count));
            };
            *element = value;
        }
        Ok(elements)
    }

    /// The elements in the buffer view of an accessor.
    fn stored<const N: usize, T: Send>(
        &self,
        index: usize,
        accessor: &Accessor,
        read: &(impl Fn(&[u8]) -> T + Sync),
    ) -> Result<Vec<T>, SceneError> {
        let fault = |detail: String| Err(SceneError::fault(format!("/accessors/{index}"), detail));
        let size = match accessor.component_type {
            5120 | 5121 => N,
            5122 | 5123 => 2 * N,
            5125 | 5126 => 4 * N,
            other => return fault(format!("componentType {other} is not one of 5120 to 5123, 5125, 5126")),
        };
        let shape = if N == 16 { "MAT4" } else { ["SCALAR", "VEC2", "VEC3", "VEC4"][N - 1] };
        if shape != accessor.shape {
            return fault(format!("type \"{}\" where {N} numbers are needed", accessor.shape));
        }
        SceneError::above(format!("/accessors/{index}/count"), accessor.count, MOST_ELEMENTS)?;
        let view =
            accessor.buffer_view.ok_or_else(|| SceneError::Missing(format!("accessor {index} has no numbers")))?;
        let bytes = self.view(view)?;
        let stride = self.document.buffer_views[view].byte_stride.unwrap_or(size as u64);
        if stride < size as u64 || stride > 255 {
            return fault(format!("byteStride {stride} is not between {size}, the size of an element, and 252"));
        }
        let length = accessor.count.checked_sub(1).map_or(0, |last| last * stride + size as u64);
        if length > 0 && accessor.byte_offset.saturating_add(length) > bytes.len() as u64 {
            return fault(format!("{} elements are more than buffer view {view} has", accessor.count));
        }
        let element = |i: usize| read(&bytes[(accessor.byte_offset + i as u64 * stride) as usize..][..size]);
        Ok((0..accessor.count as usize).into_par_iter().with_min_len(LEAST_READ).map(element).collect())
    }
}

fn number(accessor: &Accessor, bytes: &[u8]) -> f32 {
    let whole = whole(bytes);
    let (value, most) = match accessor.component_type {
        5120 => ((whole as u8).cast_signed().into(), 127.0),
        5121 => (whole as f32, 255.0),
        5122 => ((whole as u16).cast_signed().into(), 32_767.0),
        5123 => (whole as f32, 65_535.0),
        5125 => (whole as f32, u32::MAX as f32),
        _ => return f32::from_bits(whole),
    };
    if accessor.normalized { f32::max(value / most, -1.0) } else { value }
}

/// An unsigned integer of one, two or four bytes.
fn whole(bytes: &[u8]) -> u32 {
    match *bytes {
        [a] => a.into(),
        [a, b] => u16::from_le_bytes([a, b]).into(),
        [a, b, c, d] => u32::from_le_bytes([a, b, c, d]),
        _ => 0,
    }
}
