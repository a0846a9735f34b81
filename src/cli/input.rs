//! Reads the recipes and tables that the command line names.

use std::{
    io,
    path::{Path, PathBuf},
};

use clap::Args;

use super::{CommandFailure, file_failure, mismatch, table_file, table_path, tabulated, usage};
use ltcforge_client::TABLE_BYTES;
use ltcforge_files::{
    bounded::{read_named, read_stream},
    compact::{self, COMPACT_MAGIC},
    container::{AnyFile, NPY_MAGIC, NpyTable, TableFile, decode_npy},
    digest::Digest,
    text::{other_form, without_mark},
};
use ltcforge_fit::{BrdfKind, MOST_POINTS, PerAxis, Recipe, Report, Table, ggx_terms, report, report_points};

/// The choice of a table.
#[derive(Debug, Args)]
pub struct TableChoice {
    /// Table: a file, or the first digits of a digest in --tables
    pub table: PathBuf,
    /// The folder of tables
    #[command(flatten)]
    pub folder: TableFolder,
}

/// The folder to search for tables, and the maximum size of a table.
#[derive(Debug, Args)]
pub struct TableFolder {
    /// Folder to search for digests [default: `.`, then `tables`]
    #[arg(long, value_name = "DIR")]
    pub tables: Option<PathBuf>,
    /// The maximum size of a table.
    #[command(flatten)]
    pub limit: TableLimit,
}

/// The maximum size of a table.
#[derive(Debug, Clone, Copy, Args)]
pub struct TableLimit {
    /// Largest table to read or download
    #[arg(long, env = "LTCFORGE_TABLE_LIMIT", value_name = "BYTES", default_value_t = TABLE_BYTES)]
    pub table_limit: u64,
}

/// Maximum size of a recipe. The service accepts only 64 KiB.
const RECIPE_LIMIT_BYTES: u64 = 1 << 20;

/// A table from one of ltcforge's files, from a compact form, or from a `.npy` file.
pub(super) struct AnyTable {
    pub(super) path: PathBuf,
    /// The digest of the file.
    pub(super) digest: Digest,
    pub(super) table: Table,
    pub(super) origin: Origin,
}

/// The origin of a table, as its file states it.
pub(super) enum Origin {
    /// The recipe that one of ltcforge's files contains.
    Recipe(Recipe),
    /// The axis ranges of a compact form or a `.npy` file, which contain no recipe.
    Range(PerAxis<[f64; 2]>),
}

impl Origin {
    /// The recipe, if the file has one.
    pub(super) fn recipe(&self) -> Option<&Recipe> {
        if let Self::Recipe(recipe) = self { Some(recipe) } else { None }
    }

    /// The ranges of the table's axes.
    pub(super) fn range(&self) -> &PerAxis<[f64; 2]> {
        match self {
            Self::Recipe(recipe) => &recipe.range,
            Self::Range(range) => range,
        }
    }
}

impl AnyTable {
    /// Reads a table. The first bytes of the file or its extension determine the format.
    ///
    /// # Errors
    /// When the file does not exist, is longer than the limit, or is not a table.
    pub(super) fn read(choice: &TableChoice) -> Result<Self, CommandFailure> {
        Self::named(&choice.table, &choice.folder)
    }

    /// Reads the table `name`: a path or a digest.
    ///
    /// # Errors
    /// See [`Self::read`].
    pub(super) fn named(name: &Path, folder: &TableFolder) -> Result<Self, CommandFailure> {
        let path = table_path(name, folder.tables.as_deref())?;
        let bytes = read_named(&path, folder.limit.table_limit).map_err(|error| file_failure(&path, &error))?;
        if bytes.starts_with(COMPACT_MAGIC) {
            let table = compact::decode(&bytes).map_err(|error| mismatch(&path, error))?;
            let ends = |nodes: &Vec<f64>| [nodes.first(), nodes.last()].map(|end| end.copied().unwrap_or_default());
            let PerAxis { alpha, ratio, theta, phi } = &table.axes;
            let range = PerAxis { alpha: ends(alpha), ratio: ends(ratio), theta: ends(theta), phi: ends(phi) };
            return Ok(Self { path, digest: Digest::of(&bytes), table, origin: Origin::Range(range) });
        }
        let is_npy = bytes.starts_with(NPY_MAGIC) || path.extension().is_some_and(|extension| extension == "npy");
        if !is_npy {
            let (digest, file) = table_file::check(&path, &bytes, None)?;
            let AnyFile::Ltc(mut file) = file else {
                let why = "is a lookup table; this command is for tables of linearly transformed cosines";
                return Err(usage(format!("{} {why}", path.display())));
            };
            tabulated::attach(&mut file, &path);
            let TableFile { table, recipe } = *file;
            return Ok(Self { path, digest, table, origin: Origin::Recipe(recipe) });
        }
        let NpyTable { table, range } = decode_npy(&bytes)
            .map_err(|error| mismatch(&path, other_form(&bytes).unwrap_or_else(|| error.to_string())))?;
        Ok(Self { path, digest: Digest::of(&bytes), table, origin: Origin::Range(range) })
    }

    /// Measures the table at `points` points, by default at as many as its manifest reports. Runs on the current rayon
    /// pool.
    pub(super) fn report(&self, points: Option<u32>) -> Report {
        let usual = self.origin.recipe().map_or(MOST_POINTS.into(), report_points);
        report(&self.table, self.origin.range(), points.map_or(usual, |points| (points as usize).into()))
    }

    /// If `of_ggx`, replaces the table's amplitude and Fresnel term with those of GGX.
    ///
    /// # Errors
    /// When the table has another scattering model.
    pub(super) fn with_terms(mut self, of_ggx: bool) -> Result<Self, CommandFailure> {
        if !of_ggx {
            return Ok(self);
        }
        if self.table.brdf != BrdfKind::Ggx {
            let message = format!("--ggx-terms needs a table of brdf ggx; this table has brdf {}", self.table.brdf);
            return Err(usage(message));
        }
        self.table.terms = Some(ggx_terms(self.table.layout, &self.table.axes));
        Ok(self)
    }
}

/// Reads a recipe by name: `-` is stdin, a bare word is a preset, anything else is a file.
///
/// # Errors
/// When the recipe cannot be read, or is longer than [`RECIPE_LIMIT_BYTES`].
pub(super) fn recipe_document(name: &Path) -> Result<Vec<u8>, CommandFailure> {
    let document = match name.to_str() {
        Some("-") => read_stream(io::stdin().lock(), RECIPE_LIMIT_BYTES)
            .map_err(|error| file_failure(Path::new("standard input"), &error)),
        Some(preset) if is_preset_name(preset) => Ok(serde_json::json!({ "preset": preset }).to_string().into_bytes()),
        _ => read_named(name, RECIPE_LIMIT_BYTES).map_err(|error| {
            file_failure(name, &format!("{error}; a recipe is a file, a preset such as draft, or - for standard input"))
        }),
    };
    document.map(|document| without_mark(&document).to_vec())
}

/// Whether a name is a bare word. A recipe file without an extension needs a path such as `./recipe`.
fn is_preset_name(name: &str) -> bool {
    !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_'))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::{super::Exit, *};

    #[test]
    fn a_bare_word_is_a_preset_and_anything_else_a_file() {
        assert_eq!(recipe_document(Path::new("paper")).expect("a preset"), br#"{"preset":"paper"}"#);
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("recipe.json");
        fs::write(&path, "{}").expect("a file");
        assert_eq!(recipe_document(&path).expect("a file"), b"{}");
        let refused = recipe_document(Path::new("./none.json")).expect_err("no file");
        assert_eq!(refused.exit, Exit::Failed);
        assert!(refused.message.starts_with("./none.json: "), "{}", refused.message);
        let refused = recipe_document(Path::new("{\"preset\": \"draft\"}")).expect_err("no file");
        assert!(refused.message.contains("- for standard input"), "{}", refused.message);
        let refused = recipe_document(Path::new("/dev/zero")).expect_err("no end");
        assert!(refused.message.contains("not a regular file"), "{}", refused.message);
    }
}
