//! What the arc over which pins press does to K, where nobody has said how wide it is.

use crate::case::{Case, Engine};
use crate::element_free::crack::initial_cracks;
use crate::element_free::factors;
use crate::element_free::resolution::room;
use crate::element_free::solve::solve;
use crate::error::Result;
use crate::growth::nodes::initial_plate;
use crate::specimen::pin::{LOOSE_PIN, SNUG_PIN};
use crate::specimen::{Bearing, Load, SpecimenKind};

/// Half angles that are compared with [`LOOSE_PIN`], rad: 15° less, which is the narrowest arc, 15° more, a pin that fills its hole.
const OTHERS: [f64; 3] = [LOOSE_PIN / 15.0, 2.0 * LOOSE_PIN, SNUG_PIN];

/// One line on pins of which nothing is known: the arc that is taken, and K of the initial tips under others, on nodes; `None` without such
/// pins, by a handbook, whose K is that of its own, and where nodes cannot say it.
pub fn line(case: &Case) -> Option<String> {
    let is_unknown = |load: &Load| matches!(load, Load::Pin { contact: Bearing::Unknown, .. });
    if case.engine() == Engine::Handbook || !case.specimen.loads.iter().any(is_unknown) {
        return None;
    }
    let changes = changes(case).ok()?;
    let of = |k: usize| {
        let (tip, change) = changes[k];
        (tip, format!("{:+.1} %", 100.0 * change))
    };
    let ((_, narrow), (tip, wide), (_, snug)) = (of(0), of(1), of(2));
    let key = match case.specimen.kind {
        SpecimenKind::Plate => "pin_diameter_mm or contact_half_angle_deg of loading.pins",
        _ => "specimen.pin_diameter_mm or specimen.pin_half_angle_deg",
    };
    let most = if case.specimen.tips.len() > 1 { format!(" (tip {tip})") } else { String::new() };
    Some(format!(
        "pins: nothing known of them, ±15° of their holes taken; K at N = 0 is {narrow} with 15° less, {wide} with 15° more{most}, {snug} with \
         pins that fill their holes (±90°): give {key}"
    ))
}

/// The tip whose K changes most with each of the other arcs, and by what share.
fn changes(case: &Case) -> Result<Vec<(usize, f64)>> {
    let plate = initial_plate(case)?;
    let (lines, tips) = initial_cracks(&case.specimen);
    let far = case.nodes().resolution.far;
    let under = |half_angle: f64| -> Result<Vec<f64>> {
        let mut specimen = case.specimen.clone();
        for load in &mut specimen.loads {
            if let Load::Pin { contact: contact @ Bearing::Unknown, .. } = load {
                *contact = Bearing::Cosine(half_angle);
            }
        }
        let solution = solve(&specimen, &plate, far, case.loading.maximum)?;
        let share = case.loading.share(solution.work);
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
    let usual = under(LOOSE_PIN)?;
    OTHERS
        .iter()
        .map(|&half_angle| {
            let shares = under(half_angle)?.into_iter().zip(&usual).map(|(k, usual)| k / usual - 1.0).enumerate();
            Ok(shares.filter(|(_, share)| share.is_finite()).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).unwrap_or_default())
        })
        .collect()
}
