//! Which of the tasks that this process has leased are under way, and which wait until one of them ends.
//!
//! A lease may take milliseconds, more so of a database elsewhere, and shards may take few more. So that a thread does not
//! wait for one, the next tasks are leased while others are under way. Each job with a task here has one under way: another
//! job's long shard does not keep it from going on.

use std::{
    collections::{HashMap, VecDeque},
    num::NonZeroUsize,
    time::Duration,
};

use crate::queue::{Demand, JobId};

/// Tasks are leased ahead while shards take less than this. Another process that is idle waits as long at most, and longer
/// ones gain nothing.
const SHORT: Duration = Duration::from_millis(500);

/// The tasks that were leased and have not ended.
#[derive(Debug)]
pub(super) struct Places {
    /// Tasks under way at once, unless jobs would wait for each other.
    at_once: usize,
    under_way: usize,
    /// How many of them each job has.
    of_job: HashMap<JobId, usize>,
    /// Tickets and jobs of those that wait.
    ahead: VecDeque<(u64, JobId)>,
    tickets: u64,
    /// What the last shard took.
    last: Option<Duration>,
}

/// What becomes of a leased task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// It is under way.
    UnderWay,
    /// It waits until [`Places::end`] names its ticket.
    Ahead(u64),
}

impl Places {
    pub(super) fn new(at_once: usize) -> Self {
        Self { at_once, under_way: 0, of_job: HashMap::new(), ahead: VecDeque::new(), tickets: 0, last: None }
    }

    /// The tasks to lease next, for at most `threads` that ask: any while too few are under way, some ahead when half of
    /// those are gone, else one of a job that nobody works for.
    pub(super) fn demand(&self, threads: usize) -> (Demand, NonZeroUsize) {
        let held = self.under_way + self.ahead.len();
        let leads = self.under_way <= self.at_once
            && 2 * self.ahead.len() <= self.at_once
            && self.last.is_some_and(|last| last < SHORT);
        let most = match self.at_once.saturating_sub(held) {
            0 if leads => self.at_once - self.ahead.len(),
            free => free,
        };
        match NonZeroUsize::new(most.min(threads)) {
            Some(most) => (Demand::Any, most),
            None => (Demand::Unserved, NonZeroUsize::MIN),
        }
    }

    /// Takes in a leased task of `job`.
    pub(super) fn add(&mut self, job: JobId) -> Place {
        if self.under_way < self.at_once || !self.of_job.contains_key(&job) {
            self.begin(job);
            return Place::UnderWay;
        }
        self.tickets += 1;
        self.ahead.push_back((self.tickets, job));
        Place::Ahead(self.tickets)
    }

    /// Ends a task of `job` that is under way; `took` is what a shard took to its end. Returns the ticket of a task that
    /// is under way instead.
    pub(super) fn end(&mut self, job: JobId, took: Option<Duration>) -> Option<u64> {
        self.last = took.or(self.last);
        self.under_way -= 1;
        if let Some(of_job) = self.of_job.get_mut(&job) {
            *of_job -= 1;
            if *of_job == 0 {
                self.of_job.remove(&job);
            }
        }
        // Its own job goes first if it has no other task under way.
        let own = self.ahead.iter().position(|(_, of)| *of == job).filter(|_| !self.of_job.contains_key(&job));
        let next = own.or_else(|| (self.under_way < self.at_once).then_some(0))?;
        let (ticket, job) = self.ahead.remove(next)?;
        self.begin(job);
        Some(ticket)
    }

    fn begin(&mut self, job: JobId) {
        self.under_way += 1;
        *self.of_job.entry(job).or_default() += 1;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use ltcforge_files::digest::Digest;

    const QUICK: Option<Duration> = Some(Duration::from_millis(50));

    fn job(name: &str) -> JobId {
        JobId::of_recipe(&Digest::of(name.as_bytes()))
    }

    fn any_of(most: usize) -> (Demand, NonZeroUsize) {
        (Demand::Any, NonZeroUsize::new(most).unwrap())
    }

    fn add(places: &mut Places, tasks: usize) {
        for _ in 0..tasks {
            places.add(job("a"));
        }
    }

    const UNSERVED: (Demand, NonZeroUsize) = (Demand::Unserved, NonZeroUsize::MIN);

    #[test]
    fn quick_shards_are_leased_ahead_and_long_ones_are_not() {
        let mut places = Places::new(1);
        assert_eq!(places.demand(9), any_of(1));
        assert_eq!(places.add(job("a")), Place::UnderWay);
        assert_eq!(places.demand(9), UNSERVED, "nothing is known of its shards");
        assert_eq!(places.end(job("a"), QUICK), None);
        assert_eq!((places.add(job("a")), places.demand(9)), (Place::UnderWay, any_of(1)));
        assert_eq!((places.add(job("a")), places.demand(9)), (Place::Ahead(1), UNSERVED));
        assert_eq!((places.end(job("a"), QUICK), places.demand(9)), (Some(1), any_of(1)));
        assert_eq!((places.end(job("a"), Some(SHORT)), places.add(job("a"))), (None, Place::UnderWay));
        assert_eq!(places.demand(9), UNSERVED);
    }

    #[test]
    fn many_are_leased_ahead_together_when_half_of_them_are_gone() {
        let mut places = Places::new(8);
        add(&mut places, 9);
        assert_eq!(places.end(job("a"), QUICK), Some(1));
        assert_eq!((places.demand(99), places.demand(3)), (any_of(8), any_of(3)));
        add(&mut places, 8);
        (0..3).for_each(|_| assert!(places.end(job("a"), QUICK).is_some()));
        assert_eq!(places.demand(99), UNSERVED);
        assert!(places.end(job("a"), QUICK).is_some());
        assert_eq!(places.demand(99), any_of(4));
    }

    #[test]
    fn a_job_goes_on_beside_another_one_s_long_shard() {
        let mut places = Places::new(1);
        assert_eq!((places.add(job("a")), places.end(job("a"), QUICK)), (Place::UnderWay, None));
        assert_eq!((places.add(job("a")), places.add(job("a"))), (Place::UnderWay, Place::Ahead(1)));
        assert_eq!(places.add(job("long")), Place::UnderWay, "nobody works for it here");
        assert_eq!(places.demand(9), UNSERVED);
        assert_eq!(places.end(job("a"), QUICK), Some(1), "it has no other one under way");
        assert_eq!(places.end(job("a"), QUICK), None);
    }

    #[test]
    fn tasks_ahead_begin_in_their_order_and_only_when_there_is_room() {
        let mut places = Places::new(2);
        add(&mut places, 2);
        assert_eq!(places.end(job("a"), QUICK), None);
        assert_eq!((places.add(job("a")), places.add(job("long"))), (Place::UnderWay, Place::UnderWay));
        assert_eq!(places.demand(9), UNSERVED, "more are under way than there are threads");
        assert_eq!(places.add(job("a")), Place::Ahead(1));
        assert_eq!(places.end(job("a"), QUICK), None, "there are as many others as threads");
        assert_eq!(places.end(job("a"), QUICK), Some(1));
        let mut places = Places::new(3);
        assert_eq!(["a", "b", "c"].map(|name| places.add(job(name))), [Place::UnderWay; 3]);
        assert_eq!(["a", "b"].map(|name| places.add(job(name))), [Place::Ahead(1), Place::Ahead(2)]);
        assert_eq!(places.end(job("c"), QUICK), Some(1));
    }

    #[test]
    fn an_assembly_says_nothing_of_shards() {
        let mut places = Places::new(1);
        add(&mut places, 1);
        assert_eq!(places.end(job("a"), QUICK), None);
        add(&mut places, 1);
        assert_eq!(places.end(job("a"), None), None);
        add(&mut places, 1);
        assert_eq!(places.demand(9), any_of(1));
    }

    proptest! {
        /// Whatever is leased and ends: as many are under way as may be, each job has one of them, and none is forgotten.
        #[test]
        fn no_job_waits_for_another(at_once in 1..5_usize, steps in prop::collection::vec((0..4_u8, any::<bool>()), 1..200)) {
            let mut places = Places::new(at_once);
            let (mut under_way, mut waiting) = (Vec::new(), HashMap::new());
            for (n, ends) in steps {
                let of = job(&n.to_string());
                if !ends {
                    let (_, most) = places.demand(9);
                    for _ in 0..most.get() {
                        match places.add(of) {
                            Place::UnderWay => under_way.push(of),
                            Place::Ahead(ticket) => assert!(waiting.insert(ticket, of).is_none()),
                        }
                    }
                } else if let Some(at) = under_way.iter().position(|other| *other == of) {
                    under_way.swap_remove(at);
                    if let Some(ticket) = places.end(of, QUICK) {
                        under_way.push(waiting.remove(&ticket).expect("it waits"));
                    }
                }
                prop_assert!(waiting.values().all(|job| under_way.contains(job)));
                prop_assert!(waiting.is_empty() || at_once <= under_way.len());
            }
            while let Some(of) = under_way.pop() {
                let next = places.end(of, QUICK).map(|ticket| waiting.remove(&ticket).expect("it waits"));
                under_way.extend(next);
            }
            prop_assert!(waiting.is_empty());
            prop_assert_eq!(places.demand(99), any_of(at_once));
        }
    }
}
