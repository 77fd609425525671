//! How large the plastic zone at the crack tip is, and whether K still describes the crack (small-scale yielding).

use std::f64::consts::PI;

use super::{CurvePoint, Prediction};
use crate::case::Case;
use crate::material::Plane;
use crate::specimen::Specimen;
use crate::specimen::geometry::{distance, distance_to_polygon};
use crate::specimen::net_section::ligament_needed;
use crate::units::MM;

/// Plastic zone at one crack length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zone {
    /// Crack length, m.
    pub crack_length: f64,
    /// K_max, Pa√m.
    pub k_max: f64,
    /// Extent along the crack, `(K_max/σ_Y)² / π` in plane stress, a third of it in plane strain (Irwin 1960), m.
    pub size: f64,
    /// Ligament of a standard kind; of a plate the way from the nearest tip to a free edge, m.
    pub ligament: f64,
}

/// Plastic zone along a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlasticZone {
    /// At the first row whose K is known.
    pub first: Zone,
    /// At the last one, or at the first at which it is as large as the ligament.
    pub last: Zone,
    /// Crack length from which small-scale yielding does not hold, m; `None` where it holds to the end.
    pub too_large_from: Option<f64>,
    /// Share of the life spent beyond that length.
    pub life_share_too_large: f64,
}

/// The plastic zone of a run; `None` where yield strength or K is not known.
///
/// Small-scale yielding: the ligament is as large as ASTM E647 asks ([`Specimen::ligament_asked`]); in
/// a plate the nearest free edge is at least `(4/π) (K_max/σ_Y)²` away from every tip.
pub fn plastic_zone(case: &Case, curve: &[CurvePoint]) -> Option<PlasticZone> {
    let strength = case.material.yield_strength?;
    let known: Vec<(&CurvePoint, Zone)> = curve
        .iter()
        .filter(|point| point.delta_k.is_finite())
        .map(|point| (point, zone(case, point, point.k_max(&case.loading), strength)))
        .collect();
    // Once the zone has outgrown the ligament, K says nothing about either.
    let yielded = known.iter().find(|(_, zone)| zone.size >= zone.ligament);
    let (first, last) = (known.first()?.1, yielded.or(known.last())?.1);
    // How much of the ligament that is asked for is missing is linear between two rows.
    let missing = |zone: &Zone| 1.0 - zone.ligament / asked(case, zone, strength);
    let outgrown = known.iter().position(|(_, zone)| missing(zone) > 0.0).map(|row| {
        let (point, zone) = &known[row];
        let Some((before, smaller)) = row.checked_sub(1).map(|row| &known[row]) else {
            return (point.crack_length, point.cycles);
        };
        let share = missing(smaller) / (missing(smaller) - missing(zone));
        let at = |from: f64, to: f64| from + share * (to - from);
        (at(before.crack_length, point.crack_length), at(before.cycles, point.cycles))
    });
    let life = curve.last()?.cycles;
    Some(PlasticZone {
        first,
        last,
        too_large_from: outgrown.map(|(length, _)| length),
        life_share_too_large: outgrown.filter(|_| life > 0.0).map_or(0.0, |(_, cycles)| (life - cycles) / life),
    })
}

fn zone(case: &Case, point: &CurvePoint, k_max: f64, strength: f64) -> Zone {
    let constraint = match case.material.plane {
        Plane::Stress => 1.0,
        Plane::Strain => 3.0,
    };
    let size = (k_max / strength).powi(2) / (PI * constraint);
    let way = || point.tips.iter().map(|tip| way_to_edge(&case.specimen, tip.position)).fold(f64::INFINITY, f64::min);
    // Of a crack that does not go through that beside it: the one below it yields long before its end.
    let beside = case.specimen.part_through.map(|flaw| flaw.room() - point.crack_length);
    let ligament = case.specimen.ligament(point.crack_length).or(beside).unwrap_or_else(way);
    Zone { crack_length: point.crack_length, k_max, size, ligament }
}

/// Distance of a tip from outline and holes, m.
fn way_to_edge(specimen: &Specimen, tip: [f64; 2]) -> f64 {
    let holes = specimen.holes.iter().map(|hole| (distance(tip, hole.centre) - hole.radius).max(0.0));
    holes.fold(distance_to_polygon(tip, &specimen.outline), f64::min)
}

/// Ligament that small-scale yielding asks for, m.
fn asked(case: &Case, zone: &Zone, strength: f64) -> f64 {
    // ASTM's condition for M(T) asks for the load, which cycles of a displacement do not keep.
    if case.loading.displacement().is_some() {
        return ligament_needed(zone.k_max, strength);
    }
    case.specimen.ligament_asked(case.loading.maximum, zone.k_max, strength)
}

/// What the user should know: yielding that K does not cover, and a plane state that the thickness contradicts.
pub fn warnings(case: &Case, curve: &[CurvePoint]) -> Vec<String> {
    let (Some(zone), Some(strength)) = (plastic_zone(case, curve), case.material.yield_strength) else { return Vec::new() };
    let mut lines = Vec::new();
    if let Some(length) = zone.too_large_from {
        lines.push(format!(
            "small-scale yielding does not hold from a crack length of {:.1} mm on ({:.2} % of the life): the ligament is smaller \
             than ASTM E647 asks for, and the crack grows faster than K says (plastic zone at the end {:.3} mm, ligament {:.3} mm)",
            length / MM,
            100.0 * zone.life_share_too_large,
            zone.last.size / MM,
            zone.last.ligament / MM
        ));
    }
    let needed = 2.5 * (zone.first.k_max / strength).powi(2);
    if case.material.plane == Plane::Strain && case.specimen.thickness < needed {
        lines.push(format!(
            "material.plane = \"strain\", but plane strain at the crack tip asks for a thickness of {:.2} mm from the start \
             (2.5 (K_max/yield)², ASTM E399), and the plate has {:.2} mm",
            needed / MM,
            case.specimen.thickness / MM
        ));
    }
    lines
}

impl PlasticZone {
    /// The zone of a finished run.
    pub fn of(case: &Case, prediction: &Prediction) -> Option<Self> {
        plastic_zone(case, &prediction.curve)
    }
}
