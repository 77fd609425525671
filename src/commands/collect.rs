//! `perilife collect`: the results of a sweep whose cases were run in parts.

use std::path::PathBuf;
use std::time::Instant;

use super::console::Console;
use super::sweep::finish;
use perilife_base::error::Result;
use perilife_runner::sweep::SweepFolder;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folder of the sweep
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
    #[command(flatten)]
    pub console: Console,
}

pub fn run(args: &Args) -> Result<()> {
    finish(&SweepFolder::existing(&args.dir)?, Instant::now(), &args.console)
}
