//! What was chosen for a case or a scene: key, value and reason of every choice, in the order of `result.json`.

use serde_json::{Map, Value};

use super::json::clean;
use crate::bond_law::{BondLaw, BondLawKind};
use crate::case::{Case, LawSource, Method};
use crate::fracture::scene::{Scene, SceneLaw};
use crate::net::Refinement;
use crate::predict::RunFigures;
use crate::solver::SolverUsed;
use crate::specimen::handbook::handbook;
use crate::units::MM;

/// Keys that say how bonds resist.
pub const OF_BONDS: [&str; 7] =
    ["bond_law", "kernel", "rotation", "surface_correction", "kinematics", "zero_energy_control", "zero_energy_factor"];

/// One choice.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Its key in the input file or of the result.
    pub key: &'static str,
    /// What was chosen.
    pub value: Value,
    /// Whether the file asked for it or the program chose it, and why; `None` for what follows from other choices.
    pub why: Option<String>,
}

/// The choices as one object, reasons under `why`.
#[must_use]
pub fn object(choices: &[Choice]) -> Value {
    let why = |choice: &Choice| Some((choice.key.to_owned(), choice.why.clone()?.into()));
    let why: Map<String, Value> = choices.iter().filter_map(why).collect();
    let mut object: Map<String, Value> = choices.iter().map(|choice| (choice.key.to_owned(), choice.value.clone())).collect();
    object.insert("why".to_owned(), why.into());
    object.into()
}

/// The choices of these keys in words: the first value, then key and value of the others.
#[must_use]
pub fn words(choices: &[Choice], keys: &[&str]) -> String {
    let value = |choice: &Choice| choice.value.as_str().map_or_else(|| choice.value.to_string(), str::to_owned);
    let chosen = choices.iter().filter(|choice| keys.contains(&choice.key)).enumerate();
    let words = chosen.map(|(i, choice)| match i {
        0 => value(choice),
        _ => format!("{} {}", choice.key.replace('_', " "), value(choice)),
    });
    words.collect::<Vec<_>>().join(", ")
}

/// The model of a case; sizes and solved part are those of its run where there was one.
#[must_use]
pub fn of_case(case: &Case, figures: Option<&RunFigures>) -> Vec<Choice> {
    let model = &case.model;
    if model.method == Method::Handbook {
        return hand_calculation(case);
    }
    let (spacing, horizon) =
        figures.map_or((model.spacing, model.spacing * model.horizon_ratio), |figures| (figures.spacing, figures.horizon));
    let used = figures.and_then(|figures| figures.solver);
    let mut values: Vec<(&'static str, Value)> =
        vec![("method", model.method.name().into()), ("driver", case.fatigue.driver.name().into())];
    values.extend(bonds(model.bond_law));
    values.extend([
        ("discretisation", model.arrangement.name().into()),
        ("levels", (1 + model.refinement.as_ref().map_or(0, Refinement::deepest)).into()),
        ("spacing_mm", clean(spacing / MM).into()),
        ("spacing_coarsest_mm", clean(spacing * model.coarsest_spacing() / model.spacing / MM).into()),
        ("horizon_ratio", model.horizon_ratio.into()),
        ("horizon_mm", clean(horizon / MM).into()),
        ("lattice_angle_deg", clean(model.lattice_angle.to_degrees()).into()),
        ("solver", used.map_or(model.solver.name(), SolverUsed::name).into()),
        ("symmetry", model.symmetry.name().into()),
    ]);
    let choice = |(key, value)| Choice { key, value, why: why(case, figures, key) };
    values.into_iter().map(choice).collect()
}

/// The model of a scene; `finest` is the least spacing of its points, m, once they are laid.
#[must_use]
pub fn of_scene(scene: &Scene, finest: Option<f64>) -> Vec<Choice> {
    let model = &scene.model;
    let mut values: Vec<(&'static str, Value)> = match model.law {
        SceneLaw::Bonds(law) => {
            let kinematics = ("kinematics", if model.finite { "finite" } else { "small" }.into());
            bonds(law).into_iter().chain([kinematics]).collect()
        }
        SceneLaw::Correspondence { control, factor } => vec![
            ("bond_law", "correspondence".into()),
            ("zero_energy_control", control.name().into()),
            ("zero_energy_factor", factor.into()),
        ],
    };
    values.extend([("discretisation", model.arrangement.name().into()), ("spacing_mm", clean(model.spacing / MM).into())]);
    values.extend(finest.map(|finest| ("finest_spacing_mm", clean(finest / MM).into())));
    values.extend([
        ("horizon_ratio", model.horizon_ratio.into()),
        ("lattice_angle_deg", clean(model.lattice_angle.to_degrees()).into()),
        ("solver", model.solver.name().into()),
    ]);
    let given = |key: &str| scene.echo.get("model").is_some_and(|model| model.get(key).is_some());
    let why = |key: &str| {
        let reason = reason(&WHY_IN_SCENES, key).or_else(|| reason(&WHY, key))?;
        Some(if given(key) { "given in the file" } else { reason }.to_owned())
    };
    values.into_iter().map(|(key, value)| Choice { key, value, why: why(key) }).collect()
}

fn bonds(law: BondLaw) -> [(&'static str, Value); 4] {
    [
        ("bond_law", law.kind.name().into()),
        ("kernel", law.kernel.name().into()),
        ("rotation", law.rotation.name().into()),
        ("surface_correction", law.surface_correction.name().into()),
    ]
}

/// The formula of method `handbook`. Other keys of `[model]` say nothing there.
fn hand_calculation(case: &Case) -> Vec<Choice> {
    let formula = handbook(&case.specimen);
    let choice = |key, value: Option<&str>, why: Option<&str>| Choice { key, value: value.into(), why: why.map(str::to_owned) };
    vec![
        choice("method", Some(case.model.method.name()), Some("given in the case")),
        choice("formula", formula.map(|formula| formula.name), Some("that of the kind of specimen")),
        choice("source", formula.map(|formula| formula.source), None),
        choice("range", formula.map(|formula| formula.range), None),
    ]
}

/// Why the program takes what it takes where the file leaves a choice open.
const WHY: [(&str, &str); 11] = [
    ("method", "default: computes any plate and the path of its cracks"),
    ("bond_law", "default: takes Poisson's ratio from the material instead of fixing it"),
    ("kernel", "default: of the kernels tried, its crack growth depends least on the lattice"),
    ("rotation", "default: rigid rotation of crack flanks must cost no energy"),
    ("surface_correction", "default: the most accurate one built"),
    ("discretisation", "default: one spacing everywhere"),
    ("spacing_mm", "default: the smaller of crack length / 9 and width / 100"),
    ("horizon_ratio", "default: 3.015, three neighbours in every lattice direction"),
    ("lattice_angle_deg", "default: lattice rows along x"),
    ("solver", "default: the fastest exact one built"),
    ("symmetry", "default: exact"),
];

/// The same where a fracture scene differs.
const WHY_IN_SCENES: [(&str, &str); 7] = [
    ("kernel", "default: that of the law's literature"),
    ("rotation", "default: as the law is printed"),
    ("surface_correction", "default: that of the literature"),
    ("kinematics", "default: strains are small"),
    ("zero_energy_control", "default: leaves uniform strain alone"),
    ("zero_energy_factor", "default: 1"),
    ("solver", "default: that of the procedure"),
];

fn reason(reasons: &[(&str, &'static str)], key: &str) -> Option<&'static str> {
    reasons.iter().find(|(known, _)| *known == key).map(|(_, reason)| *reason)
}

/// Why the default bond law is not taken.
const BEYOND_SPRINGS: &str = "chosen: springs alone cannot have this Poisson's ratio";

/// Choices that a fitted law is meaningless without.
const FIXED_BY_RECORD: [&str; 5] = ["bond_law", "kernel", "rotation", "surface_correction", "horizon_ratio"];

fn why(case: &Case, figures: Option<&RunFigures>, key: &str) -> Option<String> {
    let reason = reason(&WHY, key)?;
    let given = case.echo.get("model").is_some_and(|model| model.get(key).is_some());
    let recorded = match &case.law {
        // A record of hand calculation fixes nothing.
        LawSource::Fitted(record) => record.rate_constant.is_some() && FIXED_BY_RECORD.contains(&key),
        _ => false,
    };
    let source = match (given, recorded) {
        (true, _) => "given in the case",
        (false, true) => "as in the fitted record: the law holds for this choice only",
        (false, false) if key == "bond_law" && case.model.bond_law.kind == BondLawKind::StateBased => BEYOND_SPRINGS,
        (false, false) => reason,
    };
    let of_the_run = match key {
        "spacing_mm" => {
            let finest = if case.model.refinement.is_some() { "; that of the finest level, on which cracks grow" } else { "" };
            let (asked, actual) = (case.model.spacing / MM, figures.map_or(case.model.spacing, |figures| figures.spacing) / MM);
            let is_moved = ((asked - actual) / actual).abs() > 1e-9;
            let moved = is_moved.then(|| format!("; moved from {asked:.6} to {actual:.6} so that it divides the width"));
            format!("{finest}{}", moved.unwrap_or_default())
        }
        "solver" => figures
            .and_then(|figures| figures.solver)
            .map_or_else(String::new, |used| format!("; asked for was \"{}\", used were {}", case.model.solver, used.meaning())),
        "symmetry" => figures.map_or_else(String::new, |figures| format!("; {}", solved_part(figures))),
        _ => String::new(),
    };
    Some(format!("{source}{of_the_run}"))
}

/// How much of the plate was solved for.
fn solved_part(figures: &RunFigures) -> &'static str {
    let (all, solved) = (figures.points, figures.points_solved);
    // A line of symmetry through a row of points leaves half a row more.
    match (solved == all, 3 * solved > all) {
        (true, _) => "the whole plate was solved",
        (false, true) => "one half was solved, the other is its mirror image",
        (false, false) => "a quarter was solved, the others are its mirror images",
    }
}
