//! `verify`: tables and their hashes.

use std::{fs, path::Path};

use serde_json::json;

use super::{Context, Exit, Failure, args::VerifyArgs, file_failure, print};
use crate::files::{
    digest::Digest,
    export::{self, TableFile},
};

/// Checks every file; the first that fails decides the exit code.
pub(super) fn run(args: &VerifyArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, Failure> {
    let mut failures: Vec<Failure> = Vec::new();
    for path in &args.files {
        match read(path, args.digest) {
            Ok((digest, _)) => {
                let value = json!({ "file": path, "digest": digest, "ok": true });
                print(context.stdout, json, &value, &format!("{}: ok, {digest}", path.display()))?;
            }
            Err(failure) => {
                if json {
                    let value = json!({ "file": path, "ok": false, "detail": failure.message });
                    print(context.stdout, true, &value, "")?;
                }
                failures.push(failure);
            }
        }
    }
    match failures.first().map(|first| first.exit) {
        None => Ok(Exit::Ok),
        Some(exit) => {
            let lines: Vec<String> = failures.into_iter().map(|failure| failure.message).collect();
            Err(Failure::new(exit, lines.join("\n")))
        }
    }
}

fn read(path: &Path, expected: Option<Digest>) -> Result<(Digest, TableFile), Failure> {
    let bytes = fs::read(path).map_err(|error| file_failure(path, &error))?;
    check(path, &bytes, expected)
}

/// The table of a file that is what it says it is: it hashes to `expected`, or else to the digest in its name if there
/// is one, and is well formed.
pub(super) fn check(path: &Path, bytes: &[u8], expected: Option<Digest>) -> Result<(Digest, TableFile), Failure> {
    let actual = Digest::of(bytes);
    let mismatch = |reason: String| Failure::new(Exit::Mismatch, format!("{}: {reason}", path.display()));
    if let Some(expected) = expected.or_else(|| digest_in_name(path))
        && actual != expected
    {
        return Err(mismatch(format!("the file hashes to {actual}, not to {expected}")));
    }
    let file = export::decode(bytes).map_err(|error| mismatch(error.to_string()))?;
    Ok((actual, file))
}

/// The digest that a file is named after.
fn digest_in_name(path: &Path) -> Option<Digest> {
    path.file_name()?.to_str()?.split('.').next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_is_a_digest_is_a_promise() {
        let hex = Digest::of(b"abc").hex();
        assert_eq!(digest_in_name(Path::new(&format!("a/{hex}.safetensors"))), Some(Digest::of(b"abc")));
        assert_eq!(digest_in_name(Path::new("a/metal.safetensors")), None);

        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(format!("{hex}.safetensors"));
        fs::write(&path, "other").expect("a file");
        let refused = read(&path, None).expect_err("other bytes");
        assert_eq!(refused.exit, Exit::Mismatch);
        assert!(refused.message.contains(&Digest::of(b"other").to_string()), "{}", refused.message);
        assert_eq!(read(&folder.path().join("none"), None).expect_err("no file").exit, Exit::Failed);
    }
}
