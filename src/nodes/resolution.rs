//! How fine the nodes are, and where.
//!
//! The spacing is `far` but for halvings: at a tip down to the `hold`-th part of its room, the least of its distance from rims and other
//! cracks, the length of its crack (half of it with two tips), its growth since a kink and the way over which it is straight; around holes
//! and concave arcs of the outline to R/2.4, around holes of elastic pins to R/4.8, at mouths of cracks there to R/19; across every
//! ligament to a third of it, between sides of the plate that face each other to a sixth; at sharp re-entrant corners to an eighth of the
//! shorter side, or of the way to a tip; along cracks to the way over which a residual stress changes by a quarter of its largest. A loaded
//! stretch of the outline is a spacing long at the least, or what it sinks in would depend on how nodes lie beside it, and the work of the
//! loads with that.

use super::basis::{BasisKind, Enrichment};
use super::crack::Tip;
use super::grid::{Grid, Source};
use super::rims::{ARC_TURN, Stretch, stretches};
use perilife_base::error::{Error, Result};
use perilife_base::units::{MM, place_mm};
use perilife_plate::loading::residual::{Components, ResidualStress};
use perilife_plate::specimen::geometry::{
    along, bounding_box, circle_shares, direction, distance, edges, meeting_share, point_in_polygon, segments_touch, turn_at,
};
use perilife_plate::specimen::{CrackLine, Hole, Load, Point, Specimen};

/// Share of a piece of crack by which it may miss a rim that it begins at: round-off of the input.
const ON_RIM: f64 = 1e-6;
const CELLS_MOST: usize = 200_000;

/// Spacings in the radius of a hole or fillet that K of a crack nearby asks for.
pub const IN_RADIUS: f64 = 2.4;
/// The same over that at a hole in which an elastic pin stands: what it does to its rim is read from nodes.
const AT_PIN: f64 = 2.0;
/// The same at mouths of cracks there, where a flank that the pin presses is a corner.
const AT_MOUTH: f64 = 8.0;
/// Reach of rims and ligaments, in spacings of the coarser level, that K of a crack nearby asks for.
pub const RIM_REACH: f64 = 1.5;
/// Reach of a sharp corner, in spacings of the coarser level: neighbors differ by one level.
const CORNER_REACH: f64 = 2.5;
/// Spacings across a ligament.
const ACROSS_LIGAMENT: f64 = 3.0;
/// Spacings across a member, which may be bent: between sides of the plate that face each other.
const ACROSS_MEMBER: f64 = 6.0;
/// Cosine between the ways into the material from two sides up to which they face each other.
const FACING: f64 = -0.8;
/// Spacings at a sharp re-entrant corner in the way to the nearest tip, and in the shorter of its sides.
const AT_CORNER: f64 = 8.0;
/// Way to the nearest tip over a gap beside a crack from which the gap is away from tips: at four one of two equal cracks has 0.1 % more K, which
/// the other loses in the end.
const AWAY: f64 = 6.0;
/// Spacings across such a gap.
const ACROSS_GAP_AWAY: f64 = 1.5;
/// Gap over the way along a crack to its mouth below which it is the wedge between the crack and the rim that it starts from: no load
/// goes there.
const WEDGE: f64 = 0.7;
/// Stretch of a crack for which one place stands, over the gap beside it.
const STRETCH_OF_GAP: f64 = 2.0;
/// The same over the far spacing at the least.
const STRETCH_LEAST: f64 = 1e-3;
/// Change of a residual stress over a spacing of the crack, over its largest there.
const CHANGE_OF_RESIDUAL: f64 = 0.25;
/// Pieces of a far spacing, and of a piece of crack, at whose ends a residual stress is looked at first.
const PIECES_OF_RESIDUAL: f64 = 4.0;
/// Gap at the ends of a stretch over that at its middle above which the gap runs along it.
const ALONGSIDE: f64 = 0.5;

/// How fine nodes are, and what they carry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resolution {
    /// Spacing far from everything, m.
    pub far: f64,
    /// Spacings in the room of a tip.
    pub hold: f64,
    /// Reach of a tip, in spacings of the coarser level.
    pub reach: f64,
    /// Spacings in the radius of a hole or fillet.
    pub in_radius: f64,
    /// Reach of a hole or fillet, in spacings of the coarser level.
    pub rim_reach: f64,
    /// Spacings across ligaments, members and at corners over those that are usual.
    pub fineness: f64,
    /// Radius of influence of a node, in its spacings.
    pub support: f64,
    pub basis: BasisKind,
    /// Near-tip fields.
    pub enrichment: Enrichment,
}

impl Resolution {
    /// Finer by a factor near tips, rims and ligaments, and by one far from them.
    pub fn finer(&self, [by, by_far]: [f64; 2]) -> Self {
        let Resolution { far, hold, in_radius, fineness, .. } = *self;
        Resolution { far: far / by_far, hold: by * hold, in_radius: by * in_radius, fineness: by * fineness, ..*self }
    }

    /// Cells of a plate with these cracks, and the spacing asked for at every tip, m.
    /// Errors: [`Error::Mechanics`] where the plate would have too many cells.
    pub fn grid(
        &self,
        specimen: &Specimen,
        lines: &[CrackLine],
        tips: &[Tip],
        residual: Option<&ResidualStress>,
    ) -> Result<(Grid, Vec<f64>)> {
        let bounds = bounding_box(&specimen.outline);
        let [width, height] = [0, 1].map(|i| bounds[1][i] - bounds[0][i]);
        let cells = width * height / (self.far * self.far);
        if cells > CELLS_MOST as f64 {
            return Err(Error::Mechanics(format!("{cells:.1e} integration cells needed; reduce model.nodes")));
        }
        let mut sources = Vec::new();
        for tip in tips {
            let spacing = room(specimen, lines, tip) / self.hold;
            let at = lines[tip.end.line].end(tip.end.at_last);
            sources.push(Source::point(at, spacing, self.reach));
        }
        sources.extend(self.of_rims(specimen));
        sources.extend(self.of_pins(specimen, lines));
        sources.extend(self.of_corners(specimen, lines, tips));
        sources.extend(self.of_cracks(specimen, lines, tips));
        sources.extend(residual.into_iter().flat_map(|residual| self.of_residual(lines, residual)));
        let loaded = specimen.loads.iter().filter_map(Load::on_edge);
        sources.extend(loaded.map(|(from, to, _)| Source::point(along(from, to, 0.5), distance(from, to), RIM_REACH)));
        let grid = Grid::new(bounds, self.far, &sources, CELLS_MOST);
        let finest = sources.iter().min_by(|a, b| a.spacing.total_cmp(&b.spacing));
        if let Some(finest) = finest.filter(|_| grid.len() > CELLS_MOST) {
            return Err(too_narrow(finest));
        }
        let at_tip = |tip: &Tip| grid.coarsest(lines[tip.end.line].end(tip.end.at_last));
        let spacings = tips.iter().map(at_tip).collect();
        Ok((grid, spacings))
    }

    /// Holes by their radius, and ligaments between rims by the way straight into the material.
    fn of_rims(&self, specimen: &Specimen) -> Vec<Source> {
        let holes = specimen.holes.iter().map(|hole| Source {
            radius: hole.radius,
            ..Source::point(hole.centre, hole.radius / self.in_radius, self.rim_reach)
        });
        let mut sources: Vec<Source> = holes.collect();
        sources.extend(self.of_arcs(&specimen.outline));
        let rims = stretches(specimen);
        let [across_ligament, across_member] = [ACROSS_LIGAMENT, ACROSS_MEMBER].map(|across| self.fineness * across);
        let reach = across_member * self.far;
        let walls: Vec<[Point; 2]> = edges(&specimen.outline)
            .chain(specimen.slots.iter().flat_map(|slot| edges(&slot.corners()).collect::<Vec<_>>()))
            .map(|(a, b)| [a, b])
            .collect();
        for stretch in &rims {
            // Around a hole in pairs, since half a turn of a plate may leave it as it is.
            let count = ((2.0 * stretch.length() / self.far).ceil().clamp(2.0, 400.0) as usize).next_multiple_of(2);
            for k in 0..count {
                let share = (k as f64 + 0.5) / count as f64;
                let (from, [x, y]) = (stretch.at(share), stretch.inward(share));
                let start = [from[0] + 1e-6 * reach * x, from[1] + 1e-6 * reach * y];
                let to = [from[0] + reach * x, from[1] + reach * y];
                if !specimen.contains(start) {
                    continue;
                }
                let straight = walls.iter().filter(|[a, b]| segments_touch(start, to, *a, *b)).filter_map(|[a, b]| {
                    let [u, v] = direction(*a, *b);
                    let is_member = matches!(stretch, Stretch::Straight(_)) && (x * v - y * u).abs() > -FACING;
                    Some((meeting_share(start, to, *a, *b)?, if is_member { across_member } else { across_ligament }))
                });
                let round = specimen.holes.iter().filter_map(|hole| Some(circle_shares(start, to, hole.centre, hole.radius)?[0]));
                let met = straight.chain(round.map(|share| (share, across_ligament)));
                let nearest = met.filter(|(share, _)| *share > 0.0).min_by(|a, b| a.0.total_cmp(&b.0));
                if let Some((share, across)) = nearest {
                    let width = share * reach;
                    let at = [from[0] + 0.5 * width * x, from[1] + 0.5 * width * y];
                    sources.push(Source::point(at, width / across, RIM_REACH));
                }
            }
        }
        sources
    }

    /// Holes in which elastic pins stand, and mouths of cracks at them.
    fn of_pins(&self, specimen: &Specimen, lines: &[CrackLine]) -> Vec<Source> {
        let mut sources = Vec::new();
        for load in specimen.loads.iter().filter(|load| load.is_elastic_pin()) {
            let Load::Pin { hole, .. } = load else { continue };
            let hole = specimen.holes[*hole];
            let spacing = |times: f64| hole.radius / (times * self.in_radius);
            let around = Source { radius: hole.radius, ..Source::point(hole.centre, spacing(AT_PIN), self.rim_reach) };
            let mouths = lines.iter().flat_map(|line| mouths(&line.points, hole));
            sources.extend(mouths.map(|mouth| Source::point(mouth, spacing(AT_MOUTH), CORNER_REACH)).chain([around]));
        }
        sources
    }

    /// Sharp re-entrant corners of the outline, of slots and of cracks with bends, where stress grows without bound.
    fn of_corners(&self, specimen: &Specimen, lines: &[CrackLine], tips: &[Tip]) -> Vec<Source> {
        let outline = &specimen.outline;
        let n = outline.len();
        let of_outline = (0..n).filter_map(|k| {
            let [before, at, after] = [outline[(k + n - 1) % n], outline[k], outline[(k + 1) % n]];
            (turn_at(before, at, after) < -ARC_TURN).then(|| (at, distance(before, at).min(distance(at, after))))
        });
        let of_slots = specimen.slots.iter().flat_map(|slot| slot.corners().map(|at| (at, slot.width)));
        // Pieces of a crack are steps of its growth: the way to a tip says how fine its corners have to be.
        let of_cracks = lines.iter().flat_map(|line| line.points.windows(3)).filter_map(|corner| {
            (turn_at(corner[0], corner[1], corner[2]).abs() > ARC_TURN).then_some((corner[1], f64::INFINITY))
        });
        let inside = of_outline.chain(of_slots.filter(|(at, _)| point_in_polygon(*at, outline))).chain(of_cracks);
        let at_corner = |(at, side): (Point, f64)| {
            let to_tip = |tip: &Tip| distance(at, lines[tip.end.line].end(tip.end.at_last));
            let size = tips.iter().map(to_tip).fold(side, f64::min);
            Source::point(at, size / (self.fineness * AT_CORNER), CORNER_REACH)
        };
        inside.map(at_corner).collect()
    }

    /// Concave arcs of the outline by their radius: the length of the shorter side at a corner over its turn.
    fn of_arcs(&self, outline: &[Point]) -> Vec<Source> {
        let mut sources = Vec::new();
        for (k, &at) in outline.iter().enumerate() {
            let [before, after] = [(k + outline.len() - 1) % outline.len(), (k + 1) % outline.len()].map(|k| outline[k]);
            let turn = turn_at(before, at, after);
            if !(-ARC_TURN..-1e-6).contains(&turn) {
                continue;
            }
            let side = distance(before, at).min(distance(at, after));
            let spacing = side / -turn / self.in_radius;
            let count = (0.5 * side / spacing).ceil().min(100.0) as usize;
            for end in [before, after] {
                let share = 0.5 * side / distance(at, end);
                let place = |i: usize| along(at, end, share * i as f64 / count as f64);
                sources.extend((0..count).map(|i| Source::point(place(i), spacing, self.rim_reach)));
            }
        }
        sources
    }

    /// Pieces of cracks over which a residual stress changes by a share of its largest.
    fn of_residual(&self, lines: &[CrackLine], residual: &ResidualStress) -> Vec<Source> {
        let mut open: Vec<[Point; 2]> = Vec::new();
        for [a, b] in lines.iter().flat_map(CrackLine::pieces) {
            let count = (PIECES_OF_RESIDUAL * distance(a, b) / self.far).ceil().max(PIECES_OF_RESIDUAL) as usize;
            open.extend((0..count).map(|k| [k, k + 1].map(|k| along(a, b, k as f64 / count as f64))));
        }
        let apart = |a: Components, b: Components| [0, 1, 2].iter().map(|&i| (a[i] - b[i]).abs()).fold(0.0, f64::max);
        let most = open.iter().flatten().map(|at| apart(residual.at(*at), [0.0; 3])).fold(0.0, f64::max);
        let mut sources = Vec::new();
        while let Some([a, b]) = open.pop() {
            let (middle, length) = (along(a, b, 0.5), distance(a, b));
            let [from, at, to] = [a, middle, b].map(|at| residual.at(at));
            let change = apart(from, at) + apart(at, to);
            let spacing = length * CHANGE_OF_RESIDUAL * most / (self.fineness * change);
            if spacing < length && length > STRETCH_LEAST * self.far {
                open.extend([[a, middle], [middle, b]]);
            } else if spacing < self.far {
                sources.push(Source::point(middle, spacing, RIM_REACH));
            }
        }
        sources
    }

    /// Gaps between cracks and rims, and between cracks.
    fn of_cracks(&self, specimen: &Specimen, lines: &[CrackLine], tips: &[Tip]) -> Vec<Source> {
        let mut sources = Vec::new();
        let rims = stretches(specimen);
        let across = self.fineness * ACROSS_LIGAMENT;
        let reach = across * self.far;
        for (own, line) in lines.iter().enumerate() {
            let is_tip = |at_last: bool| tips.iter().any(|tip| tip.end.line == own && tip.end.at_last == at_last);
            let mouths: Vec<(bool, Point)> =
                [false, true].into_iter().filter(|end| !is_tip(*end)).map(|end| (end, line.end(end))).collect();
            let (total, mut way) = (line.length(), 0.0);
            for [a, b] in line.pieces() {
                let length = distance(a, b);
                let gap = |share: f64| {
                    let at = along(a, b, share);
                    let passed = way + share * length;
                    // Whether something at this distance from the crack forms a wedge with it.
                    let is_wedge = |gap: f64, from: &dyn Fn(Point) -> f64| {
                        let way = |at_last: bool| if at_last { total - passed } else { passed };
                        mouths.iter().any(|&(end, mouth)| from(mouth) < 1e-6 * total && gap < WEDGE * way(end))
                    };
                    let gap = |from: &dyn Fn(Point) -> f64| if is_wedge(from(at), from) { f64::INFINITY } else { from(at) };
                    let of_rims = rims.iter().map(|rim| gap(&|at| rim.distance(at)));
                    let others = lines.iter().enumerate().filter(|(other, _)| *other != own);
                    of_rims.chain(others.map(|(_, other)| gap(&|at| other.distance(at)))).fold(f64::INFINITY, f64::min)
                };
                let count = (2.0 * length / self.far).ceil().max(1.0) as usize;
                let mut stretches: Vec<[f64; 2]> = (0..count).map(|k| [k, k + 1].map(|k| k as f64 / count as f64)).collect();
                while let Some([from, to]) = stretches.pop() {
                    let middle = 0.5 * (from + to);
                    let narrow = gap(middle);
                    if narrow >= reach {
                        continue;
                    }
                    let at = along(a, b, middle);
                    let to_tip = |tip: &Tip| distance(at, lines[tip.end.line].end(tip.end.at_last));
                    let is_away = tips.iter().map(to_tip).fold(f64::INFINITY, f64::min) > AWAY * narrow;
                    let across = if is_away { self.fineness * ACROSS_GAP_AWAY } else { across };
                    sources.push(Source::point(at, narrow / across, RIM_REACH));
                    let stretch = (to - from) * length;
                    // Beside a line that crosses, the gap goes to nothing: what is fine there helps nobody.
                    let is_alongside = || gap(from).min(gap(to)) > ALONGSIDE * narrow;
                    if stretch > STRETCH_OF_GAP * narrow && stretch > STRETCH_LEAST * self.far && is_alongside() {
                        stretches.extend([[from, middle], [middle, to]]);
                    }
                }
                way += length;
            }
        }
        sources
    }
}

/// Where a crack meets the rim of a hole.
pub fn mouths(points: &[Point], hole: Hole) -> Vec<Point> {
    let mut mouths = Vec::new();
    for piece in points.windows(2) {
        let shares = circle_shares(piece[0], piece[1], hole.centre, hole.radius).unwrap_or([f64::NAN; 2]);
        let met = shares.into_iter().filter(|share| (-ON_RIM..1.0 + ON_RIM).contains(share));
        mouths.extend(met.map(|share| along(piece[0], piece[1], share)));
    }
    mouths
}

/// What is said where a gap asks for more cells than there may be.
fn too_narrow(finest: &Source) -> Error {
    Error::Mechanics(format!(
        "cracks or edges near {} need nodes {:.2e} mm apart and more than {CELLS_MOST} integration cells; move apart, or \
         join, features {:.2e} mm apart there",
        place_mm(finest.at),
        finest.spacing / MM,
        ACROSS_LIGAMENT * finest.spacing / MM
    ))
}

/// Room of a tip, m.
pub fn room(specimen: &Specimen, lines: &[CrackLine], tip: &Tip) -> f64 {
    let at = lines[tip.end.line].end(tip.end.at_last);
    let others = lines.iter().enumerate().filter(|(other, _)| *other != tip.end.line).map(|(_, line)| line.distance(at));
    let straight = lines[tip.end.line].straight_way(tip.end.at_last, f64::INFINITY);
    others.fold(specimen.rim_distance(at), f64::min).min(tip.length).min(straight)
}

/// How fine nodes are and how long steps of cracks are, of a case.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ElementFreeSettings {
    pub resolution: Resolution,
    /// Change of K of the initial tips up to which they need not be finer.
    pub tolerance: f64,
    /// Whether the case says how fine they are.
    pub is_given: bool,
    /// Whether they stay as they are, however K changes when they get finer.
    pub is_final: bool,
    /// Growth of a tip in an increment at the most, over the length of its crack and the room ahead of it.
    pub step_share: f64,
}
