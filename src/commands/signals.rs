//! Ctrl-C and its like: what is in the making goes, one line says how to go on, and the exit code is that of the signal.

use std::io::Write as _;
use std::sync::{Mutex, PoisonError};

use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

use perilife_results::output::fold_up;

type Way = Box<dyn Fn() -> String + Send>;

static WAY: Mutex<Option<Way>> = Mutex::new(None);

/// Says this line if the process is asked to end.
pub fn say_at_the_end(words: &str) {
    let words = words.to_owned();
    go_on_by(move || words.clone());
}

pub fn go_on_by(words: impl Fn() -> String + Send + 'static) {
    *WAY.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(words));
}

/// Has the process fold up on SIGINT, SIGTERM and SIGHUP, except on those that it was started to ignore (`nohup`).
pub fn fold_up_on_signals() {
    let ignored = ignored();
    let wanted = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0);
    match Signals::new(wanted) {
        Ok(mut signals) => drop(std::thread::spawn(move || signals.forever().next().map(end))),
        // Then they end the process as ever, and the next start tidies up.
        Err(error) => tracing::warn!("signals leave temporary files behind: {error}"),
    }
}

/// Signals that the process ignores, a bit each; none where the system does not tell.
fn ignored() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

fn end(signal: i32) {
    fold_up();
    let name = match signal {
        SIGINT => "SIGINT",
        SIGTERM => "SIGTERM",
        _ => "SIGHUP",
    };
    let nothing = || "nothing was written; use --checkpoint FILE to resume".to_owned();
    let way = WAY.lock().unwrap_or_else(PoisonError::into_inner).as_ref().map_or_else(nothing, |way| way());
    let _ = writeln!(std::io::stderr(), "interrupted by {name}; {way}");
    std::process::exit(128 + signal);
}
