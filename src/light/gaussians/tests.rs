//! Compares the Gaussians with quadrature and with their limits, and measures their difference from GGX.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;

use super::*;
use crate::cases::{Draw, Lit, Roughness};
use ltcforge_fit::math::{cos, direction, exp, sin_cos};

/// Surfaces from the sharpest to the roughest, including needles.
const SURFACES: [[f64; 2]; 6] = [[1e-5, 1e-5], [0.01, 0.01], [0.2, 0.05], [0.5, 0.5], [1.0, 1e-5], [1.0, 1.0]];

fn square(centre: DVec3, half: f64) -> Vec<[f64; 3]> {
    let x = centre.cross(DVec3::new(0.3, -0.2, 0.9)).normalize() * half;
    let y = centre.cross(x).normalize() * half;
    [centre - x - y, centre + x - y, centre + x + y, centre - x + y].map(|v| v.to_array()).to_vec()
}

/// The integral of `f` over all directions, on a grid that is uniform in azimuth and height.
fn over_sphere(f: impl Fn([f64; 3]) -> f64) -> f64 {
    const SIDE: u32 = 1200;
    let step = std::f64::consts::TAU / f64::from(SIDE);
    let mut sum = 0.0;
    for row in 0..SIDE {
        let z = (f64::from(row) + 0.5) / f64::from(SIDE) * 2.0 - 1.0;
        let radius = (1.0 - z * z).sqrt();
        for column in 0..SIDE {
            let (sin, cos) = sin_cos((f64::from(column) + 0.5) * step);
            sum += f([radius * cos, radius * sin, z]);
        }
    }
    sum * step * 2.0 / f64::from(SIDE)
}

#[test]
fn seen_face_on_both_warps_are_the_sharpness_of_the_article() {
    for alpha in [0.05, 0.3] {
        let wo = [0.0, 0.0, 1.0];
        for warp in [Warp::Visible, Warp::Surface] {
            for &gaussian in Gaussian::ALL {
                let lobe = Lobe::new(gaussian, warp, [alpha, alpha], wo);
                let w = direction(0.1, 0.4);
                let [x, y] = lobe.shape.at(w.to_array());
                // The wanted exponent is L (1 - cos) with L = 2 / alpha^2 / 4.
                let wanted = 0.5 / (alpha * alpha) * (1.0 - cos(0.1));
                assert!((x * x + y * y - wanted).abs() < 1e-9 * wanted && lobe.shape.axis == wo, "{gaussian} {warp:?}");
            }
        }
    }
    // Seen from the side, the warp around the surface normal has the two sharpnesses of Xu et al.
    let (theta, alpha) = (0.9, 0.2);
    let wo = direction(theta, 0.0).to_array();
    let lobe = Lobe::new(Gaussian::Asg, Warp::Surface, [alpha, alpha], wo);
    assert!((DVec3::from(lobe.shape.axis) - direction(theta, std::f64::consts::PI)).length() < 1e-12);
    let lengths = lobe.shape.rows.map(|row| DVec3::from(row).length());
    let wanted = [0.5 / alpha, 0.5 / (alpha * cos(theta))];
    assert!(lengths.iter().zip(wanted).all(|(found, wanted)| (found - wanted).abs() < 1e-9 * wanted), "{lengths:?}");
    // The round Gaussian has their geometric mean.
    let round = Lobe::new(Gaussian::Sg, Warp::Surface, [alpha, alpha], wo);
    let sharpness = DVec3::from(round.shape.rows[0]).length_squared();
    assert!((sharpness - wanted[0] * wanted[1]).abs() < 1e-9 * sharpness, "{sharpness}");
}

#[test]
fn deviations_are_how_reflections_move_when_normals_tilt() {
    for (alpha, theta) in [([0.3, 0.1], 0.4), ([0.02, 0.5], 1.2), ([0.6, 0.6], 1.5)] {
        let wo = direction(theta, 0.7);
        let s = DVec3::new(alpha[0] * wo.x, alpha[1] * wo.y, wo.z).normalize();
        let spread = (2.0 * (1.0 + s.z)).sqrt();
        let reflect = |u: DVec3| {
            let h = (DVec3::new(alpha[0], alpha[1], 1.0) * (u + s)).normalize();
            h * (2.0 * wo.dot(h)) - wo
        };
        let lobe = Lobe::new(Gaussian::Asg, Warp::Visible, alpha, wo.to_array());
        assert!((reflect(DVec3::Z) - DVec3::from(lobe.shape.axis)).length() < 1e-12);
        for (k, tilt) in [(0, DVec3::X), (1, DVec3::Y)] {
            let step = 1e-5 * spread;
            let moved = (reflect(DVec3::Z + tilt * step) - reflect(DVec3::Z - tilt * step)) / 2e-5;
            let found = lobe.shape.rows.map(|row| DVec3::from(row).dot(moved));
            assert!((found[k] - 1.0).abs() < 1e-7 && found[1 - k].abs() < 1e-7, "{alpha:?} {theta} {found:?}");
        }
    }
}

#[test]
fn narrow_gaussians_have_their_weight_as_integral() {
    for &gaussian in Gaussian::ALL {
        for (alpha, theta) in [([0.1, 0.1], 0.0), ([0.2, 0.1], 0.8), ([0.15, 0.3], 1.2)] {
            let lobe = Lobe::new(gaussian, Warp::Visible, alpha, direction(theta, 0.3).to_array());
            let whole = over_sphere(|w| lobe.density(w));
            assert!((whole - lobe.weight).abs() < 2e-3 * lobe.weight, "{gaussian} {alpha:?}: {whole} {}", lobe.weight);
            assert!((0.3..=1.0).contains(&lobe.weight), "{}", lobe.weight);
        }
    }
}

/// Compares the part of the Gaussian over a polygon light with a quadrature of the Gaussian.
#[test]
fn polygons_cover_about_what_the_gaussian_has_over_them() {
    let (mut sum, mut most, mut count) = (0.0, 0.0_f64, 0);
    for &gaussian in Gaussian::ALL {
        for (alpha, theta) in [([0.3, 0.1], 0.5), ([0.4, 0.4], 1.0), ([0.15, 0.5], 1.3)] {
            let lobe = Lobe::new(gaussian, Warp::Visible, alpha, direction(theta, 0.6).to_array());
            for (towards, half) in [(0.0, 0.15), (0.3, 0.3), (0.2, 0.8), (0.9, 0.5)] {
                let centre = (DVec3::from(lobe.shape.axis) + DVec3::new(0.7, -0.4, 0.2) * towards).normalize();
                let light = square(centre, half);
                let inside = |w: [f64; 3]| {
                    let w = DVec3::from(w);
                    let edges = (0..4).map(|i| DVec3::from(light[i]).cross(DVec3::from(light[(i + 1) % 4])).dot(w));
                    w.z > 0.0 && w.dot(centre) > 0.0 && edges.into_iter().all(|side| side > 0.0)
                };
                let wanted = over_sphere(|w| if inside(w) { lobe.density(w) } else { 0.0 }) / lobe.weight;
                let found = covered(&lobe.shape, &light, Sides::One);
                let off = (found - wanted).abs();
                (sum, most, count) = (sum + off, most.max(off), count + 1);
            }
        }
    }
    let mean = sum / f64::from(count);
    println!("mean {mean:.4}, most {most:.4}");
    assert!(mean < 0.02 && most < 0.07, "{mean} {most}");
}

#[test]
fn a_mirror_reflects_all_of_a_light_or_nothing() {
    for &gaussian in Gaussian::ALL {
        for theta in [0.0, 0.7, 1.4] {
            let wo = direction(theta, 0.3);
            let mirror = DVec3::new(-wo.x, -wo.y, wo.z);
            for (k, half) in (0..40_u32).flat_map(|k| [0.45, 1.2, 7.0].map(|half| (k, half))) {
                // With this offset, a light reaches farthest behind the mirror direction.
                let light = square(mirror + 1.2 * half * direction(1.1, f64::from(k)), half);
                let edge = |i: usize| DVec3::from(light[i]).cross(DVec3::from(light[(i + 1) % 4])).dot(mirror);
                let is_lit = (0..4).all(|i| edge(i) > 0.0);
                let [energy, _] = reflected(gaussian, [1e-5; 2], wo.to_array(), &light, Sides::Two);
                let wanted = if is_lit { 1.0 } else { 0.0 };
                assert!((energy - wanted).abs() < 1e-3, "{gaussian} {theta} {k} {half}: {energy}, not {wanted}");
            }
        }
    }
}

#[test]
fn a_tiny_light_reflects_its_size_times_the_density() {
    for &gaussian in Gaussian::ALL {
        for (alpha, theta) in [([0.3, 0.1], 0.5), ([0.4, 0.4], 1.1), ([0.6, 0.05], 1.3)] {
            let wo = direction(theta, 0.6).to_array();
            let lobe = Lobe::new(gaussian, Warp::Visible, alpha, wo);
            for towards in [0.0, 0.05, 0.3] {
                let centre = (DVec3::from(lobe.shape.axis) + DVec3::new(0.7, -0.4, 0.2) * towards).normalize();
                let [energy, fresnel] = reflected(gaussian, alpha, wo, &square(centre, 5e-4), Sides::One);
                let wanted = lobe.density(centre.to_array()) * 1e-6;
                // The error function is an approximation, and so is its derivative. The tolerance is relative to the
                // value at the centre.
                let middle = lobe.weight * lobe.shape.peak() * 1e-6;
                assert!((energy - wanted).abs() < 0.03 * middle, "{gaussian} {alpha:?} {towards}: {energy} {wanted}");
                assert!((fresnel - energy * lobe.schlick).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn every_light_on_every_surface_is_finite_and_no_brighter_than_itself() {
    let mut lit = 0;
    for &gaussian in Gaussian::ALL {
        for (alpha, theta) in
            SURFACES.iter().flat_map(|alpha| [0.0, 1.0, 1.5, FRAC_PI_2 - 1e-6].map(|theta| (*alpha, theta)))
        {
            let wo = direction(theta, 0.4);
            for (centre, half) in [
                (DVec3::new(0.0, 0.0, 1.0), 1e-9),
                (DVec3::new(0.3, -0.2, 0.0), 0.2),
                (DVec3::new(-wo.x, -wo.y, 1e-9), 0.5),
                (DVec3::new(0.1, 0.2, 1e-3), 40.0),
                (DVec3::new(0.2, 0.1, -0.5), 0.3),
                (DVec3::new(-wo.x, -wo.y, wo.z), 1.0),
            ] {
                let light = square(centre, half);
                for sides in [Sides::One, Sides::Two] {
                    let wide = reflected(gaussian, alpha, wo.to_array(), &light, sides);
                    let vertices: Vec<[f32; 3]> = light.iter().map(|v| v.map(|x| x as f32)).collect();
                    let narrow =
                        reflected(gaussian, alpha.map(|x| x as f32), wo.as_vec3().to_array(), &vertices, sides);
                    for [energy, fresnel] in [wide, narrow.map(f64::from)] {
                        let what = format!("{gaussian} {alpha:?} {theta} {centre} {half}");
                        assert!((0.0..=1.0).contains(&energy) && (0.0..=energy).contains(&fresnel), "{what}: {energy}");
                        lit += usize::from(energy > 0.1);
                    }
                }
            }
        }
    }
    assert!(lit > 100, "{lit}");
    // The part below the surface is zero.
    let below = square(DVec3::new(0.2, 0.1, -0.9), 0.2);
    assert_eq!(reflected(Gaussian::Asg, [0.5; 2], [0.0, 0.0, 1.0], &below, Sides::Two), [0.0; 2]);
}

#[test]
fn the_back_of_a_light_is_dark() {
    let wo = direction(0.6, 0.2);
    let mut light = square(DVec3::new(-wo.x, -wo.y, wo.z), 0.4);
    let of = |light: &[[f64; 3]], sides| reflected(Gaussian::Asg, [0.3, 0.2], wo.to_array(), light, sides)[0];
    let front = of(&light, Sides::One);
    assert!(front > 0.1 && front == of(&light, Sides::Two), "{front}");
    light.reverse();
    assert_eq!(of(&light, Sides::One), 0.0);
    assert!((of(&light, Sides::Two) - front).abs() < 1e-12);
}

#[test]
fn the_light_of_a_gaussian_is_an_inner_product() {
    for &gaussian in Gaussian::ALL {
        for (alpha, theta, sharpness) in [([0.3, 0.1], 0.5, 40.0), ([0.2, 0.2], 1.1, 200.0), ([0.1, 0.3], 0.9, 12.0)] {
            let wo = direction(theta, 0.6).to_array();
            let lobe = Lobe::new(gaussian, Warp::Visible, alpha, wo);
            let axis = (DVec3::from(lobe.shape.axis) + DVec3::new(0.1, -0.05, 0.1)).normalize();
            let light = SgLight { axis: axis.to_array(), sharpness, amplitude: 1.7 };
            let radiance = |w| 1.7 * exp(sharpness * (axis.dot(DVec3::from(w)) - 1.0));
            let wanted = over_sphere(|w| lobe.density(w) * radiance(w));
            let [energy, fresnel] = reflected_sg(gaussian, alpha, wo, &light);
            assert!((energy - wanted).abs() < 0.05 * wanted, "{gaussian} {alpha:?} {sharpness}: {energy} {wanted}");
            assert!((fresnel - energy * lobe.schlick).abs() < 1e-12);
        }
    }
    // Tests a light as sharp as a point and a light as wide as the sky.
    let wo = [0.0, 0.0, 1.0];
    let of = |sharpness| {
        reflected_sg(Gaussian::Sg, [0.5_f64; 2], wo, &SgLight { axis: [0.6, 0.0, 0.8], sharpness, amplitude: 1.0 })[0]
    };
    let lobe = Lobe::new(Gaussian::Sg, Warp::Visible, [0.5_f64; 2], wo);
    let point = std::f64::consts::TAU / 1e9 * lobe.density([0.6, 0.0, 0.8]);
    assert!((of(1e9) - point).abs() < 1e-6 * point && (of(1e-9) - lobe.weight).abs() < 1e-6);
}

/// Tests lights that the horizon cuts, on a rough surface seen from above. The horizon is 90 degrees from the axis
/// everywhere.
#[test]
fn single_and_double_precision_agree_where_the_horizon_is_a_quarter_away() {
    for (gaussian, k) in Gaussian::ALL.iter().flat_map(|gaussian| (0..60_u32).map(move |k| (*gaussian, f64::from(k)))) {
        let wo = direction(0.02 * k, 0.3 * k);
        let light = square(DVec3::new(cos(k), cos(k + 1.0), 0.2 * cos(2.0 * k)), 0.7);
        let [wide, _] = reflected(gaussian, [1.0; 2], wo.to_array(), &light, Sides::Two);
        let light: Vec<[f32; 3]> = light.iter().map(|v| v.map(|x| x as f32)).collect();
        let [narrow, _] = reflected(gaussian, [1.0; 2], wo.as_vec3().to_array(), &light, Sides::Two);
        assert!((f64::from(narrow) - wide).abs() < 1e-5 && wide > 0.005, "{gaussian} {k}: {narrow}, not {wide}");
    }
}

/// Positions on the cap of visible normals: part of its height, part of a turn.
const POINTS: [[f64; 2]; 4] = [[0.1, 0.1], [0.35, 0.7], [0.6, 0.35], [0.85, 0.9]];

/// The reflected light, as the mean over visible normals of `G2 / G1` times the radiance in the reflected direction.
fn over_normals(alpha: [f64; 2], wo: DVec3, radiance: impl Fn(DVec3) -> f64) -> f64 {
    const SIDE: u32 = 160;
    let stretch = DVec3::new(alpha[0], alpha[1], 1.0);
    let mu = |w: DVec3| w.z / (stretch * w).length();
    let mut sum = 0.0;
    for [row, column] in (0..SIDE).flat_map(|row| (0..2 * SIDE).map(move |column| [row, column].map(f64::from))) {
        let wi = reflected_at(alpha, wo, [(row + 0.5) / f64::from(SIDE), (column + 0.5) / f64::from(2 * SIDE)]);
        if wi.z > 0.0 {
            sum += (1.0 + mu(wo)) * mu(wi) / (mu(wi) + mu(wo)) * radiance(wi);
        }
    }
    sum / f64::from(2 * SIDE * SIDE)
}

/// The reflection of the visible normal at a part of the cap's height and of a turn.
fn reflected_at(alpha: [f64; 2], wo: DVec3, [height, turn]: [f64; 2]) -> DVec3 {
    let stretch = DVec3::new(alpha[0], alpha[1], 1.0);
    let s = (stretch * wo).normalize();
    let z = 1.0 - height * (1.0 + s.z);
    let (sin, cos) = sin_cos(std::f64::consts::TAU * turn);
    let h = (stretch * (DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z + s)).normalize();
    h * (2.0 * wo.dot(h)) - wo
}

/// Shows why the warp is around the central visible normal.
#[test]
fn the_warp_around_the_surface_s_normal_is_farther_off() {
    let mut errors = [0.0; 2];
    let mut count = 0;
    for alpha in [[0.05, 0.05], [0.2, 0.2], [0.3, 0.1], [0.5, 0.5], [0.6, 0.1]] {
        for (theta, u) in [0.2, 0.6, 1.0, 1.3, 1.5].into_iter().flat_map(|theta| POINTS.map(|u| (theta, u))) {
            let wo = direction(theta, 0.7);
            let centre = reflected_at(alpha, wo, u);
            let light = square(centre, 0.3);
            let edge = |i: usize| DVec3::from(light[i]).cross(DVec3::from(light[(i + 1) % 4]));
            let edges = [0, 1, 2, 3].map(edge);
            let is_light = |w: DVec3| w.dot(centre) > 0.0 && edges.iter().all(|edge| edge.dot(w) > 0.0);
            let wanted = over_normals(alpha, wo, |wi| f64::from(u8::from(is_light(wi))));
            for (error, warp) in errors.iter_mut().zip([Warp::Visible, Warp::Surface]) {
                let lobe = Lobe::new(Gaussian::Asg, warp, alpha, wo.to_array());
                *error += (lobe.weight * covered(&lobe.shape, &light, Sides::One) - wanted).abs();
            }
            count += 1;
        }
    }
    let [visible, surface] = errors.map(|error| error / f64::from(count));
    println!("around the middle visible normal {visible:.4}, around the surface normal {surface:.4}, {count} lights");
    assert!(visible < 0.7 * surface && visible < 0.05, "{visible} {surface}");
}

/// Tests lights of spherical Gaussians around the reflections of surfaces, with Gaussians of both warps.
#[test]
fn the_light_of_gaussians_is_as_far_off_as_the_docs_say() {
    let mut errors = [0.0; 4];
    let (mut count, mut energy) = (0, 0.0);
    for alpha in [[0.05, 0.05], [0.2, 0.2], [0.3, 0.1], [0.5, 0.5], [0.6, 0.1]] {
        for (theta, u) in [0.2, 0.6, 1.0, 1.3, 1.5].into_iter().flat_map(|theta| POINTS.map(|u| (theta, u))) {
            let wo = direction(theta, 0.7);
            let axis = reflected_at(alpha, wo, u);
            for sharpness in [5.0, 20.0, 100.0] {
                let wanted = over_normals(alpha, wo, |wi| exp(sharpness * (axis.dot(wi) - 1.0)));
                let light = SgLight { axis: axis.to_array(), sharpness, amplitude: 1.0 };
                let kinds = [Warp::Visible, Warp::Surface].map(|warp| [Gaussian::Sg, Gaussian::Asg].map(|g| (g, warp)));
                for (error, (gaussian, warp)) in errors.iter_mut().zip(kinds.into_iter().flatten()) {
                    let lobe = Lobe::new(gaussian, warp, alpha, wo.to_array());
                    *error += (reflected_sg_by(&lobe.shape, lobe.parts(), &light)[0] - wanted).abs();
                }
                (count, energy) = (count + 1, energy + wanted);
            }
        }
    }
    let [sg, asg, sg_warp, asg_warp] = errors.map(|error| error / f64::from(count));
    println!("sg {sg:.4}, asg {asg:.4}; around the surface normal {sg_warp:.4}, {asg_warp:.4}");
    println!("{count} lights; mean reflected light {:.3}", energy / f64::from(count));
    assert!(asg < 0.053 && asg < asg_warp && sg < 0.078 && sg < sg_warp, "{sg} {asg} {sg_warp} {asg_warp}");
}

/// The largest difference between the descriptions of the same scene, over several scenes lit from both sides, and the
/// sum of the light.
fn between_variants(scenes: &[Lit], of: impl Fn(&Lit) -> f64) -> (f64, f64) {
    scenes.iter().fold((0.0, 0.0), |(most, sum), scene| {
        let energy = of(scene);
        let off = scene.variants().map(|scene_variant| (of(&scene_variant) - energy).abs()).fold(most, f64::max);
        (off, sum + energy)
    })
}

#[test]
fn a_scene_is_lit_equally_in_every_description() {
    for roughness in [Roughness::All, Roughness::Anisotropic] {
        // Half of the lights are as large as the sky, and their edges pass behind the lobe.
        let mut draw = Draw::new(7);
        let scenes: Vec<Lit> =
            (0..600).map(|k| draw.lit_by(roughness, if k % 2 == 0 { [0.05, 1.2] } else { [1.0, 8.0] })).collect();
        for &gaussian in Gaussian::ALL {
            let wide = |lit: &Lit| {
                let vertices: Vec<[f64; 3]> = lit.vertices.iter().map(DVec3::to_array).collect();
                reflected(gaussian, lit.alpha(), lit.wo().to_array(), &vertices, Sides::Two)[0]
            };
            let narrow = |lit: &Lit| {
                let vertices: Vec<[f32; 3]> = lit.vertices.iter().map(|v| v.as_vec3().to_array()).collect();
                let (alpha, wo) = (lit.alpha().map(|alpha| alpha as f32), lit.wo().as_vec3().to_array());
                f64::from(reflected(gaussian, alpha, wo, &vertices, Sides::Two)[0])
            };
            let (off, sum) = between_variants(&scenes, wide);
            let (off32, _) = between_variants(&scenes, narrow);
            println!("{gaussian} {roughness:?}: {off:e} in f64, {off32:e} in f32");
            assert!(off < 1e-9 && off32 < 2e-4 && sum > 60.0, "{gaussian} {roughness:?}: {off} {off32} {sum}");
        }
    }
}
