//! Pages from other sites, unknown host names, slow requests, and too many requests.

use std::{
    fmt::Write as _,
    io::{Read as _, Write as _},
    net::{Shutdown, TcpStream},
};

use crate::common::{
    SMALL, eventually,
    openapi::{DOCUMENT, faults},
    server::{Server, text},
};
use serde_json::Value;

/// A connection on which `request` was sent.
pub(super) fn send(server: &Server, request: &str) -> TcpStream {
    let address = server.url.strip_prefix("http://").expect("an http URL");
    let mut tcp = TcpStream::connect(address).expect("a connection");
    tcp.set_read_timeout(Some(crate::common::DEADLINE)).expect("a time limit");
    // The service may have closed the connection already.
    let _ = tcp.write_all(request.as_bytes());
    tcp
}

/// Status, head and body of the response. The service must close the connection.
#[track_caller]
pub(super) fn answer(tcp: TcpStream) -> (u16, String, String) {
    try_answer(tcp).expect("an answer")
}

/// Like [`answer`], but `None` if the connection is closed without a response.
pub(super) fn try_answer(mut tcp: TcpStream) -> Option<(u16, String, String)> {
    let mut all = String::new();
    tcp.read_to_string(&mut all).ok()?;
    let (head, body) = all.split_once("\r\n\r\n")?;
    let status = head.split(' ').nth(1)?.parse().ok()?;
    Some((status, head.to_owned(), body.to_owned()))
}

/// The problem document in the response to `request`. `openapi.yaml` must contain it.
#[track_caller]
fn problem(server: &Server, request: &str, status: u16, kind: &str) -> Value {
    let (answered, head, body) = answer(send(server, request));
    assert_eq!(answered, status, "{request}: {head}");
    assert!(head.contains("content-type: application/problem+json"), "{head}");
    let problem: Value = serde_json::from_str(&body).expect("a document");
    assert_eq!(faults(&DOCUMENT["components"]["schemas"]["Problem"], &problem), [""; 0], "{problem:#}");
    assert_eq!(problem["type"], format!("/problems/{kind}"), "{problem:#}");
    assert!(DOCUMENT["x-any-path"][status.to_string()].is_object(), "{status} is not in the file");
    problem
}

/// The head of a request with additional fields. It asks the service to close the connection.
pub(super) fn request(line: &str, fields: &[(&str, &str)]) -> String {
    let mut head = format!("{line} HTTP/1.1\r\nconnection: close\r\n");
    for (name, value) in fields {
        write!(head, "{name}: {value}\r\n").expect("a String takes all");
    }
    head + "\r\n"
}

pub(super) fn host(server: &Server) -> &str {
    server.url.strip_prefix("http://").expect("an http URL")
}

#[test]
fn another_name_is_refused_unless_it_is_allowed() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &["--allow-host", "farm,other:81"]);
    let port = host(&server).rsplit(':').next().expect("a port");
    let ask = |name: &str| request("GET /healthz", &[("host", name)]);
    for own in [host(&server), &format!("localhost:{port}"), "[::1]:1", "10.0.0.1", "farm", "FARM:1", "other:81"] {
        assert_eq!(answer(send(&server, &ask(own))).0, 200, "{own}");
    }
    for foreign in ["attacker.example", &format!("attacker.example:{port}"), "localhost.example", "other", "other:80"] {
        let refused = problem(&server, &ask(foreign), 421, "wrong-host");
        assert!(text(&refused["detail"]).contains("--allow-host"), "{refused:#}");
    }
    problem(&server, &request("GET /healthz", &[]), 400, "bad-request");
    // A page of another site cannot find out which paths exist.
    problem(&server, &request("GET /nothing", &[("host", "attacker.example")]), 421, "wrong-host");
}

#[test]
fn a_foreign_page_is_refused_unless_it_is_allowed() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &["--allow-origin", "https://wiki.example"]);
    let own = format!("http://{}", host(&server));
    let post = |origin: &str| {
        let length = SMALL.len().to_string();
        let fields = [("host", host(&server)), ("origin", origin), ("content-length", &length)];
        request("POST /v1/jobs", &fields) + SMALL
    };
    for foreign in ["http://attacker.example", "null", "http://localhost:1", "https://wiki.example.attacker.example"] {
        let refused = problem(&server, &post(foreign), 403, "foreign-origin");
        assert!(text(&refused["detail"]).contains("--allow-origin"), "{refused:#}");
    }
    let jobs = server.get("/v1/jobs").with_status(200).json();
    assert_eq!(jobs["items"], Value::Array(vec![]), "a refused request leaves no job");
    for allowed in [own.as_str(), "https://wiki.example"] {
        assert!(answer(send(&server, &post(allowed))).0 < 300, "{allowed}");
    }
}

#[test]
fn a_slow_body_gets_a_response_and_a_slow_head_is_cut() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &["--client-seconds", "1"]);
    let fields = [("host", host(&server)), ("content-length", "100")];
    let body = problem(&server, &(request("POST /v1/jobs", &fields) + "{"), 408, "slow-request");
    assert!(text(&body["detail"]).contains("the body of the request was not complete within 1 s"), "{body:#}");
    let mut silent = Vec::new();
    let begun = send(&server, "GET /healthz HTTP/1.1\r\nhost:").read_to_end(&mut silent);
    begun.expect("the end of the connection");
    assert_eq!(silent, b"");
}

#[test]
fn a_busy_service_refuses_requests_and_answers_probes() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &["--requests", "2", "--client-seconds", "600"]);
    let fields = [("host", host(&server)), ("content-length", "100")];
    let slow = request("POST /v1/jobs", &fields) + "{";
    let mut open = Vec::new();
    let busy = eventually("a busy service", || {
        // A slow request that arrives during a call of this test is refused, so each round sends another one.
        open.push(send(&server, &slow));
        Some(server.get("/v1/jobs")).filter(|answer| answer.status == 503)
    });
    assert_eq!((busy.header("retry-after"), &busy.json()["type"]), (Some("2"), &"/problems/busy".into()));
    assert!(text(&busy.json()["detail"]).contains("--requests"), "{busy:?}");
    server.get("/healthz").with_status(200);
    drop(open);
    eventually("room for a request", || (server.get("/v1/jobs").status == 200).then_some(()));
}

#[test]
fn a_body_with_a_large_content_length_is_rejected_before_it_is_sent() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let post = |length: &str| {
        let fields = [("host", host(&server)), ("expect", "100-continue"), ("content-length", length)];
        request("POST /v1/jobs", &fields)
    };
    let (status, head, body) = answer(send(&server, &post("65537")));
    assert_eq!(status, 413, "{head}");
    assert!(body.contains("/problems/body-too-large"), "{body}");
    let mut tcp = send(&server, &post("2"));
    let mut go_on = [0; 25];
    tcp.read_exact(&mut go_on).expect("an interim answer");
    assert_eq!(&go_on, b"HTTP/1.1 100 Continue\r\n\r\n");
    tcp.shutdown(Shutdown::Both).expect("an open connection");
}

#[test]
fn the_log_does_not_repeat_requests() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    for path in ["/healthz", "/v1/jobs", "/v1/jobs/xyz", "/nothing"] {
        server.get(path);
    }
    let run = server.stop("TERM").exited(0);
    assert!(!run.stderr.contains("request") && !run.stderr.contains("/healthz"), "{}", run.stderr);
}
