//! Compares drawn directions on the GPU with f64.

use glam::{DVec3, Vec3, Vec4};

use super::{
    normals::{Single, lights, rounded},
    report_skipped,
};
use crate::preview::gpu::{GpuFailure, tests::example};
use ltcforge_fit::{
    Configuration, Sides,
    brdf::{Brdf, Ggx},
    math::atan2,
};
use ltcforge_light::{
    LightModel, NormalsRule, PolygonLight,
    cases::{Draw, Lit, Roughness},
    normals::region,
    sample::{
        LightSampler,
        sets::{LightSet, over_triangle, triangles},
    },
};
use ltcforge_shaders::{Lights, LitBy, Reading, functions, samplers};

/// Draws directions. `rectangles` and `polygons` return 16 draws of a light, `histogram` counts draws in cells of one
/// light.
const ENTRIES: &str = "
struct Case {
    wo: vec3<f32>,
    alpha_x: f32,
    alpha_y: f32,
    count: f32,
    corners: array<vec4<f32>, 8>,
}

@group(0) @binding(0) var<uniform> given: array<Case, 64>;
@group(0) @binding(1) var<storage, read_write> found: array<vec4<f32>, 2048>;

/// PCG [O'Neill 2014].
fn random(seed: u32) -> u32 {
    let state = seed * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

fn numbers(index: u32, draw: u32) -> vec2<f32> {
    let first = random(index * 4096u + draw);
    return vec2(f32(first >> 8u), f32(random(first ^ 0x9e3779b9u) >> 8u)) * 5.9604645e-8;
}

fn corners_of(given: Case) -> array<vec3<f32>, 4> {
    return array(given.corners[0].xyz, given.corners[1].xyz, given.corners[2].xyz, given.corners[3].xyz);
}

@compute @workgroup_size(64)
fn rectangles(@builtin(local_invocation_index) index: u32) {
    let given = given[index];
    let light = sampler_normals(given.alpha_x, given.alpha_y, given.wo, corners_of(given), true);
    for (var i = 0u; i < 16u; i++) {
        let drawn = sampler_draw(light, numbers(index, i));
        found[32u * index + 2u * i] = vec4(drawn.wi, drawn.pdf);
        found[32u * index + 2u * i + 1u] = vec4(sampler_pdf(light, drawn.wi));
    }
}

@compute @workgroup_size(64)
fn about_means(@builtin(local_invocation_index) index: u32) {
    let given = given[index];
    let view = normals_view(given.alpha_x, given.alpha_y, given.wo);
    let corners = corners_of(given);
    let flux = normals_rectangle_lit(view, corners, true).flux;
    let light = sampler_normals_about(given.alpha_x, given.alpha_y, given.wo, flux, corners, true);
    for (var i = 0u; i < 16u; i++) {
        let drawn = sampler_draw(light, numbers(index, i));
        found[32u * index + 2u * i] = vec4(drawn.wi, drawn.pdf);
        found[32u * index + 2u * i + 1u] = vec4(sampler_pdf(light, drawn.wi));
    }
}

@compute @workgroup_size(64)
fn polygons(@builtin(local_invocation_index) index: u32) {
    let given = given[index];
    var corners: array<vec3<f32>, 8>;
    for (var i = 0u; i < 8u; i++) {
        corners[i] = given.corners[i].xyz;
    }
    let light = sampler_normals_polygon(given.alpha_x, given.alpha_y, given.wo, &corners, u32(given.count), true);
    for (var i = 0u; i < 16u; i++) {
        let drawn = sampler_draw_polygon(light, numbers(index, i));
        found[32u * index + 2u * i] = vec4(drawn.wi, drawn.pdf);
        found[32u * index + 2u * i + 1u] = vec4(sampler_pdf_polygon(light, drawn.wi));
    }
}

var<workgroup> counts: array<atomic<u32>, 256>;

@compute @workgroup_size(256)
fn histogram(@builtin(local_invocation_index) index: u32) {
    let given = given[0];
    let corners = corners_of(given);
    let light = sampler_normals(given.alpha_x, given.alpha_y, given.wo, corners, true);
    let x = corners[1] - corners[0];
    let y = corners[3] - corners[0];
    let normal = cross(x, y);
    for (var i = 0u; i < 782u; i++) {
        let wi = sampler_draw(light, numbers(index, i)).wi;
        let p = wi * (dot(corners[0], normal) / dot(wi, normal)) - corners[0];
        let cell = vec2<u32>(clamp(16.0 * vec2(dot(p, x) / dot(x, x), dot(p, y) / dot(y, y)), vec2(0.0), vec2(15.0)));
        atomicAdd(&counts[16u * cell.x + cell.y], 1u);
    }
    workgroupBarrier();
    found[index] = vec4(f32(atomicLoad(&counts[index])));
}
";

/// The results of an entry point for 64 lights at a time, or `None` without a GPU.
fn run(entry: &str, lights: &[Single]) -> Option<Vec<[Vec4; 2048]>> {
    let model = LitBy::new(LightModel::Normals, None).expect("a model");
    let source = samplers() + &functions(model, Reading::default(), Lights::All) + ENTRIES;
    let words: Vec<[f32; 40]> = lights.iter().map(Single::words).collect();
    let (groups, rest) = words.as_chunks::<64>();
    assert!(rest.is_empty(), "the shader takes 64 at a time");
    match example::run::<_, [[f32; 4]; 2048]>(&source, entry, None, groups) {
        Ok(found) => Some(found.into_iter().map(|found| found.map(Vec4::from_array)).collect()),
        Err(GpuFailure::Absent(reason)) => {
            report_skipped(&reason);
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// The surface and light of the same numbers rounded to 32 bits, and the sampler of an entry point in f64. `None` for a
/// light through the shaded point.
fn exact(entry: &str, single: &Single) -> Option<(Ggx, DVec3, PolygonLight, LightSampler)> {
    let [alpha_x, alpha_y] = single.alpha.map(f64::from);
    let wo = single.wo.as_dvec3().normalize();
    let at = Configuration { alpha_x, alpha_y, theta: atan2(wo.x.hypot(wo.y), wo.z), phi: atan2(wo.y, wo.x) };
    let corners: Vec<DVec3> = single.corners.iter().map(|corner| corner.as_dvec3()).collect();
    let light = PolygonLight::new(corners, Sides::Two).ok()?;
    let sampler = if entry == "about_means" {
        let vertices: Vec<[f64; 3]> = light.vertices().iter().map(glam::DVec3::to_array).collect();
        let region = region([alpha_x, alpha_y], wo.to_array(), &vertices, Sides::Two, NormalsRule::Balanced);
        LightSampler::normals_about(&at, &light, region.map_or(DVec3::ZERO, |region| region.flux.into())).ok()?
    } else {
        LightSampler::normals(&at, &light).ok()?
    };
    Some((Ggx { alpha_x, alpha_y }, wo, light, sampler))
}

/// For draws of an entry point, the 95th percentiles of three errors: of the light, if each density had the error of its
/// direction; of the density of a drawn direction by `sampler_pdf`; and of the sum of densities.
fn errors(entry: &str, lights: &[Single]) -> Option<[f64; 3]> {
    let found = run(entry, lights)?;
    let [mut of_light, mut of_pdf, mut of_sum] = [Vec::new(), Vec::new(), Vec::new()];
    for (single, draws) in lights.iter().zip(found.iter().flat_map(|found| found.as_chunks::<32>().0)) {
        let Some((ggx, wo, _, sampler)) = exact(entry, single) else { continue };
        let mut sums = [0.0; 3];
        for [drawn, again] in draws.as_chunks::<2>().0 {
            let wi = drawn.truncate().as_dvec3().normalize();
            let pdf = f64::from(drawn.w);
            assert!(wi.is_finite() && pdf.is_finite(), "{entry} {:?} {:?}", single.alpha, single.corners);
            if sampler.is_empty() || pdf == 0.0 {
                continue;
            }
            let light = ggx.eval_cos(wo, wi);
            let exact = sampler.pdf(wi);
            sums = [sums[0] + light / pdf, sums[1] + light / exact, sums[2] + exact / pdf];
            of_pdf.push((f64::from(again.x) / pdf - 1.0).abs());
        }
        if sums[1] > 0.0 {
            of_light.push((sums[0] / sums[1] - 1.0).abs());
            of_sum.push((sums[2] / 16.0 - 1.0).abs());
        }
    }
    let percentile = |mut errors: Vec<f64>| {
        errors.sort_by(f64::total_cmp);
        errors[errors.len() * 95 / 100]
    };
    Some([percentile(of_light), percentile(of_pdf), percentile(of_sum)])
}

/// Lights with roughness and ratio uniform in their logarithms, views up to `most` degrees.
fn lights_of(seed: u64, [alpha, ratio]: [[f64; 2]; 2], [least, most]: [f64; 2]) -> Vec<Lit> {
    let mut draw = Draw::new(seed);
    let mut log = |[low, high]: [f64; 2]| draw.within(f64::ln(low), f64::ln(high)).exp();
    let surfaces: Vec<[f64; 3]> = (0..1024).map(|_| [log(alpha), log(ratio), log([least, most])]).collect();
    let mut draw = Draw::new(seed + 1);
    let of = |[alpha, ratio, theta]: [f64; 3]| loop {
        let at = Configuration {
            alpha_x: alpha,
            alpha_y: alpha * ratio,
            theta: theta.to_radians(),
            phi: draw.within(0.0, 6.3),
        };
        let centre = Ggx { alpha_x: alpha, alpha_y: alpha * ratio };
        let wo = ltcforge_fit::math::direction(at.theta, at.phi);
        let centre = centre.sample(wo, [draw.within(0.0, 1.0), draw.within(0.0, 1.0)]).wi;
        if centre.z > 0.0 {
            let size = draw.within(-3.0, 0.0).exp();
            let normal = (-centre + 0.5 * draw.vector()).normalize();
            let x = normal.cross(draw.vector()).normalize() * size;
            let y = normal.cross(x);
            break Lit { at, vertices: vec![centre - x - y, centre + x - y, centre + x + y, centre - x + y] };
        }
    };
    surfaces.into_iter().map(of).collect()
}

#[test]
fn densities_in_32_bits_are_those_of_f64() {
    let whole = [[0.02, 1.0], [0.1, 1.0]];
    let sets = [
        ("rectangles", "alpha from 0.02", lights_of(61_000, whole, [0.1, 85.0]), [1e-4, 1e-4, 1e-4]),
        ("polygons", "alpha from 0.02", rounded(lights_of(61_040, whole, [0.1, 85.0])), [1e-4, 1e-4, 1e-4]),
        ("about_means", "alpha from 0.02", lights_of(61_050, whole, [0.1, 85.0]), [1e-4, 1e-4, 1e-4]),
        // Many of these are walls edge-on, or 50 times as far as high.
        ("polygons", "walls", rounded(lights(Roughness::Anisotropic)).split_off(4096), [2e-3, 1e-3, 1e-3]),
        ("rectangles", "alpha 1e-4 to 0.02", lights_of(61_010, [[1e-4, 0.02], [0.1, 1.0]], [0.1, 85.0]), [2e-3; 3]),
        ("rectangles", "ratio 1e-3", lights_of(61_020, [[0.1, 1.0], [1e-3, 1.1e-3]], [0.1, 85.0]), [0.01; 3]),
        (
            "rectangles",
            "alpha from 0.02, ratio 1e-3",
            lights_of(61_020, [[0.02, 1.0], [1e-3, 1.1e-3]], [0.1, 85.0]),
            [0.01; 3],
        ),
        // 1 + q . wo loses digits if the view is along the surface.
        ("rectangles", "views 89 to 89.99", lights_of(61_030, whole, [89.0, 89.99]), [0.02; 3]),
    ];
    for (entry, name, lights, limits) in sets {
        let lights: Vec<Single> = lights.iter().map(Single::of).collect();
        let Some(errors) = errors(entry, &lights) else { return };
        println!("{entry}, {name}: off by {:.1e}, {:.1e}, {:.1e} (p95)", errors[0], errors[1], errors[2]);
        assert!(errors.iter().zip(limits).all(|(error, limit)| *error < limit), "{entry}, {name}: {errors:?}");
    }
}

/// Both draw the same direction of a polygon for the same numbers.
#[test]
fn polygons_are_sampled_as_in_f64() {
    let random = |seed: u32| {
        let state = seed.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
        (word >> 22) ^ word
    };
    let lights: Vec<Single> = rounded(lights(Roughness::Anisotropic)).iter().map(Single::of).take(1024).collect();
    let Some(found) = run("polygons", &lights) else { return };
    let mut far = Vec::new();
    for (index, (single, draws)) in
        lights.iter().zip(found.iter().flat_map(|found| found.as_chunks::<32>().0)).enumerate()
    {
        let Some((.., sampler)) = exact("polygons", single) else { continue };
        for (i, [drawn, _]) in (0..).zip(draws.as_chunks::<2>().0) {
            let first = random((index as u32 % 64) * 4096 + i);
            let u = [first, random(first ^ 0x9e37_79b9)].map(|word| f64::from(word >> 8) / f64::from(1 << 24));
            match sampler.sample(u) {
                Some(expected) => far.push((drawn.truncate().as_dvec3() - expected.wi).length()),
                None => assert!(drawn.w == 0.0, "{drawn}"),
            }
        }
    }
    far.sort_by(f64::total_cmp);
    let [middle, most] = [far.len() / 2, far.len() * 99 / 100].map(|i| far[i]);
    println!("{} draws, off by {middle:.1e} (median), {most:.1e} (p99)", far.len());
    assert!(far.len() > 10_000 && middle < 2e-5 && most < 5e-3, "{middle} {most}");
}

/// A light that stands on the surface with one corner has an empty triangle between others. Both of its halves are
/// drawn.
#[test]
fn all_parts_of_a_light_on_one_corner_are_drawn() {
    let at = Configuration { alpha_x: 0.5, alpha_y: 0.5, theta: 0.6, phi: -std::f64::consts::FRAC_PI_2 };
    let corners = [[0.0, 2.0, 0.0], [1.0, 2.0, 1.0], [0.0, 2.0, 2.0], [-1.0, 2.0, 1.0]];
    for first in 0..4 {
        let vertices = (0..4).map(|i| DVec3::from_array(corners[(first + i) % 4])).collect();
        let lit = Lit { at, vertices };
        let lights: Vec<Single> = (0..64).map(|_| Single::of(&lit)).collect();
        let Some(found) = run("polygons", &lights) else { return };
        let draws = found.iter().flat_map(|found| found.as_chunks::<2>().0).filter(|[draw, _]| draw.w > 0.0);
        let right = draws.clone().filter(|[draw, _]| draw.x > 0.0).count();
        let all = draws.count();
        println!("{right} of {all} draws are right of the corner {first}");
        assert!(all == 1024 && (400..624).contains(&right), "{right} of {all}");
    }
}

/// The largest normal deviate of a test: probability 1e-4.
const MOST_DEVIATION: f64 = 3.72;

#[test]
fn draws_in_32_bits_follow_their_density() {
    let mut lights = Vec::new();
    for index in 0..100_u64 {
        let set = LightSet::EIGHT[index as usize % 8];
        lights.push(Single::of(&set.draw(&mut Draw::new(62_000 + index))));
    }
    // The entry point reads the first of 64.
    let copy = |single: &Single| Single { wo: single.wo, alpha: single.alpha, corners: single.corners.clone() };
    let repeated: Vec<Single> = lights.iter().flat_map(|single| (0..64).map(|_| copy(single))).collect();
    let Some(found) = run("histogram", &repeated) else { return };
    let mut worst = f64::NEG_INFINITY;
    for (single, counts) in lights.iter().zip(&found) {
        let (.., sampler) = exact("histogram", single).expect("a light");
        let [corner, x, y] = [0, 1, 3].map(|i| single.corners[i]);
        let at = |i: usize, j: usize| corner.as_dvec3() + sides(x, corner) * i as f64 + sides(y, corner) * j as f64;
        let draws = 256.0 * 782.0;
        let mut rare = [0.0; 2];
        let mut cells = Vec::new();
        for (i, j) in (0..16).flat_map(|i| (0..16).map(move |j| (i, j))) {
            let cell = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            let parts = triangles(&cell).into_iter().map(|part| over_triangle(&|wi| sampler.pdf(wi), part, 16));
            let [expected, counted] = [draws * parts.sum::<f64>(), f64::from(counts[16 * i + j].x)];
            if expected > 10.0 {
                cells.push([expected, counted]);
            } else {
                rare = [rare[0] + expected, rare[1] + counted];
            }
        }
        if rare[0] > 10.0 {
            cells.push(rare);
        }
        let chi_square: f64 = cells.iter().map(|[expected, found]| (found - expected).powi(2) / expected).sum();
        let freedom = (cells.len() - 1) as f64;
        // Wilson and Hilferty's approximation.
        let spread = 2.0 / (9.0 * freedom);
        let deviation = ((chi_square / freedom).cbrt() - (1.0 - spread)) / spread.sqrt();
        worst = worst.max(deviation);
        assert!(deviation < MOST_DEVIATION, "{:?} {:?}: {chi_square} of {freedom}", single.alpha, single.corners);
    }
    println!("the largest of 100 deviations is {worst:.2}");
}

/// A 16th of a side.
fn sides(end: Vec3, corner: Vec3) -> DVec3 {
    (end.as_dvec3() - corner.as_dvec3()) / 16.0
}

#[test]
fn no_extreme_light_gives_a_bad_draw() {
    let mut draw = Draw::new(63_000);
    let lights: Vec<Single> = (0..65_536)
        .map(|index| {
            let mut lit = draw.lit_by(Roughness::Extreme, [[1e-4, 1e-2], [1e-2, 10.0], [10.0, 1e4]][index % 3]);
            lit.at.alpha_x = 10_f64.powf(draw.within(-5.0, 0.0));
            lit.at.alpha_y = lit.at.alpha_x * 10_f64.powf(draw.within(-3.0, 0.0));
            if index % 2 == 0 {
                lit.at.theta = draw.within(89.0, 89.99).to_radians();
            }
            Single::of(&lit)
        })
        .collect();
    let Some(found) = run("rectangles", &lights) else { return };
    let [mut drawn, mut hidden] = [0, 0];
    for (single, draws) in lights.iter().zip(found.iter().flat_map(|found| found.as_chunks::<32>().0)) {
        let seen = draws.as_chunks::<2>().0.iter().filter(|[draw, _]| draw.w > 0.0).count();
        // A light has no density of 0, or it is not visible and has no other.
        let is_visible = single.corners.iter().any(|corner| corner.z > 0.0);
        assert!(seen == 16 || seen == 0, "{seen}: {:?} {:?}", single.alpha, single.corners);
        for [draw, again] in draws.as_chunks::<2>().0.iter().filter(|_| seen > 0) {
            let is_good = draw.is_finite() && again.is_finite() && (draw.truncate().length() - 1.0).abs() < 1e-5;
            assert!(is_good && is_visible, "{draw} {again}: {:?} {:?}", single.alpha, single.corners);
        }
        drawn += seen;
        hidden += usize::from(seen == 0 && is_visible);
    }
    println!("{drawn} draws; {hidden} lights above the surface without solid angle");
    assert!(drawn > 1_000_000 && hidden < 100, "{drawn} {hidden}");
}
