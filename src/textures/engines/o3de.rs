//! Open 3D Engine, development branch, from copies of the sources.
//!
//! `LtcCommon.cpp` loads `textures/ltc/ltc_mat_lutrgba32f.dds` and `textures/ltc/ltc_amp_lutrg32f.dds` through the
//! asset processor, from `Gems/Atom/Feature/Common/Assets/Textures/LTC`. `Ltc.azsli` samples at roughness and theta /
//! (pi/2), and builds the inverse [1 0 w; 0 z 0; y 0 x] from a texel. It has a constant for half a texel of a 32 x 32
//! texture (`LUT_SIZE`), which must change for textures of another size. `DdsLoader.cpp` reads the Direct3D 10 header.

use super::rules::{FIRST, SECOND, Source, file};
use crate::{bundle::Bundle, containers::dx10, file::TextureFileError};
use ltcforge_fit::Precision;

/// The texture size in the shader.
const SHADER_SIZE: u32 = 32;

pub(super) fn bundle(source: &Source<'_>) -> Result<Bundle, TextureFileError> {
    let size = source.named(FIRST, || "4 channels".to_owned())?.width;
    let matrix = source.square(FIRST, size, Precision::F32)?;
    let terms = source.square(SECOND, size, Precision::F32)?.texture;
    let channels: Vec<&str> = terms.channels.iter().take(2).map(String::as_str).collect();
    let terms = terms.only(&channels)?;
    let terms = source.stored(&terms, Precision::F32)?;
    let files = vec![
        file("ltc_mat_lutrgba32f.dds", dx10(&matrix)?, &[&matrix]),
        file("ltc_amp_lutrg32f.dds", dx10(&terms)?, &[&terms]),
    ];
    let mut steps = vec![
        "Replace both files in Gems/Atom/Feature/Common/Assets/Textures/LTC; the asset processor does the rest."
            .to_owned(),
    ];
    if size != SHADER_SIZE {
        steps.push(format!("Set LUT_SIZE in LtcCoords of Ltc.azsli to {size}.0; the default is {SHADER_SIZE}.0."));
    }
    Ok(Bundle { files, steps })
}
