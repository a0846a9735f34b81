//! Exports are made once, one at a time, and kept within a limit.

use std::{panic::AssertUnwindSafe, thread};

use super::*;
use ltcforge_textures::{Engine, Export};

const THREE: Export = Export::Engine(Engine::Three);
const BABYLON: Export = Export::Engine(Engine::Babylon);

#[test]
fn an_export_is_made_once_until_others_push_it_out() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let service = start(dir.path(), &shared);
    let table = fitted(&service, "gold 1");
    let exports = || shared.behaviour.lock().unwrap().exports;
    let text = |export| {
        let made = service.export(table, export).unwrap().expect("a table");
        assert_eq!(made.files[0].digest, Digest::of(&made.files[0].bytes));
        String::from_utf8(made.files[0].bytes.to_vec()).unwrap()
    };
    assert_eq!(service.exports(table).unwrap(), Some(vec![THREE]));
    assert_eq!(text(THREE), "three of TABLE gold 1 0, of 14 bytes");
    assert_eq!((text(THREE), exports()), ("three of TABLE gold 1 0, of 14 bytes".to_owned(), 1));
    // Two fit into a hundred bytes, three do not.
    text(BABYLON);
    text(THREE);
    assert_eq!(exports(), 2);
    text(Export::Engine(Engine::O3de));
    text(THREE);
    assert_eq!(exports(), 3);
    text(BABYLON);
    assert_eq!((exports(), service.metrics().unwrap().exports_made), (4, 4));
    // The table was measured when it was fitted, and not again.
    assert_eq!(shared.behaviour.lock().unwrap().manifests, 1);

    assert!(service.export(Digest::of(b"unknown"), THREE).unwrap().is_none());
    assert!(service.exports(Digest::of(b"unknown")).unwrap().is_none());
}

#[test]
fn equal_requests_share_one_export_and_more_than_a_few_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let shared = Arc::new(Shared::default());
    let service = start(dir.path(), &shared);
    let table = fitted(&service, "gold 1");
    shared.set(|b| b.held = true);
    thread::scope(|scope| {
        let requests: Vec<_> = (0..16).map(|_| scope.spawn(|| service.export(table, THREE))).collect();
        shared.wait_for_exports(1);
        while service.state.exports.waiting() < 16 {
            thread::yield_now();
        }
        let refused = service.export(table, BABYLON).expect_err("one too many");
        assert!(matches!(refused, ExportFailure::QueueFull { limit: 16, .. }), "{refused}");
        shared.set(|b| b.held = false);
        for request in requests {
            assert!(request.join().unwrap().unwrap().is_some());
        }
    });
    assert_eq!(shared.behaviour.lock().unwrap().exports, 1);
    assert_eq!(service.state.exports.waiting(), 0);
    assert!(service.export(table, BABYLON).unwrap().is_some());
}

#[test]
fn an_export_that_fails_leaves_room_for_others() {
    let dir = tempfile::tempdir().unwrap();
    let service = start(dir.path(), &Arc::new(Shared::default()));
    let table = fitted(&service, "gold 1");
    for _ in 0..20 {
        let refused = service.export(table, Export::Engine(Engine::Godot)).expect_err("too large");
        assert!(matches!(refused, ExportFailure::TooLarge { .. }), "{refused}");
        let bevy = AssertUnwindSafe(|| service.export(table, Export::Engine(Engine::Bevy)));
        assert!(std::panic::catch_unwind(bevy).is_err());
    }
    assert_eq!(service.state.exports.waiting(), 0);
    assert!(service.export(table, THREE).unwrap().is_some());
    service.stop();
    assert!(matches!(service.export(table, BABYLON), Err(ExportFailure::Store(ServiceError::Stopping))));
}
