//! Short files compressed by zstd for the clients that accept it, each once, and kept in memory.
//!
//! Invariant: what is kept follows from the file's digest alone. Whether the stored file is sound is asked elsewhere, for
//! each request.

use std::sync::Arc;

use quick_cache::{Weighter, sync::Cache};

use super::{SHORT_BYTES, Service};
use ltcforge_files::digest::Digest;

/// zstd's own default. Level 1 takes half of the time, a millisecond for a table of 200 KB, and its result is up to a
/// quarter longer.
const LEVEL: i32 = 3;

/// A compressed file that is longer than this share of the file is not worth its decoding.
const WORTHWHILE: f64 = 0.9;

/// Bytes of compressed files that are kept.
const KEPT_BYTES: u64 = 32 << 20;

/// How many files the cache expects. For more than 62 it would divide its bytes among several parts, and a file of a
/// mebibyte would fit into none.
const KEPT_FILES: usize = 32;

/// About what the cache takes for an entry beside the bytes.
const ENTRY_BYTES: u64 = 256;

/// What zstd makes of a file.
#[derive(Debug, Clone)]
pub enum Zstd {
    /// Fewer bytes, with the digest of these.
    Shorter(Arc<Vec<u8>>, Digest),
    /// Nothing that saves a tenth of the file.
    NotWorthwhile,
}

/// The files that were compressed last.
#[derive(Debug)]
pub(super) struct Compressed {
    kept: Cache<Digest, Zstd, Weight>,
}

/// Counts the bytes of a compressed file.
#[derive(Debug, Clone)]
struct Weight;

impl Weighter<Digest, Zstd> for Weight {
    fn weight(&self, _key: &Digest, file: &Zstd) -> u64 {
        match file {
            Zstd::Shorter(bytes, _) => bytes.len() as u64 + ENTRY_BYTES,
            Zstd::NotWorthwhile => ENTRY_BYTES,
        }
    }
}

impl Default for Compressed {
    fn default() -> Self {
        Self::within(KEPT_BYTES)
    }
}

impl Compressed {
    /// Keeps up to `limit_bytes`.
    fn within(limit_bytes: u64) -> Self {
        Self { kept: Cache::with_weighter(KEPT_FILES, limit_bytes, Weight) }
    }

    /// The file `digest`, whose bytes are `bytes`. Requests for one file at the same time wait for the first.
    fn get(&self, digest: Digest, bytes: &[u8]) -> Zstd {
        if bytes.len() as u64 > SHORT_BYTES {
            return Zstd::NotWorthwhile;
        }
        self.kept.get_or_insert_with(&digest, || compress(bytes)).unwrap_or_else(|error| {
            // The machine lacks memory. The file can be sent as it is.
            tracing::warn!(%digest, %error, "the file is sent as it is, because it was not compressed");
            Zstd::NotWorthwhile
        })
    }
}

fn compress(bytes: &[u8]) -> std::io::Result<Zstd> {
    let mut shorter = zstd::bulk::compress(bytes, LEVEL)?;
    if shorter.len() as f64 > WORTHWHILE * bytes.len() as f64 {
        return Ok(Zstd::NotWorthwhile);
    }
    // It was allocated for the longest result.
    shorter.shrink_to_fit();
    let digest = Digest::of(&shorter);
    Ok(Zstd::Shorter(Arc::new(shorter), digest))
}

impl Service {
    /// A file as zstd has it, if that is kept. It does not block.
    #[must_use]
    pub fn known_compressed(&self, digest: Digest) -> Option<Zstd> {
        self.state.compressed.kept.get(&digest)
    }

    /// The file `digest`, whose bytes are `bytes`, as zstd has it. Only files of up to [`SHORT_BYTES`] are compressed.
    #[must_use]
    pub fn compressed(&self, digest: Digest, bytes: &[u8]) -> Zstd {
        self.state.compressed.get(digest, bytes)
    }
}

#[cfg(test)]
mod tests {
    use std::thread;

    use super::*;

    /// Bytes that zstd halves, and others in each file.
    fn file(seed: u8, length: usize) -> Vec<u8> {
        (0..length)
            .map(|i| if i % 2 == 0 { 0 } else { Digest::of(&[seed, i as u8, (i >> 8) as u8]).as_bytes()[0] })
            .collect()
    }

    #[test]
    fn a_file_is_compressed_once_whoever_asks_at_the_same_time() {
        let (compressed, file) = (Compressed::default(), file(0, 100_000));
        let ask = || match compressed.get(Digest::of(&file), &file) {
            Zstd::Shorter(bytes, digest) => (bytes, digest),
            Zstd::NotWorthwhile => panic!("half of the file is zeros"),
        };
        let all: Vec<_> = thread::scope(|scope| {
            let threads: Vec<_> = (0..8).map(|_| scope.spawn(ask)).collect();
            threads.into_iter().map(|thread| thread.join().expect("a file")).collect()
        });
        let (first, digest) = &all[0];
        assert!(all.iter().all(|(bytes, _)| Arc::ptr_eq(bytes, first)), "others were made");
        assert_eq!(*digest, Digest::of(first));
        assert_eq!(zstd::bulk::decompress(first, file.len()).expect("a frame"), file);
    }

    #[test]
    fn what_saves_less_than_a_tenth_and_what_is_long_stays_as_it_is() {
        let compressed = Compressed::default();
        let mut noise: Vec<u8> = (0..1000_u32).flat_map(|i| *Digest::of(&i.to_le_bytes()).as_bytes()).collect();
        let ask = |bytes: &[u8]| compressed.get(Digest::of(bytes), bytes);
        assert!(matches!(ask(&noise), Zstd::NotWorthwhile));
        noise.resize(noise.len() + 3000, 0);
        assert!(matches!(ask(&noise), Zstd::NotWorthwhile), "3,000 bytes of 35,000 are less than a tenth");
        noise.resize(noise.len() + 1000, 0);
        assert!(matches!(ask(&noise), Zstd::Shorter(..)), "4,000 bytes of 36,000 are more than a tenth");
        let mut zeros = vec![0; SHORT_BYTES as usize];
        assert!(matches!(ask(&zeros), Zstd::Shorter(..)));
        zeros.push(0);
        assert!(matches!(ask(&zeros), Zstd::NotWorthwhile));
    }

    #[test]
    fn the_bytes_that_are_kept_are_bounded() {
        let limit = 100_000;
        let compressed = Compressed::within(limit);
        for seed in 0..40 {
            let file = file(seed, 10_000);
            assert!(matches!(compressed.get(Digest::of(&file), &file), Zstd::Shorter(..)));
            assert!(compressed.kept.weight() <= limit, "{}", compressed.kept.weight());
        }
        assert!(compressed.kept.weight() > limit / 2, "{}", compressed.kept.weight());
    }
}
