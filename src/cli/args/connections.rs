//! `serve`: whom it serves, and how many at a time.

use std::num::{NonZeroU64, NonZeroUsize};

use clap::Args;

use crate::server::http::{AllowedHost, AllowedOrigin};

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
    /// Seconds that a client may take to send a request's head, to send its body, or to read more of an answer
    /// [default: 30]
    #[arg(long, env = "LTCFORGE_CLIENT_SECONDS", value_name = "N")]
    pub client_seconds: Option<NonZeroU64>,
}
