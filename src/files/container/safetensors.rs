//! The canonical file: safetensors with the recipe as its only metadata.
//!
//! | tensor | type | shape |
//! |---|---|---|
//! | `matrix` | f32, or f16 if it is the recipe's precision | alpha, ratio, theta, phi, 3, 3 |
//! | `matrix_2` (if the recipe has two lobes per entry) | like `matrix` | like `matrix` |
//! | `amplitude`, `fresnel` (if the recipe has terms), `edge` (with F82), `node_error` | like `matrix` | alpha, ratio, theta, phi |
//! | `axis_alpha`, `axis_ratio`, `axis_theta`, `axis_phi` | f64 | nodes |
//!
//! Layout `materials` has one ratio for each alpha: `axis_ratio` is as long as `axis_alpha`, and the shape has length 1
//! on the ratio axis.
//!
//! Equal recipes and tables give equal bytes, and no other bytes decode to them.

use safetensors::{Dtype, SafeTensors, serialize, tensor::Metadata};

use crate::{recipe_document, tabulated::FindBrdf, tensor::Tensor, text::other_form};
use ltcforge_fit::{
    BrdfModel, Precision, Recipe, StoredTerms, Table, Terms,
    math::{from_half_bits, from_row_major, half_bits},
};

/// The metadata key of the recipe.
pub(super) const RECIPE_KEY: &str = "ltcforge";

/// A decoded canonical file.
#[derive(Debug, Clone, PartialEq)]
pub struct TableFile {
    /// The recipe that was fitted.
    pub recipe: Recipe,
    /// The fitted table.
    pub table: Table,
}

impl TableFile {
    /// The recipe that was fitted.
    #[must_use]
    pub fn recipe(&self) -> &Recipe {
        &self.recipe
    }

    /// The fitted table.
    #[must_use]
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// Finds the file of a tabulated BRDF, which is needed to measure the table. Does nothing for other tables.
    ///
    /// # Errors
    /// [`TableFileError::Brdf`] if the file is not found.
    pub fn find_brdf(&mut self, find: &FindBrdf<'_>) -> Result<(), TableFileError> {
        let missing = self.table.brdf.file().filter(|_| !self.table.brdf.is_complete());
        let Some(name) = missing.map(ToString::to_string) else { return Ok(()) };
        let file = find(&name).map_err(|faults| TableFileError::Brdf(faults.join("; ")))?;
        if file.to_string() != name {
            return Err(TableFileError::Brdf(format!("{file} is not {name}")));
        }
        // A tabulated model has no Fresnel factor.
        self.table.brdf = BrdfModel::tabulated(file);
        self.recipe.brdf = self.table.brdf.clone();
        Ok(())
    }
}

/// The bytes are not a canonical table file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TableFileError {
    /// The bytes are not a safetensors file.
    #[error("not a safetensors file: {0}")]
    Container(String),
    /// The metadata has no recipe, or the recipe is incomplete or invalid.
    #[error("no valid recipe under the metadata key «{RECIPE_KEY}»: {0}")]
    Recipe(String),
    /// The file of a tabulated BRDF was not found.
    #[error("the file of the table's tabulated BRDF was not found: {0}")]
    Brdf(String),
    /// A tensor is missing, or its type or shape does not match the recipe.
    #[error("tensor «{name}»: {detail}")]
    Tensor {
        /// The name of the tensor.
        name: String,
        /// The problem.
        detail: String,
    },
    /// The parts are correct, but [`encode`] would write other bytes: other tensors, order or spacing.
    #[error("not in canonical form: tensors, metadata, order or spacing differ from those of the recipe's table")]
    NotCanonical,
}

/// A tensor of numbers in a precision that stores them exactly.
pub(super) fn tensor<'a>(precision: Precision, shape: &[usize], values: impl IntoIterator<Item = &'a f32>) -> Tensor {
    let values = values.into_iter();
    let (dtype, bytes) = match precision {
        Precision::F32 => (Dtype::F32, values.flat_map(|x| x.to_le_bytes()).collect()),
        Precision::F16 => (Dtype::F16, values.flat_map(|x| half_bits(*x).to_le_bytes()).collect()),
    };
    Tensor { dtype, shape: shape.to_vec(), bytes }
}

/// The canonical file of a table.
///
/// # Errors
/// The lengths of the table's vectors do not match its axes.
pub fn encode(recipe: &Recipe, table: &Table) -> Result<Vec<u8>, TableFileError> {
    let shape = table.lengths().named().map(|(_, n)| *n);
    let matrix_shape: Vec<usize> = shape.into_iter().chain([3, 3]).collect();
    let precision = recipe.precision;
    let mut tensors = vec![
        ("matrix".to_owned(), tensor(precision, &matrix_shape, table.matrix.iter().flatten())),
        ("node_error".to_owned(), tensor(precision, &shape, &table.node_error)),
    ];
    if let Some(second) = &table.second {
        tensors.push(("matrix_2".to_owned(), tensor(precision, &matrix_shape, second.iter().flatten())));
    }
    if let Some(terms) = &table.terms {
        tensors.push(("amplitude".to_owned(), tensor(precision, &shape, &terms.amplitude)));
        tensors.push(("fresnel".to_owned(), tensor(precision, &shape, &terms.fresnel)));
        if let Some(edge) = &terms.edge {
            tensors.push(("edge".to_owned(), tensor(precision, &shape, edge)));
        }
    }
    for (name, nodes) in table.axes.named() {
        let bytes = nodes.iter().flat_map(|x| x.to_le_bytes()).collect();
        tensors.push((format!("axis_{name}"), Tensor { dtype: Dtype::F64, shape: vec![nodes.len()], bytes }));
    }
    for (name, tensor) in &tensors {
        if tensor.shape.iter().product::<usize>() * tensor.dtype.bitsize() != tensor.bytes.len() * 8 {
            let detail = format!("{} bytes do not match the shape {:?}", tensor.bytes.len(), tensor.shape);
            return Err(TableFileError::Tensor { name: name.clone(), detail });
        }
    }
    let metadata = [(RECIPE_KEY.to_owned(), recipe_document::canonical_json(recipe))];
    serialize(tensors, Some(metadata.into_iter().collect()))
        .map_err(|error| TableFileError::Container(error.to_string()))
}

fn recipe_of(header: &Metadata) -> Result<Recipe, TableFileError> {
    let text = header.metadata().as_ref().and_then(|metadata| metadata.get(RECIPE_KEY));
    let text = text.ok_or_else(|| TableFileError::Recipe("the key is missing".to_owned()))?;
    recipe_document::parse_stored(text.as_bytes()).map_err(|error| TableFileError::Recipe(error.to_string()))
}

/// Reads a canonical file. Hostile bytes give an error, never a panic.
///
/// # Errors
/// The error names the problem: container, recipe, a tensor's type, shape or numbers, or the form.
pub fn decode(bytes: &[u8]) -> Result<TableFile, TableFileError> {
    let container = |error: safetensors::SafeTensorError| {
        TableFileError::Container(other_form(bytes).unwrap_or_else(|| error.to_string()))
    };
    let (_, header) = SafeTensors::read_metadata(bytes).map_err(container)?;
    let file = SafeTensors::deserialize(bytes).map_err(container)?;
    let recipe = recipe_of(&header)?;
    let axes = recipe.nodes();
    let shape = recipe.layout.lengths(&axes).named().map(|(_, n)| *n);
    let matrix_shape: Vec<usize> = shape.into_iter().chain([3, 3]).collect();
    for (name, nodes) in axes.named() {
        if numbers::<8>(&file, &format!("axis_{name}"), Dtype::F64, &[nodes.len()])?
            .map(f64::from_le_bytes)
            .ne(nodes.iter().copied())
        {
            let detail = "the nodes differ from those of the recipe".to_owned();
            return Err(TableFileError::Tensor { name: format!("axis_{name}"), detail });
        }
    }
    let finite = |name: &str, shape: &[usize]| finite(&file, name, recipe.precision, shape);
    let matrices = |name: &str| {
        let numbers = finite(name, &matrix_shape)?;
        let (matrices, _) = numbers.as_chunks::<9>();
        if let Some(index) = matrices.iter().position(|m| from_row_major(&m.map(f64::from)).determinant() <= 0.0) {
            let detail = format!("the matrix of entry {index} has no positive determinant");
            return Err(TableFileError::Tensor { name: name.to_owned(), detail });
        }
        Ok(matrices.to_vec())
    };
    let matrix = matrices("matrix")?;
    let second = recipe.model().fresnel().second().map(|_| matrices("matrix_2")).transpose()?;
    let not_negative = |name: &str| {
        let values = finite(name, &shape)?;
        match values.iter().position(|x| *x < 0.0) {
            None => Ok(values),
            Some(index) => {
                let detail = format!("element {index} is {}, which is negative", values[index]);
                Err(TableFileError::Tensor { name: name.to_owned(), detail })
            }
        }
    };
    let terms = if recipe.terms.any() {
        // The number that layout `reflected` stores for the Fresnel term may be negative.
        let (amplitude, fresnel) = (not_negative("amplitude")?, finite("fresnel", &shape)?);
        let edge = (recipe.terms == StoredTerms::F82).then(|| not_negative("edge")).transpose()?;
        Some(Terms { amplitude, fresnel, edge })
    } else {
        None
    };
    let node_error = not_negative("node_error")?;
    let table = Table {
        brdf: recipe.brdf.clone(),
        lobe: recipe.lobe,
        layout: recipe.layout,
        axes,
        matrix,
        second,
        terms,
        node_error,
    };
    if encode(&recipe, &table)? != bytes {
        return Err(TableFileError::NotCanonical);
    }
    Ok(TableFile { recipe, table })
}

/// The elements of a tensor with this type and shape, as little-endian bytes.
pub(super) fn numbers<'a, const BYTES: usize>(
    file: &SafeTensors<'a>,
    name: &str,
    dtype: Dtype,
    shape: &[usize],
) -> Result<impl Iterator<Item = [u8; BYTES]> + use<'a, BYTES>, TableFileError> {
    let fault = |detail| TableFileError::Tensor { name: name.to_owned(), detail };
    let tensor = file.tensor(name).map_err(|_| fault("missing".to_owned()))?;
    if tensor.dtype() != dtype || tensor.shape() != shape {
        let detail = format!("{:?} {:?}, not {dtype:?} {shape:?}", tensor.dtype(), tensor.shape());
        return Err(fault(detail));
    }
    let (elements, _) = tensor.data().as_chunks::<BYTES>();
    Ok(elements.iter().copied())
}

/// The elements of a tensor with this precision and shape; all must be finite.
pub(super) fn finite(
    file: &SafeTensors,
    name: &str,
    precision: Precision,
    shape: &[usize],
) -> Result<Vec<f32>, TableFileError> {
    let values: Vec<f32> = match precision {
        Precision::F32 => numbers::<4>(file, name, Dtype::F32, shape)?.map(f32::from_le_bytes).collect(),
        Precision::F16 => numbers::<2>(file, name, Dtype::F16, shape)?
            .map(|bytes| from_half_bits(u16::from_le_bytes(bytes)))
            .collect(),
    };
    match values.iter().position(|x| !x.is_finite()) {
        None => Ok(values),
        Some(index) => {
            let detail = format!("element {index} is {}, not a finite number", values[index]);
            Err(TableFileError::Tensor { name: name.to_owned(), detail })
        }
    }
}

#[cfg(test)]
mod tests;
