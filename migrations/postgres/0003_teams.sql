-- What a job may have of the workers: the team of the token that it came with, that team's share, and its priority: -1, 0 or 1.
-- An applied migration never changes: add a new file instead.
ALTER TABLE ltcforge.jobs ADD COLUMN team text NOT NULL DEFAULT '', ADD COLUMN share integer NOT NULL DEFAULT 1,
    ADD COLUMN priority smallint NOT NULL DEFAULT 0;
ALTER TABLE ltcforge.serving ADD COLUMN team text NOT NULL DEFAULT '', ADD COLUMN priority smallint NOT NULL DEFAULT 0;

-- Teams that had a job once. Each lease passes the turn of its team.
CREATE TABLE ltcforge.teams (
    team text PRIMARY KEY,
    share integer NOT NULL CHECK (share > 0),
    turn bigint NOT NULL
) WITH (fillfactor = 50, autovacuum_vacuum_scale_factor = 0.02, autovacuum_analyze_scale_factor = 0.02);
INSERT INTO ltcforge.teams VALUES ('', 1, 0);
