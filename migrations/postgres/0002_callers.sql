-- Who submitted and who cancelled a job: names of tokens. An applied migration never changes: add a new file instead.
ALTER TABLE ltcforge.jobs ADD COLUMN submitted_by text, ADD COLUMN cancelled_by text;
