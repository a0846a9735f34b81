//! Finds the polynomials of the shaders for tables and of `shaders/normals_arcs*.wgsl`. They minimise the largest
//! error.

/// A function that is approximated by a sum of terms. Each term has a factor.
struct Approximation<const N: usize> {
    terms: fn(f64) -> [f64; N],
    function: fn(f64) -> f64,
}

/// The factors of a sum, with its largest error.
#[derive(Debug, Clone, PartialEq)]
pub struct Sum {
    /// The factor of each term.
    pub numbers: Vec<f64>,
    /// The largest difference from the exact function.
    pub error: f64,
}

/// Points from 0 to 1 at which the error is computed. They are denser near the ends.
const PLACES: usize = 4001;
const ROUNDS: usize = 40;

/// Remez's exchange algorithm. Each round solves for an error that alternates between equal extremes at some points.
/// The next round uses the points of the actual extremes.
fn minimax<const N: usize>(goal: &Approximation<N>) -> Sum {
    let place = |i: usize| 0.5 - 0.5 * (std::f64::consts::PI * i as f64 / (PLACES - 1) as f64).cos();
    // The ends are excluded, because quotients there are 0 divided by 0.
    let places: Vec<f64> = (1..PLACES - 1).map(place).collect();
    let mut extremes: Vec<usize> = (0..=N).map(|i| i * (places.len() - 1) / N).collect();
    let mut sum = Sum { numbers: vec![0.0; N], error: f64::INFINITY };
    for _ in 0..ROUNDS {
        let mut numbers = levelled(goal, extremes.iter().map(|at| places[*at]));
        numbers.truncate(N);
        let errors: Vec<f64> = places.iter().map(|x| value(goal, &numbers, *x) - (goal.function)(*x)).collect();
        sum = Sum { numbers, error: errors.iter().fold(0.0, |most, error| most.max(error.abs())) };
        // The position of the largest error in each run of errors with the same sign.
        let mut runs: Vec<usize> = Vec::new();
        for (i, error) in errors.iter().enumerate() {
            match runs.last_mut() {
                Some(last) if errors[*last] * error > 0.0 => {
                    if error.abs() > errors[*last].abs() {
                        *last = i;
                    }
                }
                _ => runs.push(i),
            }
        }
        // Removes the smaller of the two outer extremes until `N + 1` extremes remain.
        while runs.len() > N + 1 {
            let (first, last) = (errors[runs[0]].abs(), errors[runs[runs.len() - 1]].abs());
            runs.remove(if first < last { 0 } else { runs.len() - 1 });
        }
        if runs.len() != N + 1 {
            break;
        }
        extremes = runs;
    }
    sum
}

/// The factors for which the error at these points alternates with equal size, followed by this error. Solved by
/// Gaussian elimination.
fn levelled<const N: usize>(goal: &Approximation<N>, places: impl Iterator<Item = f64>) -> Vec<f64> {
    let row =
        |(i, x): (i32, f64)| (goal.terms)(x).into_iter().chain([(-1.0_f64).powi(i), (goal.function)(x)]).collect();
    let mut rows: Vec<Vec<f64>> = (0..).zip(places).map(row).collect();
    let size = rows.len();
    for column in 0..size {
        let largest = |a: &usize, b: &usize| rows[*a][column].abs().total_cmp(&rows[*b][column].abs());
        let pivot = (column..size).max_by(largest).unwrap_or(column);
        rows.swap(column, pivot);
        let chosen = rows[column].clone();
        for (_, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != column) {
            let factor = row[column] / chosen[column];
            row.iter_mut().zip(&chosen).for_each(|(x, y)| *x -= factor * y);
        }
    }
    (0..size).map(|i| rows[i][size] / rows[i][i]).collect()
}

fn value<const N: usize>(goal: &Approximation<N>, numbers: &[f64], x: f64) -> f64 {
    (goal.terms)(x).iter().zip(numbers).map(|(term, number)| term * number).sum()
}

/// An angle divided by its sine, up to an angle of pi, as `(pi + k (n_0 + k n_1)) / sqrt k - d_0 - k (d_1 + k d_2)`.
/// Here `k` is the squared length of the sum of both directions.
///
/// The cosine of half the angle is `c = sqrt k / 2`. The angle divided by its sine, times `c`, is `acos(c) / sqrt(1 -
/// c^2)`. The fit minimises the error of this product.
#[must_use]
pub fn angle_over_sine() -> Sum {
    minimax(&Approximation {
        terms: |c| {
            let k = 4.0 * c * c;
            [0.5 * k, 0.5 * k * k, -c, -c * k, -c * k * k]
        },
        function: |c| c.acos() / (1.0 - c * c).sqrt() - std::f64::consts::FRAC_PI_2,
    })
}

/// Terms and value of [`arcs_close`]. They are divided by the quotient, so that the error is relative.
fn of_arcs(c: f64) -> ([f64; 4], f64) {
    let h = 2.0 * c * c;
    let (angle, root) = (2.0 * c.acos(), h.sqrt());
    let quotient = angle / angle.sin();
    let terms = [h / root, h * h / root, 1.0, h].map(|term| term / quotient);
    (terms, 1.0 - std::f64::consts::PI * std::f64::consts::FRAC_1_SQRT_2 / (root * quotient))
}

/// An angle divided by its sine, up to an angle of pi, with the least relative error, for `h = 1 + cosine`:
/// `(pi / sqrt 2 + a h + b h^2) / sqrt h + c + d h`. The terms are functions of the cosine of half the angle,
/// `sqrt(h / 2)`.
#[must_use]
pub fn arcs_close() -> Sum {
    minimax(&Approximation { terms: |c| of_arcs(c).0, function: |c| of_arcs(c).1 })
}

/// [`arcs_close`] without b.
#[must_use]
pub fn arcs_rough() -> Sum {
    let terms = |c| {
        let [a, _, c, d] = of_arcs(c).0;
        [a, c, d]
    };
    minimax(&Approximation { terms, function: |c| of_arcs(c).1 })
}

/// The arc tangent up to an angle of pi/4, as odd powers.
#[must_use]
pub fn arc_tangent() -> Sum {
    minimax(&Approximation {
        terms: |x| {
            let z = x * x;
            [x, x * z, x * z * z, x * z.powi(3), x * z.powi(4), x * z.powi(5), x * z.powi(6)]
        },
        function: f64::atan,
    })
}

/// Each polynomial: its name, its numbers as in the shaders, and its error. In the first polynomial, `d_0` is larger by
/// one, because the shader computes the quotient minus one.
#[must_use]
pub fn rows() -> Vec<(&'static str, Vec<String>, f64)> {
    let mut bend = angle_over_sine();
    bend.numbers[2] += 1.0;
    let row = |name, Sum { numbers, error }: Sum| {
        (name, numbers.iter().map(|number| format!("{:.7}", number.abs())).collect(), error)
    };
    vec![
        row("angle over sine, less one", bend),
        row("arc tangent", arc_tangent()),
        row("angle over sine of arcs, close", arcs_close()),
        row("angle over sine of arcs, rough", arcs_rough()),
    ]
}
