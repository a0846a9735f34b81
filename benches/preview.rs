//! What a picture costs: the first one, one of each estimator once warm, and what of it is the lookup.
//!
//! `cargo bench --bench preview`. The lookup's cost is the difference between a frame and one whose lookup is replaced by
//! a constant; all variants take turns, so that a busy machine slows all of them.
#![allow(missing_docs, reason = "criterion's macros define undocumented functions")]

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use criterion::{Criterion, criterion_group, criterion_main};
use glam::{DMat3, DVec3};
use ltcforge::{
    ltc::{Layout, PerAxis, Table, Terms},
    math::{row_major, sin_cos},
    preview::{Adapter, Material, Mode, Precision, Preview, Scene, ShaderTable, Variant, Weights},
};

/// Nodes on each axis, as in the paper.
const NODES: u32 = 8;

/// A table of the limit of sharp lobes: what it holds does not change what it costs.
fn table() -> Table {
    let uniform = |high: f64| (0..NODES).map(|i| (high * f64::from(i) / f64::from(NODES - 1)).max(1e-4)).collect();
    let axes: PerAxis<Vec<f64>> =
        PerAxis { alpha: uniform(1.0), ratio: uniform(1.0), theta: uniform(1.57), phi: uniform(1.57) };
    let mut matrix = Vec::new();
    for alpha in &axes.alpha {
        for ratio in &axes.ratio {
            for theta in &axes.theta {
                for phi in &axes.phi {
                    let ((sin_t, cos_t), (sin_p, cos_p)) = (sin_cos(*theta), sin_cos(*phi));
                    let v = DVec3::new(sin_t * cos_p, sin_t * sin_p, cos_t.max(1e-4));
                    let m = DMat3::from_cols(
                        2.0 * alpha * DVec3::new(v.z, 0.0, v.x),
                        2.0 * alpha * ratio * DVec3::new(0.0, v.z, v.y),
                        DVec3::new(-v.x, -v.y, v.z),
                    );
                    matrix.push(row_major(&m).map(|x| x as f32));
                }
            }
        }
    }
    let entries = matrix.len();
    let terms = Some(Terms { amplitude: vec![1.0; entries], fresnel: vec![0.0; entries] });
    Table { layout: Layout::Kt2022, axes, matrix, terms, node_error: vec![0.0; entries] }
}

fn scene(mode: Mode) -> Scene {
    let materials = vec![Material { alpha_x: 0.3, alpha_y: 0.08, rotation: 0.4 }];
    Scene { materials, mode, size: 512, spp: 64, ..Scene::default() }
}

fn timed(preview: &mut Preview, table: &Arc<ShaderTable>, scene: &Scene) -> Duration {
    let start = Instant::now();
    preview.render(table, scene, &|| false).expect("a picture");
    start.elapsed()
}

/// The median, and the least: what a machine that does something else too would take without it.
fn summary(mut times: Vec<Duration>) -> String {
    times.sort();
    format!("{:.1?}, at least {:.1?}", times[times.len() / 2], times[0])
}

fn frames(_: &mut Criterion) {
    const RUNS: usize = 21;
    let table = |precision| Arc::new(ShaderTable::new(&table(), precision));
    let (single, half) = (table(Precision::F32), table(Precision::F16));
    let ltc = scene(Mode::Ltc);
    let mut gpu = Preview::new(Adapter::Any);
    let first = timed(&mut gpu, &single, &ltc);
    println!("adapter: {}", gpu.adapter_name().expect("a name"));
    println!("first 512 x 512 frame, device and shaders included: {first:.1?}");

    let variant = |variant| Preview::with_variant(Adapter::Any, variant);
    let constant = Variant { lookup_is_constant: true, ..Variant::default() };
    let weights = |weights| variant(Variant { weights, ..Variant::default() });
    let mut candidates = [
        ("ltc", gpu, &single),
        ("ltc, f16 table", variant(Variant::default()), &half),
        ("ltc, weights by the shader", weights(Weights::Shader), &single),
        ("ltc, weights by the sampler", weights(Weights::Sampler), &single),
        ("ltc, lookup replaced by a constant", variant(constant), &single),
        ("ltc, CPU twin", Preview::new(Adapter::Cpu), &single),
    ];
    let mut times = [const { Vec::new() }; 6];
    for _ in 0..RUNS {
        for (times, (_, preview, table)) in times.iter_mut().zip(&mut candidates) {
            times.push(timed(preview, table, &ltc));
        }
    }
    for (times, (name, ..)) in times.into_iter().zip(&candidates) {
        println!("{name}: {}", summary(times));
    }
    let reference = scene(Mode::Reference);
    for index in [0, candidates.len() - 1] {
        let (name, preview, table) = &mut candidates[index];
        let times = (0..5).map(|_| timed(preview, table, &reference)).collect();
        let twin = if name.contains("CPU") { ", CPU twin" } else { "" };
        println!("reference, 64 samples a pixel{twin}: {}", summary(times));
    }
}

criterion_group!(benches, frames);
criterion_main!(benches);
