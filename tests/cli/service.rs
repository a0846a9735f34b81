//! Commands that call a service, commands of the service itself, settings, and usage errors.

use std::{
    fs,
    io::{BufRead as _, BufReader},
    net::TcpListener,
    thread,
};

use serde_json::Value;

use crate::common::{
    ENDLESS, SMALL,
    command::{Run, ltcforge, run, run_with_stdin},
    server::{Server, text},
};

#[test]
fn jobs_are_submitted_and_managed_from_the_command_line() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(&folder.path().join("data"), &[]);
    let jobs = |args: &[&str], input: &str| {
        run_with_stdin(folder.path(), ["jobs", "--server", server.url.as_str()].iter().chain(args), input)
    };
    let watched = jobs(&["submit", "-", "--watch"], SMALL).exited(0);
    let digest = watched.last_line().to_owned();
    assert!(digest.starts_with("sha256:"), "{watched:#?}");
    let submitted = jobs(&["submit", "-"], SMALL).exited(0);
    assert!(submitted.stdout.ends_with(&format!("done {digest}\n")), "{}", submitted.stdout);
    let id = submitted.stdout.split(' ').next().expect("an id");
    let shown: Value = serde_json::from_str(&jobs(&["show", id, "--json"], "").exited(0).stdout).expect("JSON");
    assert_eq!(shown["table"], digest);
    assert_eq!(jobs(&["watch", id], "").exited(0).last_line(), digest);
    assert_eq!(jobs(&["list", "--state", "done"], "").exited(0).stdout, submitted.stdout);

    // The served table equals the table that its recipe gives on this machine.
    let address = format!("{}/v1/tables/{digest}", server.url);
    let output = run(folder.path(), ["verify", &address, "--refit"]).exited(0);
    assert_eq!(output.stdout, format!("{address}: ok, {digest}, and fitting its recipe gives the same bytes\n"));
    let none = format!("{}/v1/tables/sha256:{}", server.url, "0".repeat(64));
    assert!(run(folder.path(), ["verify", &none]).exited(1).stderr.contains("404"));
    for wrong in ["/v1/tables/sha256:12", "/v1/tables", "/v1/jobs"] {
        let refused = run(folder.path(), ["verify", &format!("{}{wrong}", server.url)]).exited(2);
        assert!(refused.complaints()[0].contains("http://HOST/v1/tables/sha256:DIGEST"), "{refused:#?}");
    }

    let running: Value =
        serde_json::from_str(&jobs(&["submit", "-", "--json"], ENDLESS).exited(0).stdout).expect("JSON");
    let id = text(&running["id"]);
    assert!(jobs(&["cancel", id], "").exited(0).stdout.contains(" cancelled "));
    assert!(jobs(&["watch", id], "").exited(5).stderr.contains("cancelled"));

    assert!(jobs(&["show", &"0".repeat(32)], "").exited(1).stderr.contains("404"));
    let refused = jobs(&["submit", "-"], r#"{"preset":"draft","colour":1}"#).exited(2);
    assert!(refused.stderr.contains("/colour"), "{}", refused.stderr);
}

#[test]
fn a_missing_server_differs_from_a_rejected_request() {
    let folder = tempfile::tempdir().expect("a folder");
    let ended = run(folder.path(), ["jobs", "list", "--server", "http://127.0.0.1:9"]).exited(4);
    assert!(ended.stderr.contains("http://127.0.0.1:9/v1/jobs"), "{}", ended.stderr);
}

#[test]
fn a_proxy_is_only_used_for_https_to_other_machines() {
    let folder = tempfile::tempdir().expect("a folder");
    let server = Server::start(folder.path(), &[]);
    let proxy = TcpListener::bind("127.0.0.1:0").expect("a free port");
    let url = format!("http://{}", proxy.local_addr().expect("an address"));
    let list = |server: &str| {
        let mut command = ltcforge(folder.path(), ["jobs", "list", "--server", server]);
        Run::from(command.env("ALL_PROXY", &url).output().expect("the binary runs"))
    };
    let asked = thread::spawn(move || {
        let (stream, _) = proxy.accept().expect("a connection");
        BufReader::new(stream).lines().next().expect("a line").expect("text")
    });
    list(&server.url).exited(0);
    list("http://tables.invalid").exited(4);
    list("https://tables.invalid").exited(4);
    assert!(asked.join().expect("a request").starts_with("CONNECT tables.invalid:443 "));
}

#[test]
fn settings_come_from_flag_environment_file_and_default_in_this_order() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("ltcforge.toml"), "server = 'http://127.0.0.1:1'").expect("a file");
    let asked = |flag: Option<&str>, variable: Option<&str>| {
        let mut command = ltcforge(folder.path(), ["jobs", "list"]);
        command.args(flag.map(|flag| ["--server", flag]).into_iter().flatten());
        command.envs(variable.map(|value| ("LTCFORGE_SERVER", value)));
        String::from_utf8(command.output().expect("the binary runs").stderr).expect("UTF-8")
    };
    let (flag, variable) = ("http://127.0.0.1:3", "http://127.0.0.1:2");
    assert!(asked(Some(flag), Some(variable)).contains(flag));
    assert!(asked(None, Some(variable)).contains(variable));
    assert!(asked(None, None).contains("http://127.0.0.1:1/"));
    fs::write(folder.path().join("ltcforge.toml"), "colour = 1").expect("a file");
    run(folder.path(), ["jobs", "list"]).exited(2);
    run(folder.path(), ["jobs", "list", "--config", "none.toml"]).exited(2);
}

#[test]
fn usage_errors_exit_with_2_and_completions_are_printed() {
    let folder = tempfile::tempdir().expect("a folder");
    run(folder.path(), ["fit"]).exited(2);
    run(folder.path(), ["serve", "--listen", "nowhere"]).exited(2);
    assert!(run(folder.path(), ["completions", "bash"]).exited(0).stdout.contains("ltcforge"));
}

#[test]
fn a_server_exits_with_0_on_either_signal() {
    for name in ["TERM", "INT"] {
        let folder = tempfile::tempdir().expect("a folder");
        Server::start(folder.path(), &[]).stop(name).exited(0);
    }
}
