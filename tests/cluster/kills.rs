//! Kills processes with SIGKILL at random while jobs are submitted: [`KILLS`] or `LTCFORGE_TEST_KILLS` times.

use crate::{
    Shared, Worker,
    common::{
        SMALL,
        command::run_with_stdin,
        eventually,
        server::{Server, text},
        soak::{Random, four_shards, rounds},
    },
    throwaway,
};

/// Two kills take about a second.
const KILLS: usize = 50;

#[test]
fn kills_lose_nothing_that_was_acknowledged() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut shared) = Shared::new(folder.path()) else { return };
    let Some(database) = throwaway::Server::start("-c fsync=off") else { return };
    shared.database = database.empty_database();
    let name = shared.database.split(['/', '?']).nth(3).expect("a name").to_owned();
    // This table gets a row for each finished shard that is leased again.
    let replica = |number: usize| shared.replica(&folder.path().join(format!("replica-{number}")));
    let mut replicas: Vec<Option<Server>> = (0..2).map(|number| Some(replica(number))).collect();
    database.psql(
        &name,
        "CREATE TABLE refitted (submission bigint, task integer);
        CREATE FUNCTION note() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN
            INSERT INTO public.refitted VALUES (OLD.submission, OLD.task); RETURN NEW; END $$;
        CREATE TRIGGER note AFTER UPDATE ON ltcforge.tasks FOR EACH ROW
            WHEN (OLD.state = 'finished' AND NEW.state <> 'finished') EXECUTE FUNCTION note()",
    );
    let worker = || Worker::start(&shared, folder.path(), "1");
    let mut workers: Vec<Option<Worker>> = (0..2).map(|_| Some(worker())).collect();
    let mut random = Random(1);
    let mut acknowledged = Vec::new();
    let kills = rounds("LTCFORGE_TEST_KILLS", KILLS);
    for kill in 0..kills {
        // A killed process is started again before the next kill. Sometimes all processes are killed at once.
        let hit = random.below(5);
        let submitted = four_shards(kill);
        if let Some(server) = replicas.iter().flatten().next() {
            acknowledged.push((submitted.clone(), text(&server.submit(&submitted).json()["id"]).to_owned()));
        }
        // Each kill happens at another point of the job.
        let wanted = random.below(5);
        let (_, id) = acknowledged.last().expect("a job");
        let finished = format!(
            "SELECT count(*) FROM ltcforge.tasks AS t JOIN ltcforge.jobs AS j USING (submission)
            WHERE encode(j.id, 'hex') = '{id}' AND t.state = 'finished'"
        );
        let ended = format!("SELECT count(*) FROM ltcforge.jobs WHERE encode(id, 'hex') = '{id}' AND state = 'done'");
        eventually("the point for the next kill", || {
            let count: usize = database.psql(&name, &finished).parse().expect("a count");
            (count >= wanted || database.psql(&name, &ended) == "1").then_some(())
        });
        if hit == 4 {
            workers.fill_with(|| None);
            replicas.iter_mut().filter_map(Option::take).for_each(Server::kill);
        }
        for number in 0..2 {
            if hit == number || hit == 4 {
                workers[number].take();
                workers[number] = Some(worker());
            }
            if hit == number + 2 || hit == 4 {
                replicas[number].take().into_iter().for_each(Server::kill);
                replicas[number] = Some(replica(number));
            }
        }
    }
    let server = replicas[0].as_ref().expect("a replica");
    for (recipe, id) in &acknowledged {
        let job = server.finished(id);
        assert_eq!(job["state"], "done", "{job:#}");
        let expected = run_with_stdin(folder.path(), ["fit", "-", "-o", "fitted"], recipe).exited(0);
        assert_eq!(job["table"], expected.last_line());
    }
    assert_eq!(acknowledged.len(), kills);
    assert_eq!(database.psql(&name, "SELECT count(*) FROM refitted"), "0", "a finished shard was fitted again");
    let small = run_with_stdin(folder.path(), ["fit", "-", "-o", "fitted"], SMALL).exited(0);
    assert_eq!(server.fit(SMALL), small.last_line());
}
