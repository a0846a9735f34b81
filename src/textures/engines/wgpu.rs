//! Your own renderer, with the shader that `ltcforge shader` writes. The textures have the table's layout and are KTX2
//! files. A JSON file has the contents of the shader's buffers.

use half::f16;

use super::rules::Source;
use crate::{
    bundle::Bundle,
    containers::TextureContainer,
    export::{STEM, shader_steps},
    file::TextureFileError,
};
use ltcforge_fit::Precision;

/// 32-bit textures. If all numbers of the table are halves, the textures have 16 bits.
pub(super) fn bundle(source: &Source<'_>) -> Result<Bundle, TextureFileError> {
    let is_half = |x: &f32| f16::from_f32_const(*x).to_f32_const().to_bits() == x.to_bits();
    let are_halves = source.textures.iter().all(|texture| texture.texels.iter().all(is_half));
    stored_as(source, if are_halves { Precision::F16 } else { Precision::F32 })
}

/// 16-bit textures.
pub(super) fn half_bundle(source: &Source<'_>) -> Result<Bundle, TextureFileError> {
    stored_as(source, Precision::F16)
}

fn stored_as(source: &Source<'_>, precision: Precision) -> Result<Bundle, TextureFileError> {
    for name in ["ltc_matrix_a", "ltc_matrix_b", "ltc_terms"] {
        source.named(name, || "the three 3D textures of the shader".to_owned())?;
    }
    let files = TextureContainer::Ktx2.files(STEM, source.textures, precision, source.about)?;
    Ok(Bundle { files, steps: shader_steps(false) })
}
