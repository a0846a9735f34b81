//! The time and the memory for planning on two threads. The scene has a million triangles, and 50 textures of 1024 x
//! 1024 texels with metals and dielectrics. It is planned for all views, and for two cameras.
//!
//! `cargo bench -p ltcforge-benches --bench plan`.
#![allow(missing_docs, reason = "criterion's macros define undocumented functions")]

use std::{fs, time::Instant};

use criterion::{Criterion, criterion_group, criterion_main};
use ltcforge_plan::{Budget, Form, Needs, Scene, TablePlan};
use serde_json::{Value, json};

/// Textures. Each has its own material and mesh.
const TEXTURES: usize = 50;
const TEXELS: usize = 1024;
/// Squares along a side of a mesh. Each has two triangles.
const SQUARES: u32 = 100;

/// A pseudo-random byte for each `i`.
fn mixed(i: usize) -> u8 {
    let bits = (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (bits >> 56) as u8
}

/// A PNG with slowly changing roughness, a little noise, and spots of metal.
fn texture(number: usize) -> Vec<u8> {
    let texel = |i: usize| {
        let (x, y) = (i % TEXELS, i / TEXELS);
        let roughness = 40 + (x / 16 + y / 32 + 2 * number) % 150 + usize::from(mixed(i) >> 5);
        [0, roughness as u8, if mixed(x / 64 + 31 * (y / 64) + number) < 80 { 255 } else { 0 }]
    };
    let texels: Vec<u8> = (0..TEXELS * TEXELS).flat_map(texel).collect();
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, TEXELS as u32, TEXELS as u32);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&texels).expect("texels");
    writer.finish().expect("an image");
    out
}

/// Parts of a binary chunk, with their buffer views and accessors.
#[derive(Default)]
struct Parts {
    binary: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Parts {
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.views.push(json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len() }));
        self.binary.extend(bytes);
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    fn accessor(&mut self, bytes: &[u8], component: u32, count: u32, shape: &str) -> usize {
        let view = self.view(bytes);
        self.accessors.push(json!({ "bufferView": view, "componentType": component, "count": count, "type": shape }));
        self.accessors.len() - 1
    }

    fn floats(&mut self, numbers: &[f32], count: u32, shape: &str) -> usize {
        let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.accessor(&bytes, 5126, count, shape)
    }
}

/// A wavy sheet of `2 SQUARES^2` triangles.
fn sheet(parts: &mut Parts, material: usize) -> Value {
    let side = SQUARES + 1;
    let (mut positions, mut normals, mut uv, mut order) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (i, j) in (0..side).flat_map(|j| (0..side).map(move |i| (i, j))) {
        let [u, v] = [i, j].map(|k| k as f32 / SQUARES as f32);
        let slope = [0.3 * (6.0 * u).cos(), 0.2 * (8.0 * v).cos()];
        positions.extend([u, v, 0.05 * (6.0 * u).sin() + 0.025 * (8.0 * v).sin()]);
        let length = (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
        normals.extend([-slope[0] / length, -slope[1] / length, 1.0 / length]);
        uv.extend([u, v]);
    }
    for (i, j) in (0..SQUARES).flat_map(|j| (0..SQUARES).map(move |i| (i, j))) {
        let corner = j * side + i;
        order.extend([corner, corner + 1, corner + side + 1, corner, corner + side + 1, corner + side]);
    }
    let indices: Vec<u8> = order.iter().flat_map(|index| index.to_le_bytes()).collect();
    let corners = side * side;
    let attributes = json!({
        "POSITION": parts.floats(&positions, corners, "VEC3"), "NORMAL": parts.floats(&normals, corners, "VEC3"),
        "TEXCOORD_0": parts.floats(&uv, corners, "VEC2"),
    });
    let indices = parts.accessor(&indices, 5125, 6 * SQUARES * SQUARES, "SCALAR");
    json!({ "primitives": [{ "attributes": attributes, "indices": indices, "material": material }] })
}

/// The scene as a GLB.
fn scene(has_cameras: bool) -> Vec<u8> {
    let mut parts = Parts::default();
    let images: Vec<Value> = (0..TEXTURES).map(|i| json!({ "bufferView": parts.view(&texture(i)) })).collect();
    let meshes: Vec<Value> = (0..TEXTURES).map(|i| sheet(&mut parts, i)).collect();
    let material = |i: usize| json!({ "pbrMetallicRoughness": { "metallicRoughnessTexture": { "index": i } } });
    let place = |i: usize| json!({ "mesh": i, "translation": [i % 10, i / 10, 0] });
    let mut nodes: Vec<Value> = (0..TEXTURES).map(place).collect();
    let mut cameras = Vec::new();
    if has_cameras {
        cameras.push(json!({ "type": "perspective", "perspective": { "yfov": 1.2, "znear": 0.1 } }));
        nodes.extend([3.0, 7.0].map(|x| json!({ "camera": 0, "translation": [x, 2.5, 4.0] })));
    }
    let roots: Vec<usize> = (0..nodes.len()).collect();
    let document = json!({
        "asset": { "version": "2.0" }, "scenes": [{ "nodes": roots }], "nodes": nodes, "meshes": meshes, "images": images,
        "cameras": cameras, "materials": (0..TEXTURES).map(material).collect::<Vec<_>>(),
        "textures": (0..TEXTURES).map(|i| json!({ "source": i })).collect::<Vec<_>>(),
        "bufferViews": parts.views, "accessors": parts.accessors, "buffers": [{ "byteLength": parts.binary.len() }],
    });
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let length = |bytes: usize| (bytes as u32).to_le_bytes();
    let mut out = [b"glTF".as_slice(), &length(2), &length(28 + text.len() + parts.binary.len())].concat();
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &parts.binary)] {
        out.extend([length(chunk.len()).as_slice(), kind, chunk].concat());
    }
    out
}

/// Reads the scene and plans its table. Returns the time after each step.
fn planned<T>(glb: &[u8], now: impl Fn() -> T) -> [T; 2] {
    let scene = Scene::from_bytes(glb.to_vec(), &|| true).expect("a scene");
    let read = now();
    let needs = Needs::of(&scene, false).expect("lobes");
    let plan = TablePlan::new(needs, Budget::Bytes(20_000), Form::default(), &|| true).expect("nothing stops it");
    assert!(plan.is_met && scene.triangles == 1_000_000);
    [read, now()]
}

/// The processor time of all threads of this process, in seconds.
fn processor_seconds() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// The peak memory of this process in megabytes. `None` if the system does not report it.
fn most_memory() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? / 1000)
}

fn plans(criterion: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    for (name, has_cameras) in [("seen from everywhere", false), ("seen by two cameras", true)] {
        let glb = scene(has_cameras);
        let (wall, processor) = (Instant::now(), processor_seconds());
        let now = || [wall.elapsed().as_secs_f64(), processor_seconds() - processor];
        let [read, end] = pool.install(|| planned(&glb, now));
        println!(
            "{name}: read in {:.2} s, planned after {:.2} s (processor time of both threads: {:.2} and {:.2} s); peak memory {} MB",
            read[0],
            end[0],
            read[1],
            end[1],
            most_memory().map_or("an unknown number of".to_owned(), |megabytes| megabytes.to_string())
        );
        criterion.bench_function(&format!("a plan on two threads, {name}"), |bench| {
            bench.iter(|| pool.install(|| planned(&glb, || ())));
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = plans
}
criterion_main!(benches);
