//! `verify`: checks that files are tables and have the right digests.

use std::path::Path;

use serde_json::json;

use super::{
    CommandFailure, Context, Exit,
    args::VerifyArgs,
    pins::Fitting,
    print, shown,
    table_file::{self, check, table_path},
};
use ltcforge_files::{container::TableFile, digest::Digest, recipe_document};

/// Checks every file. The first that fails decides the exit code.
pub(super) fn run(args: &VerifyArgs, json: bool, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let mut failures: Vec<CommandFailure> = Vec::new();
    let limit = args.folder.limit.table_limit;
    for name in &args.files {
        let found = table_path(name, args.folder.tables.as_deref());
        let path = found.as_deref().unwrap_or(name);
        let checked = found.clone().and_then(|path| {
            let (digest, file) = read(&path, args.digest, limit)?;
            if args.refit {
                refit(&path, digest, &file, &Fitting::new(args.threads, args.entry_limit, context))?;
            }
            Ok(digest)
        });
        match checked {
            Ok(digest) => {
                let value = json!({ "file": shown(path), "digest": digest, "ok": true, "refitted": args.refit });
                let refitted = if args.refit { ", and so is the table that its recipe gives" } else { "" };
                print(context.stdout, json, &value, &format!("{}: ok, {digest}{refitted}", path.display()))?;
            }
            Err(failure) if failure.exit == Exit::Interrupted => return Err(failure),
            Err(failure) => {
                if json {
                    let value = json!({ "file": shown(path), "ok": false, "detail": failure.message });
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

/// Fits the recipe of a table again. The result must have the table's bytes.
fn refit(path: &Path, digest: Digest, file: &TableFile, fitting: &Fitting<'_>) -> Result<(), CommandFailure> {
    let recipe = fitting.recipe(path, recipe_document::canonical_json(&file.recipe).as_bytes())?;
    let actual = Digest::of(&fitting.fit(&recipe)?);
    if actual == digest {
        return Ok(());
    }
    let reason = format!("the file hashes to {digest}, the table that its recipe gives to {actual}");
    Err(CommandFailure::new(Exit::Mismatch, format!("{}: {reason}", path.display())))
}

fn read(path: &Path, expected: Option<Digest>, limit_bytes: u64) -> Result<(Digest, TableFile), CommandFailure> {
    let bytes = table_file::read(path, limit_bytes)?;
    check(path, &bytes, expected)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_name_that_is_a_digest_is_a_promise() {
        let hex = Digest::of(b"abc").hex();
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(format!("{hex}.safetensors"));
        fs::write(&path, "other").expect("a file");
        let refused = read(&path, None, 5).expect_err("other bytes");
        assert_eq!(refused.exit, Exit::Mismatch);
        assert!(refused.message.contains(&Digest::of(b"other").to_string()), "{}", refused.message);
        assert_eq!(read(&folder.path().join("none"), None, 5).expect_err("no file").exit, Exit::Failed);
        let refused = read(&path, None, 4).expect_err("too long");
        assert!(refused.message.contains("longer than 4 bytes"), "{}", refused.message);
    }
}
