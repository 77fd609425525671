//! What the arc over which pins press does to K, where nobody has said how wide it is.

use crate::case::{Case, Engine, initial_plate};
use perilife_base::error::Result;
use perilife_nodes::crack::initial_cracks;
use perilife_nodes::factors;
use perilife_nodes::resolution::room;
use perilife_nodes::solve::solve;
use perilife_plate::specimen::pin::{LOOSE_PIN, SNUG_PIN};
use perilife_plate::specimen::{Bearing, Load, SpecimenKind};

/// Change of the arc that is told, rad.
const OTHER: f64 = 15.0 * std::f64::consts::PI / 180.0;
/// Narrowest arc, rad.
const NARROW: f64 = std::f64::consts::PI / 180.0;

/// One line on pins of which nothing is known: the arc that is taken, and K of the initial tips under others, on nodes; `None` without such
/// pins, by a handbook, whose K is that of its own, and where nodes cannot say it.
pub fn line(case: &Case) -> Option<String> {
    let unknown = |load: &Load| match load {
        Load::Pin { contact: Bearing::Unknown(half_angle), .. } => Some(*half_angle),
        _ => None,
    };
    let usual = case.specimen.loads.iter().find_map(unknown).filter(|_| case.engine() != Engine::Handbook)?;
    let (fits, extreme) = if usual < SNUG_PIN {
        ("as of pins that pull against each other in holes with clearance", SNUG_PIN)
    } else {
        ("as of a pin that fills its hole", LOOSE_PIN)
    };
    let mut others = vec![(usual - OTHER).max(NARROW), (usual + OTHER).min(SNUG_PIN), extreme];
    others.retain(|other| (other - usual).abs() > 0.5 * NARROW);
    let found = changes(case, usual, &others).ok()?;
    let several = case.specimen.tips.len() > 1;
    let told = others.iter().zip(&found).map(|(other, (tip, change))| {
        let of_tip = if several { format!(" (tip {tip})") } else { String::new() };
        format!("{:+.1} % at ±{:.0}°{of_tip}", 100.0 * change, other.to_degrees())
    });
    let key = match case.specimen.kind {
        SpecimenKind::Plate => "pin_diameter_mm or contact_half_angle_deg of loading.pins",
        _ => "specimen.pin_diameter_mm or specimen.pin_half_angle_deg",
    };
    Some(format!(
        "pins: pin contact assumed over ±{:.0}° ({fits}); effect on K at N = 0: {}; set {key}",
        usual.to_degrees(),
        told.collect::<Vec<_>>().join(", ")
    ))
}

/// The tip whose K changes most with each of the other arcs, and by what share.
fn changes(case: &Case, usual: f64, others: &[f64]) -> Result<Vec<(usize, f64)>> {
    let plate = initial_plate(case)?;
    let (lines, tips) = initial_cracks(&case.specimen);
    let far = case.nodes().resolution.far;
    let under = |half_angle: f64| -> Result<Vec<f64>> {
        let mut specimen = case.specimen.clone();
        for load in &mut specimen.loads {
            if let Load::Pin { contact: contact @ Bearing::Unknown(_), .. } = load {
                *contact = Bearing::Cosine(half_angle);
            }
        }
        let solution = solve(&specimen, &plate, far, case.loading.maximum)?;
        let share = case.loading.share(solution.work, case.specimen.crack_length);
        let size = |tip: usize| {
            let [k_i, k_ii] = factors::read(&plate, &solution.u, tip, room(&specimen, &lines, &tips[tip]), &|at| {
                let pressure = solution.pressure_at(at);
                [pressure, pressure, 0.0]
            })?
            .factors;
            Ok(share * k_i.hypot(k_ii))
        };
        (0..tips.len()).map(size).collect()
    };
    let usual = under(usual)?;
    others
        .iter()
        .map(|&half_angle| {
            let shares = under(half_angle)?.into_iter().zip(&usual).map(|(k, usual)| k / usual - 1.0).enumerate();
            Ok(shares.filter(|(_, share)| share.is_finite()).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).unwrap_or_default())
        })
        .collect()
}
