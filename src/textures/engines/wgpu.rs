//! Your own renderer, with the shader that `ltcforge shader` writes. The textures have the table's layout and are KTX2
//! files. A JSON file has the contents of the shader's buffers.

use serde_json::json;

use super::rules::{Source, file};
use crate::{
    bundle::Bundle,
    containers::ktx2,
    file::{TextureFile, TextureFileError},
    rounding::RoundingError,
};
use ltcforge_fit::Precision;

pub(super) fn bundle(source: &Source<'_>) -> Result<Bundle, TextureFileError> {
    for name in ["ltc_matrix_a", "ltc_matrix_b", "ltc_terms"] {
        source.named(name, || "the three 3D textures of the shader".to_owned())?;
    }
    let mut files = Vec::new();
    for texture in source.textures {
        let stored = source.stored(texture, Precision::F32)?;
        files.push(file(&format!("{}.ktx2", texture.name), ktx2(&stored, false, source.about)?, &[&stored]));
    }
    let axes = source.axes;
    let document = json!({
        "textures": files.iter().map(|file| &file.path).collect::<Vec<_>>(),
        "ltc_table": {
            "nodes": axes.nodes,
            "reading": axes.reading,
            "start": axes.start,
            "spacing": axes.step,
            "per_step": axes.per_step,
            "texel": axes.texel,
            "roughness": axes.roughness,
            "cosines": axes.cosines,
            "azimuths": axes.azimuths,
        },
        "about": source.about.lines(),
    });
    let bytes = format!("{document:#}\n").into_bytes();
    files.push(TextureFile { path: "ltc.json".to_owned(), bytes, rounding: RoundingError::default() });
    let steps = [
        "Load each texture as 3D, in the order of ltc.json, at bindings 1 to 3 of the shader that ltcforge shader writes.",
        "Binding 0 is ltc_table of ltc.json, in the shader's order: nodes, reading, start, spacing, per_step, texel, roughness, cosines, azimuths; the first two u32, the others f32.",
    ];
    Ok(Bundle { files, steps: steps.map(str::to_owned).into() })
}
