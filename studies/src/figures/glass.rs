//! Compares the closed form with Monte Carlo integration, for lamps behind rough glass.

use glam::DVec3;
use rayon::prelude::*;

use ltcforge::{
    Sides,
    light::transmission::{sampled, transmitted},
    view::picture::{Panel, Picture, bar, caption, grid, headed, number, signed_colour, srgb},
};

/// The refractive index of the glass relative to air.
const ETA: f64 = 1.5;
/// Roughness along x and y of each row of panels: satin, frosted, brushed.
const SURFACES: [[f64; 2]; 3] = [[0.1, 0.1], [0.35, 0.35], [0.5, 0.06]];
/// Half the side of the visible surface, and the height of the eye above its centre.
const HALF: f64 = 1.0;
const EYE: f64 = 2.5;
/// The picture shows differences multiplied by this factor.
const STRONGER: f32 = 100.0;

/// A lamp inside the glass: its corners and its basic radiance.
struct Lamp {
    corners: [[f64; 3]; 4],
    radiance: [f32; 3],
}

/// A window, a tube, and a tilted panel with its lower end close to the surface.
const LAMPS: [Lamp; 3] = [
    Lamp {
        corners: [[-0.75, 0.1, -0.5], [-0.75, 0.75, -0.5], [-0.1, 0.75, -0.5], [-0.1, 0.1, -0.5]],
        radiance: [1.0, 0.62, 0.28],
    },
    Lamp {
        corners: [[0.2, 0.62, -0.35], [0.2, 0.68, -0.35], [0.85, 0.68, -0.35], [0.85, 0.62, -0.35]],
        radiance: [0.35, 0.8, 1.0],
    },
    Lamp {
        corners: [[-0.6, -0.7, -0.06], [-0.5, -0.25, -0.9], [0.5, -0.25, -0.9], [0.6, -0.7, -0.06]],
        radiance: [0.5, 0.95, 0.45],
    },
];

/// The picture, and the mean error for each surface.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FrostedGlass {
    /// The picture, with one row of panels per surface.
    pub(super) picture: Picture,
    /// The error of each surface.
    pub(super) surfaces: Vec<GlassError>,
}

/// The error of the closed form against Monte Carlo integration, for one surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct GlassError {
    /// Mean radiance of the reference over pixels and colours.
    pub(super) mean_radiance: f64,
    /// Mean absolute difference from the reference.
    pub(super) mean_absolute_error: f64,
}

/// Draws panels of `side` pixels. The reference uses `samples` visible normals per pixel. Runs on the current rayon
/// pool, whose size does not change the picture.
pub(super) fn draw(side: u32, samples: usize) -> FrostedGlass {
    let rows = SURFACES.map(|alpha| row(alpha, side, samples));
    let surfaces: Vec<GlassError> = rows.iter().map(|row| row.error).collect();
    let titles: Vec<String> = SURFACES
        .iter()
        .map(|[x, y]| if x == y { format!("alpha {x}") } else { format!("alpha {x} across, {y} up") })
        .collect();
    let differences: Vec<String> = surfaces
        .iter()
        .map(|of| {
            let [error, mean] = [of.mean_absolute_error, of.mean_radiance].map(|x| number(x as f32));
            format!("difference, mean {error} of {mean}")
        })
        .collect();
    let mut panels = Vec::new();
    for ((row, title), apart) in rows.into_iter().zip(&titles).zip(&differences) {
        let [found, wanted, difference] = row.pictures;
        panels.push(Panel { title, picture: found, foot: caption(side, &["closed form"]) });
        let by = format!("{samples} normals a pixel");
        panels.push(Panel { title: "Monte Carlo", picture: wanted, foot: caption(side, &[&by]) });
        let foot = bar(side, |x| signed_colour(2.0 * x - 1.0), ["-0.01", "0.01"], &["radiance"]);
        panels.push(Panel { title: apart, picture: difference, foot });
    }
    let heading = format!("Lamps in glass with a rough surface, index {ETA}, seen from air");
    let picture = headed(&[&[&heading, "Lamps in rough glass"]], &grid(&panels, 3));
    FrostedGlass { picture, surfaces }
}

/// Closed form, reference and difference of one surface.
struct Row {
    pictures: [Picture; 3],
    error: GlassError,
}

fn row(alpha: [f64; 2], side: u32, samples: usize) -> Row {
    let pixels: Vec<[[f32; 3]; 2]> =
        (0..side * side).into_par_iter().map(|index| pixel(alpha, index % side, index / side, side, samples)).collect();
    let mut pictures = [0; 3].map(|_| Picture::filled(side, side, [0; 3]));
    let (mut radiance, mut apart) = (0.0, 0.0);
    for (index, [found, wanted]) in pixels.iter().enumerate() {
        pictures[0].rgb[index] = found.map(srgb);
        pictures[1].rgb[index] = wanted.map(srgb);
        let difference: [f32; 3] = std::array::from_fn(|i| found[i] - wanted[i]);
        pictures[2].rgb[index] = signed_colour(STRONGER * difference.iter().sum::<f32>() / 3.0);
        radiance += wanted.iter().map(|x| f64::from(*x)).sum::<f64>() / 3.0;
        apart += difference.iter().map(|x| f64::from(x.abs())).sum::<f64>() / 3.0;
    }
    let count = pixels.len().max(1) as f64;
    let error = GlassError { mean_radiance: radiance / count, mean_absolute_error: apart / count };
    Row { pictures, error }
}

/// Radiance towards the eye, by the closed form and by the reference.
fn pixel(alpha: [f64; 2], column: u32, row: u32, side: u32, samples: usize) -> [[f32; 3]; 2] {
    let at = |k: u32| HALF * (2.0 * (f64::from(k) + 0.5) / f64::from(side) - 1.0);
    let place = DVec3::new(at(column), -at(row), 0.0);
    let wo = (DVec3::new(0.0, 0.0, EYE) - place).normalize().to_array();
    // Neighbouring pixels get different noise.
    let shift =
        [0.754_877_666_246_693, 0.569_840_290_998_053].map(|step| (f64::from(row * side + column) * step).fract());
    let mut sums = [[0.0; 3]; 2];
    for Lamp { corners, radiance } in &LAMPS {
        let light = corners.map(|corner| (DVec3::from_array(corner) - place).to_array());
        let found = transmitted(alpha, wo, ETA, &light, Sides::Two).dielectric;
        let wanted = sampled(alpha, wo, ETA, &light, Sides::Two, samples, shift).dielectric;
        for (sum, part) in sums.iter_mut().zip([found, wanted]) {
            for (sum, radiance) in sum.iter_mut().zip(radiance) {
                *sum += part as f32 * radiance;
            }
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closed_form_looks_like_the_reference() {
        let drawn = draw(24, 2000);
        assert_eq!(drawn.surfaces.len(), SURFACES.len());
        for GlassError { mean_radiance, mean_absolute_error } in &drawn.surfaces {
            assert!(*mean_radiance > 0.05 && *mean_absolute_error < 0.02 * mean_radiance, "{:?}", drawn.surfaces);
        }
        assert!(drawn == draw(24, 2000), "the second picture differs");
    }
}
