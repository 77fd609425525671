//! Says in the program which commit it was built from, where that can be told: results repeat it. Says how it is linked.

use std::path::Path;
use std::process::Command;

fn main() {
    // Whenever the sources change the program is built anew, and with it this answer.
    let sources = if Path::new("src").is_dir() { "src" } else { ".." };
    println!("cargo:rerun-if-changed={sources}");
    println!("cargo:rerun-if-changed=Cargo.toml");
    println!("cargo:rerun-if-env-changed=PERILIFE_COMMIT");
    let given = std::env::var("PERILIFE_COMMIT").ok().filter(|commit| !commit.is_empty());
    if let Some(commit) = given.or_else(of_repository) {
        println!("cargo:rustc-env=PERILIFE_COMMIT={commit}");
    }
    // The program (not the Python module) at a fixed address: 300 000 relocations at every start take a third of the time of a life
    // by hand calculation.
    let built = ["CARGO_PKG_NAME", "CARGO_CFG_TARGET_OS", "CARGO_CFG_TARGET_ENV"];
    if built.map(|name| std::env::var(name).unwrap_or_default()) == ["perilife", "linux", "gnu"] {
        println!("cargo:rustc-link-arg-bins=-no-pie");
    }
}

/// The commit of the working copy, marked where the sources differ from it; `None` outside of one.
fn of_repository() -> Option<String> {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
        String::from_utf8(output.stdout).ok()
    };
    // A package that was unpacked into another repository is not of that one.
    git(&["ls-files", "--error-unmatch", "Cargo.toml"])?;
    let commit = git(&["rev-parse", "HEAD"])?;
    let changes = git(&["status", "--porcelain", "--untracked-files=no", "--", ":/src", ":/Cargo.toml", ":/data"])?;
    let mark = if changes.trim().is_empty() { "" } else { " with changes" };
    Some(format!("{}{mark}", commit.trim()))
}
