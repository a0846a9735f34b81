//! Tabulated BRDFs over HTTP: uploading, naming and keeping them.

use std::{
    fs,
    io::{Read as _, Write as _},
    net::TcpStream,
    path::Path,
    thread,
    time::Duration,
};

use ltcforge::Digest;

use crate::common::{
    command::run,
    server::{Server, text},
};

pub(crate) const OCTETS: (&str, &str) = ("content-type", "application/octet-stream");

/// A small recipe for a file, with one row of views.
fn recipe(name: &str) -> String {
    format!(
        r#"{{"brdf": "tabulated", "tabulated": "{name}", "resolution": {{"alpha": 2, "theta": 3}},
            "fit": {{"samples": 64, "directions": 4, "steps": 5}}}}"#
    )
}

#[test]
fn an_uploaded_file_is_fitted_and_survives_a_kill() {
    let folder = tempfile::tempdir().expect("a folder");
    let (here, data) = (folder.path(), folder.path().join("data"));
    let made = run(here, ["tabulate", "oren_nayar", "--alpha", "0.2,1", "-o", "eon.safetensors"]).exited(0);
    let digest = made.last_line().to_owned();
    let bytes = fs::read(here.join("eon.safetensors")).expect("the file");
    let server = Server::start(&data, &[]);

    let early = server.submit(&recipe(&digest)).with_status(422).json();
    assert!(text(&early["errors"][0]["detail"]).contains("send its file to /v1/brdfs first"), "{early:#}");
    let path = server.submit(&recipe("eon.safetensors")).with_status(422).json();
    assert!(text(&path["errors"][0]["detail"]).contains("is not a digest: send the file to /v1/brdfs"), "{path:#}");

    let sent = server.request("POST", "/v1/brdfs", &[OCTETS], Some(&bytes)).with_status(201);
    assert_eq!(sent.header("location"), Some(format!("/v1/brdfs/{digest}").as_str()));
    let stored = sent.json();
    assert_eq!((text(&stored["digest"]), &stored["shape"]), (&*digest, &serde_json::json!([2, 36, 48, 32])));
    server.request("POST", "/v1/brdfs", &[OCTETS], Some(&bytes)).with_status(200);
    assert_eq!(server.get(&format!("/v1/brdfs/{digest}")).with_status(200).body, bytes);

    let azimuths =
        ["tabulate", "ggx", "--alpha", "0.5", "--ratio", "0.5", "--theta", "16", "--phi", "9", "-o", "a.safetensors"];
    run(here, azimuths).exited(0);
    let anisotropic = fs::read(here.join("a.safetensors")).expect("the file");
    let stored = server.request("POST", "/v1/brdfs", &[OCTETS], Some(&anisotropic)).with_status(201).json();
    assert_eq!(stored["shape"], serde_json::json!([1, 1, 12, 9, 16, 17]), "{stored:#}");
    assert!(stored["asymmetry"]["phi_o"].is_number() && stored["asymmetry"]["ratio"] == 0.5, "{stored:#}");

    let table = server.fit(&recipe(&digest));
    let manifest = server.get(&format!("/v1/tables/{table}/manifest")).with_status(200).json();
    assert_eq!(text(&manifest["tabulated"]["file"]), digest);
    assert_eq!(text(&manifest["recipe"]["tabulated"]), digest);
    // The table can be refitted on a machine that has neither file.
    let elsewhere = tempfile::tempdir().expect("a folder");
    let address = format!("{}/v1/tables/{table}", server.url);
    let output = run(elsewhere.path(), ["verify", &address, "--refit"]).exited(0);
    assert!(output.stdout.contains("and fitting its recipe gives the same bytes"), "{output:#?}");
    // A table is not a BRDF, and a BRDF is not a table.
    server.get(&format!("/v1/brdfs/{table}")).with_status(404);
    for of_table in ["", "/manifest", "/exports", "/exports/three", "/plots/matrix.png"] {
        let path = format!("/v1/tables/{digest}{of_table}");
        let output = server.get(&path).with_status(404).json();
        assert_eq!(text(&output["type"]), "/problems/unknown-table", "{path}");
    }
    server.request("HEAD", &format!("/v1/tables/{digest}"), &[], None).with_status(404);
    server.get(&format!("/v1/preview?table={digest}")).with_status(404);
    let picture = format!("/v1/preview?table={table}&mode=strip&size=64&spp=16&alpha_x=0.5&alpha_y=0.5");
    server.get(&picture).with_status(200);
    server.kill();

    let server = Server::start(&data, &[]);
    assert_eq!(server.get(&format!("/v1/brdfs/{digest}")).with_status(200).body, bytes);
    // The command line uploads the file that a recipe names by path.
    fs::write(here.join("recipe.json"), recipe("eon.safetensors").replace("64", "65")).expect("a recipe");
    let watched = run(here, ["jobs", "submit", "recipe.json", "--watch", "--server", &server.url]).exited(0);
    assert_ne!(watched.last_line(), table);
    server.get(&format!("/v1/tables/{}", watched.last_line())).with_status(200);
    let refused = run(here, ["tabulate", "oren_nayar", "-o", "other.safetensors"]).exited(0);
    fs::write(here.join("recipe.json"), recipe("other.safetensors").replace(r#""alpha": 2"#, r#""alpha": 2000"#))
        .expect("a recipe");
    let refused = (refused, run(here, ["jobs", "submit", "recipe.json", "--server", &server.url]).exited(2));
    assert!(refused.1.stderr.contains("/resolution/alpha"), "{refused:#?}");
}

#[test]
fn a_bad_file_is_refused_with_all_its_faults() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let refused = server.request("POST", "/v1/brdfs", &[OCTETS], Some(b"{}")).with_status(422).json();
    assert_eq!(text(&refused["type"]), "/problems/bad-brdf");
    let header = br#"{"phi":{"dtype":"F32","shape":[1],"data_offsets":[0,4]},"value":{"dtype":"I32","shape":[1],"data_offsets":[4,8]}}"#;
    let bytes = [&(header.len() as u64).to_le_bytes(), &header[..], &[0; 8]].concat();
    let refused = server.request("POST", "/v1/brdfs", &[OCTETS], Some(&bytes)).with_status(422).json();
    let output: Vec<&str> =
        refused["errors"].as_array().expect("faults").iter().map(|error| text(&error["detail"])).collect();
    for said in
        ["tensor «theta_o»: missing", "tensor «theta_i»: missing", "tensor «value»: type I32", "tensor «phi»: 1 nodes"]
    {
        assert!(output.iter().any(|output| output.starts_with(said)), "{said}: {output:?}");
    }
    server.request("POST", "/v1/brdfs", &[("content-type", "application/json")], Some(&bytes)).with_status(415);
    server.get(&format!("/v1/brdfs/{}", "0".repeat(64))).with_status(404);
}

/// Plants a file of 60 MB with one tensor in the store. It is a tabulated BRDF if the tensor is named `value`, and
/// otherwise a table.
fn plant_large(data: &Path, tensor: &str) -> (Digest, Vec<u8>) {
    let numbers = 15 << 20;
    let header = format!(r#"{{"{tensor}":{{"dtype":"F32","shape":[{numbers}],"data_offsets":[0,{}]}}}}"#, 4 * numbers);
    let mut bytes = [&(header.len() as u64).to_le_bytes(), header.as_bytes()].concat();
    bytes.extend((0..4 * numbers).map(|i: u32| (i >> 8) as u8));
    let digest = Digest::of(&bytes);
    let folder = data.join("blobs").join(&digest.hex()[..2]);
    fs::create_dir_all(&folder).expect("a folder");
    fs::write(folder.join(digest.hex()), &bytes).expect("a blob");
    (digest, bytes)
}

/// A connection that has started to download the whole file, and the bytes that were read from it.
fn begun(server: &Server, path: &str) -> (TcpStream, Vec<u8>) {
    let address = server.url.strip_prefix("http://").expect("an address");
    let mut client = TcpStream::connect(address).expect("a connection");
    write!(client, "GET {path} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n").expect("a request");
    let mut answer = vec![0; 16 << 10];
    client.read_exact(&mut answer).expect("a head");
    (client, answer)
}

#[test]
fn a_large_file_is_sent_in_parts_within_bounded_memory() {
    let folder = tempfile::tempdir().expect("a folder");
    let (digest, bytes) = plant_large(folder.path(), "value");
    let server = Server::start(folder.path(), &[]);
    let path = format!("/v1/brdfs/{digest}");
    let before = server.most_memory();
    thread::scope(|scope| {
        for at in 0..32 {
            let (server, path, bytes) = (&server, &path, &bytes);
            scope.spawn(move || {
                let range = format!("bytes={}-{}", at << 20, at << 20);
                let part = server.request("GET", path, &[("range", &range)], None).with_status(206);
                assert_eq!(part.body, bytes[at << 20..=at << 20]);
                server.request("HEAD", path, &[], None).with_status(200);
            });
        }
    });
    // The service is busy with several whole downloads at the same time. No client reads them.
    let unread: Vec<TcpStream> = (0..16).map(|_| begun(&server, &path).0).collect();
    assert!(server.get(&path).with_status(200).body == bytes);
    drop(unread);
    let grown = (server.most_memory() - before) / bytes.len() as u64;
    assert!(grown < 8, "{grown} times the file");
}

/// The service reads at most four files completely at the same time. It does not wait for clients that have left.
#[test]
fn no_file_is_read_for_clients_that_have_left() {
    let folder = tempfile::tempdir().expect("a folder");
    let (digest, bytes) = plant_large(folder.path(), "value");
    let server = Server::start(folder.path(), &[]);
    let path = format!("/v1/brdfs/{digest}");
    let address = server.url.strip_prefix("http://").expect("an address");
    let before = server.bytes_read();
    for _ in 0..64 {
        let mut client = TcpStream::connect(address).expect("a connection");
        write!(client, "GET {path} HTTP/1.1\r\nHost: {address}\r\n\r\n").expect("a request");
    }
    assert!(server.get(&path).with_status(200).body == bytes);
    let read = (server.bytes_read() - before) / bytes.len() as u64;
    assert!(read < 16, "{read} times the file");
}

#[test]
fn long_input_is_not_repeated_in_responses() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let many: Vec<String> =
        (0..20_000).map(|i| format!(r#""t{i}":{{"dtype":"F32","shape":[0],"data_offsets":[0,0]}}"#)).collect();
    let long = "x".repeat(30_000);
    let name = format!(r#"{{"{long}":{{"dtype":"F32","shape":[0],"data_offsets":[0,0]}}}}"#);
    for header in [format!("{{{}}}", many.join(",")), name, format!("{{{long}")] {
        let bytes = [&(header.len() as u64).to_le_bytes(), header.as_bytes()].concat();
        let refused = server.request("POST", "/v1/brdfs", &[OCTETS], Some(&bytes)).with_status(422);
        assert!(refused.body.len() < 1000, "{} bytes", refused.body.len());
    }
    let digest = "0".repeat(64);
    let gets = [
        (format!("/v1/{long}"), 404),
        (format!("/v1/jobs?state={long}"), 400),
        (format!("/v1/jobs?{long}=1"), 400),
        (format!("/v1/jobs/{long}"), 400),
        (format!("/v1/tables?cursor={long}"), 400),
        (format!("/v1/tables/{long}"), 400),
        (format!("/v1/tables/{digest}/exports/{long}"), 404),
        (format!("/v1/brdfs/{long}"), 400),
        (format!("/v1/recipes/{long}"), 400),
        (format!("/v1/preview?{long}=1"), 422),
        (format!("/v1/preview?mode={long}"), 422),
        (format!("/v1/preview?table={long}"), 422),
    ];
    for (path, status) in gets {
        let output = server.get(&path).with_status(status).json().to_string();
        assert!(output.matches('x').count() < 450, "{}: {output}", &path[..40]);
    }
    for field in ["host", "origin", "content-type"] {
        let output = server.request("POST", "/v1/jobs", &[(field, &long)], Some(b"{}")).json().to_string();
        assert!(output.matches('x').count() < 450, "{field}: {output}");
    }
    assert!(server.submit(&format!(r#"{{"{long}": "{long}"}}"#)).with_status(422).body.len() < 1000);
}

#[test]
fn a_client_that_reads_slowly_but_steadily_is_not_cut() {
    let folder = tempfile::tempdir().expect("a folder");
    let (digest, bytes) = plant_large(folder.path(), "value");
    let server = Server::start(folder.path(), &["--client-seconds", "1"]);
    let (mut client, mut answer) = begun(&server, &format!("/v1/brdfs/{digest}"));
    // 320 kB per second, for three times the limit. This tests the pace.
    for _ in 0..60 {
        thread::sleep(Duration::from_millis(50));
        let mut part = [0; 16 << 10];
        client.read_exact(&mut part).expect("a part");
        answer.extend(part);
    }
    client.read_to_end(&mut answer).expect("the rest");
    assert!(answer.ends_with(&bytes), "{} bytes", answer.len());
}

#[test]
fn stored_files_are_counted_and_listed_and_unused_files_are_deleted() {
    let folder = tempfile::tempdir().expect("a folder");
    let (here, data) = (folder.path(), folder.path().join("data"));
    let made = ["0.2,1", "0.3,1", "0.4,1"].map(|alpha| {
        let digest = run(here, ["tabulate", "oren_nayar", "--alpha", alpha, "-o", "brdf.safetensors"]).exited(0);
        (digest.last_line().to_owned(), fs::read(here.join("brdf.safetensors")).expect("the file"))
    });
    let [(fitted, _), (other, other_bytes), (third, third_bytes)] = &made;
    let server = Server::start(&data, &["--brdf-limit", "2"]);
    let send = |server: &Server, bytes: &[u8]| server.request("POST", "/v1/brdfs", &[OCTETS], Some(bytes));
    for (_, bytes) in &made[..2] {
        send(&server, bytes).with_status(201);
    }
    let full = send(&server, third_bytes).with_status(507).json();
    assert_eq!(text(&full["type"]), "/problems/brdf-limit");
    assert!(text(&full["detail"]).contains("`--brdf-limit`"), "{full:#}");
    send(&server, other_bytes).with_status(200);
    server.get(&format!("/v1/brdfs/{third}")).with_status(404);

    let table = server.fit(&recipe(fitted));
    let listed = |server: &Server| {
        let (mut digests, mut next) = (Vec::new(), String::new());
        loop {
            let page = server.get(&format!("/v1/brdfs?limit=1{next}")).with_status(200).json();
            digests.extend(page["items"].as_array().expect("items").iter().map(|row| text(&row["digest"]).to_owned()));
            match page["next"].as_str() {
                Some(cursor) => next = format!("&cursor={cursor}"),
                None => return digests,
            }
        }
    };
    assert_eq!(listed(&server), [other.as_str(), fitted], "newest first, without tables");
    let row = &server.get("/v1/brdfs?limit=1").with_status(200).json()["items"][0];
    assert_eq!(row["bytes"], other_bytes.len());

    let delete = |server: &Server, digest: &str| server.request("DELETE", &format!("/v1/brdfs/{digest}"), &[], None);
    assert_eq!(text(&delete(&server, fitted).with_status(409).json()["type"]), "/problems/brdf-in-use");
    // A table cannot be deleted through the BRDF paths.
    delete(&server, &table).with_status(404);
    // A waiting job uses the file. A cancelled job does not.
    let slow = recipe(other).replace("\"samples\": 64", "\"samples\": 4096").replace("\"theta\": 3", "\"theta\": 2000");
    let job = server.submit(&slow).with_status(202).json();
    delete(&server, other).with_status(409);
    server.request("DELETE", &format!("/v1/jobs/{}", text(&job["id"])), &[], None).with_status(200);
    let path = format!("/v1/brdfs/{other}");
    server.request("DELETE", &path, &[("if-match", "\"x\"")], None).with_status(412);
    server.request("DELETE", &path, &[("if-match", &format!("\"{other}\""))], None).with_status(204);
    server.get(&path).with_status(404);
    delete(&server, other).with_status(404);
    let refused = server.submit(&slow).with_status(422).json();
    assert!(text(&refused["errors"][0]["detail"]).contains("send its file to /v1/brdfs first"), "{refused:#}");
    send(&server, third_bytes).with_status(201);
    server.kill();

    let server = Server::start(&data, &[]);
    assert_eq!(listed(&server), [third.as_str(), fitted]);
    assert_eq!(server.fit(&recipe(fitted)), table);
}
