//! How large the plastic zone at the crack tip is, and whether K still describes the crack (small-scale yielding).

use std::f64::consts::PI;

use super::{CurvePoint, GoverningCrack};
use crate::case::Case;
use perilife_base::units::MM;
use perilife_plate::material::Plane;
use perilife_plate::specimen::Specimen;
use perilife_plate::specimen::geometry::{distance, distance_to_segment, edges};
use perilife_plate::specimen::net_section::ligament_needed;

/// Distance of the mouth of a crack from a rim, over the width of the plate, up to which it lies on it.
const ON_RIM: f64 = 1e-6;

/// Plastic zone at one crack length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zone {
    /// Crack length, m: of a plate that of the governing crack.
    pub crack_length: f64,
    /// K_max, Pa√m.
    pub k_max: f64,
    /// Extent along the crack, `(K_max/σ_Y)² / π` in plane stress, a third of it in plane strain (Irwin 1960), m.
    pub size: f64,
    /// Ligament of a standard kind; of a plate the way from the nearest tip to a free edge, m.
    pub ligament: f64,
    /// Length of the shortest crack from a rim of a plate, m: the way of its tip back to a free edge; infinite where there is none.
    pub crack: f64,
}

impl Zone {
    /// What leaves the plastic zone least room, m, and its name.
    pub fn room(&self) -> (f64, &'static str) {
        if self.crack < self.ligament { (self.crack, "crack length") } else { (self.ligament, "ligament") }
    }
}

/// Plastic zone along a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlasticZone {
    /// At the first row whose K is known.
    pub first: Zone,
    /// At the last one, or at the first at which it is as large as its room.
    pub last: Zone,
    /// Crack length, as [`Zone::crack_length`], from which small-scale yielding does not hold, m; `None` where it holds to the end.
    pub too_large_from: Option<f64>,
    /// Crack length from which it holds after all, to the end, m: a crack that was too short has grown.
    pub too_large_to: Option<f64>,
    pub too_small: &'static str,
    /// Share of the life in which it does not hold.
    pub life_share_too_large: f64,
}

/// The plastic zone of a run; `None` where yield strength or K is not known.
///
/// Small-scale yielding: the ligament is as large as ASTM E647 asks ([`Specimen::ligament_asked`]); in
/// a plate the nearest free edge is at least `(4/π) (K_max/σ_Y)²` away from every tip, and cracks from rims are at least as long.
pub fn plastic_zone(case: &Case, curve: &[CurvePoint]) -> Option<PlasticZone> {
    let strength = case.material.yield_strength?;
    let governing = GoverningCrack::of(&case.specimen, curve);
    let known: Vec<(&CurvePoint, Zone)> = curve
        .iter()
        .filter(|point| point.delta_k.is_finite())
        .map(|point| {
            (point, Zone { crack_length: governing.length(point), ..zone(case, point, point.k_max(&case.loading), strength) })
        })
        // Where every tip has reached an edge there is no room for a zone.
        .filter(|(_, zone)| zone.room().0.is_finite())
        .collect();
    // Once the zone has outgrown its room, K says nothing about either.
    let yielded = known.iter().find(|(_, zone)| zone.size >= zone.room().0);
    let (first, last) = (known.first()?.1, yielded.or(known.last())?.1);
    // How much of the room that is asked for is missing is linear between two rows.
    let missing = |zone: &Zone| 1.0 - zone.room().0 / asked(case, zone, strength);
    let is_missing: Vec<bool> = known.iter().map(|(_, zone)| missing(zone) > 0.0).collect();
    // Crack length and cycles between a row and the one before it at which small-scale yielding ends or begins.
    let change = |row: usize| {
        let ([before, point], [smaller, zone]) = ([row - 1, row].map(|row| known[row].0), [row - 1, row].map(|row| known[row].1));
        let share = missing(&smaller) / (missing(&smaller) - missing(&zone));
        let at = |from: f64, to: f64| from + share * (to - from);
        (at(smaller.crack_length, zone.crack_length), at(before.cycles, point.cycles))
    };
    let life = curve.last()?.cycles;
    let mut since = is_missing[0].then(|| (first.crack_length, known[0].0.cycles));
    let mut outgrown = since.map(|(length, _)| (length, first.room().1));
    let (mut regained, mut cycles) = (None, 0.0);
    for row in (1..known.len()).filter(|row| is_missing[*row] != is_missing[*row - 1]) {
        let (length, at) = change(row);
        match since.take() {
            Some((_, from)) => {
                cycles += at - from;
                regained = Some(length);
            }
            None => {
                since = Some((length, at));
                outgrown = outgrown.or(Some((length, known[row].1.room().1)));
            }
        }
    }
    cycles += since.map_or(0.0, |(_, from)| life - from);
    Some(PlasticZone {
        first,
        last,
        too_large_from: outgrown.map(|(length, _)| length),
        too_large_to: regained.filter(|_| since.is_none()),
        too_small: outgrown.map_or_else(|| last.room().1, |(_, name)| name),
        life_share_too_large: if life > 0.0 { cycles / life } else { f64::from(u8::from(since.is_some())) },
    })
}

fn zone(case: &Case, point: &CurvePoint, k_max: f64, strength: f64) -> Zone {
    let constraint = match case.material.plane {
        Plane::Stress => 1.0,
        Plane::Strain => 3.0,
    };
    let size = (k_max / strength).powi(2) / (PI * constraint);
    // Of a crack that does not go through that beside it: the one below it yields long before its end.
    let beside = case.specimen.part_through.map(|flaw| flaw.room() - point.crack_length);
    let of_standard = case.specimen.ligament(point.crack_length).or(beside).map(|ligament| [ligament, f64::INFINITY]);
    let [ligament, crack] = of_standard.unwrap_or_else(|| {
        let near = ON_RIM * case.specimen.gross_width;
        let ways = (0..point.tips.len()).map(|tip| ways_to_edges(&case.specimen, point, tip)).filter(|ways| ways[0] > near);
        ways.fold([f64::INFINITY; 2], |least, ways| [least[0].min(ways[0]), least[1].min(ways[1])])
    });
    Zone { crack_length: point.crack_length, k_max, size, ligament, crack }
}

/// Share of the distance to the mouth of its crack above which the way of a tip to the edge leads back along the crack.
const BACK: f64 = 0.5;

/// Distance of a tip from outline and holes, m, and the length of its crack where that starts at one of them.
fn ways_to_edges(specimen: &Specimen, point: &CurvePoint, tip: usize) -> [f64; 2] {
    let at = point.tips[tip].position;
    let mouth = specimen.line_end(tip).map(|end| specimen.crack_lines()[end.line].end(!end.at_last));
    let near = ON_RIM * specimen.gross_width;
    let (mut ligament, mut crack) = (f64::INFINITY, f64::INFINITY);
    let mut add = |way: f64, is_of_mouth: &dyn Fn([f64; 2]) -> bool| {
        let is_back = mouth.is_some_and(|mouth| is_of_mouth(mouth) && way > BACK * distance(at, mouth));
        match point.crack_length_of(specimen, tip).filter(|_| is_back) {
            Some(length) => crack = crack.min(length),
            None => ligament = ligament.min(way),
        }
    };
    for hole in &specimen.holes {
        let way = |place: [f64; 2]| distance(place, hole.centre) - hole.radius;
        add(way(at).max(0.0), &|mouth| way(mouth) <= near);
    }
    for (a, b) in edges(&specimen.outline) {
        add(distance_to_segment(at, a, b), &|mouth| distance_to_segment(mouth, a, b) <= near);
    }
    [ligament, crack]
}

/// Ligament that small-scale yielding asks for, m.
fn asked(case: &Case, zone: &Zone, strength: f64) -> f64 {
    // ASTM's condition for M(T) asks for the load, which cycles of a displacement do not keep.
    if case.loading.displacement().is_some() {
        return ligament_needed(zone.k_max, strength);
    }
    case.specimen.ligament_asked(case.loading.at(zone.crack_length), zone.k_max, strength)
}

/// Warning of a thickness below that of plane strain.
pub fn plane_warning(case: &Case, curve: &[CurvePoint]) -> Option<String> {
    // With retardation [`super::retarded`] warns, once the crack is through.
    let is_told = case.retardation.is_some() && curve.iter().any(|row| !row.is_of_front());
    let (_, [needed, _]) = other_plane(case, curve).filter(|(asked, _)| *asked == Plane::Stress && !is_told)?;
    let [needed, thickness] = [needed, case.specimen.thickness].map(|length| length / MM);
    Some(format!(
        "plane: material.plane = \"strain\", but plane strain at the tip needs a thickness of {needed:.2} mm from the start \
         (2.5 (K_max/yield)², ASTM E399); the plate has {thickness:.2} mm"
    ))
}

/// Plane state by the thickness at the start where the case has the other, and the least thickness of plane strain, m, at start and end.
pub(super) fn other_plane(case: &Case, curve: &[CurvePoint]) -> Option<(Plane, [f64; 2])> {
    let (zone, strength) = plastic_zone(case, curve).zip(case.material.yield_strength)?;
    let needed = [zone.first, zone.last].map(|zone| 2.5 * (zone.k_max / strength).powi(2));
    let asked = if case.specimen.thickness >= needed[0] { Plane::Strain } else { Plane::Stress };
    (asked != case.material.plane).then_some((asked, needed))
}
