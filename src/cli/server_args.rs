//! Options of the commands that call a service.

use clap::Args;

use super::{CommandFailure, usage};
use ltcforge_client::{ServerTokens, ServerTokensError};

/// The service that a command calls.
#[derive(Debug, Args)]
pub struct ServerArgs {
    /// Service to call [default: `http://127.0.0.1:8317`]
    #[arg(long, global = true, env = "LTCFORGE_SERVER", value_name = "URL")]
    pub server: Option<String>,
    /// Its token.
    #[command(flatten)]
    pub token: TokenArgs,
}

/// The token of a service.
#[derive(Debug, Args)]
pub struct TokenArgs {
    /// Token of a service; set it in the environment to keep it secret
    #[arg(long, global = true, env = "LTCFORGE_TOKEN", hide_env_values = true, value_name = "URL TOKEN")]
    token: Option<String>,
}

impl TokenArgs {
    /// Parses the tokens: pairs of `URL TOKEN`, separated by `;`.
    pub(super) fn tokens(&self) -> Result<ServerTokens, CommandFailure> {
        let none = Ok(ServerTokens::NONE);
        self.token.as_ref().map_or(none, |text| text.parse().map_err(usage::<ServerTokensError>))
    }
}
