//! What the service remembers: jobs, their input, state and results, in SQLite (one file) or PostgreSQL (many machines) by the
//! same statements.
//!
//! The store is the only place in which a job exists: nothing of it stands in files, and no name from outside becomes a path.
//! Times are those of the database, so that machines need not agree on theirs.

mod files;
mod jobs;
mod queue;
mod schema;
mod tokens;

use std::path::Path;
use std::time::{Duration, Instant};

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_encode};
use sqlx::any::AnyPoolOptions;
use sqlx::{AnyConnection, AnyPool, Connection};

pub use files::{File, FileEntry, Origin, PART, media_type};
pub use jobs::{Listing, NewJob, Submitted};
pub use queue::{Claim, Growth, Heartbeat, Outcome};
pub use tokens::{Role, Token, hash, hex};

/// What a statement can fail with; see [`is_gone`].
pub type Result<T> = std::result::Result<T, sqlx::Error>;

/// Time a statement waits for a free connection, and a SQLite writer for another.
const PATIENCE: Duration = Duration::from_secs(5);

/// Time between two looks for a database that is not there yet.
const LOOK_EVERY: Duration = Duration::from_millis(250);

/// The database.
#[derive(Debug, Clone)]
pub struct Store {
    pool: AnyPool,
    dialect: Dialect,
}

/// In what the statements differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Dialect {
    Sqlite,
    Postgres,
}

impl Dialect {
    /// Milliseconds since 1970 by the clock of the database.
    fn now(self) -> &'static str {
        match self {
            Dialect::Sqlite => "CAST(unixepoch('subsec') * 1000 AS INTEGER)",
            Dialect::Postgres => "CAST(extract(epoch FROM clock_timestamp()) * 1000 AS BIGINT)",
        }
    }

    /// Passes over rows that another transaction is about to take. SQLite has one writer at a time.
    fn skip_locked(self) -> &'static str {
        match self {
            Dialect::Sqlite => "",
            Dialect::Postgres => "FOR UPDATE SKIP LOCKED",
        }
    }

    /// Type of bytes.
    fn bytes(self) -> &'static str {
        match self {
            Dialect::Sqlite => "BLOB",
            Dialect::Postgres => "BYTEA",
        }
    }

    /// Type of ids and names that are compared: by bytes, whatever the language of the server.
    fn key(self) -> &'static str {
        match self {
            Dialect::Sqlite => "TEXT",
            Dialect::Postgres => "TEXT COLLATE \"C\"",
        }
    }

    /// Begins a transaction that writes: SQLite must know before it reads, or two could wait for each other.
    fn begin(self) -> &'static str {
        match self {
            Dialect::Sqlite => "BEGIN IMMEDIATE",
            Dialect::Postgres => "BEGIN",
        }
    }
}

/// URL of the database file of a data folder.
#[must_use]
pub fn url_of_file(path: &Path) -> String {
    const IN_FILES: AsciiSet = NON_ALPHANUMERIC.remove(b'/');
    format!("sqlite://{}?mode=rwc", percent_encode(path.as_os_str().as_encoded_bytes(), &IN_FILES))
}

/// Connects once without a pool, which would only say that its time is over. A database that is on its way up is waited for; the first
/// error is the one that says what is wrong.
async fn first_look(url: &str, dialect: Dialect) -> Result<()> {
    let look = async || -> Result<()> {
        let mut connection = AnyConnection::connect(url).await?;
        // SQLite reads nothing of its file before it is asked something.
        let question = if dialect == Dialect::Sqlite { "PRAGMA schema_version" } else { "SELECT 1" };
        sqlx::raw_sql(question).execute(&mut connection).await?;
        connection.close().await
    };
    let (begun, mut first) = (Instant::now(), None);
    loop {
        match look().await {
            Err(error) if is_gone(&error) && begun.elapsed() < PATIENCE => {
                first.get_or_insert(error);
                tokio::time::sleep(LOOK_EVERY).await;
            }
            Err(error) => return Err(first.unwrap_or(error)),
            Ok(()) => return Ok(()),
        }
    }
}

impl Store {
    /// Connects to `sqlite://FILE` or `postgres://...` and lays the tables in a new database.
    ///
    /// # Errors
    /// Another kind of URL; a database that cannot be reached or was made by another version of this program.
    pub async fn open(url: &str, connections: u32) -> Result<Store> {
        sqlx::any::install_default_drivers();
        let dialect = match url.split(':').next() {
            Some("sqlite") => Dialect::Sqlite,
            Some("postgres" | "postgresql") => Dialect::Postgres,
            _ => return Err(sqlx::Error::Configuration("the URL must begin with sqlite:// or postgres://".into())),
        };
        first_look(url, dialect).await?;
        let pool = AnyPoolOptions::new()
            .max_connections(connections)
            .acquire_timeout(PATIENCE)
            .after_connect(move |connection, _| {
                Box::pin(async move {
                    let patience = PATIENCE.as_millis();
                    let settings = match dialect {
                        // Readers and the writer do not wait for each other; what was committed outlives a loss of power.
                        Dialect::Sqlite => {
                            format!("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA busy_timeout = {patience};")
                        }
                        // A process that stands still in the middle of a transaction would keep others from its job for as long as
                        // its connection seems to be there.
                        Dialect::Postgres => format!("SET idle_in_transaction_session_timeout = {patience};"),
                    };
                    sqlx::raw_sql(sqlx::AssertSqlSafe(settings)).execute(connection).await.map(drop)
                })
            })
            .before_acquire(|connection, _| {
                // SQLite ends a transaction by itself when the disk is full; the driver, which would end it once more, fails at that
                // and takes the connection for busy ever after. Such a one is thrown away.
                let is_free = !connection.is_in_transaction();
                Box::pin(async move { Ok(is_free) })
            })
            .connect(url)
            .await?;
        let store = Store { pool, dialect };
        store.lay_tables().await?;
        Ok(store)
    }

    /// Whether the database answers.
    ///
    /// # Errors
    /// It does not.
    pub async fn ping(&self) -> Result<()> {
        sqlx::query("SELECT 1").execute(&self.pool).await.map(drop)
    }

    /// Closes all connections.
    pub async fn close(&self) {
        self.pool.close().await;
    }

    /// A statement with the fragments of this database filled in: `{now}`, `{skip_locked}`, `{bytes}`, `{key}`.
    fn sql(&self, statement: &str) -> sqlx::AssertSqlSafe<String> {
        let dialect = self.dialect;
        let filled = statement
            .replace("{now}", dialect.now())
            .replace("{skip_locked}", dialect.skip_locked())
            .replace("{bytes}", dialect.bytes())
            .replace("{key}", dialect.key());
        sqlx::AssertSqlSafe(filled)
    }

    /// A transaction that writes.
    async fn begin(&self) -> Result<sqlx::Transaction<'static, sqlx::Any>> {
        self.pool.begin_with(self.dialect.begin()).await
    }
}

/// Whether a statement failed because there is no connection, not because of what was asked: worth another try on a new one.
#[must_use]
pub fn is_gone(error: &sqlx::Error) -> bool {
    use sqlx::Error as E;
    match error {
        E::Io(_) | E::Tls(_) | E::Protocol(_) | E::PoolTimedOut | E::PoolClosed | E::WorkerCrashed => true,
        // PostgreSQL: connection lost (08), out of room (53), being shut down or not up yet (57), stood still for too long (25P03);
        // SQLite: busy, locked, no memory, read-only, disk error, full, cannot open.
        E::Database(database) => database.code().is_some_and(|code| {
            ["08", "53", "57", "25P03"].iter().any(|class| code.len() == 5 && code.starts_with(class))
                || code.parse::<u32>().is_ok_and(|code| code < 10_000 && [5, 6, 7, 8, 10, 13, 14].contains(&(code & 0xff)))
        }),
        _ => false,
    }
}
