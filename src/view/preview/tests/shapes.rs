//! Compares `ltc_shapes.wgsl` and its CPU twin with f64.

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
use ltcforge_fit::{Ltc, Sides, testing::mirror_like};
use ltcforge_light::CosineSpace;
use ltcforge_shaders::{Bound, joined};

/// Integrates each kind of light. A case has a matrix and three vectors.
const ENTRY: &str = "
struct Case {
    m: array<vec4<f32>, 3>,
    places: array<vec4<f32>, 3>,
}

@group(1) @binding(0) var<uniform> given: array<Case, 256>;
@group(1) @binding(1) var<storage, read_write> found: array<vec4<f32>, 256>;

@compute @workgroup_size(256)
fn covered(@builtin(local_invocation_index) index: u32) {
    let given = given[index];
    let inverse = ltc_inverse(mat3x3(given.m[0].xyz, given.m[1].xyz, given.m[2].xyz));
    let a = given.places[0].xyz;
    let b = given.places[1].xyz;
    let size = given.places[0].w;
    found[index] = vec4(
        ltc_disk(inverse, a, b, given.places[2].xyz, true),
        ltc_sphere(inverse, a, size),
        ltc_tube(inverse, a - b, a + b, size),
        ltc_line(inverse, a - b, a + b, size),
    );
}
";

const COUNT: usize = 20 * 256;

/// A lobe and its lights. The disk has a centre and two half axes. The sphere has the centre and radius `size`. The
/// tube and the line extend from the centre by the first half axis in both directions, with radius or width `size`.
struct Case {
    m: Mat3,
    places: [Vec3; 3],
    size: f32,
}

impl Case {
    /// The results in f64, for the same inputs rounded to 32 bits.
    fn wanted(&self) -> [f64; 4] {
        let ltc = Ltc::new(self.m.as_dmat3()).expect("regular");
        let space = CosineSpace::from(&ltc);
        let [centre, x, y] = self.places.map(Vec3::as_dvec3);
        let [start, end] = [self.places[0] - self.places[1], self.places[0] + self.places[1]];
        let ends = [start, end].map(Vec3::as_dvec3);
        let size = self.size.into();
        [
            space.ellipse(centre, [x, y], Sides::Two),
            space.sphere(centre, size),
            space.tube(ends, size),
            space.line(ends, size),
        ]
    }
}

/// Lobes with roughness from 0.01 on, and lights of all sizes around them. Some lights are hard: seen edge-on, around
/// the shaded point, of size zero, or with parallel half axes.
fn cases() -> Vec<Case> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(21);
    let mut within =
        move |low: f64, high: f64| low + (high - low) * ((random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64);
    let mut cases = Vec::with_capacity(COUNT);
    for i in 0..COUNT {
        let [alpha_x, alpha_y] = [0, 1].map(|_| 10_f64.powf(within(-2.0, 0.0)));
        let mut m = mirror_like(alpha_x, alpha_y, within(0.0, 1.5), within(0.0, TAU));
        if i % 3 == 0 {
            m *= DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0));
        }
        let mut vector = || DVec3::new(within(-1.0, 1.0), within(-1.0, 1.0), within(-1.0, 1.0));
        let mut centre = (m * (vector() + 0.3 * DVec3::Z)).normalize();
        let [mut x, mut y] = [vector(), vector()];
        let scale = 10_f64.powf(within(-3.0, 1.0));
        (x, y) = (x * scale, y * scale);
        match i % 64 {
            8 => y = centre * 0.5,
            16 => centre = DVec3::ZERO,
            24 => x = DVec3::ZERO,
            32 => y = x * 0.5,
            40 => centre = x * 2.0,
            48 => (x, y) = (x * 1e4, y * 1e4),
            _ => {}
        }
        cases.push(Case {
            m: m.as_mat3(),
            places: [centre, x, y].map(DVec3::as_vec3),
            size: (scale * within(0.0, 1.0)) as f32,
        });
    }
    cases
}

fn words(case: &Case) -> [f32; 24] {
    let mut words = [0.0; 24];
    let columns = [case.m.x_axis, case.m.y_axis, case.m.z_axis];
    for (place, vector) in words.chunks_exact_mut(4).zip(columns.iter().chain(&case.places)) {
        place[..3].copy_from_slice(&vector.to_array());
    }
    words[15] = case.size;
    words
}

#[test]
fn thousands_of_lights_in_32_bits_agree_with_f64() {
    let cases = cases();
    let mut all = vec![("CPU", cases.iter().map(|case| cpu::shapes_covered(case.m, case.places, case.size)).collect())];
    let words: Vec<[f32; 24]> = cases.iter().map(words).collect();
    let (groups, rest) = words.as_chunks::<256>();
    assert!(rest.is_empty(), "the shader takes 256 at a time");
    let source = joined(&["ltc_math", "ltc_inverse", "ltc_rectangle", "ltc_light", "ltc_shapes"]) + ENTRY;
    let table = shader_table(TexelFormat::F32);
    match example::run::<_, [[f32; 4]; 256]>(&source, "covered", Some((&*table, Bound::Volumes)), groups) {
        Ok(by_gpu) => all.push(("GPU", by_gpu.into_flattened())),
        Err(GpuFailure::Absent(reason)) => report_skipped(&reason),
        Err(error) => panic!("{error}"),
    }
    for (who, found) in all {
        let mut errors: [Vec<f64>; 4] = std::array::from_fn(|_| Vec::new());
        let mut lit = 0;
        for (case, found) in cases.iter().zip(&found) {
            let wanted = case.wanted();
            for ((errors, found), wanted) in errors.iter_mut().zip(found).zip(wanted) {
                assert!((0.0..=1.0).contains(found), "{who}: {found}: {} {:?} {}", case.m, case.places, case.size);
                errors.push((f64::from(*found) - wanted).abs());
                lit += usize::from((0.01..0.99).contains(&wanted));
            }
        }
        assert!(lit > COUNT, "{lit}");
        for (name, mut errors) in ["disk", "sphere", "tube", "line"].into_iter().zip(errors) {
            errors.sort_by(f64::total_cmp);
            let [p50, p99, p999] = [50, 990, 999].map(|part| errors[COUNT * part / 1000]);
            println!("{who} {name}: {p50:e} {p99:e} {p999:e} {:e}", errors[COUNT - 1]);
            // One in 64 lines points at the shaded point, where terms must cancel.
            let most = if name == "line" { 5e-4 } else { 1e-3 };
            assert!(p99 < 2e-5 && p999 < most, "{who} {name}: {p99:e} {p999:e}");
        }
    }
}
