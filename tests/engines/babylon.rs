//! Compares `examples/babylon`, a plugin for Babylon.js materials, with the truth.

use super::examples::{hold_errors, package};

/// Upper bounds of the example's errors, under one light of radiance 2, and under four lights, with one of them on the
/// floor. The measured errors are 0.00030, 0.00028 and 0.00009 under one, and 0.00056, 0.00040 and 0.00017 under four.
/// Babylon itself has 0.063 and 0.090.
const EXAMPLE_ERRORS: [(&str, [f64; 2]); 3] =
    [("fast", [0.0005, 0.0009]), ("balanced", [0.00045, 0.0007]), ("fine", [0.00045, 0.0006])];

#[test]
#[ignore = "make test-all runs it"]
fn the_example_is_nearer_to_the_truth_than_babylon() {
    hold_errors("babylon", &EXAMPLE_ERRORS);
}

/// Invalid inputs, each with a part of the error message.
const REFUSALS: [(&str, &str); 10] = [
    ("standard", "StandardMaterial is not lit by the shader of PBRMaterial"),
    ("openpbr", "OpenPBRMaterial is not lit by the shader of PBRMaterial"),
    ("nothing", "undefined is not lit"),
    ("text", "ltcforge shader --model normals"),
    ("text from a file", "ltcforge shader --model normals"),
    ("webgpu", "WGSL"),
    ("webgl 1", "needs WebGL 2"),
    ("alpha", "alpha is 0"),
    ("version", "install 9.34 or 9.35"),
    ("version at the first frame", "install 9.34 or 9.35"),
];

#[test]
#[ignore = "make test-all runs it"]
fn the_package_patches_materials_of_babylon_and_removes_the_patch() {
    let Some(report) = package("babylon", &REFUSALS) else { return };
    report.same_as_ours(&[
        "patched again",
        "clone",
        "clone of the clone",
        "from a file",
        "simple class",
        "without uniform buffers",
        "patched after a draw",
        "moved",
    ]);
    report.same_as_stock(&["undone", "clone of the undone"]);
    // Babylon still lights a light with a picture.
    let [ours, stock] =
        ["light with a picture", "stock, light with a picture"].map(|name| report.from_stock[name].mean);
    assert!(ours.to_bits() == stock.to_bits() && stock > 0.001, "{ours} {stock}");
    // In a mirrored scene, rounding can move an edge.
    assert!(report.from_ours["left-handed"].mean < 1e-5, "{:?}", report.from_ours);
    report.differ_from_ours(&[("stock", 0.01), ("elsewhere", 0.01), ("another rule", 0.0001)]);
}
