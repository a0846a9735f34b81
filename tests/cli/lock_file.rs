//! A project pins its tables by hash: the lock file that `lock` writes, and lock files that are rejected.

use std::{ffi::OsStr, fs, os::unix::ffi::OsStrExt as _, process::Child, time::SystemTime};

use super::project::{NOBODY, files_of, modified, project, pull, read};
use crate::common::{
    SMALL,
    command::{Run, ltcforge, run},
    server::Server,
};
use ltcforge::files::digest::Digest;

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

    // Pinning again changes nothing, not even a modification time.
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
fn an_export_with_other_bytes_than_this_program_makes_is_rejected() {
    let (_folder, project) = project();
    let lock = read(&project.join("ltcforge.lock"));
    let texture = project.join("assets/ltc/ltc_terms.ktx2");
    let pin = format!("digest = \"{}\" }}", Digest::of(&fs::read(&texture).expect("a texture")));
    assert!(lock.contains(&pin));
    let terms = lock.lines().find(|line| line.contains("ltc_terms.ktx2")).expect("a line");
    let cases = [
        (lock.replace(&pin, &format!("digest = \"{}\" }}", Digest::of(b"old"))), 3, "this version makes sha256:"),
        (lock.replace(&format!("{terms}\n"), ""), 3, "which is not pinned"),
        (lock.replace("ltc/ltc_terms", "ltc/ltc_words"), 3, "this version does not make this file"),
        (lock.replace("for = \"wgpu\"", "for = \"unity\""), 2, "«unity» is not an export; allowed: an engine (three, "),
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
    // `lock` pins the bytes that this program makes.
    fs::write(project.join("ltcforge.lock"), lock.replace(&format!("{terms}\n"), "")).expect("a lock file");
    run(&project, ["lock"]).exited(0);
    assert_eq!(read(&project.join("ltcforge.lock")), lock);
    run(&project, ["pull", "--locked"]).exited(0);
}

#[test]
fn a_table_on_a_server_is_pinned_by_its_digest() {
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
    let output = lock("metal", &digest, &server.url, 0);
    assert_eq!(output.stdout, "metal pinned: sub/t\n");
    assert_eq!(Digest::of(&fs::read(&file).expect("the table")).to_string(), digest);
    let text = read(&project.join("ltcforge.lock"));
    assert!(text.contains(&format!("sources = [\"{}\"]", server.url)), "{text}");

    // The previous pin with this name does not change.
    lock("metal", &missing, &server.url, 1);
    assert_eq!(read(&project.join("ltcforge.lock")), text);

    // Correct files are neither changed nor requested.
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
fn a_missing_table_does_not_block_other_pins_and_version_1_is_read() {
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

    // A pin without a recipe cannot be fitted. `lock` upgrades the file to the current version.
    fs::remove_file(folder.path().join("metal")).expect("a file");
    let refused = run(folder.path(), ["pull", "--offline", "--fit"]).exited(1);
    assert!(refused.stderr.contains("run `ltcforge lock`"), "{refused:#?}");
    fs::write(&path, lock.replace(&none, "")).expect("a lock file");
    run(folder.path(), ["lock"]).exited(0);
    let new = read(&path);
    assert!(new.starts_with("version = 2 # ours\n") && new.contains("recipe = '{"), "{new}");
    fs::remove_file(folder.path().join("metal")).expect("a file");
    run(folder.path(), ["pull", "--offline", "--fit"]).exited(0);
}

#[test]
fn an_invalid_lock_file_is_rejected_before_anything_is_written() {
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
        (lock.replace(table, "path = \".git/config\""), 2, "«.git/config» is not allowed: version control"),
        (lock.replace(table, "path = \"a\\u202Eb\""), 2, "«a\\u{202e}b»"),
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
fn a_failed_lock_changes_no_file() {
    let (folder, project) = project();
    fs::write(folder.path().join("table.npy"), b"\x93NUMPY\x01\x00").expect("a file");
    fs::write(folder.path().join("bytes"), "no table").expect("a file");
    let before = files_of(folder.path());
    let lock = |words: &[&str]| run(&project, ["lock"].iter().chain(words));
    let cases: [(&[&str], i32, &str); 10] = [
        (&["other"], 2, "no pin has this name"),
        (&["other", "sha256:12"], 1, "no 12*.safetensors"),
        (&["other", "../table.npy"], 3, "table.npy"),
        (&["other", "../bytes"], 3, "bytes"),
        (&["other", "../none"], 1, "../none"),
        (&["other", "--recipe", "draft", "--to", "../x"], 2, "«../x»"),
        (&["other", "--recipe", "draft", "--to", "assets/metal.safetensors"], 2, "choose another --out or --to"),
        (&["metal", "--layout", "reflected", "--container", "ktx2", "--out", "assets/ltc"], 2, "choose another --out"),
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
fn many_concurrent_locks_lose_no_pin_and_no_export() {
    const COUNT: usize = 12;
    let (_folder, project) = project();
    fs::copy(project.join("assets/metal.safetensors"), project.join("table")).expect("a copy");
    run(&project, ["lock", "gone", "table", "--to", "gone"]).exited(0);
    let all = |words: &[Vec<String>]| {
        let running: Vec<Child> =
            words.iter().map(|words| ltcforge(&project, words).spawn().expect("the binary runs")).collect();
        for child in running {
            Run::from(child.wait_with_output().expect("the binary ends")).exited(0);
        }
    };
    let words = |text: String| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
    let mut commands: Vec<_> = (0..COUNT).map(|i| words(format!("lock n{i} table --to t{i}"))).collect();
    commands.push(words("lock gone --remove".into()));
    commands.push(words("lock".into()));
    let exports: Vec<_> = ["dds", "npy", "json", "raw"]
        .map(|container| words(format!("lock metal --layout reflected --container {container} --out out/{container}")))
        .into();
    all(&[commands, exports].concat());
    let text = read(&project.join("ltcforge.lock"));
    for i in 0..COUNT {
        assert!(text.contains(&format!("name = \"n{i}\"\n")), "n{i} is not in {text}");
    }
    for container in ["dds", "npy", "json", "raw"] {
        assert!(text.contains(&format!("to = \"out/{container}\"\n")), "{container} is not in {text}");
    }
    assert!(!text.contains("gone"), "{text}");
    run(&project, ["pull", "--locked"]).exited(0);
    assert!(
        !files_of(&project).iter().any(|(path, _)| path.to_string_lossy().contains(".ltcforge.")),
        "a temporary file is left"
    );
}
