//! Reads the textures of materials within limits of pixels and bytes.

use std::{collections::BTreeMap, sync::Arc};

use super::{
    accessor::Buffers,
    container::{Container, MOST_BYTES},
    document::{Document, TextureInfo, TextureTransform, WebpTexture},
    error::{SceneError, out_of_range},
    extensions::extension,
    image::{Pixels, decode},
    texture::Sampled,
};
use ltcforge_fit::{GoOn, math::sin_cos};

/// Maximum number of pixels of one image, and of all images, in a scene that may name files.
const OF_FILES: [u64; 2] = [1 << 26, 1 << 28];
/// Like [`OF_FILES`], for a scene of one file, which a service may have received. Three channels of all images, and
/// four channels of one image during decoding, take 208 MiB.
const OF_ONE_FILE: [u64; 2] = [1 << 24, 3 << 24];

/// Channels of an image that several textures may share, or why they are missing.
type Kept = Result<Arc<Pixels>, String>;

/// Reads textures, and counts the pixels and bytes of their images.
pub(super) struct Textures<'a> {
    document: &'a Document,
    buffers: &'a Buffers<'a>,
    container: &'a mut Container,
    go_on: &'a GoOn<'a>,
    /// Maximum number of pixels of one image, and of all images.
    most: [u64; 2],
    /// By the image and its channels.
    kept: BTreeMap<(usize, &'static [usize]), Kept>,
    /// Pixels and bytes of all images so far. Images that share their bytes are counted separately.
    pixels: u64,
    bytes: u64,
}

impl<'a> Textures<'a> {
    pub(super) fn new(
        document: &'a Document,
        buffers: &'a Buffers<'a>,
        container: &'a mut Container,
        go_on: &'a GoOn<'a>,
    ) -> Self {
        let most = if container.folder.is_some() { OF_FILES } else { OF_ONE_FILE };
        Self { document, buffers, container, go_on, most, kept: BTreeMap::new(), pixels: 0, bytes: 0 }
    }

    /// Some channels of a texture of the material at `place`.
    pub(super) fn read(
        &mut self,
        place: &str,
        info: &TextureInfo,
        channels: &'static [usize],
    ) -> Result<Sampled, SceneError> {
        let (index, textures) = (info.index, &self.document.textures);
        let texture = textures.get(index);
        let texture = texture.ok_or_else(|| SceneError::fault(place, out_of_range(index, "textures", textures)))?;
        let webp: WebpTexture = extension(&format!("/textures/{index}"), &texture.extensions, "EXT_texture_webp")?;
        let image = webp.source.or(texture.source).ok_or_else(|| {
            let kind = texture.extensions.keys().next().map_or("without an image", |name| name.as_str());
            SceneError::Missing(format!("texture {index} is {kind}"))
        })?;
        let kept = match self.kept.get(&(image, channels)) {
            Some(kept) => kept.clone(),
            None => SceneError::split(self.decoded(image, channels))?,
        };
        // A missing image is kept too: a thousand materials may name it.
        self.kept.insert((image, channels), kept.clone());
        let sampler = texture.sampler.and_then(|sampler| self.document.samplers.get(sampler));
        let change: TextureTransform = extension(place, &info.extensions, "KHR_texture_transform")?;
        let ([u, v], [x, y]) = (change.offset, change.scale);
        let [sin, cos] = <[f64; 2]>::from(sin_cos(change.rotation));
        Ok(Sampled {
            pixels: kept.map_err(SceneError::Missing)?,
            wrap: sampler.map_or([None; 2], |sampler| [sampler.wrap_s, sampler.wrap_t]),
            set: change.tex_coord.unwrap_or(info.tex_coord),
            transform: [[cos * x, sin * y, u], [-sin * x, cos * y, v]],
        })
    }

    /// The channels of an image.
    fn decoded(&mut self, image: usize, wanted: &'static [usize]) -> Result<Arc<Pixels>, SceneError> {
        SceneError::unless(self.go_on)?;
        let bytes = self.image(image)?;
        self.bytes += bytes.len() as u64;
        SceneError::above("bytes of all images", self.bytes, MOST_BYTES)?;
        let pointer = format!("/images/{image}");
        let decoded = decode(&pointer, &bytes, wanted, |pixels| {
            SceneError::above(format!("{pointer}: pixels of the image"), pixels, self.most[0])?;
            self.pixels += pixels;
            SceneError::above("pixels of all textures", self.pixels, self.most[1])
        })?;
        Ok(Arc::new(decoded.ok_or_else(|| SceneError::Missing(format!("image {image} is not PNG, JPEG or WebP")))?))
    }

    /// The bytes of an image.
    fn image(&mut self, index: usize) -> Result<Vec<u8>, SceneError> {
        let images = &self.document.images;
        let image = images.get(index);
        let image = image.ok_or_else(|| SceneError::fault("/textures", out_of_range(index, "images", images)))?;
        match (&image.uri, image.buffer_view) {
            (Some(uri), _) => self.container.named(&format!("/images/{index}/uri"), uri),
            (None, Some(view)) => Ok(self.buffers.view(view)?.to_vec()),
            (None, None) => Err(SceneError::Missing(format!("image {index} has no bytes"))),
        }
    }
}
