//! `light-texture`: the prefiltered pyramid of a picture on a light.

use std::fmt::Write as _;

use serde_json::json;

use super::{
    CommandFailure, Context, Exit, args::LightTextureArgs, file_failure, output::check_output_folder, print, shown,
};
use ltcforge_files::{bounded::read_file, digest::Digest, replace::replace_file};
use ltcforge_light::textured::MOST_SQUARE_TEXELS;
use ltcforge_textures::{
    LightTexture, LightTextureError, LightTextureOptions, MOST_PIXELS, PROFILE_FORMAT, light_texture,
};

/// The longest picture that is read.
const PICTURE_LIMIT_BYTES: u64 = 1 << 28;

/// Writes the files, and prints what they are. A file that is no picture is refused before anything is written.
pub(super) fn run(args: &LightTextureArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    check_output_folder(&args.out)?;
    let refuse = |error: &dyn std::fmt::Display| file_failure(&args.picture, error);
    let bytes = read_file(&args.picture, PICTURE_LIMIT_BYTES).map_err(|error| refuse(&error))?;
    let LightTextureArgs { light, transfer, container, texels, .. } = *args;
    let options = LightTextureOptions { light, transfer, container, texels, most_pixels: MOST_PIXELS };
    let made = args.threads.pool()?.install(|| light_texture(&bytes, &args.name, &options));
    let made = made.map_err(|error| match error {
        LightTextureError::Files(error) => CommandFailure::new(Exit::Usage, error.to_string()),
        error => refuse(&error),
    })?;
    let LightTexture { format, transfer, picture, size, levels, texels, error, clamped, files } = &made;
    for file in files {
        let path = args.out.join(&file.name);
        replace_file(&path, &file.bytes).map_err(|error| file_failure(&path, &error))?;
    }
    let list: Vec<_> = files
        .iter()
        .map(|file| {
            json!({
                "file": shown(&args.out.join(&file.name)), "bytes": file.bytes.len(),
                "sha256": Digest::of(&file.bytes).hex(),
            })
        })
        .collect();
    let mut value = json!(made);
    value["files"] = list.into();
    let mut text = format!(
        "{format} of {} x {} {}, {transfer}; {} x {} texels, {levels} levels, {texels}\n",
        picture[0],
        picture[1],
        if *format == PROFILE_FORMAT { "angles" } else { "pixels" },
        size[0],
        size[1]
    );
    for file in files {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}  {} bytes", args.out.join(&file.name).display(), file.bytes.len());
    }
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
    print(context.stdout, json, &value, text.trim_end())?;
    Ok(Exit::Ok)
}
