//! A full disk fails the job, not the service.

use std::{
    fs,
    io::Write as _,
    path::{Path, PathBuf},
    process::Command,
};

use crate::common::{
    server::{Server, text},
    tell_skipped,
};
use serde_json::Value;

/// A file system of its own, unmounted when dropped.
struct SmallDisk(PathBuf);

impl SmallDisk {
    fn mount(at: &Path) -> Option<Self> {
        fs::create_dir(at).expect("a mount point");
        let mounted = Command::new("mount").args(["-t", "tmpfs", "-o", "size=24m", "tmpfs"]).arg(at).output().ok()?;
        mounted.status.success().then(|| Self(at.to_owned()))
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        // The folder goes with the test's temporary folder; a mount that stays is the system's to report.
        let _ = Command::new("umount").arg("-l").arg(&self.0).status();
    }
}

/// Fills what is left of the disk.
fn fill(path: &Path) {
    let mut file = fs::File::create(path).expect("a file");
    for block in [65_536, 4096, 1] {
        while file.write_all(&vec![0; block]).is_ok() {}
    }
}

/// Seven hundred entries: more bytes than the store has in hand.
fn recipe(seed: u32) -> String {
    format!(
        r#"{{"preset":"draft","resolution":{{"alpha":6,"ratio":5,"theta":6,"phi":4}},
            "fit":{{"samples":64,"directions":4,"steps":5,"seed":{seed}}}}}"#
    )
}

/// Why a recipe did not become a table: refused at once, or accepted and failed later.
fn refusal(server: &Server, recipe: &str) -> Value {
    let answer = server.submit(recipe);
    match answer.status {
        202 => server.finished(text(&answer.json()["id"]))["error"].clone(),
        _ => answer.json(),
    }
}

#[test]
fn a_full_disk_fails_the_job_and_room_heals_the_service() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(disk) = SmallDisk::mount(&folder.path().join("disk")) else {
        return tell_skipped("no right to mount a tmpfs");
    };
    let server = Server::start(&disk.0.join("data"), &[]);
    let before = server.fit(&recipe(0));
    let filler = disk.0.join("filler");
    fill(&filler);

    let problem = refusal(&server, &recipe(1));
    assert_eq!(problem["type"], "/problems/disk-full", "{problem:#}");
    server.get("/healthz").with_status(200);
    server.get(&format!("/v1/tables/{before}")).with_status(200);

    fs::remove_file(&filler).expect("room");
    server.fit(&recipe(1));
    assert_eq!(server.stop("TERM").code, Some(0));
}
