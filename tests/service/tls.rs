//! Tests TLS with a certificate, and with a renewed certificate.

use std::{fs, io::Write as _, net::TcpStream, path::Path};

use rcgen::{CertificateParams, CertifiedKey, KeyPair, date_time_ymd, generate_simple_self_signed};

use crate::common::{
    command::{ltcforge, run},
    eventually,
    server::Server,
};

/// Writes a new certificate for `localhost`, and its key.
fn certify(chain: &Path, key: &Path) -> String {
    let CertifiedKey { cert, signing_key } =
        generate_simple_self_signed(["localhost".to_owned()]).expect("a certificate");
    fs::write(key, signing_key.serialize_pem()).expect("a file");
    fs::write(chain, cert.pem()).expect("a file");
    cert.pem()
}

#[test]
fn a_certificate_is_used_and_renewed_without_a_restart() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let (chain, key) = (path("chain.pem"), path("key.pem"));
    let first = certify(&chain, &key);
    fs::write(path("first.pem"), first).expect("a file");
    let flags = ["--tls-certificate", chain.to_str().expect("UTF-8"), "--tls-key", key.to_str().expect("UTF-8")];
    let server = Server::start(&path("data"), &flags);
    let port = server.url.strip_prefix("https://127.0.0.1:").expect("an address by TLS");

    // The client trusts only this certificate.
    let trusts = |root: &str| {
        let url = format!("https://localhost:{port}");
        let mut client = ltcforge(folder.path(), ["jobs", "list", "--server", &url]);
        let run = client.env("SSL_CERT_FILE", path(root)).output().expect("the binary runs");
        println!("{root}: {}", String::from_utf8_lossy(&run.stderr));
        run.status.success()
    };
    assert!(trusts("first.pem"));
    let mut bare = TcpStream::connect(format!("127.0.0.1:{port}")).expect("a connection");
    bare.write_all(b"GET /healthz HTTP/1.1\r\nhost: localhost\r\n\r\n").expect("a listener");
    let mut answer = Vec::new();
    // The service may have reset the connection.
    let _ = std::io::Read::read_to_end(&mut bare, &mut answer);
    assert!(!answer.starts_with(b"HTTP"), "bare HTTP is not answered");

    // The new key does not match the old certificate. The service uses the old pair until the new certificate is there
    // as well.
    let second = certify(&path("second.pem"), &path("second_key.pem"));
    fs::copy(path("second.pem"), &chain).expect("a file");
    assert!(trusts("first.pem"));
    fs::copy(path("second_key.pem"), &key).expect("a file");
    assert!(second.starts_with("-----BEGIN CERTIFICATE-----"));
    eventually("the second certificate", || trusts("second.pem").then_some(()));
    assert!(!trusts("first.pem"));

    // An expired certificate is used, because the clock may be wrong, but the log reports it.
    let mut expired = CertificateParams::new(["localhost".to_owned()]).expect("a name");
    expired.not_after = date_time_ymd(2020, 1, 1);
    let pair = KeyPair::from_pem(&fs::read_to_string(&key).expect("a key")).expect("a key");
    fs::write(&chain, expired.self_signed(&pair).expect("a certificate").pem()).expect("a file");
    eventually("the expired certificate", || (!trusts("second.pem")).then_some(()));
    let log = server.stop("TERM").stderr;
    let warned = log.matches("chain.pem: a certificate expired at 2020-01-01T00:00:00Z").count();
    assert_eq!(warned, 1, "{log}");
    fs::copy(path("second.pem"), &chain).expect("a file");

    for (certificate, key, message) in [
        ("chain.pem", "none.pem", "none.pem"),
        ("key.pem", "key.pem", "no PEM certificate"),
        ("first.pem", "key.pem", "certificate first.pem and key key.pem"),
    ] {
        let refused = run(folder.path(), ["serve", "--tls-certificate", certificate, "--tls-key", key]).exited(2);
        assert!(refused.stderr.contains(message), "{refused:?}");
    }
    let refused = run(folder.path(), ["serve", "--tls-key", "key.pem"]).exited(2);
    assert!(refused.stderr.contains("--tls-key needs --tls-certificate"), "{refused:?}");
}
