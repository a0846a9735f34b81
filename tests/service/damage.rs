//! Damage of every kind to every file of a data folder: [`DAMAGES`] variants, or `LTCFORGE_TEST_DAMAGES`.
//!
//! The service then says what is wrong, keeps a copy of what was damaged, sends no wrong bytes, and has every job that was
//! acknowledged, or names it. Where it does not start it says in one line why, and all is there once the file is back.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

use rustix::fs::{CWD, FileType, Mode, mknodat};

use super::{brdfs::OCTETS, fsck::write};
use crate::common::{
    command::run,
    folder::contents,
    seeded,
    server::{Server, text},
    soak::{Random, rounds},
};

/// Each file is damaged twice and in each way at least once. A variant takes about a second.
const DAMAGES: usize = 16;

/// Jobs of a folder. The service is killed when the first two are done.
const JOBS: u32 = 6;

#[derive(Debug, Clone, Copy)]
enum How {
    FlipBit,
    Cut,
    Zero,
    Empty,
    Remove,
    /// It changes places with another file.
    Swap,
    FolderInstead,
    FifoInstead,
}

impl How {
    /// Their number has no factor in common with that of the files, so that the variants in order are all pairs.
    const ALL: [Self; 8] = [
        Self::FlipBit,
        Self::Cut,
        Self::Zero,
        Self::Empty,
        Self::Remove,
        Self::Swap,
        Self::FolderInstead,
        Self::FifoInstead,
    ];

    fn damage(self, path: &Path, other: &Path, random: &mut Random) {
        let bytes = fs::read(path).expect("a file");
        let at = random.below(bytes.len().max(1));
        let write = |bytes: &[u8]| fs::write(path, bytes).expect("a file");
        match self {
            Self::FlipBit => {
                let mut bytes = bytes;
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << random.below(8);
                }
                write(&bytes);
            }
            Self::Cut => write(&bytes[..at]),
            Self::Zero => write(&vec![0; bytes.len()]),
            Self::Empty => write(&[]),
            Self::Remove => fs::remove_file(path).expect("a file"),
            Self::Swap => {
                let others = fs::read(other).expect("a file");
                write(&others);
                fs::write(other, bytes).expect("a file");
            }
            Self::FolderInstead => {
                fs::remove_file(path).expect("a file");
                fs::create_dir(path).expect("a folder");
            }
            Self::FifoInstead => {
                fs::remove_file(path).expect("a file");
                mknodat(CWD, path, FileType::Fifo, Mode::RWXU, 0).expect("a FIFO");
            }
        }
    }
}

/// A folder that a killed service left, and what it had promised.
struct World {
    files: BTreeMap<PathBuf, Vec<u8>>,
    /// The files that are damaged.
    targets: Vec<PathBuf>,
    /// Ids of the jobs, their recipes, and their tables.
    jobs: Vec<(String, String, String)>,
    /// Paths of the service and the bytes that it has there.
    downloads: Vec<(String, Vec<u8>)>,
}

impl World {
    fn new(data: &Path) -> Self {
        // Another folder tells the tables of all jobs.
        let elsewhere = tempfile::tempdir().expect("a folder");
        let reference = Server::start(elsewhere.path(), &[]);
        let tables: Vec<String> = (0..JOBS).map(|seed| reference.fit(&seeded(seed))).collect();
        let made = run(elsewhere.path(), ["tabulate", "oren_nayar", "--alpha", "0.2,1", "-o", "eon.safetensors"]);
        let brdf = made.exited(0).last_line().to_owned();
        let brdf_bytes = fs::read(elsewhere.path().join("eon.safetensors")).expect("a file");

        let server = Server::start(data, &["--workers", "1"]);
        server.request("POST", "/v1/brdfs", &[OCTETS], Some(&brdf_bytes)).with_status(201);
        // A BRDF is missed where something refers to it.
        server.fit(&format!(
            r#"{{"brdf": "tabulated", "tabulated": "{brdf}", "resolution": {{"alpha": 2, "theta": 3}},
                "fit": {{"samples": 64, "directions": 4, "steps": 5}}}}"#
        ));
        let submit = |seed: u32| text(&server.submit(&seeded(seed)).with_status(202).json()["id"]).to_owned();
        let ids: Vec<String> = (0..JOBS).map(submit).collect();
        let downloads = (0..2).map(|n| {
            let path = format!("/v1/tables/{}", text(&server.finished(&ids[n])["table"]));
            let bytes = server.get(&path).with_status(200).body;
            (path, bytes)
        });
        let mut downloads: Vec<_> = downloads.collect();
        downloads.push((format!("/v1/brdfs/{brdf}"), brdf_bytes));
        server.kill();

        let files = contents(data);
        let first: Vec<PathBuf> = downloads
            .iter()
            .map(|(_, bytes)| files.iter().find(|(_, found)| *found == bytes).expect("a blob").0.clone())
            .collect();
        let others = ["jobs.log", "db/db", "db/conf", "lock"].map(|name| data.join(name));
        let targets: Vec<PathBuf> = others.into_iter().chain(first).collect();
        let jobs =
            ids.into_iter().zip((0..JOBS).map(seeded)).zip(tables).map(|((id, recipe), table)| (id, recipe, table));
        Self { files, targets, jobs: jobs.collect(), downloads }
    }

    /// Looks at everything that was promised, where `log` says what was found at the start. Returns what is not as it was.
    fn look(&self, server: &Server) -> Vec<String> {
        let mut missing = Vec::new();
        for (path, bytes) in &self.downloads {
            let answer = server.get(path);
            match answer.status {
                200 => assert!(answer.body == *bytes, "{path}: wrong bytes"),
                500 => assert_eq!(answer.json()["type"], "/problems/damaged-blob", "{path}"),
                _ => assert_eq!(answer.status, 404, "{path}"),
            }
            if answer.status != 200 {
                missing.push(path.clone());
            }
        }
        for (id, _, table) in &self.jobs {
            if server.get(&format!("/v1/jobs/{id}")).status == 404 {
                missing.push(id.clone());
                continue;
            }
            let job = server.finished(id);
            assert_eq!((&job["state"], text(&job["table"])), (&"done".into(), table.as_str()), "{job:#}");
        }
        missing
    }
}

#[test]
fn damage_is_told_kept_aside_and_mended() {
    let folder = tempfile::tempdir().expect("a folder");
    let data = folder.path().join("data");
    let world = World::new(&data);
    let mut random = Random(1);
    for variant in 0..rounds("LTCFORGE_TEST_DAMAGES", DAMAGES) {
        fs::remove_dir_all(&data).expect("a folder");
        write(&world.files);
        let how = How::ALL[variant % How::ALL.len()];
        let target = &world.targets[variant % world.targets.len()];
        let other = &world.targets[(variant + 1 + random.below(world.targets.len() - 1)) % world.targets.len()];
        let said = format!("variant {variant}: {how:?} of {}", target.strip_prefix(&data).expect("a part").display());
        how.damage(target, other, &mut random);
        // Of a file without a byte, as one that a short one changed places with, there is nothing to keep.
        let is_file = fs::symlink_metadata(target).is_ok_and(|file| file.is_file());
        let is_blank = !is_file || fs::read(target).expect("a file").iter().all(|byte| *byte == 0);

        let checked = run(folder.path(), ["fsck", "--data", "data"]);
        assert!(matches!(checked.code, Some(0 | 1 | 3)), "{said}: {checked:#?}");
        let server = match Server::attempt(&data, &["--workers", "1"]) {
            Ok(server) => server,
            Err(refused) => {
                assert_eq!((refused.code, refused.complaints().len()), (Some(1), 1), "{said}: {refused:#?}");
                let _ = fs::remove_dir(target).or_else(|_| fs::remove_file(target));
                write(&world.files);
                let server = Server::attempt(&data, &["--workers", "1"]).expect(&said);
                assert_eq!(world.look(&server), [""; 0], "{said}: {refused:#?}");
                continue;
            }
        };
        let missing = world.look(&server);
        let log = server.stop("TERM").exited(0).stderr;
        // Whole lines that are missing at the end leave no trace.
        let journal_is_gone = log.contains("jobs are lost") || matches!(how, How::Cut) && target.ends_with("jobs.log");
        for lost in &missing {
            let digest = lost.rsplit('/').next().unwrap_or(lost);
            assert!(
                log.contains(digest) || journal_is_gone && !lost.contains('/'),
                "{said}: {lost} without a word: {log}"
            );
        }
        // What is told to be damaged is still there to be looked at. A database that ends too early is one that a crash left,
        // and one of zeros is empty.
        let is_kept = !is_blank || matches!(how, How::FolderInstead | How::FifoInstead);
        if log.contains("ERROR") && is_kept {
            assert!(data.join("quarantine").is_dir(), "{said}: {log}");
        }

        // Afterwards it is whole again, and recipes have their tables.
        let server = Server::start(&data, &[]);
        let (_, brdf) = world.downloads.last().expect("a BRDF");
        let sent = server.request("POST", "/v1/brdfs", &[OCTETS], Some(brdf));
        assert!(matches!(sent.status, 200 | 201), "{said}: {sent:?}");
        for (_, recipe, table) in &world.jobs {
            assert_eq!(server.fit(recipe), *table, "{said}");
        }
        assert_eq!(server.stop("TERM").code, Some(0), "{said}");
        let log = Server::start(&data, &[]).stop("TERM").exited(0).stderr;
        assert!(!log.contains("ERROR"), "{said}, two starts later: {log}");
        let checked = run(folder.path(), ["fsck", "--data", "data"]);
        assert_eq!(checked.code, Some(0), "{said}: {checked:#?}");
    }
}
