//! Files of jobs, in parts: no reader holds more than one at a time. Tokens, of which only hashes are kept.

use std::path::Path;

use serde::Serialize;
use sha2::{Digest, Sha256};
use sqlx::Row;
use utoipa::ToSchema;

use super::{Result, Store};

/// Bytes of a part.
pub const PART: usize = 256 << 10;

/// What is said of a file.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct FileEntry {
    /// Its name.
    pub name: String,
    /// What it is.
    pub media_type: String,
    /// Its size.
    pub bytes: i64,
}

/// Whose a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// It came with the job.
    Input,
    /// The job made it.
    Result,
}

impl Origin {
    /// As the database calls it.
    fn name(self) -> &'static str {
        match self {
            Origin::Input => "input",
            Origin::Result => "result",
        }
    }
}

/// What a file of this name is.
pub fn media_type(name: &str) -> String {
    match Path::new(name).extension().and_then(|extension| extension.to_str()) {
        // Not registered, so not guessed.
        Some("parquet") => "application/vnd.apache.parquet".to_owned(),
        Some("toml") => "application/toml".to_owned(),
        _ => mime_guess::from_path(name).first_or_octet_stream().to_string(),
    }
}

impl Store {
    /// Files of a job, by name.
    pub async fn file_entries(&self, job: &str, origin: Origin) -> Result<Vec<FileEntry>> {
        let rows = sqlx::query("SELECT name, media_type, size FROM job_files WHERE job = $1 AND origin = $2 ORDER BY name")
            .bind(job)
            .bind(origin.name());
        rows.fetch_all(&self.pool).await?.iter().map(entry).collect()
    }

    /// A file of a job, and its first part.
    pub async fn open_file(&self, job: &str, origin: Origin, name: &str) -> Result<Option<(FileEntry, Vec<u8>)>> {
        let row = sqlx::query(
            "SELECT f.name, f.media_type, f.size, p.content FROM job_files f
             JOIN file_parts p ON p.job = f.job AND p.origin = f.origin AND p.name = f.name AND p.number = 0
             WHERE f.job = $1 AND f.origin = $2 AND f.name = $3",
        );
        let row = row.bind(job).bind(origin.name()).bind(name).fetch_optional(&self.pool).await?;
        row.map(|row| Ok((entry(&row)?, row.try_get(3)?))).transpose()
    }

    /// A part of a file of a job; `None` behind the last.
    pub async fn file_part(&self, job: &str, origin: Origin, name: &str, number: i64) -> Result<Option<Vec<u8>>> {
        bound!(sqlx::query_scalar("SELECT content FROM file_parts WHERE job = $1 AND origin = $2 AND name = $3 AND number = $4");
            job, origin.name(), name, number)
        .fetch_optional(&self.pool)
        .await
    }

    /// A whole file of a job.
    pub async fn whole_file(&self, job: &str, origin: Origin, name: &str) -> Result<Option<Vec<u8>>> {
        let Some((entry, mut content)) = self.open_file(job, origin, name).await? else { return Ok(None) };
        let mut number = 1;
        while (content.len() as i64) < entry.bytes {
            // Deleted meanwhile, so as good as never there.
            let Some(part) = self.file_part(job, origin, name, number).await? else { return Ok(None) };
            content.extend(part);
            number += 1;
        }
        Ok(Some(content))
    }
}

/// Stores a file of a job.
pub(super) async fn add(
    transaction: &mut sqlx::Transaction<'static, sqlx::Any>,
    job: &str,
    origin: Origin,
    name: &str,
    content: &[u8],
) -> Result<()> {
    run!(&mut **transaction, "INSERT INTO job_files (job, origin, name, media_type, size) VALUES ($1, $2, $3, $4, $5)";
        job, origin.name(), name, media_type(name), content.len() as i64)?;
    // In one statement, which the database takes apart: a result has a hundred parts. An empty file has one as well, so that every
    // file opens alike.
    let last = content.len().saturating_sub(1) / PART;
    let statement = format!(
        "INSERT INTO file_parts (job, origin, name, number, content)
         WITH RECURSIVE numbers(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM numbers WHERE i < $5)
         SELECT $1, $2, $3, i, COALESCE(substr($4, i * {PART} + 1, {PART}), $4) FROM numbers"
    );
    run!(&mut **transaction, sqlx::AssertSqlSafe(statement); job, origin.name(), name, content, last as i64)?;
    Ok(())
}

/// A row of name, media type and size.
fn entry(row: &sqlx::any::AnyRow) -> Result<FileEntry> {
    Ok(FileEntry { name: row.try_get(0)?, media_type: row.try_get(1)?, bytes: row.try_get(2)? })
}

perilife_base::kinds! {
    /// What the holder of a token may do; each role may do what the ones before it may.
    #[derive(PartialOrd, Ord, ToSchema, clap::ValueEnum)]
    #[schema(rename_all = "snake_case")]
    pub enum Role for "role" {
        Read = "read": "Look at everything.",
        Run = "run": "Submit jobs, and cancel and delete his own.",
        Admin = "admin": "Cancel and delete those of others.",
    }
}

/// A token as it is kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Token {
    /// Whose it is.
    pub name: String,
    pub role: Role,
    /// When it was made, milliseconds since 1970.
    pub created_ms: i64,
    /// When it ends.
    pub expires_ms: Option<i64>,
}

/// Random bytes of a token: 256 bits, which nobody guesses, so that a plain hash of it can be kept.
const RANDOM_BYTES: usize = 32;
/// What every token begins with, so that one that leaked is recognised as such.
const PREFIX: &str = "perilife_";

/// What is kept of a token.
pub fn hash(secret: &str) -> String {
    hex(&Sha256::digest(secret.as_bytes()))
}

/// Bytes as hexadecimal digits.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

impl Store {
    /// Makes a token and returns it; it is not kept and cannot be had again. `None` if there is one of this name already.
    pub async fn add_token(&self, name: &str, role: Role, days: Option<u32>) -> Result<Option<String>> {
        let mut random = [0; RANDOM_BYTES];
        getrandom::fill(&mut random).map_err(|error| sqlx::Error::Io(std::io::Error::other(error.to_string())))?;
        let secret = format!("{PREFIX}{}", hex(&random));
        let added = run!(&self.pool, self.sql(
            "INSERT INTO tokens (hash, name, role, created_ms, expires_ms) VALUES ($1, $2, $3, {now}, {now} + $4)
             ON CONFLICT DO NOTHING",
        ); hash(&secret), name, role.name(), days.map(|days| i64::from(days) * 86_400_000))?;
        Ok((added.rows_affected() > 0).then_some(secret))
    }

    /// The token with this hash, if it has not ended.
    pub async fn token(&self, hash: &str) -> Result<Option<Token>> {
        let statement = "SELECT name, role, created_ms, expires_ms FROM tokens
                         WHERE hash = $1 AND (expires_ms IS NULL OR expires_ms > {now})";
        let row = sqlx::query(self.sql(statement)).bind(hash).fetch_optional(&self.pool).await?;
        row.map(|row| token_of(&row)).transpose()
    }

    /// All tokens, by name.
    pub async fn tokens(&self) -> Result<Vec<Token>> {
        let rows = sqlx::query("SELECT name, role, created_ms, expires_ms FROM tokens ORDER BY name");
        rows.fetch_all(&self.pool).await?.iter().map(token_of).collect()
    }

    /// Removes a token; whether there was one of this name.
    pub async fn remove_token(&self, name: &str) -> Result<bool> {
        Ok(sqlx::query("DELETE FROM tokens WHERE name = $1").bind(name).execute(&self.pool).await?.rows_affected() > 0)
    }
}

fn token_of(row: &sqlx::any::AnyRow) -> Result<Token> {
    let role: String = row.try_get(1)?;
    Ok(Token {
        name: row.try_get(0)?,
        role: role.parse().map_err(|_| sqlx::Error::Decode("unknown role".into()))?,
        created_ms: row.try_get(2)?,
        expires_ms: row.try_get(3)?,
    })
}
