//! A Slurm cluster of one node, of a test's own, where the machine has the programs for one.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use tempfile::TempDir;

use crate::support::installed::{end, free_ports, is_root, or_skipped};

/// Longest wait until the node is ready.
const PATIENCE: Duration = Duration::from_secs(60);

/// A cluster with its own folder and ports, stopped and removed when dropped.
pub struct Slurm {
    daemons: Vec<Child>,
    folder: TempDir,
}

impl Slurm {
    /// Starts one, where the machine has it.
    pub fn start() -> Option<Slurm> {
        or_skipped("slurm", Self::try_start())
    }

    fn try_start() -> Result<Slurm, String> {
        for program in ["/usr/sbin/munged", "/usr/sbin/slurmctld", "/usr/sbin/slurmd", "/usr/bin/sbatch"] {
            if !Path::new(program).is_file() {
                return Err(format!("{program} is not installed (Debian: apt-get install slurm-wlm)"));
            }
        }
        if !is_root() {
            return Err("its daemons must be started as root".to_owned());
        }
        let folder = tempfile::Builder::new().prefix("perilife-slurm").tempdir().map_err(|error| error.to_string())?;
        let mut cluster = Slurm { daemons: Vec::new(), folder };
        let here = cluster.folder.path().to_path_buf();
        for name in ["state", "spool"] {
            fs::create_dir(here.join(name)).map_err(|error| error.to_string())?;
        }
        fs::write(here.join("munge.key"), [7u8; 128]).map_err(|error| error.to_string())?;
        set_mode(&here, 0o755)?;
        set_mode(&here.join("munge.key"), 0o400)?;
        fs::write(here.join("slurm.conf"), conf(&here)?).map_err(|error| error.to_string())?;

        let file = |option: &str, name: &str| format!("--{option}={}", here.join(name).display());
        let munge = ["--foreground", "--force"].map(str::to_owned).into_iter().chain([
            file("key-file", "munge.key"),
            file("socket", "munge.socket"),
            file("pid-file", "munge.pid"),
            file("log-file", "munge.log"),
            file("seed-file", "munge.seed"),
        ]);
        cluster.daemon("/usr/sbin/munged", munge)?;
        wait(|| here.join("munge.socket").exists())
            .map_err(|()| format!("munged does not start: {}", cluster.log("munge.log")))?;
        let conf = here.join("slurm.conf").display().to_string();
        cluster.daemon("/usr/sbin/slurmctld", ["-D", "-f", &conf].map(str::to_owned))?;
        cluster.daemon("/usr/sbin/slurmd", ["-D", "-N", NODE, "-f", &conf].map(str::to_owned))?;
        wait(|| cluster.ask("sinfo", &["-h", "-o", "%T"]).is_ok_and(|state| state.trim() == "idle")).map_err(|()| {
            let state = cluster.ask("sinfo", &["-h", "-o", "%T %E"]);
            format!("the node does not come up: {state:?}; {}; {}", cluster.log("slurmctld.log"), cluster.log("slurmd.log"))
        })?;
        Ok(cluster)
    }

    fn daemon(&mut self, program: &str, arguments: impl IntoIterator<Item = String>) -> Result<(), String> {
        let mut command = Command::new(program);
        command.args(arguments).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        self.daemons.push(command.spawn().map_err(|error| format!("{program}: {error}"))?);
        Ok(())
    }

    /// Configuration that clients need in `SLURM_CONF`.
    pub fn conf(&self) -> PathBuf {
        self.folder.path().join("slurm.conf")
    }

    /// What a program of Slurm answers.
    pub fn ask(&self, program: &str, arguments: &[&str]) -> Result<String, String> {
        let output = Command::new(program).args(arguments).env("SLURM_CONF", self.conf()).output();
        let output = output.map_err(|error| error.to_string())?;
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        if output.status.success() { Ok(text(&output.stdout)) } else { Err(text(&output.stderr)) }
    }

    /// The last lines of a log.
    fn log(&self, name: &str) -> String {
        let text = fs::read_to_string(self.folder.path().join(name)).unwrap_or_default();
        let lines: Vec<&str> = text.lines().collect();
        lines[lines.len().saturating_sub(5)..].join(" | ")
    }
}

impl Drop for Slurm {
    fn drop(&mut self) {
        // The node before the controller, munged last: in the other order they wait for each other.
        self.daemons.iter_mut().rev().for_each(|daemon| end(daemon, Duration::from_secs(10)));
    }
}

/// Name of the node; its address is that of this machine to itself.
const NODE: &str = "perilife";

fn conf(here: &Path) -> Result<String, String> {
    let [controller, node] = free_ports();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let here = here.display();
    let host = fs::read_to_string("/proc/sys/kernel/hostname").map_err(|error| error.to_string())?;
    Ok(format!(
        "ClusterName=perilife\nSlurmctldHost={}(127.0.0.1)\nSlurmctldPort={controller}\nSlurmdPort={node}\n\
         AuthType=auth/munge\nAuthInfo=socket={here}/munge.socket\nCredType=cred/munge\n\
         SlurmUser=root\nSlurmdUser=root\nStateSaveLocation={here}/state\nSlurmdSpoolDir={here}/spool\n\
         SlurmctldPidFile={here}/slurmctld.pid\nSlurmdPidFile={here}/slurmd.pid\n\
         SlurmctldLogFile={here}/slurmctld.log\nSlurmdLogFile={here}/slurmd.log\n\
         ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nSelectType=select/cons_tres\nSelectTypeParameters=CR_Core\n\
         ReturnToService=2\nMpiDefault=none\nAccountingStorageType=accounting_storage/none\nJobAcctGatherType=jobacct_gather/none\n\
         SchedulerParameters=sched_interval=1\nMinJobAge=30\n\
         NodeName={NODE} NodeHostname={} NodeAddr=127.0.0.1 CPUs={cores} State=UNKNOWN\n\
         PartitionName=all Nodes={NODE} Default=YES MaxTime=INFINITE State=UP OverSubscribe=YES\n",
        host.trim(),
        host.trim()
    ))
}

fn wait(is_so: impl Fn() -> bool) -> Result<(), ()> {
    let begun = Instant::now();
    while begun.elapsed() < PATIENCE {
        if is_so() {
            return Ok(());
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    Err(())
}

fn set_mode(path: &Path, mode: u32) -> Result<(), String> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(mode)).map_err(|error| error.to_string())
}
