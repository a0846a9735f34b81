//! The first lines of every shader text: its licence, the version that wrote it, and a digest that detects changes.

use sha2::{Digest, Sha256};

/// The licence of texts without numbers of a table.
pub(super) const LICENCE: &str = "MIT OR Apache-2.0";

/// A placeholder for the digest, which depends on the finished text.
const DIGEST: &str = "{digest}";

/// The first lines of a comment, for [`stamped`]. `revision` is raised when the values of a model change.
#[must_use]
pub fn head(licence: &str, revision: u32) -> String {
    let version = env!("CARGO_PKG_VERSION");
    format!(
        "SPDX-License-Identifier: {licence}\nltcforge {version}, revision {revision}, sha256 of the text below: {DIGEST}\n"
    )
}

/// The comment `header`, a blank line, and the `code`. The comment contains a digest of the text below the first blank
/// line: the first 16 digits of its SHA-256.
#[must_use]
pub fn stamped(header: &str, code: &str) -> String {
    format!("{}\n{code}", header.replace(DIGEST, &digest(code)))
}

fn digest(code: &str) -> String {
    let first =
        Sha256::digest(code.as_bytes()).iter().take(8).fold(0_u64, |digits, byte| digits << 8 | u64::from(*byte));
    format!("{first:016x}")
}
