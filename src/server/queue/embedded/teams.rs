//! How teams share the workers.

use std::{cmp::Reverse, collections::BTreeMap};

use super::active::ActiveJob;
use crate::queue::{Claim, Demand, TURN};

/// Unfinished jobs by submission.
pub(super) type ActiveJobs = BTreeMap<u64, ActiveJob>;

/// Teams that had a job once.
#[derive(Debug, Default)]
pub(super) struct Teams(BTreeMap<String, Team>);

#[derive(Debug, Default)]
struct Team {
    share: u64,
    /// Of teams that have equally much, the lowest is served next.
    turn: u64,
}

/// A team with unfinished jobs.
#[derive(Debug, Clone, Copy)]
struct Served {
    share: u64,
    turn: u64,
    /// Tasks of its jobs that are leased.
    leased: u64,
}

impl Teams {
    /// Counts a job in that is about to be one of `jobs`. A team that has no other begins where the one begins that is next:
    /// while it had no work, it saved up nothing.
    pub(super) fn join(&mut self, claim: &Claim, jobs: &ActiveJobs) {
        let Claim { team, share, .. } = claim;
        let served = self.served(jobs);
        let begin = if served.contains_key(team.as_str()) { None } else { served.values().map(|team| team.turn).min() };
        let entry = self.0.entry(team.clone()).or_default();
        entry.share = u64::from(share.get());
        entry.turn = entry.turn.max(begin.unwrap_or(0));
    }

    fn served<'a>(&self, jobs: &'a ActiveJobs) -> BTreeMap<&'a str, Served> {
        let mut served = BTreeMap::new();
        for active in jobs.values() {
            let name = active.claim().team.as_str();
            let team = served.entry(name).or_insert_with(|| {
                let team = self.0.get(name);
                Served { share: team.map_or(1, |team| team.share), turn: team.map_or(0, |team| team.turn), leased: 0 }
            });
            team.leased += active.tasks_leased() as u64;
        }
        served
    }

    /// The submission and the number of the task to lease next, by the order of [`crate::queue::Queue::lease`].
    pub(super) fn next_task(&self, jobs: &ActiveJobs, demand: Demand) -> Option<(u64, u32)> {
        let with_suspects = !jobs.values().any(ActiveJob::has_suspect_leased);
        let highest = jobs.values().map(|active| active.claim().priority).max()?;
        let teams = self.served(jobs);
        let (leased, shares) =
            teams.values().fold((0, 0), |(leased, shares), team| (leased + team.leased, shares + team.share));
        let is_meant = |active: &ActiveJob, team: &Served| match demand {
            Demand::Any => true,
            Demand::Unserved => {
                let has_its_share = team.leased * shares > team.share * leased;
                active.tasks_leased() == 0 && active.claim().priority == highest && !has_its_share
            }
        };
        let candidates = jobs.iter().filter_map(|(submission, active)| {
            let Claim { team: name, priority, .. } = active.claim();
            let team = teams.get(name.as_str()).filter(|team| is_meant(active, team))?;
            let task = active.next_waiting(with_suspects)?;
            let of_teams = (Reverse(*priority), team.leased / team.share, team.turn, name);
            Some(((of_teams, active.tasks_leased(), active.last_served, *submission), task))
        });
        let ((_, _, _, submission), task) = candidates.min()?;
        Some((submission, task))
    }

    /// A task of the team was leased.
    pub(super) fn pass_turn(&mut self, team: &str) {
        if let Some(team) = self.0.get_mut(team) {
            team.turn += TURN / team.share;
        }
    }
}
