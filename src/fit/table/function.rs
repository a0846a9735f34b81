//! A table of isotropic surfaces as a function. A shader evaluates its polynomials in roughness and view without a
//! texture.
//!
//! For an isotropic surface seen from phi 0, six of the nine numbers of [`Table::smooth_numbers`] are not zero. Each is
//! a polynomial in `x` and `y`,
//!
//! ```text
//! sum over i, j < 10 of c_ij T_i(x) T_j(y)
//! x = from -1 to 1 over the table's roughness sqrt(alpha),    y = from -1 to 1 over the table's 1 - sqrt(cos theta)
//! ```
//!
//! with Chebyshev polynomials `T`. The coefficients are a least-squares fit at the nodes, weighted by the ranges of
//! roughness and angle around each node. They are rounded to multiples of 1/8192 or 1/16384 that fit 16 bits.
//!
//! The errors of fitted lobes vary slightly from node to node. The least-squares fit averages out this variation, so
//! the function is closer to the exact lobes than a fine table of layout `reflected`.

use super::{Configuration, LookedUp, Table};
use crate::{
    axes::PerAxis,
    brdf::BrdfKind,
    layout::{ALPHA_FLOOR, Layout, LobeNumbers, SMOOTH_NUMBERS, THETA_CEILING},
    lobe::LobeModel,
    math::{cos, row_major, turned_about_z},
};

/// The number of polynomials along either axis.
pub const FUNCTION_SIDE: usize = 10;
/// The indices of the stored channels among the smooth numbers.
const CHANNELS: [usize; 6] = [0, 2, 3, 5, 7, 8];
/// The steps of the channels' coefficients.
const STEPS: [f64; 6] = [1.0 / 8192.0, 1.0 / 8192.0, 1.0 / 8192.0, 1.0 / 16384.0, 1.0 / 16384.0, 1.0 / 16384.0];
/// The smallest number of nodes along either axis. With fewer nodes the polynomials would oscillate between them.
const LEAST_NODES: usize = 32;
/// The number of nodes along either axis of the table through which the function is measured.
const MEASURED_NODES: u32 = 128;

/// A recipe of a table that can be converted to a function.
const RECIPE: &str = r#"{"preset": "paper", "layout": "reflected", "resolution": {"alpha": 64, "ratio": 1, "theta": 64, "phi": 1}, "range": {"ratio": [1, 1], "phi": [0, 0]}}"#;

/// The reason why a table cannot be converted to a function.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FunctionError {
    /// A table of anisotropic surfaces.
    #[error("the table has {ratios} ratios and {phis} phi; it must have only ratio 1 and phi 0")]
    Anisotropic {
        /// Nodes of ratio.
        ratios: usize,
        /// Nodes of phi.
        phis: usize,
    },
    /// A layout whose numbers do not represent the lobes at the nodes.
    #[error(
        "layout {layout} chooses its numbers to minimise the error between nodes, not at the nodes; a suitable recipe: \
         {RECIPE}"
    )]
    Chosen {
        /// The layout.
        layout: Layout,
    },
    /// Too few nodes to fit the polynomials.
    #[error("the table has {nodes} nodes of {axis}; allowed: at least {least}", least = LEAST_NODES)]
    Coarse {
        /// The axis.
        axis: &'static str,
        /// The number of nodes on the axis.
        nodes: usize,
    },
    /// A table without amplitude and Fresnel term.
    #[error("the table has no terms: its recipe needs \"terms\": true")]
    NoTerms,
    /// A scattering model whose lobes are not near the reflection.
    #[error("the function stores lobes relative to the reflection, but lobes of brdf {brdf} do not follow it")]
    Reflection {
        /// The scattering model.
        brdf: BrdfKind,
    },
    /// Two lobes per entry.
    #[error(
        "the table has two lobes per entry, but the function has one; omit field fresnel or use a mix of materials"
    )]
    TwoLobes,
    /// A lobe model other than LTCs.
    #[error("the function needs a table of lobe ltc; this table has lobe {lobe}")]
    Lobe {
        /// The lobe model.
        lobe: LobeModel,
    },
    /// An entry with a singular matrix or an amplitude of zero.
    #[error("entry {entry} has a number that is not finite")]
    Entry {
        /// The index of the entry.
        entry: usize,
    },
    /// Numbers that vary too strongly.
    #[error("a coefficient of channel {channel} is {value}, which does not fit 16 bits")]
    Large {
        /// The channel.
        channel: usize,
        /// The coefficient in units of its step.
        value: String,
    },
}

/// An isotropic table as polynomials.
#[derive(Debug, Clone, PartialEq)]
pub struct IsotropicFunction {
    /// Coefficients by degree in roughness, degree in view, and channel.
    coefficients: [[[i16; 6]; FUNCTION_SIDE]; FUNCTION_SIDE],
    /// The first and last `sqrt(alpha)`.
    roughness: [f64; 2],
    /// The first and last `1 - sqrt(cos theta)`.
    view: [f64; 2],
}

impl IsotropicFunction {
    /// Fits the function to a table.
    ///
    /// # Errors
    /// If the table is not isotropic, or has no terms, too few nodes, or an unsuitable layout or model.
    pub fn of(table: &Table) -> Result<Self, FunctionError> {
        let PerAxis { alpha, ratio, theta, phi } = &table.axes;
        if ratio.as_slice() != [1.0] || phi.as_slice() != [0.0] {
            return Err(FunctionError::Anisotropic { ratios: ratio.len(), phis: phi.len() });
        }
        if table.lobe.gaussian().is_some() {
            return Err(FunctionError::Lobe { lobe: table.lobe });
        }
        if table.second.is_some() {
            return Err(FunctionError::TwoLobes);
        }
        if !table.brdf.follows_reflection() {
            return Err(FunctionError::Reflection { brdf: table.brdf() });
        }
        if table.layout.rules().free_numbers().is_some() {
            return Err(FunctionError::Chosen { layout: table.layout });
        }
        for (axis, nodes) in [("alpha", alpha.len()), ("theta", theta.len())] {
            if nodes < LEAST_NODES {
                return Err(FunctionError::Coarse { axis, nodes });
            }
        }
        if table.terms.is_none() {
            return Err(FunctionError::NoTerms);
        }
        let numbers = table.smooth_numbers();
        if let Some(entry) = numbers.iter().position(|entry| entry.iter().any(|x| !x.is_finite())) {
            return Err(FunctionError::Entry { entry });
        }
        let (rows, columns) = (alpha.len(), theta.len());
        let roughness: Vec<f64> = alpha.iter().map(|x| roughness_of(*x)).collect();
        let view: Vec<f64> = theta.iter().map(|x| view_of(*x)).collect();
        let row_weights = shares(&roughness);
        let ends = |places: &[f64]| [places[0], places[places.len() - 1]];
        let mut found = Self {
            coefficients: [[[0; 6]; FUNCTION_SIDE]; FUNCTION_SIDE],
            roughness: ends(&roughness),
            view: ends(&view),
        };
        let across = Projection::new(&roughness, found.roughness, &row_weights);
        let along = Projection::new(&view, found.view, &shares(theta));
        for (channel, (place, step)) in CHANNELS.into_iter().zip(STEPS).enumerate() {
            let by_row: Vec<[f64; FUNCTION_SIDE]> =
                (0..rows).map(|row| along.of(|column| numbers[row * columns + column][place])).collect();
            for (i, j) in (0..FUNCTION_SIDE * FUNCTION_SIDE).map(|k| (k / FUNCTION_SIDE, k % FUNCTION_SIDE)) {
                let steps = (across.of(|row| by_row[row][j])[i] / step).round();
                if !(f64::from(i16::MIN)..=f64::from(i16::MAX)).contains(&steps) {
                    return Err(FunctionError::Large { channel: place, value: steps.to_string() });
                }
                found.coefficients[i][j][channel] = steps as i16;
            }
        }
        Ok(found)
    }

    /// The coefficients in multiples of [`Self::steps`], by degree in roughness, degree in view, and channel. The
    /// channels are `p`, `q`, the slant (the stereographic projection of the third column), the last row, and the two
    /// terms, as in `shaders/ltc_function.wgsl`.
    #[must_use]
    pub fn coefficients(&self) -> &[[[i16; 6]; FUNCTION_SIDE]; FUNCTION_SIDE] {
        &self.coefficients
    }

    /// The step of each channel. Its coefficients are multiples of the step.
    #[must_use]
    pub fn steps() -> [f64; 6] {
        STEPS
    }

    /// The ends of `sqrt(alpha)` and of `1 - sqrt(cos theta)`. Beyond an end the function is constant.
    #[must_use]
    pub fn ends(&self) -> [[f64; 2]; 2] {
        [self.roughness, self.view]
    }

    /// Converts the function to a table of layout `reflected`, to measure it. The nodes are so dense that interpolation
    /// adds no error.
    #[must_use]
    pub fn table(&self, source: &Table) -> Table {
        let range = |nodes: &[f64]| [nodes[0], nodes[nodes.len() - 1]];
        let ranges = PerAxis {
            alpha: range(&source.axes.alpha),
            ratio: [1.0; 2],
            theta: range(&source.axes.theta),
            phi: [0.0; 2],
        };
        let resolution = PerAxis { alpha: MEASURED_NODES, ratio: 1, theta: MEASURED_NODES, phi: 1 };
        let axes = Layout::Reflected.nodes(&ranges, &resolution);
        let numbers: Vec<[f64; SMOOTH_NUMBERS]> =
            axes.alpha.iter().flat_map(|alpha| axes.theta.iter().map(|theta| self.numbers(*alpha, *theta))).collect();
        Table::of_smooth_numbers((source.brdf(), source.lobe, Layout::Reflected), axes, &numbers, true)
    }

    /// The numbers that a shader computes from the polynomials. The function has one roughness: the larger of the two,
    /// raised to [`ALPHA_FLOOR`]. The lobe is turned by the view's azimuth.
    #[must_use]
    pub fn lobe(&self, configuration: &Configuration) -> LookedUp {
        let Configuration { alpha_x, alpha_y, theta, phi } = *configuration;
        let alpha = alpha_x.max(alpha_y).clamp(ALPHA_FLOOR, 1.0);
        let place = PerAxis { alpha, ratio: 1.0, theta: theta.min(THETA_CEILING), phi: 0.0 };
        let stored = Layout::Reflected.of_smooth(&place, &self.numbers(alpha, theta));
        let LobeNumbers { matrix, terms } = Layout::Reflected.rules().restore(&place, &stored);
        LookedUp {
            matrix: row_major(&turned_about_z(matrix, phi)),
            second: None,
            amplitude: Some(terms.amplitude),
            fresnel: Some(terms.fresnel),
            edge: None,
        }
    }

    /// The smooth numbers at a roughness and an angle.
    fn numbers(&self, alpha: f64, theta: f64) -> [f64; SMOOTH_NUMBERS] {
        let x = chebyshev(within(roughness_of(alpha), self.roughness));
        let y = chebyshev(within(view_of(theta), self.view));
        let mut numbers = [0.0; SMOOTH_NUMBERS];
        for (channel, (place, step)) in CHANNELS.into_iter().zip(STEPS).enumerate() {
            for (row, x) in self.coefficients.iter().zip(x) {
                numbers[place] += row.iter().zip(y).map(|(c, y)| f64::from(c[channel]) * step * x * y).sum::<f64>();
            }
        }
        numbers
    }
}

fn roughness_of(alpha: f64) -> f64 {
    alpha.max(ALPHA_FLOOR).sqrt()
}

fn view_of(theta: f64) -> f64 {
    1.0 - cos(theta.min(THETA_CEILING)).sqrt()
}

/// The position between two ends, from -1 to 1.
fn within(x: f64, [low, high]: [f64; 2]) -> f64 {
    (2.0 * (x - low) / (high - low) - 1.0).clamp(-1.0, 1.0)
}

/// The Chebyshev polynomials at `x`.
fn chebyshev(x: f64) -> [f64; FUNCTION_SIDE] {
    let mut t = [1.0; FUNCTION_SIDE];
    t[1] = x;
    for k in 2..FUNCTION_SIDE {
        t[k] = 2.0 * x * t[k - 1] - t[k - 2];
    }
    t
}

/// The length of the axis around each of the ascending positions.
fn shares(places: &[f64]) -> Vec<f64> {
    let last = places.len() - 1;
    (0..=last).map(|i| 0.5 * (places[(i + 1).min(last)] - places[i.saturating_sub(1)])).collect()
}

/// Least squares along one axis: a matrix that maps values at nodes to coefficients.
struct Projection(Vec<[f64; FUNCTION_SIDE]>);

impl Projection {
    /// Domain: at least [`FUNCTION_SIDE`] different positions.
    fn new(places: &[f64], ends: [f64; 2], weights: &[f64]) -> Self {
        let basis: Vec<[f64; FUNCTION_SIDE]> = places.iter().map(|x| chebyshev(within(*x, ends))).collect();
        let mut normal = [[0.0; FUNCTION_SIDE]; FUNCTION_SIDE];
        for (t, weight) in basis.iter().zip(weights) {
            for i in 0..FUNCTION_SIDE {
                for j in 0..FUNCTION_SIDE {
                    normal[i][j] += weight * t[i] * t[j];
                }
            }
        }
        let factor = cholesky(&normal);
        let column = |(t, weight): (&[f64; FUNCTION_SIDE], &f64)| solved(&factor, t.map(|t| t * weight));
        Self(basis.iter().zip(weights).map(column).collect())
    }

    /// The coefficients of values at the positions.
    fn of(&self, value: impl Fn(usize) -> f64) -> [f64; FUNCTION_SIDE] {
        let mut sum = [0.0; FUNCTION_SIDE];
        for (i, column) in self.0.iter().enumerate() {
            let value = value(i);
            sum.iter_mut().zip(column).for_each(|(sum, factor)| *sum += value * factor);
        }
        sum
    }
}

type Square = [[f64; FUNCTION_SIDE]; FUNCTION_SIDE];

/// The Cholesky factor: the lower triangle `L` of a positive definite `L L^T`.
fn cholesky(matrix: &Square) -> Square {
    let mut factor = [[0.0; FUNCTION_SIDE]; FUNCTION_SIDE];
    for i in 0..FUNCTION_SIDE {
        for j in 0..=i {
            let rest = matrix[i][j] - (0..j).map(|k| factor[i][k] * factor[j][k]).sum::<f64>();
            factor[i][j] = if i == j { rest.max(f64::MIN_POSITIVE).sqrt() } else { rest / factor[j][j] };
        }
    }
    factor
}

/// Solves `L L^T x = y`.
fn solved(factor: &Square, mut y: [f64; FUNCTION_SIDE]) -> [f64; FUNCTION_SIDE] {
    for i in 0..FUNCTION_SIDE {
        y[i] = (y[i] - (0..i).map(|k| factor[i][k] * y[k]).sum::<f64>()) / factor[i][i];
    }
    for i in (0..FUNCTION_SIDE).rev() {
        y[i] = (y[i] - (i + 1..FUNCTION_SIDE).map(|k| factor[k][i] * y[k]).sum::<f64>()) / factor[i][i];
    }
    y
}

#[cfg(any(test, feature = "testing"))]
pub(crate) mod planted;
#[cfg(test)]
mod tests;
