//! The bytes of compact forms, predicted from the coarse table.
//!
//! We encode it, and for each axis the table with every
//! second node along this axis. The two sizes give the growth of the bytes with the number of nodes on this axis, as a
//! power. Powers of different axes multiply.

use crate::curve::coarser;
use ltcforge_files::compact;
use ltcforge_fit::{
    Layout, Recipe, Table,
    math::{ln, pow},
};

/// The bytes of a second lobe's form, divided by the bytes of the first lobe's form. For the default table, the forms
/// have 9,760 and 14,105 bytes.
const SECOND: f64 = 0.69;

/// Predicts the bytes of compact forms.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ShippedBytes {
    of_base: f64,
    nodes: [u32; 4],
    powers: [f64; 4],
}

impl ShippedBytes {
    /// Encodes the coarse table with all of its nodes, and with every second node along each axis in turn; `None` if
    /// it has no compact form. Domain: an odd number of nodes on each axis.
    pub(crate) fn of(table: &Table, base: &Recipe) -> Option<Self> {
        let bytes = |table: &Table| compact::encode(table).ok().map(|bytes| bytes.len() as f64);
        let of_base = bytes(table)?;
        let nodes = base.resolution.named().map(|(_, n)| *n);
        let mut powers = [0.0; 4];
        for (axis, power) in powers.iter_mut().enumerate().filter(|(axis, _)| nodes[*axis] > 2) {
            let half = nodes[axis].div_ceil(2);
            let of_half = bytes(&coarser(table, base, axis, half))?;
            *power = (ln(of_base / of_half) / ln(f64::from(nodes[axis]) / f64::from(half))).max(0.0);
        }
        Some(Self { of_base, nodes, powers })
    }

    /// The bytes of the compact form of a recipe's table. Domain: evenly spaced nodes over the ranges of the coarse
    /// table.
    pub(crate) fn bytes(&self, recipe: &Recipe) -> u64 {
        let resolution = recipe.resolution.named().map(|(_, n)| *n);
        let grown =
            (0..4).map(|axis| pow(f64::from(resolution[axis]) / f64::from(self.nodes[axis]), self.powers[axis]));
        let second = if recipe.brdf.fresnel().second().is_some() { SECOND } else { 0.0 };
        (self.of_base * (1.0 + second) * grown.product::<f64>()).ceil() as u64
    }
}

/// Encodes a table and decodes the compact form. Returns the decoded table and the bytes of the form; `None` if the
/// table has no compact form.
pub(crate) fn shipped(table: &Table) -> Option<(Table, u64)> {
    let forms = compact::encode_lobes(table).ok()?;
    let decoded: Option<Vec<Table>> = forms.iter().map(|form| compact::decode(&form.bytes).ok()).collect();
    let mut decoded = decoded?.into_iter();
    let first = decoded.next()?;
    let second = decoded.next().map(|second| second.matrix);
    let bytes = forms.iter().map(|form| form.bytes.len() as u64).sum();
    Some((Table { brdf: table.brdf.clone(), second, ..first }, bytes))
}

/// Whether tables of a layout have a compact form.
pub(crate) fn has_form(layout: Layout) -> bool {
    compact::LAYOUTS.contains(&layout)
}

#[cfg(test)]
mod tests {
    use crate::{Budget, Form, GpuLimit, Needs, Scene, TablePlan, tests::isotropic};
    use ltcforge_fit::{Plan, fit_plan};
    use std::ops::ControlFlow;

    /// The encoded table keeps the budget.
    #[test]
    fn a_table_to_ship_is_within_its_bytes_and_finer_than_one_that_is_not_encoded() {
        let list = br#"{"materials": [{"alpha_x": 0.04, "alpha_y": 0.04}, {"alpha_x": 0.25, "alpha_y": 0.25}, {"alpha_x": 0.6, "alpha_y": 0.6}]}"#;
        let scene = Scene::from_list(list).expect("a scene");
        let needs = Needs::of(&scene, false).expect("lobes");
        let form = Form { ship: true, ..Form::default() };
        let mut plan = TablePlan::new(needs, Budget::Bytes(400), form, &|| true).expect("nothing stops it");
        let plain = isotropic().within(Budget::Bytes(400), GpuLimit::default());
        assert!(plan.is_met && plan.chosen.error < plain.chosen.error, "{:?} {:?}", plan.chosen, plain.chosen);
        let fitted = |plan: &TablePlan<'_>| {
            fit_plan(&Plan::new(&plan.chosen.recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it")
        };
        plan.measure(&fitted(&plan), None, None);
        if !plan.is_measured() {
            plan.measure(&fitted(&plan), None, None);
        }
        let last = plan.fitted.last().expect("it was fitted");
        println!("{:?} predicted {:?}", plan.fitted, plan.chosen);
        assert!(plan.is_met && last.shipped.is_some_and(|bytes| bytes <= 400), "{last:?}");
        assert!(last.error < plain.chosen.error, "{} {}", last.error, plain.chosen.error);
    }
}
