//! Connections under tiny limits.

use std::{convert::Infallible, time::Duration};

use axum::{
    body::{Body, Bytes},
    routing::get,
};
use futures_util::stream;
use tokio::task::JoinHandle;

use super::*;

/// How long a condition may take to come true. It only ends a test that hangs.
const DEADLINE: Duration = Duration::from_secs(60);

/// A time limit that a test waits for.
const SHORT: Duration = Duration::from_millis(100);

/// Limits that no test runs into by accident.
fn generous() -> ConnectionLimits {
    ConnectionLimits { client: DEADLINE, drain: DEADLINE, ..ConnectionLimits::default() }
}

struct Served {
    address: SocketAddr,
    stop: watch::Sender<bool>,
    task: JoinHandle<()>,
}

/// A service with an answer without an end, one that comes in small parts, and one that is never ready.
async fn start(limits: ConnectionLimits) -> Served {
    let endless =
        || async { Body::from_stream(stream::repeat_with(|| Ok::<_, Infallible>(Bytes::from(vec![0; 64 * 1024])))) };
    let slow = || async {
        Body::from_stream(stream::unfold(0, async |part| {
            sleep(2 * SHORT).await;
            (part < 3).then_some((Ok::<_, Infallible>("part;"), part + 1))
        }))
    };
    let app = Router::new()
        .route("/", get(|| async { "hello" }))
        .route("/endless", get(endless))
        .route("/slow", get(slow))
        .route("/never", get(std::future::pending::<()>));
    let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
    let address = listener.local_addr().expect("an address");
    let (stop, stopping) = watch::channel(false);
    Served { address, stop, task: tokio::spawn(serve(listener, app, None, Arc::new(limits), stopping)) }
}

/// A connection on which `text` was sent.
async fn send(served: &Served, text: &str) -> TcpStream {
    let mut tcp = TcpStream::connect(served.address).await.expect("a connection");
    tcp.write_all(text.as_bytes()).await.expect("a listener");
    tcp
}

/// The bytes that the service still sends until it closes the connection.
async fn rest(mut tcp: TcpStream) -> String {
    let mut bytes = Vec::new();
    let read = timeout(DEADLINE, tcp.read_to_end(&mut bytes)).await.expect("the end of the connection");
    read.expect("an orderly end");
    String::from_utf8(bytes).expect("an answer in UTF-8")
}

const CLOSE: &str = "GET / HTTP/1.1\r\nhost: h\r\nconnection: close\r\n\r\n";

/// Waits until a request is answered with `hello`.
async fn until_served(served: &Served) {
    let asked = async { while !rest(send(served, CLOSE).await).await.ends_with("hello") {} };
    timeout(DEADLINE, asked).await.expect("room for a connection");
}

#[tokio::test]
async fn a_slow_head_is_told_so_and_an_idle_connection_is_closed() {
    let served = start(ConnectionLimits { client: SHORT, ..generous() }).await;
    let slow = rest(send(&served, "GET / HTTP/1.1\r\nhost:").await).await;
    assert!(slow.starts_with("HTTP/1.1 408 ") && slow.contains("/problems/slow-request"), "{slow}");
    assert!(slow.contains("within 0.1 s; --client-seconds raises the limit"), "{slow}");
    assert_eq!(rest(send(&served, "").await).await, "", "a connection without a request");
    let kept = rest(send(&served, "GET / HTTP/1.1\r\nhost: h\r\n\r\n").await).await;
    assert!(kept.starts_with("HTTP/1.1 200 ") && kept.ends_with("hello"), "then it was closed: {kept}");
}

#[tokio::test]
async fn a_client_that_does_not_read_is_given_up() {
    let served = start(ConnectionLimits { connections: 1, per_address: 1, client: SHORT, ..generous() }).await;
    let unread = send(&served, "GET /endless HTTP/1.1\r\nhost: h\r\n\r\n").await;
    until_served(&served).await;
    drop(unread);
}

#[tokio::test]
async fn an_answer_in_parts_lives_longer_than_every_limit() {
    let served = start(ConnectionLimits { client: SHORT, ..generous() }).await;
    let whole = rest(send(&served, "GET /slow HTTP/1.0\r\n\r\n").await).await;
    assert!(whole.ends_with("part;part;part;"), "{whole}");
}

#[tokio::test]
async fn a_connection_beyond_a_limit_is_told_which() {
    let one = ConnectionLimits { connections: 1, per_address: 1, ..generous() };
    let of_one_address = ConnectionLimits { connections: 2, per_address: 1, ..generous() };
    for (limits, named) in [(one, "--connections raises"), (of_one_address, "--connections-per-address raises")] {
        let served = start(limits).await;
        let mut first = send(&served, "GET / HTTP/1.1\r\nhost: h\r\n\r\n").await;
        let mut byte = [0];
        first.read_exact(&mut byte).await.expect("an answer");
        let refused = rest(send(&served, CLOSE).await).await;
        assert!(refused.starts_with("HTTP/1.1 503 ") && refused.contains("retry-after: "), "{refused}");
        assert!(refused.contains("/problems/too-many-connections") && refused.contains(named), "{refused}");
        drop(first);
        until_served(&served).await;
    }
}

#[tokio::test]
async fn a_head_that_cannot_be_read_gets_a_problem() {
    let served = start(generous()).await;
    let long = "x".repeat(70_000);
    let cases = [
        ("nonsense\r\n\r\n".to_owned(), 400, "bad-request"),
        ("GET / HTTP/1.1\r\nhost h\r\n\r\n".to_owned(), 400, "bad-request"),
        ("GET / HTTP/3.7\r\n\r\n".to_owned(), 400, "bad-request"),
        // The preface of HTTP/2 and an empty frame of settings.
        ("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\x04\0\0\0\0\0".to_owned(), 400, "bad-request"),
        (format!("GET /{long} HTTP/1.1\r\nhost: h\r\n\r\n"), 414, "uri-too-long"),
        (format!("GET / HTTP/1.1\r\nhost: h\r\nx: {long}\r\ny: {long}\r\n\r\n"), 431, "head-too-large"),
        (format!("GET / HTTP/1.1\r\nhost: h\r\n{}\r\n", "x: y\r\n".repeat(101)), 431, "head-too-large"),
    ];
    for (head, status, kind) in cases {
        let shown = &head[..head.len().min(60)];
        let answer = rest(send(&served, &head).await).await;
        assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")), "{shown}: {answer}");
        let (_, body) = answer.split_once("\r\n\r\n").expect("a head");
        let problem: serde_json::Value = serde_json::from_str(body).expect("a document");
        assert_eq!(problem["type"], format!("/problems/{kind}"), "{shown}");
        assert!(answer.contains("content-type: application/problem+json\r\n"), "{answer}");
    }
}

/// hyper tells of the first kind that the head is too large, and of the others nothing.
#[tokio::test]
async fn a_content_length_that_fits_in_no_number_is_named() {
    let served = start(generous()).await;
    let digits = "9".repeat(40);
    let cases = [
        (vec!["18446744073709551614"], "413", "Content-Length is 18446744073709551614, and"),
        (vec!["18446744073709551615"], "413", "Content-Length is 18446744073709551615, and"),
        (vec!["18446744073709551616"], "413", "Content-Length is 18446744073709551616, and"),
        (vec![digits.as_str()], "413", &digits),
        (vec!["-1"], "400", "Content-Length is «-1»"),
        (vec!["+1"], "400", "Content-Length is «+1»"),
        (vec![""], "400", "Content-Length is «»"),
        (vec!["5", "6"], "400", "Content-Length is both 5 and 6"),
    ];
    for (lengths, status, named) in cases {
        let fields = lengths.iter().map(|length| format!("CONTENT-length:{length} \r\n")).collect::<Vec<_>>().concat();
        let body_of = "\r\ncontent-length: x";
        let head = format!("POST / HTTP/1.1\r\nhost: h\r\n{fields}{body_of}");
        let answer = rest(send(&served, &head).await).await;
        assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")) && answer.contains(named), "{lengths:?}: {answer}");
    }
    // Beyond the signed numbers, but a number: the route is asked.
    let length = "9223372036854775808";
    let asked = rest(
        send(&served, &format!("GET / HTTP/1.1\r\nhost: h\r\nconnection: close\r\ncontent-length: {length}\r\n\r\n"))
            .await,
    );
    assert!(asked.await.starts_with("HTTP/1.1 200 "));
}

#[tokio::test]
async fn a_stop_ends_idle_connections_and_waits_for_open_answers() {
    let served = start(generous()).await;
    let mut slow = send(&served, "GET /slow HTTP/1.1\r\nhost: h\r\n\r\n").await;
    let mut idle = send(&served, "GET / HTTP/1.1\r\nhost: h\r\n\r\n").await;
    let mut byte = [0];
    idle.read_exact(&mut byte).await.expect("an answer");
    slow.read_exact(&mut byte).await.expect("the beginning of an answer");
    served.stop.send_replace(true);
    assert!(rest(idle).await.ends_with("hello"));
    assert!(rest(slow).await.ends_with("\r\n0\r\n\r\n"), "the last chunk");
    timeout(DEADLINE, served.task).await.expect("the end of the service").expect("no panic");
    assert!(TcpStream::connect(served.address).await.is_err(), "nothing is accepted any more");
}

#[tokio::test]
async fn a_stop_does_not_wait_for_ever() {
    let served = start(ConnectionLimits { drain: SHORT, ..generous() }).await;
    let never = send(&served, "GET /never HTTP/1.1\r\nhost: h\r\n\r\n").await;
    // An answer on a later connection shows that the first one was accepted.
    until_served(&served).await;
    served.stop.send_replace(true);
    timeout(DEADLINE, served.task).await.expect("the end of the service").expect("no panic");
    assert_eq!(rest(never).await, "");
}
