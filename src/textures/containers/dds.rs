//! `DirectDraw` Surface [Microsoft, DDS programming guide].
//!
//! The Direct3D 9 header has 128 bytes and names the format by a `FourCC`, as in the published tables of 2017. It
//! describes 2D and 3D textures with 1, 2 and 4 channels. The Direct3D 10 header has 148 bytes and also describes
//! arrays, and 3 channels of 32 bits. The format has no comments.

use ddsfile::{
    AlphaMode, Caps2, D3D10ResourceDimension, D3DFormat, DxgiFormat, FourCC, NewD3dParams, NewDxgiParams, PixelFormat,
    PixelFormatFlags,
};

use super::rules::Stored;
use crate::file::TextureFileError;
use ltcforge_fit::Precision;

/// The format's name in errors.
const NAME: &str = "DDS";

/// The depth. `None` for a texture without depth.
fn depth(stored: &Stored<'_>) -> (Option<u32>, Option<Caps2>) {
    match stored.texture.depth {
        1 => (None, None),
        depth => (Some(depth), Some(Caps2::VOLUME)),
    }
}

/// The file of one texture, with the Direct3D 9 header, or with the Direct3D 10 header if the format requires it.
pub(super) fn encode(stored: &Stored<'_>) -> Result<Vec<u8>, TextureFileError> {
    let (format, fourcc) = match (stored.rounded.precision, stored.texture.channels.len()) {
        _ if stored.texture.layers > 1 => return dx10(stored),
        (Precision::F16, 1) => (D3DFormat::R16F, FourCC::R16F),
        (Precision::F16, 2) => (D3DFormat::G16R16F, FourCC::G16R16F),
        (Precision::F16, 4) => (D3DFormat::A16B16G16R16F, FourCC::A16B16G16R16F),
        (Precision::F32, 1) => (D3DFormat::R32F, FourCC::R32F),
        (Precision::F32, 2) => (D3DFormat::G32R32F, FourCC::G32R32F),
        (Precision::F32, 4) => (D3DFormat::A32B32G32R32F, FourCC::A32B32G32R32F),
        _ => return dx10(stored),
    };
    small_enough(stored)?;
    let (depth, caps2) = depth(stored);
    let (width, height) = (stored.texture.width, stored.texture.height);
    let dds = ddsfile::Dds::new_d3d(NewD3dParams { height, width, depth, format, mipmap_levels: None, caps2 });
    written(dds, fourcc, stored)
}

/// The file of one texture, with the Direct3D 10 header.
pub(crate) fn dx10(stored: &Stored<'_>) -> Result<Vec<u8>, TextureFileError> {
    let texture = stored.texture;
    stored.at_most_four(NAME)?;
    small_enough(stored)?;
    if texture.depth > 1 && texture.layers > 1 {
        return Err(stored.unsupported(NAME, "layers", texture.layers.to_string(), "1 where depth is more than 1"));
    }
    let format = match (stored.rounded.precision, texture.channels.len()) {
        (Precision::F16, 1) => DxgiFormat::R16_Float,
        (Precision::F16, 2) => DxgiFormat::R16G16_Float,
        (Precision::F16, 4) => DxgiFormat::R16G16B16A16_Float,
        (Precision::F32, 1) => DxgiFormat::R32_Float,
        (Precision::F32, 2) => DxgiFormat::R32G32_Float,
        (Precision::F32, 3) => DxgiFormat::R32G32B32_Float,
        (Precision::F32, 4) => DxgiFormat::R32G32B32A32_Float,
        (_, channels) => {
            return Err(stored.unsupported(NAME, "channels", channels.to_string(), "1, 2 and 4 of 16 bits"));
        }
    };
    let (depth, caps2) = depth(stored);
    let dds = ddsfile::Dds::new_dxgi(NewDxgiParams {
        height: texture.height,
        width: texture.width,
        depth,
        format,
        mipmap_levels: None,
        array_layers: (texture.layers > 1).then_some(texture.layers),
        caps2,
        is_cubemap: false,
        resource_dimension: match depth {
            None => D3D10ResourceDimension::Texture2D,
            Some(_) => D3D10ResourceDimension::Texture3D,
        },
        // The fourth channel is a number like the others, not an alpha.
        alpha_mode: AlphaMode::Custom,
    });
    written(dds, FourCC::DX10, stored)
}

/// Rejects large textures, because the crate counts bytes in 32 bits.
fn small_enough(stored: &Stored<'_>) -> Result<(), TextureFileError> {
    let bytes = stored.rounded.numbers.len() as u64 * stored.rounded.number_bytes() as u64;
    if u32::try_from(bytes).is_ok() {
        return Ok(());
    }
    Err(stored.unsupported(NAME, "texels", format!("{bytes} bytes"), "less than 4 GiB"))
}

/// The bytes of a file with this `FourCC`. The crate writes formats of a known width as colours with masks. Here only
/// the `FourCC`, such as 113, identifies the format.
fn written(
    dds: Result<ddsfile::Dds, ddsfile::Error>,
    fourcc: u32,
    stored: &Stored<'_>,
) -> Result<Vec<u8>, TextureFileError> {
    let refused = |error: ddsfile::Error| TextureFileError::Refused { container: NAME, reason: error.to_string() };
    let mut dds = dds.map_err(refused)?;
    dds.header.spf =
        PixelFormat { flags: PixelFormatFlags::FOURCC, fourcc: Some(FourCC(fourcc)), ..PixelFormat::default() };
    dds.data = stored.rounded.little_endian();
    let mut file = Vec::new();
    dds.write(&mut file).map_err(refused)?;
    Ok(file)
}
