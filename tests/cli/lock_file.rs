//! A project pins its tables by hash: `lock` writes the lock file, `pull` keeps the project to it.

use std::{
    ffi::OsStr,
    fs,
    io::{Read as _, Write as _},
    net::TcpListener,
    os::unix::ffi::OsStrExt as _,
    path::{Path, PathBuf},
    thread,
    time::SystemTime,
};

use crate::common::{
    SMALL,
    command::{Run, run},
    server::Server,
};
use ltcforge::files::digest::Digest;

/// A server's URL where nobody listens.
const NOBODY: &str = "http://127.0.0.1:9";

fn pull(project: &Path, server: &str, args: &[&str]) -> Run {
    run(project, ["pull", "--server", server].iter().chain(args))
}

fn modified(path: &Path) -> SystemTime {
    fs::metadata(path).and_then(|data| data.modified()).expect("a time")
}

fn read(path: &Path) -> String {
    fs::read_to_string(path).expect("a text")
}

/// Every file below a folder with its bytes.
fn files_of(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else {
                files.push((path.clone(), fs::read(&path).expect("a file")));
            }
        }
    }
    files.sort();
    files
}

/// A project that pins the table of [`SMALL`] and its textures, and a folder of tables that has it.
fn project() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let project = folder.path().join("project");
    fs::create_dir(&project).expect("a project");
    fs::write(folder.path().join("small.json"), SMALL).expect("a recipe");
    let words = ["lock", "metal", "--recipe", "../small.json", "--to", "assets/metal.safetensors"];
    run(&project, words.iter().chain(&["--for", "wgpu", "--out", "assets/ltc"])).exited(0);
    (folder, project)
}

/// The digest that a project's lock file pins.
fn pinned(project: &Path) -> String {
    let lock = read(&project.join("ltcforge.lock"));
    let line = lock.lines().find(|line| line.starts_with("digest = ")).expect("a digest");
    line.split('"').nth(1).expect("a digest in quotes").to_owned()
}

#[test]
fn a_recipe_is_pinned_with_its_table_and_its_textures() {
    let (_folder, project) = project();
    let lock = read(&project.join("ltcforge.lock"));
    for said in [
        "version = 2\n",
        "name = \"metal\"\n",
        "path = \"assets/metal.safetensors\"\n",
        "recipe_digest = \"sha256:",
        "recipe = '{\"brdf\":\"ggx\"",
        "[[table.export]]\nfor = \"wgpu\"\nto = \"assets/ltc\"\n",
        "\n    { path = \"assets/ltc/ltc_terms.ktx2\", bytes = ",
    ] {
        assert!(lock.contains(said), "{said} is not in {lock}");
    }
    let table = fs::read(project.join("assets/metal.safetensors")).expect("the table");
    assert!(lock.contains(&format!("digest = \"{}\"\nbytes = {}\n", Digest::of(&table), table.len())), "{lock}");
    let textures = files_of(&project.join("assets/ltc"));
    assert!(textures.len() >= 4);
    for (path, bytes) in &textures {
        let pin = format!("bytes = {}, digest = \"{}\" }}", bytes.len(), Digest::of(bytes));
        assert!(lock.contains(&pin), "{}: {pin} is not in {lock}", path.display());
    }

    // Pinned again, nothing changes: not even a time.
    let before = files_of(&project);
    let times: Vec<SystemTime> = before.iter().map(|(path, _)| modified(path)).collect();
    run(&project, ["lock"]).exited(0);
    run(&project, ["lock", "metal", "--recipe", "../small.json"]).exited(0);
    run(&project, ["pull", "--locked"]).exited(0);
    assert_eq!(files_of(&project), before);
    assert_eq!(before.iter().map(|(path, _)| modified(path)).collect::<Vec<_>>(), times);

    let removed = run(&project, ["lock", "metal", "--remove"]).exited(0);
    assert_eq!(removed.stdout, "metal removed\n");
    assert!(!read(&project.join("ltcforge.lock")).contains("metal"));
    run(&project, ["lock", "metal", "--remove"]).exited(2);
}

#[test]
fn pull_restores_whatever_drifted_and_locked_tells_it() {
    let (folder, project) = project();
    let before = files_of(&project);
    fs::create_dir(folder.path().join("tables")).expect("a folder");
    let hex = pinned(&project).replace("sha256:", "");
    fs::copy(project.join("assets/metal.safetensors"), folder.path().join(format!("tables/{hex}.safetensors")))
        .expect("a copy");
    let pinned = before.iter().filter(|(path, _)| path.extension().is_some_and(|name| name != "lock"));
    // In turn a file is missing, of other bytes, and cut off; each is found.
    for (i, (path, bytes)) in pinned.enumerate() {
        match i % 3 {
            0 => fs::remove_file(path).expect("a file"),
            1 => fs::write(path, "drifted").expect("a drifted file"),
            _ => fs::write(path, &bytes[..bytes.len() - 1]).expect("a file cut off"),
        }
        let drifted = files_of(&project);
        let told = run(&project, ["pull", "--locked"]).exited(3);
        let said = path.strip_prefix(&project).expect("a path below").display().to_string();
        assert!(told.complaints()[0].contains(&said), "{said}: {told:#?}");
        assert_eq!(files_of(&project), drifted, "--locked changes nothing");
        run(&project, ["pull", "--offline", "--from", "../tables"]).exited(0);
        assert_eq!(files_of(&project), before, "{}", path.display());
    }
}

#[test]
fn sources_are_asked_in_order_and_wrong_bytes_are_not_taken() {
    let (folder, project) = project();
    let table = project.join("assets/metal.safetensors");
    let right = fs::read(&table).expect("the table");
    let hex = Digest::of(&right).hex();
    for (name, bytes) in [("wrong", &b"other bytes"[..]), ("right", &right)] {
        fs::create_dir(folder.path().join(name)).expect("a folder");
        fs::write(folder.path().join(name).join(format!("{hex}.safetensors")), bytes).expect("a file");
    }
    let from = |places: &[&str], code: i32| {
        let words = places.iter().flat_map(|place| ["--from", place]);
        run(&project, ["pull"].into_iter().chain(words)).exited(code)
    };
    fs::remove_file(&table).expect("a file");
    let none = from(&["../none"], 1);
    assert!(none.stderr.contains(&format!("../none/{hex}.safetensors")), "{none:#?}");
    from(&[NOBODY, "../none"], 4);
    let wrong = from(&["../wrong", NOBODY], 3);
    assert!(wrong.stderr.contains(&Digest::of(b"other bytes").to_string()), "{wrong:#?}");
    let offline = run(&project, ["pull", "--from", NOBODY, "--offline"]).exited(4);
    assert!(offline.stderr.contains("--offline asks no server"), "{offline:#?}");
    assert!(!table.exists());
    let brought = from(&["../none", "../wrong", NOBODY, "../right"], 0);
    assert!(brought.stdout.starts_with("metal downloaded: assets/metal.safetensors\n"), "{brought:#?}");
    assert_eq!(fs::read(&table).expect("the table"), right);

    // The lock file and the configuration name sources too.
    fs::remove_file(&table).expect("a file");
    let lock = read(&project.join("ltcforge.lock"));
    fs::write(project.join("ltcforge.lock"), lock.replace("version = 2\n", "version = 2\nsources = [\"../right\"]\n"))
        .expect("a lock file");
    run(&project, ["pull"]).exited(0);
    fs::remove_file(&table).expect("a file");
    fs::write(project.join("ltcforge.lock"), &lock).expect("a lock file");
    fs::write(project.join("ltcforge.toml"), "sources = [\"../none\", \"../right\"]\n").expect("a configuration");
    run(&project, ["pull"]).exited(0);
    assert_eq!(fs::read(&table).expect("the table"), right);
}

#[test]
fn what_no_source_has_is_fitted_again_and_held_to_its_digest() {
    let (_folder, project) = project();
    let before = files_of(&project);
    fs::remove_dir_all(project.join("assets")).expect("a folder");
    run(&project, ["pull", "--offline"]).exited(4);
    let fitted = run(&project, ["pull", "--offline", "--fit"]).exited(0);
    assert!(fitted.stdout.starts_with("metal fitted: assets/metal.safetensors\nmetal made: "), "{}", fitted.stdout);
    assert_eq!(files_of(&project), before);

    // A recipe of another table does not arrive at the pinned digest, and leaves nothing behind.
    let lock = read(&project.join("ltcforge.lock"));
    let other = lock.replace(&pinned(&project), &Digest::of(b"other").to_string());
    fs::write(project.join("ltcforge.lock"), other).expect("a lock file");
    let before = files_of(&project);
    let refused = run(&project, ["pull", "--offline", "--fit"]).exited(3);
    assert!(refused.stderr.contains("the recipe gives a table that hashes to"), "{refused:#?}");
    assert_eq!(files_of(&project), before);
}

#[test]
fn an_export_that_this_program_makes_otherwise_is_refused() {
    let (_folder, project) = project();
    let lock = read(&project.join("ltcforge.lock"));
    let texture = project.join("assets/ltc/ltc_terms.ktx2");
    let pin = format!("digest = \"{}\" }}", Digest::of(&fs::read(&texture).expect("a texture")));
    assert!(lock.contains(&pin));
    let terms = lock.lines().find(|line| line.contains("ltc_terms.ktx2")).expect("a line");
    let cases = [
        (lock.replace(&pin, &format!("digest = \"{}\" }}", Digest::of(b"old"))), 3, "this program makes a file that"),
        (lock.replace(&format!("{terms}\n"), ""), 3, "it is not pinned"),
        (lock.replace("ltc/ltc_terms", "ltc/ltc_words"), 3, "this program makes no such file"),
        (lock.replace("for = \"wgpu\"", "for = \"unity\""), 2, "for is «unity»; allowed: three, "),
    ];
    fs::remove_file(project.join("assets/ltc/ltc_matrix_a.ktx2")).expect("a file");
    for (wrong, code, said) in cases {
        assert_ne!(wrong, lock);
        fs::write(project.join("ltcforge.lock"), &wrong).expect("a lock file");
        let before = files_of(&project);
        let refused = run(&project, ["pull", "--offline"]).exited(code);
        assert!(refused.stderr.contains(said), "{said}: {refused:#?}");
        assert_eq!(files_of(&project), before, "{said}");
    }
    // `lock` pins what this program makes.
    fs::write(project.join("ltcforge.lock"), lock.replace(&format!("{terms}\n"), "")).expect("a lock file");
    run(&project, ["lock"]).exited(0);
    assert_eq!(read(&project.join("ltcforge.lock")), lock);
    run(&project, ["pull", "--locked"]).exited(0);
}

#[test]
fn a_table_of_a_server_is_pinned_by_its_digest() {
    let folder = tempfile::tempdir().expect("a folder");
    let project = folder.path().join("project");
    fs::create_dir(&project).expect("a project");
    let server = Server::start(&folder.path().join("data"), &[]);
    let file = project.join("sub/t");
    let lock = |name: &str, digest: &str, url: &str, code: i32| {
        run(&project, ["lock", name, digest, "--to", "sub/t", "--server", url]).exited(code)
    };
    let missing = Digest::of(b"missing").to_string();
    lock("metal", &missing, NOBODY, 4);
    lock("metal", &missing, &server.url, 1);
    assert_eq!(fs::read_dir(&project).expect("the project").count(), 0, "nothing was made");

    let digest = server.fit(SMALL);
    let told = lock("metal", &digest, &server.url, 0);
    assert_eq!(told.stdout, "metal pinned: sub/t\n");
    assert_eq!(Digest::of(&fs::read(&file).expect("the table")).to_string(), digest);
    let text = read(&project.join("ltcforge.lock"));
    assert!(text.contains(&format!("sources = [\"{}\"]", server.url)), "{text}");

    // An older pin of the name stays as it was.
    lock("metal", &missing, &server.url, 1);
    assert_eq!(read(&project.join("ltcforge.lock")), text);

    // What is right is neither touched nor asked for.
    let before = modified(&file);
    pull(&project, NOBODY, &[]).exited(0);
    assert_eq!(modified(&file), before);
    fs::write(&file, "drifted").expect("a drifted file");
    pull(&project, NOBODY, &[]).exited(4);
    assert_eq!(fs::read(&file).expect("the file"), b"drifted");
    run(&project, ["pull"]).exited(0);
    assert_eq!(Digest::of(&fs::read(&file).expect("the table")).to_string(), digest);
}

#[test]
fn a_pin_that_the_server_lacks_keeps_no_other_out_and_version_1_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(&folder.path().join("data"), &[]);
    let digest = server.fit(SMALL);
    let missing = Digest::of(b"missing");
    let none = format!("[[table]]\nname = \"none\"\ndigest = \"{missing}\"\npath = \"none\"\n");
    let lock = format!(
        "version = 1 # ours\n{none}[[table]]\nname = \"metal\"\ndigest = \"{digest}\"\npath = \"metal\"\nserver = \"{}\"\n",
        server.url
    );
    let path = folder.path().join("ltcforge.lock");
    fs::write(&path, &lock).expect("a lock file");
    let ended = pull(folder.path(), &server.url, &["--json"]).exited(1);
    assert!(ended.stderr.contains("none: ") && ended.stderr.contains(&missing.to_string()), "{}", ended.stderr);
    assert!(ended.stdout.contains(r#""outcome":"downloaded""#), "{}", ended.stdout);
    assert!(folder.path().join("metal").exists());
    assert_eq!(read(&path), lock, "pull writes no lock file");

    // A pin without a recipe cannot be fitted, and `lock` brings the file to the present version.
    fs::remove_file(folder.path().join("metal")).expect("a file");
    let refused = run(folder.path(), ["pull", "--offline", "--fit"]).exited(1);
    assert!(refused.stderr.contains("`ltcforge lock` writes it"), "{refused:#?}");
    fs::write(&path, lock.replace(&none, "")).expect("a lock file");
    run(folder.path(), ["lock"]).exited(0);
    let new = read(&path);
    assert!(new.starts_with("version = 2 # ours\n") && new.contains("recipe = '{"), "{new}");
    fs::remove_file(folder.path().join("metal")).expect("a file");
    run(folder.path(), ["pull", "--offline", "--fit"]).exited(0);
}

#[test]
fn a_lock_file_that_is_wrong_is_refused_before_anything_is_written() {
    let (folder, project) = project();
    let lock = read(&project.join("ltcforge.lock"));
    let outside = files_of(folder.path()).len();
    let table = "path = \"assets/metal.safetensors\"";
    let cases = [
        (lock.replace("version = 2", "version = 3"), 2, "has version 3; this program reads versions 1 to 2"),
        (lock.replace(table, "path = \"../metal\""), 2, "«../metal»"),
        (lock.replace(table, "path = \"/tmp/metal\""), 2, "«/tmp/metal»"),
        (lock.replace(table, "path = \"a\\u0000b\""), 2, "«a\\0b»"),
        (lock.replace(table, "path = \"ltcforge.lock\""), 2, "«ltcforge.lock»"),
        (lock.replace("assets/ltc/ltc_terms", "../ltc_terms"), 2, "«../ltc_terms.ktx2»"),
        (lock.replace("to = \"assets/ltc\"", "to = \"../ltc\""), 2, "«../ltc»"),
        (lock.replace("name = \"metal\"", "name = \"a\\u001b[2J\""), 2, "the name «a\\u{1b}[2J»"),
        (lock.replace("recipe_digest = \"sha256:", "recipe_digest = \"sha256:zz"), 2, "is not a digest"),
        (lock.replace("\"seed\":", "\"seed\":9"), 3, "the recipe hashes to"),
    ];
    for (wrong, code, said) in cases {
        assert_ne!(wrong, lock, "{said}");
        fs::write(project.join("ltcforge.lock"), &wrong).expect("a lock file");
        for command in [&["pull", "--fit", "--offline"][..], &["pull", "--locked"], &["lock"]] {
            let refused = run(&project, command).exited(code);
            assert!(refused.complaints().join("\n").contains(said), "{said}: {refused:#?}");
            assert!(refused.complaints()[0].starts_with("ltcforge.lock: "), "{refused:#?}");
        }
        assert_eq!(read(&project.join("ltcforge.lock")), wrong);
        assert_eq!(files_of(folder.path()).len(), outside, "{said}");
    }
    fs::write(project.join("ltcforge.lock"), b"version = 2 # \xff\n").expect("a lock file");
    let refused = run(&project, ["pull"]).exited(2);
    assert!(refused.stderr.contains("not UTF-8"), "{refused:#?}");
    fs::remove_file(project.join("ltcforge.lock")).expect("a file");
    for command in ["pull", "lock"] {
        run(&project, [command]).exited(1);
    }
}

#[test]
fn what_cannot_be_pinned_changes_no_file() {
    let (folder, project) = project();
    fs::write(folder.path().join("table.npy"), b"\x93NUMPY\x01\x00").expect("a file");
    fs::write(folder.path().join("bytes"), "no table").expect("a file");
    let before = files_of(folder.path());
    let lock = |words: &[&str]| run(&project, ["lock"].iter().chain(words));
    let cases: [(&[&str], i32, &str); 9] = [
        (&["other"], 2, "no table of that name is pinned"),
        (&["other", "sha256:12"], 1, "no 12*.safetensors"),
        (&["other", "../table.npy"], 3, "table.npy"),
        (&["other", "../bytes"], 3, "bytes"),
        (&["other", "../none"], 1, "../none"),
        (&["other", "--recipe", "draft", "--to", "../x"], 2, "«../x»"),
        (&["other", "--recipe", "draft", "--to", "assets/metal.safetensors"], 2, "two files have the path"),
        (&["other", "--recipe", "./none.json"], 1, "none.json"),
        (&["metal", "--layout", "kt2022", "--container", "dds", "--out", "x"], 2, "\"layout\": \"kt2022\""),
    ];
    for (words, code, said) in cases {
        let refused = lock(words).exited(code);
        assert!(refused.stderr.contains(said), "{said}: {refused:#?}");
        assert_eq!(files_of(folder.path()), before, "{words:?}");
    }
    let words = ["lock", "other", "--recipe", "../small.json", "--to"].map(OsStr::new);
    let refused = run(&project, words.into_iter().chain([OsStr::from_bytes(b"odd\xff")])).exited(2);
    assert!(refused.stderr.contains("is not UTF-8"), "{refused:#?}");
    assert_eq!(files_of(folder.path()), before);
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
