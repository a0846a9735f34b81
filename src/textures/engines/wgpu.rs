//! A renderer with the shader that `ltcforge shader` writes: the textures of the table's own layout as KTX2, and what
//! the shader's buffers hold as JSON.

use serde_json::json;

use super::rules::{EngineRules, Source, file};
use crate::{
    bundle::Bundle,
    containers::ktx2,
    file::{TextureFile, TextureFileError},
    rounding::RoundingError,
};
use ltcforge_fit::Precision;

/// A renderer of one's own.
pub(super) struct Wgpu;

impl EngineRules for Wgpu {
    fn layout(&self) -> Option<&'static str> {
        None
    }

    fn bundle(&self, source: &Source<'_>) -> Result<Bundle, TextureFileError> {
        for name in ["ltc_matrix_a", "ltc_matrix_b", "ltc_terms"] {
            source.named(name, || "the three 3D textures of our shader".to_owned())?;
        }
        let mut files = Vec::new();
        for texture in source.textures {
            let stored = source.stored(texture, Precision::F32)?;
            files.push(file(&format!("{}.ktx2", texture.name), ktx2(&stored, false, source.about)?, &[&stored]));
        }
        let single = |nodes: &[f64]| nodes.iter().map(|node| *node as f32).collect::<Vec<f32>>();
        let nodes = source.axes.named().map(|(name, nodes)| (name.to_owned(), json!(single(nodes))));
        let counts = source.axes.named().map(|(_, nodes)| nodes.len());
        let turns = source.axes.ratio == [1.0] && source.axes.phi.len() == 1;
        let document = json!({
            "textures": files.iter().map(|file| &file.path).collect::<Vec<_>>(),
            "ltc_table": { "nodes": counts, "reading": [0, u32::from(turns), 0, 0] },
            "ltc_nodes": serde_json::Map::from_iter(nodes),
            "about": source.about.lines(),
        });
        let bytes = format!("{document:#}\n").into_bytes();
        files.push(TextureFile { path: "ltc.json".to_owned(), bytes, rounding: RoundingError::default() });
        let steps = [
            "Load each texture as 3D, in the order of ltc.json, at bindings 2 to 4 of the shader that ltcforge shader writes.",
            "Binding 0 is ltc_table of ltc.json; binding 1 the lists of ltc_nodes one after another: alpha, ratio, theta, phi.",
        ];
        Ok(Bundle { files, steps: steps.map(str::to_owned).into() })
    }
}
