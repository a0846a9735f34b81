//! The CPU twin of the shaders: the same arithmetic in the same order, in f32, on all cores.
//!
//! `lookup` is the twin of `ltc_table.wgsl`, `light` of `ltc_light.wgsl`, `ggx` of `ggx_reference.wgsl`, `solids` of
//! `reference_solids.wgsl`, `textured` of `light_picture.wgsl` and `preview_textured.wgsl`, and `surface` of
//! `sphere.wgsl`. `ltcforge_light` has the formulas, in f32, of models `normals`, `ltc-formula`, `sg` and `asg`, and
//! of the light from disks, spheres and tubes by an LTC. Comments are in the shaders. `any_brdf` has no shader: it is the reference for
//! models other than GGX.

mod any_brdf;
mod ggx;
mod light;
mod lookup;
mod solids;
mod surface;
#[cfg(test)]
pub(super) mod tests;
mod textured;

use rayon::prelude::*;

pub(super) use self::surface::{covering, place_of_direction};

use super::{Radiances, ShaderTable, estimator::Estimator, frame::Frame};

/// Renders a part of the picture as radiance. `corner` is its upper left pixel, and `extent` its size.
pub(super) fn render(
    frame: &Frame,
    table: &ShaderTable,
    estimator: Estimator,
    corner: [u32; 2],
    extent: [u32; 2],
) -> Radiances {
    let [width, height] = extent;
    // The loop is parallel over pixels, not rows: even a part of one row uses all cores.
    let pixels = (0..width * height).into_par_iter().map(|index| {
        let [x, y] = [index % width, index / width];
        surface::pixel(frame, table, estimator, [corner[0] + x, corner[1] + y])
    });
    Radiances { width, pixels: pixels.collect() }
}

/// Whether a table's nodes surround a roughness, after the lookup has folded it. Outside the nodes the lookup uses the
/// nearest node.
pub(super) fn covers(table: &ShaderTable, alpha_x: f32, alpha_y: f32) -> bool {
    /// The relative rounding error of an f32 quotient that should equal a node.
    const ROUNDING: f32 = 1e-6;
    let (x, y) = (alpha_x.max(lookup::LEAST_ALPHA), alpha_y.max(lookup::LEAST_ALPHA));
    let is_within =
        |first: f32, last: f32, value: f32| (first * (1.0 - ROUNDING)..=last * (1.0 + ROUNDING)).contains(&value);
    let [alpha, most_alpha, ratio, most_ratio] = table.axes.roughness;
    is_within(alpha, most_alpha, x.max(y)) && is_within(ratio, most_ratio, x.min(y) / x.max(y))
}
