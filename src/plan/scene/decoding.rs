//! Images that wait to be decoded: some at a time, on all threads, within bounds of memory.

use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use super::{
    error::SceneError,
    image::{MOST_PIXELS, Pixels, decode},
};
use ltcforge_fit::GoOn;

/// Bytes of images that wait together.
const MOST_BYTES_WAITING: usize = 64 << 20;

/// Channels of an image, which are there once it is decoded.
pub(super) type Channels = Arc<OnceLock<Pixels>>;

/// An image that waits.
struct Waiting {
    pointer: String,
    bytes: Vec<u8>,
    wanted: Vec<usize>,
    into: Channels,
}

/// Decodes images. At most as many pixels as one image may have are decoded at a time.
pub(super) struct Decoding<'a> {
    waiting: Vec<Waiting>,
    pixels: u64,
    bytes: usize,
    go_on: &'a GoOn<'a>,
}

impl<'a> Decoding<'a> {
    pub(super) fn new(go_on: &'a GoOn<'a>) -> Self {
        Self { waiting: Vec::new(), pixels: 0, bytes: 0, go_on }
    }

    /// Takes an image of so many pixels, of which some channels are wanted.
    pub(super) fn push(
        &mut self,
        pointer: String,
        bytes: Vec<u8>,
        wanted: Vec<usize>,
        pixels: u64,
    ) -> Result<Channels, SceneError> {
        if self.pixels + pixels > MOST_PIXELS || self.bytes + bytes.len() > MOST_BYTES_WAITING {
            self.finish()?;
        }
        let into = Channels::default();
        self.bytes += bytes.len();
        self.waiting.push(Waiting { pointer, bytes, wanted, into: into.clone() });
        self.pixels += pixels;
        Ok(into)
    }

    /// Decodes all that wait. Runs on the current rayon pool, whose size changes nothing.
    pub(super) fn finish(&mut self) -> Result<(), SceneError> {
        (self.pixels, self.bytes) = (0, 0);
        let one = |Waiting { pointer, bytes, wanted, into }: Waiting| {
            SceneError::unless(self.go_on)?;
            // The caller knows the format from the first bytes.
            let pixels = decode(&pointer, &bytes, &wanted)?;
            into.get_or_init(|| pixels);
            Ok(())
        };
        // Of several faults the first is told, whichever thread was the first.
        let done: Vec<Result<(), SceneError>> = std::mem::take(&mut self.waiting).into_par_iter().map(one).collect();
        done.into_iter().collect()
    }
}
