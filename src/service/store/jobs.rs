//! Jobs as those see them who submit, watch, cancel and delete them.

use sqlx::Row;
use sqlx::any::AnyRow;

use super::queue::{CANCEL, KEEP};
use super::{Dialect, Origin, Result, Store, files};
use crate::job::{Job, JobKind, State, Submission, time};

#[derive(Debug, Clone)]
pub struct NewJob<'a> {
    pub kind: JobKind,
    /// Name of the token that submits it.
    pub owner: &'a str,
    pub calibration: Option<&'a str>,
    /// Key by which a repeated request is known.
    pub idempotency_key: Option<&'a str>,
    pub fingerprint: &'a str,
    pub submission: &'a Submission,
    /// Bytes that its run may write.
    pub room: i64,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Submitted {
    New(String),
    /// The job of an earlier request with this key.
    Again(String),
    /// The key was used for another request.
    KeyTaken,
    /// The owner has as many jobs in the queue as he may have.
    QueueFull,
    /// The owner's jobs have so many bytes, and with those of this input they would have more than they may.
    SpaceFull(i64, i64),
}

/// How much of one owner there may be.
#[derive(Debug, Clone, Copy)]
pub struct Room {
    pub queued: i64,
    /// Bytes of all that his jobs have, and of what those that have not ended may write.
    pub bytes: i64,
}

/// Part of a list, newest first.
#[derive(Debug, Clone, Default)]
pub struct Listing {
    pub jobs: Vec<Job>,
    pub next: Option<String>,
}

#[derive(Debug, Clone, Copy, Default)]
pub struct Wanted<'a> {
    /// Of this kind; of all where none is named.
    pub kind: Option<JobKind>,
    pub state: Option<State>,
    /// With this text in name, note or owner; capitals of ASCII count as small letters.
    pub text: &'a str,
    /// Also those that were put away.
    pub archived: bool,
    /// From behind this job on.
    pub after: Option<&'a str>,
    pub limit: u32,
}

/// What is to be said of a job from now on; nothing changes where nothing is given.
#[derive(Debug, Clone, Default)]
pub struct Change {
    pub name: Option<String>,
    pub note: Option<String>,
    /// Report data, JSON.
    pub report: Option<String>,
    pub archived: Option<bool>,
}

const COLUMNS: &str = "id, kind, name, note, report, archived, owner, state, calibration, created_ms, started_ms, finished_ms, cancel_asked, \
                       revision, fence, failures, reason, not_before_ms, progress, problem, summary";

/// Jobs removed at a time because their time is over: a mistake in a clock shows before all is gone.
const EXPIRED_AT_ONCE: i64 = 200;

/// Sorts behind every id.
const BEHIND_ALL: &str = "~";

impl Store {
    /// Stores a job with its input, whole or not at all: once this returns it will be run.
    pub async fn submit(&self, new: &NewJob<'_>, room: Room) -> Result<Submitted> {
        let Submission { name, text, with_fitted, .. } = new.submission;
        // Without failure: text and numbers.
        let content = postcard::to_stdvec(&(name, text, with_fitted)).unwrap_or_default();
        let mut transaction = self.begin().await?;
        if self.dialect == Dialect::Postgres {
            // One of an owner's submissions at a time, or two could both find the last place free. SQLite has one writer anyway.
            run!(&mut *transaction, "SELECT pg_advisory_xact_lock(hashtextextended($1, 0))"; new.owner)?;
        }
        if let Some(earlier) = earlier(&mut transaction, new.owner, new.idempotency_key, new.fingerprint).await? {
            return Ok(earlier);
        }
        let queued =
            sqlx::query_scalar::<_, i64>("SELECT COUNT(*) FROM jobs WHERE state = 'queued' AND owner = $1").bind(new.owner);
        if queued.fetch_one(&mut *transaction).await? >= room.queued {
            return Ok(Submitted::QueueFull);
        }
        let stored = sqlx::query_scalar("SELECT bytes FROM stored WHERE owner = $1").bind(new.owner);
        let stored: i64 = stored.fetch_optional(&mut *transaction).await?.unwrap_or(0);
        let files = new.submission.files.iter().map(|(_, content)| content.len());
        let bytes = (content.len() + files.sum::<usize>()) as i64;
        if stored + bytes > room.bytes {
            return Ok(Submitted::SpaceFull(stored, bytes));
        }
        let turn = turn(&mut transaction, new.owner).await?;
        let id = uuid::Uuid::now_v7().to_string();
        run!(&mut *transaction, self.sql(
            "INSERT INTO jobs (id, kind, name, owner, state, calibration, turn, room, bytes, created_ms)
             VALUES ($1, $2, $3, $4, 'queued', $5, $6, $7, $8, {now})",
        ); &id, new.kind.name(), &new.submission.name, new.owner, new.calibration, turn, new.room, bytes + new.room)?;
        run!(&mut *transaction, "UPDATE stored SET most = $2 WHERE owner = $1"; new.owner, room.bytes)?;
        run!(&mut *transaction, "INSERT INTO submissions (job, content, options) VALUES ($1, $2, $3)";
            &id, content, serde_json::to_string(&new.submission.options).unwrap_or_default())?;
        for (name, content) in &new.submission.files {
            files::add(&mut transaction, &id, Origin::Input, name, content).await?;
        }
        if let Some(key) = new.idempotency_key {
            run!(&mut *transaction, "INSERT INTO idempotency (owner, key, fingerprint, job) VALUES ($1, $2, $3, $4)";
                new.owner, key, new.fingerprint, &id)?;
        }
        transaction.commit().await?;
        Ok(Submitted::New(id))
    }

    /// What an earlier request with this key has become, if there was one.
    pub async fn submitted(&self, owner: &str, key: Option<&str>, fingerprint: &str) -> Result<Option<Submitted>> {
        if key.is_none() {
            return Ok(None);
        }
        earlier(&mut *self.pool.acquire().await?, owner, key, fingerprint).await
    }

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
    pub async fn revision(&self, id: &str) -> Result<Option<i64>> {
        sqlx::query_scalar("SELECT revision FROM jobs WHERE id = $1").bind(id).fetch_optional(&self.pool).await
    }

    pub async fn submission(&self, id: &str) -> Result<Option<Submission>> {
        let row = sqlx::query("SELECT content, options FROM submissions WHERE job = $1").bind(id);
        let Some(row) = row.fetch_optional(&self.pool).await? else { return Ok(None) };
        let content: Vec<u8> = row.try_get(0)?;
        let options: String = row.try_get(1)?;
        let (name, text, with_fitted) = postcard::from_bytes(&content).map_err(|error| sqlx::Error::Decode(error.into()))?;
        let options = serde_json::from_str(&options).map_err(|error| sqlx::Error::Decode(error.into()))?;
        Ok(Some(Submission { name, text, with_fitted, options, files: Vec::new() }))
    }

    /// Jobs, newest first.
    pub async fn list(&self, wanted: Wanted<'_>) -> Result<Listing> {
        let Wanted { kind, state, text, archived, after, limit } = wanted;
        // Jobs of kinds that are not run any more are not shown.
        let wanted_kinds = kind.map_or_else(|| JobKind::ALL.to_vec(), |kind| vec![kind]);
        let kinds: Vec<String> = wanted_kinds.iter().map(|kind| format!("'{kind}'")).collect();
        let kinds = kinds.join(", ");
        let statement = format!(
            "SELECT {COLUMNS} FROM jobs WHERE kind IN ({kinds}) AND id < $1 AND ($3 = '' OR state = $3) AND archived <= $4
                AND ($5 = '%%' OR LOWER(name) LIKE $5 ESCAPE '!' OR LOWER(note) LIKE $5 ESCAPE '!' OR LOWER(owner) LIKE $5 ESCAPE '!')
             ORDER BY id DESC LIMIT $2"
        );
        let mut part = text.to_ascii_lowercase();
        for sign in ["!", "%", "_"] {
            part = part.replace(sign, &format!("!{sign}"));
        }
        // One more than asked for tells whether there are more.
        let rows = bound!(sqlx::query(self.sql(&statement));
            after.unwrap_or(BEHIND_ALL), i64::from(limit) + 1, state.map_or("", State::name), i64::from(archived), format!("%{part}%"))
            .fetch_all(&self.pool)
            .await?;
        let mut jobs: Vec<Job> = rows.iter().map(job_of).collect::<Result<_>>()?;
        let is_more = jobs.len() > limit as usize;
        jobs.truncate(limit as usize);
        let next = jobs.last().filter(|_| is_more).map(|job| job.id.clone());
        Ok(Listing { jobs, next })
    }

    /// Asks for the end of a job: one that waits, or whose worker is silent, ends at once, one that runs with the next sign of life,
    /// with the curve so far where it is to be kept. Whether there was one to end.
    pub async fn cancel(&self, id: &str, is_kept: bool) -> Result<bool> {
        let wish = if is_kept { KEEP } else { CANCEL };
        match self.cancel_once(id, wish).await {
            Err(error) if self.has_given_reserve_up(&error) => self.cancel_once(id, wish).await,
            done => done,
        }
    }

    async fn cancel_once(&self, id: &str, wish: i64) -> Result<bool> {
        let mut transaction = self.begin().await?;
        let state: Option<String> = sqlx::query_scalar(self.sql(
            "UPDATE jobs SET cancel_asked = CASE WHEN cancel_asked = 1 THEN 1 ELSE $2 END, revision = revision + 1,
                finished_ms = CASE WHEN state = 'queued' OR {orphaned} THEN {now} END,
                finished_count_ms = CASE WHEN state = 'queued' OR {orphaned} THEN {counted} END,
                state = CASE WHEN state = 'queued' OR {orphaned} THEN 'cancelled' ELSE state END
             WHERE id = $1 AND state IN ('queued', 'running') RETURNING state",
        ))
        .bind(id)
        .bind(wish)
        .fetch_optional(&mut *transaction)
        .await?;
        if state.as_deref() == Some(State::Cancelled.name()) {
            self.settle(&mut transaction, id).await?;
        }
        transaction.commit().await?;
        Ok(state.is_some())
    }

    /// Removes what only a job on its way needs, and counts what one that has ended keeps.
    pub(super) async fn settle(&self, transaction: &mut sqlx::Transaction<'static, sqlx::Any>, id: &str) -> Result<()> {
        for table in ["checkpoints", "growth", "pictures"] {
            let leftover = sqlx::AssertSqlSafe(format!("DELETE FROM {table} WHERE job = $1"));
            sqlx::query(leftover).bind(id).execute(&mut **transaction).await?;
        }
        let counted = self.sql("UPDATE jobs SET room = 0, bytes = {stored} WHERE id = $1");
        sqlx::query(counted).bind(id).execute(&mut **transaction).await.map(drop)
    }

    /// Says something else of a job from now on; whoever holds it goes on. Whether there was one.
    pub async fn change(&self, id: &str, change: &Change) -> Result<bool> {
        let changed = bound!(sqlx::query(
            "UPDATE jobs SET name = COALESCE($2, name), note = COALESCE($3, note), archived = COALESCE($4, archived),
                report = COALESCE($5, report), revision = revision + 1
             WHERE id = $1",
        ); id, &change.name, &change.note, change.archived.map(i64::from), &change.report)
        .execute(&self.pool)
        .await?;
        Ok(changed.rows_affected() > 0)
    }

    /// Removes a job that no worker has, with all it has. Whether there was one.
    pub async fn delete(&self, id: &str) -> Result<bool> {
        let statement = "DELETE FROM jobs WHERE id = $1 AND (state <> 'running' OR {orphaned})";
        let delete = || sqlx::query(self.sql(statement)).bind(id).execute(&self.pool);
        let gone = match delete().await {
            Err(error) if self.has_given_reserve_up(&error) => delete().await,
            done => done,
        };
        Ok(gone?.rows_affected() > 0)
    }

    /// Removes jobs that ended longer than so many milliseconds of the counted clock ago, the oldest first and only so many at a time;
    /// returns how many.
    pub async fn expire(&self, kept_ms: i64) -> Result<u64> {
        let gone = sqlx::query(self.sql(
            "DELETE FROM jobs WHERE id IN
                (SELECT id FROM jobs WHERE finished_count_ms < {counted} - $1 ORDER BY finished_count_ms LIMIT $2)",
        ));
        Ok(gone.bind(kept_ms).bind(EXPIRED_AT_ONCE).execute(&self.pool).await?.rows_affected())
    }

    /// Time for which the oldest job that waits has waited, ms; 0 if none does.
    pub async fn queue_age_ms(&self) -> Result<i64> {
        let oldest = self.sql("SELECT {now} - COALESCE(MIN(created_ms), {now}) FROM jobs WHERE state = 'queued'");
        sqlx::query_scalar(oldest).fetch_one(&self.pool).await
    }

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

fn job_of(row: &AnyRow) -> Result<Job> {
    let name = |column: &str| -> Result<String> { row.try_get(column) };
    let moment = |column: &str| -> Result<Option<String>> { Ok(row.try_get::<Option<i64>, _>(column)?.map(time)) };
    let unknown = |column: &str| sqlx::Error::Decode(format!("unknown {column}").into());
    // What this program wrote as JSON reads back; what a later version wrote is left out.
    fn object<T: serde::de::DeserializeOwned>(row: &AnyRow, column: &str) -> Result<Option<T>> {
        Ok(row.try_get::<Option<String>, _>(column)?.and_then(|text| serde_json::from_str(&text).ok()))
    }
    let state = name("state")?.parse().map_err(|_| unknown("state"))?;
    Ok(Job {
        id: name("id")?,
        kind: name("kind")?.parse().map_err(|_| unknown("kind"))?,
        name: name("name")?,
        note: name("note")?,
        report: object(row, "report")?,
        archived: row.try_get::<i64, _>("archived")? != 0,
        state,
        owner: name("owner")?,
        created: time(row.try_get("created_ms")?),
        started: moment("started_ms")?,
        finished: moment("finished_ms")?,
        attempts: row.try_get("fence")?,
        failures: row.try_get("failures")?,
        last_failure: row.try_get("reason")?,
        next_try: if state == State::Queued { moment("not_before_ms")? } else { None },
        cancel_asked: row.try_get::<i64, _>("cancel_asked")? == CANCEL,
        position: None,
        progress: object(row, "progress")?,
        problem: object(row, "problem")?,
        summary: object(row, "summary")?,
        calibration: row.try_get("calibration")?,
        revision: row.try_get("revision")?,
    })
}
