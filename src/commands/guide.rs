//! `perilife guide`: a page of the guide as Markdown.

use clap::builder::PossibleValuesParser;
use serde_json::json;

use super::console::Console;
use perilife_base::error::Result;
use perilife_runner::guide::{PAGES, page};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Page to print; the index lists all
    #[arg(value_name = "PAGE", default_value = "index", hide_possible_values = true, value_parser = PossibleValuesParser::new(PAGES.iter().map(|(name, _)| *name)))]
    pub page: String,
    #[command(flatten)]
    pub console: Console,
}

pub fn run(args: &Args) -> Result<()> {
    let text = page(&args.page).unwrap_or_default();
    args.console.result(text)?;
    args.console.object(&json!({ "page": args.page, "text": text }))
}
