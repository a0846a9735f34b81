//! Measures the memory of the service while clients send the largest requests of each call at the same time. There are
//! [`CLIENTS`] or `LTCFORGE_TEST_CLIENTS` clients. A third of them reads the whole response, a third reads nothing, and
//! a third disconnects in the middle.

use std::{
    fs,
    io::{Read as _, Write as _, copy, sink},
    net::TcpStream,
    sync::Barrier,
    thread,
};

use super::clients::host;
use crate::common::{
    DEADLINE,
    command::run,
    openapi::DOCUMENT,
    server::{Server, text},
    soak::rounds,
};

/// Number of clients in a short run.
const CLIENTS: usize = 3;

/// Memory in MiB that the service may use in addition to its memory when idle. Most of it is for two concurrent uploads
/// and their processing. docs/operations.md states this limit.
const BUDGET: u64 = 1024;

const METHODS: [&str; 5] = ["get", "head", "put", "post", "delete"];

/// The recipe of a table of more than a mebibyte. It is sent in several parts.
const LONG: &str = r#"{"preset":"draft","resolution":{"alpha":15,"ratio":8,"theta":25,"phi":10},
    "fit":{"samples":64,"directions":4,"steps":1}}"#;

/// The stored files, and the bodies for the requests.
struct Stored {
    table: String,
    job: String,
    recipe: String,
    brdf: (String, Vec<u8>),
    scene: Vec<u8>,
}

/// The largest request of a call: path and query, additional fields, and body. `None` if all requests and responses of
/// the call are small.
fn largest(call: (&str, &str), stored: &Stored) -> Option<(String, String, Vec<u8>)> {
    let (method, path) = call;
    let json = "content-type: application/json\r\n";
    let octets = "content-type: application/octet-stream\r\n";
    let with = |query: &str| {
        let file = if path.contains("{folder}") { "none" } else { "ltc.npy" };
        let filled = path.replace("{export}", "reflected.npy.f32").replace("{folder}", "none").replace("{file}", file);
        let digest = match path {
            path if path.starts_with("/v1/brdfs") => &stored.brdf.0,
            path if path.starts_with("/v1/recipes") => &stored.recipe,
            _ => &stored.table,
        };
        filled.replace("{digest}", digest).replace("{id}", &stored.job) + query
    };
    let read = |query: &str| Some((with(query), String::new(), vec![]));
    let recipe = |from: &str| {
        let start = format!(r#"{{"nodes":{{"alpha":[{from}"#);
        (start + &",0.5".repeat(16_000) + "]}}").into_bytes()
    };
    match (method, path) {
        ("post", "/v1/plans") => {
            Some((with(""), "content-type: model/gltf-binary\r\n".to_owned(), stored.scene.clone()))
        }
        ("post", "/v1/brdfs") => Some((with(""), octets.to_owned(), stored.brdf.1.clone())),
        ("get", "/v1/jobs" | "/v1/tables") => read("?limit=1000"),
        ("get", "/v1/preview") => read("?size=1024&spp=1"),
        ("get", "/page/{file}") => Some(("/page/main.js".to_owned(), String::new(), vec![])),
        ("get" | "head", _) => read(""),
        ("delete" | "put", _) => None,
        ("post", _) => Some((with(""), json.to_owned(), recipe("0.4"))),
        other => panic!("{other:?} is no method of these"),
    }
}

/// A GLB with `triangles` triangles. The triangles share no corners.
fn glb(triangles: usize) -> Vec<u8> {
    let bytes = triangles * 36;
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "materials":[{{"pbrMetallicRoughness":{{"roughnessFactor":0.4}}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"material":0}}]}}],
        "buffers":[{{"byteLength":{bytes}}}],"bufferViews":[{{"buffer":0,"byteLength":{bytes}}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3","min":[0,0,0],"max":[1,1,1]}}]}}"#,
        3 * triangles
    );
    json += &" ".repeat(json.len().next_multiple_of(4) - json.len());
    let corners = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let triangle: Vec<u8> = corners.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect();
    let length = |length: usize| u32::try_from(length).expect("a short one").to_le_bytes();
    let head = [b"glTF".as_slice(), &length(2), &length(28 + json.len() + bytes)].concat();
    let text = [&length(json.len()), b"JSON".as_slice(), json.as_bytes()].concat();
    [head, text, [length(bytes).as_slice(), b"BIN\0", &triangle.repeat(triangles)].concat()].concat()
}

fn stored(server: &Server) -> Stored {
    let folder = tempfile::tempdir().expect("a folder");
    let words = ["tabulate", "oren_nayar", "--alpha", "0.2,1", "--theta", "120", "--phi", "128", "-o", "brdf"];
    run(folder.path(), words).exited(0);
    let brdf = fs::read(folder.path().join("brdf")).expect("the file");
    let store = |path: &str, body: &[u8]| {
        let octets = ("content-type", "application/octet-stream");
        let answer = server.request("POST", path, &[octets], Some(body)).with_status(201);
        answer.header("location").and_then(|address| address.rsplit('/').next()).expect("an address").to_owned()
    };
    let brdf = (store("/v1/brdfs", &brdf), brdf);
    let job = text(&server.submit(LONG).json()["id"]).to_owned();
    let done = server.finished(&job);
    let [table, recipe] = ["table", "recipe_digest"].map(|field| text(&done[field]).to_owned());
    Stored { table, job, recipe, brdf, scene: glb(1_600_000) }
}

/// Sends a request with its whole body, or with half of it. The service may reject the rest.
fn send(server: &Server, head: &str, body: &[u8], is_whole: bool) -> TcpStream {
    let mut tcp = TcpStream::connect(host(server)).expect("a connection");
    tcp.set_read_timeout(Some(DEADLINE)).expect("a time limit");
    let body = if is_whole { body } else { &body[..body.len() / 2] };
    let _ = tcp.write_all(head.as_bytes()).and_then(|()| tcp.write_all(body));
    tcp
}

#[test]
fn the_largest_requests_and_answers_stay_within_the_budget() {
    let folder = tempfile::tempdir().expect("a folder");
    let words = ["--adapter", "cpu", "--workers", "2", "--client-seconds", "20"];
    let server = Server::start(folder.path(), &words);
    let stored = stored(&server);
    let (clients, mut met) = (rounds("LTCFORGE_TEST_CLIENTS", CLIENTS), 0);
    server.forget_peak_memory();
    let at_rest = server.peak_memory();
    for (path, calls) in DOCUMENT["paths"].as_object().expect("paths") {
        for method in calls.as_object().expect("methods").keys().filter(|key| METHODS.contains(&key.as_str())) {
            let Some((target, fields, body)) = largest((method, path), &stored) else { continue };
            let head = format!(
                "{} {target} HTTP/1.1\r\nhost: {}\r\nconnection: close\r\n{fields}content-length: {}\r\n\r\n",
                method.to_uppercase(),
                host(&server),
                body.len()
            );
            server.forget_peak_memory();
            let all_have_read = Barrier::new(clients);
            thread::scope(|scope| {
                for client in 0..clients {
                    let (server, head, body, all_have_read) = (&server, &head, &body, &all_have_read);
                    scope.spawn(move || {
                        let mut tcp = send(server, head, body, client % 3 < 2);
                        match client % 3 {
                            0 => drop(copy(&mut tcp, &mut sink())),
                            // This client disconnects during the response.
                            2 if body.is_empty() => drop(tcp.read(&mut [0])),
                            _ => {}
                        }
                        let open = (client % 3 < 2).then_some(tcp);
                        all_have_read.wait();
                        drop(open);
                    });
                }
            });
            let more = server.peak_memory().saturating_sub(at_rest);
            eprintln!("{more:5} MiB: {clients} clients of {} {path}", method.to_uppercase());
            assert!(more <= BUDGET, "{clients} clients of {method} {path}: {more} MiB, and {BUDGET} are stated");
            met += 1;
        }
    }
    assert!(met > 20, "{met} calls");
    server.get("/healthz").with_status(200);
    assert!(!server.kill_and_read().contains("panicked"));
}
