//! Mode `shadows`: occluders on the surface, lit by few samples, in f64 on the CPU.
//!
//! All surfaces, including the occluders, use the first material. The panels are the truth, one sample by solid angle, one
//! sample where the surface reflects the light, and four such samples that scale the closed form.

use glam::{DMat3, DVec3, Vec3};
use rayon::prelude::*;

use super::{Radiances, Scene, Surface, estimator::Stop, frame::Frame};
use ltcforge_fit::{
    Configuration, Sides,
    brdf::{Brdf, Ggx},
    math::{Lattice, atan2, sin_cos},
};
use ltcforge_light::{PolygonLight, by_normals, sample::LightSampler, shadow::Occluder};

/// The titles of the panels, and shorter ones.
pub(super) const TITLES: [[&str; 2]; 4] = [
    ["truth", "truth"],
    ["1 sample, solid angle", "solid angle"],
    ["1 sample, this sampler", "sampler"],
    ["4 samples x closed form", "closed form"],
];

/// The occluders on a floor, and in front of a sphere.
const ON_FLOOR: [Occluder; 3] = [
    Occluder::Sphere { centre: DVec3::new(-0.55, 0.35, -0.3), radius: 0.35 },
    Occluder::Sphere { centre: DVec3::new(0.05, 0.16, 0.55), radius: 0.16 },
    Occluder::Box { low: DVec3::new(0.35, 0.0, -0.75), high: DVec3::new(0.75, 0.8, -0.35) },
];
const BEFORE_SPHERE: [Occluder; 3] = [
    Occluder::Sphere { centre: DVec3::new(-0.75, 0.95, 1.1), radius: 0.22 },
    Occluder::Sphere { centre: DVec3::new(0.1, 0.9, 0.9), radius: 0.12 },
    Occluder::Box { low: DVec3::new(-1.1, -0.1, 1.0), high: DVec3::new(-0.9, 0.4, 1.2) },
];

/// The distance at which a floor ends, in radii of the scene's sphere.
const FLOOR_END: f64 = 12.0;

/// A shaded point.
struct Hit {
    distance: f64,
    normal: DVec3,
    /// The occluder that it lies on. A convex solid does not hide the light of its own points.
    on: Option<usize>,
}

/// The panels in the order of [`TITLES`], or `None` if `stop` returned true.
pub(super) fn panels(scene: &Scene, frame: &Frame, stop: Stop<'_>) -> Option<[Radiances; 4]> {
    let size = scene.size;
    let mut panels: [Vec<[f32; 3]>; 4] = Default::default();
    for y in 0..size {
        if stop() {
            return None;
        }
        let row: Vec<[[f32; 3]; 4]> = (0..size).into_par_iter().map(|x| pixel(scene, frame, [x, y])).collect();
        for (panel, pixels) in panels.iter_mut().enumerate() {
            pixels.extend(row.iter().map(|values| values[panel]));
        }
    }
    Some(panels.map(|pixels| Radiances { width: size, pixels }))
}

/// The mean difference of a panel from the truth, and the mean of the truth, over pixels and channels.
pub(super) fn error(panel: &Radiances, truth: &Radiances) -> [f32; 2] {
    let count = 3.0 * truth.pixels.len() as f32;
    let pairs = || panel.pixels.iter().flatten().zip(truth.pixels.iter().flatten());
    [pairs().map(|(a, b)| (a - b).abs()).sum::<f32>() / count, pairs().map(|(_, b)| *b).sum::<f32>() / count]
}

fn pixel(scene: &Scene, frame: &Frame, [x, y]: [u32; 2]) -> [[f32; 3]; 4] {
    let place = |i: u32| 2.0 * (f64::from(i) + 0.5) / f64::from(scene.size) - 1.0;
    let [eye, right, up, forward] = [frame.eye, frame.right, frame.up, frame.forward].map(Vec3::as_dvec3);
    let ray = (forward + right * place(x) - up * place(y)).normalize();
    let occluders = if scene.surface == Surface::Floor { &ON_FLOOR } else { &BEFORE_SPHERE };
    let background = [frame.background.to_array(); 4];
    nearest(scene.surface, occluders, eye, ray)
        .and_then(|hit| lit(scene, occluders, eye + ray * hit.distance, -ray, &hit, y * scene.size + x))
        .unwrap_or(background)
}

/// The first point on a ray.
fn nearest(surface: Surface, occluders: &[Occluder], eye: DVec3, ray: DVec3) -> Option<Hit> {
    let on_surface = match surface {
        Surface::Floor => {
            let distance = -eye.y / ray.y;
            let at = eye + ray * distance;
            (distance > 0.0 && at.length() < FLOOR_END).then_some((distance, DVec3::Y))
        }
        Surface::Sphere => on_occluder(&Occluder::Sphere { centre: DVec3::ZERO, radius: 1.0 }, eye, ray),
    };
    let surface = on_surface.map(|(distance, normal)| Hit { distance, normal, on: None });
    let solids = occluders.iter().enumerate().filter_map(|(index, occluder)| {
        let (distance, normal) = on_occluder(occluder, eye, ray)?;
        Some(Hit { distance, normal, on: Some(index) })
    });
    solids.chain(surface).min_by(|a, b| a.distance.total_cmp(&b.distance))
}

/// Distance and normal where a ray from outside enters a sphere or a box.
fn on_occluder(occluder: &Occluder, eye: DVec3, ray: DVec3) -> Option<(f64, DVec3)> {
    match *occluder {
        Occluder::Sphere { centre, radius } => {
            let along = (centre - eye).dot(ray);
            let half2 = radius * radius - (centre - eye - along * ray).length_squared();
            let distance = along - half2.max(0.0).sqrt();
            (half2 > 0.0 && distance > 0.0).then(|| (distance, (eye + ray * distance - centre) / radius))
        }
        Occluder::Box { low, high } => {
            let [first, second] = [(low - eye) / ray, (high - eye) / ray];
            let (near, far) = (first.min(second), first.max(second));
            let distance = near.max_element();
            let normal = DVec3::from(near.to_array().map(|t| f64::from(u8::from(t == distance)))) * -ray.signum();
            (distance > 0.0 && distance < far.min_element()).then_some((distance, normal.normalize()))
        }
        Occluder::Triangle(_) => None,
    }
}

/// The radiance of each panel at a point; `None` if it reflects nothing to the viewer.
fn lit(
    scene: &Scene,
    occluders: &[Occluder],
    point: DVec3,
    to_eye: DVec3,
    hit: &Hit,
    seed: u32,
) -> Option<[[f32; 3]; 4]> {
    let material = scene.materials[0];
    // Tangents follow circles of latitude, or x on horizontal surfaces.
    let tangent = if hit.normal.y.abs() > 0.999 { DVec3::X } else { DVec3::Y.cross(hit.normal).normalize() };
    let (sin, cos) = sin_cos(material.rotation);
    let across = hit.normal.cross(tangent);
    let x = tangent * cos + across * sin;
    let world = DMat3::from_cols(x, hit.normal.cross(x), hit.normal);
    let to_local = world.transpose();
    let wo = to_local * to_eye;
    let wo = DVec3::new(wo.x, wo.y, wo.z.max(1e-3)).normalize();
    let at = Configuration {
        alpha_x: material.alpha_x,
        alpha_y: material.alpha_y,
        theta: atan2(wo.x.hypot(wo.y), wo.z),
        phi: atan2(wo.y, wo.x),
    };
    let sides = if scene.light.two_sided { Sides::Two } else { Sides::One };
    let corners = scene.light.outline().vertices.iter().map(|corner| to_local * (*corner - point)).collect();
    let light = PolygonLight::new(corners, sides).ok()?;
    let samplers = [LightSampler::solid_angle(&light).ok()?, LightSampler::normals(&at, &light).ok()?];
    let ggx = Ggx { alpha_x: material.alpha_x, alpha_y: material.alpha_y };
    let moved = occluders.iter().map(|occluder| match *occluder {
        Occluder::Sphere { centre, radius } => Occluder::Sphere { centre: centre - point, radius },
        Occluder::Box { low, high } => Occluder::Box { low: low - point, high: high - point },
        Occluder::Triangle(corners) => Occluder::Triangle(corners.map(|corner| corner - point)),
    });
    let others: Vec<Occluder> =
        moved.enumerate().filter(|(index, _)| Some(*index) != hit.on).map(|(_, occluder)| occluder).collect();
    // Sums of seen and of all light over draws.
    let sums = |sampler: &LightSampler, count: u32, salt: u32| {
        let mut sums = [[0.0; 3]; 2];
        let first = random(random(seed) ^ salt);
        let shift = [first, random(first ^ 0x9e37_79b9)].map(|word| f64::from(word >> 8) / f64::from(1 << 24));
        for drawn in Lattice::new(count as usize, shift).points().filter_map(|u| sampler.sample(u)) {
            let value = scene.light.intensity * ggx.eval_cos(wo, drawn.wi) / drawn.pdf / f64::from(count);
            let grazing = (1.0 - wo.dot((wo + drawn.wi).normalize())).max(0.0).powi(5);
            let direction = world * drawn.wi;
            let is_seen = !others.iter().any(|occluder| occluder.blocks(direction, light.distance(drawn.wi)));
            let weighted = scene.f0.map(|f0| value * (f0 + (1.0 - f0) * grazing));
            let add = |sum: [f64; 3]| [0, 1, 2].map(|k| sum[k] + weighted[k]);
            sums = [if is_seen { add(sums[0]) } else { sums[0] }, add(sums[1])];
        }
        sums
    };
    let [seen, all] = sums(&samplers[1], 4, 40);
    let closed = by_normals(&at, &light, scene.rule).ok()?;
    let analytic = scene.f0.map(|f0| scene.light.intensity * closed.schlick(f0, 1.0));
    let scaled = [0, 1, 2].map(|k| if all[k] > 0.0 { analytic[k] * seen[k] / all[k] } else { 0.0 });
    let truth = sums(&samplers[1], scene.spp, 10)[0];
    let single = [sums(&samplers[0], 1, 20)[0], sums(&samplers[1], 1, 30)[0]];
    Some([truth, single[0], single[1], scaled].map(|colour| colour.map(|channel| channel as f32)))
}

/// PCG [O'Neill 2014].
fn random(seed: u32) -> u32 {
    let state = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::NamedScene;

    #[test]
    fn the_closed_form_has_the_least_error_and_occluders_darken_the_picture() {
        let scene = Scene { size: 64, spp: 64, ..NamedScene::Shadows.scene() };
        let frame = Frame::new(&scene, false);
        let panels = panels(&scene, &frame, &|| false).expect("it is not stopped");
        let [uniform, own, scaled] = [1, 2, 3].map(|panel: usize| error(&panels[panel], &panels[0]));
        println!("solid angle {uniform:?}, sampler {own:?}, closed form {scaled:?}");
        assert!(own[0] < 0.5 * uniform[0] && scaled[0] < 0.5 * own[0] && own[1] > 0.02, "{uniform:?} {own:?}");
        // Samples are not biased: the sum is within four standard deviations, which follow from the differences. Three
        // channels are nearly equal.
        for panel in &panels[1..3] {
            let pairs = || panel.pixels.iter().flatten().zip(panels[0].pixels.iter().flatten()).map(|(a, b)| a - b);
            let (off, square) = (pairs().sum::<f32>(), pairs().map(|x| x * x).sum::<f32>());
            println!("sum off by {off}, standard deviation {}", (3.0 * square).sqrt());
            assert!(off.abs() < 4.0 * (3.0 * square).sqrt(), "{off} {square}");
        }
        assert!(super::panels(&scene, &frame, &|| true).is_none());
    }
}
