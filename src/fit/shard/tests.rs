use std::ops::ControlFlow;

use super::*;
use crate::{digest::Digest, export, recipe};

fn plan(json: &str) -> Plan {
    Plan::new(&recipe::parse(json.as_bytes(), u64::MAX).expect("a recipe"))
}

fn fit_all(plan: &Plan) -> Vec<FittedEntry> {
    let fit = |shard| fit_shard(plan, shard, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
    (0..plan.shards()).flat_map(fit).collect()
}

fn table(json: &str) -> Table {
    let plan = plan(json);
    assemble(&plan, &fit_all(&plan))
}

const SMALL: &str = r#"{"preset": "draft", "resolution": {"alpha": 3, "ratio": 3, "theta": 4, "phi": 3}}"#;

#[test]
fn shards_are_a_partition_of_the_entries_in_whole_rows() {
    for json in ["{}", SMALL, r#"{"resolution": {"alpha": 2, "ratio": 2, "theta": 2, "phi": 100}}"#] {
        let plan = plan(json);
        let mut next = 0;
        for shard in 0..plan.shards() {
            let range = plan.shard_entries(shard);
            assert_eq!(range.start, next);
            assert!(range.end > range.start && (range.end - range.start) % plan.row_length() == 0);
            next = range.end;
        }
        assert_eq!(next, plan.entries());
        assert!(plan.shard_entries(plan.shards()).is_empty());
    }
}

#[test]
fn a_fit_stops_after_the_row_in_which_it_is_told_to() {
    let plan = plan(SMALL);
    let mut heard = Vec::new();
    let stopped = fit_shard(&plan, 0, &mut |done| {
        heard.push(done);
        if done >= 6 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!((stopped, heard), (None, vec![3, 6]));
}

#[test]
fn bytes_round_trip_and_other_lengths_are_refused() {
    let plan = plan(SMALL);
    let entries = fit_shard(&plan, 1, &mut |_| ControlFlow::Continue(())).expect("nothing stops it");
    let bytes = shard_to_bytes(&entries);
    assert_eq!(shard_from_bytes(&bytes, entries.len()), Ok(entries.clone()));
    let expected = bytes.len();
    assert_eq!(shard_from_bytes(&bytes[1..], entries.len()), Err(ShardBytesError { expected, actual: expected - 1 }));
}

#[test]
fn stored_matrices_are_upright_with_a_third_column_of_unit_length() {
    let table = table(SMALL);
    for m in &table.matrix {
        let m = from_row_major(&m.map(f64::from));
        assert!(m.determinant() > 0.0 && (m.z_axis.length() - 1.0).abs() < 1e-6, "{m}");
    }
}

/// Equation 16 of KT et al. 2022, exactly.
#[test]
fn symmetric_entries_have_exact_zeros() {
    let table = table(SMALL);
    let at = |a: usize, r: usize, t: usize, p: usize| table.matrix[((a * 3 + r) * 4 + t) * 3 + p];
    for (a, r, t) in (0..3).flat_map(|a| (0..3).flat_map(move |r| (0..4).map(move |t| (a, r, t)))) {
        let [_, m01, _, m10, _, m12, _, m21, _] = at(a, r, t, 0);
        assert_eq!([m01, m10, m12, m21], [0.0; 4], "phi = 0, {a} {r} {t}");
        let [_, m01, m02, m10, _, _, m20, _, _] = at(a, r, t, 2);
        assert_eq!([m01, m02, m10, m20], [0.0; 4], "phi = pi/2, {a} {r} {t}");
    }
    assert_eq!(at(1, 1, 0, 0), at(1, 1, 0, 1));
    assert_eq!(at(1, 1, 0, 0), at(1, 1, 0, 2));
}

/// Between two neighbours in any axis no aligned matrix turns by more than its neighbourhood asks for: with a jump
/// of the gauge the halfway matrix would collapse.
#[test]
fn halfway_between_neighbours_no_determinant_collapses() {
    let table = table(r#"{"preset": "draft", "resolution": {"alpha": 4, "ratio": 4, "theta": 8, "phi": 5}}"#);
    let lengths = [4, 4, 8, 5];
    let determinant = |m: &[f32; 9]| from_row_major(&m.map(f64::from)).determinant();
    let strides = [160, 40, 5, 1];
    let mut pairs = 0;
    for index in 0..table.matrix.len() {
        for (stride, length) in strides.into_iter().zip(lengths) {
            if index / stride % length + 1 == length {
                continue;
            }
            let (here, there) = (&table.matrix[index], &table.matrix[index + stride]);
            let halfway = std::array::from_fn(|k| 0.5 * (here[k] + there[k]));
            let least = determinant(here).min(determinant(there));
            assert!(determinant(&halfway) > 0.5 * least, "{index} {stride}: {here:?} {there:?}");
            pairs += 1;
        }
    }
    assert!(pairs > 2000);
}

/// The bytes of a table that has every kind of entry. When this changes on purpose, raise `FITTER_VERSION`.
#[test]
fn the_bytes_of_a_small_table_are_pinned() {
    let plan = plan(SMALL);
    let file = export::encode(plan.recipe(), &assemble(&plan, &fit_all(&plan))).expect("a table");
    assert_eq!(Digest::of(&file).hex(), PINNED);
}

const PINNED: &str = "f06b39e66a8bfd10d9048c383e1557504804f7fb2e5aed7edb4fafdc2f72f7a6";
