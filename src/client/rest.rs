//! The calls of the HTTP interface. They block.

use std::{
    fmt,
    io::{self, BufReader},
    time::{Duration, Instant},
};

use serde::Deserialize;
use serde_json::Value;
use ureq::{
    Agent, Body, Proxy, RequestBuilder,
    config::RedirectAuthHeaders,
    http::Response,
    tls::{RootCerts, TlsConfig},
    typestate::{WithBody, WithoutBody},
};

use super::{
    ClientError, JobDocument, Limits, ServerTokens, answer,
    base::{is_this_machine, parse_base},
    download::Download,
    error::printable,
    events::events,
};
use ltcforge_files::{
    digest::Digest,
    job::{JobId, StateName},
};

/// How long a connection may take to open.
const CONNECT: Duration = Duration::from_secs(10);
/// How long the head of an answer may take, and how long a stream of events may be silent: three heartbeats.
const SILENCE: Duration = Duration::from_secs(45);
/// How long a follower tries to reach a server that became unavailable.
const RECONNECT_LIMIT: Duration = Duration::from_secs(20);
/// The pause between two attempts to reach it.
const RECONNECT_PAUSE: Duration = Duration::from_millis(500);

/// A service, by its URL.
pub struct Client {
    agent: Agent,
    base: String,
    limits: Limits,
    /// The value of `Authorization`.
    authorization: Option<String>,
}

/// Without the token.
impl fmt::Debug for Client {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Client").field("base", &self.base).finish_non_exhaustive()
    }
}

/// The part of a page of a list that the client reads.
#[derive(Debug, Deserialize)]
struct Page {
    items: Vec<Value>,
    next: Option<String>,
}

impl Client {
    /// A client of the service at `base`, such as `http://127.0.0.1:8317`, with the usual limits.
    ///
    /// # Errors
    /// [`ClientError::BadUrl`], [`ClientError::BadPort`] and [`ClientError::Credentials`] when `base` is not an http or
    /// https URL, with a port that there is, and without a user.
    pub fn new(base: &str) -> Result<Self, ClientError> {
        Self::with_limits(base, Limits::USUAL)
    }

    /// The same with other limits.
    ///
    /// # Errors
    /// [`ClientError::BadUrl`], [`ClientError::BadPort`] and [`ClientError::Credentials`] when `base` is not an http or
    /// https URL, with a port that there is, and without a user.
    pub fn with_limits(base: &str, limits: Limits) -> Result<Self, ClientError> {
        let base = base.trim_end_matches('/').to_owned();
        let uri = parse_base(&base)?;
        // A farm's own authority vouches for its services, which no list of the web's knows.
        let tls = TlsConfig::builder().root_certs(RootCerts::PlatformVerifier).build();
        let config = Agent::config_builder()
            .tls_config(tls)
            .http_status_as_error(false)
            .proxy(Proxy::try_from_env().filter(|_| !is_this_machine(&uri)))
            .timeout_connect(Some(CONNECT))
            .timeout_recv_response(Some(SILENCE))
            .timeout_per_read(Some(limits.stall))
            .timeout_per_write(Some(SILENCE))
            .redirect_auth_headers(RedirectAuthHeaders::Never)
            .user_agent(concat!("ltcforge/", env!("CARGO_PKG_VERSION")))
            .build();
        Ok(Self { agent: config.into(), base, limits, authorization: None })
    }

    /// The same with the token that `tokens` have for its server, if there is one. It is not sent along where the server sends
    /// the client on.
    #[must_use]
    pub fn with_tokens(self, tokens: &ServerTokens) -> Self {
        let base = parse_base(&self.base).ok();
        let token = base.and_then(|base| tokens.of(&base).map(|token| format!("Bearer {token}")));
        Self { authorization: token, ..self }
    }

    fn signed<B>(&self, request: RequestBuilder<B>) -> RequestBuilder<B> {
        match &self.authorization {
            Some(value) => request.header("authorization", value),
            None => request,
        }
    }

    fn get(&self, url: &str) -> RequestBuilder<WithoutBody> {
        self.signed(self.agent.get(url))
    }

    fn post(&self, url: &str) -> RequestBuilder<WithBody> {
        self.signed(self.agent.post(url))
    }

    /// Submits a recipe document.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn submit(&self, document: &[u8]) -> Result<JobDocument, ClientError> {
        let url = self.url("/v1/jobs");
        let sent = self.post(&url).content_type("application/json").send(document);
        parse_job(&url, &self.document(&url, sent)?)
    }

    /// Stores the file of a tabulated BRDF, which recipes then name by its digest.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn store_brdf(&self, bytes: &[u8]) -> Result<(), ClientError> {
        let url = self.url("/v1/brdfs");
        let sent = self.post(&url).content_type("application/octet-stream").send(bytes);
        self.document(&url, sent).map(drop)
    }

    /// A job as it is now.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn job(&self, id: JobId) -> Result<JobDocument, ClientError> {
        let url = self.url(&format!("/v1/jobs/{id}"));
        parse_job(&url, &self.document(&url, self.get(&url).call())?)
    }

    /// Cancels a job.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn cancel(&self, id: JobId) -> Result<JobDocument, ClientError> {
        let url = self.url(&format!("/v1/jobs/{id}"));
        parse_job(&url, &self.document(&url, self.signed(self.agent.delete(&url)).call())?)
    }

    /// At most `limit` jobs, newest first.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn jobs(&self, state: Option<StateName>, limit: usize) -> Result<Vec<JobDocument>, ClientError> {
        /// Items on a page. A page of the largest jobs is far below the limit of a document.
        const PAGE: usize = 200;
        let url = self.url("/v1/jobs");
        let mut jobs = Vec::new();
        let mut cursor: Option<String> = None;
        while jobs.len() < limit {
            let mut request = self.get(&url).query("limit", (limit - jobs.len()).min(PAGE).to_string());
            if let Some(Ok(Value::String(name))) = state.map(serde_json::to_value) {
                request = request.query("state", name);
            }
            if let Some(cursor) = &cursor {
                request = request.query("cursor", cursor);
            }
            let page = self.document(&url, request.call())?;
            let page: Page = serde_json::from_slice(&page).map_err(|error| unexpected(&url, &error))?;
            let is_last = page.items.is_empty() || page.next.is_none();
            for item in page.items.into_iter().take(limit - jobs.len()) {
                jobs.push(JobDocument::parse(item).map_err(|error| unexpected(&url, &error))?);
            }
            if is_last {
                break;
            }
            cursor = page.next;
        }
        Ok(jobs)
    }

    /// Requests the canonical file of a table.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn table(&self, digest: Digest) -> Result<Download, ClientError> {
        self.download(&format!("/v1/tables/{digest}"), digest)
    }

    /// Requests the file of a tabulated BRDF.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn brdf(&self, digest: Digest) -> Result<Download, ClientError> {
        self.download(&format!("/v1/brdfs/{digest}"), digest)
    }

    /// Requests the file `path` of an export of a table. The file must have this digest.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn exported(&self, table: Digest, export: &str, path: &str, digest: Digest) -> Result<Download, ClientError> {
        self.download(&format!("/v1/tables/{table}/exports/{export}/{path}?digest={digest}"), digest)
    }

    fn download(&self, path: &str, digest: Digest) -> Result<Download, ClientError> {
        let url = self.url(path);
        let request = self.get(&url).header("accept-encoding", answer::CODINGS);
        let response = self.successful(&url, request.call())?;
        Ok(Download::new(url, response, digest, self.limits))
    }

    /// Follows a job to its final state and returns that. `on_update` is called on each change. After a lost connection
    /// the client goes on from the last event.
    ///
    /// # Errors
    /// See [`ClientError`]; unavailable when the server cannot be reached again within 20 seconds.
    pub fn follow(&self, id: JobId, on_update: &mut dyn FnMut(&JobDocument)) -> Result<JobDocument, ClientError> {
        // This request comes first, so that an unknown id or a missing server is an error at once.
        let mut latest = self.job(id)?;
        on_update(&latest);
        let mut seen: Option<String> = None;
        let mut last_update = Instant::now();
        while !latest.is_final() {
            let followed = self.follow_once(id, &mut seen, &mut |update| {
                last_update = Instant::now();
                on_update(&update);
                latest = update;
            });
            match followed {
                Err(error) if !is_temporary(&error) || last_update.elapsed() > RECONNECT_LIMIT => return Err(error),
                _ if latest.is_final() => {}
                _ => std::thread::sleep(RECONNECT_PAUSE),
            }
        }
        Ok(latest)
    }

    /// Follows a job over one connection, until either ends.
    fn follow_once(
        &self,
        id: JobId,
        seen: &mut Option<String>,
        on_update: &mut dyn FnMut(JobDocument),
    ) -> Result<(), ClientError> {
        let url = self.url(&format!("/v1/jobs/{id}/events"));
        let mut request = self.get(&url).header("accept", "text/event-stream");
        if let Some(seen) = seen.as_ref() {
            request = request.header("last-event-id", seen);
        }
        let request = request.config().timeout_per_read(Some(SILENCE)).build();
        let response = self.successful(&url, request.call())?;
        if response.status() == 204 {
            on_update(self.job(id)?);
            return Ok(());
        }
        for event in events(BufReader::new(response.into_body().into_reader())) {
            let event = event.map_err(|error| match error.kind() {
                // This is not an event stream, and another attempt would not change that.
                io::ErrorKind::InvalidData => ClientError::Unexpected { url: url.clone(), reason: error.to_string() },
                _ => ClientError::transport(&url, &ureq::Error::from(error)),
            })?;
            let json = serde_json::from_str(&event.data).map_err(|error| unexpected(&url, &error))?;
            let update = JobDocument::parse(json).map_err(|error| unexpected(&url, &error))?;
            *seen = event.id;
            let is_final = update.is_final();
            on_update(update);
            if is_final {
                break;
            }
        }
        Ok(())
    }

    fn url(&self, path: &str) -> String {
        format!("{}{path}", self.base)
    }

    /// The response, if its status is a success.
    fn successful(&self, url: &str, sent: Result<Response<Body>, ureq::Error>) -> Result<Response<Body>, ClientError> {
        let response = sent.map_err(|error| ClientError::transport(url, &error))?;
        let status = response.status();
        if status.is_success() {
            return Ok(response);
        }
        // The status is enough. The body of an error may be incomplete.
        let body = answer::document(url, response, self.limits).unwrap_or_default();
        Err(ClientError::status(url, status.as_u16(), &body))
    }

    fn document(&self, url: &str, sent: Result<Response<Body>, ureq::Error>) -> Result<Vec<u8>, ClientError> {
        answer::document(url, self.successful(url, sent)?, self.limits)
    }
}

/// Whether another attempt may succeed.
fn is_temporary(error: &ClientError) -> bool {
    matches!(error, ClientError::Unavailable { .. })
}

fn parse_job(url: &str, body: &[u8]) -> Result<JobDocument, ClientError> {
    serde_json::from_slice(body).and_then(JobDocument::parse).map_err(|error| unexpected(url, &error))
}

fn unexpected(url: &str, error: &serde_json::Error) -> ClientError {
    // The error may quote the server's answer.
    ClientError::Unexpected { url: url.to_owned(), reason: printable(&error.to_string()) }
}
