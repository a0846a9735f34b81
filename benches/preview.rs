//! The time of the first picture, of a picture by each estimator after a warm-up, and of the lookup.
//!
//! `cargo bench --bench preview`. The time of the lookup is the difference between a frame and a frame whose lookup is
//! replaced by a constant. All variants take turns, so a busy machine slows all of them.
#![allow(missing_docs, reason = "criterion's macros define undocumented functions")]

use std::{
    ops::ControlFlow,
    sync::Arc,
    time::{Duration, Instant},
};

use criterion::{Criterion, criterion_group, criterion_main};
use ltcforge::{
    files::recipe_document::{self, DEFAULT_ENTRY_LIMIT},
    fit::{Plan, Table, assemble, fit_shard},
    light::{LightModel, normals::NormalsRule},
    view::preview::{Adapter, Light, LightKind, Material, Mode, Preview, Scene, ShaderTable, TexelFormat, Weights},
};

/// The table of a layout at its default resolution. The quality of its fit does not change the time of a picture.
fn table(layout: &str) -> Table {
    let document = format!(r#"{{"preset": "draft", "layout": "{layout}"}}"#);
    let plan = Plan::new(&recipe_document::parse(document.as_bytes(), DEFAULT_ENTRY_LIMIT).expect("a recipe"));
    let go_on = &mut |_: u64| ControlFlow::Continue(());
    let shards = (0..plan.shards()).map(|shard| fit_shard(&plan, shard, go_on).expect("not interrupted"));
    assemble(&plan, &shards.collect::<Vec<_>>().concat())
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

/// The median and the least time. The least time is that of an idle machine.
fn summary(mut times: Vec<Duration>) -> String {
    times.sort();
    format!("{:.1?}, at least {:.1?}", times[times.len() / 2], times[0])
}

fn frames(_: &mut Criterion) {
    const RUNS: usize = 21;
    let (reflected, kt2022) = (table("reflected"), table("kt2022"));
    let single = Arc::new(ShaderTable::new(&reflected, TexelFormat::F32));
    let half = Arc::new(ShaderTable::new(&reflected, TexelFormat::F16));
    let kt2022 = Arc::new(ShaderTable::new(&kt2022, TexelFormat::F32));
    let ltc = scene(Mode::Ltc);
    let mut gpu = Preview::new(Adapter::Any);
    let first = timed(&mut gpu, &single, &ltc);
    println!("adapter: {}", gpu.adapter_name().expect("a name"));
    println!("first 512 x 512 frame, device and shaders included: {first:.1?}");

    let weights = |weights| Preview::with_weights(Adapter::Any, weights);
    let normals = |rule| Scene { model: LightModel::Normals, rule, ..scene(Mode::Ltc) };
    let by = |model| Scene { model, ..scene(Mode::Ltc) };
    let octagon = |scene: Scene| Scene { light: Light { kind: LightKind::Polygon(8), ..scene.light }, ..scene };
    let usual = || Preview::new(Adapter::Any);
    let mut candidates = [
        ("ltc", gpu, &single, ltc.clone()),
        ("ltc, layout kt2022", usual(), &kt2022, ltc.clone()),
        ("ltc, f16 table", usual(), &half, ltc.clone()),
        ("ltc, weights by the shader", weights(Weights::Shader), &single, ltc.clone()),
        ("ltc, weights by the sampler", weights(Weights::Sampler), &single, ltc.clone()),
        ("ltc, eight edges", usual(), &single, octagon(ltc.clone())),
        ("normals, rule balanced", usual(), &single, normals(NormalsRule::Balanced)),
        ("normals, rule fast", usual(), &single, normals(NormalsRule::Fast)),
        ("normals, rule fine", usual(), &single, normals(NormalsRule::Fine)),
        ("ltc-formula", usual(), &single, by(LightModel::LtcFormula)),
        ("normals, eight edges", usual(), &single, octagon(normals(NormalsRule::Balanced))),
        ("sg", usual(), &single, by(LightModel::Sg)),
        ("asg", usual(), &single, by(LightModel::Asg)),
        ("asg, eight edges", usual(), &single, octagon(by(LightModel::Asg))),
        ("ltc, CPU twin", Preview::new(Adapter::Cpu), &single, ltc.clone()),
    ];
    let mut times = candidates.each_ref().map(|_| Vec::new());
    for _ in 0..RUNS {
        for (times, (_, preview, table, scene)) in times.iter_mut().zip(&mut candidates) {
            times.push(timed(preview, table, scene));
        }
    }
    for (times, (name, ..)) in times.into_iter().zip(&candidates) {
        println!("{name}: {}", summary(times));
    }
    let reference = scene(Mode::Reference);
    for index in [0, candidates.len() - 1] {
        let (name, preview, table, _) = &mut candidates[index];
        let times = (0..5).map(|_| timed(preview, table, &reference)).collect();
        let twin = if name.contains("CPU") { ", CPU twin" } else { "" };
        println!("reference, 64 samples per pixel{twin}: {}", summary(times));
    }
}

criterion_group!(benches, frames);
criterion_main!(benches);
