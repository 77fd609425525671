//! Programs of the machine that tests start for themselves.

use std::net::TcpListener;
use std::path::Path;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

/// What was started; `None`, with the reason printed, where that cannot be. A machine that is meant to have it says so in
/// `PERILIFE_TESTS_NEED`, and the test fails there.
pub fn or_skipped<T>(what: &str, started: Result<T, String>) -> Option<T> {
    if let Err(why) = &started {
        let needed = std::env::var("PERILIFE_TESTS_NEED").is_ok_and(|needs| needs.contains(what));
        assert!(!needed, "{what} is needed here: {why}");
        println!("skipped with {what}: {why}");
    }
    started.ok()
}

pub fn is_root() -> bool {
    use std::os::unix::fs::MetadataExt;
    Path::new("/proc/self").metadata().is_ok_and(|process| process.uid() == 0)
}

/// Ports that nobody listens at; all open at once, or two could be the same.
pub fn free_ports<const N: usize>() -> [u16; N] {
    [(); N].map(|()| TcpListener::bind("127.0.0.1:0").unwrap()).map(|free| free.local_addr().unwrap().port())
}

/// Asks a process to end, and kills it where it does not.
pub fn end(process: &mut Child, patience: Duration) {
    let _ = Command::new("kill").args(["-TERM", &process.id().to_string()]).status();
    let begun = Instant::now();
    while process.try_wait().is_ok_and(|ended| ended.is_none()) {
        if begun.elapsed() > patience {
            let _ = process.kill();
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}
