//! `perilife validate`: published tests, measured and predicted.

use std::path::PathBuf;

use super::console::Console;
use perilife_base::error::{Error, Result};
use perilife_base::input::Provenance;
use perilife_results::output::{OutputFile, OutputFolder, RunKind, Sort};
use perilife_study::validate::{page, rows, sets};

#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "A folder of your own tests contains source.toml ([source] and one [[test]] per prediction), the cases of the tests,\n\
                             a calibration if they need one, and tables: data/README.md of the source has the keys, data/validation 17 sets."
)]
pub struct Args {
    /// Sets of tests, or your own folders [default: all; see `perilife list`]
    #[arg(value_name = "NAME or FOLDER")]
    pub sets: Vec<String>,
    /// Results folder
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<PathBuf>,
    /// Markdown file of the page
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub markdown: Option<PathBuf>,
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife validate`.
/// Errors: a set that cannot be read, before any run; tests without a prediction, after all; files that cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let sets = sets(&args.sets)?;
    let sort = Sort { option: "--markdown", sign: b"Written by `perilife validate --markdown`" };
    let markdown = args.markdown.as_deref().map(|path| OutputFile::claim(path, sort, &Provenance::default())).transpose()?;
    let folder = args.out.as_deref().map(|path| OutputFolder::create(path, RunKind::Validate)).transpose()?;
    let rows = rows(&sets, &|set, rows| args.console.say(&page::lines(set, rows)));
    let (object, page) = (page::object(&rows), page::markdown(&sets, &rows));
    if let Some(folder) = folder {
        let [csv, json, svg] = [page::csv(&rows), format!("{object:#}\n"), page::svg(&rows)];
        folder.write(&[("validate.csv", &csv), ("validate.json", &json), ("validate.svg", &svg), ("validate.md", &page)])?;
    }
    markdown.map_or(Ok(()), |file| file.write(page.as_bytes()))?;
    args.console.object(&object)?;
    let failed: Vec<String> = rows.into_iter().filter_map(|row| row.failure).collect();
    if failed.is_empty() { Ok(()) } else { Err(Error::Mechanics(failed.join("\n"))) }
}
