//! `[loading]` of an input file: how large the cycles are.

use serde::Deserialize;
use toml::Value;

use super::boundary;
use super::{Loading, LoadingKind};
use crate::error::{Result, input, input_missing};
use crate::input::{FORCE, FORCE_KN, Quantity, STRESS, number, shorten, slice, table_of};
use crate::specimen::{Edge, LoadMeasure, Specimen, SpecimenKind};

/// Keys that ask for a load history.
const SEQUENCES: &[&str] = &["sequence", "sequences", "blocks", "spectrum", "spectrum_file", "history", "rainflow", "overloads"];

/// Keys that do not say whether they mean maximum or range.
const BARE: &[&str] = &[
    "stress",
    "stress_mpa",
    "stress_amplitude_mpa",
    "stress_mean_mpa",
    "stress_min_mpa",
    "force",
    "force_n",
    "force_kn",
    "load",
    "load_n",
    "load_kn",
];

const MAGNITUDES: &str = "stress_max_mpa, stress_range_mpa, force_max_n, force_range_n, force_max_kn, force_range_kn";

/// The kind alone.
#[derive(Deserialize)]
struct KindInput {
    #[serde(rename = "kind")]
    _kind: LoadingKind,
}

/// Keys of `[loading]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Input {
    #[serde(rename = "kind")]
    _kind: Option<LoadingKind>,
    stress_max_mpa: Option<f64>,
    stress_range_mpa: Option<f64>,
    force_max_n: Option<f64>,
    force_range_n: Option<f64>,
    force_max_kn: Option<f64>,
    force_range_kn: Option<f64>,
    stress_ratio: Option<f64>,
    stress_parallel_ratio: Option<f64>,
    pub(super) edges: Option<Vec<Edge>>,
    pub(super) pins: Option<Vec<Value>>,
    pub(super) rollers: Option<Vec<Value>>,
}

/// Reads `[loading]` and `[supports]`, puts loads and supports of a `plate` on `specimen`, and gives the cycles.
pub fn from_values(loading: &Value, supports: Option<&Value>, specimen: &mut Specimen) -> Result<Loading> {
    if let Some(kind) = table_of(loading, "loading")?.get("kind") {
        // First, so that a load of a fracture scene is told where it belongs.
        let only = toml::Table::from_iter([("kind".to_owned(), kind.clone())]);
        slice::<KindInput>(&Value::Table(only), "loading")?;
    }
    refuse_by_name(loading)?;
    let input: Input = slice(loading, "loading")?;
    let ratio = read_ratio(input.stress_ratio)?;
    let magnitude = Magnitude::read(&input)?;
    let parallel_ratio =
        number("a ratio", -10.0, 10.0).read("loading.stress_parallel_ratio", input.stress_parallel_ratio.unwrap_or(0.0))?;
    let area = boundary::apply(&input, supports, specimen, parallel_ratio)?;
    // A range is maximum - minimum, hence maximum (1 - R), also where R is negative.
    let largest = if magnitude.is_range { magnitude.value / (1.0 - ratio) } else { magnitude.value };
    let maximum = match (specimen.load_measure, magnitude.is_force) {
        (LoadMeasure::Stress, false) | (LoadMeasure::Force, true) => largest,
        (LoadMeasure::Stress, true) => largest / area,
        (LoadMeasure::Force, false) => {
            let who = if specimen.kind == SpecimenKind::CompactTension {
                "compact_tension"
            } else {
                "a plate loaded by pins or rollers"
            };
            let problem = format!("is a stress, but {who} takes a force");
            return Err(input_error(&magnitude, problem, "give force_max_n or force_range_n (or _kn)"));
        }
    };
    Ok(Loading { maximum, ratio, parallel_ratio })
}

fn input_error(magnitude: &Magnitude, problem: String, remedy: &str) -> crate::Error {
    input(&magnitude.key, magnitude.given, problem, remedy)
}

/// Keys that are refused before anything else, since "unknown key" would not tell the user what to do.
fn refuse_by_name(loading: &Value) -> Result<()> {
    let table = table_of(loading, "loading")?;
    for (key, value) in table {
        let path = format!("loading.{key}");
        if SEQUENCES.contains(&key.as_str()) {
            let problem = "is a load sequence, which is not supported yet (and would never be averaged)";
            return Err(input(
                &path,
                shorten(value),
                problem,
                "give constant amplitude: stress_range_mpa or stress_max_mpa with stress_ratio",
            ));
        }
        if BARE.contains(&key.as_str()) {
            let problem = "does not say whether the maximum or the range is meant";
            return Err(input(&path, shorten(value), problem, format!("give exactly one of {MAGNITUDES}")));
        }
    }
    Ok(())
}

fn read_ratio(ratio: Option<f64>) -> Result<f64> {
    const KEY: &str = "loading.stress_ratio";
    let ratio = ratio.ok_or_else(|| input_missing(KEY, "is missing", "give R = minimum / maximum, 0 for pulsating load"))?;
    if ratio >= 1.0 {
        return Err(input(KEY, ratio, "must be below 1: at R = 1 nothing changes in a cycle", "give R = minimum / maximum"));
    }
    number("a ratio", -100.0, 0.999).read(KEY, ratio)
}

/// The one load magnitude of the file.
struct Magnitude {
    key: String,
    /// As given, in the unit of its key.
    given: f64,
    /// Pa or N.
    value: f64,
    is_range: bool,
    is_force: bool,
}

impl Magnitude {
    fn read(slice: &Input) -> Result<Self> {
        let choices: [(&str, Option<f64>, Quantity); 6] = [
            ("stress_max_mpa", slice.stress_max_mpa, STRESS),
            ("stress_range_mpa", slice.stress_range_mpa, STRESS),
            ("force_max_n", slice.force_max_n, FORCE),
            ("force_range_n", slice.force_range_n, FORCE),
            ("force_max_kn", slice.force_max_kn, FORCE_KN),
            ("force_range_kn", slice.force_range_kn, FORCE_KN),
        ];
        let given: Vec<_> = choices.iter().filter_map(|(key, value, quantity)| Some((*key, (*value)?, quantity))).collect();
        match given[..] {
            [(key, given, quantity)] => {
                let path = format!("loading.{key}");
                let value = quantity.read(&path, given)?;
                Ok(Magnitude { key: path, given, value, is_range: key.contains("range"), is_force: key.starts_with("force") })
            }
            [] => Err(input_missing(
                "loading.stress_max_mpa",
                "is missing: there is no load",
                format!("give exactly one of {MAGNITUDES}"),
            )),
            [(first, ..), (second, value, _), ..] => {
                let problem = format!("stands beside {first}: one load is given twice");
                Err(input(&format!("loading.{second}"), value, problem, format!("give exactly one of {MAGNITUDES}")))
            }
        }
    }
}
