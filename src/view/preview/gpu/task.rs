//! A rendering task for a GPU, and its parts.

use std::time::Duration;

use super::tiles;
use crate::preview::{
    cost::most_cost,
    estimator::Estimator,
    frame::{Frame, Part},
};

/// The largest number of samples per part. A part is one submission to the GPU, and takes a third of a second on two
/// slow cores. The caller can stop only between parts, because a busy driver can neither be stopped nor dropped.
/// Smaller parts cost more, because lavapipe without a shader cache takes 0.1 s per part to compile the reference.
/// Parts get smaller only if they take longer than usual, for example on a busy machine.
const SAMPLES_A_PART: u32 = 1 << 24;
/// Samples per pixel in one pass. Lavapipe ends a shader's loops after 65535 steps, nested loops included, and a sample
/// takes up to 15 steps.
const SAMPLES_A_PASS: u32 = 1024;
/// The largest number of workgroups per dispatch that every GPU supports.
const TILES_A_PART: u32 = 65_535;

/// A picture, or a part of a picture, to render.
#[derive(Debug)]
pub(in crate::preview) struct RenderTask<'a> {
    pub(in crate::preview) frame: &'a Frame,
    pub(in crate::preview) estimator: Estimator,
    /// The upper left pixel of the rendered part.
    pub(in crate::preview) corner: [u32; 2],
    /// Width and height of the rendered part.
    pub(in crate::preview) extent: [u32; 2],
}

impl<'a> RenderTask<'a> {
    /// The task of a whole frame.
    pub(in crate::preview) fn whole(frame: &'a Frame, estimator: Estimator) -> Self {
        Self { frame, estimator, corner: [0; 2], extent: [frame.size; 2] }
    }

    /// The parts that are sent to the GPU one at a time: some of the visible tiles, and a range of their samples.
    pub(super) fn parts(&self, tiles: u32) -> TaskParts {
        let is_sampled = self.estimator == Estimator::Reference;
        let samples = if is_sampled { self.frame.spp } else { 1 };
        let cost = if is_sampled { samples.min(SAMPLES_A_PASS) } else { most_cost() };
        let most = (SAMPLES_A_PART / cost / (tiles::SIDE * tiles::SIDE)).min(TILES_A_PART);
        TaskParts { tiles, samples, most, now: most, first_tile: 0, first_sample: 0 }
    }
}

/// After a part that took longer than this, parts have half as many tiles.
const SLOW: Duration = Duration::from_millis(400);
/// After a part that took less than this, parts have twice as many tiles.
const FAST: Duration = Duration::from_millis(100);

/// The parts of a task that are still to be rendered.
#[derive(Debug)]
pub(super) struct TaskParts {
    tiles: u32,
    samples: u32,
    /// The largest number of tiles per part, and the number of tiles in the current part.
    most: u32,
    now: u32,
    first_tile: u32,
    first_sample: u32,
}

impl TaskParts {
    /// The next part. `took` is the duration of the last part, if there was one.
    pub(super) fn next(&mut self, took: Option<Duration>) -> Option<Part> {
        let Self { tiles, samples, most, .. } = *self;
        if self.first_sample >= samples {
            self.first_tile += self.now;
            self.first_sample = 0;
        }
        // The number of tiles changes only before the first pass over new tiles.
        match took {
            Some(took) if self.first_sample == 0 && took > SLOW => self.now = (self.now / 2).max(1),
            Some(took) if self.first_sample == 0 && took < FAST => self.now = self.now.saturating_mul(2).min(most),
            _ => {}
        }
        if self.first_tile >= tiles {
            return None;
        }
        let first_sample = self.first_sample;
        self.first_sample += SAMPLES_A_PASS;
        Some(Part {
            first_tile: self.first_tile,
            tiles: self.now.min(tiles - self.first_tile),
            first_sample,
            samples: SAMPLES_A_PASS.min(samples - first_sample),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::Scene;

    #[test]
    fn parts_take_each_sample_of_each_tile_once() {
        let cases = [(64, 4096), (4096, 64), (4225, 700), (65536, 1), (64, 1025), (0, 64)];
        for ((tiles, spp), millis) in cases.into_iter().flat_map(|case| [(case, 0), (case, 200), (case, 900)]) {
            let frame = Frame::new(&Scene { spp, ..Scene::default() }, false);
            let mut samples = vec![0_u32; tiles as usize];
            let mut parts = RenderTask::whole(&frame, Estimator::Reference).parts(tiles);
            let mut took = None;
            while let Some(part) = parts.next(took) {
                took = Some(Duration::from_millis(millis));
                assert!(part.tiles * 64 * part.samples <= SAMPLES_A_PART && part.tiles <= TILES_A_PART);
                for tile in part.first_tile..part.first_tile + part.tiles {
                    assert_eq!(samples[tile as usize], part.first_sample);
                    samples[tile as usize] += part.samples;
                }
            }
            assert!(samples.iter().all(|samples| *samples == spp), "{tiles} {spp} {millis}");
        }
    }

    /// The caller can stop between any two parts.
    #[test]
    fn slow_parts_are_halved_and_fast_parts_grow() {
        let frame = Frame::new(&Scene { spp: 64, ..Scene::default() }, false);
        let mut parts = RenderTask::whole(&frame, Estimator::Reference).parts(1 << 16);
        let mut tiles = |took| parts.next(took).expect("more tiles").tiles;
        let (slow, usual, fast) = (Duration::from_secs(4), Duration::from_millis(200), Duration::ZERO);
        assert_eq!(tiles(None), 4096);
        let next = [slow, slow, usual, fast, fast, fast].map(|took| tiles(Some(took)));
        assert_eq!(next, [2048, 1024, 1024, 2048, 4096, 4096]);
        let least = (0..20).map(|_| tiles(Some(slow))).last();
        assert_eq!(least, Some(1));
    }
}
