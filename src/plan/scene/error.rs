//! Errors of reading a scene.

use ltcforge_files::recipe_document::Fault;
use ltcforge_fit::GoOn;

/// Maximum number of faults in one error.
const MOST_FAULTS: usize = 50;

/// Why a scene cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The scene's own file cannot be read.
    #[error(transparent)]
    Open(std::io::Error),
    /// The document is invalid or exceeds a limit. The error lists the first faults.
    #[error("{}", list(.0))]
    Faults(Vec<Fault>),
    /// A part of the scene is missing, or its format is not supported. The scene is read without it.
    #[error("{0}")]
    Missing(String),
    /// The scene has nothing to plan for.
    #[error("the scene has no surface that a table could serve: it needs triangles of a material with GGX or sheen")]
    Empty,
    /// The caller's `go_on` returned `false`.
    #[error("stopped")]
    Stopped,
}

fn list(faults: &[Fault]) -> String {
    let line = |Fault { pointer, detail }: &Fault| match pointer.as_str() {
        "" => detail.clone(),
        pointer => format!("{pointer}: {detail}"),
    };
    faults.iter().map(line).collect::<Vec<_>>().join("\n")
}

impl SceneError {
    /// One fault.
    pub(super) fn fault(pointer: impl Into<String>, detail: impl Into<String>) -> Self {
        Self::Faults(vec![Fault { pointer: pointer.into(), detail: detail.into() }])
    }

    /// An error if `go_on` returns `false`.
    pub(super) fn unless(go_on: &GoOn<'_>) -> Result<(), Self> {
        if go_on() { Ok(()) } else { Err(Self::Stopped) }
    }

    /// An error if `is` is above `most`.
    pub(super) fn above(what: impl Into<String>, is: u64, most: u64) -> Result<(), Self> {
        let what = what.into();
        if is > most { Err(Self::fault("", format!("{what}: {is}; at most {most} are allowed"))) } else { Ok(()) }
    }

    /// Separates missing parts from other errors. The inner error says why the part is missing.
    pub(super) fn split<T>(read: Result<T, Self>) -> Result<Result<T, String>, Self> {
        match read {
            Ok(part) => Ok(Ok(part)),
            Err(Self::Missing(why)) => Ok(Err(why)),
            Err(other) => Err(other),
        }
    }
}

/// Collects faults.
#[derive(Debug, Default)]
pub(super) struct Faults(Vec<Fault>);

impl Faults {
    pub(super) fn add(&mut self, pointer: impl Into<String>, detail: impl Into<String>) {
        self.extend(vec![Fault { pointer: pointer.into(), detail: detail.into() }]);
    }

    pub(super) fn extend(&mut self, faults: Vec<Fault>) {
        self.0.extend(faults);
        self.0.truncate(MOST_FAULTS);
    }

    /// Checks a number.
    pub(super) fn within(&mut self, pointer: String, value: f64, most: f64) {
        if !(0.0..=most).contains(&value) {
            self.add(pointer, format!("{value} is not between 0 and {most}"));
        }
    }

    /// Checks an index into a list of the document.
    pub(super) fn index<T>(&mut self, pointer: String, index: Option<usize>, name: &str, list: &[T]) {
        if let Some(index) = index.filter(|index| *index >= list.len()) {
            self.add(pointer, out_of_range(index, name, list));
        }
    }

    /// An error if there are faults.
    pub(super) fn none(self) -> Result<(), SceneError> {
        if self.0.is_empty() { Ok(()) } else { Err(SceneError::Faults(self.0)) }
    }
}

/// The fault of an index into a list of the document.
pub(super) fn out_of_range<T>(index: usize, name: &str, list: &[T]) -> String {
    format!("{index} is out of range: the document has {} {name}", list.len())
}

/// The start of a text of the document, for messages.
pub(super) fn shown(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).take(80).collect()
}

/// A name of the document for messages, or the default for a missing name.
pub(super) fn named(name: Option<&str>, default: impl FnOnce() -> String) -> String {
    name.map(shown).filter(|name| !name.trim().is_empty()).unwrap_or_else(default)
}
