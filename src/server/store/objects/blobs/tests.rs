use super::*;

fn open(dir: &FilePath) -> ObjectBlobs {
    let store = dir.join("store");
    fs::create_dir_all(&store).unwrap();
    ObjectBlobs::open(&format!("file://{}", store.display()), Access::Write, &dir.join("cache"), 1 << 20).unwrap()
}

fn file(dir: &FilePath, digest: Digest) -> std::path::PathBuf {
    let hex = digest.hex();
    dir.join("store").join(&hex[..2]).join(&hex)
}

#[test]
fn a_blob_can_be_read_listed_and_put_again() {
    let dir = tempfile::tempdir().unwrap();
    let blobs = open(dir.path());
    let digest = blobs.put(b"table").unwrap();
    assert_eq!(blobs.put(b"table").unwrap(), digest);
    assert_eq!(blobs.get(digest).unwrap().unwrap(), b"table");
    assert!(blobs.contains(digest).unwrap() && !blobs.contains(Digest::of(b"other")).unwrap());
    assert_eq!(blobs.list().unwrap().iter().map(|blob| blob.digest).collect::<Vec<_>>(), [digest]);
    assert!(blobs.get(Digest::of(b"other")).unwrap().is_none());
    fs::remove_file(file(dir.path(), digest)).unwrap();
    assert_eq!(blobs.get(digest).unwrap().unwrap(), b"table", "from the cache");
}

#[test]
fn a_blob_that_is_uploaded_in_parts_is_whole() {
    let dir = tempfile::tempdir().unwrap();
    let bytes: Vec<u8> = (0..=u8::MAX).cycle().take(2 * PART + 1000).collect();
    let digest = open(dir.path()).put(&bytes).unwrap();
    fs::remove_dir_all(dir.path().join("cache")).unwrap();
    assert!(open(dir.path()).get(digest).unwrap().is_some_and(|got| got == bytes));
}

#[test]
fn only_regular_files_of_a_folder_are_opened() {
    let dir = tempfile::tempdir().unwrap();
    let blobs = open(dir.path());
    let digest = Digest::of(b"table");
    let path = file(dir.path(), digest);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(dir.path().join("elsewhere"), b"table").unwrap();
    for target in [dir.path().join("elsewhere"), "/dev/zero".into()] {
        std::os::unix::fs::symlink(target, &path).unwrap();
        assert!(matches!(blobs.get(digest), Err(error) if error.is_passing()));
        fs::remove_file(&path).unwrap();
    }
    rustix::fs::mknodat(rustix::fs::CWD, &path, rustix::fs::FileType::Fifo, rustix::fs::Mode::RUSR, 0).unwrap();
    assert!(matches!(blobs.get(digest), Err(error) if error.is_passing()));
    blobs.put(b"table").unwrap();
    assert_eq!(blobs.get(digest).unwrap().unwrap(), b"table");
}

#[test]
fn other_bytes_are_never_served_and_putting_mends_them() {
    let dir = tempfile::tempdir().unwrap();
    let digest = open(dir.path()).put(b"table").unwrap();
    fs::remove_dir_all(dir.path().join("cache")).unwrap();
    fs::write(file(dir.path(), digest), "tabel").unwrap();
    let blobs = open(dir.path());
    assert!(matches!(blobs.get(digest), Err(error) if error.is_passing()));
    blobs.put(b"table").unwrap();
    assert_eq!(fs::read(file(dir.path(), digest)).unwrap(), b"table");
    assert_eq!(blobs.get(digest).unwrap().unwrap(), b"table");
}

/// Listed as stored long ago.
fn orphan(dir: &FilePath, blobs: &ObjectBlobs) -> BlobInfo {
    let digest = blobs.put(b"brdf").unwrap();
    let day = std::time::SystemTime::now() - Duration::from_secs(100_000);
    fs::File::options().write(true).open(file(dir, digest)).unwrap().set_modified(day).unwrap();
    blobs.list().unwrap().remove(0)
}

#[test]
fn an_orphan_is_removed_once_and_one_that_becomes_known_meanwhile_stays() {
    let dir = tempfile::tempdir().unwrap();
    let blobs = open(dir.path());
    let orphan = orphan(dir.path(), &blobs);
    assert!(!blobs.remove(&orphan, &|_| Ok(true)).unwrap());
    assert_eq!(fs::read(file(dir.path(), orphan.digest)).unwrap(), b"brdf");
    let listed = blobs.list().unwrap().remove(0);
    assert!(blobs.remove(&listed, &|_| Ok(false)).unwrap());
    assert!(!file(dir.path(), orphan.digest).exists());
    assert!(!blobs.remove(&listed, &|_| Ok(false)).unwrap());
}

#[test]
fn a_blob_that_is_stored_again_after_it_was_listed_is_not_removed() {
    let dir = tempfile::tempdir().unwrap();
    let blobs = open(dir.path());
    let orphan = orphan(dir.path(), &blobs);
    blobs.put(b"brdf").unwrap();
    assert!(!blobs.remove(&orphan, &|_| Ok(false)).unwrap());
    assert!(file(dir.path(), orphan.digest).exists());
}

#[test]
fn a_blob_that_was_removed_before_it_became_known_is_stored_again() {
    let dir = tempfile::tempdir().unwrap();
    let blobs = open(dir.path());
    let digest = blobs.put(b"table").unwrap();
    fs::remove_file(file(dir.path(), digest)).unwrap();
    assert!(blobs.contains(digest).unwrap(), "it was seen a moment ago");
    blobs.keep(digest, b"table").unwrap();
    assert_eq!(fs::read(file(dir.path(), digest)).unwrap(), b"table");
}
