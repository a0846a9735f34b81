//! A table returns usable matrices even for degenerate lobes.

use std::{f64::consts::FRAC_PI_2, ops::ControlFlow, sync::LazyLock};

use glam::{DMat3, DVec3, Mat3};
use ltcforge::{
    files::recipe_document,
    fit::{Configuration, Corner, Plan, Table, assemble, extremes, fit_shard},
};
use proptest::prelude::*;
use rayon::prelude::*;

/// The tolerance for the change of an LTC by f32 arithmetic, in radians.
const INVERSION: f64 = 1e-3;
/// The largest jump at a fold, in widths of the lobe. It comes from f64 rounding.
const JUMP: f64 = 1e-9;

fn fitted(recipe: &str) -> Table {
    let plan = Plan::new(&recipe_document::parse(recipe.as_bytes(), 10_000).expect("a recipe"));
    let fit = |shard| fit_shard(&plan, shard, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
    let entries: Vec<_> = (0..plan.shards()).into_par_iter().flat_map_iter(fit).collect();
    assemble(&plan, &entries)
}

/// The default table in f32 and in half floats, and a table in the paper's layout.
static TABLES: LazyLock<[(&str, Table); 4]> = LazyLock::new(|| {
    [
        r#"{"preset": "draft"}"#,
        r#"{"preset": "draft", "precision": "f16"}"#,
        r#"{"preset": "draft", "layout": "kt2022"}"#,
        r#"{"preset": "draft", "layout": "kt2022", "precision": "f16"}"#,
    ]
    .map(|recipe| (recipe, fitted(recipe)))
});

#[test]
fn every_corner_is_upright_continuous_and_can_be_inverted_in_f32() {
    for (name, table) in TABLES.iter() {
        let corners = extremes(table);
        assert_eq!(corners.len(), 120);
        for corner in corners {
            let Corner { broken, jump, inversion, .. } = corner;
            assert!(broken == 0 && jump < JUMP && inversion < INVERSION, "{name} {corner:?}");
        }
    }
}

/// A value at which tables are hardest, moved by a few ulps, or any other value.
fn hard(values: &'static [f64], high: f64) -> impl Strategy<Value = f64> {
    let near = (prop::sample::select(values), -3_i64..=3)
        .prop_map(move |(x, ulps)| f64::from_bits(x.to_bits().saturating_add_signed(ulps)).clamp(0.0, high));
    prop_oneof![near, 0.0..high]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn any_configuration_gets_a_matrix_that_f32_can_invert(
        alpha in hard(&[0.0, 1e-8, 1e-5, 1e-4, 1e-3, 1.0], 1.0),
        ratio in hard(&[0.0, 1e-6, 1e-3, 1.0], 1.0),
        theta in hard(&[0.0, 1e-9, 1.569_796_326_794_896_6, 1.570_796_325_794_896_7, FRAC_PI_2], FRAC_PI_2),
        phi in hard(&[0.0, FRAC_PI_2, 2.0 * FRAC_PI_2, 3.0 * FRAC_PI_2, 4.0 * FRAC_PI_2], 7.0),
        swap in any::<bool>(),
    ) {
        let (alpha_x, alpha_y) = if swap { (alpha * ratio, alpha) } else { (alpha, alpha * ratio) };
        for (name, table) in TABLES.iter() {
            let found = table.lookup(&Configuration { alpha_x, alpha_y, theta, phi });
            let m = DMat3::from_cols_array(&found.matrix).transpose();
            prop_assert!(m.is_finite() && m.determinant() > 0.0, "{} {:?}", name, m);
            let (amplitude, fresnel) = (found.amplitude.expect("terms"), found.fresnel.expect("terms"));
            prop_assert!((0.0..1.1).contains(&amplitude) && (0.0..=amplitude).contains(&fresnel), "{} {:?}", name, found);
            let inverse: Mat3 = m.as_mat3().inverse();
            let back = inverse.as_dmat3().inverse();
            let moved = |c: DVec3| ((m * c).normalize() - (back * c).normalize()).length();
            let samples = [(0.1, 0.0), (0.5, 1.0), (0.7, 2.0), (0.9, 3.0), (0.95, 4.5), (0.99, 5.5)];
            let mean = samples.map(|(r, p): (f64, f64)| moved(DVec3::new(r * p.cos(), r * p.sin(), (1.0 - r * r).sqrt())));
            prop_assert!(mean.iter().sum::<f64>() / 6.0 < INVERSION, "{} {:?}", name, mean);
        }
    }
}
