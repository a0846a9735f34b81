//! Checks the digests that `tests/cli/same_bytes.rs` pins for the command, on any target processor of the compiler.

use std::ops::ControlFlow;

use ltcforge_files::{
    container::TableFile,
    digest::Digest,
    recipe_document::{DEFAULT_ENTRY_LIMIT, parse},
};
use ltcforge_fit::{Plan, fit_plan};

const DIGESTS: [(&str, &str); 3] = [
    ("ltc", "sha256:2c3d0be191fa318bae02c01a19581ccfd5ffe169f39cf14adc6ab35065d221d3"),
    ("sg", "sha256:3f719fc926b56fa7c427aa842ea95aee574242605683c00d634ed8b246fbf74b"),
    ("asg", "sha256:82ca1d11e86d7361f151d7fed723c6f913bb8d1e8405bb61b556b9c5c6a7dc37"),
];

#[test]
fn the_bytes_of_small_tables_are_pinned() {
    for (lobe, digest) in DIGESTS {
        let axes = r#"{"alpha": 3, "ratio": 3, "theta": 4, "phi": 3}"#;
        let recipe = format!(
            r#"{{"preset": "draft", "lobe": "{lobe}", "resolution": {axes}, "fit": {{"samples": 128, "seed": 1}}}}"#
        );
        let recipe = parse(recipe.as_bytes(), DEFAULT_ENTRY_LIMIT).expect("a recipe");
        let table = fit_plan(&Plan::new(&recipe), &|_| ControlFlow::Continue(())).expect("nothing stops it");
        let bytes = TableFile { recipe, table }.to_bytes().expect("a table");
        assert_eq!(Digest::of(&bytes).to_string(), digest, "{lobe}");
    }
}
