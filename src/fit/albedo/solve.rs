//! The texels whose linear filter is nearest to given values.

use super::recipe::LutRecipe;

/// The domain of the stated errors: the smallest alpha and the smallest cosine.
pub(super) const LEAST: [f64; 2] = [0.002, 0.01];
/// The weight of places outside the domain. They only determine texels that the domain does not reach.
const OUTSIDE: f64 = 1e-4;
/// Rounds of least squares. The first has equal weights; each following round gives more weight to large errors. At 32 x
/// 32 the rounds decrease the largest error of `dfg` in f16 from .0057 to .0043, at 16 x 16 from .0179 to .0150
/// (331 x 337 places, not those of the report).
const ROUNDS: usize = 8;
/// The number of texels above which fewer rounds are enough.
const MANY_TEXELS: u64 = 64 * 64;
const FEW_ROUNDS: usize = 3;
/// Steps of conjugate gradients in each round, from the texels of the previous round.
const STEPS: usize = 24;

/// A place: the first of its four texels, the weights of the next texel on both axes, its value and its weight.
struct Place {
    texel: usize,
    next: [f64; 2],
    value: f64,
    domain: f64,
    weight: f64,
}

impl Place {
    fn filters(&self) -> [f64; 4] {
        let [row, column] = self.next;
        [(1.0 - row) * (1.0 - column), (1.0 - row) * column, row * (1.0 - column), row * column]
    }
}

/// The texels for the values at the places `[roughness, cosine]`, row-major.
///
/// Minimises the weighted squares of `filtered - value` by conjugate gradients.
pub(super) fn solve(recipe: &LutRecipe, [rows, columns]: [&[f64]; 2], values: &[f64]) -> Vec<f64> {
    let (axes, sizes) = (&recipe.axes, [recipe.resolution.roughness as usize, recipe.resolution.cos_theta as usize]);
    let width = sizes[1];
    let mut places = Vec::with_capacity(values.len());
    for (row, values) in rows.iter().zip(values.chunks(columns.len())) {
        let (texel, next) = axes.texels.filter(*row, sizes[0]);
        let is_rough = axes.roughness.alpha(*row) >= LEAST[0];
        for (column, value) in columns.iter().zip(values) {
            let (below, after) = axes.texels.filter(*column, width);
            let is_inside = is_rough && axes.cos_theta.cosine(*column) >= LEAST[1];
            let domain = if is_inside { 1.0 } else { OUTSIDE };
            places.push(Place {
                texel: texel * width + below,
                next: [next, after],
                value: *value,
                domain,
                weight: domain,
            });
        }
    }
    let offsets = [0, 1, width, width + 1];
    let filtered = |texels: &[f64], place: &Place| -> f64 {
        place.filters().iter().zip(offsets).map(|(weight, offset)| weight * texels[place.texel + offset]).sum()
    };
    let mut texels = vec![0.0; sizes[0] * width];
    for round in 0..if recipe.entries() > MANY_TEXELS { FEW_ROUNDS } else { ROUNDS } {
        if round > 0 {
            let errors: Vec<f64> = places.iter().map(|place| (filtered(&texels, place) - place.value).abs()).collect();
            let inside = || places.iter().zip(&errors).filter(|(place, _)| place.domain == 1.0);
            let largest = inside().map(|(_, error)| *error).fold(1e-9, f64::max);
            for (place, error) in places.iter_mut().zip(&errors) {
                let relative = error / largest;
                let emphasis = 1.0 + 20.0 * relative * relative * relative;
                place.weight = 0.5 * place.weight + 0.5 * place.domain * emphasis;
            }
        }
        descend(&mut texels, &places, &offsets, if round == 0 { 2 * STEPS } else { STEPS });
    }
    texels
}

/// Conjugate gradients with the diagonal as preconditioner.
fn descend(texels: &mut [f64], places: &[Place], offsets: &[usize; 4], steps: usize) {
    let n = texels.len();
    let mut diagonal = vec![1e-12; n];
    let mut residual = vec![0.0; n];
    // `place.value - filtered` spreads back to the four texels of each place.
    let spread = |from: &dyn Fn(&Place, f64) -> f64, texels: &[f64], to: &mut [f64]| {
        for place in places {
            let filters = place.filters();
            let sum: f64 =
                filters.iter().zip(offsets).map(|(weight, offset)| weight * texels[place.texel + offset]).sum();
            let push = from(place, sum);
            for (weight, offset) in filters.iter().zip(offsets) {
                to[place.texel + offset] += weight * push;
            }
        }
    };
    spread(&|place, sum| place.weight * (place.value - sum), texels, &mut residual);
    for place in places {
        for (weight, offset) in place.filters().iter().zip(offsets) {
            diagonal[place.texel + offset] += weight * weight * place.weight;
        }
    }
    let scaled = |residual: &[f64]| -> Vec<f64> { residual.iter().zip(&diagonal).map(|(r, d)| r / d).collect() };
    let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
    let mut direction = scaled(&residual);
    let mut square = dot(&residual, &direction);
    for _ in 0..steps {
        if square < 1e-24 {
            return;
        }
        let mut image = vec![0.0; n];
        spread(&|place, sum| place.weight * sum, &direction, &mut image);
        let step = square / dot(&direction, &image);
        for i in 0..n {
            texels[i] += step * direction[i];
            residual[i] -= step * image[i];
        }
        let next = scaled(&residual);
        let new = dot(&residual, &next);
        let kept = new / square;
        for i in 0..n {
            direction[i] = next[i] + kept * direction[i];
        }
        square = new;
    }
}
