//! What GGX reflects of a light, by adaptive quadrature: slow, and as exact as one likes.
//!
//! Quadrature over a light's area misses sharp lobes, which are points of it, and needs more and more points for
//! needles. In the space of normals stretched by `1 / alpha` ([`super::normals`]) every lobe is the same cosine, and the
//! integrand as smooth as the weight of shadowing. So the light's image there is integrated over, in two steps: along
//! its outline, and along the ray from a tip within the image to the outline. An edge is halved until its image is
//! short, which finds the few points of a light that a mirror reflects.
//!
//! An outline has straight pieces and arcs of ellipses (`border.rs`): those of disks, spheres and tubes are exact, and no polygon
//! stands for them. A line light has no outline; what it reflects is an integral along it.
//!
//! This shares no line with the closed form but the mapping of directions to normals.

mod border;

use std::f64::consts::PI;

use glam::DVec3;

use self::border::Piece;
use super::{AreaLight, LightError, Reflected, model::surface_and_view, shaped::Form};
use crate::fit::{
    Configuration, Sides,
    brdf::{Brdf, Ggx},
};

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

/// A line points at the shaded point that is closer to it, made longer, than this part of the farther end's distance.
const POINTING: f64 = 1e-14;

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
/// A line is the limit of a thin tube: what it reflects is proportional to its width, up to one.
///
/// # Errors
/// [`LightError::Domain`] for a roughness outside [0, 1] or a view direction on or below the horizon.
pub fn truth<'a>(at: &Configuration, light: impl Into<AreaLight<'a>>) -> Result<Reflected, LightError> {
    truth_within(TRUTH_TOLERANCE, at, light)
}

/// The same, with another tolerance for each part of an edge.
///
/// # Errors
/// As [`truth`].
pub fn truth_within<'a>(
    tolerance: f64,
    at: &Configuration,
    light: impl Into<AreaLight<'a>>,
) -> Result<Reflected, LightError> {
    let (alpha, wo) = surface_and_view(at)?;
    let lobe = Lobe::new(alpha, wo);
    let (border, sides) = match light.into() {
        AreaLight::Polygon(light) => (border::of_polygon(light.vertices()), light.sides()),
        AreaLight::Shaped(light) => match *light.form() {
            Form::Line { ends, width } => return Ok(within_one(lobe.line(alpha, ends, width, tolerance))),
            Form::Ellipse { sides, .. } => (border::of_shape(light.form()), sides),
            Form::Sphere { .. } | Form::Tube { .. } => (border::of_shape(light.form()), Sides::Two),
        },
    };
    let sum = lobe.within(&border::above_surface(&border), tolerance);
    // The lit side is that from which the outline runs clockwise; seen from there, the sum is positive.
    Ok(within_one(match (sides, sum[0] < 0.0) {
        (_, false) => sum,
        (Sides::Two, true) => sum.map(|x| -x),
        (Sides::One, true) => [0.0; 2],
    }))
}

fn within_one(parts: [f64; 2]) -> Reflected {
    let [energy, fresnel] = parts.map(|part| part.clamp(0.0, 1.0));
    Reflected { energy, fresnel }
}

/// A lobe of GGX among normals `c = normalize(A^-1 h)`, `A = diag(alpha_x, alpha_y, 1)`.
struct Lobe {
    stretch: DVec3,
    wo: DVec3,
    /// `A wo`, and its length.
    seen_along: DVec3,
    length: f64,
}

/// A part of an outline, and the images of its ends.
#[derive(Clone, Copy)]
struct Edge {
    piece: Piece,
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

    fn edge(&self, piece: Piece) -> Edge {
        let [from_image, to_image] = piece.ends().map(|end| self.image_of(&piece, end));
        Edge { piece, from_image, to_image }
    }

    /// The image of a place on a piece: straight ones are of unit vectors.
    fn image_of(&self, piece: &Piece, place: DVec3) -> DVec3 {
        match piece {
            Piece::Straight(_) => self.image(place),
            Piece::Arc { .. } => self.image(place.normalize()),
        }
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

    /// The integral of the density within an outline above the surface, positive where that is seen to run clockwise.
    fn within(&self, outline: &[Piece], tolerance: f64) -> [f64; 2] {
        let around = outline.iter().fold(DVec3::ZERO, |sum, piece| match piece {
            Piece::Straight([from, _]) => sum + *from,
            Piece::Arc { .. } => sum + piece.ends()[0].normalize() + piece.middle().normalize(),
        });
        let middle = around.normalize_or_zero();
        if middle == DVec3::ZERO {
            return [0.0; 2];
        }
        let tip = self.image(middle);
        let triangle = |edge: &Edge| self.triangle(tip, edge, tolerance);
        let parts = outline.iter().map(|piece| self.over_short_parts(self.edge(*piece), 0, &triangle));
        parts.fold([0.0; 2], plus)
    }

    /// The sum over parts of an edge whose images are short.
    fn over_short_parts(&self, edge: Edge, halvings: u32, part: &impl Fn(&Edge) -> [f64; 2]) -> [f64; 2] {
        let Edge { piece, from_image, to_image } = edge;
        if matches!(piece, Piece::Straight([from, to]) if from == to) {
            return [0.0; 2];
        }
        let image = self.image_of(&piece, piece.middle());
        let ends = [from_image.dot(to_image), from_image.dot(image), image.dot(to_image)];
        let is_short = halvings >= LEAST_EDGE_HALVINGS && ends.iter().all(|cosine| *cosine > SHORT);
        if is_short || halvings == MOST_EDGE_HALVINGS {
            return part(&edge);
        }
        let [first, second] = piece.halves();
        let halves =
            [Edge { piece: first, to_image: image, ..edge }, Edge { piece: second, from_image: image, ..edge }];
        halves.into_iter().fold([0.0; 2], |sum, half| plus(sum, self.over_short_parts(half, halvings + 1, part)))
    }

    /// The integral of the density over the triangle between `tip` and the image of an edge, negative where it runs
    /// the other way round.
    fn triangle(&self, tip: DVec3, edge: &Edge, tolerance: f64) -> [f64; 2] {
        // c(t) along the image, and its derivative.
        let slice = |t: f64| {
            let (w, turning) = turn(&edge.piece, t);
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

    /// What is reflected of a line: the width times the integral of the BRDF times cosine over the angle along the line, over the
    /// distance.
    fn line(&self, [alpha_x, alpha_y]: [f64; 2], ends: [DVec3; 2], width: f64, tolerance: f64) -> [f64; 2] {
        let ggx = Ggx { alpha_x, alpha_y };
        let axis = (ends[1] - ends[0]).normalize();
        let beside = ends[0] - axis * ends[0].dot(axis);
        let (own, towards) = (beside.length(), beside.normalize_or_zero());
        // A line that points at the shaded point is seen as a point.
        if own <= POINTING * ends[0].length().max(ends[1].length()) {
            return [0.0; 2];
        }
        let along = |edge: &Edge| {
            let at = |t: f64| {
                let (w, turning) = turn(&edge.piece, t);
                let cosine = self.wo.dot((self.wo + w).normalize()).min(1.0);
                let energy = width * ggx.eval_cos(self.wo, w) * turning.length() * w.dot(towards) / own;
                [energy, energy * (1.0 - cosine).powi(5)]
            };
            integral(&at, [0.0, 1.0], tolerance, OUTLINE_HALVINGS)
        };
        let seen = Piece::Straight(ends).above_surface();
        seen.iter().map(|piece| self.over_short_parts(self.edge(*piece), 0, &along)).fold([0.0; 2], plus)
    }
}

/// The direction to the place at `t` of a piece, and its derivative.
fn turn(piece: &Piece, t: f64) -> (DVec3, DVec3) {
    let (place, along) = piece.at(t);
    let distance = place.length();
    let w = place / distance;
    (w, (along - w * w.dot(along)) / distance)
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
