//! The canonical file of a lookup table: safetensors with the recipe as its only metadata.
//!
//! | tensor | type | shape |
//! |---|---|---|
//! | `texels` | f32, f16, u16 or u8, by the recipe's precision | the table's axes, channels |
//! | `average` (table `albedo`) | f32 | roughness |

use safetensors::{Dtype, SafeTensors, serialize};

use super::safetensors::{RECIPE_KEY, TableFile, TableFileError, decode, finite, numbers, tensor};
use crate::{
    recipe_document::{self, AnyRecipe},
    tensor::Tensor,
};
use ltcforge_fit::{
    Precision,
    albedo::{Lut, LutKind, LutPrecision, LutRecipe},
};

/// A decoded file of a lookup table.
#[derive(Debug, Clone, PartialEq)]
pub struct LutFile {
    /// The recipe.
    pub recipe: LutRecipe,
    /// The table.
    pub lut: Lut,
}

/// A decoded file of either kind.
#[derive(Debug, Clone, PartialEq)]
pub enum AnyFile {
    /// A table of linearly transformed cosines.
    Ltc(Box<TableFile>),
    /// A lookup table.
    Lut(LutFile),
}

impl AnyFile {
    /// The canonical JSON of the recipe.
    #[must_use]
    pub fn recipe_json(&self) -> String {
        match self {
            Self::Ltc(file) => recipe_document::canonical_json(&file.recipe),
            Self::Lut(file) => recipe_document::canonical_json(&file.recipe),
        }
    }
}

/// The canonical file of a lookup table.
///
/// # Errors
/// The container cannot be written.
pub fn encode_lut(recipe: &LutRecipe, lut: &Lut) -> Result<Vec<u8>, TableFileError> {
    let shape = shape(recipe);
    let mut tensors = vec![("texels".to_owned(), texels(recipe, &lut.texels))];
    tensors.extend(
        lut.average.as_ref().map(|average| ("average".to_owned(), tensor(Precision::F32, &shape[..1], average))),
    );
    let metadata = [(RECIPE_KEY.to_owned(), recipe_document::canonical_json(recipe))];
    serialize(tensors, Some(metadata.into_iter().collect()))
        .map_err(|error| TableFileError::Container(error.to_string()))
}

fn shape(recipe: &LutRecipe) -> Vec<usize> {
    let axes = recipe.resolution.texels().iter().map(|n| *n as usize);
    axes.chain([recipe.channels().len()]).collect()
}

/// The tensor of a table's texels. Integers are steps from 0 to 1.
fn texels(recipe: &LutRecipe, texels: &[f32]) -> Tensor {
    let steps = f32::from(recipe.precision.steps().unwrap_or(1));
    let integers = texels.iter().map(|x| (x * steps).round() as u16);
    let (dtype, bytes) = match recipe.precision {
        LutPrecision::F32 => return tensor(Precision::F32, &shape(recipe), texels),
        LutPrecision::F16 => return tensor(Precision::F16, &shape(recipe), texels),
        LutPrecision::Unorm16 => (Dtype::U16, integers.flat_map(u16::to_le_bytes).collect()),
        LutPrecision::Rgba8 => (Dtype::U8, integers.map(|integer| integer as u8).collect()),
    };
    Tensor { dtype, shape: shape(recipe), bytes }
}

fn read_texels(file: &SafeTensors, recipe: &LutRecipe) -> Result<Vec<f32>, TableFileError> {
    let shape = shape(recipe);
    let step = f64::from(recipe.precision.steps().unwrap_or(1));
    let fraction = |integer: u16| (f64::from(integer) / step) as f32;
    match recipe.precision {
        LutPrecision::F32 => finite(file, "texels", Precision::F32, &shape),
        LutPrecision::F16 => finite(file, "texels", Precision::F16, &shape),
        LutPrecision::Unorm16 => {
            Ok(numbers::<2>(file, "texels", Dtype::U16, &shape)?.map(|x| fraction(u16::from_le_bytes(x))).collect())
        }
        LutPrecision::Rgba8 => {
            Ok(numbers::<1>(file, "texels", Dtype::U8, &shape)?.map(|[x]| fraction(u16::from(x))).collect())
        }
    }
}

/// Reads a canonical file of either kind. Hostile bytes give an error, never a panic.
///
/// # Errors
/// Like [`decode`].
pub fn decode_any(bytes: &[u8]) -> Result<AnyFile, TableFileError> {
    let ltc = || decode(bytes).map(|file| AnyFile::Ltc(Box::new(file)));
    // Errors of the container and of the recipe are those of `decode`.
    let Ok((_, header)) = SafeTensors::read_metadata(bytes) else { return ltc() };
    let Some(text) = header.metadata().as_ref().and_then(|metadata| metadata.get(RECIPE_KEY)) else { return ltc() };
    let Ok(AnyRecipe::Lut(recipe)) = recipe_document::parse_any_stored(text.as_bytes()) else { return ltc() };
    let file = SafeTensors::deserialize(bytes).map_err(|error| TableFileError::Container(error.to_string()))?;
    let shape = shape(&recipe);
    let average = || finite(&file, "average", Precision::F32, &shape[..1]);
    let average = (recipe.table == LutKind::Albedo).then(average).transpose()?;
    let lut = Lut { texels: read_texels(&file, &recipe)?, average };
    if encode_lut(&recipe, &lut)? != bytes {
        return Err(TableFileError::NotCanonical);
    }
    Ok(AnyFile::Lut(LutFile { recipe, lut }))
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::recipe_document::{DEFAULT_ENTRY_LIMIT, RecipeError, parse_any};
    use crate::tabulated::no_files;
    use ltcforge_fit::albedo::{LutPlan, fit_lut};

    fn recipe(document: &str) -> Result<AnyRecipe, RecipeError> {
        parse_any(document.as_bytes(), DEFAULT_ENTRY_LIMIT, &no_files)
    }

    #[test]
    fn lookup_tables_round_trip_and_damaged_files_are_refused() {
        for (kind, axes, precision) in [
            ("albedo", "{\"roughness\": 3, \"cos_theta\": 2}", "f32"),
            ("albedo", "{\"roughness\": 3, \"cos_theta\": 2}", "f16"),
            ("transmission", "{\"ior\": 2, \"roughness\": 3, \"cos_theta\": 2}", "unorm16"),
            ("anisotropic_dfg", "{\"alpha\": 2, \"ratio\": 3, \"theta\": 2, \"phi\": 2}", "rgba8"),
        ] {
            let document = format!(r#"{{"table": "{kind}", "resolution": {axes}, "precision": "{precision}"}}"#);
            let Ok(AnyRecipe::Lut(recipe)) = recipe(&document) else { panic!("a recipe of a lookup table") };
            let lut = fit_lut(&LutPlan::new(&recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it");
            let bytes = encode_lut(&recipe, &lut).expect("a file");
            assert_eq!(decode_any(&bytes), Ok(AnyFile::Lut(LutFile { recipe, lut })));
            assert!(decode(&bytes).expect_err("not an LTC table").to_string().contains("lookup table"));
            assert!(decode_any(&bytes[..bytes.len() - 1]).is_err());
            let mut other = bytes.clone();
            let last = other.len() - 1;
            other[last] = 0xff;
            other[last - 1] = 0xff;
            assert!(recipe.precision.steps().is_some() || decode_any(&other).is_err(), "not a number");
        }
    }

    #[test]
    fn faults_name_the_field_and_the_allowed_values() {
        let message = |document: &str| recipe(document).expect_err("a fault").to_string();
        for (document, parts) in [
            (
                r#"{"table": "brdf"}"#,
                [
                    "/table",
                    "\"ltc\", \"dfg\", \"albedo\", \"sheen\", \"diffuse\", \"transmission\", \"anisotropic_dfg\"",
                ],
            ),
            (r#"{"table": "sheen", "brdf": "ggx"}"#, ["/brdf", "\"charlie\", \"charlie_neubelt\", \"fuzz\""]),
            (r#"{"table": "albedo", "form": "karis"}"#, ["/form", "no forms"]),
            (r#"{"table": "dfg", "form": "hill"}"#, ["/form", "\"karis\", \"filament\", \"f82\""]),
            (r#"{"preset": "dfg", "resolution": {"roughness": 1}}"#, ["/resolution/roughness", "2 to 1024"]),
            (r#"{"table": "dfg", "layout": "ltc2017"}"#, ["/layout", "unknown field"]),
            (r#"{"table": "dfg", "resolution": {"cos_theta": 1e9}}"#, ["/resolution/cos_theta", "2 to 1024"]),
            (r#"{"table": "dfg", "resolution": {"ior": 4}}"#, ["/resolution/ior", "unknown field"]),
            (r#"{"table": "transmission", "resolution": {"ior": 65}}"#, ["/resolution/ior", "2 to 64"]),
            (r#"{"table": "transmission", "form": "karis"}"#, ["/form", "no forms"]),
            (r#"{"table": "anisotropic_dfg", "resolution": {"phi": 17}}"#, ["/resolution/phi", "2 to 16"]),
            (r#"{"table": "anisotropic_dfg", "axes": {}}"#, ["/axes", "leave this field out"]),
            (r#"{"table": ["dfg"]}"#, ["/table", "is not one of"]),
        ] {
            let message = message(document);
            assert!(parts.iter().all(|part| message.contains(part)), "{document}: {message}");
        }
        let plain = recipe_document::parse(b"{}", DEFAULT_ENTRY_LIMIT).expect("a recipe");
        assert_eq!(recipe(r#"{"table": "ltc"}"#), Ok(AnyRecipe::Ltc(Box::new(plain))));
        assert_eq!(recipe(r#"{"preset": "dfg"}"#), recipe(r#"{"table": "dfg"}"#));
    }
}
