//! How jobs share the workers.

use std::{
    num::{NonZeroU32, NonZeroUsize},
    time::Duration,
};

use super::world::{World, complete, results, submit, task, tasks};
use crate::queue::{
    Claim, Demand, JobId, LeasedTask, Limits, NewJob, Offer, Priority, Queue, QueueError, StaleLease, Submitted,
    Submitter,
};
use ltcforge_files::digest::Digest;

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

/// A job of so many shards of a team, with its share and priority.
fn submit_for(queue: &dyn Queue, name: &str, shards: usize, (team, share, priority): (&str, u32, Priority)) -> JobId {
    let claim = Claim { team: team.to_owned(), share: share.try_into().unwrap(), priority };
    let recipe_digest = Digest::of(name.as_bytes());
    let by = Some(Submitter { name: format!("token of {team}"), claim });
    let new = NewJob { recipe: name.to_owned(), recipe_digest, shard_entries: vec![1; shards], by };
    assert!(matches!(queue.submit(new, &|_| false), Ok(Submitted::Queued(_))));
    JobId::of_recipe(&recipe_digest)
}

const LARGE: Limits = Limits { jobs: 99, ..LIMITS };

pub(super) fn many_jobs_of_a_team_get_no_more_than_one_of_another<W: World>() {
    let Some(world) = W::new(LARGE) else { return };
    let queue = world.queue();
    for n in 0..20 {
        submit_for(queue, &format!("small {n}"), 2, ("many", 1, Priority::Normal));
    }
    assert_eq!(tasks(queue, Demand::Any, 8).len(), 8);
    submit_for(queue, "large", 40, ("one", 1, Priority::Normal));
    let of_one = |tasks: &[LeasedTask]| tasks.iter().filter(|task| task.recipe == "large").count();
    assert_eq!(of_one(&tasks(queue, Demand::Any, 8)), 8, "until it has as much");
    assert_eq!(of_one(&tasks(queue, Demand::Any, 10)), 5, "then as much of what comes");
}

pub(super) fn a_team_has_its_share_of_many_workers_and_of_one<W: World>() {
    let Some(world) = W::new(LARGE) else { return };
    let queue = world.queue();
    let three = ("three", 3, Priority::Normal);
    submit_for(queue, "a", 99, three);
    submit_for(queue, "b", 99, ("one", 1, Priority::Normal));
    submit_for(queue, "c", 99, three);
    let count =
        |tasks: &[LeasedTask]| ["a", "b", "c"].map(|name| recipes(tasks).iter().filter(|of| **of == name).count());
    let at_once = tasks(queue, Demand::Any, 16);
    assert_eq!(count(&at_once), [6, 4, 6]);
    for task in &at_once {
        complete(queue, task);
    }
    // One worker serves by turns; a shard takes as long as it takes.
    let by_turns: Vec<LeasedTask> = (0..40)
        .map(|_| {
            let task = task(queue);
            complete(queue, &task);
            task
        })
        .collect();
    let [a, b, c] = count(&by_turns);
    assert!((9..=11).contains(&b) && a.abs_diff(c) <= 1, "{a} {b} {c}");
}

pub(super) fn a_team_that_had_no_work_has_saved_up_nothing<W: World>() {
    let Some(world) = W::new(LARGE) else { return };
    let queue = world.queue();
    submit_for(queue, "early", 30, ("early", 1, Priority::Normal));
    let lease_one = || {
        let task = task(queue);
        complete(queue, &task);
        task.recipe
    };
    assert!((0..10).all(|_| lease_one() == "early"));
    submit_for(queue, "late", 30, ("late", 1, Priority::Normal));
    let late = (0..10).filter(|_| lease_one() == "late").count();
    assert!((5..=6).contains(&late), "{late}");
}

pub(super) fn a_higher_priority_goes_first_and_a_job_takes_the_highest_it_is_submitted_with<W: World>() {
    let Some(mut world) = W::new(LARGE) else { return };
    let nightly = ("nightly", 1, Priority::Low);
    let waits = submit_for(world.queue(), "waits", 3, nightly);
    submit_for(world.queue(), "night", 3, nightly);
    submit_for(world.queue(), "day", 2, ("day", 1, Priority::Normal));
    submit_for(world.queue(), "now", 1, ("day", 1, Priority::High));
    let mut first: Vec<String> = tasks(world.queue(), Demand::Any, 4).into_iter().map(|task| task.recipe).collect();
    first.sort();
    assert_eq!(first, ["day", "day", "now", "waits"]);
    assert!(tasks(world.queue(), Demand::Unserved, 1).is_empty(), "the lower waits for a free worker");
    // Somebody waits for it now.
    let claim = Claim { team: "day".to_owned(), share: std::num::NonZeroU32::MIN, priority: Priority::High };
    let recipe_digest = Digest::of(b"night");
    let by = Some(Submitter { name: "day".to_owned(), claim: claim.clone() });
    let again = NewJob { recipe: "night".to_owned(), recipe_digest, shard_entries: vec![1; 3], by };
    let Ok(Submitted::Joined(job)) = world.queue().submit(again, &|_| false) else { panic!("it is joined") };
    assert_eq!((job.claim.clone(), job.submitted_by.as_deref()), (claim.clone(), Some("token of nightly")));
    assert_eq!(task(world.queue()).recipe, "night");
    world.reopen(LARGE);
    let kept = world.queue().job(job.id).unwrap().unwrap();
    assert_eq!(kept.claim, claim);
    assert_eq!(world.queue().job(waits).unwrap().unwrap().claim.priority, Priority::Low);
    let next = tasks(world.queue(), Demand::Any, 2);
    assert!(recipes(&next).iter().all(|name| ["night", "now", "day"].contains(name)), "{:?}", recipes(&next));
}

pub(super) fn a_thread_beside_the_workers_goes_to_a_team_without_its_share<W: World>() {
    let Some(world) = W::new(LARGE) else { return };
    let queue = world.queue();
    submit_for(queue, "large", 9, ("one", 1, Priority::Normal));
    assert_eq!(tasks(queue, Demand::Any, 2).len(), 2);
    for n in 0..9 {
        submit_for(queue, &format!("small {n}"), 1, ("many", 1, Priority::Normal));
    }
    let beside = (0..9).map_while(|_| tasks(queue, Demand::Unserved, 1).pop()).count();
    assert_eq!(beside, 3, "as many as the other team, and the one that makes it more");
}

pub(super) fn a_team_may_fill_half_of_the_queue<W: World>() {
    let Some(world) = W::new(LIMITS) else { return };
    let queue = world.queue();
    let of = |name: &str, team: &str| {
        let claim = Claim { team: team.to_owned(), ..Claim::default() };
        let by = Some(Submitter { name: "any".to_owned(), claim });
        let recipe_digest = Digest::of(name.as_bytes());
        queue.submit(NewJob { recipe: name.to_owned(), recipe_digest, shard_entries: vec![1], by }, &|_| false)
    };
    for n in 0..5 {
        of(&n.to_string(), "many").unwrap();
    }
    let refused = of("5", "many").unwrap_err();
    assert!(matches!(&refused, QueueError::Full { limit: 5, team: Some(team) } if team == "many"), "{refused:?}");
    assert!(matches!(of("4", "many"), Ok(Submitted::Joined(_))), "it is there");
    for n in 6..10 {
        of(&n.to_string(), "other").unwrap();
    }
    let refused = of("10", "third").unwrap_err();
    assert!(matches!(refused, QueueError::Full { limit: 9, team: None }), "{refused:?}");
}
