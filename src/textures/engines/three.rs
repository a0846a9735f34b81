//! three.js 0.187.0 (npm).
//!
//! `WebGLLights` reads `UniformsLib.LTC_FLOAT_1` and `_2`, or `LTC_HALF_1` and `_2` if the device does not filter
//! 32-bit textures. `RectAreaLightNode.setLTC` takes an object with the same four textures. Both sample at roughness
//! and sqrt(1 - cos theta). Their shaders have a constant for half a texel of a 64 x 64 texture.
//!
//! The module contains the 32-bit numbers once. For each number, one bit selects one of its two neighbouring halves.

use base64::{Engine as _, prelude::BASE64_STANDARD};
use half::f16;

use super::rules::{SIZE, Source, file};
use crate::{bundle::Bundle, containers::Stored, file::TextureFileError};
use ltcforge_fit::Precision;

/// The function that creates the four textures, with the classes of the page's three.js.
const FUNCTION: &str = include_str!("create_ltc.js");

pub(super) fn bundle(source: &Source<'_>) -> Result<Bundle, TextureFileError> {
    let (floats, halves) = (source.both(Precision::F32)?, source.both(Precision::F16)?);
    let [numbers, farther] = [sorted_bytes(&floats), farther_bits(&floats, &halves)];
    let [numbers, farther] = [numbers, farther].map(|bytes| BASE64_STANDARD.encode(bytes));
    let about = source.about.comment();
    let text = format!(
        "{about}\nconst SIZE = {SIZE};\nconst NUMBERS = '{numbers}';\nconst FARTHER = '{farther}';\n\n{FUNCTION}"
    );
    let all: Vec<_> = floats.iter().chain(&halves).collect();
    let steps = [
        "Import createLTC from ltc.js next to three.js (checked with 0.187).",
        "WebGLRenderer: after RectAreaLightUniformsLib.init(), Object.assign( THREE.UniformsLib, createLTC( THREE ) ).",
        "WebGPURenderer: import { RectAreaLightNode } from 'three/webgpu', and call RectAreaLightNode.setLTC( createLTC( THREE ) ).",
    ];
    Ok(Bundle { files: vec![file("ltc.js", text.into_bytes(), &all)], steps: steps.map(str::to_owned).into() })
}

/// The bytes of all numbers: first the lowest byte of each number, last the highest. For each of the four bytes, the
/// numbers are in the order of textures and channels.
fn sorted_bytes(textures: &[Stored<'_>]) -> Vec<u8> {
    let mut sorted = Vec::new();
    for byte in 0..4 {
        for stored in textures {
            for channel in 0..4 {
                let numbers = stored.rounded.numbers.iter().skip(channel).step_by(4);
                sorted.extend(numbers.map(|x| x.to_le_bytes()[byte]));
            }
        }
    }
    sorted
}

/// One bit per number, starting with the lowest bit. It is set if the half is the neighbour farther from zero.
fn farther_bits(floats: &[Stored<'_>], halves: &[Stored<'_>]) -> Vec<u8> {
    let pairs = floats.iter().zip(halves).flat_map(|(floats, halves)| {
        floats.rounded.numbers.iter().zip(halves.rounded.half_bits()).map(|(x, half)| half != half_nearer_to_zero(*x))
    });
    let bits: Vec<bool> = pairs.collect();
    let byte = |bits: &[bool]| bits.iter().enumerate().fold(0, |byte, (i, bit)| byte | u8::from(*bit) << i);
    bits.chunks(8).map(byte).collect()
}

/// The bits of the largest half whose magnitude does not exceed that of the number.
fn half_nearer_to_zero(x: f32) -> u16 {
    let nearest = f16::from_f32_const(x);
    // The bits of a half grow with its magnitude. Infinity follows 65504.
    nearest.to_bits() - u16::from(nearest.to_f32_const().abs() > x.abs())
}
