//! The calls of the HTTP interface, blocking.

use std::{
    io::BufReader,
    net::IpAddr,
    time::{Duration, Instant},
};

use serde::Deserialize;
use serde_json::Value;
use ureq::{
    Agent, Body, Proxy,
    http::{Response, Uri},
};

use super::{ClientError, JobDocument, events::events};
use crate::files::{
    digest::Digest,
    job::{JobId, StateName},
};

/// How long a connection may take to open.
const CONNECT: Duration = Duration::from_secs(10);
/// How long a server may send nothing: three of its heartbeats.
const SILENCE: Duration = Duration::from_secs(45);
/// Longest file that is downloaded. The service's limit on entries keeps tables far below it.
const FILE_LIMIT_BYTES: u64 = 1 << 32;
/// How long a follower tries to reach a server that became unavailable.
const RECONNECT_LIMIT: Duration = Duration::from_secs(20);
/// Pause between two attempts to reach it.
const RECONNECT_PAUSE: Duration = Duration::from_millis(500);

/// A service, by its URL.
#[derive(Debug)]
pub struct Client {
    agent: Agent,
    base: String,
}

/// The part of a page of a list that the client reads.
#[derive(Debug, Deserialize)]
struct Page {
    items: Vec<Value>,
    next: Option<String>,
}

impl Client {
    /// A client of the service at `base`, such as `http://127.0.0.1:8317`.
    ///
    /// # Errors
    /// When `base` is not an http or https URL.
    pub fn new(base: &str) -> Result<Self, ClientError> {
        let base = base.trim_end_matches('/').to_owned();
        let is_server = |uri: &Uri| {
            matches!(uri.scheme_str(), Some("http" | "https")) && uri.authority().is_some() && uri.query().is_none()
        };
        let Some(uri) = base.parse().ok().filter(is_server) else {
            let reason = "this is not the URL of a server, such as http://127.0.0.1:8317".to_owned();
            return Err(ClientError::Unexpected { url: base, reason });
        };
        let config = Agent::config_builder()
            .http_status_as_error(false)
            .proxy(Proxy::try_from_env().filter(|_| !is_this_machine(&uri)))
            .timeout_connect(Some(CONNECT))
            .timeout_recv_response(Some(SILENCE))
            .timeout_per_read(Some(SILENCE))
            .timeout_per_write(Some(SILENCE))
            .user_agent(concat!("ltcforge/", env!("CARGO_PKG_VERSION")))
            .build();
        Ok(Self { agent: config.into(), base })
    }

    /// Submits a recipe document.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn submit(&self, document: &[u8]) -> Result<JobDocument, ClientError> {
        let url = self.url("/v1/jobs");
        let sent = self.agent.post(&url).content_type("application/json").send(document);
        parse_job(&url, &body(&url, sent)?)
    }

    /// A job as it is now.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn job(&self, id: JobId) -> Result<JobDocument, ClientError> {
        let url = self.url(&format!("/v1/jobs/{id}"));
        parse_job(&url, &body(&url, self.agent.get(&url).call())?)
    }

    /// Cancels a job.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn cancel(&self, id: JobId) -> Result<JobDocument, ClientError> {
        let url = self.url(&format!("/v1/jobs/{id}"));
        parse_job(&url, &body(&url, self.agent.delete(&url).call())?)
    }

    /// At most `limit` jobs, newest first.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn jobs(&self, state: Option<StateName>, limit: usize) -> Result<Vec<JobDocument>, ClientError> {
        /// Most items that a service puts on a page.
        const PAGE: usize = 1000;
        let url = self.url("/v1/jobs");
        let mut jobs = Vec::new();
        let mut cursor: Option<String> = None;
        while jobs.len() < limit {
            let mut request = self.agent.get(&url).query("limit", (limit - jobs.len()).min(PAGE).to_string());
            if let Some(Ok(Value::String(name))) = state.map(serde_json::to_value) {
                request = request.query("state", name);
            }
            if let Some(cursor) = &cursor {
                request = request.query("cursor", cursor);
            }
            let page: Page =
                serde_json::from_slice(&body(&url, request.call())?).map_err(|error| unexpected(&url, &error))?;
            for item in page.items {
                jobs.push(JobDocument::parse(item).map_err(|error| unexpected(&url, &error))?);
            }
            cursor = page.next;
            if cursor.is_none() {
                break;
            }
        }
        Ok(jobs)
    }

    /// The canonical file of a table; its bytes hash to `digest`.
    ///
    /// # Errors
    /// See [`ClientError`].
    pub fn table(&self, digest: Digest) -> Result<Vec<u8>, ClientError> {
        let url = self.url(&format!("/v1/tables/{digest}"));
        let bytes = body(&url, self.agent.get(&url).call())?;
        let actual = Digest::of(&bytes);
        if actual == digest { Ok(bytes) } else { Err(ClientError::Mismatch { url, expected: digest, actual }) }
    }

    /// Follows a job to its final state and returns that. `on_update` is called on each change. A lost connection is
    /// resumed where it broke off.
    ///
    /// # Errors
    /// See [`ClientError`]; unavailable when the server cannot be reached again within 20 seconds.
    pub fn follow(&self, id: JobId, on_update: &mut dyn FnMut(&JobDocument)) -> Result<JobDocument, ClientError> {
        // Asked first, so that an unknown id or a missing server is an error at once.
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

    /// Follows a job over one connection, until it ends.
    fn follow_once(
        &self,
        id: JobId,
        seen: &mut Option<String>,
        on_update: &mut dyn FnMut(JobDocument),
    ) -> Result<(), ClientError> {
        let url = self.url(&format!("/v1/jobs/{id}/events"));
        let mut request = self.agent.get(&url).header("accept", "text/event-stream");
        if let Some(seen) = seen.as_ref() {
            request = request.header("last-event-id", seen);
        }
        let response = successful(&url, request.call())?;
        if response.status() == 204 {
            on_update(self.job(id)?);
            return Ok(());
        }
        for event in events(BufReader::new(response.into_body().into_reader())) {
            let event = event.map_err(|error| ClientError::transport(&url, &ureq::Error::from(error)))?;
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
}

/// Whether another attempt may succeed.
fn is_temporary(error: &ClientError) -> bool {
    matches!(error, ClientError::Unavailable { .. })
}

/// The response, if its status is a success.
fn successful(url: &str, sent: Result<Response<Body>, ureq::Error>) -> Result<Response<Body>, ClientError> {
    let mut response = sent.map_err(|error| ClientError::transport(url, &error))?;
    if response.status().is_success() {
        return Ok(response);
    }
    // The status is enough: the body of an error may be incomplete.
    let body = response.body_mut().read_to_vec().unwrap_or_default();
    Err(ClientError::status(url, response.status().as_u16(), &body))
}

fn body(url: &str, sent: Result<Response<Body>, ureq::Error>) -> Result<Vec<u8>, ClientError> {
    let read = successful(url, sent)?.body_mut().with_config().limit(FILE_LIMIT_BYTES).read_to_vec();
    read.map_err(|error| ClientError::transport(url, &error))
}

fn parse_job(url: &str, body: &[u8]) -> Result<JobDocument, ClientError> {
    serde_json::from_slice(body).and_then(JobDocument::parse).map_err(|error| unexpected(url, &error))
}

fn unexpected(url: &str, error: &serde_json::Error) -> ClientError {
    ClientError::Unexpected { url: url.to_owned(), reason: error.to_string() }
}

/// Whether a server is on this machine, which a proxy cannot reach.
fn is_this_machine(uri: &Uri) -> bool {
    let host = uri.host().unwrap_or_default();
    let address = host.trim_start_matches('[').trim_end_matches(']').parse();
    host.eq_ignore_ascii_case("localhost") || address.is_ok_and(|address: IpAddr| address.is_loopback())
}

#[cfg(test)]
mod tests {
    use std::{
        io::{Read as _, Write as _},
        net::TcpListener,
        thread,
    };

    use super::{super::job::tests::document, *};

    /// A server that sends each connection one of `answers`, and its URL.
    fn server(answers: Vec<String>) -> (String, thread::JoinHandle<Vec<String>>) {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let url = format!("http://{}", listener.local_addr().expect("an address"));
        let requests = thread::spawn(move || {
            answers
                .into_iter()
                .map(|answer| {
                    let (mut stream, _) = listener.accept().expect("a connection");
                    let mut request = Vec::new();
                    let mut byte = [0];
                    while !request.ends_with(b"\r\n\r\n") && stream.read(&mut byte).is_ok_and(|n| n > 0) {
                        request.push(byte[0]);
                    }
                    stream.write_all(answer.as_bytes()).expect("the client listens");
                    String::from_utf8_lossy(&request).into_owned()
                })
                .collect()
        });
        (url, requests)
    }

    fn answer(content_type: &str, body: &str) -> String {
        let length = body.len();
        format!(
            "HTTP/1.1 200 OK\r\ncontent-type: {content_type}\r\ncontent-length: {length}\r\nconnection: close\r\n\r\n{body}"
        )
    }

    #[test]
    fn bytes_of_another_digest_are_refused() {
        let file = answer("application/octet-stream", "abc");
        let (url, _requests) = server(vec![file.clone(), file]);
        let client = Client::new(&url).expect("a URL");
        assert_eq!(client.table(Digest::of(b"abc")).expect("the very bytes"), b"abc");
        let refused = client.table(Digest::of(b"other"));
        assert!(matches!(refused, Err(ClientError::Mismatch { actual, .. }) if actual == Digest::of(b"abc")));
    }

    #[test]
    fn a_broken_stream_is_resumed_where_it_broke() {
        let running = document("running");
        let (url, requests) = server(vec![
            answer("application/json", &running.to_string()),
            answer("text/event-stream", &format!("id: 7\ndata: {running}\n\nid: 8\ndata: {{")),
            answer("text/event-stream", &format!("id: 9\ndata: {}\n\n", document("cancelled"))),
        ]);
        let id = "5f70bf18a086007016e948b04aed3b82".parse().expect("an id");
        let mut updates = 0;
        let job = Client::new(&url).expect("a URL").follow(id, &mut |_| updates += 1).expect("a final state");
        assert_eq!((job.status.state, updates), (StateName::Cancelled, 3));
        let requests = requests.join().expect("three requests");
        assert!(requests[2].contains("last-event-id: 7"), "{}", requests[2]);
    }

    #[test]
    fn a_missing_server_is_unavailable_and_named() {
        let error = Client::new("http://127.0.0.1:1/").expect("a URL").submit(b"{}").expect_err("nobody listens");
        assert!(matches!(&error, ClientError::Unavailable { url, .. } if url == "http://127.0.0.1:1/v1/jobs"));
    }

    #[test]
    fn servers_on_this_machine_are_recognised() {
        for (base, expected) in [
            ("http://127.0.0.1:8317", true),
            ("http://127.9.0.1", true),
            ("http://[::1]:80", true),
            ("http://LocalHost:8317/ltc", true),
            ("http://10.0.0.1:8317", false),
            ("https://tables.example", false),
            ("http://127.0.0.1.example", false),
        ] {
            assert_eq!(is_this_machine(&base.parse().expect("a URL")), expected, "{base}");
        }
    }

    #[test]
    fn anything_but_a_url_is_refused() {
        for base in ["", "localhost:8317", "ftp://host", "http://", "http://host/?a=b"] {
            assert!(Client::new(base).is_err(), "{base}");
        }
    }
}
