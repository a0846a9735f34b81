//! Random histories of a queue, each of one seed.

use std::env;

use proptest::{
    prelude::*,
    test_runner::{RngAlgorithm, TestRng, TestRunner},
};

use super::{
    actions::action,
    model::{LIMITS, agrees},
    world::World,
};

/// What happens in a history, and how often, follows from its seed alone.
fn runner(seed: u64) -> TestRunner {
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    let config = ProptestConfig { cases: 1, failure_persistence: None, ..ProptestConfig::default() };
    TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &bytes))
}

/// A number in the environment.
fn number(name: &str) -> Option<u64> {
    env::var(name).ok().map(|text| text.parse().unwrap_or_else(|_| panic!("{name} is a number, and not «{text}»")))
}

/// One history for each seed up to [`World::HISTORIES`], or to `LTCFORGE_TEST_HISTORIES`; that of `LTCFORGE_TEST_SEED` alone, if
/// it is set. A history that fails is made as short as it can be.
pub(super) fn every_history_agrees_with_the_model<W: World>() {
    let seeds = match number("LTCFORGE_TEST_SEED") {
        Some(seed) => seed..seed + 1,
        None => 0..number("LTCFORGE_TEST_HISTORIES").map_or(W::HISTORIES, |all| all.div_ceil(W::PART)),
    };
    for seed in seeds {
        let ran = runner(seed).run(&prop::collection::vec(action(), 1..120), |actions| match W::new(LIMITS) {
            Some(world) => agrees(world, &actions),
            None => Ok(()),
        });
        ran.unwrap_or_else(|error| panic!("LTCFORGE_TEST_SEED={seed} replays this history: {error}"));
    }
}
