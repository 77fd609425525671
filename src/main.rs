//! Arguments to a command, error to words and an exit code; nothing else.

use std::io::Write;
use std::process::ExitCode;

use clap::FromArgMatches;
use perilife::commands::console::{error_words, print_error_object};
use perilife::commands::{CommandLine, command_line};
use perilife_results::provenance::built_from;

fn main() -> ExitCode {
    if let Some(commit) = option_env!("PERILIFE_COMMIT") {
        built_from(commit);
    }
    let matches = command_line().get_matches();
    let is_json = |of_command: &clap::ArgMatches| matches!(of_command.try_get_one("json"), Ok(Some(true)));
    let is_json = matches.subcommand().is_some_and(|(_, of_command)| is_json(of_command));
    let line = CommandLine::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
    line.begin();
    match line.command.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            if is_json {
                print_error_object(&error);
            }
            // A closed stderr must not turn the exit code into a panic.
            let _ = writeln!(std::io::stderr(), "{}", error_words(&error));
            ExitCode::from(error.exit_code())
        }
    }
}
