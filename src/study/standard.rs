//! Lives of standard specimens by quadrature with K of finite elements. The lengths between which a crack grows are keys of the case.

use super::cases::case_of;
use perilife_base::error::{Error, Result};
use perilife_base::quadrature::integrate;
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_calibration::median::cycles_of_run;
use perilife_growth::case::Case;
use perilife_growth::predict::{Prediction, Silent, predict};
use perilife_plate::specimen::handbook::handbook;
use perilife_plate::specimen::{LoadMeasure, Specimen};

/// K of finite elements: specimen, crack length in mm, K_I in MPa√m at 100 MPa or 10 kN. Right to 0.05 % (`tests/reference/README.md`).
const FACTORS: &str = include_str!("../../data/reference/standard_specimens.csv");
/// Keys of the first and the last crack length.
const RANGE: [&str; 2] = ["specimen.crack_length_mm=", "stop.crack_length_mm="];

/// First and last crack length of the keys, mm.
fn range(set: &[String]) -> Result<[f64; 2]> {
    let [first, last] = RANGE.map(|key| set.iter().rev().find_map(|set| set.strip_prefix(key)?.parse().ok()));
    first.zip(last).map(|(first, last)| [first, last]).ok_or_else(|| Error::Mechanics(format!("keys {RANGE:?} are missing")))
}

/// The largest error of the cycles of a run at shares of the growth, percent, against quadrature with the range of its keys alone.
pub fn growth_error(text: &str, set: &[String], run: &Prediction, shares: &[f64]) -> Result<f64> {
    let [from, to] = range(set)?;
    let own: Vec<String> = set.iter().filter(|key| RANGE.iter().any(|range| key.starts_with(range))).cloned().collect();
    let lengths: Vec<f64> = [0.0].iter().chain(shares).map(|share| from + share * (to - from)).collect();
    let points: Vec<(f64, f64)> = run.curve.iter().map(|point| (point.cycles, point.crack_length)).collect();
    let cycles = cycles_of_run(&points, &lengths.iter().map(|length| length * MM).collect::<Vec<_>>())?;
    let mut largest = 0.0_f64;
    for (length, cycles) in lengths.iter().zip(&cycles).skip(1) {
        let error = 100.0 * (cycles / by_quadrature(text, &own, Some(*length))? - 1.0);
        largest = if error.abs() > largest.abs() { error } else { largest };
    }
    Ok(largest)
}

/// Life by quadrature with K of finite elements, to the last length of the keys or to another, mm.
pub fn by_quadrature(text: &str, set: &[String], to: Option<f64>) -> Result<f64> {
    let [from, last] = range(set)?;
    let to = to.unwrap_or(last);
    let more = [format!("{}{to}", RANGE[1]), "model.method=handbook".to_owned()];
    let by_hand = case_of(text, &[set, &more].concat())?;
    Ok(predict(&by_hand, &Silent)?.life_cycles() * over_handbook(&by_hand, [from, to])?)
}

/// K_I of finite elements at a crack length of the table, mm, under the load of a case, Pa√m.
pub fn k_of_elements(case: &Case, length: f64) -> Result<f64> {
    let load = case.loading.maximum / load_of_table(&case.specimen);
    let found = known_factors(case.specimen.kind.name()).find(|[a, _]| *a == length);
    found.map(|[_, k]| k * load).ok_or_else(|| Error::Mechanics(format!("no K at {length} mm in the table")))
}

/// Load of the table: 100 MPa, or 10 kN.
fn load_of_table(specimen: &Specimen) -> f64 {
    if specimen.load_measure == LoadMeasure::Force { 1e4 } else { 1e8 }
}

/// Crack lengths, mm, and K_I, Pa√m, of a specimen of the table.
fn known_factors(name: &str) -> impl Iterator<Item = [f64; 2]> {
    FACTORS
        .lines()
        .filter_map(move |line| line.strip_prefix(name)?.strip_prefix(',')?.split_once(','))
        .filter_map(|(a, k)| Some([a.parse().ok()?, k.parse::<f64>().ok()? * MPA_SQRT_M]))
}

/// Life with K by finite elements over that with the handbook's, between two lengths, mm. Their ratio is taken linear between the
/// lengths of the table; the formulas are right to 0.1 to 1 %.
fn over_handbook(case: &Case, [from, to]: [f64; 2]) -> Result<f64> {
    let specimen = &case.specimen;
    let m = case.paris_law()?.m;
    let name = specimen.kind.name();
    let formula = handbook(specimen).ok_or_else(|| Error::Mechanics(format!("no handbook formula for {name}")))?;
    let load = load_of_table(specimen);
    let ratios: Vec<[f64; 2]> = known_factors(name).map(|[a, k]| [a, k / formula.k_i(a * MM, load)]).collect();
    let ratio = |a: f64| {
        let next = ratios.partition_point(|known| known[0] < a).clamp(1, ratios.len() - 1);
        let ([a0, r0], [a1, r1]) = (ratios[next - 1], ratios[next]);
        r0 + (a - a0) / (a1 - a0) * (r1 - r0)
    };
    let life = |k: &dyn Fn(f64) -> f64| integrate(|a| k(a).powf(-m), from, to, 1e-8).value;
    let by_formula = |a: f64| formula.k_i(a * MM, load) / MPA_SQRT_M;
    Ok(life(&|a| ratio(a) * by_formula(a)) / life(&by_formula))
}
