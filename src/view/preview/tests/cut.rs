//! Compares `ltc_cut.wgsl`, `ltc_cut_shapes.wgsl` and their CPU twin with f64.

use std::f64::consts::TAU;

use glam::{DMat3, DVec3, Mat3, Vec3};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{report_skipped, shader_table};
use crate::preview::{
    TexelFormat,
    cpu::tests as cpu,
    gpu::{GpuFailure, tests::example},
};
use ltcforge_fit::{Ltc, Sides, cheap_form_factor, testing::mirror_like};
use ltcforge_light::{AboveSurface, CosineSpace};
use ltcforge_shaders::{Bound, joined};

/// Integrates each kind of light. A case has a matrix and three vectors.
const ENTRY: &str = "
struct Case {
    m: array<vec4<f32>, 3>,
    places: array<vec4<f32>, 3>,
}

@group(1) @binding(0) var<uniform> given: array<Case, 256>;
@group(1) @binding(1) var<storage, read_write> found: array<array<vec4<f32>, 2>, 256>;

@compute @workgroup_size(256)
fn covered(@builtin(local_invocation_index) index: u32) {
    let given = given[index];
    let inverse = ltc_inverse(mat3x3(given.m[0].xyz, given.m[1].xyz, given.m[2].xyz));
    let a = given.places[0].xyz;
    let x = given.places[1].xyz;
    let y = given.places[2].xyz;
    let size = given.places[0].w;
    let corners = array<vec3<f32>, 4>(a - x - y, a + x - y, a + x + y, vec3(0.0));
    var vertices: array<vec3<f32>, 8>;
    vertices[0] = corners[0];
    vertices[1] = corners[1];
    vertices[2] = corners[2];
    vertices[3] = a - x + y;
    found[index] = array<vec4<f32>, 2>(
        vec4(
            ltc_cut_disk(inverse, a, x, y, true),
            ltc_cut_sphere(inverse, a, size),
            ltc_cut_tube(inverse, a - x, a + x, size),
            ltc_cut_line(inverse, a - x, a + x, size),
        ),
        vec4(
            ltc_cut_polygon(inverse, vertices, 4u, true),
            ltc_cut_rectangle(inverse, corners, true),
            ltc_cut_rectangle(inverse, corners, false),
            0.0,
        ),
    );
}
";

const FILES: [&str; 7] =
    ["ltc_math", "ltc_inverse", "ltc_rectangle", "ltc_light", "ltc_shapes", "ltc_cut", "ltc_cut_shapes"];
const NAMES: [&str; 7] = ["disk", "sphere", "tube", "line", "polygon", "rectangle", "rectangle from one side"];
const COUNT: usize = 16 * 256;

/// A lobe and its lights. The disk and the parallelogram have a centre and two half axes. The sphere has the centre and
/// radius `size`. The tube and the line extend from the centre by the first half axis in both directions, with radius
/// or width `size`.
struct Case {
    m: Mat3,
    places: [Vec3; 3],
    size: f32,
}

impl Case {
    fn above(&self) -> AboveSurface<f64> {
        CosineSpace::from(&Ltc::new(self.m.as_dmat3()).expect("regular")).above_surface()
    }

    fn corners(&self) -> [DVec3; 4] {
        let [a, x, y] = self.places;
        let [a, b, c] = [a - x - y, a + x - y, a + x + y].map(Vec3::as_dvec3);
        [a, b, c, a + c - b]
    }

    /// The results in f64, for the same inputs rounded to 32 bits.
    fn wanted(&self) -> [f64; 7] {
        let above = self.above();
        let [centre, x, y] = self.places.map(Vec3::as_dvec3);
        let ends = [self.places[0] - self.places[1], self.places[0] + self.places[1]].map(Vec3::as_dvec3);
        let size = self.size.into();
        [
            above.ellipse(centre, [x, y], Sides::Two),
            above.sphere(centre, size),
            above.tube(ends, size),
            above.line(ends, size),
            above.polygon(&self.corners(), Sides::Two),
            above.polygon(&self.corners(), Sides::Two),
            above.polygon(&self.corners(), Sides::One),
        ]
    }

    fn words(&self) -> [f32; 24] {
        let mut words = [0.0; 24];
        let columns = [self.m.x_axis, self.m.y_axis, self.m.z_axis];
        for (place, vector) in words.chunks_exact_mut(4).zip(columns.iter().chain(&self.places)) {
            place[..3].copy_from_slice(&vector.to_array());
        }
        words[15] = self.size;
        words
    }
}

/// Lobes with roughness from 0.02 on and grazing views, and lights of all sizes around them.
fn cases() -> Vec<Case> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(23);
    let mut within =
        move |low: f64, high: f64| low + (high - low) * ((random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64);
    let mut cases = Vec::with_capacity(COUNT);
    for i in 0..COUNT {
        let [alpha_x, alpha_y] = [0, 1].map(|_| 10_f64.powf(within(-1.7, 0.0)));
        let mut m = mirror_like(alpha_x, alpha_y, within(0.7, 1.55), within(0.0, TAU));
        if i % 3 == 0 {
            m *= DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
        }
        let mut vector = || DVec3::new(within(-1.0, 1.0), within(-1.0, 1.0), within(-1.0, 1.0));
        let centre = (m * (vector() + 0.3 * DVec3::Z)).normalize();
        let [x, y] = [vector(), vector()];
        let scale = 10_f64.powf(within(-2.0, 1.0));
        let places = [centre, x * scale, y * scale].map(DVec3::as_vec3);
        cases.push(Case { m: m.as_mat3(), places, size: (scale * within(0.0, 1.0)) as f32 });
    }
    cases
}

fn by_gpu(cases: &[Case], source: &str) -> Option<Vec<[f32; 8]>> {
    let words: Vec<[f32; 24]> = cases.iter().map(Case::words).collect();
    let (groups, rest) = words.as_chunks::<256>();
    assert!(rest.is_empty(), "the shader takes 256 at a time");
    let table = shader_table(TexelFormat::F32);
    match example::run::<_, [[f32; 8]; 256]>(source, "covered", Some((&*table, Bound::Volumes)), groups) {
        Ok(by_gpu) => Some(by_gpu.into_flattened()),
        Err(GpuFailure::Absent(reason)) => {
            report_skipped(&reason);
            None
        }
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn thousands_of_lights_that_the_surface_cuts_agree_with_f64() {
    let cases = cases();
    let twin = |case: &Case| {
        let [disk, sphere, tube, line] = cpu::shapes_covered_above(case.m, case.places, case.size);
        let corners = case.corners().map(DVec3::as_vec3);
        let [two, one] = [true, false].map(|two_sided| cpu::covered_above(case.m, &corners, two_sided));
        [disk, sphere, tube, line, two, two, one, 0.0]
    };
    let mut all = vec![("CPU", cases.iter().map(twin).collect())];
    all.extend(by_gpu(&cases, &(joined(&FILES) + ENTRY)).map(|found| ("GPU", found)));
    for (who, found) in all {
        let mut errors: [Vec<f64>; 7] = std::array::from_fn(|_| Vec::new());
        let mut lit = [0; 7];
        for (case, found) in cases.iter().zip(&found) {
            for (((errors, lit), found), wanted) in errors.iter_mut().zip(&mut lit).zip(found).zip(case.wanted()) {
                assert!((0.0..=1.0).contains(found), "{who}: {found}: {} {:?} {}", case.m, case.places, case.size);
                errors.push((f64::from(*found) - wanted).abs());
                *lit += usize::from((0.01..0.99).contains(&wanted));
            }
        }
        assert!(lit.iter().all(|lit| *lit > COUNT / 10), "{lit:?}");
        for (name, mut errors) in NAMES.into_iter().zip(errors) {
            errors.sort_by(f64::total_cmp);
            let [p99, p999] = [990, 999].map(|part| errors[COUNT * part / 1000]);
            println!("{who} {name}: {p99:e} {p999:e} {:e}", errors[COUNT - 1]);
            assert!(p99 < 2e-5 && p999 < 1e-3, "{who} {name}: {p99:e} {p999:e}");
        }
    }
}

/// With `LTC_CHEAP_HORIZON`, polygons are cut at the surface and their horizon is approximated. Tubes do not change.
#[test]
fn the_cheap_horizon_of_a_cut_polygon_is_the_fit_for_spheres() {
    let cases = cases();
    let source = joined(&FILES) + ENTRY;
    let cheap = source.replacen("LTC_CHEAP_HORIZON: bool = false", "LTC_CHEAP_HORIZON: bool = true", 1);
    assert_ne!(cheap, source);
    let Some(found) = by_gpu(&cases, &cheap) else { return };
    let mut lit = 0;
    for (case, found) in cases.iter().zip(found) {
        let ltc = Ltc::new(case.m.as_dmat3()).expect("regular");
        let corners = case.corners();
        let mut left = Vec::new();
        for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            left.extend((a.z > 0.0).then_some(*a));
            left.extend(((a.z > 0.0) != (b.z > 0.0)).then(|| *a + (*b - *a) * (a.z / (a.z - b.z))));
        }
        let flux = ltc.vector_form_factor(&left);
        let length = flux.length();
        let guessed = length * cheap_form_factor(if length > 0.0 { flux.z / length } else { 0.0 }, length);
        let row = case.m.as_dmat3().transpose() * DVec3::Z;
        let wanted = (2.0 * guessed / (1.0 + row.normalize().z)).min(1.0);
        let off = (f64::from(found[5]) - wanted).abs();
        assert!(off < 2e-3, "{} {wanted}: {} {:?}", found[5], case.m, case.places);
        // An exception is a tube whose end hides the rest: it is treated like a sphere.
        let [centre, half] = [0, 1].map(|i| case.places[i].as_dvec3());
        let beside = (centre - half).reject_from(half).length();
        let tube = (f64::from(found[2]) - case.wanted()[2]).abs();
        assert!(
            tube < 1e-3 || beside < f64::from(case.size),
            "{} {}: {} {:?}",
            found[2],
            case.wanted()[2],
            case.m,
            case.places
        );
        lit += usize::from((0.01..0.99).contains(&wanted));
    }
    assert!(lit > COUNT / 10, "{lit}");
}
