//! Several processes on one queue. The tests of every queue are [`crate::queue`]'s.

use std::{
    num::{NonZeroU32, NonZeroUsize},
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use super::{PostgresQueue, Process};
use crate::{
    queue::{
        Demand, JobId, JobState, LeaseError, LeasedTask, Limits, NewJob, Offer, Queue as _, StaleLease, Submitted,
        TaskKind, tests::world::results,
    },
    store::{Batch, Database, throwaway},
};
use ltcforge_files::digest::Digest;

mod at_once;
mod indexes;
mod operators;

/// How long a condition may take to come true. It only ends a test that hangs.
const DEADLINE: Duration = Duration::from_secs(60);

fn eventually<T>(mut look: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(start.elapsed() < DEADLINE);
        thread::sleep(Duration::from_millis(5));
    }
}

/// Queues as `processes` have them, on one database.
fn queues(processes: usize, lease_ttl: Duration) -> Option<Vec<PostgresQueue>> {
    let url = throwaway::empty_database()?;
    let limits =
        Limits { jobs: 999, lease_ttl, max_attempts: NonZeroU32::new(9).unwrap(), keep_ended: None, most_ended: None };
    let open = |n: usize| {
        let process = Process { name: n.to_string(), fitter: 1 };
        PostgresQueue::open(Database::open(&url).unwrap(), limits, process).unwrap()
    };
    Some((0..processes).map(open).collect())
}

fn new(name: &str, shards: usize) -> NewJob {
    NewJob {
        recipe: name.to_owned(),
        recipe_digest: Digest::of(name.as_bytes()),
        shard_entries: vec![1; shards],
        by: None,
    }
}

fn lease(queue: &PostgresQueue) -> Option<LeasedTask> {
    match queue.lease(Demand::Any, NonZeroUsize::MIN) {
        Offer::Tasks(mut tasks) => tasks.pop(),
        Offer::Nothing { .. } | Offer::Closed => None,
    }
}

#[test]
fn equal_recipes_at_once_make_one_job() {
    let Some(queues) = queues(2, Duration::from_secs(60)) else { return };
    for n in 0..100 {
        let queued = AtomicUsize::new(0);
        let barrier = std::sync::Barrier::new(queues.len());
        thread::scope(|scope| {
            for queue in &queues {
                scope.spawn(|| {
                    barrier.wait();
                    match queue.submit(new(&n.to_string(), 3), &|_| false).unwrap() {
                        Submitted::Queued(_) => drop(queued.fetch_add(1, Ordering::Relaxed)),
                        Submitted::Joined(_) => {}
                        other @ Submitted::Done(..) => panic!("{other:?}"),
                    }
                });
            }
        });
        assert_eq!(queued.into_inner(), 1);
    }
    assert_eq!(queues[0].list(None, None, 999).unwrap().0.len(), 100);
}

#[test]
fn a_result_that_comes_after_its_lease_is_refused() {
    let Some(queues) = queues(2, Duration::from_secs(1)) else { return };
    let [late, other] = &queues[..] else { panic!("two") };
    late.submit(new("a", 1), &|_| false).unwrap();
    let lost = lease(late).unwrap();
    // Nobody reports on it, so that it expires.
    let again = eventually(|| lease(other));
    assert_eq!(again.kind, lost.kind);
    assert_eq!(late.complete(&[(lost.lease, b"late")]).unwrap(), [Err(StaleLease)]);
    assert_eq!(late.give_back(&lost.lease), Err(StaleLease));
    assert_eq!(late.fail(&lost.lease, "late"), Err(StaleLease));
    assert_eq!(other.complete(&[(again.lease, b"in time")]).unwrap(), [Ok(())]);
    let assembly = eventually(|| lease(other));
    assert_eq!(results(other, &assembly.lease).unwrap().unwrap(), [b"in time"]);
    assert_eq!(other.failures(), (1, 1));
}

#[test]
fn a_worker_that_reports_keeps_its_lease_and_hears_of_a_cancel_elsewhere() {
    let Some(queues) = queues(2, Duration::from_secs(1)) else { return };
    let [worker, other] = &queues[..] else { panic!("two") };
    worker.submit(new("a", 1), &|_| false).unwrap();
    let task = lease(worker).unwrap();
    let end = Instant::now() + Duration::from_secs(3);
    while Instant::now() < end {
        worker.progress(&task.lease, 1).unwrap();
        assert_eq!(lease(other), None);
        thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(other.job(task.job).unwrap().unwrap().entries_done, 1);
    other.cancel(task.job, None).unwrap();
    eventually(|| worker.progress(&task.lease, 1).err());
    assert!(worker.take_changed().contains(&task.job));
    assert_eq!(worker.complete(&[(task.lease, b"late")]).unwrap(), [Err(StaleLease)]);
}

#[test]
fn another_fitter_leaves_the_job_alone() {
    let Some(url) = throwaway::empty_database() else { return };
    let limits = Limits {
        jobs: 9,
        lease_ttl: Duration::from_secs(60),
        max_attempts: NonZeroU32::MIN,
        keep_ended: None,
        most_ended: None,
    };
    let of = |fitter| {
        let process = Process { name: "test".to_owned(), fitter };
        PostgresQueue::open(Database::open(&url).unwrap(), limits, process).unwrap()
    };
    let (old, new_one) = (of(1), of(2));
    old.submit(new("a", 1), &|_| false).unwrap();
    assert_eq!(lease(&new_one), None);
    assert!(lease(&old).is_some());
}

fn execute(queue: &PostgresQueue, statement: &str) {
    queue.database.run(async |client| Ok(client.batch_execute(statement).await?)).unwrap();
}

#[test]
fn suspect_shards_run_one_at_a_time_beside_all_others() {
    let Some(queues) = queues(1, Duration::from_secs(60)) else { return };
    let queue = &queues[0];
    queue.submit(new("a", 3), &|_| false).unwrap();
    execute(queue, "UPDATE ltcforge.tasks SET deaths = 3 WHERE task < 2");
    let Offer::Tasks(tasks) = queue.lease(Demand::Any, NonZeroUsize::new(9).unwrap()) else { panic!("no tasks") };
    assert_eq!(tasks.iter().map(|task| task.kind).collect::<Vec<_>>(), [TaskKind::Shard(0), TaskKind::Shard(2)]);
    assert_eq!(lease(queue), None, "shard 1 is suspect too");
    queue.submit(new("b", 1), &|_| false).unwrap();
    assert_eq!(lease(queue).unwrap().recipe, "b", "another job goes on");
    queue.complete(&[(tasks[0].lease, b"result")]).unwrap();
    assert_eq!(lease(queue).unwrap().kind, TaskKind::Shard(1));
}

#[test]
fn a_shard_that_ends_its_worker_each_time_fails_its_job_in_the_end() {
    let Some(queues) = queues(1, Duration::from_secs(1)) else { return };
    let queue = &queues[0];
    queue.submit(new("a", 2), &|_| false).unwrap();
    execute(queue, "UPDATE ltcforge.tasks SET deaths = 19 WHERE task = 1");
    lease(queue).unwrap();
    let deadly = lease(queue).unwrap();
    let job = eventually(|| {
        lease(queue);
        queue.job(deadly.job).unwrap().filter(|job| job.state.name().is_final())
    });
    let JobState::Failed { error } = job.state else { panic!("{job:?}") };
    assert_eq!(error.detail, "shard 1 was leased 20 times by workers that stopped reporting");
}

/// All tasks that can be leased, in order.
fn lease_all(queue: &PostgresQueue) -> Vec<LeasedTask> {
    let mut tasks = vec![];
    while let Offer::Tasks(more) = queue.lease(Demand::Any, NonZeroUsize::new(256).unwrap()) {
        tasks.extend(more);
    }
    tasks.sort_by_key(|task| task.lease);
    tasks
}

fn eager_queue() -> Option<PostgresQueue> {
    let limits = Limits {
        jobs: 9,
        lease_ttl: Duration::from_secs(600),
        max_attempts: NonZeroU32::MIN,
        keep_ended: None,
        most_ended: None,
    };
    Some(PostgresQueue::open_eager(Database::open(&throwaway::empty_database()?).unwrap(), limits))
}

#[test]
fn a_large_job_gets_its_rows_as_it_goes_on() {
    let Some(queue) = eager_queue() else { return };
    queue.submit(new("large", 20_000), &|_| false).unwrap();
    let count = "SELECT count(*) FROM ltcforge.tasks";
    let rows = queue.database.run(async |client| Ok(client.query_one(count, &[]).await?.get::<_, i64>(0))).unwrap();
    assert_eq!(rows, 513, "8 blocks of 64 shards, and the assembly");
    let shards: Vec<TaskKind> = lease_all(&queue).into_iter().map(|task| task.kind).collect();
    assert_eq!(shards, (0..20_000).map(TaskKind::Shard).collect::<Vec<_>>());
}

/// Earlier versions made the row of a shard when it was leased, and took it off its block.
#[test]
fn a_job_that_an_earlier_version_began_goes_on() {
    let Some(queue) = eager_queue() else { return };
    queue.submit(new("a", 70), &|_| false).unwrap();
    execute(
        &queue,
        "DELETE FROM ltcforge.tasks WHERE NOT is_assembly;
        INSERT INTO ltcforge.blocks SELECT submission, 0, 4, 64, 1 FROM ltcforge.jobs;
        INSERT INTO ltcforge.blocks SELECT submission, 64, 64, 70, 1 FROM ltcforge.jobs;
        INSERT INTO ltcforge.tasks (submission, task, is_assembly, entries, state, attempt, worker, lease_until)
            SELECT submission, n, false, 1, 'leased', 1, 'ended', ltcforge.clock()
            FROM ltcforge.jobs, generate_series(0, 3) AS n;
        UPDATE ltcforge.tasks SET state = 'finished', worker = NULL, lease_until = NULL,
            result = substring(sha256('result') FOR 8) || 'result' WHERE task = 2;
        UPDATE ltcforge.finished_entries SET entries = 1;
        UPDATE ltcforge.jobs SET state = 'running', started_at = ltcforge.clock()",
    );
    let tasks = lease_all(&queue);
    assert_eq!(
        tasks.iter().map(|task| task.lease.task).collect::<Vec<_>>(),
        [0, 1].into_iter().chain(3..70).collect::<Vec<_>>()
    );
    let done: Vec<_> = tasks.iter().map(|task| (task.lease, b"result".as_slice())).collect();
    assert_eq!(queue.complete(&done).unwrap(), [Ok(()); 69]);
    let assembly = lease(&queue).unwrap();
    assert_eq!(results(&queue, &assembly.lease).unwrap().unwrap(), [b"result"; 70]);
    queue.finish(&assembly.lease, Digest::of(b"a"), Batch::default()).unwrap();
    let job = queue.job(assembly.job).unwrap().unwrap();
    assert_eq!((job.entries_done, job.attempts), (70, 2));
}

/// Works until all jobs are done; returns the shards that were completed, each as often as it was.
fn work(queue: &PostgresQueue, jobs: &[JobId], completed: &Mutex<Vec<(JobId, u32)>>) {
    eventually(|| {
        let Offer::Tasks(tasks) = queue.lease(Demand::Any, NonZeroUsize::new(3).unwrap()) else {
            let is_done = |id: &JobId| queue.job(*id).unwrap().is_some_and(|job| job.state.name().is_final());
            return jobs.iter().all(is_done).then_some(());
        };
        for task in tasks {
            match task.kind {
                TaskKind::Shard(shard) => {
                    let result = format!("{}/{shard}", task.recipe);
                    if queue.complete(&[(task.lease, result.as_bytes())]).unwrap() == [Ok(())] {
                        completed.lock().unwrap().push((task.job, shard));
                    }
                }
                TaskKind::Assemble => {
                    let Ok(Some(results)) = results(queue, &task.lease) else { continue };
                    let wanted = (0..40).map(|n| format!("{}/{n}", task.recipe).into_bytes());
                    assert_eq!(results, wanted.collect::<Vec<_>>());
                    match queue.finish(&task.lease, Digest::of(task.recipe.as_bytes()), Batch::default()) {
                        // Stale as well if it was committed and the answer got lost.
                        Ok(()) | Err(LeaseError::Stale(_)) => {}
                        Err(error) => panic!("{error}"),
                    }
                }
            }
        }
        None
    });
}

fn submit_ten(queue: &PostgresQueue) -> Vec<JobId> {
    let submit = |n: usize| {
        let job = new(&format!("job {n}"), 40);
        let id = JobId::of_recipe(&job.recipe_digest);
        queue.submit(job, &|_| false).unwrap();
        id
    };
    (0..10).map(submit).collect()
}

fn assert_all_done(queue: &PostgresQueue, jobs: &[JobId], completed: Mutex<Vec<(JobId, u32)>>) {
    let mut completed = completed.into_inner().unwrap();
    completed.sort_unstable();
    assert!(completed.windows(2).all(|pair| pair[0] != pair[1]), "a shard was completed twice");
    for id in jobs {
        let job = queue.job(*id).unwrap().unwrap();
        assert!(matches!(job.state, JobState::Done { .. }), "{job:?}");
        assert_eq!(job.entries_done, 40);
    }
}

#[test]
fn of_many_workers_each_shard_is_accepted_from_one() {
    let Some(queues) = queues(6, Duration::from_secs(60)) else { return };
    let jobs = submit_ten(&queues[0]);
    let completed = Mutex::default();
    thread::scope(|scope| queues.iter().for_each(|queue| drop(scope.spawn(|| work(queue, &jobs, &completed)))));
    assert_eq!(completed.lock().unwrap().len(), 400);
    assert_all_done(&queues[0], &jobs, completed);
}

#[test]
fn connections_that_are_cut_cost_no_job() {
    let Some(queues) = queues(3, Duration::from_secs(2)) else { return };
    let jobs = submit_ten(&queues[0]);
    let (completed, ended, cut) = (Mutex::default(), AtomicBool::new(false), AtomicUsize::new(0));
    thread::scope(|scope| {
        let workers: Vec<_> = queues.iter().map(|queue| scope.spawn(|| work(queue, &jobs, &completed))).collect();
        scope.spawn(|| {
            let database: &Arc<Database> = &queues[0].database;
            while !ended.load(Ordering::Relaxed) {
                // The oldest of the other connections.
                let done = database.run(async |client| {
                    let one =
                        "SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = current_database()
                        AND pid <> pg_backend_pid() ORDER BY query_start LIMIT 1";
                    Ok(client.query(one, &[]).await?)
                });
                cut.fetch_add(done.map_or(0, |rows| rows.len()), Ordering::Relaxed);
                // A statement needs some time between two cuts.
                thread::sleep(Duration::from_millis(25));
            }
        });
        let joined: Vec<_> = workers.into_iter().map(thread::ScopedJoinHandle::join).collect();
        ended.store(true, Ordering::Relaxed);
        for worker in joined {
            worker.unwrap();
        }
    });
    assert!(cut.into_inner() > 10);
    assert_all_done(&queues[0], &jobs, completed);
}
