//! The table that engines with two 64 x 64 textures ship today, published by Heitz et al. in 2017 for a Fresnel factor
//! of one.

use half::f16;

use ltcforge_fit::{BrdfKind, Layout, LobeModel, Table, Terms};

/// Exact copies of `ltc_1.dds` and `ltc_2.dds`, with their licence in `ltc2017_LICENSE.txt`.
const FILES: [&[u8]; 2] = [
    include_bytes!("../../server/page/published/ltc2017_1.dds"),
    include_bytes!("../../server/page/published/ltc2017_2.dds"),
];
/// The bytes of a DDS header with the extension of Direct3D 10.
const HEADER: usize = 128;

/// The published table.
pub(super) fn published() -> Option<Table> {
    let layout = Layout::Ltc2017;
    let axes = layout.nodes(&layout.only_ranges()?, &layout.default_resolution());
    let texels = FILES.map(|file| -> Vec<[f32; 4]> {
        let (texels, _) = file[HEADER..].as_chunks::<8>();
        let halves = |texel: &[u8; 8]| [0, 2, 4, 6].map(|at| f16::from_le_bytes([texel[at], texel[at + 1]]).to_f32());
        texels.iter().map(halves).collect()
    });
    let side = axes.theta.len();
    // The roughness varies fastest in the files and slowest in the table.
    let entries = || (0..side * side).map(|entry| entry % side * side + entry / side);
    let matrix = |[m00, m20, m02, m22]: [f32; 4]| [m00, 0.0, m02, 0.0, 1.0, 0.0, m20, 0.0, m22];
    let term = |channel: usize| entries().map(|texel| texels[1][texel][channel]).collect();
    Some(Table {
        brdf: BrdfKind::Ggx.into(),
        lobe: LobeModel::Ltc,
        layout,
        matrix: entries().map(|texel| matrix(texels[0][texel])).collect(),
        second: None,
        terms: Some(Terms { amplitude: term(0), fresnel: term(1), edge: None }),
        node_error: vec![0.0; side * side],
        axes,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge_fit::{Configuration, ggx_terms};

    /// Its terms are those of GGX, and its lobe lies around the reflection.
    #[test]
    fn the_published_table_is_read_in_the_order_of_tables() {
        let table = published().expect("a layout of one size");
        let (found, wanted) = (table.terms.clone().expect("terms"), ggx_terms(table.layout, &table.axes));
        let off = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f32>() / a.len() as f32;
        let [amplitude, fresnel] = [off(&found.amplitude, &wanted.amplitude), off(&found.fresnel, &wanted.fresnel)];
        assert!(amplitude < 0.01 && fresnel < 0.01, "{amplitude} {fresnel}");
        let at = Configuration { alpha_x: 0.04, alpha_y: 0.04, theta: 0.8, phi: 0.0 };
        let matrix = table.lookup(&at).matrix;
        assert!(matrix[2] * matrix[8] < 0.0, "{matrix:?}");
    }
}
