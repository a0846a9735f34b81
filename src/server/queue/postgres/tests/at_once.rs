//! Leases at the same time, each in a transaction that has not been committed when the next one looks.

use std::{num::NonZeroUsize, thread, time::Duration};

use deadpool_postgres::Transaction;
use tokio_postgres::Error;

use super::{new, queues};
use crate::{
    queue::{
        Demand, Offer, Queue as _, SUSPECT_DEATHS,
        postgres::{PostgresQueue, lease::LEASE},
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

/// The tasks that each of `times` leases of up to `most` gets while none of them is committed. All are committed
/// afterwards.
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
fn leases_at_once_have_tasks_of_their_own_and_jobs_are_served_in_turns() {
    let Some(queues) = queues(1, LEASE_TTL) else { return };
    let queue = &queues[0];
    for n in 0..40 {
        submit(queue, &n.to_string(), 20);
    }
    // All see the same four jobs with the fewest leased tasks.
    for round in 0..10 {
        let got = leases(&queue.database, 8, 4);
        assert!(got.iter().all(|tasks| tasks.len() == 4), "round {round}: {got:?}");
    }
    let counts = "SELECT count(*) FROM ltcforge.tasks WHERE state = 'leased' GROUP BY submission";
    let counts = queue.database.run(async |client| Ok(client.query(counts, &[]).await?)).unwrap();
    let counts: Vec<i64> = counts.iter().map(|row| row.get(0)).collect();
    assert_eq!(counts, [8; 40]);
}

#[test]
fn leases_at_once_serve_a_new_job_until_it_has_as_many_as_the_others() {
    let Some(queues) = queues(1, LEASE_TTL) else { return };
    let queue = &queues[0];
    submit(queue, "long", 300);
    let long = leases(&queue.database, 1, 3).remove(0);
    submit(queue, "new", 300);
    let got = leases(&queue.database, 3, 1);
    assert!(got.iter().all(|tasks| tasks.len() == 1 && tasks[0] != long[0]), "{long:?} {got:?}");
    // Both have three now, and the long one was served longest ago.
    assert_eq!(leases(&queue.database, 1, 1)[0], [long[0]]);
}

#[test]
fn a_lease_waits_a_moment_for_tasks_that_another_lease_has_locked() {
    let Some(queues) = queues(1, LEASE_TTL) else { return };
    let queue = &queues[0];
    submit(queue, "a", 3);
    let all = NonZeroUsize::new(9).unwrap();
    queue.database.block_on(async {
        let mut client = queue.database.client().await.unwrap();
        let transaction = client.transaction().await.unwrap();
        assert_eq!(lease(&transaction, 9).await.unwrap().len(), 3);
        thread::scope(|scope| {
            let leased = scope.spawn(|| queue.lease(Demand::Any, all));
            assert!(matches!(leased.join().unwrap(), Offer::Nothing { .. }));
        });
        transaction.rollback().await.unwrap();
    });
    let Offer::Tasks(tasks) = queue.lease(Demand::Any, all) else { panic!("no tasks") };
    assert_eq!(tasks.len(), 3);
}
