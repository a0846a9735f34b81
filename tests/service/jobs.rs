//! A job over HTTP, from the recipe to the downloaded table.

use std::io::{BufRead as _, BufReader};

use crate::common::{
    ENDLESS, LARGE, SMALL,
    server::{Server, text},
};
use ltcforge::files::digest::Digest;
use serde_json::Value;

#[test]
fn a_recipe_becomes_a_table_under_its_hash() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);

    let accepted = server.submit(SMALL).with_status(202);
    let job = accepted.json();
    let id = text(&job["id"]);
    assert_eq!(accepted.header("location"), Some(format!("/v1/jobs/{id}").as_str()));
    assert_eq!(job["progress"]["entries_total"], 16);
    for figure in ["seconds", "error", "shards"] {
        assert!(job["expected"][figure].as_f64().is_some_and(|figure| figure > 0.0), "{job:#}");
    }
    assert_eq!(&text(&job["recipe_digest"])["sha256:".len()..][..32], id);

    let done = server.finished(id);
    assert_eq!(done["state"], "done", "{done:#}");
    assert_eq!(done["progress"]["entries_done"], 16);
    assert_eq!(done["expected"]["error"], job["expected"]["error"]);
    let digest = text(&done["table"]);

    let file = server.get(&format!("/v1/tables/{digest}")).with_status(200);
    assert_eq!(Digest::of(&file.body).to_string(), digest);
    assert_eq!(file.header("etag"), Some(format!("\"{digest}\"").as_str()));

    let again = server.submit(SMALL).with_status(200).json();
    assert_eq!((&again["id"], &again["table"]), (&job["id"], &done["table"]));

    let recipe = server.get(&format!("/v1/recipes/{}", text(&job["recipe_digest"]))).with_status(200).json();
    assert_eq!((&recipe["table"], &recipe["recipe"]), (&done["table"], &job["recipe"]));
    let manifest = server.get(&format!("/v1/tables/{digest}/manifest")).with_status(200).json();
    assert_eq!(manifest["recipe"], job["recipe"]);
    let tables = server.get("/v1/tables").with_status(200).json();
    assert_eq!(tables["items"][0]["digest"], done["table"]);
    assert_eq!(tables["items"][0]["bytes"], file.body.len());
    // The list has the figures that a list of tables shows.
    let (listed, between) = (&tables["items"][0], &manifest["report"]["between"]);
    assert_eq!((&listed["recipe"], &listed["errors"]["light"]), (&job["recipe"], &between["light"]["mean"]));
    assert_eq!(listed["errors"]["width"], between["width"]["mean"]);
}

/// Responses that contain a list of materials also agree with `openapi.yaml`.
#[test]
fn equal_lists_of_materials_give_the_same_job() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let with = |fresnel: &str| SMALL.replacen('{', &format!(r#"{{"fresnel": {fresnel}, "#), 1);
    let table = server.fit(&with(r#"[{"f0": 1}, {"f0": 0.04, "weight": 4}]"#));
    let manifest = server.get(&format!("/v1/tables/{table}/manifest")).with_status(200).json();
    let materials = serde_json::json!([{ "f0": 0.04, "weight": 1 }, { "f0": 1, "weight": 0.25 }]);
    assert_eq!(manifest["recipe"]["fresnel"], materials);
    let same = server.submit(&with(r#"[{"f0": 0.04, "weight": 8}, {"f0": 1, "weight": 2}]"#)).with_status(200).json();
    assert_eq!(same["table"], table);
    let metal = server.submit(&with(r#""one""#)).with_status(202).json();
    assert!(metal["recipe"]["fresnel"].is_null() && metal["id"] != same["id"], "{metal:#}");
}

#[test]
fn a_table_download_supports_ranges_and_conditions() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let digest = server.fit(SMALL);
    // The prefix `sha256:` is optional.
    let path = format!("/v1/tables/{}", &digest["sha256:".len()..]);
    let ask = |method: &str, fields: &[(&str, &str)]| server.request(method, &path, fields, None);
    let file = ask("GET", &[]).with_status(200).body;
    let tag = format!("\"{digest}\"");

    let probe = ask("HEAD", &[]).with_status(200);
    assert_eq!(probe.header("content-length"), Some(file.len().to_string().as_str()));
    assert!(probe.body.is_empty());

    assert!(ask("GET", &[("if-none-match", &tag)]).with_status(304).body.is_empty());
    ask("HEAD", &[("if-none-match", &format!("\"x\", W/{tag}"))]).with_status(304);
    assert_eq!(ask("GET", &[("if-none-match", "\"x\"")]).with_status(200).body, file);

    // If-Match takes precedence over If-None-Match, and uses strong comparison.
    ask("GET", &[("if-match", &tag)]).with_status(200);
    ask("HEAD", &[("if-match", &format!("W/{tag}"))]).with_status(412);
    let other = ask("GET", &[("if-match", "\"x\""), ("if-none-match", &tag)]).with_status(412);
    assert_eq!(other.json()["type"], "/problems/precondition-failed");

    let (head, tail) = (ask("GET", &[("range", "bytes=0-99")]), ask("GET", &[("range", "bytes=100-")]));
    assert_eq!(tail.header("content-range"), Some(format!("bytes 100-{}/{}", file.len() - 1, file.len()).as_str()));
    assert_eq!([head.with_status(206).body, tail.with_status(206).body].concat(), file);
    assert_eq!(ask("GET", &[("range", "bytes=-7")]).with_status(206).body, file[file.len() - 7..]);
    let past = ask("GET", &[("range", &format!("bytes={}-", file.len()))]).with_status(416);
    assert_eq!(past.header("content-range"), Some(format!("bytes */{}", file.len()).as_str()));
    assert_eq!(ask("GET", &[("range", "bytes=0-99"), ("if-range", "\"x\"")]).with_status(200).body, file);
    ask("GET", &[("range", "bytes=0-99"), ("if-range", &tag)]).with_status(206);
}

/// No entity tag matches a resource without one [RFC 9110, section 13.1.1].
#[test]
fn conditions_fail_without_an_entity_tag() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let job = server.submit(ENDLESS).with_status(202).json();
    let path = format!("/v1/jobs/{}", text(&job["id"]));
    let asked = [("if-match", "\"nope\"")];
    let refused = server.request("DELETE", &path, &asked, None).with_status(412).json();
    assert_eq!(refused["type"], "/problems/precondition-failed");
    let submit = |fields: &[(&str, &str)]| server.request("POST", "/v1/jobs", fields, Some(SMALL.as_bytes()));
    submit(&asked).with_status(412);
    let jobs = server.get("/v1/jobs").with_status(200).json();
    assert_eq!(jobs["items"].as_array().map(Vec::len), Some(1), "{jobs:#}");
    assert!(jobs["items"][0]["state"] != "cancelled", "{jobs:#}");
    let events = format!("{path}/events");
    for path in [&path, &events, "/v1/jobs", "/v1/tables", "/healthz", "/metrics", "/openapi.yaml"] {
        for method in ["GET", "HEAD"] {
            server.request(method, path, &asked, None).with_status(412);
        }
    }
    // Conditions are ignored if the request would fail anyway.
    let unknown = format!("/v1/jobs/{}", "0".repeat(32));
    server.request("DELETE", &unknown, &asked, None).with_status(404);
    server.request("GET", &unknown, &asked, None).with_status(404);
    server.request("PUT", "/v1/jobs", &asked, None).with_status(405);
    submit(&[("if-match", "*")]).with_status(202);
    server.request("DELETE", &path, &[("if-match", "*")], None).with_status(200);
}

#[test]
fn two_clients_with_the_same_recipe_share_a_job() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let submit = || server.submit(ENDLESS).with_status(202).json()["id"].clone();
    let (one, other) = std::thread::scope(|scope| {
        let (one, other) = (scope.spawn(submit), scope.spawn(submit));
        (one.join().expect("an answer"), other.join().expect("an answer"))
    });
    assert_eq!(one, other);
    let jobs = server.get("/v1/jobs").with_status(200).json();
    assert_eq!(jobs["items"].as_array().map(Vec::len), Some(1), "{jobs:#}");
}

#[test]
fn a_cancelled_job_stops_and_can_be_submitted_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let id = text(&server.submit(ENDLESS).with_status(202).json()["id"]).to_owned();
    server.job_when(&id, |job| job["state"] == "running");
    let path = format!("/v1/jobs/{id}");
    let cancelled = server.request("DELETE", &path, &[], None).with_status(200).json();
    assert_eq!(cancelled["state"], "cancelled");
    assert_eq!(server.finished(&id)["state"], "cancelled");
    assert_eq!(server.request("DELETE", &path, &[], None).with_status(200).json()["state"], "cancelled");

    let by_state = |state: &str| server.get(&format!("/v1/jobs?state={state}")).with_status(200).json();
    assert_eq!(by_state("cancelled")["items"][0]["id"], id);
    assert_eq!(by_state("running")["items"], Value::Array(vec![]));

    assert_eq!(server.submit(ENDLESS).with_status(202).json()["id"], id);
    server.job_when(&id, |job| job["state"] == "running");
}

#[test]
fn a_restarted_service_serves_its_old_tables() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let digest = server.fit(SMALL);
    let file = server.get(&format!("/v1/tables/{digest}")).with_status(200).body;
    assert_eq!(server.stop("TERM").code, Some(0));

    let server = Server::start(folder.path(), &[]);
    assert_eq!(server.get(&format!("/v1/tables/{digest}")).with_status(200).body, file);
    assert_eq!(server.submit(SMALL).with_status(200).json()["table"], digest);
    assert_eq!(server.metric("ltcforge_entries_fitted_total"), 0);
}

#[test]
fn pages_of_jobs_follow_each_other() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    for seed in 0..3 {
        let mut recipe: Value = serde_json::from_str(SMALL).expect("a recipe");
        recipe["fit"]["seed"] = seed.into();
        server.fit(&recipe.to_string());
    }
    let mut ids = Vec::new();
    let mut path = "/v1/jobs?limit=2".to_owned();
    for items in [2, 1] {
        let page = server.get(&path).with_status(200).json();
        assert_eq!(page["items"].as_array().map(Vec::len), Some(items), "{page:#}");
        ids.extend(page["items"].as_array().into_iter().flatten().map(|job| text(&job["id"]).to_owned()));
        path = format!("/v1/jobs?limit=2&cursor={}", page["next"].as_str().unwrap_or("none"));
    }
    assert!(path.ends_with("cursor=none"), "a third page: {path}");
    ids.sort();
    ids.dedup();
    assert_eq!(ids.len(), 3);
}

/// The events of a stream, as (name, id, data).
fn events(server: &Server, id: &str, last_event_id: Option<&str>) -> (u16, Vec<(String, String, Value)>) {
    let response = server.events(id, last_event_id);
    let status = response.status().as_u16();
    let (mut found, mut name, mut number) = (Vec::new(), String::new(), String::new());
    for line in BufReader::new(response.into_body().into_reader()).lines() {
        let line = line.expect("the stream ends in order");
        match line.split_once(": ") {
            Some(("event", value)) => value.clone_into(&mut name),
            Some(("id", value)) => value.clone_into(&mut number),
            Some(("data", value)) => {
                found.push((name.clone(), number.clone(), serde_json::from_str(value).expect("a job")));
            }
            _ => {}
        }
    }
    (status, found)
}

#[test]
fn events_lead_to_the_final_state_and_resume() {
    let folder = tempfile::tempdir().expect("a folder");
    // With one worker, the job has time for several events, and runs longer than `--client-seconds`.
    let server = Server::start(folder.path(), &["--workers", "1", "--client-seconds", "1"]);
    let id = text(&server.submit(LARGE).with_status(202).json()["id"]).to_owned();

    let (_, all) = events(&server, &id, None);
    let (name, last, job) = all.last().expect("events");
    assert_eq!((name.as_str(), &job["state"]), ("state", &Value::from("done")));
    assert_eq!(all[0].0, "state", "the first event is the current state");
    assert!(all.iter().any(|(name, ..)| name == "progress"), "a job of many entries makes progress");
    let numbers: Vec<u64> = all.iter().map(|(_, number, _)| number.parse().expect("a number")).collect();
    assert!(numbers.is_sorted_by(|a, b| a < b), "{numbers:?}");
    let done: Vec<u64> = all.iter().filter_map(|(.., job)| job["progress"]["entries_done"].as_u64()).collect();
    assert!(done.is_sorted() && done.len() == all.len(), "{done:?}");

    // A client that already has the final state gets 204. Other clients get the final state.
    assert_eq!(events(&server, &id, Some(last)), (204, vec![]));
    let (_, rest) = events(&server, &id, Some("0"));
    assert_eq!(rest.len(), 1);
    assert_eq!(rest[0].2["state"], "done");
}

#[test]
fn an_open_stream_does_not_delay_a_stop() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let id = text(&server.submit(ENDLESS).with_status(202).json()["id"]).to_owned();
    let mut stream = BufReader::new(server.events(&id, None).into_body().into_reader());
    let mut line = String::new();
    stream.read_line(&mut line).expect("a first line");
    let run = server.stop("TERM").exited(0);
    assert!(!run.stderr.contains("were closed"), "{}", run.stderr);
}
