//! `verify`: whether files are tables and have the right digests.

use std::{fs, path::Path};

use serde_json::json;

use super::{
    CommandFailure, Context, Exit,
    args::VerifyArgs,
    file_failure, print,
    table_file::{check, table_path},
};
use crate::files::{container::TableFile, digest::Digest};

/// Checks every file; the first that fails decides the exit code.
pub(super) fn run(args: &VerifyArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let mut failures: Vec<CommandFailure> = Vec::new();
    for name in &args.files {
        let found = table_path(name, args.folder.tables.as_deref());
        let path = found.as_deref().unwrap_or(Path::new(name));
        match found.clone().and_then(|path| read(&path, args.digest)) {
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
            Err(CommandFailure::new(exit, lines.join("\n")))
        }
    }
}

fn read(path: &Path, expected: Option<Digest>) -> Result<(Digest, TableFile), CommandFailure> {
    let bytes = fs::read(path).map_err(|error| file_failure(path, &error))?;
    check(path, &bytes, expected)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_is_a_digest_is_a_promise() {
        let hex = Digest::of(b"abc").hex();
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(format!("{hex}.safetensors"));
        fs::write(&path, "other").expect("a file");
        let refused = read(&path, None).expect_err("other bytes");
        assert_eq!(refused.exit, Exit::Mismatch);
        assert!(refused.message.contains(&Digest::of(b"other").to_string()), "{}", refused.message);
        assert_eq!(read(&folder.path().join("none"), None).expect_err("no file").exit, Exit::Failed);
    }
}
