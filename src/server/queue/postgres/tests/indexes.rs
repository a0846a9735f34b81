//! How PostgreSQL finds rows.

use std::time::Duration;

use super::{new, queues};
use crate::queue::{
    Queue as _,
    postgres::{blocks, deliver, fence, held, jobs, lease},
};

/// The statements that a worker and a page of jobs wait for, with 100,000 shards in the queue.
#[test]
fn statements_go_by_indexes_however_long_the_queue_is() {
    let Some(queues) = queues(1, Duration::from_secs(60)) else { return };
    for n in 0..4 {
        queues[0].submit(new(&n.to_string(), 25_000), &|_| false).unwrap();
    }
    let explain = |statement: &str, arguments: &str| {
        let types = vec!["unknown"; arguments.matches(',').count() + 1].join(", ");
        let [types, arguments] = [types.as_str(), arguments]
            .map(|list| if arguments.is_empty() { String::new() } else { format!("({list})") });
        let statements =
            format!("PREPARE s {types} AS {statement}; EXPLAIN (COSTS OFF) EXECUTE s {arguments}; DEALLOCATE s");
        let messages = queues[0].database.run(async |client| Ok(client.simple_query(&statements).await?)).unwrap();
        let lines = messages.iter().filter_map(|message| match message {
            tokio_postgres::SimpleQueryMessage::Row(row) => row.get(0).map(str::to_owned),
            _ => None,
        });
        lines.collect::<Vec<_>>().join("\n")
    };
    let of_submission = format!("{} WHERE submission < $1 ORDER BY submission DESC LIMIT $2", jobs::COLUMNS);
    for (statement, arguments) in [
        (lease::LEASE.as_str(), "1, 16, 60, 'me', false, 3"),
        (lease::OPEN, ""),
        (blocks::MAKE_ROWS, "NULL, 2048, 64, 1"),
        (deliver::COMPLETE, "'{1}', '{0}', '{a}', '{abc}', 8"),
        (fence::IS_CURRENT, "1, 0, 'a'"),
        (held::RENEW, "'{1}', '{0}', '{a}', '{1}', 60"),
        (of_submission.as_str(), "9, 20"),
    ] {
        let plan = explain(statement, arguments);
        assert!(plan.contains("Scan"), "{plan}");
        for table in ["tasks", "blocks", "jobs", "serving"] {
            assert!(!plan.contains(&format!("Seq Scan on {table}")), "{plan}");
        }
    }
}
