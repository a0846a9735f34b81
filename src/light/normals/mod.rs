//! The light of a polygon on GGX, computed in the space of its normals without a table.
//!
//! The light reflected from a polygon P of radiance one, for a Fresnel factor of one, is
//!
//! ```text
//! integral over P of D(h) G2 / (4 cos_o) dwi = integral over H(P) of Dv(h) (G2 / G1) dh,   Dv = G1 (wo . h) D / cos_o
//! ```
//!
//! where H(P) are the half vectors `h = normalize(wo + wi)` [Walter et al. 2007]. With `c = normalize(A^-1 h)` and
//! `A = diag(alpha_x, alpha_y, 1)`, the normals of GGX become a clamped cosine, `D(h) h.z dh = c.z / pi dc`. The
//! visible normals become the projection of the hemisphere along `A wo` [Heitz 2018]. So the integral of `Dv` over a
//! region is the form factor of the region's image C(P) for a receiver with the normal `A wo`:
//!
//! ```text
//! V = 2 / (cos_o + |A wo|) (A wo) . F,     F = 1/(2 pi) closed integral of c x dc along the outline of C(P)
//! ```
//!
//! The images of a light's edges are conics. Four arcs of great circles approximate each (`arcs.rs`); the exact
//! integral has a closed form (`exact/`). The weight `G2 / G1` and Schlick's fifth power are smooth. Their mean comes
//! from a few normals and is corrected by a small network (`mean.rs`). `docs/normals.md` has the derivation.
//!
//! For every direction above the surface, the half vector is above the surface and faces the viewer. So a light is only
//! cut at the surface.

mod arcs;
mod exact;
mod mean;
mod model;
mod network;
#[rustfmt::skip]
#[allow(clippy::unreadable_literal, clippy::approx_constant, reason = "a program prints them, one row per line")]
mod numbers;
mod outline;
pub(crate) mod view;

pub(super) use self::model::NormalsModel;
pub(crate) use self::view::View;
pub use self::{
    arcs::BULGE,
    mean::{INPUTS, OUTPUTS, Region},
    model::by_normals,
    network::Network,
};
use self::{
    arcs::{AnglePerSine, CLOSE, four_arcs},
    mean::Outlined,
    outline::Outline,
};
pub(super) use exact::cos_of_third;
use ltcforge_fit::{
    Sides,
    brdf::edge_of_parts,
    math::{Scalar, Triple, dot, plus, scaled},
    named_list,
};

named_list! {
    /// The trade-off between cost and accuracy.
    pub enum NormalsRule {
        /// Four arcs per edge. The weight is sampled once per edge. The network has nine inputs and four units.
        Balanced = "balanced",
        /// Four arcs per edge, with a rougher formula for angles. The weight is not sampled at the edges. The network
        /// has eight inputs and three units.
        Fast = "fast",
        /// Four arcs per edge. The weight is sampled three times per edge. The network has twelve inputs and 24 units.
        Fine = "fine",
        /// Like [`NormalsRule::Fine`], with the exact integrals of the edges. Shaders do not have this rule.
        Exact = "exact",
    }
}

impl NormalsRule {
    /// The rules of shaders, the default first.
    pub const SHADED: [Self; 3] = [Self::Balanced, Self::Fast, Self::Fine];

    /// The network for the mean of the weight.
    #[must_use]
    pub fn network(self) -> Network<'static> {
        match self {
            Self::Balanced => numbers::BALANCED,
            Self::Fast => numbers::FAST,
            Self::Fine | Self::Exact => numbers::FINE,
        }
    }

    /// The number of a region's values that the network uses as inputs.
    #[must_use]
    pub fn inputs(self) -> usize {
        match self {
            Self::Fast => 8,
            Self::Balanced => 9,
            Self::Fine | Self::Exact => INPUTS,
        }
    }

    /// The number of points at which an edge's weight is sampled.
    fn samples(self) -> usize {
        match self {
            Self::Fast => 0,
            Self::Balanced => 1,
            Self::Fine | Self::Exact => 3,
        }
    }

    fn angle_per_sine(self) -> &'static AnglePerSine {
        if self == Self::Fast { &arcs::ROUGH } else { &arcs::CLOSE }
    }
}

impl<T: Scalar> Region<T> {
    /// The reflected light, from the outputs of a rule's network: for a Fresnel factor of one, and weighted by Schlick's
    /// factor.
    #[must_use]
    pub fn reflected(&self, network: &Network<'_>) -> [T; 2] {
        self.mean(network.at(&self.inputs)).map(|mean| self.visible * mean)
    }
}

impl Region<f64> {
    /// The reflected light weighted by F82's edge weight. It is evaluated at the angle of incidence at which Schlick's
    /// factor is the mean of the region. So it needs no extra network.
    #[must_use]
    pub fn edge(&self, network: &Network<'_>) -> f64 {
        (self.visible * edge_of_parts(self.mean(network.at(&self.inputs)))).clamp(0.0, self.visible)
    }
}

/// The light of a polygon of radiance one that GGX reflects towards `wo`. Returns the light for a Fresnel factor of one
/// and the light weighted by Schlick's `(1 - wo . h)^5`, both in [0, 1].
///
/// The vertices of the convex polygon are relative to the shaded point in its tangent frame, normal +z. They run
/// clockwise as seen from the lit side. Domain: `alpha` in [1e-5, 1], `wo` of unit length with `z > 0`, finite
/// vertices.
#[must_use]
pub fn reflected<T: Scalar>(
    alpha: [T; 2],
    wo: Triple<T>,
    vertices: &[Triple<T>],
    sides: Sides,
    rule: NormalsRule,
) -> [T; 2] {
    region(alpha, wo, vertices, sides, rule).map_or([T::ZERO; 2], |region| region.reflected(&rule.network()))
}

/// The visible normals that reflect a light, by a rule; `None` if nothing is reflected.
#[must_use]
pub fn region<T: Scalar>(
    alpha: [T; 2],
    wo: Triple<T>,
    vertices: &[Triple<T>],
    sides: Sides,
    rule: NormalsRule,
) -> Option<Region<T>> {
    let view = View::new(alpha, wo);
    let outline = Outline::new(&view, vertices);
    if outline.corners.len() < 3 {
        return None;
    }
    let psi = rule.angle_per_sine();
    let mut flux = [T::ZERO; 3];
    let mut outlined = Outlined::NONE;
    for (i, (from, to)) in outline.edges().enumerate() {
        let arcs = four_arcs(psi, BULGE, &view, from, to);
        flux = plus(flux, arcs.flux);
        let [q, r] = arcs.quarters;
        let samples = [arcs.middle, q, r];
        let count = if outline.is_on_horizon(i) { 0 } else { rule.samples() };
        outlined.add(&view, from.c, arcs.middle, &samples[..count]);
    }
    if rule == NormalsRule::Exact {
        flux = exact::flux(&view, &outline.corners);
    }
    let along_view = dot(flux, view.stretched);
    let side = if along_view < T::ZERO { -T::ONE } else { T::ONE };
    if sides == Sides::One && along_view < T::ZERO {
        return None;
    }
    let visible = (along_view * side * to_visible(&view)).min(T::ONE);
    let flux = scaled(flux, side);
    Some(if rule == NormalsRule::Fast {
        mean::by_corners(&view, vertices, flux, visible)
    } else {
        mean::by_outline(&view, &outlined, flux, visible, rule)
    })
}

/// The part V of the visible normals that reflect a polygon's light, from the exact integrals of its edges. It is
/// positive on the lit side and negative on the back.
#[must_use]
pub fn visible<T: Scalar>(alpha: [T; 2], wo: Triple<T>, vertices: &[Triple<T>]) -> T {
    let view = View::new(alpha, wo);
    let outline = Outline::new(&view, vertices);
    if outline.corners.len() < 3 {
        return T::ZERO;
    }
    dot(exact::flux(&view, &outline.corners), view.stretched) * to_visible(&view)
}

/// Like [`visible`], from four arcs per edge. `bulge` is how far outside of the image the arcs meet. All rules use
/// [`BULGE`]; the angles are those of `balanced` and `fine`.
#[must_use]
pub fn visible_by_arcs<T: Scalar>(alpha: [T; 2], wo: Triple<T>, vertices: &[Triple<T>], bulge: [f64; 2]) -> T {
    let view = View::new(alpha, wo);
    let outline = Outline::new(&view, vertices);
    let edges = outline.edges().map(|(from, to)| four_arcs(&CLOSE, bulge, &view, from, to));
    let flux = edges.fold([T::ZERO; 3], |sum, edge| plus(sum, edge.flux));
    if outline.corners.len() < 3 { T::ZERO } else { dot(flux, view.stretched) * to_visible(&view) }
}

/// The factor from the integral of `c x dc` along `A wo` to the part of the visible normals.
fn to_visible<T: Scalar>(view: &View<T>) -> T {
    T::of(std::f64::consts::FRAC_1_PI) / (view.wo[2] + view.length)
}
