//! The shaders' twin: the same arithmetic in the same order, in f32, on all cores.
//!
//! `lookup` is the twin of `ltc_table.wgsl`, `light` of `ltc_light.wgsl`, `ggx` of `ggx_reference.wgsl`, `solids` of
//! `reference_solids.wgsl`, and `surface` of `sphere.wgsl`. The formulas of models `normals`, `sg` and `asg` and of a
//! table's disks, spheres and tubes are those of `ltcforge_light` in f32. The shaders have the comments. `any_brdf` has
//! no shader: it is the reference of models other than GGX.

mod any_brdf;
mod ggx;
mod light;
mod lookup;
mod solids;
mod surface;

use rayon::prelude::*;

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

/// The lookup alone: `M`, row-major, amplitude, Fresnel term, and a zero.
#[cfg(test)]
pub(super) fn looked_up(table: &ShaderTable, alpha: [f32; 4], wo: [f32; 4]) -> [f32; 12] {
    let [x, y, z, _] = wo;
    let lobe = lookup::lookup(table, alpha[0], alpha[1], glam::Vec3::new(x, y, z));
    let [a, b, c, d, e, f, g, h, i] = lobe.matrix.transpose().to_cols_array();
    [a, b, c, d, e, f, g, h, i, lobe.amplitude, lobe.fresnel, 0.0]
}

/// `ltc_example`: M, and the amplitude, the Fresnel term and the part of the lobe that a one-sided polygon covers.
#[cfg(test)]
pub(super) fn lit(
    table: &ShaderTable,
    alpha_x: f32,
    alpha_y: f32,
    wo: glam::Vec3,
    vertices: &[glam::Vec3],
) -> (glam::Mat3, [f32; 3]) {
    let lobe = lookup::lookup(table, alpha_x, alpha_y, wo);
    (lobe.matrix, [lobe.amplitude, lobe.fresnel, covered(lobe.matrix, vertices, false)])
}

/// `gaussians_table_example`: the reflection of a one-sided polygon.
#[cfg(test)]
pub(super) fn lit_by_gaussian(
    table: &ShaderTable,
    gaussian: ltcforge_light::Gaussian,
    alpha: [f32; 2],
    wo: glam::Vec3,
    vertices: &[[f32; 3]],
) -> [f32; 2] {
    surface::lit_by_gaussian(table, gaussian, alpha, wo, vertices, ltcforge_fit::Sides::One)
}

/// `ltc_polygon` with the inverse of `m`.
#[cfg(test)]
pub(super) fn covered(m: glam::Mat3, vertices: &[glam::Vec3], two_sided: bool) -> f32 {
    let light = super::frame::FrameLight {
        vertices: vertices.to_vec(),
        area_up_to: Vec::new(),
        shape: super::frame::FrameShape::Polygon,
        normal: glam::Vec3::Z,
        area: 0.0,
        radiance: 1.0,
        two_sided,
    };
    light::Inverse::of(m).covered(&light, glam::Vec3::ZERO, glam::Mat3::IDENTITY)
}

/// `ltc_disk`, `ltc_sphere`, `ltc_tube` and `ltc_line` with the inverse of `m`: of a centre and two half axes, and of
/// `size`.
#[cfg(test)]
pub(super) fn shapes_covered(m: glam::Mat3, [centre, x, y]: [glam::Vec3; 3], size: f32) -> [f32; 4] {
    let Some(space) = light::Inverse::of(m).cosine_space(glam::Mat3::IDENTITY) else { return [0.0; 4] };
    let ends = [centre - x, centre + x];
    [
        space.ellipse(centre, [x, y], ltcforge_fit::Sides::Two),
        space.sphere(centre, size),
        space.tube(ends, size),
        space.line(ends, size),
    ]
}

/// Whether a table's nodes surround a roughness as the lookup folds it. Outside them it takes the nearest.
pub(super) fn covers(table: &ShaderTable, alpha_x: f32, alpha_y: f32) -> bool {
    /// A quotient of f32 numbers may be off a node that it stands for by this part of it.
    const ROUNDING: f32 = 1e-6;
    let (x, y) = (alpha_x.max(lookup::LEAST_ALPHA), alpha_y.max(lookup::LEAST_ALPHA));
    let is_within = |nodes: &[f32], value: f32| {
        let [Some(first), Some(last)] = [nodes.first(), nodes.last()] else { return false };
        (first * (1.0 - ROUNDING)..=last * (1.0 + ROUNDING)).contains(&value)
    };
    is_within(&table.nodes.alpha, x.max(y)) && is_within(&table.nodes.ratio, x.min(y) / x.max(y))
}

/// Where a lobe's picture shows a direction, in pixels; `None` on the far side of the sphere of directions.
pub(super) fn place_of_direction(frame: &Frame, w: glam::Vec3) -> Option<[f32; 2]> {
    surface::place_of_direction(frame, w)
}

/// The cell whose surface covers a pixel, at least in part.
pub(super) fn covering(frame: &Frame, pixel: [u32; 2]) -> Option<usize> {
    surface::covering(frame, pixel)
}
