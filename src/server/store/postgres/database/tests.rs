//! Connections, as PostgreSQL and its URLs treat them.

use super::{
    super::tests::{database, throwaway},
    *,
};

#[test]
fn connections_that_nobody_uses_are_ended_and_made_again() {
    let Some(database) = database() else { return };
    let select = || database.run(async |client| Ok(client.query_one("SELECT pg_sleep(.1)", &[]).await.map(drop)?));
    std::thread::scope(|scope| (0..8).for_each(|_| drop(scope.spawn(select))));
    assert!(database.pool.status().size > 1, "{:?}", database.pool.status());
    end_idle(&database.pool, Duration::from_secs(3600));
    assert!(database.pool.status().size > 1, "they were just used");
    end_idle(&database.pool, Duration::ZERO);
    assert_eq!(database.pool.status().size, 0);
    select().unwrap();
    assert_eq!(database.pool.status().size, 1);
}

#[test]
fn callers_share_the_connections_that_there_may_be() {
    let Some(url) = throwaway::empty_database() else { return };
    let [one, two] = [1, 2].map(|most| {
        let most = NonZeroUsize::new(most).unwrap();
        Database::open_with(&url, most, DatabaseTimeouts::default()).unwrap()
    });
    for (database, most) in [(one, 1), (two, 2)] {
        let select =
            || database.run(async |client| Ok(client.query_one("SELECT pg_sleep(.02)", &[]).await.map(drop)?));
        std::thread::scope(|scope| (0..8).for_each(|_| drop(scope.spawn(|| select().unwrap()))));
        assert_eq!(database.pool.status().size, most);
    }
}

#[test]
fn a_connection_that_does_not_answer_is_given_up_and_its_statement_is_ended() {
    let Some(database) = database() else { return };
    let sleep = async |client: &mut Client| Ok(client.batch_execute("SELECT pg_sleep(3600)").await?);
    let soon = Instant::now() + Duration::from_millis(200);
    let Err(StoreError::Unavailable(reason)) = database.block_on(database.tried(Some(soon), &sleep)) else {
        panic!("it slept")
    };
    assert!(reason.ends_with("does not answer in time"), "{reason}");
    assert_eq!(database.pool.status().size, 0, "nobody else waits for it");
    let sleeping = || {
        let count = "SELECT count(*) FROM pg_stat_activity WHERE query LIKE 'SELECT pg_sleep(3600)%'
            AND datname = current_database() AND state = 'active'";
        database.run(async |client| Ok(client.query_one(count, &[]).await?.get::<_, i64>(0))).unwrap()
    };
    while sleeping() > 0 {
        std::thread::yield_now();
    }
}

/// The sequence of privileges is that of an operator who goes on where it still does not work.
#[test]
fn a_role_that_cannot_write_is_told_with_what_it_lacks() {
    let Some(url) = throwaway::empty_database() else { return };
    let owner = Database::open(&url).unwrap();
    let execute = |statement: &str| {
        owner.run(async |client| Ok(client.batch_execute(statement).await?)).unwrap();
    };
    assert_eq!(owner.fault(), None);
    let role = format!("reader{}", std::process::id());
    execute(&format!(
        "CREATE ROLE {role} LOGIN; GRANT USAGE ON SCHEMA ltcforge TO {role};
        GRANT SELECT ON ALL TABLES IN SCHEMA ltcforge TO {role}"
    ));
    let reader = Database::open(&url.replace("postgres@", &format!("{role}@"))).unwrap();
    let fault = reader.fault().unwrap();
    assert!(fault.contains(&format!("the role {role} may not write blocks, finished_entries, jobs")), "{fault}");
    let write = || reader.run(async |client| Ok(client.batch_execute("DELETE FROM ltcforge.jobs").await?));
    assert!(matches!(write(), Err(StoreError::Refused(_))));
    execute(&format!("GRANT INSERT, UPDATE, DELETE ON ALL TABLES IN SCHEMA ltcforge TO {role}"));
    assert!(reader.fault().unwrap().ends_with("may not write servings, submissions"));
    execute(&format!("GRANT USAGE ON ALL SEQUENCES IN SCHEMA ltcforge TO {role}"));
    assert_eq!(reader.fault(), None);
    execute(&format!("ALTER ROLE {role} SET default_transaction_read_only = on"));
    end_idle(&reader.pool, Duration::ZERO);
    assert!(reader.fault().unwrap().ends_with("its transactions are read-only"));
    execute(&format!("DROP OWNED BY {role}; DROP ROLE {role}"));
    end_idle(&reader.pool, Duration::ZERO);
    assert!(reader.fault().unwrap().contains("does not exist"));
}

#[test]
fn a_url_whose_password_would_show_is_refused() {
    for url in ["://me:a@b@host/name", "://me:a/b@host/name", "://me:a?b@host/name", "://me:a#b@host/name"] {
        assert!(has_stray_at(&format!("postgres{url}")), "{url}");
    }
    for url in ["postgres://me:a%40b@host/name?sslmode=disable", "postgres://host/name", "host=h user=a@b"] {
        assert!(!has_stray_at(url), "{url}");
    }
    let error = Database::open("postgres://me:hunter2@more@host/name").unwrap_err().to_string();
    assert!(error.contains("%40") && !error.contains("more"), "{error}");
}
