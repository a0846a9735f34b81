//! What a GPU renders in one go, and in which parts.

use crate::preview::{
    frame::{Frame, Part},
    renderer::Estimator,
};

/// Samples that are sent to the GPU at a time: some hundred milliseconds on two slow cores, after which the caller may
/// stop. A driver that is busy for long can neither be stopped nor dropped.
const SAMPLES_A_TILE: u32 = 1 << 22;
/// Samples of a pixel that one pass takes. Lavapipe ends a shader's loops after 65535 steps, those within them counted
/// in, of which a sample takes up to 15.
const SAMPLES_A_PASS: u32 = 1024;
/// What light by the table costs, in samples of the reference.
const TABLE_COST: u32 = 8;
/// Pixels a side of a workgroup.
pub(super) const GROUP: u32 = 8;

/// What is rendered in one go.
#[derive(Debug)]
pub(in crate::preview) struct Job<'a> {
    pub(in crate::preview) frame: &'a Frame,
    pub(in crate::preview) estimator: Estimator,
    /// Left upper pixel of the part that is rendered.
    pub(in crate::preview) corner: [u32; 2],
    /// Its width and height.
    pub(in crate::preview) extent: [u32; 2],
    /// To display, or as radiance.
    pub(in crate::preview) as_bytes: bool,
}

impl<'a> Job<'a> {
    /// All of a frame.
    pub(in crate::preview) fn whole(frame: &'a Frame, estimator: Estimator, as_bytes: bool) -> Self {
        Self { frame, estimator, corner: [0; 2], extent: [frame.size; 2], as_bytes }
    }

    /// Whether one pass can do it. Several add up radiances, which bytes cannot.
    pub(in crate::preview) fn is_one_pass(frame: &Frame, estimator: Estimator) -> bool {
        estimator != Estimator::Reference || frame.spp <= SAMPLES_A_PASS
    }

    /// What is sent to the GPU at a time: square tiles of whole workgroups, together the job's part of the picture, and
    /// of each its samples from the first on.
    pub(super) fn parts(&self) -> impl Iterator<Item = Part> {
        let is_sampled = self.estimator == Estimator::Reference;
        let all = if is_sampled { self.frame.spp } else { 1 };
        let cost = if is_sampled { all.min(SAMPLES_A_PASS) } else { TABLE_COST };
        let side = ((SAMPLES_A_TILE / cost).isqrt() / GROUP * GROUP).max(GROUP);
        let Self { corner, extent, as_bytes, .. } = *self;
        let starts = move |length: u32| (0..length).step_by(side as usize);
        let corners = starts(extent[1]).flat_map(move |y| starts(extent[0]).map(move |x| [x, y]));
        corners.flat_map(move |[x, y]| {
            (0..all).step_by(SAMPLES_A_PASS as usize).map(move |first_sample| Part {
                corner: [corner[0] + x, corner[1] + y],
                extent: [side.min(extent[0] - x), side.min(extent[1] - y)],
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
    use crate::preview::Scene;

    #[test]
    fn parts_take_each_sample_of_each_pixel_once() {
        for (size, spp) in [(64, 4096), (512, 64), (515, 700), (2048, 1), (64, 1025)] {
            let frame = Frame::new(&Scene { size, spp, ..Scene::default() }, false);
            let mut taken = vec![0_u32; (size * size) as usize];
            for part in Job::whole(&frame, Estimator::Reference, false).parts() {
                let ([left, top], [width, height]) = (part.corner, part.extent);
                assert!(width * height * part.samples <= SAMPLES_A_TILE);
                for index in (top..top + height).flat_map(|y| (left..left + width).map(move |x| y * size + x)) {
                    assert_eq!(taken[index as usize], part.first_sample);
                    taken[index as usize] += part.samples;
                }
            }
            assert!(taken.iter().all(|samples| *samples == spp), "{size} {spp}");
        }
    }
}
