//! Invalid input gets a clear error, and nothing is lost.

use crate::common::{
    SMALL,
    command::run,
    server::{Answer, Server},
};

/// The JSON pointers in the errors for a rejected recipe.
#[track_caller]
fn pointers(answer: &Answer) -> Vec<String> {
    let problem = answer.json();
    let errors = problem["errors"].as_array().unwrap_or_else(|| panic!("no errors in {problem:#}"));
    errors.iter().map(|error| error["pointer"].as_str().expect("a pointer").to_owned()).collect()
}

#[test]
fn each_fault_of_a_recipe_has_a_json_pointer() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let cases = [
        (r#"{"preset":"draft","colour":"red"}"#, "/colour"),
        (r#"{"preset":"draft","fit":{"sample":64}}"#, "/fit/sample"),
        (r#"{"preset":"draft","resolution":{"alpha":"8"}}"#, "/resolution/alpha"),
        (r#"{"preset":"draft","resolution":{"alpha":2.5}}"#, "/resolution/alpha"),
        (r#"{"preset":"draft","resolution":{"theta":0}}"#, "/resolution/theta"),
        (r#"{"preset":"draft","resolution":{"theta":1}}"#, "/resolution/theta"),
        (r#"{"preset":"draft","resolution":{"phi":-1}}"#, "/resolution/phi"),
        (r#"{"preset":"draft","resolution":{"alpha":1000,"ratio":1000}}"#, "/resolution"),
        (r#"{"preset":"draft","range":{"alpha":[0.9,0.1]}}"#, "/range/alpha"),
        (r#"{"preset":"draft","range":{"theta":[0,3]}}"#, "/range/theta"),
        (r#"{"preset":"draft","range":{"phi":[0]}}"#, "/range/phi"),
        (r#"{"preset":"draft","range":{"ratio":[0,null]}}"#, "/range/ratio"),
        (r#"{"preset":"draft","fit":{"samples":0}}"#, "/fit/samples"),
        (r#"{"preset":"draft","fit":{"samples":4000000000}}"#, "/fit/samples"),
        (r#"{"preset":"draft","fit":{"directions":0}}"#, "/fit/directions"),
        (r#"{"preset":"draft","fit":{"solver":"magic"}}"#, "/fit/solver"),
        (r#"{"preset":"draft","terms":"yes"}"#, "/terms"),
        (r#"{"preset":"draft","fresnel":[{"f0":2}]}"#, "/fresnel/0/f0"),
        (r#"{"preset":"draft","brdf":"oren_nayar","fresnel":[{"f0":0.04}]}"#, "/fresnel"),
        (r#"{"preset":"finest"}"#, "/preset"),
        (r#"{"preset":7}"#, "/preset"),
        ("[]", ""),
        ("\"draft\"", ""),
    ];
    for (recipe, pointer) in cases {
        let refused = server.submit(recipe).with_status(422);
        let pointed = pointers(&refused);
        assert!(pointed.iter().any(|found| found.starts_with(pointer)), "{recipe}: {pointed:?}");
    }
    let jobs = server.get("/v1/jobs").with_status(200).json();
    assert_eq!(jobs["items"].as_array().map(Vec::len), Some(0), "a refused recipe leaves no job");
}

#[test]
fn all_faults_are_reported_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let recipe = r#"{"preset":"draft","colour":1,"resolution":{"alpha":0},"range":{"theta":[1,0],"ratio":[0,0.00001]},"fit":{"samples":0}}"#;
    let pointed = pointers(&server.submit(recipe).with_status(422));
    for pointer in ["/colour", "/resolution/alpha", "/range/theta", "/range/ratio", "/fit/samples"] {
        assert!(pointed.iter().any(|found| found.starts_with(pointer)), "{pointer} is missing in {pointed:?}");
    }
}

/// For a sheen table, previews reject models that only support GGX.
#[test]
fn models_for_ggx_are_rejected_for_tables_of_another_scattering_model() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let refused = server.submit(r#"{"brdf":"charlie","layout":"reflected","range":{"ratio":[0,1]}}"#).with_status(422);
    assert_eq!(pointers(&refused), ["/layout", "/range/ratio"]);
    let recipe =
        r#"{"brdf":"charlie","resolution":{"alpha":3,"theta":3},"fit":{"samples":64,"directions":4,"steps":5}}"#;
    let table = server.fit(recipe);
    let preview = |query: &str| server.get(&format!("/v1/preview?table={table}&size=64&spp=4&{query}"));
    assert_eq!(preview("mode=strip").with_status(200).header("preview-adapter"), Some("cpu"));
    for query in ["mode=models", "model=normals&mode=strip", "model=asg&mode=difference"] {
        let problem = preview(query).with_status(400).json();
        assert!(problem["detail"].as_str().is_some_and(|detail| detail.contains("brdf charlie")), "{problem:#}");
    }
    let manifest = server.get(&format!("/v1/tables/{table}/manifest")).with_status(200).json();
    assert!(manifest["report"]["poor"]["nodes"].as_u64().is_some(), "{manifest:#}");
}

#[test]
fn a_long_list_of_faults_is_cut() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let fields: Vec<String> = (0..150).map(|number| format!("\"x{number}\":1")).collect();
    let refused = server.submit(&format!("{{{}}}", fields.join(","))).with_status(422);
    assert_eq!(pointers(&refused).len(), 100);
    let detail = refused.json()["detail"].to_string();
    assert!(detail.contains("150 faults") && detail.contains("50 are omitted"), "{detail}");
    let query: Vec<String> = (0..150).map(|number| format!("x{number}=1")).collect();
    let refused = server.get(&format!("/v1/preview?{}", query.join("&"))).with_status(422).json();
    assert_eq!(refused["errors"].as_array().map(Vec::len), Some(100), "{}", refused["detail"]);
}

#[test]
fn invalid_json_long_bodies_and_other_types_are_rejected() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    for text in ["", "{", "preset: draft", r#"{"preset":"draft","range":{"alpha":[NaN,1]}}"#, "{} {}", "\u{0}"] {
        assert_eq!(server.submit(text).with_status(400).json()["type"], "/problems/not-json", "{text:?}");
    }
    let deep = "[".repeat(60_000);
    assert_eq!(server.submit(&deep).with_status(400).json()["type"], "/problems/not-json");

    let padded = |length: usize| format!("{SMALL}{}", " ".repeat(length - SMALL.len()));
    server.submit(&padded(64 * 1024)).with_status(202);
    assert_eq!(server.submit(&padded(64 * 1024 + 1)).with_status(413).json()["type"], "/problems/body-too-large");

    let post = |fields: &[(&str, &str)]| server.request("POST", "/v1/jobs", fields, Some(SMALL.as_bytes()));
    assert_eq!(post(&[("content-type", "text/plain")]).with_status(415).json()["type"], "/problems/not-json-type");
    assert!(post(&[("content-type", "application/recipe+json")]).status < 300);
    assert!(post(&[]).status < 300, "without a content type, the body is JSON");
}

#[test]
fn invalid_ids_and_parameters_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let (id, digest) = ("0".repeat(32), "0".repeat(64));
    let unknown = [
        (format!("/v1/jobs/{id}"), "/problems/unknown-job"),
        (format!("/v1/jobs/{id}/events"), "/problems/unknown-job"),
        (format!("/v1/tables/{digest}"), "/problems/unknown-table"),
        (format!("/v1/tables/sha256:{digest}/manifest"), "/problems/unknown-table"),
        (format!("/v1/recipes/{digest}"), "/problems/unknown-recipe"),
    ];
    for (path, kind) in unknown {
        assert_eq!(server.get(&path).with_status(404).json()["type"], kind, "{path}");
    }
    assert_eq!(server.request("DELETE", &format!("/v1/jobs/{id}"), &[], None).status, 404);

    let malformed = [
        ("/v1/jobs/xyz", "«xyz»"),
        ("/v1/jobs/%FF", "UTF-8"),
        ("/v1/tables/sha256:12", "«sha256:12»"),
        ("/v1/recipes/..%2F..%2Fetc", "«../../etc»"),
        ("/v1/jobs?sate=done", "sate"),
        ("/v1/jobs?state=finished", "finished"),
        ("/v1/jobs?limit=0", "«0»"),
        ("/v1/jobs?limit=ten", "«ten»"),
        ("/v1/jobs?limit=1&limit=2", "limit"),
        ("/v1/jobs?cursor=%00%2Fxyz", "/xyz»"),
        ("/v1/jobs?cursor=", "«»"),
        ("/v1/jobs?cursor=00ff", "«00ff»"),
        ("/v1/tables?cursor=xyz", "«xyz»"),
        ("/v1/tables?cursor=0", "«0»"),
        ("/v1/tables?state=done", "state"),
        ("/healthz?x=1", "x"),
        ("/readyz?x=1", "x"),
        ("/metrics?x=1", "x"),
        ("/version?x", "x"),
        ("/openapi.yaml?x=1", "x"),
        ("/v1/tables/0000000000000000000000000000000000000000000000000000000000000000?x=1", "x"),
    ];
    for (path, named) in malformed {
        let problem = server.get(path).with_status(400).json();
        let detail = problem["detail"].as_str().unwrap_or_default();
        assert!(detail.contains(named), "{path}: {detail}");
    }
}

#[test]
fn every_fault_of_a_plot_s_parameters_is_listed() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let zeros = "0".repeat(64);
    let cases: [(&str, &[(&str, &str)]); 5] = [
        (
            "error.png?ratio=1.5&phi=x&colour=red&ratio=0.5",
            &[("ratio", "«1.5»"), ("phi", "«x»"), ("colour", "ratio and phi"), ("ratio", "more than once")],
        ),
        ("error.png?phi=NaN", &[("phi", "«NaN»")]),
        ("error.png?ratio=", &[("ratio", "«»")]),
        ("matrix.png?phi=0&ratio=0.5", &[("phi", "no parameters"), ("ratio", "no parameters")]),
        ("matrix.png?phi=0&phi=0", &[("phi", "no parameters"), ("phi", "more than once")]),
    ];
    for (rest, expected) in cases {
        let problem = server.get(&format!("/v1/tables/{zeros}/plots/{rest}")).with_status(422).json();
        assert_eq!(problem["type"], "/problems/bad-plot", "{problem:#}");
        let faults = problem["errors"].as_array().unwrap_or_else(|| panic!("no errors in {problem:#}"));
        let count = if faults.len() == 1 { "1 fault".to_owned() } else { format!("{} faults", faults.len()) };
        assert_eq!(problem["detail"], format!("{count} in the parameters"), "{rest}");
        assert_eq!(faults.len(), expected.len(), "{problem:#}");
        for (fault, (parameter, detail)) in faults.iter().zip(expected) {
            assert_eq!(fault["parameter"], *parameter, "{problem:#}");
            assert!(fault["detail"].as_str().is_some_and(|text| text.contains(detail)), "{detail}: {problem:#}");
        }
    }
    // A malformed table is an error of the path, as in every other call.
    let malformed = server.get("/v1/tables/xyz/plots/error.png?ratio=2").with_status(400).json();
    assert_eq!(malformed["type"], "/problems/bad-parameter");
    let unknown = server.get(&format!("/v1/tables/{zeros}/plots/error.png?ratio=1")).with_status(404).json();
    assert_eq!(unknown["type"], "/problems/unknown-table");
}

#[test]
fn a_full_queue_asks_clients_to_retry() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &["--queue-limit", "1"]);
    let id = server.submit(crate::common::ENDLESS).with_status(202).json()["id"].clone();
    let refused = server.submit(SMALL).with_status(429);
    assert!(refused.header("retry-after").is_some());
    let joined = server.submit(crate::common::ENDLESS).with_status(202).json();
    assert_eq!(joined["id"], id, "an equal recipe must join the same job");
}

#[test]
fn the_operator_sets_the_limit_on_entries() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &["--entry-limit", "15"]);
    assert_eq!(server.submit(SMALL).with_status(422).json()["type"], "/problems/bad-recipe");
}

/// The line that explains why a service does not start.
#[track_caller]
fn complaint(data: &std::path::Path, listen: &str) -> String {
    let data = data.to_str().expect("a path in UTF-8");
    let folder = tempfile::tempdir().expect("a folder");
    let ended = run(folder.path(), ["serve", "--listen", listen, "--data", data]).exited(1);
    assert_eq!(ended.complaints().len(), 1, "{ended:#?}");
    assert_eq!(ended.stdout, "", "a service that does not start must not print its address");
    ended.complaints()[0].to_owned()
}

#[test]
fn a_service_that_cannot_start_names_the_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let (one, other) = (folder.path().join("one"), folder.path().join("other"));
    let server = Server::start(&one, &[]);
    let address = server.url.strip_prefix("http://").expect("an http URL");

    let taken = complaint(&other, address);
    assert!(taken.contains(address) && taken.contains("the port is already in use"), "{taken}");
    let locked = complaint(&one, "127.0.0.1:0");
    assert!(locked.contains("in use by another process") && locked.contains(one.to_str().expect("UTF-8")), "{locked}");

    // Even root cannot create a folder below a file.
    let file = folder.path().join("file");
    std::fs::write(&file, "").expect("a file");
    let unusable = complaint(&file.join("data"), "127.0.0.1:0");
    assert!(unusable.contains("cannot be used") && unusable.contains("file/data"), "{unusable}");

    assert_eq!(server.get("/healthz").status, 200, "the first service must keep running");
}
