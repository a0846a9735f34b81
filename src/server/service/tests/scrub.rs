//! The scrub finds damage and takes damaged tables out of the catalogue.

use std::{fs, sync::Arc};

use super::{fake_backend::Shared, fitted, start};

#[test]
fn the_scrub_finds_damage_that_no_client_asks_for() {
    let dir = tempfile::tempdir().unwrap();
    let service = start(dir.path(), &Arc::new(Shared::default()));
    let [table, sound] = ["gold 1", "silver 1"].map(|recipe| fitted(&service, recipe));
    let scrub = |most: usize| {
        let (mut read, mut found) = (0, 0);
        let mut go_on = |bytes: usize| {
            read += bytes;
            read < most
        };
        service.state.tables.scrub(&mut go_on, &mut || found += 1).unwrap();
        (read, found)
    };
    let all = scrub(usize::MAX);
    assert!(all.0 > 0 && all.1 == 0, "{all:?}");
    assert!(scrub(1).0 < all.0, "it ends when it is told to");
    let hex = table.hex();
    fs::write(dir.path().join("blobs").join(&hex[..2]).join(&hex), "noise").unwrap();
    assert_eq!(scrub(usize::MAX).1, 1);
    assert_eq!(service.metrics().unwrap().blobs_corrupt, 1);
    assert!(service.table(table).unwrap().is_none());
    assert_eq!(service.tables(None, 10).unwrap().items.iter().map(|row| row.digest).collect::<Vec<_>>(), [sound]);
    assert_eq!(fs::read(dir.path().join(format!("quarantine/{hex}-1"))).unwrap(), b"noise");
    assert_eq!(scrub(usize::MAX).1, 0);
}
