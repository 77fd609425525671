//! Where elastic pins touch their holes when a case begins.

use super::{Case, Model};
use perilife_base::error::{Error, Result, input};
use perilife_base::units::MM;
use perilife_nodes::crack::initial_cracks;
use perilife_nodes::field::Discretisation;
use perilife_nodes::solve::solve;
use perilife_plate::loading::LoadControl;
use perilife_plate::specimen::{Bearing, Load, SpecimenKind};
use perilife_plate::williams::Elasticity;

/// Finds where the elastic pins of a case touch at maximum load, on nodes with the initial cracks, and puts that on its loads. Points keep
/// it as the cracks grow; nodes find contact anew in every equilibrium.
/// Errors: what does not go with such pins; those of the equilibrium.
pub(super) fn settle(case: &mut Case) -> Result<()> {
    let Some((hole, radius)) = case.specimen.loads.iter().find_map(|load| match load {
        Load::Pin { hole, contact: Bearing::Elastic(pin), .. } => Some((*hole, pin.radius)),
        _ => None,
    }) else {
        return Ok(());
    };
    let (key, value) = match case.specimen.kind {
        SpecimenKind::Plate => ("loading.pins", format!("pin of hole {hole}")),
        _ => ("specimen.pin_diameter_mm", ((2e6 * radius / MM).round() / 1e6).to_string()),
    };
    let refused = |problem: &str, remedy: &str| Err(input(key, value.clone(), problem, remedy));
    if case.loading.control != LoadControl::Load {
        let problem = "has a contact arc that depends on force, which varies with crack length";
        return refused(problem, "give its contact half angle");
    }
    if matches!(case.model, Model::Handbook(_)) {
        return refused(
            "is not supported by the handbook formula (it assumes its own pins)",
            "use model.method = \"element_free_galerkin\"",
        );
    }
    let plate = initial_plate(case)?;
    let solution =
        solve(&case.specimen, &plate, case.nodes().resolution.far, case.loading.maximum).map_err(|error| match error {
            Error::LossOfStiffness => Error::Mechanics("a part of the plate moves freely under the pin loads".to_owned()),
            other => other,
        })?;
    for (load, contact) in solution.contacts {
        if let Load::Pin { contact: Bearing::Elastic(pin), .. } = &mut case.specimen.loads[load] {
            pin.found = Some(contact.into());
        }
    }
    Ok(())
}

/// The nodes of a case with its initial cracks.
/// Errors: too many cells.
pub fn initial_plate(case: &Case) -> Result<Discretisation> {
    let (lines, tips) = initial_cracks(&case.specimen);
    let (resolution, residual) = (case.nodes().resolution, case.loading.residual.as_deref());
    Discretisation::new(&case.specimen, Elasticity::of(&case.material), &lines, &tips, &resolution, residual)
}
