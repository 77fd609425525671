//! What the service remembers: jobs, their input, state and results, in SQLite (one file) or PostgreSQL (many machines) by the
//! same statements.
//!
//! The store is the only place in which a job exists: nothing of it stands in files, and no name from outside becomes a path.
//! Times are those of the database, so that machines need not agree on theirs.

/// A statement with the values of its places, in their order.
macro_rules! bound {
    ($query:expr; $($value:expr),+) => { $query$(.bind($value))+ };
}
/// What came of running one.
macro_rules! run {
    ($on:expr, $statement:expr; $($value:expr),+) => { bound!(sqlx::query($statement); $($value),+).execute($on).await };
}

mod files;
mod jobs;
mod queue;
mod schema;

use std::fs::{self, OpenOptions};
use std::io;
use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_encode};
use rustix::fs::{FallocateFlags, fallocate};
use sqlx::any::AnyPoolOptions;
use sqlx::{AnyConnection, AnyPool, Connection};

pub use files::{FileEntry, Origin, PART, Role, Token, hash, hex, media_type};
pub use jobs::{Change, Listing, NewJob, Room, Submitted, Wanted};
pub use queue::{Claim, Finish, Growth, Heartbeat, Outcome, ResultFile, Told};

/// What a statement can fail with; see [`is_gone`].
pub type Result<T> = std::result::Result<T, sqlx::Error>;

/// Time a statement waits for a free connection, and a SQLite writer for another.
const PATIENCE: Duration = Duration::from_secs(5);

/// Time between two looks for a database that is not there yet.
const LOOK_EVERY: Duration = Duration::from_millis(250);

#[derive(Debug, Clone)]
pub struct Store {
    pool: AnyPool,
    dialect: Dialect,
    file: Option<DatabaseFile>,
}

/// In what the statements differ.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Dialect {
    Sqlite,
    Postgres,
}

impl Dialect {
    /// Fragments of statements: milliseconds since 1970 by the clock of the database; what passes over rows that another transaction is
    /// about to take (SQLite has one writer at a time); type of bytes; type of ids and names, compared by bytes whatever the language
    /// of the server.
    fn fragments(self) -> [(&'static str, &'static str); 4] {
        match self {
            Dialect::Sqlite => [
                ("{now}", "CAST(unixepoch('subsec') * 1000 AS INTEGER)"),
                ("{skip_locked}", ""),
                ("{bytes}", "BLOB"),
                ("{key}", "TEXT"),
            ],
            Dialect::Postgres => [
                ("{now}", "CAST(extract(epoch FROM clock_timestamp()) * 1000 AS BIGINT)"),
                ("{skip_locked}", "FOR UPDATE SKIP LOCKED"),
                ("{bytes}", "BYTEA"),
                ("{key}", "TEXT COLLATE \"C\""),
            ],
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
pub fn url_of_file(path: &Path) -> String {
    const IN_FILES: AsciiSet = NON_ALPHANUMERIC.remove(b'/');
    format!("sqlite://{}?mode=rwc", percent_encode(path.as_os_str().as_encoded_bytes(), &IN_FILES))
}

/// Connects once without a pool, which would only say that its time is over. A database that is on its way up is waited for; the first
/// error is the one that says what is wrong.
async fn first_look(url: &str, dialect: Dialect) -> Result<()> {
    let look = async || -> Result<()> {
        let mut connection = AnyConnection::connect(url).await?;
        // SQLite reads nothing of its file before it is asked something. Readers and the writer do not wait for each other; space of
        // what was deleted can be given back. Both stay in the file, where they are said before the first table is laid, and a connection
        // that says them once more would write on a full disk.
        let question = match dialect {
            Dialect::Sqlite => "PRAGMA schema_version; PRAGMA auto_vacuum = INCREMENTAL; PRAGMA journal_mode = WAL",
            Dialect::Postgres => "SELECT 1",
        };
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

/// Longest step of the counted clock: what is longer was a jump of the database's clock, or no service ran.
const COUNTED_STEP: Duration = Duration::from_secs(300);

/// Time since the counted clock was looked at last, within its longest step.
const STEP: &str = "CASE WHEN {now} < seen_ms THEN 0 WHEN {now} - seen_ms > {most} THEN {most} ELSE {now} - seen_ms END";

const STORED: &str = "CAST((SELECT COALESCE(SUM(octet_length(content)), 0) FROM submissions WHERE job = jobs.id)
    + (SELECT COALESCE(SUM(size), 0) FROM job_files WHERE job = jobs.id)
    + (SELECT COALESCE(SUM(octet_length(content)), 0) FROM checkpoints WHERE job = jobs.id)
    + (SELECT COALESCE(SUM(octet_length(entries)), 0) FROM growth WHERE job = jobs.id)
    + (SELECT COALESCE(SUM(octet_length(content)), 0) FROM pictures WHERE job = jobs.id) AS BIGINT)";

/// A running job whose worker is silent: its lease is over, or ends later than any lease granted now could, as after a clock was set
/// back.
const ORPHANED: &str = "(lease_until_ms < {now} OR lease_until_ms > {now} + 2 * lease_ms)";

/// A job that may be taken, unless it was put back for so long, $3, that the clock must have been set back.
const WAITS: &str = "state = 'queued' AND (not_before_ms IS NULL OR not_before_ms <= {now} OR not_before_ms > {now} + $3)";

/// Pages of SQLite given back to the disk at a time, 4 kB each: so that writers do not wait for long.
const GIVEN_BACK: u32 = 16_384;

/// Whether tables of an earlier version are led on to this one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Upgrade {
    /// By the service itself.
    Allowed,
    /// Not by who merely uses its store.
    Refused,
}

impl Store {
    /// Connects to `sqlite://FILE` or `postgres://...` and lays the tables in a new database.
    pub async fn open(url: &str, connections: u32, upgrade: Upgrade) -> Result<Store> {
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
                        // What was committed outlives a loss of power.
                        Dialect::Sqlite => format!("PRAGMA synchronous = FULL; PRAGMA busy_timeout = {patience};"),
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
            // A file that was removed since is not made anew.
            .connect(&url.replace("mode=rwc", "mode=rw"))
            .await?;
        let store = Store { pool, dialect, file: DatabaseFile::of(url) };
        store.lay_tables(upgrade == Upgrade::Allowed).await?;
        store.file.iter().for_each(DatabaseFile::lay_reserve);
        Ok(store)
    }

    /// Whether the database takes what is written, and its tables are of this version.
    pub async fn is_ready(&self) -> Result<()> {
        let mut transaction = self.begin().await?;
        schema::expect(&mut transaction).await?;
        sqlx::query("UPDATE clock SET seen_ms = seen_ms").execute(&mut *transaction).await?;
        transaction.commit().await
    }

    /// Lets the counted clock go on, and gives space of what was deleted back to the disk.
    pub async fn tidy(&self) -> Result<()> {
        sqlx::query(self.sql("UPDATE clock SET counted_ms = counted_ms + {step}, seen_ms = {now}")).execute(&self.pool).await?;
        if self.dialect == Dialect::Sqlite {
            let give_back = format!("PRAGMA incremental_vacuum({GIVEN_BACK}); PRAGMA wal_checkpoint(TRUNCATE)");
            sqlx::raw_sql(sqlx::AssertSqlSafe(give_back)).execute(&self.pool).await?;
        }
        self.file.iter().for_each(DatabaseFile::lay_reserve);
        Ok(())
    }

    /// Whether what makes room is worth another try after this error, since a full disk has got the reserve.
    fn has_given_reserve_up(&self, error: &sqlx::Error) -> bool {
        let given_up = is_gone(error) && self.file.as_ref().is_some_and(DatabaseFile::give_reserve_up);
        if given_up {
            tracing::warn!("the disk is full: its reserve is given up ({error})");
        }
        given_up
    }

    /// Whether results may be written: on a full disk they leave the rest to deletions.
    pub fn has_room_for_results(&self) -> bool {
        self.file.as_ref().is_none_or(|file| !file.is_disk_full())
    }

    pub async fn close(&self) {
        self.pool.close().await;
    }

    /// A statement with the fragments of this database filled in: `{now}`, `{skip_locked}`, `{bytes}`, `{key}`, and those made of
    /// them: `{counted}`, the counted clock, `{orphaned}`, whether a running job's lease is over, `{waits}`, whether a job may be taken, and `{stored}`,
    /// its bytes.
    fn sql(&self, statement: &str) -> sqlx::AssertSqlSafe<String> {
        let composed = statement
            .replace("{counted}", "(SELECT counted_ms + {step} FROM clock)")
            .replace("{step}", &STEP.replace("{most}", &COUNTED_STEP.as_millis().to_string()))
            .replace("{waits}", WAITS)
            .replace("{orphaned}", ORPHANED)
            .replace("{stored}", STORED);
        let fragments = self.dialect.fragments().into_iter();
        sqlx::AssertSqlSafe(fragments.fold(composed, |statement, (name, fragment)| statement.replace(name, fragment)))
    }

    /// A transaction that writes.
    /// Errors: also a file that was removed or replaced, in which nobody would find what is written.
    async fn begin(&self) -> Result<sqlx::Transaction<'static, sqlx::Any>> {
        self.file.as_ref().map_or(Ok(()), DatabaseFile::check)?;
        self.pool.begin_with(self.dialect.begin()).await
    }
}

/// Whether a statement failed because there is no connection, not because of what was asked: worth another try on a new one.
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

/// Bytes that must be free on every disk that is written to.
const FREE_BYTES: u64 = 64 << 20;
const RESERVE: u64 = 4 << 20;

/// Bytes that are free where a folder is; `None` where it is not there.
pub fn free_bytes(folder: &Path) -> Option<u64> {
    let about = rustix::fs::statvfs(folder).ok()?;
    Some(about.f_bavail.saturating_mul(about.f_frsize))
}

/// Bytes that must be free where a folder is, and those of a reserve there: less on a disk that has not as much in all.
pub fn needed_bytes(folder: &Path) -> [u64; 2] {
    let all = rustix::fs::statvfs(folder).map_or(u64::MAX, |about| about.f_blocks.saturating_mul(about.f_frsize));
    if all > FREE_BYTES { [FREE_BYTES, RESERVE] } else { [all / 4, all / 8] }
}

#[derive(Debug, Clone)]
pub struct DatabaseFile {
    path: PathBuf,
    /// Device and number, by which it is known whatever its name.
    identity: Option<(u64, u64)>,
}

impl DatabaseFile {
    /// The file of a URL, `sqlite://FILE`; `None` of another.
    pub fn of(url: &str) -> Option<DatabaseFile> {
        let path = url.strip_prefix("sqlite://")?.split('?').next()?;
        let path = PathBuf::from(percent_encoding::percent_decode_str(path).decode_utf8_lossy().into_owned());
        let identity = identity(&path);
        Some(DatabaseFile { path, identity })
    }

    pub fn folder(&self) -> PathBuf {
        self.path.parent().map(Path::to_path_buf).unwrap_or_default()
    }

    /// Refuses to write to a file that nobody finds again.
    pub fn check(&self) -> io::Result<()> {
        if identity(&self.path) == self.identity {
            return Ok(());
        }
        Err(io::Error::new(io::ErrorKind::NotFound, format!("{} was removed or replaced", self.path.display())))
    }

    /// Lays the reserve where there is plenty of room. On disks that cannot there is none.
    pub fn lay_reserve(&self) {
        let [needed, reserve] = needed_bytes(&self.folder());
        if free_bytes(&self.folder()).is_none_or(|free| free < needed + reserve) {
            return;
        }
        let file = OpenOptions::new().write(true).create_new(true).mode(0o600).open(self.path.with_extension("reserve"));
        if file.is_ok_and(|file| fallocate(&file, FallocateFlags::empty(), 0, reserve).is_err()) {
            let _ = fs::remove_file(self.path.with_extension("reserve"));
        }
    }

    /// Whether its disk has less room than a reserve.
    pub fn is_disk_full(&self) -> bool {
        free_bytes(&self.folder()).is_some_and(|free| free < needed_bytes(&self.folder())[1])
    }

    /// Gives the reserve up on a full disk; whether that made room.
    pub fn give_reserve_up(&self) -> bool {
        self.is_disk_full() && fs::remove_file(self.path.with_extension("reserve")).is_ok()
    }
}

fn identity(path: &Path) -> Option<(u64, u64)> {
    fs::metadata(path).ok().map(|about| (about.dev(), about.ino()))
}
