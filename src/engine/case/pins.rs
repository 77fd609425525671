//! Where elastic pins touch their holes when a case begins.

use super::{Case, Model};
use crate::element_free::crack::initial_cracks;
use crate::element_free::field::Discretisation;
use crate::element_free::solve::solve;
use crate::error::{Error, Result, input};
use crate::specimen::{Bearing, Load};
use crate::williams::Elasticity;

/// Finds where the elastic pins of a case touch at maximum load, on nodes with the initial cracks, and puts that on its loads. Points keep
/// it as the cracks grow; nodes find contact anew in every equilibrium.
/// Errors: what does not go with such pins; those of the equilibrium.
pub(super) fn settle(case: &mut Case) -> Result<()> {
    let Some(hole) = case.specimen.loads.iter().find_map(|load| match load {
        Load::Pin { hole, .. } if load.is_elastic_pin() => Some(*hole),
        _ => None,
    }) else {
        return Ok(());
    };
    let key =
        if case.specimen.kind == crate::specimen::SpecimenKind::Plate { "loading.pins" } else { "specimen.pin_diameter_mm" };
    let refused = |problem: &str, remedy: &str| Err(input(key, format!("pin of hole {hole}"), problem, remedy));
    if case.loading.displacement().is_some() {
        let problem = "touches as its force says, which cycles of a displacement do not know beforehand";
        return refused(problem, "give its contact half angle");
    }
    if matches!(case.model, Model::Handbook(_)) {
        return refused(
            "is not known to the handbook, whose K is that of its own pins",
            "use another model.method, or leave the pin out",
        );
    }
    let (lines, tips) = initial_cracks(&case.specimen);
    let resolution = case.nodes().resolution;
    let plate = Discretisation::new(&case.specimen, Elasticity::of(&case.material), &lines, &tips, &resolution)?;
    let solution = solve(&case.specimen, &plate, resolution.far, case.loading.maximum).map_err(|error| match error {
        Error::LossOfStiffness => Error::Mechanics("what is left of the plate cannot carry the load of its pins".to_owned()),
        other => other,
    })?;
    for (load, contact) in solution.contacts {
        if let Load::Pin { contact: Bearing::Elastic(pin), .. } = &mut case.specimen.loads[load] {
            pin.found = Some(contact.into());
        }
    }
    Ok(())
}
