//! Reads constants from source files.

/// The value of a constant in a source file. If it is a list, the item with this index.
#[must_use]
pub fn number(source: &str, name: &str, index: usize) -> Option<f64> {
    let declaration = source.split_once(&format!("const {name}:"))?.1.split_once(';')?;
    // The type of a list also contains a semicolon.
    let value = match declaration {
        (kind, rest) if kind.trim_start().starts_with('[') => rest.split_once('=')?.1.split(';').next()?,
        (kind, _) => kind.split_once('=')?.1,
    };
    parsed(value.trim().trim_matches(['[', ']']).split(',').nth(index)?)
}

/// The number of a field, from its first occurrence in a source file.
#[must_use]
pub fn field(source: &str, name: &str) -> Option<f64> {
    let is_number = |rest: &&str| rest.trim_start().starts_with(|c: char| c.is_ascii_digit());
    parsed(source.split(&format!("{name}:")).skip(1).find(is_number)?.split([',', '}', ' ']).find(|x| !x.is_empty())?)
}

fn parsed(text: &str) -> Option<f64> {
    text.trim().replace('_', "").parse().ok()
}

/// The first line of a source file that contains `start`, from `start` on.
#[must_use]
pub fn line<'a>(source: &'a str, start: &str) -> Option<&'a str> {
    source.lines().map(str::trim).find(|line| line.starts_with(start))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_from_sources() {
        let source = "/// Seconds.\nconst SORT_SECONDS: [f64; 2] = [12e-9, 4.5e-9];\npub const RATE: u32 = 1_000;\n";
        let found =
            [("SORT_SECONDS", 1), ("RATE", 0), ("RATE", 1), ("NONE", 0)].map(|(name, i)| number(source, name, i));
        assert_eq!(found, [Some(4.5e-9), Some(1000.0), None, None]);
        let source = "struct A { sample: f64 }\nCompared { sample: 10.0, error: 4.0 }";
        assert_eq!(
            [field(source, "sample"), field(source, "error"), field(source, "x")],
            [Some(10.0), Some(4.0), None]
        );
    }
}
