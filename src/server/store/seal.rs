//! Each stored value starts with a hash. The hash detects damaged values, which sled does not detect.

use sha2::{Digest as _, Sha256};

/// Length of the hash in bytes.
const SEAL_BYTES: usize = 8;

/// Puts a hash in front of a value: the first bytes of the SHA-256 of tree, key and value. The hash detects bit flips
/// and values under a wrong key.
pub(super) fn seal(tree: &str, key: &[u8], value: &[u8]) -> Vec<u8> {
    [&hash(tree, key, value)[..], value].concat()
}

/// The inverse of [`seal`]. `None` if the hash does not match.
pub(super) fn unseal(tree: &str, key: &[u8], sealed: &[u8]) -> Option<Vec<u8>> {
    let (found, value) = sealed.split_at_checked(SEAL_BYTES)?;
    (found == hash(tree, key, value)).then(|| value.to_vec())
}

fn hash(tree: &str, key: &[u8], value: &[u8]) -> [u8; SEAL_BYTES] {
    let mut hasher = Sha256::new();
    for part in [tree.as_bytes(), key] {
        hasher.update((part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    hasher.update(value);
    let full = hasher.finalize();
    std::array::from_fn(|i| full[i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sealed_value_opens_under_its_own_key_only_and_every_bit_flip_is_detected() {
        let sealed = seal("jobs", b"key", b"value");
        assert_eq!(unseal("jobs", b"key", &sealed).unwrap(), b"value");
        assert!(unseal("jobs", b"kex", &sealed).is_none());
        assert!(unseal("results", b"key", &sealed).is_none());
        for bit in 0..sealed.len() * 8 {
            let mut damaged = sealed.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(unseal("jobs", b"key", &damaged).is_none(), "bit {bit}");
        }
        assert!(unseal("jobs", b"key", b"short").is_none());
    }
}
