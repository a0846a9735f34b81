use ltcforge::view::{
    picture::{GROUND, LINE, colour},
    preview::Adapter,
};
use std::fs;

use super::*;

/// The number of bright pixels.
fn bright(picture: &Picture) -> usize {
    let brightest: Vec<[u8; 3]> = (90..=100).map(|percent| colour(percent as f32 / 100.0)).collect();
    picture.rgb.iter().filter(|pixel| brightest.contains(pixel)).count()
}

#[test]
fn lobes_are_drawn_and_reproducible() {
    for (draw, least) in [(lobes::draw as fn() -> _, 3000), (metrics::draw, 400)] {
        let drawn: Picture = draw().expect("a picture");
        assert!(bright(&drawn) > least, "{}", bright(&drawn));
        assert!(drawn == draw().expect("a picture"), "the second picture differs");
    }
}

/// Tests the first two rows of panels: interpolating matrices of one distribution changes the distribution, unless the
/// matrices are aligned.
#[test]
fn interpolating_aligned_matrices_keeps_their_distribution() {
    let drawn = alignment::draw().expect("a picture");
    let (width, height) = (drawn.width as usize, drawn.height as usize / 4);
    let across = width.div_ceil(5);
    let panel = |row: usize, column: usize| {
        let lines = row * height + 60..(row + 1) * height - 40;
        lines.flat_map(|y| &drawn.rgb[y * width + column * across..][..across - 4]).collect::<Vec<_>>()
    };
    let row = |row: usize| (panel(row, 0), panel(row, 2));
    let (first, between) = row(0);
    assert!(first != between, "interpolating unaligned matrices changed nothing");
    let (first, between) = row(1);
    let apart = first.iter().zip(&between).filter(|(a, b)| a != b).count();
    assert!(apart * 50 < first.len(), "{apart} of {}", first.len());
}

#[test]
fn both_alignments_are_drawn_with_their_errors() {
    let drawn = alignments::draw().expect("a picture");
    assert!(bright(&drawn) > 400, "{}", bright(&drawn));
    // A line that does not fit would be missing.
    let first = |line: u32| (2 + line * LINE) * drawn.width;
    for line in 0..8 {
        let pixels = &drawn.rgb[first(line) as usize..first(line + 1) as usize];
        assert!(pixels.iter().any(|pixel| *pixel != GROUND), "line {line} is empty");
    }
}

#[test]
fn table_1_equals_the_table_of_the_documentation() {
    let table = sizes::table().expect("a table");
    assert_eq!(table, include_str!("../../figures/table_1.md"), "run make figures");
    for (layout, numbers) in [("reflected", "| 11 | 181440 | 90720 |"), ("ltc2017", "| 6 | 131072 | 65536 |")] {
        let line = table.lines().find(|line| line.starts_with(&format!("| `{layout}` |"))).expect(layout);
        assert!(line.ends_with(numbers), "{line}");
    }
}

#[test]
fn the_documentation_shows_every_figure() {
    let read = |page: &str| fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(page)).expect("a page");
    let text = ["figures.md", "gaussians.md", "isotropic.md", "../docs/refraction.md"].map(read).concat();
    for figure in Figure::ALL.iter().filter(|figure| **figure != Figure::Table1) {
        assert!(text.contains(&format!("figures/{figure}.png)")), "{figure}");
    }
}

/// Tests figures that do not fit a whole table.
#[test]
fn pictures_of_isotropic_fits_differ_and_are_reproducible() {
    let draw = || [isotropic::shears(Shear::X), isotropic::shears(Shear::Z), isotropic::order()];
    let drawn = draw();
    assert!(drawn == draw(), "the second picture differs");
    assert!(drawn[0] != drawn[1] && drawn[0].rgb.len() > 100_000);
}

/// Tests figures that fit almost nothing.
#[test]
fn figures_are_written_under_their_names() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut preview = Preview::new(Adapter::Cpu);
    for (figure, name) in
        [(Figure::Notes2, "notes_2.png"), (Figure::Table1, "table_1.md"), (Figure::Notes5, "notes_5.png")]
    {
        let path = figure.write(&mut preview, folder.path()).expect("a file");
        assert_eq!(path, folder.path().join(name));
        let shown = Path::new(env!("CARGO_MANIFEST_DIR")).join("figures").join(name);
        assert!(
            fs::read(path).expect("a file") == fs::read(shown).expect("a file"),
            "{name} differs from the file of the documentation: run make figures"
        );
    }
    let error = Figure::Table1.write(&mut preview, Path::new("/proc")).expect_err("the folder is read-only");
    assert!(error.to_string().starts_with("/proc/table_1.md: "), "{error}");
}
