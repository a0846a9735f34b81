use std::f64::consts::FRAC_PI_2;

use half::f16;
use proptest::prelude::*;

use super::*;
use ltcforge_fit::{BrdfKind, Layout, LobeFresnel, LobeModel, SecondLobe};

/// A recipe of 2 x 2 x 3 x 2 entries, and a table with invented numbers.
fn example(terms: bool) -> (Recipe, Table) {
    let text = format!(
        r#"{{"resolution": {{"alpha": 2, "ratio": 2, "theta": 3, "phi": 2}}, "terms": {terms},
            "range": {{"alpha": [0.1, 0.4], "ratio": [0.5, 1], "theta": [0, 1.2], "phi": [0, {FRAC_PI_2}]}}}}"#
    );
    let recipe = recipe_document::parse(text.as_bytes(), 24).expect("a recipe");
    let column = |scale: f32| (0..24_u8).map(|i| scale * f32::from(i)).collect::<Vec<f32>>();
    let table = Table {
        brdf: BrdfKind::Ggx.into(),
        lobe: LobeModel::Ltc,
        layout: Layout::Reflected,
        axes: recipe.nodes(),
        matrix: column(0.01).into_iter().map(|x| [0.5, x, 0.0, 0.0, 0.3, 0.0, x, 0.0, 1.0]).collect(),
        terms: terms.then(|| Terms { amplitude: column(0.04), fresnel: column(0.02), edge: None }),
        second: None,
        node_error: column(0.001),
    };
    (recipe, table)
}

fn file(terms: bool) -> Vec<u8> {
    let (recipe, table) = example(terms);
    encode(&recipe, &table).expect("a consistent table")
}

/// The error of decoding the example after `change` has damaged it.
fn broken(change: impl FnOnce(&mut Recipe, &mut Table)) -> TableFileError {
    let (mut recipe, mut table) = example(true);
    change(&mut recipe, &mut table);
    decode(&encode(&recipe, &table).expect("lengths agree")).expect_err("not a table")
}

#[test]
fn a_file_reads_back_as_it_was_written() {
    for terms in [true, false] {
        let (recipe, table) = example(terms);
        assert_eq!(decode(&file(terms)), Ok(TableFile { recipe, table }));
    }
}

/// The example with a second lobe.
fn example_of_two_lobes() -> (Recipe, Table) {
    let (recipe, table) = example(true);
    let brdf = BrdfModel::from(BrdfKind::Ggx).with_fresnel(LobeFresnel::Two(SecondLobe::Blended));
    let second = table.matrix.iter().map(|m| m.map(|x| 0.5 * x)).collect();
    (Recipe { brdf: brdf.clone(), ..recipe }, Table { brdf, second: Some(second), ..table })
}

#[test]
fn a_second_lobe_reads_back_and_takes_three_quarters_more_at_most() {
    let (recipe, table) = example_of_two_lobes();
    let bytes = encode(&recipe, &table).expect("a consistent table");
    assert_eq!(bytes.len() - 24 * 9 * 4 - file(true).len(), 104, "the header's part");
    assert_eq!(decode(&bytes), Ok(TableFile { recipe: recipe.clone(), table: table.clone() }));
    let mut flat = table.clone();
    flat.second.as_mut().expect("a second lobe")[7] = [0.0; 9];
    let refused = decode(&encode(&recipe, &flat).expect("lengths agree")).expect_err("a flat lobe").to_string();
    assert!(refused.contains("matrix_2") && refused.contains("entry 7"), "{refused}");
    let lost = encode(&recipe, &Table { second: None, ..table }).expect("lengths agree");
    assert!(decode(&lost).expect_err("no second lobe").to_string().contains("«matrix_2»: missing"));
}

/// The third term is a separate tensor, which the recipe requires, and is not negative.
#[test]
fn a_file_with_the_edge_term_reads_back_too() {
    let (mut recipe, mut table) = example(true);
    recipe.terms = StoredTerms::F82;
    let set = |table: &mut Table, edge| table.terms.as_mut().expect("terms").edge = edge;
    set(&mut table, Some(vec![0.03; 24]));
    let bytes = encode(&recipe, &table).expect("a consistent table");
    assert_eq!(decode(&bytes), Ok(TableFile { recipe: recipe.clone(), table: table.clone() }));
    for wrong in [None, Some(vec![-0.03; 24])] {
        set(&mut table, wrong);
        let refused = decode(&encode(&recipe, &table).expect("lengths agree"));
        assert!(matches!(&refused, Err(TableFileError::Tensor { name, .. }) if name == "edge"), "{refused:?}");
    }
}

/// Half floats are stored as halves, and numbers that are halves are read back exactly.
#[test]
fn a_file_of_half_floats_takes_half_the_bytes() {
    let (mut recipe, mut table) = example(true);
    recipe.precision = Precision::F16;
    let halves = |values: &mut [f32]| values.iter_mut().for_each(|x| *x = f16::from_f32_const(*x).to_f32_const());
    halves(table.matrix.as_flattened_mut());
    halves(&mut table.node_error);
    let terms = table.terms.as_mut().expect("terms");
    halves(&mut terms.amplitude);
    halves(&mut terms.fresnel);
    let file_of_halves = encode(&recipe, &table).expect("a consistent table");
    assert_eq!(file(true).len() - file_of_halves.len(), 24 * (9 + 3) * 2);
    assert_eq!(decode(&file_of_halves), Ok(TableFile { recipe, table }));
}

/// A fitter reads tables of older fitters, which keep their version, but not tables of newer fitters.
#[test]
fn tables_of_older_fitters_can_be_read() {
    let (mut recipe, table) = example(true);
    recipe.fitter = 1;
    let older = encode(&recipe, &table).expect("a consistent table");
    assert_eq!(decode(&older), Ok(TableFile { recipe, table }));
}

#[test]
fn the_header_is_canonical_json_and_the_recipe_is_all_the_metadata() {
    let file = file(true);
    let (_, header) = SafeTensors::read_metadata(&file).expect("a header");
    let metadata = header.metadata().as_ref().expect("metadata");
    assert_eq!(metadata.keys().collect::<Vec<_>>(), [RECIPE_KEY]);
    assert_eq!(metadata[RECIPE_KEY], recipe_document::canonical_json(&example(true).0));
}

#[test]
fn lengths_that_do_not_agree_are_not_written() {
    let (recipe, mut table) = example(true);
    table.node_error.pop();
    assert!(matches!(encode(&recipe, &table), Err(TableFileError::Tensor { name, .. }) if name == "node_error"));
}

#[test]
fn numbers_that_make_no_table_are_named() {
    let tensor = |error: TableFileError| match error {
        TableFileError::Tensor { name, detail } => (name, detail),
        other => panic!("{other}"),
    };
    let (name, detail) = tensor(broken(|_, table| table.matrix[7][1] = f32::NAN));
    assert!(name == "matrix" && detail.contains("element 64 is NaN"), "{detail}");
    let (name, detail) = tensor(broken(|_, table| table.matrix[7][4] = -0.3));
    assert!(name == "matrix" && detail.contains("entry 7"), "{detail}");
    let (name, _) = tensor(broken(|_, table| table.node_error[0] = f32::INFINITY));
    assert_eq!(name, "node_error");
    let (name, detail) = tensor(broken(|_, table| table.node_error[1] = -0.1));
    assert!(name == "node_error" && detail.contains("element 1 is -0.1"), "{detail}");
    let (name, _) = tensor(broken(|_, table| table.terms.as_mut().expect("terms").amplitude[0] = -1.0));
    assert_eq!(name, "amplitude");
    let (name, _) = tensor(broken(|_, table| table.axes.theta[1] = 0.7));
    assert_eq!(name, "axis_theta");
    let (name, _) = tensor(broken(|_, table| table.terms = None));
    assert_eq!(name, "amplitude");
    let (name, _) = tensor(broken(|recipe, _| recipe.resolution.phi = 3));
    assert_eq!(name, "axis_phi");
}

#[test]
fn tensors_that_the_recipe_does_not_ask_for_are_not_canonical() {
    assert_eq!(broken(|recipe, _| recipe.terms = StoredTerms::None), TableFileError::NotCanonical);
    let mut padded = file(true);
    // Safetensors allows eight more blanks in the header, which move the data.
    let length = u64::from_le_bytes(padded[..8].try_into().expect("eight bytes")) + 8;
    padded[..8].copy_from_slice(&length.to_le_bytes());
    let end = length as usize;
    padded.splice(end..end, [b' '; 8]);
    assert!(decode(&padded).is_err());
}

#[test]
fn other_containers_and_recipes_are_refused() {
    assert!(matches!(decode(b""), Err(TableFileError::Container(_))));
    assert!(matches!(decode(&u64::MAX.to_le_bytes()), Err(TableFileError::Container(_))));
    let no_tensors: Vec<(String, Tensor)> = vec![];
    let bare = serialize(no_tensors, None).expect("a file");
    assert!(matches!(decode(&bare), Err(TableFileError::Recipe(_))));
    let unknown = broken(|recipe, _| recipe.fitter += 1);
    assert!(matches!(unknown, TableFileError::Recipe(ref detail) if detail.contains("/fitter")), "{unknown}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Each table has exactly one file. If a file decodes after a bit has changed, its table encodes to exactly the
    /// changed bytes.
    #[test]
    fn a_changed_bit_is_an_error_or_another_table(at in 0..file(true).len() * 8) {
        let mut bytes = file(true);
        bytes[at / 8] ^= 1 << (at % 8);
        if let Ok(TableFile { recipe, table }) = decode(&bytes) {
            prop_assert_eq!(encode(&recipe, &table), Ok(bytes));
        }
    }

    #[test]
    fn a_cut_file_is_refused(length in 0..file(true).len()) {
        prop_assert!(decode(&file(true)[..length]).is_err());
    }

    #[test]
    fn any_bytes_give_an_answer(header in prop::collection::vec(any::<u8>(), 0..64), length in 0_u64..80) {
        let _ = decode(&header);
        let _ = decode(&[&length.to_le_bytes()[..], &header].concat());
    }
}
