//! Tables and files of exports, compressed for the clients that accept zstd.

use crate::common::{
    SMALL,
    server::{Answer, Server, text},
};
use ltcforge::files::digest::Digest;

/// The bytes that a compressed answer stands for.
fn unpacked(answer: &Answer) -> Vec<u8> {
    assert_eq!(answer.header("content-encoding"), Some("zstd"), "{answer:?}");
    zstd::decode_all(answer.body.as_slice()).expect("a zstd frame")
}

#[test]
fn a_table_is_compressed_for_whoever_accepts_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let digest = server.fit(SMALL);
    let path = format!("/v1/tables/{digest}");
    let ask = |method: &str, fields: &[(&str, &str)]| server.request(method, &path, fields, None);

    let plain = ask("GET", &[("accept-encoding", "identity")]).with_status(200);
    let packed = ask("GET", &[("accept-encoding", "gzip, zstd;q=0.5")]).with_status(200);
    assert_eq!(Digest::of(&unpacked(&packed)).to_string(), digest);
    assert!(packed.body.len() * 10 < plain.body.len() * 9, "{} of {}", packed.body.len(), plain.body.len());
    for answer in [&plain, &packed] {
        let own = Digest::of(&answer.body);
        assert_eq!(answer.header("etag"), Some(format!("\"{own}\"").as_str()), "each representation has its own");
        assert_eq!(answer.header("repr-digest"), answer.header("content-digest"));
        assert_eq!(answer.header("vary"), Some("accept-encoding"));
        assert_eq!(answer.header("content-disposition"), plain.header("content-disposition"));
    }
    assert_ne!(packed.header("content-digest"), plain.header("content-digest"));

    for refused in ["zstd;q=0", "gzip", "*", "identity, zstd;q=0.9"] {
        let answer = ask("GET", &[("accept-encoding", refused)]).with_status(200);
        assert_eq!((answer.header("content-encoding"), &answer.body), (None, &plain.body), "{refused}");
    }

    let probe = ask("HEAD", &[("accept-encoding", "zstd")]).with_status(200);
    assert!(probe.body.is_empty());
    for field in ["etag", "repr-digest", "content-encoding", "vary"] {
        assert_eq!(probe.header(field), packed.header(field), "{field}");
    }
    assert_eq!(probe.header("content-length"), Some(packed.body.len().to_string().as_str()));
}

#[test]
fn conditions_count_for_the_representation_that_they_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let path = format!("/v1/tables/{}", server.fit(SMALL));
    let ask = |fields: &[(&str, &str)]| server.request("GET", &path, fields, None);
    let zstd = ("accept-encoding", "zstd");
    let (plain, packed) = (ask(&[("accept-encoding", "identity")]), ask(&[zstd]));
    let tag = |answer: &Answer| answer.header("etag").expect("a tag").to_owned();
    let (plain_tag, packed_tag) = (tag(&plain), tag(&packed));

    for own in [&plain_tag, &packed_tag] {
        let known = ask(&[zstd, ("if-none-match", own)]).with_status(304);
        assert_eq!((known.header("etag"), known.header("vary")), (Some(own.as_str()), Some("accept-encoding")));
        let matched = ask(&[zstd, ("if-match", own)]).with_status(200);
        assert_eq!(matched.header("etag"), Some(own.as_str()));
    }
    let identity = ("accept-encoding", "identity");
    let other = ask(&[identity, ("if-none-match", &packed_tag)]).with_status(200);
    assert_eq!(other.body, plain.body, "the client cannot use what it has");
    ask(&[identity, ("if-match", &packed_tag)]).with_status(412);

    let part = ask(&[zstd, ("range", "bytes=10-99")]).with_status(206);
    assert_eq!((part.header("content-encoding"), part.body.as_slice()), (None, &plain.body[10..100]));
    assert_eq!((part.header("etag"), part.header("vary")), (Some(plain_tag.as_str()), Some("accept-encoding")));
    ask(&[zstd, ("range", "bytes=10-99"), ("if-range", &plain_tag)]).with_status(206);
    let whole = ask(&[zstd, ("range", "bytes=10-99"), ("if-range", &packed_tag)]).with_status(200);
    assert_eq!(whole.body, plain.body, "no part of a compressed table is sent");
}

#[test]
fn files_of_exports_are_compressed_and_their_list_is_not() {
    let folder = tempfile::tempdir().expect("a folder");
    // Nothing is kept, so that the files are made anew.
    let server = Server::start(folder.path(), &["--export-bytes", "0"]);
    let export = format!("/v1/tables/{}/exports/reflected.json.f16", server.fit(SMALL));
    let zstd = [("accept-encoding", "zstd")];
    let shown = server.request("GET", &export, &zstd, None).with_status(200);
    assert_eq!((shown.header("content-encoding"), shown.header("vary")), (None, None));
    let shown = shown.json();
    for file in shown["files"].as_array().expect("files") {
        // The harness reads JSON where the answer says so; a HEAD tells the fields of a GET.
        let probe = server.request("HEAD", text(&file["url"]), &zstd, None).with_status(200);
        assert_eq!((probe.header("content-encoding"), probe.header("vary")), (Some("zstd"), Some("accept-encoding")));
        let plain = server.get(text(&file["url"])).with_status(200);
        assert_eq!(plain.header("vary"), Some("accept-encoding"));
        let length: usize = probe.header("content-length").and_then(|n| n.parse().ok()).expect("a length");
        assert!(length * 10 < plain.body.len() * 9, "{length} of {}", plain.body.len());
    }
    let binary = export.replace("reflected.json.f16", "wgpu/ltc_terms.ktx2");
    let (plain, packed) = (server.get(&binary), server.request("GET", &binary, &zstd, None).with_status(200));
    assert_eq!(unpacked(&packed), plain.with_status(200).body);
}
