//! The policy for crates, as `deny.toml` has it.

use std::str::FromStr;

use rustsec::advisory::Id;
use serde::Deserialize;
use spdx::Licensee;

/// The parts of the file that [`super::check`] goes by.
#[derive(Debug)]
pub(crate) struct Policy {
    /// Licences of which each crate allows one, or all that it asks for at once.
    pub(crate) licences: Vec<Licensee>,
    /// Where crates come from.
    pub(crate) registries: Vec<String>,
    /// Advisories that somebody has looked at.
    pub(crate) ignored: Vec<Id>,
}

#[derive(Deserialize)]
struct File {
    licenses: Licences,
    sources: Sources,
    advisories: Advisories,
}

#[derive(Deserialize)]
struct Licences {
    allow: Vec<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
struct Sources {
    allow_registry: Vec<String>,
}

#[derive(Deserialize)]
struct Advisories {
    ignore: Vec<Ignored>,
}

#[derive(Deserialize)]
struct Ignored {
    id: String,
    /// Without one the file is refused.
    #[serde(rename = "reason")]
    _reason: String,
}

impl FromStr for Policy {
    type Err = Box<dyn std::error::Error>;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let file: File = toml_edit::de::from_str(text)?;
        let licence = |name: &String| Licensee::parse(name).map_err(|error| format!("licence {name}: {error}"));
        Ok(Self {
            licences: file.licenses.allow.iter().map(licence).collect::<Result<_, _>>()?,
            registries: file.sources.allow_registry,
            ignored: file.advisories.ignore.iter().map(|ignored| ignored.id.parse()).collect::<Result<_, _>>()?,
        })
    }
}
