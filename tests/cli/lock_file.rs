//! A project pins its tables by hash.

use std::{
    ffi::OsStr,
    fs,
    io::{Read as _, Write as _},
    net::TcpListener,
    os::unix::ffi::OsStrExt as _,
    path::Path,
    thread,
    time::SystemTime,
};

use crate::common::{
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
    let bytes = fs::metadata(&file).expect("the table").len();
    assert!(lock.contains(&format!("bytes = {bytes}\n")), "{lock}");

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

#[test]
fn a_pin_is_written_once_its_table_is_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(&folder.path().join("data"), &[]);
    let project = folder.path().join("project");
    fs::create_dir(&project).expect("a project");
    let add = |name: &str, digest: &str, url: &str| pull(&project, url, &["--add", name, digest, "--to", "sub/t"]);
    let missing = Digest::of(b"missing").to_string();
    add("metal", &missing, NOBODY).exited(4);
    add("metal", &missing, &server.url).exited(1);
    assert_eq!(fs::read_dir(&project).expect("the project").count(), 0, "nothing was made");

    // An older pin of the name stays as it was.
    let digest = server.fit(SMALL);
    let added = add("metal", &digest, &server.url).exited(0);
    assert_eq!(added.stdout, "metal downloaded: sub/t\n");
    let lock = fs::read(project.join("ltcforge.lock")).expect("a lock file");
    add("metal", &missing, &server.url).exited(1);
    assert_eq!(fs::read(project.join("ltcforge.lock")).expect("the lock file"), lock);
}

#[test]
fn a_path_that_the_lock_file_cannot_hold_is_refused_first() {
    let folder = tempfile::tempdir().expect("a folder");
    let digest = Digest::of(b"").to_string();
    let words = ["pull", "--server", NOBODY, "--add", "metal", &digest, "--to"].map(OsStr::new);
    let refused = run(folder.path(), words.into_iter().chain([OsStr::from_bytes(b"odd\xff")])).exited(2);
    assert!(refused.stderr.contains("is not UTF-8"), "{refused:#?}");
    assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 0);
}

#[test]
fn an_endless_table_is_cut_at_the_size_that_the_lock_file_states() {
    let folder = tempfile::tempdir().expect("a folder");
    let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let url = format!("http://{}", listener.local_addr().expect("an address"));
    thread::spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.expect("a connection");
            let _ = stream.read(&mut [0; 4096]);
            let mut sent = stream.write_all(b"HTTP/1.1 200 OK\r\nconnection: close\r\n\r\n");
            while sent.is_ok() {
                sent = stream.write_all(&[0; 8192]);
            }
        }
    });
    let pin = format!("version = 1\n[[table]]\nname = \"metal\"\ndigest = \"{}\"\npath = \"t\"\n", Digest::of(b""));
    let lock = folder.path().join("ltcforge.lock");
    fs::write(&lock, format!("{pin}bytes = 1000000\n")).expect("a lock file");
    let refused = pull(folder.path(), &url, &[]).exited(1);
    assert!(refused.stderr.contains("longer than 1000000 bytes, the size that the lock file states"), "{refused:#?}");
    fs::write(&lock, pin).expect("a lock file");
    let refused = pull(folder.path(), &url, &["--table-limit", "2000000"]).exited(1);
    assert!(refused.stderr.contains("longer than 2000000 bytes, the limit for tables"), "{refused:#?}");
    assert_eq!(fs::read_dir(folder.path()).expect("the folder").count(), 1, "nothing is left");
}
