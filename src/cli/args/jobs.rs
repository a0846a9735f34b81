//! `jobs`: commands to a server.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use ltcforge_files::job::{JobId, StateName};

/// `jobs`.
#[derive(Debug, Args)]
pub struct JobsArgs {
    /// The action
    #[command(subcommand)]
    pub action: JobsAction,
}

/// The commands on jobs.
#[derive(Debug, Subcommand)]
pub enum JobsAction {
    /// Submit a recipe
    Submit {
        /// A recipe's file, `-` for stdin, or the name of a preset
        recipe: PathBuf,
        /// Follow the job to its end; the last line of stdout is the table's digest
        #[arg(long)]
        watch: bool,
    },
    /// List jobs, newest first
    List {
        /// Only jobs in this state
        #[arg(long, value_parser = parse_state, value_name = "STATE")]
        state: Option<StateName>,
        /// List at most so many jobs
        #[arg(long, default_value_t = 50, value_name = "N")]
        limit: usize,
    },
    /// Show a job
    Show {
        /// The job
        id: JobId,
    },
    /// Follow a job to its end; the last line of stdout is the table's digest
    Watch {
        /// The job
        id: JobId,
    },
    /// Cancel a job
    Cancel {
        /// The job
        id: JobId,
    },
}

fn parse_state(text: &str) -> Result<StateName, String> {
    serde_json::from_value(text.into())
        .map_err(|_| "a state is one of queued, running, done, failed, cancelled".to_owned())
}
