//! The first lines of every text: licence, revision and digest.

use sha2::{Digest, Sha256};

use super::*;
use ltcforge_light::NormalsRule;

/// The first 16 digits of a digest.
fn digest(text: &str) -> String {
    let digest = Sha256::digest(text.as_bytes());
    let first = digest.first_chunk().expect("a digest has more bytes");
    format!("{:016x}", u64::from_be_bytes(*first))
}

/// Every shader text, with its name.
fn texts() -> Vec<(String, String)> {
    let all = includes().map(|(language, lit_by, text)| (format!("{} {lit_by:?}", language.name()), text));
    let mut texts: Vec<(String, String)> = all.collect();
    let function = IsotropicFunction::of(&planted_isotropic(Layout::Reflected)).expect("a function");
    let renamed = Namespace { prefix: "sheen".parse().ok(), first_binding: 6, group: 1 };
    for language in Language::ALL.iter().copied().filter(|language| language.has_includes()) {
        let name = language.name();
        let by_function =
            include_function(language, &function, &[], Lights::All, Additions::default(), &renamed).expect("a text");
        let by_table = include(language, Layout::Ltc2017, Reading::default(), Lights::All, &renamed).expect("a text");
        texts.extend([(format!("{name} function"), by_function), (format!("{name} ltc2017"), by_table)]);
    }
    for language in programs().filter(|language| *language != Language::Spirv) {
        texts.push((format!("{} program", language.name()), text(language, Layout::Reflected)));
        texts.push((format!("{} program", language.name()), text(language, lit_by(LightModel::Normals, None))));
    }
    texts
}

#[test]
fn every_text_states_licence_revision_and_the_digest_of_its_code() {
    let texts = texts();
    assert!(texts.len() > 100);
    for (name, text) in texts {
        let (comment, below) = text.split_once("\n\n").expect("a blank line");
        let mut lines = comment.lines().filter(|line| !line.starts_with("#version"));
        let licence = lines.next().expect("a line");
        let is_licence = licence.strip_prefix("// SPDX-License-Identifier: ");
        assert!(
            ["MIT OR Apache-2.0", "(MIT OR Apache-2.0) AND CC0-1.0"].map(Some).contains(&is_licence),
            "{name}: {licence}"
        );
        let [program, digest] = [format!("// ltcforge {}, revision ", env!("CARGO_PKG_VERSION")), digest(below)];
        let second =
            lines.next().and_then(|line| line.strip_prefix(&program)?.split_once(", sha256 of the text below: "));
        assert_eq!(second.map(|(revision, of_text)| (revision.len(), of_text)), Some((1, digest.as_str())), "{name}");
        assert!(lines.all(|line| line.starts_with("//")) && !text.contains("{digest}"), "{name}");
    }
}

#[test]
fn spirv_holds_the_digest_of_its_source() {
    let bytes = ported(Language::Spirv, Layout::Reflected);
    let text = String::from_utf8_lossy(&bytes);
    let source = &text[text.find("// SPDX").expect("a comment")..];
    let source = &source[..source.find('\0').expect("an end")];
    let (comment, below) = source.split_once("\n\n").expect("a blank line");
    assert!(comment.contains(&digest(below)), "{comment}");
}

/// Digests of each model's check. If a digest changes, the revision must be raised.
const VALUES: [(&str, u32, &str); 7] = [
    ("ltc", 1, "18aa316e979f73bf"),
    ("normals fast", 3, "13d290d8816a3504"),
    ("normals balanced", 3, "ec8047d79988f1a5"),
    ("normals fine", 3, "53d0d11bc4b62995"),
    ("ltc-formula", 1, "4823a6abc9e93467"),
    ("sg and asg", 1, "8b2ab91cc3f04ce4"),
    ("sg and asg by a table", 1, "a095c0d058a72397"),
];

#[test]
fn the_values_of_a_revision_do_not_change() {
    let normals = |rule| lit_by(LightModel::Normals, None).by_rule(Some(rule)).expect("a rule");
    let [fast, balanced, fine] = [NormalsRule::Fast, NormalsRule::Balanced, NormalsRule::Fine].map(normals);
    let table = lit_by(LightModel::Asg, Some(Layout::Reflected));
    let [formula, asg] = [LightModel::LtcFormula, LightModel::Asg].map(|model| lit_by(model, None));
    let models = [Layout::Reflected.into(), fast, balanced, fine, formula, asg, table];
    for (lit_by, (name, revision, values)) in models.into_iter().zip(VALUES) {
        let comment = lit_by.comment(Language::Wgsl);
        let found = digest(&comment[comment.find("CHECK").expect("a check")..]);
        assert!(comment.contains(&format!("revision {revision},")), "{name}");
        assert_eq!(found, values, "{name}: raise its revision, and update VALUES");
    }
}
