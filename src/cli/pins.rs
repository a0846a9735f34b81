//! Makes pinned files again, for `lock`, `pull` and `verify`: tables from their recipes, exports from tables.

use std::{
    num::NonZeroU64,
    path::{Path, PathBuf},
};

use super::{
    CommandFailure, Context, ExportChoice, Interrupt, Threads,
    export::{self},
    failed,
    fit::fit_alone,
    lut, tabulated, usage,
};
use ltcforge_client::{ExportPin, FilePin, Pin};
use ltcforge_files::{
    container::{self, AnyFile, LutFile, TableFile, encode_lut},
    digest::Digest,
    manifest::MeanError,
    recipe_document::AnyRecipe,
};
use ltcforge_textures::{About, Export, LutExport, LutExportError, TextureFile, UnknownExport};

/// Settings for fitting tables.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fitting<'a> {
    threads: Threads,
    entry_limit: Option<NonZeroU64>,
    draws_progress: bool,
    interrupt: &'a Interrupt,
}

impl<'a> Fitting<'a> {
    /// The settings that the command line chooses.
    pub(super) fn new(threads: Threads, entry_limit: Option<NonZeroU64>, context: &'a Context<'_>) -> Self {
        Self { threads, entry_limit, draws_progress: context.draws_progress, interrupt: &context.interrupt }
    }

    /// Parses the recipe in `document`, which was read from `name`.
    ///
    /// # Errors
    /// The faults of the recipe. It is also a fault if the recipe names another fitter version.
    pub(super) fn recipe(&self, name: &Path, document: &[u8]) -> Result<AnyRecipe, CommandFailure> {
        tabulated::any_recipe(name, document, self.entry_limit).map(|(recipe, _)| recipe)
    }

    /// Fits a recipe and returns the table's file.
    ///
    /// # Errors
    /// When no threads can be started, or the user stops the fit.
    pub(super) fn fit(&self, recipe: &AnyRecipe) -> Result<Vec<u8>, CommandFailure> {
        let (pool, draws, interrupt) = (self.threads.pool()?, self.draws_progress, self.interrupt);
        match recipe {
            AnyRecipe::Ltc(recipe) => {
                let table = pool.install(|| fit_alone(recipe, draws, interrupt))?;
                container::encode(recipe, &table).map_err(failed)
            }
            AnyRecipe::Lut(recipe) => {
                let lut = pool.install(|| lut::fit_alone(recipe, draws, interrupt))?;
                encode_lut(recipe, &lut).map_err(failed)
            }
        }
    }

    /// Measures a table, for exports.
    ///
    /// # Errors
    /// When the file of the table's tabulated BRDF is missing, or no threads can be started.
    pub(super) fn measure(&self, file: AnyFile, digest: Digest) -> Result<Measured, CommandFailure> {
        let mut file = match file {
            AnyFile::Ltc(file) => *file,
            AnyFile::Lut(file) => return Ok(Measured::Lut { file, digest, threads: self.threads }),
        };
        // The file of a tabulated BRDF is in one of the table folders.
        let name = PathBuf::from(format!("{}.safetensors", digest.hex()));
        tabulated::attach(&mut file, &name);
        tabulated::check_complete(&file.table, &name)?;
        let error = self.threads.pool()?.install(|| export::measured(&file.table, Some(&file.recipe)));
        Ok(Measured::Ltc { file: Box::new(file), digest, error })
    }
}

/// A table that was measured once for all its exports.
pub(super) enum Measured {
    /// A table of linearly transformed cosines.
    Ltc {
        file: Box<TableFile>,
        digest: Digest,
        /// The table's mean error between nodes.
        error: Option<MeanError>,
    },
    /// A lookup table, which each export measures.
    Lut { file: LutFile, digest: Digest, threads: Threads },
}

impl Measured {
    /// The files of an export, with their pins in the same order.
    ///
    /// # Errors
    /// When this version does not know the export, or cannot make it from the table.
    pub(super) fn export(&self, asked: &ExportPin) -> Result<(ExportPin, Vec<TextureFile>), CommandFailure> {
        let files = self.files(&name_of(asked)?).map_err(|failure| of_export(asked, &failure))?;
        let pin = |file: &TextureFile| FilePin {
            path: asked.to.join(&file.path),
            bytes: file.bytes.len() as u64,
            digest: Digest::of(&file.bytes),
        };
        let pins = files.iter().map(pin).collect();
        Ok((ExportPin { file: pins, ..asked.clone() }, files))
    }

    /// The files of the export `name`.
    ///
    /// # Errors
    /// When the export cannot be made from the table.
    pub(super) fn files(&self, name: &str) -> Result<Vec<TextureFile>, CommandFailure> {
        let bundle = match self {
            Self::Ltc { file, digest, error } => {
                let export: Export = name.parse().map_err(|error: UnknownExport| usage(error))?;
                export.bundle(&file.table, About::of_table(*digest, Some(&file.recipe), *error)).map_err(usage)?
            }
            Self::Lut { file, digest, threads } => {
                let export: LutExport = name.parse().map_err(|error: LutExportError| usage(error))?;
                threads.pool()?.install(|| export.bundle(file, *digest)).map_err(usage)?
            }
        };
        Ok(bundle.files)
    }
}

/// The pin of an export, without its files.
///
/// # Errors
/// When `--precision` is given with an engine that has a fixed number format.
pub(super) fn asked_by(choice: &ExportChoice, to: &Path) -> Result<ExportPin, CommandFailure> {
    let ExportChoice { engine, layout, container, precision } = &choice.checked()?;
    Ok(ExportPin {
        engine: engine.clone(),
        layout: layout.clone(),
        container: container.clone(),
        precision: precision.map(|precision| precision.name().to_owned()),
        to: to.to_owned(),
        file: vec![],
    })
}

/// The name of the export that a pin requests.
pub(super) fn name_of(pin: &ExportPin) -> Result<String, CommandFailure> {
    const FIELDS: &str = "use «for», or «container», optionally with «layout» and «precision»";
    pin.name().ok_or_else(|| of_export(pin, &usage(FIELDS)))
}

/// A failure of an export.
fn of_export(pin: &ExportPin, failure: &CommandFailure) -> CommandFailure {
    CommandFailure::new(failure.exit, format!("the export to {}: {}", pin.to.display(), failure.message))
}

/// A failure of the pin `name`.
pub(super) fn of_pin(pin: &Pin, failure: &CommandFailure) -> CommandFailure {
    CommandFailure::new(failure.exit, format!("{}: {}", pin.name, failure.message))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pin(engine: Option<&str>, layout: Option<&str>, container: Option<&str>, precision: Option<&str>) -> ExportPin {
        let text = |text: Option<&str>| text.map(str::to_owned);
        let (engine, layout) = (text(engine), text(layout));
        ExportPin {
            engine,
            layout,
            container: text(container),
            precision: text(precision),
            to: "out".into(),
            file: vec![],
        }
    }

    #[test]
    fn a_pin_requests_the_same_export_again() {
        for asked in [
            pin(Some("wgpu"), None, None, None),
            pin(None, Some("reflected"), Some("ktx2"), Some("f16")),
            pin(None, Some("reflected"), Some("dds"), None),
            pin(None, None, Some("compact-js"), None),
        ] {
            // Services use the same name for the export.
            let name = name_of(&asked).expect("a name");
            let export: Export = name.parse().expect("a known export");
            assert_eq!(export.to_string(), name);
        }
    }

    #[test]
    fn an_unknown_export_is_reported_with_the_known_exports() {
        for (asked, said) in [
            (pin(Some("unity"), None, None, None), "«unity» is not an export; allowed: an engine (three, "),
            (pin(None, Some("reflected"), Some("bmp"), None), "«reflected.bmp.f32» is not an export"),
            (pin(None, Some("reflected"), Some("dds"), Some("f64")), "«reflected.dds.f64» is not an export"),
            (pin(None, None, None, None), "use «for», or"),
            (pin(Some("wgpu"), Some("reflected"), Some("dds"), None), "use «for», or"),
            (pin(None, Some("reflected"), None, None), "use «for», or"),
        ] {
            let parsed = name_of(&asked).map(|name| name.parse::<Export>().map_err(usage));
            let refused = parsed.and_then(|export| export).expect_err(said);
            assert_eq!(refused.exit, super::super::Exit::Usage);
            assert!(refused.message.contains(said), "{}", refused.message);
        }
    }
}
