//! Leases at the same time, each in a transaction that has not been committed when the next one looks.

use std::{collections::BTreeSet, num::NonZeroUsize, thread, time::Duration};

use deadpool_postgres::Transaction;
use tokio_postgres::Error;

use super::{eventually, new, queues};
use crate::{
    queue::{
        Demand, Offer, Queue as _, SUSPECT_DEATHS,
        postgres::{PostgresQueue, gate, lease::LEASE},
    },
    store::Database,
};

const LEASE_TTL: Duration = Duration::from_secs(60);

/// The submissions of up to `most` tasks, which are leased in one statement.
async fn lease(transaction: &Transaction<'_>, most: i64) -> Result<Vec<i64>, Error> {
    let statement = transaction.prepare_cached(&LEASE).await?;
    let suspect = SUSPECT_DEATHS.cast_signed();
    let rows =
        transaction.query(&statement, &[&1_i32, &most, &LEASE_TTL.as_secs_f64(), &"test", &false, &suspect]).await?;
    Ok(rows.iter().filter_map(|row| row.get("submission")).collect())
}

/// What `times` leases of `most` tasks each get while none is committed; they are afterwards.
fn leases(database: &Database, times: usize, most: i64) -> Vec<Vec<i64>> {
    database.block_on(async {
        let (mut clients, mut open, mut got) = (vec![], vec![], vec![]);
        for _ in 0..times {
            clients.push(database.client().await.unwrap());
        }
        for client in &mut clients {
            let transaction = client.transaction().await.unwrap();
            got.push(lease(&transaction, most).await.unwrap());
            open.push(transaction);
        }
        for transaction in open {
            transaction.commit().await.unwrap();
        }
        got
    })
}

fn submit(queue: &PostgresQueue, name: &str, shards: usize) {
    queue.submit(new(name, shards), &|_| false).unwrap();
}

#[test]
fn leases_at_once_have_jobs_of_their_own_when_there_are_many() {
    let Some(queues) = queues(1, LEASE_TTL) else { return };
    let queue = &queues[0];
    for n in 0..40 {
        submit(queue, &n.to_string(), 20);
    }
    // At first nobody works for any, then somebody for most, then for all, of some more than of others.
    for round in 0..4 {
        let got = leases(&queue.shared.database, 8, 4);
        assert!(got.iter().all(|tasks| tasks.len() == 4), "round {round}: {got:?}");
        let jobs: BTreeSet<i64> = got.iter().flatten().copied().collect();
        assert_eq!(jobs.len(), 32, "round {round}: {got:?}");
    }
    let counts = "SELECT count(*) FROM ltcforge.tasks WHERE state = 'leased' GROUP BY submission";
    let counts = queue.shared.database.run(async |client| client.query(counts, &[]).await).unwrap();
    let counts: Vec<i64> = counts.iter().map(|row| row.get(0)).collect();
    assert_eq!((counts.len(), counts.iter().sum::<i64>()), (40, 128));
    assert!(counts.iter().all(|count| (3..=4).contains(count)), "{counts:?}");
}

#[test]
fn a_lease_shares_the_job_of_another_lease_before_one_that_has_more() {
    let Some(queues) = queues(1, LEASE_TTL) else { return };
    let queue = &queues[0];
    submit(queue, "long", 300);
    let long = leases(&queue.shared.database, 1, 3).remove(0);
    // Its shards are in several rows, of which each lease locks one.
    submit(queue, "new", 300);
    let got = leases(&queue.shared.database, 3, 1);
    assert!(got.iter().all(|tasks| tasks.len() == 1 && tasks[0] != long[0]), "{long:?} {got:?}");
    // The last one has as many as the other one then, and the longest ago served is next.
    assert_eq!(leases(&queue.shared.database, 1, 1)[0], [long[0]]);
}

#[test]
fn a_lease_of_many_tasks_waits_for_its_turn_and_not_for_ever() {
    let Some(queues) = queues(1, LEASE_TTL) else { return };
    let queue = &queues[0];
    submit(queue, "a", 20);
    let many = NonZeroUsize::new(usize::try_from(gate::MANY).unwrap()).unwrap();
    let database = &queue.shared.database;
    let others = database.block_on(database.client()).unwrap();
    let (gate, last) = (gate::GATE, gate::PLACES - 1);
    let enter = format!("BEGIN; SELECT pg_advisory_xact_lock({gate}, place) FROM generate_series(0, {last}) AS place");
    database.block_on(others.batch_execute(&enter)).unwrap();
    thread::scope(|scope| {
        let leased = scope.spawn(|| queue.lease(0, Demand::Any, many));
        let waits = "SELECT FROM pg_locks WHERE locktype = 'advisory' AND NOT granted
            AND database = (SELECT oid FROM pg_database WHERE datname = current_database())";
        eventually(|| database.run(async |client| client.query_opt(waits, &[]).await).unwrap());
        assert!(matches!(leased.join().unwrap(), Offer::Tasks(_)));
    });
    database.block_on(others.batch_execute("ROLLBACK")).unwrap();
    assert!(matches!(queue.lease(0, Demand::Any, many), Offer::Tasks(_)));
    let open = "SELECT FROM pg_stat_activity WHERE datname = current_database() AND state LIKE 'idle in transaction%'";
    let open = database.run(async |client| client.query(open, &[]).await).unwrap();
    assert!(open.is_empty(), "a transaction was left open");
}
