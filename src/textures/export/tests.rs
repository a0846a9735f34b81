use std::{collections::BTreeSet, ops::ControlFlow};

use super::*;
use ltcforge_files::{
    compact::planted::{planted, unmeasured},
    digest::Digest,
    recipe_document,
};
use ltcforge_fit::{BrdfKind, Layout, LobeModel, Plan, Recipe, Terms, fit_plan};

fn table(document: &str) -> Table {
    let recipe = recipe_document::parse(document.as_bytes(), 10_000).expect("a recipe");
    fit_plan(&Plan::new(&recipe), &|_| ControlFlow::Continue(())).expect("a table")
}

#[test]
fn a_name_belongs_to_one_export() {
    let all: Vec<Export> = Export::all().collect();
    let names: BTreeSet<String> = all.iter().map(ToString::to_string).collect();
    assert_eq!(names.len(), all.len());
    assert!(all.iter().all(|export| export.to_string().parse() == Ok(*export)));
    for wrong in
        ["", "unity", "ltc2017", "ltc2017.ktx2", "ltc2017.ktx2.f64", "ltc2017.ktx2.f16.", "Three", "compact.f16"]
    {
        let error = wrong.parse::<Export>().expect_err(wrong).to_string();
        assert!(
            error.contains(&format!("«{wrong}»")) && error.contains("ktx2-zstd") && error.contains("compact-wgsl"),
            "{error}"
        );
    }
}

#[test]
fn matrices_without_an_inverse_are_counted_and_the_first_is_named() {
    let mut table = planted(Layout::Reflected, [3, 2, 3, 2], true, |_, _| 0.0);
    for entry in [9, 4] {
        table.matrix[entry] = [1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 0.0, 1.0];
    }
    for name in ["wgpu", "reflected.npy.f16", "compact"] {
        let export: Export = name.parse().expect("an export");
        let error = export.bundle(&table, About::default()).expect_err(name);
        assert!(matches!(error, ExportError::Singular { count: 2, entry: 4, .. }), "{name}: {error}");
        assert_eq!(export.layout(&table), Err(error));
    }
}

/// An engine's shader has the formulas of GGX, so engines reject a table for sheen. Our shader and plain textures
/// accept any model.
#[test]
fn engines_only_accept_tables_for_ggx() {
    let mut table = table(r#"{"layout": "godot", "resolution": {"alpha": 2, "theta": 2}}"#);
    table.brdf = BrdfKind::Charlie.into();
    let export = |name: &str| name.parse::<Export>().expect("an export");
    let refused = export("godot").layout(&table).expect_err("not for GGX").to_string();
    assert!(refused.contains("brdf charlie") && refused.contains("--layout godot"), "{refused}");
    let refused = export("compact").layout(&table).expect_err("not near a reflection").to_string();
    assert!(refused.contains("brdf charlie"), "{refused}");
    assert!(export("wgpu").layout(&table).is_ok() && export("godot.ktx2.f32").layout(&table).is_ok());
}

/// Engines and decoders only support LTCs. Tables of Gaussians can be exported as plain numbers for a shader with
/// Gaussians.
#[test]
fn engines_and_decoders_reject_gaussians() {
    let small =
        r#"{"resolution":{"alpha":2,"ratio":2,"theta":2,"phi":2},"fit":{"samples":64,"directions":4,"steps":5}}"#;
    let table = Table { lobe: ltcforge_fit::LobeModel::Asg, ..table(small) };
    let export = |name: &str| name.parse::<Export>().expect("an export");
    for name in ["wgpu", "compact"] {
        let refused = export(name).layout(&table).expect_err("no LTCs").to_string();
        assert!(refused.contains("lobe asg"), "{name}: {refused}");
    }
    assert!(export("reflected.ktx2.f32").layout(&table).is_ok());
}

#[test]
fn errors_name_a_recipe_with_the_requested_textures() {
    let fit = r#""fit":{"samples":64,"directions":4,"steps":5}"#;
    let own = table(&format!(r#"{{"resolution":{{"alpha":2,"ratio":2,"theta":2,"phi":2}},{fit}}}"#));
    let small = table(&format!(r#"{{"layout":"ltc2017","resolution":{{"alpha":2,"theta":2}},{fit}}}"#));
    let theirs =
        table(&format!(r#"{{"layout":"kt2022","resolution":{{"alpha":2,"ratio":2,"theta":2,"phi":2}},{fit}}}"#));
    let godot = table(&format!(r#"{{"layout":"godot","resolution":{{"alpha":2,"theta":2}},{fit}}}"#));
    let refusal = |name: &str, table: &Table| {
        let export: Export = name.parse().expect("an export");
        export.bundle(table, About::default()).expect_err(name)
    };
    for (name, table, recipe) in [
        ("three", &own, r#"{"layout": "ltc2017"}"#),
        ("kt2022.dds.f32", &own, r#"{"layout": "kt2022"}"#),
        ("ltc2016-3d.ktx2.f32", &small, r#"{"layout": "ltc2016"}"#),
        ("three", &small, r#"{"layout": "ltc2017"}"#),
        ("compact-rust", &theirs, r#"{"layout": "reflected"}"#),
        ("compact", &godot, r#"{"layout": "ltc2017"}"#),
    ] {
        let refused = refusal(name, table);
        assert_eq!(refused.recipe(), Some(recipe), "{name}: {refused}");
        assert!(refused.to_string().contains(recipe), "{name}: {refused}");
    }
    for name in ["wgpu", "reflected.npz.f16", "compact-wgsl"] {
        let export: Export = name.parse().expect("an export");
        assert!(!export.bundle(&own, About::default()).expect(name).files.is_empty());
    }
    for table in [&small, &theirs, &godot] {
        let wgpu: Export = "wgpu".parse().expect("an export");
        assert_eq!(wgpu.bundle(table, About::default()).expect("every layout").files.len(), 5);
    }
}

#[test]
fn every_export_has_a_manifest_of_its_files() {
    let table = planted(Layout::Reflected, [3, 2, 3, 2], true, |_, _| 0.0);
    for name in ["wgpu", "reflected.npy.f16", "reflected.dds.f32", "reflected.npz.f16", "compact", "compact-rust"] {
        let export: Export = name.parse().expect("an export");
        let about = About::new(["table 1234"]);
        // A planted table has no measured error.
        let made = match export {
            Export::Compact(container) => Export::compact_bundle(container, vec![unmeasured(&table)], &about),
            Export::Engine(_) | Export::Textures { .. } | Export::Lut(_) => export.bundle(&table, about),
        };
        let Bundle { files, steps } = made.expect(name);
        let (manifest, others) = files.split_last().expect("files");
        assert_eq!(manifest.path, "ltcforge.json", "{name}");
        let manifest: serde_json::Value = serde_json::from_slice(&manifest.bytes).expect("JSON");
        let key = if name == "wgpu" { "for" } else { "export" };
        assert_eq!((&manifest[key], &manifest["about"][0]), (&name.into(), &"table 1234".into()));
        assert_eq!(manifest["steps"], serde_json::json!(steps), "{name}");
        assert_eq!(manifest["files"].as_array().map(Vec::len), Some(others.len()), "{name}");
        for (reported, file) in manifest["files"].as_array().expect("files").iter().zip(others) {
            assert_eq!((&reported["path"], &reported["bytes"]), (&file.path.as_str().into(), &file.bytes.len().into()));
            assert_eq!(reported["sha256"], Digest::of(&file.bytes).hex(), "{name}: {}", file.path);
            assert_eq!(reported["rounding"], serde_json::json!(file.rounding), "{name}: {}", file.path);
        }
    }
}

#[test]
fn the_forms_of_an_export_match_its_files() {
    let own = planted(Layout::Reflected, [3, 2, 3, 2], true, |_, _| 0.0);
    let theirs = planted(Layout::Ltc2017, [64, 1, 64, 1], true, |_, _| 0.0);
    let mut seen = 0;
    for (table, export) in [&own, &theirs].iter().flat_map(|table| Export::all().map(move |export| (table, export))) {
        let about = About::new(["table 1234"]);
        let made = match export {
            Export::Compact(container) => Export::compact_bundle(container, vec![unmeasured(table)], &about).ok(),
            // The forms of different layouts differ only in numbers.
            Export::Textures { layout, .. } if layout.sampling().table != table.layout => None,
            Export::Engine(_) | Export::Textures { .. } | Export::Lut(_) => export.bundle(table, about).ok(),
        };
        let Some(Bundle { files, .. }) = made else { continue };
        let forms = export.forms(table).expect("the table has the files");
        let paths = |files: &[TextureFile]| files.iter().map(|file| file.path.clone()).collect::<Vec<_>>();
        assert_eq!(paths(&forms), paths(&files), "{export}");
        for (form, file) in forms.iter().zip(&files) {
            assert!(form.resembles(&file.bytes), "{export}: {}", file.path);
            for other in [&b"\x7fELF\0"[..], b"[core]\n\tfsmonitor = \"\xff\"\n", b""] {
                assert!(!form.resembles(other), "{export}: {}: {other:?}", file.path);
            }
            seen += 1;
        }
    }
    assert!(seen > 200, "{seen} files");
}

/// Our shader needs binding 0 in addition to the textures. Every container has both.
#[test]
fn an_export_for_our_shader_has_its_uniform_and_steps() {
    let own = planted(Layout::Reflected, [3, 2, 3, 2], true, |_, _| 0.0);
    let theirs = planted(Layout::Ltc2017, [3, 1, 3, 1], true, |_, _| 0.0);
    for (table, layout) in [(&own, "reflected"), (&own, "reflected-array"), (&theirs, "ltc2017-3d")] {
        let words = table.shader_axes().words();
        for container in TextureContainer::ALL {
            let export: Export = format!("{layout}.{container}.f32").parse().expect("an export");
            let Ok(Bundle { files, steps }) = export.bundle(table, About::default()) else {
                // Some formats have no arrays.
                assert_eq!(layout, "reflected-array", "{export}");
                continue;
            };
            let document = files.iter().find(|file| file.path == "ltc.json").unwrap_or_else(|| panic!("{export}"));
            let document: serde_json::Value = serde_json::from_slice(&document.bytes).expect("JSON");
            let names =
                ["nodes", "reading", "start", "spacing", "per_step", "texel", "roughness", "cosines", "azimuths"];
            let vector = |name| document["ltc_table"][name].clone();
            let found = names.map(|name| serde_json::from_value::<[f32; 4]>(vector(name)).expect("four numbers"));
            let expected = words.chunks(4).enumerate().map(|(i, vector)| {
                std::array::from_fn(|k| if i < 2 { vector[k] as f32 } else { f32::from_bits(vector[k]) })
            });
            assert_eq!(found.to_vec(), expected.collect::<Vec<_>>(), "{export}");
            assert!(steps.iter().any(|step| step.contains("ltcforge shader")), "{export}: {steps:?}");
        }
        let header: Export = format!("{layout}.c.f16").parse().expect("an export");
        let header = header.bundle(table, About::default()).expect("a header").files.remove(0);
        let text = String::from_utf8(header.bytes).expect("text");
        let (_, rows) =
            text.split_once("uint32_t ltc_table").and_then(|(_, rest)| rest.split_once('{')).expect("words");
        let rows = rows.split_once('}').expect("its end").0.split(',').map(str::trim).filter(|word| !word.is_empty());
        let found = rows.map(|word| u32::from_str_radix(word.trim_start_matches("0x"), 16).expect("hexadecimal"));
        assert_eq!(found.collect::<Vec<u32>>(), words, "{layout}");
    }
    let engine = "ltc2017.ktx2.f32".parse::<Export>().expect("an export").bundle(&theirs, About::default());
    let Bundle { files, steps } = engine.expect("textures");
    assert!(steps[0].contains("--layout ltc2017-3d") && files.iter().all(|file| file.path != "ltc.json"), "{steps:?}");
}

/// The texels of a KTX2 file with four 32-bit channels, and the texture's sides.
fn texels(bundle: &Bundle, path: &str) -> ([usize; 3], Vec<f32>) {
    let file = bundle.files.iter().find(|file| file.path == path).expect(path);
    let reader = ktx2::Reader::new(&file.bytes).expect("KTX2");
    let header = reader.header();
    assert_eq!(header.format, Some(ktx2::Format::R32G32B32A32_SFLOAT));
    let sides = [header.pixel_width, header.pixel_height, header.pixel_depth].map(|side| side as usize);
    let data = reader.levels().next().expect("a level").data;
    (sides, data.as_chunks::<4>().0.iter().map(|x| f32::from_le_bytes(*x)).collect())
}

#[test]
fn our_shader_finds_every_number_of_a_table_of_every_layout() {
    for &layout in Layout::ALL {
        let sides = match layout.only_ranges() {
            Some(_) => r#"{"alpha":3,"theta":2}"#,
            None if layout.is_of_materials() => {
                r#"{"theta":2,"phi":3},"materials":[{"alpha":0.5,"ratio":0.1},{"alpha":0.2},{"alpha":0.7}]"#
            }
            None => r#"{"alpha":3,"ratio":2,"theta":2,"phi":3}"#,
        };
        let fit = r#""fit":{"samples":64,"directions":4,"steps":5}"#;
        let table = table(&format!(r#"{{"layout":"{layout}","resolution":{sides},{fit}}}"#));
        let bundle = Export::Engine(Engine::Wgpu).bundle(&table, About::default()).expect("textures");
        let [a, b, terms] =
            ["ltc_matrix_a", "ltc_matrix_b", "ltc_terms"].map(|name| texels(&bundle, &format!("{name}.ktx2")));
        let counts = table.lengths();
        assert_eq!(a.0, [counts.phi, counts.ratio * counts.theta, counts.alpha], "{layout}");
        assert!(a.0 == b.0 && a.0 == terms.0, "{layout}");
        // The shader reads texel (p, r * theta_nodes + t, a).
        let at = |(sides, texels): &([usize; 3], Vec<f32>), [x, y, z]: [usize; 3]| -> [f32; 4] {
            let start = 4 * ((z * sides[1] + y) * sides[0] + x);
            texels[start..start + 4].try_into().expect("a texel")
        };
        let own = table.terms.as_ref().expect("terms");
        let mut entry = 0;
        for alpha in 0..counts.alpha {
            for row in 0..counts.ratio * counts.theta {
                for phi in 0..counts.phi {
                    let [a, b, terms] = [&a, &b, &terms].map(|texture| at(texture, [phi, row, alpha]));
                    assert_eq!([&a[..], &b[..], &terms[..1]].concat(), table.matrix[entry], "{layout}, {entry}");
                    assert_eq!(terms[1..3], [own.amplitude()[entry], own.fresnel()[entry]], "{layout}, {entry}");
                    let pair = table.materials().nth(alpha).map_or(0.0, |pair| pair[row] as f32);
                    assert_eq!(terms[3], pair, "{layout}, {entry}");
                    entry += 1;
                }
            }
        }
        assert_eq!(entry, table.matrix.len(), "{layout}");
    }
}

/// A table for a recipe, in which all lobes are the same.
fn uniform(recipe: &Recipe) -> Table {
    let entries = recipe.entries() as usize;
    Table {
        brdf: recipe.brdf.clone(),
        lobe: recipe.lobe,
        layout: recipe.layout,
        axes: recipe.nodes(),
        matrix: vec![[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]; entries],
        terms: recipe.terms.any().then(|| Terms {
            amplitude: vec![1.0; entries],
            fresnel: vec![0.5; entries],
            edge: None,
        }),
        second: None,
        node_error: vec![0.0; entries],
    }
}

/// Tries every export for every BRDF, layout and lobe model.
#[test]
fn an_error_names_only_recipes_and_exports_that_work() {
    let (mut named, mut advised) = (BTreeSet::new(), 0);
    let file = format!("\"tabulated\":\"{}\",", Digest::of(b"brdf"));
    for (&brdf, &layout, &lobe) in BrdfKind::ALL.iter().flat_map(|brdf| {
        Layout::ALL.iter().flat_map(move |layout| LobeModel::ALL.iter().map(move |lobe| (brdf, layout, lobe)))
    }) {
        let file = if brdf == BrdfKind::Tabulated { &file } else { "" };
        for has_terms in [true, false] {
            let list = if layout.is_of_materials() { r#""materials":[{"alpha":0.5},{"alpha":1}],"# } else { "" };
            let document = format!(
                r#"{{"brdf":"{brdf}",{file}{list}"layout":"{layout}","lobe":"{lobe}","terms":{has_terms},"resolution":{{"alpha":2,"theta":2}}}}"#
            );
            let recipe = match recipe_document::parse_stored(document.as_bytes()) {
                Ok(recipe) => recipe,
                Err(error) => {
                    let lacks_terms = !has_terms && lobe.gaussian().is_some();
                    assert!(
                        !layout.takes(&brdf.into()) || !layout.stores(lobe) || lacks_terms,
                        "{document}: {error:?}"
                    );
                    continue;
                }
            };
            let table = uniform(&recipe);
            let exports = Export::all().filter(|export| match export {
                Export::Textures { container, precision, .. } => {
                    (*container, *precision) == (TextureContainer::Ktx2, Precision::F32)
                }
                Export::Engine(_) | Export::Compact(_) | Export::Lut(_) => true,
            });
            for export in exports {
                let Err(error) = export.layout(&table).and_then(|_| export.forms(&table)) else { continue };
                let message = error.to_string();
                if let Some(recipe) = error.recipe() {
                    assert!(message.ends_with(recipe), "{export} of {document}: {message}");
                    named.insert((export.to_string(), recipe.to_owned()));
                } else {
                    assert!(!message.contains('{'), "{export} of {document}: {message}");
                }
                if let Some((_, advice)) = message.split_once("--layout ") {
                    let words: Vec<&str> = advice.split(' ').take(3).collect();
                    let [layout, "--container", container] = words[..] else { panic!("{message}") };
                    let other: Export = format!("{layout}.{container}.f32").parse().expect("an export");
                    assert!(message.contains(&format!("(export {other})")), "{message}");
                    other.layout(&table).unwrap_or_else(|error| panic!("{export} of {document}: {message}: {error}"));
                    advised += 1;
                }
            }
        }
    }
    assert!(named.len() > 100 && advised > 50, "{} recipes, {advised} exports", named.len());
    for (name, document) in named {
        let export: Export = name.parse().expect("an export");
        let recipe = recipe_document::parse_stored(document.as_bytes())
            .unwrap_or_else(|error| panic!("{name}: {document}: {error}"));
        let table = uniform(&recipe);
        let made = export.layout(&table).and_then(|_| export.forms(&table));
        made.unwrap_or_else(|error| panic!("{name}: {document}: {error}"));
    }
}
