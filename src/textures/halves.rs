//! Rounds the numbers of a matrix to halves together, so that its lobe moves least.
//!
//! The direction of a sharp lobe depends on small differences of large numbers. Rounding each number to the nearest
//! half can move the lobe by most of its width. Therefore each number becomes one of its two neighbouring halves, and a
//! search selects the combination that moves the lobe least:
//!
//! ```text
//! d^2 = mean_k |w'_k - w_k|^2,   w_k = M c_k / |M c_k|
//! ```
//!
//! The directions `c_k` are fixed and represent a clamped cosine. For up to five numbers, as in isotropic tables, the
//! search tries all combinations. For nine numbers, it changes one or two numbers at a time until nothing improves.

use glam::{DMat3, DVec3};
use half::f16;
use serde::Serialize;

use ltcforge_fit::{ALPHA_FLOOR, Layout, PerAxis, Reflection, THETA_CEILING, Table, math::concentric_cosine};

/// How far rounding moves lobes: the root mean square displacement of a lobe's directions, divided by the root mean
/// square of their distances from the middle of the lobe. It is 1 for a matrix without a lobe.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Displacement {
    /// The mean over a table's entries.
    pub mean: f64,
    /// The largest value.
    pub max: f64,
}

/// The numbers of a texture as halves that were rounded together.
#[derive(Debug, Clone, PartialEq)]
pub struct Halves {
    /// The halves, in the order of the texels.
    pub numbers: Vec<f32>,
    /// How far rounding moves the table's lobes.
    pub displacement: Displacement,
}

/// The numbers of rings and sectors of the clamped cosine, for the search and for the reported displacement. Each cell
/// has one direction.
const SEARCHED: [usize; 2] = [4, 8];
const MEASURED: [usize; 2] = [8, 16];
/// The largest number of values for which the search tries all combinations.
const MOST_TOGETHER: usize = 5;
/// The displacement of a matrix without a lobe, and of a matrix for which no combination of halves has a lobe.
const WITHOUT_LOBE: f64 = 1.0;
/// The largest number of rounds that change one or two numbers.
const MOST_ROUNDS: usize = 8;

/// The table with matrices in halves, and the displacement of its lobes.
pub(super) fn halved(table: &Table) -> (Table, Displacement) {
    let (searched, measured) = (Cosine::new(SEARCHED), Cosine::new(MEASURED));
    let mut halved = table.clone();
    let (mut sum, mut max, mut lobes) = (0.0, 0.0_f64, 0);
    for matrices in [Some(&mut halved.matrix), halved.second.as_mut()].into_iter().flatten() {
        for (entry, matrix) in matrices.iter_mut().enumerate() {
            let decoder = LobeDecoder::of(table.layout, table.node(entry));
            let exact = *matrix;
            *matrix = decoder.nearest_lobe(&exact, &searched);
            let moved = decoder.displacement(&exact, matrix, &measured).unwrap_or(WITHOUT_LOBE);
            sum += moved;
            max = max.max(moved);
            lobes += 1;
        }
    }
    let mean = sum / f64::from(lobes.max(1));
    (halved, Displacement { mean, max })
}

/// The half nearest to a number, and the neighbouring half on the other side of the number, if there is one. Both are
/// finite. If the number is not zero, neither half is zero.
pub(super) fn neighbours(x: f32) -> (f32, Option<f32>) {
    let half = f16::from_f32_const(x);
    if x == 0.0 || half.to_f32_const() == x {
        return (x, None);
    }
    if half.is_infinite() {
        return (f16::MAX.to_f32_const().copysign(x), None);
    }
    if half.to_f32_const() == 0.0 {
        return (f16::MIN_POSITIVE_SUBNORMAL.to_f32_const().copysign(x), None);
    }
    let nearest = half.to_f32_const();
    let bits = half.to_bits();
    // The bits of a half grow with its magnitude.
    let other = f16::from_bits(if nearest.abs() < x.abs() { bits + 1 } else { bits - 1 });
    let is_usable = other.is_finite() && other.to_f32_const() != 0.0;
    (nearest, is_usable.then(|| other.to_f32_const()))
}

/// Directions that represent a clamped cosine.
struct Cosine(Vec<DVec3>);

impl Cosine {
    fn new([rings, sectors]: [usize; 2]) -> Self {
        let middle = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
        let at = |i: usize| concentric_cosine([middle(i / sectors, rings), middle(i % sectors, sectors)]);
        Self((0..rings * sectors).map(at).collect())
    }

    /// The directions of a lobe, for its matrix `m`.
    fn of(&self, m: &DMat3) -> Vec<DVec3> {
        self.0.iter().map(|c| (*m * *c).normalize()).collect()
    }
}

/// Computes the lobe of an entry from its stored matrix.
struct LobeDecoder {
    is_inverse: bool,
    /// The left factor of the stored matrix.
    before: DMat3,
}

impl LobeDecoder {
    fn of(layout: Layout, mut node: PerAxis<f64>) -> Self {
        (node.alpha, node.theta) = (node.alpha.max(ALPHA_FLOOR), node.theta.min(THETA_CEILING));
        let before = if layout.is_relative() { Reflection::at(&node).matrix } else { DMat3::IDENTITY };
        Self { is_inverse: layout.free_numbers().is_some_and(|free| free.is_inverse), before }
    }

    /// The lobe of a stored matrix. `None` if the matrix has no lobe.
    fn lobe(&self, stored: &[f32; 9]) -> Option<DMat3> {
        // The array is row-major.
        let stored = DMat3::from_cols_array(&stored.map(f64::from)).transpose();
        let determinant = stored.determinant();
        let lobe = self.before * if self.is_inverse { stored.inverse() } else { stored };
        (determinant > 0.0 && lobe.is_finite()).then_some(lobe)
    }

    /// The displacement between the lobes of two stored matrices. `None` if one of them has no lobe.
    fn displacement(&self, exact: &[f32; 9], other: &[f32; 9], cosine: &Cosine) -> Option<f64> {
        let exact = cosine.of(&self.lobe(exact)?);
        let moved = mean_square(&exact, &cosine.of(&self.lobe(other)?));
        let middle = exact.iter().sum::<DVec3>() / exact.len() as f64;
        let width = exact.iter().map(|w| w.distance_squared(middle)).sum::<f64>() / exact.len() as f64;
        let part = (moved / width).sqrt();
        part.is_finite().then_some(part)
    }

    /// The halves whose lobe is nearest to that of the exact matrix.
    fn nearest_lobe(&self, exact: &[f32; 9], cosine: &Cosine) -> [f32; 9] {
        let choices = exact.map(neighbours);
        let free: Vec<usize> = (0..9).filter(|i| choices[*i].1.is_some()).collect();
        let taken = |mask: u32| -> [f32; 9] {
            std::array::from_fn(|i| {
                let (nearest, other) = choices[i];
                if mask >> i & 1 == 1 { other.unwrap_or(nearest) } else { nearest }
            })
        };
        let Some(lobe) = self.lobe(exact) else { return taken(0) };
        let wanted = cosine.of(&lobe);
        let moved = |mask: u32| {
            let moved = self.lobe(&taken(mask)).map(|lobe| mean_square(&wanted, &cosine.of(&lobe)));
            moved.filter(|moved| moved.is_finite()).unwrap_or(f64::INFINITY)
        };
        let mut best = (0, moved(0));
        let try_one = |mask: u32, best: &mut (u32, f64)| {
            let moved = moved(mask);
            if moved < best.1 {
                *best = (mask, moved);
            }
        };
        if free.len() <= MOST_TOGETHER {
            for choice in 1..1_u32 << free.len() {
                let mask = free.iter().enumerate().map(|(k, i)| (choice >> k & 1) << i).sum();
                try_one(mask, &mut best);
            }
            return taken(best.0);
        }
        for _ in 0..MOST_ROUNDS {
            let before = best.0;
            for (k, one) in free.iter().enumerate() {
                // The last item changes one number. The items before it change two.
                for other in free[k + 1..].iter().chain([one]) {
                    let change = 1 << one | 1 << other;
                    try_one(best.0 ^ change, &mut best);
                }
            }
            if best.0 == before {
                break;
            }
        }
        taken(best.0)
    }
}

fn mean_square(one: &[DVec3], other: &[DVec3]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a.distance_squared(*b)).sum::<f64>() / one.len() as f64
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::round;
    use ltcforge_files::compact::planted::planted;
    use ltcforge_fit::Precision;

    /// The displacement if each number is rounded on its own.
    fn alone(table: &Table) -> Displacement {
        let cosine = Cosine::new(MEASURED);
        let moved: Vec<f64> = (0..table.matrix.len())
            .map(|entry| {
                let nearest = round(&table.matrix[entry], Precision::F16).numbers;
                let nearest: [f32; 9] = nearest.try_into().expect("nine");
                let decoder = LobeDecoder::of(table.layout, table.node(entry));
                decoder.displacement(&table.matrix[entry], &nearest, &cosine).unwrap_or(WITHOUT_LOBE)
            })
            .collect();
        let mean = moved.iter().sum::<f64>() / moved.len() as f64;
        Displacement { mean, max: moved.iter().copied().fold(0.0, f64::max) }
    }

    #[test]
    fn lobes_move_less_than_with_separate_rounding() {
        for (layout, nodes, part) in [
            (Layout::Ltc2017, [24, 1, 24, 1], 0.75),
            (Layout::Godot, [24, 1, 24, 1], 0.85),
            (Layout::Kt2022, [6, 4, 6, 5], 0.7),
            (Layout::Reflected, [6, 4, 6, 5], 0.7),
        ] {
            let table = planted(layout, nodes, true, |_, _| 0.0);
            let (halved, moved) = halved(&table);
            let alone = alone(&table);
            assert!(moved.mean < part * alone.mean, "{layout}: {moved:?} {alone:?}");
            // The search does not try all combinations of nine numbers.
            assert!(moved.max <= alone.max || table.layout.only_ranges().is_none(), "{layout}: {moved:?} {alone:?}");
            assert!(moved.mean > 0.0 && halved.matrix != table.matrix, "{layout}");
            let (again, unmoved) = super::halved(&halved);
            assert!(again.matrix == halved.matrix && unmoved == Displacement::default(), "{layout}: {unmoved:?}");
        }
    }

    proptest! {
        #[test]
        fn neighbours_are_halves_on_both_sides(x in prop::num::f32::NORMAL | prop::num::f32::SUBNORMAL) {
            let (nearest, other) = neighbours(x);
            for half in [Some(nearest), other].into_iter().flatten() {
                prop_assert!(half.is_finite() && half != 0.0 && half.signum() == x.signum());
                prop_assert_eq!(f16::from_f32_const(half).to_f32_const(), half);
            }
            prop_assert_eq!(nearest, round(&[x], Precision::F16).numbers[0]);
            if let Some(other) = other {
                prop_assert!((nearest < x) != (other < x) && (nearest - x).abs() <= (other - x).abs(), "{nearest} {x} {other}");
            }
        }
    }
}
