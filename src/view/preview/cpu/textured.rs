//! Twin of `light_picture.wgsl` and `preview_textured.wgsl`.

use glam::{Mat3, Vec2, Vec3};

use super::{
    ggx::{ColouredParts, Shaded},
    light::Inverse,
};
use crate::preview::{frame::Frame, light_picture::LightPicture};
use ltcforge_fit::Sides;
use ltcforge_light::{
    NormalsRule,
    textured::{LightImage, Reading, colour as colour_of, ltc_readings, normals_readings},
};

const RAYS: u8 = 4;

/// The point where a ray meets the light's plane, in picture coordinates from 0 to 1, and its distance.
fn met(frame: &Frame, start: Vec3, ray: Vec3) -> (Vec2, f32) {
    let light = &frame.light;
    let corner = light.vertices[0];
    let (x, y) = (light.vertices[1] - corner, light.vertices[3] - corner);
    let away = light.normal.dot(corner - start) / light.normal.dot(ray);
    let p = start + away * ray - corner;
    (Vec2::new(p.dot(x) / x.dot(x), p.dot(y) / y.dot(y)), away)
}

fn texel(image: &LightImage, uv: Vec2) -> Vec3 {
    let place = |part: f32, count: usize| ((part.clamp(0.0, 1.0) * count as f32) as usize).min(count - 1);
    Vec3::from(image.row(place(uv.y, image.height()))[place(uv.x, image.width())])
}

/// The colour of the picture where the ray from `position` along `wi` meets the light. White without a picture.
pub(super) fn colour(frame: &Frame, position: Vec3, wi: Vec3) -> Vec3 {
    frame.picture.as_ref().map_or(Vec3::ONE, |picture| texel(&picture.image, met(frame, position, wi).0))
}

/// The part of a pixel that the light covers where it is nearer than `behind`: its radiance and its share.
pub(super) fn light_in(frame: &Frame, place: Vec2, behind: f32) -> (Vec3, f32) {
    let Some(picture) = &frame.picture else { return (Vec3::ZERO, 0.0) };
    let (mut sum, mut covered) = (Vec3::ZERO, 0.0);
    for (ray, uv) in rays(frame, place, behind) {
        let emits = frame.light.faces(frame.light.normal.dot(ray));
        sum += if emits { frame.light.radiance * texel(&picture.image, uv) } else { Vec3::ZERO };
        covered += 1.0;
    }
    let all = f32::from(RAYS * RAYS);
    (sum / all, covered / all)
}

/// Whether the light covers any part of a pixel.
pub(super) fn covers(frame: &Frame, place: Vec2, behind: f32) -> bool {
    frame.picture.is_some() && rays(frame, place, behind).next().is_some()
}

/// The rays of a pixel that hit the light, with the points that they hit.
fn rays(frame: &Frame, place: Vec2, behind: f32) -> impl Iterator<Item = (Vec3, Vec2)> {
    let pixel = 2.0 / (frame.size / frame.cells) as f32;
    (0..RAYS * RAYS).filter_map(move |i| {
        let offset = (Vec2::new(f32::from(i % RAYS), f32::from(i / RAYS)) + 0.5) / f32::from(RAYS) - 0.5;
        let at = place + pixel * offset;
        let ray = (frame.forward + frame.right * at.x + frame.up * at.y).normalize();
        let (uv, away) = met(frame, frame.eye, ray);
        let is_within = uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all();
        (away > 0.0 && away < behind && is_within).then_some((ray, uv))
    })
}

/// The corners of the light, relative to a point of the surface and in its tangent frame.
fn corners(frame: &Frame, at: &Shaded) -> [[f32; 3]; 4] {
    let to_local = Mat3::from_cols(at.x, at.y, at.z).transpose();
    [0, 1, 2, 3].map(|i| (to_local * (frame.light.vertices[i] - at.position)).to_array())
}

fn colour_at(picture: &LightPicture, readings: &[Reading<f32>]) -> Vec3 {
    let readings: Vec<Reading<f64>> = readings
        .iter()
        .map(|reading| Reading {
            uv: reading.uv.map(f64::from),
            radius: reading.radius.into(),
            weight: reading.weight.into(),
        })
        .collect();
    Vec3::from(colour_of(&readings, &picture.pyramid).map(|channel| channel as f32))
}

/// The mean colour of the picture, weighted by a lobe.
pub(super) fn colour_by_lobe(frame: &Frame, picture: &LightPicture, inverse: &Inverse, at: &Shaded) -> Vec3 {
    let space = inverse.cosine_space(Mat3::IDENTITY);
    let readings = space.map(|space| ltc_readings(&space, &corners(frame, at), picture.readings)).unwrap_or_default();
    colour_at(picture, &readings)
}

/// The reflected light of the picture, by model `normals`.
pub(super) fn by_normals(frame: &Frame, picture: &LightPicture, rule: NormalsRule, at: &Shaded) -> ColouredParts {
    let sides = if frame.light.two_sided { Sides::Two } else { Sides::One };
    let how = (rule, picture.readings);
    let (parts, readings) = normals_readings(at.alpha.to_array(), at.wo.to_array(), &corners(frame, at), sides, how);
    ColouredParts::coloured(Vec2::from(parts), colour_at(picture, &readings))
}
