//! The client against faulty servers.

use std::{
    io::{Read as _, Write as _},
    net::{TcpListener, TcpStream},
    thread,
    time::Duration,
};

use super::{Client, ClientError, DownloadError, Limits, ServerTokens, job::tests::document};
use ltcforge_files::{digest::Digest, job::StateName};

/// A server that reads the head of each request and hands the connection to the next of `answers`. Returns its URL and
/// the requests.
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

/// A server that sends each connection one of `answers`, and its URL.
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

/// A server that answers with a head and then `part` again and again, until the client has enough.
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

/// The table whose bytes should be `expected`.
fn table(client: &Client, expected: &[u8], stated_bytes: Option<u64>) -> Result<Vec<u8>, DownloadError> {
    let mut bytes = Vec::new();
    client.table(Digest::of(expected))?.write_to(stated_bytes, &|| false, &mut bytes)?;
    Ok(bytes)
}

/// A client with the usual limits, but for `change`.
fn client(url: &str, change: impl FnOnce(&mut Limits)) -> Client {
    let mut limits = Limits::USUAL;
    change(&mut limits);
    Client::with_limits(url, limits).expect("a URL")
}

#[test]
fn bytes_of_another_digest_are_refused() {
    let file = answer("application/octet-stream", "abc");
    let (url, _requests) = server(vec![file.clone(), file]);
    let client = Client::new(&url).expect("a URL");
    assert_eq!(table(&client, b"abc", None).expect("the very bytes"), b"abc");
    let refused = table(&client, b"other", None).expect_err("other bytes");
    assert!(
        matches!(refused, DownloadError::Client(ClientError::Mismatch { actual, .. }) if actual == Digest::of(b"abc"))
    );
}

/// Codings have no case, and x-gzip is another name of gzip [RFC 9110, section 8.4.1.3].
#[test]
fn gzip_is_undone_under_each_of_its_names() {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    encoder.write_all(b"abc").expect("memory");
    let packed = encoder.finish().expect("memory");
    for name in ["gzip", "x-gzip", "GZip", "X-GZIP"] {
        let length = packed.len();
        let head = format!("HTTP/1.1 200 OK\r\ncontent-encoding: {name}\r\ncontent-length: {length}\r\n\r\n");
        let file = [head.as_bytes(), &packed].concat();
        let send = move |mut stream: TcpStream| stream.write_all(&file).expect("the client listens");
        let (url, _requests) = server_of(vec![Box::new(send)]);
        assert_eq!(table(&Client::new(&url).expect("a URL"), b"abc", Some(3)).expect(name), b"abc");
    }
    // A file that unpacks to more than it may have is cut as any other.
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(&vec![0; 1 << 16]).expect("memory");
    let packed = encoder.finish().expect("memory");
    let head = "HTTP/1.1 200 OK\r\ncontent-encoding: x-gzip\r\nconnection: close\r\n\r\n";
    let file = [head.as_bytes(), &packed].concat();
    let send = move |mut stream: TcpStream| stream.write_all(&file).expect("the client listens");
    let (url, _requests) = server_of(vec![Box::new(send)]);
    let refused = table(&Client::new(&url).expect("a URL"), &vec![0; 1 << 16], Some(1000)).expect_err("it is longer");
    assert!(matches!(refused, DownloadError::Client(ClientError::TooLong { limit_bytes: 1000, .. })), "{refused:?}");
}

/// A client of a server that answers with `packed`, and what it asked.
fn zstd_server(packed: &[u8]) -> (Client, thread::JoinHandle<Vec<String>>) {
    let length = packed.len();
    let head = format!("HTTP/1.1 200 OK\r\ncontent-encoding: zstd\r\ncontent-length: {length}\r\n\r\n");
    let file = [head.as_bytes(), packed].concat();
    // A client that has enough leaves.
    let send = move |mut stream: TcpStream| drop(stream.write_all(&file));
    let (url, requests) = server_of(vec![Box::new(send)]);
    (Client::new(&url).expect("a URL"), requests)
}

#[test]
fn zstd_is_asked_for_and_undone_within_the_limit_of_what_comes_out() {
    // The compressed answer is longer than the three bytes that come out of it, and only those are held to the limit.
    let (client, requests) = zstd_server(&zstd::bulk::compress(b"abc", 3).expect("memory"));
    assert_eq!(table(&client, b"abc", Some(3)).expect("the very bytes"), b"abc");
    let requests = requests.join().expect("a request");
    assert!(requests[0].to_lowercase().contains("accept-encoding: zstd"), "{}", requests[0]);

    let bomb = zstd::bulk::compress(&vec![0; 1 << 28], 3).expect("memory");
    assert!(bomb.len() < 1 << 16, "{} bytes of 256 MiB", bomb.len());
    let refused = table(&zstd_server(&bomb).0, b"", Some(1000)).expect_err("it is longer");
    assert!(matches!(refused, DownloadError::Client(ClientError::TooLong { limit_bytes: 1000, .. })), "{refused:?}");

    let whole = zstd::bulk::compress(&[7; 1000], 3).expect("memory");
    for broken in [&whole[..whole.len() - 1], b"abc"] {
        table(&zstd_server(broken).0, &[7; 1000], Some(1000)).expect_err("no whole frame");
    }
}

#[test]
fn a_frame_that_wants_more_memory_than_a_server_may_ask_for_is_refused() {
    let pack = |window_log| {
        let mut encoder = zstd::Encoder::new(Vec::new(), 3).expect("memory");
        encoder.window_log(window_log).expect("a window");
        encoder.write_all(b"abc").expect("memory");
        encoder.finish().expect("memory")
    };
    assert_eq!(table(&zstd_server(&pack(23)).0, b"abc", None).expect("8 MiB are allowed"), b"abc");
    table(&zstd_server(&pack(24)).0, b"abc", None).expect_err("16 MiB");
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
fn a_table_is_cut_at_the_size_that_the_lock_states_or_at_the_limit() {
    let refused = table(&client(&endless(&[0; 4096]), |_| {}), b"", Some(100_000)).expect_err("an endless table");
    let DownloadError::Client(error @ ClientError::TooLong { limit_bytes: 100_000, .. }) = refused else {
        panic!("{refused}")
    };
    assert!(error.to_string().contains("that the lock file states"), "{error}");

    let limited = client(&endless(&[0; 4096]), |limits| limits.table_bytes = 65_536);
    let refused = table(&limited, b"", None).expect_err("an endless table");
    assert!(refused.to_string().contains("65536 bytes, the limit for tables"), "{refused}");

    // A head that announces too much is enough.
    let announced = "HTTP/1.1 200 OK\r\ncontent-length: 99999999999\r\n\r\n".to_owned();
    let refused = table(&client(&server(vec![announced]).0, |_| {}), b"", None).expect_err("too long");
    assert!(refused.to_string().contains("1073741824 bytes"), "{refused}");
}

#[test]
fn a_document_is_cut_at_its_limit() {
    let limited = client(&endless(b"[[[["), |limits| limits.document_bytes = 100_000);
    let refused = limited.jobs(None, 10).expect_err("an endless list");
    assert!(matches!(refused, ClientError::TooLong { limit_bytes: 100_000, .. }), "{refused}");
}

#[test]
fn a_list_that_never_ends_is_left() {
    let page = answer("application/json", r#"{"items":[],"next":"again"}"#);
    let (url, requests) = server(vec![page]);
    assert_eq!(client(&url, |_| {}).jobs(None, 10).expect("an empty list"), []);
    assert_eq!(requests.join().expect("one request").len(), 1);

    let job = document("done");
    let page = answer("application/json", &serde_json::json!({ "items": vec![job; 9], "next": "more" }).to_string());
    assert_eq!(client(&server(vec![page]).0, |_| {}).jobs(None, 3).expect("a list").len(), 3, "no more than asked for");
}

#[test]
fn an_answer_that_is_slow_or_late_is_left() {
    // Every speed is below this one.
    let slow = client(&endless(b"x"), |limits| {
        (limits.pace_window, limits.pace_bytes_per_second) = (Duration::ZERO, u64::MAX);
    });
    let refused = table(&slow, b"", None).expect_err("too slow");
    assert!(matches!(&refused, DownloadError::Client(ClientError::Unavailable { .. })), "{refused}");
    assert!(refused.to_string().contains("bytes/s, the limit"), "{refused}");

    let late = client(&endless(b"x"), |limits| limits.document_time = Duration::from_millis(1));
    let refused = late.jobs(None, 1).expect_err("too late");
    assert!(refused.to_string().contains("longer than 0.001 s, the limit"), "{refused}");
}

#[test]
fn an_answer_that_stops_half_way_is_left() {
    let half: Box<dyn FnOnce(TcpStream) + Send> = Box::new(|mut stream| {
        let half = stream.write_all(b"HTTP/1.1 200 OK\r\ncontent-length: 10\r\n\r\nabc");
        half.expect("the client listens");
        // Until the client hangs up.
        let _ = stream.read(&mut [0]);
    });
    let stalled = client(&server_of(vec![half]).0, |limits| limits.stall = Duration::from_millis(50));
    let refused = stalled.jobs(None, 1).expect_err("half an answer");
    assert!(matches!(&refused, ClientError::Unavailable { .. }), "{refused}");
}

#[test]
fn a_download_that_is_stopped_ends() {
    let download = client(&endless(b"x"), |_| {}).table(Digest::of(b"")).expect("an answer");
    let stopped = download.write_to(None, &|| true, &mut std::io::sink());
    assert!(matches!(stopped, Err(DownloadError::Stopped)));
}

#[test]
fn an_endless_event_is_refused() {
    let running = answer("application/json", &document("running").to_string());
    let (head, line) = ("HTTP/1.1 200 OK\r\nconnection: close\r\n\r\n", format!("data: {}\n", "x".repeat(1000)));
    let first: Box<dyn FnOnce(TcpStream) + Send> =
        Box::new(move |mut stream| stream.write_all(running.as_bytes()).expect("the client listens"));
    let second: Box<dyn FnOnce(TcpStream) + Send> = Box::new(move |mut stream| {
        let mut sent = stream.write_all(head.as_bytes());
        while sent.is_ok() {
            sent = stream.write_all(line.as_bytes());
        }
    });
    let id = "5f70bf18a086007016e948b04aed3b82".parse().expect("an id");
    let refused = client(&server_of(vec![first, second]).0, |_| {}).follow(id, &mut |_| {}).expect_err("endless");
    assert!(matches!(refused, ClientError::Unexpected { .. }), "{refused}");
    assert!(refused.to_string().contains("longer than 1048576 bytes"), "{refused}");
}

/// A server that sends the client on gets the token; where it sends it, nobody does.
#[test]
fn a_token_goes_to_its_own_server_alone() {
    let bytes = b"table";
    let of = |tokens: &str, url: &str| {
        let tokens: ServerTokens = tokens.parse().expect("tokens");
        client(url, |_| {}).with_tokens(&tokens)
    };
    let whole = answer("application/octet-stream", "table");
    let (elsewhere, sent_on) = server(vec![whole.clone()]);
    let moved = format!("HTTP/1.1 307 x\r\nlocation: {elsewhere}/b\r\ncontent-length: 0\r\nconnection: close\r\n\r\n");
    let (own, requests) = server(vec![moved]);
    assert_eq!(table(&of(&format!("{own} s3cret"), &own), bytes, None).expect("the table"), bytes);
    let asked = requests.join().expect("requests").concat().to_lowercase();
    assert!(asked.contains("authorization: bearer s3cret"), "{asked}");
    let asked = sent_on.join().expect("requests").concat().to_lowercase();
    assert!(asked.starts_with("get /b") && !asked.contains("s3cret"), "{asked}");
    let (other, requests) = server(vec![whole]);
    let named = of(&format!("{own} s3cret"), &other);
    assert!(!format!("{named:?}").contains("s3cret"));
    assert_eq!(table(&named, bytes, None).expect("the table"), bytes);
    let asked = requests.join().expect("requests").concat().to_lowercase();
    assert!(!asked.contains("authorization"), "{asked}");
}
