//! Commands that create, read and measure tables.

use std::fs;

use ltcforge::files::digest::Digest;
use serde_json::Value;

use crate::common::{
    ENDLESS, SMALL,
    command::{ltcforge, run, run_with_stdin, signal},
    eventually,
    server::{Server, text},
};

#[test]
fn fit_writes_a_table_under_its_digest_with_any_number_of_threads() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("small.json"), SMALL).expect("a recipe");
    let fitted = run(folder.path(), ["fit", "small.json", "-o", "one", "--threads", "1"]).exited(0);
    let digest: Digest = fitted.last_line().parse().expect("a digest in the last line");
    assert!(fitted.last_line().starts_with("sha256:"));
    assert!(!fitted.stderr.contains('\r'), "a progress bar without a terminal: {:?}", fitted.stderr);
    for said in
        ["16 entries in ", "% on average", &format!("next: ltcforge preview one/{}.safetensors -o", digest.hex())]
    {
        assert!(fitted.stderr.contains(said), "{said} is not in\n{}", fitted.stderr);
    }
    let file = fs::read(folder.path().join(format!("one/{}.safetensors", digest.hex()))).expect("the table");
    assert_eq!(Digest::of(&file), digest);
    let manifest = fs::read(folder.path().join(format!("one/{}.manifest.json", digest.hex()))).expect("the manifest");
    assert!(serde_json::from_slice::<Value>(&manifest).expect("JSON")["report"].is_object());
    assert_eq!(fs::read_dir(folder.path().join("one")).expect("the folder").count(), 2, "another file is left");

    let again = run_with_stdin(folder.path(), ["fit", "-", "-o", "two", "--threads", "2", "--json"], SMALL).exited(0);
    let output: Value = serde_json::from_str(again.last_line()).expect("JSON");
    assert_eq!(output["table"], digest.to_string());
    assert!(output["seconds"].as_f64() >= output["fit_seconds"].as_f64() && output["fit_seconds"].is_f64(), "{output}");
    let report: Value = serde_json::from_slice::<Value>(&manifest).expect("JSON")["report"]["between"]["width"].take();
    assert_eq!((&output["error"]["mean"], &output["error"]["p95"]), (&report["mean"], &report["p95"]));
    assert!(text(&output["next"][0]).starts_with("ltcforge preview two/"), "{output}");
    assert_eq!(again.stderr, "", "with --json, nothing is printed on standard error");
    let other = fs::read(folder.path().join(format!("two/{}.manifest.json", digest.hex()))).expect("the manifest");
    assert_eq!(other, manifest);

    // The service makes the same bytes.
    let server = Server::start(&folder.path().join("data"), &[]);
    assert_eq!(server.fit(SMALL), digest.to_string());
    assert_eq!(server.get(&format!("/v1/tables/{digest}/manifest")).with_status(200).body, manifest);
}

#[test]
fn fit_reports_every_fault_on_its_own_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let bad = r#"{"preset":"draft","colour":1,"fit":{"samples":0}}"#;
    let refused = run_with_stdin(folder.path(), ["fit", "-"], bad).exited(2);
    let lines = refused.complaints();
    assert_eq!(lines.len(), 2, "{refused:#?}");
    assert!(lines.iter().any(|line| line.contains("/colour")), "{lines:?}");
    assert!(lines.iter().any(|line| line.contains("/fit/samples")), "{lines:?}");
    assert!(run(folder.path(), ["fit", "finest"]).exited(2).stderr.contains("finest"));
    assert!(run_with_stdin(folder.path(), ["fit", "-"], "{").exited(2).stderr.contains("not JSON"));
    assert!(run(folder.path(), ["fit", "./none.json"]).exited(1).stderr.contains("./none.json"));
    run(folder.path(), ["fit", "draft", "--entry-limit", "5"]).exited(2);
    assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 0);
}

#[test]
fn an_interrupted_fit_leaves_nothing_behind() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("r.json"), ENDLESS).expect("a recipe");
    let child = ltcforge(folder.path(), ["fit", "r.json", "-o", "out"]).spawn().expect("the binary runs");
    // /proc shows the mask of caught signals. Once the signal is caught, the start of the process is over.
    let status = format!("/proc/{}/status", child.id());
    eventually("the signal to be caught", || {
        let text = fs::read_to_string(&status).ok()?;
        let caught = text.lines().find_map(|line| line.strip_prefix("SigCgt:"))?.trim();
        // SIGINT is signal 2.
        (u64::from_str_radix(caught, 16).ok()? & 0b10 != 0).then_some(())
    });
    signal(&child, "INT");
    let ended = child.wait_with_output().expect("its end");
    assert_eq!(ended.status.code(), Some(130), "{}", String::from_utf8_lossy(&ended.stderr));
    assert!(!folder.path().join("out").exists());
}

#[test]
fn lookup_prints_a_matrix_for_each_point() {
    let folder = tempfile::tempdir().expect("a folder");
    let digest = run_with_stdin(folder.path(), ["fit", "-"], SMALL).exited(0).last_line().to_owned();
    let points = "alpha_x,alpha_y,theta,phi\n0.50,0.25,0.7,0.3\n\n0.25,0.5,0.7,-9.1\n";
    let beginning = &digest[..20];
    let printed = run_with_stdin(folder.path(), ["lookup", beginning, "--points", "-"], points).exited(0);
    let lines: Vec<&str> = printed.stdout.lines().collect();
    assert_eq!(lines[0], "alpha_x,alpha_y,theta,phi,m00,m01,m02,m10,m11,m12,m20,m21,m22,amplitude,fresnel");
    assert!(lines[1].starts_with("0.50,0.25,0.7,0.3,") && lines[2].starts_with("0.25,0.5,0.7,-9.1,"), "{lines:?}");
    assert_eq!(lines.len(), 3);
    for line in &lines[1..] {
        let numbers: Vec<f64> = line.split(',').map(|field| field.parse().expect("a number")).collect();
        assert_eq!(numbers.len(), 15);
        assert!(numbers.iter().all(|number| number.is_finite()));
    }

    fs::write(folder.path().join("p.csv"), "0.5,0.5,0,0\n0.5,1.5,0,0\n").expect("points");
    let file = format!("{}.safetensors", &digest["sha256:".len()..]);
    let refused = run(folder.path(), ["lookup", &file, "--points", "p.csv"]).exited(2);
    assert_eq!(refused.complaints().len(), 1);
    assert!(refused.complaints()[0].contains("p.csv, line 2: alpha_y is «1.5»"), "{}", refused.stderr);
    let json = run_with_stdin(folder.path(), ["lookup", &file, "--points", "-", "--json"], "0.5,0.5,0,0").exited(0);
    let output: Value = serde_json::from_str(json.last_line()).expect("JSON");
    assert_eq!(output["matrix"].as_array().map(Vec::len), Some(9));

    let mut damaged = fs::read(folder.path().join(&file)).expect("the table");
    let last = damaged.len() - 1;
    damaged[last] ^= 1;
    fs::write(folder.path().join(&file), damaged).expect("a damaged table");
    let refused = run_with_stdin(folder.path(), ["lookup", &file, "--points", "-"], points).exited(3);
    assert!(refused.stderr.contains("has digest"), "{}", refused.stderr);
}

#[test]
fn lookup_reports_points_outside_the_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = r#"{"preset": "draft", "fit": {"samples": 32, "directions": 4, "steps": 1},
        "range": {"alpha": [0.2, 0.5], "ratio": [1, 1], "theta": [0, 1], "phi": [0, 0]},
        "resolution": {"alpha": 2, "theta": 2}}"#;
    let digest = run_with_stdin(folder.path(), ["fit", "-"], recipe).exited(0).last_line().to_owned();
    let look_up = |points: &str, option: &[&str]| {
        run_with_stdin(folder.path(), ["lookup", &digest, "--points", "-"].iter().chain(option), points).exited(0)
    };
    // Isotropic surfaces have no azimuth, so no azimuth is outside.
    assert_eq!(look_up("0.2,0.2,0,0\n0.5,0.5,1,4\n", &[]).stderr, "");
    let points = "0.1,0.1,0.5,0\n0.5,0.5,1.2,0\n0.3,0.15,0.5,0\n0.1,0.1,1.5,0\n0.3,0.3,0.5,0\n";
    let expected = "4 of 5 points are outside the table's range and were clamped:\n\
                    \x20 alpha below 0.2: 2 clamped to 0.2\n\
                    \x20 ratio below 1: 1 clamped to 1\n\
                    \x20 theta above 1: 2 clamped to 1\n";
    let printed = look_up(points, &[]);
    assert_eq!(printed.stderr, expected);
    assert_eq!(printed.stdout.lines().count(), 6);
    let output: Vec<Value> =
        look_up(points, &["--json"]).stdout.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let clamped: Vec<String> = output.iter().map(|line| line["clamped"].to_string()).collect();
    assert_eq!(
        clamped,
        [r#"{"alpha":0.2}"#, r#"{"theta":1.0}"#, r#"{"ratio":1.0}"#, r#"{"alpha":0.2,"theta":1.0}"#, "{}"]
    );
}

#[test]
fn a_digest_as_fit_prints_it_names_the_table_in_every_command() {
    let folder = tempfile::tempdir().expect("a folder");
    let digest = run_with_stdin(folder.path(), ["fit", "-", "-o", "tables"], SMALL).exited(0).last_line().to_owned();
    let beginning = &digest["sha256:".len()..][..8];
    fs::write(folder.path().join("p.csv"), "0.5,0.5,0,0\n").expect("points");
    let commands: [&[&str]; 5] = [
        &["lookup", "TABLE", "--points", "p.csv"],
        &["report", "TABLE"],
        &["preview", "TABLE", "-o", "p.png", "--size", "64", "--adapter", "cpu"],
        &["plot", "TABLE", "matrix", "-o", "m.png"],
        &["verify", "TABLE"],
    ];
    for command in commands {
        let with = |table: &str| -> Vec<String> { command.iter().map(|word| word.replace("TABLE", table)).collect() };
        for table in [digest.as_str(), beginning] {
            run(folder.path(), with(table)).exited(0);
        }
        let refused = run(folder.path(), with("sha256:ffff0")).exited(1);
        let expected = "sha256:ffff0: there is no such file, and no ffff0*.safetensors in ./ and tables/; \
                        use --tables to search another folder";
        assert_eq!(refused.complaints(), [expected]);
        run(folder.path(), with(&digest).into_iter().chain(["--tables".to_owned(), ".".to_owned()])).exited(1);
    }
    // If both folders contain the same table, it counts as one table.
    let name = format!("{}.safetensors", &digest["sha256:".len()..]);
    fs::copy(folder.path().join("tables").join(&name), folder.path().join(&name)).expect("a copy");
    assert!(run(folder.path(), ["verify", beginning]).exited(0).stdout.starts_with(&name));
}

/// The bytes of a `.npy` file with 2 x 2 x 2 x 2 clamped cosines. One of them is mirrored.
fn npy() -> Vec<u8> {
    let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2, 2, 2, 3, 3), }\n";
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(u16::try_from(header.len()).expect("a short header").to_le_bytes());
    bytes.extend(header.bytes());
    for entry in 0..16 {
        let yy = if entry == 5 { -1.0 } else { 1.0 };
        bytes.extend([1.0, 0.0, 0.0, 0.0, yy, 0.0, 0.0, 0.0, 1.0_f32].iter().flat_map(|x| x.to_le_bytes()));
    }
    bytes
}

#[test]
fn report_agrees_with_manifests_and_reads_npy_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let digest = run_with_stdin(folder.path(), ["fit", "-"], SMALL).exited(0).last_line().to_owned();
    let hex = &digest["sha256:".len()..];
    let json = |args: &[&str]| -> Value {
        let printed = run(folder.path(), ["report", "--json"].iter().chain(args)).exited(0);
        serde_json::from_str(printed.stdout.trim()).expect("one line of JSON")
    };
    let output = json(&[&hex[..12], "--threads", "1"]);
    let manifest = fs::read(folder.path().join(format!("{hex}.manifest.json"))).expect("the manifest");
    let manifest: Value = serde_json::from_slice(&manifest).expect("JSON");
    assert_eq!((&output["report"], &output["digest"]), (&manifest["report"], &manifest["table"]));
    assert_eq!(output["resolution"]["theta"], 2);
    assert_eq!(json(&[&hex[..12], "--points", "11"])["report"]["between"]["points"], 11);
    let refused = run(folder.path(), ["report", hex, "--points", "7"]).exited(2);
    assert!(refused.stderr.contains("7 is not in 8..=1000000"), "{}", refused.stderr);
    let people = run(folder.path(), ["report", &hex[..12]]).exited(0).stdout;
    for said in [
        &digest,
        "error between nodes, mean",
        "at 8 nodes",
        "at 8 places between",
        "worst at nodes",
        "0 negative",
        "alpha_y",
    ] {
        assert!(people.contains(said), "{said} is not in\n{people}");
    }

    fs::write(folder.path().join("other.npy"), npy()).expect("a file");
    let other = json(&["other.npy"]);
    assert_eq!(other["report"]["matrices"]["negative_determinants"], 1);
    assert_eq!(other["report"]["nodes"]["amplitude"], Value::Null);
    assert_eq!(other["report"]["between"]["points"], 1024);
    let cosine = other["report"]["nodes"]["sw1"]["mean"].as_f64().expect("a number");
    assert!(cosine > 0.1, "no lobe is a cosine: {cosine}");

    let cut = npy();
    fs::write(folder.path().join("cut.npy"), &cut[..cut.len() - 1]).expect("a file");
    let refused = run(folder.path(), ["report", "cut.npy"]).exited(3);
    assert!(refused.stderr.contains("575 bytes of data; the shape needs 576"), "{}", refused.stderr);
    fs::write(folder.path().join("empty.npy"), b"").expect("a file");
    let refused = run(folder.path(), ["report", "empty.npy"]).exited(3);
    assert!(refused.complaints()[0].contains("not a .npy file"), "{:?}", refused.complaints());
    run(folder.path(), ["report", "none.npy"]).exited(1);
    run(folder.path(), ["report", "ffff"]).exited(1);
}

#[test]
fn verify_compares_files_with_their_names() {
    let folder = tempfile::tempdir().expect("a folder");
    let digest = run_with_stdin(folder.path(), ["fit", "-"], SMALL).exited(0).last_line().to_owned();
    let name = format!("{}.safetensors", &digest["sha256:".len()..]);
    let good = fs::read(folder.path().join(&name)).expect("the table");
    assert!(run(folder.path(), ["verify", &name]).exited(0).stdout.contains(&digest));

    let other = Digest::of(b"").to_string();
    run(folder.path(), ["verify", &name, "--digest", &other]).exited(3);
    fs::write(folder.path().join("plain.safetensors"), &good[..good.len() - 1]).expect("a cut table");
    run(folder.path(), ["verify", "plain.safetensors"]).exited(3);
    let mut bad = good.clone();
    *bad.last_mut().expect("bytes") ^= 1;
    fs::write(folder.path().join(&name), &bad).expect("a damaged table");
    run(folder.path(), ["verify", &name]).exited(3);
    run(folder.path(), ["verify", "none"]).exited(1);
}

#[test]
fn verify_compares_a_folder_of_blobs_with_its_names() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let path_of = |hex: &str| here.join("data/blobs").join(&hex[..2]).join(hex);
    let keep = |bytes: &[u8]| {
        let path = path_of(&Digest::of(bytes).hex());
        fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
        fs::write(&path, bytes).expect("a blob");
        path
    };
    let (one, two) = (keep(b"one"), keep(b"two"));
    fs::write(one.with_file_name("unfinished.tmp"), "x").expect("a file of another name");
    for (named, said) in [("data", "data: ok, all 2 files"), ("data/blobs", "data/blobs: ok, all 2 files")] {
        assert!(run(here, ["verify", named]).exited(0).stdout.starts_with(said), "{named}");
    }

    fs::write(&one, "damaged").expect("a blob");
    let refused = run(here, ["verify", "data"]).exited(3);
    assert!(refused.complaints().len() == 1 && refused.stderr.contains(&Digest::of(b"one").hex()), "{refused:#?}");
    // An entry that is not a regular file is reported but not read.
    fs::remove_file(&two).expect("a blob");
    std::os::unix::fs::symlink("/dev/zero", &two).expect("a link");
    let refused = run(here, ["verify", "data", "--json"]).exited(3);
    assert!(refused.stdout.contains("has digest") && refused.stdout.contains("not a regular file"), "{refused:#?}");

    fs::create_dir(here.join("empty")).expect("a folder");
    assert!(run(here, ["verify", "empty"]).exited(1).stderr.contains("neither ltcforge.json nor files"));
    assert!(run(here, ["verify", "data", "--refit"]).exited(2).stderr.contains("need a table"));
}
