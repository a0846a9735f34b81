//! `light-texture`: the prefiltered pyramid of a picture on a light.

use std::fmt::Write as _;

use serde_json::json;

use super::{
    CommandFailure, Context, Exit,
    args::LightTextureArgs,
    exit::usage,
    file_failure,
    light_picture::PICTURE_LIMIT_BYTES,
    output::{check_output_folder, listed, write_in},
};
use ltcforge_files::bounded::read_file;
use ltcforge_light::textured::MOST_SQUARE_TEXELS;
use ltcforge_textures::{
    LightTexture, LightTextureError, LightTextureOptions, MOST_PIXELS, PROFILE_FORMAT, light_texture,
};

/// Writes the files, and prints what they are. A file that is no picture is refused before anything is written.
pub(super) fn run(args: &LightTextureArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    check_output_folder(&args.out)?;
    let refuse = |error: &dyn std::fmt::Display| file_failure(&args.picture, error);
    let bytes = read_file(&args.picture, PICTURE_LIMIT_BYTES).map_err(|error| refuse(&error))?;
    let LightTextureArgs { light, transfer, container, texels, .. } = *args;
    let options = LightTextureOptions { light, transfer, container, texels, most_pixels: MOST_PIXELS };
    let made = args.threads.pool()?.install(|| light_texture(&bytes, &args.name, &options));
    let made = made.map_err(|error| match error {
        LightTextureError::Files(error) => usage(error),
        error => refuse(&error),
    })?;
    let LightTexture { format, transfer, picture, size, levels, texels, error, clamped, files } = &made;
    let unit = if *format == PROFILE_FORMAT { "angles" } else { "pixels" };
    let ([across, down], [width, height]) = (picture, size);
    let mut text = format!(
        "{format} of {across} x {down} {unit}, {transfer}; {width} x {height} texels, {levels} levels, {texels}\n"
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
        let _ = writeln!(text, "coarser than the picture: texels are at most {along} a side and {in_all} in all");
    }
    if *error > 0.0 {
        let _ = writeln!(text, "rounded: a channel changes by at most {error:.1e} of its texel's largest");
    }
    if *clamped > 0 {
        let _ = writeln!(text, "{clamped} numbers are above the largest of {texels} and became that");
    }
    context.print(&value, text.trim_end())
}
