//! `verify`: checks that files are tables and have the right digests, and that they are what their recipes give.

use std::{
    fs,
    path::{Path, PathBuf},
};

use serde_json::json;

use super::{
    CommandFailure, Context, Exit, Interrupt,
    args::VerifyArgs,
    file_failure,
    pins::Fitting,
    print, shown,
    table_file::{self, check, table_path},
    verify_export::{self, manifest_of},
};
use ltcforge_client::{Client, Download, DownloadError, Limits, ServerTokens};
use ltcforge_files::{container::TableFile, digest::Digest, recipe_document, tabulated::kept_name};

/// Checks every file. The first that fails decides the exit code.
pub(super) fn run(
    args: &VerifyArgs,
    tokens: &ServerTokens,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let mut failures: Vec<CommandFailure> = Vec::new();
    for name in &args.files {
        let fitting = Fitting::new(args.threads, args.entry_limit, context);
        let Checked { path, digest: checked } = check_one(name, args, tokens, &fitting, &context.interrupt);
        match checked {
            Ok(digest) => {
                let value = json!({ "file": shown(&path), "digest": digest, "ok": true, "refitted": args.refit });
                let refitted = if args.refit { ", and so is the table that its recipe gives" } else { "" };
                print(context.stdout, json, &value, &format!("{}: ok, {digest}{refitted}", path.display()))?;
            }
            Err(failure) if failure.exit == Exit::Interrupted => return Err(failure),
            Err(failure) => {
                if json {
                    let value = json!({ "file": shown(&path), "ok": false, "detail": failure.message });
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

/// The name under which something was checked, and the digest of its table.
struct Checked {
    path: PathBuf,
    digest: Result<Digest, CommandFailure>,
}

/// Checks the table of a URL, the files of an export, or a table's file.
fn check_one(
    name: &Path,
    args: &VerifyArgs,
    tokens: &ServerTokens,
    fitting: &Fitting<'_>,
    interrupt: &Interrupt,
) -> Checked {
    let limit = args.folder.limit.table_limit;
    let fitting = args.refit.then_some(fitting);
    let checked = |path: &Path, digest| Checked { path: path.to_owned(), digest };
    let refitted = |path: &Path, (digest, file): (Digest, TableFile)| {
        fitting.map_or(Ok(()), |fitting| refit(path, path, (digest, &file), fitting)).map(|()| digest)
    };
    if let Some(url) = name.to_str().filter(|name| name.contains("://")) {
        let limits = Limits { table_bytes: limit, ..Limits::USUAL };
        return checked(name, served(url, args.digest, (limits, tokens, interrupt), fitting));
    }
    if let Some(manifest) = manifest_of(name) {
        let table = verify_export::check(&manifest, limit, fitting);
        return checked(&manifest, table.and_then(|table| expect(&manifest, table, args.digest)));
    }
    match table_path(name, args.folder.tables.as_deref()) {
        Ok(path) => {
            let table = read(&path, args.digest, limit).and_then(|table| refitted(&path, table));
            checked(&path, table)
        }
        Err(failure) => checked(name, Err(failure)),
    }
}

/// Checks the table at a URL of a service, `http://HOST/v1/tables/sha256:DIGEST`: the bytes must be those of the digest. A
/// tabulated BRDF that a refit needs comes from there too.
fn served(
    url: &str,
    expected: Option<Digest>,
    (limits, tokens, interrupt): (Limits, &ServerTokens, &Interrupt),
    fitting: Option<&Fitting<'_>>,
) -> Result<Digest, CommandFailure> {
    let parts = url.split_once("/v1/tables/").and_then(|(base, digest)| Some((base, digest.parse::<Digest>().ok()?)));
    let Some((base, digest)) = parts else {
        let what = "the address of a table is http://HOST/v1/tables/sha256:DIGEST";
        return Err(CommandFailure::new(Exit::Usage, format!("{}: {what}", url.escape_debug())));
    };
    expect(Path::new(url), digest, expected)?;
    let client = Client::with_limits(base, limits)?.with_tokens(tokens);
    let name = Path::new(url);
    let (digest, file) = check(name, &received(client.table(digest)?, interrupt)?, Some(digest))?;
    let Some(fitting) = fitting else { return Ok(digest) };
    let folder = tempfile::tempdir().map_err(|error| CommandFailure::new(Exit::Failed, error.to_string()))?;
    if let Some(brdf) = file.table.model().file() {
        let bytes = received(client.brdf(Digest::from_bytes(*brdf.digest()))?, interrupt)?;
        let path = folder.path().join(kept_name(brdf.digest()));
        fs::write(&path, bytes).map_err(|error| file_failure(&path, &error))?;
    }
    refit(name, &folder.path().join("table"), (digest, &file), fitting).map(|()| digest)
}

/// The bytes of a download.
fn received(download: Download, interrupt: &Interrupt) -> Result<Vec<u8>, CommandFailure> {
    let mut bytes = Vec::new();
    match download.write_to(None, &|| interrupt.is_set(), &mut bytes) {
        Ok(()) => Ok(bytes),
        Err(DownloadError::Client(error)) => Err(error.into()),
        Err(DownloadError::Stopped) => Err(CommandFailure::interrupted()),
        Err(error @ DownloadError::Write(_)) => Err(CommandFailure::new(Exit::Failed, error.to_string())),
    }
}

/// The digest `actual`, which must be the expected one if there is one.
fn expect(name: &Path, actual: Digest, expected: Option<Digest>) -> Result<Digest, CommandFailure> {
    match expected {
        Some(expected) if expected != actual => {
            let reason = format!("the table is {actual}, not {expected}");
            Err(CommandFailure::new(Exit::Mismatch, format!("{}: {reason}", name.display())))
        }
        _ => Ok(actual),
    }
}

/// Fits the recipe of a table again; what it needs lies in the folder of `beside`. The result must have the table's bytes.
fn refit(
    path: &Path,
    beside: &Path,
    (digest, file): (Digest, &TableFile),
    fitting: &Fitting<'_>,
) -> Result<(), CommandFailure> {
    let recipe = fitting.recipe(beside, recipe_document::canonical_json(&file.recipe).as_bytes())?;
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
