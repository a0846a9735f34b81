-- Jobs, their tasks, and the catalogue of tables. An applied migration never changes: add a new file instead.

-- The one clock of the queue. Leases expire by it alone, whatever the workers' clocks say.
CREATE FUNCTION ltcforge.clock() RETURNS timestamptz LANGUAGE sql STABLE AS 'SELECT now()';

-- The submissions give jobs their order, and a submission tells leases of one recipe's jobs apart.
CREATE SEQUENCE ltcforge.submissions;
CREATE SEQUENCE ltcforge.servings;

CREATE TABLE ltcforge.jobs (
    submission bigint PRIMARY KEY,
    id bytea NOT NULL,
    recipe_digest bytea NOT NULL,
    recipe text NOT NULL,
    -- Only workers with this version of the fitter work on it.
    fitter integer NOT NULL,
    shards integer NOT NULL,
    -- SHA-256 of the entries of each shard: finished shards are kept for a later submission with the same one.
    shards_digest bytea NOT NULL,
    entries_total bigint NOT NULL,
    state text NOT NULL CHECK (state IN ('queued', 'running', 'done', 'failed', 'cancelled')),
    table_digest bytea CHECK ((state = 'done') = (table_digest IS NOT NULL)),
    failure text CHECK ((state = 'failed') = (failure IS NOT NULL)),
    -- Both are set when the job ends; before that they follow from its tasks.
    entries_done bigint,
    attempts integer,
    created_at timestamptz NOT NULL,
    started_at timestamptz,
    finished_at timestamptz
);
-- Two replicas that get the same recipe at once make one job of it.
CREATE UNIQUE INDEX jobs_by_recipe ON ltcforge.jobs (recipe_digest);
CREATE UNIQUE INDEX jobs_by_id ON ltcforge.jobs (id);
CREATE INDEX jobs_by_state ON ltcforge.jobs (state, submission);
CREATE INDEX jobs_open ON ltcforge.jobs (submission) WHERE state IN ('queued', 'running');
CREATE INDEX jobs_by_end ON ltcforge.jobs (finished_at);

-- Shards that were never leased, as runs of shards with equally many entries: a row for each shard would make submitting a
-- large job slow. Leasing takes the first ones off, so that `next` up to `past` are left.
CREATE TABLE ltcforge.blocks (
    submission bigint NOT NULL,
    first integer NOT NULL,
    next integer NOT NULL,
    past integer NOT NULL,
    entries integer NOT NULL,
    PRIMARY KEY (submission, first),
    CHECK (first <= next AND next < past)
) WITH (fillfactor = 50);

-- A task for each shard of an unfinished job that was leased before, and one, the last, that assembles the table. A failed
-- job keeps its finished ones.
CREATE TABLE ltcforge.tasks (
    submission bigint NOT NULL,
    task integer NOT NULL,
    is_assembly boolean NOT NULL,
    entries integer NOT NULL,
    state text NOT NULL CHECK (state IN ('waiting', 'leased', 'finished')),
    -- Leases so far. The number is the fence: nothing is written for an attempt that is not the current one.
    attempt integer NOT NULL DEFAULT 0,
    -- Leases that ended in an error.
    failures integer NOT NULL DEFAULT 0,
    -- Leases that expired: their workers died, or were cut off.
    deaths integer NOT NULL DEFAULT 0,
    last_error text,
    worker text,
    -- Leases are found by it and the key. Without a word of the state: the indexes of leased tasks would be taken instead.
    lease_until timestamptz CHECK ((state = 'leased') = (lease_until IS NOT NULL)),
    -- Entries that the lease has reported.
    entries_reported integer NOT NULL DEFAULT 0,
    -- The shard's entries behind the first eight bytes of their SHA-256.
    result bytea,
    PRIMARY KEY (submission, task)
) WITH (autovacuum_vacuum_scale_factor = 0.02, autovacuum_analyze_scale_factor = 0.02);
-- Numbers of a fit do not compress.
ALTER TABLE ltcforge.tasks ALTER COLUMN result SET STORAGE EXTERNAL;
-- Its order is that of leasing, and no other index has it.
CREATE INDEX tasks_waiting ON ltcforge.tasks (submission, is_assembly, task) WHERE state = 'waiting';
CREATE INDEX tasks_leased ON ltcforge.tasks (submission, lease_until) WHERE state = 'leased';
CREATE INDEX tasks_suspect ON ltcforge.tasks (deaths) WHERE state = 'leased' AND deaths > 0;
CREATE INDEX tasks_repeated ON ltcforge.tasks (submission, attempt) WHERE attempt > 1;

-- When an unfinished job was last served, in the order of servings.
CREATE TABLE ltcforge.serving (
    submission bigint PRIMARY KEY,
    -- That of the job.
    fitter integer NOT NULL,
    last_served bigint NOT NULL DEFAULT 0
) WITH (autovacuum_vacuum_scale_factor = 0.02, autovacuum_analyze_scale_factor = 0.02);
-- Who was not served for longest is found without looking at the others.
CREATE INDEX serving_order ON ltcforge.serving (fitter, last_served, submission);

-- Entries of a job's finished shards. Each writer adds to one of several rows, so that they seldom wait for each other.
CREATE TABLE ltcforge.finished_entries (
    submission bigint NOT NULL,
    slot smallint NOT NULL,
    entries bigint NOT NULL,
    PRIMARY KEY (submission, slot)
) WITH (fillfactor = 50);

-- The catalogue: the trees of the embedded store that are not of jobs.
CREATE TABLE ltcforge.rows (
    tree text NOT NULL,
    key bytea NOT NULL,
    value bytea NOT NULL,
    PRIMARY KEY (tree, key)
);

-- Number and bytes of the tables in the catalogue, as sums of rows, so that nobody has to count them. Each writer adds to
-- one of several rows, so that they seldom wait for each other.
CREATE TABLE ltcforge.totals (
    slot integer PRIMARY KEY,
    tables bigint NOT NULL,
    bytes bigint NOT NULL
) WITH (fillfactor = 50);

CREATE FUNCTION ltcforge.count_table() RETURNS trigger LANGUAGE plpgsql AS $$
DECLARE
    more_tables bigint := 0;
    more_bytes bigint := 0;
BEGIN
    IF TG_OP <> 'INSERT' THEN
        more_tables := more_tables - 1;
        more_bytes := more_bytes - coalesce((convert_from(OLD.value, 'UTF8')::json ->> 'bytes')::bigint, 0);
    END IF;
    IF TG_OP <> 'DELETE' THEN
        more_tables := more_tables + 1;
        more_bytes := more_bytes + coalesce((convert_from(NEW.value, 'UTF8')::json ->> 'bytes')::bigint, 0);
    END IF;
    INSERT INTO ltcforge.totals AS t (slot, tables, bytes) VALUES (pg_backend_pid() % 8, more_tables, more_bytes)
    ON CONFLICT (slot) DO UPDATE SET tables = t.tables + excluded.tables, bytes = t.bytes + excluded.bytes;
    RETURN NULL;
END
$$;
CREATE TRIGGER table_added AFTER INSERT ON ltcforge.rows
    FOR EACH ROW WHEN (NEW.tree = 'tables') EXECUTE FUNCTION ltcforge.count_table();
CREATE TRIGGER table_changed AFTER UPDATE ON ltcforge.rows
    FOR EACH ROW WHEN (NEW.tree = 'tables') EXECUTE FUNCTION ltcforge.count_table();
CREATE TRIGGER table_removed AFTER DELETE ON ltcforge.rows
    FOR EACH ROW WHEN (OLD.tree = 'tables') EXECUTE FUNCTION ltcforge.count_table();
