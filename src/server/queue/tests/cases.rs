//! Test cases for both queues.

use std::{collections::BTreeMap, time::Duration};

use super::world::{FITTER, LIMITS, World, complete, lease, new_job, result, submit};
use crate::{
    queue::{
        Depth, Failure, FailureKind, JobState, LeaseError, Limits, Queue, QueueError, Release, Shard, StateName,
        Submitted, TaskKind,
    },
    store::Batch,
};
use ltcforge_files::digest::Digest;

/// Runs all tasks of the first job. Returns the digest of its table.
fn make_table(queue: &dyn Queue) -> Digest {
    loop {
        let task = lease(queue, 1).pop().unwrap();
        if task.kind == TaskKind::Assemble {
            let table = Digest::of(task.recipe.as_bytes());
            queue.results(&task.lease).unwrap();
            queue.finish(&task.lease, table, Batch::default()).unwrap();
            return table;
        }
        complete(queue, &[task]);
    }
}

pub(super) fn a_small_job_among_long_ones_is_leased_next_and_long_ones_share_evenly<W: World>() {
    let Some(world) = W::new(LIMITS) else { return };
    for n in 0..32 {
        submit(world.queue(), new_job(&format!("long {n}"), 20, 1.0));
    }
    let mut done = BTreeMap::new();
    let mut running = lease(world.queue(), 4);
    for step in 0..150 {
        if step % 50 == 20 {
            let small = submit(world.queue(), new_job(&format!("small {step}"), 1, 0.01));
            complete(world.queue(), &running);
            running = lease(world.queue(), 4);
            assert!(running.iter().any(|task| task.job == small), "{running:?}");
        }
        complete(world.queue(), &running);
        for task in running.iter().filter(|task| task.recipe.starts_with("long")) {
            *done.entry(task.job).or_insert(0) += 1;
        }
        let (least, most) = (done.values().min().unwrap(), done.values().max().unwrap());
        assert!(done.len() < 32 || most - least <= 2, "{done:?}");
        world.pass(1);
        running = lease(world.queue(), 4);
        while let Some(at) = running.iter().position(|task| task.kind == TaskKind::Assemble) {
            let task = running.remove(at);
            world.queue().finish(&task.lease, Digest::of(b""), Batch::default()).unwrap();
        }
    }
}

pub(super) fn under_an_endless_flood_of_small_jobs_a_long_one_goes_on<W: World>() {
    let Some(world) = W::new(LIMITS) else { return };
    let long = submit(world.queue(), new_job("long", 10, 0.2));
    let (mut leases, mut flood) = (0, 0);
    while leases < 3 {
        // New jobs arrive faster than one worker can fit them, because each job takes two leases.
        flood += 1;
        submit(world.queue(), new_job(&format!("small {flood}"), 1, 0.01));
        world.pass(1);
        let tasks = lease(world.queue(), 1);
        leases += usize::from(tasks[0].job == long);
        if tasks[0].kind == TaskKind::Assemble {
            world.queue().finish(&tasks[0].lease, Digest::of(b""), Batch::default()).unwrap();
        } else {
            complete(world.queue(), &tasks);
        }
        assert!(flood < 500, "{leases}");
    }
}

pub(super) fn a_task_fails_its_job_after_five_failures_or_twenty_five_leases<W: World>() {
    let Some(world) = W::new(LIMITS) else { return };
    let id = submit(world.queue(), new_job("a", 1, 1.0));
    for n in 1..=5 {
        for _ in 0..30 {
            let task = lease(world.queue(), 1).pop().unwrap();
            world.queue().release(&task.lease, Release::GiveBack).unwrap();
        }
        let task = lease(world.queue(), 1).pop().unwrap();
        assert_eq!(world.queue().job(id).unwrap().unwrap().attempts, n);
        world.queue().release(&task.lease, Release::Failed("no\0pe".to_owned())).unwrap();
        assert!(matches!(world.queue().release(&task.lease, Release::GiveBack), Err(LeaseError::Stale(_))));
    }
    let job = world.queue().job(id).unwrap().unwrap();
    let JobState::Failed { error } = &job.state else { panic!("{job:?}") };
    assert_eq!(error.kind, FailureKind::Attempts);
    assert_eq!(error.detail, "shard 0 failed 5 times; the last error: no\0pe");
    assert_eq!(job.attempts, 5);
    assert!(job.finished_at.is_some() && job.started_at.is_some());
    submit(world.queue(), new_job("a", 1, 1.0));
    for n in 1..=25 {
        assert_eq!(
            world.queue().job(id).unwrap().unwrap().state.name(),
            if n == 1 { StateName::Queued } else { StateName::Running }
        );
        assert_eq!(lease(world.queue(), 1).len(), 1);
        world.pass(10);
        world.queue().renew(&[]).unwrap();
    }
    let job = world.queue().job(id).unwrap().unwrap();
    let JobState::Failed { error } = job.state else { panic!("{job:?}") };
    assert_eq!(error.detail, "shard 0 was leased 25 times without a result");
    // Jobs of another fitter version are not leased.
    if W::LEASES_SURVIVE {
        submit(world.queue(), crate::queue::NewJob { fitter: FITTER + 1, ..new_job("other", 1, 1.0) });
        assert!(lease(world.queue(), 9).is_empty());
    }
    // A failure ends the whole job.
    let id = submit(world.queue(), new_job("b", 2, 1.0));
    let task = lease(world.queue(), 1).pop().unwrap();
    let failure = Failure { kind: FailureKind::Storage, detail: "x".to_owned() };
    world.queue().release(&task.lease, Release::Abort(failure.clone())).unwrap();
    assert_eq!(world.queue().job(id).unwrap().unwrap().state, JobState::Failed { error: failure });
    assert!(lease(world.queue(), 1).is_empty());
}

pub(super) fn a_failed_job_keeps_its_finished_shards_if_its_shards_are_the_same<W: World>() {
    let Some(mut world) = W::new(LIMITS) else { return };
    let fail = |queue: &dyn Queue| {
        complete(queue, &lease(queue, 2));
        let task = lease(queue, 1).pop().unwrap();
        let failure = Failure { kind: FailureKind::Storage, detail: "x".to_owned() };
        queue.release(&task.lease, Release::Abort(failure)).unwrap();
    };
    let id = submit(world.queue(), new_job("a", 3, 1.0));
    fail(world.queue());
    assert_eq!(world.results(), 2);
    world.restart(LIMITS);
    submit(world.queue(), new_job("a", 3, 2.0));
    assert_eq!(world.queue().job(id).unwrap().unwrap().entries_done, 4);
    let task = lease(world.queue(), 3).pop().unwrap();
    assert_eq!(task.kind, TaskKind::Shard(2));
    complete(world.queue(), &[task]);
    assert_eq!(world.queue().results(&lease(world.queue(), 1)[0].lease).unwrap().len(), 3);
    world.queue().cancel(id, Some("bob")).unwrap();
    assert_eq!(world.queue().job(id).unwrap().unwrap().cancelled_by.unwrap(), "bob");
    assert_eq!(world.results(), 0);
    submit(world.queue(), new_job("a", 3, 1.0));
    fail(world.queue());
    let mut others = new_job("a", 3, 1.0);
    others.shards.insert(0, Shard { entries: 1, seconds: 1.0 });
    submit(world.queue(), others);
    assert_eq!(world.results(), 0);
    assert_eq!(lease(world.queue(), 9).len(), 4);
}

pub(super) fn lost_results_are_fitted_again<W: World>() {
    let Some(world) = W::new(LIMITS) else { return };
    let id = submit(world.queue(), new_job("a", 3, 1.0));
    complete(world.queue(), &lease(world.queue(), 3));
    world.lose(id, 1);
    let assembly = lease(world.queue(), 9).pop().unwrap();
    assert!(matches!(world.queue().results(&assembly.lease), Err(LeaseError::Lost(1))));
    assert!(matches!(world.queue().results(&assembly.lease), Err(LeaseError::Stale(_))));
    let again = lease(world.queue(), 9);
    assert_eq!((again.len(), again[0].kind), (1, TaskKind::Shard(1)));
    complete(world.queue(), &again);
    let assembly = lease(world.queue(), 9).pop().unwrap();
    assert_eq!(world.queue().results(&assembly.lease).unwrap()[1], result(&again[0]).into_bytes());
}

pub(super) fn a_suspended_process_keeps_its_leases<W: World>() {
    let Some(world) = W::new(LIMITS) else { return };
    let id = submit(world.queue(), new_job("a", 1, 1.0));
    for _ in 0..2 {
        let task = lease(world.queue(), 1).pop().unwrap();
        for _ in 0..3 {
            // After a pause that is longer than a lease, an idle worker may ask for a task before leases are renewed.
            world.pass(100);
            assert!(lease(world.queue(), 1).is_empty());
            assert_eq!(world.queue().renew(&[(task.lease, 0)]).unwrap(), [Ok(())]);
        }
        assert_eq!((world.queue().job(id).unwrap().unwrap().attempts, world.queue().failures()), (1, (0, 0)));
        match task.kind {
            TaskKind::Shard(_) => complete(world.queue(), &[task]),
            TaskKind::Assemble => world.queue().finish(&task.lease, Digest::of(b""), Batch::default()).unwrap(),
        }
    }
    assert_eq!(world.queue().job(id).unwrap().unwrap().attempts, 1);
}

pub(super) fn statistics_and_pages_agree_with_the_jobs<W: World>() {
    let Some(world) = W::new(Limits { jobs: 4, ..LIMITS }) else { return };
    let ids: Vec<_> = (0..4).map(|n| submit(world.queue(), new_job(&n.to_string(), 2, 1.5))).collect();
    let full = world.queue().submit(new_job("x", 1, 1.0), &|_| true);
    assert!(matches!(full, Err(QueueError::Full(4))));
    assert!(matches!(world.queue().submit(new_job("3", 2, 1.5), &|_| true), Ok(Submitted::Joined(_))));
    world.queue().cancel(ids[1], None).unwrap();
    let tasks = lease(world.queue(), 2);
    assert_eq!(tasks.iter().map(|task| task.job).collect::<Vec<_>>(), [ids[0], ids[2]]);
    complete(world.queue(), &tasks[..1]);
    assert_eq!(
        world.queue().renew(&[(tasks[1].lease, 1), (tasks[0].lease, 1)]).unwrap(),
        [Ok(()), Err(crate::queue::StaleLease)]
    );
    let statistics = world.queue().statistics().unwrap();
    let count = |name| statistics.jobs.iter().find(|(of, _)| *of == name).unwrap().1;
    assert_eq!(StateName::ALL.map(count), [1, 2, 0, 0, 1]);
    assert_eq!(statistics.depth, Depth { waiting: 4, leased: 1 });
    assert!((statistics.core_seconds - 7.5).abs() < 1e-9);
    assert_eq!(statistics.oldest, Some(world.queue().job(ids[0]).unwrap().unwrap().created_at));
    assert_eq!(world.queue().job(ids[2]).unwrap().unwrap().entries_done, 1);
    assert_eq!(world.queue().failures(), (0, 0));
    let (mut seen, mut before) = (vec![], None);
    loop {
        let (page, next) = world.queue().list(None, before, 3).unwrap();
        seen.extend(page.into_iter().map(|job| job.id));
        before = next;
        if next.is_none() {
            break;
        }
    }
    assert_eq!(seen, ids.iter().rev().copied().collect::<Vec<_>>());
    let (page, next) = world.queue().list(Some(StateName::Running), None, 2).unwrap();
    assert_eq!((page.len(), page[0].id, next), (2, ids[2], None));
}

pub(super) fn a_job_is_found_by_its_table_until_it_is_forgotten<W: World>() {
    let limits = Limits { keep_ended: Some(Duration::from_secs(100)), most_ended: Some(2), ..LIMITS };
    let Some(mut world) = W::new(limits) else { return };
    let mut tables = vec![];
    for n in 0..3 {
        submit(world.queue(), new_job(&n.to_string(), 300, 1.0));
        tables.push(make_table(world.queue()));
        world.pass(1);
    }
    let known =
        |world: &W| tables.iter().filter(|table| world.queue().job_of_table(**table).unwrap().is_some()).count();
    assert_eq!(known(&world), 3);
    let done = world.queue().submit(new_job("2", 300, 1.0), &|table| table == tables[2]).unwrap();
    assert!(matches!(done, Submitted::Done(job, table) if table == tables[2] && job.entries_done == 600));
    let id = submit(world.queue(), new_job("x", 1, 1.0));
    assert_eq!(known(&world), 2);
    assert!(world.queue().job_of_table(tables[0]).unwrap().is_none());
    world.queue().cancel(id, None).unwrap();
    world.pass(200);
    world.restart(limits);
    submit(world.queue(), new_job("y", 1, 1.0));
    assert_eq!(known(&world), 0);
    assert_eq!(world.results(), 0);
    assert_eq!(world.queue().list(None, None, 9).unwrap().0.len(), 1);
}

pub(super) fn waiting_ends_when_the_queue_is_closed<W: World>() {
    let Some(world) = W::new(LIMITS) else { return };
    assert!(world.queue().wait(Duration::from_millis(1)));
    let queue = world.queue();
    submit(queue, new_job("a", 1, 1.0));
    std::thread::scope(|scope| {
        let waiting = scope.spawn(|| {
            while queue.wait(Duration::from_secs(60)) {
                lease(queue, 1);
            }
        });
        queue.close();
        waiting.join().unwrap();
    });
    assert!(lease(queue, 1).is_empty());
}
