//! Checks that values form a BRDF.

use super::{TabulatedAxes, TabulatedBrdf, TabulatedFault, fault::COUNT};

/// The largest fraction of uniform light that a tabulated BRDF may reflect.
pub const MOST_ALBEDO: f64 = 1.001;
/// The largest number of values of a tabulated BRDF: 32 MiB of f64.
pub const MOST_VALUES: usize = 1 << 22;
/// The smallest fraction of uniform light that a view may reflect. A lobe without light has no shape.
const LEAST_ALBEDO: f64 = 1e-12;
/// The tolerance for two values that should be equal by symmetry, relative to the largest value of the view. It is
/// larger than the error of a computation in f32 and smaller than the error of a table.
const SAME: f64 = 1e-3;

impl TabulatedBrdf {
    /// The BRDF with these values, per steradian and without the cosine. The last axis varies fastest.
    ///
    /// # Errors
    /// Returns all faults at once. Axes must ascend, lie inside their ranges and span the hemisphere. Values must be
    /// finite and not negative, and their number must match the axes. If the number matches, the reflected light is
    /// checked too: each view must reflect some uniform light, but at most [`MOST_ALBEDO`]. Anisotropic surfaces must
    /// have equal values where their symmetry requires equality. Invalid values count as zero and are not compared.
    pub fn new(mut axes: TabulatedAxes, mut values: Vec<f64>) -> Result<Self, Vec<TabulatedFault>> {
        let mut faults = Vec::new();
        axes.check(&mut faults);
        let axes_are_right = faults.is_empty();
        let lengths = axes.shape();
        let shape = lengths.iter().map(ToString::to_string).collect::<Vec<_>>().join(" x ");
        let count = lengths.iter().try_fold(1_usize, |product, n| product.checked_mul(*n));
        let mut note = |detail: String| faults.push(TabulatedFault { tensor: "value", detail });
        let fits = count == Some(values.len());
        let is_too_large = count.is_none_or(|count| count > MOST_VALUES);
        if is_too_large {
            note(format!("{shape} numbers; allowed: at most {MOST_VALUES}"));
        }
        if !fits {
            note(format!("{} numbers{COUNT}{shape}", values.len()));
        }
        let mut report = |what: &str, wrong: fn(&f64) -> bool| {
            let mut found = values.iter().enumerate().filter(|(_, x)| wrong(x));
            let Some((first, x)) = found.next() else { return };
            let place = if fits { axes.place(first) } else { format!("element {first}") };
            let count = 1 + found.count();
            note(format!("{count} of {} numbers {what}; the first is {x}, at {place}", values.len()));
        };
        report("are not finite", |x| !x.is_finite());
        report("are negative", |x| *x < 0.0);
        let is_wrong = |x: &f64| !(x.is_finite() && *x >= 0.0);
        let any_is_wrong = values.iter().any(is_wrong);
        if !axes_are_right || !fits || is_too_large {
            return Err(faults);
        }
        faults.extend(azimuth_faults(&axes, &values));
        values.iter_mut().filter(|x| is_wrong(x)).for_each(|x| *x = 0.0);
        let grid = Self::of_checked(axes, values);
        faults.extend(grid.energy_faults(any_is_wrong));
        if faults.is_empty() { Ok(grid) } else { Err(faults) }
    }

    /// The faults of views that reflect too much light or none. If any value was invalid, only too much light is a
    /// fault.
    fn energy_faults(&self, any_was_wrong: bool) -> Vec<TabulatedFault> {
        let place = |node: usize| self.axes().place_of_view(node);
        let mut faults = Vec::new();
        let mut note = |detail: String| faults.push(TabulatedFault { tensor: "value", detail });
        let albedos = self.albedos();
        let too_bright = |x: &f64| x.is_nan() || *x > MOST_ALBEDO;
        let count = albedos.iter().filter(|x| too_bright(x)).count();
        let most = albedos.iter().enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b));
        if let Some((node, albedo)) = most.filter(|_| count > 0) {
            let place = place(node);
            note(format!(
                "{count} of {} views reflect more than {MOST_ALBEDO} of uniform light, up to {albedo:.4} at {place}",
                albedos.len()
            ));
        }
        if let Some(node) = albedos.iter().position(|x| *x < LEAST_ALBEDO).filter(|_| !any_was_wrong) {
            let place = place(node);
            note(format!("no light is reflected at {place}; end the axis before this node or give it values above 0"));
        }
        faults
    }
}

/// The faults of values of anisotropic surfaces that should be equal: at both ends of a turn of `phi`, and at `phi` and
/// `2 pi - phi` for views along an axis of the surface. Domain: valid axes with the right number of values.
fn azimuth_faults(axes: &TabulatedAxes, values: &[f64]) -> Vec<TabulatedFault> {
    let (azimuths, phis) = (axes.phi_o.len(), axes.phi.len());
    if axes.is_isotropic() {
        return Vec::new();
    }
    let (mut turn, mut mirror) = (Apart::default(), Apart::default());
    let of_view = axes.theta_i.len() * phis;
    for (view, of_lights) in values.chunks_exact(of_view).enumerate() {
        let most = of_lights.iter().copied().filter(|x| x.is_finite()).fold(0.0, f64::max);
        let is_along_an_axis = [0, azimuths - 1].contains(&(view % azimuths));
        for (i, row) in of_lights.chunks_exact(phis).enumerate() {
            let first = view * of_view + i * phis;
            turn.compare([row[phis - 1], row[0]], most, first + phis - 1);
            for p in (1..phis / 2).filter(|_| is_along_an_axis) {
                mirror.compare([row[p], row[phis - 1 - p]], most, first + p);
            }
        }
    }
    let checks = [
        (turn, "differ at phi 0 and 2 pi, which are the same azimuth"),
        (mirror, "differ at phi and 2 pi - phi for phi_o 0 or pi/2, where the surface is symmetric"),
    ];
    checks.into_iter().filter_map(|(apart, what)| apart.fault(what, axes)).collect()
}

/// Pairs of values that should be equal but differ.
#[derive(Default)]
struct Apart {
    pairs: usize,
    /// The largest difference, relative to the view's largest value, and the index of its first value.
    largest: (f64, usize),
}

impl Apart {
    fn compare(&mut self, pair: [f64; 2], most: f64, index: usize) {
        let apart = (pair[0] - pair[1]).abs() / most;
        // Invalid values have their own message.
        if pair.iter().all(|x| x.is_finite() && *x >= 0.0) && apart > SAME {
            self.pairs += 1;
            if apart > self.largest.0 {
                self.largest = (apart, index);
            }
        }
    }

    fn fault(self, what: &str, axes: &TabulatedAxes) -> Option<TabulatedFault> {
        let Self { pairs, largest: (most, index) } = self;
        let place = axes.place(index);
        let detail = format!(
            "{pairs} pairs of numbers {what}, by up to {most:.4} of the view's largest number at {place}; allowed: {SAME}"
        );
        (pairs > 0).then_some(TabulatedFault { tensor: "value", detail })
    }
}
