//! Access: host names and origins, tokens and their scopes, and logs without secrets.

use std::{
    fs,
    io::{BufRead as _, BufReader},
    thread,
    time::Duration,
};

use rustix::fs::{CWD, FileType, Mode, mknodat};
use serde_json::Value;

use super::clients::{host, send};
use crate::common::{
    ENDLESS, SMALL,
    command::{ltcforge, run},
    eventually,
    server::{Answer, Server, text},
};

/// A new token: the secret, and the line for the service.
fn token(name: &str, scope: &str) -> (String, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let made = run(folder.path(), ["token", "new", name, "--scope", scope, "--json"]).exited(0);
    let made: Value = serde_json::from_str(&made.stdout).expect("JSON");
    (text(&made["token"]).to_owned(), text(&made["kept"]).to_owned())
}

fn call(server: &Server, method: &str, path: &str, secret: &str, body: Option<&[u8]>) -> Answer {
    let bearer = format!("Bearer {secret}");
    server.request(method, path, &[("authorization", &bearer), ("content-type", "application/json")], body)
}

#[test]
fn the_log_names_requests_and_shows_no_secret() {
    let folder = tempfile::tempdir().expect("a folder");
    let (farm, kept) = token("farm", "read");
    let server = Server::start_in(
        &folder.path().join("data"),
        &["--token-list", &kept],
        &[("LTCFORGE_LOG", "debug"), ("LTCFORGE_LOG_FORMAT", "json")].map(|(a, b)| (a.to_owned(), b.to_owned())),
    );
    let named = server.request("GET", "/healthz", &[("x-request-id", "from-proxy.7")], None);
    assert_eq!(named.header("x-request-id"), Some("from-proxy.7"));
    // The log must not contain a token that a client put into the URL by mistake.
    server.get(&format!("/healthz?token={farm}")).with_status(400);
    let other = server.request("GET", "/healthz", &[("x-request-id", "no name")], None);
    assert!(other.header("x-request-id").is_some_and(|name| name != "no name"), "{other:?}");
    let log = server.kill_and_read();
    let lines: Vec<Value> = log.lines().map(|line| serde_json::from_str(line).expect("a document a line")).collect();
    let of_request = lines.iter().filter(|line| line["span"]["id"] == "from-proxy.7");
    assert!(of_request.count() > 0, "{log}");
    assert!(log.contains("/healthz?token=ltcforge_[...]"), "{log}");
    assert!(!log.contains(&farm), "a secret is in the log");
}

/// If a FIFO replaces the token file, requests still work, and the next change is still noticed. The streams of a
/// revoked token end.
#[test]
fn an_event_stream_ends_with_its_token() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("tokens");
    let ((farm, farm_kept), (_, other_kept)) = (token("farm", "submit"), token("other", "read"));
    fs::write(&file, format!("{farm_kept}\n")).expect("a file");
    let server = Server::start(&folder.path().join("data"), &["--tokens", file.to_str().expect("UTF-8")]);
    let job = call(&server, "POST", "/v1/jobs", &farm, Some(ENDLESS.as_bytes())).with_status(202).json();
    let head = format!(
        "GET /v1/jobs/{}/events HTTP/1.1\r\nhost: {}\r\nauthorization: Bearer {farm}\r\n\r\n",
        text(&job["id"]),
        host(&server)
    );
    let mut stream = BufReader::new(send(&server, &head));
    let mut line = String::new();
    stream.read_line(&mut line).expect("a status");
    assert!(line.contains(" 200 "), "{line}");
    fs::remove_file(&file).expect("a file");
    mknodat(CWD, &file, FileType::Fifo, Mode::RWXU, 0).expect("a FIFO");
    thread::sleep(Duration::from_secs(3));
    call(&server, "GET", "/v1/jobs", &farm, None).with_status(200);
    fs::remove_file(&file).expect("a FIFO");
    fs::write(&file, format!("{other_kept}\n")).expect("a file");
    // The last chunk is empty, so the stream has ended regularly.
    eventually("the end of the stream", || {
        line.clear();
        stream.read_line(&mut line).expect("the stream goes on or ends");
        (line == "0\r\n").then_some(())
    });
    call(&server, "GET", "/v1/jobs", &farm, None).with_status(401);
    let log = server.stop("TERM").stderr;
    assert_eq!(log.matches("not a regular file").count(), 1, "once: {log}");
}

#[test]
fn a_public_address_is_not_opened_without_tokens() {
    let folder = tempfile::tempdir().expect("a folder");
    let refused = run(folder.path(), ["serve", "--listen", "0.0.0.0:0"]).exited(2);
    assert!(refused.complaints()[0].contains("--allow-anyone"), "{refused:?}");
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 0, "a file was made");
}

#[test]
fn tokens_allow_their_scopes_and_jobs_name_the_user() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("tokens");
    let (reader, reader_kept) = token("viewer", "read");
    let (farm, farm_kept) = token("farm", "submit");
    let (root, root_kept) = token("root", "admin");
    assert_ne!(farm, token("farm", "submit").0, "each is new");
    fs::write(&file, format!("{reader_kept}\n{farm_kept}\n")).expect("a file");
    let flags = ["--tokens", file.to_str().expect("UTF-8"), "--token-list", &root_kept];
    let server = Server::start(&folder.path().join("data"), &flags);

    let shut = server.get("/v1/jobs").with_status(401);
    assert_eq!(shut.header("www-authenticate"), Some("Bearer realm=\"ltcforge\""));
    assert_eq!(shut.json()["type"], "/problems/no-token");
    server.get("/metrics").with_status(401);
    server.get("/healthz").with_status(200);
    server.get("/readyz").with_status(200);
    server.get("/").with_status(200);
    server.get("/page/main.js").with_status(200);
    call(&server, "GET", "/v1/jobs", "ltcforge_wrong", None).with_status(401);
    let refused = call(&server, "POST", "/v1/jobs", &reader, Some(SMALL.as_bytes())).with_status(403).json();
    assert_eq!(refused["type"], "/problems/out-of-scope");
    let foreseen = call(&server, "POST", "/v1/recipes", &reader, Some(SMALL.as_bytes())).with_status(200).json();
    assert!(foreseen["problem"].is_null(), "{foreseen:#}");

    let job = call(&server, "POST", "/v1/jobs", &farm, Some(SMALL.as_bytes())).with_status(202).json();
    assert_eq!(job["submitted_by"], "farm");
    let path = format!("/v1/jobs/{}", text(&job["id"]));
    let table = eventually("the table", || {
        let job = call(&server, "GET", &path, &reader, None).with_status(200).json();
        job["table"].as_str().map(str::to_owned)
    });
    let table = call(&server, "GET", &format!("/v1/tables/{table}"), &reader, None).with_status(200);
    assert!(
        table.header("cache-control").is_some_and(|field| field.starts_with("private,")),
        "a shared cache may store it"
    );
    assert_eq!(table.header("x-content-type-options"), Some("nosniff"));
    let long = br#"{"preset":"best","resolution":{"alpha":16,"ratio":16,"theta":16,"phi":16}}"#;
    let long = call(&server, "POST", "/v1/jobs", &farm, Some(long)).with_status(202).json();
    let long = format!("/v1/jobs/{}", text(&long["id"]));
    call(&server, "DELETE", &long, &reader, None).with_status(403);
    let cancelled = call(&server, "DELETE", &long, &root, None).with_status(200).json();
    assert_eq!((&cancelled["submitted_by"], &cancelled["cancelled_by"]), (&"farm".into(), &"root".into()));
    call(&server, "DELETE", &format!("/v1/brdfs/{}", "0".repeat(64)), &farm, None).with_status(403);
    call(&server, "DELETE", &format!("/v1/brdfs/{}", "0".repeat(64)), &root, None).with_status(404);

    // The command line reads the token from the environment.
    let client = |token: &str| {
        let mut command = ltcforge(folder.path(), ["jobs", "list", "--server", &server.url]);
        command.env("LTCFORGE_TOKEN", token).output().expect("the binary runs").status.code()
    };
    assert_eq!(client(&format!("{} {reader}", server.url)), Some(0));
    assert_eq!(client(&format!("http://other.example {reader}")), Some(1), "it is for another server");

    // A token is revoked without a restart. A malformed file changes nothing.
    fs::write(&file, "nonsense").expect("a file");
    fs::write(&file, farm_kept).expect("a file");
    eventually("the file is read again", || {
        let answer = call(&server, "GET", "/v1/jobs", &reader, None);
        (answer.status == 401).then_some(())
    });
    call(&server, "GET", "/v1/jobs", &farm, None).with_status(200);
    let ended = server.stop("TERM");
    for secret in [&reader, &farm, &root] {
        assert!(!ended.stderr.contains(secret.as_str()), "{}", ended.stderr);
    }

    // After a restart, the service still knows who submitted and who cancelled a job.
    let server = Server::start(&folder.path().join("data"), &flags);
    let job = call(&server, "GET", &long, &farm, None).with_status(200).json();
    assert_eq!((&job["submitted_by"], &job["cancelled_by"]), (&"farm".into(), &"root".into()));
}

#[test]
fn only_pages_of_allowed_origins_can_read_responses() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &["--allow-origin", "https://wiki.example"]);
    let page = server.request("GET", "/v1/jobs", &[("origin", "https://wiki.example")], None).with_status(200);
    assert_eq!(page.header("access-control-allow-origin"), Some("https://wiki.example"));
    let other = server.request("GET", "/v1/jobs", &[("origin", "https://other.example")], None).with_status(403);
    assert_eq!(other.header("access-control-allow-origin"), None);
    assert_eq!(server.get("/v1/jobs").header("access-control-allow-origin"), None);
}
