//! What `perilife check` has understood of a file, in words, and the body that a run would compute, looked at before anything is solved.

use toml::Value;

use perilife_base::error::{Error, InputError, Result};
use perilife_base::units::{GPA, MM, MM_PER_CYCLE};
use perilife_calibration::laws::case::LawCase;
use perilife_calibration::sweep::{DesignKind, DrawnCase, Sweep};
use perilife_growth::ageing::stuck;
use perilife_growth::case::{Case, Engine, LawSource, Model, PointSettings, initial_plate, needs};
use perilife_growth::plate;
use perilife_growth::predict::fit_use;
use perilife_measured::MeasuredCurve;
use perilife_nodes::resolution::ElementFreeSettings;
use perilife_plate::material::Material;
use perilife_plate::specimen::handbook::handbook_beside;
use perilife_plate::specimen::part_through::{RANGE, SOURCE};
use perilife_plate::specimen::{Specimen, Support};
use perilife_points::body::lattice::Lattice;
use perilife_points::budget::Budget;
use perilife_points::crack_tip::CrackTip;
use perilife_points::pieces::{Connectivity, remove_fragments};
use perilife_points::state::Bonds;
use perilife_results::model_words::{self, Choice, mm, short};
use perilife_results::spectrum;

#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    pub what: &'static str,
    pub value: String,
    /// Whether a long summary alone has it.
    pub is_detail: bool,
}

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
    line("measured", value)
}

pub(super) fn rates_line(case: &LawCase) -> Line {
    let [low, high] = case.delta_k_range();
    let ratios = case.ratios().iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
    let (rates, of) = (count(case.rows.len(), "rate"), case.law);
    line("measured", format!("{rates} at R = {ratios}, ΔK {} to {} MPa√m, law {of}", short(low), short(high)))
}

/// The design of a sweep, and what its cases have for each key that varies; that of the first case follows.
pub(super) fn sweep_lines(sweep: &Sweep, cases: &[DrawnCase]) -> Vec<Line> {
    let design = &sweep.design;
    let seed = if design.kind == DesignKind::Grid { String::new() } else { format!(", seed {}", design.seed) };
    let number = count(cases.len(), "case");
    let mut lines = vec![line("sweep", format!("{number} of {}, {}{seed}", sweep.base.name, design.kind))];
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
        lines.push(line("varies", format!("{key}: {values}")));
    }
    lines.push(detail("first case", cases[0].name.clone()));
    lines
}

/// Specimen, flaws and material of a case or a scene; `flaws` is the name of their line, `of_them` more words about them.
pub(super) fn plate_lines(
    specimen: &Specimen,
    material: &Material,
    (flaws, cracks, of_them): (&'static str, usize, String),
) -> Vec<Line> {
    let [width, length, thickness] = [specimen.gross_width, specimen.length(), specimen.thickness].map(mm);
    let counts =
        [(cracks, "crack"), (specimen.slots.len(), "slot"), (specimen.holes.len(), "hole"), (specimen.tips.len(), "tip")];
    let counts = counts.map(|(number, name)| count(number, name)).join(", ");
    let (modulus, nu, plane) = (short(material.youngs_modulus / GPA), material.poisson_ratio, material.plane);
    vec![
        line("specimen", format!("{}, {width} × {length} × {thickness} mm (W × L × B)", specimen.kind)),
        line(flaws, format!("{counts}{of_them}")),
        line("material", format!("{}: E {modulus} GPa, ν {nu}, plane {plane}", material.name)),
    ]
}

pub(super) fn built([points, bonds, cut]: [usize; 3]) -> String {
    format!("{points} and {bonds} bonds, {cut} of them cut by the initial cracks,")
}

/// How a plate is divided: spacing of the finest and the coarsest level, the finest asked for, and the horizon there, m.
pub(super) fn points_words(count: &str, spacings: [f64; 2], [asked, horizon]: [f64; 2], chosen: &[Choice]) -> String {
    let ([fine, coarse], [asked, horizon]) = (spacings.map(mm), [asked, horizon].map(mm));
    let to = if fine == coarse { String::new() } else { format!(" to {coarse}") };
    let moved = if fine == asked { String::new() } else { format!(" ({asked} asked for)") };
    let choices = model_words::words(chosen, &["discretisation", "horizon_ratio", "solver"]);
    format!("{count} at spacing {fine}{to} mm{moved}, horizon {horizon} mm, {choices}")
}

/// What the program understood of a case, one line each; `points` says how it is divided.
pub(super) fn case_lines(case: &Case, points: String) -> Vec<Line> {
    let (specimen, fatigue) = (&case.specimen, &case.fatigue);
    let chosen = model_words::of_case(case, None);
    let held = match specimen.supports.first() {
        None => "no supports (loads balanced)",
        Some(Support::Moved { .. }) => "no other supports",
        Some(Support::Fixed { .. }) => "supports from [supports] or the specimen kind",
        Some(Support::Elsewhere) => "supports outside the plate",
        Some(Support::ClampedEnds) => "clamped grips",
        Some(Support::RigidEnds) => "pinned grips",
    };
    let of_front = || specimen.part_through.map_or_else(|| "none for this specimen".to_owned(), |_| format!("{SOURCE}; {RANGE}"));
    let formula = handbook_beside(specimen)
        .map_or_else(of_front, |formula| format!("{} ({}); {}", formula.name, formula.source, formula.range));
    let end = Some(case.stop.crack_length).filter(|length| length.is_finite());
    let mut end = end.map_or_else(String::new, |length| format!("crack length {} mm, or ", mm(length)));
    if case.stop.crack_depth.is_finite() {
        end += &format!("crack depth {} mm, or ", mm(case.stop.crack_depth));
    }
    if case.stop.at_break_through {
        end += "breakthrough, or ";
    }
    let depth = specimen.part_through.map(|flaw| format!(", depth {} mm of {} mm", mm(flaw.depth), mm(flaw.through_depth())));
    let crack = format!("; length {} mm{}", mm(specimen.crack_length), depth.unwrap_or_default());
    let mut lines = plate_lines(specimen, &case.material, ("crack", specimen.cracks.len(), crack));
    let cycles = format!("{}; {held}", model_words::loading(case));
    lines.push(line("loading", cycles));
    lines.extend(case.loading.spectrum.iter().map(|spectrum| line("spectrum", spectrum::more_words(case, spectrum))));
    let by_points = matches!(case.model, Model::Points(_));
    lines.extend(case.chosen.as_ref().map(|why| line("model", format!("{} ({why})", case.model.method()))));
    lines.extend(by_points.then(|| detail("bonds", model_words::words(&chosen, &model_words::OF_BONDS))));
    lines.push(detail("points", points));
    lines.push(line("fatigue", law_words(case)));
    lines.extend(by_points.then(|| detail("driver", model_words::words(&chosen, &["driver"]))));
    if case.spends_bond_life() {
        let radius = fatigue.zone_radius_horizons;
        let then = if case.engine() == Engine::BondsThenPoints {
            "; K of the tips once cracks from slots are 1.5 horizons long"
        } else {
            ""
        };
        let words = format!("{}, zone radius {radius} horizons, a solve after every break{then}", fatigue.ageing);
        lines.push(detail("ageing", words));
    }
    lines.push(detail("handbook K", formula));
    let bears = case.stop.required.map(|factor| format!("residual strength {factor:.4} times the largest load, or "));
    // So many that nobody asked for them.
    let last = if case.stop.cycles_max < 1e9 {
        format!("{} cycles", case.stop.cycles_max)
    } else {
        "failure, or no further growth".to_owned()
    };
    lines.push(line("stop", format!("{end}{}{last}", bears.unwrap_or_default())));
    lines
}

fn law_words(case: &Case) -> String {
    if let Some(record) = &case.law_record {
        let constants = record.fatigue.iter().filter(|(key, _)| *key != "growth_law");
        let constants = constants.map(|(key, value)| match value.as_float() {
            Some(number) if number != 0.0 && number.abs() < 1e-3 => format!("{key} {number:.4e}"),
            Some(number) => format!("{key} {number:.4}"),
            None => format!("{key} {value}"),
        });
        return format!("{}, fitted to {} rates: {}", record.kind(), record.rates, constants.collect::<Vec<_>>().join(", "));
    }
    match &case.law {
        LawSource::Inline(law) => format!("a = {:e} per cycle, p = {} at horizon {} mm", law.a, law.p, mm(law.horizon)),
        LawSource::Paris(law) => format!("da/dN = {:e} ΔK^{} (mm/cycle, MPa√m)", law.c / MM_PER_CYCLE, law.m),
        LawSource::Factor(law) => format!("{}: {}", law.kind, law.in_words()),
        LawSource::Fitted(record) => {
            let law = fit_use::law_line(case).unwrap_or_default();
            let of_bonds = match case.model {
                Model::Points(_) => format!("; a = {:e} per cycle at horizon {} mm", record.a, record.horizon_mm),
                Model::Handbook(_) | Model::Nodes(_) => String::new(),
            };
            format!("{law}{of_bonds}")
        }
        LawSource::Missing(path) if path.as_os_str().is_empty() => "to be fitted".to_owned(),
        LawSource::Missing(path) => format!("{} does not exist yet", path.display()),
    }
}

pub(super) fn line(what: &'static str, value: String) -> Line {
    Line { what, value, is_detail: false }
}

pub(super) fn detail(what: &'static str, value: String) -> Line {
    Line { is_detail: true, ..line(what, value) }
}

fn count(number: usize, name: &str) -> String {
    format!("{number} {name}{}", if number == 1 { "" } else { "s" })
}

fn figures(value: f64) -> String {
    let is_plain = value == 0.0 || (1e-2..1e7).contains(&value.abs());
    if is_plain { short(value) } else { format!("{value:.4e}") }
}

/// Bonds up to which the body is built, those of 4e5 points at the usual horizon; well below a second.
const BONDS_BUILT: f64 = 6e6;
/// Memory up to which it is: what takes long beside bonds are the equations of a rim, which are large where horizons are.
const BYTES_BUILT: f64 = 5e8;
/// Corners of an outline, holes and slots among them, with which a place is asked in no time.
const CORNERS_USUAL: f64 = 50.0;
/// Places up to which it is: an outline of thin arms has many that are empty, and each of them is asked whether it lies in the plate.
const PLACES_BUILT: f64 = 2e6;

/// Whether points and bonds are so few that a check lays them.
pub(super) fn is_quick(budget: &Budget, specimen: &Specimen) -> bool {
    let corners = specimen.outline.len() + specimen.holes.len() + 4 * specimen.slots.len();
    let asked = budget.places * (corners as f64 / CORNERS_USUAL).max(1.0);
    budget.bonds <= BONDS_BUILT && asked <= PLACES_BUILT && budget.bytes <= BYTES_BUILT
}

/// What the lattice makes of a case.
pub(super) struct Preview {
    pub points: String,
    pub warnings: Vec<String>,
}

/// Seconds of an increment on two processors for every node, with the look for its error.
const SECONDS_OF_NODE: f64 = 3.5e-5;
const SECONDS_OF_POINT: f64 = 1.5e-6;
/// Increments of a life, and how many more of them every tip takes.
const INCREMENTS: [f64; 2] = [12.0, 7.0];

fn of_nodes(case: &Case, ElementFreeSettings { resolution, .. }: &ElementFreeSettings) -> Result<Preview> {
    let plate = initial_plate(case).map_err(as_input)?;
    let finest = plate.nodes.spacing.iter().copied().fold(f64::INFINITY, f64::min);
    let points = format!(
        "{} nodes, {} unknowns; spacing {} mm, {} mm at the finest, radius of influence {} spacings{}",
        plate.nodes.at.len(),
        plate.unknowns(),
        mm(resolution.far),
        mm(finest),
        resolution.support,
        time_words(case, SECONDS_OF_NODE * plate.nodes.at.len() as f64)
    );
    Ok(Preview { points, warnings: Vec::new() })
}

/// What a life takes, by the seconds of an increment; within a factor of three.
fn time_words(case: &Case, seconds: f64) -> String {
    let increments = INCREMENTS[0] + INCREMENTS[1] * case.specimen.tips.len() as f64;
    format!("; about {:.0} s", (increments * seconds).max(1.0))
}

/// Lays the lattice and, where that is quick, builds the body.
pub(super) fn preview(case: &Case) -> Result<Preview> {
    match &case.model {
        Model::Handbook(_) => Ok(Preview { points: "none (handbook K)".to_owned(), warnings: Vec::new() }),
        Model::Nodes(nodes) => of_nodes(case, nodes),
        Model::Points(points) => {
            let mut preview = of_points(case, points)?;
            if case.engine() == Engine::Points {
                preview.points += &time_words(case, SECONDS_OF_POINT * needs::of_case(case).points);
            }
            Ok(preview)
        }
    }
}

fn of_points(case: &Case, points: &PointSettings) -> Result<Preview> {
    let specimen = &case.specimen;
    let budget = needs::of_case(case);
    if !is_quick(&budget, specimen) {
        let padding = points.horizon_ratio.floor() as usize;
        let lattice = Lattice::over(specimen, points.spacing, points.lattice_angle, padding)?;
        let count = format!("about {:.0}", budget.points * (points.spacing / lattice.spacing).powi(2));
        return Ok(Preview { points: points_line(case, &count, lattice.spacing), warnings: Vec::new() });
    }
    let body = &points.body(specimen, &case.material).map_err(as_input)?;
    let mut bonds = Bonds::new(body);
    if remove_fragments(body, &mut bonds, &body.pre_cut) == Connectivity::Severed {
        return Err(as_input(Error::Mechanics("the initial cracks cut the plate in two".to_owned())));
    }
    let count = built([body.points.len(), body.bond_count, body.pre_cut.len()]);
    let tips: Vec<CrackTip> = specimen.tips.iter().map(|seed| CrackTip::at(seed, body)).collect();
    let held = stuck(body, &bonds, &tips, &case.fatigue).into_iter().map(|tip| {
        let [x, y] = tips[tip].position.map(mm);
        format!(
            "bonds: the crack tip at ({x}, {y}) mm is inside the no-failure zone of a load or support and will not grow; \
             move it one horizon away ({} mm), or load the plate elsewhere",
            mm(body.horizon())
        )
    });
    let warnings = plate::warning(body).into_iter().chain(held).collect();
    Ok(Preview { points: points_line(case, &count, body.lattice.spacing), warnings })
}

fn points_line(case: &Case, count: &str, spacing: f64) -> String {
    let sizes = [case.points().spacing, spacing * case.points().horizon_ratio];
    points_words(count, [spacing; 2], sizes, &model_words::of_case(case, None))
}

/// What a run would end with as mechanics is, seen before any run, input that has to change.
pub(super) fn as_input(error: Error) -> Error {
    match error {
        Error::Mechanics(problem) => Error::Input(Box::new(InputError { problem, ..InputError::default() })),
        other => other,
    }
}
