//! The measure of faults along paths finds planted faults, and none in the exact visible part.

use ltcforge::light::normals::visible;
use ltcforge_studies::{lights::Lit, paths::measure};

fn exact(lit: &Lit) -> f64 {
    visible(lit.alpha(), lit.wo(), &lit.vertices).abs()
}

#[test]
fn the_exact_visible_part_grows_smoothly() {
    let faults = measure(5, 0.05, |lit| [exact(lit), 0.0]);
    assert!(faults.lost == 0.0 && faults.to_one_side[0] < 1e-9 && faults.about_middle[0][1] < 1e-9, "{faults:?}");
    assert!(faults.false_steps[1] == 0.0, "{faults:?}");
}

/// A part that falls when it is large, and one whose slope changes its sign.
#[test]
fn planted_faults_are_found() {
    let falls = measure(5, 0.05, |lit| [exact(lit) * (1.0 - 0.3 * exact(lit).powi(8)), 0.0]);
    assert!(falls.to_one_side[0] > 0.01 && falls.about_middle[0][0] > 0.01, "{falls:?}");
    let bends = measure(5, 0.05, |lit| [((20.0 * exact(lit)).fract() - 0.5).abs(), 0.0]);
    assert!(bends.false_steps[0] > 0.2, "{bends:?}");
    // A clamp, of the energy or of Schlick's part.
    let clamped = |lit: &Lit| exact(lit).min(0.3);
    let metal = measure(5, 0.5, |lit| [clamped(lit), 0.0]).false_steps;
    let plastic = measure(5, 0.5, |lit| [0.0, clamped(lit)]).false_steps;
    assert!(metal[0] > 0.1 && plastic[1] > 0.1, "{metal:?} {plastic:?}");
}
