//! Reads the parameters of a picture from texts, such as a query string.
//!
//! Invariant: every fault is listed, not only the first.

use serde::Serialize;

/// A rejected parameter.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ParameterFault {
    /// The parameter's name.
    pub parameter: String,
    /// The fault, without the parameter's name.
    pub detail: String,
}

impl ParameterFault {
    /// A fault of the parameter `name`.
    #[must_use]
    pub fn new(name: &str, detail: impl Into<String>) -> Self {
        Self { parameter: name.to_owned(), detail: detail.into() }
    }

    /// The fault of a parameter that appears more than once.
    #[must_use]
    pub fn repeated(name: &str) -> Self {
        Self::new(name, "is given more than once")
    }
}

/// Calls `set` with each (name, text) pair. Returns every fault: the texts that `set` rejected, and the names that
/// appear more than once.
pub fn read_pairs<'a>(
    pairs: impl IntoIterator<Item = (&'a str, &'a str)>,
    mut set: impl FnMut(&str, &str) -> Result<(), String>,
) -> Vec<ParameterFault> {
    let (mut faults, mut names) = (Vec::new(), Vec::new());
    for (name, text) in pairs {
        if names.contains(&name) {
            faults.push(ParameterFault::repeated(name));
        } else if let Err(detail) = set(name, text) {
            faults.push(ParameterFault::new(name, detail));
        }
        names.push(name);
    }
    faults
}
