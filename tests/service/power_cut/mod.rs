//! Power cuts and kills: what a service writes is recorded, and at [`CUTS`] points, or `LTCFORGE_TEST_CUTS`, what a disk may have by
//! then is made of it. A service that starts there has all that was acknowledged. Kills are between durable steps: a file is
//! synchronised, or gets, changes or loses its name.

mod disk;
mod trace;

use std::{collections::BTreeMap, fs, path::Path, process::Command, sync::LazyLock};

use serde_json::Value;

use super::brdfs::OCTETS;
use crate::common::{
    ENDLESS,
    command::run,
    server::{Server, text},
    soak::{Random, four_shards, rounds},
    tell_skipped,
};
use disk::End;
use trace::{Change, Trace};

/// Each takes about half a second.
const CUTS: usize = 12;

/// What a client was told by a line of the trace.
#[derive(Debug)]
enum Told {
    /// A job with its state and, if it is done, its table.
    Job { id: String, state: String, table: Option<String> },
    /// Something is stored there.
    Stored { address: String },
}

/// What the service told, and at which line it began to.
fn told(trace: &Trace) -> Vec<(usize, Told)> {
    let mut all = Vec::new();
    for event in &trace.events {
        let Change::Sent { bytes } = &event.change else { continue };
        let text = String::from_utf8_lossy(bytes);
        let Some((head, body)) = text.split_once("\r\n\r\n").filter(|(head, _)| head.starts_with("HTTP/1.1 20")) else {
            continue;
        };
        let location =
            head.lines().find_map(|line| line.to_ascii_lowercase().strip_prefix("location: ").map(str::to_owned));
        match serde_json::from_str::<Value>(body) {
            Ok(job) if job["progress"].is_object() => {
                let [id, state] = ["id", "state"].map(|field| job[field].as_str().expect("a text").to_owned());
                let table = job["table"].as_str().map(str::to_owned);
                all.push((event.began, Told::Job { id, state, table }));
            }
            _ => all.extend(location.map(|address| (event.began, Told::Stored { address }))),
        }
    }
    all
}

/// The trace of a service that fits, cancels, is asked again for what it has, and stores a tabulated BRDF.
fn traced() -> Trace {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let (data, file) = (folder.join("data"), folder.join("trace"));
    fs::create_dir(&data).expect("a folder");
    run(folder, ["tabulate", "oren_nayar", "--alpha", "0.2,1", "-o", "brdf"]).exited(0);
    let brdf = fs::read(folder.join("brdf")).expect("the file");
    // The tracer is a process beside, so that the child is the service itself.
    let words = ["-D", "-f", "-xx", "-s", "100000000", "-o", file.to_str().expect("UTF-8"), "-e", trace::CALLS];
    let server = Server::start_under("strace", &words, &data, &["--workers", "2"]);
    for number in 0..3 {
        let id = text(&server.submit(&four_shards(number)).with_status(202).json()["id"]).to_owned();
        if number == 1 {
            server.request("POST", "/v1/brdfs", &[OCTETS], Some(&brdf)).with_status(201);
        }
        server.finished(&id);
    }
    let endless = text(&server.submit(ENDLESS).with_status(202).json()["id"]).to_owned();
    server.request("DELETE", &format!("/v1/jobs/{endless}"), &[], None).with_status(200);
    server.submit(&four_shards(0)).with_status(200);
    server.submit(&four_shards(3)).with_status(202);
    server.kill_and_read();
    trace::read(&fs::read_to_string(file).expect("the trace"), &data)
}

/// What was done, and what was told.
type Recorded = (Trace, Vec<(usize, Told)>);

/// What both tests use; `None`, and it says so, where nothing can be traced.
fn recorded() -> Option<&'static Recorded> {
    static RECORDED: LazyLock<Option<Recorded>> = LazyLock::new(|| {
        let can_trace = Command::new("strace").args(["-f", "true"]).output().is_ok_and(|run| run.status.success());
        can_trace.then(|| {
            let trace = traced();
            let told = told(&trace);
            let tables = told.iter().filter(|(_, told)| matches!(told, Told::Job { table: Some(_), .. })).count();
            assert!(tables >= 3 && told.iter().any(|(_, told)| matches!(told, Told::Stored { .. })), "{told:#?}");
            (trace, told)
        })
    });
    if RECORDED.is_none() {
        tell_skipped("there is no strace here, or it may not trace");
    }
    RECORDED.as_ref()
}

/// A service on `data` has what was told ahead of line `line`.
fn check(data: &Path, told: &[(usize, Told)], line: usize) {
    let server = Server::start(data, &["--workers", "1"]);
    // The last word on each.
    let mut jobs = BTreeMap::new();
    for (at, told) in told.iter().filter(|(at, _)| *at < line) {
        match told {
            Told::Job { id, .. } => drop(jobs.insert(id, (at, told))),
            Told::Stored { address } => drop(server.get(address).with_status(200)),
        }
    }
    for (id, (at, told)) in jobs {
        let Told::Job { state, table, .. } = told else { continue };
        let job = server.get(&format!("/v1/jobs/{id}"));
        if job.status != 200 {
            let log = server.kill_and_read();
            panic!("ahead of line {line}: job {id}, told at line {at}, is lost: {log}");
        }
        let job = job.json();
        if ["done", "cancelled"].contains(&state.as_str()) {
            assert_eq!(job["state"], *state, "ahead of line {line}, told at line {at}: {job:#}");
        }
        if let Some(table) = table {
            server.get(&format!("/v1/tables/{table}")).with_status(200);
        }
    }
    let log = server.kill_and_read();
    assert!(!log.contains("panicked"), "ahead of line {line}: {log}");
}

#[test]
fn power_cuts_lose_nothing_that_was_acknowledged() {
    let Some((trace, told)) = recorded() else { return };
    let mut random = Random(1);
    for _ in 0..rounds("LTCFORGE_TEST_CUTS", CUTS) {
        let (line, folder) = (random.below(trace.lines + 1), tempfile::tempdir().expect("a folder"));
        disk::after(End::PowerCut(&mut random), trace, line, folder.path());
        check(folder.path(), told, line);
    }
}

#[test]
fn kills_between_durable_steps_lose_nothing_that_was_acknowledged() {
    let Some((trace, told)) = recorded() else { return };
    let is_durable = |change: &Change| !matches!(change, Change::Write { .. } | Change::Sent { .. });
    let steps: Vec<usize> =
        trace.events.iter().filter(|event| is_durable(&event.change)).map(|event| event.began).collect();
    // All of them, or as many at equal distances.
    let every = steps.len().div_ceil(rounds("LTCFORGE_TEST_CUTS", CUTS));
    for step in steps.iter().step_by(every) {
        let folder = tempfile::tempdir().expect("a folder");
        disk::after(End::Kill, trace, *step, folder.path());
        check(folder.path(), told, *step);
    }
}
