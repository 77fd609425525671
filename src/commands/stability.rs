//! `perilife stability`: where each method fails.

use std::path::PathBuf;

use super::console::Console;
use perilife_base::error::Result;
use perilife_results::output::{OutputFolder, RunKind, write_file};
use perilife_study::stability::{self, Effort, SLOW, sweeps};
use perilife_study::stability_table as tables;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Sweeps to run [default: all; see `perilife list`]
    #[arg(value_name = "NAME")]
    pub names: Vec<String>,
    /// Short version: every third value, limits to 20 % (2 min)
    #[arg(long)]
    pub quick: bool,
    /// Results folder
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub console: Console,
}

pub fn run(args: &Args) -> Result<()> {
    let sweeps = sweeps(&args.names)?;
    // Who names a sweep wants all of it.
    let with_slow = !args.quick || !args.names.is_empty();
    let effort = Effort { with_slow, ..if args.quick { Effort::QUICK } else { Effort::FULL } };
    if !with_slow {
        let left_out = SLOW.map(|(sweep, method)| format!("{sweep} of {method}")).join(", ");
        args.console.note(&format!("skipped (slow): {left_out}"));
    }
    let folder = args.out.as_deref().map(|path| OutputFolder::create(path, RunKind::Stability)).transpose()?;
    let records = stability::run(&sweeps, effort, &|record| args.console.say(&tables::line(record)));
    let object = tables::object(&records);
    if let Some(mut folder) = folder {
        folder.fill(|path| {
            let write = |name: &str, text: String| write_file(&path.join(name), text.as_bytes());
            write("stability.csv", tables::csv(&records))?;
            write("boundaries.csv", tables::boundaries(&records))?;
            write("stability.json", format!("{object:#}\n"))?;
            for sweep in &sweeps {
                let of_sweep: Vec<_> = records.iter().filter(|record| record.sweep.name == sweep.name).collect();
                tables::sweep(&path.join(format!("{}.svg", sweep.name)), sweep, &of_sweep)?;
            }
            tables::overview(&path.join("stability.svg"), &records)
        })?;
        drop(folder.finish()?);
    }
    args.console.object(&object)
}
