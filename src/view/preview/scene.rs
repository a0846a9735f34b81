//! The scene of a preview, with defaults. [`super::parameters`] lists the fields that callers can choose.

use serde::{Deserialize, Serialize};

use super::ScenePicture;
use ltcforge_fit::named_list;
use ltcforge_light::{AnisotropicRoughness, LightModel, LightShape, normals::NormalsRule, textured::Readings};

/// The largest number of materials in a picture.
pub(super) const MAX_MATERIALS: usize = 4;

/// The models that mode `models` compares.
pub(super) const COMPARED: [LightModel; 3] = [LightModel::Ltc, LightModel::LtcFormula, LightModel::Normals];

/// The scene of a preview. Lengths are in radii of the sphere, angles are in radians, and y points up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Scene {
    /// The surface.
    pub surface: Surface,
    /// One material, or two to four materials in two columns.
    pub materials: Vec<Material>,
    /// Reflectance at normal incidence, linear sRGB. At grazing incidence it is one.
    pub f0: [f64; 3],
    /// The light.
    pub light: Light,
    /// The picture on the light.
    pub picture: ScenePicture,
    /// Texture reads of a model per shaded point.
    pub readings: Readings,
    /// The camera.
    pub camera: Camera,
    /// The view direction for mode `lobe`. The lobe's roughness is that of the first material.
    pub lobe: LobeView,
    /// Side of each panel in pixels.
    pub size: u32,
    /// Samples per pixel of the reference. Each sample is a visible normal and a point of the light.
    pub spp: u32,
    /// The kind of picture.
    pub mode: Mode,
    /// The model of light.
    pub model: LightModel,
    /// The rule of model `normals`.
    pub rule: NormalsRule,
    /// Whether an LTC cuts the light and the lobe at the surface, so that no light comes from below the surface.
    pub cut: bool,
    /// Whether the light that is lost between facets is added back, by the factor `1 + f0 (1 / albedo - 1)`.
    pub compensate: bool,
    /// A factor on the radiance before display.
    pub exposure: f64,
    /// The radiance difference at the ends of the colour bar; 0 fits the picture.
    pub difference_scale: f64,
}

/// The shape of the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Surface {
    /// A sphere of radius one around the origin. Its tangents follow circles of latitude.
    Sphere,
    /// The plane y = 0. Its tangents point along x.
    Floor,
}

/// The roughness of an anisotropic metal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Material {
    /// GGX roughness along the tangent.
    pub alpha_x: f64,
    /// GGX roughness across the tangent.
    pub alpha_y: f64,
    /// Rotation of the tangent frame about the normal.
    pub rotation: f64,
}

/// A light with uniform emission.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Light {
    /// The shape.
    pub kind: LightKind,
    /// The centre.
    pub centre: [f64; 3],
    /// Half the width and half the height. For a sphere, the first number is the radius, and the second is ignored. For
    /// a tube or line, the first number is half the distance between its ends. The second is the tube's radius, or half
    /// the line's width.
    pub half_size: [f64; 2],
    /// Yaw, pitch and roll away from an upright light that faces the origin. They are applied in reverse order.
    pub rotation: [f64; 3],
    /// Radiance.
    pub intensity: f64,
    /// Whether the back also emits. Spheres, tubes and lines emit to all sides.
    pub two_sided: bool,
}

/// A light's shape.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LightKind {
    /// A rectangle.
    Rectangle,
    /// An ellipse.
    Disk,
    /// A sphere.
    Sphere,
    /// All points up to a radius from a line: a cylinder with round ends.
    Tube,
    /// The limit of a thin tube. Its light is proportional to its diameter.
    Line,
    /// A regular polygon with one vertex at the top, stretched to the half sizes.
    Polygon(u32),
}

/// A pinhole camera.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Camera {
    /// Distance from the target.
    pub distance: f64,
    /// Angle about +y, from +z towards +x.
    pub azimuth: f64,
    /// Angle above the horizontal.
    pub elevation: f64,
    /// Full angle of view.
    pub field_of_view: f64,
    /// The point in the middle of the picture.
    pub target: [f64; 3],
}

/// A view direction in the tangent frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LobeView {
    /// Polar angle.
    pub theta: f64,
    /// Azimuth.
    pub phi: f64,
}

named_list! {
    /// The modes of a preview.
    pub enum Mode {
        /// Light by the model.
        Ltc = "ltc",
        /// Light by Monte Carlo integration of the BRDF itself.
        Reference = "reference",
        /// The difference between modes `ltc` and `reference` in false colours, with the colour scale.
        Difference = "difference",
        /// Modes `ltc`, `reference` and `difference` next to each other.
        Strip = "strip",
        /// The reference, the light by the table and by the closed form, and their differences from the reference.
        Models = "models",
        /// The BRDF's lobe and the fitted lobe, on the sphere of directions.
        Lobe = "lobe",
        /// Occluders on the surface: the truth, one sample by solid angle, one sample by the sampler, and four samples
        /// with the closed form. Only on the CPU, for polygons.
        Shadows = "shadows",
    }
}

impl Scene {
    /// The scene with defaults for the parameters that its mode does not show.
    #[must_use]
    pub fn canonical(self) -> Self {
        let usual = Self { mode: self.mode, size: self.size, ..Self::default() };
        let rule = if self.shows(LightModel::Normals) { self.rule } else { usual.rule };
        let is_read = self.picture != ScenePicture::None && self.mode != Mode::Reference;
        let readings = if is_read { self.readings } else { usual.readings };
        let is_of_ltcs = LightModel::ALL.iter().any(|model| model.is_of_ltcs() && self.shows(*model));
        let cut = self.cut && self.mode != Mode::Lobe && is_of_ltcs;
        match self.mode {
            Mode::Ltc => {
                let Self { lobe, spp, difference_scale, .. } = usual;
                Self { readings, lobe, spp, rule, cut, difference_scale, ..self }
            }
            Mode::Reference => {
                let Self { lobe, model, difference_scale, .. } = usual;
                Self { readings, lobe, model, rule, cut, difference_scale, ..self }
            }
            // False colours show radiance, so the exposure does not matter.
            Mode::Difference => Self { lobe: usual.lobe, exposure: usual.exposure, rule, readings, cut, ..self },
            Mode::Strip => Self { lobe: usual.lobe, rule, readings, cut, ..self },
            Mode::Models => Self { lobe: usual.lobe, model: usual.model, readings, ..self },
            Mode::Shadows => {
                let Self { lobe, model, picture, difference_scale, .. } = usual;
                let materials = self.materials.iter().take(1).copied().collect();
                Self {
                    materials,
                    lobe,
                    model,
                    picture,
                    readings: usual.readings,
                    difference_scale,
                    cut: false,
                    compensate: false,
                    ..self
                }
            }
            Mode::Lobe => {
                let roughness = |material: &Material| Material { rotation: 0.0, ..*material };
                Self { materials: self.materials.iter().take(1).map(roughness).collect(), lobe: self.lobe, ..usual }
            }
        }
    }
}

impl Scene {
    /// Whether the picture needs a table.
    #[must_use]
    pub fn needs_table(&self) -> bool {
        self.shows(LightModel::Ltc)
    }

    /// Whether the picture shows light by a model.
    #[must_use]
    pub fn shows(&self, model: LightModel) -> bool {
        match self.mode {
            Mode::Ltc | Mode::Difference | Mode::Strip => self.model == model,
            Mode::Models => COMPARED.contains(&model),
            Mode::Lobe => model == LightModel::Ltc,
            Mode::Shadows => model == LightModel::Normals,
            Mode::Reference => false,
        }
    }
}

impl LightKind {
    /// The shapes with a name in parameters.
    pub const NAMED: [(&str, Self); 10] = [
        ("rectangle", Self::Rectangle),
        (LightShape::Disk.name(), Self::Disk),
        (LightShape::Sphere.name(), Self::Sphere),
        (LightShape::Tube.name(), Self::Tube),
        (LightShape::Line.name(), Self::Line),
        ("triangle", Self::Polygon(3)),
        ("pentagon", Self::Polygon(5)),
        ("hexagon", Self::Polygon(6)),
        ("heptagon", Self::Polygon(7)),
        ("octagon", Self::Polygon(8)),
    ];

    /// The shape's name, or `polygon`.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMED.iter().find(|(_, kind)| *kind == self).map_or("polygon", |(name, _)| name)
    }
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            surface: Surface::Sphere,
            materials: vec![Material::default()],
            f0: [0.91, 0.92, 0.92],
            light: Light::default(),
            picture: ScenePicture::None,
            readings: Readings::ALL[0],
            camera: Camera::default(),
            lobe: LobeView::default(),
            size: 512,
            spp: 1024,
            mode: Mode::Ltc,
            model: LightModel::Ltc,
            rule: NormalsRule::Balanced,
            cut: false,
            compensate: false,
            exposure: 1.0,
            difference_scale: 0.0,
        }
    }
}

impl From<AnisotropicRoughness> for Material {
    fn from(AnisotropicRoughness { alpha_x, alpha_y, rotation }: AnisotropicRoughness) -> Self {
        Self { alpha_x, alpha_y, rotation }
    }
}

impl Default for Material {
    fn default() -> Self {
        Self { alpha_x: 0.5, alpha_y: 0.1, rotation: 0.0 }
    }
}

impl Default for Light {
    fn default() -> Self {
        Self {
            kind: LightKind::Rectangle,
            centre: [-1.6, 1.8, 2.2],
            half_size: [1.0, 0.6],
            rotation: [0.0; 3],
            intensity: 3.0,
            two_sided: false,
        }
    }
}

impl Default for Camera {
    fn default() -> Self {
        Self { distance: 4.5, azimuth: 0.0, elevation: 0.2, field_of_view: 0.5, target: [0.0; 3] }
    }
}

impl Default for LobeView {
    fn default() -> Self {
        Self { theta: 1.0, phi: 0.6 }
    }
}
