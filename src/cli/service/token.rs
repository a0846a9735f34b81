//! `token new`: a token of a service.

use std::{fs::File, io::Read as _};

use clap::Subcommand;
use serde_json::json;

use super::{CommandFailure, Context, Exit, failed, named, usage};
use ltcforge_server::http::{Scope, TOKEN_BYTES, Token};

/// The commands on tokens.
#[derive(Debug, Subcommand)]
pub enum TokenCommand {
    /// Print a new token and its line for the service's token file
    New {
        /// Owner, shown with jobs: up to 64 letters, digits and -_.@
        name: String,
        /// Rights: read; submit also cancels; admin also deletes
        #[arg(long, value_parser = named(&Scope::ALL, Scope::name))]
        scope: Scope,
    },
}

/// Makes a token from the system's random bytes.
pub(super) fn run(command: &TokenCommand, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let TokenCommand::New { name, scope } = command;
    let mut random = [0; TOKEN_BYTES];
    let read = File::open("/dev/urandom").and_then(|mut system| system.read_exact(&mut random));
    read.map_err(|error| failed(format!("/dev/urandom: {error}")))?;
    let (secret, kept) = Token::new(name, *scope, &random).map_err(usage)?;
    let kept = kept.to_string();
    let text = format!("token for the client (keep it secret):\n{secret}\nline for the service's token file:\n{kept}");
    context.print(&json!({ "token": secret, "kept": kept }), &text)
}
