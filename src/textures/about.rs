//! The comment in an exported file that describes its contents.

use ltcforge_files::{digest::Digest, manifest::MeanError, recipe_document};
use ltcforge_fit::{BrdfKind, Recipe, ShaderAxes};
use serde_json::{Value, json};

/// The licence of the numbers. Tables are facts about a BRDF, and anyone may ship them without permission.
const LICENCE: &str = "licence of the numbers: CC0-1.0";

/// The licence of tables for `fuzz`. Their lobes are published numbers, not a fit.
const FUZZ: &str = "licence of the numbers: Apache-2.0, that of the lobes of fuzz: Zeltner, Burley, Chiang 2022, by the functions of MaterialX 1.39";

/// The papers on which the tables are based.
const PAPERS: [&str; 2] = [
    "Heitz, Dupuy, Hill, Neubelt: Real-Time Polygonal-Light Shading with Linearly Transformed Cosines, 2016",
    "KT, Heitz, Dupuy, Narayanan: Bringing Linearly Transformed Cosines to Anisotropic GGX, 2022",
];

/// The number of hexadecimal digits by which names identify a table.
const DIGITS: usize = 8;

/// The vectors of f32 in binding 0. Two vectors of u32 come before them.
const FLOAT_VECTORS: [&str; 7] = ["start", "spacing", "per_step", "texel", "roughness", "cosines", "azimuths"];

/// Lines of text for people. Each exported file contains them, if its format has room for comments. Lines have no
/// control characters.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct About {
    lines: Vec<String>,
    table: Option<Digest>,
    /// The recipe in canonical JSON.
    recipe: Option<String>,
    layout: Option<&'static str>,
    /// The words of binding 0, if the shader of `ltcforge shader` reads the textures.
    uniform: Option<[u32; 36]>,
}

impl About {
    /// A comment with these lines. A line break within a line starts a new line, and other control characters become
    /// spaces.
    pub fn new(lines: impl IntoIterator<Item = impl AsRef<str>>) -> Self {
        let mut clean = Vec::new();
        for line in lines {
            clean.extend(line.as_ref().lines().map(|line| {
                line.chars()
                    .map(|c| if c.is_control() || is_break(c) { ' ' } else { c })
                    .collect::<String>()
                    .trim_end()
                    .to_owned()
            }));
        }
        Self { lines: clean, ..Self::default() }
    }

    /// A comment with the known facts about a table: its digest, its recipe's digest, its mean error between nodes
    /// (`report.between` of its manifest), the licence and the papers.
    #[must_use]
    pub fn of_table(table: Digest, recipe: Option<&Recipe>, error: Option<MeanError>) -> Self {
        let mut lines = vec![format!("ltcforge {}", env!("CARGO_PKG_VERSION")), format!("table {table}")];
        let document = recipe.map(recipe_document::canonical_json);
        lines.extend(document.as_ref().map(|document| format!("recipe {}", Digest::of(document.as_bytes()))));
        // Files for GGX do not name their BRDF. Otherwise their bytes would differ from those of earlier versions.
        let brdf = recipe.map(Recipe::brdf).filter(|brdf| *brdf != BrdfKind::Ggx);
        lines.extend(brdf.map(|brdf| format!("brdf {brdf}")));
        let fresnel = recipe.map(|recipe| recipe.model().fresnel()).filter(|fresnel| !fresnel.is_one());
        lines.extend(fresnel.map(|fresnel| format!("lobe of {fresnel}")));
        lines.extend(error.map(|MeanError { width, places }| {
            format!("mean error between nodes: {width:.4} of the lobe's width, at {places} places")
        }));
        lines.push(if brdf == Some(BrdfKind::Fuzz) { FUZZ } else { LICENCE }.to_owned());
        lines.extend(PAPERS.map(str::to_owned));
        Self { table: Some(table), recipe: document, ..Self::new(lines) }
    }

    /// A comment with the known facts about a lookup table: its digest, its recipe in canonical JSON, and a line about
    /// the exported numbers.
    pub(super) fn of_lut(table: Digest, recipe: String, error: String) -> Self {
        let lines = [
            format!("ltcforge {}", env!("CARGO_PKG_VERSION")),
            format!("table {table}"),
            format!("recipe {}", Digest::of(recipe.as_bytes())),
            error,
            LICENCE.to_owned(),
        ];
        Self { table: Some(table), recipe: Some(recipe), ..Self::new(lines) }
    }

    /// The recipe of the table in canonical JSON, if it is known.
    pub(super) fn recipe(&self) -> Option<&str> {
        self.recipe.as_deref()
    }

    /// The same comment, with the layout in the suffix of names.
    #[must_use]
    pub fn of_layout(self, layout: &'static str) -> Self {
        Self { layout: Some(layout), ..self }
    }

    /// The same comment, for textures that the shader of `ltcforge shader` reads.
    pub(super) fn for_shader(self, axes: &ShaderAxes) -> Self {
        Self { uniform: Some(axes.words()), ..self }
    }

    /// The words of binding 0 of our shader, if it reads the textures.
    pub(super) fn uniform(&self) -> Option<&[u32; 36]> {
        self.uniform.as_ref()
    }

    /// The words of binding 0 as JSON: vectors by name, in order.
    pub(super) fn uniform_json(&self) -> Option<Value> {
        let [integers, floats] = [0, 8].map(|start| self.uniform.as_ref().map(|words| words[start..].chunks(4)));
        let integers = ["nodes", "reading"].into_iter().zip(integers?).map(|(name, words)| (name, json!(words)));
        let floats = FLOAT_VECTORS
            .into_iter()
            .zip(floats?)
            .map(|(name, words)| (name, words.iter().map(|word| json!(f32::from_bits(*word))).collect()));
        Some(
            integers
                .chain(floats)
                .map(|(name, vector)| (name.to_owned(), vector))
                .collect::<serde_json::Map<_, _>>()
                .into(),
        )
    }

    /// A suffix that distinguishes this table's names in code from those of other tables. It is the layout and the
    /// first digits of the table's digest, if they are known, each after an underscore. It has only ASCII letters,
    /// digits and underscores.
    pub(super) fn suffix(&self) -> String {
        let digits = self.table.map(|table| table.hex()[..DIGITS].to_owned());
        let parts = self.layout.map(|layout| layout.replace('-', "_")).into_iter().chain(digits);
        parts.flat_map(|part| ["_".to_owned(), part]).collect()
    }

    /// The same comment with more lines.
    #[must_use]
    pub fn and(mut self, lines: impl IntoIterator<Item = impl AsRef<str>>) -> Self {
        self.lines.extend(Self::new(lines).lines);
        self
    }

    /// The lines.
    #[must_use]
    pub fn lines(&self) -> &[String] {
        &self.lines
    }

    /// The lines as a comment in code, each after `//`.
    #[must_use]
    pub(super) fn comment(&self) -> String {
        // In C, a backslash at the end of a line would continue the comment.
        self.lines.iter().map(|line| format!("// {line}").trim_end_matches(['\\', ' ']).to_owned() + "\n").collect()
    }
}

/// Whether a character that is not a control character ends a line in some languages, and therefore a comment.
fn is_break(c: char) -> bool {
    matches!(c, '\u{2028}' | '\u{2029}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_in_code_differ_between_layouts_and_tables() {
        let of = |bytes: &[u8], layout| About::of_table(Digest::of(bytes), None, None).of_layout(layout).and(["more"]);
        assert_eq!(of(b"abc", "reflected-array").suffix(), "_reflected_array_ba7816bf");
        assert_ne!(of(b"abc", "ltc2017").suffix(), of(b"abd", "ltc2017").suffix());
        assert_eq!(About::new(["a line"]).suffix(), "");
    }

    /// A table for fuzz has published numbers with their own licence.
    #[test]
    fn one_licence_is_stated() {
        for (brdf, licence) in
            [(BrdfKind::Ggx, "CC0-1.0"), (BrdfKind::Charlie, "CC0-1.0"), (BrdfKind::Fuzz, "Apache-2.0")]
        {
            let document = format!(r#"{{"brdf": "{brdf}"}}"#);
            let recipe = recipe_document::parse(document.as_bytes(), 1_000_000).expect("a recipe");
            let about = About::of_table(Digest::of(b""), Some(&recipe), None);
            let reported: Vec<_> = about.lines().iter().filter(|line| line.starts_with("licence")).collect();
            assert!(reported.len() == 1 && reported[0].contains(licence), "{brdf}: {reported:?}");
        }
    }

    /// The comment states the number of places, because the mean over few places can be twice the mean over many.
    #[test]
    fn the_error_is_stated_with_the_number_of_places() {
        let about = About::of_table(Digest::of(b""), None, Some(MeanError { width: 0.046_98, places: 512 }));
        let line = "mean error between nodes: 0.0470 of the lobe's width, at 512 places";
        assert!(about.lines().iter().any(|own| own == line), "{about:?}");
    }

    #[test]
    fn no_line_ends_a_comment() {
        let about = About::new(["one\ntwo", "a\u{2028}b\u{7}c\r", "\\"]);
        assert_eq!(about.lines(), ["one", "two", "a b c", "\\"]);
        let comment = about.comment();
        assert_eq!(comment.lines().count(), 4);
        assert!(comment.lines().all(|line| line.starts_with("//") && !line.ends_with('\\')), "{comment}");
    }
}
