//! The fits for the pictures.

use std::ops::ControlFlow;

use glam::{DMat3, DVec3};
use rayon::prelude::*;

use ltcforge::fit::{
    BrdfKind, FITTER_VERSION, FitSettings, Fitter, GivenNodes, Layout, LobeModel, Metric, PerAxis, Plan, Precision,
    Recipe, Shear, Simplex, Solver, Start, StopCheck, StoredTerms,
    brdf::Ggx,
    fit_rows,
    math::{direction, from_row_major},
};

/// Entries along each side of a table.
pub(super) const SIDE: u32 = 64;

/// Steps of a search that starts at the cosine. A close start needs far fewer.
const STEPS_FROM_COSINE: u32 = 200;

/// Settings with the effort of docs/recipes/isotropic-l3.json.
pub(super) fn settings(shear: Shear, start: Start) -> FitSettings {
    FitSettings {
        metric: Metric::L3,
        solver: Solver::NelderMead,
        samples: 512,
        directions: 16,
        steps: 60,
        seed: 0,
        simplex: Some(Simplex { shear, start }),
    }
}

/// A fit in the frame of its lobe's mean direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fit {
    pub(super) m11: f64,
    pub(super) m22: f64,
    pub(super) m13: f64,
    /// Angle between the mean direction and the normal, away from the view, in degrees.
    pub(super) angle: f64,
    /// `M` in the tangent frame.
    pub(super) matrix: DMat3,
}

impl Fit {
    /// The fit of a matrix with shear x. The first column has the direction of the frame's x axis.
    fn of(matrix: DMat3) -> Self {
        let x = matrix.x_axis.normalize();
        Self {
            m11: matrix.x_axis.length(),
            m22: matrix.y_axis.y,
            m13: matrix.z_axis.dot(x),
            angle: libm::atan2(x.z, x.x).to_degrees(),
            matrix,
        }
    }
}

/// Every entry of a table of layout `ltc2017` with shear x, from the smoothest surface to the roughest. For each
/// roughness, views start at the normal.
pub(super) fn table(start: Start) -> Vec<Fit> {
    let plan = plan(start);
    let fitter = Fitter::new(&plan.recipe().fit());
    let row = |row: u64| {
        let entries = fit_rows(&plan, row..row + 1, &mut fitter.another(), &mut |_| ControlFlow::Continue(()));
        entries.unwrap_or_default()
    };
    let rows: Vec<u64> = (0..plan.rows()).collect();
    let entries: Vec<_> = rows.into_par_iter().with_max_len(1).map(row).collect();
    entries.concat().iter().map(|entry| Fit::of(from_row_major(&entry.matrix))).collect()
}

/// The entries of [`table`], each found by its own search. The search starts at the cosine around the lobe's mean
/// direction. The start does not depend on the width of the lobe.
pub(super) fn table_from_cosine() -> Vec<Fit> {
    let plan = plan(Start::Independent);
    let fitter = Fitter::new(&FitSettings { steps: STEPS_FROM_COSINE, ..plan.recipe().fit() });
    let entry = |fitter: &mut Fitter, index: u64| {
        let place = plan.place(index);
        let [alpha_x, alpha_y] = place.roughness();
        let mut go_on = || ControlFlow::Continue(());
        let mut stop_check = StopCheck::new(&mut go_on);
        fitter.fit_from(&Ggx { alpha_x, alpha_y }, place.view(), DMat3::IDENTITY, &mut stop_check)
    };
    let indices: Vec<u64> = (0..plan.entries()).collect();
    let entries: Option<Vec<_>> = indices
        .into_par_iter()
        .with_max_len(16)
        .map_init(|| fitter.another(), |fitter, index| entry(fitter, index))
        .collect();
    entries.unwrap_or_default().iter().map(|entry| Fit::of(from_row_major(&entry.matrix))).collect()
}

fn plan(start: Start) -> Plan {
    let layout = Layout::Ltc2017;
    let whole =
        PerAxis { alpha: [0.0, 1.0], ratio: [1.0; 2], theta: [0.0, std::f64::consts::FRAC_PI_2], phi: [0.0; 2] };
    Plan::new(&Recipe {
        fitter: FITTER_VERSION,
        given: GivenNodes::default(),
        brdf: BrdfKind::Ggx.into(),
        lobe: LobeModel::Ltc,
        layout,
        resolution: PerAxis { alpha: SIDE, ratio: 1, theta: SIDE, phi: 1 },
        range: layout.only_ranges().unwrap_or(whole),
        fit: settings(Shear::X, start),
        terms: StoredTerms::Schlick,
        precision: Precision::F32,
    })
}

/// The matrix for one lobe of GGX.
pub(super) fn lobe(alpha: f64, theta: f64, shear: Shear) -> Option<DMat3> {
    let wo: DVec3 = direction(theta, 0.0);
    let mut go_on = || ControlFlow::Continue(());
    let mut fitter = Fitter::new(&settings(shear, Start::Independent));
    let entry = fitter.fit(&Ggx { alpha_x: alpha, alpha_y: alpha }, wo, 0, &mut StopCheck::new(&mut go_on))?;
    Some(from_row_major(&entry.matrix))
}
