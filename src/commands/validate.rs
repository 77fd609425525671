//! `perilife validate`: published tests, measured and predicted.

use std::path::PathBuf;

use super::console::Console;
use perilife_base::error::{Error, Result};
use perilife_results::output::{OutputFile, OutputFolder, Room, RunKind, Sort, write_file};
use perilife_study::validate::{Row, page, picture, read, rows, sets};

/// Arguments of `perilife validate`.
#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "A folder of your own tests holds source.toml ([source] and one [[test]] per prediction), the cases of the tests,\n\
                             a calibration if they need one, and tables: data/README.md of the source has the keys, data/validation 17 sets."
)]
pub struct Args {
    /// Sets of tests, or folders of your own; all sets if omitted (`perilife list` names them)
    #[arg(value_name = "NAME or FOLDER")]
    pub sets: Vec<String>,
    /// Folder for validate.csv, validate.json, validate.md and validate.svg
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<PathBuf>,
    /// File for the page as Markdown, without wall times
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub markdown: Option<PathBuf>,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife validate`.
/// Errors: a set that cannot be read, before any run; tests without a prediction, after all; files that cannot be written.
pub fn run(args: &Args) -> Result<()> {
    let sets = sets(&args.sets)?;
    let read = read(&sets);
    let sort = Sort { option: "--markdown", sign: b"Written by `perilife validate --markdown`" };
    let markdown = args.markdown.as_deref().map(|path| OutputFile::claim(path, sort, &read)).transpose()?;
    let claim = |path: &PathBuf| OutputFolder::claim(path, RunKind::Validate, &read, Room::default());
    let folder = args.out.as_ref().map(claim).transpose()?;
    let rows = rows(&sets, &|set, rows| args.console.say(&page::lines(set, rows)));
    let (object, page) = (page::object(&rows), page::markdown(&sets, &rows));
    if let Some(mut folder) = folder {
        folder.fill(|path| {
            write_file(&path.join("validate.csv"), page::csv(&rows).as_bytes())?;
            write_file(&path.join("validate.json"), format!("{object:#}\n").as_bytes())?;
            write_file(&path.join("validate.svg"), picture::svg(&rows).as_bytes())?;
            write_file(&path.join("validate.md"), page.as_bytes())
        })?;
        drop(folder.finish()?);
    }
    markdown.map_or(Ok(()), |file| file.write(page.as_bytes()))?;
    args.console.object(&object)?;
    let failed: Vec<String> = rows.iter().filter_map(Row::failure).collect();
    if failed.is_empty() { Ok(()) } else { Err(Error::Mechanics(failed.join("\n"))) }
}
