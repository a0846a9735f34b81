//! Power cuts and kills. The test records the writes of a service. From the record it creates possible contents of the
//! disk at [`CUTS`] or `LTCFORGE_TEST_CUTS` points. A service that starts with these contents must have everything that
//! was acknowledged. Kills happen between durable steps: a file is synchronised, or a name is added, changed or
//! removed.

mod disk;
mod trace;

use std::{collections::BTreeMap, fs, path::Path, process::Command, sync::LazyLock};

use serde_json::Value;

use super::brdfs::OCTETS;
use crate::common::{
    ENDLESS,
    command::run,
    report_skipped,
    server::{Server, text},
    soak::{Random, four_shards, rounds},
};
use disk::End;
use trace::{Change, Trace};

/// The number of points. Each takes about half a second.
const CUTS: usize = 12;

/// A response that acknowledges a change to a client.
#[derive(Debug)]
enum Ack {
    /// A job with its state. If it is done, it has a table.
    Job { id: String, state: String, table: Option<String> },
    /// A file is stored at this address.
    Stored { address: String },
}

/// The acknowledgements in a trace. The number is the line where the response starts.
fn acks(trace: &Trace) -> Vec<(usize, Ack)> {
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
                all.push((event.began, Ack::Job { id, state, table }));
            }
            _ => all.extend(location.map(|address| (event.began, Ack::Stored { address }))),
        }
    }
    all
}

/// The trace of a service that fits tables, stores a tabulated BRDF, cancels a job, and receives a recipe again.
fn traced() -> Trace {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let (data, file) = (folder.join("data"), folder.join("trace"));
    fs::create_dir(&data).expect("a folder");
    run(folder, ["tabulate", "oren_nayar", "--alpha", "0.2,1", "-o", "brdf"]).exited(0);
    let brdf = fs::read(folder.join("brdf")).expect("the file");
    // strace runs as a separate process (-D), so the child process is the service itself.
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

/// A trace and its acknowledgements.
type Recorded = (Trace, Vec<(usize, Ack)>);

/// The trace for both tests. Prints a message and returns `None` if tracing is not possible.
fn recorded() -> Option<&'static Recorded> {
    static RECORDED: LazyLock<Option<Recorded>> = LazyLock::new(|| {
        let can_trace = Command::new("strace").args(["-f", "true"]).output().is_ok_and(|run| run.status.success());
        can_trace.then(|| {
            let trace = traced();
            let acks = acks(&trace);
            let tables = acks.iter().filter(|(_, ack)| matches!(ack, Ack::Job { table: Some(_), .. })).count();
            assert!(tables >= 3 && acks.iter().any(|(_, ack)| matches!(ack, Ack::Stored { .. })), "{acks:#?}");
            (trace, acks)
        })
    });
    if RECORDED.is_none() {
        report_skipped("there is no strace here, or it may not trace");
    }
    RECORDED.as_ref()
}

/// Checks that a service on `data` has everything that was acknowledged before line `line`.
fn check(data: &Path, acks: &[(usize, Ack)], line: usize) {
    let server = Server::start(data, &["--workers", "1"]);
    // Only the last acknowledgement of each job counts.
    let mut jobs = BTreeMap::new();
    for (at, ack) in acks.iter().filter(|(at, _)| *at < line) {
        match ack {
            Ack::Job { id, .. } => drop(jobs.insert(id, (at, ack))),
            Ack::Stored { address } => drop(server.get(address).with_status(200)),
        }
    }
    for (id, (at, ack)) in jobs {
        let Ack::Job { state, table, .. } = ack else { continue };
        let job = server.get(&format!("/v1/jobs/{id}"));
        if job.status != 200 {
            let log = server.kill_and_read();
            panic!("before line {line}: job {id}, acknowledged at line {at}, is lost: {log}");
        }
        let job = job.json();
        if ["done", "cancelled"].contains(&state.as_str()) {
            assert_eq!(job["state"], *state, "before line {line}, acknowledged at line {at}: {job:#}");
        }
        if let Some(table) = table {
            server.get(&format!("/v1/tables/{table}")).with_status(200);
        }
    }
    let log = server.kill_and_read();
    assert!(!log.contains("panicked"), "before line {line}: {log}");
}

#[test]
fn power_cuts_lose_nothing_that_was_acknowledged() {
    let Some((trace, acks)) = recorded() else { return };
    let mut random = Random(1);
    for _ in 0..rounds("LTCFORGE_TEST_CUTS", CUTS) {
        let (line, folder) = (random.below(trace.lines + 1), tempfile::tempdir().expect("a folder"));
        disk::after(End::PowerCut(&mut random), trace, line, folder.path());
        check(folder.path(), acks, line);
    }
}

#[test]
fn kills_between_durable_steps_lose_nothing_that_was_acknowledged() {
    let Some((trace, acks)) = recorded() else { return };
    let is_durable = |change: &Change| !matches!(change, Change::Write { .. } | Change::Sent { .. });
    let steps: Vec<usize> =
        trace.events.iter().filter(|event| is_durable(&event.change)).map(|event| event.began).collect();
    // All steps, or the given number of evenly spaced steps.
    let every = steps.len().div_ceil(rounds("LTCFORGE_TEST_CUTS", CUTS));
    for step in steps.iter().step_by(every) {
        let folder = tempfile::tempdir().expect("a folder");
        disk::after(End::Kill, trace, *step, folder.path());
        check(folder.path(), acks, *step);
    }
}
