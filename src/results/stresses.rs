//! Stresses of a plate on nodes: `result.json`, `stress.svg`, `nodes.svg` and ParaView files.

use std::fmt::Write as _;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::output::{Room, write_file, write_json};
use super::pictures::stress::stress_svg;
use super::specimen_picture::nodes_svg;
use super::{provenance, record::RESULT_FILE, snapshots};
use perilife_base::error::Result;
use perilife_base::raster::Snapshot;
use perilife_base::units::shown::{column, per, told};
use perilife_base::units::{MM, MPA};
use perilife_growth::case::{Case, Model};
use perilife_growth::predict::moment::StressField;
use perilife_growth::stress_concentration::{SETTLED, Stressed};
use perilife_nodes::resolution::ElementFreeSettings;
use perilife_nodes::rim_stress::{Rim, RimStress, StressAt};

/// A rim in words: `holes[0]`, `notches[0]`, `outline`, as its key in `[specimen]`.
fn name(rim: Rim) -> String {
    match rim {
        Rim::Hole(index) => format!("holes[{index}]"),
        Rim::Slot(index) => format!("notches[{index}]"),
        Rim::Outline => "outline".to_owned(),
    }
}

/// Every rim with its largest and least stress, where they are, and the same over the gross stress.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StressesRecord {
    pub gross_stress_mpa: Option<f64>,
    pub rims: Vec<RimRecord>,
    pub last_change_percent: Option<f64>,
    pub largest_displacement: Displacement,
    pub nodes: usize,
    pub unknowns: usize,
    pub solves: usize,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RimRecord {
    pub rim: String,
    pub largest: StressRecord,
    pub least: StressRecord,
    pub has_sharp_corner: bool,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StressRecord {
    pub stress_mpa: f64,
    pub x_mm: f64,
    pub y_mm: f64,
    pub stress_concentration: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Displacement {
    pub mm: f64,
    pub x_mm: f64,
    pub y_mm: f64,
}

impl StressesRecord {
    pub fn of(stressed: &Stressed) -> Self {
        let place = |StressAt { at: [x, y], stress }: StressAt| StressRecord {
            stress_mpa: stress / MPA,
            x_mm: x / MM,
            y_mm: y / MM,
            stress_concentration: stressed.concentration(stress),
        };
        let rim = |rim: &RimStress| RimRecord {
            rim: name(rim.rim),
            largest: place(rim.largest),
            least: place(rim.least),
            has_sharp_corner: rim.is_sharp,
        };
        let (moved, [x, y]) = stressed.moved;
        StressesRecord {
            gross_stress_mpa: stressed.gross.map(|gross| gross / MPA),
            rims: stressed.rims.iter().map(rim).collect(),
            last_change_percent: stressed.change.map(|change| 100.0 * change),
            largest_displacement: Displacement { mm: moved / MM, x_mm: x / MM, y_mm: y / MM },
            nodes: stressed.nodes,
            unknowns: stressed.unknowns,
            solves: stressed.solves,
        }
    }
}

pub fn table(stressed: &Stressed) -> String {
    let [x, y] = ["x_mm", "y_mm"].map(column);
    let [largest, least] = ["largest MPa", "least MPa"].map(told);
    let mut text = format!(
        "{:<12} {largest:>12} {over:>10} {x:>10} {y:>10} {least:>12} {over:>10} {x:>10} {y:>10}\n",
        "rim",
        over = "over gross"
    );
    let [mpa, mm] = [MPA / per("MPa"), MM / per("mm")];
    let over = |stress: f64| stressed.concentration(stress).map_or_else(|| "-".to_owned(), |share| format!("{share:.4}"));
    for rim in &stressed.rims {
        let mut words = String::new();
        for StressAt { at: [x, y], stress } in [rim.largest, rim.least] {
            // Writing to a String cannot fail.
            let _ = write!(words, " {:>12.3} {:>10} {:>10.4} {:>10.4}", stress / mpa, over(stress), x / mm, y / mm);
        }
        let _ = writeln!(text, "{:<12}{words}", name(rim.rim));
    }
    text
}

pub fn words(case: &Case, stressed: &Stressed) -> String {
    let gross = stressed.gross.map_or(String::new(), |gross| format!(", gross stress {:.3} MPa", gross / MPA));
    let settled = stressed.change.map_or(String::new(), |change| format!(", last change {:.2} %", 100.0 * change));
    let (nodes, solves, moved) = (stressed.nodes, stressed.solves, stressed.moved.0 / MM);
    format!("{}: {nodes} nodes after {solves} solves{settled}{gross}; largest displacement {moved:.6} mm", case.name)
}

pub fn warnings(stressed: &Stressed) -> Vec<String> {
    let sharp: Vec<String> = stressed.rims.iter().filter(|rim| rim.is_sharp).map(|rim| name(rim.rim)).collect();
    let mut warnings = Vec::new();
    if !sharp.is_empty() {
        warnings.push(format!(
            "stress: {}: elastic stress at a sharp corner is singular: the value depends on the nodes; draw the \
             corner with its radius, as several corners of outline_mm",
            sharp.join(", ")
        ));
    }
    if let (false, Some(change)) = (stressed.is_settled(), stressed.change) {
        warnings.push(format!(
            "stress: the largest stress of an edge still changed by {:.2} % in the last refinement (target {} %); give more \
             model.nodes",
            100.0 * change,
            100.0 * SETTLED
        ));
    }
    warnings
}

pub fn room(case: &Case) -> Room {
    const OF_POINT: f64 = 60.0;
    let points = 100.0 * case.specimen.area() / case.nodes().resolution.far.powi(2);
    let of_fields = if case.output.paraview { (OF_POINT * points) as u64 } else { 0 };
    Room { tables: 64_000, all: 500_000 + of_fields }
}

/// Writes all files into `folder`; `result` is the content of `result.json` but for what made it.
pub fn write(folder: &Path, case: &Case, stressed: &Stressed, result: &Value) -> Result<()> {
    let mut result = result.clone();
    provenance::add(&mut result, &case.provenance, []);
    write_json(folder, RESULT_FILE, &result)?;
    let command = "sif --method element_free_galerkin";
    provenance::write(folder, command, provenance::table_of(&case.echo), &case.provenance)?;
    if !case.output.tables_only {
        let field = StressField { cycles: 0.0, cracks: case.specimen.crack_lines(), pieces: stressed.pieces.clone() };
        write_file(&folder.join("stress.svg"), stress_svg(&field, &case.material, &case.specimen.holes).as_bytes())?;
        let mut of_nodes = case.clone();
        of_nodes.model = Model::Nodes(ElementFreeSettings { resolution: stressed.resolution, ..case.nodes() });
        write_file(&folder.join("nodes.svg"), nodes_svg(&of_nodes, &[])?.as_bytes())?;
    }
    let snapshot = Snapshot {
        cycles: 0.0,
        crack_length: case.specimen.crack_length,
        displacement: stressed.displacement.clone(),
        damage: vec![0.0; stressed.displacement.len()],
        remaining_life: Vec::new(),
        stress: stressed.stress.clone(),
    };
    snapshots::write_wanted(folder, case.output, &stressed.grid, &[snapshot])
}
