//! Minimisation of a function of a few variables by BFGS with backtracking [Nocedal and Wright 2006, chapters 3, 6].

/// The largest number of variables.
pub(super) const VARIABLES: usize = 7;

/// A point, a gradient or a direction.
pub(super) type Vector = [f64; VARIABLES];

/// A step must achieve at least this fraction of the decrease that the gradient predicts (Armijo).
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// The number of halvings of a step before the direction is abandoned.
const MOST_HALVINGS: u32 = 12;
/// The largest step of the variables. The quadratic model does not hold beyond it.
const LONGEST_STEP: f64 = 1.0;

/// The criteria for stopping.
#[derive(Debug, Clone, Copy)]
pub(super) struct StopRule {
    /// The largest number of steps.
    pub(super) steps: u32,
    /// Stops after two steps in a row that reduce the value by less than this fraction.
    pub(super) relative_decrease: f64,
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The estimate of BFGS for the inverse Hessian.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct InverseHessian {
    rows: [Vector; VARIABLES],
    /// True after the first update.
    has_learnt: bool,
}

impl InverseHessian {
    pub(super) fn diagonal(numbers: &Vector) -> Self {
        let mut rows = [[0.0; VARIABLES]; VARIABLES];
        for (i, (row, number)) in rows.iter_mut().zip(numbers).enumerate() {
            row[i] = *number;
        }
        Self { rows, has_learnt: false }
    }

    fn times(&self, v: &Vector) -> Vector {
        self.rows.map(|row| dot(&row, v))
    }

    /// Updates `H <- (I - rho s y^T) H (I - rho y s^T) + rho s s^T` with `rho = 1 / (y^T s)`, for the step `s` and the
    /// change `y` of the gradient. A step along which the slope decreases is ignored, because it shows no positive
    /// curvature.
    fn learn(&mut self, s: &Vector, y: &Vector) {
        let ys = dot(y, s);
        let yy = dot(y, y);
        if ys <= 1e-10 * yy.sqrt() * dot(s, s).sqrt() {
            return;
        }
        self.has_learnt = true;
        let rho = 1.0 / ys;
        let hy = self.times(y);
        let gain = rho * (1.0 + rho * dot(y, &hy));
        for (i, row) in self.rows.iter_mut().enumerate() {
            for (j, h) in row.iter_mut().enumerate() {
                *h += gain * s[i] * s[j] - rho * (hy[i] * s[j] + s[i] * hy[j]);
            }
        }
    }
}

/// Minimises `function`, which returns value and gradient, from `start`. `hessian` is an estimate of the inverse
/// Hessian, which the search improves. If the estimate gives a bad direction, the search continues with the diagonal
/// `curvature`. Variables that are not `free` do not change. Returns `None` if `function` returns `None`.
///
/// Returns the lowest point. A value that is not finite counts as too high.
pub(super) fn minimise(
    start: Vector,
    curvature: &Vector,
    hessian: &mut InverseHessian,
    free: [bool; VARIABLES],
    stop: StopRule,
    mut function: impl FnMut(&Vector) -> Option<(f64, Vector)>,
) -> Option<Vector> {
    let mut masked = |point: &Vector| {
        let (value, mut gradient) = function(point)?;
        for (slope, free) in gradient.iter_mut().zip(free) {
            if !free {
                *slope = 0.0;
            }
        }
        Some((value, gradient))
    };
    let mut point = start;
    let (mut value, mut gradient) = masked(&point)?;
    let mut small_steps = 0;
    for _ in 0..stop.steps {
        let mut direction = hessian.times(&gradient).map(|d| -d);
        let mut slope = dot(&direction, &gradient);
        if slope >= 0.0 {
            *hessian = InverseHessian::diagonal(curvature);
            direction = hessian.times(&gradient).map(|d| -d);
            slope = dot(&direction, &gradient);
            if slope == 0.0 {
                break;
            }
        }
        let length = dot(&direction, &direction).sqrt();
        let mut step = if length > LONGEST_STEP { LONGEST_STEP / length } else { 1.0 };
        let mut next = None;
        for _ in 0..MOST_HALVINGS {
            let mut trial = point;
            trial.iter_mut().zip(&direction).for_each(|(x, d)| *x += step * d);
            let (trial_value, trial_gradient) = masked(&trial)?;
            if trial_value <= value + SUFFICIENT_DECREASE * step * slope {
                next = Some((trial, trial_value, trial_gradient));
                break;
            }
            step *= 0.5;
        }
        let Some((next_point, next_value, next_gradient)) = next else {
            if !hessian.has_learnt {
                break;
            }
            *hessian = InverseHessian::diagonal(curvature);
            continue;
        };
        let mut s = next_point;
        s.iter_mut().zip(&point).for_each(|(s, x)| *s -= x);
        let mut y = next_gradient;
        y.iter_mut().zip(&gradient).for_each(|(y, g)| *y -= g);
        hessian.learn(&s, &y);
        let decrease = value - next_value;
        (point, value, gradient) = (next_point, next_value, next_gradient);
        // The line search can cause one short step. Two short steps in a row mean convergence.
        small_steps = if decrease <= stop.relative_decrease * value { small_steps + 1 } else { 0 };
        if small_steps == 2 {
            break;
        }
    }
    Some(point)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONES: Vector = [1.0; VARIABLES];
    const ALL: [bool; VARIABLES] = [true; VARIABLES];

    /// A quadratic bowl with curvatures from 1 to 64 and its minimum at (1, 2, ..., 7) / 10.
    fn bowl(x: &Vector) -> (f64, Vector) {
        let mut gradient = [0.0; VARIABLES];
        let mut value = 0.5;
        for (i, (x, g)) in x.iter().zip(&mut gradient).enumerate() {
            let (curvature, offset) = (f64::from(1 << i), x - (i + 1) as f64 / 10.0);
            *g = curvature * offset;
            value += 0.5 * curvature * offset * offset;
        }
        (value, gradient)
    }

    #[test]
    fn finds_the_bottom_of_a_bowl() {
        let stop = StopRule { steps: 100, relative_decrease: 0.0 };
        let minimum =
            minimise([0.0; VARIABLES], &ONES, &mut InverseHessian::diagonal(&ONES), ALL, stop, |x| Some(bowl(x)))
                .expect("nothing stops it");
        for (i, x) in minimum.iter().enumerate() {
            assert!((x - (i + 1) as f64 / 10.0).abs() < 1e-5, "{minimum:?}");
        }
    }

    #[test]
    fn returns_none_if_the_function_does() {
        let mut left = 3;
        let stop = StopRule { steps: 100, relative_decrease: 0.0 };
        let stopped = minimise([0.0; VARIABLES], &ONES, &mut InverseHessian::diagonal(&ONES), ALL, stop, |x| {
            left -= 1;
            (left > 0).then(|| bowl(x))
        });
        assert_eq!((stopped, left), (None, 0));
    }

    #[test]
    fn leaves_bound_variables_alone() {
        let mut free = ALL;
        free[3] = false;
        let stop = StopRule { steps: 100, relative_decrease: 0.0 };
        let minimum =
            minimise([0.0; VARIABLES], &ONES, &mut InverseHessian::diagonal(&ONES), free, stop, |x| Some(bowl(x)))
                .expect("nothing stops it");
        assert_eq!(minimum[3], 0.0);
        assert!((minimum[4] - 0.5).abs() < 1e-5);
    }

    #[test]
    fn survives_values_that_are_not_finite() {
        let stop = StopRule { steps: 50, relative_decrease: 0.0 };
        let wall = |x: &Vector| if x[0] > 0.05 { (f64::NAN, [f64::NAN; VARIABLES]) } else { bowl(x) };
        let minimum =
            minimise([0.0; VARIABLES], &ONES, &mut InverseHessian::diagonal(&ONES), ALL, stop, |x| Some(wall(x)))
                .expect("nothing stops it");
        assert!(bowl(&minimum).0 < bowl(&[0.0; VARIABLES]).0 && minimum[0] <= 0.05, "{minimum:?}");
    }
}
