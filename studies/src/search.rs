//! The least sum of absolute errors of a model of light over cases, by its numbers.
//!
//! Errors are taken to be linear in small changes of the numbers; the least sum of their squares, each weighed by one
//! over its size, is nearly that of the sizes (reweighted least squares). A step is damped until it makes the sum
//! smaller (Levenberg and Marquardt). Derivatives are differences, so that a model has nothing but its formula.

use rayon::prelude::*;

use crate::lights::{Case, Lit};

/// A model of light with numbers to find.
pub trait Model: Sync {
    /// The reflected light: for a Fresnel factor of one, and its part weighed by Schlick's fifth power.
    fn reflected(&self, numbers: &[f64], lit: &Lit) -> [f64; 2];
}

/// Step of the differences. All numbers are of order one.
const STEP: f64 = 1e-4;
/// Errors below this are as good as none: squares take the place of sizes there.
const NEGLIGIBLE: f64 = 1e-4;
/// Damping of a step, as a part of the sum's curvature by each number: of the first, and the most.
const DAMPING: [f64; 2] = [1e-2, 1e6];
/// Cases that one task sums up; the order of the sums does not depend on the number of threads.
const PART: usize = 64;

/// Differences between what a model tells and the truth.
fn errors(model: &dyn Model, numbers: &[f64], case: &Case) -> [f64; 2] {
    let found = model.reflected(numbers, &case.lit);
    [found[0] - case.truth[0], found[1] - case.truth[1]]
}

fn size(error: f64) -> f64 {
    (error * error + NEGLIGIBLE * NEGLIGIBLE).sqrt() - NEGLIGIBLE
}

/// The mean over cases of the sum of both parts' absolute errors, which is minimised.
#[must_use]
pub fn objective(model: &dyn Model, numbers: &[f64], cases: &[Case]) -> f64 {
    let sum = |part: &[Case]| -> f64 {
        part.iter().map(|case| errors(model, numbers, case).map(size).iter().sum::<f64>()).sum()
    };
    cases.par_chunks(PART).map(sum).collect::<Vec<_>>().iter().sum::<f64>() / cases.len() as f64
}

/// The normal equations of a step: half of the sum's second derivatives by pairs of numbers, and its first.
struct Equations {
    matrix: Vec<f64>,
    slope: Vec<f64>,
}

impl Equations {
    fn none(count: usize) -> Self {
        Self { matrix: vec![0.0; count * count], slope: vec![0.0; count] }
    }

    fn of(model: &dyn Model, numbers: &[f64], cases: &[Case]) -> Self {
        let parts: Vec<Self> = cases.par_chunks(PART).map(|part| Self::of_part(model, numbers, part)).collect();
        parts.iter().fold(Self::none(numbers.len()), |mut sum, part| {
            sum.matrix.iter_mut().zip(&part.matrix).for_each(|(sum, x)| *sum += x);
            sum.slope.iter_mut().zip(&part.slope).for_each(|(sum, x)| *sum += x);
            sum
        })
    }

    fn of_part(model: &dyn Model, numbers: &[f64], cases: &[Case]) -> Self {
        let count = numbers.len();
        let (mut sum, mut moved) = (Self::none(count), numbers.to_vec());
        let mut gradients = [vec![0.0; count], vec![0.0; count]];
        for case in cases {
            let at = errors(model, numbers, case);
            for i in 0..count {
                moved[i] = numbers[i] + STEP;
                let beside = errors(model, &moved, case);
                moved[i] = numbers[i];
                for (gradient, (beside, at)) in gradients.iter_mut().zip(beside.iter().zip(at)) {
                    gradient[i] = (beside - at) / STEP;
                }
            }
            for (error, gradient) in at.iter().zip(&gradients) {
                let weight = 1.0 / (size(*error) + NEGLIGIBLE);
                for (i, g) in gradient.iter().enumerate().filter(|(_, g)| **g != 0.0) {
                    sum.slope[i] += weight * g * error;
                    let row = &mut sum.matrix[i * count..(i + 1) * count];
                    row.iter_mut().zip(gradient).for_each(|(sum, other)| *sum += weight * g * other);
                }
            }
        }
        sum
    }

    /// The step that the equations ask for, each number held back by `damping` of its own curvature.
    fn step(&self, damping: f64) -> Option<Vec<f64>> {
        let count = self.slope.len();
        let mut matrix = self.matrix.clone();
        let most = (0..count).map(|i| matrix[i * count + i]).fold(0.0, f64::max);
        for i in 0..count {
            matrix[i * count + i] += damping * matrix[i * count + i] + 1e-12 * most;
        }
        let negative: Vec<f64> = self.slope.iter().map(|slope| -slope).collect();
        solve(matrix, negative)
    }
}

/// The solution of a symmetric positive system, row-major, by Cholesky's factors; `None` where it is not positive.
#[must_use]
pub fn solve(mut matrix: Vec<f64>, mut right: Vec<f64>) -> Option<Vec<f64>> {
    let count = right.len();
    for i in 0..count {
        for j in 0..=i {
            let sum = (0..j).fold(matrix[i * count + j], |sum, k| sum - matrix[i * count + k] * matrix[j * count + k]);
            matrix[i * count + j] = if i > j {
                sum / matrix[j * count + j]
            } else if sum > 0.0 {
                sum.sqrt()
            } else {
                return None;
            };
        }
    }
    for i in 0..count {
        let sum = (0..i).fold(right[i], |sum, k| sum - matrix[i * count + k] * right[k]);
        right[i] = sum / matrix[i * count + i];
    }
    for i in (0..count).rev() {
        let sum = (i + 1..count).fold(right[i], |sum, k| sum - matrix[k * count + i] * right[k]);
        right[i] = sum / matrix[i * count + i];
    }
    Some(right)
}

/// The numbers that at most `rounds` steps from `start` lead to. `tell` hears the objective after each.
pub fn search(
    model: &dyn Model,
    start: &[f64],
    cases: &[Case],
    rounds: usize,
    mut tell: impl FnMut(usize, f64),
) -> Vec<f64> {
    let (mut numbers, mut least, mut damping) = (start.to_vec(), objective(model, start, cases), DAMPING[0]);
    for round in 1..=rounds {
        let equations = Equations::of(model, &numbers, cases);
        let before = least;
        while damping < DAMPING[1] {
            if let Some(step) = equations.step(damping) {
                let moved: Vec<f64> = numbers.iter().zip(step).map(|(x, step)| x + step).collect();
                let found = objective(model, &moved, cases);
                if found < least {
                    (numbers, least, damping) = (moved, found, 0.2 * damping);
                    break;
                }
            }
            damping *= 5.0;
        }
        tell(round, least);
        if before - least < 1e-5 * before {
            break;
        }
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lights::{Kind, cases};

    /// The reflection of any light depends on three numbers of its view, one of them in a product.
    struct Planted;

    impl Model for Planted {
        fn reflected(&self, numbers: &[f64], lit: &Lit) -> [f64; 2] {
            let [x, y, z] = lit.wo();
            [numbers[0] * x + numbers[1] * y * z, (numbers[2] * z).max(0.0) * numbers[1]]
        }
    }

    #[test]
    fn planted_numbers_are_found_although_a_third_of_the_cases_is_wrong() {
        let planted = [0.4, -0.7, 1.3];
        let mut cases = cases(Kind::Random, 5, 300);
        for (i, case) in cases.iter_mut().enumerate() {
            let wrong = if i % 3 == 0 { 0.2 } else { 0.0 };
            case.truth = Planted.reflected(&planted, &case.lit).map(|x| x + wrong);
        }
        let found = search(&Planted, &[0.1, -0.2, 0.3], &cases, 40, |_, _| {});
        assert!(found.iter().zip(planted).all(|(found, x)| (found - x).abs() < 0.01), "{found:?}");
    }

    #[test]
    fn systems_are_solved_and_those_that_are_not_positive_refused() {
        let found = solve(vec![4.0, 2.0, 2.0, 3.0], vec![10.0, 8.0]).expect("positive");
        assert!((found[0] - 1.75).abs() < 1e-12 && (found[1] - 1.5).abs() < 1e-12, "{found:?}");
        assert_eq!(solve(vec![1.0, 2.0, 2.0, 1.0], vec![1.0, 1.0]), None);
    }
}
