//! A PostgreSQL server of a test's own, where the machine has the programs for one.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use tempfile::TempDir;

use crate::support::installed::{free_ports, is_root, or_skipped};

/// A server with its own folder and port, stopped and removed when dropped.
pub struct Postgres {
    programs: PathBuf,
    folder: TempDir,
    port: u16,
}

impl Postgres {
    /// Starts one, where the machine has it.
    pub fn start() -> Option<Postgres> {
        or_skipped("postgres", Self::try_start())
    }

    fn try_start() -> Result<Postgres, String> {
        let programs = programs().ok_or("no server is installed (Debian: apt-get install postgresql)")?;
        let folder = tempfile::Builder::new().prefix("perilife-pg").tempdir().map_err(|error| error.to_string())?;
        let [port] = free_ports();
        let server = Postgres { programs, folder, port };
        if is_root() {
            run(Command::new("chown").arg("postgres").arg(server.folder.path()))?;
        }
        server.lay_out()?;
        server.up()?;
        Ok(server)
    }

    /// An empty cluster: laid out once for each version of the programs, and copied from then on.
    fn lay_out(&self) -> Result<(), String> {
        let version = self.programs.parent().and_then(Path::file_name).unwrap_or_default();
        let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join("postgres").join(version);
        let copy = |from: &Path, to: &Path| run(Command::new("cp").arg("-a").args([from, to]));
        if kept.is_dir() {
            return copy(&kept, &self.data());
        }
        run(self.program("initdb").args(["-U", "perilife", "-A", "trust", "--no-sync", "-D"]).arg(self.data()))?;
        let part = kept.with_file_name(format!("part-{}", self.port));
        std::fs::create_dir_all(kept.parent().unwrap_or(&kept)).map_err(|error| error.to_string())?;
        copy(&self.data(), &part)?;
        // Another test may have been first.
        if std::fs::rename(&part, &kept).is_err() {
            let _ = std::fs::remove_dir_all(&part);
        }
        Ok(())
    }

    /// Starts the server, which is not running.
    pub fn up(&self) -> Result<(), String> {
        let (port, sockets) = (self.port, self.folder.path().display());
        let options = format!("-p {port} -c listen_addresses=127.0.0.1 -c unix_socket_directories={sockets} -c fsync=off");
        run(self.program("pg_ctl").args(["-w", "-l", "log", "-o", &options, "-D"]).arg(self.data()).arg("start"))
    }

    /// Stops it as a crash would.
    pub fn down(&self) {
        let _ = run(self.program("pg_ctl").args(["-m", "immediate", "-D"]).arg(self.data()).arg("stop"));
    }

    /// URL of a new, empty database.
    pub fn database(&self, name: &str) -> String {
        let url = format!("postgres://perilife@127.0.0.1:{}", self.port);
        // In a language that sorts otherwise than bytes do, as most servers are.
        let language = ["-T", "template0", "--locale-provider=icu", "--icu-locale=en-US", "--locale=C.UTF-8"];
        let place = format!("{url}/postgres");
        run(Command::new(self.programs.join("createdb")).args(language).args(["--maintenance-db", &place, name])).unwrap();
        format!("{url}/{name}")
    }

    /// Runs a statement.
    pub fn sql(&self, database: &str, statement: &str) -> Result<(), String> {
        run(Command::new(self.programs.join("psql")).args(["-q", "-d", database, "-c", statement]))
    }

    fn data(&self) -> PathBuf {
        self.folder.path().join("data")
    }

    /// A program of the server, which refuses to run as root.
    fn program(&self, name: &str) -> Command {
        let path = self.programs.join(name);
        let mut command = if is_root() {
            let mut command = Command::new("runuser");
            command.args(["-u", "postgres", "--"]).arg(path);
            command
        } else {
            Command::new(path)
        };
        command.current_dir(self.folder.path());
        command
    }
}

impl Drop for Postgres {
    fn drop(&mut self) {
        self.down();
    }
}

/// Folder of the newest server's programs.
fn programs() -> Option<PathBuf> {
    let versions = std::fs::read_dir("/usr/lib/postgresql").into_iter().flatten().flatten();
    let mut found: Vec<PathBuf> =
        versions.map(|version| version.path().join("bin")).filter(|bin| bin.join("initdb").is_file()).collect();
    found.sort();
    found.pop()
}

fn run(command: &mut Command) -> Result<(), String> {
    // What it leaves running must not hold on to a pipe of ours.
    let log = tempfile::tempfile().map_err(|error| error.to_string())?;
    let copy = log.try_clone().map_err(|error| error.to_string())?;
    let status = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(copy).status();
    match status {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => {
            use std::io::{Read, Seek};
            let (mut log, mut text) = (log, String::new());
            let _ = log.rewind().and_then(|()| log.read_to_string(&mut text));
            Err(format!("{command:?}: {status}: {text}"))
        }
        Err(error) => Err(format!("{command:?}: {error}")),
    }
}
