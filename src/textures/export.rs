//! Exports of a table. Each set of files has a name.

mod bytes;

use std::{fmt, str::FromStr};

use super::{
    About, Bundle, CompactContainer, CompactFileError, Engine, LutExport, NoTextures, TextureContainer, TextureFile,
    TextureFileError, TextureLayout, recipe::recipe_like, rounding::RoundingError, sampling_of,
};
use ltcforge_files::compact::{COMPACT_MAGIC, encode_lobes};
use ltcforge_fit::{Precision, Table};

/// The name of a file that contains all textures, without its extension.
pub(super) const STEM: &str = "ltc";
/// The manifest's key for the name of an export that is not for an engine.
pub(super) const MANIFEST_KEY: &str = "export";

/// A set of files that can be made from a table. Its name is an engine, a compact form, or a layout, format and
/// precision with dots between: `three`, `compact-js`, `ltc2017.ktx2.f16`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Export {
    /// The files of an engine, named as the engine expects.
    Engine(Engine),
    /// Textures of a layout in any format.
    Textures {
        /// The layout of axes, texels and channels.
        layout: TextureLayout,
        /// The format of the files.
        container: TextureContainer,
        /// The number format.
        precision: Precision,
    },
    /// The table in its compact form.
    Compact(CompactContainer),
    /// The files of a lookup table.
    Lut(LutExport),
}

/// The name is not an export.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "«{}» is not an export; allowed: an engine ({}), a compact form ({}), or layout.container.precision, such as \
    ltc2017.ktx2.f16, with layouts {}, containers {} and precisions {}", .0.escape_debug(), names(Engine::ALL),
    names(CompactContainer::ALL), names(TextureLayout::ALL), names(TextureContainer::ALL), names(Precision::ALL)
)]
pub struct UnknownExport(pub String);

fn names<T: fmt::Display>(all: &[T]) -> String {
    all.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// The table does not have these files.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ExportError {
    /// The table has no textures of this layout.
    #[error(transparent)]
    Textures(#[from] NoTextures),
    /// The table has these textures, but not in the sizes that the engine needs.
    #[error("{source}; this recipe gives a table with these sizes: {recipe}")]
    Sizes {
        /// The sizes that the engine needs, and the sizes of the table.
        source: Box<TextureFileError>,
        /// A recipe whose table has the needed sizes.
        recipe: String,
    },
    /// The format cannot store the textures.
    #[error(transparent)]
    Files(TextureFileError),
    /// Some matrices are singular, and shaders cannot invert them.
    #[error(
        "{count} entries have matrices without an inverse, which shaders cannot use; the first is entry {entry}, {place}"
    )]
    Singular {
        /// The number of singular matrices.
        count: usize,
        /// The index of the first singular entry.
        entry: usize,
        /// The position of the first singular entry.
        place: String,
    },
    /// The export is for lookup tables.
    #[error(
        "{0} is an export of lookup tables, and this is a table for area lights; choose a layout, or fit the recipe dfg and export its table"
    )]
    LookupTable(LutExport),
    /// The table has no compact form of this kind.
    #[error(transparent)]
    Compact(#[from] CompactFileError),
}

impl ExportError {
    /// A recipe for a table that has these files, if there is one.
    #[must_use]
    pub fn recipe(&self) -> Option<&str> {
        match self {
            Self::Textures(NoTextures::OtherLayout { recipe, .. } | NoTextures::Lacking { recipe, .. })
            | Self::Sizes { recipe, .. }
            | Self::Compact(CompactFileError::Layout { recipe, .. }) => Some(recipe),
            Self::Textures(_) | Self::Files(_) | Self::Singular { .. } | Self::Compact(_) | Self::LookupTable(_) => {
                None
            }
        }
    }
}

impl Export {
    /// All exports of tables for area lights: first engines, then textures, then compact forms.
    pub fn all() -> impl Iterator<Item = Self> {
        let textures = TextureLayout::ALL.iter().flat_map(|&layout| {
            TextureContainer::ALL.iter().flat_map(move |&container| {
                Precision::ALL.iter().map(move |&precision| Self::Textures { layout, container, precision })
            })
        });
        let compact = CompactContainer::ALL.iter().map(|&container| Self::Compact(container));
        Engine::ALL.iter().map(|&engine| Self::Engine(engine)).chain(textures).chain(compact)
    }

    /// The name of the layout of the files, if the table supports it. Sizes are not checked.
    ///
    /// # Errors
    /// The table does not have this layout, or a matrix has no inverse. [`ExportError::recipe`] may suggest a recipe.
    pub fn layout(self, table: &Table) -> Result<&'static str, ExportError> {
        check_inverses(table)?;
        match self {
            Self::Engine(engine) => Ok(engine_textures(engine, table)?.name()),
            Self::Textures { layout, .. } => {
                layout.check(table)?;
                Ok(layout.name())
            }
            Self::Compact(container) => {
                container.check(table)?;
                Ok(table.layout.name())
            }
            Self::Lut(export) => Err(ExportError::LookupTable(export)),
        }
    }

    /// The files, their manifest, and instructions. They depend only on the arguments and the version of this program.
    /// `about` describes the table. This function adds how to sample the textures.
    ///
    /// # Errors
    /// The table does not have these files.
    pub fn bundle(self, table: &Table, about: About) -> Result<Bundle, ExportError> {
        check_inverses(table)?;
        match self {
            Self::Engine(engine) => {
                let layout = engine_textures(engine, table)?;
                let textures = layout.textures(table)?;
                let made = engine.bundle(table.brdf(), &textures, &described(about, table, layout));
                let made = made.map(|bundle| with_search(bundle, table));
                made.map_err(|source| match source {
                    TextureFileError::Missing { .. } => {
                        let recipe = recipe_like(layout.sampling().recipe, table.layout(), true, table);
                        ExportError::Sizes { source: Box::new(source), recipe }
                    }
                    other => ExportError::Files(other),
                })
            }
            Self::Textures { layout, container, precision } => {
                let textures = layout.textures(table)?;
                let about = described(about.of_layout(layout.name()), table, layout);
                let files = container.files(STEM, &textures, precision, &about).map_err(ExportError::Files)?;
                let bundle = with_search(Bundle { files, steps: steps(layout) }, table);
                Ok(bundle.with_manifest(MANIFEST_KEY, &self.to_string(), &about))
            }
            Self::Compact(container) => {
                container.check(table)?;
                let forms = encode_lobes(table).map_err(CompactFileError::Form)?;
                Self::compact_bundle(container, forms.into_iter().map(|encoded| encoded.bytes).collect(), &about)
            }
            Self::Lut(export) => Err(ExportError::LookupTable(export)),
        }
    }

    /// The paths of a table's files. The contents are placeholders with the same formats but other numbers. This takes
    /// a fraction of the time of [`Self::bundle`].
    ///
    /// # Errors
    /// The table does not have these textures.
    pub fn forms(self, table: &Table) -> Result<Vec<TextureFile>, ExportError> {
        let about = About::default();
        let lobes = |bytes: Vec<u8>| vec![bytes; if table.second_matrices().is_some() { 2 } else { 1 }];
        let bundle = match self {
            Self::Engine(engine) => {
                let layout = engine_textures(engine, table)?;
                let about = described(about, table, layout);
                let textures = layout.rules().textures(table)?;
                engine.bundle(table.brdf(), &textures, &about).map_err(ExportError::Files)?
            }
            Self::Textures { layout, container, precision } => {
                layout.check(table)?;
                let about = described(about, table, layout);
                let textures = layout.rules().textures(table)?;
                let files = container.files(STEM, &textures, precision, &about).map_err(ExportError::Files)?;
                Bundle { files, steps: vec![] }.with_manifest(MANIFEST_KEY, &self.to_string(), &about)
            }
            Self::Compact(CompactContainer::Wgsl) => {
                // The module's text depends on numbers that the placeholder bytes do not have.
                let mut bundle = Self::compact_bundle(CompactContainer::Bytes, lobes(COMPACT_MAGIC.to_vec()), &about)?;
                let (path, bytes) = (format!("{STEM}.compact.wgsl"), b"// WGSL".to_vec());
                bundle.files.insert(1, TextureFile { path, bytes, rounding: RoundingError::default() });
                bundle
            }
            Self::Compact(container) => Self::compact_bundle(container, lobes(COMPACT_MAGIC.to_vec()), &about)?,
            Self::Lut(export) => return Err(ExportError::LookupTable(export)),
        };
        Ok(bundle.files)
    }

    /// Like [`Self::bundle`], but from the compact forms of the table's lobes.
    ///
    /// # Errors
    /// The bytes are not a compact form.
    pub fn compact_bundle(
        container: CompactContainer,
        forms: Vec<Vec<u8>>,
        about: &About,
    ) -> Result<Bundle, ExportError> {
        let bundle = Bundle { files: container.files_of_lobes(STEM, forms, about)?, steps: container.steps(STEM) };
        Ok(bundle.with_manifest(MANIFEST_KEY, container.name(), about))
    }
}

/// The comment with the sampling of the textures, and with binding 0 if our shader reads them.
fn described(about: About, table: &Table, layout: TextureLayout) -> About {
    let about = about.and(sampling_of(table, layout));
    if layout.is_for_shader() { about.for_shader(&table.shader_axes()) } else { about }
}

/// How to use textures of a layout.
fn steps(layout: TextureLayout) -> Vec<String> {
    if layout.is_for_shader() {
        return shader_steps(layout.sampling().textures.len() == 1);
    }
    let table = layout.sampling().table;
    vec![format!(
        "These are the textures of other renderers. The shader that ltcforge shader --layout {table} writes needs --layout {} instead.",
        TextureLayout::of_shader(table)
    )]
}

/// How to bind textures to the shader that `ltcforge shader` writes.
pub(super) fn shader_steps(is_array: bool) -> Vec<String> {
    let load = if is_array {
        "Load the texture as a 2D array at binding 1 of the shader that ltcforge shader --texture-array writes."
    } else {
        "Load each texture as 3D, in the order of ltc.json, at bindings 1 to 3 of the shader that ltcforge shader writes."
    };
    let uniform = "Binding 0 is ltc_table of ltc.json, in the shader's order: nodes, reading, start, spacing, per_step, texel, roughness, cosines, azimuths; the first two u32, the others f32.";
    [load, uniform].map(str::to_owned).into()
}

/// If the table's recipe lists its nodes, adds the step to use a shader with these nodes.
fn with_search(mut bundle: Bundle, table: &Table) -> Bundle {
    if !table.layout.is_even(&table.axes) {
        let text = "The recipe lists its nodes, so use the shader that ltcforge shader --nodes TABLE writes.";
        bundle.steps.push(text.to_owned());
    }
    bundle
}

/// Rejects matrices without an inverse.
fn check_inverses(table: &Table) -> Result<(), ExportError> {
    let mut singular = table.determinants().enumerate().filter(|(_, x)| *x == 0.0 || !x.is_finite());
    let Some((entry, _)) = singular.next() else { return Ok(()) };
    Err(ExportError::Singular { count: 1 + singular.count(), entry, place: table.place_of(entry) })
}

/// The layout of the textures that an engine needs from a table. Errors that no other recipe can fix come first.
fn engine_textures(engine: Engine, table: &Table) -> Result<TextureLayout, NoTextures> {
    let own = TextureLayout::of_shader(table.layout);
    let layout = engine.layout().map_or(Ok(own), TextureLayout::named)?;
    let checked = layout.check(table);
    let available = if checked.is_ok() { layout.name() } else { own.name() };
    if table.lobe.gaussian().is_some() {
        return Err(NoTextures::OtherLobe { engine: engine.name(), lobe: table.lobe, layout: available });
    }
    if engine.layout().is_some() && !engine.brdfs().contains(&table.brdf()) {
        let known = engine.brdfs().iter().map(|brdf| brdf.name()).collect::<Vec<_>>().join(", ");
        return Err(NoTextures::OtherBrdf { engine: engine.name(), known, brdf: table.brdf(), layout: available });
    }
    checked?;
    Ok(layout)
}

impl fmt::Display for Export {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Engine(engine) => f.write_str(engine.name()),
            Self::Textures { layout, container, precision } => {
                write!(f, "{}.{}.{}", layout.name(), container.name(), precision.name())
            }
            Self::Compact(container) => f.write_str(container.name()),
            Self::Lut(export) => export.fmt(f),
        }
    }
}

impl FromStr for Export {
    type Err = UnknownExport;

    fn from_str(text: &str) -> Result<Self, UnknownExport> {
        let textures = || {
            let mut parts = text.split('.');
            let layout = TextureLayout::from_name(parts.next()?)?;
            let container = TextureContainer::from_name(parts.next()?)?;
            let precision = Precision::from_name(parts.next()?)?;
            parts.next().is_none().then_some(Self::Textures { layout, container, precision })
        };
        let engine = Engine::from_name(text).map(Self::Engine);
        let compact = || CompactContainer::from_name(text).map(Self::Compact);
        let lut = || text.parse().ok().map(Self::Lut);
        engine.or_else(compact).or_else(textures).or_else(lut).ok_or_else(|| UnknownExport(text.to_owned()))
    }
}

#[cfg(test)]
mod tests;
