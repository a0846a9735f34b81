//! `pull`: the tables pinned in the lock file, and the files that are pinned with them.

use std::{
    io::{self, Write as _},
    path::{Path, PathBuf},
};

use clap::Args;
use serde_json::json;

use super::{
    CommandFailure, Context, Exit, Fitting, Measured, SourceArgs, Sources, failed, file_failure, lock_failure,
    mismatch, name_of, of_pin, shown, table_file::check, usage, verify::all_of,
};
use ltcforge_client::{
    self as client, ExportPin, FilePin, LockFile, Pin, PinState, PullError, Source, SourcesError, Wanted,
};
use ltcforge_files::{bounded::read_file, container::AnyFile, digest::Digest, recipe_document, replace::Staged};
use ltcforge_textures::{Export, UnknownExport};

/// `pull`.
#[derive(Debug, Args)]
pub struct PullArgs {
    /// Change nothing; exit with 3 if a file is missing or changed
    #[arg(long, conflicts_with_all = ["from", "fit", "offline"])]
    pub locked: bool,
    /// Fit a table from its recipe if no source has it
    #[arg(long)]
    pub fit: bool,
    /// The sources of tables
    #[command(flatten)]
    pub sources: SourceArgs,
}

/// A pinned file, and the outcome for it.
struct Done<'a> {
    path: &'a Path,
    digest: Digest,
    /// The outcome, or why the file is not right.
    outcome: Result<&'static str, String>,
}

/// Downloads or makes every pinned file that is missing or changed. Files are moved into place when all pins have been
/// processed. If a pin is invalid, or a table or file does not have the pinned bytes, no file changes. A file that no
/// source has does not stop the others. The first failure decides the exit code.
pub(super) fn run(args: &PullArgs, sources: &Sources, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let lock_path = &args.sources.lock;
    let lock = LockFile::read(lock_path).map_err(|error| lock_failure(lock_path, &error))?;
    if args.locked {
        return check_all(&lock, context);
    }
    let mut ends = Vec::new();
    let mut staged = Staged::default();
    for pin in &lock.pins {
        if context.interrupt.is_set() {
            return Err(CommandFailure::interrupted());
        }
        let count = staged.places().count();
        let fitting = Fitting::new(args.sources.threads, args.sources.entry_limit, context);
        let mut pulling = Pulling { args, fitting, sources, lock: &lock, context, staged: &mut staged };
        let mut done = Vec::new();
        let failure = pulling.pin(pin, &mut done).err();
        if failure.is_some() {
            staged.truncate(count);
        }
        ends.push((pin, done, failure));
    }
    let failures = || ends.iter().filter_map(|(.., failure)| failure.as_ref());
    let is_wrong = |failure: &CommandFailure| matches!(failure.exit, Exit::Usage | Exit::Mismatch | Exit::Interrupted);
    let places = !failures().any(is_wrong);
    if places {
        client::place(staged)?;
    }
    for (pin, done, failure) in &ends {
        // A file that was not moved into place is not reported.
        let is_done = |done: &&Done<'_>| places && failure.is_none() || done.outcome == Ok(UNCHANGED);
        for done in done.iter().filter(is_done) {
            print(pin, done, context)?;
        }
        if let Some(failure) = failure {
            let outcome = Err(failure.message.clone());
            print(pin, &Done { path: &pin.path, digest: pin.digest, outcome }, context)?;
        }
    }
    let failures = ends.iter().filter_map(|(pin, _, failure)| Some(of_pin(pin, failure.as_ref()?)));
    all_of(failures.collect()).map(|()| Exit::Ok)
}

/// Compares all pinned files with their digests, and reports every file that is missing or changed.
fn check_all(lock: &LockFile, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let mut failures = Vec::new();
    for (pin, path, digest, bytes) in lock.files() {
        let checked = client::check_unchanged(path, digest, bytes, &lock.folder).map(|()| UNCHANGED);
        let outcome = checked.as_ref().copied().map_err(ToString::to_string);
        print(pin, &Done { path, digest, outcome }, context)?;
        failures.extend(checked.err().map(|error| of_pin(pin, &error.into())));
    }
    all_of(failures).map(|()| Exit::Ok)
}

/// Prints the outcome for a file. Without `--json`, failures are printed only at the end.
fn print(pin: &Pin, done: &Done<'_>, context: &mut Context<'_>) -> Result<(), CommandFailure> {
    let (path, outcome) = (done.path, done.outcome.as_deref().unwrap_or("failed"));
    let mut value = json!({ "name": pin.name, "path": shown(path), "digest": done.digest, "outcome": outcome });
    if let Err(detail) = &done.outcome {
        value["detail"] = detail.as_str().into();
    }
    if done.outcome.is_ok() || context.json {
        context.print(&value, &format!("{} {outcome}: {}", pin.name, path.display()))?;
    }
    Ok(())
}

/// The outcome for a file that was already right.
const UNCHANGED: &str = "unchanged";

struct Pulling<'a, 'b> {
    args: &'a PullArgs,
    fitting: Fitting<'a>,
    sources: &'a Sources,
    lock: &'a LockFile,
    context: &'a Context<'b>,
    staged: &'a mut Staged,
}

impl Pulling<'_, '_> {
    /// Pulls a table and the files that are made from it. Adds the outcome for each file to `done`.
    fn pin<'p>(&mut self, pin: &'p Pin, done: &mut Vec<Done<'p>>) -> Result<(), CommandFailure> {
        let folder = &self.lock.folder;
        let outcome = match client::check(&pin.path, pin.digest, pin.bytes, folder)? {
            PinState::Right => UNCHANGED,
            state if self.stages(&Wanted::table(pin.digest, pin.bytes), &pin.path, pin)? => {
                self.check_recipe(pin, &self.read(pin)?)?;
                if state == PinState::Missing { "downloaded" } else { "replaced" }
            }
            _ => self.fit(pin)?,
        };
        done.push(Done { path: &pin.path, digest: pin.digest, outcome: Ok(outcome) });
        // The table is read and measured at most once, and only if a file has to be made.
        let mut read: Option<Measured> = None;
        for export in &pin.exports {
            let mut states = Vec::new();
            for file in &export.file {
                states.push((file, client::check(&file.path, file.digest, Some(file.bytes), folder)?));
            }
            let wrong = states.iter().filter(|(_, state)| *state != PinState::Right);
            let wrong: Vec<&FilePin> = wrong.map(|(file, _)| *file).collect();
            let comes = !wrong.is_empty() && self.download(pin, export, &wrong)?;
            if !comes && !wrong.is_empty() {
                let table = match read.take() {
                    Some(table) => table,
                    None => self.fitting.measure(self.read(pin)?, pin.digest)?,
                };
                self.export(export, read.insert(table), &wrong)?;
            }
            for (FilePin { path, digest, .. }, state) in states {
                let outcome = match state {
                    PinState::Right => UNCHANGED,
                    PinState::Missing if comes => "downloaded",
                    PinState::Missing => "made",
                    PinState::Different { .. } => "replaced",
                };
                done.push(Done { path, digest: *digest, outcome: Ok(outcome) });
            }
        }
        Ok(())
    }

    /// Stages a file of a pin from its sources. Returns `false` if no source has the file and it can be made here: an
    /// exported file, or with `--fit` a table.
    fn stages(&mut self, wanted: &Wanted, path: &Path, pin: &Pin) -> Result<bool, CommandFailure> {
        let folder = &self.lock.folder;
        let is_table = path == pin.path;
        let mut sources = self.sources.of(pin.sources.iter().chain(&self.lock.sources), folder);
        // Folders contain only tables, so only services have other files.
        sources.retain(|source| is_table || matches!(source, Source::Server(_)));
        let staged = &mut *self.staged;
        let found = self.sources.with_access(&self.context.interrupt, |access| {
            client::stage(wanted, (folder, path), &sources, access, staged)
        });
        match found {
            Ok(()) => Ok(true),
            Err(PullError::Sources(SourcesError::NoneHasIt(_))) if self.args.fit || !is_table => Ok(false),
            Err(PullError::Sources(error @ SourcesError::NoneHasIt(_))) if pin.recipe.is_some() => {
                let message = format!("{error}; add --from SOURCE, or --fit to fit the table from its recipe");
                Err(CommandFailure { message, ..error.into() })
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Rejects a table whose recipe differs from the pinned recipe.
    fn check_recipe(&self, pin: &Pin, file: &AnyFile) -> Result<(), CommandFailure> {
        let Some(pinned) = &pin.recipe else { return Ok(()) };
        let place = self.lock.folder.join(&pin.path);
        let pinned = recipe_document::parse_any_stored(pinned.as_bytes()).map_err(|error| mismatch(&place, error))?;
        let (pinned, actual) = (recipe_document::digest(&pinned), Digest::of(file.recipe_json().as_bytes()));
        if actual == pinned {
            return Ok(());
        }
        Err(mismatch(&place, format!("the table's recipe has digest {actual}, but {pinned} is pinned")))
    }

    /// Fits a pinned recipe again. The table must have the pinned bytes.
    fn fit(&mut self, pin: &Pin) -> Result<&'static str, CommandFailure> {
        let Some(document) = &pin.recipe else {
            let reason = "no source has the table, and the lock file has no recipe to fit: run `ltcforge lock`";
            return Err(failed(reason));
        };
        let (place, target) = (self.lock.folder.join(&pin.path), client::target(&pin.path, &self.lock.folder)?);
        let bytes = self.fitting.fit(&self.fitting.recipe(Path::new("recipe"), document.as_bytes())?)?;
        let actual = Digest::of(&bytes);
        if actual != pin.digest {
            let reason = format!("fitting the recipe gives {actual}, but {} is pinned", pin.digest);
            return Err(mismatch(&place, reason));
        }
        client::check_size(place, bytes.len() as u64, pin.bytes)?;
        self.stage(&target, &bytes)?;
        Ok("fitted")
    }

    fn stage(&mut self, target: &Path, bytes: &[u8]) -> Result<(), CommandFailure> {
        let staged: io::Result<()> = self.staged.write(target, |file| file.write_all(bytes));
        staged.map_err(|error| file_failure(target, &error))
    }

    /// The path to read a pinned file from: the staged file, or else the file itself.
    fn found(&self, path: &Path) -> Result<PathBuf, CommandFailure> {
        let target = client::target(path, &self.lock.folder)?;
        Ok(self.staged.path_of(&target).map_or_else(|| self.lock.folder.join(path), Path::to_owned))
    }

    /// The table of a pin.
    fn read(&self, pin: &Pin) -> Result<AnyFile, CommandFailure> {
        let path = self.found(&pin.path)?;
        let limit = pin.bytes.unwrap_or(self.args.sources.limit.table_limit);
        let bytes = read_file(&path, limit).map_err(|error| file_failure(&path, &error))?;
        Ok(check(&self.lock.folder.join(&pin.path), &bytes, Some(pin.digest))?.1)
    }

    /// Downloads the `wrong` files of an export if the services have all of them, and checks that they belong to this
    /// export.
    fn download(&mut self, pin: &Pin, export: &ExportPin, wrong: &[&FilePin]) -> Result<bool, CommandFailure> {
        // An unknown export, or a file that the export does not have, is an error before any request.
        let name = name_of(export)?;
        // Lookup tables take less time to export than to download.
        let AnyFile::Ltc(file) = self.read(pin)? else { return Ok(false) };
        let asked: Export = name.parse().map_err(|error: UnknownExport| usage(error))?;
        let forms = asked.forms(&file.table).map_err(usage)?;
        let form_of = |file: &FilePin| forms.iter().find(|form| export.to.join(&form.path) == file.path);
        let place = |file: &FilePin| self.lock.folder.join(&file.path);
        if let Some(file) = export.file.iter().find(|file| form_of(file).is_none()) {
            return Err(mismatch(&place(file), format!("this version does not make this file; {ADVICE}")));
        }
        for file in wrong {
            let Some(wanted) = export.wanted(pin.digest, file) else { return Ok(false) };
            if !self.stages(&wanted, &file.path, pin)? {
                return Ok(false);
            }
            let bytes =
                read_file(&self.found(&file.path)?, file.bytes).map_err(|error| file_failure(&place(file), &error))?;
            if !form_of(file).is_some_and(|form| form.resembles(&bytes)) {
                let reason = format!("the pinned bytes are not a file of export {asked}; {ADVICE}");
                return Err(mismatch(&place(file), reason));
            }
        }
        Ok(true)
    }

    /// Stages the `wrong` files of an export. If a file does not have its pinned hash, no file is staged.
    fn export(&mut self, export: &ExportPin, table: &Measured, wrong: &[&FilePin]) -> Result<(), CommandFailure> {
        let (made, files) = table.export(export)?;
        let refused =
            |path: &Path, what: String| Err(mismatch(&self.lock.folder.join(path), format!("{what}; {ADVICE}")));
        for FilePin { path, digest, bytes } in &export.file {
            match made.file.iter().find(|file| file.path == *path) {
                Some(file) if file.digest == *digest => {
                    client::check_size(self.lock.folder.join(path), file.bytes, Some(*bytes))?;
                }
                Some(FilePin { digest: actual, .. }) => {
                    return refused(path, format!("this version makes {actual}, but {digest} is pinned"));
                }
                None => return refused(path, "this version does not make this file".to_owned()),
            }
        }
        if let Some(file) = made.file.iter().find(|made| export.file.iter().all(|pinned| pinned.path != made.path)) {
            return refused(&file.path, "this version also makes this file, which is not pinned".to_owned());
        }
        for (made, file) in
            made.file.iter().zip(&files).filter(|(made, _)| wrong.iter().any(|file| file.path == made.path))
        {
            let target = client::target(&made.path, &self.lock.folder)?;
            self.stage(&target, &file.bytes)?;
        }
        Ok(())
    }
}

/// The advice for a pinned file that this version does not make.
const ADVICE: &str = "run `ltcforge lock` to pin the files of this version";
