//! Tests pictures on lights that extend below the surface, for tables whose lobes end at the surface.

use std::ops::ControlFlow;

use glam::DVec3;

use ltcforge_files::recipe_document;
use ltcforge_fit::{Configuration, Plan, Sides, fit_plan};
use ltcforge_light::{
    PolygonLight, TableUse,
    cases::Draw,
    textured::{LightImage, LightPyramid, Readings, TexturedLight},
};

/// Side of the picture in texels.
const SIDE: usize = 48;

/// Squares, a ramp, and a lower half that is brighter than the upper half.
fn picture() -> Vec<[f32; 3]> {
    let texel = |i: usize| {
        let [x, y] = [i % SIDE, i / SIDE];
        let square = f32::from(u8::from((x / 6 + y / 6).is_multiple_of(2)));
        [square, x as f32 / SIDE as f32, if y < SIDE / 2 { 0.2 } else { 1.0 }]
    };
    (0..SIDE * SIDE).map(texel).collect()
}

/// An upright light across the view, with the first `rows` rows of its picture.
fn light([distance, width, texel]: [f64; 3], above: usize, rows: usize) -> (TexturedLight, LightImage) {
    let [top, bottom] = [above as f64 * texel, (above as f64 - rows as f64) * texel];
    let corner = |y: f64, z: f64| DVec3::new(distance, y * width, z);
    let corners = vec![corner(0.5, top), corner(-0.5, top), corner(-0.5, bottom), corner(0.5, bottom)];
    let light = PolygonLight::new(corners, Sides::One).expect("a polygon");
    let image = LightImage::new(SIDE, rows, picture()[..SIDE * rows].to_vec()).expect("an image");
    (TexturedLight::new(light).expect("a rectangle"), image)
}

/// If a table's lobes end at the surface, cropping a light at the surface reduces the error. Without cropping, the
/// prefilter would blur the picture's part below the surface into the part above.
#[test]
fn cropping_pictures_at_the_surface_reduces_the_error() {
    let recipe = recipe_document::parse(br#"{"preset": "draft"}"#, u64::MAX).expect("a recipe");
    let table = fit_plan(&Plan::new(&recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it");
    let used = (TableUse { cut: true, blend: false }, Readings::Four);
    let mut draw = Draw::new(4411);
    let (mut sums, mut count) = ([0.0_f64; 2], 0.0);
    for _ in 0..300 {
        let at = Configuration {
            alpha_x: draw.within(0.08, 0.5),
            alpha_y: draw.within(0.08, 0.5),
            theta: draw.within(1.0, 1.55),
            phi: std::f64::consts::PI + draw.within(-0.3, 0.3),
        };
        let rows = 12 + draw.within(0.0, 30.0) as usize;
        let size = [1.0, draw.within(0.5, 2.0), draw.within(0.01, 0.04)];
        let lights = [SIDE, rows].map(|count| light(size, rows, count));
        let found = lights.each_ref().map(|(light, image)| {
            let pyramid = LightPyramid::new(&image.resampled(image.square_size(light.size())));
            light.by_table(&table, &at, &pyramid, used).expect("a light").energy
        });
        let (light, image) = &lights[0];
        let truth = light.truth(&at, image, 1e-4).expect("a light").energy;
        for channel in 0..3 {
            for (sum, found) in sums.iter_mut().zip(&found) {
                *sum += (found[channel] - truth[channel]).abs();
            }
            count += 1.0;
        }
    }
    let [whole, cropped] = sums.map(|sum| sum / count);
    println!("mean error {whole:.4}; with the light cropped at the surface {cropped:.4}");
    assert!(cropped < 0.8 * whole && whole < 2.0 * cropped, "{whole} {cropped}");
}
