//! `perilife verify`: the built-in verification as a table.

use std::path::PathBuf;

use serde_json::json;

use super::console::Console;
use perilife_base::error::{Error, Result};
use perilife_base::input::Provenance;
use perilife_results::output::{OutputFile, OutputFolder, RunKind, Sort};
use perilife_study::topics;
use perilife_study::verification;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Topics to verify [default: all; see `perilife list`]
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,
    /// Results folder
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<PathBuf>,
    /// Markdown file of all tables, without run times
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub markdown: Option<PathBuf>,
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife verify`.
/// Errors: a name that is no topic; a row that misses its bound for no known reason or by more than is known; a topic with
/// another number of misses than is pinned; files that cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let topics = topics(&args.names)?;
    // Before minutes are spent on what cannot be written.
    let sort = Sort { option: "--markdown", sign: b"Written by `perilife verify --markdown`" };
    let markdown = args.markdown.as_deref().map(|path| OutputFile::claim(path, sort, &Provenance::default())).transpose()?;
    let folder = args.out.as_deref().map(|path| OutputFolder::create(path, RunKind::Verify)).transpose()?;
    let rows = perilife_study::rows(&topics, &|topic, rows| {
        let lines: Vec<String> = rows.iter().map(verification::line).collect();
        args.console.say(&format!("{}: {}\n{}", topic.name, topic.about, lines.join("\n")));
    })?;
    let object = verification::object(&rows);
    let page = verification::markdown(&topics, &rows);
    if let Some(folder) = folder {
        let (csv, json) = (verification::csv(&rows), format!("{object:#}\n"));
        folder.write(&[("verify.csv", &csv), ("verify.json", &json), ("verify.md", &page)])?;
    }
    markdown.map_or(Ok(()), |file| file.write(page.as_bytes()))?;
    let (failed, missed) = (rows.iter().filter(|row| row.fails()).count(), rows.iter().filter(|row| !row.ok()).count());
    args.console.say(&format!("{} rows, {} within bounds, {} known misses", rows.len(), rows.len() - missed, missed - failed));
    args.console.object(&json!({ "rows": object["rows"], "known_misses": missed - failed, "failed": failed }))?;
    let faults = perilife_study::faults(&topics, &rows);
    if faults.is_empty() { Ok(()) } else { Err(Error::Mechanics(faults.join("\n"))) }
}
