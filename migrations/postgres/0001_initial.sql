-- Jobs, their tasks, and the list of tables. An applied migration never changes: add a new file instead.

-- The queue's clock. Leases expire by this clock. The clocks of the workers do not matter.
CREATE FUNCTION ltcforge.clock() RETURNS timestamptz LANGUAGE sql STABLE AS 'SELECT now()';

CREATE SEQUENCE ltcforge.submissions;

CREATE TABLE ltcforge.jobs (
    -- A job that is submitted again gets a new number.
    submission bigint PRIMARY KEY DEFAULT nextval('ltcforge.submissions'),
    id bytea NOT NULL UNIQUE,
    recipe_digest bytea NOT NULL,
    recipe text NOT NULL,
    -- Only workers with this version of the fitter work on the job.
    fitter integer NOT NULL,
    -- SHA-256 of the division into shards. A later submission with the same digest keeps the finished shards.
    shards_digest bytea NOT NULL,
    entries_total bigint NOT NULL,
    state text NOT NULL CHECK (state IN ('queued', 'running', 'done', 'failed', 'cancelled')),
    table_digest bytea CHECK ((state = 'done') = (table_digest IS NOT NULL)),
    failure text CHECK ((state = 'failed') = (failure IS NOT NULL)),
    -- Both columns are set when the job ends. Before, they are computed from its tasks.
    entries_done bigint,
    attempts integer,
    created_at timestamptz NOT NULL,
    started_at timestamptz,
    finished_at timestamptz,
    submitted_by text,
    cancelled_by text
);
CREATE INDEX jobs_by_state ON ltcforge.jobs (state, submission);
CREATE INDEX jobs_by_end ON ltcforge.jobs (finished_at) WHERE finished_at IS NOT NULL;
CREATE INDEX jobs_by_table ON ltcforge.jobs (table_digest) WHERE table_digest IS NOT NULL;

-- The tasks of unfinished jobs: one for each shard, and a last one that assembles the table. A failed job keeps its
-- finished shards.
CREATE TABLE ltcforge.tasks (
    submission bigint NOT NULL REFERENCES ltcforge.jobs ON UPDATE CASCADE ON DELETE CASCADE,
    task integer NOT NULL,
    is_assembly boolean NOT NULL,
    -- The fitter version of the job.
    fitter integer NOT NULL,
    -- Microseconds of the virtual clock. Tasks are leased in this order.
    tag bigint NOT NULL,
    entries integer NOT NULL,
    -- The predicted time on one core.
    seconds double precision NOT NULL,
    -- An assembly is blocked until all shards are finished.
    state text NOT NULL CHECK (state IN ('blocked', 'waiting', 'leased', 'finished')),
    -- The number of the current lease. A worker with another number cannot write.
    lease bigint,
    lease_until timestamptz CHECK ((state = 'leased') = (lease_until IS NOT NULL)),
    -- The number of leases, without returned leases, and the number of reported failures.
    leases integer NOT NULL DEFAULT 0,
    failures integer NOT NULL DEFAULT 0,
    -- The number of finished entries that the worker has reported.
    entries_reported bigint NOT NULL DEFAULT 0,
    -- The first eight bytes of the hash of the shard's bytes, followed by the shard's bytes.
    result bytea CHECK (result IS NULL OR state = 'finished'),
    PRIMARY KEY (submission, task)
) WITH (autovacuum_vacuum_scale_factor = 0.02, autovacuum_analyze_scale_factor = 0.02);
-- The numbers of a fit do not compress.
ALTER TABLE ltcforge.tasks ALTER COLUMN result SET STORAGE EXTERNAL;
CREATE INDEX tasks_waiting ON ltcforge.tasks (fitter, tag, submission, task) WHERE state = 'waiting';
CREATE INDEX tasks_leased ON ltcforge.tasks (lease_until) WHERE state = 'leased';
CREATE INDEX tasks_unfinished ON ltcforge.tasks (submission) WHERE state IN ('waiting', 'leased') AND NOT is_assembly;
CREATE INDEX tasks_blocked ON ltcforge.tasks (submission) WHERE state = 'blocked';

-- The rows that are not about jobs. The embedded store has a tree for each value of `tree`.
CREATE TABLE ltcforge.rows (
    tree text NOT NULL,
    key bytea NOT NULL,
    value bytea NOT NULL,
    PRIMARY KEY (tree, key)
);
