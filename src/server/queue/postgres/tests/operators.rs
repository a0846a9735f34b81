//! A database that its operator restores, or takes rights away from.

use std::{num::NonZeroU32, sync::atomic::Ordering, time::Duration};

use super::{execute, lease, new, queues};
use crate::{
    queue::{
        Failure, FailureKind, LeaseError, Limits, Queue as _, StaleLease,
        postgres::{PostgresQueue, held, queue::back_off},
        tests::world::results,
    },
    store::{Batch, Database, throwaway},
};
use ltcforge_files::digest::Digest;

/// A restored database gives the numbers of submissions and attempts again, to other jobs.
#[test]
fn a_lease_from_before_the_database_was_restored_is_refused() {
    let Some(queues) = queues(2, Duration::from_secs(600)) else { return };
    let [late, other] = &queues[..] else { panic!("two") };
    let leased = |queue: &PostgresQueue, name: &str, is_assembly: bool| {
        queue.submit(new(name, 1), &|_| false).unwrap();
        let shard = lease(queue).unwrap();
        if !is_assembly {
            return shard;
        }
        assert_eq!(queue.complete(&[(shard.lease, b"result")]).unwrap(), [Ok(())]);
        lease(queue).unwrap()
    };
    for is_assembly in [false, true] {
        let lost = leased(late, "lost", is_assembly);
        // The backup is of the empty database.
        let restore = "TRUNCATE ltcforge.jobs, ltcforge.tasks, ltcforge.blocks, ltcforge.serving,
            ltcforge.finished_entries; ALTER SEQUENCE ltcforge.submissions RESTART";
        execute(other, restore);
        let current = leased(other, "new", is_assembly);
        assert_eq!((lost.lease.submission, lost.lease.task), (current.lease.submission, current.lease.task));
        let held = [(lost.lease, 1)];
        let renewed = held::renew(&late.database, &late.process, &held, Duration::from_secs(1)).unwrap();
        assert!(renewed.is_empty(), "{renewed:?}");
        assert_eq!(late.complete(&[(lost.lease, b"late")]).unwrap(), [Err(StaleLease)]);
        assert!(!is_assembly || matches!(results(late, &lost.lease), Err(LeaseError::Stale(_))));
        let finished = late.finish(&lost.lease, Digest::of(b"lost"), Batch::default());
        assert!(matches!(finished, Err(LeaseError::Stale(_))));
        let failure = Failure { kind: FailureKind::Attempts, detail: "late".to_owned() };
        let answers = [late.give_back(&lost.lease), late.fail(&lost.lease, "late"), late.abort(&lost.lease, failure)];
        assert_eq!(answers, [Err(StaleLease); 3]);
        if is_assembly {
            other.finish(&current.lease, Digest::of(b"new"), Batch::default()).unwrap();
        } else {
            assert_eq!(other.complete(&[(current.lease, b"in time")]).unwrap(), [Ok(())]);
        }
        execute(other, restore);
    }
}

#[test]
fn a_worker_without_rights_waits_longer_each_time_and_goes_on_once_it_has_them() {
    let Some(url) = throwaway::empty_database() else { return };
    let open = |url: &str| {
        let (lease_ttl, max_attempts) = (Duration::from_secs(600), NonZeroU32::MIN);
        let limits = Limits { jobs: 9, lease_ttl, max_attempts, keep_ended: None, most_ended: None };
        PostgresQueue::open_eager(Database::open(url).unwrap(), limits)
    };
    let (owner, role) = (open(&url), format!("worker{}", std::process::id()));
    execute(
        &owner,
        &format!(
            "CREATE ROLE {role} LOGIN; GRANT USAGE ON SCHEMA ltcforge TO {role};
            GRANT SELECT ON ALL TABLES IN SCHEMA ltcforge TO {role}"
        ),
    );
    owner.submit(new("a", 1), &|_| false).unwrap();
    let queue = open(&url.replace("postgres@", &format!("{role}@")));
    for refusals in 1..3 {
        assert_eq!(lease(&queue), None);
        assert_eq!(queue.refusals.load(Ordering::Relaxed), refusals);
    }
    assert!(queue.fault().unwrap().contains("may not write"));
    execute(
        &owner,
        &format!(
            "GRANT INSERT, UPDATE, DELETE ON ALL TABLES IN SCHEMA ltcforge TO {role};
            GRANT USAGE ON ALL SEQUENCES IN SCHEMA ltcforge TO {role}"
        ),
    );
    assert!(lease(&queue).is_some());
    assert_eq!(queue.refusals.load(Ordering::Relaxed), 0);
    let waits: Vec<u64> = (0..9).map(|refusals| back_off(refusals).as_secs()).collect();
    assert_eq!(waits, [1, 2, 4, 8, 16, 32, 64, 64, 64]);
}
