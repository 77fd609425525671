//! `perilife completions`: what a shell needs to complete commands and flags, and the manual page, both made from the arguments themselves.

use std::path::Path;

use clap::ValueEnum;
use clap_complete::{Shell, generate};

use super::command_line;
use super::console::Console;
use perilife_base::error::{Error, Result};
use perilife_base::input::STREAM;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Shell, or man: manual page (roff), for `man -l`
    #[arg(value_name = "SHELL", value_parser = ["bash", "elvish", "fish", "powershell", "zsh", "man"])]
    pub form: String,
}

pub fn run(args: &Args) -> Result<()> {
    let (mut command, mut text) = (command_line(), Vec::new());
    match Shell::from_str(&args.form, true) {
        Ok(shell) => generate(shell, &mut command, "perilife", &mut text),
        Err(_) => clap_mangen::Man::new(command)
            .render(&mut text)
            .map_err(|error| Error::file(Path::new(STREAM), "cannot write", error))?,
    }
    Console::default().result(&String::from_utf8_lossy(&text))
}
