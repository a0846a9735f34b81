use glam::{DMat3, DVec3, Mat3, Vec3};

use super::{report_skipped, shader_table};
use crate::preview::{
    TexelFormat,
    cpu::tests as cpu,
    gpu::{GpuFailure, tests::example},
};
use ltcforge_fit::{
    Ltc, Sides, cheap_form_factor,
    testing::{polygon_quadrature as quadrature, random_cases},
};
use ltcforge_shaders::{Bound, joined};

/// Integrates the polygon of a case with its matrix.
const ENTRY: &str = "
struct Case {
    m: array<vec4<f32>, 3>,
    count: vec4<u32>,
    vertices: array<vec4<f32>, 8>,
}

@group(1) @binding(0) var<uniform> given: array<Case, 256>;
@group(1) @binding(1) var<storage, read_write> found: array<vec2<f32>, 256>;

@compute @workgroup_size(256)
fn covered(@builtin(local_invocation_index) index: u32) {
    let given = given[index];
    let inverse = ltc_inverse(mat3x3(given.m[0].xyz, given.m[1].xyz, given.m[2].xyz));
    var vertices: array<vec3<f32>, 8>;
    for (var i = 0u; i < 8u; i++) {
        vertices[i] = given.vertices[i].xyz;
    }
    found[index] = vec2(
        ltc_polygon(inverse, vertices, given.count.x, false),
        ltc_polygon(inverse, vertices, given.count.x, true),
    );
}
";

/// Ten thousand cases, rounded to whole workgroups.
const COUNT: usize = 40 * 256;

/// A matrix and a polygon in 32 bits, and the covered part of the lobe in f64.
struct Case {
    m: Mat3,
    vertices: Vec<Vec3>,
    wanted: f64,
}

impl Case {
    /// `exact` computes the expected value from the matrix and the polygon in 32 bits.
    fn new(m: DMat3, polygon: impl Iterator<Item = DVec3>, exact: impl Fn(DMat3, &[DVec3]) -> f64) -> Self {
        let (m, vertices) = (m.as_mat3(), polygon.map(DVec3::as_vec3).collect::<Vec<Vec3>>());
        let polygon: Vec<DVec3> = vertices.iter().map(|v| v.as_dvec3()).collect();
        Self { m, wanted: exact(m.as_dmat3(), &polygon), vertices }
    }
}

/// Random cases. With `aimed`, the polygons are around or within the lobe, for any direction and sharpness of the lobe.
fn cases(aimed: bool) -> Vec<Case> {
    let place = |m: DMat3, v: DVec3| if aimed { m * v } else { v };
    random_cases(COUNT).map(|(polygon, m)| Case::new(m, polygon.into_iter().map(|v| place(m, v)), quadrature)).collect()
}

/// The covered parts, lit from one side and from both sides. The CPU twin computes them, and the GPU if there is one.
fn by_all(cases: &[Case]) -> Vec<(&'static str, Vec<[f32; 2]>)> {
    let twin = |case: &Case| [false, true].map(|two_sided| cpu::covered(case.m, &case.vertices, two_sided));
    let mut found = vec![("CPU", cases.iter().map(twin).collect())];
    found.extend(
        by_gpu(cases, &(joined(&["ltc_math", "ltc_inverse", "ltc_rectangle", "ltc_light"]) + ENTRY))
            .map(|by_gpu| ("GPU", by_gpu)),
    );
    found
}

/// The covered parts, by a shader with [`ENTRY`]. `None` without a GPU.
fn by_gpu(cases: &[Case], source: &str) -> Option<Vec<[f32; 2]>> {
    let words: Vec<[u32; 48]> = cases.iter().map(words).collect();
    let (groups, rest) = words.as_chunks::<256>();
    assert!(rest.is_empty(), "the shader takes 256 at a time");
    let table = shader_table(TexelFormat::F32);
    match example::run::<_, [[f32; 2]; 256]>(source, "covered", Some((&*table, Bound::Volumes)), groups) {
        Ok(by_gpu) => Some(by_gpu.into_flattened()),
        Err(GpuFailure::Absent(reason)) => {
            report_skipped(&reason);
            None
        }
        Err(error) => panic!("{error}"),
    }
}

fn words(case: &Case) -> [u32; 48] {
    let mut words = [0; 48];
    let (matrix, rest) = words.split_at_mut(12);
    let (count, vertices) = rest.split_at_mut(4);
    count[0] = case.vertices.len() as u32;
    let columns = [case.m.x_axis, case.m.y_axis, case.m.z_axis];
    for (place, vector) in
        matrix.chunks_exact_mut(4).zip(&columns).chain(vertices.chunks_exact_mut(4).zip(&case.vertices))
    {
        place[..3].copy_from_slice(&vector.to_array().map(f32::to_bits));
    }
    words
}

/// The error of a case's integral. Also checks that the integral is from 0 to 1.
#[track_caller]
fn error(case: &Case, who: &str, [one, two]: [f32; 2]) -> f64 {
    let Case { m, vertices, wanted } = case;
    let what = || format!("{who}: {one} and {two}, not {wanted}: {m} {vertices:?}");
    assert!((0.0..=1.0).contains(&one) && (0.0..=1.0).contains(&two), "{}", what());
    assert!(one == two || one == 0.0, "{}", what());
    (f64::from(two) - wanted).abs()
}

/// Whether the whole polygon is clearly below the lobe's horizon.
fn is_below(case: &Case) -> bool {
    let inverse = case.m.as_dmat3().inverse();
    case.vertices.iter().map(|v| (inverse * v.as_dvec3()).normalize()).all(|c| c.z < -1e-3)
}

#[test]
fn ten_thousand_polygons_in_32_bits_agree_with_quadrature() {
    let cases = cases(false);
    let mut below = 0;
    for (who, found) in by_all(&cases) {
        for (case, found) in cases.iter().zip(found) {
            let error = error(case, who, found);
            assert!(error < 1e-4, "{who}: {error:e}: {} {:?}", case.m, case.vertices);
            if is_below(case) {
                assert_eq!(found, [0.0; 2], "{who}: {} {:?}", case.m, case.vertices);
                below += 1;
            }
        }
    }
    assert!(below > 500, "{below}");
}

/// In 32 bits the edge of a light is accurate to 1e-7 rad. For roughness 1e-4 this is a thousandth of the lobe's width.
#[test]
fn lights_that_end_within_a_sharp_lobe_have_small_errors() {
    let cases = cases(true);
    for (who, found) in by_all(&cases) {
        let errors: Vec<f64> = cases.iter().zip(found).map(|(case, found)| error(case, who, found)).collect();
        let beyond = errors.iter().filter(|error| **error > 1e-4).count();
        let most = errors.iter().copied().fold(0.0, f64::max);
        assert!(most < 3e-3 && beyond <= 20, "{who}: at most {most:e}, {beyond} of {COUNT} beyond 1e-4");
    }
}

/// Parallelograms, given by three corners. `ltc_rectangle` cuts them at the horizon without branches.
#[test]
fn ten_thousand_rectangles_in_32_bits_agree_with_64_bits() {
    let source = joined(&["ltc_inverse", "ltc_rectangle", "ltc_light"])
        + &ENTRY.replace("ltc_polygon(inverse, vertices, given.count.x,", "ltc_rectangle(inverse, corners,").replace(
            "    found[index]",
            "    let corners = array<vec3<f32>, 4>(vertices[0], vertices[1], vertices[2], vec3(0.0));\n    found[index]",
        );
    for (aimed, most) in [(false, 1e-3), (true, 3e-3)] {
        let cases: Vec<Case> = random_cases(COUNT)
            .map(|(polygon, m)| {
                let place = |v: DVec3| if aimed { m * v } else { v };
                let vertices: Vec<Vec3> = polygon[..3].iter().map(|v| place(*v).as_vec3()).collect();
                let [a, b, c] = [0, 1, 2].map(|i| vertices[i].as_dvec3());
                let m = m.as_mat3();
                let ltc = Ltc::new(m.as_dmat3()).expect("regular");
                Case { m, vertices, wanted: ltc.polygon(&[a, b, c, a + c - b], Sides::Two) }
            })
            .collect();
        let Some(found) = by_gpu(&cases, &source) else { return };
        let errors: Vec<f64> = cases.iter().zip(found).map(|(case, found)| error(case, "GPU", found)).collect();
        let largest = errors.iter().copied().fold(0.0, f64::max);
        let beyond = errors.iter().filter(|error| **error > 1e-4).count();
        let cut = cases.iter().filter(|case| (0.01..0.99).contains(&case.wanted)).count();
        println!("{largest:e}, {beyond} beyond 1e-4, {cut} in part");
        assert!(largest < most && beyond <= 20, "{largest:e}, {beyond} of {COUNT} beyond 1e-4");
        assert!(cut > 1000, "{cut}");
    }
}

/// `LTC_CHEAP_HORIZON` uses the cheap fit for a sphere with the same vector form factor.
#[test]
fn the_cheap_horizon_of_polygons_is_the_fit_for_spheres() {
    let exact = |m: DMat3, polygon: &[DVec3]| {
        let flux = Ltc::new(m).expect("regular").vector_form_factor(polygon);
        let length = flux.length();
        length * cheap_form_factor(if length > 0.0 { flux.z / length } else { 0.0 }, length)
    };
    let cases: Vec<Case> = random_cases(COUNT).map(|(polygon, m)| Case::new(m, polygon.into_iter(), exact)).collect();
    let source = joined(&["ltc_math", "ltc_inverse", "ltc_rectangle", "ltc_light"]) + ENTRY;
    let cheap = source.replacen("LTC_CHEAP_HORIZON: bool = false", "LTC_CHEAP_HORIZON: bool = true", 1);
    assert_ne!(cheap, source);
    let Some(found) = by_gpu(&cases, &cheap) else { return };
    let mut lit = [0; 2];
    for (case, found) in cases.iter().zip(found) {
        let error = error(case, "GPU", found);
        assert!(error < 1e-4, "{error:e}: {} {:?}", case.m, case.vertices);
        lit[usize::from(found[0] > 0.0)] += usize::from(found[1] > 1e-3);
    }
    assert!(lit.into_iter().all(|count| count > 500), "{lit:?} lit from behind and from the front");
}

/// Lights of a thousandth of the usual size.
fn small_cases() -> Vec<Case> {
    // Quadrature has no relative accuracy for these lights.
    let exact = |m: DMat3, polygon: &[DVec3]| Ltc::new(m).expect("regular").polygon(polygon, Sides::Two);
    let small = |(polygon, m): (Vec<DVec3>, DMat3)| {
        let centre = polygon.iter().sum::<DVec3>() / polygon.len() as f64;
        Case::new(m, polygon.into_iter().map(|v| centre + 1e-3 * (v - centre)), exact)
    };
    random_cases(COUNT).map(small).collect()
}

/// The integrals of small lights are about 1e-6. The usual sum has terms that cancel, with rounding errors of the same
/// size.
#[test]
fn small_lights_keep_relative_accuracy() {
    let cases = small_cases();
    for (who, found) in by_all(&cases) {
        let lit = cases.iter().zip(found).filter(|(case, _)| case.wanted > 1e-9);
        let mut errors: Vec<f64> = lit.map(|(case, found)| error(case, who, found) / case.wanted).collect();
        errors.sort_by(f64::total_cmp);
        let part = |of_a_thousand: usize| errors[errors.len() * of_a_thousand / 1000];
        assert!(errors.len() > 2000, "{who}: {}", errors.len());
        assert!(part(500) < 1e-3 && part(990) < 0.08, "{who}: {:e}, {:e}", part(500), part(990));
    }
}
