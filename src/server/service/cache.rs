//! What was made last, up to a number of bytes.

use std::collections::HashMap;

use ltcforge_files::digest::Digest;

/// The values that were used last.
#[derive(Debug)]
pub(super) struct Cache<T> {
    limit_bytes: usize,
    bytes: usize,
    /// Number of uses so far.
    uses: u64,
    kept: HashMap<Digest, Kept<T>>,
}

#[derive(Debug)]
struct Kept<T> {
    /// The number of its last use.
    used: u64,
    bytes: usize,
    value: T,
}

impl<T: Clone> Cache<T> {
    /// An empty cache of up to `limit_bytes`.
    pub(super) fn new(limit_bytes: usize) -> Self {
        Self { limit_bytes, bytes: 0, uses: 0, kept: HashMap::new() }
    }

    /// The value of `key`.
    pub(super) fn get(&mut self, key: Digest) -> Option<T> {
        self.uses += 1;
        let kept = self.kept.get_mut(&key)?;
        kept.used = self.uses;
        Some(kept.value.clone())
    }

    /// Keeps a value of so many bytes and removes the least recently used ones to make room. A value that does not fit is
    /// not kept.
    pub(super) fn keep(&mut self, key: Digest, bytes: usize, value: T) {
        if bytes > self.limit_bytes {
            return;
        }
        self.uses += 1;
        self.bytes += bytes;
        if let Some(before) = self.kept.insert(key, Kept { used: self.uses, bytes, value }) {
            self.bytes -= before.bytes;
        }
        while self.bytes > self.limit_bytes {
            let Some(oldest) = self.kept.iter().min_by_key(|(_, kept)| kept.used).map(|(key, _)| *key) else {
                return;
            };
            if let Some(removed) = self.kept.remove(&oldest) {
                self.bytes -= removed.bytes;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(name: &str) -> Digest {
        Digest::of(name.as_bytes())
    }

    #[test]
    fn the_least_recently_used_value_makes_room() {
        let mut cache = Cache::new(10);
        cache.keep(key("a"), 4, 'a');
        cache.keep(key("b"), 4, 'b');
        assert!(cache.get(key("a")).is_some());
        cache.keep(key("c"), 6, 'c');
        assert!(cache.get(key("b")).is_none());
        assert!(cache.get(key("a")).is_some() && cache.get(key("c")).is_some());
        cache.keep(key("d"), 11, 'd');
        assert!(cache.get(key("d")).is_none());
        assert!(cache.get(key("a")).is_some() && cache.get(key("c")).is_some());
        // The same key again replaces the value.
        cache.keep(key("a"), 3, 'A');
        assert_eq!((cache.get(key("a")), cache.get(key("c"))), (Some('A'), Some('c')));
        assert_eq!(cache.bytes, 9);
    }
}
