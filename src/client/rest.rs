//! Blocking calls of the HTTP interface.

use std::{
    env,
    io::Write,
    thread::sleep,
    time::{Duration, Instant},
};

use serde::Deserialize;
use serde_json::Value;
use ureq::{
    Agent, Body, Proxy, ProxyProtocol, RequestBuilder,
    config::RedirectAuthHeaders,
    http::{Response, Uri},
    tls::{RootCerts, TlsConfig},
};

use super::{
    Access, ClientError, JobDocument, ServerTokens, SourcesError, Wanted,
    base::{is_direct, parse_base},
    download::copy,
    error::printable,
};
use ltcforge_files::{
    bounded::{open_regular, read_stream},
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
/// Maximum number of requests to a server that is busy and states in `Retry-After` when to try again.
const MOST_TRIES: usize = 5;
/// Maximum time to wait for a busy server. A server that states a longer time has failed.
const BUSY_LIMIT: Duration = Duration::from_secs(30);

/// A client of one service.
pub struct Client {
    agent: Agent,
    base: String,
    /// The host and port of the proxy that connects to the server.
    proxy: Option<String>,
    /// The value of the `Authorization` header.
    authorization: Option<String>,
}

/// The part of a page of a list that the client reads.
#[derive(Debug, Deserialize)]
struct Page {
    items: Vec<Value>,
    next: Option<String>,
}

/// The proxy of the environment for a server. SOCKS proxies are ignored.
fn proxy_of(server: &Uri) -> Option<Proxy> {
    let is_http = |proxy: &Proxy| matches!(proxy.protocol(), ProxyProtocol::Http | ProxyProtocol::Https);
    Proxy::try_from_env().filter(is_http).filter(|_| !is_direct(server))
}

/// Checks the file of certificates that TLS will read. A FIFO would block the command.
fn check_certificates(server: &Uri) -> Result<(), ClientError> {
    let file = env::var_os("SSL_CERT_FILE").filter(|_| server.scheme_str() == Some("https"));
    let opened = file.as_ref().map_or(Ok(()), |file| open_regular(file.as_ref()).map(drop));
    opened.map_err(|error| ClientError::Unreadable {
        place: format!("SSL_CERT_FILE={}", file.unwrap_or_default().display()),
        reason: error.to_string(),
    })
}

/// The HTTP agent for a server.
fn agent(proxy: Option<Proxy>, stall: Duration) -> Agent {
    // The platform's verifier also knows private certificate authorities.
    let tls = TlsConfig::builder().root_certs(RootCerts::PlatformVerifier).build();
    let config = Agent::config_builder()
        .tls_config(tls)
        .http_status_as_error(false)
        .proxy(proxy)
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
        Self::with(base, tokens, STALL, proxy_of)
    }

    /// Like [`Self::new`], with another time limit for each pause, and with another choice of the proxy.
    pub(super) fn with(
        base: &str,
        tokens: &ServerTokens,
        stall: Duration,
        proxy_of: impl Fn(&Uri) -> Option<Proxy>,
    ) -> Result<Self, ClientError> {
        let base = base.trim_end_matches('/').to_owned();
        let uri = parse_base(&base)?;
        check_certificates(&uri)?;
        let authorization = tokens.of(&uri).map(|token| format!("Bearer {token}"));
        let proxy = proxy_of(&uri);
        let named = proxy.as_ref().filter(|proxy| !proxy.is_no_proxy(&uri));
        let named = named.map(|proxy| format!("{}:{}", proxy.host(), proxy.port()));
        Ok(Self { agent: agent(proxy, stall), base, proxy: named, authorization })
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
        let request = || self.signed(self.agent.post(&url)).content_type("application/json");
        self.job_of(&url, &|| request().send(document))
    }

    /// Stores the file of a tabulated BRDF, which recipes then name by its digest.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn store_brdf(&self, bytes: &[u8]) -> Result<(), ClientError> {
        let url = self.url("/v1/brdfs");
        let request = || self.signed(self.agent.post(&url)).content_type("application/octet-stream");
        self.document(&url, &|| request().send(bytes)).map(drop)
    }

    /// A job as it is now.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn job(&self, id: JobId) -> Result<JobDocument, ClientError> {
        let url = self.url(&format!("/v1/jobs/{id}"));
        self.job_of(&url, &|| self.signed(self.agent.get(&url)).call())
    }

    /// Cancels a job.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn cancel(&self, id: JobId) -> Result<JobDocument, ClientError> {
        let url = self.url(&format!("/v1/jobs/{id}"));
        self.job_of(&url, &|| self.signed(self.agent.delete(&url)).call())
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
            let send = || {
                let mut request = self.signed(self.agent.get(&url));
                request = request.query("limit", (limit - jobs.len()).min(PAGE).to_string());
                if let Some(Ok(Value::String(name))) = state.map(serde_json::to_value) {
                    request = request.query("state", name);
                }
                if let Some(cursor) = &cursor {
                    request = request.query("cursor", cursor);
                }
                request.call()
            };
            let page = self.document(&url, &send)?;
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
        let request = || self.signed(self.agent.get(&url)).config().timeout_recv_body(Some(FILE_TIME)).build();
        let response = self.successful(&url, &|| request().call(), access.should_stop);
        if (access.should_stop)() {
            return Err(SourcesError::Stopped);
        }
        let body = response?.into_body();
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

    /// The response, if its status is a success. While the server is busy, the request is sent again. Every request of
    /// this client may arrive twice: submitting a recipe or a BRDF again has no effect.
    fn successful(
        &self,
        url: &str,
        send: &SendRequest<'_>,
        should_stop: &dyn Fn() -> bool,
    ) -> Result<Response<Body>, ClientError> {
        let (mut tries, mut left) = (0, BUSY_LIMIT);
        loop {
            tries += 1;
            let response = send().map_err(|error| ClientError::no_response(url, self.proxy.as_deref(), &error))?;
            let status = response.status();
            if status.is_success() {
                return Ok(response);
            }
            let pause = retry_after(&response).filter(|pause| *pause <= left && tries < MOST_TRIES);
            if let Some(pause) = pause {
                left -= pause;
                let until = Instant::now() + pause;
                while Instant::now() < until && !should_stop() {
                    sleep(POLL.min(until - Instant::now()));
                }
                if !should_stop() {
                    continue;
                }
            }
            // The body of an error may be incomplete. The status alone is enough for an error message.
            let body = read_stream(response.into_body().into_reader(), DOCUMENT_BYTES).unwrap_or_default();
            return Err(ClientError::status(url, status.as_u16(), &body));
        }
    }

    fn document(&self, url: &str, send: &SendRequest<'_>) -> Result<Vec<u8>, ClientError> {
        let body = self.successful(url, send, &|| false)?.into_body();
        let read = read_stream(body.into_reader(), DOCUMENT_BYTES);
        read.map_err(|error| ClientError::transport(url, &ureq::Error::from(error)))
    }

    fn job_of(&self, url: &str, send: &SendRequest<'_>) -> Result<JobDocument, ClientError> {
        let body = self.document(url, send)?;
        serde_json::from_slice(&body).and_then(JobDocument::parse).map_err(|error| unexpected(url, &error))
    }
}

/// Sends a request.
type SendRequest<'a> = dyn Fn() -> Result<Response<Body>, ureq::Error> + 'a;

/// The time after which a busy server wants the request again. A date is ignored, because clocks differ.
fn retry_after(response: &Response<Body>) -> Option<Duration> {
    let seconds = response.headers().get("retry-after").filter(|_| matches!(response.status().as_u16(), 429 | 503))?;
    Some(Duration::from_secs(seconds.to_str().ok()?.trim().parse().ok()?))
}

fn unexpected(url: &str, error: &serde_json::Error) -> ClientError {
    // The error may quote the server's response.
    ClientError::Unexpected { url: url.to_owned(), reason: printable(&error.to_string()) }
}
