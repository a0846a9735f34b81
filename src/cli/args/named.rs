//! Items of lists, by the names that they have everywhere.

use clap::builder::{PossibleValuesParser, TypedValueParser};

/// An item of a list by its name.
pub(crate) fn named<T: Copy + Send + Sync + 'static>(
    all: &'static [T],
    name: fn(T) -> &'static str,
) -> impl TypedValueParser<Value = T> {
    let named = move |text: String| all.iter().copied().find(|item| name(*item) == text).ok_or("no such name");
    PossibleValuesParser::new(all.iter().map(move |item| name(*item))).try_map(named)
}
