//! The square tiles of a picture that the GPU renders.
//!
//! A shader computes all pixels of a SIMD vector if one of them needs the result, and with lavapipe even if none does.
//! Therefore tiles that the surface cannot cover are not sent to the GPU. If the light is drawn, all tiles are sent,
//! because it can be anywhere.

use glam::Vec3;

use crate::preview::{Surface, estimator::Estimator, frame::Frame};

/// Side of a tile in pixels. Each tile is a workgroup.
pub(super) const SIDE: u32 = 8;
/// The distance in pixels from a tile's middle to the middle of its outermost pixel, plus half a pixel for the sphere's
/// rim, rounded up.
const REACH: f32 = 6.0;

/// Tiles, each given by its upper left pixel.
#[derive(Debug)]
pub(super) struct Tiles {
    /// The tiles to render.
    pub(super) visible: Vec<[u32; 2]>,
    /// The tiles that only show the background.
    pub(super) background: Vec<[u32; 2]>,
}

impl Tiles {
    /// The tiles of a part of a picture. `corner` is the upper left pixel of the part, and `extent` its size.
    pub(super) fn of(frame: &Frame, estimator: Estimator, corner: [u32; 2], extent: [u32; 2]) -> Self {
        let starts = |axis: usize| (corner[axis]..corner[axis] + extent[axis]).step_by(SIDE as usize);
        let tiles = starts(1).flat_map(|y| starts(0).map(move |x| [x, y]));
        let is_lobe = estimator.is_lobe();
        let (visible, background) =
            tiles.partition(|tile| is_lobe || frame.picture.is_some() || may_show(frame, *tile));
        Self { visible, background }
    }
}

/// Whether a tile can show the surface. `false` is certain, `true` is not.
fn may_show(frame: &Frame, tile: [u32; 2]) -> bool {
    let side = frame.size / frame.cells;
    let cell = tile.map(|x| (x / side).min(frame.cells - 1));
    let is_within = |axis: usize| cell[axis] == frame.cells - 1 || tile[axis] + SIDE <= (cell[axis] + 1) * side;
    if !(is_within(0) && is_within(1)) {
        return true;
    }
    if frame.material(cell[1] * frame.cells + cell[0]).is_none() {
        return false;
    }
    let middle = |axis: usize| ((tile[axis] - cell[axis] * side + SIDE / 2) as f32) / side as f32 * 2.0 - 1.0;
    let ray = (frame.forward + frame.right * middle(0) - frame.up * middle(1)).normalize();
    // The largest angle between the ray through the tile's middle and any other ray of the tile. The image plane is at
    // distance one.
    let spread = REACH * frame.pixel;
    match frame.surface {
        Surface::Floor => frame.eye.y > 0.0 && ray.y - spread < -frame.eye.y / frame.floor_end,
        Surface::Sphere => distance_from_origin(frame.eye, ray) - frame.eye.length() * spread < 1.0,
    }
}

/// The distance between the origin and the line through `point` along `direction`.
fn distance_from_origin(point: Vec3, direction: Vec3) -> f32 {
    (point - point.dot(direction) * direction).length()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::preview::{Camera, NamedScene, Scene, cpu};

    /// All tiles of a frame, and the pixels that the surface covers.
    fn tiles_of(scene: &Scene) -> (Tiles, Vec<[u32; 2]>) {
        let frame = Frame::new(scene, false);
        let pixels = (0..frame.size).flat_map(|y| (0..frame.size).map(move |x| [x, y]));
        let covered = pixels.filter(|pixel| cpu::covering(&frame, *pixel).is_some()).collect();
        (Tiles::of(&frame, Estimator::Reference, [0; 2], [frame.size; 2]), covered)
    }

    #[test]
    fn few_rendered_tiles_are_empty() {
        // A light that is drawn can be in any tile.
        let without_picture = NamedScene::ALL.iter().filter(|named| **named != NamedScene::Screen);
        for named in without_picture {
            let (tiles, covered) = tiles_of(&Scene { size: 512, ..named.scene() });
            let sent = tiles.visible.len() * (SIDE * SIDE) as usize;
            assert!(sent <= covered.len() * 6 / 5, "{}: {sent} pixels for {}", named.name(), covered.len());
            assert_eq!(tiles.visible.len() + tiles.background.len(), 64 * 64);
        }
    }

    proptest! {
        #[test]
        fn every_covered_pixel_is_rendered(
            named in prop::sample::select(NamedScene::ALL.to_vec()),
            size in 64_u32..200,
            distance in 1.5..100.0,
            (azimuth, elevation) in (-6.0..6.0, -1.57..1.57),
            field_of_view in 0.01..2.5,
            target in prop::array::uniform3(-0.25..0.25),
        ) {
            let camera = Camera { distance, azimuth, elevation, field_of_view, target };
            let (tiles, covered) = tiles_of(&Scene { camera, size, ..named.scene() });
            for [x, y] in covered {
                let is_sent = tiles.visible.iter().any(|[left, top]| {
                    (*left..left + SIDE).contains(&x) && (*top..top + SIDE).contains(&y)
                });
                prop_assert!(is_sent, "{x} {y}");
            }
        }
    }
}
