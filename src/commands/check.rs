//! `perilife check`: is this input file right, and what would be run?

use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::case::{Case, LawSource};
use crate::error::{Error, Result};
use crate::input::Document;
use crate::report::specimen_picture::specimen_svg;
use crate::specimen::handbook::handbook;
use crate::specimen::{LoadMeasure, Support};
use crate::units::{GPA, KN, MM, MPA};

/// Validate a case or calibration file without running it
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Case or calibration file
    #[arg(value_name = "FILE.toml")]
    pub file: PathBuf,
    /// Draw specimen, crack, loads and supports into this SVG file
    #[arg(long, value_name = "OUT.svg")]
    pub picture: Option<PathBuf>,
    /// Print one JSON object on stdout
    #[arg(long)]
    pub json: bool,
    /// Override a key of the file (repeatable)
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    pub set: Vec<String>,
}

/// One line of what was understood.
#[derive(Debug, Serialize)]
struct Line {
    what: &'static str,
    value: String,
}

/// Checks the file, prints what was understood and draws the picture.
pub fn run(args: &Args) -> Result<()> {
    let document = Document::read(&args.file, &args.set)?;
    let is_calibration = document.table.contains_key("measured") || document.table.contains_key("fit");
    let case = if is_calibration { shared_part(&document)? } else { Case::from_document(&document)? };
    if let Some(path) = &args.picture {
        write_whole(path, &specimen_svg(&case))?;
    }
    let lines = understood(&case);
    if args.json {
        let kind = if is_calibration { "calibration" } else { "case" };
        let lines: serde_json::Map<String, serde_json::Value> = lines.into_iter().map(|line| (line.what.replace(' ', "_"), line.value.into())).collect();
        let report = serde_json::json!({ "ok": true, "kind": kind, "name": case.name, "understood": lines, "warnings": case.warnings, "case": case.echo });
        println!("{report:#}");
    } else {
        for line in lines {
            println!("{:<12} {}", line.what, line.value);
        }
        for warning in &case.warnings {
            eprintln!("warning: {warning}");
        }
        println!("{:<12} no errors", "check");
    }
    Ok(())
}

/// The sections a calibration shares with a case.
fn shared_part(document: &Document) -> Result<Case> {
    let mut table = document.table.clone();
    table.remove("measured");
    table.remove("fit");
    Case::from_table(table, &document.name, &document.base_dir).map_err(|error| document.locate(error))
}

/// What the program understood, one line each.
fn understood(case: &Case) -> Vec<Line> {
    let (specimen, material, loading, model, fatigue) = (&case.specimen, &case.material, &case.loading, &case.model, &case.fatigue);
    let mm = |metres: f64| short(metres / MM);
    let bond = model.bond_law;
    let load = match specimen.load_measure {
        LoadMeasure::Stress => format!("stress {} to {} MPa", short(loading.maximum * loading.ratio / MPA), short(loading.maximum / MPA)),
        LoadMeasure::Force => format!("force {} to {} kN", short(loading.maximum * loading.ratio / KN), short(loading.maximum / KN)),
    };
    let held = match specimen.supports.first() {
        None => "nothing held, loads in equilibrium",
        Some(Support::Fixed { .. }) => "held as [supports] says",
        Some(Support::ClampedEnds) => "rigid ends that cannot rotate",
        Some(Support::RigidEnds) => "rigid ends that rotate about pins",
    };
    let law = match &case.law {
        LawSource::Inline(law) => format!("a = {:e} per cycle, p = {} at horizon {} mm", law.a, law.p, mm(law.horizon)),
        LawSource::Fitted(record) => format!("a = {:e} per cycle, p = {} at horizon {} mm, fitted to {}", record.a, record.p, record.horizon_mm, record.material),
        LawSource::Missing(path) if path.as_os_str().is_empty() => "to be fitted".to_owned(),
        LawSource::Missing(path) => format!("{} does not exist yet", path.display()),
    };
    let formula = handbook(specimen).map_or_else(|| "none for this specimen".to_owned(), |formula| format!("{} ({}); {}", formula.name, formula.source, formula.range));
    let stop = if case.stop.crack_length.is_finite() { format!("crack length {} mm, or ", mm(case.stop.crack_length)) } else { String::new() };
    let lines = [
        (
            "specimen",
            format!("{}, {} x {} x {} mm (width, length, thickness)", specimen.kind, mm(specimen.gross_width), mm(specimen.length()), mm(specimen.thickness)),
        ),
        (
            "crack",
            format!(
                "length {} mm; {} cracks, {} slots, {} holes, {} tips",
                mm(specimen.crack_length),
                specimen.cracks.len(),
                specimen.slots.len(),
                specimen.holes.len(),
                specimen.tips.len()
            ),
        ),
        (
            "material",
            format!("{}: E {} GPa, nu {}, plane {}", material.name, short(material.youngs_modulus / GPA), material.poisson_ratio, material.plane),
        ),
        ("loading", format!("{load}, R = {}; {held}", loading.ratio)),
        ("bonds", format!("{}, kernel {}, rotation {}, surface correction {}", bond.kind, bond.kernel, bond.rotation, bond.surface_correction)),
        (
            "points",
            format!(
                "about {:.0} at spacing {} mm, horizon {} mm (ratio {}), solver {}",
                specimen.area() / model.spacing.powi(2),
                mm(model.spacing),
                mm(model.spacing * model.horizon_ratio),
                model.horizon_ratio,
                model.solver
            ),
        ),
        ("fatigue", law),
        (
            "ageing",
            format!("{}, zone radius {} horizons, precrack {}, block {}", fatigue.ageing, fatigue.zone_radius_horizons, fatigue.precrack, fatigue.block.kind),
        ),
        ("handbook K", formula),
        ("stop", format!("{stop}{} cycles", case.stop.cycles_max)),
    ];
    lines.into_iter().map(|(what, value)| Line { what, value }).collect()
}

/// A number with at most four decimals.
fn short(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Writes a file under a temporary name beside its place and renames it: whole or not at all.
fn write_whole(path: &Path, text: &str) -> Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let trouble = |source: std::io::Error| Error::file(path, "cannot write", source);
    let mut file = tempfile::NamedTempFile::new_in(folder).map_err(trouble)?;
    std::io::Write::write_all(&mut file, text.as_bytes()).map_err(trouble)?;
    file.persist(path).map_err(|error| trouble(error.error))?;
    Ok(())
}
