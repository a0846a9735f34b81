//! Kills the service with SIGKILL while jobs are submitted: [`KILLS`] or `LTCFORGE_TEST_KILLS` times.

use std::{thread, time::Duration};

use crate::common::{
    command::run_with_stdin,
    server::{Server, text},
    soak::{Random, four_shards, rounds},
};

/// Number of kills. Two kills take about a second.
const KILLS: usize = 10;

/// Largest delay of every fourth kill, after the response to a submission. For these kills, the test does not wait for
/// the job's progress.
const SOON_MILLISECONDS: usize = 40;

#[test]
fn kills_lose_nothing_that_was_acknowledged() {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().join("data");
    let start = || Server::start(&data, &["--workers", "2"]);
    let (mut server, mut random) = (start(), Random(1));
    let (mut acknowledged, mut finished) = (Vec::new(), Vec::<String>::new());
    let kills = rounds("LTCFORGE_TEST_KILLS", KILLS);
    for kill in 0..kills {
        let recipe = four_shards(kill);
        let id = text(&server.submit(&recipe).json()["id"]).to_owned();
        acknowledged.push((recipe, id.clone()));
        if random.below(4) == 0 {
            thread::sleep(Duration::from_millis(random.below(SOON_MILLISECONDS) as u64));
        } else {
            // Each time, the job has reached another point: no shard, some shards of 64 entries each, or the table.
            let wanted = 64 * random.below(5) as u64;
            let job = server.job_when(&id, |job| {
                job["progress"]["entries_done"].as_u64() >= Some(wanted) || job["state"] == "done"
            });
            finished.extend(job["table"].as_str().map(str::to_owned));
        }
        let log = server.kill_and_read();
        assert!(!log.contains("ERROR"), "kill {kill}: {log}");
        server = start();
        for table in finished.iter().rev().take(2) {
            server.get(&format!("/v1/tables/{table}")).with_status(200);
        }
    }
    for (recipe, id) in &acknowledged {
        let job = server.finished(id);
        assert_eq!(job["state"], "done", "{job:#}");
        let expected = run_with_stdin(folder.path(), ["fit", "-", "-o", "fitted"], recipe).exited(0);
        assert_eq!(job["table"], expected.last_line());
        server.get(&format!("/v1/tables/{}", expected.last_line())).with_status(200);
    }
    assert_eq!(acknowledged.len(), kills);
    assert_eq!(server.stop("TERM").exited(0).stderr.matches("ERROR").count(), 0);
    assert!(!data.join("quarantine").exists());
}
