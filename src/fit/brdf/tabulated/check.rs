//! Checks that numbers are a BRDF.

use super::{TabulatedAxes, TabulatedBrdf, TabulatedFault, fault::COUNT};

/// The most that a tabulated BRDF may reflect of even light.
pub const MOST_ALBEDO: f64 = 1.001;
/// The most numbers of a tabulated BRDF: 32 MiB of f64.
pub const MOST_VALUES: usize = 1 << 22;
/// The least that it may reflect: a lobe without light has no shape.
const LEAST_ALBEDO: f64 = 1e-12;

impl TabulatedBrdf {
    /// The BRDF of these values, row by row of the last axis: per steradian and without the cosine.
    ///
    /// # Errors
    /// All faults at once: axes that do not ascend, lie outside their ranges or do not span the hemisphere; values that
    /// are too many, too few, negative or no numbers; and, where axes and number of values are right, more than
    /// [`MOST_ALBEDO`] or nothing at all of even light reflected. Values that are negative or no numbers count as zero
    /// there.
    pub fn new(mut axes: TabulatedAxes, mut values: Vec<f64>) -> Result<Self, Vec<TabulatedFault>> {
        let mut faults = Vec::new();
        axes.check(&mut faults);
        let axes_are_right = faults.is_empty();
        let lengths = axes.lengths();
        let count = lengths.iter().try_fold(1_usize, |product, n| product.checked_mul(*n));
        let mut note = |detail: String| faults.push(TabulatedFault { tensor: "value", detail });
        let fits = count == Some(values.len());
        let is_too_large = count.is_none_or(|count| count > MOST_VALUES);
        if is_too_large {
            note(format!("{} numbers; allowed: at most {MOST_VALUES}", shape(lengths)));
        }
        if !fits {
            note(format!("{} numbers{COUNT}{}", values.len(), shape(lengths)));
        }
        let mut refuse = |what: &str, wrong: fn(&f64) -> bool| {
            let mut found = values.iter().enumerate().filter(|(_, x)| wrong(x));
            let Some((first, x)) = found.next() else { return };
            let place = if fits { axes.place(first) } else { format!("element {first}") };
            let count = 1 + found.count();
            note(format!("{count} of {} numbers {what}; the first is {x}, at {place}", values.len()));
        };
        refuse("are not finite", |x| !x.is_finite());
        refuse("are negative", |x| *x < 0.0);
        let is_wrong = |x: &f64| !(x.is_finite() && *x >= 0.0);
        let any_is_wrong = values.iter().any(is_wrong);
        if !axes_are_right || !fits || is_too_large {
            return Err(faults);
        }
        values.iter_mut().filter(|x| is_wrong(x)).for_each(|x| *x = 0.0);
        let grid = Self::of_checked(axes, values);
        faults.extend(grid.energy_faults(any_is_wrong));
        if faults.is_empty() { Ok(grid) } else { Err(faults) }
    }

    /// Views for which it reflects too much, or nothing; too much alone if some of its values were wrong.
    fn energy_faults(&self, any_was_wrong: bool) -> Vec<TabulatedFault> {
        let views = self.axes().theta_o.len();
        let place = |node: usize| {
            let theta = format!("theta_o {:.4}", self.axes().theta_o[node % views]);
            let alpha = self.axes().alpha.get(node / views);
            alpha.map_or(theta.clone(), |alpha| format!("alpha {alpha:.4}, {theta}"))
        };
        let mut faults = Vec::new();
        let mut note = |detail: String| faults.push(TabulatedFault { tensor: "value", detail });
        let albedos = self.albedos();
        let too_bright = |x: &f64| x.is_nan() || *x > MOST_ALBEDO;
        let count = albedos.iter().filter(|x| too_bright(x)).count();
        let most = albedos.iter().enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b));
        if let Some((node, albedo)) = most.filter(|_| count > 0) {
            let place = place(node);
            note(format!(
                "{count} of {} views reflect more than {MOST_ALBEDO} of even light; the most is {albedo:.4}, at {place}",
                albedos.len()
            ));
        }
        if let Some(node) = albedos.iter().position(|x| *x < LEAST_ALBEDO).filter(|_| !any_was_wrong) {
            let place = place(node);
            note(format!("nothing is reflected at {place}; end the axis before it, or give it a value"));
        }
        faults
    }
}

fn shape(lengths: [usize; 4]) -> String {
    lengths.map(|n| n.to_string()).join(" x ")
}
