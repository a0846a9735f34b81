//! Tests for both queues.

mod cases;
mod model;
mod world;

macro_rules! in_world {
    ($world:ty: $($suite:ident::$test:ident),* $(,)?) => {
        $(#[test]
        fn $test() {
            super::$suite::$test::<$world>();
        })*
    };
}

macro_rules! every_queue {
    ($($tests:tt)*) => {
        mod embedded {
            in_world!(crate::queue::tests::world::EmbeddedWorld: $($tests)*);
        }

        #[cfg(feature = "cluster")]
        mod postgres {
            in_world!(crate::queue::tests::world::PostgresWorld: $($tests)*);
        }
    };
}

every_queue!(
    cases::a_failed_job_keeps_its_finished_shards_if_its_shards_are_the_same,
    cases::a_job_is_found_by_its_table_until_it_is_forgotten,
    cases::a_suspended_process_keeps_its_leases,
    cases::a_small_job_among_long_ones_is_leased_next_and_long_ones_share_evenly,
    cases::a_task_fails_its_job_after_five_failures_or_twenty_five_leases,
    cases::lost_results_are_fitted_again,
    cases::statistics_and_pages_agree_with_the_jobs,
    cases::under_an_endless_flood_of_small_jobs_a_long_one_goes_on,
    cases::waiting_ends_when_the_queue_is_closed,
    model::every_history_agrees_with_the_model,
);
