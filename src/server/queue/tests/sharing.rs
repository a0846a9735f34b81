//! How jobs share the workers.

use std::{
    num::{NonZeroU32, NonZeroUsize},
    time::Duration,
};

use super::world::{World, complete, results, submit, task, tasks};
use crate::queue::{Demand, LeasedTask, Limits, Offer, StaleLease};

const LIMITS: Limits = Limits {
    jobs: 9,
    lease_ttl: Duration::from_secs(60),
    max_attempts: NonZeroU32::MIN,
    keep_ended: None,
    most_ended: None,
};

fn recipes(tasks: &[LeasedTask]) -> Vec<&str> {
    tasks.iter().map(|task| task.recipe.as_str()).collect()
}

pub(super) fn jobs_share_the_workers_evenly_and_a_new_one_is_next<W: World>() {
    let Some(world) = W::new(LIMITS) else { return };
    let queue = world.queue();
    submit(queue, "long", 9);
    assert_eq!([task(queue), task(queue)].map(|task| task.recipe), ["long", "long"]);
    submit(queue, "new", 9);
    let tasks: Vec<LeasedTask> = (0..4).map(|_| task(queue)).collect();
    // Two each; of equals the one that was served longest ago.
    assert_eq!(recipes(&tasks), ["new", "new", "long", "new"]);
}

pub(super) fn several_tasks_at_once_are_shared_as_evenly<W: World>() {
    let Some(world) = W::new(LIMITS) else { return };
    let queue = world.queue();
    submit(queue, "long", 9);
    assert_eq!(recipes(&tasks(queue, Demand::Any, 2)), ["long", "long"]);
    submit(queue, "new", 3);
    let mut names: Vec<String> = tasks(queue, Demand::Any, 5).into_iter().map(|task| task.recipe).collect();
    names.sort();
    // Three and four: the new job has no more shards, and its assembly is not due.
    assert_eq!(names, ["long", "long", "new", "new", "new"]);
    assert_eq!(tasks(queue, Demand::Any, 100).len(), 5, "what is left");
    assert!(tasks(queue, Demand::Any, 100).is_empty());
}

pub(super) fn a_new_job_gets_all_until_it_has_as_many<W: World>() {
    let Some(world) = W::new(LIMITS) else { return };
    let queue = world.queue();
    submit(queue, "long", 9);
    assert_eq!(recipes(&tasks(queue, Demand::Any, 3)), ["long", "long", "long"]);
    submit(queue, "new", 9);
    task(queue);
    assert_eq!(recipes(&tasks(queue, Demand::Any, 2)), ["new", "new"]);
}

pub(super) fn one_worker_alternates<W: World>() {
    let Some(world) = W::new(LIMITS) else { return };
    let queue = world.queue();
    submit(queue, "a", 3);
    submit(queue, "b", 3);
    let names: Vec<String> = (0..4)
        .map(|_| {
            let task = task(queue);
            complete(queue, &task);
            task.recipe
        })
        .collect();
    assert_eq!(names, ["a", "b", "a", "b"]);
}

pub(super) fn a_job_without_workers_is_told_from_others<W: World>() {
    let Some(world) = W::new(LIMITS) else { return };
    let queue = world.queue();
    submit(queue, "long", 9);
    task(queue);
    assert!(tasks(queue, Demand::Unserved, 1).is_empty());
    submit(queue, "new", 9);
    let other = tasks(queue, Demand::Unserved, 1).pop().expect("the new job has no worker");
    assert_eq!(other.recipe, "new");
    assert!(tasks(queue, Demand::Unserved, 1).is_empty());
    complete(queue, &other);
    assert_eq!(tasks(queue, Demand::Unserved, 1).len(), 1);
    queue.close();
    assert_eq!(queue.lease(Demand::Unserved, NonZeroUsize::MIN), Offer::Closed);
}

pub(super) fn several_results_have_an_answer_each<W: World>() {
    let Some(world) = W::new(LIMITS) else { return };
    let queue = world.queue();
    let id = submit(queue, "a", 3);
    let leased = tasks(queue, Demand::Any, 3);
    queue.give_back(&leased[1].lease).unwrap();
    let again = task(queue);
    let done = [leased[0].lease, leased[1].lease, leased[2].lease, again.lease, leased[0].lease];
    let done = done.map(|lease| (lease, b"result".as_slice()));
    let answers = [Ok(()), Err(StaleLease), Ok(()), Ok(()), Err(StaleLease)];
    assert_eq!(queue.complete(&done).unwrap(), answers, "each is taken once");
    assert_eq!(queue.complete(&done).unwrap(), [Err(StaleLease); 5]);
    assert_eq!(queue.job(id).unwrap().unwrap().entries_done, 3);
    assert_eq!(results(queue, &task(queue).lease).unwrap().unwrap(), [b"result"; 3]);
}
