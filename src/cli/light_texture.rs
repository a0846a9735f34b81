//! `light-texture`: the prefiltered pyramid of a picture on a light.

use std::{fmt::Write as _, path::PathBuf, str::FromStr as _};

use clap::Args;
use serde_json::json;

use super::{
    CommandFailure, Context, Exit, Threads, check_output_folder, file_failure, light_picture::PICTURE_LIMIT_BYTES,
    listed, named, usage, write_in,
};
use ltcforge_files::bounded::read_named;
use ltcforge_light::textured::MOST_SQUARE_TEXELS;
use ltcforge_textures::{
    LightSize, LightTexels, LightTexture, LightTextureError, LightTextureOptions, MOST_PIXELS, PROFILE_FORMAT,
    TextureContainer, TransferFunction, light_texture,
};

/// `light-texture`.
#[derive(Debug, Args)]
pub struct LightTextureArgs {
    /// Picture (PNG, `OpenEXR`, Radiance HDR, JPEG) or IES profile
    #[arg(value_name = "IMAGE")]
    pub picture: PathBuf,
    /// Output folder, created if missing
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,
    /// Size of the light, to make texels square on it [default: as the picture]
    #[arg(long, value_name = "WxH", value_parser = LightSize::from_str)]
    pub light: Option<LightSize>,
    /// Transfer function of the picture [default: from its format]
    #[arg(long, value_parser = named(TransferFunction::ALL, TransferFunction::name))]
    pub transfer: Option<TransferFunction>,
    /// Output format; formats other than KTX2 write a file per level
    #[arg(long = "as", value_name = "NAME", default_value = TextureContainer::ALL[0].name(), value_parser = named(TextureContainer::ALL, TextureContainer::name))]
    pub container: TextureContainer,
    /// Texel format
    #[arg(long, default_value = LightTexels::ALL[0].name(), value_parser = named(LightTexels::ALL, LightTexels::name))]
    pub texels: LightTexels,
    /// File name of 1 to 60 letters, digits and _, starting with a letter
    #[arg(long, default_value = "light", value_parser = file_name)]
    pub name: String,
    /// Threads.
    #[command(flatten)]
    pub threads: Threads,
}

fn file_name(text: &str) -> Result<String, &'static str> {
    let is_name = text.len() <= 60
        && text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    is_name.then(|| text.to_owned()).ok_or("use 1 to 60 letters, digits and _; the name must start with a letter")
}

/// Writes the files and lists them. Rejects an invalid picture before it writes anything.
pub(super) fn run(args: &LightTextureArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    check_output_folder(&args.out)?;
    let refuse = |error: &dyn std::fmt::Display| file_failure(&args.picture, error);
    let bytes = read_named(&args.picture, PICTURE_LIMIT_BYTES).map_err(|error| refuse(&error))?;
    let LightTextureArgs { light, transfer, container, texels, .. } = *args;
    let options = LightTextureOptions { light, transfer, container, texels, most_pixels: MOST_PIXELS };
    let made = args.threads.pool()?.install(|| light_texture(&bytes, &args.name, &options));
    let made = made.map_err(|error| match error {
        LightTextureError::Files(error) => usage(error),
        error => refuse(&error),
    })?;
    let LightTexture { format, transfer, primaries, picture, size, levels, texels, error, clamped, files } = &made;
    let unit = if *format == PROFILE_FORMAT { "angles" } else { "pixels" };
    let ([across, down], [width, height]) = (picture, size);
    let mut text = format!(
        "{format}, {across} x {down} {unit}, {transfer}, {primaries}; {levels} levels from {width} x {height} texels, {texels}\n"
    );
    let mut list = Vec::new();
    for file in files {
        let path = write_in(&args.out, &file.name, &file.bytes)?;
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}  {} bytes", path.display(), file.bytes.len());
        list.push(listed(&path, &file.bytes));
    }
    let mut value = json!(made);
    value["files"] = list.into();
    if *format != PROFILE_FORMAT && (0..2).any(|i| size[i] < picture[i]) {
        let [along, in_all] = MOST_SQUARE_TEXELS;
        let _ = writeln!(text, "coarser than the picture: the limit is {along} texels per side and {in_all} in total");
    }
    if *error > 0.0 {
        let _ = writeln!(text, "rounded: a channel changes by at most {error:.1e} of the texel's largest channel");
    }
    if *clamped > 0 {
        let _ = writeln!(text, "{clamped} numbers are too large for {texels} and were clamped");
    }
    context.print(&value, text.trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_checked() {
        assert_eq!(file_name("tv_1"), Ok("tv_1".to_owned()));
        let long = "a".repeat(61);
        for wrong in ["", "1a", "a/b", "..", "a-b", &long] {
            assert!(file_name(wrong).is_err(), "{wrong}");
        }
    }
}
