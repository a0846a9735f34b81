//! The pictures on the light of a preview.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use ltcforge_light::textured::LightImage;

/// The picture on the light of a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ScenePicture {
    /// The light emits evenly.
    None,
    /// A television's test card.
    Television,
    /// A window of six panes, with sky and land behind it.
    Window,
    /// A picture from the caller. Scenes with such a picture are not written as documents.
    #[serde(skip)]
    Image(Arc<LightImage>),
}

/// Size of the built-in pictures in texels.
const SIZE: [usize; 2] = [320, 180];
/// Aspect ratio of the built-in pictures.
const ASPECT: f32 = 16.0 / 9.0;
const WHITE: [f32; 3] = [1.0; 3];
const BLACK: [f32; 3] = [0.0; 3];
/// The bars of the test card at 75 %: white, yellow, cyan, green, magenta, red and blue.
const BARS: [[f32; 3]; 7] = [
    [0.75, 0.75, 0.75],
    [0.75, 0.75, 0.02],
    [0.02, 0.75, 0.75],
    [0.02, 0.75, 0.02],
    [0.75, 0.02, 0.75],
    [0.75, 0.02, 0.02],
    [0.02, 0.02, 0.75],
];

impl ScenePicture {
    /// The pictures with a name in parameters.
    pub const NAMED: [(&str, Self); 3] =
        [("none", Self::None), ("television", Self::Television), ("window", Self::Window)];

    /// The image. `None` for a light that emits evenly.
    pub(super) fn image(&self) -> Option<Arc<LightImage>> {
        let colour = match self {
            Self::None => return None,
            Self::Image(image) => return Some(Arc::clone(image)),
            Self::Television => television,
            Self::Window => window,
        };
        let [width, height] = SIZE;
        let texel = |i: usize| {
            let part = |place: usize, count: usize| (place as f32 + 0.5) / count as f32;
            colour([part(i % width, width), part(i / width, height)])
        };
        LightImage::new(width, height, (0..width * height).map(texel).collect()).ok().map(Arc::new)
    }
}

/// A test card: a grid, and a circle with a title bar, coloured bars, stripes and grey steps.
fn television([u, v]: [f32; 2]) -> [f32; 3] {
    let (x, y) = ((u - 0.5) * ASPECT, v - 0.5);
    let grey = |is_white: bool| if is_white { WHITE } else { BLACK };
    if x * x + y * y > 0.45 * 0.45 {
        let is_border = x.abs() > 0.5 * ASPECT - 0.04 || y.abs() > 0.46;
        let is_even = ((x * 9.0).floor() + (y * 9.0).floor()).rem_euclid(2.0) == 0.0;
        let on_line = |p: f32| (p * 9.0 - (p * 9.0).round()).abs() < 0.06;
        return match (is_border, on_line(x) || on_line(y)) {
            (true, _) => grey(is_even),
            (false, true) => WHITE,
            (false, false) => [0.10, 0.12, 0.16],
        };
    }
    let across = (x + 0.45) / 0.9;
    match y {
        ..-0.28 => WHITE,
        ..-0.20 => BLACK,
        ..0.10 => BARS[((across * 7.0) as usize).min(6)],
        ..0.22 => grey((across * across * 40.0).fract() < 0.5),
        ..0.34 => [(across * 6.0).floor() / 5.0; 3],
        _ => [0.85, 0.35, 0.05],
    }
}

/// A window with panes between bars. The view is brighter above the horizon than below.
fn window([u, v]: [f32; 2]) -> [f32; 3] {
    let is_bar = |part: f32, panes: f32, width: f32| {
        let place = (part * panes).fract();
        place.min(1.0 - place) < width
    };
    if is_bar(u, 3.0, 0.09) || is_bar(v, 2.0, 0.11) {
        return [0.02, 0.015, 0.01];
    }
    if v < 0.68 {
        let high = 1.0 - v / 0.68;
        return [0.95 - 0.5 * high, 0.95 - 0.3 * high, 1.0];
    }
    [0.16, 0.24, 0.06]
}
