//! Who submitted and who cancelled a job.

use std::{num::NonZeroU32, time::Duration};

use super::{actions::recipe, world::World};
use crate::queue::{Claim, JobId, Limits, NewJob, Submitter};

pub(super) fn a_job_tells_who_submitted_and_who_cancelled_it<W: World>() {
    let limits = Limits {
        jobs: 9,
        lease_ttl: Duration::from_secs(60),
        max_attempts: NonZeroU32::MIN,
        keep_ended: None,
        most_ended: None,
    };
    let Some(mut world) = W::new(limits) else { return };
    let by =
        |name: &str| NewJob { by: Some(Submitter { name: name.to_owned(), claim: Claim::default() }), ..recipe(1) };
    let id = JobId::of_recipe(&recipe(1).recipe_digest);
    let who = |world: &W| {
        let job = world.queue().job(id).unwrap().unwrap();
        (job.submitted_by, job.cancelled_by)
    };
    let told = |submitted: &str, cancelled: Option<&str>| (Some(submitted.to_owned()), cancelled.map(str::to_owned));
    world.queue().submit(by("first"), &|_| false).unwrap();
    world.queue().submit(by("joins"), &|_| false).unwrap();
    assert_eq!(who(&world), told("first", None));
    world.queue().cancel(id, Some("other")).unwrap();
    world.queue().cancel(id, Some("late")).unwrap();
    assert_eq!(who(&world), told("first", Some("other")));
    world.reopen(limits);
    assert_eq!(who(&world), told("first", Some("other")));
    world.queue().submit(by("again"), &|_| false).unwrap();
    assert_eq!(who(&world), told("again", None));
    world.queue().cancel(id, None).unwrap();
    assert_eq!(who(&world), told("again", None));
}
