//! Runs the commands of `docs/tutorial.md`. Its page must show the light that `ltcforge light` prints.

use std::os::unix::fs::symlink;

use super::*;
use crate::common::documents::{blocks, commands, document, shell};

/// Prefixes of commands that the test does not run: they install the program, or serve the page.
const EXCEPT: [&str; 2] = ["cargo ", "python3 -m http.server"];

/// The page of the tutorial.
const PAGE: &str = "examples/webgl/index.html";

/// The output of `tutorial.js`.
#[derive(Debug, Deserialize)]
struct Tutorial {
    /// The number of compared pixels of the floor, and of bright pixels.
    pixels: usize,
    lit: usize,
    /// The largest difference from the light by the same table, in sRGB bytes.
    off: f64,
    /// The mean difference from the truth, in sRGB bytes.
    #[serde(rename = "fromTruth")]
    from_truth: f64,
    /// Warnings and errors from the browser.
    faults: Vec<String>,
}

/// Upper bound of the largest difference. Rounding to a byte causes 0.5, and the driver's arithmetic a little more.
const OFF: f64 = 1.0;

/// Upper bound of the mean difference from the truth. The measured difference is 3.2.
const FROM_TRUTH: f64 = 5.0;

#[test]
fn the_page_of_the_tutorial_is_lit_by_its_table() {
    let folder = tempfile::tempdir().expect("a folder");
    // The tutorial copies the page from the examples.
    symlink(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples"), folder.path().join("examples")).expect("a link");
    let printed = shell(folder.path(), &commands("docs/tutorial.md", &EXCEPT));
    assert!(printed.contains("energy,fresnel,reflected"), "{printed}");
    let lit = folder.path().join("lit");
    let Some(page) = browser::script::<Tutorial>(&here(), "tutorial.js", &["--folder", &lit.to_string_lossy()]) else {
        return;
    };
    print(&format!("{page:.2?}"));
    assert_eq!(page.faults, [""; 0]);
    assert!(page.pixels > 400 && page.lit > 40, "{page:?}");
    assert!(page.off <= OFF && page.from_truth < FROM_TRUTH, "{page:?}");
}

#[test]
fn the_code_of_the_tutorial_is_the_code_of_its_page() {
    let trimmed = |text: &str| {
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        lines.collect::<Vec<_>>().join("\n")
    };
    let page = trimmed(&document(PAGE));
    for language in ["glsl", "js"] {
        for block in blocks("docs/tutorial.md", language) {
            assert!(page.contains(&trimmed(&block)), "{PAGE} has other lines than\n{block}");
        }
    }
}
