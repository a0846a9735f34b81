//! Compares shapes in the closed form with finer polygons and other integrals.

use std::f64::consts::TAU;

use glam::DVec3;
use rayon::prelude::*;

use crate::cases::{Draw, Lit, Roughness};
use crate::{
    LightError, NormalsRule, PolygonLight, TubeEnds, by_normals, disk, ellipse, line, normals::visible, rectangle,
    truth_within, tube,
};
use ltcforge_fit::{
    Configuration, Sides,
    brdf::{Brdf, Ggx},
    math::direction,
};

const AT: Configuration = Configuration { alpha_x: 0.4, alpha_y: 0.15, theta: 0.8, phi: 0.3 };

fn exact(at: &Configuration, light: &PolygonLight) -> f64 {
    truth_within(1e-9, at, light).expect("a surface").energy
}

/// The solid angle of a convex polygon, from a fan of triangles [Van Oosterom and Strackee 1983].
fn solid_angle(vertices: &[DVec3]) -> f64 {
    let v: Vec<DVec3> = vertices.iter().map(|v| v.normalize()).collect();
    let triangle = |i: usize| {
        let (a, b, c) = (v[0], v[i], v[i + 1]);
        2.0 * a.dot(b.cross(c)).atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
    };
    (1..v.len() - 1).map(triangle).sum::<f64>().abs()
}

#[test]
fn a_rectangle_is_lit_on_the_side_of_its_normal() {
    let (centre, x, y) = (DVec3::new(-0.8, 0.1, 1.0), 0.4 * DVec3::X, 0.3 * DVec3::Y);
    let energy = |light: PolygonLight| by_normals(&AT, &light, NormalsRule::Balanced).expect("a surface").energy;
    assert!(energy(rectangle(centre, [y, x], Sides::One).expect("a light")) > 0.01);
    assert_eq!(energy(rectangle(centre, [x, y], Sides::One).expect("a light")), 0.0);
    assert!(energy(disk(centre, -DVec3::Z, 0.4, Sides::One).expect("a light")) > 0.01);
    assert_eq!(energy(disk(centre, DVec3::Z, 0.4, Sides::One).expect("a light")), 0.0);
}

/// Compares the polygon of 32 vertices with a polygon of 2048.
#[test]
fn an_ellipse_is_as_good_as_a_finer_one() {
    for (roughness, limits) in [(Roughness::All, [3e-5, 1e-3]), (Roughness::Extreme, [1e-4, 3e-3])] {
        let mut draw = Draw::new(71);
        let cases: Vec<_> = (0..300).map(|_| draw.lit(roughness)).collect();
        let error = |lit: &Lit| {
            let [a, b, c, _] = lit.vertices[..] else { panic!("four vertices") };
            let (centre, x, y) = (a.midpoint(c), 0.5 * (b - a), 0.5 * (c - b));
            let fine = (0..2048).map(|i| f64::from(i) * TAU / 2048.0);
            let fine = fine.map(|angle| centre + x * angle.cos() + y * angle.sin()).map(|v| v.to_array());
            let fine: Vec<[f64; 3]> = fine.collect();
            let covered = |vertices: &[[f64; 3]]| visible(lit.alpha(), lit.wo().to_array(), vertices).abs();
            let light = ellipse(centre, [x, y], Sides::Two).expect("a light");
            let vertices: Vec<[f64; 3]> = light.vertices().iter().map(DVec3::to_array).collect();
            (covered(&vertices) - covered(&fine)).abs()
        };
        let errors: Vec<f64> = cases.par_iter().map(error).collect();
        let (mean, worst) = (errors.iter().sum::<f64>() / 300.0, errors.iter().copied().fold(0.0, f64::max));
        println!("{roughness:?}: V of an ellipse is off by {mean:.1e}, {worst:.1e} at most");
        assert!(mean < limits[0] && worst < limits[1], "{roughness:?}: {mean} {worst}");
    }
}

/// A sphere is seen as a cone. A cylinder from its side is seen as a strip between tangents.
#[test]
fn tubes_have_the_solid_angles_of_spheres_and_cylinders() {
    let centre = DVec3::new(0.3, -1.0, 2.0);
    let sphere = tube([centre; 2], 0.5, TubeEnds::Round).expect("a light");
    let cosine = (1.0 - 0.25 / centre.length_squared()).sqrt();
    let wanted = TAU * (1.0 - cosine);
    let found = solid_angle(sphere.vertices());
    assert!((found / wanted - 1.0).abs() < 0.007 && found < wanted, "{found} {wanted}");

    // A long cylinder at distance d covers 2 asin(r / d) between its tangents and nearly half a turn along its axis.
    let long = tube([DVec3::new(-1e4, 0.0, 2.0), DVec3::new(1e4, 0.0, 2.0)], 0.5, TubeEnds::Flat).expect("a light");
    let wanted = 4.0 * 0.25_f64.asin();
    let found = solid_angle(long.vertices());
    assert!((found / wanted - 1.0).abs() < 1e-3, "{found} {wanted}");

    // Round ends add the difference between a sphere and a disk.
    let ends = [DVec3::new(-0.7, 0.4, 1.5), DVec3::new(0.9, 0.2, 2.0)];
    let [flat, round] = [TubeEnds::Flat, TubeEnds::Round].map(|shape| tube(ends, 0.2, shape).expect("a light"));
    assert!(solid_angle(round.vertices()) > solid_angle(flat.vertices()));
}

/// Rays hit a tube if and only if they hit its polygon. The test uses the distance between a ray and the axis of the
/// tube.
#[test]
fn a_tubes_outline_is_what_rays_meet() {
    let mut draw = Draw::new(72);
    let (mut met, mut missed) = (0, 0);
    for i in 0..200 {
        let ends = [draw.vector() * 1.5, draw.vector() * 1.5];
        let radius = draw.within(0.05, 0.6);
        let shape = if i % 2 == 0 { TubeEnds::Round } else { TubeEnds::Flat };
        let light = match tube(ends, radius, shape) {
            Ok(light) => light,
            Err(refused) => {
                assert_eq!(refused, LightError::Inside);
                continue;
            }
        };
        let vertices = light.vertices();
        let inside: DVec3 = vertices.iter().sum();
        let planes: Vec<DVec3> = vertices
            .iter()
            .zip(vertices.iter().cycle().skip(1))
            .map(|(a, b)| a.cross(*b))
            .map(|plane| if plane.dot(inside) < 0.0 { -plane } else { plane })
            .collect();
        for _ in 0..200 {
            let towards = ends[0].lerp(ends[1], draw.within(-0.3, 1.3)) + draw.vector() * radius;
            let ray = towards.normalize();
            let is_in_outline = planes.iter().all(|plane| plane.dot(ray) > 0.0);
            // Rays that hit a tube with 0.98 times the radius hit the polygon. Rays that hit the polygon hit a tube
            // with 1.0001 times the radius.
            let (surely, at_most) = (meets(ray, ends, 0.98, radius, shape), meets(ray, ends, 1.0001, radius, shape));
            assert!(is_in_outline || !surely, "{shape:?} {ends:?} {radius} {ray}");
            assert!(!is_in_outline || at_most, "{shape:?} {ends:?} {radius} {ray}");
            met += u32::from(surely);
            missed += u32::from(!at_most);
        }
    }
    assert!(met > 5000 && missed > 5000, "{met} met, {missed} missed");
}

/// True if a ray hits the tube with `scale` times its radius. Flat ends move outwards by the same distance as the side.
fn meets(ray: DVec3, ends: [DVec3; 2], scale: f64, radius: f64, shape: TubeEnds) -> bool {
    let axis = (ends[1] - ends[0]).normalize();
    let longer = (scale - 1.0) * radius * if shape == TubeEnds::Flat { 1.0 } else { 0.0 };
    let (from, to) = (ends[0] - axis * longer, ends[1] + axis * longer);
    let length = from.distance(to);
    let is_near = |t: f64| {
        let point = ray * t - from;
        let along = point.dot(axis);
        let radial = (point - axis * along).length();
        match shape {
            TubeEnds::Round => point.distance(axis * along.clamp(0.0, length)) <= scale * radius,
            TubeEnds::Flat => (0.0..=length).contains(&along) && radial <= scale * radius,
        }
    };
    // Tubes of both shapes are convex, so the part of the ray inside is an interval. Fine steps and the point nearest
    // to the line find it.
    let across = ray - axis * ray.dot(axis);
    let base = from - axis * from.dot(axis);
    let nearest = across.dot(base) / across.length_squared().max(1e-12);
    std::iter::once(nearest).chain((0..4000).map(|i| f64::from(i) * 0.002)).any(|t| t > 0.0 && is_near(t))
}

/// The integral over a line light: radiance times width times the BRDF, over the angle of the line.
#[test]
fn a_line_light_is_an_integral_over_the_line() {
    const WIDTH: f64 = 1e-4;
    let mut draw = Draw::new(73);
    for _ in 0..100 {
        let at = Configuration {
            alpha_x: draw.within(0.2, 0.8),
            alpha_y: draw.within(0.2, 0.8),
            ..draw.configuration(Roughness::All)
        };
        let mut end = || draw.vector() + DVec3::new(0.0, 0.0, 1.5);
        let ends = [end(), end()];
        if ends.iter().any(|end| end.z < 0.1 || end.length() < 0.3) {
            continue;
        }
        let ggx = Ggx { alpha_x: at.alpha_x, alpha_y: at.alpha_y };
        let (wo, along) = (direction(at.theta, at.phi), ends[1] - ends[0]);
        let n = 4000;
        let slice = |i: i32| {
            let place = ends[0] + along * ((f64::from(i) + 0.5) / f64::from(n));
            let distance = place.length();
            // A piece of the line seen from the side, divided by the squared distance, times the width.
            ggx.eval_cos(wo, place / distance) * along.cross(place / distance).length() / (distance * distance)
        };
        let wanted = (0..n).map(slice).sum::<f64>() / f64::from(n);
        let light = line(ends, WIDTH).expect("a light");
        let found = exact_thin(&at, &light) / WIDTH;
        assert!((found - wanted).abs() < 1e-3 * wanted + 1e-4, "{found} {wanted} {at:?} {ends:?}");
        let closed = by_normals(&at, &light, NormalsRule::Balanced).expect("a surface").energy / WIDTH;
        assert!((closed - wanted).abs() < 0.05 * wanted + 0.02, "{closed} {wanted} {at:?} {ends:?}");
        // A thin tube gives the same light.
        let thin = tube(ends, 0.5 * WIDTH, TubeEnds::Flat).expect("a light");
        let thin = by_normals(&at, &thin, NormalsRule::Balanced).expect("a surface").energy / WIDTH;
        assert!((thin - closed).abs() < 2e-3 * closed + 1e-3, "{thin} {closed}");
    }
}

fn exact_thin(at: &Configuration, light: &PolygonLight) -> f64 {
    truth_within(1e-11, at, light).expect("a surface").energy
}

#[test]
fn degenerate_shapes_are_dark_or_refused() {
    let up = DVec3::new(-0.6, 0.2, 1.0);
    let nothing = [
        rectangle(up, [DVec3::ZERO, DVec3::X], Sides::Two),
        rectangle(up, [DVec3::ZERO; 2], Sides::Two),
        ellipse(up, [DVec3::X, DVec3::X], Sides::Two),
        disk(up, DVec3::Z, 0.0, Sides::Two),
        line([up, up], 0.1),
        line([up, 2.0 * up], 0.1),
        line([up, up + DVec3::X], 0.0),
        tube([up; 2], 0.0, TubeEnds::Round),
        tube([up, up + DVec3::X], 0.0, TubeEnds::Round),
        tube([up, up + DVec3::X], 0.0, TubeEnds::Flat),
        tube([-up, -up + DVec3::X], 0.1, TubeEnds::Flat),
    ];
    for light in nothing {
        let light = light.expect("a light of no size");
        let found = by_normals(&AT, &light, NormalsRule::Balanced).expect("a surface");
        assert!(found.energy.abs() < 1e-12 && found.fresnel.abs() < 1e-12, "{light:?}: {found:?}");
        assert!(exact(&AT, &light).abs() < 1e-12, "{light:?}");
    }
    let refused = [
        rectangle(up * f64::NAN, [DVec3::X, DVec3::Y], Sides::One),
        ellipse(up, [DVec3::X * f64::INFINITY, DVec3::Y], Sides::One),
        disk(up, DVec3::ZERO, 1.0, Sides::One),
        disk(up, DVec3::Z, -1.0, Sides::One),
        disk(up, DVec3::Z, f64::NAN, Sides::One),
        line([up, up * f64::NAN], 0.1),
        line([up, -up], f64::INFINITY),
        tube([up, up * 1.1], 5.0, TubeEnds::Round),
        tube([-up, up], 0.1, TubeEnds::Flat),
        tube([up; 2], 0.1, TubeEnds::Flat),
        tube([up, up * f64::INFINITY], 0.1, TubeEnds::Round),
    ];
    for (i, light) in refused.into_iter().enumerate() {
        assert!(light.is_err(), "{i}: {light:?}");
    }
    // A mirror sees only the sphere around the mirror direction.
    let mirror = Configuration { alpha_x: 1e-3, alpha_y: 1e-3, theta: 0.0, phi: 0.0 };
    let sphere = tube([DVec3::Z * 2.0; 2], 1.0, TubeEnds::Round).expect("a light");
    assert!((exact(&mirror, &sphere) - 1.0).abs() < 1e-3);
}
