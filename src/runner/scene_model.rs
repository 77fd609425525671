//! What was chosen for a scene.

use serde_json::Value;

use perilife_base::units::MM;
use perilife_results::model_words::{ANGLE, Choice, RATIO, SPACING, TWO_SPRINGS, clean, given};
use perilife_scenes::scene::{Scene, SceneLaw};

/// The model of a scene; `finest` is the least spacing of its points, m, once they are laid.
pub fn of_scene(scene: &Scene, finest: Option<f64>) -> Vec<Choice> {
    let model = &scene.model;
    let chosen = |key, value: Value, default: &str| {
        let why = if given(&scene.echo, key) { "set in the file" } else { default };
        Choice { key, value, why: Some(why.to_owned()) }
    };
    let mut choices = match model.law {
        SceneLaw::Bonds(law) => vec![
            chosen("bond_law", law.kind.name().into(), TWO_SPRINGS),
            chosen("kernel", law.kernel.name().into(), "default: as published"),
            chosen("rotation", law.rotation.name().into(), "default: no energy of rigid rotation"),
            chosen("surface_correction", law.surface_correction.name().into(), "default: as published"),
            chosen("kinematics", if model.finite { "finite" } else { "small" }.into(), "default: small strains"),
        ],
        SceneLaw::Correspondence { control, factor } => vec![
            chosen("bond_law", "correspondence".into(), TWO_SPRINGS),
            chosen("zero_energy_control", control.name().into(), "default: does not affect uniform strain"),
            chosen("zero_energy_factor", factor.into(), "default: bending, shear and a pressed disc together"),
        ],
    };
    choices.push(chosen("discretisation", model.arrangement.name().into(), "default: one spacing"));
    choices.push(chosen("spacing_mm", clean(model.spacing / MM).into(), SPACING));
    choices.extend(finest.map(|finest| Choice { key: "finest_spacing_mm", value: clean(finest / MM).into(), why: None }));
    choices.push(chosen("horizon_ratio", model.horizon_ratio.into(), RATIO));
    choices.push(chosen("lattice_angle_deg", clean(model.lattice_angle.to_degrees()).into(), ANGLE));
    choices.push(chosen("solver", model.solver.name().into(), "default: that of the procedure"));
    choices
}
