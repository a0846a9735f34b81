//! Lookup tables as files of engines and as textures.

use std::{
    fmt::{self, Write as _},
    ops::ControlFlow::Continue,
    str::FromStr,
};

use super::{
    About, Bundle, Engine, TextureContainer, TextureFileError,
    containers::{Stored, ktx2, numbers, stored},
    engines::file,
    export::MANIFEST_KEY,
    texture::Texture,
};
use ltcforge_files::{container::LutFile, digest::Digest, recipe_document};
use ltcforge_fit::{
    Precision,
    albedo::{
        CosineAxis, DfgForm, Lut, LutAxes, LutKind, LutPlan, LutRecipe, LutReport, MeasuredLut, RoughnessAxis, Texels,
        fit_lut,
    },
};

/// The engines that load a `dfg` table.
const ENGINES: [Engine; 2] = [Engine::Three, Engine::Bevy];
/// Both engines read scale and bias at perceptual roughness and cosine, without a correction for texel centres.
const AXES: LutAxes =
    LutAxes { roughness: RoughnessAxis::Perceptual, cos_theta: CosineAxis::Cosine, texels: Texels::Centres };

/// A set of files that can be made from a lookup table: an engine, or a container and a precision with a dot between,
/// such as `ktx2.f16`. Without a precision it is f32.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LutExport {
    /// The files of an engine.
    Engine(Engine),
    /// Textures with the parameters of the table.
    Textures {
        /// The format of the files.
        container: TextureContainer,
        /// The number format.
        precision: Precision,
    },
}

/// The lookup table does not have these files.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LutExportError {
    /// The engine has no lookup table of this kind.
    #[error(
        "{engine} loads no file of table {table}; engines that load a dfg table: {}; other formats: {}",
        listed(&ENGINES), listed(TextureContainer::ALL)
    )]
    Engine {
        /// The engine.
        engine: Engine,
        /// The kind of the table.
        table: LutKind,
    },
    /// The name is not an export of lookup tables.
    #[error(
        "«{}» is not an export of a lookup table; allowed: {}, or container.precision, such as ktx2.f16, with containers {}",
        .0.escape_debug(), listed(&ENGINES), listed(TextureContainer::ALL)
    )]
    Unknown(String),
    /// The format cannot store the texture.
    #[error(transparent)]
    File(#[from] TextureFileError),
}

fn listed<T: fmt::Display>(all: &[T]) -> String {
    all.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

impl fmt::Display for LutExport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Engine(engine) => f.write_str(engine.name()),
            Self::Textures { container, precision } => write!(f, "{container}.{precision}"),
        }
    }
}

impl FromStr for LutExport {
    type Err = LutExportError;

    fn from_str(text: &str) -> Result<Self, LutExportError> {
        let textures = || {
            let (container, precision) = text.split_once('.').unwrap_or((text, Precision::F32.name()));
            let container = TextureContainer::from_name(container)?;
            Some(Self::Textures { container, precision: Precision::from_name(precision)? })
        };
        let engine = Engine::from_name(text).map(Self::Engine);
        engine.or_else(textures).ok_or_else(|| LutExportError::Unknown(text.to_owned()))
    }
}

impl LutExport {
    /// The exports of a table.
    pub fn all(recipe: &LutRecipe) -> impl Iterator<Item = Self> {
        let engines = ENGINES.into_iter().map(Self::Engine);
        let textures = TextureContainer::ALL.iter().flat_map(|&container| {
            Precision::ALL.iter().map(move |&precision| Self::Textures { container, precision })
        });
        let recipe = *recipe;
        engines.chain(textures).filter(move |export| export.recipe(&recipe).is_ok())
    }

    /// The recipe of the table in the files: the table itself, or the same values with the engine's parameters.
    ///
    /// # Errors
    /// The engine has no such table.
    pub fn recipe(self, recipe: &LutRecipe) -> Result<LutRecipe, LutExportError> {
        match self {
            Self::Engine(engine) if ENGINES.contains(&engine) && recipe.table == LutKind::Dfg => {
                Ok(LutRecipe { axes: AXES, form: Some(DfgForm::Karis), precision: Precision::F16, ..*recipe })
            }
            Self::Engine(engine) => Err(LutExportError::Engine { engine, table: recipe.table }),
            Self::Textures { .. } => Ok(*recipe),
        }
    }

    /// The files of a lookup table, their manifest, and instructions. For an engine with other parameters, the texels
    /// are solved again. Runs on the current rayon pool.
    ///
    /// # Errors
    /// The engine has no such table, or the format cannot store it.
    pub fn bundle(self, of: &LutFile, digest: Digest) -> Result<Bundle, LutExportError> {
        let recipe = self.recipe(&of.recipe)?;
        let other = if recipe == of.recipe { None } else { fit_lut(&LutPlan::new(&recipe), &|_| Continue(())) };
        let file = LutFile { recipe, lut: other.unwrap_or_else(|| of.lut.clone()) };
        let report = MeasuredLut::new(&recipe).report(&file.lut);
        bundle(self, &file, digest, recipe_document::canonical_json(&of.recipe), &report)
    }
}

/// The files of a lookup table that has the parameters of the export.
fn bundle(
    export: LutExport,
    of: &LutFile,
    source: Digest,
    document: String,
    report: &LutReport,
) -> Result<Bundle, LutExportError> {
    let LutFile { recipe, lut } = of;
    let error = &report.stored;
    let error = format!(
        "{} x {} texels; error after linear filtering, alpha from .002, cosine from .01: mean {:.5}, p95 {:.5}, max {:.5}",
        recipe.resolution.roughness, recipe.resolution.cos_theta, error.mean, error.p95, error.max
    );
    let about = About::of_lut(source, document, error);
    let bundle = match export {
        LutExport::Engine(Engine::Three) => three(recipe, lut, &about)?,
        LutExport::Engine(_) => {
            let texture = texture("dfg", recipe, lut)?;
            let stored = one(&texture, Precision::F16)?;
            let steps = [
                "Built in: replace crates/bevy_pbr/src/environment_map/dfg.ktx2 in Bevy's sources (feature dfg_lut).",
                "At run time: insert the handle of dfg.ktx2 as DfgLut { texture } into the render world.",
                "The table for area lights is ltc.ktx2: ltcforge export LTC_TABLE --for bevy.",
            ];
            let files = vec![file("dfg.ktx2", ktx2(&stored, true, &about)?, &[&stored])];
            Bundle { files, steps: steps.map(str::to_owned).into() }
        }
        LutExport::Textures { container, precision } => plain(container, precision, recipe, lut, &about)?,
    };
    let key = if matches!(export, LutExport::Engine(_)) { "for" } else { MANIFEST_KEY };
    Ok(bundle.with_manifest(key, &export.to_string(), &about))
}

/// three.js 0.185: `src/renderers/shaders/DFGLUTData.js` exports `getDFGLUT`. Roughness is along x, the cosine along y.
fn three(recipe: &LutRecipe, lut: &Lut, about: &About) -> Result<Bundle, LutExportError> {
    let (rows, columns) = (recipe.resolution.roughness as usize, recipe.resolution.cos_theta as usize);
    let swapped = (0..columns).flat_map(|column| (0..rows).map(move |row| 2 * (row * columns + column)));
    let texels: Vec<f32> = swapped.flat_map(|at| [lut.texels[at], lut.texels[at + 1]]).collect();
    let size = [recipe.resolution.roughness, recipe.resolution.cos_theta];
    let texture = Texture::flat("dfg", size, recipe.channels(), texels).map_err(TextureFileError::from)?;
    let stored = one(&texture, Precision::F16)?;
    let mut text = about.comment();
    // Writing to a String cannot fail.
    let _ = write!(
        text,
        "\nimport {{ DataTexture }} from '../../textures/DataTexture.js';\n\
         import {{ RGFormat, HalfFloatType, LinearFilter, ClampToEdgeWrapping }} from '../../constants.js';\n\n\
         const DATA = new Uint16Array( [\n{}] );\n\n\
         let lut = null;\n\n\
         export function getDFGLUT() {{\n\n\
         \tif ( lut !== null ) return lut;\n\n\
         \tlut = new DataTexture( DATA, {rows}, {columns}, RGFormat, HalfFloatType, undefined, ClampToEdgeWrapping, \
         ClampToEdgeWrapping, LinearFilter, LinearFilter );\n\
         \tlut.name = 'DFG_LUT';\n\tlut.generateMipmaps = false;\n\tlut.needsUpdate = true;\n\treturn lut;\n\n}}\n",
        numbers(&stored, |x| x.to_string())
    );
    let steps = [
        "Replace src/renderers/shaders/DFGLUTData.js in three.js's sources (0.185), and build it.",
        "The tables for area lights are in ltc.js: ltcforge export LTC_TABLE --for three.",
    ];
    let files = vec![file("DFGLUTData.js", text.into_bytes(), &[&stored])];
    Ok(Bundle { files, steps: steps.map(str::to_owned).into() })
}

/// Textures in any format: the cosine along x, roughness along y, smooth surfaces first.
fn plain(
    container: TextureContainer,
    precision: Precision,
    recipe: &LutRecipe,
    lut: &Lut,
    about: &About,
) -> Result<Bundle, LutExportError> {
    let name = recipe.table.name();
    let mut textures = vec![texture(name, recipe, lut)?];
    if let Some(average) = &lut.average {
        let size = [recipe.resolution.roughness, 1];
        textures.push(Texture::flat("average", size, &["average"], average.clone()).map_err(TextureFileError::from)?);
    }
    let files = container.files(name, &textures, precision, about)?;
    let LutAxes { roughness, cos_theta, texels } = recipe.axes;
    let mut steps = vec![format!("The axis x is the view ({cos_theta}), y is roughness ({roughness}), from 0 up.")];
    steps.push(match texels {
        Texels::Centres => "Sample at the parameters themselves, with linear filtering and clamped edges.".to_owned(),
        Texels::Corners => {
            "Sample at (parameter * (n - 1) + 0.5) / n for n texels, with linear filtering and clamped edges."
                .to_owned()
        }
    });
    Ok(Bundle { files, steps })
}

fn texture(name: &str, recipe: &LutRecipe, lut: &Lut) -> Result<Texture, LutExportError> {
    let size = [recipe.resolution.cos_theta, recipe.resolution.roughness];
    Ok(Texture::flat(name, size, recipe.channels(), lut.texels.clone()).map_err(TextureFileError::from)?)
}

fn one(texture: &Texture, precision: Precision) -> Result<Stored<'_>, LutExportError> {
    Ok(stored(std::slice::from_ref(texture), precision)?.pop().ok_or(TextureFileError::Empty)?)
}

#[cfg(test)]
mod tests;
