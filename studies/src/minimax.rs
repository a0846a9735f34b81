//! The polynomials of tables' shaders and of `shaders/normals_arcs*.wgsl` with the least largest error.

/// A function that is approximated by a sum of others, each times a number.
struct Asked<const N: usize> {
    terms: fn(f64) -> [f64; N],
    wanted: fn(f64) -> f64,
}

/// The numbers of a sum, and its largest error.
#[derive(Debug, Clone, PartialEq)]
pub struct Sum {
    /// One for each term.
    pub numbers: Vec<f64>,
    /// From the exact function.
    pub error: f64,
}

/// Places from 0 to 1 at which errors are looked at, denser at the ends.
const PLACES: usize = 4001;
const ROUNDS: usize = 40;

/// Remez's exchange: the error alternates between extremes of one size, which the next round looks for again.
fn minimax<const N: usize>(asked: &Asked<N>) -> Sum {
    let place = |i: usize| 0.5 - 0.5 * (std::f64::consts::PI * i as f64 / (PLACES - 1) as f64).cos();
    // Without the ends, where quotients are 0 over 0.
    let places: Vec<f64> = (1..PLACES - 1).map(place).collect();
    let mut extremes: Vec<usize> = (0..=N).map(|i| i * (places.len() - 1) / N).collect();
    let mut sum = Sum { numbers: vec![0.0; N], error: f64::INFINITY };
    for _ in 0..ROUNDS {
        let mut numbers = levelled(asked, extremes.iter().map(|at| places[*at]));
        numbers.truncate(N);
        let errors: Vec<f64> = places.iter().map(|x| value(asked, &numbers, *x) - (asked.wanted)(*x)).collect();
        sum = Sum { numbers, error: errors.iter().fold(0.0, |most, error| most.max(error.abs())) };
        // The largest error of each run of one sign.
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
        // More than are needed: those at the ends with the least errors go.
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

/// The numbers for which the error at these places has one size and alternates, and that error: Gauss's elimination.
fn levelled<const N: usize>(asked: &Asked<N>, places: impl Iterator<Item = f64>) -> Vec<f64> {
    let row =
        |(i, x): (i32, f64)| (asked.terms)(x).into_iter().chain([(-1.0_f64).powi(i), (asked.wanted)(x)]).collect();
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

fn value<const N: usize>(asked: &Asked<N>, numbers: &[f64], x: f64) -> f64 {
    (asked.terms)(x).iter().zip(numbers).map(|(term, number)| term * number).sum()
}

/// An angle over its sine, of `k`, the squared length of the sum of both directions, up to a straight angle:
/// `(pi + k (n_0 + k n_1)) / sqrt k - d_0 - k (d_1 + k d_2)`.
///
/// The cosine of half the angle is `c = sqrt k / 2`. Times `c`, half the angle over the sine of half of it is wanted, and its error
/// is the least.
#[must_use]
pub fn angle_over_sine() -> Sum {
    minimax(&Asked {
        terms: |c| {
            let k = 4.0 * c * c;
            [0.5 * k, 0.5 * k * k, -c, -c * k, -c * k * k]
        },
        wanted: |c| c.acos() / (1.0 - c * c).sqrt() - std::f64::consts::FRAC_PI_2,
    })
}

/// Terms and wanted value of [`arcs_close`], each over the quotient itself, so that the error is a part of it.
fn of_arcs(c: f64) -> ([f64; 5], f64) {
    let h = 2.0 * c * c;
    let (angle, root) = (2.0 * c.acos(), h.sqrt());
    let quotient = angle / angle.sin();
    let terms = [h / root, h * h / root, 1.0, h, h * h].map(|term| term / quotient);
    (terms, 1.0 - std::f64::consts::PI * std::f64::consts::FRAC_1_SQRT_2 / (root * quotient))
}

/// An angle over its sine, of `h = 1 + cosine`, up to a straight angle:
/// `(pi / sqrt 2 + a h + b h^2) / sqrt h + c + d h + e h^2`, with the least error as a part of it. `c = sqrt(h / 2)` here.
#[must_use]
pub fn arcs_close() -> Sum {
    minimax(&Asked { terms: |c| of_arcs(c).0, wanted: |c| of_arcs(c).1 })
}

/// The same without b and e.
#[must_use]
pub fn arcs_rough() -> Sum {
    let terms = |c| {
        let [a, _, c, d, _] = of_arcs(c).0;
        [a, c, d]
    };
    minimax(&Asked { terms, wanted: |c| of_arcs(c).1 })
}

/// The arc tangent up to an angle of pi/4, in odd powers.
#[must_use]
pub fn arc_tangent() -> Sum {
    minimax(&Asked {
        terms: |x| {
            let z = x * x;
            [x, x * z, x * z * z, x * z.powi(3), x * z.powi(4), x * z.powi(5), x * z.powi(6)]
        },
        wanted: f64::atan,
    })
}

/// All, with the numbers as the shaders have them: of the first, `d_0` is one more, as the quotient less one is wanted there.
#[must_use]
pub fn told() -> Vec<(&'static str, Vec<String>, f64)> {
    let mut bend = angle_over_sine();
    bend.numbers[2] += 1.0;
    let written = |name, Sum { numbers, error }: Sum| {
        (name, numbers.iter().map(|number| format!("{:.7}", number.abs())).collect(), error)
    };
    vec![
        written("angle over sine, less one", bend),
        written("arc tangent", arc_tangent()),
        written("angle over sine of arcs, close", arcs_close()),
        written("angle over sine of arcs, rough", arcs_rough()),
    ]
}
