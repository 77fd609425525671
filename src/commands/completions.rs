//! `perilife completions`: what a shell needs to complete commands and flags, and the manual page, both made from the arguments themselves.

use std::path::Path;

use clap_complete::{Shell, generate};

use super::command_line;
use super::console::Console;
use perilife_base::error::{Error, Result};
use perilife_base::input::STREAM;

/// What is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Form {
    /// bash
    Bash,
    /// elvish
    Elvish,
    /// fish
    Fish,
    /// PowerShell
    Powershell,
    /// zsh
    Zsh,
    /// Man page (roff), for `man -l`
    Man,
}

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Shell, or `man`
    #[arg(value_name = "SHELL")]
    pub form: Form,
}

pub fn run(args: &Args) -> Result<()> {
    let mut command = command_line();
    let shell = match args.form {
        Form::Bash => Shell::Bash,
        Form::Elvish => Shell::Elvish,
        Form::Fish => Shell::Fish,
        Form::Powershell => Shell::PowerShell,
        Form::Zsh => Shell::Zsh,
        Form::Man => {
            let mut page = Vec::new();
            let made = clap_mangen::Man::new(command).render(&mut page);
            made.map_err(|error| Error::file(Path::new(STREAM), "cannot write", error))?;
            return Console::default().result(&String::from_utf8_lossy(&page));
        }
    };
    let mut script = Vec::new();
    generate(shell, &mut command, "perilife", &mut script);
    Console::default().result(&String::from_utf8_lossy(&script))
}
