//! What was chosen for a case or a scene: key, value and reason of every choice, in the order of `result.json`.

use serde_json::{Map, Value};

pub use super::format::{clean, mm, short};
use perilife_base::units::{KN, MM, MPA};
use perilife_growth::case::{Case, LawSource, Method, Model, PointSettings};
use perilife_growth::predict::RunFigures;
use perilife_nodes::resolution::ElementFreeSettings;
use perilife_plate::specimen::handbook::handbook;
use perilife_plate::specimen::part_through::{RANGE, SOURCE};
use perilife_plate::specimen::{Load, LoadMeasure, Specimen, Support};
use perilife_points::bond_law::BondLawKind;
use perilife_points::refinement::Discretisation;
use perilife_points::solver::SolverUsed;

pub const OF_BONDS: [&str; 7] =
    ["bond_law", "kernel", "rotation", "surface_correction", "kinematics", "zero_energy_control", "zero_energy_factor"];

#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Its key in the input file or of the result.
    pub key: &'static str,
    pub value: Value,
    /// Whether the file asked for it or the program chose it, and why; `None` for what follows from other choices.
    pub why: Option<String>,
}

pub fn object(choices: &[Choice]) -> Map<String, Value> {
    let why = |choice: &Choice| Some((choice.key.to_owned(), choice.why.clone()?.into()));
    let why: Map<String, Value> = choices.iter().filter_map(why).collect();
    let mut object: Map<String, Value> = choices.iter().map(|choice| (choice.key.to_owned(), choice.value.clone())).collect();
    object.insert("why".to_owned(), why.into());
    object
}

/// The choices of these keys in words: the first value, then key and value of the others.
pub fn words(choices: &[Choice], keys: &[&str]) -> String {
    let value = |choice: &Choice| choice.value.as_str().map_or_else(|| choice.value.to_string(), str::to_owned);
    let chosen = choices.iter().filter(|choice| keys.contains(&choice.key)).enumerate();
    let words = chosen.map(|(i, choice)| match i {
        0 => value(choice),
        _ => format!("{} {}", choice.key.replace('_', " "), value(choice)),
    });
    words.collect::<Vec<_>>().join(", ")
}

/// The model of a case; sizes, solver and solved part are those of its run where there was one.
pub fn of_case(case: &Case, figures: Option<&RunFigures>) -> Vec<Choice> {
    let mut choices = match &case.model {
        Model::Handbook(_) => return hand_calculation(case),
        Model::Nodes(nodes) => of_nodes(case, nodes),
        Model::Points(points) => of_points(case, points, figures),
    };
    let pins = pins(case);
    if !pins.is_empty() {
        let why = "pins at maximum load; contact is solved in every increment (nodes) or once at N = 0 (points)".to_owned();
        choices.push(Choice { key: "pins", value: pins.into(), why: Some(why) });
    }
    choices
}

pub fn pins(case: &Case) -> Vec<String> {
    let words = |load: &Load| match load {
        Load::Pin { hole, contact, .. } => Some(format!("hole {hole}: {}", contact.words())),
        Load::Edge { .. } | Load::Bent { .. } => None,
    };
    case.specimen.loads.iter().filter_map(words).collect()
}

fn of_points(case: &Case, points: &PointSettings, figures: Option<&RunFigures>) -> Vec<Choice> {
    let law = points.bond_law;
    let (spacing, horizon) = figures.map_or((points.spacing, points.horizon()), |run| (run.spacing, run.horizon));
    let used = figures.and_then(|run| run.solver);
    let moved = if ((points.spacing - spacing) / spacing).abs() > 1e-9 {
        format!("; moved from {:.6} to {:.6} so that it divides the width", points.spacing / MM, spacing / MM)
    } else {
        String::new()
    };
    let by_solver = used.map(|used| format!("; requested \"{}\", used {}", points.solver, used.meaning()));
    let springs_do = law.kind != BondLawKind::StateBased;
    // A record of hand calculation fixes nothing.
    let is_by_record = matches!(&case.law, LawSource::Fitted(record) if record.rate_constant.is_some());
    let chosen = |key, value: Value, default: &str, more: &str| {
        let why = if given(&case.echo, key) {
            "given in the case"
        } else if is_by_record && OF_RECORD.contains(&key) {
            "from the fitted law, which is valid for this choice only"
        } else {
            default
        };
        Choice { key, value, why: Some(format!("{why}{more}")) }
    };
    let follows = |key, value: Value| Choice { key, value, why: None };
    vec![
        Choice { key: "method", value: case.model.method().name().into(), why: Some(why_method(case)) },
        follows("driver", case.fatigue.driver.name().into()),
        chosen("bond_law", law.kind.name().into(), if springs_do { TWO_SPRINGS } else { BEYOND_SPRINGS }, ""),
        chosen("kernel", law.kernel.name().into(), "default: least lattice dependence of those tested", ""),
        chosen("rotation", law.rotation.name().into(), "default: rigid rotation of crack faces costs no energy", ""),
        chosen("surface_correction", law.surface_correction.name().into(), "default: most accurate option", ""),
        follows("discretisation", Discretisation::Lattice.name().into()),
        chosen("spacing_mm", clean(spacing / MM).into(), SPACING, &moved),
        chosen("horizon_ratio", points.horizon_ratio.into(), RATIO, ""),
        follows("horizon_mm", clean(horizon / MM).into()),
        chosen("lattice_angle_deg", clean(points.lattice_angle.to_degrees()).into(), ANGLE, ""),
        chosen(
            "solver",
            used.map_or(points.solver.name(), SolverUsed::name).into(),
            "default: fastest exact solver",
            by_solver.as_deref().unwrap_or(""),
        ),
        chosen("symmetry", points.symmetry.name().into(), "default: exact", figures.map_or("", solved_part)),
    ]
}

fn why_method(case: &Case) -> String {
    case.chosen.as_ref().map_or_else(|| "given in the case".to_owned(), |why| format!("automatic: {why}"))
}

/// The formula of method `handbook`. Other keys of `[model]` say nothing there.
fn hand_calculation(case: &Case) -> Vec<Choice> {
    let choice = |key, value: Option<&str>, why: Option<&str>| Choice { key, value: value.into(), why: why.map(str::to_owned) };
    let method = Choice { why: Some(why_method(case)), ..choice("method", Some(case.model.method().name()), None) };
    let of_kind = Some("of the specimen kind");
    if let Some(flaw) = &case.specimen.part_through {
        let formula = format!("Newman and Raju, {}", flaw.kind().name().replace('_', " "));
        let through = Some("the through crack of the same plate");
        return vec![
            method,
            choice("formula", Some(&formula), of_kind),
            choice("source", Some(SOURCE), None),
            choice("range", Some(RANGE), None),
            choice("once_through", Some(Method::ElementFreeGalerkin.name()), through),
        ];
    }
    let formula = handbook(&case.specimen);
    vec![
        method,
        choice(
            "formula",
            formula.as_ref().map(|formula| formula.name),
            case.specimen.beta.as_ref().map_or(of_kind, |_| Some("given in the case")),
        ),
        choice("source", formula.as_ref().map(|formula| formula.source), None),
        choice("range", formula.as_ref().map(|formula| formula.range), None),
    ]
}

fn of_nodes(case: &Case, nodes: &ElementFreeSettings) -> Vec<Choice> {
    let ElementFreeSettings { resolution, step_share, .. } = *nodes;
    let why = |key: &str| Some(if given(&case.echo, key) { "given in the case" } else { "automatic" }.to_owned());
    let choice = |key, value: Value, why| Choice { key, value, why };
    vec![
        choice("method", case.model.method().name().into(), Some(why_method(case))),
        choice("spacing_mm", (resolution.far / MM).into(), why("spacing_mm")),
        choice("basis", resolution.basis.name().into(), why("basis")),
        choice("enrichment", resolution.enrichment.name().into(), why("enrichment")),
        choice("influence_radius", resolution.support.into(), why("influence_radius")),
        choice(
            "spacings_in_room",
            resolution.hold.into(),
            Some("spacing at a tip over its distance from edges and cracks".to_owned()),
        ),
        choice("step_share", step_share.into(), why("tolerance_percent")),
    ]
}

pub const TWO_SPRINGS: &str = "default: takes Poisson's ratio from the material instead of fixing it";
const BEYOND_SPRINGS: &str = "automatic: bonds without dilatation cannot represent this Poisson's ratio";
pub const SPACING: &str = "default: the smaller of crack length / 9 and width / 100";
pub const RATIO: &str = "default: 3.015, three neighbours in every lattice direction";
pub const ANGLE: &str = "default: lattice rows along x";

pub fn given(echo: &Value, key: &str) -> bool {
    echo.get("model").is_some_and(|model| model.get(key).is_some())
}

/// Keys without whose choice a fitted law is meaningless.
const OF_RECORD: [&str; 5] = ["bond_law", "kernel", "rotation", "horizon_ratio", "surface_correction"];

fn solved_part(figures: &RunFigures) -> &'static str {
    let (all, solved) = (figures.points, figures.points_solved);
    // A line of symmetry through a row of points leaves half a row more.
    match (solved == all, 3 * solved > all) {
        (true, _) => "; whole plate solved",
        (false, true) => "; one half solved (mirror symmetry)",
        (false, false) => "; one quarter solved (mirror symmetry)",
    }
}

pub fn loading(case: &Case) -> String {
    let (specimen, loading) = (&case.specimen, &case.loading);
    let (load, unit, symbol) = match specimen.load_measure {
        LoadMeasure::Stress => ("stress", MPA, "MPa"),
        LoadMeasure::Force => ("force", KN, "kN"),
    };
    let least = loading.spectrum.as_ref().map_or(loading.ratio, |spectrum| spectrum.smallest());
    let range = |unit: f64, most: f64| format!("{} to {}", short(least * most / unit), short(most / unit));
    let loads = range(unit, loading.maximum);
    let cycles = match (loading.displacement(), specimen.crack_pressure) {
        (Some(most), _) => {
            let (moved, range) = (moved(specimen), range(MM, most));
            format!("displacement range {range} mm ({moved}); the load drops as the crack grows")
        }
        (None, pressure) if pressure > 0.0 && specimen.loads.is_empty() => format!("pressure on the cracks {loads} {symbol}"),
        (None, pressure) if pressure > 0.0 => {
            let most = short(pressure * loading.maximum / MPA);
            format!("{load} {loads} {symbol}, pressure on the cracks up to {most} MPa")
        }
        _ => {
            let of_end =
                |end: f64| format!("; the maximum follows the crack to {} at {} mm", short(loading.at(end) / unit), mm(end));
            format!("{load} {loads} {symbol}{}", loading.course().map_or_else(String::new, |course| of_end(course.end())))
        }
    };
    let sides =
        if loading.parallel_ratio == 0.0 { String::new() } else { format!(", {} of it on the sides", loading.parallel_ratio) };
    let bent = specimen.part_through.map_or(0.0, |flaw| flaw.bending_ratio);
    let bending = if bent == 0.0 { String::new() } else { format!(", bending of {} of it at the face", short(bent)) };
    let residual = loading.residual.as_ref().map(|residual| format!(", {}", residual.described())).unwrap_or_default();
    match &loading.spectrum {
        Some(spectrum) => {
            let [low, high] = spectrum.ratios.map(short);
            format!("spectrum, {cycles}{sides}{bending}, R = {low} to {high}, {} at the largest{residual}", short(loading.ratio))
        }
        None => format!("{cycles}{sides}{bending}, R = {}{residual}", short(loading.ratio)),
    }
}

fn moved(specimen: &Specimen) -> &'static str {
    let is_gripped = specimen.supports.iter().any(|support| matches!(support, Support::ClampedEnds | Support::RigidEnds));
    let of_edge = |support: &Support| match *support {
        Support::Moved { held: true, .. } => Some("edge, straight and fixed transversely"),
        Support::Moved { from, to, direction: [x, y], .. } => {
            let is_normal = ((to[0] - from[0]) * x + (to[1] - from[1]) * y).abs() < 1e-9;
            Some(if is_normal { "edge, straight, free along it" } else { "edge, straight, free transversely" })
        }
        _ => None,
    };
    let by_mean = !is_gripped && specimen.load_measure == LoadMeasure::Stress;
    let otherwise = if by_mean { "mean of the edge under uniform stress" } else { "loaded places" };
    specimen.supports.iter().find_map(of_edge).unwrap_or(otherwise)
}
