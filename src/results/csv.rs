//! Tables of a run: `a_n.csv` and `crack_path.csv`; reading `a_n.csv` back, and whether it is still what was written.
//!
//! Numbers carry at least ten significant digits; cycles are written so that they read back bit for bit.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

pub use super::digits::{exact, number};
use super::json::RESULT_FILE;
use super::units::of_table;
use perilife_base::error::{Error, InputError, Result};
use perilife_base::input::{Opened, sha256};
use perilife_base::units::us::System;
use perilife_base::units::{MM, MM_PER_CYCLE, MPA, MPA_SQRT_M};
use perilife_growth::case::Case;
use perilife_growth::predict::{CurvePoint, GoverningCrack, Prediction};
use perilife_growth::record::DepthRecord;
use perilife_plate::loading::LoadControl;
use perilife_plate::specimen::{Crack, LoadMeasure, Point};

/// Name of the table of a run's a-N curve.
pub const A_N_FILE: &str = "a_n.csv";
/// The four columns every a-N table starts with.
pub const A_N_COLUMNS: [&str; 4] = ["cycles", "crack_length_mm", "delta_k_mpa_sqrt_m", "da_dn_mm_per_cycle"];

/// One row of an a-N table, in the units of its columns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Cycles since N = 0.
    pub cycles: f64,
    /// Crack length, mm.
    pub crack_length_mm: f64,
    /// ΔK, MPa√m; NaN where unknown (an empty field).
    pub delta_k_mpa_sqrt_m: f64,
    /// da/dN, mm/cycle; NaN where unknown (an empty field).
    pub da_dn_mm_per_cycle: f64,
}

impl Row {
    /// The rows of a run.
    pub fn of_run(case: &Case, prediction: &Prediction) -> Vec<Row> {
        let governing = GoverningCrack::of(&case.specimen, &prediction.curve);
        prediction.curve.iter().map(|point| Row::of(point, &governing, case.loading.ratio)).collect()
    }

    fn of(point: &CurvePoint, governing: &GoverningCrack<'_>, ratio: f64) -> Row {
        Row {
            cycles: point.cycles,
            crack_length_mm: governing.length(point) / MM,
            delta_k_mpa_sqrt_m: governing.delta_k(point, ratio) / MPA_SQRT_M,
            da_dn_mm_per_cycle: governing.growth_rate(point) / MM_PER_CYCLE,
        }
    }

    /// The four fields as text.
    pub fn fields(&self) -> String {
        let rest = [self.crack_length_mm, self.delta_k_mpa_sqrt_m, self.da_dn_mm_per_cycle].map(number);
        format!("{},{}", exact(self.cycles), rest.join(","))
    }
}

/// Crack length, mm, and cycles of rows.
pub fn curve(rows: &[Row]) -> Vec<[f64; 2]> {
    rows.iter().map(|row| [row.crack_length_mm, row.cycles]).collect()
}

/// A column of the largest load of a cycle: its name behind a comma, and its value in a row.
type LoadColumn<'a> = (&'static str, Box<dyn Fn(&CurvePoint) -> f64 + 'a>);

/// That of a case whose load depends on the crack.
fn load_column(case: &Case) -> Option<LoadColumn<'_>> {
    let loading = &case.loading;
    let at = |point: &CurvePoint| loading.at(point.crack_length);
    Some(match (&loading.control, case.specimen.load_measure) {
        (LoadControl::Load, _) => return None,
        (LoadControl::Displacement { maximum, .. }, _) => (",force_max_n", Box::new(|point| point.work / *maximum)),
        (LoadControl::Follows(_), LoadMeasure::Force) => (",force_max_n", Box::new(at)),
        (LoadControl::Follows(_), LoadMeasure::Stress) => (",stress_max_mpa", Box::new(move |point| at(point) / MPA)),
    })
}

/// `a_n.csv`: one row per cycle block; after the four columns, of the governing crack, broken bonds, the work of the loads
/// (load squared times compliance), the load where it depends on the crack, the length of all cracks together where there are several, of a crack
/// that did not go through at the start its depth, where K does not follow the load in proportion K of the leading tip without load (K_res) and its
/// stress ratio at that of the load, and, per tip, position and growth, and K_I, K_II and T at maximum load and da/dN where they are known.
pub fn a_n(case: &Case, prediction: &Prediction) -> String {
    let (load, ratio) = (load_column(case), case.loading.ratio);
    let governing = GoverningCrack::of(&case.specimen, &prediction.curve);
    let mut text = A_N_COLUMNS.join(",");
    text.push_str(",broken_bonds,load_work_j");
    text.push_str(load.as_ref().map_or("", |(column, _)| column));
    if governing.is_of_several() {
        text.push_str(",total_crack_length_mm");
    }
    let has_depth = prediction.curve.iter().any(|point| point.depth.is_some());
    if has_depth {
        text.push_str(DEPTH_COLUMNS);
    }
    let is_shifted = prediction.curve.iter().any(|point| !point.response.is_proportional());
    if is_shifted {
        text.push_str(",k_residual_mpa_sqrt_m,stress_ratio_effective");
    }
    // Fatigue bonds, driven by their own strain know no K of a tip.
    let has_factors = prediction.curve.iter().flat_map(|point| &point.tips).any(|tip| tip.factors.is_some());
    let has_t = prediction.curve.iter().flat_map(|point| &point.tips).any(|tip| tip.t_stress.is_some());
    let has_rate = prediction.curve.iter().flat_map(|point| &point.tips).any(|tip| tip.growth_rate.is_some());
    for tip in 0..prediction.curve.first().map_or(0, |point| point.tips.len()) {
        let _ = write!(text, ",tip{tip}_x_mm,tip{tip}_y_mm,tip{tip}_growth_mm"); // writing to a String cannot fail
        if has_factors {
            let _ = write!(text, ",tip{tip}_k_i_mpa_sqrt_m,tip{tip}_k_ii_mpa_sqrt_m");
        }
        if has_t {
            let _ = write!(text, ",tip{tip}_t_stress_mpa");
        }
        if has_rate {
            let _ = write!(text, ",tip{tip}_da_dn_mm_per_cycle");
        }
    }
    text.push('\n');
    for point in &prediction.curve {
        let _ = write!(text, "{},{},{}", Row::of(point, &governing, ratio).fields(), point.broken_bonds, number(point.work));
        if let Some((_, load)) = &load {
            let _ = write!(text, ",{}", number(load(point)));
        }
        if governing.is_of_several() {
            let _ = write!(text, ",{}", number(point.crack_length / MM));
        }
        if has_depth {
            text.push_str(&depth_fields(point.depth));
        }
        if is_shifted {
            let without_load = point.delta_k / point.response.range_share(ratio) * point.response.at(0.0) / MPA_SQRT_M;
            let _ = write!(text, ",{},{}", number(without_load), number(point.response.ratio(ratio)));
        }
        for tip in &point.tips {
            for length in [tip.position[0], tip.position[1], tip.growth] {
                let _ = write!(text, ",{}", number(length / MM));
            }
            for factor in tip.factors.unwrap_or([f64::NAN; 2]).into_iter().filter(|_| has_factors) {
                let _ = write!(text, ",{}", number(factor / MPA_SQRT_M));
            }
            if has_t {
                let _ = write!(text, ",{}", number(tip.t_stress.unwrap_or(f64::NAN) / MPA));
            }
            if has_rate {
                let _ = write!(text, ",{}", number(tip.growth_rate.unwrap_or(f64::NAN) / MM_PER_CYCLE));
            }
        }
        text.push('\n');
    }
    text
}

/// Columns of a crack that did not go through at the start: its depth a, K_I at maximum load and growth rate there, empty once it is through.
const DEPTH_COLUMNS: &str = ",crack_depth_mm,depth_k_i_mpa_sqrt_m,depth_da_dn_mm_per_cycle";

fn depth_fields(depth: Option<DepthRecord>) -> String {
    let of = |pick: fn(DepthRecord) -> Option<f64>, unit: f64| number(depth.and_then(pick).unwrap_or(f64::NAN) / unit);
    let size = of(|depth| Some(depth.depth), MM);
    format!(",{size},{},{}", of(|depth| depth.k_i, MPA_SQRT_M), of(|depth| depth.growth_rate, MM_PER_CYCLE))
}

/// A table of the four columns alone.
pub fn table(rows: &[Row]) -> String {
    let lines = rows.iter().map(|row| row.fields() + "\n");
    std::iter::once(A_N_COLUMNS.join(",") + "\n").chain(lines).collect()
}

/// `crack_path.csv`: `tip,cycles,x_mm,y_mm`, one row per tip and recorded step. Each tip's rows start with the initial crack
/// it belongs to, from the far end to the tip, at N = 0; a tip at the end of a slot starts where it is.
pub fn crack_path(prediction: &Prediction, cracks: &[Crack]) -> String {
    let mut text = String::from("tip,cycles,x_mm,y_mm\n");
    for (tip, path) in paths(prediction, cracks).iter().enumerate() {
        for (cycles, [x, y]) in path {
            let _ = writeln!(text, "{tip},{},{},{}", exact(*cycles), number(x / MM), number(y / MM));
        }
    }
    text
}

/// Path of every tip: cycles and positions in metres, the initial crack's far end first.
pub fn paths(prediction: &Prediction, cracks: &[Crack]) -> Vec<Vec<(f64, Point)>> {
    let Some(first) = prediction.curve.first() else { return Vec::new() };
    let path_of = |tip: usize| {
        let grown = prediction.curve.iter().filter_map(|point| Some((point.cycles, point.tips.get(tip)?.position)));
        let start = far_end(first.tips[tip].position, cracks).map(|end| (0.0, end));
        start.into_iter().chain(grown).collect()
    };
    (0..first.tips.len()).map(path_of).collect()
}

/// Far end of the initial crack whose nearer end is this tip. The first recorded position may lie a fraction of a spacing
/// away from the drawn one, so the nearest end within a tenth of the crack's length counts.
fn far_end(tip: Point, cracks: &[Crack]) -> Option<Point> {
    let distance = |p: Point, q: Point| (p[0] - q[0]).hypot(p[1] - q[1]);
    let ends = cracks.iter().flat_map(|crack| {
        let reach = 0.1 * distance(crack.from, crack.to);
        [(crack.from, crack.to, reach), (crack.to, crack.from, reach)]
    });
    let near = ends.filter(|(near, _, reach)| distance(*near, tip) <= *reach);
    near.min_by(|a, b| distance(a.0, tip).total_cmp(&distance(b.0, tip))).map(|(_, far, _)| far)
}

/// Reads the first four columns of an a-N table this program wrote.
pub fn read_a_n(path: &Path) -> Result<Vec<Row>> {
    parse_a_n(&std::fs::read_to_string(path).map_err(|e| Error::file(path, "cannot read", e))?, path)
}

/// The same for text, in the units of its columns whichever they are; `path` is only named in messages.
pub fn parse_a_n(text: &str, path: &Path) -> Result<Vec<Row>> {
    let text = of_table(text, System::Si);
    let mut lines = text.lines();
    if !lines.next().is_some_and(|head| head.split(',').map(str::trim).take(4).eq(A_N_COLUMNS)) {
        return Err(bad_table(path, 1, None, None, "is not the header of an a-N table of this program"));
    }
    let mut rows: Vec<Row> = Vec::new();
    for (line, fields) in (2..).zip(lines) {
        let values: Vec<&str> = fields.split(',').map(str::trim).collect();
        let value = |column: usize, may_be_empty: bool| match values.get(column).copied().unwrap_or("") {
            "" if may_be_empty => Ok(f64::NAN),
            text => text
                .parse::<f64>()
                .ok()
                .filter(|x| x.is_finite())
                .ok_or_else(|| bad_table(path, line, Some(A_N_COLUMNS[column]), Some(text), "is not a number")),
        };
        let row = Row {
            cycles: value(0, false)?,
            crack_length_mm: value(1, false)?,
            delta_k_mpa_sqrt_m: value(2, true)?,
            da_dn_mm_per_cycle: value(3, true)?,
        };
        if rows.last().is_some_and(|last| row.cycles < last.cycles) {
            return Err(bad_table(path, line, Some("cycles"), Some(values[0]), "falls"));
        }
        rows.push(row);
    }
    if rows.is_empty() {
        return Err(bad_table(path, 1, None, None, "is followed by no row"));
    }
    Ok(rows)
}

/// A cell or line of a table that is not as it was written.
pub(super) fn bad_table(path: &Path, line: usize, column: Option<&str>, value: Option<&str>, problem: &str) -> Error {
    Error::Input(Box::new(InputError {
        file: Some(path.to_path_buf()),
        line: Some(line),
        key: column.map(str::to_owned),
        value: value.map(|text| format!("\"{text}\"")),
        problem: problem.to_owned(),
        remedy: "run `perilife predict` again to write the table anew".to_owned(),
        more: Vec::new(),
    }))
}

/// What a result says of one of its tables; `None` of an earlier version.
pub fn listed<'r>(result: &'r Value, name: &str) -> Option<&'r Value> {
    result["tables"].as_array().into_iter().flatten().find(|entry| entry["file"] == name)
}

/// Compares a table with the entry of a result about it.
/// Errors: one that is cut off, or not the one that was written; `by` names the file that says so.
pub fn check_listed(path: &Path, table: &[u8], entry: &Value, by: &str) -> Result<()> {
    let bytes = entry["bytes"].as_u64().unwrap_or(0);
    let problem = match table.len() as u64 {
        length if length < bytes => format!("is cut off: {length} of the {bytes} bytes that the run wrote"),
        _ if entry["sha256"] != sha256(table) => format!("is not the table that the run wrote, by {by}"),
        _ => return Ok(()),
    };
    let remedy = "copy the folder again, or run the case again".to_owned();
    Err(Error::Input(Box::new(InputError { file: Some(path.to_path_buf()), problem, remedy, ..InputError::default() })))
}

/// Compares a table with what `result.json` beside it says of it; without that file there is nothing to compare with.
pub fn check_whole(folder: &Path, name: &str, table: &[u8], opened: &Opened) -> Result<()> {
    let (path, beside) = (folder.join(name), folder.join(RESULT_FILE));
    let refuse = |problem: String| {
        let remedy = "copy the folder again, or run the case again".to_owned();
        let error = InputError { file: Some(path.clone()), problem, remedy, ..InputError::default() };
        Err(Error::Input(Box::new(error)))
    };
    if !beside.is_file() {
        return Ok(());
    }
    let Ok(result) = serde_json::from_slice::<Value>(&opened.read(&beside, RESULT_FILE)?) else {
        return refuse(format!("stands beside a {RESULT_FILE} that is cut off or damaged"));
    };
    if let Some(entry) = listed(&result, name) {
        return check_listed(&path, table, entry, RESULT_FILE);
    }
    // A run of an earlier version says its life alone.
    let last = parse_a_n(&String::from_utf8_lossy(table), &path)?.last().map(|row| row.cycles);
    match (result["life_cycles"].as_f64(), last) {
        (Some(life), Some(last)) if last < life => refuse(format!("ends at {last} cycles, and the run at {life}")),
        _ => Ok(()),
    }
}
