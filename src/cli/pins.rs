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
    tabulated, usage,
};
use ltcforge_client::{ExportPin, FilePin, Pin};
use ltcforge_files::{
    container::{self, TableFile},
    digest::Digest,
    manifest::MeanError,
};
use ltcforge_fit::Recipe;
use ltcforge_textures::{About, Export, TextureFile, UnknownExport};

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
    pub(super) fn recipe(&self, name: &Path, document: &[u8]) -> Result<Recipe, CommandFailure> {
        tabulated::recipe(name, document, self.entry_limit).map(|(recipe, _)| recipe)
    }

    /// Fits a recipe and returns the table's file.
    ///
    /// # Errors
    /// When no threads can be started, or the user stops the fit.
    pub(super) fn fit(&self, recipe: &Recipe) -> Result<Vec<u8>, CommandFailure> {
        let table = self.threads.pool()?.install(|| fit_alone(recipe, self.draws_progress, self.interrupt))?;
        container::encode(recipe, &table).map_err(failed)
    }

    /// Measures a table, for exports.
    ///
    /// # Errors
    /// When the file of the table's tabulated BRDF is missing, or no threads can be started.
    pub(super) fn measure(&self, mut file: TableFile, digest: Digest) -> Result<Measured, CommandFailure> {
        // The file of a tabulated BRDF is in one of the table folders.
        let name = PathBuf::from(format!("{}.safetensors", digest.hex()));
        tabulated::attach(&mut file, &name);
        tabulated::check_complete(&file.table, &name)?;
        let error = self.threads.pool()?.install(|| export::measured(&file.table, Some(&file.recipe)));
        Ok(Measured { file, digest, error })
    }
}

/// A table that was measured once for all its exports.
pub(super) struct Measured {
    file: TableFile,
    digest: Digest,
    /// The table's mean error between nodes.
    error: Option<MeanError>,
}

impl Measured {
    /// The files of an export, with their pins in the same order.
    ///
    /// # Errors
    /// When this version does not know the export, or cannot make it from the table.
    pub(super) fn export(&self, asked: &ExportPin) -> Result<(ExportPin, Vec<TextureFile>), CommandFailure> {
        let files = self.files(export_of(asked)?)?;
        let pin = |file: &TextureFile| FilePin {
            path: asked.to.join(&file.path),
            bytes: file.bytes.len() as u64,
            digest: Digest::of(&file.bytes),
        };
        let pins = files.iter().map(pin).collect();
        Ok((ExportPin { file: pins, ..asked.clone() }, files))
    }

    /// The files of an export.
    ///
    /// # Errors
    /// When the export cannot be made from the table.
    pub(super) fn files(&self, export: Export) -> Result<Vec<TextureFile>, CommandFailure> {
        let Self { file: TableFile { table, recipe, .. }, digest, error } = self;
        Ok(export.bundle(table, About::of_table(*digest, Some(recipe), *error)).map_err(usage)?.files)
    }
}

/// The pin of an export, without its files.
///
/// # Errors
/// When `--precision` is given with an engine that has a fixed number format.
pub(super) fn asked_by(choice: &ExportChoice, to: &Path) -> Result<ExportPin, CommandFailure> {
    let ExportChoice { engine, layout, container, precision } = &choice.checked()?;
    Ok(ExportPin {
        engine: engine.map(|engine| engine.name().to_owned()),
        layout: layout.clone(),
        container: container.clone(),
        precision: precision.map(|precision| precision.name().to_owned()),
        to: to.to_owned(),
        file: vec![],
    })
}

/// The export that a pin requests.
pub(super) fn export_of(pin: &ExportPin) -> Result<Export, CommandFailure> {
    const FIELDS: &str = "use «for», or «layout», «container» and optionally «precision», or a compact «container»";
    let named = pin.name().ok_or_else(|| FIELDS.to_owned());
    let export = named.and_then(|name| name.parse().map_err(|error: UnknownExport| error.to_string()));
    export.map_err(|why| usage(format!("the export to {}: {why}", pin.to.display())))
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
            assert_eq!(asked.name(), Some(export_of(&asked).expect("a known export").to_string()));
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
            let refused = export_of(&asked).expect_err(said);
            assert_eq!(refused.exit, super::super::Exit::Usage);
            assert!(refused.message.contains(said), "{}", refused.message);
        }
    }
}
