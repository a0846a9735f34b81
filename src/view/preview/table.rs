//! A table in the form that shaders read.

use half::f16;

use super::{Mode, Scene};
use crate::picture::short_digest;
use ltcforge_fit::{BrdfKind, BrdfModel, Layout, LobeModel, PerAxis, SecondLobe, ShaderAxes, Table, named_list};

named_list! {
    /// The number format of texels.
    pub enum TexelFormat {
        /// 32 bits, as fitted.
        F32 = "f32",
        /// 16 bits, rounded to nearest.
        F16 = "f16",
    }
}

/// A table as shaders read it: three texels per entry, in the order of the file's entries.
#[derive(Debug, Clone, PartialEq)]
pub struct ShaderTable {
    /// The scattering model that the table was fitted to. The references in its pictures use this model.
    pub(super) brdf: BrdfModel,
    /// The distribution that the table fits to a lobe.
    pub(super) lobe: LobeModel,
    pub(super) layout: Layout,
    pub(super) format: TexelFormat,
    /// The axes as shaders read them.
    pub(super) axes: ShaderAxes,
    /// `m00 m01 m02 m10`, `m11 m12 m20 m21`, `m22 amplitude fresnel 0` of each entry, then of each second lobe. The
    /// numbers are rounded to `format`.
    pub(super) texels: [Vec<[f32; 4]>; 3],
    /// The table's name in pictures.
    pub(super) label: Option<String>,
}

impl ShaderTable {
    /// A placeholder for pictures that show no table. The reference in these pictures is GGX.
    #[must_use]
    pub fn none() -> Self {
        let texel = |texel: [f32; 4]| vec![texel];
        Self {
            brdf: BrdfKind::Ggx.into(),
            lobe: LobeModel::Ltc,
            layout: Layout::Kt2022,
            format: TexelFormat::F32,
            axes: Layout::Kt2022.shader_axes(&PerAxis {
                alpha: vec![1.0],
                ratio: vec![1.0],
                theta: vec![0.0],
                phi: vec![0.0],
            }),
            texels: [texel([1.0, 0.0, 0.0, 0.0]), texel([1.0, 0.0, 0.0, 0.0]), texel([1.0, 1.0, 0.0, 0.0])],
            label: None,
        }
    }

    /// The table with its numbers rounded to `format`. A table without terms gets amplitude 1 and Fresnel term 0. In
    /// layout `kt2022`, the surface then reflects all light. In layout `reflected`, it reflects the part that the
    /// reflection in the middle of the lobe reflects. Domain: nodes of the table's layout, as in every file.
    #[must_use]
    pub fn new(table: &Table, format: TexelFormat) -> Self {
        let rounded = |x: f32| match format {
            TexelFormat::F32 => x,
            TexelFormat::F16 => f16::from_f32(x).to_f32(),
        };
        let entry = |lobe: &[[f32; 9]], index: usize| {
            let m = &lobe[index];
            let terms = table.terms.as_ref();
            let (amplitude, fresnel) = terms.map_or((1.0, 0.0), |t| (t.amplitude[index], t.fresnel[index]));
            [[m[0], m[1], m[2], m[3]], [m[4], m[5], m[6], m[7]], [m[8], amplitude, fresnel, table.beside_terms(index)]]
                .map(|texel| texel.map(rounded))
        };
        let lobes: Vec<(&[[f32; 9]], usize)> = [Some(table.matrices()), table.second_matrices()]
            .into_iter()
            .flatten()
            .flat_map(|lobe| (0..lobe.len()).map(move |index| (lobe, index)))
            .collect();
        Self {
            brdf: table.brdf.clone(),
            lobe: table.lobe,
            layout: table.layout,
            format,
            axes: table.shader_axes(),
            texels: [0, 1, 2].map(|texel| lobes.iter().map(|(lobe, index)| entry(lobe, *index)[texel]).collect()),
            label: None,
        }
    }

    /// The table, named in pictures by the first digits of its file's digest.
    #[must_use]
    pub fn labelled(self, digest: &str) -> Self {
        Self { label: Some(short_digest(digest).to_owned()), ..self }
    }

    /// Whether the scene's reference can only run on the CPU. Shaders only have the reference for GGX.
    #[must_use]
    pub fn has_reference_on_cpu_only(&self, scene: &Scene) -> bool {
        self.brdf != BrdfKind::Ggx && scene.mode != Mode::Ltc
    }

    /// The use of the second lobe, if the entries have two lobes.
    #[must_use]
    pub fn second(&self) -> Option<SecondLobe> {
        self.brdf.fresnel().second()
    }

    /// The title in pictures for light by this table.
    pub(super) fn lobe_title(&self) -> String {
        self.lobe.name().to_uppercase()
    }

    /// The title in pictures for the model that the table was fitted to.
    pub(super) fn brdf_title(&self) -> &'static str {
        match self.brdf.kind() {
            BrdfKind::Ggx => "GGX",
            other => other.name(),
        }
    }

    /// The size of the texels in a GPU's memory, in bytes.
    #[must_use]
    pub fn gpu_bytes(&self) -> u64 {
        let number = match self.format {
            TexelFormat::F32 => size_of::<f32>(),
            TexelFormat::F16 => size_of::<f16>(),
        };
        let texels: usize = self.texels.iter().map(Vec::len).sum();
        (texels * 4 * number) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preview::tests::planted;

    #[test]
    fn sixteen_bits_round_to_nearest_and_keep_the_smallest_roughness() {
        let table = planted();
        let (single, half) = (ShaderTable::new(&table, TexelFormat::F32), ShaderTable::new(&table, TexelFormat::F16));
        let mut differ = 0;
        for (a, b) in single.texels.iter().flatten().flatten().zip(half.texels.iter().flatten().flatten()) {
            // Half a unit in the last of 11 bits. Numbers below 2^-14 are 2^-24 apart.
            assert!((a - b).abs() <= (a.abs() / 2048.0).max(2.0_f32.powi(-25)), "{a} {b}");
            differ += usize::from(a != b);
        }
        assert!(differ > single.texels[0].len());
        // Twelve numbers per entry.
        let entries = table.matrix.len() as u64;
        assert_eq!([single.gpu_bytes(), half.gpu_bytes()], [48 * entries, 24 * entries]);
        assert!(half.texels[0][0][0] > 0.0, "alpha = 1e-4 became a singular matrix");
    }
}
