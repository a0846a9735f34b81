//! The crates that the program is made of: whether they may be shipped, and their list.
//!
//! ```sh
//! cargo run -p ltcforge-supply -- check
//! cargo run -p ltcforge-supply -- sbom --target x86_64-unknown-linux-gnu -o ltcforge.cdx.json
//! cargo run -p ltcforge-supply -- renew advisory-db
//! ```

mod check;
mod policy;
mod sbom;

use std::{
    error::Error,
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
};

use cargo_metadata::{Metadata, MetadataCommand};
use clap::Parser;
use rustsec::{Database, Lockfile};

use self::policy::Policy;

#[derive(Debug, Parser)]
enum Command {
    /// Say which crates deny.toml does not allow, and which have a known hole
    Check,
    /// Write the list of crates that the program is made of, for machines
    Sbom {
        /// The platform that it was built for
        #[arg(long)]
        target: String,
        /// The file to write
        #[arg(short)]
        output: PathBuf,
    },
    /// Replace the advisories by those of a clone of github.com/rustsec/advisory-db on our crates
    Renew {
        /// The clone
        database: PathBuf,
    },
}

/// The project's folder.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn advisories() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("advisories")
}

/// All crates that `Cargo.lock` has, or those for one platform.
fn metadata(target: Option<&str>) -> Result<Metadata, cargo_metadata::Error> {
    let mut options = vec!["--locked".to_owned()];
    options.extend(target.map(|target| format!("--filter-platform={target}")));
    MetadataCommand::new().manifest_path(root().join("Cargo.toml")).other_options(options).exec()
}

fn lockfile() -> Result<Lockfile, Box<dyn Error>> {
    Ok(Lockfile::load(root().join("Cargo.lock"))?)
}

/// The faults of this project's crates, a sentence each.
fn faults() -> Result<Vec<String>, Box<dyn Error>> {
    let policy: Policy = fs::read_to_string(root().join("deny.toml"))?.parse()?;
    let mut faults = check::licences_and_sources(&metadata(None)?, &policy);
    faults.extend(check::advisories(&Database::open(&advisories())?, &lockfile()?, &policy));
    Ok(faults)
}

/// Copies the advisories on crates of `Cargo.lock`, and removes those that are no longer there.
fn renew(database: &Path) -> Result<usize, Box<dyn Error>> {
    let (crates, mut copied) = (advisories().join("crates"), 0);
    // An unreadable clone leaves what is there.
    fs::read_dir(database.join("crates"))?;
    fs::remove_dir_all(&crates).or_else(|error| match error.kind() {
        std::io::ErrorKind::NotFound => Ok(()),
        _ => Err(error),
    })?;
    for package in lockfile()?.packages {
        let (from, to) = (database.join("crates").join(package.name.as_str()), crates.join(package.name.as_str()));
        if !from.is_dir() || to.is_dir() {
            continue;
        }
        fs::create_dir_all(&to)?;
        for entry in fs::read_dir(from)? {
            let entry = entry?;
            fs::copy(entry.path(), to.join(entry.file_name()))?;
            copied += 1;
        }
    }
    Ok(copied)
}

fn run(command: &Command) -> Result<ExitCode, Box<dyn Error>> {
    match command {
        Command::Check => {
            let faults = faults()?;
            for fault in &faults {
                eprintln!("{fault}");
            }
            Ok(if faults.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
        }
        Command::Sbom { target, output } => {
            let document = sbom::document(&metadata(Some(target))?, &lockfile()?)?;
            fs::write(output, serde_json::to_string_pretty(&document)? + "\n")?;
            Ok(ExitCode::SUCCESS)
        }
        Command::Renew { database } => {
            println!("{} advisories", renew(database)?);
            Ok(ExitCode::SUCCESS)
        }
    }
}

fn main() -> ExitCode {
    run(&Command::parse()).unwrap_or_else(|error| {
        eprintln!("{error}");
        ExitCode::FAILURE
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_crate_is_refused() {
        let faults = faults().unwrap();
        assert!(faults.is_empty(), "\n{}", faults.join("\n"));
    }
}
