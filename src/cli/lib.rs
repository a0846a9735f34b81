//! The command line: parse, configure, run, exit code.
//!
//! Invariant: `cli` owns neither signals nor the environment; `main` passes both in. Logic that fits into
//! `ltcforge_server::service` belongs there.

mod args;
mod config_file;
mod context;
mod csv;
mod diff;
mod exit;
mod export;
mod fit;
mod input;
mod interrupt;
mod jobs;
mod light;
mod light_args;
mod light_case;
mod light_picture;
mod light_texture;
mod lock;
mod lookup;
mod lut;
mod occluders;
mod out_of_range;
mod output;
mod pins;
mod plan;
mod plot;
mod points;
mod preview;
mod progress;
mod pull;
mod report;
mod run;
mod sample;
mod server_args;
#[cfg(unix)]
mod service;
mod shader;
mod sources;
mod table_file;
mod tabulated;
mod tradeoff;
mod tradeoff_models;
mod values;
mod verify;
mod verify_export;

pub use args::{Cli, Command, OnInterrupt};
pub use context::Context;
pub use exit::{CommandFailure, Exit};
pub use interrupt::Interrupt;
pub use ltcforge_client::without_passwords;
pub use run::run;

use config_file::{ConfigFile, DEFAULT_SERVER};
use context::shown;
use csv::{CsvLines, LineFailure, Rows};
use exit::{failed, file_failure, lock_failure, mismatch, usage};
use export::ExportChoice;
use input::{AnyTable, TableChoice, TableFolder, TableLimit};
use out_of_range::{Clamped, clamped};
use output::{OutputFile, check_output_folder, listed, write_in};
use pins::{Fitting, Measured, asked_by, name_of, of_pin};
use sources::{SourceArgs, Sources};
use table_file::table_path;
use values::{Threads, named};
