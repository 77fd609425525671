//! `perilife job`: one job of a worker, in a process of its own.

use serde_json::{Value, json};

use super::console::Console;
use super::{chart, sif, sweep};
use crate::error::Result;
use crate::input::Document;
use crate::report::json::RESULT_FILE;
use crate::report::output::write_file;
use crate::service::job::JobKind;
use crate::service::worker::{Order, child};

/// Arguments of `perilife job`: none, since all comes over the socket of the worker.
#[derive(Debug, clap::Args)]
pub struct Args {}

/// Runs `perilife job`.
///
/// # Errors
/// The standard input is not the socket of a worker.
pub fn run(_: &Args) -> Result<()> {
    child::take(&of_command)
}

/// A job that is one of a command as a whole: its files go into the folder of the order, its figures come back.
fn of_command(order: &Order, document: Document) -> Result<Value> {
    // Its process has nobody to print for.
    let console = Console { quiet: true, json: false };
    let option = |name: &str| -> Vec<String> {
        let values = order.options.iter().filter_map(|option| option.split_once('=')).filter(|(key, _)| *key == name);
        values.map(|(_, value)| value.to_owned()).collect()
    };
    let (folder, name) = (&order.folder, document.name.clone());
    let mut figures = match order.kind {
        JobKind::Sif => {
            let found = sif::run_on(&document, &option("method"), None, &console)?;
            write_file(&folder.join(RESULT_FILE), format!("{found:#}\n").as_bytes())?;
            found
        }
        JobKind::Sweep => sweep::run_on(document, folder, order.threads, &console)?,
        _ => {
            let quick = option("quick").iter().any(|value| value == "true");
            let args =
                chart::Args { names: option("scene"), quick, out: Some(folder.clone()), once: false, set: Vec::new(), console };
            chart::measured(&args)?
        }
    };
    figures["name"] = json!(name);
    Ok(figures)
}
