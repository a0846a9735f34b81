//! Each limit of `docs/operations.md` that is answered over HTTP is met once, and its answer says which it was.

use std::fs;

use serde_json::Value;

use super::{
    brdfs::OCTETS,
    clients::{host, request, send, try_answer},
};
use crate::common::{
    ENDLESS, SMALL,
    command::run,
    eventually,
    server::{Server, text},
};

/// The sections of the file whose tables list them.
const SECTIONS: [&str; 4] = ["Names and web pages", "Connections", "Requests", "Jobs, tables and pictures"];

/// A row of the file.
#[derive(Debug, Clone)]
struct Limit {
    name: String,
    /// The type of the problem.
    kind: String,
    /// The option that raises it; `None` if it is fixed.
    flag: Option<String>,
}

/// The rows that name a problem.
fn documented() -> Vec<Limit> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/operations.md");
    let file = fs::read_to_string(file).expect("the file");
    let mut limits: Vec<Limit> = Vec::new();
    for section in file.split("\n## ").filter(|section| SECTIONS.iter().any(|name| section.starts_with(name))) {
        for row in section.lines().filter(|line| line.starts_with('|')) {
            let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
            let last = limits.last().cloned();
            let beyond = cells[2];
            let kind = match beyond.split_once("/problems/") {
                Some((_, rest)) => rest.split('`').next().expect("a name").to_owned(),
                None if beyond.starts_with("the same") => last.clone().expect("a row before").kind,
                None => continue,
            };
            let word = |cell: &str| Some(cell.split_once("`--")?.1.split(['`', ' ']).next()?.to_owned());
            let flag = match cells.get(3) {
                Some(&"likewise") => last.and_then(|last| last.flag),
                Some(cell) => word(cell).map(|flag| format!("--{flag}")),
                None => None,
            };
            limits.push(Limit { name: cells[0].replace('`', ""), kind, flag });
        }
    }
    limits
}

/// The problem with which the service answers `text`.
#[track_caller]
fn told(server: &Server, text: &str) -> Value {
    let (_, _, body) = try_answer(send(server, text)).expect("an answer");
    serde_json::from_str(&body).expect("a document")
}

fn get(server: &Server, path: &str, more: &[(&str, &str)]) -> Value {
    let fields: Vec<(&str, &str)> = [("host", host(server))].into_iter().chain(more.iter().copied()).collect();
    told(server, &request(&format!("GET {path}"), &fields))
}

const MOST_EXPENSIVE: &str = "mode=strip&size=2048&spp=4096";
/// A picture that takes minutes, and far less than a day in any build on the busiest machine.
const LONG: &str = "mode=strip&size=2048&spp=64";

/// The token whose bytes are all 7.
const KEPT: &str = "farm submit sha256:24f573e77440149c1390fc3e4e2226e6ac24907bcd948645269c896bd58ebe0c";

/// The problem of the limit called `name`, on a service that has no table yet.
fn met(name: &str, server: &Server) -> Value {
    let long = "x".repeat(70_000);
    match name {
        "Host" => told(server, &request("GET /healthz", &[("host", "attacker.example")])),
        "Origin" => get(server, "/healthz", &[("origin", "http://attacker.example")]),
        "Sec-Fetch-Site" => get(server, "/healthz", &[("sec-fetch-site", "cross-site")]),
        "connections open in all" | "connections from one address, or one IPv6 network of 64 bits" => {
            // The harness keeps its connection.
            server.get("/healthz").with_status(200);
            get(server, "/healthz", &[])
        }
        name if name.starts_with("time until the head") => told(server, "GET /healthz HTTP/1.1\r\nhost:"),
        "time until its body is complete" => {
            let fields = [("host", host(server)), ("content-length", "100")];
            told(server, &(request("POST /v1/jobs", &fields) + "{"))
        }
        "head" => get(server, "/healthz", &[("x", &long), ("y", &long)]),
        "path and query" => get(server, &format!("/{long}"), &[]),
        "body" => server.submit(&long).json(),
        "items on a page" => get(server, "/v1/jobs?limit=1001", &[]),
        "jobs that wait or run" => {
            server.submit(ENDLESS).with_status(202);
            server.submit(SMALL).json()
        }
        "jobs of one team that wait or run" => {
            let bearer = format!("Bearer ltcforge_{}", "07".repeat(32));
            let fields = [("authorization", bearer.as_str()), ("content-type", "application/json")];
            let submit = |recipe: &str| server.request("POST", "/v1/jobs", &fields, Some(recipe.as_bytes()));
            submit(ENDLESS).with_status(202);
            submit(SMALL).json()
        }
        "entries of a table" => server.submit(SMALL).json(),
        "predicted seconds of a job, with all workers on it" => server.submit(ENDLESS).json(),
        "pictures that wait or are rendered" => {
            server.fit(SMALL);
            let fields = [("host", host(server))];
            let long = request(&format!("GET /v1/preview?{LONG}"), &fields);
            let mut asked = Vec::new();
            let mut size = 63;
            eventually("a full queue", || {
                // The small picture may have come first, and the long one been refused: it is requested until it waits.
                asked.push(send(server, &long));
                size += 1;
                let answer = server.get(&format!("/v1/preview?size={size}"));
                (answer.status == 429).then(|| answer.json())
            })
        }
        "samples of a picture" => {
            server.fit(SMALL);
            server.get(&format!("/v1/preview?{MOST_EXPENSIVE}")).with_status(422).json()
        }
        name if name.starts_with("tabulated BRDFs that are stored") => {
            let folder = tempfile::tempdir().expect("a folder");
            let [first, second] = ["0.2,1", "0.3,1"].map(|alpha| {
                run(folder.path(), ["tabulate", "oren_nayar", "--alpha", alpha, "-o", "brdf.safetensors"]).exited(0);
                fs::read(folder.path().join("brdf.safetensors")).expect("the file")
            });
            server.request("POST", "/v1/brdfs", &[OCTETS], Some(&first)).with_status(201);
            server.request("POST", "/v1/brdfs", &[OCTETS], Some(&second)).json()
        }
        "pins of a table" => {
            let table = server.fit(SMALL);
            let put = |n: usize| server.request("PUT", &format!("/v1/tables/{table}/pins/p{n}"), &[], None);
            (0..256).for_each(|n| drop(put(n).with_status(201)));
            put(0).with_status(200);
            put(256).json()
        }
        name if name.starts_with("requests a second") => eventually("a refusal", || {
            Some(server.get("/v1/jobs")).filter(|answer| answer.status != 200).map(|answer| answer.json())
        }),
        name if name.starts_with("light textures that are stored") => {
            // One pixel of Radiance HDR, and another.
            let picture = |exponent: u8| [b"#?RADIANCE\n\n-Y 1 +X 1\n\x80\x80\x80".as_slice(), &[exponent]].concat();
            server.request("POST", "/v1/light-textures", &[OCTETS], Some(&picture(129))).with_status(201);
            server.request("POST", "/v1/light-textures", &[OCTETS], Some(&picture(130))).json()
        }
        name if name.starts_with("tabulated BRDFs that are received") => {
            let fields = [("host", host(server)), OCTETS, ("content-length", "1000")];
            let held = request("POST /v1/brdfs", &fields);
            // The bodies never come: those that are waited for end with 408, and their places go to the next.
            let held: Vec<_> = (0..8).map(|_| send(server, &held)).collect();
            let answers: Vec<_> = held.into_iter().map(|client| try_answer(client).expect("an answer")).collect();
            let (_, _, body) = answers.iter().find(|(status, ..)| *status == 503).expect("one that waited in vain");
            serde_json::from_str(body).expect("a document")
        }
        other => panic!("no test meets the limit «{other}»"),
    }
}

/// Arguments under which [`met`] meets it.
fn arguments(name: &str) -> &'static [&'static str] {
    match name {
        "connections open in all" => &["--connections", "1"],
        "connections from one address, or one IPv6 network of 64 bits" => &["--connections-per-address", "1"],
        name if name.starts_with("time until") || name.starts_with("tabulated BRDFs that are received") => {
            &["--client-seconds", "1"]
        }
        name if name.starts_with("requests a second") => &["--requests-per-second", "1"],
        name if name.starts_with("tabulated BRDFs that are stored") => &["--brdf-limit", "1"],
        name if name.starts_with("light textures that are stored") => &["--light-texture-limit", "1"],
        "jobs that wait or run" => &["--queue-limit", "1"],
        "jobs of one team that wait or run" => &["--queue-limit", "2", "--token-list", KEPT],
        "entries of a table" => &["--entry-limit", "15"],
        "predicted seconds of a job, with all workers on it" => &["--job-seconds", "1"],
        "pictures that wait or are rendered" => {
            &["--adapter", "cpu", "--picture-queue", "1", "--picture-seconds", "86400"]
        }
        "samples of a picture" => &["--adapter", "cpu", "--picture-seconds", "1"],
        _ => &[],
    }
}

#[test]
fn the_answer_of_each_limit_says_which_it_was() {
    let limits = documented();
    assert!(limits.len() > 15, "{limits:#?}");
    for Limit { name, kind, flag } in limits {
        // Only a picture within the limit of samples meets it, on a slow machine; `http::error` tests what its answer
        // says.
        if name.starts_with("time of a picture") {
            continue;
        }
        // A table of half a million entries and a crowd of exports take minutes; `http::error` tests what is answered.
        if name == "entries of a table that is exported" || name.starts_with("requests for exports") {
            continue;
        }
        let folder = tempfile::tempdir().expect("a folder");
        let server = Server::start(folder.path(), arguments(&name));
        let problem = met(&name, &server);
        assert_eq!(problem["type"], format!("/problems/{kind}"), "{name}: {problem:#}");
        match flag {
            Some(flag) => assert!(problem.to_string().contains(&flag), "{name} does not name {flag}: {problem:#}"),
            None => assert!(text(&problem["detail"]).contains(char::is_numeric), "{name}: {problem:#}"),
        }
    }
}
