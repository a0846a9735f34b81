use super::*;
use crate::picture::Picture;
use ltcforge_fit::{BrdfKind, Layout, LobeModel, PerAxis, Table, Terms};

const DIGEST: &str = "0a1b2c3d4e5f";

/// A table of twelve entries. All entries are the identity, except entry `bad`.
fn table(bad: usize) -> Table {
    let mut matrix = vec![[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]; 12];
    matrix[bad] = [0.2, 0.0, 0.5, 0.0, 0.7, 0.0, 0.0, 0.0, 1.0];
    Table {
        brdf: BrdfKind::Ggx.into(),
        lobe: LobeModel::Ltc,
        layout: Layout::Kt2022,
        axes: PerAxis { alpha: vec![0.25, 1.0], ratio: vec![0.5, 1.0], theta: vec![0.0, 0.5, 1.0], phi: vec![0.0] },
        matrix,
        terms: Some(Terms { amplitude: vec![1.0; 12], fresnel: vec![0.0; 12], edge: None }),
        second: None,
        node_error: vec![0.01; 12],
    }
}

fn pixel(picture: &Picture, x: u32, y: u32) -> [u8; 3] {
    picture.rgb[(y * picture.width + x) as usize]
}

#[test]
fn a_plot_of_the_entries_is_a_png_and_equal_calls_give_equal_bytes() {
    let draw = |bad, digest| Plot::Matrix.draw(&table(bad), digest);
    let first = draw(1, DIGEST);
    assert!(first.png().expect("a PNG").starts_with(b"\x89PNG"));
    assert!(first == draw(1, DIGEST));
    assert!(first != draw(2, DIGEST), "the plot does not show the bad entry");
    assert!(first != draw(1, "4e5f"), "the plot does not name the table");
}

#[test]
fn numbers_that_a_table_lacks_are_left_empty() {
    let mut bare = table(0);
    bare.terms = None;
    bare.node_error.fill(f32::NAN);
    let (with, without) = (Plot::Matrix.draw(&table(0), DIGEST), Plot::Matrix.draw(&bare, DIGEST));
    assert_eq!((with.width, with.height), (without.width, without.height));
    let differ = (0..with.height).flat_map(|y| (0..with.width).map(move |x| (x, y)));
    let differ: Vec<u32> =
        differ.filter(|(x, y)| pixel(&with, *x, *y) != pixel(&without, *x, *y)).map(|(x, _)| x).collect();
    assert!(!differ.is_empty());
    assert!(differ.iter().all(|x| *x >= with.width / 4 * 3), "a panel of the matrix changed");
}

#[test]
fn a_slice_is_within_the_range_of_the_table() {
    let draw = |bad, ratio, phi| Plot::Error(ErrorSlice { ratio, phi }).draw(&table(bad), DIGEST);
    let nearest = draw(1, 0.5, 0.0);
    assert!(nearest.png().expect("a PNG").starts_with(b"\x89PNG"));
    assert!(draw(1, 0.1, 3.0) == nearest);
    assert!(draw(1, 1.0, 0.0) != nearest);
    // This entry is at the ratio that the plot shows.
    assert!(draw(2, 0.5, 0.0) != nearest, "the plot does not show the bad entry");
}
