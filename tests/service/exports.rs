//! Exports over HTTP: they have the same bytes as `ltcforge export`, and are made only once.

use std::fs;

use crate::common::{
    SMALL,
    command::run,
    server::{Server, text},
};
use ltcforge::files::digest::Digest;

/// The recipe for an isotropic table with few texels.
const ISOTROPIC: &str = r#"{"layout":"ltc2017","resolution":{"alpha":2,"theta":2},
    "fit":{"samples":64,"directions":4,"steps":5}}"#;

fn exports(digest: &str) -> String {
    format!("/v1/tables/{digest}/exports")
}

#[test]
fn an_export_equals_the_files_of_the_command_and_is_made_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(&folder.path().join("data"), &[]);
    let digest = server.fit(SMALL);
    let table = folder.path().join("table.safetensors");
    fs::write(&table, server.get(&format!("/v1/tables/{digest}")).with_status(200).body).expect("a file");

    let list = server.get(&exports(&digest)).with_status(200).json();
    assert_eq!(list["table"], digest);
    let names: Vec<&str> = list["items"].as_array().expect("items").iter().map(|item| text(&item["name"])).collect();
    assert!(names.contains(&"wgpu") && names.contains(&"reflected-array.ktx2-zstd.f16"), "{names:?}");
    assert!(names.contains(&"compact") && names.contains(&"compact-rust"), "{names:?}");
    assert!(!names.contains(&"three") && !names.iter().any(|name| name.starts_with("kt2022")), "{names:?}");
    assert_eq!(server.metric("ltcforge_exports_total"), 0, "listing exports must not make them");

    for (name, words) in [
        ("wgpu", &["--for", "wgpu"][..]),
        ("reflected.npz.f32", &["--layout", "reflected", "--container", "npz"]),
        ("reflected-array.dds.f16", &["--layout", "reflected-array", "--container", "dds", "--precision", "half"]),
        ("reflected.json.f16", &["--layout", "reflected", "--container", "json", "--precision", "half"]),
        ("compact-js", &["--container", "compact-js"]),
        ("compact-wgsl", &["--container", "compact-wgsl"]),
    ] {
        let out = folder.path().join(name);
        let out_text = out.to_str().expect("a path in UTF-8");
        run(folder.path(), ["export", "table.safetensors", "-o", out_text].iter().chain(words)).exited(0);
        let shown = server.get(&format!("{}/{name}", exports(&digest))).with_status(200).json();
        let files = shown["files"].as_array().expect("files");
        assert_eq!(files.len(), fs::read_dir(&out).expect("a folder").count(), "{name}");
        for file in files {
            let answer = server.get(text(&file["url"])).with_status(200);
            let written = fs::read(out.join(text(&file["path"]))).expect("a file of the command");
            assert!(answer.body == written, "{name}: {} has other bytes than the command writes", file["path"]);
            let pinned = Digest::of(&written).to_string();
            assert_eq!((text(&file["digest"]), file["bytes"].as_u64()), (pinned.as_str(), Some(written.len() as u64)));
            assert_eq!(answer.header("etag"), Some(format!("\"{pinned}\"").as_str()));
            assert_eq!(answer.header("cache-control"), Some("public, max-age=31536000, immutable"));
        }
    }
    assert_eq!(server.metric("ltcforge_exports_total"), 6, "an export was made more than once");
}

/// Babylon.js needs 64 x 64 texels. Its file is inside a folder.
#[test]
fn a_file_in_a_folder_of_an_export_is_served() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let digest = server.fit(&ISOTROPIC.replace(r#""resolution":{"alpha":2,"theta":2},"#, ""));
    let shown = server.get(&format!("{}/babylon", exports(&digest))).with_status(200).json();
    let path = "areaLights/areaLightsLTC.bin";
    let file = shown["files"].as_array().expect("files").iter().find(|file| file["path"] == path).expect(path);
    for url in [text(&file["url"]), &format!("{}/babylon/{path}", exports(&digest))] {
        let answer = server.get(url).with_status(200);
        assert_eq!((answer.body.len(), Digest::of(&answer.body).to_string().as_str()), (65_536, text(&file["digest"])));
        assert_eq!(answer.header("content-disposition"), Some("attachment; filename=\"areaLightsLTC.bin\""));
    }
}

#[test]
fn a_file_of_an_export_supports_ranges_and_conditions() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let digest = server.fit(SMALL);
    let path = format!("{}/wgpu/ltc_terms.ktx2", exports(&digest));
    let ask = |method: &str, fields: &[(&str, &str)]| server.request(method, &path, fields, None);
    let whole = ask("GET", &[]).with_status(200);
    assert_eq!(whole.header("content-type"), Some("image/ktx2"));
    assert_eq!(whole.header("content-disposition"), Some("attachment; filename=\"ltc_terms.ktx2\""));
    assert_eq!(whole.header("cache-control"), Some("public, max-age=86400"), "another version makes other bytes");
    let tag = whole.header("etag").expect("a tag").to_owned();
    assert_eq!(tag, format!("\"{}\"", Digest::of(&whole.body)));

    let probe = ask("HEAD", &[]).with_status(200);
    assert_eq!(probe.header("content-length"), Some(whole.body.len().to_string().as_str()));
    assert!(ask("GET", &[("if-none-match", &tag)]).with_status(304).body.is_empty());
    ask("GET", &[("if-match", "\"x\"")]).with_status(412);
    let (head, tail) = (ask("GET", &[("range", "bytes=0-99")]), ask("GET", &[("range", "bytes=100-")]));
    assert_eq!([head.with_status(206).body, tail.with_status(206).body].concat(), whole.body);
    let past = ask("GET", &[("range", &format!("bytes={}-", whole.body.len()))]).with_status(416);
    assert_eq!(past.json()["type"], "/problems/range-not-satisfiable");
    assert_eq!(server.metric("ltcforge_exports_total"), 1, "the export was made again");

    let shown = server.get(&format!("{}/wgpu", exports(&digest))).with_status(200);
    let tag = shown.header("etag").expect("a tag").to_owned();
    let known = [("if-none-match", tag.as_str())];
    server.request("GET", &format!("{}/wgpu", exports(&digest)), &known, None).with_status(304);
}

#[test]
fn errors_of_exports_name_a_recipe_that_works() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let (own, isotropic) = (server.fit(SMALL), server.fit(ISOTROPIC));
    for (digest, name, recipe) in [
        (&own, "three", "ltc2017"),
        (&own, "godot.exr.f32", "godot"),
        (&isotropic, "hdrp", "hdrp"),
        // The table has the right layout, but not 64 x 64 nodes.
        (&isotropic, "babylon", "ltc2017"),
    ] {
        for path in [name.to_owned(), format!("{name}/file"), format!("{name}/folder/file")] {
            let problem = server.get(&format!("{}/{path}", exports(digest))).with_status(422).json();
            assert_eq!(problem["type"], "/problems/cannot-export", "{path}");
            assert_eq!(problem["recipe"]["layout"], recipe, "{path}: {problem:#}");
            assert!(text(&problem["detail"]).contains(recipe), "{path}: {problem:#}");
        }
        // The service accepts this recipe without changes.
        let problem = server.get(&format!("{}/{name}", exports(digest))).json();
        let id = server.submit(&problem["recipe"].to_string()).with_status(202).json()["id"].clone();
        server.request("DELETE", &format!("/v1/jobs/{}", text(&id)), &[], None).with_status(200);
    }
}

#[test]
fn missing_exports_are_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let digest = server.fit(SMALL);
    let unknown = Digest::of(b"unknown").to_string();
    let other = format!("wgpu/ltc.json?digest={unknown}");
    for (digest, path, status, kind, said) in [
        (&unknown, "", 404, "unknown-table", unknown.as_str()),
        (&unknown, "/wgpu", 404, "unknown-table", &unknown),
        (&unknown, "/wgpu/ltc.json", 404, "unknown-table", &unknown),
        (&digest, "/unity", 404, "unknown-export", "«unity»"),
        (&digest, "/wgpu.ktx2.f16", 404, "unknown-export", "playcanvas"),
        (&digest, "/reflected.ktx2", 404, "unknown-export", "ktx2-zstd"),
        (&digest, "/reflected.ktx2.f64/ltc.ktx2", 404, "unknown-export", "f32, f16"),
        (&digest, "/wgpu/ltc", 404, "unknown-file", "ltc_terms.ktx2"),
        (&digest, "/wgpu/a/ltc.json", 404, "unknown-file", "«a/ltc.json»"),
        (&digest, "/wgpu/%2e%2e%2fltc.json", 404, "unknown-file", "«../ltc.json»"),
        (&digest, "/wgpu?colour=red", 400, "bad-parameter", "colour"),
        (&digest, "?digest=1", 400, "bad-parameter", "digest"),
        (&digest, "/wgpu/ltc.json?digest=xyz", 400, "bad-parameter", "«xyz»"),
        (&digest, &format!("/{other}"), 409, "other-bytes", &unknown),
        (&"xyz".to_owned(), "", 400, "bad-parameter", "«xyz»"),
    ] {
        let problem = server.get(&format!("{}{path}", exports(digest))).with_status(status).json();
        assert_eq!(problem["type"], format!("/problems/{kind}"), "{path}");
        assert!(text(&problem["detail"]).contains(said), "{path}: {problem:#}");
    }
}
