//! Numbers of accessors: positions, normals, tangents, texture coordinates and indices.

use rayon::prelude::*;

use super::{
    container::{Container, Named},
    document::{Accessor, Document},
    error::SceneError,
};

/// Elements of one accessor.
const MOST_ELEMENTS: u64 = 1 << 26;
/// Elements that a thread reads at once.
const LEAST_READ: usize = 1 << 14;

/// The buffers of a scene, and how to read them.
#[derive(Debug)]
pub(super) struct Buffers {
    /// Bytes of each buffer, or why they are missing.
    buffers: Vec<Result<Vec<u8>, String>>,
}

impl Buffers {
    /// Reads all buffers that the document names.
    pub(super) fn read(document: &Document, container: &mut Container) -> Result<Self, SceneError> {
        let mut buffers = Vec::with_capacity(document.buffers.len());
        for (index, buffer) in document.buffers.iter().enumerate() {
            let found = match (&buffer.uri, index) {
                (Some(uri), _) => match container.named(&format!("/buffers/{index}/uri"), uri)? {
                    Named::Bytes(bytes) => Ok(bytes),
                    Named::Missing(why) => Err(why),
                },
                (None, 0) => container.binary.take().ok_or_else(|| "the file has no binary chunk".to_owned()),
                (None, _) => Err(format!("buffer {index} has no uri")),
            };
            buffers.push(match found {
                Ok(bytes) if (bytes.len() as u64) < buffer.byte_length => {
                    Err(format!("buffer {index} has {} bytes in place of {}", bytes.len(), buffer.byte_length))
                }
                found => found,
            });
        }
        Ok(Self { buffers })
    }

    /// The bytes of a buffer view; the inner error says why they cannot be had.
    pub(super) fn view(&self, document: &Document, index: usize) -> Result<Result<&[u8], String>, SceneError> {
        let pointer = format!("/bufferViews/{index}");
        let Some(view) = document.buffer_views.get(index) else {
            return Err(SceneError::fault(pointer, "there is no such buffer view"));
        };
        if let Some(name) = view.extensions.keys().find(|name| name.ends_with("_meshopt_compression")) {
            return Ok(Err(format!("it is compressed by {name}")));
        }
        let end = view.byte_offset.checked_add(view.byte_length);
        let Some(end) =
            end.filter(|end| document.buffers.get(view.buffer).is_some_and(|buffer| *end <= buffer.byte_length))
        else {
            let detail =
                format!("{} bytes from {} go beyond buffer {}", view.byte_length, view.byte_offset, view.buffer);
            return Err(SceneError::fault(pointer, detail));
        };
        match self.buffers.get(view.buffer) {
            Some(Ok(bytes)) => Ok(bytes.get(view.byte_offset as usize..end as usize).ok_or_else(|| "cut short".into())),
            Some(Err(why)) => Ok(Err(why.clone())),
            None => Err(SceneError::fault(pointer, format!("there is no buffer {}", view.buffer))),
        }
    }

    /// The elements of an accessor of `N` numbers each, integers scaled where they are normalised; the inner error
    /// says why they cannot be had.
    pub(super) fn numbers<const N: usize>(
        &self,
        document: &Document,
        index: usize,
    ) -> Result<Result<Vec<[f32; N]>, String>, SceneError> {
        self.elements::<N, _>(document, index, |bytes, component, normalized| {
            std::array::from_fn(|i| component.number(&bytes[i * component.size..], normalized))
        })
    }

    /// The indices of an accessor.
    pub(super) fn indices(&self, document: &Document, index: usize) -> Result<Result<Vec<u32>, String>, SceneError> {
        self.elements::<1, _>(document, index, |bytes, component, _| component.whole(bytes))
    }

    fn elements<const N: usize, T: Send>(
        &self,
        document: &Document,
        index: usize,
        read: impl Fn(&[u8], Component, bool) -> T + Sync,
    ) -> Result<Result<Vec<T>, String>, SceneError> {
        let pointer = format!("/accessors/{index}");
        let wrong = |detail: String| Err(SceneError::fault(pointer.clone(), detail));
        let Some(accessor) = document.accessors.get(index) else { return wrong("there is no such accessor".into()) };
        let Some(component) = Component::of(accessor.component_type) else {
            return wrong(format!("componentType {} is none of 5120 to 5123, 5125, 5126", accessor.component_type));
        };
        if numbers_of(&accessor.shape) != Some(N) {
            return wrong(format!("type \"{}\" where {N} numbers are needed", accessor.shape));
        }
        SceneError::above(format!("{pointer}/count"), accessor.count, MOST_ELEMENTS)?;
        if accessor.sparse.is_some() {
            return Ok(Err(format!("accessor {index} is sparse")));
        }
        let Some(view) = accessor.buffer_view else { return Ok(Err(format!("accessor {index} has no numbers"))) };
        let bytes = match self.view(document, view)? {
            Ok(bytes) => bytes,
            Err(why) => return Ok(Err(why)),
        };
        let size = N * component.size;
        let stride = document.buffer_views[view].byte_stride.unwrap_or(size as u64);
        if stride < size as u64 || stride > 255 {
            return wrong(format!("a stride of {stride} bytes for elements of {size}; up to 252 are allowed"));
        }
        let length = accessor.count.checked_sub(1).map_or(0, |last| last * stride + size as u64);
        if length > 0 && accessor.byte_offset.saturating_add(length) > bytes.len() as u64 {
            return wrong(format!("{} elements go beyond buffer view {view}", accessor.count));
        }
        let at = |i: usize| (accessor.byte_offset + i as u64 * stride) as usize;
        let element = |i: usize| read(&bytes[at(i)..at(i) + size], component, accessor.normalized);
        Ok(Ok((0..accessor.count as usize).into_par_iter().with_min_len(LEAST_READ).map(element).collect()))
    }
}

/// The box of an accessor of positions, where it has one.
pub(super) fn bounds(accessor: &Accessor) -> Option<[[f64; 3]; 2]> {
    let three = |numbers: &Option<Vec<f64>>| numbers.as_deref().and_then(|numbers| <[f64; 3]>::try_from(numbers).ok());
    three(&accessor.min).zip(three(&accessor.max)).map(|(min, max)| [min, max])
}

fn numbers_of(shape: &str) -> Option<usize> {
    [("SCALAR", 1), ("VEC2", 2), ("VEC3", 3), ("VEC4", 4)].iter().find(|(name, _)| *name == shape).map(|(_, n)| *n)
}

/// The type of a number.
#[derive(Debug, Clone, Copy)]
struct Component {
    code: u32,
    size: usize,
}

impl Component {
    fn of(code: u32) -> Option<Self> {
        let size = match code {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            5125 | 5126 => 4,
            _ => return None,
        };
        Some(Self { code, size })
    }

    fn number(self, bytes: &[u8], normalized: bool) -> f32 {
        let (value, most) = match self.code {
            5120 => (f32::from(bytes[0].cast_signed()), 127.0),
            5121 => (f32::from(bytes[0]), 255.0),
            5122 => (f32::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32_767.0),
            5123 => (f32::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65_535.0),
            5125 => (self.whole(bytes) as f32, u32::MAX as f32),
            _ => return f32::from_bits(self.whole(bytes)),
        };
        if normalized { (value / most).max(-1.0) } else { value }
    }

    fn whole(self, bytes: &[u8]) -> u32 {
        match self.size {
            1 => bytes[0].into(),
            2 => u16::from_le_bytes([bytes[0], bytes[1]]).into(),
            _ => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        }
    }
}
