//! `jobs`: the jobs of a server.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::{CommandFailure, Context, Exit, input, progress, server_args::ServerArgs, tabulated};
use ltcforge_client::{Client, JobDocument, JobStatus};
use ltcforge_files::job::{JobId, StateName};

/// `jobs`.
#[derive(Debug, Args)]
pub struct JobsArgs {
    /// The action
    #[command(subcommand)]
    pub action: JobsAction,
    /// The service
    #[command(flatten)]
    pub server: ServerArgs,
}

/// The actions on jobs.
#[derive(Debug, Subcommand)]
pub enum JobsAction {
    /// Submit a recipe
    Submit {
        /// Recipe: a file, `-` for stdin, or a preset's name
        recipe: PathBuf,
        /// Follow the job; the last output line is the table's digest
        #[arg(long)]
        watch: bool,
    },
    /// List jobs, newest first
    List {
        /// State of the jobs to list
        #[arg(long, value_parser = parse_state, value_name = "STATE")]
        state: Option<StateName>,
        /// Maximum number of jobs to list
        #[arg(long, default_value_t = 50, value_name = "N")]
        limit: usize,
    },
    /// Show a job
    Show {
        /// Job id
        id: JobId,
    },
    /// Follow a job; the last output line is the table's digest
    Watch {
        /// Job id
        id: JobId,
    },
    /// Cancel a job
    Cancel {
        /// Job id
        id: JobId,
    },
}

fn parse_state(text: &str) -> Result<StateName, String> {
    serde_json::from_value(text.into()).map_err(|_| "use queued, running, done, failed or cancelled".to_owned())
}

/// Runs an action on jobs.
pub(super) fn run(action: &JobsAction, client: &Client, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    match action {
        JobsAction::Submit { recipe, watch } => {
            let document = input::recipe_document(recipe)?;
            let job = client.submit(&tabulated::uploaded(recipe, document, client)?)?;
            if *watch { follow(job.status.id, client, context) } else { show(&job, context) }
        }
        JobsAction::List { state, limit } => {
            for job in client.jobs(*state, *limit)? {
                show(&job, context)?;
            }
            Ok(Exit::Ok)
        }
        JobsAction::Show { id } => show(&client.job(*id)?, context),
        JobsAction::Watch { id } => follow(*id, client, context),
        JobsAction::Cancel { id } => show(&client.cancel(*id)?, context),
    }
}

fn show(job: &JobDocument, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    context.print(&job.json, &line(&job.status))
}

/// Follows a job to its end. Prints each update as JSON, or the table's digest at the end.
fn follow(id: JobId, client: &Client, context: &mut Context<'_>) -> Result<Exit, CommandFailure> {
    let bar = progress::bar(context.draws_progress, 0);
    let mut printed = Ok(Exit::Ok);
    let job = client.follow(id, &mut |update| {
        bar.set_length(update.status.progress.entries_total);
        bar.set_position(update.status.progress.entries_done);
        if context.json && printed.is_ok() {
            printed = context.print(&update.json, "");
        }
    })?;
    bar.finish_and_clear();
    match job.status.table {
        None => printed.and(Err(CommandFailure::new(Exit::JobFailed, line(&job.status)))),
        Some(_) if context.json => printed,
        Some(table) => context.print(&job.json, &table.to_string()),
    }
}

/// A job on one line: its id, its state, and the progress, digest or error of that state.
fn line(job: &JobStatus) -> String {
    let done = format!("{}/{}", job.progress.entries_done, job.progress.entries_total);
    let (state, matter) = match job.state {
        StateName::Queued => ("queued", done),
        StateName::Running => match job.progress.seconds_left {
            Some(seconds) => ("running", format!("{done}, {seconds:.0} s left")),
            None => ("running", done),
        },
        StateName::Done => ("done", job.table.map(|table| table.to_string()).unwrap_or_default()),
        StateName::Failed => ("failed", job.error.clone().unwrap_or_default()),
        StateName::Cancelled => ("cancelled", done),
    };
    format!("{} {state} {matter}", job.id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge_client::JobProgress;
    use ltcforge_files::digest::Digest;

    fn job(state: StateName) -> JobStatus {
        JobStatus {
            id: JobId::of_recipe(&Digest::from_bytes([0xab; 32])),
            state,
            progress: JobProgress { entries_done: 3, entries_total: 16, seconds_left: Some(1.6) },
            attempts: 1,
            table: None,
            error: Some("no room".into()),
        }
    }

    #[test]
    fn a_line_says_what_matters_in_each_state() {
        let id = "ab".repeat(16);
        assert_eq!(line(&job(StateName::Queued)), format!("{id} queued 3/16"));
        assert_eq!(line(&job(StateName::Running)), format!("{id} running 3/16, 2 s left"));
        assert_eq!(line(&job(StateName::Failed)), format!("{id} failed no room"));
        let done = JobStatus { table: Some(Digest::of(b"")), ..job(StateName::Done) };
        assert_eq!(line(&done), format!("{id} done {}", Digest::of(b"")));
    }
}
