use std::f64::consts::{PI, TAU};

use glam::{DMat3, DVec3};

use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use super::{planted::diffuse, *};
use crate::preview::{
    Camera, Estimator, Light, LightKind, Material, Mode, Scene, TableFault,
    light::{Ellipse, Shape},
};
use ltcforge_fit::{
    BrdfKind, BrdfModel, LobeModel, Table, TabulatedFile,
    testing::{planted_anisotropic, planted_tabulated},
};
use ltcforge_light::LightModel;

/// The tolerance, relative to the reflected energy.
const TOLERANCE: f64 = 0.005;
/// Errors of dim points are divided by this energy, relative to the energy of a light from everywhere.
const DIM: f64 = 0.05;
/// The least energy of a lit point, relative to the energy of a light from everywhere.
const LIT: f64 = 0.02;
const SIZE: u32 = 64;
const FLAT: &[LightKind] = &[LightKind::Rectangle, LightKind::Disk, LightKind::Polygon(3), LightKind::Polygon(6)];
const ROUND: &[LightKind] = &[LightKind::Sphere, LightKind::Tube, LightKind::Line];
/// Samples per pixel. Their noise is a third of the tolerance.
const SAMPLES: u32 = 1 << 13;

/// A point of the sphere in f64, from this test's own geometry. The rows of `to_local` are its tangent frame, and `wo`
/// is in this frame.
struct Point {
    position: DVec3,
    to_local: DMat3,
    wo: DVec3,
}

fn point_in(scene: &Scene, pixel: [u32; 2]) -> Option<Point> {
    let camera = &scene.camera;
    let turn = DMat3::from_rotation_y(camera.azimuth) * DMat3::from_rotation_x(-camera.elevation);
    let eye = turn * DVec3::Z * camera.distance;
    let half = (0.5 * camera.field_of_view).tan();
    let at = |i: usize| ((f64::from(pixel[i]) + 0.5) / f64::from(SIZE) * 2.0 - 1.0) * half;
    let ray = (turn * DVec3::new(at(0), -at(1), -1.0)).normalize();
    let middle = -eye.dot(ray);
    let beside2 = (eye + middle * ray).length_squared();
    let position = eye + (middle - (1.0 - beside2).max(0.0).sqrt()) * ray;
    let along = DVec3::Y.cross(position).normalize();
    let turned = DMat3::from_axis_angle(position, scene.materials[0].rotation);
    let (x, y) = (turned * along, turned * position.cross(along));
    let to_local = DMat3::from_cols(x, y, position).transpose();
    // The sphere covers the pixels at its rim only partly.
    (beside2 < 0.98).then(|| Point { position, to_local, wo: to_local * (eye - position).normalize() })
}

/// Midpoints of a grid over the triangle fan of a convex polygon, each with its area.
fn grid(vertices: &[DVec3]) -> Vec<(DVec3, f64)> {
    const N: usize = 320;
    let mut points = Vec::new();
    for i in 2..vertices.len() {
        let (a, b, c) = (vertices[0], vertices[i - 1], vertices[i]);
        let area = 0.5 * (b - a).cross(c - a).length();
        for j in 0..N {
            // Strips of the triangle, parallel to the side b c.
            let t = (j as f64 + 0.5) / N as f64;
            let share = area * (2.0 * j as f64 + 1.0) / (N * N) as f64 / N as f64;
            points.extend((0..N).map(|k| (a + t * (b.lerp(c, (k as f64 + 0.5) / N as f64) - a), share)));
        }
    }
    points
}

/// Points of an ellipse with their areas, on rings of equal area.
fn rings(ellipse: &Ellipse<DVec3, f64>) -> Vec<(DVec3, f64)> {
    const N: usize = 800;
    let [x, y] = ellipse.half_axes.map(|(axis, _)| axis);
    let share = PI * x.length() * y.length() / (N * N) as f64;
    let radius = |j: usize| ((j as f64 + 0.5) / N as f64).sqrt();
    let angle = |k: usize| (k as f64 + 0.5) / N as f64 * TAU;
    let point = |(r, a): (f64, f64)| (ellipse.centre + r * (a.cos() * x + a.sin() * y), share);
    (0..N).flat_map(|j| (0..N).map(move |k| (radius(j), angle(k)))).map(point).collect()
}

/// Points of the surface of a tube with round ends, each with its normal and its area.
fn surface([start, end]: [DVec3; 2], radius: f64) -> Vec<(DVec3, DVec3, f64)> {
    const N: usize = 400;
    let axis = (end - start).try_normalize().unwrap_or(DVec3::X);
    let (x, y) = axis.any_orthonormal_pair();
    let share = 2.0 * PI * radius / (N * N) as f64;
    let mut points = Vec::new();
    for (along, around) in (0..N).flat_map(|i| (0..N).map(move |k| (i, k))) {
        let s = (along as f64 + 0.5) / N as f64;
        let (sin, cos) = ((around as f64 + 0.5) / N as f64 * TAU).sin_cos();
        let across = x * cos + y * sin;
        points.push((start.lerp(end, s) + across * radius, across, share * start.distance(end)));
        let height = 2.0 * s - 1.0;
        let normal = axis * height + across * (1.0 - height * height).sqrt();
        points.push((if height > 0.0 { end } else { start } + normal * radius, normal, share * 2.0 * radius));
    }
    points
}

/// A point of a light, its share of the area, and a function for the cosine of the emission angle.
type Sample = (DVec3, f64, Box<dyn Fn(DVec3) -> f64>);

/// The light's points, each with its area and the cosine for a direction from the shaded point.
fn points(scene: &Scene) -> Vec<Sample> {
    let outline = scene.light.outline();
    let (normal, two_sided) = (outline.normal, scene.light.two_sided);
    let flat = move |wi: DVec3| if two_sided { normal.dot(wi).abs() } else { (-normal.dot(wi)).max(0.0) };
    let flat = |(at, area): (DVec3, f64)| (at, area, Box::new(flat) as Box<dyn Fn(DVec3) -> f64>);
    match outline.shape {
        Shape::Polygon => grid(&outline.vertices).into_iter().map(flat).collect(),
        Shape::Ellipse(ellipse) => rings(&ellipse).into_iter().map(flat).collect(),
        Shape::Tube { ends, radius } => {
            let surface = surface(ends, radius).into_iter();
            let towards = |normal: DVec3| Box::new(move |wi: DVec3| (-normal.dot(wi)).max(0.0));
            surface.map(|(at, normal, area)| (at, area, towards(normal) as Box<dyn Fn(DVec3) -> f64>)).collect()
        }
        Shape::Line { ends: [start, end], width } => {
            const N: u32 = 100_000;
            let (axis, part) = ((end - start).normalize(), width * start.distance(end) / f64::from(N));
            let at = |i: u32| start.lerp(end, (f64::from(i) + 0.5) / f64::from(N));
            let sine = move |wi: DVec3| axis.cross(wi).length();
            (0..N).map(|i| (at(i), part, Box::new(sine) as Box<dyn Fn(DVec3) -> f64>)).collect()
        }
    }
}

/// Radiance for each channel: the sum of `reflects(wo, wi) -> (all, Fresnel part)` over the light.
fn expected(scene: &Scene, point: &Point, reflects: impl Fn(DVec3, DVec3) -> (f64, f64)) -> [f64; 3] {
    let (mut all, mut fresnel) = (0.0, 0.0);
    for (at, area, cosine) in points(scene) {
        let to_light = at - point.position;
        let distance2 = to_light.length_squared();
        let wi = to_light / distance2.sqrt();
        let facing = cosine(wi);
        let (a, f) = reflects(point.wo, point.to_local * wi);
        all += a * area * facing / distance2;
        fresnel += f * area * facing / distance2;
    }
    scene.f0.map(|f0| scene.light.intensity * (f0 * (all - fresnel) + fresnel))
}

/// Twenty sets of material, light, camera and pixel, from sharp to rough. The lights are near the mirror direction, and
/// the horizon cuts some of them. The last set has the roughest surface and a view from above.
fn configurations(kinds: &[LightKind]) -> Vec<(Scene, [u32; 2])> {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(20);
    let mut within = |low: f64, high: f64| low + (high - low) * (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
    let mut found = Vec::new();
    while found.len() < 20 {
        let rough = |u: f64| 0.03 + 0.97 * u * u;
        let material = Material {
            alpha_x: rough(within(0.0, 1.0)),
            alpha_y: rough(within(0.0, 1.0)),
            rotation: within(-3.0, 3.0),
        };
        let camera =
            Camera { distance: 4.0, azimuth: within(-3.0, 3.0), elevation: within(-1.0, 1.0), ..Camera::default() };
        let mut scene = Scene {
            materials: vec![material],
            f0: [0.2, 0.6, 0.9],
            camera,
            size: SIZE,
            spp: SAMPLES,
            ..Scene::default()
        };
        let pixel = [0; 2].map(|_: u32| within(4.0, 60.0) as u32);
        let Some(point) = point_in(&scene, pixel) else { continue };
        let mirror = point.to_local.transpose() * DVec3::new(-point.wo.x, -point.wo.y, point.wo.z);
        let jitter = DVec3::from([0; 3].map(|_: u32| within(-0.6, 0.6)));
        scene.light = Light {
            kind: kinds[found.len() % kinds.len()],
            centre: (point.position + 1.2 * mirror + jitter).to_array(),
            half_size: [within(0.2, 1.2), within(0.2, 1.2)],
            rotation: [within(-1.0, 1.0), within(-1.0, 1.0), within(-3.0, 3.0)],
            intensity: 2.0,
            two_sided: found.len() % 2 == 0,
        };
        // Another test covers spheres and tubes that contain the shaded point.
        if let Shape::Tube { ends: [start, end], radius } = scene.light.outline().shape {
            let along = end - start;
            let foot = (point.position - start).dot(along) / along.length_squared().max(1e-30);
            if (start + along * foot.clamp(0.0, 1.0)).distance(point.position) < 1.1 * radius {
                continue;
            }
        }
        found.push((scene, pixel));
    }
    let rough = Material { alpha_x: 1.0, alpha_y: 1.0, rotation: 0.0 };
    let light = Light { kind: kinds[0], ..Light::default() };
    let from_above = Scene { materials: vec![rough], light, size: SIZE, spp: SAMPLES, ..Scene::default() };
    found.push((from_above, [SIZE / 2; 2]));
    found
}

/// Compares the renderers' radiance with the expected radiance. Most configurations must be lit. `faint` is the light
/// that a surface reflects in one direction, relative to metal. It scales the tolerance and the threshold for lit
/// points.
fn assert_true(
    renderers: &mut [Preview],
    table: &Arc<ShaderTable>,
    (estimator, kinds): (Estimator, &[LightKind]),
    faint: f64,
    truth: impl Fn(&Scene, &Point) -> [f64; 3],
) {
    let mut lit = 0;
    let configurations = configurations(kinds);
    let (scene, pixel) = &configurations[20];
    assert!(point_in(scene, *pixel).expect("on the sphere").wo.z > 0.999);
    for (scene, pixel) in configurations {
        let point = point_in(&scene, pixel).expect("on the sphere");
        let wanted = truth(&scene, &point);
        lit += usize::from(wanted[1] > faint * LIT * scene.light.intensity);
        for preview in &mut *renderers {
            let part = preview.part(table, &scene, estimator, pixel, [1, 1]).expect("radiance");
            let found = part.pixels[0].map(f64::from);
            for (found, wanted) in found.into_iter().zip(wanted) {
                let apart = (found - wanted).abs() / wanted.max(faint * DIM * scene.light.intensity);
                assert!(apart < TOLERANCE, "{}: {found} is not {wanted}: {scene:?} {pixel:?}", table.brdf);
            }
        }
    }
    let least = if faint < 1.0 { 6 } else { 12 };
    assert!(lit >= least, "{}: only {lit} points are lit", table.brdf);
}

#[test]
fn the_reference_converges_to_the_integral_of_ggx() {
    for kinds in [FLAT, ROUND] {
        let table = shader_table(TexelFormat::F32);
        assert_true(&mut renderers(), &table, (Estimator::Reference, kinds), 1.0, |scene, point| {
            integral(&BrdfKind::Ggx.into(), scene, point)
        });
    }
}

/// The integral of a scattering model over the light.
fn integral(brdf: &BrdfModel, scene: &Scene, point: &Point) -> [f64; 3] {
    let Material { alpha_x, alpha_y, .. } = scene.materials[0];
    let surface = brdf.surface([alpha_x, alpha_y]);
    expected(scene, point, |wo, wi| {
        let all = surface.eval_cos(wo, wi);
        (all, all * (1.0 - wo.dot((wo + wi).normalize())).powi(5))
    })
}

/// The reference of a table uses the table's scattering model, and is rendered by the CPU.
#[test]
fn every_reference_converges_to_the_integral_of_its_model() {
    for brdf in BrdfKind::formulas().map(BrdfModel::from).chain([planted_tabulated(), planted_anisotropic()]) {
        let table = Arc::new(ShaderTable::new(&Table { brdf: brdf.clone(), ..planted() }, TexelFormat::F32));
        let mut renderers = [Adapter::Any, Adapter::Cpu].map(Preview::new);
        // Sheen and diffuse surfaces reflect little light in any single direction.
        let faint = if brdf.follows_reflection() { 1.0 } else { 0.1 };
        let kinds = [LightKind::Disk, LightKind::Tube, LightKind::Sphere, LightKind::Line];
        let reference = (Estimator::Reference, &kinds[..]);
        assert_true(&mut renderers, &table, reference, faint, |scene, point| integral(&brdf, scene, point));
    }
}

/// Shaders only have the reference for GGX, and model `normals` only supports GGX. Pictures that would compare them
/// with a table of another model are rejected. Pictures without a reference are accepted.
#[test]
fn pictures_that_would_compare_different_models_are_rejected() {
    let planted = Table { brdf: BrdfKind::Charlie.into(), ..planted() };
    let table = Arc::new(ShaderTable::new(&planted, TexelFormat::F32));
    let scene = |mode, model| Scene { mode, model, size: 64, spp: 1, ..Scene::default() };
    let refused = |fault| Err(PreviewError::Table(vec![fault]));
    let mut cpu = Preview::new(Adapter::Cpu);
    for scene in [
        scene(Mode::Strip, LightModel::Normals),
        scene(Mode::Ltc, LightModel::Normals),
        scene(Mode::Models, LightModel::Ltc),
    ] {
        assert_eq!(cpu.render(&table, &scene, &|| false), refused(TableFault::OtherBrdf(BrdfKind::Charlie)));
    }
    // The model has no facets, so there is nothing to compensate.
    let compensated = Scene { compensate: true, ..scene(Mode::Ltc, LightModel::Ltc) };
    assert_eq!(cpu.render(&table, &compensated, &|| false), refused(TableFault::NoFacets(BrdfKind::Charlie)));
    // The model has no Fresnel factor. Its only reflectance is one, which is also the default.
    let dark = Scene { f0: [0.04; 3], ..scene(Mode::Ltc, LightModel::Ltc) };
    assert_eq!(cpu.render(&table, &dark, &|| false), refused(TableFault::NoFresnel(BrdfKind::Charlie)));
    // All faults of a picture are reported at once.
    let all = Scene { compensate: true, f0: [0.04; 3], ..scene(Mode::Strip, LightModel::Normals) };
    let faults = [TableFault::OtherBrdf, TableFault::NoFacets, TableFault::NoFresnel].map(|f| f(BrdfKind::Charlie));
    assert_eq!(cpu.render(&table, &all, &|| false), Err(PreviewError::Table(faults.to_vec())));
    let metal = Scene { f0: [1.0; 3], ..scene(Mode::Ltc, LightModel::Ltc) };
    let [default, metal] = [scene(Mode::Ltc, LightModel::Ltc), metal]
        .map(|scene| cpu.render(&table, &scene, &|| false).expect("a picture").picture);
    assert!(default == metal);
    let strip = scene(Mode::Strip, LightModel::Ltc);
    let mut gpu = Preview::new(Adapter::Gpu);
    assert_eq!(gpu.render(&table, &strip, &|| false), Err(PreviewError::CpuOnly(BrdfKind::Charlie)));
    let rendered = Preview::new(Adapter::Any).render(&table, &strip, &|| false).expect("the CPU renders it");
    assert_eq!(rendered.adapter, "cpu");
    assert_eq!(rendered.errors.len(), 1);
    assert!(cpu.render(&table, &scene(Mode::Lobe, LightModel::Ltc), &|| false).is_ok());
    assert!(cpu.render(&table, &scene(Mode::Ltc, LightModel::Ltc), &|| false).is_ok());
}

/// A tabulated BRDF without its file has no reference, but its table can be shown.
#[test]
fn a_missing_file_is_an_error_if_the_reference_is_shown() {
    let unread = BrdfModel::tabulated(TabulatedFile::unread([7; 32]));
    let table = Arc::new(ShaderTable::new(&Table { brdf: unread, ..planted() }, TexelFormat::F32));
    let scene = |mode| Scene { mode, size: 64, spp: 1, ..Scene::default() };
    let mut cpu = Preview::new(Adapter::Cpu);
    for mode in [Mode::Strip, Mode::Reference, Mode::Lobe] {
        let refused = cpu.render(&table, &scene(mode), &|| false);
        assert_eq!(refused, Err(PreviewError::NoBrdfFile(format!("sha256:{}", "07".repeat(32)))), "{mode:?}");
    }
    assert!(cpu.render(&table, &scene(Mode::Ltc), &|| false).is_ok());
}

#[test]
fn a_planted_diffuse_table_is_lit_like_a_diffuse_surface() {
    let table = Arc::new(ShaderTable::new(&diffuse(), TexelFormat::F32));
    for kinds in [FLAT, ROUND] {
        assert_true(&mut renderers(), &table, (Estimator::Table(LobeModel::Ltc), kinds), 1.0, |scene, point| {
            expected(scene, point, |_, wi| (wi.z.max(0.0) / PI, 0.0))
        });
    }
}
