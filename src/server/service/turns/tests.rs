use std::{num::NonZeroU32, sync::Arc};

use super::*;
use crate::{
    queue::{Lease, Limits, NewJob, Queue as _, embedded::EmbeddedQueue},
    store::memory::MemoryRows,
};
use ltcforge_files::digest::Digest;

/// The shards of a job, leased.
fn shards(count: usize) -> Vec<LeasedTask> {
    let limits = Limits {
        jobs: 1,
        lease_ttl: Duration::from_secs(60),
        max_attempts: NonZeroU32::new(3).unwrap(),
        keep_ended: None,
    };
    let clock = Arc::new(|| jiff::Timestamp::UNIX_EPOCH);
    let queue = EmbeddedQueue::open(Arc::new(MemoryRows::default()), limits, clock).unwrap();
    let recipe_digest = Digest::of(b"recipe");
    let new = NewJob { recipe: "recipe".to_owned(), recipe_digest, shard_entries: vec![1; count] };
    queue.submit(new, &|_| false).unwrap();
    match queue.lease(0, Demand::Any, NonZeroUsize::new(count).unwrap()) {
        Offer::Tasks(tasks) => tasks,
        other => panic!("{other:?}"),
    }
}

/// Takes shards in and ends them, so that their results wait; returns their leases.
fn end_all(turns: &Turns, tasks: &[LeasedTask]) -> Vec<Lease> {
    let taken: Vec<_> = tasks
        .iter()
        .map(|_| match turns.ask(|_, _| Offer::Tasks(tasks.to_vec()), |_| ()) {
            Some(Asked::Task(task)) => task,
            other => panic!("{other:?}"),
        })
        .collect();
    for task in taken {
        let mut turn = turns.begin(task.job, &mut || ());
        assert!(turn.end(Duration::ZERO, ShardResult { task, bytes: vec![1] }).is_none());
    }
    tasks.iter().map(|task| task.lease).collect()
}

/// Nobody works on a result that waits for the disk, and its lease must not end for that.
#[test]
fn leases_of_results_that_wait_are_renewed_until_a_thread_has_them() {
    let turns = Turns::new(2, Duration::ZERO);
    let renewed = || {
        let mut leases = Vec::new();
        turns.renew_held(|task| leases.push(task.lease));
        leases
    };
    let leases = end_all(&turns, &shards(2));
    assert_eq!(renewed(), leases);
    let ask = || turns.ask(|_, _| Offer::Closed, |_| ());
    assert!(matches!(ask(), Some(Asked::Result(result)) if result.task.lease == leases[0]));
    assert_eq!(renewed(), leases[1..]);
    assert!(matches!(ask(), Some(Asked::Result(_))));
    assert_eq!(renewed(), []);
    assert!(ask().is_none());
}

#[test]
fn leases_are_not_renewed_before_they_are_due() {
    let turns = Turns::new(1, Duration::from_secs(3600));
    end_all(&turns, &shards(1));
    turns.renew_held(|task| panic!("{task:?}"));
}
