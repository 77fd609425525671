//! `perilife list`: every kind of every key.

use super::console::Console;
use perilife_base::error::{Result, input};
use perilife_runner::catalogue;

/// Arguments of `perilife list`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Only keys whose name contains this: `materials`, `loading`, `growth_law`
    #[arg(value_name = "WHAT")]
    pub what: Option<String>,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// Prints the list in aligned columns, or as JSON.
pub fn run(args: &Args) -> Result<()> {
    let what = args.what.as_deref().map(|what| what.to_lowercase().trim_end_matches('s').to_owned());
    let is_asked = |key: &str| what.as_ref().is_none_or(|what| key.contains(what.as_str()));
    let all = [catalogue::lines(), perilife_study::catalogue::lines()].concat();
    let lines: Vec<_> = all.iter().filter(|(key, ..)| is_asked(key)).cloned().collect();
    if let (true, Some(given)) = (lines.is_empty(), &args.what) {
        return Err(input("WHAT", given, "is part of no key", "use `perilife list` for all of them"));
    }
    let widest =
        |pick: fn(&(String, String, String)) -> &String| lines.iter().map(|line| pick(line).chars().count()).max().unwrap_or(0);
    let (key_width, name_width) = (widest(|line| &line.0), widest(|line| &line.1));
    let line = |(key, name, meaning): &(String, String, String)| format!("{key:<key_width$}  {name:<name_width$}  {meaning}\n");
    args.console.result(&lines.iter().map(line).collect::<String>())?;
    args.console.object(&catalogue::json(all))
}
