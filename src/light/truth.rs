//! What GGX reflects of a light, by adaptive quadrature: slow, and as exact as one likes.
//!
//! Quadrature over a light's area misses sharp lobes, which are points of it, and needs more and more points for
//! needles. In the space of normals stretched by `1 / alpha` ([`super::normals`]) every lobe is the same cosine, and the
//! integrand as smooth as the weight of shadowing. So the light's image there is integrated over, in two steps: along
//! its outline, and along the ray from a tip within the image to the outline. An edge is halved until its image is
//! short, which finds the few points of a light that a mirror reflects.
//!
//! This shares no line with the closed form but the mapping of directions to normals.

use std::f64::consts::PI;

use glam::DVec3;

use super::{LightError, PolygonLight, Reflected, model::surface_and_view};
use crate::fit::{Configuration, Sides};

/// How exact [`truth`] is, for each part of an edge.
pub const TRUTH_TOLERANCE: f64 = 1e-9;

/// Cosine of 18 degrees: an image no longer than this is smooth to a rule of 15 points.
const SHORT: f64 = 0.95;
/// Parts into which an edge is halved at most: the last is shorter than the spacing of f64 directions.
const MOST_EDGE_HALVINGS: u32 = 60;
/// An edge is halved at least so often: an image that leaves and comes back would look short.
const LEAST_EDGE_HALVINGS: u32 = 2;

/// Halvings of an interval along the outline, and along a ray. They end where a horizon crosses the integrand.
const OUTLINE_HALVINGS: u32 = 16;
const RAY_HALVINGS: u32 = 12;

/// Nodes and weights of the Kronrod rule of 15 points on [-1, 1], for zero and the positive nodes in ascending order.
const KRONROD: [(f64, f64); 8] = [
    (0.0, 0.209_482_141_084_727_83),
    (0.207_784_955_007_898_47, 0.204_432_940_075_298_9),
    (0.405_845_151_377_397_2, 0.190_350_578_064_785_4),
    (0.586_087_235_467_691_1, 0.169_004_726_639_267_9),
    (0.741_531_185_599_394_4, 0.140_653_259_715_525_92),
    (0.864_864_423_359_769_1, 0.104_790_010_322_250_18),
    (0.949_107_912_342_758_5, 0.063_092_092_629_978_56),
    (0.991_455_371_120_812_6, 0.022_935_322_010_529_224),
];
/// Weights of Gauss's rule of 7 points, whose nodes are every other one of Kronrod's.
const GAUSS: [f64; 4] =
    [0.417_959_183_673_469_4, 0.381_830_050_505_118_9, 0.279_705_391_489_276_64, 0.129_484_966_168_869_7];

/// What a surface reflects of a light, to [`TRUTH_TOLERANCE`].
///
/// # Errors
/// [`LightError::Domain`] for a roughness outside [0, 1] or a view direction on or below the horizon.
pub fn truth(at: &Configuration, light: &PolygonLight) -> Result<Reflected, LightError> {
    truth_within(TRUTH_TOLERANCE, at, light)
}

/// The same, with another tolerance for each part of an edge.
///
/// # Errors
/// As [`truth`].
pub fn truth_within(tolerance: f64, at: &Configuration, light: &PolygonLight) -> Result<Reflected, LightError> {
    let (alpha, wo) = surface_and_view(at)?;
    let lobe = Lobe::new(alpha, wo);
    let outline = above_surface(light.vertices());
    let middle = outline.iter().sum::<DVec3>().normalize_or_zero();
    if outline.len() < 3 || middle == DVec3::ZERO {
        return Ok(Reflected::NONE);
    }
    let tip = lobe.image(middle);
    let mut sum = [0.0; 2];
    for (i, from) in outline.iter().enumerate() {
        let edge = lobe.edge(*from, outline[(i + 1) % outline.len()]);
        sum = plus(sum, lobe.triangle(tip, edge, tolerance, 0));
    }
    // The lit side is that from which the outline runs clockwise; seen from there, the sum is positive.
    let [energy, fresnel] = match (light.sides(), sum[0] < 0.0) {
        (_, false) => sum,
        (Sides::Two, true) => sum.map(|x| -x),
        (Sides::One, true) => [0.0; 2],
    };
    Ok(Reflected { energy: energy.clamp(0.0, 1.0), fresnel: fresnel.clamp(0.0, 1.0) })
}

/// The directions to the corners of the part of a polygon above the surface.
fn above_surface(vertices: &[DVec3]) -> Vec<DVec3> {
    let mut kept = Vec::with_capacity(vertices.len() + 1);
    for (from, to) in vertices.iter().zip(vertices.iter().cycle().skip(1)) {
        if from.z > 0.0 {
            kept.push(from.normalize());
        }
        if (from.z > 0.0) != (to.z > 0.0) {
            let crossing = *from * to.z.abs() + *to * from.z.abs();
            kept.push(DVec3::new(crossing.x, crossing.y, 0.0).normalize_or_zero());
        }
    }
    kept
}

/// A lobe of GGX among normals `c = normalize(A^-1 h)`, `A = diag(alpha_x, alpha_y, 1)`.
struct Lobe {
    stretch: DVec3,
    wo: DVec3,
    /// `A wo`, and its length.
    seen_along: DVec3,
    length: f64,
}

/// A part of an edge: directions to its ends, and their images.
#[derive(Clone, Copy)]
struct Edge {
    from: DVec3,
    to: DVec3,
    from_image: DVec3,
    to_image: DVec3,
}

impl Lobe {
    fn new([alpha_x, alpha_y]: [f64; 2], wo: DVec3) -> Self {
        let stretch = DVec3::new(alpha_x, alpha_y, 1.0);
        Self { stretch, wo, seen_along: stretch * wo, length: (stretch * wo).length() }
    }

    /// The normal that reflects the view to `w`, in the stretched space.
    fn image(&self, w: DVec3) -> DVec3 {
        ((self.wo + w) / self.stretch).normalize()
    }

    fn edge(&self, from: DVec3, to: DVec3) -> Edge {
        Edge { from, to, from_image: self.image(from), to_image: self.image(to) }
    }

    /// Energy reflected by normals around `c`, of length one, per steradian there, and the same times Schlick's fifth
    /// power.
    ///
    /// Visible normals have the density `2 (A wo . c) / (cos_o + |A wo|) / pi`, and `G2 / G1` is
    /// `(cos_o + |A wo|) cos_i / (|A wo| cos_i + cos_o |A wi|)`.
    fn density(&self, c: DVec3) -> [f64; 2] {
        let h = (self.stretch * c).normalize();
        let cosine = self.wo.dot(h);
        let wi = 2.0 * cosine * h - self.wo;
        if wi.z <= 0.0 {
            return [0.0; 2];
        }
        let shadowing = self.length * wi.z + self.wo.z * (self.stretch * wi).length();
        let energy = 2.0 * self.seen_along.dot(c) * wi.z / (PI * shadowing);
        [energy, energy * (1.0 - cosine.min(1.0)).powi(5)]
    }

    /// The integral of the density over the triangle between `tip` and the image of an edge, negative where it runs
    /// the other way round.
    fn triangle(&self, tip: DVec3, edge: Edge, tolerance: f64, halvings: u32) -> [f64; 2] {
        let Edge { from, to, from_image, to_image } = edge;
        if from == to {
            return [0.0; 2];
        }
        let middle = (from + to).normalize_or_zero();
        let image = self.image(middle);
        let ends = [from_image.dot(to_image), from_image.dot(image), image.dot(to_image)];
        let is_short = halvings >= LEAST_EDGE_HALVINGS && ends.iter().all(|cosine| *cosine > SHORT);
        if !is_short && halvings < MOST_EDGE_HALVINGS {
            let halves =
                [Edge { to: middle, to_image: image, ..edge }, Edge { from: middle, from_image: image, ..edge }];
            return halves
                .into_iter()
                .fold([0.0; 2], |sum, half| plus(sum, self.triangle(tip, half, tolerance, halvings + 1)));
        }
        // c(t) along the image, and its derivative.
        let along = to - from;
        let slice = |t: f64| {
            let w = from + along * t;
            let distance = w.length();
            let w = w / distance;
            let turning = (along - w * w.dot(along)) / distance;
            let h = (self.wo + w) / self.stretch;
            let length = h.length();
            let (c, derivative) = (h / length, turning / self.stretch / length);
            let sweep = tip.dot(c.cross(derivative));
            // Points p = (1 - s) tip + s c of the plane triangle, seen from the origin.
            let ray = |s: f64| {
                let p = tip * (1.0 - s) + c * s;
                let length = p.length();
                self.density(p / length).map(|x| x * s / (length * length * length))
            };
            let tolerance = 0.1 * tolerance / sweep.abs().max(1e-3);
            integral(&ray, [0.0, 1.0], tolerance, RAY_HALVINGS).map(|x| x * sweep)
        };
        integral(&slice, [0.0, 1.0], tolerance, OUTLINE_HALVINGS)
    }
}

fn plus<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|i| a[i] + b[i])
}

/// The integral of `f` over an interval by the rules of Gauss and Kronrod, halved until they agree.
pub(super) fn integral<const N: usize>(
    f: &impl Fn(f64) -> [f64; N],
    [from, to]: [f64; 2],
    tolerance: f64,
    halvings: u32,
) -> [f64; N] {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let (mut fine, mut coarse) = ([0.0; N], [0.0; N]);
    for (i, (x, weight)) in KRONROD.into_iter().enumerate() {
        let right = f(middle + half * x);
        let both = if i == 0 { right } else { plus(right, f(middle - half * x)) };
        fine = plus(fine, both.map(|y| y * weight * half));
        if i % 2 == 0 {
            coarse = plus(coarse, both.map(|y| y * GAUSS[i / 2] * half));
        }
    }
    if halvings == 0 || fine.iter().zip(coarse).all(|(fine, coarse)| (fine - coarse).abs() < tolerance) {
        return fine;
    }
    let part = |ends| integral(f, ends, 0.6 * tolerance, halvings - 1);
    plus(part([from, middle]), part([middle, to]))
}
