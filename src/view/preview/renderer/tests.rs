use super::*;

impl Preview {
    pub(in crate::preview) fn lose_device(&mut self) {
        self.gpu.lose();
    }

    /// Makes the GPU fail after it has rendered `times` more pictures.
    pub(in crate::preview) fn fail_after(&mut self, times: u32) {
        self.gpu.fail_after(times);
    }

    /// Radiances of a part of the picture. `corner` is its upper left pixel, and `extent` its size.
    pub(in crate::preview) fn part(
        &mut self,
        table: &Arc<ShaderTable>,
        scene: &Scene,
        estimator: Estimator,
        corner: [u32; 2],
        extent: [u32; 2],
    ) -> Result<Radiances, PreviewError> {
        let mode = if estimator.is_lobe() { Mode::Lobe } else { Mode::Reference };
        let mode = if matches!(estimator, Estimator::Reference | Estimator::ReferenceLobe) { mode } else { Mode::Ltc };
        // This function always applies f0, for every scattering model.
        let scene_of_part = Scene { mode, ..scene.clone() };
        let is_for_cpu = self.check(table, &scene_of_part, faults_of_table(table, &scene_of_part))?;
        let frame = Frame::new(scene, estimator.is_lobe());
        let task = RenderTask { frame: &frame, estimator, corner, extent };
        let by_gpu = |gpu: &mut Gpu| gpu.render(table, &task, &|| false);
        let Some(all) = (if is_for_cpu { None } else { self.on_gpu(by_gpu)? }) else {
            return Ok(cpu::render(&frame, table, estimator, corner, extent));
        };
        let pixels = (corner[1]..corner[1] + extent[1])
            .flat_map(|y| (corner[0]..corner[0] + extent[0]).map(move |x| (y * frame.size + x) as usize))
            .map(|index| all[index])
            .collect();
        Ok(Radiances { width: extent[0], pixels })
    }
}

/// Whether the preview tries the GPU. The GPU returns `answer`.
fn tries_gpu(preview: &mut Preview, answer: Result<(), GpuFailure>) -> bool {
    let mut is_tried = false;
    let done = preview.on_gpu(|_| {
        is_tried = true;
        answer
    });
    assert!(done.is_ok(), "the CPU renders instead: {done:?}");
    is_tried
}

fn absent() -> Result<(), GpuFailure> {
    Err(GpuFailure::Absent("none".to_owned()))
}

/// In every scene, the CPU calls `stop` after at most [`SAMPLES`] samples, or after each pixel.
#[test]
fn parts_for_the_cpu_are_small_and_take_each_pixel_once_in_order() {
    for (size, samples) in [(64, 1), (64, 4096), (2048, 4096), (2048, 64), (2048, 8), (333, 700), (100, 1 << 20)] {
        let mut next = 0;
        for ([left, top], [width, height]) in cpu_parts(size, samples) {
            assert!(width * height == 1 || width * height * samples <= SAMPLES, "{size} {samples}");
            assert!(height == 1 || width == size, "whole rows, or a part of one");
            assert_eq!(top * size + left, next, "{size} {samples}");
            next += width * height;
        }
        assert_eq!(next, size * size, "{size} {samples}");
    }
}

#[test]
fn an_absent_gpu_is_tried_once_and_a_lost_gpu_again() {
    let mut preview = Preview::new(Adapter::Any);
    assert!(tries_gpu(&mut preview, absent()));
    assert!(!tries_gpu(&mut preview, Ok(())));
    let mut preview = Preview::new(Adapter::Any);
    for answer in [Ok(()), absent(), Ok(())] {
        assert!(tries_gpu(&mut preview, answer));
    }
}
