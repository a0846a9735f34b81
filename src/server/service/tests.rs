use std::{
    fs,
    num::NonZeroUsize,
    path::{Path, PathBuf},
    sync::Arc,
    time::Duration,
};

use jiff::{SignedDuration, Timestamp};

use super::*;
use crate::{
    queue::{JobId, JobState},
    service::pictures::Subject,
    store::StoreError,
};
use ltcforge_files::{
    container::encode_lut,
    digest::Digest,
    recipe_document::{AnyRecipe, parse_any},
    tabulated::{encode, no_files},
};
use ltcforge_fit::albedo::{LutPlan, fit_lut};
use ltcforge_fit::{BrdfKind, TabulatedAxes, TabulatedBrdf};
use ltcforge_textures::Export;
use ltcforge_view::{
    plots::Plot,
    preview::{Adapter, Mode, Scene},
};

pub(super) fn config(folder: &Path) -> Config {
    Config {
        data_dir: folder.to_owned(),
        workers: 2,
        queue_limit: 8,
        entry_limit: 10_000,
        job_seconds: 86_400,
        keep_ended: None,
        store_bytes: None,
        lease_ttl: Duration::from_secs(60),
        adapter: Adapter::Cpu,
        picture_time: Duration::from_secs(60),
        brdf_limit: 2,
    }
}

/// A recipe of 16 entries. Different seeds give different tables.
fn recipe(seed: u32) -> String {
    format!(
        r#"{{"preset": "draft", "resolution": {{"alpha": 2, "ratio": 2, "theta": 2, "phi": 2}},
        "fit": {{"samples": 64, "directions": 4, "steps": 1, "seed": {seed}}}}}"#
    )
}

fn runtime() -> tokio::runtime::Runtime {
    tokio::runtime::Builder::new_multi_thread().enable_all().build().unwrap()
}

fn submitted(service: &Service, recipe: &str) -> JobId {
    match service.submit(recipe.as_bytes(), Some("ci")).unwrap() {
        SubmitReply::InFlight { job, .. } | SubmitReply::Ready { job, .. } => job.id,
    }
}

/// The states that a follower of a job receives, up to the final state.
fn followed(service: &Service, id: JobId) -> Vec<JobState> {
    let mut latest = service.watch(id).unwrap().unwrap();
    let mut states = Vec::new();
    runtime().block_on(async {
        loop {
            let state = latest.borrow_and_update().job.state.clone();
            let is_final = state.name().is_final();
            if states.last() != Some(&state) {
                states.push(state);
            }
            if is_final || latest.changed().await.is_err() {
                return states;
            }
        }
    })
}

fn fitted(service: &Service, recipe: &str) -> Digest {
    match followed(service, submitted(service, recipe)).pop() {
        Some(JobState::Done { table }) => table,
        other => panic!("{other:?}"),
    }
}

fn path(folder: &Path, digest: Digest) -> PathBuf {
    let hex = digest.hex();
    folder.join("blobs").join(&hex[..2]).join(&hex)
}

/// Sets the times of a file as if it had been stored and used `seconds` ago.
fn used_ago(file: &Path, seconds: u64) {
    let time = std::time::SystemTime::now() - Duration::from_secs(seconds);
    let times = fs::FileTimes::new().set_accessed(time).set_modified(time);
    fs::File::options().write(true).open(file).unwrap().set_times(times).unwrap();
}

fn brdf(alpha: f64) -> Vec<u8> {
    let axes = TabulatedAxes::spread(vec![alpha, 1.0], 48, 32);
    encode(&TabulatedBrdf::tabulate(BrdfKind::OrenNayar, axes).unwrap()).unwrap()
}

#[test]
fn a_lookup_table_takes_the_same_path_as_an_ltc_table() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::open(config(folder.path())).unwrap();
    let document = r#"{"table": "dfg", "resolution": {"roughness": 5, "cos_theta": 4}}"#;
    let foreseen = service.foresee(document.as_bytes()).unwrap();
    assert_eq!((foreseen.entries, foreseen.expected.unwrap().shards), (20, 5));
    let table = fitted(&service, document);
    // The file is that of a fit without the service.
    let recipe = parse_any(document.as_bytes(), 10_000, &no_files).unwrap();
    let AnyRecipe::Lut(recipe) = recipe else { panic!("{recipe:?}") };
    let lut = fit_lut(&LutPlan::new(&recipe), &|_| std::ops::ControlFlow::Continue(())).unwrap();
    assert_eq!(Digest::of(&encode_lut(&recipe, &lut).unwrap()), table);
    let manifest: serde_json::Value = serde_json::from_str(&service.manifest(table).unwrap().unwrap()).unwrap();
    assert_eq!((&manifest["recipe"]["table"], &manifest["entries"]), (&"dfg".into(), &20.into()));
    let exports: Vec<String> = service.exports(table).unwrap().unwrap().iter().map(ToString::to_string).collect();
    assert!(exports.starts_with(&["three".to_owned()]) && exports.contains(&"blender".to_owned()), "{exports:?}");
    assert!(exports.contains(&"png".to_owned()) && exports.contains(&"ktx2.f16".to_owned()), "{exports:?}");
    let made = service.export(table, "bevy".parse().unwrap()).unwrap().unwrap();
    assert_eq!(made.files[0].path, "dfg.ktx2");
    let refused = service.export(table, "playcanvas".parse().unwrap()).unwrap_err();
    assert!(matches!(refused, ExportFailure::Lut(_)), "{refused}");
    // The catalogue finds the table again without its database.
    service.stop();
    drop(service);
    fs::remove_dir_all(folder.path().join("db")).unwrap();
    let service = Service::open(config(folder.path())).unwrap();
    assert!(
        matches!(service.submit(document.as_bytes(), None).unwrap(), SubmitReply::Ready { table: found, .. } if found == table)
    );
}

#[test]
fn a_lost_database_loses_no_table_and_no_brdf() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::open(config(folder.path())).unwrap();
    let table = fitted(&service, &recipe(1));
    let (brdf, was_there) = service.store_brdf(&brdf(0.2)).unwrap();
    assert!(!was_there);
    let manifest = service.manifest(table).unwrap().unwrap();
    service.stop();
    drop(service);
    fs::remove_dir_all(folder.path().join("db")).unwrap();
    let service = Service::open(config(folder.path())).unwrap();
    let listed: Vec<_> = service.tables(None, 9).unwrap().items.into_iter().map(|row| row.row.digest).collect();
    assert_eq!(listed, [table]);
    assert_eq!(service.brdfs(None, 9).unwrap().items[0].digest, brdf.digest);
    assert_eq!(service.manifest(table).unwrap().unwrap(), manifest);
    assert!(
        matches!(service.submit(recipe(1).as_bytes(), None), Ok(SubmitReply::Ready { table: ready, .. }) if ready == table)
    );
}

#[test]
fn a_follower_sees_the_last_state_and_equal_recipes_share_a_job() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::open(Config { workers: 0, ..config(folder.path()) }).unwrap();
    let id = submitted(&service, &recipe(1));
    let again = service.submit(recipe(1).as_bytes(), None).unwrap();
    assert!(
        matches!(again, SubmitReply::InFlight { job, joined: true } if job.id == id && job.submitted_by.as_deref() == Some("ci"))
    );
    let follower = {
        let service = Arc::clone(&service);
        std::thread::spawn(move || followed(&service, id))
    };
    while service.state.hub_len() == 0 {
        std::thread::yield_now();
    }
    service.cancel(id, Some("somebody")).unwrap().unwrap();
    assert_eq!(follower.join().unwrap().pop(), Some(JobState::Cancelled));
    assert_eq!(service.state.hub_len(), 0, "an ended job keeps no channel");
}

#[test]
fn the_least_recently_used_tables_are_evicted_and_a_brdf_never() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::open(config(folder.path())).unwrap();
    let tables = [1, 2, 3].map(|seed| fitted(&service, &recipe(seed)));
    let stored = service.store_brdf(&brdf(0.2)).unwrap().0;
    // The second file was used last.
    for (table, age) in tables.into_iter().zip([3000, 1000, 2000]) {
        used_ago(&path(folder.path(), table), age);
    }
    let of_table = fs::metadata(path(folder.path(), tables[0])).unwrap().len();
    let limit = stored.bytes as u64 + of_table + of_table / 2;
    service.state.evict_above(limit, Timestamp::now()).unwrap();
    let there = tables.map(|table| path(folder.path(), table).exists());
    assert_eq!(there, [false, true, false]);
    assert_eq!(service.file(FileKind::Table, tables[0]).unwrap(), None, "the table is no longer cached");
    let job = service.job_of_table(tables[0]).unwrap().unwrap();
    assert!(job.recipe.contains("\"seed\":1"), "the recipe is still known: {}", job.recipe);
    // Only the BRDF fits into the limit, but the table stays at first, because it was just served from memory.
    assert!(service.file(FileKind::Table, tables[1]).unwrap().is_some());
    used_ago(&path(folder.path(), tables[1]), 1000);
    assert!(service.cached_file(FileKind::Table, tables[1]).is_some());
    service.state.evict_above(1, Timestamp::now()).unwrap();
    assert!(path(folder.path(), tables[1]).exists(), "a table that is about to be fetched stays");
    service.state.evict_above(1, Timestamp::now() + SignedDuration::from_secs(1000)).unwrap();
    assert!(!path(folder.path(), tables[1]).exists() && path(folder.path(), stored.digest).exists());
    assert_eq!(fitted(&service, &recipe(1)), tables[0], "an evicted table is fitted again");
}

#[test]
fn a_full_disk_evicts_tables_above_the_limit() {
    let folder = tempfile::tempdir().unwrap();
    let table = {
        let service = Service::open(config(folder.path())).unwrap();
        fitted(&service, &recipe(1))
    };
    let idle = Config { workers: 0, store_bytes: Some(1), ..config(folder.path()) };
    let service = Service::open(idle).unwrap();
    let file = path(folder.path(), table);
    assert!(file.exists(), "the table was used a moment ago");
    submitted(&service, &recipe(2));
    let task = service.state.queue.lease(NonZeroUsize::MIN).unwrap().remove(0);
    used_ago(&file, 5000);
    let stored = || if file.exists() { Err(StoreError::DiskFull) } else { Ok(()) };
    assert!(service.state.retried(&task, stored).is_ok() && !file.exists());
}

#[test]
fn nothing_is_evicted_after_a_start_that_was_not_clean() {
    let folder = tempfile::tempdir().unwrap();
    let (table, stored) = {
        let service = Service::open(config(folder.path())).unwrap();
        (fitted(&service, &recipe(1)), service.store_brdf(&brdf(0.2)).unwrap().0.digest)
    };
    used_ago(&path(folder.path(), table), 5000);
    fs::write(folder.path().join("db/db"), b"no database").unwrap();
    let small = Config { store_bytes: Some(1), ..config(folder.path()) };
    let service = Service::open(small.clone()).unwrap();
    assert!(!service.state.is_complete && path(folder.path(), table).exists());
    assert_eq!(service.tables(None, 9).unwrap().items.len(), 1);
    assert!(matches!(service.delete_brdf(stored), Err(DeleteError::Incomplete(_))));
    service.stop();
    drop(service);
    // The start has just read the table, which counts as a use.
    used_ago(&path(folder.path(), table), 5000);
    let service = Service::open(small).unwrap();
    assert!(service.state.is_complete && !path(folder.path(), table).exists());
    service.delete_brdf(stored).unwrap();
}

#[test]
fn a_damaged_table_is_moved_away_and_fitted_again() {
    let folder = tempfile::tempdir().unwrap();
    let table = {
        let service = Service::open(config(folder.path())).unwrap();
        fitted(&service, &recipe(1))
    };
    let file = path(folder.path(), table);
    let mut bytes = fs::read(&file).unwrap();
    bytes[1000] ^= 1;
    fs::write(&file, bytes).unwrap();
    let service = Service::open(config(folder.path())).unwrap();
    let error = service.file(FileKind::Table, table).unwrap_err();
    assert!(matches!(&error, ServiceError::Corrupt(text) if text.contains(&table.to_string())), "{error}");
    assert_eq!((service.metrics().unwrap().blobs_corrupt, file.exists()), (1, false));
    assert_eq!(fitted(&service, &recipe(1)), table);
    assert!(service.file(FileKind::Table, table).unwrap().is_some());
}

#[test]
fn a_deleted_table_is_unknown_until_it_is_fitted_again() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::open(config(folder.path())).unwrap();
    let table = fitted(&service, &recipe(1));
    service.delete_table(table, None).unwrap();
    assert!(matches!(service.delete_table(table, None), Err(DeleteError::UnknownTable(_))));
    assert!(service.tables(None, 9).unwrap().items.is_empty());
    assert_eq!(fitted(&service, &recipe(1)), table);
}

#[test]
fn a_brdf_stays_although_an_older_database_does_not_list_its_table() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::open(config(folder.path())).unwrap();
    let stored = service.store_brdf(&brdf(0.2)).unwrap().0.digest;
    let table = fitted(&service, &of_brdf(stored));
    let catalogue = &service.state.files.catalogue;
    catalogue.rows.commit(&catalogue.removal(table).unwrap()).unwrap();
    assert!(service.tables(None, 9).unwrap().items.is_empty());
    assert!(matches!(service.delete_brdf(stored), Err(DeleteError::InUse(_))));
    assert_eq!(service.tables(None, 9).unwrap().items.len(), 1);
}

fn of_brdf(stored: Digest) -> String {
    format!(r#"{{"brdf": "tabulated", "tabulated": "{stored}", "resolution": {{"alpha": 2, "theta": 3}}}}"#)
}

#[test]
fn a_brdf_that_a_recipe_names_stays_and_there_is_a_limit() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::open(Config { workers: 0, ..config(folder.path()) }).unwrap();
    let [first, second] = [0.2, 0.3].map(|alpha| service.store_brdf(&brdf(alpha)).unwrap().0.digest);
    assert!(matches!(service.store_brdf(&brdf(0.4)), Err(StoreBrdfError::TooMany(2))));
    assert!(service.store_brdf(&brdf(0.3)).unwrap().1, "a BRDF that is stored already does not count again");
    let recipe = of_brdf(first);
    let id = submitted(&service, &recipe);
    assert!(matches!(service.delete_brdf(first), Err(DeleteError::InUse(_))));
    service.delete_brdf(second).unwrap();
    assert!(matches!(service.delete_brdf(second), Err(DeleteError::UnknownBrdf(_))));
    service.cancel(id, None).unwrap();
    service.delete_brdf(first).unwrap();
    let refused = service.submit(recipe.as_bytes(), None).unwrap_err();
    assert!(matches!(refused, SubmitError::Recipe(_)), "{refused}");
}

#[test]
fn an_export_is_made_once_and_forgotten_with_its_table() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::open(config(folder.path())).unwrap();
    let table = fitted(&service, &recipe(1));
    let export: Export = "wgpu".parse().unwrap();
    let made = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(|| service.export(table, export).unwrap().unwrap())).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect::<Vec<_>>()
    });
    assert!(made.iter().all(|other| Arc::ptr_eq(other, &made[0])));
    assert_eq!(service.metrics().unwrap().exports_made, 1);
    service.delete_table(table, None).unwrap();
    assert!(service.export(table, export).unwrap().is_none());
}

fn scene(size: u32, samples: u32) -> Subject {
    Subject::Scene(Box::new(Scene { size, spp: samples, mode: Mode::Reference, ..Scene::default() }))
}

#[test]
fn a_picture_is_rendered_once_and_a_slow_or_huge_one_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::open(config(folder.path())).unwrap();
    let runtime = runtime();
    let picture = |service: &Service, subject| runtime.block_on(service.picture(None, subject));
    let first = picture(&service, scene(64, 1)).unwrap();
    let second = picture(&service, scene(64, 1)).unwrap();
    assert_eq!((first.digest, &*first.adapter), (second.digest, "cpu"));
    assert_eq!(service.metrics().unwrap().pictures.done, 1);
    let none = picture(&service, Subject::Scene(Box::new(Scene { mode: Mode::Ltc, ..Scene::default() })));
    assert!(matches!(none, Err(PictureError::NoTable)), "{none:?}");
    service.stop();
    drop(service);
    let service = Service::open(Config { picture_time: Duration::ZERO, ..config(folder.path()) }).unwrap();
    assert!(matches!(picture(&service, scene(64, 1)), Err(PictureError::TooExpensive(..))));
    fitted(&service, &recipe(1));
    let plot = Subject::Plot(Plot::matrix_from([]).unwrap());
    assert!(matches!(picture(&service, plot), Err(PictureError::TooSlow(..))));
    let counts = service.metrics().unwrap().pictures;
    assert_eq!((counts.refused, counts.given_up), (1, 1));
}

#[test]
fn a_caller_that_leaves_frees_the_renderer() {
    let folder = tempfile::tempdir().unwrap();
    let service = Service::open(Config { picture_time: Duration::from_secs(3600), ..config(folder.path()) }).unwrap();
    runtime().block_on(async {
        // The picture takes minutes.
        let left = tokio::time::timeout(Duration::from_millis(200), service.picture(None, scene(512, 4096))).await;
        assert!(left.is_err(), "{left:?}");
        service.picture(None, scene(64, 1)).await.unwrap();
    });
    assert_eq!(service.metrics().unwrap().pictures, PictureCounts { done: 1, given_up: 1, ..Default::default() });
}
