//! Taking a data folder along.

use serde_json::Value;

use crate::{
    Shared,
    common::{
        ENDLESS, SMALL,
        command::run,
        server::{Server, text},
    },
};

#[test]
fn tables_and_jobs_are_taken_along_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(shared) = Shared::new(folder.path()) else { return };
    let data = folder.path().join("data");
    let server = Server::start(&data, &["--workers", "1"]);
    let table = server.fit(SMALL);
    let endless = text(&server.submit(ENDLESS).with_status(202).json()["id"]).to_owned();
    assert_eq!(server.stop("TERM").code, Some(0));

    let migrate = || -> Value {
        let args = ["migrate", "--to", &shared.database, "--blobs", &shared.blobs, "--data", "data", "--json"];
        serde_json::from_str(run(folder.path(), args).exited(0).last_line()).expect("JSON")
    };
    let first = migrate();
    assert_eq!((&first["tables"], &first["jobs"], &first["missing"]), (&1.into(), &2.into(), &0.into()), "{first}");
    let again = migrate();
    assert_eq!((&again["tables"], &again["jobs"]), (&0.into(), &0.into()), "{again}");

    let args: Vec<&str> = shared.arguments().into_iter().chain(["--no-workers"]).collect();
    let replica = Server::start(&folder.path().join("replica"), &args);
    assert_eq!(replica.submit(SMALL).with_status(200).json()["table"], table);
    replica.get(&format!("/v1/tables/{table}")).with_status(200);
    assert_eq!(replica.get(&format!("/v1/jobs/{endless}")).with_status(200).json()["state"], "queued");
}
