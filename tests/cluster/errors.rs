//! Databases and stores that cannot be used. The error is one line that names the database or store, and the exit code
//! is 1.

use std::{fs, path::Path};

use crate::{
    Shared,
    common::command::{Run, ltcforge},
    throwaway::Server,
};

/// The error of `ltcforge work` for a database and a store.
#[track_caller]
fn complaint(folder: &Path, database: &str, blobs: &str) -> String {
    complaint_in(&[], folder, database, blobs)
}

/// The same with environment variables.
#[track_caller]
fn complaint_in(environment: &[(&str, &str)], folder: &Path, database: &str, blobs: &str) -> String {
    let args = ["work", "--database", database, "--blobs", blobs];
    let mut command = ltcforge(folder, args);
    command.envs(environment.iter().copied());
    let run: Run = command.output().expect("the binary runs").into();
    let run = run.exited(1);
    let [line] = run.complaints()[..] else { panic!("{run:#?}") };
    assert!(!run.stderr.contains("hunter2"), "{run:#?}");
    line.to_owned()
}

#[test]
fn a_database_that_cannot_be_used_is_named_without_its_password() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(shared) = Shared::new(folder.path()) else { return };
    let of = |database: &str| complaint(folder.path(), database, &shared.blobs);

    let line = of("postgres://me:hunter2@127.0.0.1:1/tables");
    assert!(line.contains("tables on 127.0.0.1:1 cannot be reached"), "{line}");
    let line = of("mysql://me:hunter2@host/tables");
    assert!(line.contains("the database URL is invalid"), "{line}");
    for password in ["pw@hunter2", "hunter2@more", "hun/hunter2", "a?hunter2", "hunter2#b@c"] {
        let line = of(&format!("postgres://me:{password}@127.0.0.1:1/tables"));
        assert!(line.contains("%40") || line.contains("cannot be reached"), "{line}");
    }
    let missing = shared.database.replacen("/test", "/missing", 1);
    assert!(of(&missing).contains("does not exist"), "{}", of(&missing));
    let with_tls = shared.database.replace("sslmode=disable", "sslmode=require");
    assert!(of(&with_tls).contains("TLS"), "{}", of(&with_tls));
}

#[test]
fn a_wrong_password_and_a_foreign_schema_have_different_errors() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(server) = Server::start("-c fsync=off") else { return };
    let url = server.empty_database();
    let name = url.split(['/', '?']).nth(3).expect("a name");
    let store = folder.path().join("store");
    fs::create_dir(&store).expect("a folder");
    let blobs = format!("file://{}", store.display());

    server.psql(
        name,
        "CREATE SCHEMA ltcforge; CREATE TABLE ltcforge.migrations (number integer, digest bytea);
        INSERT INTO ltcforge.migrations SELECT n, '' FROM generate_series(1, 99) n",
    );
    let line = complaint(folder.path(), &url, &blobs);
    assert!(line.contains("DROP SCHEMA ltcforge"), "{line}");

    server.psql(name, "CREATE ROLE me LOGIN PASSWORD 'right'");
    let rules = server.folder().join("data/pg_hba.conf");
    fs::write(&rules, "local all me scram-sha-256\nlocal all all trust\n").expect("the server's rules");
    server.psql(name, "SELECT pg_reload_conf()");
    let with_password = url.replace("postgres@", "me:hunter2@");
    // It takes a moment until the server has reloaded its rules.
    let line = crate::common::eventually("the new rules", || {
        let line = complaint(folder.path(), &with_password, &blobs);
        line.contains("password").then_some(line)
    });
    assert!(line.contains("refuses the user or the password"), "{line}");
}

#[test]
fn a_store_that_cannot_be_used_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(shared) = Shared::new(folder.path()) else { return };
    let of = |blobs: &str| complaint(folder.path(), &shared.database, blobs);
    assert!(of("tables").contains("`tables` is not the URL of an object store"));
    assert!(of("s3://key:hunter2@bucket/x").contains("read from the environment"));
    fs::write(folder.path().join("file"), "").expect("a file");
    let line = of(&format!("file://{}/file", folder.path().display()));
    assert!(line.contains("there is no such folder"), "{line}");
    let nowhere = folder.path().join("nowhere");
    assert!(of(&format!("file://{}", nowhere.display())).contains("there is no such folder"));
    assert!(!nowhere.exists());
}

/// The error names the missing setting, not the URL.
#[test]
fn missing_settings_of_a_store_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let nowhere = "postgres://127.0.0.1:1/tables?sslmode=require";
    let of = |environment: &[(&str, &str)], blobs| complaint_in(environment, folder.path(), nowhere, blobs);
    let (key, secret) = (("AWS_ACCESS_KEY_ID", "me"), ("AWS_SECRET_ACCESS_KEY", "hunter2"));
    let (http, allow) = (("AWS_ENDPOINT", "http://127.0.0.1:1"), ("AWS_ALLOW_HTTP", "true"));

    for name in ["AWS_ENDPOINT", "AWS_ENDPOINT_URL", "AWS_ENDPOINT_URL_S3"] {
        let line = of(&[key, secret, (name, http.1)], "s3://tables/ltc");
        assert!(line.contains(name) && line.contains("needs AWS_ALLOW_HTTP=true"), "{line}");
    }
    let line = of(&[http, allow, ("AWS_METADATA_ENDPOINT", "http://127.0.0.1:1")], "s3://tables/ltc");
    assert!(line.contains("no credentials are set") && line.contains("AWS_ACCESS_KEY_ID"), "{line}");
    for half in [key, secret] {
        let line = of(&[half, http, allow], "s3://tables/ltc");
        assert!(line.contains("the environment lacks") && line.contains("AWS_SECRET_ACCESS_KEY"), "{line}");
    }
    let line = of(&[("GOOGLE_SERVICE_ACCOUNT", "/nowhere")], "gs://tables/ltc");
    assert!(line.contains("the environment lacks") && line.contains("/nowhere"), "{line}");
    let line = of(&[key, secret, http, allow], "s3://tables/ltc");
    assert!(line.contains("cannot be reached"), "{line}");

    // A missing file, and a file without a certificate.
    let (missing, empty) = (folder.path().join("none.pem"), folder.path().join("empty.pem"));
    fs::write(&empty, "no certificate").expect("a file");
    let store = format!("file://{}", folder.path().display());
    for file in [missing, empty] {
        let file = file.to_str().expect("a path in UTF-8");
        for blobs in ["s3://tables/ltc", "gs://tables/ltc", &store] {
            let line = of(&[("SSL_CERT_FILE", file), ("SSL_CERT_DIR", "/nowhere"), key, secret], blobs);
            assert!(line.contains(&format!("SSL_CERT_FILE={file}")), "{line}");
        }
    }
}
