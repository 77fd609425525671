//! Files of finished jobs.

use std::path::Path;

use serde::Serialize;
use sqlx::Row;
use utoipa::ToSchema;

use super::{Result, Store};

/// A file of a finished job.
#[derive(Debug, Clone, PartialEq)]
pub struct File {
    /// Its name.
    pub name: String,
    /// What it is.
    pub media_type: String,
    /// Its bytes.
    pub content: Vec<u8>,
}

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

/// What a file of this name is.
#[must_use]
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
    ///
    /// # Errors
    /// The database does not answer.
    pub async fn file_entries(&self, job: &str) -> Result<Vec<FileEntry>> {
        let rows = sqlx::query("SELECT name, media_type, size FROM files WHERE job = $1 ORDER BY name").bind(job);
        let entry = |row: &sqlx::any::AnyRow| {
            Ok(FileEntry { name: row.try_get(0)?, media_type: row.try_get(1)?, bytes: row.try_get(2)? })
        };
        rows.fetch_all(&self.pool).await?.iter().map(entry).collect()
    }

    /// A file of a job.
    ///
    /// # Errors
    /// The database does not answer.
    pub async fn file(&self, job: &str, name: &str) -> Result<Option<File>> {
        let row = sqlx::query("SELECT name, media_type, content FROM files WHERE job = $1 AND name = $2").bind(job).bind(name);
        let file =
            |row: sqlx::any::AnyRow| Ok(File { name: row.try_get(0)?, media_type: row.try_get(1)?, content: row.try_get(2)? });
        row.fetch_optional(&self.pool).await?.map(file).transpose()
    }
}
