//! How fast a renderer is, measured before its first scene.

use std::{
    sync::Arc,
    time::{Duration, Instant},
};

use ltcforge_view::preview::{Mode, Preview, PreviewError, Scene, ShaderTable, Stop};

/// Side and samples of the smallest reference. Its time is the one that does not grow with the samples.
const LEAST: (u32, u32) = (64, 1);
/// Sides and samples of the references that are timed, each four times as much work as the one before.
const GROWING: [(u32, u32); 7] = [(128, 16), (128, 64), (256, 64), (256, 256), (512, 256), (512, 1024), (1024, 1024)];
/// A reference that takes so much longer than the smallest tells the rate.
const TIMED: Duration = Duration::from_millis(40);

/// What was measured.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Probed {
    /// What rendered: an adapter's name, or `cpu`.
    pub(super) adapter: String,
    /// Seconds for each sample of the reference.
    pub(super) rate: f64,
}

/// Measures `preview` on references with `table`, in some tenths of a second; opens the adapter. `None` if another
/// renderer stood in meanwhile, or the clock was too coarse.
///
/// # Errors
/// As those of a picture.
pub(super) fn probe(
    preview: &mut Preview,
    table: &Arc<ShaderTable>,
    stop: Stop<'_>,
) -> Result<Option<Probed>, PreviewError> {
    let mut timed = |(size, spp): (u32, u32)| {
        let scene = Scene { mode: Mode::Reference, size, spp, ..Scene::default() };
        let start = Instant::now();
        let rendered = preview.render(table, &scene, stop)?;
        Ok::<_, PreviewError>((start.elapsed(), scene.cost(), rendered.adapter))
    };
    // The first opens a device and compiles.
    timed(LEAST)?;
    let (least, least_cost, adapter) = timed(LEAST)?;
    let mut rate = 0.0;
    for reference in GROWING {
        let (time, cost, by) = timed(reference)?;
        if by != adapter {
            return Ok(None);
        }
        let longer = time.saturating_sub(least);
        rate = longer.as_secs_f64() / (cost - least_cost);
        if longer >= TIMED {
            break;
        }
    }
    Ok((rate > 0.0).then_some(Probed { adapter, rate }))
}
