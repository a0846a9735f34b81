//! The names of choices of previews and shaders on the command line.

use clap::{ValueEnum, builder::PossibleValue};
use serde::{Deserialize, Deserializer, de::Error as _};

use ltcforge_shaders::Language;
use ltcforge_view::preview::{Adapter, TexelFormat};

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
    /// The bits of a table's number on the GPU.
    TexelFormatName(TexelFormat) {
        "f32" => TexelFormat::F32,
        "f16" => TexelFormat::F16,
    }
    /// A shader's language.
    LanguageName(Language) {
        "wgsl" => Language::Wgsl,
        "glsl" => Language::Glsl,
        "glsl-330" => Language::Glsl330,
        "glsl-es" => Language::GlslEs,
        "hlsl" => Language::Hlsl,
        "msl" => Language::Msl,
        "spirv" => Language::Spirv,
    }
    /// The renderer.
    AdapterName(Adapter) {
        "any" => Adapter::Any,
        "gpu" => Adapter::Gpu,
        "cpu" => Adapter::Cpu,
    }
}

/// Configuration files have the same names.
impl<'de> Deserialize<'de> for AdapterName {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let name = String::deserialize(from)?;
        <Self as ValueEnum>::from_str(&name, false)
            .map_err(|_| D::Error::custom(format!("«{name}» is not an adapter; the adapters are any, gpu, cpu")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn languages_have_one_name_everywhere() {
        let values = LanguageName::value_variants().iter();
        let names: Vec<_> = values.filter_map(|v| Some(v.to_possible_value()?.get_name().to_owned())).collect();
        assert_eq!(names, Language::ALL.map(Language::name));
    }
}
