//! Lookup tables as files of engines and as textures.

mod engines;

use std::{fmt, ops::ControlFlow::Continue, str::FromStr};

pub use self::engines::LutEngine;
use super::{
    About, Bundle, TextureContainer, TextureFile, TextureFileError, export::MANIFEST_KEY, rounding::RoundingError,
    texture::Texture,
};
use ltcforge_files::{container::LutFile, digest::Digest, recipe_document};
use ltcforge_fit::{
    Precision,
    albedo::{Lut, LutKind, LutPlan, LutPrecision, LutRecipe, MeasuredLut, Texels, fit_lut},
};

/// A set of files that can be made from a lookup table: an engine, `png`, or a container and a precision with a dot
/// between, such as `ktx2.f16`. Without a precision it is f32.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LutExport {
    /// The files of an engine.
    Engine(LutEngine),
    /// Pictures with the parameters of the table: 8 bits for precision `rgba8`, otherwise 16.
    Png,
    /// Textures with the parameters of the table.
    Textures {
        /// The format of the files.
        container: TextureContainer,
        /// The number format.
        precision: Precision,
    },
}

/// The name of the export of pictures.
pub const PNG: &str = "png";

/// The lookup table does not have these files.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LutExportError {
    /// The engine has no lookup table of this kind, or a picture too few axes.
    #[error("{export} has no file of table {table}; {}: {}", of_kind(*table), formats(*table))]
    Kind {
        /// The export.
        export: LutExport,
        /// The kind of the table.
        table: LutKind,
    },
    /// The name is not an export of lookup tables.
    #[error(
        "lookup tables have no export «{}»; engines: {}; formats: {}, each except png also with a precision, such as ktx2.f16",
        .0.escape_debug(), listed(LutEngine::ALL), formats(LutKind::Dfg)
    )]
    Unknown(String),
    /// The format cannot store the texture.
    #[error(transparent)]
    File(#[from] TextureFileError),
}

fn listed<T: fmt::Display>(all: &[T]) -> String {
    all.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// The formats for tables of a kind.
fn formats(table: LutKind) -> String {
    let png = if table.axes().len() == 2 { format!("{PNG}, ") } else { String::new() };
    png + &listed(TextureContainer::ALL)
}

/// The engines that load tables of a kind, before the list of formats.
fn of_kind(table: LutKind) -> String {
    let engines: Vec<_> = LutEngine::ALL.iter().copied().filter(|engine| engine.loads(table)).collect();
    if engines.is_empty() {
        "no engine export has one; use a container".to_owned()
    } else {
        format!("engines that load such a table: {}; other formats", listed(&engines))
    }
}

impl fmt::Display for LutExport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Engine(engine) => f.write_str(engine.name()),
            Self::Png => f.write_str(PNG),
            Self::Textures { container, precision } => write!(f, "{container}.{precision}"),
        }
    }
}

impl FromStr for LutExport {
    type Err = LutExportError;

    fn from_str(text: &str) -> Result<Self, LutExportError> {
        let default = format!("{text}.{}", Precision::F32);
        let export = Self::every().find(|export| [text, &default].contains(&&*export.to_string()));
        export.ok_or_else(|| LutExportError::Unknown(text.to_owned()))
    }
}

impl LutExport {
    fn every() -> impl Iterator<Item = Self> {
        let engines = LutEngine::ALL.iter().map(|&engine| Self::Engine(engine));
        let textures = TextureContainer::ALL.iter().flat_map(|&container| {
            Precision::ALL.iter().map(move |&precision| Self::Textures { container, precision })
        });
        engines.chain([Self::Png]).chain(textures)
    }

    /// The exports of a table.
    pub fn all(recipe: &LutRecipe) -> impl Iterator<Item = Self> {
        Self::every().filter(move |export| export.recipe(recipe).is_ok())
    }

    /// The recipe of the table in the files: the table itself, or the same values with the engine's parameters.
    ///
    /// # Errors
    /// The engine has no such table.
    pub fn recipe(self, recipe: &LutRecipe) -> Result<LutRecipe, LutExportError> {
        let recipe_of_files = match self {
            Self::Engine(engine) => engine.recipe(recipe),
            Self::Png if recipe.table.axes().len() > 2 => None,
            Self::Png | Self::Textures { .. } => Some(*recipe),
        };
        recipe_of_files.ok_or(LutExportError::Kind { export: self, table: recipe.table })
    }

    /// The files of a lookup table, their manifest, and instructions. For an engine with other parameters, the texels
    /// are solved again. Runs on the current rayon pool.
    ///
    /// # Errors
    /// The engine has no such table, or the format cannot store it.
    pub fn bundle(self, of: &LutFile, digest: Digest) -> Result<Bundle, LutExportError> {
        let recipe = self.recipe(&of.recipe)?;
        let lut = if recipe == of.recipe { of.lut.clone() } else { fitted(&recipe) };
        let error = MeasuredLut::new(&recipe).error(&lut.texels);
        let error = format!("{} texels; error after linear filtering: {error}", recipe.resolution);
        let about = About::of_lut(digest, recipe_document::canonical_json(&of.recipe), error);
        let (key, bundle) = match self {
            Self::Engine(engine) => ("for", engine.bundle(&recipe, lut, &about)?),
            Self::Png => (MANIFEST_KEY, pictures(&recipe, &lut)),
            Self::Textures { container, precision } => {
                (MANIFEST_KEY, plain(container, precision, &recipe, &lut, &about)?)
            }
        };
        Ok(bundle.with_manifest(key, &self.to_string(), &about))
    }
}

fn fitted(recipe: &LutRecipe) -> Lut {
    // Nothing stops it.
    fit_lut(&LutPlan::new(recipe), &|_| Continue(())).unwrap_or(Lut { texels: vec![], average: None })
}

/// Textures in any format: the last axis along x, the axis before along y, smooth surfaces first.
fn plain(
    container: TextureContainer,
    precision: Precision,
    recipe: &LutRecipe,
    lut: &Lut,
    about: &About,
) -> Result<Bundle, LutExportError> {
    let name = recipe.table.name();
    let mut files = container.files(name, &[texture(name, recipe, lut.texels.clone())?], precision, about)?;
    if let Some(average) = &lut.average {
        // Halves near one are too coarse for the average.
        let size = [recipe.resolution.texels()[0], 1];
        let average = Texture::flat("average", size, &["average"], average.clone()).map_err(TextureFileError::from)?;
        files.extend(container.files("average", &[average], Precision::F32, about)?);
    }
    Ok(Bundle { files, steps: sampling(recipe).into() })
}

/// Pictures of 8 or 16 bits: red, green and blue are the channels. The average of an albedo is a file of 32-bit numbers.
fn pictures(recipe: &LutRecipe, lut: &Lut) -> Bundle {
    let name = recipe.table.name();
    let texel = |texel: &[f32]| [0, 1, 2].map(|i| texel.get(i).copied().unwrap_or(0.0));
    let numbers = lut.texels.chunks(recipe.channels().len()).flat_map(texel);
    let (depth, bytes): (_, Vec<u8>) = if recipe.precision == LutPrecision::Rgba8 {
        (png::BitDepth::Eight, numbers.map(byte).collect())
    } else {
        let words = numbers.map(|x| (x.clamp(0.0, 1.0) * 65_535.0).round() as u16);
        (png::BitDepth::Sixteen, words.flat_map(u16::to_be_bytes).collect())
    };
    let axes = recipe.resolution.texels();
    let picture = png([axes[1], axes[0]], png::ColorType::Rgb, depth, &bytes);
    let mut files = vec![unrounded(&format!("{name}.png"), picture)];
    if let Some(average) = &lut.average {
        files.push(unrounded("average.bin", average.iter().flat_map(|x| x.to_le_bytes()).collect()));
    }
    let mut steps: Vec<String> = sampling(recipe).into();
    steps.push("The numbers are linear, from 0 to 1: load the picture without a colour space.".to_owned());
    Bundle { files, steps }
}

/// The nearest of 255 steps from 0 to 1.
fn byte(x: f32) -> u8 {
    (x.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// A PNG without a colour space. Domain: bytes for all pixels.
fn png([width, height]: [u32; 2], colour: png::ColorType, depth: png::BitDepth, bytes: &[u8]) -> Vec<u8> {
    let mut out = vec![];
    let mut encoder = png::Encoder::new(&mut out, width, height);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    // Writing to memory cannot fail, and the number of bytes is right.
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(bytes));
    debug_assert!(written.is_ok(), "{written:?}");
    out
}

fn unrounded(path: &str, bytes: Vec<u8>) -> TextureFile {
    TextureFile { path: path.to_owned(), bytes, rounding: RoundingError::default() }
}

/// How to sample a table with its own parameters.
fn sampling(recipe: &LutRecipe) -> [String; 2] {
    let names = recipe.axis_names();
    let axes = if let [alpha, ratio, theta, phi] = names.as_slice() {
        let rows = format!("y is the texel of {ratio} times the texels of theta, plus that of {theta}");
        format!("The axis x is {phi}, {rows}, z is {alpha}, as in layout reflected. Read two ratios and blend them.")
    } else {
        let axes = names.iter().rev().zip(["x", "y", "z"]).map(|(name, axis)| format!("{axis} is {name}"));
        format!("Axes, from 0 up: {}.", axes.collect::<Vec<_>>().join(", "))
    };
    let texels = match recipe.texels() {
        Texels::Centres => "Sample at the parameters themselves, with linear filtering and clamped edges.".to_owned(),
        Texels::Corners => {
            "Sample at (parameter * (n - 1) + 0.5) / n for n texels, with linear filtering and clamped edges."
                .to_owned()
        }
    };
    [axes, texels]
}

fn texture(name: &str, recipe: &LutRecipe, texels: Vec<f32>) -> Result<Texture, TextureFileError> {
    let size = match *recipe.resolution.texels() {
        [alpha, ratio, theta, phi] => [phi, ratio * theta, alpha],
        [ior, roughness, cosine] => [cosine, roughness, ior],
        ref axes => [axes[1], axes[0], 1],
    };
    Ok(Texture::new(name, size, 1, recipe.channels(), texels)?)
}

#[cfg(test)]
mod tests;
