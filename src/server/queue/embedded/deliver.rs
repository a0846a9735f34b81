//! Results that workers deliver under a lease.

use std::collections::BTreeMap;

use super::{
    record,
    state::EmbeddedQueue,
    task::{Task, TaskState},
};
use crate::{
    queue::{Lease, LeaseError, StaleLease},
    store::{Batch, StoreError, Tree},
};

impl EmbeddedQueue {
    /// The lock is not held while the disk is waited for, so that others lease and report meanwhile. Until then the
    /// tasks count as leased: nothing is assembled of results that a power cut may undo, and what takes a lease back
    /// in between writes its rows after these.
    pub(super) fn complete_shards(&self, done: &[(Lease, &[u8])]) -> Result<Vec<Result<(), StaleLease>>, StoreError> {
        let mut state = self.lock();
        let mut batch = Batch::default();
        let (mut answers, mut accepted) = (Vec::with_capacity(done.len()), BTreeMap::new());
        for (index, (lease, result)) in done.iter().enumerate() {
            let current = state.current(lease).ok();
            let current =
                current.filter(|(active, _)| lease.task != active.assembly() && !accepted.contains_key(lease));
            answers.push(current.map_or(Err(StaleLease), |_| Ok(())));
            let Some((active, task)) = current else { continue };
            let (id, finished) = (active.record.job.id, Task { state: TaskState::Finished, ..task });
            record::put_task(&mut batch, id, lease.task, &finished)?;
            batch.put(Tree::Results, record::task_key(id, lease.task), *result);
            accepted.insert(*lease, (index, finished));
        }
        if accepted.is_empty() {
            return Ok(answers);
        }
        if !state.unsaved.is_empty() {
            self.commit(&mut state, Batch::default())?;
        }
        let staged = self.rows.stage(&batch)?;
        let until = self.expiry();
        for lease in accepted.keys() {
            // It was current a moment ago.
            let _ = state.renew(lease, until);
        }
        drop(state);
        self.rows.settle(staged)?;
        let mut state = self.lock();
        for (lease, (index, finished)) in accepted {
            answers[index] = state.current(&lease).map(drop);
            if answers[index].is_ok() {
                self.set(&mut state, &lease, finished);
            }
        }
        Ok(answers)
    }

    pub(super) fn all_results(&self, lease: &Lease, take: &mut dyn FnMut(&[u8])) -> Result<bool, LeaseError> {
        let id = self.lock().current(lease)?.0.record.job.id;
        let mut lost = Vec::new();
        for shard in 0..lease.task {
            match self.rows.get(Tree::Results, &record::task_key(id, shard)) {
                Ok(Some(result)) => take(&result),
                Ok(None) | Err(StoreError::DamagedRow { .. }) => lost.push(shard),
                Err(error) => return Err(error.into()),
            }
        }
        if lost.is_empty() {
            return Ok(true);
        }
        let mut state = self.lock();
        self.fail_task(&mut state, lease, &format!("the results of shards {lost:?} are lost or damaged"))?;
        if !state.active.contains_key(&lease.submission) {
            // That was its last attempt, and the job has failed.
            return Ok(false);
        }
        for shard in lost {
            let mut batch = Batch::default();
            record::remove_tasks(&mut batch, [record::task_key(id, shard)]);
            self.commit(&mut state, batch)?;
            self.set(&mut state, &Lease { task: shard, ..*lease }, Task::default());
        }
        Ok(false)
    }
}

#[cfg(test)]
mod tests {
    use std::{
        num::{NonZeroU32, NonZeroUsize},
        sync::{
            Arc, Mutex,
            atomic::{AtomicI64, Ordering},
        },
        time::Duration,
    };

    use super::{super::state::Clock, *};
    use crate::{
        queue::{Demand, JobId, LeasedTask, Limits, NewJob, Offer, Queue as _, Submitted, TaskKind},
        store::{
            Rows,
            memory::{Meanwhile, MemoryRows},
        },
    };
    use ltcforge_files::digest::Digest;

    const LEASE_SECONDS: i64 = 60;

    /// A queue whose results take their time on the way to the disk.
    struct Slow {
        rows: Arc<MemoryRows>,
        queue: Arc<EmbeddedQueue>,
        seconds: Arc<AtomicI64>,
    }

    fn opened(rows: &Arc<MemoryRows>, seconds: &Arc<AtomicI64>) -> Arc<EmbeddedQueue> {
        let limits = Limits {
            jobs: 9,
            lease_ttl: Duration::from_secs(LEASE_SECONDS.cast_unsigned()),
            max_attempts: NonZeroU32::new(3).unwrap(),
            keep_ended: None,
            most_ended: None,
        };
        Arc::new(EmbeddedQueue::open(Arc::clone(rows) as Arc<dyn Rows>, limits, Clock::at(seconds)).unwrap())
    }

    impl Slow {
        fn new() -> Self {
            let (rows, seconds) = (Arc::new(MemoryRows::default()), Arc::new(AtomicI64::new(1_700_000_000)));
            let queue = opened(&rows, &seconds);
            Self { rows, queue, seconds }
        }

        /// Has `work` done while the next results are on their way to the disk.
        fn meanwhile(&self, work: impl FnOnce(&EmbeddedQueue) + Send + 'static) {
            let queue = Arc::clone(&self.queue);
            *self.rows.while_settling.lock().unwrap() = Some(Meanwhile(Box::new(move || {
                assert!(queue.state.try_lock().is_ok(), "the queue is held while the disk is waited for");
                work(&queue);
            })));
        }

        /// The answer to a result that was on its way as [`Self::meanwhile`] says.
        fn complete(&self, task: &LeasedTask) -> Result<(), StaleLease> {
            let answers = self.queue.complete(&[(task.lease, b"result")]).unwrap();
            assert!(self.rows.while_settling.lock().unwrap().is_none(), "it was not waited for the disk");
            answers[0]
        }

        /// The queue of the next process, after the system has lost everything that was not on the disk.
        fn after_power_cut(&self) -> Arc<EmbeddedQueue> {
            opened(&Arc::new(self.rows.after_power_cut()), &self.seconds)
        }
    }

    fn submit(queue: &EmbeddedQueue, shards: usize) -> JobId {
        let recipe_digest = Digest::of(b"recipe");
        let new = NewJob { recipe: "recipe".to_owned(), recipe_digest, shard_entries: vec![1; shards], by: None };
        assert!(matches!(queue.submit(new, &|_| false), Ok(Submitted::Queued(_))));
        JobId::of_recipe(&recipe_digest)
    }

    fn leased(queue: &EmbeddedQueue) -> Option<LeasedTask> {
        match queue.lease(Demand::Any, NonZeroUsize::MIN) {
            Offer::Tasks(mut tasks) => tasks.pop(),
            Offer::Nothing { .. } => None,
            Offer::Closed => panic!("the queue is closed"),
        }
    }

    fn task(queue: &EmbeddedQueue) -> LeasedTask {
        leased(queue).expect("a task")
    }

    /// The shards that are leased until there is none.
    fn shards_left(queue: &EmbeddedQueue) -> Vec<u32> {
        let shard = |task: LeasedTask| match task.kind {
            TaskKind::Shard(shard) => Some(shard),
            TaskKind::Assemble => None,
        };
        std::iter::from_fn(|| leased(queue)).filter_map(shard).collect()
    }

    #[test]
    fn others_lease_and_report_while_a_result_is_on_its_way_and_nothing_is_assembled_of_it() {
        let slow = Slow::new();
        submit(&slow.queue, 2);
        let [first, second] = [task(&slow.queue), task(&slow.queue)];
        let (on_its_way, other) = (first.lease, second.clone());
        slow.meanwhile(move |queue| {
            assert_eq!(queue.progress(&on_its_way, 1), Ok(()));
            queue.give_back(&other.lease).unwrap();
            assert_eq!(task(queue).kind, other.kind);
        });
        assert_eq!(slow.complete(&first), Ok(()));
        slow.seconds.fetch_add(LEASE_SECONDS, Ordering::Relaxed);
        let second = task(&slow.queue);
        slow.meanwhile(|queue| assert_eq!(leased(queue), None, "not all are finished yet"));
        assert_eq!(slow.complete(&second), Ok(()));
        assert_eq!(task(&slow.queue).kind, TaskKind::Assemble);
    }

    #[test]
    fn a_result_on_its_way_is_lost_with_the_power_and_one_that_was_acknowledged_is_not() {
        let slow = Slow::new();
        submit(&slow.queue, 3);
        let [first, second] = [task(&slow.queue), task(&slow.queue)];
        assert_eq!(slow.queue.complete(&[(first.lease, b"result")]).unwrap(), [Ok(())]);
        let cut = Arc::new(Mutex::new(None));
        let (rows, then) = (Arc::clone(&slow.rows), Arc::clone(&cut));
        slow.meanwhile(move |_| *then.lock().unwrap() = Some(Arc::new(rows.after_power_cut())));
        assert_eq!(slow.complete(&second), Ok(()));
        let cut = cut.lock().unwrap().take().unwrap();
        assert_eq!(shards_left(&opened(&cut, &slow.seconds)), [1, 2]);
        assert_eq!(shards_left(&slow.after_power_cut()), [2]);
    }

    #[test]
    fn a_result_whose_job_is_cancelled_on_its_way_is_refused_and_leaves_nothing() {
        let slow = Slow::new();
        let id = submit(&slow.queue, 2);
        let first = task(&slow.queue);
        slow.meanwhile(move |queue| assert!(queue.cancel(id, None).unwrap().is_some()));
        assert_eq!(slow.complete(&first), Err(StaleLease));
        assert_eq!((slow.rows.len(Tree::Shards), slow.rows.len(Tree::Results)), (0, 0));
        submit(&slow.queue, 2);
        let again = task(&slow.queue);
        slow.meanwhile(move |queue| {
            assert!(queue.cancel(id, None).unwrap().is_some());
            submit(queue, 2);
        });
        assert_eq!(slow.complete(&again), Err(StaleLease), "it is of another submission");
        assert_eq!(shards_left(&slow.queue), [0, 1]);
    }

    #[test]
    fn a_lease_that_ends_while_its_result_is_on_its_way_does_not_count() {
        let slow = Slow::new();
        submit(&slow.queue, 1);
        let first = task(&slow.queue);
        slow.seconds.fetch_add(LEASE_SECONDS - 1, Ordering::Relaxed);
        let seconds = Arc::clone(&slow.seconds);
        slow.meanwhile(move |queue| {
            seconds.fetch_add(LEASE_SECONDS - 1, Ordering::Relaxed);
            assert_eq!(leased(queue), None, "delivering renews the lease");
            seconds.fetch_add(1, Ordering::Relaxed);
            assert_eq!(task(queue).kind, TaskKind::Shard(0));
        });
        assert_eq!(slow.complete(&first), Err(StaleLease));
        assert_eq!(leased(&slow.queue), None, "another has it");
        let again = slow.after_power_cut();
        assert_eq!(again.job(JobId::of_recipe(&Digest::of(b"recipe"))).unwrap().unwrap().entries_done, 0);
        assert_eq!(shards_left(&again), [0]);
    }

    #[test]
    fn a_result_that_does_not_reach_the_disk_keeps_its_lease() {
        let slow = Slow::new();
        submit(&slow.queue, 1);
        let first = task(&slow.queue);
        let rows = Arc::clone(&slow.rows);
        slow.meanwhile(move |_| rows.full.store(true, Ordering::Relaxed));
        let done: &[(Lease, &[u8])] = &[(first.lease, b"result")];
        assert!(matches!(slow.queue.complete(done), Err(StoreError::DiskFull)));
        assert_eq!(leased(&slow.queue), None);
        slow.rows.full.store(false, Ordering::Relaxed);
        assert_eq!(slow.queue.complete(done).unwrap(), [Ok(())]);
        assert_eq!(task(&slow.queue).kind, TaskKind::Assemble);
    }
}
