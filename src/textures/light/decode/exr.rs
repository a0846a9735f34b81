//! `OpenEXR`: channels R, G and B of the first part that has them, or Y of a grey picture. Alpha is left out: colours are
//! premultiplied. The data window is the picture.

use std::io::Cursor;

use ::exr::{
    error::Error,
    meta::{MetaData, header::Header},
    prelude::{ReadChannels as _, ReadLayers as _, ReadSpecificChannel as _, read},
};

use super::{Curve, Decoded, LightFileError, PictureFormat, Wanted, from_floats};

pub(super) fn decode(bytes: &[u8], wanted: Wanted) -> Result<Decoded, LightFileError> {
    let wrong = |error: Error| LightFileError::broken(PictureFormat::Exr, error);
    let meta = MetaData::read_from_buffered(bytes, false).map_err(wrong)?;
    for header in &meta.headers {
        wanted.bounded(header.layer_size.width() as u64, header.layer_size.height() as u64)?;
    }
    let has = |header: &Header, names: &[&str]| {
        names.iter().all(|name| header.channels.list.iter().any(|channel| channel.name.eq(name)))
    };
    let (colour, grey) = (["R", "G", "B"], ["Y"]);
    let (size, mut texels) = if meta.headers.iter().any(|header| has(header, &colour)) {
        coloured(bytes).map_err(wrong)?
    } else if meta.headers.iter().any(|header| has(header, &grey)) {
        grey_only(bytes).map_err(wrong)?
    } else {
        let names: Vec<String> =
            meta.headers.iter().flat_map(|h| h.channels.list.iter()).map(|c| c.name.to_string()).collect();
        let reason = format!("its channels are {}; R, G and B are read, or Y", names.join(", "));
        return Err(LightFileError::broken(PictureFormat::Exr, reason));
    };
    let curve = wanted.curve.unwrap_or(Curve::Linear);
    from_floats(&mut texels, curve);
    Ok(Decoded { size, curve, texels })
}

/// A size, and the texels that are filled one by one.
type Texels = ([usize; 2], Vec<[f32; 3]>);

fn coloured(bytes: &[u8]) -> Result<Texels, Error> {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| ([size.width(), size.height()], vec![[0.0; 3]; size.area()]),
            |(size, texels): &mut Texels, at, (r, g, b): (f32, f32, f32)| texels[at.y() * size[0] + at.x()] = [r, g, b],
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))?;
    Ok(image.layer_data.channel_data.pixels)
}

fn grey_only(bytes: &[u8]) -> Result<Texels, Error> {
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required("Y")
        .collect_pixels(
            |size, _| ([size.width(), size.height()], vec![[0.0; 3]; size.area()]),
            |(size, texels): &mut Texels, at, (y,): (f32,)| texels[at.y() * size[0] + at.x()] = [y; 3],
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))?;
    Ok(image.layer_data.channel_data.pixels)
}
