//! Compares `examples/playcanvas`, shader chunks for `PlayCanvas` materials, with the truth.

use super::examples::{hold_errors, package};

/// Upper bounds of the example's errors, under one light of radiance 2, and under four lights, with one of them on the
/// floor. The measured errors are 0.00030, 0.00028 and 0.00008 under one, and 0.00056, 0.00040 and 0.00017 under four.
/// `PlayCanvas` itself has 0.067 and 0.101.
const EXAMPLE_ERRORS: [(&str, [f64; 2]); 3] =
    [("fast", [0.0005, 0.0009]), ("balanced", [0.00045, 0.0007]), ("fine", [0.00045, 0.0006])];

#[test]
#[ignore = "make test-all runs it"]
fn the_example_is_nearer_to_the_truth_than_playcanvas() {
    hold_errors("playcanvas", &EXAMPLE_ERRORS);
}

/// Invalid inputs, each with a part of the error message.
const REFUSALS: [(&str, &str); 8] = [
    ("shader", "ShaderMaterial has no GGX lobe"),
    ("nothing", "undefined has no GGX lobe"),
    ("text", "ltcforge shader --model normals"),
    ("device", "graphicsDevice"),
    ("webgpu", "for WebGL 2"),
    ("chunk", "a chunk ltcPS of its own"),
    ("alpha", "alpha is 0"),
    ("version", "this patch is for 2.23"),
];

/// Upper bound of the difference between clustered and other lights. The measured difference is 0.00002: clustered
/// lights have colours in 16 bits.
const WAYS_DIFFER: f64 = 0.0001;

/// Upper bound of the difference between a coat and white metal in a pixel. The measured difference is 0.0000001, from
/// rounding.
const COAT_DIFFERS: f64 = 0.000_005;

#[test]
#[ignore = "make test-all runs it"]
fn the_package_patches_materials_of_playcanvas_and_removes_the_patch() {
    let Some(report) = package("playcanvas", &REFUSALS) else { return };
    report.same_as_ours(&["patched again", "clone", "clone of the clone", "patched after a draw", "moved"]);
    report.same_as_stock(&["patch taken off", "clone of the undone", "undone clone", "before the patch", "undone"]);
    report.differ_from_ours(&[("stock", 0.01), ("elsewhere", 0.01), ("another rule", 0.0001)]);
    assert!(report.from_ours["ours, unclustered"].mean < WAYS_DIFFER, "{:?}", report.from_ours);
    // PlayCanvas still lights disks.
    let [ours, stock] = ["disk", "stock, disk"].map(|name| report.from_stock[name].mean);
    assert!(ours.to_bits() == stock.to_bits() && stock > 0.001, "{ours} {stock}");
    let unclustered = ["patch taken off, unclustered", "stock, unclustered"].map(|name| &report.from_stock[name]);
    assert!(unclustered[0].mean.to_bits() == unclustered[1].mean.to_bits(), "{unclustered:?}");
    assert!(report.coats.iter().all(|most| *most < COAT_DIFFERS), "{:?}", report.coats);
    assert!(report.leaves_own && report.leaves_refused);
}
