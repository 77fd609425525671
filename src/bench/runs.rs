//! Whole runs of published plates.

use std::path::Path;

use super::clock::Timing;
use super::extrapolation::History;
use super::row::{Asked, Row};
use super::scene::Found;
use super::solvers::{Budget, whole_or_extrapolated};
use super::speed_accuracy::{WHOLE_PLATE, with};
use super::variant::{DEFAULT, VARIED};
use super::{Bench, Figure};
use crate::case::Case;
use crate::error::Result;
use crate::predict::{Silent, predict};
use crate::solver::SolverKind;

const VIRKLER: &str = include_str!("../../data/cases/virkler_panel.toml");
const SLANT: &str = include_str!("../../data/cases/slant_crack_plate.toml");

/// What is asked of the whole run over that with other solvers, by their names: times as long at least.
const ASKED: [(&str, f64); 2] = [("adaptive_dynamic_relaxation", 200.0), ("multigrid", 10.0)];
/// Milliseconds asked for a broken bond.
const ASKED_MS: f64 = 3.0;
/// Seconds asked for the panel and the slant plate.
const ASKED_S: [f64; 2] = [10.0, 8.0];

fn read(text: &str, name: &str, set: &[&str]) -> Result<Case> {
    let set: Vec<String> = ["fatigue.driver=bond_strain", "fatigue.growth_rate=bond_strain"]
        .iter()
        .chain(set)
        .map(|key| (*key).to_owned())
        .collect();
    Case::from_toml(text, name, Path::new("."), &set)
}

/// The Virkler panel by every solver.
///
/// # Errors
/// As [`predict`].
pub fn virkler_panel(bench: &mut Bench<'_>) -> Result<()> {
    const GROUP: &str = "virkler_panel";
    let (sizes, about): (&[&str], _) = match bench.effort.quick {
        true => (&["model.spacing_mm=3", "stop.crack_length_mm=15"], "Virkler panel, 9 to 15 mm, 3 mm"),
        false => (&["model.spacing_mm=1", "stop.crack_length_mm=45"], "Virkler panel, 9 to 45 mm, 1 mm"),
    };
    let panel = |set: &[&str]| read(VIRKLER, GROUP, &[sizes, set].concat());
    let default = panel(&[])?;
    let whole = |case: &Case| -> Result<Found> { found_by(case) };
    let (found, window) = bench.time(|| whole(&default))?;
    bench.push(with(Row::new(GROUP, about, DEFAULT, default.model.solver.name(), window), &found));

    let off = panel(&[WHOLE_PLATE])?;
    let (_, unmirrored) = bench.time(|| whole(&off))?;
    bench.push(with(Row::new(GROUP, about, VARIED[5], "symmetry off", unmirrored), &found));
    let (history, run) = History::of(&panel(&[WHOLE_PLATE])?)?;
    let known = Found { points: run.figures.points, ..found.clone() };
    let budget = Budget { blocks_s: 15.0 * bench.effort.seconds_of_blocks, whole_s: 4.0 * bench.effort.seconds_whole };
    for kind in SolverKind::ALL.iter().filter(|kind| **kind != default.model.solver) {
        let solver = format!("model.solver={kind}");
        let case = panel(&[&solver, WHOLE_PLATE])?;
        let (other, timing) = whole_or_extrapolated(bench, &case, (&history, &known), budget, whole)?;
        bench.push(with(Row::new(GROUP, about, "solver", &format!("{kind}, every block"), timing), &other));
        let asked = ASKED.iter().find(|(name, _)| *name == kind.name()).map(|(_, least)| Asked::AtLeast(*least));
        for (over, by, asked) in [("the default run", window, asked), ("the default solver on the whole plate", unmirrored, None)]
        {
            let quantity = format!("{kind} after every block, over {over}");
            bench.figure(Figure { group: GROUP, quantity, value: timing.ratio / by.ratio, unit: "", asked });
        }
    }
    let bonds = found.broken_bonds.unwrap_or(0) as f64;
    let figure = |quantity: &str, value, unit, most| Figure {
        group: GROUP,
        quantity: quantity.to_owned(),
        value,
        unit,
        asked: Some(Asked::AtMost(most)),
    };
    bench.figure(figure("default run for every broken bond, set-up included", 1e3 * window.wall_s / bonds, "ms", ASKED_MS));
    bench.figure(figure("default run", window.wall_s, "s", ASKED_S[0]));
    Ok(())
}

/// The plate with a slant crack.
///
/// # Errors
/// As [`predict`].
pub fn slant_plate(bench: &mut Bench<'_>) -> Result<()> {
    const GROUP: &str = "slant_plate";
    let quick = bench.effort.quick;
    let case = read(SLANT, GROUP, if quick { &["model.spacing_mm=2"] } else { &[] })?;
    let about = format!("plate 100 x 300 mm, slant crack, {} mm, until it is in two", if quick { 2 } else { 1 });
    let (found, timing): (Found, Timing) = bench.time(|| found_by(&case))?;
    bench.push(with(Row::new(GROUP, about, DEFAULT, case.model.solver.name(), timing), &found));
    let asked = Some(Asked::AtMost(ASKED_S[1]));
    bench.figure(Figure { group: GROUP, quantity: "default run".to_owned(), value: timing.wall_s, unit: "s", asked });
    Ok(())
}

/// A whole run without a reference.
fn found_by(case: &Case) -> Result<Found> {
    let run = predict(case, &Silent)?;
    Ok(Found { points: run.figures.points, error: None, broken_bonds: run.curve.last().map(|point| point.broken_bonds) })
}
