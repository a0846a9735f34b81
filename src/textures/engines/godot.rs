//! Godot with `AreaLight3D`, from copies of the sources.
//!
//! `servers/rendering/storage/make_ltc_lut.py` compiles two DDS files into the engine. It skips the first 148 bytes of
//! each file, the Direct3D 10 header. Then 64 x 64 texels of four 32-bit numbers follow.

use super::rules::{Source, file};
use crate::{bundle::Bundle, containers::dx10, file::TextureFileError};
use ltcforge_fit::Precision;

pub(super) fn bundle(source: &Source<'_>) -> Result<Bundle, TextureFileError> {
    let [first, second] = source.both(Precision::F32)?;
    let files = vec![file("ltc_lut1.dds", dx10(&first)?, &[&first]), file("ltc_lut2.dds", dx10(&second)?, &[&second])];
    let steps = [
        "Replace ltc_lut1.dds and ltc_lut2.dds in servers/rendering/storage/ltc of Godot's sources.",
        "Build the engine: it cannot load tables at run time.",
    ];
    Ok(Bundle { files, steps: steps.map(str::to_owned).into() })
}
