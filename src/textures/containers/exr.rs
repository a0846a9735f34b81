//! `OpenEXR`: pictures with named channels.
//!
//! A file has one part for each slice of a 3D texture or an array, in order. A part is named after the texture and the
//! slice. Lines are not compressed, so the bytes do not depend on the version of a compressor. The attribute `comments`
//! of each part holds the comments.

use std::io::Cursor;

use ::exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, ImageAttributes, IntegerBounds, Layer, LayerAttributes,
    Text, Vec2, WritableImage as _,
};
use half::f16;

use super::rules::Stored;
use crate::{about::About, file::TextureFileError};
use ltcforge_fit::Precision;

/// The file of one texture.
pub(super) fn encode(stored: &Stored<'_>, about: &About) -> Result<Vec<u8>, TextureFileError> {
    let texture = stored.texture;
    let size = Vec2(texture.width as usize, texture.height as usize);
    let slice_numbers = size.0 * size.1 * texture.channels.len();
    // `OpenEXR`'s own library uses UTF-8, but the crate's checked constructors accept only Latin-1.
    let comments = Text::from_slice_unchecked(about.lines().join("\n").as_bytes());
    let mut layers: Vec<Layer<AnyChannels<FlatSamples>>> = Vec::new();
    for (place, slice) in stored.rounded.numbers.chunks_exact(slice_numbers).enumerate() {
        let name =
            if texture.slices().len() == 1 { texture.name.clone() } else { format!("{}.{place:05}", texture.name) };
        let channels = texture.channels.iter().enumerate().map(|(i, channel)| {
            let numbers = slice.iter().copied().skip(i).step_by(texture.channels.len());
            let samples = match stored.rounded.precision {
                Precision::F32 => FlatSamples::F32(numbers.collect()),
                Precision::F16 => FlatSamples::F16(numbers.map(f16::from_f32_const).collect()),
            };
            AnyChannel::new(channel.as_str(), samples)
        });
        let attributes = LayerAttributes { comments: Some(comments.clone()), ..LayerAttributes::named(name.as_str()) };
        let channels = AnyChannels::sort(channels.collect());
        layers.push(Layer::new(size, attributes, Encoding::UNCOMPRESSED, channels));
    }
    let attributes = ImageAttributes::new(IntegerBounds::from_dimensions(size));
    let image = Image::from_layers(attributes, layers);
    let mut file = Cursor::new(Vec::new());
    image
        .write()
        .non_parallel()
        .to_buffered(&mut file)
        .map_err(|error| TextureFileError::Refused { container: "EXR", reason: error.to_string() })?;
    Ok(file.into_inner())
}
