//! Who may ask for what: tokens, of which only hashes are kept.

use sha2::{Digest, Sha256};
use sqlx::Row;
use utoipa::ToSchema;

use super::{Result, Store};

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
    /// What he may do.
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
