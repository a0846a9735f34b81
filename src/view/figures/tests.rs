use super::*;
use crate::view::picture::colour;

/// Pixels of the brightest colours.
fn bright(picture: &Picture) -> usize {
    let brightest: Vec<[u8; 3]> = (90..=100).map(|percent| colour(percent as f32 / 100.0)).collect();
    picture.rgb.iter().filter(|pixel| brightest.contains(pixel)).count()
}

#[test]
fn lobes_are_drawn_and_come_again() {
    for (draw, least) in [(lobes::draw as fn() -> _, 3000), (metrics::draw, 400)] {
        let drawn: Picture = draw().expect("a picture");
        assert!(bright(&drawn) > least, "{}", bright(&drawn));
        assert!(drawn == draw().expect("a picture"), "not the same again");
    }
}

/// A matrix between two of one distribution is of another one, unless they are aligned: the first two rows of panels.
#[test]
fn aligned_matrices_of_one_distribution_stay_it() {
    let drawn = alignment::draw().expect("a picture");
    let (width, height) = (drawn.width as usize, drawn.height as usize / 4);
    let across = width.div_ceil(5);
    let panel = |row: usize, column: usize| {
        let lines = row * height + 60..(row + 1) * height - 40;
        lines.flat_map(|y| &drawn.rgb[y * width + column * across..][..across - 4]).collect::<Vec<_>>()
    };
    let row = |row: usize| (panel(row, 0), panel(row, 2));
    let (first, between) = row(0);
    assert!(first != between, "an unaligned matrix changes nothing");
    let (first, between) = row(1);
    let apart = first.iter().zip(&between).filter(|(a, b)| a != b).count();
    assert!(apart * 50 < first.len(), "{apart} of {}", first.len());
}

#[test]
fn every_figure_has_a_name_of_its_own() {
    let mut names = Figure::ALL.map(Figure::name).to_vec();
    names.dedup();
    assert_eq!(names.len(), Figure::ALL.len());
}
