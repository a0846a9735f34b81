//! three.js, as of 0.187.0 (npm).
//!
//! `WebGLLights` reads `UniformsLib.LTC_FLOAT_1` and `_2`, or `LTC_HALF_1` and `_2` where the device does not filter 32-bit
//! textures; `RectAreaLightNode.setLTC` takes an object with the same four. Both sample at roughness and
//! sqrt(1 - cos theta), with the half texel of 64 x 64 written into the shader.

use super::rules::{Bundle, EngineRules, FIRST, SECOND, SIZE, Source, file};
use crate::{
    files::textures::{containers::constant, file::TextureFileError},
    fit::Precision,
};

/// three.js.
pub(super) struct Rules;

/// Makes the four textures with the classes of the page's own three.js.
const FUNCTION: &str = "
// The four textures, made with the classes of THREE, the namespace of the three.js that renders:
//     import * as THREE from 'three';
//     RectAreaLightUniformsLib.init();
//     Object.assign( THREE.UniformsLib, createLTC( THREE ) );   // WebGLRenderer
//     RectAreaLightNode.setLTC( createLTC( THREE ) );           // WebGPURenderer
export function createLTC( THREE ) {
	const texture = ( data, type ) => {
		const made = new THREE.DataTexture( data, SIZE, SIZE, THREE.RGBAFormat, type );
		made.wrapS = made.wrapT = THREE.ClampToEdgeWrapping;
		made.magFilter = made.minFilter = THREE.LinearFilter;
		made.generateMipmaps = false;
		made.needsUpdate = true;
		return made;
	};
	return {
		LTC_FLOAT_1: texture( FLOAT_1, THREE.FloatType ),
		LTC_FLOAT_2: texture( FLOAT_2, THREE.FloatType ),
		LTC_HALF_1: texture( HALF_1, THREE.HalfFloatType ),
		LTC_HALF_2: texture( HALF_2, THREE.HalfFloatType ),
	};
}
";

impl EngineRules for Rules {
    fn layout(&self) -> Option<&'static str> {
        Some("ltc2017")
    }

    fn bundle(&self, source: &Source<'_>) -> Result<Bundle, TextureFileError> {
        let mut text = format!("{}\nconst SIZE = {SIZE};\n", source.about.comment());
        let mut all = Vec::new();
        for (kind, precision) in [("FLOAT", Precision::F32), ("HALF", Precision::F16)] {
            for (place, name) in [(1, FIRST), (2, SECOND)] {
                let stored = source.square(name, SIZE, precision)?;
                text += &constant(&format!("{kind}_{place}"), &stored);
                all.push(stored);
            }
        }
        text += FUNCTION;
        let all: Vec<_> = all.iter().collect();
        let steps = [
            "Import createLTC from ltc.js beside three.js (checked with 0.187).",
            "WebGLRenderer: after RectAreaLightUniformsLib.init(), Object.assign( THREE.UniformsLib, createLTC( THREE ) ).",
            "WebGPURenderer: RectAreaLightNode.setLTC( createLTC( THREE ) ).",
        ];
        Ok(Bundle { files: vec![file("ltc.js", text.into_bytes(), &all)], steps: steps.map(str::to_owned).into() })
    }
}
