//! Arguments to a command, error to words and an exit code; nothing else.

use std::io::Write;
use std::process::ExitCode;

use clap::Parser;
use perilife::commands::CommandLine;
use perilife::commands::console::error_words;
use perilife_results::provenance::built_from;

fn main() -> ExitCode {
    if let Some(commit) = option_env!("PERILIFE_COMMIT") {
        built_from(commit);
    }
    let line = CommandLine::parse();
    line.start_log();
    line.show_units();
    line.watch_signals();
    match line.command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // A closed stderr must not turn the exit code into a panic.
            let _ = writeln!(std::io::stderr(), "{}", error_words(&error));
            ExitCode::from(error.exit_code())
        }
    }
}
