//! Sections of a scene against each other: what does not go together is refused with the reason.

use super::region::{around, overlap};
use crate::scene::{
    Action, DamageLaw, Discretisation, LoadRamp, Procedure, Region, Scene, SceneLaw, SceneLoad, ZeroEnergyControl,
};
use perilife_base::error::{Result, input, input_missing};
use perilife_base::limits;
use perilife_plate::loading::imbalance;
use perilife_plate::specimen::{Point, Support};
use perilife_points::bond_law::BondLawKind;

pub fn check(scene: &Scene) -> Result<()> {
    check_time(scene)?;
    check_march(scene)?;
    check_damage(scene)?;
    check_arrangement(scene)?;
    check_conflicts(scene)
}

/// Motion needs mass and time; equilibrium has neither.
fn check_time(scene: &Scene) -> Result<()> {
    let acts = |test: fn(&Action) -> bool| scene.drives.iter().any(|drive| test(&drive.action));
    let Procedure::Dynamic { .. } = scene.procedure else {
        if acts(|action| matches!(action, Action::Velocity(_))) {
            let problem = "requires time";
            return Err(input("loading.kind", "\"velocity\"", problem, "give loading.duration_s, or a displacement with steps"));
        }
        return Ok(());
    };
    if scene.material.density.is_none() {
        let problem = "is missing (required for motion)";
        return Err(input_missing("material.density_kg_m3", problem, "give it, or remove loading.duration_s"));
    }
    Ok(())
}

/// A march keeps the fictitious density of the whole body, and its load swings: bodies in contact and shape tensors need a rest.
fn check_march(scene: &Scene) -> Result<()> {
    let Procedure::QuasiStatic { iterations: Some(iterations), .. } = scene.procedure else { return Ok(()) };
    let what = if scene.drives.iter().any(|drive| matches!(drive.action, Action::Platen(_))) {
        "platens (changing contact)"
    } else if matches!(scene.model.law, SceneLaw::Correspondence { .. }) {
        "correspondence (stiffness can increase)"
    } else {
        return Ok(());
    };
    let problem = format!("does not come to rest; cannot be combined with {what}");
    Err(input("loading.iterations_per_step", iterations, problem, "remove it"))
}

fn check_damage(scene: &Scene) -> Result<()> {
    let law = scene.damage.law;
    let refuse = |problem: &str, remedy: &str| Err(input("damage.law", format!("\"{law}\""), problem, remedy));
    match (scene.model.law, law) {
        (SceneLaw::Bonds(_), DamageLaw::PrincipalStress) => refuse(
            "needs the stress of a point, which bond laws do not have",
            "use model.bond_law = \"correspondence\", or critical_stretch",
        ),
        (SceneLaw::Correspondence { .. }, DamageLaw::CriticalEnergy | DamageLaw::NonlinearTwoParameter) => refuse(
            "requires a bond law with springs, not \"correspondence\"",
            "use critical_stretch, which uses material.fracture_energy_j_m2 too, or principal_stress",
        ),
        _ => Ok(()),
    }
}

fn check_arrangement(scene: &Scene) -> Result<()> {
    const KEY: &str = "model.discretisation";
    let arrangement = scene.model.arrangement;
    match (arrangement, scene.model.law) {
        (Discretisation::Lattice, _) if scene.refinement.is_some() => {
            let problem = "conflicts with [refinement]: one spacing everywhere";
            Err(input(KEY, format!("\"{arrangement}\""), problem, "use \"dual_horizon\", or remove the section"))
        }
        (Discretisation::DualHorizon, SceneLaw::Correspondence { .. }) => {
            let problem = "does not support bond_law = \"correspondence\"";
            Err(input(KEY, format!("\"{arrangement}\""), problem, "use \"lattice\", or a bond law"))
        }
        _ => Ok(()),
    }
}

/// What a load prescribes: displacement or velocity of each component.
fn prescribed(drive: &SceneLoad) -> [Option<f64>; 2] {
    match drive.action {
        Action::Displacement(components) | Action::Velocity(components) => components,
        Action::Traction(_) | Action::Platen(_) => [None; 2],
    }
}

/// A prescribed motion with how it rises; rest is rest, however it comes.
fn rising(drive: &SceneLoad) -> [Option<(f64, LoadRamp)>; 2] {
    prescribed(drive).map(|value| value.map(|value| (value, if value == 0.0 { LoadRamp::AT_ONCE } else { drive.rise })))
}

/// No point is told two different motions.
fn check_conflicts(scene: &Scene) -> Result<()> {
    let at_rest = |held: bool| held.then_some((0.0, LoadRamp::AT_ONCE));
    let drives = scene.drives.iter().map(|drive| (&drive.region, rising(drive), "a load"));
    let holds = scene.holds.iter().map(|hold| (&hold.region, hold.components.map(at_rest), "a support"));
    let all: Vec<_> = drives.chain(holds).collect();
    for (i, (region, motion, what)) in all.iter().enumerate() {
        for (other, other_motion, other_what) in &all[..i] {
            let differ = |c: usize| matches!((motion[c], other_motion[c]), (Some(a), Some(b)) if a != b);
            let Some(component) = (0..2).find(|&c| differ(c)) else { continue };
            let ((low, high), (other_low, other_high)) = (box_of(region, scene), box_of(other, scene));
            if overlap(low, high, other_low, other_high) {
                let axis = ["x", "y"][component];
                let problem = format!(
                    "has two prescribed motions along {axis} where {other_what} ({}) and {what} ({}) overlap",
                    words(other),
                    words(region)
                );
                let remedy = "exclude the common points by range_mm or a region, or give components to one of them only";
                return Err(input_missing("loading", problem, remedy));
            }
        }
    }
    Ok(())
}

fn words(region: &Region) -> String {
    match region {
        Region::Edge { edge, .. } => edge.to_string(),
        Region::Box { .. } => "a box".to_owned(),
    }
}

/// The box around a region, one row deep at the least.
pub fn box_of(region: &Region, scene: &Scene) -> (Point, Point) {
    around(region, scene.model.spacing, &scene.specimen)
}

/// Loads that nothing takes up are refused without time; in time inertia takes them up, and what is held or driven does.
pub fn settle_balance(scene: &mut Scene) -> Result<()> {
    let timed = matches!(scene.procedure, Procedure::Dynamic { .. });
    let mut held = [false; 2];
    for (i, held) in held.iter_mut().enumerate() {
        let driven = scene
            .drives
            .iter()
            .any(|drive| prescribed(drive)[i].is_some() || matches!(drive.action, Action::Platen(motion) if motion[i] != 0.0));
        *held = driven || scene.holds.iter().any(|hold| hold.components[i]);
    }
    let left = imbalance(&scene.specimen);
    if !timed {
        for (i, axis) in ["x", "y"].iter().enumerate() {
            if left.force[i] && !held[i] {
                let problem = format!("not in equilibrium: unbalanced force along {axis}");
                return Err(input_missing("supports", problem, "add a support in [supports], or load opposite sides equally"));
            }
        }
        if left.moment && held == [false; 2] {
            let problem = "not in equilibrium: unbalanced moment";
            return Err(input_missing("supports", problem, "add a support in [supports], or align opposite forces"));
        }
    }
    // Loads that rise one after another do not balance in between either.
    let together = scene.drives.windows(2).all(|pair| pair[0].rise == pair[1].rise);
    if held != [false; 2] || left.force != [false; 2] || left.moment || !together {
        scene.specimen.supports.push(Support::Elsewhere);
    }
    Ok(())
}

/// What the user should know about choices that are right by themselves.
pub fn lines(scene: &Scene) -> Vec<String> {
    let mut lines = Vec::new();
    if let Procedure::Dynamic { duration, .. } = scene.procedure {
        let late = scene.drives.iter().find(|drive| drive.rise.end() > duration);
        lines.extend(late.map(|drive| {
            let end = drive.rise.end();
            format!("loading: that on {} rises until {end} s; the scene ends at {duration} s, before the full load", drive.region)
        }));
    }
    let graded = scene.model.arrangement != Discretisation::Lattice;
    if graded && scene.refinement.is_none() {
        lines.push(format!("refinement: {} without [refinement]: all points have one level", scene.model.arrangement));
    }
    let nu = scene.material.poisson_ratio;
    if let SceneLaw::Bonds(law) = scene.model.law
        && law.kind == BondLawKind::BondBased
        && scene.damage.law == DamageLaw::CriticalEnergy
    {
        lines.push(format!(
            "damage: damage.law = \"critical_energy\" on bond_based uses normal stretch only, as critical_stretch does (nu {nu})"
        ));
    }
    lines.extend(zero_energy_line(scene));
    lines
}

/// A factor of `silling` beyond what was measured safe ([`perilife_base::limits`]).
fn zero_energy_line(scene: &Scene) -> Option<String> {
    let SceneLaw::Correspondence { control: ZeroEnergyControl::Silling, factor } = scene.model.law else { return None };
    let passed = |ordinate: &str| {
        let limit = limits::of("zero_energy_silling", ordinate)?;
        Some((limit.passed(factor)?, limit.bound_percent))
    };
    let (end, bound, what) =
        passed("correspondence, silling: global").map(|(end, bound)| (end, bound, "error of displacements")).or_else(|| {
            passed("correspondence, silling: nodal").map(|(end, bound)| (end, bound, "scatter of strain between points"))
        })?;
    Some(format!("tested range: model.zero_energy_factor {factor}: beyond {end} {what} above {bound} %; remove it"))
}
