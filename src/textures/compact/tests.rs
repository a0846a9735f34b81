//! Compares the JavaScript module, run by Node.js, with the decoder in Rust.

use std::{fs, process::Command};

use proptest::prelude::*;

use super::*;
use crate::textures_of;
use ltcforge_files::compact::{
    LAYOUTS, decode,
    planted::{planted, unmeasured},
};
use ltcforge_fit::{Layout, clipped_form_factor};

/// Writes the matrices, the amplitudes, the Fresnel terms, the nodes and all textures, little-endian.
const PRINT: &str = "
import { createTable, createTextures } from './ltc.compact.mjs';
import { writeFileSync } from 'node:fs';
const table = createTable();
const write = ( name, array ) => writeFileSync( name, Buffer.from( array.buffer ) );
write( 'matrix', table.matrix );
write( 'amplitude', table.amplitude ?? new Float32Array( 0 ) );
write( 'fresnel', table.fresnel ?? new Float32Array( 0 ) );
write( 'nodes', Float32Array.from( Object.values( table.axes ).flatMap( nodes => [ ...nodes ] ) ) );
if ( process.argv[ 2 ] === 'textures' ) createTextures().forEach( ( texture, i ) => write( 'texture' + i, texture.data ) );
";

/// Runs the module for a table. The folder has an array per file. `None` without Node.js.
fn run(table: &Table, textures: bool) -> Option<tempfile::TempDir> {
    if Command::new("node").arg("--version").output().is_err() {
        eprintln!("SKIPPED: no node on this machine, so the decoder in JavaScript is not run");
        return None;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let files =
        CompactContainer::JavaScript.files_of("ltc", unmeasured(table), &About::new(["a table"])).expect("a module");
    assert_eq!(files[0].path, "ltc.compact.js");
    fs::write(folder.path().join("ltc.compact.mjs"), &files[0].bytes).expect("a file");
    fs::write(folder.path().join("print.mjs"), PRINT).expect("a file");
    let mode = if textures { "textures" } else { "table" };
    let ran = Command::new("node").args(["print.mjs", mode]).current_dir(folder.path()).output().expect("node");
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    Some(folder)
}

fn floats(folder: &tempfile::TempDir, name: &str) -> Vec<f32> {
    let bytes = fs::read(folder.path().join(name)).expect("a file");
    bytes.as_chunks::<4>().0.iter().map(|word| f32::from_le_bytes(*word)).collect()
}

/// A table with waves in every channel, and an edge that needs corrections.
fn wavy(layout: Layout, has_terms: bool) -> Table {
    planted(layout, [9, 4, 7, 5], has_terms, |channel, place| {
        let wave = 0.01 * (channel as f64 + 1.0) * place[0] * (place[2] - 0.5) * (1.0 - place[3]);
        if channel == 0 && place[0] > 0.8 && place[2] < 0.4 { wave + 0.4 } else { wave }
    })
}

/// Layout `reflected` uses only arithmetic that has the same bits on every platform. The other layouts also use the
/// platform's sines.
#[test]
fn javascript_decodes_the_same_numbers() {
    for layout in &LAYOUTS {
        let table = wavy(*layout, *layout != Layout::Kt2022);
        let Some(folder) = run(&table, false) else { return };
        let expected = decode(&unmeasured(&table)).expect("a table");
        let matrices: Vec<f32> = expected.matrices().iter().flatten().copied().collect();
        let terms =
            |get: fn(&ltcforge_fit::Terms) -> &[f32]| expected.terms().map_or(vec![], |terms| get(terms).to_vec());
        let nodes: Vec<f32> =
            expected.axes().named().iter().flat_map(|(_, nodes)| nodes.iter().map(|x| *x as f32)).collect();
        let tolerance = if *layout == Layout::Reflected { 0.0 } else { 2e-7 };
        for (name, expected) in [
            ("matrix", matrices),
            ("amplitude", terms(|t| t.amplitude())),
            ("fresnel", terms(|t| t.fresnel())),
            ("nodes", nodes),
        ] {
            let found = floats(&folder, name);
            assert_eq!(found.len(), expected.len(), "{layout} {name}");
            let tolerance = if name == "nodes" { 2e-7 } else { tolerance };
            for (i, (found, expected)) in found.iter().zip(&expected).enumerate() {
                let close = (found - expected).abs() <= tolerance * (1.0 + expected.abs());
                assert!(close, "{layout} {name} {i}: {found}, not {expected}");
            }
        }
    }
}

#[test]
fn javascript_creates_the_textures_of_our_own_shader() {
    let table = wavy(Layout::Reflected, true);
    let Some(folder) = run(&table, true) else { return };
    let decoded = decode(&unmeasured(&table)).expect("a table");
    for (i, texture) in textures_of(&decoded, "reflected").expect("textures").iter().enumerate() {
        assert_eq!(floats(&folder, &format!("texture{i}")), texture.texels, "{}", texture.name);
    }
}

#[test]
fn javascript_creates_the_textures_of_an_engine() {
    let table = wavy(Layout::Ltc2017, true);
    let Some(folder) = run(&table, true) else { return };
    let (alphas, thetas) = (9, 7);
    let (matrix, amplitude) = (floats(&folder, "matrix"), floats(&folder, "amplitude"));
    let (first, second) = (floats(&folder, "texture0"), floats(&folder, "texture1"));
    for alpha in 0..alphas {
        for theta in 0..thetas {
            let (entry, texel) = (alpha * thetas + theta, theta * alphas + alpha);
            let m = &matrix[9 * entry..];
            assert_eq!(first[4 * texel..4 * texel + 4], [m[0], m[6], m[2], m[8]]);
            assert_eq!(second[4 * texel], amplitude[entry]);
            let (c, length) = (2.0 * alpha as f64 / 8.0 - 1.0, theta as f64 / 6.0);
            assert!((f64::from(second[4 * texel + 3]) - clipped_form_factor(c, length)).abs() < 1e-6);
        }
    }
}

/// Compiles the Rust module with rustc and checks the textures that it creates.
#[test]
fn rust_creates_the_textures() {
    const PRINT: &str = "#[path = \"ltc.compact.rs\"]
mod ltc;
fn main() {
    let all: Vec<f32> = ltc::textures().unwrap().into_iter().flat_map(|texture| texture.texels).collect();
    std::fs::write(\"texels\", all.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>()).unwrap();
}
";
    if Command::new("rustc").arg("--version").output().is_err() {
        eprintln!("SKIPPED: no rustc on this machine, so the Rust decoder is not compiled without this crate");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let table = wavy(Layout::Reflected, true);
    let files = CompactContainer::Rust.files_of("ltc", unmeasured(&table), &About::new(["a table"])).expect("a module");
    for file in files {
        fs::write(folder.path().join(&file.path), &file.bytes).expect("a file");
    }
    fs::write(folder.path().join("print.rs"), PRINT).expect("a file");
    let words = ["--edition", "2021", "-D", "warnings", "-A", "dead_code", "print.rs", "-o", "print"];
    let made = Command::new("rustc").args(words).current_dir(folder.path()).output().expect("rustc");
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let ran = Command::new(folder.path().join("print")).current_dir(folder.path()).output().expect("the program");
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let decoded = decode(&unmeasured(&table)).expect("a table");
    let wanted: Vec<f32> =
        textures_of(&decoded, "reflected").expect("textures").into_iter().flat_map(|texture| texture.texels).collect();
    assert_eq!(floats(&folder, "texels"), wanted);
}

#[test]
fn the_standalone_decoder_creates_the_textures_of_an_engine() {
    let layout = Layout::Ltc2017;
    for has_terms in [true, false] {
        let bytes = unmeasured(&wavy(layout, has_terms));
        let found = decoder::decode(&bytes).expect("textures");
        let wanted = textures_of(&decode(&bytes).expect("a table"), layout.name());
        // The textures of engines need terms.
        let Ok(wanted) = wanted else {
            assert!(!has_terms, "{layout}");
            assert!(found[1].texels.iter().all(|x| x.is_finite()));
            continue;
        };
        for (found, wanted) in found.iter().zip(&wanted) {
            assert_eq!(found.name, wanted.name);
            for (i, (one, other)) in found.texels.iter().zip(&wanted.texels).enumerate() {
                assert!((one - other).abs() <= 1e-5 * (1.0 + other.abs()), "{layout} {i}: {one} {other}");
            }
        }
    }
}

proptest! {
    #[test]
    fn the_standalone_decoder_survives_hostile_bytes(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        cut in prop::option::of(any::<prop::sample::Index>()), layout in prop::sample::select(&[Layout::Reflected, Layout::Ltc2017][..]),
    ) {
        let mut bytes = unmeasured(&planted(layout, [4, 3, 5, 3], true, |_, _| 0.0));
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        let _ = decoder::decode(&bytes);
    }
}
