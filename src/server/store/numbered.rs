//! Values with the revision of their last change.

/// Bytes of the revision in front of a value.
const REVISION_BYTES: usize = 8;

/// A value and the revision of its last change, big-endian and first, as one.
pub(super) fn join(revision: u64, value: &[u8]) -> Vec<u8> {
    let mut joined = revision.to_be_bytes().to_vec();
    joined.extend_from_slice(value);
    joined
}

/// The inverse of [`join`]; `None` for bytes that are too short.
pub(super) fn split(joined: &[u8]) -> Option<(u64, &[u8])> {
    let (revision, value) = joined.split_at_checked(REVISION_BYTES)?;
    Some((u64::from_be_bytes(revision.try_into().ok()?), value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_joined_comes_apart() {
        for value in [b"".as_slice(), b"value"] {
            assert_eq!(split(&join(u64::MAX - 7, value)), Some((u64::MAX - 7, value)));
        }
        assert_eq!(split(b"1234567"), None);
    }
}
