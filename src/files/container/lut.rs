//! The canonical file of a lookup table: safetensors with the recipe as its only metadata.
//!
//! | tensor | type | shape |
//! |---|---|---|
//! | `texels` | f32, or f16 if it is the recipe's precision | roughness, cos_theta, channels |
//! | `average` (table `albedo`) | f32 | roughness |

use safetensors::{SafeTensors, serialize};

use super::safetensors::{RECIPE_KEY, TableFile, TableFileError, decode, finite, tensor};
use crate::recipe_document::{self, AnyRecipe};
use ltcforge_fit::{
    Precision,
    albedo::{Lut, LutKind, LutRecipe},
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
    let mut tensors = vec![("texels".to_owned(), tensor(recipe.precision, &shape, &lut.texels))];
    tensors.extend(
        lut.average.as_ref().map(|average| ("average".to_owned(), tensor(Precision::F32, &shape[..1], average))),
    );
    let metadata = [(RECIPE_KEY.to_owned(), recipe_document::canonical_json(recipe))];
    serialize(tensors, Some(metadata.into_iter().collect()))
        .map_err(|error| TableFileError::Container(error.to_string()))
}

fn shape(recipe: &LutRecipe) -> [usize; 3] {
    [recipe.resolution.roughness as usize, recipe.resolution.cos_theta as usize, recipe.channels().len()]
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
    let lut = Lut { texels: finite(&file, "texels", recipe.precision, &shape)?, average };
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
        for precision in ["f32", "f16"] {
            let document = format!(
                r#"{{"table": "albedo", "resolution": {{"roughness": 3, "cos_theta": 2}}, "precision": "{precision}"}}"#
            );
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
            assert!(decode_any(&other).is_err(), "not a number");
        }
    }

    #[test]
    fn faults_name_the_field_and_the_allowed_values() {
        let message = |document: &str| recipe(document).expect_err("a fault").to_string();
        for (document, parts) in [
            (r#"{"table": "brdf"}"#, ["/table", "\"ltc\", \"dfg\", \"albedo\", \"sheen\", \"diffuse\""]),
            (r#"{"table": "sheen", "brdf": "ggx"}"#, ["/brdf", "\"charlie\", \"charlie_neubelt\", \"fuzz\""]),
            (r#"{"table": "albedo", "form": "karis"}"#, ["/form", "no forms"]),
            (r#"{"table": "dfg", "form": "hill"}"#, ["/form", "\"karis\", \"filament\""]),
            (r#"{"preset": "dfg", "resolution": {"roughness": 1}}"#, ["/resolution/roughness", "2 to 1024"]),
            (r#"{"table": "dfg", "layout": "ltc2017"}"#, ["/layout", "unknown field"]),
        ] {
            let message = message(document);
            assert!(parts.iter().all(|part| message.contains(part)), "{document}: {message}");
        }
        let plain = recipe_document::parse(b"{}", DEFAULT_ENTRY_LIMIT).expect("a recipe");
        assert_eq!(recipe(r#"{"table": "ltc"}"#), Ok(AnyRecipe::Ltc(Box::new(plain))));
        assert_eq!(recipe(r#"{"preset": "dfg"}"#), recipe(r#"{"table": "dfg"}"#));
    }
}
