//! Time against error in scenes with a known answer, one thing varied at a time.

use super::Bench;
use super::clock::Timing;
use super::extrapolation::History;
use super::row::Row;
use super::scene::{Found, Scene, cracked_plate as cracked, displacement, k_i, life, middle_tension as middle};
use super::scene::{single_edge as single, tension_plate as tension};
use super::solvers::{Budget, whole_or_extrapolated};
use super::variant::{DEFAULT, Variant, variants};
use crate::case::Case;
use crate::error::{Error, Result};
use crate::predict::{Silent, predict};

/// Solvers are compared on the whole plate, whatever symmetry would allow.
pub(super) const WHOLE_PLATE: &str = "model.symmetry=off";

/// Life of a middle-tension panel.
///
/// # Errors
/// The default must run; a variant that fails is a row that says so.
pub fn middle_tension(bench: &mut Bench<'_>) -> Result<()> {
    lives(bench, &middle(bench.effort.quick))
}

/// Life of a single-edge panel.
///
/// # Errors
/// As [`middle_tension`].
pub fn single_edge(bench: &mut Bench<'_>) -> Result<()> {
    lives(bench, &single(bench.effort.quick))
}

/// K_I of a cracked plate.
///
/// # Errors
/// As [`middle_tension`].
pub fn cracked_plate(bench: &mut Bench<'_>) -> Result<()> {
    statics(bench, &cracked(bench.effort.quick), k_i)
}

/// Displacements of a plate in tension.
///
/// # Errors
/// As [`middle_tension`].
pub fn tension_plate(bench: &mut Bench<'_>) -> Result<()> {
    statics(bench, &tension(bench.effort.quick), displacement)
}

fn statics(bench: &mut Bench<'_>, scene: &Scene, compute: impl Fn(&Case) -> Result<Found>) -> Result<()> {
    let default = scene.case(&[])?;
    default_row(bench, scene, || compute(&default))?;
    for variant in variants(scene, &default, bench.effort.quick) {
        let case = scene.case(&variant.set)?;
        let measured = bench.time(|| compute(&case));
        push(bench, scene, &variant, measured)?;
    }
    Ok(())
}

fn lives(bench: &mut Bench<'_>, scene: &Scene) -> Result<()> {
    let by_hand = predict(&scene.by_hand()?, &Silent)?;
    let default = scene.case(&[])?;
    let found = default_row(bench, scene, || life(&default, &by_hand))?;
    let (history, _) = History::of(&scene.case(&[WHOLE_PLATE.to_owned()])?)?;
    let budget = Budget { blocks_s: bench.effort.seconds_of_blocks, whole_s: bench.effort.seconds_whole };
    for variant in variants(scene, &default, bench.effort.quick) {
        let case = scene.case(&variant.set)?;
        let measured = match variant.solver {
            Some(_) => {
                let known = (&history, &found);
                whole_or_extrapolated(bench, &case, known, budget, |case| life(case, &by_hand))
            }
            None => bench.time(|| life(&case, &by_hand)),
        };
        push(bench, scene, &variant, measured)?;
    }
    Ok(())
}

fn default_row(bench: &mut Bench<'_>, scene: &Scene, run: impl FnMut() -> Result<Found>) -> Result<Found> {
    let (found, timing) = bench.time(run)?;
    let row = Row::new(scene.name, &*scene.about, DEFAULT, "default", timing);
    bench.push(with(row, &found));
    Ok(found)
}

/// A row of a variant; one that the mechanics stopped says why and has no error.
fn push(bench: &mut Bench<'_>, scene: &Scene, variant: &Variant, measured: Result<(Found, Timing)>) -> Result<()> {
    let row = |timing| Row::new(scene.name, &*scene.about, variant.varied, &variant.choice, timing);
    let row = match measured {
        Ok((found, timing)) => with(row(timing), &found),
        Err(error @ (Error::Mechanics(_) | Error::LossOfStiffness)) => Row { note: error.to_string(), ..row(Timing::NONE) },
        Err(other) => return Err(other),
    };
    bench.push(row);
    Ok(())
}

/// A row with what was found.
pub(super) fn with(row: Row, found: &Found) -> Row {
    let note = match (row.timing.extrapolated_from, row.timing.estimated_s) {
        (Some(blocks), _) => format!("extrapolated from {blocks} blocks along the run; error taken from the default solver"),
        (None, Some(seconds)) => format!("measured whole; some blocks along the run would have said {seconds:.3} s"),
        (None, None) => String::new(),
    };
    Row { points: found.points, error: found.error.clone(), broken_bonds: found.broken_bonds, note, ..row }
}
