//! Pictures of docs/textured.md: a dot on spheres and a window on a floor. They show the truth, `normals`, and the way
//! engines read pictures.

use std::{fs, io, path::Path};

use glam::{DMat3, DVec3};
use ltcforge::{
    Preset, Recipe, RecipeDocument as _,
    fit::{Configuration, Sides, Table, math::atan2},
    light::{
        NormalsRule, PolygonLight,
        textured::{LightImage, LightPyramid, Readings, TexturedLight},
    },
    view::picture::{Panel, Picture, caption, grid, srgb},
};
use rayon::prelude::*;

use super::by_engines_reading;
use crate::tables::fitted;

/// Side of a panel in pixels, and of a picture in texels.
const SIDE: usize = 144;
const TEXELS: usize = 64;
/// The tolerance of a pixel's true value: less than a step of eight bits.
const TOLERANCE: f64 = 5e-4;
/// The best width of the engines' read, from the table of docs/textured.md.
const ENGINES_WIDTH: f64 = 1.4;

/// The surface point in a pixel: its tangent frame and its position.
struct Point {
    place: DVec3,
    tangent: DVec3,
    normal: DVec3,
    /// The direction to the camera.
    wo: DVec3,
}

/// A surface as a function of the pixel, and a light.
struct Scene {
    name: &'static str,
    alpha: [f64; 2],
    corners: [DVec3; 4],
    /// The picture's value at u and v.
    texel: fn(f64, f64) -> f64,
    point: fn(f64, f64) -> Option<Point>,
    exposure: f64,
}

fn sphere(x: f64, y: f64) -> Option<Point> {
    let z2 = 1.0 - 1.1 * 1.1 * (x * x + y * y);
    let normal = DVec3::new(1.1 * x, 1.1 * y, z2.max(0.0).sqrt());
    let tangent = DVec3::Y.cross(normal).normalize_or_zero();
    (z2 > 1e-3).then_some(Point { place: normal, tangent, normal, wo: DVec3::Z })
}

/// A floor at a grazing view, 77 to 86 degrees from its normal.
fn floor(x: f64, y: f64) -> Option<Point> {
    let eye = DVec3::new(0.0, 0.5, 4.0);
    let ray = DVec3::new(0.34 * x, -0.155 + 0.075 * y, -1.0);
    (ray.y < 0.0).then(|| {
        let place = eye + ray * (eye.y / -ray.y);
        Point { place, tangent: DVec3::X, normal: DVec3::Y, wo: -ray.normalize() }
    })
}

const LAMP: [DVec3; 4] =
    [DVec3::new(-0.6, 2.2, 1.6), DVec3::new(1.6, 2.2, 1.6), DVec3::new(1.6, 0.9, 3.4), DVec3::new(-0.6, 0.9, 3.4)];
const WALL: [DVec3; 4] =
    [DVec3::new(-0.9, 1.5, -1.5), DVec3::new(0.9, 1.5, -1.5), DVec3::new(0.9, 0.1, -1.5), DVec3::new(-0.9, 0.1, -1.5)];

fn dot(u: f64, v: f64) -> f64 {
    0.05 + 4.0 * f64::from(u8::from((u - 0.5).hypot(v - 0.5) < 0.1))
}

fn window(u: f64, v: f64) -> f64 {
    let (p, q) = ((2.0 * u).fract(), (3.0 * v).fract());
    f64::from(u8::from((0.08..0.92).contains(&p) && (0.08..0.92).contains(&q)))
}

const SCENES: [Scene; 3] = [
    Scene { name: "alpha .35", alpha: [0.35, 0.35], corners: LAMP, texel: dot, point: sphere, exposure: 3.0 },
    Scene { name: "alpha .5, .06", alpha: [0.06, 0.5], corners: LAMP, texel: dot, point: sphere, exposure: 3.0 },
    Scene { name: "alpha .12, .05", alpha: [0.05, 0.12], corners: WALL, texel: window, point: floor, exposure: 1.0 },
];

/// Draws the scenes and writes them as a PNG file.
///
/// # Errors
/// The file cannot be written, or preset `draft` is not a recipe.
pub fn write(path: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let table = fitted(&Recipe::builder().preset(Preset::Draft).build()?);
    let drawn: Vec<[Picture; 3]> = SCENES.iter().map(|scene| panels(scene, &table)).collect();
    let titles = ["the truth", "normals, 4 readings", "as engines read"];
    let panels: Vec<Panel<'_>> = SCENES
        .iter()
        .zip(drawn)
        .flat_map(|(scene, drawn)| {
            let foot = caption(SIDE as u32, &[scene.name]);
            titles.iter().zip(drawn).map(move |(title, picture)| Panel { title, picture, foot: foot.clone() })
        })
        .collect();
    let bytes = grid(&panels, 3).png().map_err(io::Error::other)?;
    Ok(fs::write(path, bytes)?)
}

/// The scene, for each method.
fn panels(scene: &Scene, table: &Table) -> [Picture; 3] {
    let texel = |i: usize| {
        let [u, v] = [i % TEXELS, i / TEXELS].map(|x| (x as f64 + 0.5) / TEXELS as f64);
        [(scene.texel)(u, v) as f32; 3]
    };
    let image = LightImage::new(TEXELS, TEXELS, (0..TEXELS * TEXELS).map(texel).collect()).expect("an image");
    let [a, b, _, d] = scene.corners;
    let pyramid = LightPyramid::new(&image.resampled(image.square_size([(b - a).length(), (d - a).length()])));
    let pixel = |i: usize| {
        let at = |x: usize| (x as f64 + 0.5) / (SIDE as f64 / 2.0) - 1.0;
        let Some(point) = (scene.point)(at(i % SIDE), -at(i / SIDE)) else { return [0.0; 3] };
        let to_frame = DMat3::from_cols(point.tangent, point.normal.cross(point.tangent), point.normal).transpose();
        let wo = to_frame * point.wo;
        let [alpha_x, alpha_y] = scene.alpha;
        let theta = atan2(wo.truncate().length(), wo.z);
        let at = Configuration { alpha_x, alpha_y, theta, phi: atan2(wo.y, wo.x) };
        let corners = scene.corners.map(|corner| to_frame * (corner - point.place)).to_vec();
        let light = PolygonLight::new(corners, Sides::Two).and_then(TexturedLight::new).expect("a rectangle");
        let truth = light.truth(&at, &image, TOLERANCE).expect("a broad lobe").energy[0];
        let how = (NormalsRule::Balanced, Readings::Four);
        let normals = light.by_normals(&at, &pyramid, how).expect("a surface").energy[0];
        [truth, normals, by_engines_reading(table, &at, &light, &pyramid, ENGINES_WIDTH).energy[0]]
    };
    let pixels: Vec<[f64; 3]> = (0..SIDE * SIDE).into_par_iter().map(pixel).collect();
    [0, 1, 2].map(|way| {
        let rgb = pixels.iter().map(|pixel| [srgb((pixel[way] * scene.exposure) as f32); 3]).collect();
        Picture { width: SIDE as u32, height: SIDE as u32, rgb }
    })
}
