//! What a GPU renders in one go, and in which parts.

use super::tiles;
use crate::view::preview::{
    cost::NORMALS_COST,
    estimator::Estimator,
    frame::{Frame, Part},
};

/// Samples that are sent to the GPU at a time. They take a third of a second on two slow cores, after which the caller may
/// stop: a driver that is busy can neither be stopped nor dropped. Smaller parts cost more, since lavapipe without a
/// shader cache takes 0.1 s per part to compile the reference anew.
const SAMPLES_A_PART: u32 = 1 << 24;
/// Samples of a pixel that one pass takes. Lavapipe ends a shader's loops after 65535 steps, nested ones included, and a
/// sample takes up to 15.
const SAMPLES_A_PASS: u32 = 1024;
/// Workgroups that every GPU takes in one dispatch.
const TILES_A_PART: u32 = 65_535;

/// What is rendered in one go.
#[derive(Debug)]
pub(in crate::view::preview) struct RenderTask<'a> {
    pub(in crate::view::preview) frame: &'a Frame,
    pub(in crate::view::preview) estimator: Estimator,
    /// Left upper pixel of the part that is rendered.
    pub(in crate::view::preview) corner: [u32; 2],
    /// Its width and height.
    pub(in crate::view::preview) extent: [u32; 2],
    /// To display, or as radiance.
    pub(in crate::view::preview) as_bytes: bool,
}

impl<'a> RenderTask<'a> {
    /// A whole frame.
    pub(in crate::view::preview) fn whole(frame: &'a Frame, estimator: Estimator, as_bytes: bool) -> Self {
        Self { frame, estimator, corner: [0; 2], extent: [frame.size; 2], as_bytes }
    }

    /// Whether one pass is enough. Several passes add up radiances, which bytes to display cannot do.
    pub(in crate::view::preview) fn is_one_pass(frame: &Frame, estimator: Estimator) -> bool {
        estimator != Estimator::Reference || frame.spp <= SAMPLES_A_PASS
    }

    /// The parts that are sent to the GPU one at a time: some of the tiles that are seen, and a range of their samples.
    pub(super) fn parts(&self, tiles: u32) -> impl Iterator<Item = Part> {
        let is_sampled = self.estimator == Estimator::Reference;
        let all = if is_sampled { self.frame.spp } else { 1 };
        let cost = if is_sampled { all.min(SAMPLES_A_PASS) } else { NORMALS_COST };
        let most = (SAMPLES_A_PART / cost / (tiles::SIDE * tiles::SIDE)).min(TILES_A_PART);
        let as_bytes = self.as_bytes;
        (0..tiles).step_by(most as usize).flat_map(move |first_tile| {
            (0..all).step_by(SAMPLES_A_PASS as usize).map(move |first_sample| Part {
                first_tile,
                tiles: most.min(tiles - first_tile),
                first_sample,
                samples: SAMPLES_A_PASS.min(all - first_sample),
                as_bytes,
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::preview::Scene;

    #[test]
    fn parts_take_each_sample_of_each_tile_once() {
        for (tiles, spp) in [(64, 4096), (4096, 64), (4225, 700), (65536, 1), (64, 1025), (0, 64)] {
            let frame = Frame::new(&Scene { spp, ..Scene::default() }, false);
            let mut taken = vec![0_u32; tiles as usize];
            for part in RenderTask::whole(&frame, Estimator::Reference, false).parts(tiles) {
                assert!(part.tiles * 64 * part.samples <= SAMPLES_A_PART && part.tiles <= TILES_A_PART);
                for tile in part.first_tile..part.first_tile + part.tiles {
                    assert_eq!(taken[tile as usize], part.first_sample);
                    taken[tile as usize] += part.samples;
                }
            }
            assert!(taken.iter().all(|samples| *samples == spp), "{tiles} {spp}");
        }
    }
}
