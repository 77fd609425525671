//! `perilife rates`: da/dN against ΔK from measured a-N curves.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use toml::Table;

use super::console::Console;
use perilife_base::error::{Result, input};
use perilife_base::input::{Document, Folder, Opened, STREAM, number};
use perilife_base::table::units::{CycleUnit, LengthUnit, LoadUnit};
use perilife_base::table::{Decimal, Sheet};
use perilife_base::units::shown::{column, per};
use perilife_base::units::{MM, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_calibration::case::completed;
use perilife_calibration::outliers::doubts;
use perilife_calibration::paris::implausibility_of;
use perilife_calibration::rates::{HEADER, RateMethod, RatePoint, add_delta_k, paris_line, rates, table, threshold};
use perilife_growth::case::{Case, library_law};
use perilife_measured::{ColumnNames, Import, Measured, MeasuredCurve, first_of, ratio_warnings, read_into};
use perilife_plate::specimen::handbook::{HandbookFormula, handbook};
use perilife_results::chart::{Mark, Series, growth_rate};
use perilife_results::output::{OutputFile, Sort};

/// Thickness of plates where no case says it, mm: K_c of records depends on it.
const THICKNESS_MM: f64 = 2.5;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Files of a-N readings
    #[arg(value_name = "MEASURED.csv", required_unless_present = "materials")]
    pub measured: Vec<PathBuf>,
    /// Compare with these materials: names, files, folders, fitted.toml
    #[arg(long, value_name = "NAME", num_args = 1.., help_heading = "Input")]
    pub materials: Vec<String>,
    /// Stress ratio of these laws [default: that of --specimen]
    #[arg(long, value_name = "R", requires = "materials", help_heading = "Input")]
    pub stress_ratio: Option<f64>,
    /// Chart of these laws and the rates (SVG)
    #[arg(long, value_name = "FILE.svg", requires = "materials", help_heading = "Output")]
    pub picture: Option<PathBuf>,
    /// Case or calibration with specimen and load (needed for ΔK)
    #[arg(long, value_name = "CASE.toml", help_heading = "Input")]
    pub specimen: Option<PathBuf>,
    /// Set a key of that file (repeatable)
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input", requires = "specimen")]
    pub set: Vec<String>,
    /// Crack length unit if the header has none: mm, inch, m
    #[arg(long, value_name = "UNIT", help_heading = "Input")]
    pub length_unit: Option<String>,
    /// Precision of a crack length, mm [default: scatter of the readings]
    #[arg(long, value_name = "MM", help_heading = "Input")]
    pub precision_mm: Option<f64>,
    /// Cycle unit if the header has none: cycles, kilocycles, megacycles
    #[arg(long, value_name = "UNIT", help_heading = "Input")]
    pub cycle_unit: Option<String>,
    /// Load unit if the header has none: N, kN, lbf, kip, kgf, MPa, ksi
    #[arg(long, value_name = "UNIT", help_heading = "Input")]
    pub load_unit: Option<String>,
    /// Assign a column by name or number (repeatable): length="a (in)"
    #[arg(long = "column", value_name = "KEY=NAME", help_heading = "Input")]
    pub columns: Vec<String>,
    /// Decimal separator if ambiguous: . or ,
    #[arg(long, value_name = "SIGN", help_heading = "Input")]
    pub decimal: Option<String>,
    /// Workbook sheet, by name or number
    #[arg(long, value_name = "SHEET", help_heading = "Input")]
    pub sheet: Option<String>,
    /// Rate method (ASTM E647): secant or polynomial7
    #[arg(long, value_name = "METHOD", default_value = "polynomial7", help_heading = "Method")]
    pub method: String,
    /// CSV file to write [default: stdout]
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub console: Console,
}

struct SpecimenRates {
    name: String,
    points: Vec<RatePoint>,
    /// What speaks against its readings, and its law.
    warnings: Vec<String>,
}

impl Args {
    fn import(&self) -> Result<Import> {
        let mut columns = ColumnNames::default();
        self.columns.iter().try_for_each(|column| columns.put(column))?;
        Ok(Import {
            length: self.length_unit.as_deref().map(str::parse::<LengthUnit>).transpose()?,
            cycles: self.cycle_unit.as_deref().map(str::parse::<CycleUnit>).transpose()?,
            load: self.load_unit.as_deref().map(str::parse::<LoadUnit>).transpose()?,
            columns,
            decimal: self.decimal.as_deref().map(str::parse::<Decimal>).transpose()?,
            sheet: self.sheet.clone().map(Sheet),
            ..Import::default()
        })
    }
}

pub fn run(args: &Args) -> Result<()> {
    let method: RateMethod = args.method.parse()?;
    let opened = Opened::default();
    let measured =
        if args.measured.is_empty() { Measured::default() } else { read_into(&opened, &args.measured, &args.import()?)? };
    let mut measured = measured.of_precision("--precision-mm", args.precision_mm)?;
    let case = args.specimen.as_deref().map(|path| specimen(path, &args.set, &mut measured)).transpose()?;
    if let Some(case) = &case {
        measured.compare_with(&case.specimen, &case.material, &case.loading)?;
        measured.warnings.extend(ratio_warnings(&measured.curves, &case.loading));
    }
    let specimens = specimen_rates(&measured, method, case.as_ref())?;
    let ratio = args.stress_ratio.or(case.as_ref().map(|case| case.loading.ratio)).unwrap_or(0.0);
    let ratio = number("a ratio", -2.0, 0.99).read("stress_ratio", ratio)?;
    let thickness_mm = case.as_ref().map_or(THICKNESS_MM, |case| case.specimen.thickness / MM);
    let (materials, of_materials) = MaterialRates::all(&args.materials, ratio, thickness_mm)?;
    if let Some(path) = &args.picture {
        let points = specimens.iter().flat_map(|specimen| &specimen.points);
        let in_units = |point: &RatePoint| (point.delta_k / MPA_SQRT_M, point.rate / MM_PER_CYCLE);
        draw(path, &materials, ratio, points.map(in_units).collect())?;
    }
    if !materials.is_empty() {
        args.console.say(&materials_table(&materials, ratio));
    }
    let of_specimens = first_of(specimens.iter().flat_map(|specimen| specimen.warnings.iter().cloned()).collect());
    for warning in of_materials.iter().chain(&measured.warnings).chain(&of_specimens) {
        args.console.warn(warning);
    }
    let table = table(specimens.iter().flat_map(|one| one.points.iter().map(|point| (&*one.name, point))));
    match &args.out {
        Some(path) => {
            let mut read = opened.so_far();
            read.files.extend(case.iter().flat_map(|case| case.provenance.files.clone()));
            let sort = Sort { option: "--out", sign: HEADER.as_bytes() };
            OutputFile::claim(path, sort, &read)?.write(table.csv().as_bytes())?;
        }
        None => args.console.result(&table.csv())?,
    }
    if args.out.as_deref().is_some_and(|path| path != Path::new(STREAM)) {
        specimens.iter().for_each(|specimen| args.console.say(&specimen.summary()));
    }
    args.console.object(&object(&specimens, method))
}

/// The case of `--specimen`; the load and crack length that it does not give are those of the readings.
fn specimen(path: &Path, set: &[String], measured: &mut Measured) -> Result<Case> {
    let document = Document::read(path, set)?;
    let plate = |table: &Table| {
        let mut own = document.clone();
        own.table.clone_from(table);
        let case = Case::plate_of(&own)?;
        case.specimen.check_growth().map(|()| case)
    };
    let of_readings =
        completed(&mut document.table.clone(), &plate, &|| Ok(measured.clone()), &|read: &Measured| Ok(read.clone()));
    let (case, notes) = of_readings.map_err(|error| document.locate(error))?;
    measured.warnings.extend(notes);
    Ok(case)
}

fn specimen_rates(measured: &Measured, method: RateMethod, case: Option<&Case>) -> Result<Vec<SpecimenRates>> {
    let of_curve = |curve: &MeasuredCurve| SpecimenRates {
        name: curve.specimen.clone(),
        points: rates(curve, method),
        warnings: Vec::new(),
    };
    let mut specimens: Vec<SpecimenRates> = measured.curves.iter().map(of_curve).collect();
    let Some(case) = case else { return Ok(specimens) };
    let Some(formula) = handbook(&case.specimen) else {
        let remedy = "give a standard specimen whose length is at least 1.5 widths, or remove --specimen";
        return Err(input("specimen.kind", case.specimen.kind, "has no handbook K(a)", remedy));
    };
    let delta_k = |length: f64| formula.delta_k(length, case.loading.maximum, case.loading.range_share());
    for (specimen, curve) in specimens.iter_mut().zip(&measured.curves) {
        add_delta_k(&mut specimen.points, case, &delta_k);
        let law = paris_line(&specimen.points).and_then(|law| implausibility_of(10_f64.powf(law.intercept), law.slope));
        let named = |name: &'static str| move |words: String| format!("{name}: specimen {}: {words}", curve.specimen);
        let of_law = law.map(named("units"));
        let outside = outside_formula(&specimen.points, &formula).map(named("formula range"));
        let slow = specimen.threshold().map(|(_, words)| named("threshold")(words));
        specimen.warnings = doubts(curve, &delta_k).into_iter().chain(of_law).chain(outside).chain(slow).collect();
    }
    Ok(specimens)
}

/// What is to be said of rates at lengths that the formula for K is not made for.
fn outside_formula(points: &[RatePoint], formula: &HandbookFormula) -> Option<String> {
    let outside: Vec<f64> =
        points.iter().map(|point| point.crack_length).filter(|length| !formula.holds_at(*length)).map(|a| a / MM).collect();
    let (low, high) = (outside.iter().copied().fold(f64::INFINITY, f64::min), outside.iter().copied().fold(0.0, f64::max));
    let share = 100.0 * outside.len() as f64 / points.len() as f64;
    (!outside.is_empty()).then(|| {
        format!(
            "{} of {} rates ({share:.1} %), at crack lengths from {low:.3} to {high:.3} mm, are outside the range of {} ({})",
            outside.len(),
            points.len(),
            formula.name,
            formula.range
        )
    })
}

fn object(specimens: &[SpecimenRates], method: RateMethod) -> Value {
    let points = |specimen: &SpecimenRates| -> Vec<Value> {
        let point = |point: &RatePoint| {
            json!({
                "cycles": point.cycles,
                "crack_length_mm": point.crack_length / MM,
                "delta_k_mpa_sqrt_m": point.delta_k / MPA_SQRT_M,
                "da_dn_mm_per_cycle": point.rate / MM_PER_CYCLE,
                "stress_ratio": point.ratio,
                "flags": point.flags.words().split_whitespace().collect::<Vec<_>>(),
            })
        };
        specimen.points.iter().map(point).collect()
    };
    let specimen = |specimen: &SpecimenRates| {
        let law = paris_line(&specimen.points);
        json!({
            "name": specimen.name,
            "paris_c_mm_per_cycle": law.map(|law| 10_f64.powf(law.intercept)),
            "paris_m": law.map(|law| law.slope),
            "scatter_decades": law.map(|law| law.scatter),
            "delta_k_threshold_mpa_sqrt_m": specimen.threshold().map(|(k, _)| k),
            "flagged": specimen.flagged(),
            "warnings": specimen.warnings,
            "points": points(specimen),
        })
    };
    json!({ "method": method.name(), "specimens": specimens.iter().map(specimen).collect::<Vec<_>>() })
}

impl SpecimenRates {
    fn flagged(&self) -> usize {
        self.points.iter().filter(|point| point.flags.any()).count()
    }

    /// ΔK_th of the rates that count.
    fn threshold(&self) -> Option<(f64, String)> {
        let good = self.points.iter().filter(|point| !point.flags.any());
        threshold(good.map(|point| (point.delta_k / MPA_SQRT_M, point.rate / MM_PER_CYCLE)))
    }

    fn summary(&self) -> String {
        let start = format!("{}: {} rates, {} of them flagged", self.name, self.points.len(), self.flagged());
        match paris_line(&self.points) {
            None => start,
            Some(law) => {
                let c = 10_f64.powf(law.intercept);
                format!("{start}; da/dN = {c:.4e} ΔK^{:.4} (mm/cycle, MPa√m), scatter {:.4} decades", law.slope, law.scatter)
            }
        }
    }
}

/// ΔK between which a law is drawn, MPa√m, and the points over them.
const RANGE: [f64; 2] = [1.0, 200.0];
const POINTS: usize = 240;
/// Rates beyond which nothing is drawn, mm/cycle.
const RATES: [f64; 2] = [1e-8, 1e-1];
/// ΔK of the table, MPa√m.
const LISTED: [f64; 4] = [5.0, 10.0, 20.0, 30.0];

/// One law over ΔK.
pub struct MaterialRates {
    name: String,
    /// ΔK, MPa√m, and da/dN, mm/cycle.
    points: Vec<(f64, f64)>,
    listed: [Option<f64>; 4],
}

impl MaterialRates {
    /// Of materials by name, or by the path of a file, a `fitted.toml` too, or of a folder of files, at a stress ratio and a thickness, mm; and what is to be said of
    /// them, and of those that cannot be drawn.
    /// Errors: as [`library_law`], where none can be drawn.
    pub fn all(names: &[String], ratio: f64, thickness_mm: f64) -> Result<(Vec<MaterialRates>, Vec<String>)> {
        let folder = Folder::from(Path::new(""));
        let (mut all, mut lines, mut first) = (Vec::new(), Vec::new(), None);
        for name in names.iter().flat_map(|name| files(name)) {
            let (law, fitted) = match library_law(&name, thickness_mm * MM, ratio, &folder) {
                Ok(found) => found,
                Err(error) => {
                    lines.push(format!("rates: {name}: no growth rates: {error}"));
                    first = first.or(Some(error));
                    continue;
                }
            };
            lines.extend(law.beyond_ratio(ratio).map(|words| format!("rates: {name}: {words}")));
            let k_max = |delta_k: f64| delta_k * MPA_SQRT_M / (1.0 - ratio.max(0.0));
            let rate = |delta_k: f64| law.rate(k_max(delta_k), ratio) / MM_PER_CYCLE;
            let at = |k: usize| RANGE[0] * (RANGE[1] / RANGE[0]).powf(k as f64 / POINTS as f64);
            let is_fitted = |k: f64| (fitted[0]..=fitted[1]).contains(&(k * MPA_SQRT_M));
            let known = |(k, rate): &(f64, f64)| {
                is_fitted(*k) && (RATES[0]..=RATES[1]).contains(rate) && law.beyond(k_max(*k), ratio).is_none()
            };
            let points = (0..=POINTS).map(|k| (at(k), rate(at(k)))).filter(known).collect();
            let listed = LISTED.map(|k| Some(k / per("MPa√m")).filter(|k| is_fitted(*k)).map(rate));
            all.push(MaterialRates { name, points, listed });
        }
        match first {
            Some(error) if all.is_empty() => Err(error),
            _ => Ok((all, lines)),
        }
    }
}

/// A name itself, or every material file of a folder.
fn files(name: &str) -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(name) else { return vec![name.to_owned()] };
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut files: Vec<String> =
        paths.filter(|path| path.extension().is_some_and(|end| end == "toml")).map(|path| path.display().to_string()).collect();
    files.sort();
    files
}

/// A line a material: rates at some ΔK, these in the unit that is shown.
pub fn materials_table(materials: &[MaterialRates], ratio: f64) -> String {
    let head: String = LISTED.iter().map(|k| format!(",{}", column(&format!("da_dn_at_{k}_mm_per_cycle")))).collect();
    let row = |one: &MaterialRates| {
        format!(
            "{},{ratio}{}\n",
            one.name,
            one.listed
                .iter()
                .map(|rate| rate.map_or(",".to_owned(), |rate| format!(",{:.4e}", rate * per("mm/cycle"))))
                .collect::<String>()
        )
    };
    format!("material,stress_ratio{head}\n{}", materials.iter().map(row).collect::<String>())
}

/// Laws as lines, measured rates `(ΔK, da/dN)` as circles.
pub fn draw(path: &Path, materials: &[MaterialRates], ratio: f64, measured: Vec<(f64, f64)>) -> Result<()> {
    let mut series: Vec<Series> =
        materials.iter().map(|one| Series { name: one.name.clone(), mark: Mark::Line, points: one.points.clone() }).collect();
    if !measured.is_empty() {
        series.push(Series { name: "measured".to_owned(), mark: Mark::Circles, points: measured });
    }
    growth_rate(path, &format!("Growth rates at R = {ratio}"), &series)
}
