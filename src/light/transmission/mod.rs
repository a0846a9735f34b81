//! The light of a polygon behind a rough dielectric interface, in the space of its normals, without a table. It is
//! exact except for the weight of shadowing and the Fresnel term.
//!
//! `eta = n_far / n_near`. The view `wo` is above the surface, `z > 0`, and the light is below it. The normal that
//! refracts `wi` into `wo` is `h = sigma (wo + eta wi)` up to length, with `sigma = -1` for `eta > 1` and `+1`
//! otherwise [Walter et al. 2007]. It is linear in `wi`, like the normal of a reflection. With `c = normalize(A^-1 h)`
//! the light of a polygon is again a weighted form factor over its image C(P):
//!
//! ```text
//! V = 2 / (cos_o + |A wo|) (A wo) . F,     F = 1/(2 pi) closed integral of c x dc along the outline of C(P)
//! ```
//!
//! The image of a circle of directions `p . w = q` is the cone `c^T K c = 0`,
//! `K = A [k (wo p' + p wo') - k^2 I - (1 - eta^2) p p'] A`, `k = wo . p + eta q`, and the integral over it is
//! elementary (`integral.rs`). Not every direction below the surface counts (`outline.rs`): the normal must be above
//! the surface and face both the viewer and the light. All these limits are circles, so the clips are exact. The
//! weight, `G2 / G1` with and without the Fresnel term, is averaged over four normals of each triangle between the mean
//! normal and an arc (`weight.rs`). `docs/refraction.md` has the derivation.

#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "NaN counts as what the comparison denies")]

mod arc;
mod bend;
#[cfg(any(test, feature = "testing"))]
pub mod cases;
mod clip;
mod cone;
mod eigen;
mod flat;
mod integral;
mod interface;
mod outline;
mod sampled;
#[cfg(test)]
mod tests;
mod weight;

pub use sampled::sampled;

use self::{
    arc::{Arc, ArcKind, Extent},
    integral::curved_part,
    interface::Interface,
    outline::outline,
};
use bend::arc_bend;
use ltcforge_fit::{
    Sides,
    math::{Scalar, Triple, cross, dot, minus, plus, scaled, unit},
};

/// The range of relative refractive indices `eta` for which the closed form is measured, except for values within
/// [`ETA_APART`] of one.
pub const ETA_RANGE: [f64; 2] = [1.0 / 3.0, 3.0];
/// The smallest difference of `eta` from one. At `eta = 1`, light passes straight through and has no normal,
/// `wo + eta wi = 0`. Near one, this sum is as short as `|eta - 1|`, and f32 loses digits: the mean error is 5e-7 at
/// 1.02 and 1e-6 at 1.005.
pub const ETA_APART: f64 = 0.02;

/// If the cosine between the ends of an image is above this, the image is a single part of the fan.
const LONG_COSINE: f64 = 0.7;
/// The number of parts of longer arcs: of an edge of the light, and of an arc that closes a clipped light.
const EDGE_PARTS: u32 = 2;
const CLOSING_PARTS: u32 = 4;
/// The number of parts of the edge that closes a light at the surface, where the weight is steepest, and of short
/// closing arcs.
const SHORT_CLOSING_PARTS: u32 = 2;
/// The number of parts of a closing circle.
const WHOLE_PARTS: u32 = 8;

/// The light transmitted by a rough interface. Each number is in [0, 1].
///
/// The unit is basic radiance, `L / n^2`: a half space of basic radiance one gives at most one. To get the radiance in
/// front of the interface from the radiance behind it, divide the result by `eta^2`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transmitted<T> {
    /// The light with shadowing and masking, for an interface that does not reflect.
    pub energy: T,
    /// The light weighted by `1 - F`, with the Fresnel equations of an unpolarised dielectric at the microfacet.
    pub dielectric: T,
    /// The light weighted by `1 - F`, with Schlick's approximation at the larger of the two angles.
    pub schlick: T,
}

/// The light that GGX transmits towards `wo` from a polygon of basic radiance one.
///
/// The vertices of the convex polygon are relative to the shaded point in its tangent frame, normal +z. The light is
/// the part of the polygon below the surface, `z < 0`. The vertices run clockwise as seen from the lit side. Domain:
/// `alpha` in [1e-4, 1], `wo` of unit length with `z > 0`, `eta` in [`ETA_RANGE`] but not within [`ETA_APART`] of one,
/// finite vertices.
///
/// ```
/// use ltcforge_fit::Sides;
/// use ltcforge_light::transmission::transmitted;
///
/// // A window below a pane of frosted glass, seen from straight above.
/// let window = [[-1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [1.0, 1.0, -1.0], [1.0, -1.0, -1.0]];
/// let through = transmitted([0.3, 0.3], [0.0, 0.0, 1.0], 1.5, &window, Sides::Two);
/// assert!(through.dielectric > 0.9 && through.dielectric < through.energy);
/// ```
#[must_use]
pub fn transmitted<T: Scalar>(
    alpha: [T; 2],
    wo: Triple<T>,
    eta: T,
    vertices: &[Triple<T>],
    sides: Sides,
) -> Transmitted<T> {
    let interface = Interface::new(alpha, wo, eta);
    let whole = outline(&interface, vertices, sides);
    let mut arcs = Vec::with_capacity(2 * whole.len());
    for arc in &whole {
        arc.split(&interface, parts(&interface, arc), &mut arcs);
    }
    let region = Region::new(&interface, &arcs);
    let [energy, dielectric, schlick] = region.weighed(&interface);
    let energy = energy.max(T::ZERO).min(T::ONE);
    let passed = |x: T| x.max(T::ZERO).min(energy);
    Transmitted { energy, dielectric: passed(dielectric), schlick: passed(schlick) }
}

/// The number of parts into which an arc is split for the weight. The integral of an arc is exact without a split.
fn parts<T: Scalar>(interface: &Interface<T>, arc: &Arc<T>) -> u32 {
    let is_short = || dot(interface.image(arc.from), interface.image(arc.to)) > T::of(LONG_COSINE);
    match (arc.kind, arc.extent) {
        (_, Extent::Whole) => WHOLE_PARTS,
        (ArcKind::Surface, _) => SHORT_CLOSING_PARTS,
        (ArcKind::Edge, _) => {
            if is_short() {
                1
            } else {
                EDGE_PARTS
            }
        }
        _ => {
            if is_short() {
                SHORT_CLOSING_PARTS
            } else {
                CLOSING_PARTS
            }
        }
    }
}

/// A region of normals, given by the images of the arcs around it.
struct Region<T> {
    sides: Vec<Side<T>>,
    /// `2 pi F`.
    flux: Triple<T>,
}

/// The image of an arc: its ends, and its contribution to the integral of `c x dc` without the plane triangle.
struct Side<T> {
    from: Triple<T>,
    to: Triple<T>,
    curved: Triple<T>,
}

impl<T: Scalar> Region<T> {
    /// The region inside of arcs of directions that run counterclockwise as seen from outside of the sphere. The map to
    /// normals turns the sphere inside out. The images run clockwise, so all integrals are negated.
    fn new(interface: &Interface<T>, arcs: &[Arc<T>]) -> Self {
        let side = |arc: &Arc<T>| {
            let [from, to] = [arc.from, arc.to].map(|w| interface.image(w));
            Side { from, to, curved: curved_part(interface, arc, from, to) }
        };
        let sides: Vec<Side<T>> = arcs.iter().map(side).collect();
        // The plane part is summed around a corner, because it cancels to a small area for a small light.
        let origin = sides.first().map_or([T::ZERO; 3], |side| side.from);
        let flux = sides.iter().fold([T::ZERO; 3], |sum, side| minus(sum, side.flux(origin)));
        Self { sides, flux }
    }

    /// The part of the visible normals in the region.
    #[cfg(any(test, feature = "testing"))]
    fn part(&self, interface: &Interface<T>) -> T {
        interface.per_flux() * dot(self.flux, interface.stretched)
    }

    /// The part of the visible normals in the region, with three weights.
    ///
    /// The region is a fan of triangles between the mean normal, which is the direction of F, and the sides. The part
    /// and the centroid of each triangle are exact.
    fn weighed(&self, interface: &Interface<T>) -> Triple<T> {
        let mut sum = [T::ZERO; 3];
        if !(dot(self.flux, interface.stretched) > T::ZERO) {
            return sum;
        }
        let tip = unit(self.flux);
        for side in &self.sides {
            let spokes = minus(arc_bend(tip, side.from), arc_bend(tip, side.to));
            let flux = scaled(plus(side.flux(tip), spokes), -T::ONE);
            let centroid = unit(flux);
            let centroid = if dot(centroid, tip) < T::ZERO { scaled(centroid, -T::ONE) } else { centroid };
            let part = interface.per_flux() * dot(flux, interface.stretched);
            sum = plus(sum, scaled(interface.mean_weight(centroid, [tip, side.from, side.to]), part));
        }
        sum
    }
}

impl<T: Scalar> Side<T> {
    /// The integral of `c x dc` along the side, relative to an origin.
    fn flux(&self, origin: Triple<T>) -> Triple<T> {
        plus(self.curved, cross(minus(self.from, origin), minus(self.to, origin)))
    }
}
