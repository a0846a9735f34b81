//! `light-texture`: a picture on a light.

use std::{path::PathBuf, str::FromStr as _};

use clap::Args;

use super::{Threads, named};
use ltcforge_textures::{LightSize, LightTexels, TextureContainer, TransferFunction};

/// `light-texture`.
#[derive(Debug, Args)]
pub struct LightTextureArgs {
    /// The picture: PNG, `OpenEXR`, Radiance HDR or JPEG; or an IES profile, `docs/textured.md`
    #[arg(value_name = "IMAGE")]
    pub picture: PathBuf,
    /// The folder; it is made if it is missing
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,
    /// The size of the light, in any unit: texels become square on it [default: they are square already]
    #[arg(long, value_name = "WxH", value_parser = LightSize::from_str)]
    pub light: Option<LightSize>,
    /// What the picture's numbers stand for [default: `OpenEXR` and Radiance HDR linear, JPEG sRGB, PNG what it says, else
    /// sRGB]
    #[arg(long, value_parser = named(TransferFunction::ALL, TransferFunction::name))]
    pub transfer: Option<TransferFunction>,
    /// The format: all levels in one file of KTX2, or a file of another format for each level
    #[arg(long = "as", value_name = "NAME", default_value = TextureContainer::ALL[0].name(), value_parser = named(TextureContainer::ALL, TextureContainer::name))]
    pub container: TextureContainer,
    /// How texels are stored
    #[arg(long, default_value = LightTexels::ALL[0].name(), value_parser = named(LightTexels::ALL, LightTexels::name))]
    pub texels: LightTexels,
    /// The name of the files: 1 to 60 letters, digits and underscores, a letter first
    #[arg(long, default_value = "light", value_parser = file_name)]
    pub name: String,
    /// How many threads make the levels
    #[command(flatten)]
    pub threads: Threads,
}

fn file_name(text: &str) -> Result<String, String> {
    let is_name = text.len() <= 60
        && text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    is_name
        .then(|| text.to_owned())
        .ok_or_else(|| "it is 1 to 60 letters, digits and underscores, a letter first".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_checked() {
        assert_eq!(file_name("tv_1").as_deref(), Ok("tv_1"));
        let long = "a".repeat(61);
        for wrong in ["", "1a", "a/b", "..", "a-b", &long] {
            assert!(file_name(wrong).is_err(), "{wrong}");
        }
    }
}
