//! The light transmitted by a rough interface, by Monte Carlo integration over its visible normals. It is the
//! reference, and shares no code with the closed form.

use glam::DVec3;

use super::Transmitted;
use ltcforge_fit::{
    Sides,
    brdf::{Brdf, Ggx},
    math::{Lattice, Triple},
};

/// The light that GGX transmits towards `wo` from a polygon of basic radiance one, estimated from `count` visible
/// normals and the directions that they refract.
///
/// The other arguments are the arguments of [`super::transmitted`]. Each normal contributes between 0 and 1, so the
/// standard error for one normal is at most one half. It falls with `1 / sqrt(count)`, and faster for wide lobes.
/// `shift`, in [0, 1), moves the points; equal shifts give equal bits. Domain: `count` from 1 to 2^32 - 1.
#[must_use]
pub fn sampled(
    [alpha_x, alpha_y]: [f64; 2],
    wo: Triple<f64>,
    eta: f64,
    vertices: &[Triple<f64>],
    sides: Sides,
    count: usize,
    shift: [f64; 2],
) -> Transmitted<f64> {
    let ggx = Ggx { alpha_x, alpha_y };
    let wo = DVec3::from_array(wo);
    let light = Cone::new(vertices, sides);
    let mut sum = [0.0; 3];
    for u in Lattice::new(count, shift).points() {
        let h = (ggx.sample(wo, u).wi + wo).normalize();
        let Some(wi) = refracted(wo, h, eta).filter(|wi| wi.z < 0.0 && light.contains(*wi)) else { continue };
        let one_plus_lambda = 1.0 + ggx.smith_lambda(wo);
        let weight = one_plus_lambda / (one_plus_lambda + ggx.smith_lambda(wi));
        let (cos_o, cos_i) = (wo.dot(h), -wi.dot(h));
        let [dielectric, schlick] = passed(cos_o, cos_i, eta);
        sum = [sum[0] + weight, sum[1] + weight * dielectric, sum[2] + weight * schlick];
    }
    let [energy, dielectric, schlick] = sum.map(|x| x / count as f64);
    Transmitted { energy, dielectric, schlick }
}

/// Snell's law at the normal `h`; `None` for total reflection.
fn refracted(wo: DVec3, h: DVec3, eta: f64) -> Option<DVec3> {
    let cosine = wo.dot(h);
    let sine2 = (1.0 - cosine * cosine) / (eta * eta);
    (sine2 < 1.0 && cosine > 0.0).then(|| h * (cosine / eta - (1.0 - sine2).sqrt()) - wo / eta)
}

/// `1 - F` by the Fresnel equations for unpolarised light, and by Schlick's approximation at the larger angle.
fn passed(cos_o: f64, cos_i: f64, eta: f64) -> [f64; 2] {
    let across = (cos_o - eta * cos_i) / (cos_o + eta * cos_i);
    let along = (eta * cos_o - cos_i) / (eta * cos_o + cos_i);
    let f0 = ((eta - 1.0) / (eta + 1.0)).powi(2);
    let schlick = f0 + (1.0 - f0) * (1.0 - cos_o.min(cos_i)).powi(5);
    [1.0 - 0.5 * (across * across + along * along), 1.0 - schlick]
}

/// The directions to a convex polygon. They are on the same side of all planes through its edges.
struct Cone {
    sides: Vec<DVec3>,
    is_lit: bool,
}

impl Cone {
    fn new(vertices: &[Triple<f64>], sides: Sides) -> Self {
        let vertices: Vec<DVec3> = vertices.iter().map(|v| DVec3::from_array(*v)).collect();
        let next = vertices.iter().cycle().skip(1);
        let planes: Vec<DVec3> = vertices.iter().zip(next).map(|(from, to)| from.cross(*to)).collect();
        let middle: DVec3 = vertices.iter().sum();
        let is_clockwise = planes.iter().map(|plane| plane.dot(middle)).sum::<f64>() > 0.0;
        let planes = if is_clockwise { planes } else { planes.into_iter().map(|plane| -plane).collect() };
        Self { sides: planes, is_lit: sides == Sides::Two || is_clockwise }
    }

    fn contains(&self, w: DVec3) -> bool {
        self.is_lit && self.sides.iter().all(|plane| plane.dot(w) > 0.0)
    }
}
