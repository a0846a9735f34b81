//! `pull`: the tables pinned in the lock file.

use std::{fs, io, path::Path};

use serde_json::json;

use super::{CommandFailure, Context, Exit, args::PullArgs, config_file::DEFAULT_SERVER, file_failure, print};
use crate::{
    client::{self, Client, LockFile, LockFileError, Pin, PinState, replace_file, with_pin},
    files::digest::ParseDigestError,
};

/// The servers that a table may be downloaded from, besides the one that its pin names.
#[derive(Debug, Clone, Copy)]
pub(super) struct Servers<'a> {
    /// Named on the command line or in the environment: goes before a pin's own.
    pub(super) chosen: Option<&'a str>,
    /// Named in the configuration file: for pins without their own.
    pub(super) usual: Option<&'a str>,
}

impl Servers<'_> {
    fn client_for(self, pin: &Pin) -> Result<Client, CommandFailure> {
        Ok(Client::new(self.chosen.or(pin.server.as_deref()).or(self.usual).unwrap_or(DEFAULT_SERVER))?)
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
    if let [name, digest] = args.add.as_slice() {
        add(args, name, digest, servers)?;
    }
    let lock = LockFile::read(&args.lock)?;
    let mut failures: Vec<CommandFailure> = Vec::new();
    for pin in &lock.pins {
        if context.interrupt.is_set() {
            return Err(CommandFailure::interrupted());
        }
        let outcome = if args.locked { check(pin, &lock.folder) } else { pull(pin, &lock.folder, servers) };
        match outcome {
            Ok(word) => {
                let value = json!({ "name": pin.name, "path": pin.path, "digest": pin.digest, "outcome": word });
                print(context.stdout, json, &value, &format!("{} {word}: {}", pin.name, pin.path.display()))?;
            }
            Err(failure) => {
                failures.push(CommandFailure::new(failure.exit, format!("{}: {}", pin.name, failure.message)));
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

fn pull(pin: &Pin, folder: &Path, servers: Servers<'_>) -> Result<&'static str, CommandFailure> {
    Ok(match client::pull(pin, folder, &servers.client_for(pin)?)? {
        PinState::Right => "unchanged",
        PinState::Missing => "downloaded",
        PinState::Different { .. } => "replaced",
    })
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

/// Writes a pin into the lock file, which is made when it is missing.
fn add(args: &PullArgs, name: &str, digest: &str, servers: Servers<'_>) -> Result<(), CommandFailure> {
    let pin = Pin {
        name: name.to_owned(),
        digest: digest
            .parse()
            .map_err(|error: ParseDigestError| CommandFailure::new(Exit::Usage, error.to_string()))?,
        path: args.to.clone().unwrap_or_else(|| format!("{name}.safetensors").into()),
        server: servers.chosen.map(str::to_owned),
    };
    let old = match fs::read_to_string(&args.lock) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
        Err(source) => return Err(LockFileError::Read { path: args.lock.clone(), source }.into()),
    };
    let new = with_pin(&old, &pin)?;
    replace_file(&args.lock, new.as_bytes()).map_err(|error| file_failure(&args.lock, &error))
}
