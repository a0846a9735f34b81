use proptest::prelude::*;

use super::*;

const HEADER: &str = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3, 2, 2, 3, 3), }";
/// How many numbers a table with this shape has.
const NUMBERS: usize = 2 * 3 * 2 * 2 * 9;

/// A file of version 1.
fn file(header: &str, data: &[u8]) -> Vec<u8> {
    let length = u16::try_from(header.len()).expect("a short header");
    [NPY_MAGIC, &[1, 0], &length.to_le_bytes(), header.as_bytes(), data].concat()
}

fn data(numbers: impl IntoIterator<Item = f32>) -> Vec<u8> {
    numbers.into_iter().flat_map(f32::to_le_bytes).collect()
}

fn ascending() -> Vec<u8> {
    data((0_u16..).take(NUMBERS).map(f32::from))
}

#[test]
fn numbers_come_in_storage_order_at_the_nodes_of_kt2022() {
    let NpyTable { table, range } = decode_npy(&file(HEADER, &ascending())).expect("a table");
    assert_eq!(table.axes.lengths(), PerAxis { alpha: 2, ratio: 3, theta: 2, phi: 2 });
    assert_eq!(table.axes.ratio, [ltcforge_fit::RATIO_FLOOR, 0.5, 1.0]);
    assert_eq!(range.alpha, [0.0, 1.0]);
    assert_eq!(table.matrix.len(), 24);
    assert_eq!(table.matrix[1], [9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0, 16.0, 17.0]);
    assert_eq!(table.terms, None);
}

#[test]
fn headers_of_every_version_order_and_spacing_are_read() {
    let other = "{\"shape\":(2,3,2,2,3,3),\"fortran_order\":False,\"descr\":\"<f4\"}       \n";
    let wanted = decode_npy(&file(HEADER, &ascending())).expect("a table").table.matrix;
    assert_eq!(decode_npy(&file(other, &ascending())).expect("a table").table.matrix, wanted);
    for version in [2, 3] {
        let length = u32::try_from(HEADER.len()).expect("short").to_le_bytes();
        let bytes = [NPY_MAGIC, &[version, 0], &length, HEADER.as_bytes(), &ascending()].concat();
        assert_eq!(decode_npy(&bytes).expect("a table").table.matrix, wanted);
    }
}

/// Matrices with a negative determinant, as in the published table, are read. The report counts them.
#[test]
fn negative_determinants_are_let_through() {
    let flipped = [1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0];
    let found = decode_npy(&file(HEADER, &data(flipped.into_iter().cycle().take(NUMBERS)))).expect("a table");
    assert_eq!(found.table.matrix[23], flipped);
}

#[test]
fn every_error_is_named() {
    let said = |bytes: &[u8]| decode_npy(bytes).expect_err("not a table").to_string();
    let with = |from: &str, to: &str| said(&file(&HEADER.replace(from, to), &ascending()));
    assert_eq!(with("<f4", "<f8"), "«descr» is «<f8»; a table has «<f4»");
    assert_eq!(with("False", "True"), "«fortran_order» is True; a table has False");
    assert!(with("(2, 3, 2, 2, 3, 3)", "(24, 3, 3)").starts_with("«shape» is [24, 3, 3]"));
    assert!(with("(2, 3, 2, 2, 3, 3)", "(1, 6, 2, 2, 3, 3)").contains("2 to 16384 nodes"));
    assert!(with("(2,", "(9999999999999999999, 9999999999,").contains("«shape»"));
    assert!(with("(2, 3, 2,", "(4611686018427387904, 3, 2,").contains("the shape needs 18446744073709551615"));
    assert!(with("(2, 3, 2,", "(3, 3, 2,").contains("864 bytes of data; the shape needs 1296"));
    assert_eq!(with("False", "Maybe"), "the header: expected True or False, found «Maybe, 'shape': (2, »");
    assert_eq!(with("descr", "shape"), "the header: expected «(», found «'<f4', 'fortran_orde»");
    assert_eq!(with("'descr': '<f4', ", ""), "the header: «descr» is missing");
    assert_eq!(with("'descr'", "'colour': 1, 'descr'"), "the header: «colour» is an unknown field");
    let twice = "{'descr': '<f4', 'descr': '<f4'}";
    assert_eq!(said(&file(twice, &[])), "the header: «descr» is repeated");
    assert_eq!(said(b"safetensors"), NpyError::Magic.to_string());
    assert_eq!(said(b"\x93NUMPY\x01\x00\x99"), "the header: the file ends too early");
    assert_eq!(said(b"\x93NUMPY\x04\x00\x00\x00"), NpyError::Magic.to_string());
    let mut infinite = ascending();
    infinite[28..32].copy_from_slice(&f32::INFINITY.to_le_bytes());
    assert_eq!(said(&file(HEADER, &infinite)), "element 7 is inf, not a finite number");
}

proptest! {
    #[test]
    fn any_bytes_give_an_answer(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = decode_npy(&bytes);
        let _ = decode_npy(&[NPY_MAGIC, &bytes].concat());
    }

    /// Headers that are almost right: a piece of a valid header is cut out or replaced.
    #[test]
    fn any_header_gives_an_answer(start in 0..HEADER.len(), length in 0..20_usize, piece in "[{}()',:a-z0-9 <é-]{0,20}") {
        let end = (start + length).min(HEADER.len());
        let header = [&HEADER[..start], &piece, &HEADER[end..]].concat();
        let _ = decode_npy(&file(&header, &ascending()));
    }

    #[test]
    fn a_cut_file_is_refused(cut in 0..800_usize) {
        let whole = file(HEADER, &ascending());
        prop_assert!(decode_npy(&whole[..cut.min(whole.len() - 1)]).is_err());
    }
}
