//! `serve`: whom it serves, and how many at a time.

use std::{num::NonZeroUsize, str::FromStr, time::Duration};

use clap::Args;
use serde::Deserialize;

use ltcforge_server::http::{AllowedHost, AllowedOrigin};

/// Names, web pages and connections that `serve` accepts.
#[derive(Debug, Clone, Default, Args)]
pub struct ConnectionArgs {
    /// Name by which clients may call the service, beside its own address; may be repeated
    #[arg(long, env = "LTCFORGE_ALLOW_HOST", value_name = "HOST[:PORT]", value_delimiter = ',')]
    pub allow_host: Vec<AllowedHost>,
    /// Origin of web pages that may send requests, such as <https://wiki.example>; may be repeated
    #[arg(long, env = "LTCFORGE_ALLOW_ORIGIN", value_name = "ORIGIN", value_delimiter = ',')]
    pub allow_origin: Vec<AllowedOrigin>,
    /// Connections open at the same time; fewer if the process may not open as many files [default: 1024]
    #[arg(long, env = "LTCFORGE_CONNECTIONS", value_name = "N")]
    pub connections: Option<NonZeroUsize>,
    /// Connections open at the same time from one address [default: half of --connections]
    #[arg(long, env = "LTCFORGE_CONNECTIONS_PER_ADDRESS", value_name = "N")]
    pub connections_per_address: Option<NonZeroUsize>,
    /// Seconds that a client may take to send a request's head, to send its body, or to read more of an answer, 1 to
    /// 86400 [default: 30]
    #[arg(long, env = "LTCFORGE_CLIENT_SECONDS", value_name = "N")]
    pub client_seconds: Option<WaitSeconds>,
}

/// Seconds that the service waits for a client or a picture, at most a day.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(try_from = "u64")]
pub struct WaitSeconds(u64);

impl WaitSeconds {
    const MOST: u64 = 86_400;

    /// As a time.
    pub(crate) fn duration(self) -> Duration {
        Duration::from_secs(self.0)
    }
}

impl TryFrom<u64> for WaitSeconds {
    type Error = String;

    fn try_from(seconds: u64) -> Result<Self, String> {
        let is_allowed = (1..=Self::MOST).contains(&seconds);
        is_allowed.then_some(Self(seconds)).ok_or_else(|| format!("it is a number from 1 to {}", Self::MOST))
    }
}

impl FromStr for WaitSeconds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Self::try_from(text.parse().unwrap_or(0))
    }
}
