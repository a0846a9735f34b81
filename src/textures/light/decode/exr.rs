//! `OpenEXR`: channels R, G and B of the first part that has them, or Y of a grey picture. Alpha is ignored, because
//! colours are premultiplied. The picture is the data window.

use std::io::Cursor;

use ::exr::{
    error::Error,
    meta::{MetaData, header::Header},
    prelude::{ReadChannels as _, ReadLayers as _, ReadSpecificChannel as _, read},
};

use super::{Curve, Decoded, LightFileError, PictureFormat, Wanted, from_floats, primaries};

/// The largest number of channels of a part. The crate also decompresses channels that are not read.
const MOST_CHANNELS: usize = 16;

/// Limits for the bytes and attributes in all headers, because the crate uses up to a kilobyte per attribute.
const MOST_HEADER_BYTES: usize = 1 << 22;
const MOST_ATTRIBUTES: usize = 1 << 12;

/// Checks the size of the headers before the crate reads them. An attribute consists of its name, its type, the length
/// of its value, and the value. A zero follows the name and the type. A zero ends a header. In a file with several
/// parts, another zero follows the last header.
fn check_headers(bytes: &[u8]) -> Result<(), String> {
    let too_long = || format!("its headers are cut off, or longer than {MOST_HEADER_BYTES} bytes");
    let is_of_parts = bytes.get(5).is_some_and(|flags| flags & 0x10 != 0);
    let mut rest = bytes.get(8..bytes.len().min(MOST_HEADER_BYTES)).ok_or_else(too_long)?;
    let mut was_end = false;
    for _ in 0..MOST_ATTRIBUTES {
        let is_end = rest.first() == Some(&0);
        if is_end && (was_end || !is_of_parts) {
            return Ok(());
        }
        was_end = is_end;
        rest = if is_end { &rest[1..] } else { after_attribute(rest).ok_or_else(too_long)? };
    }
    Err(format!("its headers have more than {MOST_ATTRIBUTES} attributes"))
}

fn after_attribute(bytes: &[u8]) -> Option<&[u8]> {
    let after_text = |bytes: &'_ [u8]| bytes.iter().position(|byte| *byte == 0).map(|end| end + 1);
    let of_type = after_text(bytes)?;
    let value = of_type + after_text(&bytes[of_type..])?;
    let (length, rest) = bytes[value..].split_first_chunk()?;
    rest.get(usize::try_from(i32::from_le_bytes(*length)).ok()?..)
}

pub(super) fn decode(bytes: &[u8], wanted: Wanted) -> Result<Decoded, LightFileError> {
    let wrong = |error: Error| LightFileError::broken(PictureFormat::Exr, error);
    check_headers(bytes).map_err(|reason| LightFileError::broken(PictureFormat::Exr, reason))?;
    let meta = MetaData::read_from_buffered(bytes, false).map_err(wrong)?;
    for header in &meta.headers {
        wanted.bounded(header.layer_size.width() as u64, header.layer_size.height() as u64)?;
        let channels = header.channels.list.len();
        if channels > MOST_CHANNELS {
            let reason =
                format!("a part has {channels} channels; at most {MOST_CHANNELS} are allowed: save R, G and B only");
            return Err(LightFileError::broken(PictureFormat::Exr, reason));
        }
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
        let reason = format!("its channels are {}; R, G and B, or Y, are required", names.join(", "));
        return Err(LightFileError::broken(PictureFormat::Exr, reason));
    };
    let stated = meta.headers.iter().find_map(|header| header.shared_attributes.chromaticities);
    let stated = stated.map(|xy| [xy.red, xy.green, xy.blue, xy.white].map(|xy| [xy.x(), xy.y()].map(f64::from)));
    let curve = wanted.curve(Curve::Linear);
    from_floats(&mut texels, &curve);
    Ok(Decoded { size, curve, primaries: primaries(stated)?, texels, orientation: 1 })
}

/// The size, and texels that are filled one by one.
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
