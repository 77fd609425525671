//! `perilife list`: every kind of every key, every key of every section, the JSON Schema of input files.

use super::console::Console;
use perilife_base::error::{Result, input};
use perilife_base::keys::nearest;
use perilife_runner::catalogue;

#[derive(clap::Args, Debug)]
pub struct Args {
    /// `keys` for all keys and ranges, or part of a name, e.g. `materials`
    #[arg(value_name = "WHAT")]
    pub what: Option<String>,
    /// With `keys`: a section or kind of specimen, e.g. `specimen.lug`
    #[arg(value_name = "SECTION")]
    pub section: Option<String>,
    /// Print the JSON Schema of input files (for editors)
    #[arg(long)]
    pub schema: bool,
    #[command(flatten)]
    pub console: Console,
}

/// Prints the list in aligned columns, or as JSON.
pub fn run(args: &Args) -> Result<()> {
    if args.schema {
        let schema = catalogue::schema();
        args.console.result(&format!("{schema:#}\n"))?;
        return args.console.object(&schema);
    }
    let what = args.what.as_deref().map(|what| what.to_lowercase().trim_end_matches('s').to_owned());
    if what.as_deref() == Some("key") {
        return keys(args);
    }
    let is_asked = |key: &str| what.as_ref().is_none_or(|what| key.contains(what.as_str()));
    let all = [catalogue::lines(), perilife_study::catalogue()].concat();
    let mut lines: Vec<Vec<String>> = all
        .iter()
        .filter(|(key, ..)| is_asked(key))
        .map(|(key, name, meaning)| vec![key.clone(), name.clone(), meaning.clone()])
        .collect();
    if lines.is_empty() {
        let told = catalogue::told();
        lines = told.iter().flat_map(|told| told.lines()).map(Vec::from).filter(|line| is_asked(&line[0])).collect();
    }
    if let (true, Some(given)) = (lines.is_empty(), &args.what) {
        return Err(input(
            "WHAT",
            given,
            "no key matches",
            "use `perilife list` for all choices, `perilife list keys` for all keys",
        ));
    }
    args.console.result(&aligned(&lines))?;
    args.console.object(&catalogue::json(all))
}

fn keys(args: &Args) -> Result<()> {
    let told = [catalogue::told(), catalogue::beside()].concat();
    let is_asked =
        |section: &str| args.section.as_deref().is_none_or(|asked| section == asked || section.split('.').next() == Some(asked));
    let asked: Vec<_> = told.iter().filter(|told| is_asked(&told.section)).collect();
    if let (true, Some(given)) = (asked.is_empty(), &args.section) {
        let names = told.iter().flat_map(|told| [Some(told.section.as_str()), told.section.split('.').next()]).flatten();
        let near = nearest(given, names);
        let list = || told.iter().map(|told| told.section.as_str()).collect::<Vec<_>>().join(", ");
        let remedy = near.map_or_else(|| format!("use one of {}", list()), |near| format!("did you mean {near}?"));
        return Err(input("SECTION", given, "unknown section", remedy));
    }
    let lines: Vec<Vec<String>> = asked.iter().flat_map(|told| told.lines()).map(Vec::from).collect();
    args.console.result(&aligned(&lines))?;
    let rows =
        lines.iter().map(|line| serde_json::json!({ "key": line[0], "range": line[1], "left_out": line[2], "meaning": line[3] }));
    args.console.object(&rows.collect())
}

/// Lines of cells in columns, the last one as long as it is; one that is far longer than most does not widen its column.
fn aligned(lines: &[Vec<String>]) -> String {
    const WIDEST: usize = 44;
    let width = |column: usize| {
        let lengths = lines.iter().map(|line| line[column].chars().count());
        if column == 0 { lengths.max() } else { lengths.filter(|length| *length <= WIDEST).max() }.unwrap_or(0)
    };
    let widths: Vec<usize> = (0..lines.first().map_or(0, Vec::len)).map(width).collect();
    let line = |line: &Vec<String>| {
        let cells = line.iter().zip(&widths).map(|(cell, width)| format!("{cell:<width$}"));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    lines.iter().map(line).collect()
}
