//! Jobs as workers see them: claimed for a time, kept alive, written to by who holds the claim, finished once.

use std::path::PathBuf;
use std::time::Duration;

use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use sqlx::Row;

use super::{FileEntry, Origin, Result, Store, files, schema};
use crate::job::{JobKind, State, Submission};
use crate::problem::Problem;

/// A job that a worker holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    pub id: String,
    pub kind: JobKind,
    /// Number of the claim; every writing names it.
    pub fence: i64,
    /// Claims since it began or since its last checkpoint, this one among them.
    pub attempts: i64,
    /// Somebody asked for its end already.
    pub cancel_asked: bool,
    /// Ends so far that were not the job's fault.
    pub failures: i64,
    /// Computing time of earlier claims, ms.
    pub spent_ms: i64,
    /// Time from its submission to its first worker, ms.
    pub waited_ms: i64,
}

/// Longest time for which a job that was put back waits.
const LONGEST_WAIT: Duration = Duration::from_secs(300);

/// Waiting time of another owner's job after which a run gives way.
const PATIENT: Duration = Duration::from_millis(500);

/// Time for which a run goes on while others wait, where its owner has other workers' turns to give.
const HELD: Duration = Duration::from_secs(120);

/// Computing time that counts as a turn where a run has given way.
const TURN: Duration = Duration::from_secs(10);

/// Wishes for the end of a job: without a result, and with the curve so far.
pub(super) const CANCEL: i64 = 1;
pub(super) const KEEP: i64 = 2;

/// What a sign of life brings back.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Heartbeat {
    Held,
    /// Somebody asks for the end of the job.
    Cancel,
    /// Somebody asks for its end with the curve so far.
    Keep,
    /// The job is another worker's now, or gone.
    Lost,
}

/// A file of a result, where its worker has it on disk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ResultFile {
    pub name: String,
    pub path: PathBuf,
}

/// What became of the end of a job: it is stored, the claim does not hold any more, or with its results the owner's jobs would have so
/// many bytes, more than they may.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "said above")]
pub enum Finish {
    Stored,
    Lost,
    SpaceFull(i64),
}

#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    pub state: State,
    /// The figures of its result, JSON.
    pub summary: Option<String>,
    /// Why there is none, JSON.
    pub problem: Option<String>,
    pub files: Vec<ResultFile>,
}

/// A piece of a growing curve.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Growth {
    /// Number of the first entry; 0 starts over.
    pub from: usize,
    pub cycles: Vec<f64>,
    pub crack_length_mm: Vec<f64>,
    /// Position of every tip, mm.
    pub tips: Vec<Vec<[f64; 2]>>,
}

/// What a run has told since its last sign of life.
#[derive(Debug, Clone, Default)]
pub struct Told {
    /// How far it is, JSON.
    pub progress: Option<String>,
    pub growth: Option<Growth>,
    /// What is said of a picture, JSON, and its PNG.
    pub picture: Option<(String, Vec<u8>)>,
}

impl Store {
    /// A job whose worker has given no sign of life for as long as it was granted, or else the next that waits. While others wait an owner
    /// has all but one of the `workers` of a process; where several may submit, runs that cannot give way leave it to them in any case.
    pub async fn claim(&self, worker: &str, workers: usize, lease_ms: i64) -> Result<Option<Claim>> {
        // Within a transaction, since only its end tells that the claim has got to the disk.
        let mut transaction = self.begin().await?;
        schema::expect(&mut transaction).await?;
        // Asked again by the statement itself: tables may have been led on between the two.
        let row = bound!(sqlx::query(self.sql(
            "UPDATE jobs SET state = 'running', worker = $1, fence = fence + 1, attempts = attempts + 1,
                lease_until_ms = {now} + $2, lease_ms = $2, started_ms = COALESCE(started_ms, {now}), not_before_ms = NULL,
                revision = revision + 1
             WHERE id = COALESCE(
                (SELECT id FROM jobs WHERE state = 'running' AND {orphaned} ORDER BY turn, id LIMIT 1 {skip_locked}),
                (SELECT id FROM jobs WHERE {waits} AND owner NOT IN
                    (SELECT owner FROM jobs WHERE state = 'running' AND worker = $1 GROUP BY owner HAVING COUNT(*) >= $4)
                 ORDER BY turn, id LIMIT 1 {skip_locked}),
                (SELECT id FROM jobs WHERE {waits}
                    AND (kind = 'prediction' OR (SELECT COUNT(*) FROM tokens WHERE role <> 'read') < 2)
                 ORDER BY turn, id LIMIT 1 {skip_locked}))
                AND (SELECT MAX(version) FROM perilife_schema) = $5
             RETURNING id, kind, fence, attempts, cancel_asked, owner, turn, failures, spent_ms, started_ms - created_ms AS waited_ms",
        )); worker, lease_ms, LONGEST_WAIT.as_millis() as i64, workers.saturating_sub(1).max(1) as i64, schema::VERSION)
        .fetch_optional(&mut *transaction)
        .await?;
        let Some(row) = row else { return Ok(None) };
        // One taken up again had its turn long ago.
        bound!(sqlx::query(
            "INSERT INTO turns (owner, turn) VALUES ($1, $2) ON CONFLICT (owner) DO UPDATE
                SET turn = CASE WHEN turns.turn < excluded.turn THEN excluded.turn ELSE turns.turn END",
        ); row.try_get::<String, _>("owner")?, row.try_get::<i64, _>("turn")?)
        .execute(&mut *transaction)
        .await?;
        let (id, kind): (String, String) = (row.try_get("id")?, row.try_get("kind")?);
        let Ok(kind) = kind.parse() else {
            // Of an earlier version: ended, or it would come up for ever.
            let detail = format!("jobs of kind {kind} are not run any more; run `perilife {kind}` on a command line");
            let problem = serde_json::to_string(&Problem::new(StatusCode::GONE, "Gone", detail)).unwrap_or_default();
            let ended = "UPDATE jobs SET state = 'failed', problem = $2, finished_ms = {now}, finished_count_ms = {counted},
                worker = NULL, lease_until_ms = NULL, revision = revision + 1 WHERE id = $1";
            sqlx::query(self.sql(ended)).bind(id).bind(problem).execute(&mut *transaction).await?;
            transaction.commit().await?;
            return Ok(None);
        };
        transaction.commit().await?;
        Ok(Some(Claim {
            id,
            kind,
            fence: row.try_get("fence")?,
            attempts: row.try_get("attempts")?,
            cancel_asked: row.try_get::<i64, _>("cancel_asked")? == CANCEL,
            failures: row.try_get("failures")?,
            spent_ms: row.try_get("spent_ms")?,
            waited_ms: row.try_get("waited_ms")?,
        }))
    }

    /// What a claimed job is about, and where it stood.
    /// Errors: the database does not answer, or what stands there cannot be read.
    pub async fn content(&self, claim: &Claim) -> Result<(Option<Submission>, Option<Vec<u8>>)> {
        let checkpoint = sqlx::query_scalar("SELECT content FROM checkpoints WHERE job = $1").bind(&claim.id);
        let Some(mut submission) = self.submission(&claim.id).await? else { return Ok((None, None)) };
        for FileEntry { name, .. } in self.file_entries(&claim.id, Origin::Input).await? {
            // Deleted meanwhile, with the job.
            let Some(content) = self.whole_file(&claim.id, Origin::Input, &name).await? else { return Ok((None, None)) };
            submission.files.push((name, content));
        }
        Ok((Some(submission), checkpoint.fetch_optional(&self.pool).await?))
    }

    /// A sign of life: the claim holds on for `lease_ms` and has taken so long so far. What the run told goes with it, in one transaction,
    /// since each takes the disk of the database to its end.
    /// Errors: the database does not answer, and has stored nothing; the claim may still hold.
    pub async fn beat(&self, claim: &Claim, lease_ms: i64, elapsed: Duration, told: &Told) -> Result<Heartbeat> {
        let mut transaction = self.begin().await?;
        let is_more = told.growth.is_some() || told.picture.is_some();
        let asked: Option<i64> = bound!(sqlx::query_scalar(self.sql(
            "UPDATE jobs SET lease_until_ms = {now} + $3, lease_ms = $3, spent_ms = $5,
                revision = revision + CASE WHEN $6 = 0 AND ($4 IS NULL OR $4 = progress) THEN 0 ELSE 1 END,
                progress = COALESCE($4, progress)
             WHERE id = $1 AND fence = $2 AND state = 'running' RETURNING cancel_asked",
        )); &claim.id, claim.fence, lease_ms, &told.progress, claim.spent_ms + elapsed.as_millis() as i64, i64::from(is_more))
        .fetch_optional(&mut *transaction)
        .await?;
        let Some(asked) = asked else { return Ok(Heartbeat::Lost) };
        if let Some(growth) = &told.growth {
            grow(&mut transaction, claim, growth).await?;
        }
        if let Some((about, picture)) = &told.picture {
            run!(&mut *transaction, "INSERT INTO pictures (job, revision, about, content) VALUES ($1, 1, $2, $3) ON CONFLICT (job) DO UPDATE
                    SET revision = pictures.revision + 1, about = excluded.about, content = excluded.content";
                        &claim.id, about, &picture[..])?;
        }
        transaction.commit().await?;
        Ok(match asked {
            0 => Heartbeat::Held,
            KEEP => Heartbeat::Keep,
            _ => Heartbeat::Cancel,
        })
    }

    /// Stores the state of a job, from which any worker can go on. Whether the claim still holds.
    /// Errors: the database cannot take it; what stood there before stays.
    pub async fn keep(&self, claim: &Claim, checkpoint: Vec<u8>) -> Result<bool> {
        let mut transaction = self.begin().await?;
        // Others cannot take the row until the transaction ends.
        let held = run!(&mut *transaction, "UPDATE jobs SET attempts = 0 WHERE id = $1 AND fence = $2 AND state = 'running'";
            &claim.id, claim.fence)?;
        if held.rows_affected() == 0 {
            return Ok(false);
        }
        run!(&mut *transaction, "INSERT INTO checkpoints (job, content) VALUES ($1, $2) ON CONFLICT (job) DO UPDATE SET content = excluded.content";
            &claim.id, checkpoint)?;
        let counted = self.sql("UPDATE jobs SET bytes = room + {stored} WHERE id = $1");
        sqlx::query(counted).bind(&claim.id).execute(&mut *transaction).await?;
        transaction.commit().await?;
        Ok(true)
    }

    /// Pieces of the growing curve of a job from entry `from` on, of one claim or of all.
    pub async fn growth(&self, id: &str, from: i64, fence: Option<i64>) -> Result<Vec<Growth>> {
        let pieces: Vec<String> = bound!(sqlx::query_scalar(
            "SELECT entries FROM growth WHERE job = $1 AND first >= $2 AND ($3 < 0 OR fence = $3) ORDER BY first",
        ); id, from, fence.unwrap_or(-1))
        .fetch_all(&self.pool)
        .await?;
        Ok(pieces.iter().filter_map(|piece| serde_json::from_str(piece).ok()).collect())
    }

    /// Number of the latest picture of a job, and what is said of it.
    pub async fn picture_about(&self, id: &str) -> Result<Option<(i64, String)>> {
        let row = sqlx::query("SELECT revision, about FROM pictures WHERE job = $1").bind(id).fetch_optional(&self.pool).await?;
        row.map(|row| Ok((row.try_get(0)?, row.try_get(1)?))).transpose()
    }

    pub async fn picture(&self, id: &str) -> Result<Option<Vec<u8>>> {
        sqlx::query_scalar("SELECT content FROM pictures WHERE job = $1").bind(id).fetch_optional(&self.pool).await
    }

    /// Ends a job with its results, all or nothing, if the claim still holds and the owner has room for them.
    /// Errors: the database cannot take it; the job then runs on as far as it is concerned.
    pub async fn finish(&self, claim: &Claim, outcome: &Outcome) -> Result<Finish> {
        let mut transaction = self.begin().await?;
        let changed = run!(&mut *transaction, self.sql(
            "UPDATE jobs SET state = $3, summary = $4, problem = $5, finished_ms = {now}, finished_count_ms = {counted}, worker = NULL, lease_until_ms = NULL,
                revision = revision + 1
             WHERE id = $1 AND fence = $2 AND state = 'running'",
        ); &claim.id, claim.fence, outcome.state.name(), &outcome.summary, &outcome.problem)?;
        if changed.rows_affected() == 0 {
            return Ok(Finish::Lost);
        }
        for ResultFile { name, path } in &outcome.files {
            // One at a time in memory.
            let content = tokio::fs::read(path).await?;
            files::add(&mut transaction, &claim.id, Origin::Result, name, &content).await?;
        }
        self.settle(&mut transaction, &claim.id).await?;
        if outcome.state == State::Succeeded {
            let over = sqlx::query_scalar(
                "SELECT bytes FROM stored WHERE bytes > most AND owner = (SELECT owner FROM jobs WHERE id = $1)",
            );
            if let Some(bytes) = over.bind(&claim.id).fetch_optional(&mut *transaction).await? {
                return Ok(Finish::SpaceFull(bytes));
            }
        }
        transaction.commit().await?;
        Ok(Finish::Stored)
    }

    /// Gives a job that was held for so long back to the queue, behind those of others, if one of an owner waits who has nothing running,
    /// and this job's owner has all `workers` of its process, or it was held for long enough. Whether it did: it must have been kept.
    pub async fn give_way(&self, claim: &Claim, workers: usize, held: Duration) -> Result<bool> {
        let changed = run!(&self.pool, self.sql(
            "UPDATE jobs SET state = 'queued', worker = NULL, lease_until_ms = NULL, revision = revision + 1,
                turn = $3 + (SELECT MAX(turn) FROM turns)
             WHERE id = $1 AND fence = $2 AND state = 'running'
                AND ($4 = 1 OR $5 <= (SELECT COUNT(*) FROM jobs own
                    WHERE own.state = 'running' AND own.worker = jobs.worker AND own.owner = jobs.owner))
                AND EXISTS (SELECT 1 FROM jobs other WHERE other.state = 'queued' AND other.owner <> jobs.owner
                    AND COALESCE(other.not_before_ms, other.created_ms) < {now} - $6
                    AND other.owner NOT IN (SELECT owner FROM jobs WHERE state = 'running'))",
        ); &claim.id, claim.fence, 1 + (held.as_secs() / TURN.as_secs()) as i64, i64::from(held >= HELD), workers.max(2) as i64,
            PATIENT.as_millis() as i64)?;
        Ok(changed.rows_affected() > 0)
    }

    /// Gives a job back to the queue, not counted as having been tried: it is not to blame.
    /// Errors: the database does not answer; the job goes on elsewhere once its time has run out.
    pub async fn release(&self, claim: &Claim) -> Result<()> {
        self.requeue(claim, "attempts = CASE WHEN attempts > 0 THEN attempts - 1 ELSE 0 END", 0, None).await
    }

    /// Gives a job back to the queue after an end that was not its fault, which is counted; nobody takes it before `wait` is over.
    pub async fn put_back(&self, claim: &Claim, wait: Duration, reason: &str) -> Result<()> {
        let wait = wait.min(LONGEST_WAIT).as_millis() as i64;
        self.requeue(claim, "failures = failures + 1, not_before_ms = {now} + $3", wait, Some(reason)).await
    }

    async fn requeue(&self, claim: &Claim, change: &str, wait_ms: i64, reason: Option<&str>) -> Result<()> {
        let statement = format!(
            "UPDATE jobs SET state = 'queued', worker = NULL, lease_until_ms = NULL, revision = revision + 1,
                reason = CASE WHEN $3 > 0 THEN $4 ELSE reason END, {change}
             WHERE id = $1 AND fence = $2 AND state = 'running'"
        );
        run!(&self.pool, self.sql(&statement); &claim.id, claim.fence, wait_ms, reason).map(drop)
    }
}

/// Puts a piece behind the growing curve of a job; a piece from 0 replaces all.
async fn grow(transaction: &mut sqlx::Transaction<'static, sqlx::Any>, claim: &Claim, growth: &Growth) -> Result<()> {
    if growth.from == 0 {
        sqlx::query("DELETE FROM growth WHERE job = $1").bind(&claim.id).execute(&mut **transaction).await?;
    }
    run!(&mut **transaction, "INSERT INTO growth (job, first, fence, entries) VALUES ($1, $2, $3, $4)
         ON CONFLICT (job, first) DO UPDATE SET fence = excluded.fence, entries = excluded.entries";
             &claim.id, growth.from as i64, claim.fence, serde_json::to_string(growth).unwrap_or_default())
    .map(drop)
}
