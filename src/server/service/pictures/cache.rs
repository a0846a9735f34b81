//! Rendered pictures, up to a number of bytes.

use std::collections::HashMap;

use super::picture::PictureFile;
use crate::files::digest::Digest;

/// The pictures that were used last.
#[derive(Debug)]
pub(super) struct Cache {
    limit_bytes: usize,
    bytes: usize,
    /// Number of uses so far.
    uses: u64,
    /// Each with the number of its last use.
    pictures: HashMap<Digest, (u64, PictureFile)>,
}

impl Cache {
    /// An empty cache for up to `limit_bytes` of PNG files.
    pub(super) fn new(limit_bytes: usize) -> Self {
        Self { limit_bytes, bytes: 0, uses: 0, pictures: HashMap::new() }
    }

    /// The picture of `key`.
    pub(super) fn get(&mut self, key: Digest) -> Option<PictureFile> {
        self.uses += 1;
        let (used, file) = self.pictures.get_mut(&key)?;
        *used = self.uses;
        Some(file.clone())
    }

    /// Keeps a picture and removes the least recently used ones to make room. A picture that does not fit is not kept.
    pub(super) fn keep(&mut self, key: Digest, file: PictureFile) {
        if file.png.len() > self.limit_bytes {
            return;
        }
        self.uses += 1;
        self.bytes += file.png.len();
        if let Some((_, before)) = self.pictures.insert(key, (self.uses, file)) {
            self.bytes -= before.png.len();
        }
        while self.bytes > self.limit_bytes {
            let Some(oldest) = self.pictures.iter().min_by_key(|(_, (used, _))| *used).map(|(key, _)| *key) else {
                return;
            };
            if let Some((_, file)) = self.pictures.remove(&oldest) {
                self.bytes -= file.png.len();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    fn key(name: &str) -> Digest {
        Digest::of(name.as_bytes())
    }

    fn file(bytes: usize) -> PictureFile {
        PictureFile { png: Arc::new(vec![0; bytes]), adapter: "cpu".into(), tag: key("tag") }
    }

    #[test]
    fn the_least_recently_used_picture_makes_room() {
        let mut cache = Cache::new(10);
        cache.keep(key("a"), file(4));
        cache.keep(key("b"), file(4));
        assert!(cache.get(key("a")).is_some());
        cache.keep(key("c"), file(6));
        assert!(cache.get(key("b")).is_none());
        assert!(cache.get(key("a")).is_some() && cache.get(key("c")).is_some());
        cache.keep(key("d"), file(11));
        assert!(cache.get(key("d")).is_none());
        assert!(cache.get(key("a")).is_some() && cache.get(key("c")).is_some());
        // The same key again replaces the picture.
        cache.keep(key("a"), file(3));
        assert!(cache.get(key("c")).is_some());
        assert_eq!(cache.bytes, 9);
    }
}
