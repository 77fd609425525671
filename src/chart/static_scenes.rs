//! Plates without cracks whose answer is known: uniform tension, and a hole in it.

use crate::body::Body;
use crate::case::{Case, Method};
use crate::element_free::rim_stress::Rim;
use crate::error::{Error, Result};
use crate::solver::Equilibrium;
use crate::solver::field::Layout;
use crate::specimen::Point;
use crate::specimen::geometry::distance;
use crate::state::Bonds;
use crate::stress_concentration::stressed;
use crate::stress_intensity::{TipFrame, derivatives_at};
use crate::units::MM;
use crate::verify::element_free::rims::concentration_of;
use crate::verify::scene::{plate_alone, pulled_plate};
use crate::verify::uniform_tension::{strip, uniform_tension_with};

use super::run::points_of;
use super::scene::Found;

/// Where the stress at the hole comes from.
pub const HOLE_SOURCE: &str = "Howland 1930 (fit of Pilkey and Pilkey 2008)";
/// How far that may be off, percent.
pub const HOLE_UNCERTAINTY_PERCENT: f64 = 0.5;
/// Width and length of the plates and diameter of the hole, mm.
const WIDTH_MM: f64 = 100.0;
const LENGTH_MM: f64 = 200.0;
const DIAMETER_MM: f64 = 20.0;
/// The plate in uniform tension.
pub fn tension_case(set: &[String]) -> Result<Case> {
    of_text(&pulled_plate(&format!("width_mm = {WIDTH_MM}\nlength_mm = {LENGTH_MM}")), set)
}

/// The plate with the hole.
pub fn hole_case(set: &[String]) -> Result<Case> {
    let hole = format!("holes = [{{ x_mm = 0, y_mm = 0, diameter_mm = {DIAMETER_MM} }}]");
    of_text(&pulled_plate(&format!("width_mm = {WIDTH_MM}\nlength_mm = {LENGTH_MM}\n{hole}")), set)
}

fn of_text(text: &str, set: &[String]) -> Result<Case> {
    let keys: Vec<&str> = set.iter().map(String::as_str).collect();
    plate_alone(text, &keys)
}

/// Displacement of a plate in uniform tension.
///
/// # Errors
/// No equilibrium; nodes, which reproduce linear fields and are not asked.
pub fn tension(case: &Case) -> Result<Found> {
    on_points(case)?;
    let (specimen, model) = (&case.specimen, &case.model);
    let plate = strip(specimen.width, specimen.length());
    let resolution = (model.spacing, model.horizon_ratio, model.lattice_angle);
    let by = (model.solver, model.symmetry);
    let errors = uniform_tension_with(by, &plate, &model.bond_law, case.material.poisson_ratio, resolution)?;
    Ok(Found { points: points_of(case), solves: 1, error_percent: errors.along, path_rms_mm: None })
}

/// σ_y at both sides of the hole over the stress far away.
///
/// The rim is free, so that σ_y = E ε_y there; ε_y comes from the quadratic through the displacements around the point nearest to
/// the place, taken on to the rim.
pub fn hole(case: &Case) -> Result<Found> {
    if case.model.method == Method::ElementFreeGalerkin {
        return hole_on_nodes(case);
    }
    on_points(case)?;
    let model = &case.model;
    let body =
        Body::build(&case.specimen, &case.material, &model.bond_law, model.spacing, model.horizon_ratio, model.lattice_angle)?;
    let bonds = Bonds::new(&body);
    let mut displacement = Vec::new();
    Equilibrium::new(model.solver, model.symmetry, &body, &bonds, case.loading.maximum).solve(
        &body,
        &bonds,
        &mut displacement,
    )?;
    let layout = Layout::of(&body.lattice, body.stencil.unknowns);
    let frame = TipFrame { origin: [0.0; 2], ahead: [1.0, 0.0] };
    let radius = 0.5 * DIAMETER_MM * MM;
    let strain = |side: Point| -> Result<f64> {
        let gap = |place: &u32| distance(body.lattice.position(*place as usize), side);
        let nearest = body.points.iter().copied().min_by(|a, b| gap(a).total_cmp(&gap(b)));
        let place = nearest.ok_or_else(|| Error::Mechanics("a plate without points".to_owned()))? as usize;
        let [x, y] = body.lattice.position(place);
        let found = derivatives_at(&body, &bonds, &layout, &displacement, &frame, place);
        let found = found.ok_or_else(|| Error::Mechanics("too few bonds beside the hole for a strain".to_owned()))?;
        Ok(found.at([side[0] - x, side[1] - y])[1][1])
    };
    let mean = 0.5 * (strain([radius, 0.0])? + strain([-radius, 0.0])?);
    let concentration = case.material.youngs_modulus * mean / case.loading.maximum;
    Ok(Found { points: body.points.len(), solves: 1, error_percent: off(concentration), path_rms_mm: None })
}

/// The same by the stress along the rim, on nodes.
fn hole_on_nodes(case: &Case) -> Result<Found> {
    let stressed = stressed(case)?;
    let largest = stressed.rims.iter().find(|rim| rim.rim == Rim::Hole(0)).map(|rim| rim.largest.stress);
    let concentration = largest.and_then(|stress| stressed.concentration(stress)).unwrap_or(f64::NAN);
    Ok(Found { points: stressed.nodes, solves: stressed.solves, error_percent: off(concentration), path_rms_mm: None })
}

/// Size of the error of a stress concentration, percent.
fn off(concentration: f64) -> f64 {
    100.0 * (concentration / concentration_of(DIAMETER_MM / WIDTH_MM) - 1.0).abs()
}

fn on_points(case: &Case) -> Result<()> {
    if case.model.method == Method::Peridynamics {
        return Ok(());
    }
    Err(Error::Mechanics(format!("{} is not asked for a plate without a crack", case.model.method)))
}
