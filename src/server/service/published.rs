//! The table that KT et al. published, in the format that the page's viewer loads.

use std::sync::LazyLock;

use super::MadeExport;
use ltcforge_files::container::decode_npy;
use ltcforge_fit::ggx_terms;
use ltcforge_textures::{About, Engine, Export};

/// An exact copy of `LUT/alpha_lambda_theta_phi.npy` in the repository of KT et al.
const FILE: &[u8] = include_bytes!("../page/published/kt2022.npy");

const ABOUT: [&str; 3] = [
    "KT, Heitz, Dupuy, Narayanan: Bringing Linearly Transformed Cosines to Anisotropic GGX, 2022",
    "LUT/alpha_lambda_theta_phi.npy of github.com/AakashKT/LTC-Anisotropic, under MIT: kt2022_LICENSE.txt",
    "amplitudes and Fresnel terms: computed for GGX at the nodes, as the file does not contain them",
];

/// The textures of the table, as `ltcforge export --for wgpu` writes them, with the terms of GGX. The first call
/// integrates the terms on the current rayon pool. The size of the pool does not change the result.
///
/// # Errors
/// A message. An error is a bug in this program.
pub fn published_table() -> Result<&'static MadeExport, &'static str> {
    static MADE: LazyLock<Result<MadeExport, String>> = LazyLock::new(|| {
        let mut table = decode_npy(FILE).map_err(|error| error.to_string())?.table;
        table.terms = Some(ggx_terms(table.layout(), table.axes()));
        let bundle = Export::Engine(Engine::Wgpu).bundle(&table, About::new(ABOUT));
        bundle.map(MadeExport::from).map_err(|error| error.to_string())
    });
    MADE.as_ref().map_err(String::as_str)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_textures_have_a_document_and_the_terms_of_ggx() {
        let made = published_table().expect("textures");
        let names: Vec<&str> = made.files.iter().map(|file| file.path.as_str()).collect();
        assert_eq!(names, ["ltc_matrix_a.ktx2", "ltc_matrix_b.ktx2", "ltc_terms.ktx2", "ltc.json", "ltcforge.json"]);
        // The last texel is for the roughest surface at the horizon. It contains the amplitude and the Fresnel term.
        let last: Vec<f32> = made.files[2]
            .bytes
            .rchunks(4)
            .take(4)
            .map(|word| f32::from_le_bytes(word.try_into().expect("4")))
            .collect();
        assert!(last[0] == 0.0 && last[1] > 0.0 && last[2] > last[1] && last[2] < 1.0, "{last:?}");
    }
}
