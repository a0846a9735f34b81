use std::f64::consts::{FRAC_PI_2, PI};

use proptest::prelude::*;

use super::*;
use glam::DMat3;

use crate::{
    brdf::BrdfKind,
    layout::{Layout, Reflection},
    lobe::LobeModel,
    table::Terms,
};

/// A table of 3 x 2 x 3 x 3 entries whose numbers are linear in the values of the node. Interpolation must be exact.
fn linear() -> Table {
    let axes = PerAxis {
        alpha: vec![0.1, 0.4, 1.0],
        ratio: vec![0.2, 1.0],
        theta: vec![0.0, 0.5, 1.5],
        phi: vec![0.0, 0.75, FRAC_PI_2],
    };
    let mut table = Table {
        brdf: BrdfKind::Ggx.into(),
        lobe: LobeModel::Ltc,
        layout: Layout::Kt2022,
        axes: axes.clone(),
        matrix: vec![],
        terms: Some(Terms { amplitude: vec![], fresnel: vec![], edge: None }),
        second: None,
        node_error: vec![],
    };
    let terms = table.terms.as_mut().expect("terms");
    for a in &axes.alpha {
        for r in &axes.ratio {
            for t in &axes.theta {
                for p in &axes.phi {
                    table.matrix.push(matrix(*a, *r, *t, *p).map(|x| x as f32));
                    terms.amplitude.push((0.5 + 0.1 * t) as f32);
                    terms.fresnel.push((0.25 * a) as f32);
                    table.node_error.push(0.0);
                }
            }
        }
    }
    table
}

fn matrix(a: f64, r: f64, t: f64, p: f64) -> [f64; 9] {
    [1.0 + a, 0.1 * p, 0.2 * t, 0.05 * r, 1.0 + r, 0.3 * p, 0.1 * a, 0.2 * p, 1.0 + t]
}

/// A bound for the rounding error of a number of order one in f32.
const F32: f64 = 3e-7;

fn close(a: [f64; 9], b: [f64; 9]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < F32)
}

fn at(alpha_x: f64, alpha_y: f64, theta: f64, phi: f64) -> LookedUp {
    linear().lookup(&Configuration { alpha_x, alpha_y, theta, phi })
}

proptest! {
    #[test]
    fn between_nodes_weights_are_linear(a in 0.1..1.0, r in 0.2..1.0, t in 0.0..1.5, p in 0.0..FRAC_PI_2) {
        let found = at(a, a * r, t, p);
        prop_assert!(close(found.matrix, matrix(a, r, t, p)), "{:?}", found);
        prop_assert!((found.amplitude.expect("terms") - (0.5 + 0.1 * t)).abs() < F32);
        prop_assert!((found.fresnel.expect("terms") - 0.25 * a).abs() < F32);
    }

    #[test]
    fn outside_the_nodes_the_nearest_configuration_answers(a in 0.0..1.0, r in 0.0..1.0, t in 0.0..FRAC_PI_2) {
        let found = at(a, a * r, t, 0.3);
        prop_assert!(close(found.matrix, matrix(f64::max(a, 0.1), f64::max(r, 0.2), f64::min(t, 1.5), 0.3)), "{:?}", found);
    }

    /// Equations 13 and 15 of KT et al. 2022, with the mirror or swap on both sides.
    #[test]
    fn quadrants_and_swapped_roughness_are_mirrors(a in 0.1..1.0, r in 0.2..0.99, t in 0.0..1.5, p in 0.0..FRAC_PI_2) {
        let [xx, xy, xz, yx, yy, yz, zx, zy, zz] = at(a, a * r, t, p).matrix;
        let mirror_x = [xx, -xy, -xz, -yx, yy, yz, -zx, zy, zz];
        let mirror_y = [xx, -xy, xz, -yx, yy, -yz, zx, -zy, zz];
        let both = [xx, xy, -xz, yx, yy, -yz, -zx, -zy, zz];
        let swapped = [yy, yx, yz, xy, xx, xz, zy, zx, zz];
        prop_assert!(close(at(a, a * r, t, PI - p).matrix, mirror_x));
        prop_assert!(close(at(a, a * r, t, PI + p).matrix, both));
        prop_assert!(close(at(a, a * r, t, 2.0 * PI - p).matrix, mirror_y));
        prop_assert!(close(at(a, a * r, t, -p).matrix, mirror_y));
        prop_assert!(close(at(a, a * r, t, p + 6.0 * PI).matrix, at(a, a * r, t, p).matrix));
        prop_assert!(close(at(a * r, a, t, FRAC_PI_2 - p).matrix, swapped));
    }
}

#[test]
fn on_a_node_the_stored_entry_answers_exactly() {
    let table = linear();
    for (index, stored) in table.matrix.iter().enumerate() {
        let (a, r) = (table.axes.alpha[index / 18], table.axes.ratio[index / 9 % 2]);
        // The lookup finds a ratio of 1 exactly. It finds 0.2 exactly only if a * 0.2 / a equals 0.2.
        if a * r / a == r {
            let phi = table.axes.phi[index % 3];
            let found = at(a, a * r, table.axes.theta[index / 3 % 3], phi);
            assert_eq!(found.matrix, stored.map(f64::from), "{index}");
        }
    }
}

#[test]
fn a_perfect_mirror_is_isotropic() {
    assert!(close(at(0.0, 0.0, 0.5, 0.0).matrix, matrix(0.1, 1.0, 0.5, 0.0)));
}

#[test]
fn an_isotropic_table_turns_with_the_view() {
    let stored = [0.5, 0.0, -0.4, 0.0, 0.3, 0.0, 0.2, 0.0, 1.0];
    let table = Table {
        brdf: BrdfKind::Ggx.into(),
        lobe: LobeModel::Ltc,
        layout: Layout::Kt2022,
        axes: PerAxis { alpha: vec![0.5], ratio: vec![1.0], theta: vec![0.7], phi: vec![0.0] },
        matrix: vec![stored.map(|x| x as f32)],
        terms: None,
        second: None,
        node_error: vec![0.0],
    };
    let m = from_row_major(&stored);
    for phi in [0.0, 0.4, FRAC_PI_2, 2.0, PI, 4.0, 5.5, -0.3] {
        let found = table.lookup(&Configuration { alpha_x: 0.5, alpha_y: 0.5, theta: 0.7, phi });
        // Both are equal up to a rotation about z, which changes neither the third column nor M M^T.
        let (found, wanted) = (from_row_major(&found.matrix), turned_about_z(m, phi));
        assert!((found.z_axis - wanted.z_axis).length() < F32, "{phi}: {found} {wanted}");
        let square = |m: glam::DMat3| m * m.transpose();
        assert!(square(found).abs_diff_eq(square(wanted), 1e-6), "{phi}: {found} {wanted}");
    }
}

/// A table of layout `reflected` with the same matrix in every entry, and with the terms of the reflection.
fn reflections(axes: PerAxis<Vec<f64>>, matrix: [f32; 9]) -> Table {
    let entries = axes.named().iter().map(|(_, nodes)| nodes.len()).product();
    Table {
        brdf: BrdfKind::Ggx.into(),
        lobe: LobeModel::Ltc,
        layout: Layout::Reflected,
        axes,
        matrix: vec![matrix; entries],
        terms: Some(Terms { amplitude: vec![1.0; entries], fresnel: vec![0.0; entries], edge: None }),
        second: None,
        node_error: vec![0.0; entries],
    }
}

const IDENTITY: [f32; 9] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

proptest! {
    #[test]
    fn a_reflected_table_starts_from_the_reflection_at_the_very_place(
        a in 0.1..1.0, r in 0.2..1.0, t in 0.0..1.5, p in 0.0..FRAC_PI_2,
    ) {
        let found = reflections(linear().axes, IDENTITY).lookup(&Configuration { alpha_x: a, alpha_y: a * r, theta: t, phi: p });
        let place = PerAxis { alpha: a, ratio: r, theta: t, phi: p };
        let reflection = Reflection::at(&place);
        prop_assert!(close(found.matrix, row_major(&reflection.matrix)), "{:?}", found);
        prop_assert!((found.amplitude.expect("terms") - reflection.amplitude).abs() < F32);
        prop_assert!((found.fresnel.expect("terms") - reflection.amplitude * reflection.grazing.powi(5)).abs() < F32);
    }

    /// Outside of its ranges a table returns the result of the nearest configuration inside, including its reflection.
    /// Surfaces with roughness below 1e-4 would get a different ratio, because both roughnesses are first raised to
    /// 1e-5.
    #[test]
    fn outside_its_nodes_a_reflected_table_answers_as_at_their_end(a in 1e-4..0.1, r in 0.0..0.2, t in 1.5..FRAC_PI_2) {
        let table = reflections(linear().axes, IDENTITY);
        let at = |a: f64, r: f64, t: f64| table.lookup(&Configuration { alpha_x: a, alpha_y: a * r, theta: t, phi: 0.3 });
        prop_assert!(close(at(a, r, t).matrix, at(0.1, 0.2, 1.5).matrix));
    }
}

#[test]
fn a_reflected_isotropic_table_turns_with_the_view() {
    let axes = PerAxis { alpha: vec![0.5], ratio: vec![1.0], theta: vec![0.7], phi: vec![0.0] };
    let table = reflections(axes, [0.9, 0.0, 0.1, 0.0, 1.1, 0.0, 0.2, 0.0, 1.0]);
    let at = |phi: f64| table.lookup(&Configuration { alpha_x: 0.5, alpha_y: 0.5, theta: 0.7, phi });
    let m = from_row_major(&at(0.0).matrix);
    for phi in [0.4, FRAC_PI_2, 2.0, 5.5] {
        let square = |m: DMat3| m * m.transpose();
        let found = from_row_major(&at(phi).matrix);
        assert!(square(found).abs_diff_eq(square(turned_about_z(m, phi)), 1e-12), "{phi}: {found}");
    }
}

/// The lookup of an engine's sampler and shader in a table of 5 x 4 texels. Texel centres are at i / (n - 1). The
/// stored numbers are interpolated bilinearly, then inverted if the layout stores an inverse.
fn as_an_engine_samples(table: &Table, stores_inverse: bool, [u, v]: [f64; 2]) -> DMat3 {
    let (x, y) = (u * 4.0, v * 3.0);
    let (i, j) = ((x as usize).min(3), (y as usize).min(2));
    let texel = |i: usize, j: usize| from_row_major(&table.matrix[i * 4 + j].map(f64::from));
    let (s, t) = (x - i as f64, y - j as f64);
    let near = texel(i, j) * (1.0 - t) + texel(i, j + 1) * t;
    let far = texel(i + 1, j) * (1.0 - t) + texel(i + 1, j + 1) * t;
    let sampled = near * (1.0 - s) + far * s;
    if stores_inverse { sampled.inverse() } else { sampled }
}

/// An isotropic table of 5 x 4 entries that do not vary smoothly.
fn of_engines(layout: Layout) -> Table {
    let ranges = layout.only_ranges().expect("the layout has one domain");
    let axes = layout.nodes(&ranges, &PerAxis { alpha: 5, ratio: 1, theta: 4, phi: 1 });
    let number = |entry: usize, k: usize| ((entry * 7 + k * 3) % 11) as f32 / 11.0;
    let matrix = |e: usize| {
        [0.5 + number(e, 0), 0.0, number(e, 1), 0.0, 0.5 + number(e, 2), 0.0, -number(e, 3), 0.0, 0.5 + number(e, 4)]
    };
    Table {
        brdf: BrdfKind::Ggx.into(),
        lobe: LobeModel::Ltc,
        layout,
        axes,
        matrix: (0..20).map(matrix).collect(),
        terms: None,
        second: None,
        node_error: vec![0.0; 20],
    }
}

proptest! {
    /// Tests roughnesses from the smallest value that a lookup does not raise.
    #[test]
    fn isotropic_layouts_are_what_engines_sample(u in 0.004..=1.0, v in 0.0..=1.0, phi in 0.0..=FRAC_PI_2) {
        for (layout, stores_inverse, theta) in [
            (Layout::Ltc2017, true, f64::acos(1.0 - v * v)),
            (Layout::Ltc2016, true, v * FRAC_PI_2),
            (Layout::Godot, false, v * FRAC_PI_2),
            (Layout::Hdrp, true, f64::acos(1.0 - v * v)),
            (Layout::Inverse, true, f64::acos(1.0 - v * v)),
            (Layout::Matrix33, false, f64::acos(1.0 - v * v)),
        ] {
            let table = of_engines(layout);
            let found = table.lookup(&Configuration { alpha_x: u * u, alpha_y: u * u, theta, phi });
            let wanted = turned_about_z(as_an_engine_samples(&table, stores_inverse, [u, v]), phi);
            // The matrices are equal up to scale and, since the view turns, up to a rotation about z.
            let canonical = |m: DMat3| m * m.transpose() * (1.0 / m.z_axis.length_squared());
            let (found, wanted) = (canonical(from_row_major(&found.matrix)), canonical(wanted));
            // acos loses half of the digits near the normal.
            prop_assert!(found.abs_diff_eq(wanted, 1e-5), "{layout} {found} {wanted}");
        }
    }
}
