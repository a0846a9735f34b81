//! Compares the WGSL decoder of compact forms on the GPU with the Rust decoder.

use super::preview::{GpuFailure, report_skipped, run_decoder};
use ltcforge_files::compact::{decode, encode};
use ltcforge_fit::{Layout, Table, testing::planted_isotropic};
use ltcforge_textures::{About, CompactContainer, textures_of};

/// The number before `word` (such as ` bytes`) in the header of the module, in the first line that contains `line`.
fn stated(text: &str, line: &str, word: &str) -> u64 {
    let line = text.lines().find(|found| found.contains(line)).expect(line);
    let (before, _) = line.split_once(word).expect(word);
    before.split_whitespace().next_back().and_then(|number| number.parse().ok()).expect("a number")
}

/// A table with an edge, so that some entries need corrections.
fn edged(layout: Layout) -> Table {
    let mut table = planted_isotropic(layout);
    let numbers = &mut table.matrix;
    let last = numbers.len() - 3;
    for row in &mut numbers[last..] {
        row[0] *= 1.7;
    }
    table
}

#[test]
fn the_decoder_in_wgsl_rebuilds_the_textures() {
    for layout in [Layout::Reflected, Layout::Ltc2017] {
        let table = edged(layout);
        let bytes = encode(&table).expect("bytes");
        let files = CompactContainer::Wgsl.files("ltc", &table, &About::new(["a table"])).expect("files");
        assert_eq!((files[0].path.as_str(), &files[0].bytes), ("ltc.compact", &bytes));
        let source = std::str::from_utf8(&files[1].bytes).expect("UTF-8");
        let sizes =
            [stated(source, "scratch memory of the decoder", " bytes"), stated(source, "RGBA of 32 bits", " bytes")];
        let passes = [stated(source, "ltc_read, ", " dispatches"), stated(source, "ltc_expand, ", " workgroups. Copy")];
        let passes = passes.map(|n| u32::try_from(n).expect("few"));
        let found = match run_decoder(source, &bytes, sizes, passes) {
            Ok(found) => found,
            Err(GpuFailure::Absent(reason)) => return report_skipped(&reason),
            Err(error) => panic!("{error}"),
        };
        let decoded = decode(&bytes).expect("a table");
        let textures = textures_of(&decoded, layout.name()).expect("textures");
        let wanted: Vec<f32> = textures.iter().flat_map(|texture| texture.texels.iter().copied()).collect();
        assert_eq!(found.len(), wanted.len(), "{layout}");
        for (i, (found, wanted)) in found.iter().zip(&wanted).enumerate() {
            assert!((found - wanted).abs() < 2e-4 * (1.0 + wanted.abs()), "{layout} {i}: {found} {wanted}");
        }
    }
}
