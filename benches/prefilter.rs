//! The time to compute a picture's pyramid on two threads: for 1024 x 1024 texels, and for a size that is odd on every
//! level.
//!
//! `cargo bench --bench prefilter`.
#![allow(missing_docs, reason = "criterion's macros define undocumented functions")]

use criterion::{Criterion, criterion_group, criterion_main};
use ltcforge::light::textured::{LightImage, LightPyramid};

/// A picture of noise.
fn picture(side: usize) -> LightImage {
    let number = |i: usize| (i.wrapping_mul(2_654_435_761) % 1000) as f32 / 1000.0;
    let texels = (0..side * side).map(|i| [number(3 * i), number(3 * i + 1), number(3 * i + 2)]).collect();
    LightImage::new(side, side, texels).expect("a picture")
}

fn pyramids(criterion: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
    for side in [1024, 1023] {
        let image = picture(side);
        criterion.bench_function(&format!("pyramid of {side} x {side} on two threads"), |bench| {
            bench.iter(|| pool.install(|| LightPyramid::new(&image)));
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20);
    targets = pyramids
}
criterion_main!(benches);
