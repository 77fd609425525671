//! Sections through a plate that may yield: along its cracks and on from their ends, through holes, across corners of its outline.

use super::Plate;
use crate::specimen::geometry::{
    along, circle_shares, direction, distance, distance_to_polygon, distance_to_segment, edges, meeting_share, point_in_polygon,
    segments_touch, turn,
};
use crate::specimen::{CrackLine, Hole, Load, Point};

/// Corners of an outline from which on only those that point inwards are cut across: a curve drawn by points.
const CORNERS_MOST: usize = 24;
/// Cosine to the direction of a crack from which on a section does not turn back on it.
const BACK: f64 = -0.3;
/// Cracks in one section beyond the first.
const CHAIN_MOST: usize = 2;
/// Holes and cracks beside one that a section goes on to: the nearest.
const NEIGHBOURS: usize = 3;
/// Angles outwards from the force of a pin at which it may shear out, in degrees.
const SHEARED: [f64; 13] = [0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 55.0, 60.0];
const ROUNDS_MOST: usize = 4;

#[derive(Debug, Clone, Default)]
pub(super) struct Cut {
    pub points: Vec<Point>,
    pub ligaments: Vec<[Point; 2]>,
    pub cracked: Vec<[Point; 2]>,
}

impl Cut {
    fn reversed(&self) -> Cut {
        let turned = |pieces: &[[Point; 2]]| pieces.iter().rev().map(|[a, b]| [*b, *a]).collect();
        Cut {
            points: self.points.iter().rev().copied().collect(),
            ligaments: turned(&self.ligaments),
            cracked: turned(&self.cracked),
        }
    }

    fn joined(mut self, other: &Cut) -> Cut {
        self.points.extend(other.points.iter().skip(usize::from(!self.points.is_empty())));
        self.ligaments.extend(&other.ligaments);
        self.cracked.extend(&other.cracked);
        self
    }

    /// Whether it meets itself, so that it parts off no free body.
    fn meets_itself(&self, same: f64) -> bool {
        let mut points = self.points.clone();
        points.dedup_by(|a, b| distance(*a, *b) <= same);
        let pieces: Vec<[Point; 2]> = points.windows(2).map(|pair| [pair[0], pair[1]]).collect();
        let later = |i: usize| pieces.iter().skip(i + 2);
        (0..pieces.len()).any(|i| later(i).any(|[a, b]| segments_touch(pieces[i][0], pieces[i][1], *a, *b)))
    }

    fn along_crack(points: Vec<Point>) -> Cut {
        let cracked = points.windows(2).map(|piece| [piece[0], piece[1]]).collect();
        Cut { points, ligaments: Vec::new(), cracked }
    }
}

/// Straight sections through the middle of every hole and across corners of the outline.
pub(super) fn of_plate(plate: &Plate<'_>) -> Vec<Cut> {
    let specimen = plate.specimen;
    let axes = [[1.0, 0.0], [0.0, 1.0]];
    let mut lines: Vec<(Point, Point)> = Vec::new();
    for hole in &specimen.holes {
        lines.extend(axes.map(|axis| (hole.centre, axis)));
        lines.extend(nearest_of_outline(plate, hole.centre).into_iter().map(|way| (hole.centre, way)));
        lines.extend(nearest_holes(plate, hole.centre).into_iter().map(|other| (hole.centre, direction(hole.centre, other))));
    }
    let outline = &specimen.outline;
    let n = outline.len();
    for (i, &corner) in outline.iter().enumerate() {
        let [before, behind] = [outline[(i + n - 1) % n], outline[(i + 1) % n]];
        if n > CORNERS_MOST && turn(before, corner, behind) >= 0.0 {
            continue;
        }
        // A little way in, so that the line meets the outline on both sides.
        let inwards = [direction(corner, before), direction(corner, behind)];
        let sign = if turn(before, corner, behind) >= 0.0 { 1.0 } else { -1.0 };
        let at = [0, 1].map(|k| corner[k] + sign * 20.0 * plate.same * (inwards[0][k] + inwards[1][k]));
        lines.extend(axes.map(|axis| (at, axis)));
    }
    lines
        .into_iter()
        .filter(|(at, _)| point_in_polygon(*at, outline))
        .filter_map(|(at, ahead)| {
            let back = ahead.map(|x| -x);
            Some(ray(plate, at, back)?.reversed().joined(&ray(plate, at, ahead)?))
        })
        .collect()
}

/// Sections along a crack, each end of which is chosen for the least of what `load` says of the whole.
pub(super) fn of_crack(plate: &Plate<'_>, line: usize, load: &mut dyn FnMut(&Cut) -> f64) {
    let crack = &plate.cracks[line];
    let [before, behind] = [false, true].map(|at_last| exits(plate, line, at_last, &mut vec![line]));
    of_ends(plate, &before, &Cut::along_crack(crack.points.clone()), &behind, load);
}

/// Sections on which a pin shears out of the plate ahead of it: from both sides of its hole.
pub(super) fn of_pin(plate: &Plate<'_>, hole: usize, ahead: Point, load: &mut dyn FnMut(&Cut) -> f64) {
    let [left, right] = [1.0, -1.0].map(|side| side_of_pin(plate, hole, ahead, side));
    let [before, behind] = [(left, 1.0), (right, -1.0)].map(|(at, side)| sheared(plate, at, ahead, side));
    let across = Cut { points: vec![left, right], ..Cut::default() };
    // Which side is chosen first may matter, and mirror images are to bear alike.
    of_ends(plate, &before, &across, &behind, load);
    of_ends(plate, &behind, &across.reversed(), &before, load);
}

/// The place of a rim across the force of its pin, to the left (1) or to the right (-1).
fn side_of_pin(plate: &Plate<'_>, hole: usize, ahead: Point, side: f64) -> Point {
    let hole = plate.specimen.holes[hole];
    [hole.centre[0] - side * hole.radius * ahead[1], hole.centre[1] + side * hole.radius * ahead[0]]
}

fn sheared(plate: &Plate<'_>, at: Point, ahead: Point, side: f64) -> Vec<Cut> {
    let turned = |degrees: f64| {
        let (sine, cosine) = (side * degrees.to_radians()).sin_cos();
        [cosine * ahead[0] - sine * ahead[1], cosine * ahead[1] + sine * ahead[0]]
    };
    SHEARED.into_iter().filter_map(|degrees| ray(plate, at, turned(degrees))).collect()
}

/// Sections of a middle part and ways on from its ends, each of which is chosen in turn for the least of what `load` says of the whole.
fn of_ends(plate: &Plate<'_>, before: &[Cut], middle: &Cut, behind: &[Cut], load: &mut dyn FnMut(&Cut) -> f64) {
    if before.is_empty() || behind.is_empty() {
        return;
    }
    let whole = |a: usize, b: usize| before[a].reversed().joined(middle).joined(&behind[b]);
    let mut chosen = [0, 0];
    let mut least = f64::INFINITY;
    for round in 0..ROUNDS_MOST {
        let end = round % 2;
        let count = [before.len(), behind.len()][1 - end];
        let mut is_better = false;
        for option in 0..count {
            let pair = if end == 0 { [chosen[0], option] } else { [option, chosen[1]] };
            let cut = whole(pair[0], pair[1]);
            let value = if cut.meets_itself(plate.same) { f64::INFINITY } else { load(&cut) };
            if value < least {
                (least, chosen, is_better) = (value, pair, true);
            }
        }
        if round > 0 && !is_better {
            break;
        }
    }
}

fn exits(plate: &Plate<'_>, line: usize, at_last: bool, visited: &mut Vec<usize>) -> Vec<Cut> {
    let (crack, specimen) = (&plate.cracks[line], plate.specimen);
    let (at, ahead) = (crack.end(at_last), crack.direction(at_last));
    let here = Cut { points: vec![at], ..Cut::default() };
    if !point_in_polygon(at, &specimen.outline) || distance_to_polygon(at, &specimen.outline) <= plate.same {
        return vec![here];
    }
    let touched = |other: &CrackLine| other.distance(at) <= plate.same;
    let others: Vec<usize> = (0..plate.cracks.len()).filter(|other| !visited.contains(other)).collect();
    let is_at = |(_, hole): &(usize, &Hole)| distance(at, hole.centre) <= hole.radius + plate.same;
    if let Some((number, hole)) = specimen.holes.iter().enumerate().find(is_at) {
        let to_middle = here.joined(&Cut { points: vec![at, hole.centre], ..Cut::default() });
        let mut ways = straight(plate, hole.centre, ahead);
        ways.extend(chained(plate, hole.centre, &others, visited));
        for load in &specimen.loads {
            let Load::Pin { hole: own, direction, .. } = load else { continue };
            for side in [1.0, -1.0].into_iter().filter(|_| *own == number) {
                let from = side_of_pin(plate, number, *direction, side);
                let to_side = Cut { points: vec![hole.centre, from], ..Cut::default() };
                ways.extend(sheared(plate, from, *direction, side).iter().map(|way| to_side.clone().joined(way)));
            }
        }
        return ways.iter().map(|way| to_middle.clone().joined(way)).collect();
    }
    let near = |corners: &[Point; 4]| distance_to_polygon(at, corners) <= plate.same;
    if let Some(slot) = specimen.slots.iter().find(|slot| slot.contains(at) || near(&slot.corners())) {
        return [slot.from, slot.to]
            .into_iter()
            .flat_map(|end| {
                let is_out = !point_in_polygon(end, &specimen.outline);
                let other = if end == slot.from { slot.to } else { slot.from };
                let way = |end: Point| here.clone().joined(&Cut { points: vec![at, end], ..Cut::default() });
                if is_out || distance_to_polygon(end, &specimen.outline) <= plate.same {
                    let met = edges(&specimen.outline).filter_map(|(a, b)| {
                        segments_touch(other, end, a, b)
                            .then(|| meeting_share(other, end, a, b))?
                            .map(|share| along(other, end, share))
                    });
                    return met.take(1).map(way).collect::<Vec<_>>();
                }
                straight(plate, end, direction(other, end)).iter().map(|on| way(end).joined(on)).collect()
            })
            .collect();
    }
    if let Some(&other) = others.iter().find(|other| touched(&plate.cracks[**other])) {
        return through(plate, at, other, visited, &here);
    }
    let mut ways = straight(plate, at, ahead);
    ways.extend(chained(plate, at, &others, visited));
    ways
}

/// Straight ways to the outline: ahead, across and along the axes, to its nearest place, through the middle of every hole.
fn straight(plate: &Plate<'_>, at: Point, ahead: Point) -> Vec<Cut> {
    let mut ways = vec![ahead];
    let axes = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    let nearest = nearest_of_outline(plate, at);
    let holes = nearest_holes(plate, at).into_iter().map(|hole| direction(at, hole));
    let is_on = |way: &Point| way[0] * ahead[0] + way[1] * ahead[1] > BACK;
    ways.extend(axes.into_iter().chain(nearest).chain(holes).filter(is_on));
    ways.into_iter().filter_map(|way| ray(plate, at, way)).collect()
}

/// Ways on through other cracks: to their nearer end, along them, and on from the other one.
fn chained(plate: &Plate<'_>, at: Point, others: &[usize], visited: &mut Vec<usize>) -> Vec<Cut> {
    if visited.len() > CHAIN_MOST {
        return Vec::new();
    }
    let near_end = |other: &usize| {
        let ends = [false, true].map(|at_last| plate.cracks[*other].end(at_last));
        if distance(ends[1], at) < distance(ends[0], at) { ends[1] } else { ends[0] }
    };
    let mut nearest: Vec<(usize, Point)> = others.iter().map(|other| (*other, near_end(other))).collect();
    nearest.sort_by(|a, b| distance(a.1, at).total_cmp(&distance(b.1, at)));
    let mut ways = Vec::new();
    for (other, near) in nearest.into_iter().take(NEIGHBOURS) {
        if point_in_polygon(near, &plate.specimen.outline) {
            let bridge = Cut { points: vec![at, near], ligaments: left(plate, at, near), cracked: Vec::new() };
            ways.extend(through(plate, near, other, visited, &bridge));
        }
    }
    ways
}

/// Ways on from a place on a crack along it to each of its ends, after a way to that place.
fn through(plate: &Plate<'_>, at: Point, other: usize, visited: &mut Vec<usize>, to_it: &Cut) -> Vec<Cut> {
    let crack = &plate.cracks[other];
    visited.push(other);
    let mut ways = Vec::new();
    for at_last in [false, true] {
        if distance(crack.end(at_last), at) <= plate.same {
            continue;
        }
        let mut points = vec![at];
        let is_on = |[a, b]: &[Point; 2]| distance_to_segment(at, *a, *b) <= plate.same;
        let piece = crack.pieces().position(|piece| is_on(&piece)).unwrap_or(0);
        if at_last {
            points.extend(&crack.points[piece + 1..]);
        } else {
            points.extend(crack.points[..=piece].iter().rev());
        }
        points.dedup_by(|a, b| distance(*a, *b) <= plate.same);
        let part = to_it.clone().joined(&Cut::along_crack(points));
        ways.extend(exits(plate, other, at_last, visited).iter().map(|on| part.clone().joined(on)));
    }
    visited.pop();
    ways
}

/// Middles of the holes nearest to a place, that in which it lies left out.
fn nearest_holes(plate: &Plate<'_>, at: Point) -> Vec<Point> {
    let mut middles: Vec<Point> = plate.specimen.holes.iter().map(|hole| hole.centre).filter(|middle| *middle != at).collect();
    middles.sort_by(|a, b| distance(*a, at).total_cmp(&distance(*b, at)));
    middles.truncate(NEIGHBOURS);
    middles
}

/// Directions to the nearest place of the outline; of several equally near ones, as round a head, to the first and the last.
fn nearest_of_outline(plate: &Plate<'_>, at: Point) -> Vec<Point> {
    let places: Vec<Point> =
        edges(&plate.specimen.outline).map(|(a, b)| crate::specimen::geometry::nearest_of_segment(at, a, b)).collect();
    let least = places.iter().map(|place| distance(at, *place)).fold(f64::INFINITY, f64::min);
    let near: Vec<Point> = places.into_iter().filter(|place| distance(at, *place) <= least + plate.same).collect();
    let mut ways: Vec<Point> = near.first().into_iter().chain(near.last()).map(|place| direction(at, *place)).collect();
    ways.dedup();
    ways
}

/// Straight from a place to the outline, and what is left of the material on the way.
fn ray(plate: &Plate<'_>, at: Point, ahead: Point) -> Option<Cut> {
    if ahead == [0.0; 2] {
        return None;
    }
    let reach = 2.0 * (plate.specimen.gross_width + plate.specimen.length());
    let far = [0, 1].map(|i| at[i] + reach * ahead[i]);
    let met = edges(&plate.specimen.outline).filter(|(a, b)| segments_touch(at, far, *a, *b));
    let shares = met.filter_map(|(a, b)| meeting_share(at, far, a, b)).filter(|share| share * reach > plate.same);
    let end = along(at, far, shares.fold(f64::INFINITY, f64::min));
    end[0].is_finite().then(|| Cut { points: vec![at, end], ligaments: left(plate, at, end), cracked: Vec::new() })
}

/// What is left of a straight way through the material: without holes, slots and cracks along it.
fn left(plate: &Plate<'_>, from: Point, to: Point) -> Vec<[Point; 2]> {
    let specimen = plate.specimen;
    let length = distance(from, to);
    if length <= plate.same {
        return Vec::new();
    }
    let mut gone: Vec<[f64; 2]> =
        specimen.holes.iter().filter_map(|hole| circle_shares(from, to, hole.centre, hole.radius)).collect();
    for slot in &specimen.slots {
        let corners = slot.corners();
        let mut shares: Vec<f64> = edges(&corners)
            .filter(|(a, b)| segments_touch(from, to, *a, *b))
            .filter_map(|(a, b)| meeting_share(from, to, a, b))
            .collect();
        shares.extend([(from, 0.0), (to, 1.0)].into_iter().filter(|(at, _)| slot.contains(*at)).map(|(_, share)| share));
        let ends = shares.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), share| (a.min(*share), b.max(*share)));
        gone.extend((ends.0 < ends.1).then_some([ends.0, ends.1]));
    }
    let ahead = direction(from, to);
    let share = |p: Point| ((p[0] - from[0]) * ahead[0] + (p[1] - from[1]) * ahead[1]) / length;
    let beside = |p: Point| ((p[0] - from[0]) * ahead[1] - (p[1] - from[1]) * ahead[0]).abs();
    for [a, b] in plate.cracks.iter().flat_map(CrackLine::pieces) {
        if beside(a) <= plate.same && beside(b) <= plate.same {
            let (a, b) = (share(a), share(b));
            gone.push([a.min(b), a.max(b)]);
        }
    }
    gone.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut pieces = Vec::new();
    let mut done = 0.0;
    for [start, end] in gone.into_iter().chain([[1.0, 1.0]]) {
        let start = start.min(1.0);
        if (start - done) * length > plate.same {
            pieces.push([along(from, to, done), along(from, to, start)]);
        }
        done = end.max(done);
    }
    pieces
}
