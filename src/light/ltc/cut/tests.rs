use std::f64::consts::TAU;

use glam::{DMat3, DVec3};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::*;
use ltcforge_fit::{Ltc, lobe::ltc::cases::mirror_like, math::Lattice};

struct Draw(Xoshiro256PlusPlus);

impl Draw {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * ((self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64)
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.within(-1.0, 1.0), self.within(-1.0, 1.0), self.within(-1.0, 1.0))
    }

    /// A lobe that the surface cuts. Every other matrix has a negative determinant.
    fn matrix(&mut self, index: usize) -> DMat3 {
        let [alpha_x, alpha_y] = [0, 1].map(|_| 10_f64.powf(self.within(-1.3, 0.0)));
        let m = mirror_like(alpha_x, alpha_y, self.within(0.8, 1.55), self.within(0.0, TAU));
        if index.is_multiple_of(2) { m } else { m * DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0)) }
    }
}

/// A light of each shape.
#[derive(Debug, Clone)]
enum Light {
    Polygon(Vec<DVec3>),
    Disk(DVec3, [DVec3; 2]),
    Sphere(DVec3, f64),
    Tube([DVec3; 2], f64),
    Line([DVec3; 2], f64),
}

impl Light {
    /// A light of each shape around a lobe, of any size.
    fn all(draw: &mut Draw, m: DMat3) -> [Self; 5] {
        let centre = (m * (draw.vector() + 0.3 * DVec3::Z)).normalize();
        let size = 10_f64.powf(draw.within(-1.5, 0.7));
        let [x, y] = [draw.vector() * size, draw.vector() * size];
        let radius = 0.9 * draw.within(0.0, 1.0);
        [
            Self::Polygon(vec![centre - x - y, centre + x - y, centre + x + y, centre - x + y]),
            Self::Disk(centre, [x, y]),
            Self::Sphere(centre, radius),
            Self::Tube([centre - x, centre + x], 0.3 * radius),
            Self::Line([centre - x, centre + x], 1e-3),
        ]
    }

    fn below(&self) -> Self {
        let flip = |v: &DVec3| DVec3::new(v.x, v.y, -v.z);
        match self {
            Self::Polygon(vertices) => Self::Polygon(vertices.iter().map(flip).collect()),
            Self::Disk(centre, axes) => Self::Disk(flip(centre), [flip(&axes[0]), flip(&axes[1])]),
            Self::Sphere(centre, radius) => Self::Sphere(flip(centre), *radius),
            Self::Tube(ends, radius) => Self::Tube([flip(&ends[0]), flip(&ends[1])], *radius),
            Self::Line(ends, width) => Self::Line([flip(&ends[0]), flip(&ends[1])], *width),
        }
    }

    fn covered(&self, ltc: &Ltc) -> f64 {
        let space = CosineSpace::from(ltc);
        match self {
            Self::Polygon(vertices) => ltc.polygon(vertices, Sides::Two),
            Self::Disk(centre, axes) => space.ellipse(*centre, *axes, Sides::Two),
            Self::Sphere(centre, radius) => space.sphere(*centre, *radius),
            Self::Tube(ends, radius) => space.tube(*ends, *radius),
            Self::Line(ends, width) => space.line(*ends, *width),
        }
    }

    fn covered_above(&self, ltc: &Ltc) -> f64 {
        let above = CosineSpace::from(ltc).above_surface();
        match self {
            Self::Polygon(vertices) => above.polygon(vertices, Sides::Two),
            Self::Disk(centre, axes) => above.ellipse(*centre, *axes, Sides::Two),
            Self::Sphere(centre, radius) => above.sphere(*centre, *radius),
            Self::Tube(ends, radius) => above.tube(*ends, *radius),
            Self::Line(ends, width) => above.line(*ends, *width),
        }
    }

    /// True if the shaded point is inside of the light. Everything above and below is then lit.
    fn is_around(&self) -> bool {
        match self {
            Self::Sphere(centre, radius) => centre.length() <= *radius,
            Self::Tube([a, b], radius) => {
                let t = (-a.dot(*b - *a) / (*b - *a).length_squared()).clamp(0.0, 1.0);
                (*a + (*b - *a) * t).length() <= *radius
            }
            _ => false,
        }
    }

    /// True if a ray hits the light. No ray hits a line.
    fn meets(&self, w: DVec3) -> bool {
        let in_sphere = |centre: DVec3, radius: f64| {
            let along = centre.dot(w);
            along > 0.0 && (centre - w * along).length() < radius
        };
        match self {
            Self::Polygon(vertices) => {
                let edges = vertices.iter().zip(vertices.iter().cycle().skip(1));
                let sides: Vec<bool> = edges.map(|(a, b)| a.cross(*b).dot(w) > 0.0).collect();
                let normal = (vertices[1] - vertices[0]).cross(vertices[2] - vertices[0]);
                sides.iter().all(|side| *side == sides[0]) && normal.dot(w) * normal.dot(vertices[0]) > 0.0
            }
            Self::Disk(centre, [x, y]) => {
                let inverse = DMat3::from_cols(*x, *y, *centre).inverse() * w;
                inverse.z > 0.0 && inverse.x.hypot(inverse.y) < inverse.z
            }
            Self::Sphere(centre, radius) => in_sphere(*centre, *radius),
            // The distance of the ray grows on both sides of the nearest point of the line.
            Self::Tube([a, b], radius) => {
                let at = |t: f64| *a + (*b - *a) * t;
                let distance = |t: f64| (at(t) - w * at(t).dot(w).max(0.0)).length();
                let (mut low, mut high) = (0.0, 1.0);
                for _ in 0..80 {
                    let third = (high - low) / 3.0;
                    if distance(low + third) < distance(high - third) { high -= third } else { low += third }
                }
                distance(low) < *radius
            }
            Self::Line(..) => false,
        }
    }
}

/// The part of a distribution above the surface, and the part of its mirror image above the surface.
fn parts(ltc: &Ltc, below: &Ltc) -> [f64; 2] {
    [ltc, below].map(|ltc| CosineSpace::from(ltc).part_above())
}

/// The parts above and below add up to the whole light, for every shape. The part below comes from the same code, with
/// everything mirrored at the surface.
#[test]
fn above_and_below_make_a_whole() {
    let mut draw = Draw(Xoshiro256PlusPlus::seed_from_u64(3));
    let mut cut = [0; 5];
    for index in 0..3000 {
        let m = draw.matrix(index);
        let ltc = Ltc::new(m).expect("regular");
        let below = Ltc::new(DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0)) * m).expect("regular");
        let [part, rest] = parts(&ltc, &below);
        assert!((part + rest - 1.0).abs() < 1e-12, "{part} {rest}");
        for (light, cut) in Light::all(&mut draw, m).iter().zip(&mut cut) {
            if light.is_around() {
                assert_eq!(light.covered_above(&ltc), 1.0);
                continue;
            }
            let found = [part * light.covered_above(&ltc), rest * light.below().covered_above(&below)];
            let whole = light.covered(&ltc);
            assert!((found[0] + found[1] - whole).abs() < 1e-9, "{found:?} {whole}: {m} {light:?}");
            *cut += usize::from(found.iter().all(|part| *part > 1e-6));
        }
    }
    assert!(cut.iter().all(|count| *count > 200), "{cut:?}");
}

/// Compares with the number of samples above the surface.
#[test]
fn samples_above_the_surface_are_counted() {
    const COUNT: usize = 1 << 14;
    let mut draw = Draw(Xoshiro256PlusPlus::seed_from_u64(4));
    for index in 0..24 {
        let m = draw.matrix(index);
        let ltc = Ltc::new(m).expect("regular");
        let drawn = Lattice::new(COUNT, [0.0; 2]);
        let samples: Vec<DVec3> = drawn.points().map(|u| ltc.sample(u)).filter(|w| w.z > 0.0).collect();
        let part = CosineSpace::from(&ltc).part_above();
        assert!((samples.len() as f64 / COUNT as f64 - part).abs() < 2e-3, "{} {part}", samples.len());
        for light in &Light::all(&mut draw, m)[..4] {
            let met = samples.iter().filter(|w| light.meets(**w) || light.is_around()).count();
            let (found, counted) = (light.covered_above(&ltc), met as f64 / samples.len() as f64);
            assert!((found - counted).abs() < 6e-3, "{found} {counted}: {m} {light:?}");
        }
    }
}

/// A wide light just above the surface covers the whole lobe. A light below covers nothing.
#[test]
fn a_sky_is_all_and_a_ground_nothing() {
    let mut draw = Draw(Xoshiro256PlusPlus::seed_from_u64(5));
    for index in 0..200 {
        let ltc = Ltc::new(draw.matrix(index)).expect("regular");
        let square = |z: f64| [[-1e7, -1e7, z], [1e7, -1e7, z], [1e7, 1e7, z], [-1e7, 1e7, z]].map(DVec3::from_array);
        let above = CosineSpace::from(&ltc).above_surface();
        let [sky, ground] = [1.0, -1.0].map(|z| above.polygon(&square(z), Sides::Two));
        assert!((sky - 1.0).abs() < 1e-5 && ground == 0.0, "{sky} {ground}");
        let disk = |z: f64| above.ellipse(z * DVec3::Z, [1e7 * DVec3::X, 1e7 * DVec3::Y], Sides::Two);
        assert!((disk(1.0) - 1.0).abs() < 1e-5 && disk(-1.0) == 0.0, "{}", disk(1.0));
        assert_eq!(above.sphere(DVec3::new(0.0, 0.3, -1.0), 0.9), 0.0);
    }
}

/// Each light is lit from one side only, for positive and negative determinants.
#[test]
fn a_light_has_a_dark_side() {
    let mut draw = Draw(Xoshiro256PlusPlus::seed_from_u64(6));
    let mut lit = [0; 2];
    for index in 0..400 {
        let m = draw.matrix(index);
        let above = CosineSpace::from(&Ltc::new(m).expect("regular")).above_surface();
        let [Light::Polygon(vertices), Light::Disk(centre, axes), ..] = Light::all(&mut draw, m) else {
            panic!("order")
        };
        let reversed: Vec<DVec3> = vertices.iter().rev().copied().collect();
        let two = above.polygon(&vertices, Sides::Two);
        let sides = [&vertices, &reversed].map(|vertices| above.polygon(vertices, Sides::One));
        assert!((sides[0] + sides[1] - two).abs() < 1e-12 && sides[0].min(sides[1]) < 1e-12, "{sides:?} {two}");
        // The corners run anticlockwise around the cross product of the half axes.
        let faces = centre.dot(axes[0].cross(axes[1])) < 0.0;
        assert!((sides[usize::from(faces)] - two).abs() < 1e-12, "{sides:?} {two} {faces}");
        let disk = |sides| above.ellipse(centre, axes, sides);
        assert_eq!(disk(Sides::One), if faces { disk(Sides::Two) } else { 0.0 });
        lit[usize::from(faces)] += usize::from(two > 0.01);
    }
    assert!(lit.iter().all(|count| *count > 50), "{lit:?}");
}
