//! Tables of a run of cycles, `a_n.csv` and `crack_path.csv`, and what is drawn and asked of them.
//!
//! At chosen cycles, a monotone cubic of crack length ([`Monotone`]) between two rows: rows lie up to 1.5 horizons apart, and on straight lines
//! between them cycles were read up to 2.5 % short at a quarter of the growth. ΔK and da/dN are linear in crack length; the ends are kept.

use std::borrow::Cow;
use std::path::Path;

use perilife_base::columns::Table;
use perilife_base::error::{Error, Result, fail_if, input};
use perilife_base::monotone::Monotone;
use perilife_base::units::{MM, MM_PER_CYCLE, MPA, MPA_SQRT_M};
use perilife_calibration::population::plate::{PlateBand, Quantiles};
use perilife_growth::case::Case;
use perilife_growth::predict::{CurvePoint, GoverningCrack, Prediction};
use perilife_growth::record::TipRecord;
use perilife_plate::loading::LoadControl;
use perilife_plate::specimen::geometry::distance;
use perilife_plate::specimen::{Crack, LoadMeasure, Point};

pub const A_N_FILE: &str = "a_n.csv";
pub const CRACK_PATH_FILE: &str = "crack_path.csv";
/// The four columns every a-N table starts with.
pub const A_N_COLUMNS: [&str; 4] = ["cycles", "crack_length_mm", "delta_k_mpa_sqrt_m", "da_dn_mm_per_cycle"];
/// Columns of a band: cycles at which 5, 50 and 95 % of specimens have reached the length, and cycles that so many do not live on from there
/// to the end of the run.
pub const BAND_COLUMNS: [&str; 6] =
    ["cycles_p05", "cycles_p50", "cycles_p95", "remaining_cycles_p05", "remaining_cycles_p50", "remaining_cycles_p95"];

/// One row of an a-N table, in the units of its columns; NaN where ΔK and rate are not known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    pub cycles: f64,
    pub crack_length_mm: f64,
    pub delta_k_mpa_sqrt_m: f64,
    pub da_dn_mm_per_cycle: f64,
}

impl Row {
    /// The rows of a run, of its governing crack.
    pub fn of_run(case: &Case, prediction: &Prediction) -> Vec<Row> {
        let governing = GoverningCrack::of(&case.specimen, &prediction.curve);
        let of = |point: &CurvePoint| Row {
            cycles: point.cycles,
            crack_length_mm: governing.length(point) / MM,
            delta_k_mpa_sqrt_m: governing.delta_k(point, case.loading.ratio) / MPA_SQRT_M,
            da_dn_mm_per_cycle: governing.growth_rate(point) / MM_PER_CYCLE,
        };
        prediction.curve.iter().map(of).collect()
    }

    /// The rows of a table.
    /// Errors: one that is no a-N table, has no row, or whose cycles fall; a cell that is no number.
    pub fn of_table(table: &Table) -> Result<Vec<Row>> {
        if !A_N_COLUMNS.iter().all(|column| table.has(column)) {
            return Err(table.bad(1, None, None, "is not the header of an a-N table of this program"));
        }
        let [cycles, lengths] = [table.full(A_N_COLUMNS[0])?, table.full(A_N_COLUMNS[1])?];
        let [delta_k, rates] = [table.get(A_N_COLUMNS[2])?, table.get(A_N_COLUMNS[3])?];
        if let Some(fall) = cycles.windows(2).position(|pair| pair[1] < pair[0]) {
            return Err(table.bad(fall + 3, Some(A_N_COLUMNS[0]), Some(&cycles[fall + 1].to_string()), "falls"));
        }
        fail_if!(cycles.is_empty(), table.bad(1, None, None, "is followed by no row"));
        let row = |i: usize| Row {
            cycles: cycles[i],
            crack_length_mm: lengths[i],
            delta_k_mpa_sqrt_m: delta_k[i],
            da_dn_mm_per_cycle: rates[i],
        };
        Ok((0..cycles.len()).map(row).collect())
    }
}

/// Crack length, mm, and cycles of rows.
pub fn curve(rows: &[Row]) -> Vec<[f64; 2]> {
    rows.iter().map(|row| [row.crack_length_mm, row.cycles]).collect()
}

pub fn table(rows: &[Row]) -> Table {
    let column = |of: fn(&Row) -> f64| rows.iter().map(of);
    Table::new(A_N_FILE)
        .exact(A_N_COLUMNS[0], column(|row| row.cycles))
        .numbers(A_N_COLUMNS[1], column(|row| row.crack_length_mm))
        .numbers(A_N_COLUMNS[2], column(|row| row.delta_k_mpa_sqrt_m))
        .numbers(A_N_COLUMNS[3], column(|row| row.da_dn_mm_per_cycle))
}

/// `a_n.csv`: one row per cycle block. After the four columns, of the governing crack: broken bonds; the work of the loads (load squared times
/// compliance); the load where it depends on the crack; the length of all cracks together where there are several; of a crack that did not
/// go through at the start depth, K_I and rate there; where K does not follow the load in proportion K of the leading tip without load (K_res)
/// and its stress ratio at that of the load; per tip position and growth, and K_I, K_II and T at maximum load and da/dN where they are known;
/// the band of the specimens.
pub fn a_n(case: &Case, prediction: &Prediction, band: Option<&PlateBand>) -> Table {
    let (points, ratio) = (&prediction.curve, case.loading.ratio);
    let mut all = table(&Row::of_run(case, prediction))
        .counts("broken_bonds", points.iter().map(|point| point.broken_bonds))
        .numbers("load_work_j", points.iter().map(|point| point.work));
    let loading = &case.loading;
    match (&loading.control, case.specimen.load_measure) {
        (LoadControl::Load, _) => {}
        (LoadControl::Displacement { maximum, .. }, _) => {
            all = all.numbers("force_max_n", points.iter().map(|point| point.work / maximum));
        }
        (LoadControl::Follows(_), measure) => {
            let (name, unit) = if measure == LoadMeasure::Force { ("force_max_n", 1.0) } else { ("stress_max_mpa", MPA) };
            all = all.numbers(name, points.iter().map(|point| loading.at(point.crack_length) / unit));
        }
    }
    if GoverningCrack::of(&case.specimen, points).is_of_several() {
        all = all.numbers("total_crack_length_mm", points.iter().map(|point| point.crack_length / MM));
    }
    if points.iter().any(|point| point.depth.is_some()) {
        let depths = || points.iter().map(|point| point.depth);
        all = all
            .numbers("crack_depth_mm", depths().map(|depth| Some(depth?.depth / MM)))
            .numbers("depth_k_i_mpa_sqrt_m", depths().map(|depth| Some(depth?.k_i? / MPA_SQRT_M)))
            .numbers("depth_da_dn_mm_per_cycle", depths().map(|depth| Some(depth?.growth_rate? / MM_PER_CYCLE)));
    }
    if points.iter().any(|point| !point.response.is_proportional()) {
        let without_load = |point: &CurvePoint| point.delta_k / point.response.range_share(ratio) * point.response.at(0.0);
        all = all
            .numbers("k_residual_mpa_sqrt_m", points.iter().map(|point| without_load(point) / MPA_SQRT_M))
            .numbers("stress_ratio_effective", points.iter().map(|point| point.response.ratio(ratio)));
    }
    // Fatigue bonds, driven by their own strain know no K of a tip.
    let is_known = |of: fn(&TipRecord) -> bool| points.iter().flat_map(|point| &point.tips).any(of);
    let [has_factors, has_t, has_rate] = [
        is_known(|tip| tip.factors.is_some()),
        is_known(|tip| tip.t_stress.is_some()),
        is_known(|tip| tip.growth_rate.is_some()),
    ];
    for tip in 0..points.first().map_or(0, |point| point.tips.len()) {
        let name = |what: &str| Cow::Owned(format!("tip{tip}_{what}"));
        let of =
            |value: &dyn Fn(&TipRecord) -> Option<f64>| points.iter().map(|point| value(&point.tips[tip])).collect::<Vec<_>>();
        all = all
            .numbers(name("x_mm"), of(&|tip| Some(tip.position[0] / MM)))
            .numbers(name("y_mm"), of(&|tip| Some(tip.position[1] / MM)))
            .numbers(name("growth_mm"), of(&|tip| Some(tip.growth / MM)));
        if has_factors {
            all = all
                .numbers(name("k_i_mpa_sqrt_m"), of(&|tip| Some(tip.factors?[0] / MPA_SQRT_M)))
                .numbers(name("k_ii_mpa_sqrt_m"), of(&|tip| Some(tip.factors?[1] / MPA_SQRT_M)));
        }
        if has_t {
            all = all.numbers(name("t_stress_mpa"), of(&|tip| Some(tip.t_stress? / MPA)));
        }
        if has_rate {
            all = all.numbers(name("da_dn_mm_per_cycle"), of(&|tip| Some(tip.growth_rate? / MM_PER_CYCLE)));
        }
    }
    let Some(band) = band else { return all };
    let quantile = |of: &[Quantiles], end: usize| of.iter().map(|quantiles| quantiles[end]).collect::<Vec<_>>();
    BAND_COLUMNS
        .iter()
        .enumerate()
        .fold(all, |all, (place, name)| all.exact(*name, quantile(if place < 3 { &band.reached } else { &band.left }, place % 3)))
}

/// `crack_path.csv`: `tip,cycles,x_mm,y_mm`, one row per tip and recorded step. Each tip's rows start with the initial crack
/// it belongs to, from the far end to the tip, at N = 0; a tip at the end of a slot starts where it is.
pub fn crack_path(prediction: &Prediction, cracks: &[Crack]) -> Table {
    let paths = paths(prediction, cracks);
    let rows = || paths.iter().enumerate().flat_map(|(tip, path)| path.iter().map(move |row| (tip, row)));
    Table::new(CRACK_PATH_FILE)
        .counts("tip", rows().map(|(tip, _)| tip))
        .exact("cycles", rows().map(|(_, (cycles, _))| *cycles))
        .numbers("x_mm", rows().map(|(_, (_, [x, _]))| x / MM))
        .numbers("y_mm", rows().map(|(_, (_, [_, y]))| y / MM))
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
    let ends = cracks.iter().flat_map(|crack| {
        let reach = 0.1 * distance(crack.from, crack.to);
        [(crack.from, crack.to, reach), (crack.to, crack.from, reach)]
    });
    let near = ends.filter(|(near, _, reach)| distance(*near, tip) <= *reach);
    near.min_by(|a, b| distance(a.0, tip).total_cmp(&distance(b.0, tip))).map(|(_, far, _)| far)
}

/// Reads an a-N table that this program wrote, in either units.
pub fn read_a_n(path: &Path) -> Result<Vec<Row>> {
    let text = std::fs::read_to_string(path).map_err(|error| Error::file(path, "cannot read", error))?;
    Row::of_table(&Table::read(&text, path)?)
}

/// What is left at every row of a table with a band; `None` of one without.
pub fn left_of_table(table: &Table) -> Result<Option<Vec<Quantiles>>> {
    let [low, middle, high] = [3, 4, 5].map(|place| table.optional(BAND_COLUMNS[place]));
    let Some(((low, middle), high)) = low?.zip(middle?).zip(high?) else { return Ok(None) };
    Ok(Some((0..low.len()).map(|row| [low[row], middle[row], high[row]]).collect()))
}

#[derive(Debug, Clone, PartialEq, Default)]
pub struct TipRows {
    pub growth_mm: Vec<f64>,
    /// K_I and K_II at maximum load, MPa√m; NaN where nobody read them.
    pub factors: Vec<[f64; 2]>,
}

/// What both tables say, for pictures.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunTables {
    pub rows: Vec<Row>,
    pub tips: Vec<TipRows>,
    /// Cycles at which 5 and 95 % of specimens have reached the length of a row; `None` without a band.
    pub band: Option<Vec<[f64; 2]>>,
    /// Depth of a crack that did not go through at the start, mm, NaN once it is through; `None` of others.
    pub depths_mm: Option<Vec<f64>>,
    /// K_I at the deepest point, MPa√m, likewise.
    pub depth_factors: Option<Vec<f64>>,
    /// Of every tip: cycles, x and y, mm; the far end of its initial crack first.
    pub paths: Vec<Vec<[f64; 3]>>,
}

impl RunTables {
    /// Errors: a cell that is not as the run wrote it, by file, line, column and value.
    pub fn of(curve: &Table, path: &Table) -> Result<Self> {
        let rows = Row::of_table(curve)?;
        let count = (0..).take_while(|tip| curve.has(&format!("tip{tip}_growth_mm"))).count();
        let of_tip = |tip: usize| {
            let growth_mm = curve.get(&format!("tip{tip}_growth_mm"))?.into_owned();
            let [first, second] = ["k_i", "k_ii"].map(|k| curve.optional(&format!("tip{tip}_{k}_mpa_sqrt_m")));
            let known = first?.zip(second?);
            let factors = known.map_or_else(
                || vec![[f64::NAN; 2]; rows.len()],
                |(first, second)| first.iter().zip(&*second).map(|(k_i, k_ii)| [*k_i, *k_ii]).collect(),
            );
            Ok(TipRows { growth_mm, factors })
        };
        let tips = (0..count).map(of_tip).collect::<Result<_>>()?;
        let ends = curve.optional(BAND_COLUMNS[0])?.zip(curve.optional(BAND_COLUMNS[2])?);
        let band = ends.map(|(low, high)| low.iter().zip(&*high).map(|(low, high)| [*low, *high]).collect());
        let owned = |name: &str| -> Result<_> { Ok(curve.optional(name)?.map(Cow::into_owned)) };
        let (depths_mm, depth_factors) = (owned("crack_depth_mm")?, owned("depth_k_i_mpa_sqrt_m")?);
        Ok(RunTables { rows, tips, band, depths_mm, depth_factors, paths: paths_of(path)? })
    }

    pub fn life(&self) -> f64 {
        self.rows.last().map_or(0.0, |row| row.cycles)
    }
}

fn paths_of(table: &Table) -> Result<Vec<Vec<[f64; 3]>>> {
    let [tips, cycles, x, y] = [table.full("tip")?, table.full("cycles")?, table.full("x_mm")?, table.full("y_mm")?];
    let mut paths: Vec<Vec<[f64; 3]>> = Vec::new();
    for (row, tip) in tips.iter().enumerate() {
        // Tips are written one after the other.
        let known = paths.len() as f64;
        if *tip == known {
            paths.push(Vec::new());
        } else if *tip != known - 1.0 {
            return Err(table.bad(row + 2, Some("tip"), Some(&tip.to_string()), "does not follow the tip above it"));
        }
        if let Some(path) = paths.last_mut() {
            path.push([cycles[row], x[row], y[row]]);
        }
    }
    Ok(paths)
}

/// Most rows; more is a slip of the pen.
pub const ROWS_MAX: u64 = 10_000_000;

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sampling {
    /// So many rows, at least 2, equally spaced in cycles from the first to the last.
    Points(u64),
    /// A row every so many cycles, and one at the end.
    EveryCycles(f64),
}

impl Sampling {
    /// Rows of a curve, which has at least one.
    /// Errors: a step that is not positive or asks for more than [`ROWS_MAX`] rows; `option` is what the caller calls it.
    pub fn of(self, curve: &[Row], option: &str) -> Result<Vec<Row>> {
        let (first, last) = (curve[0].cycles, curve[curve.len() - 1].cycles);
        let cycles = match self {
            Sampling::Points(_) if first == last => vec![first],
            Sampling::Points(count) => {
                let inner = (1..count - 1).map(|i| first + (last - first) * (i as f64 / (count - 1) as f64));
                std::iter::once(first).chain(inner).chain([last]).collect()
            }
            Sampling::EveryCycles(step) => every(first, last, step, option)?,
        };
        let table = cycles_over_length(curve);
        Ok(cycles.iter().map(|n| at(curve, &table, *n)).collect())
    }
}

fn every(first: f64, last: f64, step: f64, option: &str) -> Result<Vec<f64>> {
    if !(step.is_finite() && step > 0.0) {
        return Err(input(option, step, "is not a positive number of cycles", "give for example 1000"));
    }
    let count = ((last - first) / step).floor();
    if count > ROWS_MAX as f64 {
        let problem = format!("gives {count:.0} rows, more than {ROWS_MAX}");
        return Err(input(option, step, problem, format!("give at least {:.3e}", (last - first) / ROWS_MAX as f64)));
    }
    let mut cycles: Vec<f64> = (0..=count as u64).map(|i| first + step * i as f64).filter(|n| *n < last).collect();
    cycles.push(last);
    Ok(cycles)
}

/// The curve (at least one row) at `cycles`, which lies within it. Where several rows share these cycles the last one counts; at the very
/// start the first one does, so that the curve begins at the initial crack length.
fn at(curve: &[Row], table: &Monotone, cycles: f64) -> Row {
    if cycles <= curve[0].cycles && curve[curve.len() - 1].cycles > curve[0].cycles {
        return curve[0];
    }
    let after = curve.partition_point(|row| row.cycles <= cycles);
    let from = curve[after.saturating_sub(1)];
    let Some(to) = curve.get(after) else { return from };
    let share = if cycles > from.cycles { table.fraction(after - 1, cycles) } else { 0.0 };
    // Written so that share 0 and 1 give the rows themselves and rounding cannot leave the interval.
    let between = |a: f64, b: f64| if share <= 0.0 { a } else { (a + share * (b - a)).clamp(a.min(b), a.max(b)) };
    Row {
        cycles,
        crack_length_mm: between(from.crack_length_mm, to.crack_length_mm),
        delta_k_mpa_sqrt_m: unknown_or(between, from.delta_k_mpa_sqrt_m, to.delta_k_mpa_sqrt_m),
        da_dn_mm_per_cycle: unknown_or(between, from.da_dn_mm_per_cycle, to.da_dn_mm_per_cycle),
    }
}

/// Cycles over crack length of a curve, mm.
pub fn cycles_over_length(rows: &[Row]) -> Monotone {
    Monotone::new(curve(rows).into_iter())
}

/// `clamp` refuses NaN bounds, so an unknown end makes the value unknown before it is asked.
fn unknown_or(between: impl Fn(f64, f64) -> f64, a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { between(a, b) }
}
