//! Writes the files of a prefiltered picture.

use half::f16;
use ltcforge_fit::{Precision, named_list};
use ltcforge_light::textured::{LightImage, LightPyramid};

use super::shared_exponent::{self, pack, unpack};
use crate::{
    About, Texture, TextureContainer, TextureFile, TextureFileError,
    containers::{KTX2_IDENTIFIER, Ktx2File, Sample, float_samples, vk_format},
};

named_list! {
    /// The format of a prefiltered picture's texels.
    pub enum LightTexels {
        /// Halves: red, green, blue, and in KTX2 an alpha of one, because GPUs have no texels with three halves.
        Rgba16f = "rgba16f",
        /// Three numbers of nine bits and a shared exponent. Half the size of `rgba16f`. Only in KTX2.
        Rgb9e5 = "rgb9e5",
        /// Floats: red, green, blue, and in KTX2 an alpha of one.
        Rgba32f = "rgba32f",
    }
}

/// A file of a prefiltered picture.
#[derive(Debug, Clone, PartialEq)]
pub struct LightTextureFile {
    /// The name of the file.
    pub name: String,
    /// The bytes of the file.
    pub bytes: Vec<u8>,
}

/// The files, with their rounding errors.
#[derive(Debug, Clone, PartialEq)]
pub struct LightTextureFiles {
    /// The files: a single file, or one file for each level, the finest first.
    pub files: Vec<LightTextureFile>,
    /// The largest change of a channel, divided by the largest channel of its texel. Texels below 2^-14 and texels with
    /// clamped numbers are excluded.
    pub error: f64,
    /// The number of values above the format's largest value. They were clamped to it.
    pub clamped: u64,
}

/// Smaller texels are excluded from the error: below 2^-14, halves have fewer than 11 bits.
const SMALL: f32 = 6.103_515_6e-5;

/// The KTX2 key and value for the direction of rows and columns.
const ORIENTATION: (&str, &str) = ("KTXorientation", "rd");

/// The flag of the exponent, the encoding of one, and the bias and the largest value of the exponent, in a descriptor
/// for RGB9E5 [Khronos Data Format Specification 1.3, section 16.4].
const EXPONENT: u8 = 0x20;
const ONE_OF_RGB9E5: u32 = 8448;
const EXPONENT_RANGE: [u32; 2] = [15, 31];
const VK_FORMAT_E5B9G9R9: u32 = 123;

/// Writes the files of a picture. `ktx2` and `ktx2-zstd` write one file `NAME.ktx2` with all levels. Other containers
/// write one texture per level, and `NAME_0` is the finest. Domain: `name` has 1 to 60 ASCII letters, digits and
/// underscores, and starts with a letter.
///
/// # Errors
/// The container cannot store these texels.
pub fn light_texture_files(
    name: &str,
    pyramid: &LightPyramid,
    container: TextureContainer,
    texels: LightTexels,
    about: &About,
) -> Result<LightTextureFiles, TextureFileError> {
    let levels = pyramid.levels();
    let (error, clamped) = change(levels, texels);
    let files = match container {
        TextureContainer::Ktx2 | TextureContainer::Ktx2Zstd => {
            let file = ktx2(levels, texels, container == TextureContainer::Ktx2Zstd);
            let pairs = [(ORIENTATION.0, ORIENTATION.1.to_owned()), ("ltcforge", about.lines().join("\n"))];
            let bytes = file.bytes(&pairs).map_err(|bytes| {
                unsupported(name, container, "metadata", format!("{bytes} bytes long"), "less than 4 GiB")
            })?;
            vec![LightTextureFile { name: format!("{name}.ktx2"), bytes }]
        }
        _ => {
            let precision = match texels {
                // The container cannot store three 16-bit channels.
                LightTexels::Rgba16f if matches!(container, TextureContainer::Dds | TextureContainer::DdsDx10) => {
                    return Err(unsupported(name, container, "texels", texels.name().to_owned(), "rgba32f"));
                }
                LightTexels::Rgba16f => Precision::F16,
                LightTexels::Rgba32f => Precision::F32,
                LightTexels::Rgb9e5 => {
                    return Err(unsupported(name, container, "texels", texels.name().to_owned(), "rgba16f, rgba32f"));
                }
            };
            let texture = |(i, level): (usize, &LightImage)| {
                let size = [level.width() as u32, level.height() as u32];
                let texels = level.texels().as_flattened().to_vec();
                Texture::flat(format!("{name}_{i}"), size, &["R", "G", "B"], texels)
            };
            let textures = levels.iter().enumerate().map(texture).collect::<Result<Vec<_>, _>>()?;
            let files = container.files(name, &textures, precision, about)?;
            files.into_iter().map(|TextureFile { path, bytes, .. }| LightTextureFile { name: path, bytes }).collect()
        }
    };
    Ok(LightTextureFiles { files, error, clamped })
}

/// Whether a file starts like KTX2, the usual container for pictures.
#[must_use]
pub fn is_light_texture(start: &[u8]) -> bool {
    start.starts_with(&KTX2_IDENTIFIER)
}

fn unsupported(
    name: &str,
    container: TextureContainer,
    field: &'static str,
    value: String,
    allowed: &str,
) -> TextureFileError {
    let (name, allowed) = (name.to_owned(), allowed.to_owned());
    TextureFileError::Unsupported { name, field, value, container: container.name(), allowed }
}

/// A texel, rounded as the format stores it.
fn rounded(texel: [f32; 3], texels: LightTexels) -> [f32; 3] {
    match texels {
        LightTexels::Rgba16f => texel.map(|x| half_of(x).to_f32_const()),
        LightTexels::Rgb9e5 => unpack(pack(texel)),
        LightTexels::Rgba32f => texel,
    }
}

/// The nearest half. Numbers above the largest half become the largest half.
fn half_of(x: f32) -> f16 {
    f16::from_f32_const(x.min(f16::MAX.to_f32_const()))
}

/// The rounding errors of texels, as in [`LightTextureFiles`].
fn change(levels: &[LightImage], format: LightTexels) -> (f64, u64) {
    let most = match format {
        LightTexels::Rgba16f => f16::MAX.to_f32_const(),
        LightTexels::Rgb9e5 => shared_exponent::LARGEST,
        LightTexels::Rgba32f => f32::MAX,
    };
    let (mut error, mut clamped) = (0.0_f64, 0);
    for texel in levels.iter().flat_map(LightImage::texels) {
        clamped += texel.iter().filter(|x| **x > most).count() as u64;
        let largest = texel[0].max(texel[1]).max(texel[2]);
        if (SMALL..=most).contains(&largest) {
            for (x, y) in texel.iter().zip(rounded(*texel, format)) {
                error = error.max(f64::from((x - y).abs() / largest));
            }
        }
    }
    (error, clamped)
}

/// One file with all levels.
fn ktx2(levels: &[LightImage], texels: LightTexels, zstd: bool) -> Ktx2File {
    let (vk_format, number_bytes, texel_bytes, samples) = match texels {
        LightTexels::Rgba16f => (vk_format(4, Precision::F16), 2, 8, float_samples(4, 2)),
        LightTexels::Rgba32f => (vk_format(4, Precision::F32), 4, 16, float_samples(4, 4)),
        LightTexels::Rgb9e5 => (VK_FORMAT_E5B9G9R9, 4, 4, shared_exponent_samples()),
    };
    let bytes = |level: &LightImage| -> Vec<u8> {
        let all = level.texels().iter();
        match texels {
            LightTexels::Rgba16f => {
                all.flat_map(|[r, g, b]| [*r, *g, *b, 1.0]).flat_map(|x| half_of(x).to_le_bytes()).collect()
            }
            LightTexels::Rgba32f => all.flat_map(|[r, g, b]| [*r, *g, *b, 1.0]).flat_map(f32::to_le_bytes).collect(),
            LightTexels::Rgb9e5 => all.flat_map(|texel| pack(*texel).to_le_bytes()).collect(),
        }
    };
    let sizes = [levels[0].width() as u32, levels[0].height() as u32, 0, 0];
    Ktx2File { vk_format, number_bytes, texel_bytes, samples, sizes, levels: levels.iter().map(bytes).collect(), zstd }
}

/// Each channel, followed by the shared exponent.
fn shared_exponent_samples() -> Vec<Sample> {
    let channel = |channel: u8| {
        let number = Sample { bit_offset: 9 * u16::from(channel), bits: 9, channel, range: [0, ONE_OF_RGB9E5] };
        [number, Sample { bit_offset: 27, bits: 5, channel: channel | EXPONENT, range: EXPONENT_RANGE }]
    };
    (0..3).flat_map(channel).collect()
}
