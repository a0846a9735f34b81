//! The bytes of an export's files, before the table is fitted.

use super::{About, Engine, Export};
use ltcforge_files::{digest::Digest, manifest::MeanError};
use ltcforge_fit::{Recipe, Table, Terms};

/// The figures with the longest text in a file.
const LONGEST: MeanError = MeanError { width: 0.5, places: 1_000_000 };
/// The text of rounding errors in a manifest may be this much longer than for a placeholder.
const MANIFEST_TEXT: u64 = 512;

impl Engine {
    /// The bytes of all files for a recipe's table, with room for the longest report; `None` if the engine cannot load
    /// the table.
    #[must_use]
    pub fn bytes(self, table: &Table, recipe: &Recipe) -> Option<u64> {
        let about = About::of_table(Digest::of(b""), Some(recipe), Some(LONGEST));
        let files = Export::Engine(self).bundle(table, about).ok()?.files;
        Some(files.iter().map(|file| file.bytes.len() as u64).sum())
    }

    /// [`Engine::bytes`] for a recipe that is not fitted: at most this many. `like` is another table of the scattering
    /// model. For an engine with its own layout, it has this layout.
    #[must_use]
    pub fn predicted_bytes(self, like: &Table, recipe: &Recipe) -> Option<u64> {
        let entries = recipe.entries() as usize;
        let matrices = || vec![[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]; entries];
        let placeholder = || Table {
            brdf: recipe.model().clone(),
            layout: recipe.layout(),
            axes: recipe.nodes(),
            matrix: matrices(),
            second: recipe.model().fresnel().second().map(|_| matrices()),
            terms: Some(Terms { amplitude: vec![1.0; entries], fresnel: vec![0.0; entries], edge: None }),
            node_error: vec![0.0; entries],
            ..like.clone()
        };
        let table = if self.layout().is_some() { like.clone() } else { placeholder() };
        Some(self.bytes(&table, recipe)? + MANIFEST_TEXT)
    }
}
