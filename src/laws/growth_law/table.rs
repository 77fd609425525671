//! Rates as a table.

use serde::Serialize;

use super::FactorLaw;
use super::description::{GAMMA, Given, GrowthLawSpec, RatedRow, Rates, TableEnds, UNSAID};
use perilife_base::error::{Error, InputError, Result, fail_if, input, input_missing};
use perilife_base::keys::Key;
use perilife_base::units::{MM_PER_CYCLE, MPA_SQRT_M, round_off};
use perilife_plate::loading::SAME_RATIO;

pub static LAW: GrowthLawSpec = GrowthLawSpec {
    name: "table",
    meaning: "da/dN over ΔK, and over R, as rows of a CSV file",
    constants: &[GAMMA],
    others: &[
        Key::of_choice::<String>("growth_table", "Table of rates: its file"),
        Key::of_choice::<TableEnds>("growth_table_ends", "Ends of the table: beyond its rows; default refused"),
    ],
    read: Some(|given, law| Ok(FactorLaw { table: Some(read(given)?), ..FactorLaw::new(law, Vec::new()) })),
    ..UNSAID
};

const KEY: &str = "fatigue.growth_table";
/// Distance of a ratio from that of a curve up to which it has the whole of it, not the rates alone that the next one has too.
const NEAR_RATIO: f64 = 0.005;

/// da/dN over ΔK at one or several stress ratios: straight lines between its rows in logarithms, and between two ratios ln ΔK straight over R at
/// equal da/dN, so that curves meet that bend at their thresholds, and tests of different ΔK. Known are the rates that both ratios have.
/// Compression counts as nothing unless a curve is of a negative ratio. Below the lowest ratio its curve counts, which is conservative. One ratio R₀
/// alone holds at another by Walker's exponent (1970): its rate is that at `ΔK₀ = K_max (1-R)^γ (1-R₀)^(1-γ)`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Table {
    pub curves: Vec<Curve>,
    /// Whether K beyond the ends takes the rate of the end; else it is refused.
    pub holds_ends: bool,
    /// Walker's exponent of a table of one ratio.
    pub walker_gamma: Option<f64>,
    /// Whether the file, or the user, says the ratio; one that nobody says is taken to hold for every R.
    pub says_ratio: bool,
    /// ln of rate and of ΔK at two ratios, at every row of either: of each curve (twice itself) and of it with the next, in turn.
    #[serde(skip)]
    bands: Vec<Vec<[f64; 3]>>,
    #[serde(skip)]
    notes: Vec<String>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curve {
    pub ratio: f64,
    /// ΔK in Pa√m and da/dN in m/cycle, both rising.
    pub rows: Vec<[f64; 2]>,
}

impl Curve {
    /// ln ΔK at da/dN, straight between rows over ln da/dN.
    fn log_k(&self, rate: f64) -> f64 {
        let next = self.rows.partition_point(|row| row[1] < rate).clamp(1, self.rows.len() - 1);
        let [from, to] = [next - 1, next].map(|row| self.rows[row].map(f64::ln));
        from[0] + (rate.ln() - from[1]) / (to[1] - from[1]) * (to[0] - from[0])
    }

    /// Both curves at the rates of their rows that lie in both.
    fn with(&self, other: &Curve) -> Vec<[f64; 3]> {
        let low = self.rows[0][1].max(other.rows[0][1]);
        let high = self.rows[self.rows.len() - 1][1].min(other.rows[other.rows.len() - 1][1]);
        let rows = self.rows.iter().chain(&other.rows).map(|row| row[1]);
        let mut rates: Vec<f64> = rows.filter(|rate| (low..=high).contains(rate)).collect();
        rates.sort_by(f64::total_cmp);
        rates.dedup_by(|next, rate| *next / *rate < 1.0 + 1e-12);
        rates.into_iter().map(|rate| [rate.ln(), self.log_k(rate), other.log_k(rate)]).collect()
    }
}

/// ln da/dN at ln ΔK of a band, so much of its second curve counting; beyond its ends that of the end.
fn log_rate(band: &[[f64; 3]], share: f64, log_k: f64) -> f64 {
    let at = |knot: &[f64; 3]| knot[1] + share * (knot[2] - knot[1]);
    let next = band.partition_point(|knot| at(knot) < log_k).clamp(1, band.len() - 1);
    let [from, to] = [&band[next - 1], &band[next]];
    from[0] + ((log_k - at(from)) / (at(to) - at(from))).clamp(0.0, 1.0) * (to[0] - from[0])
}

impl Table {
    /// Of curves by rising ratio, one at least.
    pub fn new(curves: Vec<Curve>, holds_ends: bool, walker_gamma: Option<f64>, says_ratio: bool) -> Self {
        let pairs = (0..2 * curves.len() - 1).map(|i| curves[i / 2].with(&curves[i.div_ceil(2)]));
        Table { bands: pairs.collect(), curves, holds_ends, walker_gamma, says_ratio, notes: Vec::new() }
    }

    fn ends(&self) -> [f64; 2] {
        [&self.curves[0], &self.curves[self.curves.len() - 1]].map(|curve| curve.ratio)
    }

    /// The band that a ratio lies in, and how much of its second curve counts. Where two curves have no rate in common that of the higher ratio
    /// counts, which is the faster one.
    fn around(&self, ratio: f64) -> (&[[f64; 3]], f64) {
        let next = self.curves.partition_point(|curve| curve.ratio < ratio);
        let [from, to] = [next.saturating_sub(1), next.min(self.curves.len() - 1)];
        let [low, high] = [from, to].map(|curve| self.curves[curve].ratio);
        match &self.bands[from + to][..] {
            _ if ratio - low < NEAR_RATIO => (&self.bands[2 * from], 0.0),
            band if high - ratio >= NEAR_RATIO && band.len() > 1 => (band, (ratio - low) / (high - low)),
            _ => (&self.bands[2 * to], 0.0),
        }
    }

    /// That no curve is of a stress ratio, and what is done there; compression counts as nothing where no curve has it.
    fn outside(&self, ratio: f64) -> Option<[String; 2]> {
        let ([first, last], is_one) = (self.ends(), self.curves.len() == 1);
        let counted = if first < 0.0 { ratio } else { ratio.max(0.0) };
        let takes_any = is_one && (self.walker_gamma.is_some() || !self.says_ratio);
        let is_known = takes_any || (first - SAME_RATIO..=last + SAME_RATIO).contains(&counted);
        let of = if is_one { format!("{first}, the ratio") } else { format!("{first} to {last}, the ratios") };
        let (side, end) = if counted > last { ("above", last) } else { ("below", first) };
        let effect = if counted > last || counted < 0.0 { "non-conservative" } else { "conservative" };
        (!is_known).then(|| {
            [
                format!("R = {} is {side} {of} of the table of rates", round_off(ratio)),
                format!("; rates of R = {end} used ({effect})"),
            ]
        })
    }

    /// In words, that no curve is of a stress ratio, and which is taken.
    pub fn beyond_ratio(&self, ratio: f64) -> Option<String> {
        self.outside(ratio).map(|words| words.concat())
    }

    /// ΔK, Pa√m, at which the rows are read.
    fn delta_k(&self, k_max: f64, ratio: f64) -> f64 {
        let [own, of_table] = [ratio, self.curves[0].ratio].map(|ratio| 1.0 - ratio.max(0.0));
        match self.walker_gamma {
            Some(gamma) => k_max * own.powf(gamma) * of_table.powf(1.0 - gamma),
            None => k_max * own,
        }
    }

    /// da/dN, m/cycle, at K_max, Pa√m; beyond the ends that of the end.
    pub fn rate(&self, k_max: f64, ratio: f64) -> f64 {
        let log_k = self.delta_k(k_max, ratio).ln();
        if log_k.is_nan() || log_k == f64::NEG_INFINITY {
            return 0.0;
        }
        let (band, share) = self.around(ratio);
        let end = band[band.len() - 1];
        // Above the rates that two ratios have in common the lower ratio may know more, and is the slower one.
        let below = self.curves.partition_point(|curve| curve.ratio < ratio).saturating_sub(1);
        let is_above = log_k > end[1] + share * (end[2] - end[1]);
        let more = if is_above { log_rate(&self.bands[2 * below], 0.0, log_k) } else { f64::NEG_INFINITY };
        log_rate(band, share, log_k).max(more).exp()
    }

    /// In words, that K lies beyond the rows.
    pub fn beyond(&self, k_max: f64, ratio: f64) -> Option<String> {
        let delta_k = self.delta_k(k_max, ratio);
        let (band, share) = self.around(ratio);
        let [low, high] = [band[0], band[band.len() - 1]].map(|knot| (knot[1] + share * (knot[2] - knot[1])).exp());
        let [at, low_mpa, high_mpa] = [delta_k, low, high].map(|k| k / MPA_SQRT_M);
        // Rows that are hit but for round-off.
        let is_beyond = delta_k > 0.0 && !(low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(&delta_k);
        is_beyond.then(|| format!("ΔK = {at:.4} MPa√m is outside the table of rates, {low_mpa:.4} to {high_mpa:.4} MPa√m"))
    }

    pub fn in_words(&self) -> String {
        let rows: usize = self.curves.iter().map(|curve| curve.rows.len()).sum();
        format!("{rows} rows at {} stress ratios", self.curves.len())
    }

    /// What is to be said of one that scatters, or names no stress ratio, or others than those of the cycles, smallest and largest.
    pub fn lines(&self, ratios: [f64; 2]) -> Vec<String> {
        let unsaid = (!self.says_ratio).then(|| {
            let remedy = "give it in a column stress_ratio or by growth_table = { file = \"...\", stress_ratio = ... }";
            format!("rates: the table of rates has no stress ratio: its rates are used at R = {} unchanged; {remedy}", ratios[1])
        });
        let mut lines: Vec<String> = self.notes.iter().cloned().chain(unsaid).collect();
        lines.extend(ratios.iter().filter_map(|ratio| Some(format!("rates: {}", self.beyond_ratio(*ratio)?))));
        lines.dedup();
        lines
    }
}

fn read(given: &Given<'_>) -> Result<Table> {
    let Some(rates) = (given.rates)(given, KEY)? else {
        let remedy =
            "name a CSV file with the columns delta_k_mpa_sqrt_m, da_dn_mm_per_cycle and, for several ratios, stress_ratio";
        return Err(input_missing(KEY, "is missing", remedy));
    };
    let (curves, notes) = curves(&rates).map_err(|error| error.in_file(&given.folder.path(&rates.file)))?;
    let holds_ends = given.get("growth_table_ends")? == Some(TableEnds::Held);
    let walker_gamma = GAMMA.quantity.read_optional("fatigue.walker_gamma", given.get(GAMMA.key)?)?;
    let table = Table { notes, ..Table::new(curves, holds_ends, walker_gamma, rates.says_ratio) };
    let [first, last] = table.ends();
    if let Some(gamma) = table.walker_gamma.filter(|_| !table.says_ratio || table.curves.len() > 1) {
        let problem = match table.says_ratio {
            true => format!("cannot be combined with a table of several stress ratios, {first} to {last}"),
            false => "cannot be combined with a table without a stress ratio".to_owned(),
        };
        let remedy = "remove it, or give a table with one stress ratio, or { file = \"...\", stress_ratio = ... }";
        return Err(input("fatigue.walker_gamma", gamma, problem, remedy));
    }
    // Of a spectrum some cycles may lie above several ratios: that is said. One ratio says nothing of others.
    let is_one = table.curves.len() == 1;
    let ratio = given.ratios[usize::from(is_one)];
    if let Some([problem, _]) = table.outside(ratio).filter(|_| ratio > last && (is_one || !holds_ends)) {
        let remedy = match is_one {
            true => "give fatigue.walker_gamma (ΔK at R = K_max (1-R)^gamma), or add rates at this ratio to the table".to_owned(),
            false => {
                let held = format!("use those of R = {last} by growth_table_ends = \"held\" (non-conservative)");
                format!("add rates at this ratio to the table, or {held}")
            }
        };
        return Err(input(KEY, format!("\"{}\"", rates.file), problem, remedy));
    }
    Ok(table)
}

/// The curves of a table by rising ratio, each with at least two rows, ΔK and rate rising; and what was done for that.
fn curves(rates: &Rates) -> Result<(Vec<Curve>, Vec<String>)> {
    let wrong = |row: Option<&RatedRow>, key: &str, value: f64, problem: String| {
        Error::Input(Box::new(InputError {
            line: row.map(|row| row.line),
            key: Some(key.to_owned()),
            value: Some(round_off(value).to_string()),
            problem,
            remedy: "give rates that rise over ΔK, both above zero, of one test at each stress ratio or of at least nine rows"
                .to_owned(),
            ..InputError::default()
        }))
    };
    let mut sorted = rates.rows.clone();
    sorted.sort_by(|a, b| a.ratio.total_cmp(&b.ratio));
    let (mut curves, mut notes, mut rest) = (Vec::new(), rates.notes.clone(), &mut sorted[..]);
    while let Some(first) = rest.first().map(|row| row.ratio) {
        // Measured ratios scatter: rows of one test have no gap between them.
        let is_one = |i: &usize| rest[*i].ratio - first <= SAME_RATIO || rest[*i].ratio - rest[*i - 1].ratio <= 0.25 * SAME_RATIO;
        let count = (1..rest.len()).find(|i| !is_one(i)).unwrap_or(rest.len());
        let (same, others) = rest.split_at_mut(count);
        rest = others;
        let last = same[same.len() - 1].ratio;
        let mean = same.iter().map(|row| row.ratio).sum::<f64>() / same.len() as f64;
        let ratio = if first == last { first } else { (mean * 1e4).round() / 1e4 };
        same.sort_by(|a, b| a.pair[0].total_cmp(&b.pair[0]).then(a.pair[1].total_cmp(&b.pair[1])));
        if same.len() < 2 {
            let problem = "has a single row; interpolation needs two".to_owned();
            return Err(wrong(Some(&same[0]), "stress_ratio", first, problem));
        }
        let pairs: Vec<[f64; 2]> = same.iter().map(|row| row.pair).collect();
        let falls = (1..pairs.len()).find(|&i| (0..2).any(|k| pairs[i][k] <= pairs[i - 1][k] * (1.0 + 1e-9)));
        let Some(fall) = falls else {
            curves.push(Curve { ratio, rows: pairs });
            continue;
        };
        let Some(rows) = rising(&pairs) else {
            let [before, at] = [pairs[fall - 1][1], pairs[fall][1]].map(|rate| round_off(rate / MM_PER_CYCLE));
            let problem = format!("is not above {before}, the rate at the next lower ΔK");
            return Err(wrong(Some(&same[fall]), &rates.columns[1], at, problem));
        };
        let (curve, count) = (Curve { ratio, rows }, pairs.len());
        let (band, points) = (curve.with(&curve), curve.rows.len());
        let squares: f64 = pairs.iter().map(|[k, rate]| (rate.ln() - log_rate(&band, 0.0, k.ln())).powi(2)).sum();
        let rms = (squares / count as f64).sqrt();
        let used = format!("rising curve of {points} points used, rms of {count} rates {rms:.3} in ln(da/dN)");
        notes.push(format!("rates: {}: those at R = {ratio} scatter; {used}", rates.file));
        curves.push(curve);
    }
    fail_if!(curves.is_empty(), wrong(None, "rows", 0.0, "are too few".to_owned()));
    Ok((curves, notes))
}

const POINTS_MIN: usize = 3;

/// ΔK and rates of a rising curve through rates by rising ΔK: medians, which outliers do not move, of as few neighbours as make it rise, and straight
/// on from them to the ends. `None`: too few rates, or none that rises.
fn rising(pairs: &[[f64; 2]]) -> Option<Vec<[f64; 2]>> {
    let logs: Vec<[f64; 2]> = pairs.iter().map(|pair| pair.map(f64::ln)).collect();
    let of = |size: usize| {
        let mut curve: Vec<[f64; 2]> = logs.chunks_exact(size).map(|some| [0, 1].map(|k| median(some, k))).collect();
        for (end, next, place) in [(0, 1, 0), (curve.len() - 1, curve.len() - 2, logs.len() - 1)] {
            let ([x, y], [x_next, y_next]) = (curve[end], curve[next]);
            curve[end] = [logs[place][0], y + (logs[place][0] - x) * (y_next - y) / (x_next - x)];
        }
        let rises = curve.windows(2).all(|pair| pair[0][0] < pair[1][0] && pair[0][1] < pair[1][1]);
        rises.then_some(curve)
    };
    let curve = (3..=logs.len() / POINTS_MIN).step_by(2).find_map(of)?;
    Some(curve.iter().map(|pair| pair.map(f64::exp)).collect())
}

fn median(some: &[[f64; 2]], k: usize) -> f64 {
    let mut values: Vec<f64> = some.iter().map(|pair| pair[k]).collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}
