//! `verify`: checks that tables and exports have the right digests and match their recipes, and that the files of a
//! data folder match their names.

use std::{
    fs, io,
    num::NonZeroU64,
    path::{Path, PathBuf},
};

use clap::Args;
use serde_json::{Value, json};

use super::{
    CommandFailure, Context, Exit, Fitting, TableFolder, Threads, failed, file_failure, mismatch,
    server_args::TokenArgs, shown, table_file, table_path, usage, verify_export,
};
use ltcforge_client::{Access, Source, Wanted, digest_of_file, fetch};
use ltcforge_files::{container::AnyFile, digest::Digest, tabulated::kept_name};

/// `verify`.
#[derive(Debug, Args)]
pub struct VerifyArgs {
    /// Tables, exports, data folders, or URLs of tables
    ///
    /// A table is a file, the first digits of a digest in --tables, or `http://HOST/v1/tables/sha256:DIGEST`. A folder
    /// is an export, or a service's data folder or a copy of it. A file with a digest as its name must match that
    /// digest
    #[arg(required = true)]
    pub files: Vec<PathBuf>,
    /// The folder of tables
    #[command(flatten)]
    pub folder: TableFolder,
    /// Digest that the table must have
    #[arg(long)]
    pub digest: Option<Digest>,
    /// Also fit each recipe again and compare the bytes
    #[arg(long)]
    pub refit: bool,
    /// Maximum entries of a table to fit [default: 2000000]
    #[arg(long, env = "LTCFORGE_ENTRY_LIMIT", value_name = "N")]
    pub entry_limit: Option<NonZeroU64>,
    /// Threads.
    #[command(flatten)]
    pub threads: Threads,
    /// The token of a service
    #[command(flatten)]
    pub token: TokenArgs,
}

/// Checks all given files. The first failure decides the exit code.
pub(super) fn run(args: &VerifyArgs, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let tokens = &args.token.tokens()?;
    let mut failures: Vec<CommandFailure> = Vec::new();
    for name in &args.files {
        let fitting = Fitting::new(args.threads, args.entry_limit, context);
        let interrupt = &context.interrupt;
        let table_bytes = args.folder.limit.table_limit;
        let access = Access { table_bytes, offline: false, tokens, should_stop: &|| interrupt.is_set() };
        let (path, found) = check_one(name, args, &access, args.refit.then_some(&fitting));
        match found {
            Ok(Found::Table(digest)) => {
                let value = json!({ "file": shown(&path), "digest": digest, "ok": true, "refitted": args.refit });
                let refitted = if args.refit { ", and fitting its recipe gives the same bytes" } else { "" };
                context.print(&value, &format!("{}: ok, {digest}{refitted}", path.display()))?;
            }
            Ok(Found::Blobs(count)) => {
                let value = json!({ "file": shown(&path), "blobs": count, "ok": true });
                context.print(&value, &format!("{}: ok, all {count} files match their digests", path.display()))?;
            }
            Err(failure) if failure.exit == Exit::Interrupted => return Err(failure),
            Err(failure) => {
                if context.json {
                    let value: Value = json!({ "file": shown(&path), "ok": false, "detail": failure.message });
                    context.print(&value, "")?;
                }
                failures.push(failure);
            }
        }
    }
    all_of(failures).map(|()| Exit::Ok)
}

/// Combines several failures into one, with the exit code of the first.
pub(super) fn all_of(failures: Vec<CommandFailure>) -> Result<(), CommandFailure> {
    let Some(exit) = failures.first().map(|first| first.exit) else { return Ok(()) };
    let lines: Vec<String> = failures.into_iter().map(|failure| failure.message).collect();
    Err(CommandFailure::new(exit, lines.join("\n")))
}

enum Found {
    /// A table, or the files of an export.
    Table(Digest),
    /// The number of files in a data folder.
    Blobs(u64),
}

/// Checks the table of a URL, the files of an export, a folder of blobs, or a table's file.
fn check_one(
    name: &Path,
    args: &VerifyArgs,
    access: &Access<'_>,
    fitting: Option<&Fitting<'_>>,
) -> (PathBuf, Result<Found, CommandFailure>) {
    let checked = |path: &Path, table: Result<Digest, _>| {
        let expected = |table| match args.digest {
            Some(expected) if expected != table => Err(mismatch(path, format!("the table is {table}, not {expected}"))),
            _ => Ok(Found::Table(table)),
        };
        (path.to_owned(), table.and_then(expected))
    };
    if let Some(url) = name.to_str().filter(|name| name.contains("://")) {
        return checked(name, served(url, access, fitting));
    }
    match verify_export::manifest_of(name) {
        Some(manifest) if name.is_dir() && !manifest.exists() => {
            let found = match fitting {
                None if args.digest.is_none() => blobs(name, access).map(Found::Blobs),
                _ => {
                    let name = name.display();
                    Err(usage(format!("{name}: this is a folder of blobs; --digest and --refit need a table")))
                }
            };
            (name.to_owned(), found)
        }
        Some(manifest) => checked(&manifest, verify_export::check(&manifest, access.table_bytes, fitting)),
        None => match table_path(name, args.folder.tables.as_deref()) {
            Ok(path) => {
                let table = read(&path, args.digest, access.table_bytes);
                checked(&path, table.and_then(|table| refitted(&path, &path, table, fitting)))
            }
            Err(failure) => checked(name, Err(failure)),
        },
    }
}

/// Checks that each blob in the data folder of a service, or in a copy of its `blobs`, hashes to its name. A blob is
/// `ab/ab12...`; files with other names are ignored. Returns the number of blobs.
///
/// # Errors
/// Every file that has other bytes or cannot be read, and a folder without blobs.
fn blobs(folder: &Path, access: &Access<'_>) -> Result<u64, CommandFailure> {
    let inside = folder.join("blobs");
    let folder = if inside.is_dir() { &inside } else { folder };
    let (mut count, mut failures) = (0, Vec::new());
    let read_folder = |folder: &Path| -> io::Result<Vec<PathBuf>> {
        let mut paths = fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>()?;
        paths.sort();
        Ok(paths)
    };
    let text = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    for beginning in read_folder(folder).map_err(|error| file_failure(folder, &error))? {
        if text(&beginning).len() != 2 || !beginning.is_dir() {
            continue;
        }
        for path in read_folder(&beginning).map_err(|error| file_failure(&beginning, &error))? {
            let name = text(&path);
            let digest = name.parse::<Digest>().ok();
            let Some(expected) = digest.filter(|digest| digest.hex() == name) else { continue };
            if (access.should_stop)() {
                return Err(CommandFailure::interrupted());
            }
            count += 1;
            match digest_of_file(&path) {
                Ok((actual, _)) if actual != expected => {
                    failures.push(mismatch(&path, format!("the file has digest {actual}, not the digest in its name")));
                }
                Ok(_) if name.starts_with(&text(&beginning)) => {}
                Ok(_) => failures.push(mismatch(&path, format!("the file belongs in the folder {}", &name[..2]))),
                Err(error) => failures.push(mismatch(&path, error)),
            }
        }
    }
    all_of(failures)?;
    if count == 0 {
        let reason = "the folder has neither ltcforge.json nor files ab/ab12... named by digests";
        return Err(file_failure(folder, &reason));
    }
    Ok(count)
}

/// Checks the table at a URL of a service, `http://HOST/v1/tables/sha256:DIGEST`. The bytes must match the digest. If a
/// refit needs a tabulated BRDF, it is downloaded from the same service.
fn served(url: &str, access: &Access<'_>, fitting: Option<&Fitting<'_>>) -> Result<Digest, CommandFailure> {
    let parts = url.split_once("/v1/tables/").and_then(|(base, digest)| Some((base, digest.parse::<Digest>().ok()?)));
    let Some((base, digest)) = parts else {
        let what = "use http://HOST/v1/tables/sha256:DIGEST";
        return Err(usage(format!("{}: {what}", url.escape_debug())));
    };
    let (name, source) = (Path::new(url), [Source::server(base)?]);
    let table = table_file::check(name, &fetch(&source, &Wanted::table(digest, None), access)?, Some(digest))?;
    let folder = tempfile::tempdir().map_err(failed)?;
    if let AnyFile::Ltc(table) = &table.1
        && let Some(brdf) = table.table.model().file().filter(|_| fitting.is_some())
    {
        let digest = Digest::from_bytes(*brdf.digest());
        let wanted = Wanted { digest, stated_bytes: None, path: format!("/v1/brdfs/{digest}") };
        let path = folder.path().join(kept_name(brdf.digest()));
        fs::write(&path, fetch(&source, &wanted, access)?).map_err(|error| file_failure(&path, &error))?;
    }
    refitted(name, &folder.path().join("table"), table, fitting)
}

/// Returns the digest of a table. With `fitting`, fits the recipe again and compares the bytes. Files that the recipe
/// needs are in the folder of `at`.
fn refitted(
    path: &Path,
    at: &Path,
    (digest, file): (Digest, AnyFile),
    fitting: Option<&Fitting<'_>>,
) -> Result<Digest, CommandFailure> {
    let Some(fitting) = fitting else { return Ok(digest) };
    let recipe = fitting.recipe(at, file.recipe_json().as_bytes())?;
    let actual = Digest::of(&fitting.fit(&recipe)?);
    if actual == digest {
        return Ok(digest);
    }
    Err(mismatch(path, format!("the file has digest {digest}, but fitting its recipe gives {actual}")))
}

fn read(path: &Path, expected: Option<Digest>, limit_bytes: u64) -> Result<(Digest, AnyFile), CommandFailure> {
    table_file::check(path, &table_file::read(path, limit_bytes)?, expected)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn a_file_named_by_a_digest_must_match_it() {
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
