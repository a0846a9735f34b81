//! The client against faulty servers.

use std::{
    io::{Read as _, Write as _},
    net::{TcpListener, TcpStream},
    thread,
    time::Duration,
};

use super::{
    Access, Client, ClientError, ServerTokens, Source, SourcesError, TABLE_BYTES, Wanted, fetch, job::tests::document,
};
use ltcforge_files::{digest::Digest, job::StateName};

/// Starts a server that reads the head of each request and passes the connection to the next of `answers`. Returns its
/// URL and the requests.
fn server_of(answers: Vec<Box<dyn FnOnce(TcpStream) + Send>>) -> (String, thread::JoinHandle<Vec<String>>) {
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
                answer(stream);
                String::from_utf8_lossy(&request).into_owned()
            })
            .collect()
    });
    (url, requests)
}

/// Starts a server that sends each connection one of `answers`. Returns its URL and the requests.
fn server(answers: Vec<String>) -> (String, thread::JoinHandle<Vec<String>>) {
    server_of(
        answers
            .into_iter()
            .map(|answer| -> Box<dyn FnOnce(TcpStream) + Send> {
                Box::new(move |mut stream| stream.write_all(answer.as_bytes()).expect("the client listens"))
            })
            .collect(),
    )
}

/// Starts a server that sends a head and then `part` again and again, until the client closes the connection.
fn endless(part: &'static [u8]) -> String {
    let answer = move |mut stream: TcpStream| {
        let head = "HTTP/1.1 200 OK\r\nconnection: close\r\n\r\n";
        let mut sent = stream.write_all(head.as_bytes());
        while sent.is_ok() {
            sent = stream.write_all(part);
        }
    };
    server_of(vec![Box::new(answer)]).0
}

fn answer(content_type: &str, body: &str) -> String {
    let length = body.len();
    format!(
        "HTTP/1.1 200 OK\r\ncontent-type: {content_type}\r\ncontent-length: {length}\r\nconnection: close\r\n\r\n{body}"
    )
}

/// Fetches the table with the digest of `expected`, with a limit of `table_bytes`.
fn table_within(
    table_bytes: u64,
    (url, tokens): (&str, &ServerTokens),
    expected: &[u8],
    stated_bytes: Option<u64>,
) -> Result<Vec<u8>, ClientError> {
    let access = Access { table_bytes, offline: false, tokens, should_stop: &|| false };
    let wanted = Wanted::table(Digest::of(expected), stated_bytes);
    fetch(&[Source::server(url).expect("a URL")], &wanted, &access).map_err(|error| match error {
        SourcesError::NoneHasIt(errors) => errors.into_iter().next().expect("an error"),
        error => panic!("{error}"),
    })
}

fn table(url: &str, expected: &[u8], stated_bytes: Option<u64>) -> Result<Vec<u8>, ClientError> {
    table_within(TABLE_BYTES, (url, &ServerTokens::NONE), expected, stated_bytes)
}

fn client(url: &str) -> Client {
    Client::new(url, &ServerTokens::NONE).expect("a URL")
}

#[test]
fn bytes_of_another_digest_are_refused() {
    let file = answer("application/octet-stream", "abc");
    let (url, _requests) = server(vec![file.clone(), file]);
    assert_eq!(table(&url, b"abc", None).expect("the very bytes"), b"abc");
    let refused = table(&url, b"other", None).expect_err("other bytes");
    assert!(matches!(refused, ClientError::Mismatch { actual, .. } if actual == Digest::of(b"abc")));
}

#[test]
fn gzip_is_undone_within_the_limit_of_its_contents() {
    let gzipped = |bytes: &[u8]| {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        encoder.write_all(bytes).expect("memory");
        let packed = encoder.finish().expect("memory");
        let head = "HTTP/1.1 200 OK\r\ncontent-encoding: gzip\r\nconnection: close\r\n\r\n";
        let file = [head.as_bytes(), &packed].concat();
        let send = move |mut stream: TcpStream| drop(stream.write_all(&file));
        server_of(vec![Box::new(send)]).0
    };
    assert_eq!(table(&gzipped(b"abc"), b"abc", Some(3)).expect("the very bytes"), b"abc");
    let zeros = vec![0; 1 << 24];
    let refused = table(&gzipped(&zeros), &zeros, Some(1000)).expect_err("it is longer");
    assert!(matches!(refused, ClientError::LongerThanStated { stated_bytes: 1000, .. }), "{refused:?}");
    let refused = client(&gzipped(&zeros)).jobs(None, 10).expect_err("a long list");
    assert!(refused.to_string().contains("longer than 4194304 bytes"), "{refused}");
}

#[test]
fn a_job_is_followed_while_the_server_is_briefly_unavailable() {
    let of = |state: &str| answer("application/json", &document(state).to_string());
    let away = "HTTP/1.1 503 x\r\ncontent-length: 0\r\nconnection: close\r\n\r\n".to_owned();
    let (url, requests) = server(vec![of("running"), of("running"), away, of("cancelled")]);
    let id = "5f70bf18a086007016e948b04aed3b82".parse().expect("an id");
    let mut updates = 0;
    let job = client(&url).follow(id, &mut |_| updates += 1).expect("a final state");
    assert_eq!((job.status.state, updates), (StateName::Cancelled, 2));
    requests.join().expect("four requests");
}

#[test]
fn a_missing_server_is_unavailable_and_named() {
    let error = client("http://127.0.0.1:1/").submit(b"{}").expect_err("nobody listens");
    assert!(matches!(&error, ClientError::Unavailable { url, .. } if url == "http://127.0.0.1:1/v1/jobs"));
}

#[test]
fn a_table_is_cut_at_the_size_that_the_lock_states_or_at_the_limit() {
    let refused = table(&endless(&[0; 4096]), b"", Some(100_000)).expect_err("an endless table");
    assert!(refused.to_string().contains("longer than 100000 bytes, the size that the lock file states"), "{refused}");
    let refused = table_within(65_536, (&endless(&[0; 4096]), &ServerTokens::NONE), b"", None).expect_err("endless");
    assert!(refused.to_string().contains("65536 bytes, the limit for tables"), "{refused}");
}

#[test]
fn a_document_is_cut_at_its_limit() {
    let refused = client(&endless(b"[[[[")).jobs(None, 10).expect_err("an endless list");
    assert!(matches!(refused, ClientError::Unexpected { .. }), "{refused}");
    assert!(refused.to_string().contains("longer than 4194304 bytes"), "{refused}");
}

#[test]
fn an_endless_list_is_abandoned() {
    let page = answer("application/json", r#"{"items":[],"next":"again"}"#);
    let (url, requests) = server(vec![page]);
    assert_eq!(client(&url).jobs(None, 10).expect("an empty list"), []);
    assert_eq!(requests.join().expect("one request").len(), 1);

    let job = document("done");
    let page = answer("application/json", &serde_json::json!({ "items": vec![job; 9], "next": "more" }).to_string());
    assert_eq!(client(&server(vec![page]).0).jobs(None, 3).expect("a list").len(), 3, "no more than requested");
}

#[test]
fn an_incomplete_answer_is_abandoned() {
    let half: Box<dyn FnOnce(TcpStream) + Send> = Box::new(|mut stream| {
        let half = stream.write_all(b"HTTP/1.1 200 OK\r\ncontent-length: 10\r\n\r\nabc");
        half.expect("the client listens");
        // Wait until the client closes the connection.
        let _ = stream.read(&mut [0]);
    });
    let url = server_of(vec![half]).0;
    let stalled = Client::with(&url, &ServerTokens::NONE, Duration::from_millis(50), |_| None).expect("a URL");
    let refused = stalled.jobs(None, 1).expect_err("half an answer");
    assert!(matches!(&refused, ClientError::Unavailable { .. }), "{refused}");
}

fn busy(status: &str, retry_after: &str) -> String {
    format!("HTTP/1.1 {status}\r\nretry-after: {retry_after}\r\ncontent-length: 0\r\nconnection: close\r\n\r\n")
}

/// A successful body and a call.
type Call<'a> = (&'a str, &'a dyn Fn(&str) -> Result<(), ClientError>);

/// Every call asks a busy server again, at most four times.
#[test]
fn a_busy_server_is_asked_again() {
    let id = "5f70bf18a086007016e948b04aed3b82".parse().expect("an id");
    let job = document("done").to_string();
    let page = serde_json::json!({ "items": [document("done")], "next": null }).to_string();
    let calls: [Call<'_>; 6] = [
        ("table", &|url| table(url, b"table", None).map(drop)),
        (&job, &|url| client(url).submit(b"{}").map(drop)),
        ("{}", &|url| client(url).store_brdf(b"brdf")),
        (&job, &|url| client(url).job(id).map(drop)),
        (&job, &|url| client(url).cancel(id).map(drop)),
        (&page, &|url| client(url).jobs(None, 1).map(drop)),
    ];
    for (body, call) in calls {
        let whole = answer("application/json", body);
        let (url, requests) = server(vec![busy("503 x", "0"), busy("429 x", " 0"), whole]);
        call(&url).unwrap_or_else(|error| panic!("{body}: {error}"));
        let requests = requests.join().expect("three requests");
        assert!(requests.iter().all(|request| *request == requests[0]), "{requests:?}");
    }
    let (url, requests) = server(vec![busy("503 x", "0"); 5]);
    assert!(matches!(client(&url).job(id), Err(ClientError::Unavailable { .. })));
    requests.join().expect("five requests");
}

/// A server that is away for long, states no seconds, or refuses for another reason is asked once.
#[test]
fn a_server_that_is_away_for_long_is_asked_once() {
    for (status, retry_after) in [
        ("503 x", "31"),
        ("503 x", "18446744073709551616"),
        ("503 x", "-1"),
        ("503 x", "Wed, 21 Oct 2026 07:28:00 GMT"),
        ("404 x", "0"),
        ("500 x", "0"),
    ] {
        let (url, requests) = server(vec![busy(status, retry_after)]);
        table(&url, b"table", None).expect_err(retry_after);
        requests.join().expect("one request");
    }
}

#[test]
fn a_download_that_waits_for_a_busy_server_can_be_stopped() {
    let (url, requests) = server(vec![busy("503 x", "30")]);
    let access =
        Access { table_bytes: TABLE_BYTES, offline: false, tokens: &ServerTokens::NONE, should_stop: &|| true };
    let stopped = fetch(&[Source::server(&url).expect("a URL")], &Wanted::table(Digest::of(b""), None), &access);
    assert!(matches!(stopped, Err(SourcesError::Stopped)));
    requests.join().expect("one request");
}

#[test]
fn a_proxy_that_does_not_connect_is_named() {
    let job = "5f70bf18a086007016e948b04aed3b82".parse().expect("an id");
    let refuses = "HTTP/1.1 403 Forbidden\r\ncontent-length: 0\r\nconnection: close\r\n\r\n".to_owned();
    let (proxy, requests) = server(vec![refuses]);
    for proxy in [proxy.replace("http://", "http://user:s3cret@"), "http://127.0.0.1:1".to_owned()] {
        let with = |_: &_| ureq::Proxy::new(&proxy).ok();
        let client = Client::with("https://mirror.example", &ServerTokens::NONE, Duration::from_secs(9), with);
        let refused = client.expect("a URL").job(job).expect_err("no connection");
        assert!(matches!(refused, ClientError::Proxy { .. }), "{refused:?}");
        let host = proxy.rsplit(['@', '/']).next().expect("a host");
        assert!(refused.to_string().contains(&format!("the proxy {host} does not connect: ")), "{refused}");
        assert!(!refused.to_string().contains("s3cret"), "{refused}");
    }
    assert!(requests.join().expect("a request")[0].starts_with("CONNECT mirror.example:443 "));
}

#[test]
fn a_download_that_is_stopped_ends() {
    let access =
        Access { table_bytes: TABLE_BYTES, offline: false, tokens: &ServerTokens::NONE, should_stop: &|| true };
    let source = Source::server(&endless(b"x")).expect("a URL");
    let stopped = fetch(&[source], &Wanted::table(Digest::of(b""), None), &access);
    assert!(matches!(stopped, Err(SourcesError::Stopped)));
}

/// A server that redirects the client gets the token. The target of the redirect does not.
#[test]
fn a_token_is_sent_only_to_its_own_server() {
    let bytes = b"table";
    let of = |tokens: &str, url: &str| {
        table_within(TABLE_BYTES, (url, &tokens.parse().expect("tokens")), bytes, None).expect("the table")
    };
    let whole = answer("application/octet-stream", "table");
    let (elsewhere, sent_on) = server(vec![whole.clone()]);
    let moved = format!("HTTP/1.1 307 x\r\nlocation: {elsewhere}/b\r\ncontent-length: 0\r\nconnection: close\r\n\r\n");
    let (own, requests) = server(vec![moved]);
    assert_eq!(of(&format!("{own} s3cret"), &own), bytes);
    let request = requests.join().expect("requests").concat().to_lowercase();
    assert!(request.contains("authorization: bearer s3cret"), "{request}");
    let request = sent_on.join().expect("requests").concat().to_lowercase();
    assert!(request.starts_with("get /b") && !request.contains("s3cret"), "{request}");
    let (other, requests) = server(vec![whole]);
    assert_eq!(of(&format!("{own} s3cret"), &other), bytes);
    let request = requests.join().expect("requests").concat().to_lowercase();
    assert!(!request.contains("authorization"), "{request}");
}
