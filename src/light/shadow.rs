//! Light with shadows: the unshadowed light minus the hidden part, estimated with draws of [`LightSampler`].
//!
//! ```text
//! shadowed = light - E[(1 - V(wi)) brdf(wo, wi) cos / pdf(wi)]
//! ```
//!
//! The estimate is not biased, and has no error where nothing is hidden [Heitz, Hill and `McGuire` 2018, section 2].

use glam::DVec3;

use super::{LightError, PolygonLight, ReflectedLight, sample::LightSampler};
use ltcforge_fit::{
    BrdfModel, Configuration,
    math::{Lattice, direction},
};

/// A solid or a triangle that hides light, relative to the shaded point in its tangent frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Occluder {
    /// A sphere.
    Sphere {
        /// The centre.
        centre: DVec3,
        /// The radius, above zero.
        radius: f64,
    },
    /// A box along the axes of the tangent frame.
    Box {
        /// The smallest coordinates.
        low: DVec3,
        /// The largest coordinates.
        high: DVec3,
    },
    /// A triangle.
    Triangle([DVec3; 3]),
}

/// The reason why an occluder is invalid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum OccluderError {
    /// The shaded point is inside or on the surface.
    #[error("the {0} contains the shaded point, which is the origin: move it away")]
    Contains(&'static str),
    /// A length is zero or negative.
    #[error("the {0} has no extent: {1}")]
    Empty(&'static str, &'static str),
}

/// The distance from the shaded point below which a triangle contains it, relative to its longest side.
const TOUCHING: f64 = 1e-9;

impl Occluder {
    /// The name of the shape.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Sphere { .. } => "sphere",
            Self::Box { .. } => "box",
            Self::Triangle(_) => "triangle",
        }
    }

    /// Checks the occluder.
    ///
    /// # Errors
    /// [`OccluderError`] for an occluder that contains the shaded point, or has no extent.
    pub fn check(&self) -> Result<(), OccluderError> {
        let (empty, contains) = match *self {
            Self::Sphere { centre, radius } => {
                ((radius <= 0.0).then_some("its radius must be above 0"), centre.length() <= radius)
            }
            Self::Box { low, high } => (
                low.cmpge(high).any().then_some("each upper coordinate must be above the lower one"),
                low.cmple(DVec3::ZERO).all() && high.cmpge(DVec3::ZERO).all(),
            ),
            Self::Triangle([a, b, c]) => {
                let normal = (b - a).cross(c - a);
                let longest = (b - a).length().max((c - a).length()).max((c - b).length());
                let foot = normal * (a.dot(normal) / normal.length_squared());
                let inside = |p: DVec3| {
                    [(a, b), (b, c), (c, a)].iter().all(|(from, to)| (*to - *from).cross(p - *from).dot(normal) >= 0.0)
                };
                let touches = foot.length() <= TOUCHING * longest && inside(DVec3::ZERO);
                ((normal == DVec3::ZERO).then_some("its corners must not be collinear"), touches)
            }
        };
        match (empty, contains) {
            (Some(why), _) => Err(OccluderError::Empty(self.name(), why)),
            (None, true) => Err(OccluderError::Contains(self.name())),
            (None, false) => Ok(()),
        }
    }

    /// True if the occluder blocks the way from the shaded point to the distance `far` in direction `wi`, of unit
    /// length.
    #[must_use]
    pub fn blocks(&self, wi: DVec3, far: f64) -> bool {
        match *self {
            Self::Sphere { centre, radius } => {
                let along = centre.dot(wi);
                let half2 = radius * radius - (centre - along * wi).length_squared();
                half2 > 0.0 && along > 0.0 && along - half2.sqrt() < far
            }
            Self::Box { low, high } => {
                let (mut near, mut end) = (0.0_f64, far);
                for axis in 0..3 {
                    if wi[axis] == 0.0 {
                        if low[axis] >= 0.0 || high[axis] <= 0.0 {
                            return false;
                        }
                        continue;
                    }
                    let [first, second] = [low[axis] / wi[axis], high[axis] / wi[axis]];
                    near = near.max(first.min(second));
                    end = end.min(first.max(second));
                }
                near < end
            }
            Self::Triangle([a, b, c]) => {
                let turns = [(a, b), (b, c), (c, a)].map(|(from, to)| wi.dot(from.cross(to)));
                let normal = (b - a).cross(c - a);
                let distance = a.dot(normal) / wi.dot(normal);
                let is_inside = turns.iter().all(|turn| *turn > 0.0) || turns.iter().all(|turn| *turn < 0.0);
                is_inside && distance > 0.0 && distance < far
            }
        }
    }
}

/// The light that a surface reflects if occluders hide a part of the light. `light` is the unshadowed light. It is
/// reduced by the mean of `count` draws, at points of a lattice.
///
/// # Errors
/// [`LightError::Domain`] for a count of zero, and the errors of [`LightSampler::normals`].
pub fn shadowed(
    brdf: &BrdfModel,
    at: &Configuration,
    light: &PolygonLight,
    unshadowed: ReflectedLight,
    occluders: &[Occluder],
    count: u32,
) -> Result<ReflectedLight, LightError> {
    if count == 0 {
        return Err(LightError::Domain { what: "the count of draws", value: 0.0, allowed: "it must be at least 1" });
    }
    let sampler = LightSampler::normals(at, light)?;
    let surface = brdf.surface([at.alpha_x, at.alpha_y]);
    let wo = direction(at.theta, at.phi);
    let mut hidden = [0.0; 2];
    for u in Lattice::new(count as usize, [0.0; 2]).points() {
        let Some(drawn) = sampler.sample(u) else { break };
        let far = light.distance(drawn.wi);
        if occluders.iter().any(|occluder| occluder.blocks(drawn.wi, far)) {
            let weight = surface.eval_cos(wo, drawn.wi) / drawn.pdf / f64::from(count);
            let grazing = (1.0 - wo.dot((wo + drawn.wi).normalize())).max(0.0);
            hidden = [hidden[0] + weight, hidden[1] + weight * grazing.powi(5)];
        }
    }
    Ok(ReflectedLight { energy: unshadowed.energy - hidden[0], fresnel: unshadowed.fresnel - hidden[1] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        cases::{Draw, Roughness},
        truth,
    };
    use ltcforge_fit::{BrdfKind, Sides};

    /// A triangle far in front of the light hides the part of the light behind it. The closed form of the rest is exact.
    #[test]
    fn a_hidden_half_is_the_light_of_the_other_half() {
        let brdf = BrdfModel::from(BrdfKind::Ggx);
        let mut worst = 0.0_f64;
        for lit in Draw::many(64_000, 60, Roughness::All).iter().filter(|lit| lit.at.alpha_x.min(lit.at.alpha_y) > 0.05)
        {
            let [a, b, c, d] = lit.vertices[..] else { panic!("a rectangle") };
            let whole = lit.light(Sides::Two);
            let half = PolygonLight::new(vec![a, a.midpoint(b), d.midpoint(c), d], Sides::Two).expect("convex");
            let [left, right] = [a.midpoint(b), d.midpoint(c)];
            // Triangles from the shaded point's side that cover the half next to b and c, and more.
            let [far_b, far_c] = [left + 4.0 * (b - left), right + 4.0 * (c - right)];
            let up = 4.0 * (right - left);
            let corners = [left - up, far_b - up, far_c + up, right + up].map(|corner| 0.5 * corner);
            let [p, q, r, s] = corners;
            let hiding = [Occluder::Triangle([p, q, r]), Occluder::Triangle([p, r, s])];
            let beyond = [[p, q, r], [p, r, s]].map(|corners| Occluder::Triangle(corners.map(|v| v * 3.0)));
            let light = truth(&lit.at, &whole).expect("a truth");
            let of =
                |occluders: &[Occluder]| shadowed(&brdf, &lit.at, &whole, light, occluders, 1 << 14).expect("light");
            assert_eq!(of(&beyond), light);
            let expected = truth(&lit.at, &half).expect("a truth");
            let found = of(&hiding);
            let error = (found.energy - expected.energy).abs() + (found.fresnel - expected.fresnel).abs();
            worst = worst.max(error);
            assert!(error < 0.01, "{lit:?}: {found:?} {expected:?}");
        }
        println!("off by at most {worst:.1e}");
    }

    #[test]
    fn solids_block_the_way_to_the_light_and_not_beyond() {
        let up = DVec3::Z;
        let shapes = [
            Occluder::Sphere { centre: DVec3::new(0.1, 0.0, 2.0), radius: 0.5 },
            Occluder::Box { low: DVec3::new(-0.1, -0.1, 1.5), high: DVec3::new(0.2, 0.2, 2.5) },
            Occluder::Triangle([DVec3::new(-1.0, -1.0, 2.0), DVec3::new(1.0, -1.0, 2.0), DVec3::new(0.0, 1.0, 2.0)]),
        ];
        for shape in shapes {
            assert_eq!(shape.check(), Ok(()));
            assert!(shape.blocks(up, 3.0) && !shape.blocks(up, 1.0), "{shape:?}");
            assert!(!shape.blocks(-up, 3.0) && !shape.blocks(DVec3::X, 9.0), "{shape:?}");
            assert!(!shape.blocks(DVec3::new(0.6, 0.0, 0.8), 3.0), "{shape:?}");
        }
    }

    #[test]
    fn occluders_at_the_shaded_point_or_without_extent_are_named() {
        let ball = |centre, radius| Occluder::Sphere { centre, radius }.check().map_err(|error| error.to_string());
        let refused = ball(DVec3::Z, 1.0).expect_err("it touches");
        assert!(refused.contains("sphere contains the shaded point"), "{refused}");
        assert!(ball(DVec3::Z, 0.0).expect_err("a point").contains("radius must be above 0"));
        let flat = Occluder::Box { low: DVec3::ONE, high: DVec3::new(2.0, 1.0, 2.0) };
        assert!(matches!(flat.check(), Err(OccluderError::Empty("box", _))));
        let around = Occluder::Box { low: DVec3::new(-1.0, -1.0, 0.0), high: DVec3::ONE };
        assert_eq!(around.check(), Err(OccluderError::Contains("box")));
        let floor = [DVec3::new(-1.0, -1.0, 0.0), DVec3::new(1.0, -1.0, 0.0), DVec3::new(0.0, 1.0, 0.0)];
        assert_eq!(Occluder::Triangle(floor).check(), Err(OccluderError::Contains("triangle")));
        assert_eq!(Occluder::Triangle(floor.map(|v| v + DVec3::Y * 3.0)).check(), Ok(()));
        let line = [DVec3::X, DVec3::X * 2.0, DVec3::X * 3.0];
        assert!(matches!(Occluder::Triangle(line).check(), Err(OccluderError::Empty("triangle", _))));
    }
}
