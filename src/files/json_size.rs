//! Size limits of a JSON document, counted before it is parsed.
//!
//! A parsed object can take a hundred times as much memory as its text, so a limit on bytes alone does not bound
//! memory.

/// The limits of a document.
#[derive(Debug, Clone, Copy)]
pub struct JsonLimits {
    /// Maximum number of objects and lists.
    pub items: usize,
    /// Maximum number of values that follow another value in an object or a list.
    pub values: usize,
}

/// The document is above a limit.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{field}: more than {most} {kind}")]
pub struct TooMany {
    /// The field in which the limit was exceeded.
    pub field: String,
    /// The kind of items.
    pub kind: &'static str,
    /// The limit.
    pub most: usize,
}

/// Maximum length of a field's name in a message.
const LONGEST_FIELD: usize = 40;

impl JsonLimits {
    /// Counts without building values, and stops at the first limit. Text that is not JSON is counted too; the parser
    /// rejects it later.
    ///
    /// # Errors
    /// [`TooMany`] with the field of the document and the kind.
    pub fn check(&self, json: &[u8]) -> Result<(), TooMany> {
        let (mut items, mut values) = (0, 0);
        let (mut depth, mut at, mut field) = (0_usize, 0, &json[..0]);
        while let Some(byte) = json.get(at) {
            at += 1;
            let (count, kind, most) = match byte {
                b'"' => {
                    let start = at;
                    while json.get(at).is_some_and(|byte| *byte != b'"') {
                        at += if json[at] == b'\\' { 2 } else { 1 };
                    }
                    // A field's name, or a text before the next name.
                    if depth == 1 {
                        field = json.get(start..at).unwrap_or_default();
                    }
                    at += 1;
                    continue;
                }
                b'{' | b'[' => (&mut items, "objects and lists", self.items),
                b',' => (&mut values, "values", self.values),
                b'}' | b']' => {
                    depth = depth.saturating_sub(1);
                    continue;
                }
                _ => continue,
            };
            depth += usize::from(*byte != b',');
            *count += 1;
            if *count > most {
                let field = String::from_utf8_lossy(&field[..field.len().min(LONGEST_FIELD)]);
                return Err(TooMany { field: format!("/{field}"), kind, most });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_is_counted_and_texts_are_not() {
        let limits = JsonLimits { items: 4, values: 3 };
        let reported = |json: &str| limits.check(json.as_bytes()).map_err(|error| error.to_string());
        for fine in [r#"{"a": [{}], "b": [1]}"#, r#"{"a": "[[[{{{,,,,,\"{{{", "b": 1}"#, "", "\"", "\"\\", "]]}}"] {
            assert_eq!(reported(fine), Ok(()), "{fine}");
        }
        for (json, error) in [
            (r#"{"a": 1, "nodes": [{}, {}, {}]}"#, "/nodes: more than 4 objects and lists"),
            (r#"{"a": [[], [], []]}"#, "/a: more than 4 objects and lists"),
            (r#"{"a": [1, 2, 3, 4, 5]}"#, "/a: more than 3 values"),
        ] {
            assert_eq!(reported(json), Err(error.to_owned()));
        }
    }
}
