//! Names that the command line has for the choices of a preview and of a shader.

use clap::{ValueEnum, builder::PossibleValue};
use serde::{Deserialize, Deserializer, de::Error as _};

use crate::{
    fit::Layout,
    view::{
        preview::{Adapter, LightKind, Mode, NamedScene, TexelFormat},
        shaders::Language,
    },
};

/// A choice under its name on the command line.
macro_rules! names {
    ($($(#[$doc:meta])* $name:ident($choice:ty) { $($text:literal => $value:expr),* $(,)? })*) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub struct $name(pub $choice);

        impl ValueEnum for $name {
            fn value_variants<'a>() -> &'a [Self] {
                &[$(Self($value)),*]
            }

            fn to_possible_value(&self) -> Option<PossibleValue> {
                $(if self.0 == $value {
                    return Some(PossibleValue::new($text));
                })*
                None
            }
        }
    )*};
}

names! {
    /// A named scene.
    SceneName(NamedScene) {
        "sphere" => NamedScene::Sphere,
        "figure14" => NamedScene::Figure14,
        "brushed_floor" => NamedScene::BrushedFloor,
        "tiny_light" => NamedScene::TinyLight,
        "horizon" => NamedScene::Horizon,
    }
    /// What is shown.
    ModeName(Mode) {
        "ltc" => Mode::Ltc,
        "reference" => Mode::Reference,
        "difference" => Mode::Difference,
        "strip" => Mode::Strip,
        "lobe" => Mode::Lobe,
    }
    /// A light's outline.
    LightName(LightKind) {
        "rectangle" => LightKind::Rectangle,
        "disk" => LightKind::Disk,
        "triangle" => LightKind::Polygon(3),
        "pentagon" => LightKind::Polygon(5),
        "hexagon" => LightKind::Polygon(6),
        "heptagon" => LightKind::Polygon(7),
        "octagon" => LightKind::Polygon(8),
    }
    /// Bits of a number of a table on the GPU.
    TexelFormatName(TexelFormat) {
        "f32" => TexelFormat::F32,
        "f16" => TexelFormat::F16,
    }
    /// A shader's language.
    LanguageName(Language) {
        "wgsl" => Language::Wgsl,
        "glsl" => Language::Glsl,
        "hlsl" => Language::Hlsl,
        "msl" => Language::Msl,
        "spirv" => Language::Spirv,
    }
    /// A table's layout.
    LayoutName(Layout) {
        "reflected" => Layout::Reflected,
        "kt2022" => Layout::Kt2022,
    }
    /// What renders.
    AdapterName(Adapter) {
        "any" => Adapter::Any,
        "gpu" => Adapter::Gpu,
        "cpu" => Adapter::Cpu,
    }
}

/// In a configuration file, by the same name.
impl<'de> Deserialize<'de> for AdapterName {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let name = String::deserialize(from)?;
        <Self as ValueEnum>::from_str(&name, false)
            .map_err(|_| D::Error::custom(format!("«{name}» is no adapter; it is one of any, gpu, cpu")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_modes_lights_and_languages_have_one_name_everywhere() {
        let named: Vec<&str> = NamedScene::ALL.map(NamedScene::name).into();
        let listed = |value: Option<PossibleValue>| value.map(|value| value.get_name().to_owned());
        let scenes: Vec<_> = SceneName::value_variants().iter().filter_map(|v| listed(v.to_possible_value())).collect();
        assert_eq!(scenes, named);
        let modes: Vec<_> = ModeName::value_variants().iter().filter_map(|v| listed(v.to_possible_value())).collect();
        assert_eq!(modes, Mode::ALL.map(Mode::name));
        let languages: Vec<_> =
            LanguageName::value_variants().iter().filter_map(|v| listed(v.to_possible_value())).collect();
        assert_eq!(languages, Language::ALL.map(Language::name));
        let lights: Vec<_> = LightName::value_variants().iter().map(|v| (listed(v.to_possible_value()), v.0)).collect();
        assert_eq!(lights, LightKind::NAMED.map(|(name, kind)| (Some(name.to_owned()), kind)));
    }
}
