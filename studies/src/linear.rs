//! Non-negative least squares.

/// One measurement: a factor for each number, and the measured sum.
#[derive(Debug, Clone)]
pub struct Measured<const N: usize> {
    /// The factor of each number.
    pub factors: [f64; N],
    /// The measured sum, above zero.
    pub value: f64,
}

/// The non-negative numbers with the least sum of squared relative errors. Negative numbers are set to zero one at a
/// time, starting with the most negative. A number is zero if all its factors are zero.
#[must_use]
pub fn least_squares<const N: usize>(measured: &[Measured<N>]) -> [f64; N] {
    let mut free: Vec<usize> = (0..N).filter(|i| measured.iter().any(|measured| measured.factors[*i] != 0.0)).collect();
    loop {
        let column = |i: usize| measured.iter().map(move |m| m.factors[i] / m.value);
        // The numbers differ by orders of magnitude, so each has its own unit.
        let unit = |i: usize| column(i).map(|x| x * x).sum::<f64>().sqrt();
        let dot = |i: usize, j: usize| column(i).zip(column(j)).map(|(x, y)| x * y).sum::<f64>() / unit(i) / unit(j);
        let matrix = free.iter().flat_map(|i| free.iter().map(|j| dot(*i, *j)).collect::<Vec<_>>()).collect();
        let right = free.iter().map(|i| column(*i).sum::<f64>() / unit(*i)).collect();
        let Some(found) = solve(matrix, right) else { return [f64::NAN; N] };
        let least = found.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
        match least {
            Some((at, x)) if *x < 0.0 => drop(free.remove(at)),
            _ => {
                let mut numbers = [0.0; N];
                free.iter().zip(found).for_each(|(i, x)| numbers[*i] = x / unit(*i));
                return numbers;
            }
        }
    }
}

/// The solution of a symmetric positive definite system in row-major order, by Cholesky decomposition. `None` if it is
/// not positive definite.
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

/// The sum that `numbers` predict for `factors`.
#[must_use]
pub fn predicted<const N: usize>(factors: &[f64; N], numbers: &[f64; N]) -> f64 {
    factors.iter().zip(numbers).map(|(x, y)| x * y).sum()
}

/// Root mean square of the relative errors.
#[must_use]
pub fn relative_error<const N: usize>(measured: &[Measured<N>], numbers: &[f64; N]) -> f64 {
    let error = |m: &Measured<N>| (predicted(&m.factors, numbers) / m.value - 1.0).powi(2);
    (measured.iter().map(error).sum::<f64>() / measured.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planted_numbers_are_found_and_no_number_is_negative() {
        let at = |value: fn(f64, f64) -> f64| -> Vec<Measured<4>> {
            let places = (1..8).flat_map(|x| (1..8).map(move |y| (f64::from(x), f64::from(y))));
            places.map(|(x, y)| Measured { factors: [1.0, 1e6 * x, 1e-6 * y, 0.0], value: value(x, y) }).collect()
        };
        let found = least_squares(&at(|x, y| 0.5 + 3.0 * x + 2.0 * y));
        assert!((found[0] - 0.5).abs() < 1e-6 && (found[1] / 3e-6 - 1.0).abs() < 1e-6 && found[3] == 0.0, "{found:?}");
        assert!((found[2] / 2e6 - 1.0).abs() < 1e-6, "{found:?}");
        let found = least_squares(&at(|x, y| 30.0 + 3.0 * x - 2.0 * y));
        assert!(found[2] == 0.0 && found[1] > 0.0, "{found:?}");
    }

    #[test]
    fn systems_are_solved_if_they_are_positive_definite() {
        let found = solve(vec![4.0, 2.0, 2.0, 3.0], vec![10.0, 8.0]).expect("positive");
        assert!((found[0] - 1.75).abs() < 1e-12 && (found[1] - 1.5).abs() < 1e-12, "{found:?}");
        assert_eq!(solve(vec![1.0, 2.0, 2.0, 1.0], vec![1.0, 1.0]), None);
    }
}
