//! A project pins its tables by hash.

mod common;

use std::{fs, path::Path, time::SystemTime};

use common::{
    SMALL,
    command::{Run, run},
    server::Server,
};
use ltcforge::files::digest::Digest;

fn pull(project: &Path, server: &str, args: &[&str]) -> Run {
    run(project, ["pull", "--server", server].iter().chain(args))
}

fn modified(path: &Path) -> SystemTime {
    fs::metadata(path).and_then(|data| data.modified()).expect("a time")
}

/// A server's URL where nobody listens.
const NOBODY: &str = "http://127.0.0.1:9";

#[test]
fn a_pinned_table_is_brought_in_once_and_held_to_its_hash() {
    let folder = tempfile::tempdir().expect("a folder");
    let (data, project) = (folder.path().join("data"), folder.path().join("project"));
    fs::create_dir(&project).expect("a project");
    let server = Server::start(&data, &[]);
    let digest = server.fit(SMALL);
    let file = project.join("assets/metal.safetensors");

    let args = ["--add", "metal", digest.as_str(), "--to", "assets/metal.safetensors"];
    pull(&project, &server.url, &args).exited(0);
    assert_eq!(Digest::of(&fs::read(&file).expect("the table")).to_string(), digest);
    let lock = fs::read_to_string(project.join("ltcforge.lock")).expect("a lock file");
    assert!(lock.contains(&digest) && lock.contains("assets/metal.safetensors"), "{lock}");

    // What is right is neither touched nor asked for.
    let before = modified(&file);
    pull(&project, NOBODY, &[]).exited(0);
    pull(&project, NOBODY, &["--locked"]).exited(0);
    assert_eq!(modified(&file), before);

    // Drift fails and is left alone, until a plain pull mends it.
    fs::write(&file, "drifted").expect("a drifted file");
    let drift = pull(&project, &server.url, &["--locked"]).exited(3);
    assert!(drift.stderr.contains(&Digest::of(b"drifted").to_string()), "{}", drift.stderr);
    assert_eq!(fs::read(&file).expect("the file"), b"drifted");
    fs::remove_file(&file).expect("a file");
    pull(&project, &server.url, &["--locked"]).exited(3);
    assert!(!file.exists(), "--locked downloads nothing");
    pull(&project, NOBODY, &[]).exited(4);
    pull(&project, &server.url, &[]).exited(0);
    assert_eq!(Digest::of(&fs::read(&file).expect("the table")).to_string(), digest);
}

#[test]
fn a_pin_that_the_server_lacks_keeps_no_other_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(&folder.path().join("data"), &[]);
    let digest = server.fit(SMALL);
    let missing = Digest::of(b"missing");
    let lock = format!(
        "version = 1\n[[table]]\nname = \"none\"\ndigest = \"{missing}\"\npath = \"none\"\n\
         [[table]]\nname = \"metal\"\ndigest = \"{digest}\"\npath = \"metal\"\nserver = \"{}\"\n",
        server.url
    );
    fs::write(folder.path().join("ltcforge.lock"), lock).expect("a lock file");
    let ended = pull(folder.path(), &server.url, &["--json"]).exited(1);
    assert!(ended.stderr.contains("none: ") && ended.stderr.contains(&missing.to_string()), "{}", ended.stderr);
    assert!(ended.stdout.contains(r#""outcome":"downloaded""#), "{}", ended.stdout);
    assert!(folder.path().join("metal").exists());
}

#[test]
fn a_lock_file_that_is_wrong_is_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    pull(folder.path(), NOBODY, &[]).exited(1);
    pull(folder.path(), NOBODY, &["--add", "metal", "sha256:12"]).exited(2);
    let digest = Digest::of(b"").to_string();
    pull(folder.path(), NOBODY, &["--add", "metal", &digest, "--to", "../metal"]).exited(2);
    assert!(!folder.path().join("ltcforge.lock").exists());
    fs::write(folder.path().join("ltcforge.lock"), "version = 2").expect("a lock file");
    pull(folder.path(), NOBODY, &[]).exited(2);
}
