//! Nelder and Mead's downhill simplex [Nelder and Mead 1965], in few variables and without randomness.

/// At convergence, the values of vertices differ by at most this fraction.
const RELATIVE_DIFFERENCE: f64 = 1e-4;
/// At convergence, vertices also differ by at most this distance in each variable. A large simplex whose vertices have
/// equal values has not converged.
const SMALLEST: f64 = 2e-3;

/// A vertex and its value.
type Vertex<const N: usize> = ([f64; N], f64);

/// The point with the lowest value after at most `steps` steps. The simplex starts from `start` and the points at a
/// distance of `side` along each variable. `None` if `value` returns `None`.
///
/// Reflection, expansion, contraction and shrinking have their usual factors of 1, 2, 1/2 and 1/2. Of two equal values,
/// the older value counts as lower. NaN counts as the highest value.
pub(super) fn minimise<const N: usize>(
    start: [f64; N],
    side: f64,
    steps: u32,
    mut value: impl FnMut(&[f64; N]) -> Option<f64>,
) -> Option<[f64; N]> {
    let mut at = |point: [f64; N]| {
        let value = value(&point)?;
        Some((point, if value.is_nan() { f64::INFINITY } else { value }))
    };
    let mut vertices: Vec<Vertex<N>> = vec![at(start)?];
    for axis in 0..N {
        let mut point = start;
        point[axis] += side;
        vertices.push(at(point)?);
    }
    for _ in 0..steps {
        // The sort is stable: equal values keep their order.
        vertices.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (lowest, second, highest) = (vertices[0], vertices[N - 1], vertices[N]);
        if has_converged(&vertices) {
            break;
        }
        let centroid: [f64; N] = std::array::from_fn(|k| vertices[..N].iter().map(|v| v.0[k]).sum::<f64>() / N as f64);
        let along = |t: f64| std::array::from_fn(|k| centroid[k] + t * (highest.0[k] - centroid[k]));
        let reflected = at(along(-1.0))?;
        if reflected.1 < lowest.1 {
            let expanded = at(along(-2.0))?;
            vertices[N] = if expanded.1 < reflected.1 { expanded } else { reflected };
            continue;
        }
        if reflected.1 < second.1 {
            vertices[N] = reflected;
            continue;
        }
        let outside = reflected.1 < highest.1;
        let contracted = at(along(if outside { -0.5 } else { 0.5 }))?;
        if contracted.1 < highest.1.min(reflected.1) {
            vertices[N] = contracted;
            continue;
        }
        for vertex in &mut vertices[1..] {
            *vertex = at(std::array::from_fn(|k| 0.5 * (vertex.0[k] + lowest.0[k])))?;
        }
    }
    vertices.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).map(|(point, _)| point)
}

fn has_converged<const N: usize>(vertices: &[Vertex<N>]) -> bool {
    let (lowest, highest) = (&vertices[0], &vertices[N]);
    let is_level = highest.1 - lowest.1 <= RELATIVE_DIFFERENCE * lowest.1;
    let is_small = vertices.iter().all(|vertex| vertex.0.iter().zip(&lowest.0).all(|(x, y)| (x - y).abs() <= SMALLEST));
    is_level && is_small
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A curved valley with its minimum at (1, 1) [Rosenbrock 1960].
    fn valley([x, y]: &[f64; 2]) -> f64 {
        let (along, across) = (1.0 - x, y - x * x);
        1.0 + along * along + 100.0 * across * across
    }

    #[test]
    fn finds_the_bottom_of_a_curved_valley() {
        let found = minimise([-1.2, 1.0], 0.1, 500, |point| Some(valley(point))).expect("nothing stops it");
        assert!((found[0] - 1.0).abs() < 0.02 && (found[1] - 1.0).abs() < 0.04, "{found:?}");
    }

    #[test]
    fn returns_none_if_the_function_does() {
        let mut left = 5;
        let stopped = minimise([-1.2, 1.0], 0.1, 500, |point| {
            left -= 1;
            (left > 0).then(|| valley(point))
        });
        assert_eq!((stopped, left), (None, 0));
    }

    #[test]
    fn values_that_are_no_numbers_are_walls() {
        let wall = |point: &[f64; 2]| if point[0] > 0.5 { f64::NAN } else { valley(point) };
        let found = minimise([-1.2, 1.0], 0.1, 500, |point| Some(wall(point))).expect("nothing stops it");
        assert!(found[0] <= 0.5 && valley(&found) < 1.3, "{found:?}");
    }

    #[test]
    fn takes_no_more_steps_than_allowed() {
        let evaluations = |steps| {
            let mut count = 0;
            minimise([-1.2, 1.0], 0.1, steps, |point| {
                count += 1;
                Some(valley(point))
            })
            .expect("nothing stops it");
            count
        };
        assert_eq!(evaluations(0), 3);
        assert!((6..=53).contains(&evaluations(10)), "{}", evaluations(10));
    }
}
