//! The tables.

use super::{Dialect, Result, Store};

/// Version of the tables; one higher with every change of them.
const VERSION: i64 = 2;

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

/// What a statement begins with that SQLite has no need of.
const POSTGRES_ONLY: &str = "postgres: ";

/// Number by which processes that start together agree who lays the tables in PostgreSQL.
const LOCK: i64 = 0x7065_7269_6c69_6665;

impl Store {
    /// Lays the tables, all or none, where there are none.
    ///
    /// # Errors
    /// Tables of another version.
    pub(super) async fn lay_tables(&self) -> Result<()> {
        let mut transaction = self.begin().await?;
        if self.dialect == Dialect::Postgres {
            sqlx::query("SELECT pg_advisory_xact_lock($1)").bind(LOCK).execute(&mut *transaction).await?;
        }
        sqlx::query("CREATE TABLE IF NOT EXISTS perilife_schema (version BIGINT NOT NULL)").execute(&mut *transaction).await?;
        let version: Option<i64> =
            sqlx::query_scalar("SELECT MAX(version) FROM perilife_schema").fetch_one(&mut *transaction).await?;
        match version {
            Some(VERSION) => return Ok(()),
            Some(other) => {
                let problem = format!(
                    "the tables of the database are of version {other}, and this program reads version {VERSION} only: use a new \
                     database (--data or --database)"
                );
                return Err(sqlx::Error::Configuration(problem.into()));
            }
            None => {}
        }
        for statement in TABLES {
            let statement = match statement.strip_prefix(POSTGRES_ONLY) {
                Some(_) if self.dialect == Dialect::Sqlite => continue,
                Some(theirs) => theirs,
                None => statement,
            };
            sqlx::query(self.sql(statement)).execute(&mut *transaction).await?;
        }
        sqlx::query("INSERT INTO perilife_schema (version) VALUES ($1)").bind(VERSION).execute(&mut *transaction).await?;
        transaction.commit().await
    }
}
