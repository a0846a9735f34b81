-- Jobs, their tasks, and the list of tables. An applied migration never changes: add a new file instead.

-- The one clock of the queue. Leases expire by it alone, whatever the workers' clocks say.
CREATE FUNCTION ltcforge.clock() RETURNS timestamptz LANGUAGE sql STABLE AS 'SELECT now()';

CREATE SEQUENCE ltcforge.submissions;

CREATE TABLE ltcforge.jobs (
    -- A job that is submitted again gets another one.
    submission bigint PRIMARY KEY DEFAULT nextval('ltcforge.submissions'),
    id bytea NOT NULL UNIQUE,
    recipe_digest bytea NOT NULL,
    recipe text NOT NULL,
    -- Only workers with this version of the fitter work on it.
    fitter integer NOT NULL,
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
    finished_at timestamptz,
    submitted_by text,
    cancelled_by text
);
CREATE INDEX jobs_by_state ON ltcforge.jobs (state, submission);
CREATE INDEX jobs_by_end ON ltcforge.jobs (finished_at) WHERE finished_at IS NOT NULL;
CREATE INDEX jobs_by_table ON ltcforge.jobs (table_digest) WHERE table_digest IS NOT NULL;

-- A task for each shard of an unfinished job, and one, the last, that assembles the table. A failed job keeps its finished
-- shards.
CREATE TABLE ltcforge.tasks (
    submission bigint NOT NULL REFERENCES ltcforge.jobs ON UPDATE CASCADE ON DELETE CASCADE,
    task integer NOT NULL,
    is_assembly boolean NOT NULL,
    -- That of the job.
    fitter integer NOT NULL,
    -- The order of leasing: microseconds of the virtual clock.
    tag bigint NOT NULL,
    entries integer NOT NULL,
    -- Predicted, on one core.
    seconds double precision NOT NULL,
    -- An assembly is blocked until all shards are finished.
    state text NOT NULL CHECK (state IN ('blocked', 'waiting', 'leased', 'finished')),
    -- The fence: nothing is written under another number.
    lease bigint,
    lease_until timestamptz CHECK ((state = 'leased') = (lease_until IS NOT NULL)),
    -- Leases without those that were given back, and reported failures.
    leases integer NOT NULL DEFAULT 0,
    failures integer NOT NULL DEFAULT 0,
    -- Entries that the worker has reported.
    entries_reported bigint NOT NULL DEFAULT 0,
    -- The shard's bytes behind the first eight bytes of their hash.
    result bytea CHECK (result IS NULL OR state = 'finished'),
    PRIMARY KEY (submission, task)
) WITH (autovacuum_vacuum_scale_factor = 0.02, autovacuum_analyze_scale_factor = 0.02);
-- Numbers of a fit do not compress.
ALTER TABLE ltcforge.tasks ALTER COLUMN result SET STORAGE EXTERNAL;
CREATE INDEX tasks_waiting ON ltcforge.tasks (fitter, tag, submission, task) WHERE state = 'waiting';
CREATE INDEX tasks_leased ON ltcforge.tasks (lease_until) WHERE state = 'leased';
CREATE INDEX tasks_unfinished ON ltcforge.tasks (submission) WHERE state IN ('waiting', 'leased') AND NOT is_assembly;
CREATE INDEX tasks_blocked ON ltcforge.tasks (submission) WHERE state = 'blocked';

-- The trees of the embedded store that are not of jobs.
CREATE TABLE ltcforge.rows (
    tree text NOT NULL,
    key bytea NOT NULL,
    value bytea NOT NULL,
    PRIMARY KEY (tree, key)
);
