//! Tests Debian's nginx in front of the service, with the example `deploy/nginx.conf`.

use std::{
    fs,
    io::{BufRead as _, BufReader, Read as _, Write as _},
    net::{TcpListener, TcpStream},
    process::{Child, Command},
};

use rcgen::{CertifiedKey, generate_simple_self_signed};
use ureq::{
    Agent,
    tls::{Certificate, RootCerts, TlsConfig},
};

use super::clients::host;
use crate::common::{
    DEADLINE, ENDLESS, SMALL, eventually, report_skipped,
    server::{Server, text},
};

/// The main configuration. It includes the example, and uses a single process.
const MAIN: &str = "daemon off; master_process off; pid nginx.pid; error_log stderr; events {}
    http { access_log off; client_body_temp_path body; proxy_temp_path proxy; fastcgi_temp_path fastcgi;
    uwsgi_temp_path uwsgi; scgi_temp_path scgi; include site.conf; }";

/// A process that is killed when dropped.
struct Nginx(Child);

impl Drop for Nginx {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn nginx_forwards_requests_and_events_and_disconnects_slow_clients() {
    if Command::new("nginx").arg("-v").output().is_err() {
        report_skipped("there is no nginx here");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let server = Server::start(&path("data"), &[]);
    let port = TcpListener::bind("127.0.0.1:0").and_then(|free| free.local_addr()).expect("a free port").port();
    let CertifiedKey { cert, signing_key } =
        generate_simple_self_signed(["localhost".to_owned()]).expect("a certificate");
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/deploy/nginx.conf");
    let mut site = fs::read_to_string(example).expect("the example");
    for (old, new) in [
        ("listen 443 ssl", format!("listen 127.0.0.1:{port} ssl")),
        ("/etc/ssl/ltcforge/", String::new()),
        ("http://127.0.0.1:8317", server.url.clone()),
        ("client_header_timeout 10s", "client_header_timeout 1s".to_owned()),
    ] {
        assert!(site.contains(old), "{old}");
        site = site.replace(old, &new);
    }
    let files = [("chain.pem", cert.pem()), ("key.pem", signing_key.serialize_pem()), ("site.conf", site)];
    for (name, contents) in files.into_iter().chain([("nginx.conf", MAIN.to_owned())]) {
        fs::write(path(name), contents).expect("a file");
    }
    let nginx = Command::new("nginx").arg("-p").arg(folder.path()).arg("-c").arg(path("nginx.conf")).spawn();
    let _nginx = Nginx(nginx.expect("nginx runs"));
    let address = format!("127.0.0.1:{port}");
    eventually("nginx", || TcpStream::connect(&address).ok());

    let trusted = Certificate::from_pem(cert.pem().as_bytes()).expect("a certificate");
    let tls = TlsConfig::builder().root_certs(RootCerts::new_with_certs(&[trusted])).build();
    let config = Agent::config_builder().tls_config(tls).http_status_as_error(false).proxy(None);
    let agent: Agent = config.timeout_global(Some(DEADLINE)).build().into();
    let url = |path: &str| format!("https://localhost:{port}{path}");

    // The proxy forwards requests with the client's host name.
    assert_eq!(agent.get(url("/readyz")).call().expect("an answer").status(), 200);
    let submitted = agent.post(url("/v1/jobs")).content_type("application/json").send(ENDLESS).expect("an answer");
    assert_eq!(submitted.status(), 202);
    let id = submitted.into_body().read_json::<serde_json::Value>().expect("a job")["id"].clone();
    assert_eq!(agent.get(url("/readyz")).header("host", "other.example").call().expect("an answer").status(), 421);
    let table = server.fit(SMALL);
    let bytes = agent.get(url(&format!("/v1/tables/{table}"))).call().expect("an answer");
    let bytes = bytes.into_body().read_to_vec().expect("a table");
    assert!(bytes == server.get(&format!("/v1/tables/{table}")).body);

    // The first event arrives while the job runs.
    let events = agent.get(url(&format!("/v1/jobs/{}/events", text(&id)))).call().expect("a stream");
    let mut line = String::new();
    BufReader::new(events.into_body().into_reader()).read_line(&mut line).expect("a line");
    assert_eq!(line.trim(), "event: state");

    // The proxy disconnects a client that does not send its request. The service does not see this client.
    let mut silent = TcpStream::connect(&address).expect("a connection");
    silent.set_read_timeout(Some(DEADLINE)).expect("a time limit");
    silent.write_all(b"\x16").expect("the beginning of TLS");
    let mut rest = Vec::new();
    silent.read_to_end(&mut rest).expect("the end of the connection");
    assert!(host(&server).starts_with("127.0.0.1"));
    server.get("/healthz").with_status(200);
}
