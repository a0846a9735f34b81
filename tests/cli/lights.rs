//! Command `light`: the light that surfaces reflect.

use std::fs;

use serde_json::Value;

use crate::common::{
    SMALL,
    command::{run, run_with_stdin},
    documents::shell,
};

/// A square and a triangle.
pub(crate) const LIGHTS: &str =
    "0.5,0.25,0.7,0.3,2,-1,-1,2,-1,1,2,1,1,2,1,-1,2\n\n0.2,0.2,0.7,0,1,-2,-1,1,1,-1,2,-1,1,2\n";

pub(crate) fn rows(text: &str) -> Vec<Vec<f64>> {
    text.lines().skip(1).map(|line| line.split(',').map(|field| field.parse().expect("a number")).collect()).collect()
}

#[test]
fn light_prints_energy_and_fresnel_part_of_each_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let header = "\u{feff}alpha_x,alpha_y,theta,phi,sides,x0,y0,z0,x1,y1,z1,x2,y2,z2\r\n";
    fs::write(folder.path().join("lights.csv"), format!("{header}{LIGHTS}")).expect("lights");
    let printed = run(folder.path(), ["light", "lights.csv"]).exited(0);
    assert_eq!(printed.stdout.lines().next(), Some("energy,fresnel"));
    let found = rows(&printed.stdout);
    assert_eq!(found.len(), 2);
    assert!(found.iter().all(|row| row[0] > 0.05 && row[0] < 1.0 && row[1] >= 0.0 && row[1] < row[0]), "{found:?}");

    // With `--truth`, the truth has its own columns. The rules are near to the truth, and differ from each other.
    let with = |options: &[&str]| run_with_stdin(folder.path(), ["light", "-"].iter().chain(options), LIGHTS).exited(0);
    let printed = with(&["--truth"]);
    assert_eq!(printed.stdout.lines().next(), Some("energy,fresnel,true_energy,true_fresnel"));
    for row in rows(&printed.stdout) {
        assert!((row[0] - row[2]).abs() < 0.01 && (row[1] - row[3]).abs() < 0.005, "{row:?}");
    }
    let texts = ["fast", "balanced", "fine"].map(|rule| with(&["--rule", rule]).stdout);
    assert!(texts[0] != texts[1] && texts[1] != texts[2]);
    assert_eq!(with(&["--model", "normals"]).stdout, texts[1]);
    let gaussians = ["sg", "asg"].map(|model| with(&["--model", model, "--truth"]).stdout);
    assert!(gaussians[0] != gaussians[1]);
    for row in gaussians.iter().flat_map(|text| rows(text)) {
        assert!((row[0] - row[2]).abs() < 0.15 && row[0] > 0.0 && row[1] < row[0], "{row:?}");
    }

    // JSON has the same numbers, to the last bit.
    let output = with(&["--json", "--truth"]).stdout;
    let output: Vec<Value> = output.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    for (output, row) in output.iter().zip(rows(&printed.stdout)) {
        let names = ["energy", "fresnel", "true_energy", "true_fresnel"];
        assert_eq!(names.map(|name| output[name].as_f64().expect("a number")).to_vec(), row);
    }
    assert_eq!(with(&["--json"]).stdout.matches("true").count(), 0);
}

#[test]
fn only_light_by_a_table_accepts_a_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let digest = run_with_stdin(folder.path(), ["fit", "-"], SMALL).exited(0).last_line().to_owned();
    let with = |options: &[&str]| run_with_stdin(folder.path(), ["light", "-"].iter().chain(options), LIGHTS);
    let by_table = rows(&with(&["--model", "ltc", "--table", &digest[..20], "--truth"]).exited(0).stdout);
    assert_eq!(by_table.len(), 2);
    let recipe = SMALL.replacen('{', r#"{"lobe":"asg","#, 1);
    let gaussians = run_with_stdin(folder.path(), ["fit", "-"], &recipe).exited(0).last_line().to_owned();
    let gaussians = gaussians.as_str();
    let by_gaussians = rows(&with(&["--model", "asg", "--table", gaussians, "--truth"]).exited(0).stdout);
    assert!(by_gaussians.len() == 2 && by_gaussians != by_table);
    for row in by_table.into_iter().chain(by_gaussians) {
        assert!((row[0] - row[2]).abs() < 0.3 && row[0] > 0.0 && row[1] < row[0], "{row:?}");
    }
    for (options, said) in [
        (&["--model", "ltc"][..], "needs a table"),
        (&["--table", &digest], "--table needs a model that reads tables"),
        (&["--model", "ltc", "--table", &digest, "--rule", "fast"], "--rule is only for model normals"),
        (&["--model", "asg", "--table", &digest], "the table has lobe ltc: use --model ltc instead of asg"),
        (&["--model", "ltc", "--table", gaussians], "the table has lobe asg: use --model asg instead of ltc"),
        (&["--model", "asg", "--table", gaussians, "--rule", "fast"], "--rule is only for model normals"),
        (&["--model", "sg", "--rule", "fast"], "--rule is only for model normals"),
    ] {
        let refused = with(options).exited(2);
        assert!(refused.complaints().len() == 1 && refused.complaints()[0].contains(said), "{refused:#?}");
    }
    let refused = with(&["--model", "ltc", "--table", "sha256:ffff0"]).exited(1);
    assert!(refused.complaints()[0].contains("there is no such file"), "{refused:#?}");
}

#[test]
fn light_names_the_line_and_the_column_that_is_wrong() {
    let folder = tempfile::tempdir().expect("a folder");
    let wrong = LIGHTS.replace("0.2,0.2,0.7", "0.2,0.2,1.7");
    fs::write(folder.path().join("l.csv"), &wrong).expect("lights");
    let refused = run(folder.path(), ["light", "l.csv"]).exited(2);
    assert_eq!(
        refused.complaints(),
        ["l.csv, line 3: theta is «1.7»; a polar angle must be at least 0 and below pi/2, in radians"]
    );
    // The rows before the error are printed.
    assert_eq!(refused.stdout.lines().count(), 2);
    let star = "1,1,0,0,2,0,1,1,0.6,-0.8,1,-0.95,0.3,1,0.95,0.3,1,-0.6,-0.8,1\n";
    let refused = run_with_stdin(folder.path(), ["light", "-"], star).exited(2);
    assert!(refused.complaints()[0].starts_with("standard input, line 1: the light is not convex"), "{refused:#?}");
    assert_eq!(
        run(folder.path(), ["light", "."]).exited(2).complaints(),
        [".: this is a folder, not a CSV file of lights"]
    );
    let refused = run(folder.path(), ["light", "/dev/zero"]).exited(1);
    assert_eq!(refused.complaints(), ["/dev/zero: this is not a regular file"]);
    run(folder.path(), ["light", "none.csv"]).exited(1);
}

/// Configurations outside a table's range, for each model that has a table. `light` reports them like `lookup`.
#[test]
fn light_by_a_table_reports_points_outside_its_range() {
    let folder = tempfile::tempdir().expect("a folder");
    let light = "2,-1,-1,2,-1,1,2,1,1,2,1,-1,2";
    let points = ["0.5,0.4,0.7,0.3", "0.01,0.01,0.7,0", "0.5,0.4,1.2,0", "0.02,0.02,1.2,0.1"];
    let lights: String = points.map(|point| format!("{point},{light}\n")).concat();
    for lobe in ["ltc", "sg", "asg"] {
        let head = format!(r#"{{"lobe":"{lobe}","range":{{"alpha":[0.25,1],"theta":[0,1]}},"#);
        let recipe = SMALL.replacen('{', &head, 1);
        let digest = run_with_stdin(folder.path(), ["fit", "-"], &recipe).exited(0).last_line().to_owned();
        let words = ["light", "-", "--model", lobe, "--table", &digest];
        let printed = run_with_stdin(folder.path(), words, &lights).exited(0);
        let looked_up =
            run_with_stdin(folder.path(), ["lookup", "--points", "-", &digest], &(points.join("\n") + "\n")).exited(0);
        let said = [
            "3 of 4 points are outside the table's range and were clamped:",
            "  alpha below 0.25: 2 clamped to 0.25",
            "  theta above 1: 2 clamped to 1",
        ];
        assert_eq!(printed.stderr.lines().collect::<Vec<_>>(), said);
        assert_eq!(printed.stderr, looked_up.stderr);
        assert_eq!(rows(&printed.stdout).len(), 4);
        let printed = run_with_stdin(folder.path(), words.iter().chain(&["--json"]), &lights).exited(0);
        assert_eq!(printed.stderr, "");
        let output: Vec<Value> = printed.stdout.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
        let clamped: Vec<String> = output.iter().map(|output| output["clamped"].to_string()).collect();
        assert_eq!(clamped, ["{}", r#"{"alpha":0.25}"#, r#"{"theta":1.0}"#, r#"{"alpha":0.25,"theta":1.0}"#]);
    }
    // A closed form has no range.
    let printed = run_with_stdin(folder.path(), ["light", "-", "--json", "--model", "asg"], &lights).exited(0);
    assert!(printed.stderr.is_empty() && !printed.stdout.contains("clamped"), "{printed:#?}");
}

/// A surface and a view, with a light of each shape except polygons.
const SHAPES: [(&str, &str); 4] = [
    ("disk", "0.5,0.25,0.7,0.3,2,-1,0.2,1.5,0.6,0,0,0,0.4,0.2"),
    ("sphere", "0.5,0.25,0.7,0.3,-1,0.2,1.5,0.5"),
    ("tube", "0.5,0.25,0.7,0.3,-1.5,-0.5,1,0,0.8,1.2,0.3"),
    ("line", "0.5,0.25,0.7,0.3,-1.5,-0.5,1,0,0.8,1.2,0.1"),
];

#[test]
fn every_shape_is_lit_by_every_model() {
    let folder = tempfile::tempdir().expect("a folder");
    let digest = run_with_stdin(folder.path(), ["fit", "-"], SMALL).exited(0).last_line().to_owned();
    for (shape, line) in SHAPES {
        let with = |options: &[&str]| {
            let words = ["light", "-", "--truth", "--light", shape];
            rows(&run_with_stdin(folder.path(), words.iter().chain(options), &format!("{line}\n")).exited(0).stdout)
        };
        let lit = [with(&[]), with(&["--model", "asg"]), with(&["--model", "ltc", "--table", &digest])];
        for (model, limit) in lit.iter().zip([0.006, 0.15, 0.3]) {
            let [row] = &model[..] else { panic!("{model:?}") };
            let [energy, fresnel, true_energy, true_fresnel] = row[..] else { panic!("{row:?}") };
            assert!((energy - true_energy).abs() < limit * true_energy.max(0.3), "{shape} {model:?}");
            assert!(0.0 <= fresnel && fresnel < energy && true_fresnel < true_energy, "{shape} {model:?}");
        }
        // A row for another shape is rejected, and the error names the columns of this shape.
        for (other, wrong) in SHAPES.iter().filter(|(_, other)| other.split(',').count() != line.split(',').count()) {
            let refused =
                run_with_stdin(folder.path(), ["light", "-", "--light", shape], &format!("{wrong}\n")).exited(2);
            assert!(refused.complaints()[0].contains(&format!("a {shape} has alpha_x,")), "{other}: {refused:#?}");
        }
    }
    let inside = run_with_stdin(folder.path(), ["light", "-", "--light", "sphere"], "1,1,0,0,0,0,1,2\n").exited(2);
    assert_eq!(inside.complaints(), ["standard input, line 1: the shaded point lies inside the light"]);
    let faults =
        run_with_stdin(folder.path(), ["light", "-", "--light", "tube"], "1,2,0,0,0,0,NaN,1,1,1,0\n").exited(2);
    assert_eq!(
        faults.complaints(),
        [
            "standard input, line 1: alpha_y is «2»; roughness must be above 0 and at most 1; az is «NaN»; a coordinate must be \
          a finite number; radius is «0»; a radius must be above 0"
        ]
    );
    assert!(
        run(folder.path(), ["light", "-", "--light", "cube"])
            .exited(2)
            .stderr
            .contains("[possible values: polygon, disk")
    );
}

/// The shaded point is in the middle of a polygon, or in its plane and within its outline. All models reject it.
#[test]
fn light_refuses_a_shaded_point_within_a_polygon() {
    let folder = tempfile::tempdir().expect("a folder");
    let digest = run_with_stdin(folder.path(), ["fit", "-"], SMALL).exited(0).last_line().to_owned();
    let within = [
        "0.5,0.5,0.7,0,2,-1,-1,0,-1,1,0,1,1,0,1,-1,0",
        "0.5,0.5,0.7,0,1,-0.3,-1,-1,-0.3,1,-1,0.6,1,2,0.6,-1,2",
        "0.5,0.5,0.7,0,2,0,-1,-2,0,-1,1,0,2,1",
    ];
    for options in [&[][..], &["--truth"], &["--model", "asg"], &["--model", "ltc", "--table", &digest, "--truth"]] {
        for line in within {
            let refused =
                run_with_stdin(folder.path(), ["light", "-"].iter().chain(options), &format!("{line}\n")).exited(2);
            let said = ["standard input, line 1: the shaded point lies inside the light"];
            assert_eq!(refused.complaints(), said, "{line} {options:?}");
        }
        // Outside the outline, a light in the same plane is seen edge-on and reflects nothing.
        let beside = "0.5,0.5,0.7,0,2,0,1,-2,0,1,1,0,2,1\n";
        let lit = run_with_stdin(folder.path(), ["light", "-"].iter().chain(options), beside).exited(0);
        assert!(rows(&lit.stdout)[0].iter().all(|x| x.abs() < 0.01), "{options:?} {}", lit.stdout);
    }
}

/// Checks the example of the docs.
#[test]
fn the_documentation_shows_the_printed_output() {
    let text = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/lights.md")).expect("the documentation");
    let block = text.split("```").find_map(|block| block.strip_prefix("console\n")).expect("a session");
    let (commands, _) = block.rsplit_once("$ ").expect("commands");
    let (asked, answer) = block[commands.len()..].split_once('\n').expect("an answer");
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(shell(folder.path(), &format!("{commands}{asked}").replace("$ ", "")), answer);
}

/// With an LTC, a light below the surface shines through. With `--cut`, it does not.
#[test]
fn with_cut_no_light_shines_through_the_surface() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = run_with_stdin(folder.path(), ["fit", "-"], SMALL).exited(0).last_line().to_owned();
    let below =
        "1,1,1.55,0,2,-90,-90,-1,-90,90,-1,90,90,-1,90,-90,-1\n0.5,0.25,0.7,0.3,2,-1,-1,2,-1,1,2,1,1,2,1,-1,2\n";
    let with = |options: &[&str]| {
        let table = ["light", "-", "--model", "ltc", "--table", table.as_str()];
        rows(&run_with_stdin(folder.path(), table.iter().chain(options), below).exited(0).stdout)
    };
    let (whole, cut) = (with(&[]), with(&["--cut"]));
    assert!(whole[0][0] > 0.0 && cut[0] == [0.0, 0.0], "{whole:?} {cut:?}");
    // The light above the surface is brighter, because the whole lobe is now above the surface.
    assert!(cut[1][0] > whole[1][0] && cut[1][0] < 1.2 * whole[1][0], "{whole:?} {cut:?}");
    let by_formula = |options: &[&str]| {
        let formula = ["light", "-", "--model", "ltc-formula"];
        rows(&run_with_stdin(folder.path(), formula.iter().chain(options), below).exited(0).stdout)
    };
    let (whole, cut) = (by_formula(&[]), by_formula(&["--cut"]));
    assert!(whole[0][0] > 0.0 && cut[0] == [0.0, 0.0] && cut[1][0] > whole[1][0], "{whole:?} {cut:?}");
    for model in ["normals", "asg"] {
        let refused = run_with_stdin(folder.path(), ["light", "-", "--cut", "--model", model], below).exited(2);
        assert!(refused.stderr.contains("--cut is only for models ltc and ltc-formula"), "{}", refused.stderr);
        let refused = run(folder.path(), ["shader", "--language", "hlsl", "--cut", "--model", model]).exited(2);
        assert!(refused.stderr.contains("--cut needs model ltc"), "{}", refused.stderr);
    }
    let shader = ["shader", "--language", "hlsl", "--layout", "reflected", "--cut"];
    assert!(run(folder.path(), shader).exited(0).stdout.contains("float ltc_cut_tube("));
    let example = shader.iter().chain(&["--as", "example"]);
    assert!(run(folder.path(), example).exited(2).stderr.contains("--cut needs --as include"));
}

/// A truth that does not converge and a singular matrix leave their columns empty, and the next lines still follow.
#[test]
fn a_result_that_cannot_be_computed_is_unknown() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let mut encoder = png::Encoder::new(fs::File::create(here.join("tv.png")).expect("a file"), 4, 4);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&[200; 48])).expect("a picture");
    let light = "2,-1,-1,1,1,-1,1,1,1,1,-1,1,1\n";
    let lights = format!("0.5,0.5,0.7,0,{light}0.3,0.00001,1.4,0.5,{light}0.5,0.25,0.7,0,{light}");
    let with = |options: &[&str]| run_with_stdin(here, ["light", "-", "--truth"].iter().chain(options), &lights);
    // The rows, with `None` for an empty cell or null, as CSV and as JSON.
    let found = |options: &[&str], result: &str| {
        let [csv, json] = [options.to_vec(), [options, &["--json"]].concat()].map(|options| with(&options).exited(0));
        assert!(csv.stderr.contains(result) && json.stderr.contains(result), "{csv:#?}");
        let names: Vec<&str> = csv.stdout.lines().next().expect("a header").split(',').collect();
        let cells = |line: &str| line.split(',').map(|cell| cell.parse::<f64>().ok()).collect::<Vec<_>>();
        let rows: Vec<_> = csv.stdout.lines().skip(1).map(cells).collect();
        let numbers = |line: &str| {
            let line: Value = serde_json::from_str(line).expect("JSON");
            names.iter().map(|name| line.get(name).expect("a column").as_f64()).collect::<Vec<_>>()
        };
        assert_eq!(rows, json.stdout.lines().map(numbers).collect::<Vec<_>>());
        rows.into_iter().map(|row| row.iter().map(Option::is_some).collect::<Vec<_>>()).collect::<Vec<_>>()
    };
    let known =
        found(&["--texture", "tv.png"], "unknown results (empty in CSV, null in JSON): 1, the first because the lobe");
    assert_eq!(known, [vec![true; 10], [[true; 5], [false; 5]].concat(), vec![true; 10]]);
}

/// A picture of four colours on a square. The reflected light of each channel is near to the truth, a mirror shows the
/// colour in its mirror direction, and all errors are reported at once.
#[test]
fn light_prints_the_channels_of_a_picture() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("tv.png");
    let mut encoder = png::Encoder::new(fs::File::create(&path).expect("a file"), 64, 64);
    encoder.set_color(png::ColorType::Rgb);
    let quarters: [[u8; 3]; 4] = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255; 3]];
    let pixels: Vec<u8> = (0..64 * 64).flat_map(|i| quarters[i % 64 / 32 + i / 2048 * 2]).collect();
    encoder.write_header().and_then(|mut writer| writer.write_image_data(&pixels)).expect("a picture");
    // Seen from its lit side below, the upper left corner of the square is at -x, +y. The order is clockwise.
    let square = |x: f64, y: f64| {
        let corners =
            [[-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]].map(|[a, b]| format!(",{},{},2", a + x, b + y));
        corners.concat()
    };
    let lights = format!("0.01,0.01,0,0,2{}\n0.4,0.1,0.9,0.3,2{}\n", square(0.5, -0.5), square(-1.0, 0.2));
    let with =
        |options: &[&str]| run_with_stdin(folder.path(), ["light", "-", "--texture"].iter().chain(options), &lights);
    let printed = with(&["tv.png", "--truth"]).exited(0);
    let names = "energy,fresnel,red,green,blue";
    let header =
        format!("{names},{}", names.split(',').map(|name| format!("true_{name}")).collect::<Vec<_>>().join(","));
    assert_eq!(printed.stdout.lines().next(), Some(header.as_str()));
    let found = rows(&printed.stdout);
    for row in &found {
        assert!((2..5).all(|i| (row[i] - row[i + 5]).abs() < 0.02), "{row:?}");
        assert!((row[7..].iter().fold(0.0, |a: f64, b| a.max(*b))) <= row[5] + 1e-4, "{row:?}");
    }
    // The first vertex is the upper left of the picture, which is red.
    assert!(found[0][2] > 0.9 && found[0][3] < 0.05 && found[0][4] < 0.05, "{:?}", found[0]);
    let half = rows(&with(&["tv.png", "--f0", "0.5", "--f90", "0.5", "--readings", "6"]).exited(0).stdout);
    assert!((half[0][3] - 0.5 * found[0][2]).abs() < 1e-3, "{half:?}");
    let output = with(&["tv.png", "--json"]).exited(0).stdout;
    let output: Value = serde_json::from_str(output.lines().next().expect("a line")).expect("JSON");
    assert_eq!(output["red"].as_f64(), Some(found[0][2]));

    let formula = rows(&with(&["tv.png", "--model", "ltc-formula", "--cut"]).exited(0).stdout);
    for (by_formula, by_normals) in formula.iter().zip(&found) {
        assert!((0..5).all(|i| (by_formula[i] - by_normals[i]).abs() < 0.02), "{by_formula:?} {by_normals:?}");
    }

    // Compensation applies the same factor to each channel as to the whole light, also in truth.
    let [once, all] =
        [&["tv.png", "--f0", "0.8", "--truth"][..], &["tv.png", "--f0", "0.8", "--truth", "--compensate"]]
            .map(|options| rows(&with(options).exited(0).stdout)[1].clone());
    let gains: Vec<f64> = once.iter().zip(&all).skip(2).map(|(once, all)| all / once).collect();
    let same = |gains: &[f64]| gains.iter().all(|gain| (gain - gains[0]).abs() < 1e-6 && *gain > 1.01);
    // The columns are the reflected light, three channels, true energy and Fresnel part, and then the same with
    // compensation.
    assert!(same(&gains[..4]) && same(&[&gains[6..]].concat()), "{gains:?}");

    let refused = with(&["tv.png", "--f0", "0.5", "--f82", "0.4", "--light", "sphere"]).exited(2);
    assert!(
        refused.stderr.contains("leave out --light; --f82 does not apply to textured lights"),
        "{}",
        refused.stderr
    );
    let refused = with(&["tv.png", "--light", "sphere", "--model", "sg"]).exited(2);
    assert!(
        refused.stderr.contains("leave out --light; works with models normals, ltc and ltc-formula, not sg"),
        "{}",
        refused.stderr
    );
    fs::write(folder.path().join("no.png"), "no picture").expect("a file");
    assert!(with(&["no.png"]).exited(1).stderr.contains("no.png: this file is not a readable image"));
    let triangle = "0.5,0.5,0,0,2,-1,-1,2,1,-1,2,0,1,2\n";
    let refused = run_with_stdin(folder.path(), ["light", "-", "--texture", "tv.png"], triangle).exited(2);
    assert!(refused.stderr.contains("four corners with right angles"), "{}", refused.stderr);
}
