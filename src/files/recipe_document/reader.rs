//! Reads fields of a JSON object and notes every fault instead of stopping at the first.

use std::f64::consts::FRAC_PI_2;

use serde_json::{Map, Value};

use super::fault::Fault;

/// Maximum length of an invalid value in an error message.
const LONGEST_ECHO: usize = 80;

/// The list of errors.
#[derive(Debug, Default)]
pub(super) struct Faults(pub(super) Vec<Fault>);

impl Faults {
    pub(super) fn note(&mut self, pointer: impl Into<String>, detail: impl Into<String>) {
        self.0.push(Fault { pointer: pointer.into(), detail: detail.into() });
    }
}

/// An object of a document, with its pointer.
#[derive(Debug, Clone)]
pub(super) struct Object<'a> {
    pointer: String,
    fields: Option<&'a Map<String, Value>>,
}

impl<'a> Object<'a> {
    /// The document's root. Fields that are not in `known` are errors.
    pub(super) fn root(value: &'a Value, known: &[&str], faults: &mut Faults) -> Self {
        Self::new(String::new(), Some(value), known, faults)
    }

    /// The object in `field`, with only the fields in `known`. It has no fields if it is missing or not an object.
    pub(super) fn object(&self, field: &str, known: &[&str], faults: &mut Faults) -> Self {
        Self::new(self.pointer(field), self.get(field), known, faults)
    }

    /// An item of a list, at its pointer, with only the fields in `known`.
    pub(super) fn item(pointer: String, value: &'a Value, known: &[&str], faults: &mut Faults) -> Self {
        Self::new(pointer, Some(value), known, faults)
    }

    fn new(pointer: String, value: Option<&'a Value>, known: &[&str], faults: &mut Faults) -> Self {
        let fields = match value {
            None => None,
            Some(Value::Object(fields)) => Some(fields),
            Some(other) => {
                let example =
                    if pointer.is_empty() { "; a recipe is one, such as {\"preset\": \"draft\"}" } else { "" };
                faults.note(&*pointer, format!("{} is not an object{example}", echo(other)));
                None
            }
        };
        for field in fields.into_iter().flat_map(Map::keys).filter(|field| !known.contains(&field.as_str())) {
            let detail = format!("unknown field; allowed: {}", known.join(", "));
            faults.note(format!("{pointer}/{}", escape(&shortened(field))), detail);
        }
        Self { pointer, fields }
    }

    pub(super) fn pointer(&self, field: &str) -> String {
        format!("{}/{}", self.pointer, escape(field))
    }

    pub(super) fn get(&self, field: &str) -> Option<&'a Value> {
        self.fields.and_then(|fields| fields.get(field))
    }

    /// A whole number from `low` to `high`.
    pub(super) fn integer(&self, field: &str, low: u64, high: u64, default: u64, faults: &mut Faults) -> u64 {
        let Some(value) = self.get(field) else { return default };
        if let Some(number) = value.as_u64().filter(|number| (low..=high).contains(number)) {
            return number;
        }
        faults.note(self.pointer(field), format!("{} is not a whole number from {low} to {high}", echo(value)));
        default
    }

    /// Like [`Object::integer`], for numbers that fit 32 bits.
    pub(super) fn integer32(&self, field: &str, low: u32, high: u32, default: u32, faults: &mut Faults) -> u32 {
        let number = self.integer(field, low.into(), high.into(), default.into(), faults);
        u32::try_from(number).unwrap_or(default)
    }

    /// A choice from several names.
    pub(super) fn choice<T: Copy>(&self, field: &str, choices: &[(&str, T)], default: T, faults: &mut Faults) -> T {
        let Some(value) = self.get(field) else { return default };
        let chosen = value.as_str().and_then(|name| choices.iter().find(|(choice, _)| *choice == name));
        if let Some((_, choice)) = chosen {
            return *choice;
        }
        let names = choices.iter().map(|(name, _)| format!("\"{name}\"")).collect::<Vec<_>>().join(", ");
        faults.note(self.pointer(field), format!("{} is not one of {names}", echo(value)));
        default
    }

    /// A number within `domain`.
    pub(super) fn number(&self, field: &str, domain: [f64; 2], default: f64, faults: &mut Faults) -> f64 {
        let Some(value) = self.get(field) else { return default };
        if let Some(number) = value.as_f64().filter(|number| (domain[0]..=domain[1]).contains(number)) {
            // -0 and 0 are equal numbers and must give the same recipe.
            return number + 0.0;
        }
        faults
            .note(self.pointer(field), format!("{} is not a number from {} to {}", echo(value), domain[0], domain[1]));
        default
    }

    /// Two numbers `[low, high]` within `domain`; `low` is not above `high`.
    pub(super) fn range(&self, field: &str, domain: [f64; 2], default: [f64; 2], faults: &mut Faults) -> [f64; 2] {
        let Some(value) = self.get(field) else { return default };
        let pointer = self.pointer(field);
        let [low, high] = match value.as_array().map(Vec::as_slice) {
            Some([low, high]) => [low, high].map(Value::as_f64),
            _ => [None; 2],
        };
        let (Some(low), Some(high)) = (low, high) else {
            faults.note(pointer, format!("{} is not a pair of numbers [low, high]", echo(value)));
            return default;
        };
        if low < domain[0] || high > domain[1] {
            let degrees = if domain[1] == FRAC_PI_2 { " in radians" } else { "" };
            faults.note(pointer, format!("{} is not within [{}, {}]{degrees}", echo(value), domain[0], domain[1]));
            return default;
        }
        if low > high {
            faults.note(pointer, format!("{} is reversed: the lower end must come first", echo(value)));
            return default;
        }
        // -0 and 0 are equal numbers and must give the same recipe.
        [low + 0.0, high + 0.0]
    }
}

/// A value as in the document, shortened.
pub(super) fn echo(value: &Value) -> String {
    shortened(&value.to_string())
}

fn shortened(text: &str) -> String {
    match text.char_indices().nth(LONGEST_ECHO) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// The text as a reference token of RFC 6901.
fn escape(field: &str) -> String {
    field.replace('~', "~0").replace('/', "~1")
}

/// The names of some items, as a list in an error.
pub(super) fn listed<T: Copy + std::fmt::Display>(items: &[T], keep: impl Fn(T) -> bool) -> String {
    let names = items.iter().filter(|item| keep(**item)).map(|item| format!("\"{item}\""));
    names.collect::<Vec<_>>().join(", ")
}
