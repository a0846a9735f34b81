//! Planted tables, and hostile bytes.

use std::ops::ControlFlow;

use proptest::prelude::*;

use super::{
    planted::{planted, recipe, unmeasured},
    *,
};
use crate::{digest::Digest, recipe_document};
use ltcforge_fit::{Layout, Plan, Recipe, fit_plan};

/// The error of a Fresnel term below which its stored root does not matter.
const UNSEEN_TERM: f32 = 1e-4;

/// The largest difference of each channel, in steps. At the horizon the layouts of engines bound their numbers, so they
/// differ from the planted numbers.
fn misses(one: &Table, other: &Table) -> [f64; CHANNELS] {
    let rounding = Rounding::of(one);
    let is_bounded = |entry: usize| one.layout() != Layout::Reflected && one.axes().node(entry).theta >= 1.57;
    let kept: Vec<usize> = (0..one.matrices().len()).filter(|entry| !is_bounded(*entry)).collect();
    let is_unseen = |channel: usize, entry: usize| {
        let fresnel = |table: &Table| table.terms().map_or(0.0, |terms| terms.fresnel()[entry]);
        channel == TERMS[1] && (fresnel(one) - fresnel(other)).abs() < UNSEEN_TERM
    };
    let numbers = [one, other].map(Table::smooth_numbers);
    std::array::from_fn(|channel| {
        let seen = kept.iter().filter(|entry| !is_unseen(channel, **entry));
        let worst = seen.map(|i| (numbers[0][*i][channel] - numbers[1][*i][channel]).abs()).fold(0.0, f64::max);
        worst / rounding.step(channel)
    })
}

#[test]
fn smooth_tables_of_every_layout_come_back_in_few_bytes() {
    for layout in &LAYOUTS {
        for has_terms in [true, false] {
            let table = planted(*layout, [12, 5, 9, 6], has_terms, |_, _| 0.0);
            let bytes = unmeasured(&table);
            let again = decode(&bytes).expect("a table");
            assert_eq!((again.layout(), again.brdf(), again.lobe()), (table.layout(), table.brdf(), table.lobe()));
            assert_eq!(again.axes(), table.axes());
            assert_eq!(again.terms().is_some(), has_terms);
            assert!(again.node_error().iter().all(|error| error.is_nan()));
            let misses = misses(&table, &again);
            // The bound covers uncorrected errors, and the rounding to 32 bits of a matrix that is nearly singular at
            // the horizon.
            let most = if *layout == Layout::Reflected { 4.1 } else { 6.0 };
            assert!(misses.iter().all(|miss| *miss < most), "{layout}: {misses:?}");
            assert!(bytes.len() < 1500, "{layout}: {} bytes", bytes.len());
            assert_eq!(unmeasured(&table), bytes, "{layout}");
        }
    }
}

/// Corrections store an edge, which the polynomials would miss by half its height.
#[test]
fn an_edge_costs_bytes_and_not_accuracy() {
    let edge = |channel, place: [f64; 4]| if channel == 0 && place[0] > 0.97 && place[2] < 0.5 { 0.5 } else { 0.0 };
    let table = planted(Layout::Ltc2017, [64, 1, 64, 1], true, edge);
    let bytes = unmeasured(&table);
    let misses = misses(&table, &decode(&bytes).expect("a table"));
    assert!(misses.iter().all(|miss| *miss < 4.5), "{misses:?}");
}

/// A change in the bytes needs a new version, the last byte of [`COMPACT_MAGIC`].
#[test]
fn bytes_and_decoded_numbers_are_pinned() {
    let wave = |channel: usize, place: [f64; 4]| 0.02 * (channel as f64) * place[0] * (place[2] - 0.5) * place[3];
    let bytes = unmeasured(&planted(Layout::Reflected, [6, 4, 5, 5], true, wave));
    let table = decode(&bytes).expect("a table");
    let numbers: Vec<u8> = table.matrices().iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    assert_eq!(
        [Digest::of(&bytes).hex()[..16].to_owned(), Digest::of(&numbers).hex()[..16].to_owned()],
        ["84c5aa48e15d0d37", "328afb3542d6270f"],
        "{} bytes",
        bytes.len()
    );
}

#[test]
fn each_fault_of_a_table_is_named() {
    let error = encode(&planted(Layout::Hdrp, [4, 1, 4, 1], true, |_, _| 0.0)).expect_err("no such form").to_string();
    assert!(error.starts_with("layout hdrp has no compact form") && error.ends_with("ltc2017 have one"), "{error}");
    let mut table = planted(Layout::Reflected, [4, 3, 4, 3], true, |_, _| 0.0);
    table.axes.theta[1] += 1e-9;
    let error = encode(&table).expect_err("other nodes").to_string();
    assert!(error.starts_with("the nodes of theta are not those of layout reflected from 0 to 1.57"), "{error}");
    let mut table = planted(Layout::Reflected, [4, 3, 4, 3], true, |_, _| 0.0);
    table.matrix[7][0] = f32::NAN;
    assert_eq!(encode(&table), Err(CompactError::Entry { entry: 7 }));
}

/// The published table has matrices with a negative determinant. Their distributions are right, but they reverse the
/// order of a light's vertices.
#[test]
fn matrices_that_are_not_upright_are_counted_and_named() {
    let mut table = planted(Layout::Kt2022, [4, 3, 4, 3], true, |_, _| 0.0);
    for entry in [41, 7, 100] {
        table.matrix[entry] = table.matrix[entry].map(|x| -x);
    }
    table.matrix[9] = [0.0; 9];
    let error = encode(&table).expect_err("no upright matrix").to_string();
    assert!(error.starts_with("4 entries have matrices whose determinant is not positive"), "{error}");
    assert!(error.ends_with("the first is entry 7, alpha 0.0001, ratio 0.0001, theta 1.0471, phi 0.7854"), "{error}");
}

/// The mean error between nodes at this many places.
fn error(table: &Table) -> f64 {
    width_between(table, MEASURED_AT).mean
}

/// Fits a table with the settings of a preset.
fn fitted(preset: &str, layout: Layout, nodes: [u32; 4]) -> Table {
    let Recipe { resolution, range, .. } = recipe(layout, nodes);
    let document = serde_json::json!({ "preset": preset, "layout": layout, "resolution": resolution, "range": range });
    let document = document.to_string();
    let recipe = recipe_document::parse(document.as_bytes(), u64::MAX).expect("a recipe");
    fit_plan(&Plan::new(&recipe), &|_| ControlFlow::Continue(())).expect("a table")
}

/// Few nodes need finer steps than 64 x 64 nodes. The lengths of whole tables are tested where they are fitted anyway,
/// in `tests/engines`.
#[test]
fn no_table_becomes_worse_by_more_than_a_hundredth() {
    for (preset, layout, nodes, most_bytes) in [
        ("standard", Layout::Ltc2017, [16, 1, 16, 1], 1_600),
        ("standard", Layout::Ltc2017, [32, 1, 32, 1], 3_000),
        ("draft", Layout::Kt2022, [6, 4, 6, 4], 6_000),
    ] {
        let table = fitted(preset, layout, nodes);
        let Encoded { bytes, table: before, decoded: after } = encode_measured(&table).expect("bytes");
        let again = decode(&bytes).expect("a table");
        assert_eq!(after.mean, error(&again), "{layout} {nodes:?}");
        assert!(after.mean <= 1.01 * before.mean, "{layout} {nodes:?}: {before:?} {after:?}");
        assert!(bytes.len() <= most_bytes, "{layout} {nodes:?}: {} bytes", bytes.len());
    }
}

fn valid() -> Vec<u8> {
    unmeasured(&planted(Layout::Reflected, [4, 3, 5, 3], true, |_, _| 0.0))
}

#[test]
fn each_fault_of_the_header_is_named() {
    let names = 8 + 4 + 4 + 10;
    let horizon = std::f64::consts::FRAC_PI_2.to_le_bytes();
    let cases: [(usize, &[u8], &str); 15] = [
        (7, b"2", "not a compact table of version 1"),
        (9, b"x", r#"brdf is "xgx"; allowed: ggx"#),
        (17, b"K", "layout is "),
        (17, b"kt2016xyz", "allowed: reflected, kt2022, ltc2017"),
        (names, &[0, 0], "nodes of alpha is 0; allowed: 1 to 16384"),
        (names, &[0xff, 0x3f], "entries is 16383 x 3 x 5 x 3"),
        (names + 2, &[5], "polynomials of alpha is 5; allowed: 1 to 4"),
        (names + 2, &[0], "polynomials of alpha is 0"),
        (names + 3, &[0xff; 8], "range of alpha is NaN to 1"),
        (names + 3 * 19 - 8, &horizon, "the nodes of theta are not those of layout reflected from 0 to 1.57"),
        (names + 76, &[0xff, 0xff], "channels is 0b1111111111111111"),
        (names + 78, &[0, 2], "corrected channels is "),
        (names + 80, &[0, 0, 0, 0], "steps of corrections is 0; allowed: 0.001 to 64"),
        (names + 80, &[0xff; 4], "steps of corrections is NaN"),
        (names + 84, &[0, 0, 0, 0], "step of channel 0 is 0; allowed: 1e-9 to 1"),
    ];
    decode(&valid()).expect("a table");
    for (at, change, said) in cases {
        let mut bytes = valid();
        // 16383 nodes of alpha times 45 are below the limit, so increase ratio.
        bytes[at..at + change.len()].copy_from_slice(change);
        if said.starts_with("entries") {
            bytes[names + 19..names + 21].copy_from_slice(&[0xff, 0x0f]);
        }
        let error = decode(&bytes).expect_err(said).to_string();
        let said = if said.starts_with("entries") { "entries is 16383 x 4095 x 5 x 3" } else { said };
        assert!(error.contains(said), "{error}");
    }
    let mut long = valid();
    long.push(0);
    assert_eq!(decode(&long), Err(CompactError::Long { bytes: 1 }));
}

proptest! {
    /// The error is within half of the correction's step, for any numbers and any lengths of the axes.
    #[test]
    fn rough_tables_come_back(
        nodes in (1_u32..6, 1_u32..5, 1_u32..7, 1_u32..5), noise in prop::collection::vec(-0.2..0.2, 97),
    ) {
        let nodes = [nodes.0 + 1, nodes.1 + 1, nodes.2 + 1, nodes.3 + 1];
        let rough = |channel: usize, place: [f64; 4]| {
            let at = place.iter().fold(channel as f64, |hash, u| hash * 7.0 + u * 31.0);
            noise[at as usize % noise.len()]
        };
        let table = planted(Layout::Reflected, nodes, true, rough);
        let again = decode(&unmeasured(&table)).expect("a table");
        let misses = misses(&table, &again);
        prop_assert!(misses.iter().all(|miss| *miss < 6.0), "{misses:?}");
    }

    #[test]
    fn hostile_bytes_give_an_error_or_a_table(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        cut in prop::option::of(any::<prop::sample::Index>()), more in prop::collection::vec(any::<u8>(), 0..64),
    ) {
        let mut bytes = valid();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        bytes.extend(more);
        if let Ok(table) = decode(&bytes) {
            prop_assert!(table.matrices().iter().flatten().all(|x| x.is_finite()));
        }
    }

    #[test]
    fn any_bytes_behind_a_header_are_survived(coded in prop::collection::vec(any::<u8>(), 0..600)) {
        let header = Header::read(&valid()).expect("a header").0.bytes();
        let _ = decode(&[header, coded].concat());
    }
}
