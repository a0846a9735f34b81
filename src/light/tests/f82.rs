//! Compares the F82 light of metals with the truth, for models and tables.

use std::ops::ControlFlow;

use rayon::prelude::*;

use crate::cases::{Draw, Lit, Roughness, over_area_of};
use crate::{LightError, LightModel, Lighting, NormalsRule, ReflectedLight, edge_truth_of, truth_of};
use glam::DVec3;
use ltcforge_fit::{
    BrdfKind, BrdfModel, FITTER_VERSION, FitSettings, GivenNodes, Layout, LobeModel, Metric, PerAxis, Plan, Precision,
    Recipe, Sides, Solver, StoredTerms, Table,
    brdf::{Brdf, BrdfSample, edge_of_parts, edge_weight},
    fit_plan,
};

/// The number of surfaces in each row.
const COUNT: usize = 600;

/// A model with the light of another model, weighted by F82's edge.
struct Edge(Box<dyn Brdf>);

impl Brdf for Edge {
    fn eval_cos(&self, wo: DVec3, wi: DVec3) -> f64 {
        self.0.eval_cos(wo, wi) * edge_weight(wo.dot((wo + wi).normalize()))
    }

    fn sample(&self, wo: DVec3, u: [f64; 2]) -> BrdfSample {
        self.0.sample(wo, u)
    }

    fn pdf(&self, wo: DVec3, wi: DVec3) -> f64 {
        self.0.pdf(wo, wi)
    }
}

/// Compares with midpoint sums over the light's area, which share no code with the truth.
#[test]
fn its_truth_is_the_sum_over_a_light() {
    for brdf in [BrdfKind::Ggx, BrdfKind::Beckmann].map(BrdfModel::from) {
        for lit in Draw::many(211, 40, Roughness::All) {
            if lit.at.alpha_x.min(lit.at.alpha_y) < 0.15 {
                continue;
            }
            let surface = Edge(brdf.surface(lit.alpha()));
            let [coarse, fine] = [70, 210].map(|n| over_area_of(&surface, &lit, n)[0]);
            let found = edge_truth_of(&brdf, 1e-9, &lit.at, &lit.light(Sides::Two)).expect("a surface");
            assert!((found - fine).abs() < (fine - coarse).abs() + 1e-6, "{brdf} {lit:?}: {found} {fine} {coarse}");
        }
    }
}

/// A table with the terms of F82.
fn table(layout: Layout, resolution: [u32; 4]) -> Table {
    let quarter = [0.0, std::f64::consts::FRAC_PI_2];
    let [alpha, ratio, theta, phi] = resolution;
    let plan = Plan::new(&Recipe {
        fitter: FITTER_VERSION,
        brdf: BrdfKind::Ggx.into(),
        lobe: LobeModel::Ltc,
        layout,
        resolution: PerAxis { alpha, ratio, theta, phi },
        range: PerAxis { alpha: [0.0, 1.0], ratio: [0.0, 1.0], theta: quarter, phi: quarter },
        fit: FitSettings {
            metric: Metric::Sw1,
            solver: Solver::Bfgs,
            samples: 192,
            directions: 8,
            steps: 30,
            seed: 0,
            simplex: None,
        },
        terms: StoredTerms::F82,
        precision: Precision::F32,
        given: GivenNodes::default(),
    });
    fit_plan(&plan, &|_| ControlFlow::Continue(())).expect("not stopped")
}

/// Mean errors of the light that metals reflect over the same lights. The first error is with the edge term of the
/// model or table. The second is with the edge term estimated from both parts of the light. The third is the error of
/// the energy alone.
fn errors(lighting: Lighting<'_>, lit: &[(Lit, ReflectedLight, f64)], metal: [f64; 2]) -> [f64; 3] {
    let error = |(lit, truth, true_edge): &(Lit, ReflectedLight, f64)| {
        let light = lit.light(Sides::Two);
        let [found, edge] = [lighting.reflected(&lit.at, &light), lighting.edge(&lit.at, &light).map(only)]
            .map(|found| found.expect("a surface"));
        let [f0, tint] = metal;
        let wanted = truth.metal(*true_edge, [f0, 1.0], tint);
        let estimated_edge = edge_of_parts([found.energy, found.fresnel]);
        let apart = [edge.energy, estimated_edge].map(|edge| (found.metal(edge, [f0, 1.0], tint) - wanted).abs());
        [apart[0], apart[1], (found.energy - truth.energy).abs()]
    };
    let sums = lit.par_iter().map(error).collect::<Vec<_>>();
    [0, 1, 2].map(|i| sums.iter().map(|error| error[i]).sum::<f64>() / lit.len() as f64)
}

fn only(energy: f64) -> ReflectedLight {
    ReflectedLight { energy, fresnel: 0.0 }
}

/// The error for a metal is at most four and a half times the error for a perfect mirror.
#[test]
fn metals_are_lit_as_well_as_mirrors() {
    let ggx = BrdfModel::from(BrdfKind::Ggx);
    let truth = |lit: Lit| {
        let light = lit.light(Sides::Two);
        let truth = truth_of(&ggx, 1e-6, &lit.at, &light).expect("a surface");
        let edge = edge_truth_of(&ggx, 1e-6, &lit.at, &light).expect("a surface");
        (lit, truth, edge)
    };
    let lit: Vec<_> = Draw::many(212, COUNT, Roughness::All).into_par_iter().map(truth).collect();
    let tables = [Layout::Reflected, Layout::Kt2022].map(|layout| table(layout, [10, 6, 9, 7]));
    let forms = NormalsRule::ALL.iter().map(|rule| {
        let form = LightModel::Normals.closed_form(Some(*rule)).expect("a formula");
        (format!("normals {rule}"), Lighting::ClosedForm(form))
    });
    let of_tables = tables.iter().map(|table| (format!("ltc {}", table.layout), Lighting::by(table)));
    for (name, lighting) in forms.chain(of_tables) {
        for metal in [[0.9, 0.5], [0.5, 0.0]] {
            let [of_metal, of_parts, of_mirror] = errors(lighting, &lit, metal);
            let [f0, tint] = metal;
            println!("{name}, F0 {f0} tint {tint}: {of_metal:.5}, by parts {of_parts:.5}, of energy {of_mirror:.5}");
            assert!(of_metal < 4.5 * of_mirror && of_metal > 1e-5, "{name} {metal:?}: {of_metal} {of_mirror}");
        }
    }
}

/// A dark metal whose F82 is negative reflects no light. Positive light stays as it is.
#[test]
fn no_metal_reflects_negative_light() {
    let form = LightModel::Normals.closed_form(None).expect("a formula");
    let mut negative = 0;
    for (i, lit) in Draw::many(214, 2000, Roughness::All).into_iter().enumerate() {
        let light = lit.light(Sides::Two);
        let parts = Lighting::ClosedForm(form).reflected(&lit.at, &light).expect("a surface");
        let edge = Lighting::ClosedForm(form).edge(&lit.at, &light).expect("a surface");
        let [f0, tint] = [i % 10, i / 10 % 10].map(|i| 0.1 * i as f64);
        let at_82 = f0 + (1.0 - f0) * (6.0_f64 / 7.0).powi(5);
        let signed = parts.schlick(f0, 1.0) - (1.0 - tint) * at_82 / edge_weight(1.0 / 7.0) * edge;
        let found = parts.metal(edge, [f0, 1.0], tint);
        assert!((found - signed.max(0.0)).abs() < 1e-12 && found >= 0.0, "{lit:?} {f0} {tint}: {found} {signed}");
        negative += usize::from(signed < -1e-3);
    }
    assert!(negative > 5, "{negative}");
}

#[test]
fn a_table_without_the_term_says_so() {
    let lit = &Draw::many(213, 1, Roughness::All)[0];
    let mut table = table(Layout::Kt2022, [2, 2, 2, 2]);
    assert!(Lighting::by(&table).edge(&lit.at, &lit.light(Sides::Two)).is_ok());
    table.terms.as_mut().expect("terms").edge = None;
    assert_eq!(Lighting::by(&table).edge(&lit.at, &lit.light(Sides::Two)), Err(LightError::NoEdge));
}
