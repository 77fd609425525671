//! Jobs as those see them who submit, watch, cancel and delete them.

use sqlx::Row;
use sqlx::any::AnyRow;

use super::{Dialect, Origin, Result, Store, files};
use crate::service::job::{Job, JobKind, State, Submission, time};

/// A job to be stored.
#[derive(Debug, Clone)]
pub struct NewJob<'a> {
    /// What it does.
    pub kind: JobKind,
    /// Name of the token that submits it.
    pub owner: &'a str,
    /// The calibration whose law it uses.
    pub calibration: Option<&'a str>,
    /// Key by which a repeated request is known.
    pub idempotency_key: Option<&'a str>,
    /// Hash of the request.
    pub fingerprint: &'a str,
    /// What was asked for.
    pub submission: &'a Submission,
}

/// What became of a submission.
#[derive(Debug, Clone, PartialEq)]
pub enum Submitted {
    /// A new job.
    New(String),
    /// The job of an earlier request with this key.
    Again(String),
    /// The key was used for another request.
    KeyTaken,
    /// The owner has as many jobs in the queue as he may have.
    QueueFull,
}

/// Part of a list, newest first.
#[derive(Debug, Clone, Default)]
pub struct Listing {
    /// Jobs.
    pub jobs: Vec<Job>,
    /// Where the next part begins, if there is one.
    pub next: Option<String>,
}

/// Columns of a [`Job`].
const COLUMNS: &str = "id, kind, name, owner, state, calibration, created_ms, started_ms, finished_ms, cancel_asked, \
                       revision, fence, progress, problem, summary";

/// Sorts behind every id.
const BEHIND_ALL: &str = "~";

impl Store {
    /// Stores a job with its input, whole or not at all: once this returns it will be run.
    ///
    /// # Errors
    /// The database cannot take it; nothing is stored then.
    pub async fn submit(&self, new: &NewJob<'_>, queued_max: i64) -> Result<Submitted> {
        // Without failure: text and numbers.
        let content = postcard::to_stdvec(new.submission).unwrap_or_default();
        let mut transaction = self.begin().await?;
        if self.dialect == Dialect::Postgres {
            // One of an owner's submissions at a time, or two could both find the last place free. SQLite has one writer anyway.
            sqlx::query("SELECT pg_advisory_xact_lock(hashtextextended($1, 0))")
                .bind(new.owner)
                .execute(&mut *transaction)
                .await?;
        }
        if let Some(earlier) = earlier(&mut transaction, new.owner, new.idempotency_key, new.fingerprint).await? {
            return Ok(earlier);
        }
        let queued: i64 = sqlx::query_scalar("SELECT COUNT(*) FROM jobs WHERE state = 'queued' AND owner = $1")
            .bind(new.owner)
            .fetch_one(&mut *transaction)
            .await?;
        if queued >= queued_max {
            return Ok(Submitted::QueueFull);
        }
        let turn = turn(&mut transaction, new.owner).await?;
        let id = uuid::Uuid::now_v7().to_string();
        sqlx::query(self.sql(
            "INSERT INTO jobs (id, kind, name, owner, state, calibration, turn, created_ms)
             VALUES ($1, $2, $3, $4, 'queued', $5, $6, {now})",
        ))
        .bind(&id)
        .bind(new.kind.name())
        .bind(&new.submission.name)
        .bind(new.owner)
        .bind(new.calibration)
        .bind(turn)
        .execute(&mut *transaction)
        .await?;
        sqlx::query("INSERT INTO submissions (job, content) VALUES ($1, $2)")
            .bind(&id)
            .bind(content)
            .execute(&mut *transaction)
            .await?;
        for (name, content) in &new.submission.files {
            files::add(&mut transaction, &id, Origin::Input, name, content).await?;
        }
        if let Some(key) = new.idempotency_key {
            sqlx::query("INSERT INTO idempotency (owner, key, fingerprint, job) VALUES ($1, $2, $3, $4)")
                .bind(new.owner)
                .bind(key)
                .bind(new.fingerprint)
                .bind(&id)
                .execute(&mut *transaction)
                .await?;
        }
        transaction.commit().await?;
        Ok(Submitted::New(id))
    }

    /// What an earlier request with this key has become, if there was one.
    ///
    /// # Errors
    /// The database does not answer.
    pub async fn submitted(&self, owner: &str, key: Option<&str>, fingerprint: &str) -> Result<Option<Submitted>> {
        if key.is_none() {
            return Ok(None);
        }
        earlier(&mut *self.pool.acquire().await?, owner, key, fingerprint).await
    }

    /// A job.
    ///
    /// # Errors
    /// The database does not answer.
    pub async fn job(&self, kind: JobKind, id: &str) -> Result<Option<Job>> {
        let statement = format!("SELECT {COLUMNS} FROM jobs WHERE id = $1 AND kind = $2");
        let row = sqlx::query(self.sql(&statement)).bind(id).bind(kind.name()).fetch_optional(&self.pool).await?;
        let Some(mut job) = row.map(|row| job_of(&row)).transpose()? else { return Ok(None) };
        if job.state == State::Queued {
            let before = sqlx::query_scalar(
                "SELECT COUNT(*) FROM jobs WHERE state = 'queued'
                 AND (turn, id) < (SELECT turn, id FROM jobs WHERE id = $1)",
            );
            job.position = Some(before.bind(id).fetch_one(&self.pool).await?);
        }
        Ok(Some(job))
    }

    /// How often a job has changed; `None` if there is no such job.
    ///
    /// # Errors
    /// The database does not answer.
    pub async fn revision(&self, id: &str) -> Result<Option<i64>> {
        sqlx::query_scalar("SELECT revision FROM jobs WHERE id = $1").bind(id).fetch_optional(&self.pool).await
    }

    /// What was asked for.
    ///
    /// # Errors
    /// The database does not answer.
    pub async fn submission(&self, id: &str) -> Result<Option<Submission>> {
        let content: Option<Vec<u8>> =
            sqlx::query_scalar("SELECT content FROM submissions WHERE job = $1").bind(id).fetch_optional(&self.pool).await?;
        let broken = |error: postcard::Error| sqlx::Error::Decode(error.into());
        content.map(|bytes| postcard::from_bytes(&bytes).map_err(broken)).transpose()
    }

    /// Jobs of a kind, newest first, from behind the job `after` on.
    ///
    /// # Errors
    /// The database does not answer.
    pub async fn list(&self, kind: JobKind, state: Option<State>, after: Option<&str>, limit: u32) -> Result<Listing> {
        let statement = format!(
            "SELECT {COLUMNS} FROM jobs WHERE kind = $1 AND id < $3 AND ($4 = '' OR state = $4) ORDER BY id DESC LIMIT $2"
        );
        // One more than asked for tells whether there are more.
        let rows = sqlx::query(self.sql(&statement))
            .bind(kind.name())
            .bind(i64::from(limit) + 1)
            .bind(after.unwrap_or(BEHIND_ALL))
            .bind(state.map_or("", State::name))
            .fetch_all(&self.pool)
            .await?;
        let mut jobs: Vec<Job> = rows.iter().map(job_of).collect::<Result<_>>()?;
        let is_more = jobs.len() > limit as usize;
        jobs.truncate(limit as usize);
        let next = jobs.last().filter(|_| is_more).map(|job| job.id.clone());
        Ok(Listing { jobs, next })
    }

    /// Asks for the end of a job: one that waits ends at once, one that runs within a cycle block. Whether there was one to end.
    ///
    /// # Errors
    /// The database does not answer.
    pub async fn cancel(&self, id: &str) -> Result<bool> {
        let changed = sqlx::query(self.sql(
            "UPDATE jobs SET cancel_asked = 1, revision = revision + 1,
                finished_ms = CASE WHEN state = 'queued' THEN {now} END,
                state = CASE WHEN state = 'queued' THEN 'cancelled' ELSE state END
             WHERE id = $1 AND state IN ('queued', 'running')",
        ))
        .bind(id)
        .execute(&self.pool)
        .await?;
        Ok(changed.rows_affected() > 0)
    }

    /// Removes a job that does not run, with all it has. Whether there was one.
    ///
    /// # Errors
    /// The database does not answer.
    pub async fn delete(&self, id: &str) -> Result<bool> {
        let gone = sqlx::query("DELETE FROM jobs WHERE id = $1 AND state <> 'running'").bind(id).execute(&self.pool).await?;
        Ok(gone.rows_affected() > 0)
    }

    /// Removes jobs that ended longer than so many milliseconds ago; returns how many.
    ///
    /// # Errors
    /// The database does not answer.
    pub async fn expire(&self, kept_ms: i64) -> Result<u64> {
        let gone = sqlx::query(self.sql("DELETE FROM jobs WHERE finished_ms < {now} - $1")).bind(kept_ms);
        Ok(gone.execute(&self.pool).await?.rows_affected())
    }

    /// Jobs in each state.
    ///
    /// # Errors
    /// The database does not answer.
    pub async fn counts(&self) -> Result<Vec<(String, i64)>> {
        let rows = sqlx::query("SELECT state, COUNT(*) FROM jobs GROUP BY state").fetch_all(&self.pool).await?;
        rows.iter().map(|row| Ok((row.try_get(0)?, row.try_get(1)?))).collect()
    }
}

/// What an earlier request of the same owner with the same key has become.
async fn earlier(
    connection: &mut sqlx::AnyConnection,
    owner: &str,
    key: Option<&str>,
    fingerprint: &str,
) -> Result<Option<Submitted>> {
    let Some(key) = key else { return Ok(None) };
    let earlier = sqlx::query("SELECT fingerprint, job FROM idempotency WHERE owner = $1 AND key = $2").bind(owner).bind(key);
    let Some(row) = earlier.fetch_optional(connection).await? else { return Ok(None) };
    let is_same = row.try_get::<String, _>(0)? == fingerprint;
    Ok(Some(if is_same { Submitted::Again(row.try_get(1)?) } else { Submitted::KeyTaken }))
}

/// Turn of an owner's next job: the one after that of his last, and not before the latest that anybody had, so that owners take
/// turns and one who comes late does not make up for it (start-time fair queueing: Goyal, Vin and Cheng, 1996).
async fn turn(connection: &mut sqlx::AnyConnection, owner: &str) -> Result<i64> {
    let row = sqlx::query(
        "SELECT (SELECT MAX(turn) FROM jobs WHERE owner = $1 AND state = 'queued'),
                (SELECT turn FROM turns WHERE owner = $1), (SELECT MAX(turn) FROM turns)",
    );
    let row = row.bind(owner).fetch_one(connection).await?;
    let number = |column: usize| row.try_get::<Option<i64>, _>(column);
    let own = number(0)?.max(number(1)?);
    Ok(own.map_or(0, |own| own + 1).max(number(2)?.unwrap_or(0)))
}

/// A row of [`COLUMNS`].
fn job_of(row: &AnyRow) -> Result<Job> {
    let name = |column: &str| -> Result<String> { row.try_get(column) };
    let moment = |column: &str| -> Result<Option<String>> { Ok(row.try_get::<Option<i64>, _>(column)?.map(time)) };
    let unknown = |column: &str| sqlx::Error::Decode(format!("unknown {column}").into());
    // What this program wrote as JSON reads back; what a later version wrote is left out.
    fn object<T: serde::de::DeserializeOwned>(row: &AnyRow, column: &str) -> Result<Option<T>> {
        Ok(row.try_get::<Option<String>, _>(column)?.and_then(|text| serde_json::from_str(&text).ok()))
    }
    Ok(Job {
        id: name("id")?,
        kind: name("kind")?.parse().map_err(|()| unknown("kind"))?,
        name: name("name")?,
        state: name("state")?.parse().map_err(|()| unknown("state"))?,
        owner: name("owner")?,
        created: time(row.try_get("created_ms")?),
        started: moment("started_ms")?,
        finished: moment("finished_ms")?,
        attempts: row.try_get("fence")?,
        cancel_asked: row.try_get::<i64, _>("cancel_asked")? != 0,
        position: None,
        progress: object(row, "progress")?,
        problem: object(row, "problem")?,
        summary: object(row, "summary")?,
        calibration: row.try_get("calibration")?,
        revision: row.try_get("revision")?,
    })
}
