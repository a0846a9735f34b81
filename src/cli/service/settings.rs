//! Settings of the service. [`ServeSettings`] declares each setting once, for the command line, the environment and the
//! section `[serve]` of the configuration file. A flag overrides its variable, a variable overrides the file, and
//! the file overrides the default.

use std::{
    fmt::Display,
    net::{Ipv4Addr, SocketAddr},
    num::{NonZeroU64, NonZeroUsize},
    path::PathBuf,
    str::FromStr,
    time::Duration,
};

use clap::{ArgMatches, Args, Command, FromArgMatches};
use serde::{Deserialize, Deserializer, de::Error as _};

#[cfg(feature = "cluster")]
use super::replica::ReplicaArgs;
use super::{CommandFailure, named, usage};
use crate::values::{ThreadCount, UpTo, cores};
use ltcforge_files::recipe_document::DEFAULT_ENTRY_LIMIT;
use ltcforge_server::{
    http::{self, AllowedHost, AllowedOrigin, Origins},
    service::Config,
};
use ltcforge_view::preview::Adapter;

/// How long a lease lasts. A process renews its leases every 0.1 s, or in a cluster every 0.5 s.
const LEASE_TTL: Duration = Duration::from_secs(60);

/// Seconds that the service waits for a client or a picture, at most a day.
type WaitSeconds = UpTo<86_400>;

impl WaitSeconds {
    /// The setting as a duration.
    fn duration(self) -> Duration {
        Duration::from_secs(self.0)
    }
}

/// Settings of `serve`. The defaults are those of [`Self::default`].
#[derive(Debug, Clone, PartialEq, Eq, Args, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct ServeSettings {
    /// Address to listen on; port 0 picks a free port [default: 127.0.0.1:8317]
    #[arg(long, env = "LTCFORGE_LISTEN", value_name = "ADDRESS")]
    pub listen: SocketAddr,
    /// Data folder, created if missing [default: ltcforge-data]
    #[arg(long, env = "LTCFORGE_DATA", value_name = "DIR")]
    pub data: PathBuf,
    /// Shards to fit at the same time, 1 to 512 [default: one per core]
    #[arg(long, env = "LTCFORGE_WORKERS", value_name = "N")]
    pub workers: Option<ThreadCount>,
    /// Maximum number of waiting and running jobs [default: 64]
    #[arg(long, env = "LTCFORGE_QUEUE_LIMIT", value_name = "N")]
    pub queue_limit: NonZeroUsize,
    /// Maximum entries of a table [default: 2000000]
    #[arg(long, env = "LTCFORGE_ENTRY_LIMIT", value_name = "N")]
    pub entry_limit: NonZeroU64,
    /// Maximum predicted seconds of a job [default: 86400]
    #[arg(long, env = "LTCFORGE_JOB_SECONDS", value_name = "N")]
    pub job_seconds: NonZeroU64,
    /// Days until an ended job is deleted; 0 keeps all [default: 90]
    #[arg(long, env = "LTCFORGE_JOB_DAYS", value_name = "N")]
    pub job_days: u32,
    /// Keep at most this many bytes; delete the least recently used tables
    #[arg(long, env = "LTCFORGE_STORE_BYTES", value_name = "N")]
    pub store_bytes: Option<NonZeroU64>,
    /// Maximum number of stored BRDFs [default: 256]
    #[arg(long, env = "LTCFORGE_BRDF_LIMIT", value_name = "N")]
    pub brdf_limit: NonZeroUsize,
    /// Renderer of previews [default: any]
    #[arg(long, value_parser = named(Adapter::ALL, Adapter::name), env = "LTCFORGE_ADAPTER")]
    #[serde(deserialize_with = "adapter")]
    pub adapter: Adapter,
    /// Maximum seconds to render a picture, 1 to 86400 [default: 30]
    #[arg(long, env = "LTCFORGE_PICTURE_SECONDS", value_name = "N")]
    pub picture_seconds: WaitSeconds,
    /// Host name that clients may use; repeatable
    #[arg(long, env = "LTCFORGE_ALLOW_HOST", value_name = "HOST[:PORT]", value_delimiter = ',')]
    #[serde(deserialize_with = "from_texts")]
    pub allow_host: Vec<AllowedHost>,
    /// Web origin that may call the service, e.g. `https://wiki.example`
    #[arg(long, env = "LTCFORGE_ALLOW_ORIGIN", value_name = "ORIGIN", value_delimiter = ',')]
    #[serde(deserialize_with = "from_texts")]
    pub allow_origin: Vec<AllowedOrigin>,
    /// Token file; every request then needs a token
    #[arg(long, env = "LTCFORGE_TOKENS", value_name = "FILE")]
    pub tokens: Option<PathBuf>,
    /// More tokens, separated by `;`
    #[arg(long, env = "LTCFORGE_TOKEN_LIST", hide_env_values = true, value_name = "TOKENS")]
    pub token_list: Option<String>,
    /// Serve other machines without tokens
    #[arg(long, env = "LTCFORGE_ALLOW_ANYONE", num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
    pub allow_anyone: Option<bool>,
    /// TLS certificate chain (PEM)
    #[arg(long, env = "LTCFORGE_TLS_CERTIFICATE", value_name = "FILE")]
    pub tls_certificate: Option<PathBuf>,
    /// Private key of the certificate (PEM)
    #[arg(long, env = "LTCFORGE_TLS_KEY", value_name = "FILE")]
    pub tls_key: Option<PathBuf>,
    /// Maximum concurrent requests, not counting event streams [default: 256]
    #[arg(long, env = "LTCFORGE_REQUESTS", value_name = "N")]
    pub requests: NonZeroUsize,
    /// Seconds that a client may take to send headers or body [default: 30]
    #[arg(long, env = "LTCFORGE_CLIENT_SECONDS", value_name = "N")]
    pub client_seconds: WaitSeconds,
    /// The database and object store of a cluster. They cannot be set in the file.
    #[cfg(feature = "cluster")]
    #[command(flatten)]
    #[serde(skip)]
    pub replica: ReplicaArgs,
}

impl Default for ServeSettings {
    fn default() -> Self {
        Self {
            listen: SocketAddr::new(Ipv4Addr::LOCALHOST.into(), 8317),
            data: "ltcforge-data".into(),
            workers: None,
            queue_limit: const { NonZeroUsize::new(64).unwrap() },
            entry_limit: const { NonZeroU64::new(DEFAULT_ENTRY_LIMIT).unwrap() },
            job_seconds: const { NonZeroU64::new(86_400).unwrap() },
            job_days: 90,
            store_bytes: None,
            brdf_limit: const { NonZeroUsize::new(256).unwrap() },
            adapter: Adapter::Any,
            picture_seconds: UpTo(30),
            allow_host: Vec::new(),
            allow_origin: Vec::new(),
            tokens: None,
            token_list: None,
            allow_anyone: None,
            tls_certificate: None,
            tls_key: None,
            requests: const { NonZeroUsize::new(256).unwrap() },
            client_seconds: UpTo(30),
            #[cfg(feature = "cluster")]
            replica: ReplicaArgs::default(),
        }
    }
}

/// Parses a list of strings in a file, each as on the command line.
fn from_texts<'de, D: Deserializer<'de>, T: FromStr<Err: Display>>(from: D) -> Result<Vec<T>, D::Error> {
    let texts = Vec::<String>::deserialize(from)?;
    texts.iter().map(|text| text.parse().map_err(D::Error::custom)).collect()
}

fn adapter<'de, D: Deserializer<'de>>(from: D) -> Result<Adapter, D::Error> {
    let name = String::deserialize(from)?;
    let known = Adapter::from_name(&name);
    known.ok_or_else(|| D::Error::custom(format!("adapter must be any, gpu or cpu, got «{name}»")))
}

/// The settings of `serve` from flags and variables, before they override the file's settings.
#[derive(Debug)]
pub struct ServeArgs(ArgMatches);

impl ServeArgs {
    /// Overrides the settings of a configuration file with these. A list replaces the file's list.
    ///
    /// # Errors
    /// None are expected: the flags were checked when they were parsed.
    pub(super) fn over(mut self, mut file: ServeSettings) -> Result<ServeSettings, CommandFailure> {
        file.update_from_arg_matches_mut(&mut self.0).map_err(usage)?;
        Ok(file)
    }
}

impl FromArgMatches for ServeArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        Ok(Self(matches.clone()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        self.0 = matches.clone();
        Ok(())
    }
}

impl Args for ServeArgs {
    fn augment_args(command: Command) -> Command {
        // All flags are optional.
        ServeSettings::augment_args_for_update(command)
    }

    fn augment_args_for_update(command: Command) -> Command {
        ServeSettings::augment_args_for_update(command)
    }
}

impl ServeSettings {
    /// The settings of the service behind the HTTP interface.
    pub(super) fn config(&self) -> Config {
        Config {
            data_dir: self.data.clone(),
            workers: self.workers.map_or_else(cores, ThreadCount::count).get(),
            queue_limit: self.queue_limit.get(),
            entry_limit: self.entry_limit.get(),
            job_seconds: self.job_seconds.get(),
            keep_ended: (self.job_days > 0).then(|| Duration::from_secs(u64::from(self.job_days) * 86_400)),
            store_bytes: self.store_bytes.map(NonZeroU64::get),
            lease_ttl: LEASE_TTL,
            adapter: self.adapter,
            picture_time: self.picture_seconds.duration(),
            brdf_limit: self.brdf_limit.get(),
        }
    }

    /// The settings of the HTTP interface.
    ///
    /// # Errors
    /// See [`Self::tokens`] and [`Self::certificate`].
    pub(super) fn http(&self) -> Result<http::Options, CommandFailure> {
        Ok(http::Options {
            requests: self.requests.get(),
            client: self.client_seconds.duration(),
            origins: Origins { hosts: self.allow_host.clone(), origins: self.allow_origin.clone() },
            tokens: self.tokens()?,
            certificate: self.certificate()?,
            only_operations: false,
        })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use clap::Parser as _;

    use super::*;
    use crate::{Cli, Command as CliCommand, service::ServiceCommand};

    /// The settings of a file and of flags.
    pub(in crate::service) fn settings(file: &str, flags: &[&str]) -> ServeSettings {
        let line = ["ltcforge", "serve"].iter().chain(flags);
        let command = Cli::try_parse_from(line).expect("good flags").command;
        let CliCommand::Service(ServiceCommand::Serve(args)) = command else { panic!() };
        args.over(toml_edit::de::from_str(file).expect("a good file")).expect("settings")
    }

    #[test]
    fn a_flag_overrides_the_file_which_overrides_the_default() {
        let file = "data = 'file'\nqueue_limit = 5\nadapter = 'cpu'\njob_days = 7";
        let merged = settings(file, &["--data", "flag", "--job-days", "0"]);
        let by_hand = ServeSettings {
            data: "flag".into(),
            queue_limit: NonZeroUsize::new(5).expect("not zero"),
            adapter: Adapter::Cpu,
            job_days: 0,
            ..ServeSettings::default()
        };
        assert_eq!(merged, by_hand);
    }

    #[test]
    fn every_setting_is_known_to_the_file_and_to_the_command_line() {
        let file = "listen = '[::1]:80'\ndata = 'd'\nworkers = 3\nqueue_limit = 4\nentry_limit = 5\njob_seconds = 6\n\
                    job_days = 7\nadapter = 'gpu'\npicture_seconds = 9\n\
                    allow_host = ['h']\nallow_origin = ['https://o']\nrequests = 12\n\
                    client_seconds = 14\nbrdf_limit = 15\n\
                    tokens = 't'\ntoken_list = 'l'\nallow_anyone = true\ntls_certificate = 'c'\ntls_key = 'k'\n\
                    store_bytes = 19";
        let flags: Vec<String> = file
            .lines()
            .map(|line| {
                let (key, value) = line.split_once(" = ").expect("a setting");
                format!("--{}={}", key.replace('_', "-"), value.trim_matches(['[', ']']).trim_matches('\''))
            })
            .map(|flag| flag.replace("=::1]", "=[::1]"))
            .collect();
        let flags: Vec<&str> = flags.iter().map(String::as_str).collect();
        assert_eq!(settings(file, &[]), settings("", &flags));
        let command = ServeSettings::augment_args_for_update(Command::new("serve"));
        let in_file = command.get_arguments().filter(|argument| file.contains(&format!("{} = ", argument.get_id())));
        assert_eq!(in_file.count(), file.lines().count());
    }

    #[test]
    fn help_states_the_defaults() {
        let command = ServeSettings::augment_args_for_update(Command::new("serve"));
        let stated = command.get_arguments().filter_map(|argument| {
            let help = argument.get_help()?.to_string();
            let (_, default) = help.rsplit_once("[default: ")?;
            Some(format!("--{}={}", argument.get_long()?, default.strip_suffix(']')?))
        });
        // Defaults in words depend on the machine.
        let stated: Vec<String> = stated.filter(|flag| !flag.contains(' ')).collect();
        assert!(stated.len() > 10, "{stated:?}");
        let flags: Vec<&str> = stated.iter().map(String::as_str).collect();
        let shown = |settings: &ServeSettings| format!("{:?}", (settings.listen, settings.config(), settings.http()));
        assert_eq!(shown(&settings("", &flags)), shown(&ServeSettings::default()));
    }

    #[test]
    fn pictures_and_jobs_have_limits() {
        let config = settings("", &[]).config();
        assert_eq!(config.picture_time, Duration::from_secs(30));
        assert_eq!((config.keep_ended, config.store_bytes), (Some(Duration::from_secs(90 * 86_400)), None));
        let file = "picture_seconds = 60\njob_days = 7";
        let config = settings(file, &["--picture-seconds", "5", "--store-bytes", "1000"]).config();
        assert_eq!((config.picture_time, config.store_bytes), (Duration::from_secs(5), Some(1000)));
        assert_eq!(config.keep_ended, Some(Duration::from_secs(7 * 86_400)));
        assert_eq!(settings(file, &["--job-days", "0"]).config().keep_ended, None, "jobs are kept forever");
    }

    #[test]
    fn serve_has_at_most_25_flags() {
        assert!(ServeSettings::augment_args_for_update(Command::new("serve")).get_arguments().count() <= 25);
    }

    #[test]
    fn a_list_of_flags_replaces_that_of_the_file() {
        let hosts = |flags| settings("allow_host = ['farm']", flags).http().expect("options").origins.hosts;
        let names = |names: &[&str]| names.iter().map(|name| name.parse().expect("a host")).collect::<Vec<_>>();
        assert_eq!(hosts(&[]), names(&["farm"]));
        assert_eq!(hosts(&["--allow-host", "a", "--allow-host", "b,c"]), names(&["a", "b", "c"]));
    }
}
