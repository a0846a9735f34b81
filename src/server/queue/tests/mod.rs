//! Tests that every queue has to pass, whatever it is built on.

mod actions;
mod callers;
mod depth;
mod forgetting;
mod histories;
mod model;
mod sharing;
pub(super) mod world;

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

        mod postgres {
            in_world!(crate::queue::tests::world::PostgresWorld: $($tests)*);
        }
    };
}

every_queue!(
    callers::a_job_tells_who_submitted_and_who_cancelled_it,
    depth::shards_that_wait_and_that_are_leased_are_counted,
    forgetting::a_start_forgets_too_and_without_a_limit_nothing_is_forgotten,
    forgetting::jobs_that_ended_long_ago_are_forgotten_with_all_their_rows,
    forgetting::of_too_many_jobs_those_that_ended_first_are_forgotten,
    histories::every_history_agrees_with_the_model,
    sharing::a_higher_priority_goes_first_and_a_job_takes_the_highest_it_is_submitted_with,
    sharing::a_new_job_gets_all_until_it_has_as_many,
    sharing::a_job_without_workers_is_told_from_others,
    sharing::a_team_has_its_share_of_many_workers_and_of_one,
    sharing::a_team_may_fill_half_of_the_queue,
    sharing::a_team_that_had_no_work_has_saved_up_nothing,
    sharing::a_thread_beside_the_workers_goes_to_a_team_without_its_share,
    sharing::jobs_share_the_workers_evenly_and_a_new_one_is_next,
    sharing::many_jobs_of_a_team_get_no_more_than_one_of_another,
    sharing::one_worker_alternates,
    sharing::several_results_have_an_answer_each,
    sharing::several_tasks_at_once_are_shared_as_evenly,
);
