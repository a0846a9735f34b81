//! Values to check a port against. They come from a small table that a comment can describe.

use glam::DVec3;

use ltcforge_fit::{
    BrdfKind, Configuration, Layout, LobeFresnel, LobeModel, Ltc, PerAxis, SecondLobe, Sides, Table, Terms,
    blend_weight, blended,
    brdf::LobeTerms,
    math::{atan2, from_row_major},
};
use ltcforge_light::{
    Gaussian,
    gaussians::{self, SphericalGaussian},
};

/// A surface and a view direction to look up. The cases cover every fold, and a position outside the table.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Roughness along x.
    pub alpha_x: f64,
    /// Roughness along y.
    pub alpha_y: f64,
    /// The view direction. With these decimals, it has exactly unit length.
    pub wo: [f64; 3],
}

/// The cases.
pub const CASES: [Case; 3] = [
    Case { alpha_x: 0.3, alpha_y: 0.15, wo: [0.36, 0.48, 0.8] },
    Case { alpha_x: 0.2, alpha_y: 0.6, wo: [-0.64, 0.48, 0.6] },
    Case { alpha_x: 0.05, alpha_y: 0.02, wo: [0.576, -0.768, 0.28] },
];

/// The corners of a rectangle that the horizon cuts, relative to the shaded point. It emits towards the shaded point.
pub const CORNERS: [[f64; 3]; 4] = [[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.5, -0.5], [-1.0, 1.5, -0.5]];

/// The values that a port must reproduce.
#[derive(Debug, Clone, Copy)]
pub struct Golden {
    /// `M`, row-major.
    pub matrix: [f64; 9],
    /// Directional albedo for a Fresnel factor of one.
    pub amplitude: f64,
    /// Directional albedo weighted by Schlick's fifth power.
    pub fresnel: f64,
    /// The part of the lobe that the rectangle covers.
    pub covered: f64,
}

/// The values for the second lobe of a table with two lobes.
#[derive(Debug, Clone, Copy)]
pub struct SecondGolden {
    /// `M_2`, row-major.
    pub matrix: [f64; 9],
    /// The part of the blended lobe that the rectangle covers, for the dielectric [`BLENDED`].
    pub blended: f64,
}

/// F0 and F90 of the dielectric.
pub const BLENDED: [f64; 2] = [0.04, 1.0];

/// The largest error of a correct 32-bit port, as stated in the headers.
pub const TOLERANCE: f64 = 2e-5;

/// The step between the numbers of neighbouring entries. With 2^-10, all numbers are exact in half floats.
const STEP: f64 = 1.0 / 1024.0;

/// The elements of a row-major matrix that are zero for a lobe that is symmetric about the plane of incidence.
const ACROSS: [usize; 4] = [1, 3, 5, 7];

/// The table. Number `k` of entry `e`, both from 0 in storage order, is `I[k] + e (k + 1) / 1024`. `I` is the identity,
/// an amplitude of 1 and a Fresnel term of 0. Layouts for isotropic surfaces have one ratio and one phi, and zeros for
/// the elements across the plane of incidence. Layout `materials` has three materials.
#[must_use]
pub fn table(layout: Layout) -> Table {
    const START: [f64; 11] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0];
    let range = layout.only_ranges().unwrap_or(PerAxis {
        alpha: [0.1, 1.0],
        ratio: [0.1, 1.0],
        theta: [0.0, 1.5],
        phi: [0.0, 1.5],
    });
    let is_isotropic = layout.only_ranges().is_some();
    let [ratio, phi] = if is_isotropic { [1, 1] } else { [2, 3] };
    let mut axes = layout.nodes(&range, &PerAxis { alpha: 3, ratio, theta: 3, phi });
    if layout.is_of_materials() {
        // These numbers are also exact in 16 bits.
        (axes.alpha, axes.ratio) = (vec![0.5, 0.125, 0.75], vec![0.5, 0.375, 0.25]);
    }
    let PerAxis { alpha, ratio, theta, phi } = layout.lengths(&axes);
    let entries = alpha * ratio * theta * phi;
    let step = |k: usize| if is_isotropic && ACROSS.contains(&k) { 0.0 } else { STEP };
    let number = |entry: usize, k: usize| (START[k] + (entry * (k + 1)) as f64 * step(k)) as f32;
    Table {
        brdf: BrdfKind::Ggx.into(),
        lobe: LobeModel::Ltc,
        layout,
        axes,
        matrix: (0..entries).map(|entry| std::array::from_fn(|k| number(entry, k))).collect(),
        terms: Some(Terms {
            amplitude: (0..entries).map(|entry| number(entry, 9)).collect(),
            fresnel: (0..entries).map(|entry| number(entry, 10)).collect(),
            edge: None,
        }),
        second: None,
        node_error: vec![0.0; entries],
    }
}

/// [`table`] with second lobes: number `k` of entry `e` is `I[k] + e (9 - k) / 1024`, with the same zeros.
#[must_use]
pub fn table_of_two_lobes(layout: Layout) -> Table {
    let first = table(layout);
    let entries = first.matrix.len();
    let number = |entry: usize, k: usize| {
        let start = if k.is_multiple_of(4) { 1.0 } else { 0.0 };
        let is_zero = layout.only_ranges().is_some() && ACROSS.contains(&k);
        (start + if is_zero { 0.0 } else { (entry * (9 - k)) as f64 * STEP }) as f32
    };
    let second = (0..entries).map(|entry| std::array::from_fn(|k| number(entry, k))).collect();
    let brdf = first.brdf.clone().with_fresnel(LobeFresnel::Two(SecondLobe::Blended));
    Table { brdf, second: Some(second), ..first }
}

impl Case {
    /// The surface and the view direction, as printed in comments.
    pub(super) fn named(&self) -> String {
        format!("alpha_x {} alpha_y {} wo ({})", self.alpha_x, self.alpha_y, listed(&self.wo))
    }

    fn configuration(&self) -> Configuration {
        let [x, y, z] = self.wo;
        let theta = atan2((x * x + y * y).sqrt(), z);
        Configuration { alpha_x: self.alpha_x, alpha_y: self.alpha_y, theta, phi: atan2(y, x) }
    }

    /// The values of [`table`] for this case, in f64.
    pub fn golden(&self, layout: Layout) -> Golden {
        let found = table(layout).lookup(&self.configuration());
        let light = CORNERS.map(DVec3::from_array);
        Golden {
            matrix: found.matrix,
            amplitude: found.amplitude.unwrap_or(1.0),
            fresnel: found.fresnel.unwrap_or(0.0),
            covered: Ltc::new(from_row_major(&found.matrix)).map_or(0.0, |ltc| ltc.polygon(&light, Sides::One)),
        }
    }

    /// The values of the second lobe of [`table_of_two_lobes`] for this case, in f64.
    pub fn golden_second(&self, layout: Layout) -> SecondGolden {
        let found = table_of_two_lobes(layout).lookup(&self.configuration());
        let matrix = found.second.unwrap_or(found.matrix);
        let [amplitude, fresnel] = [found.amplitude, found.fresnel].map(|term| term.unwrap_or(0.0));
        let weight = blend_weight(LobeTerms { amplitude, fresnel }, BLENDED[0], BLENDED[1]);
        let blend = blended(&from_row_major(&found.matrix), &from_row_major(&matrix), weight);
        let light = CORNERS.map(DVec3::from_array);
        let blended = Ltc::new(blend).map_or(0.0, |ltc| ltc.polygon(&light, Sides::One));
        SecondGolden { matrix, blended }
    }

    /// The reflected light of the rectangle in f64, with [`table`] read as a table of Gaussians: for a Fresnel factor
    /// of one, and weighted by Schlick's fifth power.
    #[must_use]
    pub fn lit_by_gaussian(&self, layout: Layout, gaussian: Gaussian) -> [f64; 2] {
        let (shape, parts) = self.gaussian(layout, gaussian);
        gaussians::reflected_by(&shape, parts, &CORNERS, Sides::One)
    }

    /// The Gaussian of [`table`], if it is read as a table of Gaussians, and its two parts.
    #[must_use]
    pub fn gaussian(&self, layout: Layout, gaussian: Gaussian) -> (SphericalGaussian<f64>, [f64; 2]) {
        let found = table(layout).lookup(&self.configuration());
        let parts = [found.amplitude.unwrap_or(1.0), found.fresnel.unwrap_or(0.0)];
        let m = from_row_major(&found.matrix);
        let columns = [m.x_axis, m.y_axis, m.z_axis].map(|column| column.to_array());
        (SphericalGaussian::of_columns(gaussian, columns), parts)
    }
}

/// The numbers, separated by spaces.
pub(super) fn listed<T: ToString>(numbers: &[T]) -> String {
    numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}
