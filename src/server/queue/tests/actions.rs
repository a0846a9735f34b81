//! The actions of a random history.

use std::num::NonZeroU32;

use proptest::prelude::*;

use crate::queue::{Claim, LeasedTask, NewJob, Priority, Submitter};
use ltcforge_files::digest::Digest;

pub(super) const LEASE_SECONDS: i64 = 10;
pub(super) const SHARDS: u32 = 3;

pub(super) fn recipe(n: u8) -> NewJob {
    NewJob {
        recipe: format!("recipe {n}"),
        recipe_digest: Digest::of(&[n]),
        shard_entries: vec![2; SHARDS as usize],
        // Each of a team of its own, or of none, and of a priority of its own.
        by: Priority::ALL.get(usize::from(n)).filter(|_| n > 0).map(|priority| Submitter {
            name: n.to_string(),
            claim: Claim { team: n.to_string(), share: NonZeroU32::MIN.saturating_add(n.into()), priority: *priority },
        }),
    }
}

/// The result of a shard.
pub(super) fn result(leased: &LeasedTask) -> String {
    format!("{}/{:?}", leased.recipe, leased.kind)
}

/// Why nothing can be written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Fault {
    DiskFull,
    NoDescriptors,
}

#[derive(Debug, Clone)]
pub(super) enum Action {
    Submit(u8),
    Cancel(u8),
    /// Lease up to so many tasks at once.
    Lease(usize),
    /// Deliver a held lease, whether it is still current or not.
    Deliver(prop::sample::Index),
    /// Deliver a held lease of a shard, and do something else while its result is on its way to the disk.
    DeliverWhile(prop::sample::Index, Box<Action>),
    /// Deliver under a lease once more.
    DeliverAgain(prop::sample::Index),
    Fail(prop::sample::Index),
    GiveBack(prop::sample::Index),
    Progress(prop::sample::Index),
    /// Let time pass.
    Tick(i64),
    /// The process ends. What was acknowledged is on the disk.
    PowerCut,
    /// The process ends, and the system writes all that reached the database.
    Kill,
    /// What is written during the next action meets a fault.
    Faulty(Fault, Box<Action>),
    /// Another process of those that share the queue acts from here on.
    Turn,
}

pub(super) fn action() -> impl Strategy<Value = Action> {
    let index = any::<prop::sample::Index>;
    let step = prop_oneof![
        3 => (0..3_u8).prop_map(Action::Submit),
        1 => (0..3_u8).prop_map(Action::Cancel),
        8 => (1..4_usize).prop_map(Action::Lease),
        8 => index().prop_map(Action::Deliver),
        1 => index().prop_map(Action::DeliverAgain),
        1 => index().prop_map(Action::Fail),
        1 => index().prop_map(Action::GiveBack),
        1 => index().prop_map(Action::Progress),
        1 => (1..2 * LEASE_SECONDS).prop_map(Action::Tick),
    ];
    let plain = prop_oneof![
        25 => step.clone(),
        1 => Just(Action::PowerCut),
        2 => Just(Action::Kill),
        2 => Just(Action::Turn),
    ];
    prop_oneof![
        27 => plain.clone(),
        // Seldom, because each needs a thread, which waits where others work.
        1 => (index(), step).prop_map(|(index, other)| Action::DeliverWhile(index, Box::new(other))),
        3 => plain.clone().prop_map(|action| Action::Faulty(Fault::DiskFull, Box::new(action))),
        1 => plain.prop_map(|action| Action::Faulty(Fault::NoDescriptors, Box::new(action))),
    ]
}
