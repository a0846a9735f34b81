//! Crowds of clients that are slow, idle or do not read, against the limits that the service has on its own. Each crowd
//! is gone within its time, and meanwhile others are served.

use std::{
    io::{Read as _, Write as _},
    net::TcpStream,
    path::Path,
    process::Command,
    time::{Duration, Instant},
};

use crate::common::{DEADLINE, eventually, server::Server, tell_skipped};

/// The limit of a client's silence, lower than the default so that the test ends soon, and how much longer a crowd may
/// take to be gone on a busy machine.
const CLIENT: Duration = Duration::from_secs(5);
const SLACK: Duration = Duration::from_secs(30);

/// Descriptors of this process that are left to other tests.
const SPARE: u64 = 200;

/// A service with its usual limits on connections.
fn start(folder: &Path) -> Server {
    Server::start(folder, &["--client-seconds", &CLIENT.as_secs().to_string()])
}

fn connect(server: &Server) -> Option<TcpStream> {
    let address = server.url.strip_prefix("http://").expect("an http URL");
    let tcp = TcpStream::connect(address).ok()?;
    tcp.set_read_timeout(Some(DEADLINE)).expect("a time limit");
    Some(tcp)
}

/// As many connections as `wanted`, on each of which `request` was sent; fewer, and it says so, if this process has no
/// descriptors for them.
fn crowd(server: &Server, wanted: usize, request: &str) -> Vec<TcpStream> {
    crowd_while(server, wanted, request, || ())
}

/// The same, with a call after every hundred of them.
fn crowd_while(server: &Server, wanted: usize, request: &str, mut meanwhile: impl FnMut()) -> Vec<TcpStream> {
    let limit = Command::new("sh").args(["-c", "ulimit -n"]).output().expect("a shell").stdout;
    let limit: u64 = String::from_utf8_lossy(&limit).trim().parse().unwrap_or(u64::MAX);
    let possible = usize::try_from(limit.saturating_sub(SPARE)).unwrap_or(usize::MAX);
    if possible < wanted {
        tell_skipped(&format!("{possible} connections instead of {wanted}: no more file descriptors"));
    }
    let mut crowd = Vec::new();
    while crowd.len() < wanted.min(possible) {
        let Some(mut tcp) = connect(server) else { continue };
        // The service may have refused and closed it already.
        let _ = tcp.write_all(request.as_bytes());
        crowd.push(tcp);
        if crowd.len().is_multiple_of(100) {
            meanwhile();
        }
    }
    crowd
}

/// A new client is served, or told that there is no room.
fn is_answered(server: &Server) -> bool {
    let ask = || {
        let mut tcp = connect(server)?;
        let host = server.url.strip_prefix("http://")?;
        write!(tcp, "GET /healthz HTTP/1.1\r\nhost: {host}\r\nconnection: close\r\n\r\n").ok()?;
        let mut answer = String::new();
        tcp.read_to_string(&mut answer).ok()?;
        answer.starts_with("HTTP/1.1 200").then_some(())
    };
    ask().is_some()
}

/// Waits until the service has closed every connection of `crowd`, and checks that this took no longer than it may.
#[track_caller]
fn gone(crowd: Vec<TcpStream>, since: Instant) {
    let mut rest = Vec::new();
    for mut tcp in crowd {
        // An error is an end too: the service may drop what it was sent.
        let _ = tcp.read_to_end(&mut rest);
        assert!(since.elapsed() < CLIENT + SLACK, "{:?}", since.elapsed());
        rest.clear();
    }
}

#[test]
fn three_hundred_slow_heads_end_while_others_are_served() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = start(folder.path());
    let since = Instant::now();
    let crowd = crowd(&server, 300, "GET /healthz HTTP/1.1\r\nhost:");
    assert!(is_answered(&server));
    gone(crowd, since);
}

#[test]
fn fifty_slow_bodies_end_while_others_are_served() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = start(folder.path());
    let host = server.url.strip_prefix("http://").expect("an http URL");
    let head = format!("POST /v1/jobs HTTP/1.1\r\nhost: {host}\r\ncontent-type: application/json\r\n");
    let since = Instant::now();
    let crowd = crowd(&server, 50, &format!("{head}content-length: 100\r\n\r\n{{"));
    assert!(is_answered(&server));
    gone(crowd, since);
}

/// More than there may be: those beyond the limit are refused, and a client that has a connection keeps it.
#[test]
fn two_thousand_idle_connections_end_and_make_room() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = start(folder.path());
    server.get("/healthz").with_status(200);
    let since = Instant::now();
    // On the connection that it keeps. It must not be idle itself for as long as the crowd takes to come.
    let crowd = crowd_while(&server, 2000, "", || {
        server.get("/healthz").with_status(200);
    });
    gone(crowd, since);
    eventually("room for a connection", || is_answered(&server).then_some(()));
}

/// Its answers to one connection are more than what the system keeps of them for a client that does not read.
const TABLE: &str = r#"{"preset":"draft","resolution":{"alpha":8,"ratio":8,"theta":8,"phi":4},
    "fit":{"samples":64,"directions":4,"steps":5}}"#;
const ANSWERS: usize = 200;

#[test]
fn a_hundred_downloads_that_nobody_reads_end_while_others_are_served() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = start(folder.path());
    let digest = server.fit(TABLE);
    let path = format!("/v1/tables/{digest}");
    let bytes = server.get(&path).with_status(200).body.len() * ANSWERS;
    assert!(bytes > 16 << 20, "{bytes} bytes may fit into buffers");
    let host = server.url.strip_prefix("http://").expect("an http URL");
    let before = server.descriptors();
    let since = Instant::now();
    let crowd = crowd(&server, 100, &format!("GET {path} HTTP/1.1\r\nhost: {host}\r\n\r\n").repeat(ANSWERS));
    eventually("a hundred downloads", || (server.descriptors() >= before + 90).then_some(()));
    assert!(is_answered(&server));
    // Nobody reads, so only the service can end them.
    eventually("the end of all downloads", || (server.descriptors() < before + 10).then_some(()));
    assert!(since.elapsed() < CLIENT + SLACK, "{:?}", since.elapsed());
    drop(crowd);
}
