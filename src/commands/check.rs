//! `perilife check`: is this input file right, and what would be run?

use std::path::PathBuf;

use super::console::Console;
use crate::check::check;
use crate::error::Result;
use crate::input::Document;
use crate::report::output::write_file;

/// Arguments of `perilife check`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Case, calibration file or fracture scene
    #[arg(value_name = "FILE.toml")]
    pub file: PathBuf,
    /// Draw specimen, crack, loads and supports into this SVG file
    #[arg(long, value_name = "OUT.svg", help_heading = "Output")]
    pub picture: Option<PathBuf>,
    /// Override a key of the file (repeatable), e.g. --set model.spacing_mm=2
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input")]
    pub set: Vec<String>,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// Checks the file, prints what was understood and draws the picture.
///
/// # Errors
/// Wrong input, or files that cannot be read or written.
pub fn run(args: &Args) -> Result<()> {
    let checked = check(Document::read(&args.file, &args.set)?)?;
    if let Some(path) = &args.picture {
        write_file(path, checked.drawing.as_bytes())?;
    }
    for warning in &checked.warnings {
        args.console.warn(warning);
    }
    for line in &checked.lines {
        args.console.say(&format!("{:<12} {}", line.what, line.value));
    }
    args.console.say(&format!("{:<12} no errors", "check"));
    args.console.object(&checked.json())
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUIET: Console = Console { json: false, quiet: true };

    /// Every shipped case passes, with a picture; a picture that cannot be written leaves nothing behind.
    #[test]
    fn shipped_cases_pass() {
        let folder = tempfile::tempdir().unwrap();
        let files = ["/data/cases", "/data/cases/fracture"].into_iter().filter_map(|below| {
            Some(std::fs::read_dir(format!("{}{below}", env!("CARGO_MANIFEST_DIR"))).ok()?.map(|entry| entry.unwrap().path()))
        });
        let is_toml = |file: &PathBuf| file.extension().is_some_and(|extension| extension == "toml");
        let files: Vec<PathBuf> = files.flatten().filter(is_toml).collect();
        assert!(files.len() > 2);
        for file in files {
            let picture = folder.path().join("picture.svg");
            let args = Args { file, picture: Some(picture.clone()), set: vec![], console: QUIET };
            run(&args).unwrap();
            assert!(std::fs::read_to_string(&picture).unwrap().ends_with("</svg>\n"));
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
            let nowhere = Args { picture: Some(folder.path().join("no/such/folder.svg")), ..args };
            assert_eq!(run(&nowhere).unwrap_err().exit_code(), 4);
        }
    }

    /// The measured files of a calibration are read and checked, and the case of it is.
    #[test]
    fn shipped_calibrations_pass() {
        for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/calibration")).unwrap() {
            let file = entry.unwrap().path().join("case.toml");
            if file.is_file() {
                let args = Args { file, picture: None, set: vec![], console: QUIET };
                run(&args).unwrap();
                let set = vec!["measured.files=[\"nowhere.csv\"]".to_owned()];
                assert_eq!(run(&Args { set, ..args }).unwrap_err().exit_code(), 4);
            }
        }
    }
}
