//! Blocking calls of the HTTP interface.

use std::{
    io::Write,
    thread::sleep,
    time::{Duration, Instant},
};

use serde::Deserialize;
use serde_json::Value;
use ureq::{
    Agent, Body, Proxy, RequestBuilder,
    config::RedirectAuthHeaders,
    http::{Response, Uri},
    tls::{RootCerts, TlsConfig},
};

use super::{
    Access, ClientError, JobDocument, ServerTokens, SourcesError, Wanted,
    base::{is_this_machine, parse_base},
    download::copy,
    error::printable,
};
use ltcforge_files::{
    bounded::read_stream,
    job::{JobId, StateName},
};

/// Time limit for opening a connection.
const CONNECT: Duration = Duration::from_secs(10);
/// Time limit for the head of a response, and for each pause within a request or a response.
const STALL: Duration = Duration::from_secs(45);
/// Time limit for a whole document.
const DOCUMENT_TIME: Duration = Duration::from_secs(120);
/// Maximum size of a document: a job, a page of jobs, or a problem.
const DOCUMENT_BYTES: u64 = 4 << 20;
/// Time limit for a whole file.
const FILE_TIME: Duration = Duration::from_secs(6 * 3600);
/// The pause between two requests while a job is followed.
const POLL: Duration = Duration::from_millis(250);
/// Time limit for reaching an unavailable server again while a job is followed.
const RECONNECT_LIMIT: Duration = Duration::from_secs(20);

/// A client of one service.
pub struct Client {
    agent: Agent,
    base: String,
    /// The value of the `Authorization` header.
    authorization: Option<String>,
}

/// The part of a page of a list that the client reads.
#[derive(Debug, Deserialize)]
struct Page {
    items: Vec<Value>,
    next: Option<String>,
}

/// The HTTP agent for a server.
fn agent(server: &Uri, stall: Duration) -> Agent {
    // The platform's verifier also knows private certificate authorities.
    let tls = TlsConfig::builder().root_certs(RootCerts::PlatformVerifier).build();
    let config = Agent::config_builder()
        .tls_config(tls)
        .http_status_as_error(false)
        .proxy(Proxy::try_from_env().filter(|_| !is_this_machine(server)))
        .timeout_connect(Some(CONNECT))
        .timeout_recv_response(Some(STALL))
        .timeout_recv_body(Some(DOCUMENT_TIME))
        .timeout_per_read(Some(stall))
        .timeout_per_write(Some(STALL))
        .redirect_auth_headers(RedirectAuthHeaders::Never)
        .user_agent(concat!("ltcforge/", env!("CARGO_PKG_VERSION")))
        .build();
    config.into()
}

impl Client {
    /// A client of the service at `base`, such as `http://127.0.0.1:8317`. It sends the token that `tokens` have for
    /// that server. It does not send the token to the target of a redirect.
    ///
    /// # Errors
    /// [`ClientError::BadUrl`] when `base` is not an http or https URL, or has a user.
    pub fn new(base: &str, tokens: &ServerTokens) -> Result<Self, ClientError> {
        Self::with_stall(base, tokens, STALL)
    }

    /// Like [`Self::new`], with another time limit for the head of a response and for each pause.
    pub(super) fn with_stall(base: &str, tokens: &ServerTokens, stall: Duration) -> Result<Self, ClientError> {
        let base = base.trim_end_matches('/').to_owned();
        let uri = parse_base(&base)?;
        let authorization = tokens.of(&uri).map(|token| format!("Bearer {token}"));
        Ok(Self { agent: agent(&uri, stall), base, authorization })
    }

    fn signed<B>(&self, request: RequestBuilder<B>) -> RequestBuilder<B> {
        match &self.authorization {
            Some(value) => request.header("authorization", value),
            None => request,
        }
    }

    /// Submits a recipe document.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn submit(&self, document: &[u8]) -> Result<JobDocument, ClientError> {
        let url = self.url("/v1/jobs");
        let request = self.signed(self.agent.post(&url)).content_type("application/json");
        job_of(&url, request.send(document))
    }

    /// Stores the file of a tabulated BRDF, which recipes then name by its digest.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn store_brdf(&self, bytes: &[u8]) -> Result<(), ClientError> {
        let url = self.url("/v1/brdfs");
        let request = self.signed(self.agent.post(&url)).content_type("application/octet-stream");
        document(&url, request.send(bytes)).map(drop)
    }

    /// A job as it is now.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn job(&self, id: JobId) -> Result<JobDocument, ClientError> {
        let url = self.url(&format!("/v1/jobs/{id}"));
        job_of(&url, self.signed(self.agent.get(&url)).call())
    }

    /// Cancels a job.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn cancel(&self, id: JobId) -> Result<JobDocument, ClientError> {
        let url = self.url(&format!("/v1/jobs/{id}"));
        job_of(&url, self.signed(self.agent.delete(&url)).call())
    }

    /// At most `limit` jobs, newest first.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn jobs(&self, state: Option<StateName>, limit: usize) -> Result<Vec<JobDocument>, ClientError> {
        /// Jobs on a page. A page of jobs whose recipes list few nodes is far below [`DOCUMENT_BYTES`].
        const PAGE: usize = 200;
        let url = self.url("/v1/jobs");
        let mut jobs = Vec::new();
        let mut cursor: Option<String> = None;
        while jobs.len() < limit {
            let mut request = self.signed(self.agent.get(&url));
            request = request.query("limit", (limit - jobs.len()).min(PAGE).to_string());
            if let Some(Ok(Value::String(name))) = state.map(serde_json::to_value) {
                request = request.query("state", name);
            }
            if let Some(cursor) = &cursor {
                request = request.query("cursor", cursor);
            }
            let page = document(&url, request.call())?;
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

    /// Writes the wanted file to `sink` as it arrives, and checks its size and hash.
    ///
    /// # Errors
    /// See [`SourcesError`]. After an error, the bytes in `sink` must not be used.
    pub(super) fn download(
        &self,
        wanted: &Wanted,
        access: &Access<'_>,
        sink: &mut dyn Write,
    ) -> Result<(), SourcesError> {
        let url = self.url(&wanted.path);
        let request = self.signed(self.agent.get(&url)).config().timeout_recv_body(Some(FILE_TIME)).build();
        let body = successful(&url, request.call())?.into_body();
        let failed = |error| ClientError::transport(&url, &ureq::Error::from(error));
        copy((&url, body.into_reader()), wanted, access, failed, sink)
    }

    /// Follows a job to its final state, and returns the final state. `on_update` is called on each change.
    ///
    /// # Errors
    /// See [`ClientError`]. [`ClientError::Unavailable`] when the server cannot be reached again within 20 seconds.
    pub fn follow(&self, id: JobId, on_update: &mut dyn FnMut(&JobDocument)) -> Result<JobDocument, ClientError> {
        let mut latest = self.job(id)?;
        on_update(&latest);
        let mut answered = Instant::now();
        while !latest.is_final() {
            sleep(POLL);
            match self.job(id) {
                Err(ClientError::Unavailable { .. }) if answered.elapsed() < RECONNECT_LIMIT => continue,
                job if job.as_ref().is_ok_and(|job| *job == latest) => {}
                job => {
                    latest = job?;
                    on_update(&latest);
                }
            }
            answered = Instant::now();
        }
        Ok(latest)
    }

    fn url(&self, path: &str) -> String {
        format!("{}{path}", self.base)
    }
}

/// The response, if its status is a success.
fn successful(url: &str, sent: Result<Response<Body>, ureq::Error>) -> Result<Response<Body>, ClientError> {
    let response = sent.map_err(|error| ClientError::transport(url, &error))?;
    let status = response.status();
    if status.is_success() {
        return Ok(response);
    }
    // The body of an error may be incomplete. The status alone is enough for an error message.
    let body = read_stream(response.into_body().into_reader(), DOCUMENT_BYTES).unwrap_or_default();
    Err(ClientError::status(url, status.as_u16(), &body))
}

fn document(url: &str, sent: Result<Response<Body>, ureq::Error>) -> Result<Vec<u8>, ClientError> {
    let read = read_stream(successful(url, sent)?.into_body().into_reader(), DOCUMENT_BYTES);
    read.map_err(|error| ClientError::transport(url, &ureq::Error::from(error)))
}

fn job_of(url: &str, sent: Result<Response<Body>, ureq::Error>) -> Result<JobDocument, ClientError> {
    let body = document(url, sent)?;
    serde_json::from_slice(&body).and_then(JobDocument::parse).map_err(|error| unexpected(url, &error))
}

fn unexpected(url: &str, error: &serde_json::Error) -> ClientError {
    // The error may quote the server's response.
    ClientError::Unexpected { url: url.to_owned(), reason: printable(&error.to_string()) }
}
