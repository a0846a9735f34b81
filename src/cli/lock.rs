//! `lock`: the only command that writes the lock file.

use std::{
    io,
    path::{Path, PathBuf},
};

use clap::Args;
use serde_json::json;

use super::{
    CommandFailure, Context, Exit, ExportChoice, Fitting, SourceArgs, Sources, asked_by, check_output_folder,
    file_failure, input, lock_failure, of_pin, shown, table_file, table_path, usage,
};
use ltcforge_client::{
    self as client, FilePin, Guard, LockFile, LockFileError, Pin, PinState, Source, Wanted, check_pins, fetch,
    read_text, with_pins,
};
use ltcforge_files::{
    container::AnyFile,
    digest::Digest,
    recipe_document,
    replace::{folder_of, replace_file},
};

/// The suffix of a plan's recipe for sheen, and of the name of its pin.
const SHEEN: &str = "-sheen";

/// `lock`.
#[derive(Debug, Args)]
pub struct LockArgs {
    /// Name of the pin; without it, update all pins
    pub name: Option<String>,
    /// Table: a file, or a digest [default: the pinned table]
    #[arg(conflicts_with = "recipe")]
    pub table: Option<PathBuf>,
    /// Recipe to fit: a file, `-` for stdin, or a preset's name
    #[arg(long)]
    pub recipe: Option<PathBuf>,
    /// Folder that `plan` wrote; pins NAME, and NAME-sheen for sheen
    #[arg(long, value_name = "DIR", conflicts_with_all = ["table", "recipe"])]
    pub plan: Option<PathBuf>,
    /// Path of the table, below the lock file [default: NAME.safetensors]
    #[arg(long, value_name = "PATH", requires = "name")]
    pub to: Option<PathBuf>,
    /// Files to make from the table and to pin as well
    #[command(flatten)]
    pub export: ExportChoice,
    /// Folder of the exported files, below the lock file
    #[arg(short, long, value_name = "DIR", requires = "name")]
    pub out: Option<PathBuf>,
    /// Remove the pin and keep its files
    #[arg(long, requires = "name", conflicts_with_all = ["table", "recipe", "plan", "to", "out"])]
    pub remove: bool,
    /// Folder to search for digests first [default: `.`, then `tables`]
    #[arg(long, value_name = "DIR")]
    pub tables: Option<PathBuf>,
    /// The sources of tables
    #[command(flatten)]
    pub sources: SourceArgs,
}

impl LockArgs {
    /// The recipe of `--recipe`, or the recipes in the folder of `--plan`. Each has the suffix of its pin's name.
    pub(crate) fn recipes(&self) -> Vec<(&'static str, PathBuf)> {
        let Some(folder) = &self.plan else {
            return self.recipe.iter().map(|recipe| ("", recipe.clone())).collect();
        };
        let of = |end: &'static str| (end, folder.join(format!("recipe{end}.json")));
        let mut found = ["", SHEEN].map(of).to_vec();
        found.retain(|(_, path)| path.exists());
        // If the folder has no recipes, the error names the first path.
        if found.is_empty() { vec![of("")] } else { found }
    }
}

/// A file to write, unless it already exists.
struct Planned {
    path: PathBuf,
    digest: Digest,
    bytes: Vec<u8>,
}

/// A table and where it was found.
struct Found {
    digest: Digest,
    file: AnyFile,
    bytes: Vec<u8>,
    /// Whether the table came from a source.
    from_source: bool,
}

/// Pins tables and the files that are made from them. All files are made and checked before the first is written. The
/// lock file is written last.
pub(super) fn run(args: &LockArgs, sources: &Sources, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let path = &args.sources.lock;
    let refused = |error: LockFileError| {
        let is_shared = matches!(error, LockFileError::Twice { owners: "files", .. });
        let CommandFailure { exit, message } = lock_failure(path, &error);
        CommandFailure { exit, message: message + if is_shared { ": choose another --out or --to" } else { "" } }
    };
    // Two `lock` commands at the same time would overwrite each other's pins.
    if !folder_of(path).is_dir() {
        return Err(file_failure(path, &format!("there is no folder {}", folder_of(path).display())));
    }
    let wait = || tracing::warn!("another `ltcforge lock` is running in {}; waiting", folder_of(path).display());
    let _guard = Guard::of(folder_of(path), wait).map_err(|error| file_failure(path, &error))?;
    let old = match read_text(path) {
        Ok(text) => text,
        Err(LockFileError::Read { source }) if source.kind() == io::ErrorKind::NotFound && args.name.is_some() => {
            String::new()
        }
        Err(error) => return Err(refused(error)),
    };
    let folder = path.parent().map(Path::to_owned).unwrap_or_default();
    let lock = if old.is_empty() {
        LockFile { folder, ..LockFile::default() }
    } else {
        LockFile::parse(&old, path).map_err(refused)?
    };
    let mut pins = lock.pins.clone();
    let mut made: Vec<String> = match &args.name {
        Some(name) => vec![name.clone()],
        None => pins.iter().map(|pin| pin.name.clone()).collect(),
    };
    let mut planned = Vec::new();
    if args.remove {
        let count = pins.len();
        pins.retain(|pin| !made.contains(&pin.name));
        if pins.len() == count {
            return Err(unknown(&made[0], path));
        }
    } else {
        if args.name.is_some() {
            made = asked_pins(args, &mut pins, path)?;
        }
        // The names are checked before the slow work, and again when all files are known.
        check_pins(&pins).map_err(refused)?;
        check_places(path, &lock.folder, pins.iter().filter(|pin| made.contains(&pin.name)))?;
        let fitting = Fitting::new(args.sources.threads, args.sources.entry_limit, context);
        let locking = Locking { args, fitting, sources, lock: &lock, context };
        for pin in pins.iter_mut().filter(|pin| made.contains(&pin.name)) {
            planned.extend(locking.pin(pin).map_err(|failure| of_pin(pin, &failure))?);
        }
    }
    let text = with_pins(&old, &pins).map_err(refused)?;
    LockFile::parse(&text, path).map_err(refused)?;
    // Everything that could prevent a write is checked before the first file is written.
    let mut wrong = Vec::new();
    for Planned { path, digest, bytes } in &planned {
        let target = client::target(path, &lock.folder)?;
        if client::check(path, *digest, None, &lock.folder)? != PinState::Right {
            wrong.push((target, bytes));
        }
    }
    for (target, bytes) in wrong {
        replace_file(&target, bytes).map_err(|error| file_failure(&target, &error))?;
    }
    if text != old {
        replace_file(path, text.as_bytes()).map_err(|error| file_failure(path, &error))?;
    }
    if args.remove {
        context.print(&json!({ "name": made[0], "outcome": "removed" }), &format!("{} removed", made[0]))?;
    }
    for pin in pins.iter().filter(|pin| made.contains(&pin.name)) {
        print_pin(pin, context)?;
    }
    let files = planned.iter().map(|planned| (planned.path.as_path(), planned.bytes.as_slice()));
    let lines = client::missing_attributes(files, &lock.folder);
    if !lines.is_empty() {
        let advice = "add these lines to .gitattributes, or Git may change the files' line endings";
        let text = format!("{advice}:\n{}", lines.join("\n"));
        context.print(&json!({ "gitattributes": lines, "detail": advice }), &text)?;
    }
    Ok(Exit::Ok)
}

/// Checks that the lock file at `path` and the pinned files below its `folder` can be written.
fn check_places<'a>(path: &Path, folder: &Path, pins: impl Iterator<Item = &'a Pin>) -> Result<(), CommandFailure> {
    check_output_folder(folder_of(path))?;
    for pin in pins {
        client::check(&pin.path, pin.digest, None, folder)?;
        check_output_folder(folder_of(&client::target(&pin.path, folder)?))?;
        for export in &pin.exports {
            // The names of the exported files are not known yet.
            let file = client::target(&export.to.join("file"), folder)?;
            check_output_folder(folder_of(&file))?;
        }
    }
    Ok(())
}

fn print_pin(pin: &Pin, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let Pin { name, path, digest, bytes, .. } = pin;
    let files = || pin.exports.iter().flat_map(|export| &export.file);
    let listed = |file: &FilePin| json!({ "path": shown(&file.path), "bytes": file.bytes, "digest": file.digest });
    let value = json!({
        "name": name, "path": shown(path), "digest": digest, "bytes": bytes, "outcome": "pinned",
        "exports": files().map(listed).collect::<Vec<_>>(),
    });
    let paths = std::iter::once(path).chain(files().map(|file| &file.path));
    let lines: Vec<String> = paths.map(|path| format!("{name} pinned: {}", path.display())).collect();
    context.print(&value, &lines.join("\n"))
}

fn unknown(name: &str, path: &Path) -> CommandFailure {
    let what = "no pin has this name; add its table, its digest or --recipe";
    usage(format!("{}: {}: {what}", path.display(), name.escape_debug()))
}

/// Adds or changes the pins that the command line names, and returns their names: one, or one per recipe of a plan.
/// The pins may still have their old digests.
fn asked_pins(args: &LockArgs, pins: &mut Vec<Pin>, lock: &Path) -> Result<Vec<String>, CommandFailure> {
    let ends = args.recipes().into_iter().map(|(end, _)| end);
    let ends = if args.recipes().is_empty() { vec![""] } else { ends.collect() };
    let mut names = Vec::new();
    for end in ends {
        let index = asked_pin(args, end, pins, lock)?;
        names.push(pins[index].name.clone());
    }
    Ok(names)
}

/// Adds or changes the pin whose name ends in `end`, and returns its index.
fn asked_pin(args: &LockArgs, end: &str, pins: &mut Vec<Pin>, lock: &Path) -> Result<usize, CommandFailure> {
    let name = args.name.clone().unwrap_or_default() + end;
    let index = pins.iter().position(|pin| pin.name == name);
    if index.is_none() && args.table.is_none() && args.recipes().is_empty() {
        return Err(unknown(&name, lock));
    }
    let index = index.unwrap_or_else(|| {
        let (path, digest) = (PathBuf::from(format!("{name}.safetensors")), Digest::of(&[]));
        pins.push(Pin { name, path, digest, bytes: None, recipe: None, sources: vec![], exports: vec![] });
        pins.len() - 1
    });
    let pin = &mut pins[index];
    if let Some(to) = &args.to {
        pin.path = ended(to, end);
    }
    // Only the first table is exported, because engines read tables of one scattering model.
    if let Some(out) = args.out.as_ref().filter(|_| end.is_empty()) {
        if args.export.engine.is_none() && args.export.container.is_none() {
            return Err(usage("--out needs an export: add --for or --container"));
        }
        let asked = asked_by(&args.export, out)?;
        if !pin.exports.iter().any(|export| export.requests_same_as(&asked)) {
            pin.exports.push(asked);
        }
    }
    Ok(index)
}

/// Appends `end` to the name of a path, before the extension.
fn ended(path: &Path, end: &str) -> PathBuf {
    if end.is_empty() {
        return path.to_owned();
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().map(|of| format!(".{}", of.to_string_lossy())).unwrap_or_default();
    path.with_file_name(format!("{stem}{end}{extension}"))
}

struct Locking<'a, 'b> {
    args: &'a LockArgs,
    fitting: Fitting<'a>,
    sources: &'a Sources,
    lock: &'a LockFile,
    context: &'a Context<'b>,
}

impl Locking<'_, '_> {
    /// Completes a pin, and returns the table and the exported files.
    fn pin(&self, pin: &mut Pin) -> Result<Vec<Planned>, CommandFailure> {
        let Found { digest, file, bytes, from_source } = self.find(pin)?;
        let recipe = file.recipe_json();
        (pin.digest, pin.bytes, pin.recipe) = (digest, Some(bytes.len() as u64), Some(recipe));
        if from_source {
            let servers = self.sources.chosen().iter().filter(|source| matches!(source, Source::Server(_)));
            let servers: Vec<Source> = servers.cloned().collect();
            if !servers.is_empty() {
                pin.sources = servers;
            }
        }
        let mut planned = vec![Planned { path: pin.path.clone(), digest, bytes }];
        if pin.exports.is_empty() {
            return Ok(planned);
        }
        let measured = self.fitting.measure(file, digest)?;
        for export in &mut pin.exports {
            let files;
            (*export, files) = measured.export(export)?;
            planned.extend(export.file.iter().zip(files).map(|(pin, file)| Planned {
                path: pin.path.clone(),
                digest: pin.digest,
                bytes: file.bytes,
            }));
        }
        Ok(planned)
    }

    /// The table to pin.
    fn find(&self, pin: &Pin) -> Result<Found, CommandFailure> {
        let base = self.args.name.as_deref().unwrap_or_default();
        let mut recipes = self.args.recipes().into_iter();
        let recipe = recipes.find(|(end, _)| pin.name.strip_prefix(base) == Some(*end)).map(|(_, path)| path);
        match (&self.args.table, &recipe) {
            (Some(table), _) => self.named(table, pin),
            (None, Some(recipe)) => self.fitted(recipe, pin),
            (None, None) => self.pinned(pin),
        }
    }

    /// Finds a table by its path or digest: in the local folders, or else in a source.
    fn named(&self, name: &Path, pin: &Pin) -> Result<Found, CommandFailure> {
        let digest = name.to_str().and_then(|text| text.parse::<Digest>().ok()).filter(|_| !name.exists());
        match (table_path(name, self.args.tables.as_deref()), digest) {
            (Ok(path), digest) => self.read(&path, digest),
            (Err(_), Some(digest)) => self.of_source(digest, None, pin),
            (Err(failure), None) => Err(failure),
        }
    }

    /// The table of a recipe: the pinned table if it has this recipe and its file is intact, or else a new fit.
    fn fitted(&self, name: &Path, pin: &Pin) -> Result<Found, CommandFailure> {
        let recipe = self.fitting.recipe(name, &input::recipe_document(name)?)?;
        let is_pinned = pin.recipe.as_ref().is_some_and(|old| *old == recipe_document::canonical_json(&recipe));
        let old = self.lock.pins.iter().find(|old| old.name == pin.name);
        if let Some(old) = old.filter(|_| is_pinned)
            && client::check(&old.path, old.digest, None, &self.lock.folder)? == PinState::Right
        {
            return self.read(&self.lock.folder.join(&old.path), Some(old.digest));
        }
        let bytes = self.fitting.fit(&recipe)?;
        let digest = Digest::of(&bytes);
        let (_, file) = table_file::check(name, &bytes, Some(digest))?;
        Ok(Found { digest, file, bytes, from_source: false })
    }

    /// The table that is already pinned.
    fn pinned(&self, pin: &Pin) -> Result<Found, CommandFailure> {
        let old = self.lock.pins.iter().find(|old| old.name == pin.name).unwrap_or(pin);
        match client::check(&old.path, pin.digest, None, &self.lock.folder)? {
            PinState::Right => self.read(&self.lock.folder.join(&old.path), Some(pin.digest)),
            _ => self.of_source(pin.digest, pin.bytes, pin).map_err(|mut failure| {
                if let Some(cause) = client::change_of_git(&old.path, pin.digest, &self.lock.folder) {
                    let path = self.lock.folder.join(&old.path);
                    failure.message = format!("{}\n{}: {cause}", failure.message, path.display());
                }
                failure
            }),
        }
    }

    fn read(&self, path: &Path, expected: Option<Digest>) -> Result<Found, CommandFailure> {
        let bytes = table_file::read(path, self.args.sources.limit.table_limit)?;
        let (digest, file) = table_file::check(path, &bytes, expected)?;
        Ok(Found { digest, file, bytes, from_source: false })
    }

    fn of_source(&self, digest: Digest, stated_bytes: Option<u64>, pin: &Pin) -> Result<Found, CommandFailure> {
        let sources = self.sources.of(pin.sources.iter().chain(&self.lock.sources), &self.lock.folder);
        let wanted = Wanted::table(digest, stated_bytes);
        let bytes = self.sources.with_access(&self.context.interrupt, |access| fetch(&sources, &wanted, access))?;
        let (digest, file) = table_file::check(Path::new(&digest.to_string()), &bytes, Some(digest))?;
        Ok(Found { digest, file, bytes, from_source: true })
    }
}
