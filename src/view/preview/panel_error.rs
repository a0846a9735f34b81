//! The difference between a model and the reference.

use ltcforge_light::LightModel;

use super::{Material, Radiances, Scene, cpu, frame::Frame};

/// The difference between a model and the reference on one material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PanelError {
    /// The model.
    pub model: LightModel,
    /// The material's roughness along its tangent.
    pub alpha_x: f64,
    /// The material's roughness across its tangent.
    pub alpha_y: f64,
    /// Mean absolute difference in radiance, over the pixels that the surface covers and over the channels, without the
    /// noise of the reference.
    pub mean_absolute: f64,
    /// Mean absolute noise of a pixel of the reference.
    pub noise: f64,
    /// Mean radiance of the reference over the same pixels and channels.
    pub mean_radiance: f64,
}

/// Pixels per side of tiles.
const TILES: [u32; 3] = [4, 8, 16];

/// Sums over the pixels of a tile on one material.
#[derive(Clone, Copy, Default)]
struct Tile {
    /// Differences on the fields of both colours of a checkerboard, and the numbers of pixels.
    apart: [[f64; 3]; 2],
    pixels: [f64; 2],
    radiance: f64,
}

/// The error of each material, over the pixels that the material covers.
///
/// The pixels of a tile have independent noise and nearly the same error. So the sign of the error comes from one half of
/// a tile, and its amount from the other half. Then noise does not add to the mean error. Noise that hides the sign and
/// errors that change their sign within a tile make the mean too small, so the result is the largest of three tile sizes.
pub(super) fn panel_errors(
    scene: &Scene,
    frame: &Frame,
    model: LightModel,
    lit: &Radiances,
    reference: &Radiances,
) -> Vec<PanelError> {
    let [mut errors, larger @ ..] = TILES.map(|side| errors_of_tiles(scene, frame, model, (lit, reference), side));
    for (error, other) in larger.into_iter().flat_map(|of| of.into_iter().enumerate()) {
        errors[error].mean_absolute = errors[error].mean_absolute.max(other.mean_absolute);
    }
    errors
}

/// The error of each material, from tiles of `side` x `side` pixels.
fn errors_of_tiles(
    scene: &Scene,
    frame: &Frame,
    model: LightModel,
    (lit, reference): (&Radiances, &Radiances),
    side: u32,
) -> Vec<PanelError> {
    let mut sums = vec![PanelError::none(model); scene.materials.len()];
    let mut pixels = vec![0.0; scene.materials.len()];
    let tiles = frame.size.div_ceil(side);
    for tile in 0..tiles * tiles {
        let mut found = vec![Tile::default(); scene.materials.len()];
        let corner = [tile % tiles, tile / tiles].map(|at| at * side);
        for at in 0..side * side {
            let [x, y] = [corner[0] + at % side, corner[1] + at / side];
            let inside = x < frame.size && y < frame.size;
            let Some(cell) = inside.then(|| cpu::covering(frame, [x, y])).flatten() else { continue };
            let index = (y * frame.size + x) as usize;
            let (half, of) = (((x + y) % 2) as usize, &mut found[cell]);
            for channel in 0..3 {
                let truth = f64::from(reference.pixels[index][channel]);
                of.apart[half][channel] += f64::from(lit.pixels[index][channel]) - truth;
                of.radiance += truth / 3.0;
            }
            of.pixels[half] += 1.0;
        }
        for ((sum, pixels), Tile { apart, pixels: [m, n], radiance }) in sums.iter_mut().zip(&mut pixels).zip(found) {
            *pixels += m + n;
            sum.mean_radiance += radiance;
            if m > 0.0 && n > 0.0 {
                let share = (m + n) / 3.0;
                for (a, b) in apart[0].map(|sum| sum / m).into_iter().zip(apart[1].map(|sum| sum / n)) {
                    let sign = if a * b > 0.0 { 0.5 } else { -0.5 };
                    sum.mean_absolute += share * sign * (a.abs() + b.abs());
                    sum.noise += share * (a - b).abs() / (1.0 / m + 1.0 / n).sqrt();
                }
            }
        }
    }
    let mean = |((sum, pixels), material): ((PanelError, f64), &Material)| PanelError {
        alpha_x: material.alpha_x,
        alpha_y: material.alpha_y,
        mean_absolute: sum.mean_absolute.max(0.0) / pixels.max(1.0),
        noise: sum.noise / pixels.max(1.0),
        mean_radiance: sum.mean_radiance / pixels.max(1.0),
        ..sum
    };
    sums.into_iter().zip(pixels).zip(&scene.materials).map(mean).collect()
}

impl PanelError {
    /// The start of a sum.
    fn none(model: LightModel) -> Self {
        Self { model, alpha_x: 0.0, alpha_y: 0.0, mean_absolute: 0.0, noise: 0.0, mean_radiance: 0.0 }
    }
}
