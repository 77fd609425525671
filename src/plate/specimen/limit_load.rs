//! The limit load of a plate with holes and cracks: the least of its sections, fully plastic.
//!
//! A section is a line from rim to rim along cracks and straight through the material (`cuts`). Force F and moment M of the
//! loads on one side of it (free body, per thickness and unit of nominal load) are borne by what is left of it with the stress ±σ_Y along
//! n, s across it; n is the normal of the chord of the section or the direction of F, whichever bears more:
//! ```text
//! λ N = σ_Y ∫ ± g ds,   λ M = σ_Y ∫ ± g s ds,   N = F·n;   ± changes once, where both hold
//! ```
//! g is 1 on a piece across n; on one at an angle φ to that, the traction along n that the piece bears over its length along s,
//! `min(1/cos²φ, 1/(cos φ √(3/4 cos²φ + 3 sin²φ)))`: von Mises in plane stress with the stress along the piece free to be half of that across
//! it (Hill 1952, J. Mech. Phys. Solids 1:19: least at 35.3°), no more than σ_Y across it. A force V across n takes its share by the
//! same criterion: `λ² (3/4/λ₀² + 3 (V/b)²) ≤ 1`, λ ≤ λ₀, b the length that is left. Where supports hold both sides, or rigid ends do not
//! turn, they take the moment.
//!
//! A pin bears on each side of a section by its pressure there: a section along its force through the middle of its hole has half of it. Its
//! pressure is the cosine over half of the hole, whatever arc it has while all is elastic: at the limit load the rim has yielded to its shape.
//! It shears out of the plate on both sides at once, from the sides of the hole at angles outwards that need not be alike (lugs: Melcon and Hoblit 1953, Prod. Eng.
//! 24(6):160, whose allowable loads, from tests, hold this and the net section).
//!
//! That is `σ_Y (W - 2a) h` of M(T), and tension with bending of SE(T) with free ends and C(T) (Kumar, German and Shih 1981, EPRI NP-1931,
//! without their factor 1.07).

mod cuts;

use cuts::Cut;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::geometry::{along, circle_shares, direction, distance, distance_to_segment, edges, point_in_polygon};
use super::{CrackLine, Hole, Load, Point, Specimen, Support};

/// Share of the size of a plate within which places are the same.
const SAME: f64 = 1e-7;
/// Cosine of the angle between a piece of a section and its chord at the least.
const ASKEW_MOST: f64 = 1e-6;
/// Component of the normal of a chord along a held direction up to which a reaction in it does not load the section.
const ACROSS: f64 = 0.3;

/// The section of a plate that yields first.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Nominal load, Pa or N, over yield strength, Pa, at which it is fully plastic.
    pub load_over_strength: f64,
    /// The line from rim to rim, m.
    pub points: Vec<Point>,
    /// What is left of it, m.
    pub ligament: f64,
}

/// The section that yields first, of a plate with these cracks; `None` where the loads on no section are known.
pub fn weakest_section(specimen: &Specimen, cracks: &[CrackLine]) -> Option<Section> {
    let plate = Plate::of(specimen, cracks);
    let mut least: Option<Section> = None;
    let mut take = |plate: &Plate<'_>, cut: &Cut| {
        let Some(load) = plate.load_over_strength(cut) else { return f64::INFINITY };
        if least.as_ref().is_none_or(|least| load < least.load_over_strength) {
            let ligament = cut.ligaments.iter().map(|[a, b]| distance(*a, *b)).sum();
            least = Some(Section { load_over_strength: load, points: cut.points.clone(), ligament });
        }
        load
    };
    cuts::of_plate(&plate).iter().for_each(|cut| {
        take(&plate, cut);
    });
    for load in &specimen.loads {
        if let Load::Pin { hole, direction, .. } = load {
            cuts::of_pin(&plate, *hole, *direction, &mut |cut| take(&plate, cut));
        }
    }
    for line in 0..cracks.len() {
        cuts::of_crack(&plate, line, &mut |cut| take(&plate, cut));
    }
    least
}

impl Specimen {
    /// Nominal load, Pa or N, at which a section is fully plastic at this yield strength, Pa: of a standard kind by its crack length, m
    /// ([`Specimen::net_section_stress`]), of a plate by its cracks, of a crack that does not go through by its size at the start.
    pub fn limit_load(&self, crack_length: f64, cracks: &[CrackLine], yield_strength: f64) -> Option<f64> {
        if let Some(flaw) = &self.part_through {
            return Some(flaw.limit_stress(flaw.start(), yield_strength));
        }
        match self.net_section_stress(crack_length, 1.0) {
            Some(stress) => Some(yield_strength / stress),
            None => weakest_section(self, cracks).map(|section| yield_strength * section.load_over_strength),
        }
    }

    /// The same of a crack length that all tips have grown to alike, straight ahead, as a handbook takes it.
    pub fn limit_load_at(&self, crack_length: f64, yield_strength: f64) -> Option<f64> {
        // The sections of a standard kind are known without its cracks.
        let cracks = if self.kind.is_plate() { self.grown_alike(crack_length).crack_lines() } else { Vec::new() };
        self.limit_load(crack_length, &cracks, yield_strength)
    }
}

pub(super) struct Plate<'a> {
    pub specimen: &'a Specimen,
    pub cracks: &'a [CrackLine],
    /// Distance within which places are the same, m.
    pub same: f64,
}

/// Force, moment about the origin, and which supports are on one side of a cut.
#[derive(Default)]
struct Side {
    force: Point,
    moment: f64,
    held: [bool; 2],
}

impl Side {
    fn add(&mut self, at: Point, force: Point) {
        self.force = [self.force[0] + force[0], self.force[1] + force[1]];
        self.moment += at[0] * force[1] - at[1] * force[0];
    }
}

impl<'a> Plate<'a> {
    fn of(specimen: &'a Specimen, cracks: &'a [CrackLine]) -> Self {
        Plate { specimen, cracks, same: SAME * specimen.gross_width.max(specimen.length()) }
    }

    /// Nominal load over yield strength at which a cut is fully plastic; `None` where the loads do not determine what it bears.
    fn load_over_strength(&self, cut: &Cut) -> Option<f64> {
        let [from, to] = [*cut.points.first()?, *cut.points.last()?];
        let along = direction(from, to);
        if distance(from, to) <= self.same {
            return None;
        }
        let across = [-along[1], along[0]];
        // The plate lies to the right of the cut on its first side; both sides balance each other where no support is.
        let [right, left] = self.sides(cut)?;
        let is_held = |side: &Side| side.held != [false; 2];
        let (body, sign) = if is_held(&right) && !is_held(&left) { (&left, -1.0) } else { (&right, 1.0) };
        let both_held = is_held(&right) && is_held(&left);
        if both_held && (0..2).any(|i| right.held[i] && left.held[i] && across[i].abs() > ACROSS) {
            return None;
        }
        let turns = !both_held && !self.specimen.has_straight_grips();
        let force = body.force.map(|f| -sign * f);
        let moment = -sign * (body.moment - (from[0] * body.force[1] - from[1] * body.force[0]));
        // Where supports hold both sides, they bear what is along the chord.
        let force = if both_held { across.map(|x| x * dot(force, across)) } else { force };
        let size = force[0].hypot(force[1]);
        let of_force = if dot(force, across) < 0.0 { -size } else { size };
        let normals = [Some(across), (size > 0.0).then(|| force.map(|f| f / of_force))];
        let bears = |normal: Point| {
            let mut pieces = Piece::of(cut, from, normal);
            if dot(force, normal).abs() < size * (1.0 - 1e-12) {
                // A piece askew bears no more than one across where there is a force across as well.
                pieces.iter_mut().for_each(|piece| piece.strength = piece.strength.min(1.0));
            }
            plastic_load(&pieces, normal, force, turns.then_some(moment))
        };
        normals.into_iter().flatten().filter_map(bears).reduce(f64::max).filter(|load| load.is_finite())
    }

    /// Loads and supports right and left of a cut, unit of nominal load and of thickness; `None` where it does not part the plate.
    fn sides(&self, cut: &Cut) -> Option<[Side; 2]> {
        let specimen = self.specimen;
        let [first, last] = [*cut.points.first()?, *cut.points.last()?];
        let (from, to) = (self.place(first)?, self.place(last)?);
        if from == to {
            return None;
        }
        // Counter-clockwise from the first end of the cut to its last lies what is right of it.
        let is_right = |place: f64| if from < to { place > from && place < to } else { place > from || place < to };
        let mut sides = [Side::default(), Side::default()];
        for load in &specimen.loads {
            if let Some((a, b, _)) = load.on_edge() {
                let mut shares = vec![0.0, 1.0];
                let length = distance(a, b);
                let ends = [first, last].into_iter().filter(|end| distance_to_segment(*end, a, b) <= self.same);
                shares.extend(ends.map(|end| (distance(a, end) / length).clamp(0.0, 1.0)));
                shares.sort_by(f64::total_cmp);
                for pair in shares.windows(2).filter(|pair| pair[1] > pair[0]) {
                    let middle = along(a, b, 0.5 * (pair[0] + pair[1]));
                    let side = &mut sides[usize::from(!is_right(self.place(middle)?))];
                    load.forces_between([pair[0], pair[1]]).into_iter().for_each(|(at, force)| side.add(at, force));
                }
            }
            if let Load::Pin { hole, direction, force, .. } = load {
                let hole = specimen.holes[*hole];
                let shares = self.shares_of_pin(hole, *direction, cut, &self.right_of(cut, from, to));
                for (side, share) in sides.iter_mut().zip(shares) {
                    // The pressure passes through the middle of the hole everywhere.
                    side.add(hole.centre, share.map(|part| part * force / specimen.thickness));
                }
            }
        }
        for [a, b] in cut.cracked.iter().filter(|_| specimen.crack_pressure != 0.0) {
            let [x, y] = direction(*a, *b);
            let push = specimen.crack_pressure * distance(*a, *b);
            let middle = along(*a, *b, 0.5);
            sides[0].add(middle, [push * y, -push * x]);
            sides[1].add(middle, [-push * y, push * x]);
        }
        for support in &specimen.supports {
            let Support::Fixed { from: a, to: b, x, y, .. } = support else { continue };
            for share in [0.01, 0.5, 0.99] {
                let side = &mut sides[usize::from(!is_right(self.place(along(*a, *b, share))?))];
                side.held = [side.held[0] || *x, side.held[1] || *y];
            }
        }
        Some(sides)
    }

    /// Force on the rim of a hole right and left of a cut, of a pin that bears with the force 1 along a direction.
    fn shares_of_pin(&self, hole: Hole, [x, y]: Point, cut: &Cut, right: &[Point]) -> [Point; 2] {
        // Angles from the direction of the force, counter-clockwise, at which the side may change.
        let mut bounds = vec![-FRAC_PI_2, FRAC_PI_2];
        for piece in cut.points.windows(2) {
            let slack = self.same / distance(piece[0], piece[1]);
            let shares = circle_shares(piece[0], piece[1], hole.centre, hole.radius).into_iter().flatten();
            for share in shares.filter(|share| (-slack..=1.0 + slack).contains(share)) {
                let at = along(piece[0], piece[1], share);
                let from_centre = [at[0] - hole.centre[0], at[1] - hole.centre[1]];
                let angle = (x * from_centre[1] - y * from_centre[0]).atan2(dot([x, y], from_centre));
                bounds.push(angle.clamp(-FRAC_PI_2, FRAC_PI_2));
            }
        }
        bounds.sort_by(f64::total_cmp);
        let mut shares = [[0.0; 2]; 2];
        for arc in bounds.windows(2).filter(|arc| arc[1] > arc[0]) {
            let (sine, cosine) = (0.5 * (arc[0] + arc[1])).sin_cos();
            let reach = hole.radius + self.same;
            let middle = [hole.centre[0] + reach * (x * cosine - y * sine), hole.centre[1] + reach * (y * cosine + x * sine)];
            // 2/π ∫ cos θ (cos θ, sin θ) dθ along the force and across it.
            let until = |angle: f64| [angle / PI + (2.0 * angle).sin() / TAU, angle.sin().powi(2) / PI];
            let ([ahead_0, aside_0], [ahead_1, aside_1]) = (until(arc[0]), until(arc[1]));
            let [ahead, aside] = [ahead_1 - ahead_0, aside_1 - aside_0];
            let share = &mut shares[usize::from(!point_in_polygon(middle, right))];
            *share = [share[0] + ahead * x - aside * y, share[1] + ahead * y + aside * x];
        }
        shares
    }

    /// The part of the plate right of a cut whose ends have these places on the outline.
    fn right_of(&self, cut: &Cut, from: f64, to: f64) -> Vec<Point> {
        let n = self.specimen.outline.len();
        let mut polygon: Vec<Point> = cut.points.iter().rev().copied().collect();
        // Corners of the outline behind the first end of the cut, up to the last one.
        let (begin, count) = (from.floor() as usize + 1, (to.floor() - from.floor()).rem_euclid(n as f64) as usize);
        let count = if count == 0 && to < from { n } else { count };
        polygon.extend((0..count).map(|i| self.specimen.outline[(begin + i) % n]));
        polygon
    }

    /// Place on the outline: number of the edge and the share of the way along it; `None` beside it.
    fn place(&self, at: Point) -> Option<f64> {
        let near = edges(&self.specimen.outline).enumerate().find(|(_, (a, b))| distance_to_segment(at, *a, *b) <= self.same)?;
        let (edge, (a, b)) = near;
        Some(edge as f64 + (distance(a, at) / distance(a, b)).min(1.0 - f64::EPSILON))
    }
}

#[derive(Debug, Clone, Copy)]
struct Piece {
    from: f64,
    to: f64,
    /// g: traction along the normal of the chord that it bears over yield strength, for its length on the chord.
    strength: f64,
}

impl Piece {
    fn of(cut: &Cut, origin: Point, normal: Point) -> Vec<Piece> {
        let along = [normal[1], -normal[0]];
        let place = |p: Point| (p[0] - origin[0]) * along[0] + (p[1] - origin[1]) * along[1];
        let piece = |[a, b]: &[Point; 2]| {
            let (s, t) = (place(*a), place(*b));
            let length = distance(*a, *b);
            // One along the normal bears by shear alone, L/√3: as one hardly askew.
            let cosine = ((t - s).abs() / length).max(ASKEW_MOST);
            let (middle, half) = (0.5 * (s + t), 0.5 * cosine * length);
            let strength =
                (cosine * (0.75 * cosine * cosine + 3.0 * (1.0 - cosine * cosine)).sqrt()).max(cosine * cosine).recip();
            Piece { from: middle - half, to: middle + half, strength }
        };
        cut.ligaments.iter().map(piece).collect()
    }

    fn length(&self) -> f64 {
        self.to - self.from
    }

    /// ∫ ± g ds and ∫ ± g s ds with the sign changing at `axis`.
    fn resultants(&self, axis: f64) -> [f64; 2] {
        let middle = axis.clamp(self.from, self.to);
        let force = self.to - middle - (middle - self.from);
        let moment = 0.5 * (self.to.powi(2) + self.from.powi(2)) - middle.powi(2);
        [self.strength * force, self.strength * moment]
    }
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// λ/σ_Y at which the pieces bear force and moment, stress along a normal but for the force across it; none where there is neither.
fn plastic_load(pieces: &[Piece], normal: Point, force: Point, moment: Option<f64>) -> Option<f64> {
    let plastic = plastic(pieces, dot(force, normal), moment)?;
    let ligament: f64 = pieces.iter().map(Piece::length).sum();
    let shear = dot(force, [normal[1], -normal[0]]);
    let by_shear =
        if shear == 0.0 { f64::INFINITY } else { (0.75 / plastic.powi(2) + 3.0 * (shear / ligament).powi(2)).sqrt().recip() };
    Some(plastic.min(by_shear))
}

/// λ/σ_Y at which the pieces bear λ N and, where the section turns, λ M: on the way of the point where the stress changes its sign from one
/// end to the other, force and moment are in the ratio of N and M just once.
fn plastic(pieces: &[Piece], normal: f64, moment: Option<f64>) -> Option<f64> {
    let all = |axis: f64| {
        pieces.iter().map(|piece| piece.resultants(axis)).fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]])
    };
    let low = pieces.iter().fold(f64::INFINITY, |least, piece| least.min(piece.from));
    if pieces.is_empty() {
        // Nothing is left.
        return (normal != 0.0 || moment.is_some_and(|moment| moment != 0.0)).then_some(0.0);
    }
    let Some(moment) = moment else { return Some(all(low)[0] / normal.abs()) };
    let off = |axis: f64| {
        let [force, turn] = all(axis);
        force * moment - turn * normal
    };
    let mut ends: Vec<f64> = pieces.iter().flat_map(|piece| [piece.from, piece.to]).collect();
    ends.sort_by(f64::total_cmp);
    let at_low = off(low);
    let beyond = ends.iter().position(|end| (off(*end) > 0.0) != (at_low > 0.0)).unwrap_or(ends.len() - 1);
    let axis = if at_low == 0.0 {
        low
    } else {
        // From the end of a piece on, `off` is of second degree in the way t: G N t² + 2 G (N s - M) t + off(s), G = Σ g of the pieces there.
        let (start, length) = (ends[beyond.max(1) - 1], ends[beyond] - ends[beyond.max(1) - 1]);
        let middle = start + 0.5 * length;
        let strength: f64 = pieces.iter().filter(|p| p.from < middle && middle < p.to).map(|piece| piece.strength).sum();
        let (a, b, c) = (strength * normal, strength * (normal * start - moment), off(start));
        let root = (b * b - a * c).max(0.0).sqrt();
        let q = if b > 0.0 { -b - root } else { -b + root };
        let ways = [q / a, c / q].into_iter().filter(|t| t.is_finite());
        start
            + ways
                .min_by(|s, t| (s - s.clamp(0.0, length)).abs().total_cmp(&(t - t.clamp(0.0, length)).abs()))
                .unwrap_or(0.0)
                .clamp(0.0, length)
    };
    let [force, turn] = all(axis);
    // Whichever of both is large: a length turns force into moment.
    let reach = pieces.iter().map(|piece| piece.to.abs().max(piece.from.abs())).fold(0.0, f64::max);
    let size = |force: f64, turn: f64| (force * reach).hypot(turn);
    Some(size(force, turn) / size(normal, moment))
}
