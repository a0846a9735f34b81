//! The shaders' twin: the same arithmetic in the same order, in f32, on all cores.
//!
//! `lookup` is the twin of `ltc_table.wgsl`, `light` of `ltc_light.wgsl`, `ggx` of `ggx_reference.wgsl`, `solids` of
//! `reference_solids.wgsl`, `textured` of `light_picture.wgsl` and `preview_textured.wgsl`, and `surface` of `sphere.wgsl`. The formulas of models `normals`, `sg` and `asg` and of a
//! table's disks, spheres and tubes are those of `ltcforge_light` in f32. The shaders have the comments. `any_brdf` has
//! no shader: it is the reference of models other than GGX.

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

/// The `extent` pixels from `corner` on, as radiance.
pub(super) fn render(
    frame: &Frame,
    table: &ShaderTable,
    estimator: Estimator,
    corner: [u32; 2],
    extent: [u32; 2],
) -> Radiances {
    let [width, height] = extent;
    // A part of one row is for all cores too.
    let pixels = (0..width * height).into_par_iter().map(|index| {
        let [x, y] = [index % width, index / width];
        surface::pixel(frame, table, estimator, [corner[0] + x, corner[1] + y])
    });
    Radiances { width, pixels: pixels.collect() }
}

/// Whether a table's nodes surround a roughness as the lookup folds it. Outside them it takes the nearest.
pub(super) fn covers(table: &ShaderTable, alpha_x: f32, alpha_y: f32) -> bool {
    /// A quotient of f32 numbers may be off a node that it stands for by this part of it.
    const ROUNDING: f32 = 1e-6;
    let (x, y) = (alpha_x.max(lookup::LEAST_ALPHA), alpha_y.max(lookup::LEAST_ALPHA));
    let is_within =
        |first: f32, last: f32, value: f32| (first * (1.0 - ROUNDING)..=last * (1.0 + ROUNDING)).contains(&value);
    let [alpha, most_alpha, ratio, most_ratio] = table.axes.roughness;
    is_within(alpha, most_alpha, x.max(y)) && is_within(ratio, most_ratio, x.min(y) / x.max(y))
}
