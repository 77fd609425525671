//! The body that a run would compute, looked at before anything is solved.

use super::understood::short;
use crate::body::Body;
use crate::body::lattice::Lattice;
use crate::case::{Case, Method};
use crate::error::{Error, InputError, Result};
use crate::fatigue::crack_tip::CrackTip;
use crate::fatigue::no_fail::stuck;
use crate::fatigue::pieces::{Cut, set_aside};
use crate::state::Bonds;
use crate::units::MM;

/// Points up to which the body is built; well below a second.
const POINTS_BUILT: f64 = 4e5;

/// What the lattice makes of a case.
pub(super) struct Preview {
    /// Points, spacing and horizon in words.
    pub points: String,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Lays the lattice and, where that is quick, builds the body.
pub(super) fn preview(case: &Case) -> Result<Preview> {
    if case.model.method == Method::Handbook {
        return Ok(Preview { points: "none: hand calculation".to_owned(), warnings: Vec::new() });
    }
    let (model, specimen) = (&case.model, &case.specimen);
    let about = specimen.area() / model.spacing.powi(2);
    if about > POINTS_BUILT {
        let padding = model.horizon_ratio.floor() as usize;
        let lattice = Lattice::over(specimen, model.spacing, model.lattice_angle, padding)?;
        let count = format!("about {:.0}", specimen.area() / lattice.spacing.powi(2));
        return Ok(Preview { points: points_line(case, &count, lattice.spacing), warnings: Vec::new() });
    }
    let body = Body::build(specimen, &case.material, &model.bond_law, model.spacing, model.horizon_ratio, model.lattice_angle)
        .map_err(as_input)?;
    let mut bonds = Bonds::new(&body);
    if set_aside(&body, &mut bonds, &body.pre_cut) == Cut::Severed {
        return Err(as_input(Error::Mechanics("the initial cracks cut the plate in two".to_owned())));
    }
    let count =
        format!("{} and {} bonds, {} of them cut by the initial cracks", body.points.len(), body.bond_count, body.pre_cut.len());
    let tips: Vec<CrackTip> = specimen.tips.iter().map(|seed| CrackTip::at(seed, &body)).collect();
    let held = stuck(&body, &bonds, &tips, &case.fatigue).into_iter().map(|tip| {
        let [x, y] = tips[tip].position.map(|metres| short(metres / MM));
        format!(
            "the crack tip at ({x}, {y}) mm stands in the zone around a load or support, where bonds do not fail: it will not \
             grow; move it one horizon away ({} mm), or load the plate elsewhere",
            short(body.horizon() / MM)
        )
    });
    Ok(Preview { points: points_line(case, &count, body.lattice.spacing), warnings: held.collect() })
}

fn points_line(case: &Case, count: &str, spacing: f64) -> String {
    let model = &case.model;
    let asked = short(model.spacing / MM);
    let spacing_words = match short(spacing / MM) {
        actual if actual == asked => format!("spacing {actual} mm"),
        actual => format!("spacing {actual} mm ({asked} asked for)"),
    };
    format!(
        "{count} at {spacing_words}, horizon {} mm (ratio {}), solver {}",
        short(spacing * model.horizon_ratio / MM),
        model.horizon_ratio,
        model.solver
    )
}

/// What a run would end with as mechanics is, seen before any run, input that has to change.
pub(super) fn as_input(error: Error) -> Error {
    match error {
        Error::Mechanics(problem) => Error::Input(Box::new(InputError { problem, ..InputError::default() })),
        other => other,
    }
}
