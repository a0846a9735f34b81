//! Tests of planted polynomials and of rejected tables.

use super::{
    planted::{planted, wanted},
    *,
};

#[test]
fn planted_polynomials_are_found() {
    let found = IsotropicFunction::of(&planted(Layout::Reflected)).expect("a function");
    for alpha in [0.0, 0.003, 0.2, 0.55, 1.0] {
        for theta in [0.0, 0.4, 1.1, 1.5] {
            for (found, wanted) in found.numbers(alpha, theta).into_iter().zip(wanted(alpha, theta)) {
                // The value is the sum of a hundred terms, and each coefficient has a rounding error of up to half a
                // step.
                assert!((found - wanted).abs() < 2e-3, "{alpha} {theta}: {found} {wanted}");
            }
        }
    }
}

#[test]
fn below_the_floor_function_and_table_have_the_lobe_of_the_floor() {
    let table = planted(Layout::Reflected);
    let function = IsotropicFunction::of(&table).expect("a function");
    let at = |alpha| Configuration { alpha_x: alpha, alpha_y: alpha, theta: 0.9, phi: 0.4 };
    for alpha in [0.0, 1e-5, 5e-5] {
        assert_eq!(function.lobe(&at(alpha)), function.lobe(&at(ALPHA_FLOOR)), "{alpha}");
        assert_eq!(table.lookup(&at(alpha)), table.lookup(&at(ALPHA_FLOOR)), "{alpha}");
    }
}

#[test]
fn the_measured_table_is_the_function() {
    let source = planted(Layout::Reflected);
    let found = IsotropicFunction::of(&source).expect("a function");
    let table = found.table(&source);
    assert_eq!((table.layout(), table.axes().lengths().alpha), (Layout::Reflected, 128));
    let (at, numbers) = (table.axes().node(64 * 128 + 50), table.smooth_numbers()[64 * 128 + 50]);
    for (one, other) in found.numbers(at.alpha, at.theta).into_iter().zip(numbers) {
        assert!((one - other).abs() < 1e-5, "{one} {other}");
    }
}

#[test]
fn tables_that_are_no_function_are_refused_by_name() {
    let error = IsotropicFunction::of(&planted(Layout::Ltc2017)).expect_err("chosen numbers").to_string();
    assert!(error.contains("layout ltc2017") && error.contains(r#""layout": "reflected""#), "{error}");
    let sheen = Table { brdf: BrdfKind::Charlie.into(), ..planted(Layout::Kt2022) };
    assert_eq!(IsotropicFunction::of(&sheen), Err(FunctionError::Reflection { brdf: BrdfKind::Charlie }));
    let mut table = planted(Layout::Reflected);
    table.terms = None;
    assert_eq!(IsotropicFunction::of(&table), Err(FunctionError::NoTerms));
    let mut table = planted(Layout::Reflected);
    table.matrix[5] = [f32::NAN; 9];
    assert_eq!(IsotropicFunction::of(&table), Err(FunctionError::Entry { entry: 5 }));
    let ranges = PerAxis { alpha: [0.0, 1.0], ratio: [0.0, 1.0], theta: [0.0, 1.5], phi: [0.0, 1.5] };
    for (resolution, message) in [
        (PerAxis { alpha: 32, ratio: 2, theta: 32, phi: 3 }, "2 ratios and 3 phi; it must have only ratio 1"),
        (PerAxis { alpha: 31, ratio: 1, theta: 32, phi: 1 }, "31 nodes of alpha; allowed: at least 32"),
        (PerAxis { alpha: 32, ratio: 1, theta: 3, phi: 1 }, "3 nodes of theta"),
    ] {
        let mut axes = Layout::Reflected.nodes(&ranges, &resolution);
        if resolution.ratio == 1 {
            (axes.ratio, axes.phi) = (vec![1.0], vec![0.0]);
        }
        let entries = axes.lengths().named().iter().map(|(_, n)| **n).product::<usize>();
        let numbers = vec![wanted(0.5, 0.5); entries];
        let table = Table::of_smooth_numbers((BrdfKind::Ggx, LobeModel::Ltc, Layout::Reflected), axes, &numbers, true);
        let error = IsotropicFunction::of(&table).expect_err(message).to_string();
        assert!(error.contains(message), "{error}");
    }
}
