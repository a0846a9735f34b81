//! A glTF material as the lobes that light gives on it: roughness along and across, reflectance seen from above.

use super::{
    coverage::Coverage,
    document::{Anisotropy, Clearcoat, Extensions, Material, Sheen, TextureInfo},
    error::SceneError,
    reflectance::{Dielectric, Uv, luminance},
    texture::{Sampled, Textures, extension, linear},
};
use ltcforge_fit::{
    ALPHA_FLOOR,
    math::{atan2, sin_cos},
};

/// The kind of a lobe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LobeKind {
    /// The surface's own, GGX.
    Base,
    /// A clear coat over it, GGX and isotropic.
    Clearcoat,
    /// Fibres over it, Charlie.
    Sheen,
}

/// What a lobe is at a point of the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LobeAt {
    pub(super) kind: LobeKind,
    /// How much of it there is: the part of the surface that has it.
    pub(super) weight: f64,
    /// The larger roughness, and the smaller over it.
    pub(super) alpha: f64,
    pub(super) ratio: f64,
    /// From the tangent to the axis of the larger roughness, radians.
    pub(super) turn: f64,
    /// The part that is metal, and its reflectance seen from above.
    pub(super) metal: [f64; 2],
    /// Reflectance seen from above of the rest.
    pub(super) dielectric: f64,
}

/// A material with its textures.
#[derive(Debug)]
pub(super) struct Shaded {
    pub(super) name: String,
    pub(super) double_sided: bool,
    pub(super) has_normal_map: bool,
    base_color: [f64; 3],
    metallic: f64,
    roughness: f64,
    /// Roughness, metallic.
    surface: Option<Sampled>,
    dielectric: Dielectric,
    coverage: Coverage,
    anisotropy: Option<(Anisotropy, Option<Sampled>)>,
    clearcoat: Option<(Clearcoat, Option<Sampled>, Option<Sampled>)>,
    /// With the textures of its colour and of its roughness.
    sheen: Option<(Sheen, Option<Sampled>, Option<Sampled>)>,
    /// Whether its own lobe is one of GGX.
    is_ggx: bool,
    /// What a table does not serve.
    pub(super) uncovered: Vec<String>,
    /// Textures that could not be had, and what stands in their place.
    pub(super) missing: Vec<String>,
}

/// Extensions whose light no table of one lobe gives, and what is left of the material without it.
const NOT_COVERED: [(&str, &str); 6] = [
    ("KHR_materials_transmission", "transmitted light; its reflection is planned for"),
    ("KHR_materials_volume", "light within its volume"),
    ("KHR_materials_diffuse_transmission", "light that comes through it"),
    ("KHR_materials_iridescence", "the colours of its thin film; the lobe is planned for"),
    ("KHR_materials_dispersion", "its dispersion"),
    ("KHR_materials_subsurface", "light below its surface"),
];
/// Extensions that change no lobe, or that a plan takes into account.
const KNOWN: [&str; 7] = [
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_texture_transform",
];
/// Extensions beyond those of materials that are read, or of which something else says what is left out.
const READ: [&str; 8] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_variants",
    "KHR_mesh_quantization",
    "KHR_texture_basisu",
];

/// Whether a plan knows what an extension is.
pub(super) fn is_known(name: &str) -> bool {
    let told = NOT_COVERED.iter().chain(&OTHER_LOBES).map(|(name, _)| name);
    KNOWN.iter().chain(&READ).chain(told).any(|known| *known == name)
}

/// Extensions of materials whose lobe is none of GGX.
const OTHER_LOBES: [(&str, &str); 2] = [
    ("KHR_materials_unlit", "nothing: it is unlit"),
    ("KHR_materials_pbrSpecularGlossiness", "its lobe, by the retired specular and glossiness"),
];

impl Shaded {
    /// Reads a material, with its textures if `textures` can be had. `place` is its pointer.
    pub(super) fn read(
        material: &Material,
        index: Option<usize>,
        mut textures: Option<&mut Textures<'_>>,
    ) -> Result<Self, SceneError> {
        let place = index.map_or_else(String::new, |index| format!("/materials/{index}"));
        let mut missing = Vec::new();
        let mut texture = |what: &str, info: Option<&TextureInfo>, channels: &[usize]| {
            let Some(info) = info else { return Ok(None) };
            let found = match &mut textures {
                Some(textures) => textures.read(info, channels)?,
                None => Err("it cannot be read from a list".to_owned()),
            };
            found.map(Some).or_else(|why| {
                missing
                    .push(format!("the texture of its {what} is left out, and its factor stands for all of it: {why}"));
                Ok::<_, SceneError>(None)
            })
        };
        let of = &material.pbr_metallic_roughness;
        let extensions = &material.extensions;
        let surface = texture("roughness", of.metallic_roughness_texture.as_ref(), &[1, 2])?;
        let anisotropy: Option<Anisotropy> = extension(extensions, "KHR_materials_anisotropy")?;
        let anisotropy = match anisotropy.filter(|of| of.anisotropy_strength != 0.0) {
            Some(of) => {
                let map = texture("anisotropy", of.anisotropy_texture.as_ref(), &[0, 1, 2])?;
                Some((of, map))
            }
            None => None,
        };
        let clearcoat: Option<Clearcoat> = extension(extensions, "KHR_materials_clearcoat")?;
        let clearcoat = match clearcoat.filter(|of| of.clearcoat_factor > 0.0) {
            Some(of) => {
                let factor = texture("clear coat", of.clearcoat_texture.as_ref(), &[0])?;
                let roughness = texture("clear coat's roughness", of.clearcoat_roughness_texture.as_ref(), &[1])?;
                Some((of, factor, roughness))
            }
            None => None,
        };
        let coat_has_normal_map = clearcoat.as_ref().is_some_and(|(of, ..)| of.clearcoat_normal_texture.is_some());
        let sheen: Option<Sheen> = extension(extensions, "KHR_materials_sheen")?;
        let sheen = match sheen.filter(|of| of.sheen_color_factor.iter().any(|colour| *colour > 0.0)) {
            Some(of) => {
                let colour = texture("sheen's colour", of.sheen_color_texture.as_ref(), &[0, 1, 2])?;
                let roughness = texture("sheen's roughness", of.sheen_roughness_texture.as_ref(), &[3])?;
                Some((of, colour, roughness))
            }
            None => None,
        };
        let dielectric = Dielectric::read(extensions, &mut texture)?;
        let coverage = Coverage::read(material, &mut texture)?;
        let of_list = |list: &[(&str, &str)], extensions: &Extensions| -> Vec<String> {
            let found = list.iter().filter(|(name, _)| extensions.contains_key(*name));
            found.map(|(name, what)| format!("{what} ({name})")).collect()
        };
        let other = of_list(&OTHER_LOBES, extensions);
        let listed = |name: &str| NOT_COVERED.iter().chain(&OTHER_LOBES).any(|(known, _)| *known == name);
        let unknown = extensions.keys().filter(|name| !KNOWN.contains(&name.as_str()) && !listed(name));
        let unknown: Vec<String> = unknown.map(|name| format!("what {name} changes")).collect();
        let shaded = Self {
            name: named(material.name.as_deref(), index),
            double_sided: material.double_sided,
            has_normal_map: material.normal_texture.is_some() || coat_has_normal_map,
            base_color: [0, 1, 2].map(|i| of.base_color_factor[i]),
            metallic: of.metallic_factor,
            roughness: of.roughness_factor,
            surface,
            dielectric,
            coverage,
            anisotropy,
            clearcoat,
            sheen,
            is_ggx: other.is_empty(),
            uncovered: other.into_iter().chain(of_list(&NOT_COVERED, extensions)).chain(unknown).collect(),
            missing,
        };
        shaded.check(&place)?;
        Ok(shaded)
    }

    /// Every factor within glTF's bounds, all faults at once.
    fn check(&self, place: &str) -> Result<(), SceneError> {
        let mut faults = super::error::Faults::default();
        let mut unit = |field: &str, value: f64| {
            if !(0.0..=1.0).contains(&value) {
                faults.note(format!("{place}/{field}"), format!("{value} is not from 0 to 1"));
            }
        };
        unit("pbrMetallicRoughness/metallicFactor", self.metallic);
        unit("pbrMetallicRoughness/roughnessFactor", self.roughness);
        let [alpha, cutoff] = self.coverage.numbers();
        self.base_color.iter().chain([&alpha]).for_each(|part| unit("pbrMetallicRoughness/baseColorFactor", *part));
        // A cutoff above one leaves nothing of the material [glTF 2.0, section 3.9.4].
        unit("alphaCutoff", cutoff.min(1.0));
        if let Some((of, _)) = &self.anisotropy {
            unit("extensions/KHR_materials_anisotropy/anisotropyStrength", of.anisotropy_strength);
        }
        if let Some((of, ..)) = &self.clearcoat {
            unit("extensions/KHR_materials_clearcoat/clearcoatFactor", of.clearcoat_factor);
            unit("extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor", of.clearcoat_roughness_factor);
        }
        if let Some((of, ..)) = &self.sheen {
            unit("extensions/KHR_materials_sheen/sheenRoughnessFactor", of.sheen_roughness_factor);
            of.sheen_color_factor
                .iter()
                .for_each(|colour| unit("extensions/KHR_materials_sheen/sheenColorFactor", *colour));
        }
        faults.none()
    }

    /// Its textures.
    fn textures(&self) -> impl Iterator<Item = &Sampled> {
        let of_coat = self.clearcoat.iter().flat_map(|(_, factor, roughness)| [factor, roughness]).flatten();
        let of_anisotropy = self.anisotropy.iter().filter_map(|(_, map)| map.as_ref());
        let of_sheen = self.sheen.iter().flat_map(|(_, colour, roughness)| [colour, roughness]).flatten();
        let of_base = self.surface.iter().chain(self.dielectric.textures()).chain(self.coverage.textures());
        of_base.chain(of_anisotropy).chain(of_coat).chain(of_sheen)
    }

    /// The sets of texture coordinates that its textures are at.
    pub(super) fn sets(&self) -> Vec<u32> {
        let mut sets: Vec<u32> = self.textures().map(|texture| texture.set).collect();
        sets.sort_unstable();
        sets.dedup();
        sets
    }

    /// Whether its lobes differ from point to point.
    pub(super) fn is_textured(&self) -> bool {
        self.textures().next().is_some()
    }

    /// Whether a lobe has a direction along the surface.
    pub(super) fn is_anisotropic(&self) -> bool {
        self.is_ggx && self.anisotropy.is_some()
    }

    /// The lobes at a point, and the part of the surface that is there; `uv` gives the texture coordinates of a set.
    pub(super) fn lobes(&self, uv: &Uv<'_>, lobes: &mut Vec<LobeAt>) -> f64 {
        let at = |map: &Option<Sampled>| map.as_ref().map_or([1.0; 3], |map| map.at(uv(map.set)));
        lobes.clear();
        let plain = |kind, weight, roughness: f64| LobeAt {
            kind,
            weight,
            alpha: (roughness * roughness).max(ALPHA_FLOOR),
            ratio: 1.0,
            turn: 0.0,
            metal: [0.0; 2],
            dielectric: COAT_F0,
        };
        if self.is_ggx {
            let [roughness, metallic, _] = at(&self.surface);
            let metallic = self.metallic * metallic;
            let base = plain(LobeKind::Base, 1.0, self.roughness * roughness);
            let metal = [metallic, luminance(self.base_color)];
            let mut lobe = LobeAt { metal, dielectric: self.dielectric.at(uv), ..base };
            if let Some((of, map)) = &self.anisotropy {
                let [x, y, strength] = map.as_ref().map_or([1.0, 0.5, 1.0], |map| map.at(uv(map.set)));
                let strength = of.anisotropy_strength * strength;
                // Along the direction: mix(alpha, 1, strength^2) [KHR_materials_anisotropy].
                let along = lobe.alpha + (1.0 - lobe.alpha) * strength * strength;
                let direction = if map.is_some() { atan2(2.0 * y - 1.0, 2.0 * x - 1.0) } else { 0.0 };
                (lobe.alpha, lobe.ratio) = (along, lobe.alpha / along);
                lobe.turn = direction + of.anisotropy_rotation;
            }
            lobes.push(lobe);
        }
        if let Some((of, factor, roughness)) = &self.clearcoat {
            let weight = of.clearcoat_factor * at(factor)[0];
            lobes.push(plain(LobeKind::Clearcoat, weight, of.clearcoat_roughness_factor * at(roughness)[0]));
        }
        if let Some((of, colour, roughness)) = &self.sheen {
            let [r, g, b] = at(colour).map(linear);
            let [x, y, z] = of.sheen_color_factor;
            let weight = (r * x).max(g * y).max(b * z);
            lobes.push(plain(LobeKind::Sheen, weight, of.sheen_roughness_factor * at(roughness)[0]));
        }
        self.coverage.at(uv)
    }
}

/// Reflectance of a clear coat seen from above, of index 1.5.
const COAT_F0: f64 = 0.04;

/// A material's name in messages: its own, cut short, or its number.
fn named(name: Option<&str>, index: Option<usize>) -> String {
    match (name, index) {
        (Some(name), _) if !name.trim().is_empty() => name.chars().filter(|c| !c.is_control()).take(80).collect(),
        (_, Some(index)) => format!("material {index}"),
        (_, None) => "the default material".to_owned(),
    }
}

/// The azimuth of a view in the quadrant that a table has, from the axis of the larger roughness.
pub(super) fn folded(x: f64, y: f64, turn: f64) -> f64 {
    let (sin, cos) = sin_cos(turn);
    atan2((cos * y - sin * x).abs(), (cos * x + sin * y).abs())
}
