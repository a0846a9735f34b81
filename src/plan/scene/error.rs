//! Why a scene cannot be planned for.

use ltcforge_fit::GoOn;

/// Most faults that are told of one scene.
const MOST_FAULTS: usize = 50;

/// A fault of a glTF document, at a JSON pointer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SceneFault {
    /// Where in the document; empty for the whole.
    pub pointer: String,
    /// What is wrong, and what would be right.
    pub detail: String,
}

/// Why a scene cannot be planned for.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The scene's own file cannot be read.
    #[error("{detail}")]
    Open {
        /// The system's word.
        detail: String,
    },
    /// More than is read.
    #[error("{what}: {is}; at most {most} are read")]
    TooMuch {
        /// What there is too much of.
        what: String,
        /// How much there is.
        is: u64,
        /// How much is allowed.
        most: u64,
    },
    /// No glTF 2.0, or one with faults: as many as are told at once.
    #[error("{}", list(.0))]
    Faults(Vec<SceneFault>),
    /// A scene without a surface.
    #[error(
        "the scene has no surface with a lobe that a table could serve: no triangles, or none of a material with GGX"
    )]
    Empty,
    /// The caller's `go_on` said no.
    #[error("stopped")]
    Stopped,
}

fn list(faults: &[SceneFault]) -> String {
    let line = |fault: &SceneFault| match fault.pointer.as_str() {
        "" => fault.detail.clone(),
        pointer => format!("{pointer}: {}", fault.detail),
    };
    faults.iter().map(line).collect::<Vec<_>>().join("\n")
}

impl SceneError {
    /// One fault.
    pub(super) fn fault(pointer: impl Into<String>, detail: impl Into<String>) -> Self {
        Self::Faults(vec![SceneFault { pointer: pointer.into(), detail: detail.into() }])
    }

    /// An error where `go_on` says no.
    pub(super) fn unless(go_on: &GoOn<'_>) -> Result<(), Self> {
        if go_on() { Ok(()) } else { Err(Self::Stopped) }
    }

    /// An error where `is` is above `most`.
    pub(super) fn above(what: impl Into<String>, is: u64, most: u64) -> Result<(), Self> {
        if is > most { Err(Self::TooMuch { what: what.into(), is, most }) } else { Ok(()) }
    }
}

/// Where faults are noted.
#[derive(Debug, Default)]
pub(super) struct Faults(Vec<SceneFault>);

impl Faults {
    pub(super) fn note(&mut self, pointer: String, detail: String) {
        if self.0.len() < MOST_FAULTS {
            self.0.push(SceneFault { pointer, detail });
        }
    }

    /// An index into a list of the document.
    pub(super) fn index(&mut self, pointer: String, index: Option<usize>, list: &str, length: usize) {
        if let Some(index) = index.filter(|index| *index >= length) {
            self.note(pointer, format!("{index} is no index of {list}, which has {length}"));
        }
    }

    pub(super) fn none(self) -> Result<(), SceneError> {
        if self.0.is_empty() { Ok(()) } else { Err(SceneError::Faults(self.0)) }
    }
}
