//! Textures: images with their wrap modes and transforms, at texture coordinates.

use std::collections::BTreeMap;

use serde::de::DeserializeOwned;

use super::{
    accessor::Buffers,
    container::{Container, MOST_BYTES, Named},
    decoding::{Channels, Decoding},
    document::{Document, Extensions, TextureInfo, TextureTransform, WebpTexture},
    error::SceneError,
    image::{MOST_PIXELS_OF_ALL, pixels_of},
};
use ltcforge_fit::{
    GoOn,
    math::{pow, sin_cos},
};

const CLAMP: u32 = 33_071;
const MIRROR: u32 = 33_648;
const REPEAT: u32 = 10_497;

/// A texture of a material.
#[derive(Debug)]
pub(super) struct Sampled {
    pixels: Channels,
    wrap: [u32; 2],
    /// The set of texture coordinates.
    pub(super) set: u32,
    transform: [[f64; 3]; 2],
}

impl Sampled {
    /// The texel at texture coordinates. Domain: after [`Textures::finish`].
    pub(super) fn at(&self, uv: [f64; 2]) -> [f64; 3] {
        let Some(pixels) = self.pixels.get() else { return [1.0; 3] };
        let place = self.transform.map(|[a, b, c]| a * uv[0] + b * uv[1] + c);
        let texel = |i: usize| {
            let wrapped = match self.wrap[i] {
                CLAMP => place[i].clamp(0.0, 1.0),
                MIRROR => {
                    let twice = place[i].rem_euclid(2.0);
                    twice.min(2.0 - twice)
                }
                _ => place[i].rem_euclid(1.0),
            };
            // A coordinate that is no number falls on the first texel.
            ((wrapped * pixels.size[i] as f64) as usize).min(pixels.size[i] - 1)
        };
        pixels.at([texel(0), texel(1)])
    }
}

/// Reads textures one at a time, and notes what it cannot have.
pub(super) struct Textures<'a> {
    document: &'a Document,
    buffers: &'a Buffers,
    container: &'a mut Container,
    /// Channels of images that several textures may have, or why there are none, and how many pixels are kept.
    kept: BTreeMap<(usize, Vec<usize>), Result<Channels, String>>,
    pixels: u64,
    /// Bytes of the images that were decoded: many may be of one part of the file.
    bytes: u64,
    decoding: Decoding<'a>,
    go_on: &'a GoOn<'a>,
}

impl<'a> Textures<'a> {
    pub(super) fn new(
        document: &'a Document,
        buffers: &'a Buffers,
        container: &'a mut Container,
        go_on: &'a GoOn<'a>,
    ) -> Self {
        let decoding = Decoding::new(go_on);
        Self { document, buffers, container, kept: BTreeMap::new(), pixels: 0, bytes: 0, decoding, go_on }
    }

    /// Decodes what was read and waits for it.
    pub(super) fn finish(mut self) -> Result<(), SceneError> {
        self.decoding.finish()
    }

    /// Some channels of a material's texture. The inner error says why there are none.
    pub(super) fn read(
        &mut self,
        info: &TextureInfo,
        channels: &[usize],
    ) -> Result<Result<Sampled, String>, SceneError> {
        let Some(texture) = self.document.textures.get(info.index) else {
            let detail = format!("{} is no index of textures, which has {}", info.index, self.document.textures.len());
            return Err(SceneError::fault("/materials", detail));
        };
        let webp: Option<WebpTexture> = extension(&texture.extensions, "EXT_texture_webp")?;
        let Some(image) = webp.map(|webp| webp.source).or(texture.source) else {
            let kind = texture.extensions.keys().next().map_or("without an image", |name| name.as_str());
            return Ok(Err(format!("texture {} is {kind}", info.index)));
        };
        let pixels = match self.pixels(image, channels)? {
            Ok(pixels) => pixels,
            Err(why) => return Ok(Err(why)),
        };
        let sampler = texture.sampler.and_then(|sampler| self.document.samplers.get(sampler));
        let wrap = sampler.map_or([None; 2], |sampler| [sampler.wrap_s, sampler.wrap_t]);
        let change: Option<TextureTransform> = extension(&info.extensions, "KHR_texture_transform")?;
        let set = change.as_ref().and_then(|change| change.tex_coord).unwrap_or(info.tex_coord);
        let TextureTransform { offset, rotation, scale, .. } = change.unwrap_or_default();
        let [sin, cos] = <[f64; 2]>::from(sin_cos(rotation));
        Ok(Ok(Sampled {
            pixels,
            wrap: wrap.map(|wrap| wrap.unwrap_or(REPEAT)),
            set,
            transform: [[cos * scale[0], sin * scale[1], offset[0]], [-sin * scale[0], cos * scale[1], offset[1]]],
        }))
    }

    fn pixels(&mut self, image: usize, channels: &[usize]) -> Result<Result<Channels, String>, SceneError> {
        let key = (image, channels.to_vec());
        if let Some(known) = self.kept.get(&key) {
            return Ok(known.clone());
        }
        // What cannot be had is kept too: a thousand materials may name one broken image.
        let found = self.decoded(image, channels)?;
        self.kept.insert(key, found.clone());
        Ok(found)
    }

    fn decoded(&mut self, image: usize, channels: &[usize]) -> Result<Result<Channels, String>, SceneError> {
        SceneError::unless(self.go_on)?;
        let bytes = match self.image(image)? {
            Ok(bytes) => bytes,
            Err(why) => return Ok(Err(format!("image {image}: {why}"))),
        };
        self.bytes += bytes.len() as u64;
        SceneError::above("bytes of all images", self.bytes, MOST_BYTES)?;
        let pointer = format!("/images/{image}");
        let Some(pixels) = pixels_of(&pointer, &bytes)? else {
            return Ok(Err(format!("image {image} is neither PNG nor JPEG nor WebP")));
        };
        self.pixels += pixels;
        SceneError::above("pixels of all textures", self.pixels, MOST_PIXELS_OF_ALL)?;
        self.decoding.push(pointer, bytes, channels.to_vec(), pixels).map(Ok)
    }

    fn image(&mut self, index: usize) -> Result<Result<Vec<u8>, String>, SceneError> {
        let Some(image) = self.document.images.get(index) else {
            let detail = format!("{index} is no index of images, which has {}", self.document.images.len());
            return Err(SceneError::fault("/textures", detail));
        };
        match (&image.uri, image.buffer_view) {
            (Some(uri), _) => Ok(match self.container.named(&format!("/images/{index}/uri"), uri)? {
                Named::Bytes(bytes) => Ok(bytes),
                Named::Missing(why) => Err(why),
            }),
            (None, Some(view)) => Ok(self.buffers.view(self.document, view)?.map(<[u8]>::to_vec)),
            (None, None) => Ok(Err("it has no bytes".into())),
        }
    }
}

/// A level of a colour texture as light: the curve of sRGB [IEC 61966-2-1]. Domain: [0, 1].
pub(super) fn linear(level: f64) -> f64 {
    if level <= 0.040_45 { level / 12.92 } else { pow((level + 0.055) / 1.055, 2.4) }
}

/// An extension of a material or texture, where it is there.
pub(super) fn extension<T: DeserializeOwned>(extensions: &Extensions, name: &str) -> Result<Option<T>, SceneError> {
    let Some(value) = extensions.get(name) else { return Ok(None) };
    serde_json::from_str(value.get())
        .map(Some)
        .map_err(|error| SceneError::fault(format!("extensions/{name}"), error.to_string()))
}
