//! What `perilife check` has understood of a file, in words.

use toml::Value;

use crate::calibration::measured::MeasuredCurve;
use crate::case::{Case, LawSource, Method};
use crate::report::fit_use;
use crate::specimen::handbook::handbook;
use crate::specimen::{LoadMeasure, Support};
use crate::sweep::{DesignKind, DrawnCase, Sweep};
use crate::units::{GPA, KN, MM, MM_PER_CYCLE, MPA};

/// One line of what was understood.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// What it is about.
    pub what: &'static str,
    /// What was understood.
    pub value: String,
}

/// The measured curves of a calibration, inside its window.
pub(super) fn curves_line(curves: &[MeasuredCurve]) -> Line {
    let readings: usize = curves.iter().map(|curve| curve.cycles.len()).sum();
    let lengths = || curves.iter().flat_map(|curve| &curve.crack_length).map(|length| length / MM);
    let (shortest, longest) = (lengths().fold(f64::INFINITY, f64::min), lengths().fold(0.0, f64::max));
    let lives = || curves.iter().filter_map(|curve| Some(curve.cycles.last()? - curve.cycles.first()?));
    let (least, most) = (lives().fold(f64::INFINITY, f64::min), lives().fold(0.0, f64::max));
    let lives = if curves.len() == 1 { format!("{most:.0}") } else { format!("{least:.0} to {most:.0}") };
    let specimens =
        if curves.len() == 1 { format!("specimen {}", curves[0].specimen) } else { format!("{} specimens", curves.len()) };
    let value = format!("{specimens}: {readings} readings from {} to {} mm in {lives} cycles", short(shortest), short(longest));
    Line { what: "measured", value }
}

/// The design of a sweep, and what its cases have for each key that varies; that of the first case follows.
pub(super) fn sweep_lines(sweep: &Sweep, cases: &[DrawnCase]) -> Vec<Line> {
    let design = &sweep.design;
    let seed = if design.kind == DesignKind::Grid { String::new() } else { format!(", seed {}", design.seed) };
    let number = count(cases.len(), "case");
    let mut lines = vec![Line { what: "sweep", value: format!("{number} of {}, {}{seed}", sweep.base.name, design.kind) }];
    for (column, key) in sweep.columns().iter().enumerate() {
        let numbers: Option<Vec<f64>> = cases
            .iter()
            .map(|case| match &case.values[column] {
                Value::Integer(number) => Some(*number as f64),
                Value::Float(number) => Some(*number),
                _ => None,
            })
            .collect();
        let values = match numbers {
            Some(numbers) => {
                let (low, high) = numbers.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (l.min(x), h.max(x)));
                format!("{} to {}", figures(low), figures(high))
            }
            None => {
                let mut words: Vec<String> = cases.iter().map(|case| case.values[column].to_string()).collect();
                words.sort();
                words.dedup();
                words.join(", ")
            }
        };
        lines.push(Line { what: "varies", value: format!("{key}: {values}") });
    }
    lines.push(Line { what: "first case", value: cases[0].name.clone() });
    lines
}

/// What the program understood of a case, one line each; `points` says how it is divided.
pub(super) fn case_lines(case: &Case, points: String) -> Vec<Line> {
    let (specimen, material, loading, model, fatigue) =
        (&case.specimen, &case.material, &case.loading, &case.model, &case.fatigue);
    let mm = |metres: f64| short(metres / MM);
    let bond = model.bond_law;
    let load = match specimen.load_measure {
        LoadMeasure::Stress => {
            format!("stress {} to {} MPa", short(loading.maximum * loading.ratio / MPA), short(loading.maximum / MPA))
        }
        LoadMeasure::Force => {
            format!("force {} to {} kN", short(loading.maximum * loading.ratio / KN), short(loading.maximum / KN))
        }
    };
    let held = match specimen.supports.first() {
        None => "nothing held, loads in equilibrium",
        Some(Support::Fixed { .. }) => "held as [supports] says",
        Some(Support::Elsewhere) => "held outside the plate",
        Some(Support::ClampedEnds) => "rigid ends that cannot rotate",
        Some(Support::RigidEnds) => "rigid ends that rotate about pins",
    };
    let law = match &case.law {
        LawSource::Inline(law) => format!("a = {:e} per cycle, p = {} at horizon {} mm", law.a, law.p, mm(law.horizon)),
        LawSource::Paris(law) => format!("da/dN = {:e} ΔK^{} (mm/cycle, MPa√m)", law.c / MM_PER_CYCLE, law.m),
        LawSource::Factor(law) => format!("{}: {}", law.kind(), law.in_words()),
        LawSource::Fitted(_) if model.method == Method::Handbook => fit_use::law_line(case).unwrap_or_default(),
        LawSource::Fitted(record) => format!(
            "{}; a = {:e} per cycle at horizon {} mm",
            fit_use::law_line(case).unwrap_or_default(),
            record.a,
            record.horizon_mm
        ),
        LawSource::Missing(path) if path.as_os_str().is_empty() => "to be fitted".to_owned(),
        LawSource::Missing(path) => format!("{} does not exist yet", path.display()),
    };
    let formula = handbook(specimen).map_or_else(
        || "none for this specimen".to_owned(),
        |formula| format!("{} ({}); {}", formula.name, formula.source, formula.range),
    );
    let stop = if case.stop.crack_length.is_finite() {
        format!("crack length {} mm, or ", mm(case.stop.crack_length))
    } else {
        String::new()
    };
    let lines = [
        (
            "specimen",
            format!(
                "{}, {} x {} x {} mm (width, length, thickness)",
                specimen.kind,
                mm(specimen.gross_width),
                mm(specimen.length()),
                mm(specimen.thickness)
            ),
        ),
        (
            "crack",
            format!(
                "length {} mm; {}, {}, {}, {}",
                mm(specimen.crack_length),
                count(specimen.cracks.len(), "crack"),
                count(specimen.slots.len(), "slot"),
                count(specimen.holes.len(), "hole"),
                count(specimen.tips.len(), "tip")
            ),
        ),
        (
            "material",
            format!(
                "{}: E {} GPa, nu {}, plane {}",
                material.name,
                short(material.youngs_modulus / GPA),
                material.poisson_ratio,
                material.plane
            ),
        ),
        ("loading", format!("{load}, R = {}; {held}", loading.ratio)),
        (
            "bonds",
            format!(
                "{}, kernel {}, rotation {}, surface correction {}",
                bond.kind, bond.kernel, bond.rotation, bond.surface_correction
            ),
        ),
        ("points", points),
        ("fatigue", law),
        ("driver", fatigue.driver.to_string()),
        (
            "ageing",
            format!(
                "{}, zone radius {} horizons, precrack {}, a solve after every break",
                fatigue.ageing, fatigue.zone_radius_horizons, fatigue.precrack
            ),
        ),
        ("handbook K", formula),
        ("stop", format!("{stop}{} cycles", case.stop.cycles_max)),
    ];
    // Hand calculation has no bonds, and tips driven by their K have none that age.
    let told = |what: &str| match what {
        "bonds" | "driver" => model.method == Method::Peridynamics,
        "ageing" => case.spends_bond_life(),
        _ => true,
    };
    lines.into_iter().filter(|(what, _)| told(what)).map(|(what, value)| Line { what, value }).collect()
}

/// So many of something.
pub(super) fn count(number: usize, name: &str) -> String {
    format!("{number} {name}{}", if number == 1 { "" } else { "s" })
}

/// A number with at most four decimals.
pub(super) fn short(value: f64) -> String {
    let text = format!("{value:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A number of any size in a few figures.
fn figures(value: f64) -> String {
    let is_plain = value == 0.0 || (1e-2..1e7).contains(&value.abs());
    if is_plain { short(value) } else { format!("{value:.4e}") }
}
