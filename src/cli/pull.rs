//! `pull`: the tables pinned in the lock file.

use std::{
    io,
    path::{Path, PathBuf},
};

use serde_json::json;

use super::{
    CommandFailure, Context, Exit, Interrupt, args::PullArgs, config_file::DEFAULT_SERVER, file_failure,
    output::check_output_folder, print, shown,
};
use crate::{
    client::{self, Client, Limits, LockFile, LockFileError, Pin, PinState, read_text, with_pin},
    files::{
        digest::ParseDigestError,
        replace::{folder_of, replace_file},
    },
};

/// The servers that a table may be downloaded from, besides the one that its pin names.
#[derive(Debug, Clone, Copy)]
pub(super) struct Servers<'a> {
    /// Named on the command line or in the environment: goes before a pin's own.
    pub(super) chosen: Option<&'a str>,
    /// Named in the configuration file: for pins without their own.
    pub(super) usual: Option<&'a str>,
}

/// How tables are downloaded.
#[derive(Debug)]
struct Downloads<'a> {
    servers: Servers<'a>,
    limits: Limits,
    interrupt: Interrupt,
}

impl Downloads<'_> {
    fn client(&self, server: Option<&str>) -> Result<Client, CommandFailure> {
        let Servers { chosen, usual } = self.servers;
        let server = chosen.or(server).or(usual).unwrap_or(DEFAULT_SERVER);
        Ok(Client::with_limits(server, self.limits)?)
    }

    /// Downloads the table of a pin if it is missing or differs, and says what was done.
    fn pull(&self, pin: &Pin, folder: &Path) -> Result<&'static str, CommandFailure> {
        let client = self.client(pin.server.as_deref())?;
        Ok(match client::pull(pin, folder, &client, &|| self.interrupt.is_set())? {
            PinState::Right => "unchanged",
            PinState::Missing => "downloaded",
            PinState::Different { .. } => "replaced",
        })
    }
}

/// Downloads every pinned table that is missing or differs. A failure does not stop the others; the first one decides
/// the exit code.
pub(super) fn run(
    args: &PullArgs,
    servers: Servers<'_>,
    json: bool,
    context: &mut Context<'_>,
) -> Result<Exit, CommandFailure> {
    let limits = Limits { table_bytes: args.limit.table_limit, ..Limits::USUAL };
    let downloads = Downloads { servers, limits, interrupt: context.interrupt.clone() };
    // A wrong URL is told before anything is done.
    downloads.client(None)?;
    let added = match args.add.as_slice() {
        [name, digest] => Some((name, add(args, name, digest, &downloads)?)),
        _ => None,
    };
    let lock = LockFile::read(&args.lock)?;
    let mut failures: Vec<CommandFailure> = Vec::new();
    for pin in &lock.pins {
        if context.interrupt.is_set() {
            return Err(CommandFailure::interrupted());
        }
        let outcome = match added {
            Some((name, word)) if *name == pin.name => Ok(word),
            _ if args.locked => check(pin, &lock.folder),
            _ => downloads.pull(pin, &lock.folder),
        };
        let (word, detail) = match &outcome {
            Ok(word) => (*word, None),
            Err(failure) => ("failed", Some(&failure.message)),
        };
        let mut value = json!({ "name": pin.name, "path": shown(&pin.path), "digest": pin.digest, "outcome": word });
        if let Some(detail) = detail {
            value["detail"] = json!(detail);
        }
        if json || outcome.is_ok() {
            print(context.stdout, json, &value, &format!("{} {word}: {}", pin.name, pin.path.display()))?;
        }
        failures.extend(outcome.err().map(|failure| named(&pin.name, &failure)));
    }
    match failures.first().map(|first| first.exit) {
        None => Ok(Exit::Ok),
        Some(exit) => {
            let lines: Vec<String> = failures.into_iter().map(|failure| failure.message).collect();
            Err(CommandFailure::new(exit, lines.join("\n")))
        }
    }
}

/// The failure of the pin `name`.
fn named(name: &str, failure: &CommandFailure) -> CommandFailure {
    CommandFailure::new(failure.exit, format!("{name}: {}", failure.message))
}

fn check(pin: &Pin, folder: &Path) -> Result<&'static str, CommandFailure> {
    let path = folder.join(&pin.path);
    let drift = |reason: String| Err(CommandFailure::new(Exit::Mismatch, format!("{}: {reason}", path.display())));
    match client::check(pin, folder)? {
        PinState::Right => Ok("unchanged"),
        PinState::Missing => drift("the file is missing".into()),
        PinState::Different { actual } => drift(format!("the file hashes to {actual}, {} is pinned", pin.digest)),
    }
}

/// Downloads a table and then writes its pin into the lock file, which is made when it is missing. Says what was done with
/// the table's file.
///
/// # Errors
/// When the pin is not allowed, which is told first, or the table cannot be downloaded. The lock file is then as before.
fn add(args: &PullArgs, name: &str, digest: &str, downloads: &Downloads<'_>) -> Result<&'static str, CommandFailure> {
    let mut pin = Pin {
        name: name.to_owned(),
        digest: digest
            .parse()
            .map_err(|error: ParseDigestError| CommandFailure::new(Exit::Usage, error.to_string()))?,
        path: args.to.clone().unwrap_or_else(|| PathBuf::from(format!("{name}.safetensors"))),
        bytes: None,
        server: downloads.servers.chosen.map(str::to_owned),
    };
    let old = match read_text(&args.lock) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
        Err(source) => return Err(LockFileError::Read { path: args.lock.clone(), source }.into()),
    };
    with_pin(&old, &pin)?;
    check_output_folder(folder_of(&args.lock))?;
    let folder = args.lock.parent().unwrap_or(Path::new(""));
    let word = downloads.pull(&pin, folder).map_err(|failure| named(name, &failure))?;
    let file = folder.join(&pin.path);
    pin.bytes = Some(file.metadata().map_err(|error| file_failure(&file, &error))?.len());
    let new = with_pin(&old, &pin)?;
    replace_file(&args.lock, new.as_bytes()).map_err(|error| file_failure(&args.lock, &error))?;
    Ok(word)
}
