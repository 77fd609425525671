//! Whether holes, slots and cracks of a plate fit into it and beside each other, and where cracks can grow.

use super::geometry::{
    along, circle_shares, direction, distance, distance_to_polygon, distance_to_segment, edges, meeting_share,
    nearest_of_segment, point_in_polygon, segments_touch, turn_at,
};
use super::{Crack, CrackLine, Hole, Point, Slot, Specimen, TipSeed};
use perilife_base::error::{Result, fail_if, input_missing};
use perilife_base::units::{given_mm, round_mm};

/// What lies closer than this counts as touching, m: far below any spacing, far above round-off.
const TOUCH: f64 = 1e-7;
/// Distance of an end of a crack from a rim, over the length of the crack, up to which it is its mouth: what is left there breaks within
/// a few cycles.
const MOUTH: f64 = 0.01;
/// Turn of a crack at a corner, degrees, from which the material ahead of the corner is stressed nearly as ahead of a tip (Williams 1952: the
/// exponent of an opening of 90° is 0.544, that of a crack 0.5), and from which the crack is one that was folded.
const SHARP: f64 = 90.0;
const FOLDED: f64 = 150.0;
/// Way ahead, over the distance from a rim, within which a crack goes on to it straight.
const AHEAD: f64 = 3.0;

/// Holes lie inside the outline and do not touch each other.
pub(super) fn check_holes(specimen: &Specimen) -> Result<()> {
    for (i, hole) in specimen.holes.iter().enumerate() {
        let inside = point_in_polygon(hole.centre, &specimen.outline);
        if !inside || distance_to_polygon(hole.centre, &specimen.outline) < hole.radius + TOUCH {
            let problem =
                format!("extends past the outline (center {}, radius {} mm)", given_mm(hole.centre), round_mm(hole.radius));
            let remedy = "move it inside, or draw the opening into outline_mm";
            return Err(input_missing(&format!("specimen.holes[{i}]"), problem, remedy));
        }
        for (j, other) in specimen.holes[..i].iter().enumerate() {
            if distance(hole.centre, other.centre) < hole.radius + other.radius + TOUCH {
                let remedy = "move the holes apart";
                return Err(input_missing(&format!("specimen.holes[{i}]"), format!("overlaps holes[{j}]"), remedy));
            }
        }
    }
    Ok(())
}

/// Puts the slots in and returns the tip seeds of their end faces.
pub(super) fn place_slots(specimen: &mut Specimen, slots: Vec<Slot>) -> Result<Vec<TipSeed>> {
    let mut seeds = Vec::new();
    for (i, slot) in slots.into_iter().enumerate() {
        let key = format!("specimen.notches[{i}]");
        let inner = |p: Point| point_in_polygon(p, &specimen.outline) && distance_to_polygon(p, &specimen.outline) > TOUCH;
        let closed = [inner(slot.from), inner(slot.to)];
        let corners = slot.corners();
        // Corners in the order right of from, right of to, left of to, left of from.
        let corners_fit = [(0, closed[0]), (3, closed[0]), (1, closed[1]), (2, closed[1])]
            .iter()
            .all(|&(c, wanted)| !wanted || inner(corners[c]));
        let walls = edges(&corners).filter(|(a, b)| edges(&specimen.outline).any(|(c, d)| segments_touch(*a, *b, c, d))).count();
        match closed {
            [false, false] => {
                let remedy = "end it in the material; a slot across the whole plate cuts it in two";
                return Err(input_missing(&key, "has no end inside the plate", remedy));
            }
            [true, true] if walls > 0 || !corners_fit => {
                return Err(input_missing(&key, "touches the outline", "move it inside, or let it start on an edge"));
            }
            _ if !corners_fit => {
                return Err(input_missing(&key, "has a notch root outside the plate", "shorten or narrow it"));
            }
            _ => {}
        }
        let meets_hole =
            |hole: &Hole| slot.contains(hole.centre) || distance_to_polygon(hole.centre, &slot.corners()) < hole.radius + TOUCH;
        if let Some(j) = specimen.holes.iter().position(meets_hole) {
            return Err(input_missing(&key, format!("overlaps holes[{j}]"), "move them apart"));
        }
        if let Some(j) = specimen.slots.iter().position(|other| slots_meet(&slot, other)) {
            return Err(input_missing(&key, format!("overlaps notches[{j}]"), "move them apart"));
        }
        for (end, other, is_closed) in [(slot.from, slot.to, closed[0]), (slot.to, slot.from, closed[1])] {
            if is_closed {
                seeds.push(TipSeed { position: end, direction: direction(other, end), from_slot: true });
            }
        }
        specimen.crack_length += specimen.length_inside(slot.from, slot.to);
        specimen.slots.push(slot);
    }
    Ok(seeds)
}

/// Puts the cracks in, lines with all their corners, cut off where they leave the material, and then all tips: cracks first, slots after
/// them. An end that lies on another crack is no tip. What was done to an end, and what passes a hole closely, goes into `notes`.
pub(super) fn place_cracks(
    specimen: &mut Specimen,
    paths: Vec<Vec<Point>>,
    mut slot_seeds: Vec<TipSeed>,
    notes: &mut Vec<String>,
) -> Result<()> {
    let mut ends: Vec<TipSeed> = Vec::new();
    for (i, path) in with_shared_ends_joined(specimen, paths) {
        let key = format!("specimen.cracks[{i}]");
        let [Some(&asked_from), Some(&asked_to)] = [path.first(), path.last()] else { continue };
        let (second, last_but_one) = (path[1], path[path.len() - 2]);
        let cut =
            [cut_end(specimen, [asked_from, second], &key, notes)?, cut_end(specimen, [asked_to, last_but_one], &key, notes)?];
        let mut corners = path.clone();
        set_ends(&mut corners, cut.map(|(end, _)| end));
        // What lies outside the material says nothing of how near an end is to a rim.
        let length = corners.windows(2).map(|piece| distance(piece[0], piece[1])).sum();
        let others = [second, last_but_one];
        let [(from, from_open), (to, to_open)] = [0, 1].map(|end| match cut[end] {
            (at, false) => at_mouth(specimen, [at, others[end]], length, &key, notes),
            open => open,
        });
        set_ends(&mut corners, [from, to]);
        let is_left = |asked: [Point; 2], left: [Point; 2]| {
            let ahead = direction(asked[0], asked[1]);
            (left[1][0] - left[0][0]) * ahead[0] + (left[1][1] - left[0][1]) * ahead[1] >= 10.0 * TOUCH
        };
        let pieces = || corners.windows(2).map(|piece| [piece[0], piece[1]]);
        if !path.windows(2).zip(pieces()).all(|(asked, left)| is_left([asked[0], asked[1]], left)) {
            return Err(input_missing(&key, "does not reach into the material", "end it inside the plate, beyond hole and slot"));
        }
        let cracks: Vec<Crack> = pieces().enumerate().map(|(j, [from, to])| Crack { from, to, continues: j > 0 }).collect();
        for (j, &crack) in cracks.iter().enumerate() {
            check_path(specimen, crack, &key)?;
            // Of cracks that share an end, too, which are one by now.
            let problem = "folds back on itself or overlaps a crack that shares its end";
            let remedy = "give every part of a crack once";
            fail_if!(cracks[..j].iter().any(|other| is_overlap(crack, *other)), input_missing(&key, problem, remedy));
            if let Some(other) = specimen.cracks.iter().find(|other| is_overlap(crack, **other)) {
                let line =
                    specimen.crack_lines().iter().position(|line| line.pieces().any(|piece| piece == [other.from, other.to]));
                let problem = format!("overlaps cracks[{}]", line.unwrap_or(0));
                return Err(input_missing(&key, problem, "give both as one crack"));
            }
        }
        check_corners(&corners, &key, notes)?;
        // A crack that starts from the end face of a slot takes the place of that face's seed.
        slot_seeds.retain(|seed| {
            let slot = specimen.slots.iter().find(|slot| slot.from == seed.position || slot.to == seed.position);
            let reach = slot.map_or(0.0, |slot| slot.width / 2.0 + TOUCH) + TOUCH;
            distance(seed.position, from) > reach && distance(seed.position, to) > reach
        });
        for (end, other, open) in [(from, corners[1], from_open), (to, corners[corners.len() - 2], to_open)] {
            if !open {
                ends.push(TipSeed { position: end, direction: direction(other, end), from_slot: false });
            }
        }
        specimen.crack_length += pieces().map(|[a, b]| distance(a, b)).sum::<f64>();
        specimen.cracks.extend(cracks);
    }
    let lines = specimen.crack_lines();
    let is_free = |seed: &TipSeed| {
        let is_end = |line: &CrackLine| [true, false].iter().any(|&at_last| line.end(at_last) == seed.position);
        lines.iter().all(|line| is_end(line) || line.distance(seed.position) > TOUCH)
            && lines.iter().filter(|line| is_end(line)).count() == 1
    };
    specimen.tips.extend(ends.into_iter().filter(is_free));
    specimen.tips.append(&mut slot_seeds);
    for (i, line) in lines.iter().enumerate() {
        let is_joined =
            || lines.iter().enumerate().any(|(other, crack)| other != i && line.pieces().any(|[a, b]| crack.meets(a, b, TOUCH)));
        // A cut between holes, such as cracks leave that have linked them, does not grow; other tips do. One from edge to edge parts the
        // plate, whatever meets it, and cracks that only meet each other have no tip at all.
        let is_from_edge_to_edge =
            || [false, true].iter().all(|&at_last| distance_to_polygon(line.end(at_last), &specimen.outline) <= TOUCH);
        if specimen.tips_of(line) == 0 && (is_from_edge_to_edge() || specimen.tips.is_empty()) {
            let key = format!("specimen.cracks[{i}]");
            let problem = "meets another crack and has no tip inside the material";
            fail_if!(is_joined(), input_missing(&key, problem, "end one of them inside the plate"));
            let problem = "has no tip inside the material (a tip within 1 % of its length from an edge counts as on it)";
            return Err(input_missing(&key, problem, "end it inside the plate"));
        }
    }
    notes.extend(closely_passed(specimen, &lines));
    Ok(())
}

/// Holes that a crack passes, not with its ends, nearer than a hundredth of its length.
fn closely_passed(specimen: &Specimen, lines: &[CrackLine]) -> Vec<String> {
    let passed = |(i, line): (usize, &CrackLine)| {
        let near = |(j, hole): (usize, &Hole)| {
            let gap = line.distance(hole.centre) - hole.radius;
            let end = [false, true]
                .iter()
                .map(|&at_last| distance(line.end(at_last), hole.centre) - hole.radius)
                .fold(f64::INFINITY, f64::min);
            (gap <= MOUTH * line.length() && end > MOUTH * line.length()).then(|| {
                let thin = "the ligament is too thin to resolve and K may be far off";
                let remedy = "end the crack in the hole and start another beyond it";
                format!("cracks: specimen.cracks[{i}] passes holes[{j}] at {} mm: {thin}; {remedy}", round_mm(gap.max(0.0)))
            })
        };
        specimen.holes.iter().enumerate().filter_map(near).collect::<Vec<_>>()
    };
    lines.iter().enumerate().flat_map(passed).collect()
}

/// Paths with their numbers; two that share an end, where no third comes, are one crack with a bend there. On a rim and outside the material
/// they do not meet: each has its own mouth.
fn with_shared_ends_joined(specimen: &Specimen, paths: Vec<Vec<Point>>) -> Vec<(usize, Vec<Point>)> {
    let is_on_rim = |at: Point| distance_to_polygon(at, &specimen.outline) <= TOUCH || !specimen.has_point_at(at, TOUCH);
    let mut joined: Vec<(usize, Vec<Point>)> = parted_at_branches(paths, is_on_rim);
    let is_same = |a: Point, b: Point| distance(a, b) < TOUCH;
    let ends = |path: &[Point]| [path[0], path[path.len() - 1]];
    loop {
        let pair = (0..joined.len()).flat_map(|i| (i + 1..joined.len()).map(move |j| (i, j))).find_map(|(i, j)| {
            let shared: Vec<Point> =
                ends(&joined[i].1).into_iter().filter(|&a| ends(&joined[j].1).into_iter().any(|b| is_same(a, b))).collect();
            let [at] = shared[..] else { return None };
            if is_on_rim(at) {
                return None;
            }
            (joined.iter().filter(|(_, path)| passes(path, at)).count() == 2).then_some((i, j, at))
        });
        let Some((i, j, at)) = pair else { return joined };
        let (_, mut second) = joined.remove(j);
        let first = &mut joined[i].1;
        let at_start = is_same(first[0], at);
        if is_same(second[0], at) == at_start {
            second.reverse();
        }
        // The corner is the end that the earlier of both gives.
        if at_start {
            second.pop();
            first.splice(0..0, second);
        } else {
            first.extend(second.into_iter().skip(1));
        }
    }
}

fn passes(path: &[Point], at: Point) -> bool {
    path.windows(2).any(|piece| distance_to_segment(at, piece[0], piece[1]) < TOUCH)
}

/// Paths with their numbers, parted at corners from which others branch, and on a rim: a branch is the end of each that meets there.
fn parted_at_branches(paths: Vec<Vec<Point>>, is_on_rim: impl Fn(Point) -> bool) -> Vec<(usize, Vec<Point>)> {
    let is_met = |own: usize, at: Point| {
        let mut others = paths.iter().enumerate().filter(|(other, _)| *other != own);
        others.any(|(_, path)| passes(path, at))
    };
    let mut parted = Vec::new();
    for (own, path) in paths.iter().enumerate() {
        let mut from = 0;
        for corner in 1..path.len() {
            if corner + 1 == path.len() || is_on_rim(path[corner]) || is_met(own, path[corner]) {
                parted.push((own, path[from..=corner].to_vec()));
                from = corner;
            }
        }
    }
    parted
}

/// Whether two straight cracks lie on one line over some length.
fn is_overlap(a: Crack, b: Crack) -> bool {
    let ahead = direction(a.from, a.to);
    let seat = |p: Point| {
        let [x, y] = [p[0] - a.from[0], p[1] - a.from[1]];
        [x * ahead[0] + y * ahead[1], y * ahead[0] - x * ahead[1]]
    };
    let ([s, off_s], [t, off_t]) = (seat(b.from), seat(b.to));
    off_s.abs() < TOUCH && off_t.abs() < TOUCH && s.min(t).max(0.0) + TOUCH < s.max(t).min(distance(a.from, a.to))
}

/// No crack turns back at a corner, which is no tip and does not grow.
fn check_corners(corners: &[Point], key: &str, notes: &mut Vec<String>) -> Result<()> {
    for corner in corners.windows(3) {
        let turn = turn_at(corner[0], corner[1], corner[2]).abs().to_degrees();
        let problem = format!("turns by {turn:.0}° at {}", given_mm(corner[1]));
        if turn > FOLDED {
            let remedy = "end the crack at that corner; give the rest as a separate crack that does not share its end";
            return Err(input_missing(key, format!("{problem}: such a sharp corner acts like a tip but does not grow"), remedy));
        }
        if turn > SHARP {
            notes.push(format!("cracks: {key} {problem}: such a sharp corner acts like a tip but does not grow"));
        }
    }
    Ok(())
}

fn set_ends(corners: &mut [Point], [from, to]: [Point; 2]) {
    if let [first, .., last] = corners {
        (*first, *last) = (from, to);
    }
}

/// Where a crack leaves what is no material at one of its ends, and whether that end is open (on an edge, in a hole or in a slot) and so
/// not a tip.
fn cut_end(specimen: &Specimen, [end, other]: [Point; 2], key: &str, notes: &mut Vec<String>) -> Result<(Point, bool)> {
    if let Some(hole) = specimen.holes.iter().find(|hole| distance(end, hole.centre) <= hole.radius + TOUCH) {
        let leaves = circle_shares(end, other, hole.centre, hole.radius).map_or(0.0, |[_, leaves]| leaves.max(0.0));
        return Ok((along(end, other, leaves), true));
    }
    if let Some(slot) =
        specimen.slots.iter().find(|slot| slot.contains(end) || distance_to_polygon(end, &slot.corners()) <= TOUCH)
    {
        let share = edges(&slot.corners()).filter_map(|(a, b)| share_of_meeting(end, other, a, b)).fold(0.0, f64::max);
        return Ok((along(end, other, share.min(1.0)), true));
    }
    if distance_to_polygon(end, &specimen.outline) <= TOUCH {
        return Ok((end, true));
    }
    if !point_in_polygon(end, &specimen.outline) {
        let shares = edges(&specimen.outline).filter_map(|(a, b)| share_of_meeting(end, other, a, b));
        let Some(share) = shares.min_by(f64::total_cmp) else {
            let remedy = "end it inside the plate or on its edge";
            return Err(input_missing(key, format!("ends outside the plate at {}", given_mm(end)), remedy));
        };
        let edge = along(end, other, share);
        notes.push(format!("cracks: {key} ends outside at {}: shortened to the edge, at {}", given_mm(end), given_mm(edge)));
        return Ok((edge, true));
    }
    Ok((end, false))
}

/// The same of an end in the material of a crack of this length, m: one that all but reaches a rim is open.
fn at_mouth(specimen: &Specimen, [end, other]: [Point; 2], length: f64, key: &str, notes: &mut Vec<String>) -> (Point, bool) {
    let Some((gap, mouth)) = mouth(specimen, end, other).filter(|(gap, _)| *gap <= MOUTH * length) else {
        return (end, false);
    };
    let near = format!("{} mm from an edge (under 1 % of its length, {} mm)", round_mm(gap), round_mm(length));
    notes.push(format!("cracks: {key} ends {near}: moved to the edge, at {}", given_mm(mouth)));
    (mouth, true)
}

/// Distance of an end of a crack, coming from `other`, from the nearest rim, m, and where it meets that: straight ahead, or at the nearest place.
fn mouth(specimen: &Specimen, end: Point, other: Point) -> Option<(f64, Point)> {
    let slots: Vec<[Point; 4]> = specimen.slots.iter().map(Slot::corners).collect();
    let walls: Vec<(Point, Point)> = edges(&specimen.outline).chain(slots.iter().flat_map(|corners| edges(corners))).collect();
    let of_walls = walls.iter().map(|(a, b)| nearest_of_segment(end, *a, *b));
    let of_holes = specimen.holes.iter().map(|hole| along(hole.centre, end, hole.radius / distance(hole.centre, end)));
    let nearest = of_walls.chain(of_holes).min_by(|a, b| distance(end, *a).total_cmp(&distance(end, *b)))?;
    let gap = distance(end, nearest);
    let ahead = along(end, other, -AHEAD * gap / distance(end, other));
    let of_walls = walls.iter().filter_map(|(a, b)| share_of_meeting(end, ahead, *a, *b));
    let of_holes = specimen.holes.iter().filter_map(|hole| Some(circle_shares(end, ahead, hole.centre, hole.radius)?[0]));
    let share = of_walls.chain(of_holes).filter(|share| (0.0..=1.0).contains(share)).min_by(f64::total_cmp);
    Some((gap, share.map_or(nearest, |share| along(end, ahead, share))))
}

/// Share of the way from `from` to `to` at which it meets the segment ab.
fn share_of_meeting(from: Point, to: Point, a: Point, b: Point) -> Option<f64> {
    segments_touch(from, to, a, b).then(|| meeting_share(from, to, a, b))?
}

/// Between its ends a crack stays in the material.
fn check_path(specimen: &Specimen, crack: Crack, key: &str) -> Result<()> {
    // Ends may touch what they start from.
    let shrink = (2.0 * TOUCH / distance(crack.from, crack.to)).max(1e-6);
    let (from, to) = (along(crack.from, crack.to, shrink), along(crack.from, crack.to, 1.0 - shrink));
    let middle = along(from, to, 0.5);
    if edges(&specimen.outline).any(|(a, b)| segments_touch(from, to, a, b)) || !point_in_polygon(middle, &specimen.outline) {
        let remedy = "give the parts inside the plate as cracks of their own";
        return Err(input_missing(key, "leaves the plate between its ends", remedy));
    }
    if let Some(i) = specimen.holes.iter().position(|hole| distance_to_segment(hole.centre, from, to) < hole.radius - TOUCH) {
        let remedy = "give one crack on each side that starts in the hole";
        return Err(input_missing(key, format!("runs through holes[{i}]"), remedy));
    }
    if let Some(i) = specimen.slots.iter().position(|slot| edges(&slot.corners()).any(|(a, b)| segments_touch(from, to, a, b))) {
        let remedy = "give one crack on each side that starts in the notch";
        return Err(input_missing(key, format!("runs through notches[{i}]"), remedy));
    }
    Ok(())
}

fn slots_meet(a: &Slot, b: &Slot) -> bool {
    let (of_a, of_b) = (a.corners(), b.corners());
    a.contains(b.from) || b.contains(a.from) || edges(&of_a).any(|(p, q)| edges(&of_b).any(|(r, s)| segments_touch(p, q, r, s)))
}
