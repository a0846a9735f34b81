//! Twins of shader functions, in f32 as on a GPU.

use glam::Mat3;
use ltcforge::{
    fit::{Clip, Configuration, Sides, Table, math::direction},
    light::{
        CosineSpace, NormalsRule,
        textured::{
            LightPyramid, Reading, Readings, TexturedLight, TexturedReflection, colour, ltc_readings, normals_readings,
        },
    },
};

/// The corners of a light, relative to the shaded point.
fn corners(light: &TexturedLight) -> [[f32; 3]; 4] {
    [0, 1, 2, 3].map(|i| light.polygon().vertices()[i].as_vec3().to_array())
}

/// The parts of a light, coloured by reads of its picture. The rounding of a sampler is not included.
fn coloured(parts: [f32; 2], readings: &[Reading<f32>], pyramid: &LightPyramid) -> TexturedReflection {
    let readings: Vec<Reading<f64>> = readings
        .iter()
        .map(|Reading { uv, radius, weight }| Reading {
            uv: uv.map(f64::from),
            radius: f64::from(*radius),
            weight: f64::from(*weight),
        })
        .collect();
    let colour = colour(&readings, pyramid);
    let [energy, fresnel] = parts.map(|part| colour.map(|channel| f64::from(part) * channel));
    TexturedReflection { energy, fresnel }
}

/// Twin of `normals_textured_rectangle`.
pub(super) fn by_normals(
    at: &Configuration,
    light: &TexturedLight,
    pyramid: &LightPyramid,
    how: (NormalsRule, Readings),
) -> TexturedReflection {
    let alpha = [at.alpha_x, at.alpha_y].map(|alpha| alpha as f32);
    let wo = direction(at.theta, at.phi).as_vec3().to_array();
    let (parts, readings) = normals_readings(alpha, wo, &corners(light), light.polygon().sides(), how);
    coloured(parts, &readings, pyramid)
}

/// Twin of `ltc_textured_rectangle`, with the terms of the table.
///
/// # Panics
/// The table has no terms, or an entry is not an LTC.
pub(super) fn by_table(
    table: &Table,
    at: &Configuration,
    light: &TexturedLight,
    pyramid: &LightPyramid,
    number: Readings,
) -> TexturedReflection {
    let found = table.lookup(at);
    let [amplitude, fresnel] = [found.amplitude, found.fresnel].map(|term| term.expect("a term") as f32);
    // `ltc_inverse` returns the adjugate divided by its largest number.
    let m = Mat3::from_cols_array(&found.matrix.map(|x| x as f32)).transpose();
    let rows = [m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis)];
    let largest = rows.iter().map(|row| row.abs().max_element()).fold(0.0, f32::max);
    let side = m.determinant().signum();
    let space = CosineSpace::new(rows.map(|row| (row * (side / largest)).to_array()));
    let corners = corners(light);
    let [a, b, c, d] = corners.map(|corner| space.of(corner));
    let mut clip = Clip::begin(d);
    for vertex in [a, b, c, d] {
        clip.edge_to(vertex);
    }
    let covered = side * clip.finish();
    let covered = if light.polygon().sides() == Sides::Two { covered.abs() } else { covered }.clamp(0.0, 1.0);
    coloured([amplitude, fresnel].map(|term| term * covered), &ltc_readings(&space, &corners, number), pyramid)
}
