//! A full disk: jobs wait for space, and tables can still be read.

use std::{
    fs,
    io::Write as _,
    path::{Path, PathBuf},
    process::Command,
};

use crate::common::{
    ENDLESS, report_skipped,
    server::{Server, text},
};

/// A separate file system. It is unmounted when dropped.
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
        // The folder is deleted with the temporary folder of the test. A failed umount is ignored.
        let _ = Command::new("umount").arg("-l").arg(&self.0).status();
    }
}

/// Fills the rest of the disk.
fn fill(path: &Path) {
    let mut file = fs::File::create(path).expect("a file");
    for block in [65_536, 4096, 1] {
        while file.write_all(&vec![0; block]).is_ok() {}
    }
}

/// A recipe with 720 entries. Its table is larger than the store's reserve.
fn recipe(seed: u32) -> String {
    format!(
        r#"{{"preset":"draft","resolution":{{"alpha":6,"ratio":5,"theta":6,"phi":4}},
            "fit":{{"samples":64,"directions":4,"steps":5,"seed":{seed}}}}}"#
    )
}

#[test]
fn on_a_full_disk_jobs_wait_and_tables_are_served_until_there_is_space() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(disk) = SmallDisk::mount(&folder.path().join("disk")) else {
        return report_skipped("no right to mount a tmpfs");
    };
    let data = disk.0.join("data");
    let server = Server::start(&data, &["--workers", "1"]);
    let before = server.fit(&recipe(0));
    let job = text(&server.submit(ENDLESS).with_status(202).json()["id"]).to_owned();
    let filler = disk.0.join("filler");
    fill(&filler);

    let state = |server: &Server| server.get(&format!("/v1/jobs/{job}"));
    let full = |server: &Server| {
        let problem = server.submit(&recipe(1)).with_status(507).json();
        assert_eq!(problem["type"], "/problems/disk-full", "{problem:#}");
        server.get("/readyz").with_status(503);
        server.get("/healthz").with_status(200);
        server.get(&format!("/v1/tables/{before}")).with_status(200);
        server.get(&format!("/v1/tables/{before}/manifest")).with_status(200);
        server.get("/v1/tables").with_status(200);
    };
    full(&server);
    assert_eq!(state(&server).with_status(200).json()["finished_at"], serde_json::Value::Null);
    server.stop("TERM");
    // After a restart, tables are served and can be deleted. Jobs are available again after a start with enough space.
    let server = Server::start(&data, &["--workers", "1"]);
    full(&server);
    state(&server).with_status(404);
    server.request("DELETE", &format!("/v1/tables/{before}"), &[], None).with_status(204);
    server.get(&format!("/v1/tables/{before}")).with_status(404);
    server.stop("TERM");
    fs::remove_file(&filler).expect("room");
    let server = Server::start(&data, &["--workers", "1"]);
    server.get("/readyz").with_status(200);
    assert_eq!(state(&server).with_status(200).json()["finished_at"], serde_json::Value::Null);
    server.request("DELETE", &format!("/v1/jobs/{job}"), &[], None).with_status(200);
    server.fit(&recipe(1));
    assert_eq!(server.stop("TERM").code, Some(0));
}
