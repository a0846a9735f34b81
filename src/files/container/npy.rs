//! Tables in `NumPy`'s `.npy` format, the format of KT et al.'s published table.
//!
//! The file has f32, little-endian, C order, shape `[alpha, ratio, theta, phi, 3, 3]`: `M` row-major at the nodes of
//! layout `kt2022` over the whole domain. It has neither nodes nor terms nor errors.
//!
//! We do not use a crate, because the crates on crates.io add a parser for all Python literals and a C compiler to read
//! one line of the header.

use crate::recipe_document;
use ltcforge_fit::{PerAxis, Recipe, Table};

/// The first bytes of every `.npy` file.
pub const NPY_MAGIC: &[u8] = b"\x93NUMPY";

/// A table that was read, and the ranges of its axes.
#[derive(Debug, Clone, PartialEq)]
pub struct NpyTable {
    /// The table, without terms. Every `node_error` is NaN, because the file does not contain it.
    pub table: Table,
    /// Lowest and highest value on each axis.
    pub range: PerAxis<[f64; 2]>,
}

/// The bytes are not a table in this format.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NpyError {
    /// The bytes are not a `.npy` file of version 1, 2 or 3.
    #[error("not a .npy file of version 1, 2 or 3")]
    Magic,
    /// The header ends too early, or is not a dictionary as `NumPy` writes it.
    #[error("the header: {0}")]
    Header(String),
    /// The elements, their order or the shape are not those of a table.
    #[error("«{field}» is {found}; a table has {wanted}")]
    Kind {
        /// The name of the header's field.
        field: &'static str,
        /// The value of the field.
        found: String,
        /// The required value.
        wanted: &'static str,
    },
    /// The number of bytes does not match the shape.
    #[error("{actual} bytes of data; the shape needs {expected}")]
    Length {
        /// The bytes that the shape needs.
        expected: u64,
        /// The bytes after the header.
        actual: usize,
    },
    /// A number is infinite or NaN.
    #[error("element {index} is {value}, not a finite number")]
    NotFinite {
        /// The index of the number in storage order.
        index: usize,
        /// The number as text.
        value: String,
    },
}

/// Reads a table. Hostile bytes give an error, never a panic, and use memory only in proportion to their length.
///
/// Matrices with a negative determinant are allowed: the published table has 48.
///
/// # Errors
/// [`NpyError`] describes the first problem.
pub fn decode_npy(bytes: &[u8]) -> Result<NpyTable, NpyError> {
    let (header, data) = split(bytes)?;
    let Header { descr, fortran_order, shape } = Header::parse(header)?;
    let kind = |field, found: String, wanted| Err(NpyError::Kind { field, found, wanted });
    if descr != "<f4" {
        return kind("descr", format!("«{descr}»"), "«<f4»");
    }
    if fortran_order {
        return kind("fortran_order", "True".to_owned(), "False");
    }
    let nodes = match shape[..] {
        [alpha, ratio, theta, phi, 3, 3] => PerAxis { alpha, ratio, theta, phi },
        _ => return kind("shape", format!("{shape:?}"), "[alpha, ratio, theta, phi, 3, 3]"),
    };
    let expected = shape.iter().try_fold(size_of::<f32>() as u64, |bytes, n| bytes.checked_mul(*n));
    let expected = expected.unwrap_or(u64::MAX);
    if expected != data.len() as u64 {
        return Err(NpyError::Length { expected, actual: data.len() });
    }
    let Some(recipe) = whole_domain(&nodes) else {
        return kind("shape", format!("{shape:?}"), "2 to 16384 nodes on each axis");
    };
    let (words, _) = data.as_chunks::<4>();
    let numbers: Vec<f32> = words.iter().map(|word| f32::from_le_bytes(*word)).collect();
    if let Some(index) = numbers.iter().position(|x| !x.is_finite()) {
        return Err(NpyError::NotFinite { index, value: numbers[index].to_string() });
    }
    let (matrix, _) = numbers.as_chunks::<9>();
    let node_error = vec![f32::NAN; matrix.len()];
    let (layout, axes) = (recipe.layout, recipe.nodes());
    let table = Table {
        brdf: recipe.brdf.clone(),
        lobe: recipe.lobe,
        layout,
        axes,
        matrix: matrix.to_vec(),
        second: None,
        terms: None,
        node_error,
    };
    Ok(NpyTable { table, range: recipe.range })
}

/// A recipe with these numbers of nodes in layout `kt2022` over the whole domain. The file does not state how the table
/// was fitted.
fn whole_domain(nodes: &PerAxis<u64>) -> Option<Recipe> {
    let PerAxis { alpha, ratio, theta, phi } = nodes;
    let resolution = format!(r#"{{"alpha": {alpha}, "ratio": {ratio}, "theta": {theta}, "phi": {phi}}}"#);
    let document = format!(r#"{{"layout": "kt2022", "resolution": {resolution}}}"#);
    recipe_document::parse(document.as_bytes(), u64::MAX).ok()
}

/// The text of the header and the data after it.
fn split(bytes: &[u8]) -> Result<(&str, &[u8]), NpyError> {
    let rest = bytes.strip_prefix(NPY_MAGIC).ok_or(NpyError::Magic)?;
    let short = || NpyError::Header("the file ends too early".to_owned());
    let (length, rest) = match rest {
        [1, _, a, b, rest @ ..] => (usize::from(u16::from_le_bytes([*a, *b])), rest),
        [2 | 3, _, a, b, c, d, rest @ ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, rest),
        [1..=3, ..] => return Err(short()),
        _ => return Err(NpyError::Magic),
    };
    let (header, data) = rest.split_at_checked(length).ok_or_else(short)?;
    let header = std::str::from_utf8(header).map_err(|_| NpyError::Header("it is not UTF-8".to_owned()))?;
    Ok((header, data))
}

/// The fields of a header.
struct Header {
    descr: String,
    fortran_order: bool,
    shape: Vec<u64>,
}

impl Header {
    /// The three fields of `{'descr': '<f4', 'fortran_order': False, 'shape': (8, 8, 8, 8, 3, 3), }` in any order.
    fn parse(text: &str) -> Result<Self, NpyError> {
        let mut reader = Reader { rest: text };
        let (mut descr, mut fortran_order, mut shape) = (None, None, None);
        reader.expect("{")?;
        while !reader.take("}") {
            let name = reader.string()?;
            reader.expect(":")?;
            let is_new = match name {
                "descr" => descr.replace(reader.string()?.to_owned()).is_none(),
                "fortran_order" => fortran_order.replace(reader.boolean()?).is_none(),
                "shape" => shape.replace(reader.tuple()?).is_none(),
                other => return Err(NpyError::Header(format!("«{other}» is an unknown field"))),
            };
            if !is_new {
                return Err(NpyError::Header(format!("«{name}» is repeated")));
            }
            if !reader.take(",") {
                reader.expect("}")?;
                break;
            }
        }
        if !reader.rest.trim().is_empty() {
            return Err(reader.refusal("its end"));
        }
        let missing = |name: &str| NpyError::Header(format!("«{name}» is missing"));
        Ok(Self {
            descr: descr.ok_or_else(|| missing("descr"))?,
            fortran_order: fortran_order.ok_or_else(|| missing("fortran_order"))?,
            shape: shape.ok_or_else(|| missing("shape"))?,
        })
    }
}

/// A reader of the Python literals in a header.
struct Reader<'a> {
    rest: &'a str,
}

impl<'a> Reader<'a> {
    /// Takes `token` if it is next.
    fn take(&mut self, token: &str) -> bool {
        let Some(rest) = self.rest.trim_start().strip_prefix(token) else { return false };
        self.rest = rest;
        true
    }

    fn expect(&mut self, token: &str) -> Result<(), NpyError> {
        if self.take(token) { Ok(()) } else { Err(self.refusal(&format!("«{token}»"))) }
    }

    fn refusal(&self, wanted: &str) -> NpyError {
        let found: String = self.rest.trim_start().chars().take(20).collect();
        NpyError::Header(format!("expected {wanted}, found «{found}»"))
    }

    /// Reads a string in single or double quotes. Escapes are not interpreted.
    fn string(&mut self) -> Result<&'a str, NpyError> {
        for quote in ["'", "\""] {
            if self.take(quote) {
                let (string, rest) = self.rest.split_once(quote).ok_or_else(|| self.refusal("a closing quote"))?;
                self.rest = rest;
                return Ok(string);
            }
        }
        Err(self.refusal("a string"))
    }

    fn boolean(&mut self) -> Result<bool, NpyError> {
        if self.take("True") {
            return Ok(true);
        }
        if self.take("False") { Ok(false) } else { Err(self.refusal("True or False")) }
    }

    fn tuple(&mut self) -> Result<Vec<u64>, NpyError> {
        let mut numbers = Vec::new();
        self.expect("(")?;
        while !self.take(")") {
            let text = self.rest.trim_start();
            let length = text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len());
            numbers.push(text[..length].parse().map_err(|_| self.refusal("a count"))?);
            self.rest = &text[length..];
            if !self.take(",") {
                self.expect(")")?;
                break;
            }
        }
        Ok(numbers)
    }
}

#[cfg(test)]
mod tests;
