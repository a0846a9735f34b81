//! CPU twins of the shaders' entry points for tests.

use super::*;

/// The lookup: `M` in row-major order, the amplitude, the Fresnel term, and a zero.
pub(in crate::preview) fn looked_up(table: &ShaderTable, alpha: [f32; 4], wo: [f32; 4]) -> [f32; 12] {
    let [x, y, z, _] = wo;
    let lobe = lookup::lookup(table, alpha[0], alpha[1], glam::Vec3::new(x, y, z));
    let [a, b, c, d, e, f, g, h, i] = lobe.matrix.transpose().to_cols_array();
    [a, b, c, d, e, f, g, h, i, lobe.amplitude, lobe.fresnel, 0.0]
}

/// The second matrix by rows, and the first row of the blend for F0 = 0.04.
pub(in crate::preview) fn looked_up_second(table: &ShaderTable, alpha: [f32; 4], wo: [f32; 4]) -> [f32; 12] {
    let [x, y, z, _] = wo;
    let (first, second) = lookup::lookup_both(table, alpha[0], alpha[1], glam::Vec3::new(x, y, z));
    let [a, b, c, d, e, f, g, h, i] = second.transpose().to_cols_array();
    let blend = lookup::blend(&first, second, 0.04, 1.0);
    [a, b, c, d, e, f, g, h, i, blend.x_axis.x, blend.y_axis.y, blend.z_axis.z]
}

/// Twin of `ltc_example`: M, the amplitude, the Fresnel term, and the part of the lobe that a one-sided polygon covers.
pub(in crate::preview) fn lit(
    table: &ShaderTable,
    alpha_x: f32,
    alpha_y: f32,
    wo: glam::Vec3,
    vertices: &[glam::Vec3],
) -> (glam::Mat3, [f32; 3]) {
    let lobe = lookup::lookup(table, alpha_x, alpha_y, wo);
    (lobe.matrix, [lobe.amplitude, lobe.fresnel, covered(lobe.matrix, vertices, false)])
}

/// `gaussians_table_example`: the reflected light of a one-sided polygon.
pub(in crate::preview) fn lit_by_gaussian(
    table: &ShaderTable,
    gaussian: ltcforge_light::Gaussian,
    alpha: [f32; 2],
    wo: glam::Vec3,
    vertices: &[[f32; 3]],
) -> [f32; 2] {
    surface::lit_by_gaussian(table, gaussian, alpha, wo, vertices, ltcforge_fit::Sides::One)
}

/// `ltc_polygon` with the inverse of `m`.
pub(in crate::preview) fn covered(m: glam::Mat3, vertices: &[glam::Vec3], two_sided: bool) -> f32 {
    light::Inverse::of(m).covered(&polygon(vertices, two_sided), glam::Vec3::ZERO, glam::Mat3::IDENTITY)
}

/// `ltc_cut_polygon` with the inverse of `m`.
pub(in crate::preview) fn covered_above(m: glam::Mat3, vertices: &[glam::Vec3], two_sided: bool) -> f32 {
    light::Inverse::of(m).covered_above(&polygon(vertices, two_sided), glam::Vec3::ZERO, glam::Mat3::IDENTITY)
}

fn polygon(vertices: &[glam::Vec3], two_sided: bool) -> super::super::frame::FrameLight {
    super::super::frame::FrameLight {
        vertices: vertices.to_vec(),
        area_up_to: Vec::new(),
        shape: super::super::frame::FrameShape::Polygon,
        normal: glam::Vec3::Z,
        area: 0.0,
        radiance: 1.0,
        two_sided,
    }
}

/// `ltc_disk`, `ltc_sphere`, `ltc_tube` and `ltc_line` with the inverse of `m`, for a centre, two half axes and `size`.
pub(in crate::preview) fn shapes_covered(m: glam::Mat3, [centre, x, y]: [glam::Vec3; 3], size: f32) -> [f32; 4] {
    let Some(space) = light::Inverse::of(m).cosine_space(glam::Mat3::IDENTITY) else { return [0.0; 4] };
    let ends = [centre - x, centre + x];
    [
        space.ellipse(centre, [x, y], ltcforge_fit::Sides::Two),
        space.sphere(centre, size),
        space.tube(ends, size),
        space.line(ends, size),
    ]
}

/// `ltc_cut_disk`, `ltc_cut_sphere`, `ltc_cut_tube` and `ltc_cut_line` with the same arguments as [`shapes_covered`].
pub(in crate::preview) fn shapes_covered_above(m: glam::Mat3, [centre, x, y]: [glam::Vec3; 3], size: f32) -> [f32; 4] {
    let Some(space) = light::Inverse::of(m).cosine_space(glam::Mat3::IDENTITY) else { return [0.0; 4] };
    let (above, ends) = (space.above_surface(), [centre - x, centre + x]);
    [
        above.ellipse(centre, [x, y], ltcforge_fit::Sides::Two),
        above.sphere(centre, size),
        above.tube(ends, size),
        above.line(ends, size),
    ]
}
