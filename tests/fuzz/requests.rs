//! Request heads and queries, sent as bytes on a connection.

use std::{
    io::{Read as _, Write as _},
    net::{Shutdown, TcpStream},
    time::Duration,
};

use super::target::Target;
use crate::common::{SMALL, server::Server};

const WORDS: [&str; 20] = [
    "\r\n",
    " ",
    ":",
    "HTTP/1.1",
    "HTTP/1.0",
    "Host: ",
    "Content-Length: ",
    "Transfer-Encoding: chunked\r\n",
    "Range: bytes=",
    "If-Match: ",
    "If-None-Match: \"x\"",
    "Origin: ",
    "Authorization: Bearer ",
    "?",
    "&",
    "=",
    "%2e%2e/",
    "%00",
    "limit=",
    "cursor=",
];

/// The longest time for a response. The service waits for the rest of a request until the connection is closed. In long
/// runs, other targets share the processor.
const MOST: Duration = Duration::from_secs(60);

#[test]
fn requests() {
    let folder = tempfile::tempdir().expect("a folder");
    let limits = ["--adapter", "cpu", "--picture-seconds", "1", "--job-seconds", "1", "--queue-limit", "2"];
    let server = Server::start(folder.path(), &limits);
    let table = server.fit(SMALL);
    let address = server.url.strip_prefix("http://").expect("a URL");
    let request = |head: &str, body: &str| {
        let length = if body.is_empty() { String::new() } else { format!("Content-Length: {}\r\n", body.len()) };
        format!(
            "{head} HTTP/1.1\r\nHost: {address}\r\nAccept: */*\r\n{length}Content-Type: application/json\r\n\r\n{body}"
        )
        .into_bytes()
    };
    let seeds = vec![
        request("GET /v1/jobs?limit=3&state=done", ""),
        request(&format!("GET /v1/tables/{table}"), ""),
        request(&format!("HEAD /v1/tables/{table}/manifest"), ""),
        request(&format!("GET /v1/tables/{table}/exports/wgpu/ltc.json"), ""),
        request("GET /v1/preview?size=64&spp=1&mode=ltc&alpha_x=0.5&light_centre=1,2,3", ""),
        request("POST /v1/jobs", SMALL),
        request("POST /v1/recipes", SMALL),
        request("POST /v1/plans?bytes=2000", r#"{"materials": [{"alpha_x": 0.2, "alpha_y": 0.2}]}"#),
        request("DELETE /v1/jobs/17ef825cea151d3d007a00aaeea2fd86", ""),
        request(&format!("GET /v1/tables/{table}/plots/error.png?ratio=0.5&phi=0.3"), ""),
    ];
    Target { name: "requests", seeds, words: &WORDS, inputs: 300 }.survive(|bytes| {
        let mut stream = TcpStream::connect(address).expect("the service accepts");
        stream.set_read_timeout(Some(MOST)).expect("a timeout");
        // The service may respond and close the connection before it has read the whole request.
        let _ = stream.write_all(bytes);
        let _ = stream.shutdown(Shutdown::Write);
        let mut answer = Vec::new();
        let read = stream.read_to_end(&mut answer);
        let timed_out = read.is_err_and(|error| error.kind() == std::io::ErrorKind::WouldBlock);
        assert!(!timed_out, "the response does not end: {}", String::from_utf8_lossy(&answer));
        let text = String::from_utf8_lossy(&answer);
        let line = text.lines().next().unwrap_or_default();
        assert!(line.is_empty() || line.starts_with("HTTP/1."), "{line}");
        assert!(!line.contains(" 500 "), "{text}");
        let reason = line.splitn(3, ' ').nth(2).unwrap_or_default();
        let problem = text.split("\"type\":").nth(1).and_then(|rest| rest.split(',').next()).unwrap_or_default();
        format!("{reason} {problem}")
    });
    server.get("/healthz").with_status(200);
    let log = server.stop("TERM").exited(0).stderr;
    assert!(!log.contains("ERROR") && !log.contains("panicked"), "{log}");
}
