//! The lobes of a glTF material: their roughness along and across, and their reflectance at normal incidence.

use super::{
    document::{AlphaMode, Anisotropy, Clearcoat, Ior, Material, Sheen, Specular, TextureInfo},
    error::{Faults, SceneError, named},
    extensions::{extension, is_ggx, uncovered},
    specification::Specification,
    texture::{Sampled, linear},
    textures::Textures,
};
use ltcforge_fit::{ALPHA_FLOOR, math::atan2};

/// Reflectance of a clear coat at normal incidence, of index 1.5.
const COAT_F0: f64 = 0.04;

/// The kind of a lobe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum LobeKind {
    /// The surface itself: GGX.
    Base,
    /// A clear coat over the surface: isotropic GGX.
    Clearcoat,
    /// Fibres over the surface: Charlie.
    Sheen,
}

/// A lobe at a point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LobeAt {
    pub(super) kind: LobeKind,
    /// The part of the surface that has the lobe.
    pub(super) weight: f64,
    /// The larger roughness, and the smaller one divided by it.
    pub(super) alpha: f64,
    pub(super) ratio: f64,
    /// Angle from the tangent to the axis of the larger roughness, radians.
    pub(super) turn: f64,
    /// Reflectance at normal incidence and its part of the surface: of dielectrics, then of metal.
    pub(super) f0: [[f64; 2]; 2],
    /// The lobe's reflectance at normal and at grazing incidence, for measurements.
    pub(super) formula: [f64; 2],
}

impl LobeAt {
    /// An isotropic lobe of a dielectric.
    pub(super) fn isotropic(kind: LobeKind, weight: f64, alpha: f64, f0: f64) -> Self {
        Self {
            kind,
            weight,
            alpha: alpha.max(ALPHA_FLOOR),
            ratio: 1.0,
            turn: 0.0,
            f0: [[f0, 1.0], [0.0; 2]],
            formula: [f0, 1.0],
        }
    }
}

/// The textures of a material: the index of each in [`Shaded::maps`].
#[derive(Debug, Clone, Copy)]
enum Map {
    Surface,
    Anisotropy,
    Coat,
    CoatRoughness,
    SheenColour,
    SheenRoughness,
    Specular,
    SpecularColour,
    Alpha,
}

/// A material with its textures.
#[derive(Debug)]
pub(super) struct Shaded {
    pub(super) name: String,
    pub(super) double_sided: bool,
    pub(super) has_normal_map: bool,
    base_color: [f64; 4],
    metallic: f64,
    roughness: f64,
    ior: f64,
    specular: Specular,
    /// Extensions that the material lacks have defaults, which change nothing.
    anisotropy: Anisotropy,
    clearcoat: Clearcoat,
    sheen: Sheen,
    alpha_mode: AlphaMode,
    alpha_cutoff: f64,
    maps: [Option<Sampled>; 9],
    /// Whether the base lobe is GGX.
    is_ggx: bool,
    /// The parts of the material's light that no table of one lobe covers.
    pub(super) uncovered: Vec<String>,
    /// Notes about missing textures.
    pub(super) missing: Vec<String>,
}

/// A function that returns the texture coordinates of a set.
type Uv<'a> = dyn Fn(u32) -> [f64; 2] + 'a;

impl Shaded {
    /// Reads a material and, if there are `textures`, its textures.
    pub(super) fn read(
        material: &Material,
        index: Option<usize>,
        mut textures: Option<&mut Textures<'_>>,
    ) -> Result<Self, SceneError> {
        let place = index.map_or_else(String::new, |index| format!("/materials/{index}"));
        let (pbr, extensions) = (&material.pbr_metallic_roughness, &material.extensions);
        let ior: Ior = extension(&place, extensions, "KHR_materials_ior")?;
        let specular: Specular = extension(&place, extensions, "KHR_materials_specular")?;
        let anisotropy: Anisotropy = extension(&place, extensions, "KHR_materials_anisotropy")?;
        let clearcoat: Clearcoat = extension(&place, extensions, "KHR_materials_clearcoat")?;
        let sheen: Sheen = extension(&place, extensions, "KHR_materials_sheen")?;
        // Layers without strength need no textures.
        let anisotropy = if anisotropy.anisotropy_strength == 0.0 { Anisotropy::default() } else { anisotropy };
        let clearcoat = if clearcoat.clearcoat_factor == 0.0 { Clearcoat::default() } else { clearcoat };
        let sheen = if sheen.sheen_color_factor == [0.0; 3] { Sheen::default() } else { sheen };
        let alpha = pbr.base_color_texture.as_ref().filter(|_| material.alpha_mode != AlphaMode::Opaque);
        let wanted: [(&str, Option<&TextureInfo>, &'static [usize]); 9] = [
            ("roughness", pbr.metallic_roughness_texture.as_ref(), &[1, 2]),
            ("anisotropy", anisotropy.anisotropy_texture.as_ref(), &[0, 1, 2]),
            ("clear coat", clearcoat.clearcoat_texture.as_ref(), &[0]),
            ("clear coat's roughness", clearcoat.clearcoat_roughness_texture.as_ref(), &[1]),
            ("sheen's colour", sheen.sheen_color_texture.as_ref(), &[0, 1, 2]),
            ("sheen's roughness", sheen.sheen_roughness_texture.as_ref(), &[3]),
            ("specular factor", specular.specular_texture.as_ref(), &[3]),
            ("specular colour", specular.specular_color_texture.as_ref(), &[0, 1, 2]),
            ("alpha", alpha, &[3]),
        ];
        let (mut maps, mut missing) = ([const { None }; 9], Vec::new());
        for (map, (what, info, channels)) in maps.iter_mut().zip(wanted) {
            let Some(info) = info else { continue };
            let read = match &mut textures {
                Some(textures) => textures.read(&place, info, channels),
                None => Err(SceneError::Missing("a list has no textures".to_owned())),
            };
            match SceneError::split(read)? {
                Ok(texture) => *map = Some(texture),
                Err(why) => missing.push(format!("the texture of its {what} is ignored; its factor is used: {why}")),
            }
        }
        let number = || index.map_or("the default material".to_owned(), |index| format!("material {index}"));
        let mut shaded = Self {
            name: named(material.name.as_deref(), number),
            double_sided: material.double_sided,
            has_normal_map: material.normal_texture.is_some() || clearcoat.clearcoat_normal_texture.is_some(),
            base_color: pbr.base_color_factor,
            metallic: pbr.metallic_factor,
            roughness: pbr.roughness_factor,
            ior: ior.ior,
            specular,
            anisotropy,
            clearcoat,
            sheen,
            alpha_mode: material.alpha_mode,
            alpha_cutoff: material.alpha_cutoff,
            maps,
            is_ggx: is_ggx(extensions),
            uncovered: uncovered(extensions),
            missing,
        };
        shaded.check(&place)?;
        if shaded.specular.specular_factor == 0.0 && shaded.metallic == 0.0 {
            shaded
                .uncovered
                .push("it reflects only diffusely: specularFactor is 0 (KHR_materials_specular)".to_owned());
        }
        Ok(shaded)
    }

    /// Checks that factors are within the bounds of glTF, and reports all faults at once.
    fn check(&self, place: &str) -> Result<(), SceneError> {
        let mut faults = Faults::default();
        let factors = [
            ("pbrMetallicRoughness/metallicFactor", self.metallic),
            ("pbrMetallicRoughness/roughnessFactor", self.roughness),
            // A cutoff above one cuts everything away [glTF 2.0, section 3.9.4].
            ("alphaCutoff", self.alpha_cutoff.min(1.0)),
            ("extensions/KHR_materials_anisotropy/anisotropyStrength", self.anisotropy.anisotropy_strength),
            ("extensions/KHR_materials_clearcoat/clearcoatFactor", self.clearcoat.clearcoat_factor),
            ("extensions/KHR_materials_clearcoat/clearcoatRoughnessFactor", self.clearcoat.clearcoat_roughness_factor),
            ("extensions/KHR_materials_sheen/sheenRoughnessFactor", self.sheen.sheen_roughness_factor),
            ("extensions/KHR_materials_specular/specularFactor", self.specular.specular_factor),
        ];
        let colour = self.base_color.map(|part| ("pbrMetallicRoughness/baseColorFactor", part));
        let sheen = self.sheen.sheen_color_factor.map(|part| ("extensions/KHR_materials_sheen/sheenColorFactor", part));
        for (field, value) in factors.into_iter().chain(colour).chain(sheen) {
            faults.within(format!("{place}/{field}"), value, 1.0);
        }
        for part in self.specular.specular_color_factor {
            faults.within(format!("{place}/extensions/KHR_materials_specular/specularColorFactor"), part, f64::MAX);
        }
        if self.ior != 0.0 && !(1.0..f64::INFINITY).contains(&self.ior) {
            let detail = format!("{} is neither 0 nor at least 1", self.ior);
            faults.add(format!("{place}/extensions/KHR_materials_ior/ior"), detail);
        }
        faults.none()
    }

    /// The shape of a dielectric's lobe: its reflectance at normal incidence divided by its reflectance at grazing
    /// incidence, `min(f0 colour, 1)` by `KHR_materials_specular`. `colour` is the texture's value.
    fn dielectric_f0(&self, colour: [f64; 3]) -> f64 {
        let root = if self.ior > 0.0 { (self.ior - 1.0) / (self.ior + 1.0) } else { 1.0 };
        let tint = self.specular.specular_color_factor;
        luminance([0, 1, 2].map(|i| (root * root * tint[i] * colour[i]).min(1.0)))
    }

    /// The sets of texture coordinates that the material's textures use.
    pub(super) fn sets(&self) -> Vec<u32> {
        let mut sets: Vec<u32> = self.maps.iter().flatten().map(|map| map.set).collect();
        sets.sort_unstable();
        sets.dedup();
        sets
    }

    /// Whether the lobes differ from point to point.
    pub(super) fn is_textured(&self) -> bool {
        self.maps.iter().any(Option::is_some)
    }

    /// Whether a lobe has a direction along the surface.
    pub(super) fn is_anisotropic(&self) -> bool {
        self.is_ggx && self.anisotropy.anisotropy_strength != 0.0
    }

    /// The part of the surface that is not transparent at a point, and the lobes there. Lobes that the material does
    /// not have weigh 0.
    pub(super) fn lobes(&self, uv: &Uv<'_>) -> (f64, [LobeAt; 3]) {
        let map = |map: Map| self.maps[map as usize].as_ref().map(|map| map.at(uv(map.set)));
        let at = |name: Map| map(name).unwrap_or([1.0; 3]);
        let colour = |name: Map| map(name).map_or([1.0; 3], |levels| levels.map(linear));
        let lobe = |kind, weight, roughness: f64| LobeAt::isotropic(kind, weight, roughness * roughness, COAT_F0);

        let [roughness, metallic, _] = at(Map::Surface);
        let mut base = lobe(LobeKind::Base, f64::from(u8::from(self.is_ggx)), self.roughness * roughness);
        let metallic = self.metallic * metallic;
        let (specular, specular_color) =
            (self.specular.specular_factor * at(Map::Specular)[0], colour(Map::SpecularColour));
        let [red, green, blue, factor] = self.base_color;
        // The factor of a dielectric scales all of its lobe, so it is a weight.
        let dielectric = (1.0 - metallic) * specular;
        base.weight *= dielectric + metallic;
        let part = |weight: f64| if weight > 0.0 { weight / (dielectric + metallic) } else { 0.0 };
        base.f0 =
            [[self.dielectric_f0(specular_color), part(dielectric)], [luminance([red, green, blue]), part(metallic)]];
        let tint = self.specular.specular_color_factor;
        let glossy = Specification {
            base_color: [red, green, blue],
            metallic,
            ior: self.ior,
            specular,
            specular_color: [0, 1, 2].map(|i| tint[i] * specular_color[i]),
        };
        base.formula = glossy.reflectance();
        if self.is_anisotropic() {
            let map = map(Map::Anisotropy);
            let direction = map.map_or(0.0, |[x, y, _]| atan2(2.0 * y - 1.0, 2.0 * x - 1.0));
            let strength = self.anisotropy.anisotropy_strength * map.map_or(1.0, |[.., strength]| strength);
            // Along the direction: mix(alpha, 1, strength^2) [KHR_materials_anisotropy].
            let along = base.alpha + (1.0 - base.alpha) * strength * strength;
            (base.alpha, base.ratio) = (along, base.alpha / along);
            base.turn = direction + self.anisotropy.anisotropy_rotation;
        }

        let Clearcoat { clearcoat_factor, clearcoat_roughness_factor, .. } = self.clearcoat;
        let roughness = clearcoat_roughness_factor * at(Map::CoatRoughness)[0];
        let coat = lobe(LobeKind::Clearcoat, clearcoat_factor * at(Map::Coat)[0], roughness);

        let (levels, factors) = (colour(Map::SheenColour), self.sheen.sheen_color_factor);
        let weight = [0, 1, 2].map(|i| levels[i] * factors[i]).into_iter().fold(0.0, f64::max);
        let sheen = lobe(LobeKind::Sheen, weight, self.sheen.sheen_roughness_factor * at(Map::SheenRoughness)[0]);

        let alpha = factor * at(Map::Alpha)[0];
        let part = match self.alpha_mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask => f64::from(u8::from(alpha >= self.alpha_cutoff)),
            AlphaMode::Blend => alpha,
        };
        (part, [base, coat, sheen])
    }
}

/// Relative luminance of linear colours [Rec. 709].
pub(super) fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}
