//! Tests pictures over HTTP.

use std::{
    fs,
    io::{Read as _, Write as _},
    net::TcpStream,
    time::Duration,
};

use crate::common::{
    SMALL,
    command::{Run, ltcforge, run, run_with_stdin},
    eventually, report_skipped,
    server::{Answer, Server, text},
};
use serde_json::Value;

/// A service that renders previews on the CPU, so they are the same on every machine.
fn start() -> (tempfile::TempDir, Server) {
    start_with(&[])
}

/// A service that also accepts pictures that take minutes.
fn start_patient() -> (tempfile::TempDir, Server) {
    start_with(&["--picture-seconds", "86400"])
}

fn start_with(more: &[&str]) -> (tempfile::TempDir, Server) {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[&["--adapter", "cpu"], more].concat());
    (folder, server)
}

/// The width and height of a PNG. All its rows must decode.
fn size(png: &[u8]) -> (u32, u32) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a picture")];
    let info = reader.next_frame(&mut pixels).expect("its pixels");
    assert!(pixels.iter().any(|byte| *byte != pixels[0]), "one colour");
    (info.width, info.height)
}

fn tag(answer: &Answer) -> String {
    answer.header("etag").expect("a tag").to_owned()
}

#[test]
fn a_picture_has_its_size_and_entity_tag() {
    let (folder, server) = start();
    let digest = server.fit(SMALL);
    let query = format!("size=64&spp=2&mode=strip&table={digest}");
    let first = server.get(&format!("/v1/preview?{query}")).with_status(200);
    assert_eq!(first.header("preview-adapter"), Some("cpu"));
    assert_eq!(first.header("cache-control"), Some("public, max-age=86400"));
    let (width, height) = size(&first.body);
    assert!(width > 3 * 64 && height > 64, "{width} x {height}");

    // The order of parameters, explicit defaults and the digest's prefix do not change the picture.
    let hex = digest.trim_start_matches("sha256:");
    let same = format!("/v1/preview?table={hex}&mode=strip&spp=2&scene=sphere&exposure=1.0&size=64");
    let again = server.get(&same).with_status(200);
    assert_eq!((tag(&again), &again.body), (tag(&first), &first.body));
    // Parameters that a mode does not show do not change the picture either.
    let plain = |rest: &str| tag(&server.get(&format!("/v1/preview?size=64&table={digest}{rest}")).with_status(200));
    assert_eq!(plain("&spp=2&theta=0.5&difference_scale=1"), plain(""));
    assert_ne!(plain("&exposure=2"), plain(""));
    assert_ne!(plain("&mode=reference&spp=2"), plain("&mode=reference&spp=3"));
    let other = server.get(&format!("/v1/preview?{query}&rotation=0.5")).with_status(200);
    assert_ne!(tag(&other), tag(&first));
    assert_ne!(other.body, first.body);

    // Another process renders the same bytes with the same entity tag.
    let known = [("if-none-match", tag(&first))];
    let known = known.each_ref().map(|(name, value)| (*name, value.as_str()));
    let path = format!("/v1/preview?{query}");
    assert!(server.request("GET", &path, &known, None).with_status(304).body.is_empty());
    assert_eq!(server.stop("TERM").code, Some(0));
    let server = Server::start(folder.path(), &["--adapter", "cpu"]);
    server.request("GET", &path, &known, None).with_status(304);
    let rendered = server.get(&path).with_status(200);
    assert_eq!((tag(&rendered), &rendered.body), (tag(&first), &first.body));
}

#[test]
fn without_a_digest_the_newest_table_is_shown() {
    let (_folder, server) = start();
    assert_eq!(server.get("/v1/preview").with_status(404).json()["detail"], "no table is stored");
    for needs_none in ["model=normals", "model=normals&mode=strip&spp=2", "mode=reference&spp=2"] {
        let picture = server.get(&format!("/v1/preview?size=64&{needs_none}")).with_status(200);
        assert_eq!(picture.header("cache-control"), Some("public, max-age=86400"), "{needs_none}");
    }
    for needs_one in ["mode=models&spp=2", "mode=lobe&model=normals"] {
        server.get(&format!("/v1/preview?size=64&{needs_one}")).with_status(404);
    }
    let tables = [SMALL, &SMALL.replace("\"steps\":5", "\"steps\":1")].map(|recipe| server.fit(recipe));
    let newest = server.get("/v1/preview?size=64").with_status(200);
    assert_eq!(newest.header("cache-control"), Some("no-cache"));
    let named = |table: &String| tag(&server.get(&format!("/v1/preview?size=64&table={table}")).with_status(200));
    assert_eq!(tag(&newest), named(&tables[1]));
    assert_ne!(tag(&newest), named(&tables[0]));
}

#[test]
fn plots_of_a_table_are_pictures_with_their_own_entity_tags() {
    let (_folder, server) = start();
    let digest = server.fit(SMALL);
    let plot = |rest: &str| server.get(&format!("/v1/tables/{digest}/plots/{rest}"));
    let (matrix, errors) = (plot("matrix.png").with_status(200), plot("error.png").with_status(200));
    for answer in [&matrix, &errors] {
        assert_eq!(answer.header("preview-adapter"), Some("cpu"));
        assert_eq!(answer.header("cache-control"), Some("public, max-age=86400"));
        let (width, height) = size(&answer.body);
        assert!(width > 400 && height > 400, "{width} x {height}");
    }
    let usual = plot("error.png?phi=0.7&ratio=0.25").with_status(200);
    assert_eq!((tag(&usual), &usual.body), (tag(&errors), &errors.body));
    let other = plot("error.png?ratio=1").with_status(200);
    assert_ne!((tag(&other), &other.body), (tag(&errors), &errors.body));
    // The errors as numbers. A report has the means over all configurations, and these numbers are for a slice.
    let numbers = plot("error.json").with_status(200);
    assert_eq!(numbers.header("content-type"), Some("application/json"));
    assert_ne!(tag(&numbers), tag(&errors));
    let numbers = numbers.json();
    assert_eq!((&numbers["ratio"], &numbers["phi"]), (&serde_json::json!(0.25), &serde_json::json!(0.7)));
    for (axis, most) in [("alpha", 1.0), ("theta", std::f64::consts::FRAC_PI_2)] {
        let values: Vec<f64> = numbers[axis].as_array().expect("a list").iter().filter_map(Value::as_f64).collect();
        assert!(values.len() == 40 && values.is_sorted() && values[0] > 0.0 && values[39] < most, "{axis}: {values:?}");
    }
    for of in ["width", "light"] {
        let rows = numbers[of].as_array().expect("rows");
        let is_whole = |row: &Value| row.as_array().is_some_and(|row| row.len() == 40 && row.iter().all(Value::is_f64));
        assert!(rows.len() == 40 && rows.iter().all(is_whole), "{of}");
    }
    // The tag is known before the picture is drawn again.
    let known = tag(&matrix);
    let path = format!("/v1/tables/{digest}/plots/matrix.png");
    assert!(server.request("GET", &path, &[("if-none-match", &known)], None).with_status(304).body.is_empty());

    for (rest, parameter, named) in [
        ("error.png?ratio=1.5", "ratio", "«1.5»"),
        ("error.png?phi=x", "phi", "«x»"),
        ("error.json?phi=x", "phi", "«x»"),
        ("matrix.png?phi=0", "phi", "no parameters"),
    ] {
        let problem = plot(rest).with_status(422).json();
        assert_eq!(problem["type"], "/problems/bad-plot", "{rest}");
        assert_eq!(problem["errors"][0]["parameter"], parameter, "{problem}");
        assert!(text(&problem["errors"][0]["detail"]).contains(named), "{problem}");
    }
    assert_eq!(plot("colours.png").with_status(404).json()["type"], "/problems/no-such-path");
    let unknown = format!("/v1/tables/{}/plots/matrix.png", "0".repeat(64));
    assert_eq!(server.get(&unknown).with_status(404).json()["type"], "/problems/unknown-table");
}

#[test]
fn every_fault_of_a_query_is_reported() {
    let (_folder, server) = start();
    let query = "table=xyz&size=63&colour=red&f0=1,2&spp=4&spp=4&light=cube&phi=NaN";
    let problem = server.get(&format!("/v1/preview?{query}")).with_status(422).json();
    assert_eq!(problem["type"], "/problems/bad-scene");
    assert_eq!(problem["detail"], "7 faults in the parameters");
    let faults = problem["errors"].as_array().expect("faults");
    let mut parameters: Vec<&str> = faults.iter().map(|fault| text(&fault["parameter"])).collect();
    parameters.sort_unstable();
    assert_eq!(parameters, ["colour", "f0", "light", "phi", "size", "spp", "table"]);
    let unknown = format!("/v1/preview?table={}", "0".repeat(64));
    assert_eq!(server.get(&unknown).with_status(404).json()["type"], "/problems/unknown-table");
}

#[test]
fn a_full_queue_rejects_requests_until_clients_disconnect() {
    let (_folder, server) = start_patient();
    let table = server.fit(SMALL);
    let address = server.url.strip_prefix("http://").expect("an address").to_owned();
    // Nine requests are accepted: one is rendered and eight wait. None of them ends soon.
    let mut asked: Vec<TcpStream> = (0..10)
        .map(|n| {
            let mut stream = TcpStream::connect(&address).expect("a connection");
            let query = format!("mode=reference&size=2048&spp=4096&rotation={n}e-3&table={table}");
            write!(stream, "GET /v1/preview?{query} HTTP/1.1\r\nhost: {address}\r\n\r\n").expect("a request");
            stream.set_read_timeout(Some(Duration::from_millis(20))).expect("a limit");
            stream
        })
        .collect();
    let refused = eventually("a refusal", || {
        asked.iter_mut().find_map(|stream| {
            let mut head = [0; 1024];
            let length = stream.read(&mut head).ok()?;
            Some(String::from_utf8_lossy(&head[..length]).to_ascii_lowercase())
        })
    });
    assert!(refused.starts_with("http/1.1 429"), "{refused}");
    assert!(refused.contains("\r\nretry-after: 2\r\n"), "{refused}");

    drop(asked);
    eventually("room", || {
        let answer = server.get(&format!("/v1/preview?size=64&table={table}"));
        (answer.status == 200).then_some(())
    });
    let metrics = String::from_utf8(server.get("/metrics").with_status(200).body).expect("text");
    for (outcome, least) in [("done", 1), ("given_up", 1), ("refused", 1)] {
        let name = format!("ltcforge_pictures_total{{outcome=\"{outcome}\"}} ");
        let count = metrics.lines().find_map(|line| line.strip_prefix(&name)).expect("a line");
        assert!(count.parse::<u64>().expect("a count") >= least, "{name}{count}");
    }
    assert_eq!(server.stop("TERM").code, Some(0));
}

#[test]
fn fitting_goes_on_while_a_picture_is_rendered() {
    let (_folder, server) = start_patient();
    let table = server.fit(SMALL);
    let address = server.url.strip_prefix("http://").expect("an address").to_owned();
    let mut stream = TcpStream::connect(&address).expect("a connection");
    // This picture takes minutes.
    let query = format!("mode=reference&size=2048&spp=4096&table={table}");
    write!(stream, "GET /v1/preview?{query} HTTP/1.1\r\nhost: {address}\r\n\r\n").expect("a request");
    assert_ne!(server.fit(&SMALL.replace("\"steps\":5", "\"steps\":2")), table);
    stream.set_read_timeout(Some(Duration::from_millis(20))).expect("a limit");
    assert!(stream.read(&mut [0; 16]).is_err(), "the picture was there before the table");
}

#[test]
fn a_fresh_service_rejects_the_most_expensive_picture_and_can_stop_while_rendering() {
    let (_folder, server) = start_with(&["--picture-seconds", "1"]);
    let table = server.fit(SMALL);
    let most_expensive = format!("/v1/preview?mode=strip&size=2048&spp=4096&table={table}");
    let refused = server.get(&most_expensive).with_status(422).json();
    assert_eq!(refused["type"], "/problems/too-expensive", "{refused:#}");
    assert!(text(&refused["detail"]).contains("--picture-seconds"), "{refused:#}");
    server.stop("TERM").exited(0);

    let (_folder, server) = start_patient();
    let table = server.fit(SMALL);
    let address = server.url.strip_prefix("http://").expect("an address").to_owned();
    let mut stream = TcpStream::connect(&address).expect("a connection");
    let query = format!("mode=strip&size=2048&spp=4096&table={table}");
    write!(stream, "GET /v1/preview?{query} HTTP/1.1\r\nhost: {address}\r\n\r\n").expect("a request");
    // The renderer is busy once a cheap picture waits for it. The client of the cheap picture then disconnects.
    let mut size = 63;
    eventually("a busy renderer", || {
        let mut waiting = TcpStream::connect(&address).ok()?;
        waiting.set_read_timeout(Some(Duration::from_millis(200))).ok()?;
        // The size must not be that of a cached picture.
        size += 1;
        write!(waiting, "GET /v1/preview?size={size}&table={table} HTTP/1.1\r\nhost: {address}\r\n\r\n").ok()?;
        waiting.read(&mut [0; 16]).is_err().then_some(())
    });
    let ended = server.stop("TERM").exited(0);
    assert!(!ended.stderr.contains("the render thread did not end"), "{ended:#?}");
}

/// Without a runtime folder, as on servers, Mesa complains that there is no display.
#[test]
fn the_command_keeps_vulkan_quiet_without_a_runtime_folder() {
    let folder = tempfile::tempdir().expect("a folder");
    let fitted = run_with_stdin(folder.path(), ["fit", "-"], SMALL).exited(0);
    let arguments = ["preview", &fitted.last_line()[..16], "-o", "p.png", "--size", "64"];
    for runtime_folder in [None, Some("")] {
        let mut command = ltcforge(folder.path(), arguments);
        command.env_remove("NODEVICE_SELECT").env_remove("XDG_RUNTIME_DIR");
        command.envs(runtime_folder.map(|folder| ("XDG_RUNTIME_DIR", folder)));
        let output = Run::from(command.output().expect("the binary runs")).exited(0);
        assert!(output.stderr.contains("adapter: "), "{output:#?}");
        assert!(!output.stderr.contains("XDG_RUNTIME_DIR"), "{output:#?}");
        if output.stderr.contains("adapter: cpu") {
            return report_skipped("there is no Vulkan driver (Debian: mesa-vulkan-drivers) that could complain");
        }
    }
}

/// A table with few alphas and ratios shows its nearest entry for other materials, and the command reports it.
#[test]
fn materials_outside_the_table_are_reported_and_marked() {
    let folder = tempfile::tempdir().expect("a folder");
    let narrow = SMALL.replacen('{', r#"{"range":{"alpha":[0.2,0.5],"ratio":[0.3,1]},"#, 1);
    let fitted = run_with_stdin(folder.path(), ["fit", "-"], &narrow).exited(0);
    let output = |rest: &[&str]| {
        let arguments = ["preview", &fitted.last_line()[..16], "-o", "p.png", "--size", "256", "--adapter", "cpu"];
        let output = run(folder.path(), arguments.iter().chain(rest)).exited(0);
        (output, fs::read(folder.path().join("p.png")).expect("a picture"))
    };
    let (inside, plain) = output(&["--alpha-x", "0.2", "--alpha-y", "0.4"]);
    assert!(!inside.stderr.contains("outside"), "{inside:#?}");
    // The nearest entry is at alpha 0.5, ratio 1. Only the label differs.
    let (at_the_end, unmarked) = output(&["--alpha-x", "0.5", "--alpha-y", "0.5"]);
    assert!(!at_the_end.stderr.contains("outside"), "{at_the_end:#?}");
    let (beyond, marked) = output(&["--alpha-x", "0.9", "--alpha-y", "0.9"]);
    let line = "alpha 0.9 0.9 lies outside the table, which covers alpha 0.2 to 0.5 and ratio 0.3 to 1";
    assert!(beyond.stderr.contains(line), "{beyond:#?}");
    assert!(marked != unmarked && unmarked != plain);
    let (json, _) = output(&["--scene", "figure14", "--json"]);
    let json: Value = serde_json::from_str(&json.stdout).expect("JSON");
    let outside: Vec<&Value> = json["outside"].as_array().expect("a list").iter().map(|m| &m["alpha_y"]).collect();
    assert_eq!(outside, [&Value::from(0.25), &0.02.into(), &1.0.into()]);
}

/// Uses the default renderer: a GPU, lavapipe, or the CPU if there is neither.
#[test]
fn the_service_renders_with_the_available_adapter() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let table = server.fit(SMALL);
    let path = format!("/v1/preview?mode=strip&size=64&spp=4&table={table}");
    let first = server.get(&path).with_status(200);
    let adapter = first.header("preview-adapter").expect("a name").to_owned();
    if adapter == "cpu" {
        report_skipped("there is no Vulkan driver (Debian: mesa-vulkan-drivers), so the CPU rendered");
    }
    let known = tag(&first);
    let known = [("if-none-match", known.as_str())];
    server.request("GET", &path, &known, None).with_status(304);
    assert_eq!(server.stop("TERM").code, Some(0));

    // The same adapter gives the same bytes with the same entity tag, which differs from that of the CPU's picture.
    let server = Server::start(folder.path(), &[]);
    let again = server.get(&path).with_status(200);
    assert_eq!((tag(&again), &again.body), (tag(&first), &first.body));
    assert_eq!(again.header("preview-adapter"), Some(adapter.as_str()));
    assert_eq!(server.stop("TERM").code, Some(0));
    let server = Server::start(folder.path(), &["--adapter", "cpu"]);
    let by_cpu = server.get(&path).with_status(200);
    assert_eq!(tag(&by_cpu) == tag(&first), adapter == "cpu");
}
