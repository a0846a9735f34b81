//! A worker whose connection to the database is down for longer than its leases, or loses packets.

use std::{
    net::Ipv4Addr,
    process::{Command, Stdio},
    time::{Duration, Instant},
};

use crate::{
    Shared, Worker,
    common::{LARGE, SMALL, command::run_with_stdin, eventually, report_skipped, server::text},
    faults::entries_done,
    proxy::{Link, Proxy, Upstream},
    throwaway,
};

/// A few shards. Each takes long enough to cut the connection during the fit.
const LONG_SHARDS: &str = r#"{"preset":"draft","resolution":{"alpha":4,"ratio":4,"theta":8,"phi":4},
    "fit":{"samples":4096,"directions":16,"steps":20}}"#;

#[test]
fn a_disconnected_worker_is_replaced_and_continues_later() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut shared) = Shared::new(folder.path()) else { return };
    let Some(database) = throwaway::Server::start("-c fsync=off") else { return };
    shared.database = database.empty_database();
    let name = shared.database.split(['/', '?']).nth(3).expect("a name").to_owned();
    let expected = run_with_stdin(folder.path(), ["fit", "-", "-o", "fitted"], LONG_SHARDS).exited(0);
    let link = Proxy::start(Upstream::Unix(database.socket()));
    let replica = shared.replica(&folder.path().join("replica"));
    // Records which connection leases an attempt, and which finishes it.
    database.psql(
        &name,
        "CREATE TABLE writes (state text, worker text, task integer, lease bigint, leases integer);
        CREATE FUNCTION note() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN
            INSERT INTO public.writes
            VALUES (NEW.state, current_setting('application_name'), NEW.task, coalesce(NEW.lease, OLD.lease), NEW.leases);
            RETURN NEW; END $$;
        CREATE TRIGGER note AFTER UPDATE ON ltcforge.tasks FOR EACH ROW
            WHEN (NEW.state IN ('leased', 'finished')) EXECUTE FUNCTION note()",
    );
    let named = |mut shared: Shared, name: &str| {
        shared.database = format!("{}&application_name={name}", shared.database);
        shared
    };
    let cut_off = Worker::start(&named(shared.by(link.address), "cut_off"), folder.path(), "2");
    let id = text(&replica.submit(LONG_SHARDS).with_status(202).json()["id"]).to_owned();
    replica.job_when(&id, |job| entries_done(job) > 0);

    link.set(Link::Held);
    let other = Worker::start(&named(shared.clone(), "other"), folder.path(), "2");
    // The late result of the worker arrives while another worker fits the shard again.
    eventually("another lease of what it had", || {
        let again = "SELECT count(*) FROM writes WHERE state = 'leased' AND worker = 'other' AND leases > 1";
        (database.psql(&name, again) != "0").then_some(())
    });
    link.set(Link::Up);
    let job = replica.finished(&id);
    assert_eq!((&job["state"], &job["table"]), (&"done".into(), &expected.last_line().into()), "{job:#}");
    assert!(job["attempts"].as_u64().expect("a count") >= 2, "the shard was leased again: {job:#}");
    let of_another = "SELECT count(*) FROM writes AS f WHERE state = 'finished' AND NOT EXISTS (
        SELECT FROM writes AS l
        WHERE l.state = 'leased' AND (l.worker, l.task, l.lease) = (f.worker, f.task, f.lease))";
    assert_eq!(database.psql(&name, of_another), "0", "a late result was accepted");
    drop(other);

    // The worker continues with other shards.
    let job = replica.finished(text(&replica.submit(SMALL).with_status(202).json()["id"]));
    assert_eq!(job["state"], "done", "{job:#}");
    drop(cut_off);
}

/// A network namespace. Its only link loses a fifth of all packets in each direction. It is removed when dropped.
struct Lossy {
    name: String,
    /// The address of this side of the link.
    here: Ipv4Addr,
}

impl Lossy {
    /// Prints a message and returns `None` if namespaces cannot be created.
    fn new() -> Option<Self> {
        let process = std::process::id();
        // The addresses are unique: a killed test leaves its namespace, and two links to the same network do not work.
        let network = u32::from(Ipv4Addr::new(10, 213, 0, 0)) + process % 0x4000 * 4;
        let [here, there] = [1, 2].map(|end| Ipv4Addr::from(network + end));
        let (name, link) = (format!("ltcforge{process}"), format!("ltc{process}v"));
        let script = format!(
            "ip netns add {name} && ip link add {link} type veth peer name eth0 netns {name} &&
            ip addr add {here}/30 dev {link} && ip link set {link} up &&
            ip -n {name} addr add {there}/30 dev eth0 && ip -n {name} link set eth0 up && ip -n {name} link set lo up &&
            ip netns exec {name} nft 'add table inet loss;
                add chain inet loss incoming {{ type filter hook input priority 0; }};
                add chain inet loss outgoing {{ type filter hook output priority 0; }};
                add rule inet loss incoming iifname eth0 numgen random mod 5 == 0 drop;
                add rule inet loss outgoing oifname eth0 numgen random mod 5 == 0 drop'"
        );
        let lossy = Self { name, here };
        let mut command = Command::new("sh");
        command.args(["-c", &script]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        if command.status().is_ok_and(|status| status.success()) {
            return Some(lossy);
        }
        report_skipped("there are no network namespaces here, which root makes with iproute2 and nftables");
        None
    }
}

impl Drop for Lossy {
    fn drop(&mut self) {
        // The namespace may not exist.
        let _ = Command::new("ip").args(["netns", "del", &self.name]).stderr(Stdio::null()).status();
    }
}

#[test]
fn a_worker_that_loses_a_fifth_of_its_packets_finishes_all_jobs() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut shared) = Shared::new(folder.path()) else { return };
    let Some(lossy) = Lossy::new() else { return };
    let Some(database) = throwaway::Server::start("-c fsync=off") else { return };
    shared.database = database.empty_database();
    let link = Proxy::start_on(lossy.here, Upstream::Unix(database.socket()));
    let expected = run_with_stdin(folder.path(), ["fit", "-", "-o", "fitted"], LARGE).exited(0);
    let replica = shared.replica(&folder.path().join("replica"));
    let by = ["ip", "netns", "exec", &lossy.name];
    let far = shared.by(link.address);
    // A worker ends if it cannot connect. It is started again, as by a supervisor.
    let _worker = eventually("a worker that connects", || Worker::start_by(&by, &far, folder.path(), "60"));
    let begun = Instant::now();
    let job = replica.finished(text(&replica.submit(LARGE).with_status(202).json()["id"]));
    assert_eq!((&job["state"], &job["table"]), (&"done".into(), &expected.last_line().into()), "{job:#}");
    for seed in 1.. {
        if begun.elapsed() >= lossy_time() {
            break;
        }
        let recipe = SMALL.replace("\"steps\":5", &format!("\"steps\":5,\"seed\":{seed}"));
        let expected = run_with_stdin(folder.path(), ["fit", "-", "-o", "fitted"], &recipe).exited(0);
        assert_eq!(replica.fit(&recipe), expected.last_line());
    }
}

/// The duration of the run on a link that loses packets: a minute, or `LTCFORGE_TEST_LOSS_SECONDS`.
fn lossy_time() -> Duration {
    let seconds =
        std::env::var("LTCFORGE_TEST_LOSS_SECONDS").map_or(60, |text| text.parse().expect("a number of seconds"));
    Duration::from_secs(seconds)
}
