//! How much there is to do.

use std::{
    num::{NonZeroU32, NonZeroUsize},
    time::Duration,
};

use super::world::{World, complete, submit, task};
use crate::queue::{Demand, Depth, Limits, Offer, TaskKind};

const LIMITS: Limits = Limits {
    jobs: 9,
    lease_ttl: Duration::from_secs(60),
    max_attempts: NonZeroU32::MAX,
    keep_ended: None,
    most_ended: None,
};

pub(super) fn shards_that_wait_and_that_are_leased_are_counted<W: World>() {
    let Some(mut world) = W::new(LIMITS) else { return };
    let depth = |world: &W| {
        let Depth { waiting, leased } = world.queue().depth().unwrap();
        (waiting, leased)
    };
    assert_eq!(depth(&world), (0, 0));
    let first = submit(world.queue(), "first", 3);
    submit(world.queue(), "second", 2);
    assert_eq!(depth(&world), (5, 0), "assemblies do not count");
    let leased = [task(world.queue()), task(world.queue()), task(world.queue())];
    assert_eq!(depth(&world), (2, 3));
    complete(world.queue(), &leased[0]);
    world.queue().give_back(&leased[1].lease).unwrap();
    assert_eq!(depth(&world), (3, 1));
    world.pass(Duration::from_secs(61));
    assert_eq!(depth(&world), (4, 0), "a lease that has expired is another's to take");
    world.queue().cancel(first, None).unwrap();
    // Leased were two of the first job and one of the second, in turns, and the first of all is finished.
    assert_eq!(depth(&world), (2, 0), "of a cancelled job nothing is left");
    while let Offer::Tasks(tasks) = world.queue().lease(Demand::Any, NonZeroUsize::MIN) {
        if tasks[0].kind == TaskKind::Assemble {
            break;
        }
        complete(world.queue(), &tasks[0]);
    }
    assert_eq!(depth(&world), (0, 0), "an assembly is left");
}
