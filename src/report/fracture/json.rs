//! `result.json` of a fracture scene.

use serde_json::{Value, json};

use super::rows;
use crate::fracture::outcome::PathPoint;
use crate::fracture::scene::{Action, Procedure, Scene, SceneLaw};
use crate::fracture::{Fracture, SceneEnd};
use crate::report::model_words::{self, clean};
use crate::report::provenance;
use crate::units::MM;

/// The whole object. A figure that does not exist is `null`.
pub fn result(scene: &Scene, fracture: &Fracture) -> Value {
    let figures = &fracture.figures;
    let peak = rows(fracture).max_by(|a, b| a.load.total_cmp(&b.load));
    let last = rows(fracture).last();
    let warnings: Vec<&String> = scene.warnings.iter().chain(&fracture.warnings).collect();
    let mut result = json!({
        "name": scene.name,
        "stop_reason": fracture.end.name(),
        "stop_meaning": fracture.end.meaning(),
        "converged": !matches!(fracture.end, SceneEnd::NoConvergence | SceneEnd::Unstable),
        "peak_load_n": peak.map(|row| clean(row.load.max(0.0))),
        "peak_step": peak.map(|row| row.step),
        "peak_displacement_mm": peak.map(|row| clean(row.displacement / MM)),
        "onset_step": fracture.onset_step,
        "onset_time_s": fracture.onset_step.and_then(|step| time_of(step, fracture)),
        "separated_step": fracture.separated_step,
        "separated_time_s": fracture.separated_step.and_then(|step| time_of(step, fracture)),
        "broken_bonds": last.map(|row| row.broken_bonds),
        "energy_balance_error": energy_error(fracture),
        "flanks_pressed_share": figures.touching.map(|flanks| clean(flanks.share())),
        "fronts": fronts(fracture),
        "points": figures.points,
        "bonds": figures.bonds,
        "steps": last.map(|row| row.step),
        "evaluations": figures.evaluations,
        "time_step_s": (figures.time_step > 0.0).then_some(figures.time_step),
        "wall_s": figures.wall_s,
        "memory_mb": figures.memory_mb,
        "loading": loading(scene),
        "model": model_words::object(&model_words::of_scene(scene, Some(fracture.grid.spacing))),
        "damage": damage(scene),
        "warnings": warnings,
        "version": env!("CARGO_PKG_VERSION"),
        "case": scene.echo,
    });
    let tables = super::tables(fracture);
    let tables: Vec<(&str, &str)> = tables.iter().map(|(name, text)| (*name, &**text)).collect();
    provenance::add(&mut result, &scene.provenance, &tables);
    result
}

/// Time of a step where there is time.
fn time_of(step: usize, fracture: &Fracture) -> Option<f64> {
    (fracture.figures.time_step > 0.0).then(|| clean(step as f64 * fracture.figures.time_step))
}

/// Largest of |kinetic + strain + fracture - work| over the largest energy of the history.
fn energy_error(fracture: &Fracture) -> Option<f64> {
    let largest = rows(fracture).map(|row| row.kinetic.max(row.strain).max(row.work.abs())).fold(0.0, f64::max);
    let left = rows(fracture).map(|row| (row.kinetic + row.strain + row.fracture - row.work).abs()).fold(0.0, f64::max);
    (largest > 0.0).then(|| left / largest).filter(|error| error.is_finite())
}

/// Where every crack front stands at the end.
fn fronts(fracture: &Fracture) -> Value {
    let count = fracture.path.iter().map(|point| point.tip + 1).max().unwrap_or(0);
    let last = |tip: usize| fracture.path.iter().rev().find(|point| point.tip == tip);
    let words = |point: &PathPoint| {
        json!({
            "tip": point.tip, "step": point.step, "time_s": point.time,
            "x_mm": clean(point.position[0] / MM), "y_mm": clean(point.position[1] / MM), "damage": clean(point.damage),
        })
    };
    (0..count).filter_map(last).map(words).collect()
}

fn loading(scene: &Scene) -> Value {
    let kinds: Vec<&str> = scene
        .drives
        .iter()
        .map(|drive| match drive.action {
            Action::Traction(_) => "traction",
            Action::Displacement(_) => "displacement",
            Action::Velocity(_) => "velocity",
            Action::Platen(_) => "platens",
        })
        .collect();
    match scene.procedure {
        Procedure::Static => json!({ "procedure": "static", "kinds": kinds }),
        Procedure::QuasiStatic { steps, iterations } => {
            json!({ "procedure": "quasi_static", "steps": steps, "iterations_per_step": iterations, "kinds": kinds })
        }
        Procedure::Dynamic { duration, .. } => json!({ "procedure": "dynamic", "duration_s": duration, "kinds": kinds }),
    }
}

fn damage(scene: &Scene) -> Value {
    let damage = &scene.damage;
    let by_points = matches!(scene.model.law, SceneLaw::Correspondence { .. });
    json!({
        "law": damage.law.name(),
        "enters": by_points.then(|| damage.enters.name()),
        "critical_stretch": damage.stretch,
        "elastic_stretch": damage.nonlinear.map(|law| law.elastic),
        "peak_stretch": damage.nonlinear.map(|law| law.peak),
        "final_stretch": damage.nonlinear.map(|law| law.last),
        "printed_law": damage.nonlinear.map(|law| law.printed),
    })
}
