//! The name prefix and the first binding of a shader text. They let one shader include several texts.

use std::str::FromStr;

use super::{Language, LitBy};

/// The names and bindings of a shader text within the shader that includes it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Namespace {
    /// The prefix of every name, instead of `ltc`, `normals` or `gaussians`.
    pub prefix: Option<Prefix>,
    /// The number of the first binding. The other bindings follow. Texts without numbered bindings ignore it.
    pub first_binding: u16,
    /// The group of the bindings. Vulkan calls it a set, and HLSL a space. OpenGL only has group 0.
    pub group: u16,
}

/// A prefix for names: `sheen` gives `sheen_lookup`, `SheenLobe` and `SHEEN_LEAST_ALPHA`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Prefix(String);

/// The text is not a valid prefix.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "the prefix «{}» is invalid: use at most {LONGEST} lower-case letters and digits, beginning with a letter; \
    {} are reserved", .0.escape_debug(), RESERVED.join(" and ")
)]
pub struct BadPrefix(pub String);

const LONGEST: usize = 32;
/// Prefixes that shading languages reserve.
const RESERVED: [&str; 2] = ["gl", "metal"];

impl FromStr for Prefix {
    type Err = BadPrefix;

    fn from_str(text: &str) -> Result<Self, BadPrefix> {
        let is_allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit();
        let begins = text.starts_with(|c: char| c.is_ascii_lowercase());
        let is_good = begins && text.len() <= LONGEST && text.chars().all(is_allowed) && !RESERVED.contains(&text);
        if is_good { Ok(Self(text.to_owned())) } else { Err(BadPrefix(text.to_owned())) }
    }
}

impl Namespace {
    /// `text` with the prefix in all names, both in the light's own code and in the arithmetic that all lights share.
    #[must_use]
    pub fn named(&self, text: &str, lit_by: LitBy) -> String {
        let own = lit_by.shader().prefix;
        let prefix = self.prefix.as_ref().map_or(own, |Prefix(prefix)| prefix);
        identifiers(text, |name, rest| {
            // Comments mention files of `shaders/`, and these names do not change.
            if rest.starts_with(".wgsl") {
                return None;
            }
            // Tables of LTCs and of Gaussians share the code that reads them. A shader may include both.
            if lit_by.layout().is_some() && own != "ltc" {
                if name.starts_with("Ltc") {
                    return Some(format!("{}{name}", capital(prefix)));
                }
                if name.starts_with("LTC_") {
                    return Some(format!("{}_{name}", prefix.to_uppercase()));
                }
            }
            let shared = || name.starts_with("ltc_").then(|| format!("{prefix}_{name}"));
            with_prefix(name, own, prefix).or_else(shared)
        })
    }

    /// The code with its bindings numbered from the first binding, in the group. Languages other than WGSL omit group
    /// 0.
    #[must_use]
    pub fn bound(&self, code: &str, language: Language) -> String {
        let group = self.group;
        let written = |text: String| if group == 0 { String::new() } else { text };
        let (sign, classes, before, behind): (_, &[char], _, _) = match language {
            Language::Wgsl => ("@group(0) @binding(", &[], format!("@group({group}) @binding("), String::new()),
            Language::Glsl => ("binding = ", &[], written(format!("set = {group}, ")) + "binding = ", String::new()),
            Language::Hlsl => {
                ("register(", &['b', 's', 't', 'u'], "register(".to_owned(), written(format!(", space{group}")))
            }
            Language::Glsl330 | Language::GlslEs | Language::Msl | Language::Spirv => return code.to_owned(),
        };
        let mut parts = code.split(sign);
        let mut out = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            let digits = part.strip_prefix(classes).unwrap_or(part);
            let after = digits.trim_start_matches(|c: char| c.is_ascii_digit());
            let class = &part[..part.len() - digits.len()];
            match digits[..digits.len() - after.len()].parse::<u32>() {
                Ok(number) => {
                    let number = (number + u32::from(self.first_binding)).to_string();
                    out.extend([before.as_str(), class, &number, &behind, after]);
                }
                Err(_) => out.extend([sign, part]),
            }
        }
        out
    }

    /// Fills in the bindings `{0}`, `{1}` and so on, and the group `{group}`, in a sentence.
    pub(super) fn numbered(&self, sentence: &str) -> String {
        (0..6).fold(sentence.replace("{group}", &self.group.to_string()), |text, n: u32| {
            text.replace(&format!("{{{n}}}"), &(n + u32::from(self.first_binding)).to_string())
        })
    }
}

/// The text with a capital first letter, as in type names. Domain: it starts with an ASCII letter.
fn capital(text: &str) -> String {
    text[..1].to_uppercase() + &text[1..]
}

/// The text with prefix `to` instead of `from` in all names.
pub(super) fn prefixed(text: &str, from: &str, to: &str) -> String {
    identifiers(text, |name, _| with_prefix(name, from, to))
}

/// The name of a function, type or constant with prefix `to` instead of `from`. `None` for other names.
fn with_prefix(name: &str, from: &str, to: &str) -> Option<String> {
    if let Some(rest) = name.strip_prefix(from).filter(|rest| rest.starts_with('_')) {
        return Some(format!("{to}{rest}"));
    }
    if let Some(rest) = name.strip_prefix(&from.to_uppercase()).filter(|rest| rest.starts_with('_')) {
        return Some(format!("{}{rest}", to.to_uppercase()));
    }
    let rest = name.strip_prefix(&capital(from))?;
    rest.starts_with(|c: char| c.is_ascii_uppercase()).then(|| format!("{}{rest}", capital(to)))
}

/// The text with identifiers replaced. `of` takes each identifier and the text after it, and returns the new name.
fn identifiers(text: &str, of: impl Fn(&str, &str) -> Option<String>) -> String {
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let (mut out, mut rest) = (String::with_capacity(text.len()), text);
    while let Some(start) = rest.find(is_part) {
        out += &rest[..start];
        let word = &rest[start..];
        let (name, after) = word.split_at(word.find(|c| !is_part(c)).unwrap_or(word.len()));
        let replaced = (!name.starts_with(|c: char| c.is_ascii_digit())).then(|| of(name, after)).flatten();
        out += replaced.as_deref().unwrap_or(name);
        rest = after;
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge_fit::Layout;
    use ltcforge_light::LightModel;

    #[test]
    fn whole_names_get_a_prefix_but_parts_of_names_do_not() {
        let namespace = |prefix: &str| Namespace { prefix: prefix.parse().ok(), ..Namespace::default() };
        let ltc = |prefix, text: &str| namespace(prefix).named(text, Layout::Reflected.into());
        assert_eq!(
            ltc("a1", "ltc_x(LtcY, LtcYOf, LTC_Z, my_ltc_x, ltcforge, Ltcx, 0ltc_)"),
            "a1_x(A1Y, A1YOf, A1_Z, my_ltc_x, ltcforge, Ltcx, 0ltc_)"
        );
        assert_eq!(ltc("", "ltc_x ltc_math.wgsl"), "ltc_x ltc_math.wgsl");
        let normals = LitBy::new(LightModel::Normals, None).expect("a formula");
        let normals = |text: &str| Namespace::default().named(text, normals);
        assert_eq!(normals("normals_x NormalsY ltc_log normals"), "normals_x NormalsY normals_ltc_log normals");
    }

    #[test]
    fn bindings_count_from_the_first() {
        let namespace = Namespace { first_binding: 10, ..Namespace::default() };
        assert_eq!(namespace.bound("register(t2); register(s5)", Language::Hlsl), "register(t12); register(s15)");
        assert_eq!(
            namespace.bound("@group(0) @binding(4) var x: a;", Language::Wgsl),
            "@group(0) @binding(14) var x: a;"
        );
        assert_eq!(namespace.bound("layout(std140, binding = 0) x", Language::Glsl), "layout(std140, binding = 10) x");
        assert_eq!(namespace.numbered("nodes {1}, {x}"), "nodes 11, {x}");
    }

    #[test]
    fn bindings_are_in_the_group() {
        let namespace = Namespace { group: 2, ..Namespace::default() };
        assert_eq!(namespace.bound("register(t2); register(x)", Language::Hlsl), "register(t2, space2); register(x)");
        assert_eq!(
            namespace.bound("@group(0) @binding(4) var x: a;", Language::Wgsl),
            "@group(2) @binding(4) var x: a;"
        );
        assert_eq!(
            namespace.bound("layout(std140, binding = 0) x", Language::Glsl),
            "layout(std140, set = 2, binding = 0) x"
        );
        assert_eq!(namespace.bound("binding = 0", Language::GlslEs), "binding = 0");
        assert_eq!(namespace.numbered("group {group}: {0}"), "group 2: 0");
    }

    #[test]
    fn reserved_prefixes_are_rejected() {
        for wrong in ["", "1a", "A", "a_b", "ä", "gl", "metal", &"a".repeat(33)] {
            let error = wrong.parse::<Prefix>().expect_err(wrong).to_string();
            assert!(error.contains(&format!("«{wrong}»")) && error.contains("lower-case"), "{error}");
        }
    }
}
