//! Command `light`: the light that materials reflect.

use serde_json::Value;

use super::lights::{LIGHTS, rows};
use crate::common::{
    SMALL,
    command::{run, run_with_stdin},
};

#[test]
fn light_of_a_material_is_a_weighted_sum_of_both_parts() {
    let folder = tempfile::tempdir().expect("a folder");
    let with = |options: &[&str]| run_with_stdin(folder.path(), ["light", "-"].iter().chain(options), LIGHTS);
    let printed = with(&["--f0", "0.04", "--f90", "0.5", "--truth"]).exited(0).stdout;
    let header = "energy,fresnel,reflected,true_energy,true_fresnel,true_reflected";
    assert_eq!(printed.lines().next(), Some(header));
    for row in rows(&printed) {
        for [energy, fresnel, reflected] in [[row[0], row[1], row[2]], [row[3], row[4], row[5]]] {
            assert!((0.04 * (energy - fresnel) + 0.5 * fresnel - reflected).abs() < 1e-15, "{row:?}");
        }
    }
    let output = with(&["--f0", "0.04", "--f90", "0.5", "--truth", "--json"]).exited(0).stdout;
    let output: Vec<Value> = output.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    for (output, row) in output.iter().zip(rows(&printed)) {
        let numbers = ["reflected", "true_reflected"].map(|name| output[name].as_f64().expect("a number"));
        assert_eq!(numbers, [row[2], row[5]]);
    }
    for (options, word) in [
        (&["--f0", "1.1"][..], "between 0 and 1"),
        (&["--f0", "nan"], "between 0 and 1"),
        (&["--f0", "0.5", "--f90=-1"], "between 0 and 1"),
        (&["--f90", "0.5"], "--f0"),
        (&["--f0=2", "--f82=3", "--f90=-1", "--cut"], "--f0 2: a reflectance"),
        (&["--f0=2", "--f82=3", "--f90=-1", "--cut"], "; --f82 3: a reflectance"),
        (&["--f0=2", "--f82=3", "--f90=-1", "--cut"], "; --f90 -1: a reflectance"),
        (&["--f0=2", "--f82=3", "--f90=-1", "--cut"], "; --cut is only for models ltc"),
    ] {
        assert!(with(options).exited(2).stderr.contains(word), "{options:?}");
    }
}

/// `--material` replaces two columns, and its rotation is the same as rotating view and light the other way.
#[test]
fn a_described_material_reflects_like_its_roughness() {
    let folder = tempfile::tempdir().expect("a folder");
    let with =
        |options: &[&str], lines: &str| run_with_stdin(folder.path(), ["light", "-"].iter().chain(options), lines);
    let lit = "0.7,0.3,1,-2,-1,1,1,-1,2,-1,1,2";
    let columns = with(&[], &format!("0.375,0.125,{lit}")).exited(0).stdout;
    let material = ["--material", "hdrp:_Smoothness=0.5,_Anisotropy=0.5"];
    assert_eq!(with(&material, lit).exited(0).stdout, columns);
    let header = "theta,phi,sides,x0,y0,z0,x1,y1,z1,x2,y2,z2";
    assert_eq!(with(&material, &format!("{header}\n{lit}")).exited(0).stdout, columns);

    // A quarter turn swaps the roughness along and across the tangent.
    let turned = "gltf:roughnessFactor=0.5,anisotropyStrength=0.5,anisotropyRotation=1.5707963267948966";
    let found = rows(&with(&["--material", turned], lit).exited(0).stdout);
    let swapped = rows(&with(&[], &format!("0.25,0.4375,{lit}")).exited(0).stdout);
    assert!(found[0].iter().zip(&swapped[0]).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {swapped:?}");
    let along = rows(&with(&[], &format!("0.4375,0.25,{lit}")).exited(0).stdout);
    assert!((along[0][0] - swapped[0][0]).abs() > 1e-3, "{along:?} {swapped:?}");

    // A roughness above 1 is clamped with a message. All errors are reported at once.
    let rough = with(&["--material", "disney:roughness=1,anisotropic=1"], lit).exited(0);
    assert!(rough.stderr.contains("is clamped to 1") && !rough.stdout.contains("NaN"), "{}", rough.stderr);
    let refused = with(&["--material", "disney:roughness=2,shiny=1"], lit).exited(2).stderr;
    assert!(refused.contains("roughness is «2»") && refused.contains("disney has no «shiny»"), "{refused}");
    let refused = with(&material, &format!("0.375,0.125,{lit}")).exited(2).stderr;
    assert!(refused.contains("14 fields; a light has theta,phi,sides"), "{refused}");
}

/// A metal by F82 reflects less than by Schlick's factor: with a closed form, and with a table that has the edge term.
/// Other tables report the missing term.
#[test]
fn light_of_a_metal_is_darker_at_its_edge() {
    let folder = tempfile::tempdir().expect("a folder");
    let lights = lights_around_reflections();
    let with = |options: &[&str]| run_with_stdin(folder.path(), ["light", "-"].iter().chain(options), &lights);
    let fit = |more: &str| {
        let small =
            r#""preset": "draft", "range": {"ratio": [1, 1], "phi": [0, 0]}, "resolution": {"alpha": 8, "theta": 12}"#;
        run_with_stdin(folder.path(), ["fit", "-"], &format!("{{{small}{more}}}")).exited(0).last_line().to_owned()
    };
    let metal = ["--f0", "0.9", "--f82", "0.5", "--truth"];
    let table = fit(r#", "terms": "f82""#);
    for by in [&["--model", "normals"][..], &["--model", "asg"], &["--model", "ltc", "--table", &table]] {
        let found = rows(&with(&[by, &metal].concat()).exited(0).stdout);
        let schlick = rows(&with(&[by, &metal[..2], &metal[4..]].concat()).exited(0).stdout);
        let off = |i: usize| found.iter().map(|row| (row[i] - row[5]).abs()).sum::<f64>() / found.len() as f64;
        let undarkened = found.iter().zip(&schlick).map(|(row, schlick)| (schlick[2] - row[5]).abs()).sum::<f64>();
        let darker = found.iter().zip(&schlick).all(|(row, schlick)| row[2] <= schlick[2] && row[5] <= schlick[5]);
        println!("{by:?}: off by {:.4}, {:.4} by Schlick's factor", off(2), undarkened / found.len() as f64);
        // F82 of a black metal with a tint of 0 is negative around 75 degrees.
        let black = rows(&with(&[by, &["--f0", "0", "--f82", "0", "--truth"]].concat()).exited(0).stdout);
        assert!(black.iter().all(|row| row[2] >= 0.0 && row[5] >= 0.0), "{by:?}: {black:?}");
        assert!(darker && off(2) < 0.7 * undarkened / found.len() as f64, "{by:?}: {} {undarkened}", off(2));
    }
    let by = |table: &str| with(&[&["--model", "ltc", "--table", table], &metal[..4]].concat()).exited(2).stderr;
    assert!(by(&fit("")).contains(r#"its recipe needs "terms": "f82""#));
    let cloth = fit(r#", "brdf": "charlie""#);
    let output = by(&cloth);
    let no_fresnel = "--f0: brdf charlie has no Fresnel factor: leave it out";
    assert!(output.contains(no_fresnel) && output.contains("; --f82: ") && output.contains("no edge term"), "{output}");
    let by_cloth = |options: &[&str]| with(&[&["--model", "ltc", "--table", &cloth], options].concat());
    let output = by_cloth(&["--f0", "0.04"]).exited(2).stderr.clone();
    assert!(output.contains(no_fresnel) && !output.contains("--f82"), "{output}");
    assert_eq!(rows(&by_cloth(&["--truth"]).exited(0).stdout).len(), lights.lines().count());
    assert!(with(&["--f82", "0.5"]).exited(2).stderr.contains("--f0"));
}

/// Lights around the mirror directions of smooth to rough surfaces. Some lights are low.
fn lights_around_reflections() -> String {
    let mut lines = Vec::new();
    for alpha in [0.06, 0.16, 0.36] {
        for theta in [0.4_f64, 1.0, 1.3, 1.45] {
            for (turn, lift) in [(0.0, 0.0), (0.3, 0.1), (-0.2, 0.3)] {
                let (x, y, z) = (-theta.sin(), turn, theta.cos() + lift);
                let corners = [[-0.2, -0.1], [0.2, -0.1], [0.2, 0.1], [-0.2, 0.1]];
                let corners = corners.map(|[across, up]| format!("{x},{},{}", y + across, z + up));
                lines.push(format!("{alpha},{alpha},{theta},0,2,{}", corners.join(",")));
            }
        }
    }
    lines.join("\n")
}

#[test]
fn a_table_for_plastic_is_nearer_for_plastic_and_a_table_for_both_is_between() {
    let folder = tempfile::tempdir().expect("a folder");
    let lights = lights_around_reflections();
    let error = |fresnel: &str, f0: &str| {
        let resolution = r#""resolution": {"alpha": 16, "theta": 16}"#;
        let recipe = format!(r#"{{"preset": "draft", "layout": "ltc2017", {resolution}, "fresnel": {fresnel}}}"#);
        let table = run_with_stdin(folder.path(), ["fit", "-"], &recipe).exited(0).last_line().to_owned();
        let words = ["light", "-", "--model", "ltc", "--table", &table, "--truth", "--f0", f0];
        let found = rows(&run_with_stdin(folder.path(), words, &lights).exited(0).stdout);
        found.iter().map(|row| (row[2] - row[5]).abs()).sum::<f64>() / found.len() as f64
    };
    let both = r#"[{"f0": 1}, {"f0": 0.04, "weight": 16}]"#;
    let [metal, plastic] =
        ["1", "0.04"].map(|f0| [r#""one""#, r#"[{"f0": 0.04}]"#, both].map(|fresnel| error(fresnel, f0)));
    println!("one, plastic, both: of metal {metal:.5?}, of plastic {plastic:.5?}");
    assert!(plastic[1] < 0.6 * plastic[0] && plastic[2] < 0.9 * plastic[0], "{plastic:?}");
    assert!(metal[0] < metal[1] && metal[2] < 0.5 * (metal[0] + metal[1]), "{metal:?}");
}

/// For metal, two lobes are as good as one. For plastic they are far better, with two integrals and with the integral
/// of their blend.
#[test]
fn two_lobes_are_accurate_for_metal_and_for_plastic() {
    let folder = tempfile::tempdir().expect("a folder");
    let lights = lights_around_reflections();
    let fitted = |fresnel: &str| {
        let resolution = r#""resolution": {"alpha": 16, "theta": 16}"#;
        let recipe = format!(r#"{{"preset": "draft", "layout": "ltc2017", {resolution}, "fresnel": "{fresnel}"}}"#);
        run_with_stdin(folder.path(), ["fit", "-"], &recipe).exited(0).last_line().to_owned()
    };
    let by = |table: &str, options: &[&str]| {
        let words = ["light", "-", "--model", "ltc", "--table", table, "--truth"];
        run_with_stdin(folder.path(), words.iter().chain(options), &lights)
    };
    let error = |table: &str, options: &[&str]| {
        let found = rows(&by(table, options).exited(0).stdout);
        found.iter().map(|row| (row[2] - row[5]).abs()).sum::<f64>() / found.len() as f64
    };
    let [one, two, blended] = ["one", "two_lobes", "blended_lobes"].map(fitted);
    let plastic = |table: &str, blend: &[&str]| error(table, &[&["--f0", "0.04"], blend].concat());
    let found = [plastic(&one, &[]), plastic(&two, &[]), plastic(&blended, &["--blend"])];
    println!("plastic by one lobe, two and their blend: {found:.5?}");
    assert!(found[1] < 0.4 * found[0] && found[2] < 0.4 * found[0], "{found:?}");
    let metal = [&one, &two, &blended].map(|table| error(table, &["--f0", "1"]));
    let blend = error(&blended, &["--f0", "1", "--blend"]);
    assert!([metal[1], metal[2], blend].iter().all(|error| (error - metal[0]).abs() < 1e-14), "{metal:?} {blend}");
    let refused = by(&one, &["--f0", "0.04", "--blend"]).exited(2).stderr.clone();
    assert!(refused.contains("one lobe per entry") && refused.contains("blended_lobes"), "{refused}");
    let found =
        run_with_stdin(folder.path(), ["lookup", &two, "--points", "-"], "0.5,0.5,0.7,0").exited(0).stdout.clone();
    assert!(found.lines().next().is_some_and(|head| head.ends_with("second22")), "{found}");
    let small =
        r#"{"preset": "draft", "fresnel": "two_lobes", "resolution": {"alpha": 3, "ratio": 2, "theta": 3, "phi": 2}}"#;
    let small = run_with_stdin(folder.path(), ["fit", "-"], small).exited(0).last_line().to_owned();
    run(folder.path(), ["export", &small, "--container", "compact", "-o", "out"]).exited(0);
    for file in ["out/ltc.compact", "out/ltc_2.compact"] {
        run(folder.path(), ["report", file, "--points", "8"]).exited(0);
    }
    let engine = run(folder.path(), ["export", &two, "--for", "three", "-o", "out"]).exited(2).stderr.clone();
    assert!(
        engine.contains("two")
            && engine.contains(r#"this recipe gives a table with these textures: {"layout": "ltc2017"}"#),
        "{engine}"
    );
}

/// The default anisotropic table with two lobes. For plastic, its error is about a third of the error with one lobe.
#[test]
fn two_lobes_are_accurate_for_plastic_on_brushed_surfaces() {
    let folder = tempfile::tempdir().expect("a folder");
    let lights = lights_around_reflections();
    // Surfaces brushed along the view and across it.
    let brushed: Vec<String> = (lights.lines().enumerate())
        .filter_map(|(i, line)| {
            let mut fields = line.split(',').map(str::to_owned).collect::<Vec<_>>();
            let alpha: f64 = fields[i % 2].parse().ok()?;
            fields[i % 2] = (alpha / 4.0).to_string();
            Some(fields.join(","))
        })
        .collect();
    let brushed = brushed.join("\n");
    let error = |fresnel: &str, options: &[&str]| {
        let recipe = format!(r#"{{"preset": "draft", "fresnel": "{fresnel}"}}"#);
        let table = run_with_stdin(folder.path(), ["fit", "-"], &recipe).exited(0).last_line().to_owned();
        let words = ["light", "-", "--model", "ltc", "--table", &table, "--truth", "--f0", "0.04"];
        let found = rows(&run_with_stdin(folder.path(), words.iter().chain(options), &brushed).exited(0).stdout);
        let [off, all] = found.iter().fold([0.0; 2], |[off, all], row| [off + (row[2] - row[5]).abs(), all + row[5]]);
        off / all
    };
    let found = [error("one", &[]), error("two_lobes", &[]), error("blended_lobes", &["--blend"])];
    println!("plastic by one lobe, two and their blend, of all light: {found:.4?}");
    assert!(found[1] < 0.5 * found[0] && found[2] < 0.6 * found[0], "{found:?}");
}

/// Compensation makes a metal brighter by a factor that depends on the albedo of its surface. Nothing else changes.
#[test]
fn compensation_restores_the_lost_light() {
    let folder = tempfile::tempdir().expect("a folder");
    let rough = "1,1,0.3,0,2,-1,-1,2,-1,1,2,1,1,2,1,-1,2\n";
    let with = |options: &[&str]| run_with_stdin(folder.path(), ["light", "-"].iter().chain(options), rough);
    let numbers = |options: &[&str]| rows(&with(options).exited(0).stdout).remove(0);
    let once = numbers(&["--f0", "0.9", "--truth"]);
    let all = numbers(&["--f0", "0.9", "--truth", "--compensate"]);
    for i in [0, 1, 3, 4] {
        assert_eq!(all[i], once[i]);
    }
    // The albedo is 0.32 in this configuration, so the factor is 1 + 0.9 (1 / 0.32 - 1).
    for i in [2, 5] {
        let factor = all[i] / once[i];
        assert!((factor - 2.9).abs() < 0.2, "{factor}");
    }
    assert_eq!(numbers(&["--f0", "0", "--compensate"]), numbers(&["--f0", "0"]));
    assert!(with(&["--compensate"]).exited(2).stderr.contains("--f0"));
    // A table uses its own amplitude. A table for a model without facets is rejected.
    let fit = |recipe: &str| run_with_stdin(folder.path(), ["fit", "-"], recipe).exited(0).last_line().to_owned();
    let table = fit(SMALL);
    let by_table = |table: &str, more: &[&str]| {
        let options = ["--model", "ltc", "--f0", "1", "--table", table];
        with(&options.iter().chain(more).copied().collect::<Vec<_>>())
    };
    let [once, all] = [&[][..], &["--compensate"]].map(|more| rows(&by_table(&table, more).exited(0).stdout).remove(0));
    assert!(all[2] > 1.5 * once[2] && all[2] <= 1.0, "{once:?} {all:?}");
    let sheen = SMALL.replacen('{', r#"{"brdf":"charlie","layout":"kt2022","#, 1);
    let sheen = fit(&sheen.replace(r#""ratio":2"#, r#""ratio":1"#).replace(r#""phi":2"#, r#""phi":1"#));
    let refused = by_table(&sheen, &["--compensate"]);
    assert!(refused.exited(2).stderr.contains("compensation is for ggx and beckmann"));
    let shader = ["shader", "--language", "glsl", "--model", "normals", "--compensate"];
    assert!(run(folder.path(), shader).exited(0).stdout.contains("vec3 normals_compensation("));
    let example = shader.iter().chain(&["--as", "example"]);
    assert!(run(folder.path(), example).exited(2).stderr.contains("--compensate needs --as include"));
}
