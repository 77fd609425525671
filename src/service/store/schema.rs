//! The tables.

use super::{Dialect, Result, Store};

/// Version of the tables; one higher with every change of them.
pub(super) const VERSION: i64 = 6;

/// Version of [`TABLES`], to which [`UPGRADES`] lead on.
const FIRST: i64 = 2;

/// What leads from the version before to the one named: additions only, so that what is stored stays as it is.
const UPGRADES: &[(i64, &[&str])] = &[
    (
        3,
        &[
            // `failures` counts ends that are not the job's fault and never falls; the job waits until `not_before_ms`. `lease_ms` is
            // what was granted last: a lease that ends later than that from now was granted before the clock was set back. `spent_ms` is
            // computing time by the clocks of the workers, `finished_count_ms` the counted clock at the end.
            "ALTER TABLE jobs ADD COLUMN failures BIGINT NOT NULL DEFAULT 0",
            "ALTER TABLE jobs ADD COLUMN not_before_ms BIGINT",
            "ALTER TABLE jobs ADD COLUMN lease_ms BIGINT NOT NULL DEFAULT 0",
            "ALTER TABLE jobs ADD COLUMN spent_ms BIGINT NOT NULL DEFAULT 0",
            "ALTER TABLE jobs ADD COLUMN finished_count_ms BIGINT",
            "UPDATE jobs SET finished_count_ms = 0 WHERE finished_ms IS NOT NULL",
            "CREATE INDEX jobs_finished_count ON jobs (finished_count_ms)",
            "DROP INDEX jobs_finished",
            "ALTER TABLE submissions ADD COLUMN options TEXT NOT NULL DEFAULT '[]'",
            // Time during which a service ran, by steps that no jump of a clock makes long.
            "CREATE TABLE clock (seen_ms BIGINT NOT NULL, counted_ms BIGINT NOT NULL)",
            "INSERT INTO clock (seen_ms, counted_ms) VALUES ({now}, 0)",
        ],
    ),
    (
        4,
        &[
            // What people say of a run once it is there.
            "ALTER TABLE jobs ADD COLUMN note TEXT NOT NULL DEFAULT ''",
            "ALTER TABLE jobs ADD COLUMN archived BIGINT NOT NULL DEFAULT 0",
        ],
    ),
    (
        5,
        &[
            // `reason` says why it ended last when it was not to blame. `room` is what a job without a result may still write, `bytes`
            // that and all it has. Their sum for each owner is kept by triggers, so that nobody has to add it up, whoever writes;
            // `most` is what he may have.
            "ALTER TABLE jobs ADD COLUMN reason TEXT",
            "ALTER TABLE jobs ADD COLUMN room BIGINT NOT NULL DEFAULT 0",
            "ALTER TABLE jobs ADD COLUMN bytes BIGINT NOT NULL DEFAULT 0",
            "UPDATE jobs SET bytes = {stored}",
            "CREATE TABLE stored (owner {key} PRIMARY KEY, bytes BIGINT NOT NULL, most BIGINT)",
            "INSERT INTO stored (owner, bytes) SELECT owner, CAST(SUM(bytes) AS BIGINT) FROM jobs GROUP BY owner",
            "sqlite: CREATE TRIGGER jobs_in AFTER INSERT ON jobs BEGIN
                INSERT INTO stored (owner, bytes) VALUES (NEW.owner, NEW.bytes)
                ON CONFLICT (owner) DO UPDATE SET bytes = stored.bytes + excluded.bytes; END",
            "sqlite: CREATE TRIGGER jobs_of AFTER UPDATE OF bytes ON jobs BEGIN
                UPDATE stored SET bytes = bytes + NEW.bytes - OLD.bytes WHERE owner = NEW.owner; END",
            "sqlite: CREATE TRIGGER jobs_out AFTER DELETE ON jobs BEGIN
                UPDATE stored SET bytes = bytes - OLD.bytes WHERE owner = OLD.owner; END",
            "postgres: CREATE FUNCTION count_stored() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN
                IF TG_OP = 'INSERT' THEN
                    INSERT INTO stored (owner, bytes) VALUES (NEW.owner, NEW.bytes)
                    ON CONFLICT (owner) DO UPDATE SET bytes = stored.bytes + excluded.bytes;
                ELSIF TG_OP = 'UPDATE' THEN
                    UPDATE stored SET bytes = bytes + NEW.bytes - OLD.bytes WHERE owner = NEW.owner;
                ELSE
                    UPDATE stored SET bytes = bytes - OLD.bytes WHERE owner = OLD.owner;
                END IF;
                RETURN NULL; END $$",
            "postgres: CREATE TRIGGER jobs_stored AFTER INSERT OR UPDATE OF bytes OR DELETE ON jobs
                FOR EACH ROW EXECUTE FUNCTION count_stored()",
        ],
    ),
    (6, &["ALTER TABLE jobs ADD COLUMN report TEXT"]),
];

const TABLES: &[&str] = &[
    // `id` is a UUID of version 7: sorted by it jobs are sorted by time. `fence` counts the claims: whoever writes must name the
    // claim he holds, so that a worker taken for dead that is not cannot write over its successor. `attempts` counts the claims
    // since the last checkpoint. `revision` grows with every change that somebody may be watching for. `turn` orders the queue, and
    // jobs of one turn are ordered by time.
    "CREATE TABLE jobs (
        id {key} PRIMARY KEY, kind TEXT NOT NULL, name TEXT NOT NULL, owner TEXT NOT NULL, state TEXT NOT NULL,
        calibration TEXT, created_ms BIGINT NOT NULL, started_ms BIGINT, finished_ms BIGINT,
        worker TEXT, fence BIGINT NOT NULL DEFAULT 0, lease_until_ms BIGINT, attempts BIGINT NOT NULL DEFAULT 0,
        cancel_asked BIGINT NOT NULL DEFAULT 0, revision BIGINT NOT NULL DEFAULT 0, turn BIGINT NOT NULL DEFAULT 0,
        progress TEXT, problem TEXT, summary TEXT)",
    "CREATE INDEX jobs_by_turn ON jobs (state, turn, id)",
    "CREATE INDEX jobs_by_owner ON jobs (owner, state, turn)",
    "CREATE INDEX jobs_by_kind ON jobs (kind, id)",
    "CREATE INDEX jobs_finished ON jobs (finished_ms)",
    // The turn of the job of each owner that was taken last.
    "CREATE TABLE turns (owner {key} PRIMARY KEY, turn BIGINT NOT NULL)",
    "CREATE TABLE submissions (job {key} PRIMARY KEY REFERENCES jobs (id) ON DELETE CASCADE, content {bytes} NOT NULL)",
    "CREATE TABLE idempotency (
        owner TEXT NOT NULL, key TEXT NOT NULL, fingerprint TEXT NOT NULL,
        job {key} NOT NULL REFERENCES jobs (id) ON DELETE CASCADE, PRIMARY KEY (owner, key))",
    "CREATE INDEX idempotency_by_job ON idempotency (job)",
    "CREATE TABLE checkpoints (job {key} PRIMARY KEY REFERENCES jobs (id) ON DELETE CASCADE, content {bytes} NOT NULL)",
    // Files in parts, so that no reader holds a whole one.
    "CREATE TABLE job_files (
        job {key} NOT NULL REFERENCES jobs (id) ON DELETE CASCADE, origin TEXT NOT NULL, name {key} NOT NULL,
        media_type TEXT NOT NULL, size BIGINT NOT NULL, PRIMARY KEY (job, origin, name))",
    "CREATE TABLE file_parts (
        job {key} NOT NULL, origin TEXT NOT NULL, name {key} NOT NULL, number BIGINT NOT NULL, content {bytes} NOT NULL,
        PRIMARY KEY (job, origin, name, number),
        FOREIGN KEY (job, origin, name) REFERENCES job_files (job, origin, name) ON DELETE CASCADE)",
    // What a running job shows of itself: pieces of its curve, and its latest picture.
    "CREATE TABLE growth (
        job {key} NOT NULL REFERENCES jobs (id) ON DELETE CASCADE, first BIGINT NOT NULL, fence BIGINT NOT NULL,
        entries TEXT NOT NULL,
        PRIMARY KEY (job, first))",
    "CREATE TABLE pictures (
        job {key} PRIMARY KEY REFERENCES jobs (id) ON DELETE CASCADE, revision BIGINT NOT NULL, about TEXT NOT NULL,
        content {bytes} NOT NULL)",
    // What is packed already is not packed once more.
    "postgres: ALTER TABLE checkpoints ALTER COLUMN content SET STORAGE EXTERNAL",
    "postgres: ALTER TABLE file_parts ALTER COLUMN content SET STORAGE EXTERNAL",
    "postgres: ALTER TABLE pictures ALTER COLUMN content SET STORAGE EXTERNAL",
    "CREATE TABLE tokens (
        hash TEXT PRIMARY KEY, name TEXT NOT NULL UNIQUE, role TEXT NOT NULL, created_ms BIGINT NOT NULL, expires_ms BIGINT)",
];

/// What a statement of one database begins with.
const ONLY: [(Dialect, &str); 2] = [(Dialect::Sqlite, "sqlite: "), (Dialect::Postgres, "postgres: ")];

/// Number by which processes that start together agree who lays the tables in PostgreSQL.
const LOCK: i64 = 0x7065_7269_6c69_6665;

impl Store {
    /// Lays the tables, all or none, where there are none, and leads older ones on to this version if that is wanted.
    pub(super) async fn lay_tables(&self, may_upgrade: bool) -> Result<()> {
        let mut transaction = self.begin().await?;
        if self.dialect == Dialect::Postgres {
            sqlx::query("SELECT pg_advisory_xact_lock($1)").bind(LOCK).execute(&mut *transaction).await?;
        }
        sqlx::query("CREATE TABLE IF NOT EXISTS perilife_schema (version BIGINT NOT NULL)").execute(&mut *transaction).await?;
        let found = version(&mut transaction).await?;
        match found {
            Some(VERSION) => return Ok(()),
            Some(FIRST..VERSION) if may_upgrade => {}
            Some(other) => return Err(of_another_version(other)),
            None => {
                for statement in TABLES {
                    self.lay(&mut transaction, statement).await?;
                }
            }
        }
        for (to, statements) in UPGRADES.iter().filter(|(to, _)| *to > found.unwrap_or(FIRST)) {
            for statement in *statements {
                self.lay(&mut transaction, statement).await?;
            }
            tracing::info!("tables of version {to} laid");
        }
        sqlx::query("DELETE FROM perilife_schema").execute(&mut *transaction).await?;
        sqlx::query("INSERT INTO perilife_schema (version) VALUES ($1)").bind(VERSION).execute(&mut *transaction).await?;
        transaction.commit().await?;
        if found == Some(FIRST) && self.dialect == Dialect::Sqlite {
            // A file that was made without giving space back learns it only by being written anew.
            let mut connection = self.pool.acquire().await?;
            sqlx::raw_sql("PRAGMA auto_vacuum = INCREMENTAL; VACUUM").execute(&mut *connection).await?;
        }
        Ok(())
    }

    async fn lay(&self, transaction: &mut sqlx::Transaction<'static, sqlx::Any>, statement: &'static str) -> Result<()> {
        let theirs = ONLY.iter().find_map(|(dialect, start)| Some((*dialect, statement.strip_prefix(start)?)));
        match theirs {
            Some((dialect, _)) if dialect != self.dialect => Ok(()),
            theirs => {
                let statement = theirs.map_or(statement, |(_, statement)| statement);
                sqlx::query(self.sql(statement)).execute(&mut **transaction).await.map(drop)
            }
        }
    }
}

/// Version of the tables; `None` where there are none.
async fn version(connection: &mut sqlx::AnyConnection) -> Result<Option<i64>> {
    sqlx::query_scalar("SELECT MAX(version) FROM perilife_schema").fetch_one(connection).await
}

/// Refuses tables that another program has led on meanwhile.
pub(super) async fn expect(connection: &mut sqlx::AnyConnection) -> Result<()> {
    match version(connection).await? {
        Some(VERSION) => Ok(()),
        other => Err(of_another_version(other.unwrap_or(0))),
    }
}

fn of_another_version(other: i64) -> sqlx::Error {
    let remedy = if (FIRST..VERSION).contains(&other) {
        "back up, then start `perilife serve` once to migrate the schema"
    } else {
        "use the program that made them, or a new database (--data or --database)"
    };
    let problem =
        format!("the tables of the database are of version {other}, and this program needs version {VERSION}: {remedy}");
    sqlx::Error::Configuration(problem.into())
}
