//! The tables, and how they came to be: each step runs once, in order.

use sqlx::Row;

use super::files::{self, Origin};
use super::{Result, Store};
use crate::service::job::Submission;

/// Steps so far. What stands here is never changed again; what is to change gets a step of its own.
const STEPS: &[&[&str]] = &[FIRST, PARTS_AND_TURNS];

const FIRST: &[&str] = &[
    // `id` is a UUID of version 7: sorted by it jobs are sorted by time. `fence` counts the claims: whoever writes must name the
    // claim he holds, so that a worker taken for dead that is not cannot write over its successor. `attempts` counts the claims
    // since the last checkpoint. `revision` grows with every change that somebody may be watching for.
    "CREATE TABLE jobs (
        id {key} PRIMARY KEY, kind TEXT NOT NULL, name TEXT NOT NULL, owner TEXT NOT NULL, state TEXT NOT NULL,
        calibration TEXT, created_ms BIGINT NOT NULL, started_ms BIGINT, finished_ms BIGINT,
        worker TEXT, fence BIGINT NOT NULL DEFAULT 0, lease_until_ms BIGINT, attempts BIGINT NOT NULL DEFAULT 0,
        cancel_asked BIGINT NOT NULL DEFAULT 0, revision BIGINT NOT NULL DEFAULT 0,
        progress TEXT, problem TEXT, summary TEXT)",
    "CREATE INDEX jobs_by_state ON jobs (state, id)",
    "CREATE INDEX jobs_by_kind ON jobs (kind, id)",
    "CREATE INDEX jobs_finished ON jobs (finished_ms)",
    "CREATE TABLE submissions (job {key} PRIMARY KEY REFERENCES jobs (id) ON DELETE CASCADE, content {bytes} NOT NULL)",
    "CREATE TABLE idempotency (
        owner TEXT NOT NULL, key TEXT NOT NULL, fingerprint TEXT NOT NULL,
        job {key} NOT NULL REFERENCES jobs (id) ON DELETE CASCADE, PRIMARY KEY (owner, key))",
    "CREATE INDEX idempotency_by_job ON idempotency (job)",
    "CREATE TABLE checkpoints (job {key} PRIMARY KEY REFERENCES jobs (id) ON DELETE CASCADE, content {bytes} NOT NULL)",
    "CREATE TABLE files (
        job {key} NOT NULL REFERENCES jobs (id) ON DELETE CASCADE, name TEXT NOT NULL, media_type TEXT NOT NULL,
        size BIGINT NOT NULL, content {bytes} NOT NULL, PRIMARY KEY (job, name))",
    // What a running job shows of itself: pieces of its curve, and its latest picture.
    "CREATE TABLE growth (
        job {key} NOT NULL REFERENCES jobs (id) ON DELETE CASCADE, first BIGINT NOT NULL, fence BIGINT NOT NULL,
        entries TEXT NOT NULL,
        PRIMARY KEY (job, first))",
    "CREATE TABLE pictures (
        job {key} PRIMARY KEY REFERENCES jobs (id) ON DELETE CASCADE, revision BIGINT NOT NULL, about TEXT NOT NULL,
        content {bytes} NOT NULL)",
    // What is packed already is not packed once more.
    "postgres: ALTER TABLE files ALTER COLUMN content SET STORAGE EXTERNAL",
    "postgres: ALTER TABLE checkpoints ALTER COLUMN content SET STORAGE EXTERNAL",
    "postgres: ALTER TABLE pictures ALTER COLUMN content SET STORAGE EXTERNAL",
    "CREATE TABLE tokens (
        hash TEXT PRIMARY KEY, name TEXT NOT NULL UNIQUE, role TEXT NOT NULL, created_ms BIGINT NOT NULL, expires_ms BIGINT)",
];

/// Files in parts, inputs among them, so that no reader holds a whole one; turns, so that no owner keeps the others waiting.
const PARTS_AND_TURNS: &[&str] = &[
    "CREATE TABLE job_files (
        job {key} NOT NULL REFERENCES jobs (id) ON DELETE CASCADE, origin TEXT NOT NULL, name {key} NOT NULL,
        media_type TEXT NOT NULL, size BIGINT NOT NULL, PRIMARY KEY (job, origin, name))",
    "CREATE TABLE file_parts (
        job {key} NOT NULL, origin TEXT NOT NULL, name {key} NOT NULL, number BIGINT NOT NULL, content {bytes} NOT NULL,
        PRIMARY KEY (job, origin, name, number),
        FOREIGN KEY (job, origin, name) REFERENCES job_files (job, origin, name) ON DELETE CASCADE)",
    "postgres: ALTER TABLE file_parts ALTER COLUMN content SET STORAGE EXTERNAL",
    // `turn` orders the queue, and jobs of one turn are ordered by time.
    "ALTER TABLE jobs ADD COLUMN turn BIGINT NOT NULL DEFAULT 0",
    "DROP INDEX jobs_by_state",
    "CREATE INDEX jobs_by_turn ON jobs (state, turn, id)",
    "CREATE INDEX jobs_by_owner ON jobs (owner, state, turn)",
    // The turn of the job of each owner that was taken last.
    "CREATE TABLE turns (owner {key} PRIMARY KEY, turn BIGINT NOT NULL)",
];

/// Step at whose end files are moved into parts.
const FILES_MOVED: usize = 2;

/// What a statement begins with that SQLite has no need of.
const POSTGRES_ONLY: &str = "postgres: ";

/// Number by which processes that start together agree who lays the tables in PostgreSQL.
const LOCK: i64 = 0x7065_7269_6c69_6665;

impl Store {
    /// Takes the steps that this database has not seen yet, all or none.
    pub(super) async fn migrate(&self) -> Result<()> {
        let mut transaction = self.begin().await?;
        if self.dialect == super::Dialect::Postgres {
            sqlx::query("SELECT pg_advisory_xact_lock($1)").bind(LOCK).execute(&mut *transaction).await?;
        }
        sqlx::query("CREATE TABLE IF NOT EXISTS perilife_schema (version BIGINT NOT NULL)").execute(&mut *transaction).await?;
        let version: Option<i64> =
            sqlx::query_scalar("SELECT MAX(version) FROM perilife_schema").fetch_one(&mut *transaction).await?;
        let done = usize::try_from(version.unwrap_or(0)).unwrap_or(0);
        if done > STEPS.len() {
            let problem = format!("the database is at version {done}, this program knows {} only: use a newer one", STEPS.len());
            return Err(sqlx::Error::Configuration(problem.into()));
        }
        if (1..STEPS.len()).contains(&done) && self.is_worked_for(&mut transaction).await? {
            let problem =
                "jobs are being run by an earlier version of this program: stop all of its processes, and try again in a minute";
            return Err(sqlx::Error::Configuration(problem.into()));
        }
        for (number, step) in STEPS.iter().enumerate().skip(done) {
            for statement in *step {
                let statement = match statement.strip_prefix(POSTGRES_ONLY) {
                    Some(_) if self.dialect == super::Dialect::Sqlite => continue,
                    Some(theirs) => theirs,
                    None => statement,
                };
                sqlx::query(self.sql(statement)).execute(&mut *transaction).await?;
            }
            let number = number + 1;
            if number == FILES_MOVED {
                move_results(&mut transaction).await?;
                move_inputs(&mut transaction).await?;
            }
            let version = number as i64;
            sqlx::query("INSERT INTO perilife_schema (version) VALUES ($1)").bind(version).execute(&mut *transaction).await?;
        }
        transaction.commit().await
    }

    /// Whether a worker holds a job.
    async fn is_worked_for(&self, transaction: &mut sqlx::Transaction<'static, sqlx::Any>) -> Result<bool> {
        let held = self.sql("SELECT COUNT(*) FROM jobs WHERE state = 'running' AND lease_until_ms > {now}");
        Ok(sqlx::query_scalar::<_, i64>(held).fetch_one(&mut **transaction).await? > 0)
    }
}

/// Takes the files of results, which were whole, into parts.
async fn move_results(transaction: &mut sqlx::Transaction<'static, sqlx::Any>) -> Result<()> {
    let names = sqlx::query("SELECT job, name FROM files").fetch_all(&mut **transaction).await?;
    for row in names {
        let (job, name): (String, String) = (row.try_get(0)?, row.try_get(1)?);
        let content: Vec<u8> = sqlx::query_scalar("SELECT content FROM files WHERE job = $1 AND name = $2")
            .bind(&job)
            .bind(&name)
            .fetch_one(&mut **transaction)
            .await?;
        files::add(transaction, &job, Origin::Result, &name, &content).await?;
    }
    sqlx::query("DROP TABLE files").execute(&mut **transaction).await.map(drop)
}

/// Takes the files out of the submissions, behind whose text they stood.
async fn move_inputs(transaction: &mut sqlx::Transaction<'static, sqlx::Any>) -> Result<()> {
    let jobs: Vec<String> = sqlx::query_scalar("SELECT job FROM submissions").fetch_all(&mut **transaction).await?;
    for job in jobs {
        let row = sqlx::query("SELECT content FROM submissions WHERE job = $1").bind(&job).fetch_one(&mut **transaction).await?;
        let content: Vec<u8> = row.try_get(0)?;
        let broken = |error: postcard::Error| sqlx::Error::Decode(error.into());
        let (text, with_files): (Submission, Vec<(String, Vec<u8>)>) = postcard::from_bytes(&content).map_err(broken)?;
        for (name, content) in with_files {
            files::add(transaction, &job, Origin::Input, &name, &content).await?;
        }
        let text = postcard::to_stdvec(&text).map_err(broken)?;
        sqlx::query("UPDATE submissions SET content = $2 WHERE job = $1")
            .bind(&job)
            .bind(text)
            .execute(&mut **transaction)
            .await?;
    }
    Ok(())
}
