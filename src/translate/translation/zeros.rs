//! Zeros of arrays in HLSL.

/// The text with the zeros of arrays in lists. naga writes them as casts, which glslang does not take.
pub(super) fn listed(text: &str) -> String {
    text.lines().fold(String::new(), |text, line| text + listed_in(line).as_deref().unwrap_or(line) + "\n")
}

/// `T name[N] = (T[N])0;` with its zeros in a list; `None` for another line.
fn listed_in(line: &str) -> Option<String> {
    let (declaration, cast) = line.split_once(" = (")?;
    let (kind, rest) = cast.split_once('[')?;
    let count: usize = rest.strip_suffix("])0;")?.parse().ok()?;
    Some(format!("{declaration} = {{ {} }};", vec![format!("({kind})0"); count].join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_of_an_array_are_listed_and_other_lines_stay() {
        let others = ["    LtcFold fold = (LtcFold)0;", "    float x = (a[1])*2.0;", "    uint y = (b[2] + c[0]);"];
        let text = format!("    float3 outline[3] = (float3[3])0;\n{}\n", others.join("\n"));
        let wanted = format!("    float3 outline[3] = {{ (float3)0, (float3)0, (float3)0 }};\n{}\n", others.join("\n"));
        assert_eq!(listed(&text), wanted);
    }
}
