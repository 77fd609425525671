//! `perilife list`: every kind of every key.

use super::console::Console;
use crate::error::Result;
use crate::report::catalogue::{json, lines};

/// Arguments of `perilife list`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// Prints the list in aligned columns, or as JSON.
pub fn run(args: &Args) -> Result<()> {
    let lines = lines();
    let widest =
        |pick: fn(&(String, String, String)) -> &String| lines.iter().map(|line| pick(line).chars().count()).max().unwrap_or(0);
    let (key_width, name_width) = (widest(|line| &line.0), widest(|line| &line.1));
    let line = |(key, name, meaning): &(String, String, String)| format!("{key:<key_width$}  {name:<name_width$}  {meaning}\n");
    args.console.result(&lines.iter().map(line).collect::<String>())?;
    args.console.object(&json())
}
