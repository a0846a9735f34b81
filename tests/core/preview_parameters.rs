//! Checks that docs/preview.md and openapi.yaml agree with the declared parameters of a preview.
//!
//! `UPDATE_GOLDEN=preview_parameters cargo test --test core preview_parameters` updates both passages.

use std::{env, fs, path::Path};

use ltcforge::view::preview::{NamedScene, PARAMETERS, Parameter, ParameterForm, Scene};

/// Compares the lines of `file` between `begin` and `end` with `expected`. With `UPDATE_GOLDEN`, replaces them.
fn assert_passage(file: &str, [begin, end]: [&str; 2], expected: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let text = fs::read_to_string(&path).expect(file);
    let start = text.find(begin).expect(begin) + begin.len();
    let stop = start + text[start..].find(end).expect(end);
    if env::var("UPDATE_GOLDEN").is_ok_and(|name| name == "preview_parameters") {
        let updated = [&text[..start], expected, &text[stop..]].concat();
        fs::write(&path, updated).expect(file);
        return;
    }
    for (line, expected) in text[start..stop].lines().zip(expected.lines()) {
        assert_eq!(line, expected, "{file}");
    }
    assert_eq!(text[start..stop].lines().count(), expected.lines().count(), "{file}");
}

fn default(parameter: &Parameter) -> String {
    parameter.text(&Scene::default())
}

/// The table row of a named scene: the parameters that differ from scene `sphere`.
fn differences(named: NamedScene) -> String {
    let scene = named.scene();
    let differ = PARAMETERS.iter().filter(|parameter| parameter.text(&scene) != default(parameter));
    let texts: Vec<String> =
        differ.map(|parameter| format!("`{}={}`", parameter.name, parameter.text(&scene))).collect();
    format!("| `{}` | {} |\n", named.name(), texts.join(" "))
}

#[test]
fn the_docs_name_every_parameter() {
    const FILE: &str = "docs/preview.md";
    let page = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(FILE)).expect(FILE);
    for Parameter { name, .. } in &PARAMETERS {
        assert!(page.contains(&format!("`{name}`")), "{FILE} does not name {name}");
    }
    let scenes = NamedScene::ALL.iter().copied().filter(|named| *named != NamedScene::Sphere);
    // Parameters cannot describe scenes that differ in the number of materials.
    let scenes = scenes.filter(|named| named.scene().materials.len() == 1);
    let rows: String = scenes.map(differences).collect();
    assert_passage(FILE, ["| scene | differs in |\n|---|---|\n", "\n`figure14`"], &rows);
}

fn entry(parameter: &Parameter) -> String {
    let default = default(parameter);
    let number = |[low, high]: [f64; 2]| format!("type: number, minimum: {low}, maximum: {high}, default: {default}");
    let number_text = "[+-]?[0-9]+([.][0-9]+)?";
    let others = parameter.count().saturating_sub(1);
    let list =
        format!("type: string, pattern: \"^{number_text}(,{number_text}){{{others}}}$\", default: \"{default}\"");
    let schema = match parameter.form {
        ParameterForm::Name { names, .. } => format!("enum: [{}], default: {default}", names().join(", ")),
        ParameterForm::Whole([low, high], _) => {
            format!("type: integer, minimum: {low}, maximum: {high}, default: {default}")
        }
        ParameterForm::Flag(_) => format!("type: boolean, default: {default}"),
        ParameterForm::OneMaterial => "type: string".to_owned(),
        ParameterForm::Point(..) => list,
        ParameterForm::Numbers(..) if parameter.count() > 1 => list,
        ParameterForm::Numbers(bounds, _)
        | ParameterForm::OfMaterials(bounds, _)
        | ParameterForm::OfOneMaterial(bounds, _) => number(bounds),
    };
    let (line, name) = (parameter.line(), parameter.name);
    let (help, _) = line.split_once(" [default").expect("every line ends with the default");
    let help =
        if parameter.count() > 1 { format!("{help}: {}", parameter.value_name.to_lowercase()) } else { help.into() };
    format!("        - {{ name: {name}, in: query, description: \"{help}.\", schema: {{ {schema} }} }}\n")
}

#[test]
fn openapi_lists_every_parameter() {
    let entries: String = PARAMETERS.iter().map(entry).collect();
    // The passage starts after the command.
    assert_passage("openapi.yaml", ["preview_parameters`.\n", "        - *if_none_match\n"], &entries);
}
