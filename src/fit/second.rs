//! Computes the stored second lobe of an entry from the lobe that was fitted for it.

use glam::DMat3;

use super::{
    brdf::{LobeTerms, Mirrors, SecondLobe},
    entry::FittedEntry,
    layout::{Layout, LobeNumbers},
    math::{from_row_major, row_major},
    shard::Plan,
    table::blend_weight,
};

/// The smallest weight for the second matrix. Below this weight, the blend is nearly the first lobe. The difference of
/// the two lobes divided by the weight would be mostly the noise of two fits. With limits from 0.02 to 0.2, the error
/// of the default table differs by less than 2 %.
const LEAST_WEIGHT: f64 = 0.05;
/// The smallest determinant of the second matrix, relative to the determinant of the first matrix. No blend between the
/// two matrices is then flat.
const LEAST_DETERMINANT: f64 = 1.0 / 16.0;

/// Copies of the entries whose `matrix` is the stored second matrix, in storage order; `None` for a plan with one lobe
/// per entry.
///
/// The second lobe of [`SecondLobe::Integrated`] is stored as fitted. The lobe of [`SecondLobe::Blended`] was fitted
/// for one F0. The entry stores the matrix whose blend with the first matrix, at the weight of this F0, is the fitted
/// matrix: see [`beyond`].
pub(super) fn entries(plan: &Plan, entries: &[FittedEntry]) -> Option<Vec<FittedEntry>> {
    let second = plan.recipe().brdf.fresnel().second()?;
    let of_entry = |(index, entry): (u64, &FittedEntry)| {
        let fitted = entry.second.unwrap_or(entry.matrix);
        let matrix = match second {
            SecondLobe::Integrated => fitted,
            SecondLobe::Blended => end_of_blend(plan, index, entry, &fitted),
        };
        FittedEntry { matrix, second: None, ..*entry }
    };
    Some((0..).zip(entries).map(of_entry).collect())
}

/// The second matrix, row-major. Its blend with the entry's matrix is the lobe fitted for one F0. The blend uses the
/// numbers that the layout's lookup blends.
fn end_of_blend(plan: &Plan, index: u64, entry: &FittedEntry, fitted: &[f64; 9]) -> [f64; 9] {
    let (place, recipe) = (plan.place(index), plan.recipe());
    // Layouts of isotropic tables store the matrix of the lobe or its inverse. Lookups blend the matrix of the lobe.
    let gauge = if recipe.layout.free_numbers().is_some() { Layout::Godot } else { recipe.layout };
    let rules = gauge.rules();
    let terms = LobeTerms { amplitude: entry.amplitude, fresnel: entry.fresnel };
    let stored = |matrix: &[f64; 9]| {
        let lobe = LobeNumbers { matrix: from_row_major(matrix), terms };
        let stored = rules.store(&place, &lobe, Mirrors::of(place.view()), recipe.precision);
        stored.matrix * (1.0 / stored.matrix.z_axis.length())
    };
    let weight = blend_weight(terms, SecondLobe::Blended.fitted_f0(), 1.0);
    let matrix = beyond(&stored(&entry.matrix), &stored(fitted), weight.max(LEAST_WEIGHT));
    row_major(&rules.restore(&place, &LobeNumbers { matrix, terms }).matrix)
}

/// The matrix `E` whose blend with `M` at weight `w` has the lobe of `B`. All three matrices have a third column of
/// unit length:
///
/// ```text
/// E = (s B - (1 - w) M) / w,    s = (1 - w) c + sqrt(w^2 - (1 - w)^2 (1 - c^2))
/// ```
///
/// with `c` the cosine between the third columns of `M` and `B`. If no `s` gives a third column of unit length, or if
/// `E` is nearly flat, `w` is doubled until neither is the case. `E` is then nearer to `B`.
fn beyond(first: &DMat3, blend: &DMat3, weight: f64) -> DMat3 {
    let mut weight = weight;
    while weight < 1.0 {
        let rest = 1.0 - weight;
        let cosine = first.z_axis.dot(blend.z_axis);
        let square = weight * weight - rest * rest * (1.0 - cosine * cosine);
        if square >= 0.0 {
            let end = (*blend * (rest * cosine + square.sqrt()) - *first * rest) * (1.0 / weight);
            let is_open = end.x_axis.x > 0.0 && end.y_axis.y > 0.0;
            if is_open && end.determinant() >= LEAST_DETERMINANT * first.determinant() {
                return end;
            }
        }
        // Doubling the weight halves the distance beyond the blend.
        weight *= 2.0;
    }
    *blend
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::table::blended;

    fn matrix(numbers: [f64; 6]) -> DMat3 {
        let [a, b, c, x, y, tilt] = numbers;
        let z = DVec3::new(x, y, 1.0).normalize();
        DMat3::from_cols(DVec3::new(a, b, tilt), DVec3::new(b, c, 0.1), z)
    }

    fn numbers() -> impl Strategy<Value = [f64; 6]> {
        [0.4..0.6, -0.1..0.1, 0.4..0.6, -0.2..0.2, -0.2..0.2, -0.1..0.1]
    }

    proptest! {
        #[test]
        fn the_blend_with_the_second_matrix_is_the_fitted_lobe(m in numbers(), b in numbers(), weight in 0.55..1.0) {
            let (first, blend) = (matrix(m), matrix(b));
            let end = beyond(&first, &blend, weight);
            prop_assert!((end.z_axis.length() - 1.0).abs() < 1e-12);
            let found = blended(&first, &end, weight);
            let scaled = found * (1.0 / found.z_axis.length());
            prop_assert!(scaled.abs_diff_eq(blend, 1e-12), "{} {}", scaled, blend);
        }
    }

    #[test]
    fn a_weight_with_a_flat_matrix_is_raised() {
        let first = DMat3::from_diagonal(DVec3::new(0.8, 0.5, 1.0));
        let blend = DMat3::from_diagonal(DVec3::new(0.4, 0.5, 1.0));
        // At a weight of 0.4 the second matrix would have a width of -0.2.
        let end = beyond(&first, &blend, 0.4);
        assert!(end.x_axis.x > 0.0 && end.x_axis.x < 0.4, "{end}");
        assert!(end.determinant() >= LEAST_DETERMINANT * first.determinant());
    }
}
