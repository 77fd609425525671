//! Lines of a drawing: straight pieces and arcs, chained end to end, and the polylines that they become.

use std::f64::consts::TAU;

use crate::specimen::Point;
use crate::specimen::geometry::{along, circle_shares, distance, meeting_share};
use perilife_base::error::fail_if;

/// Turn of an arc from one corner of its polyline to the next at the most, rad: 2.5°. Corners lie on the arc, and chords within
/// r (1 - cos 1.25°) = 2.4e-4 radii of it.
pub const TURN: f64 = TAU / 144.0;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc {
    pub centre: Point,
    /// Angle that it turns by, rad, positive counter-clockwise.
    pub sweep: f64,
}

/// A piece of a curve, from the end of the one before it to a place, m: an arc, or straight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    pub to: Point,
    pub arc: Option<Arc>,
}

impl Piece {
    pub fn straight(to: Point) -> Self {
        Piece { to, arc: None }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    pub from: Point,
    /// In order; at least one.
    pub pieces: Vec<Piece>,
}

impl Curve {
    pub fn circle(centre: Point, radius: f64) -> Self {
        let from = [centre[0] + radius, centre[1]];
        Curve { from, pieces: vec![Piece { to: from, arc: Some(Arc { centre, sweep: TAU }) }] }
    }

    pub fn end(&self) -> Point {
        self.pieces.last().map_or(self.from, |piece| piece.to)
    }

    fn end_at(&mut self, at: Point) {
        if let Some(last) = self.pieces.last_mut() {
            last.to = at;
        }
    }

    /// Whether its end is its start, within `tolerance`, m.
    pub fn is_closed(&self, tolerance: f64) -> bool {
        let is_more = self.pieces.len() > 1 || self.pieces.iter().any(|piece| piece.arc.is_some_and(|arc| arc.sweep.abs() > 1.0));
        is_more && distance(self.from, self.end()) <= tolerance
    }

    /// Centre and radius, m, of a closed curve that is a full circle of arcs.
    pub fn as_circle(&self, tolerance: f64) -> Option<(Point, f64)> {
        let centre = self.pieces.first()?.arc?.centre;
        let radius = distance(centre, self.from);
        let is_part = |piece: &Piece| {
            let arc = piece.arc?;
            let fits = distance(arc.centre, centre) <= tolerance && (distance(piece.to, centre) - radius).abs() <= tolerance;
            fits.then_some(arc.sweep)
        };
        let sweep: f64 = self.pieces.iter().map(is_part).collect::<Option<Vec<f64>>>()?.iter().sum();
        (self.is_closed(tolerance) && (sweep.abs() - TAU).abs() < 1e-3).then_some((centre, radius))
    }

    /// Its corners, arcs as polylines, both ends included; without those that lie straight between their neighbours.
    pub fn points(&self) -> Vec<Point> {
        let mut points = vec![self.from];
        for piece in &self.pieces {
            let before = points[points.len() - 1];
            if let Some(Arc { centre, sweep }) = piece.arc {
                let [x, y] = [before[0] - centre[0], before[1] - centre[1]];
                let corners = (sweep.abs() / TURN - 1e-9).ceil().max(1.0) as usize;
                points.extend((1..corners).map(|corner| {
                    let (sin, cos) = (sweep * corner as f64 / corners as f64).sin_cos();
                    [centre[0] + cos * x - sin * y, centre[1] + sin * x + cos * y]
                }));
            }
            points.push(piece.to);
        }
        points
    }

    /// The same curve with corners where cracks cross its arcs, or end within `tolerance` of them, m, so that its polyline passes through these places.
    pub fn cornered(&self, cracks: &[&Curve], tolerance: f64) -> Self {
        let mut pieces = Vec::with_capacity(self.pieces.len());
        let mut from = self.from;
        for piece in &self.pieces {
            if let Some(Arc { centre, sweep }) = piece.arc {
                let radius = distance(centre, from);
                let met = cracks.iter().flat_map(|crack| crack.meets(centre, radius, tolerance));
                let angle = |at: Point| (at[1] - centre[1]).atan2(at[0] - centre[0]);
                let turned = |to: Point| ((angle(to) - angle(from)) * sweep.signum()).rem_euclid(TAU);
                let mut cuts: Vec<(f64, Point)> = met.map(|at| (turned(at), at)).collect();
                cuts.retain(|(angle, _)| (tolerance / radius..sweep.abs() - tolerance / radius).contains(angle));
                cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
                cuts.dedup_by(|next, before| next.0 - before.0 < tolerance / radius);
                let mut gone = 0.0;
                for (angle, to) in cuts {
                    pieces.push(Piece { to, arc: Some(Arc { centre, sweep: (angle - gone).copysign(sweep) }) });
                    gone = angle;
                }
                pieces.push(Piece { to: piece.to, arc: Some(Arc { centre, sweep: (sweep.abs() - gone).copysign(sweep) }) });
            } else {
                pieces.push(*piece);
            }
            from = piece.to;
        }
        Curve { from: self.from, pieces }
    }

    /// Where its corners lie on a circle, within `tolerance`, and its lines cross that.
    fn meets(&self, centre: Point, radius: f64, tolerance: f64) -> Vec<Point> {
        let points = self.points();
        let mut met: Vec<Point> =
            points.iter().copied().filter(|at| (distance(*at, centre) - radius).abs() <= tolerance).collect();
        for pair in points.windows(2) {
            let shares = circle_shares(pair[0], pair[1], centre, radius).into_iter().flatten();
            met.extend(shares.filter(|share| (0.0..=1.0).contains(share)).map(|share| along(pair[0], pair[1], share)));
        }
        met
    }

    /// The same curve from its end to its start.
    pub fn reversed(&self) -> Self {
        let starts = std::iter::once(self.from).chain(self.pieces.iter().map(|piece| piece.to));
        let back = |(to, piece): (Point, &Piece)| Piece { to, arc: piece.arc.map(|arc| Arc { sweep: -arc.sweep, ..arc }) };
        let mut pieces: Vec<Piece> = starts.zip(&self.pieces).map(back).collect();
        pieces.reverse();
        Curve { from: self.end(), pieces }
    }

    /// With every place changed; `turns` tells whether arcs then turn the other way.
    pub fn mapped(&self, map: impl Fn(Point) -> Point, turns: bool) -> Self {
        let arc = |arc: Arc| Arc { centre: map(arc.centre), sweep: if turns { -arc.sweep } else { arc.sweep } };
        let pieces = self.pieces.iter().map(|piece| Piece { to: map(piece.to), arc: piece.arc.map(arc) }).collect();
        Curve { from: map(self.from), pieces }
    }

    /// Parted into curves without some of its straight pieces, and those of these alone.
    pub fn parted(&self, is_taken: impl Fn(Point, Point) -> bool) -> [Vec<Curve>; 2] {
        let mut parts: [Vec<Curve>; 2] = Default::default();
        let (mut from, mut last) = (self.from, None);
        for piece in &self.pieces {
            let part = usize::from(piece.arc.is_none() && is_taken(from, piece.to));
            match parts[part].last_mut().filter(|_| last == Some(part)) {
                Some(curve) => curve.pieces.push(*piece),
                None => parts[part].push(Curve { from, pieces: vec![*piece] }),
            }
            (from, last) = (piece.to, Some(part));
        }
        parts
    }
}

/// The arc from one place to another that turns by `4 atan(bulge)`, as DXF has it; straight without a bulge.
pub fn bulged(from: Point, to: Point, bulge: f64) -> Piece {
    if bulge == 0.0 {
        return Piece::straight(to);
    }
    let sweep = 4.0 * bulge.atan();
    let ahead = 0.5 / (0.5 * sweep).tan();
    let middle = along(from, to, 0.5);
    let centre = [middle[0] - ahead * (to[1] - from[1]), middle[1] + ahead * (to[0] - from[0])];
    Piece { to, arc: Some(Arc { centre, sweep }) }
}

/// Where the last piece of a curve and the first of the next one meet, whose ends lie within `tolerance` of each other, m: straight pieces
/// keep their directions, so that a gap that is closed tilts no side of a plate.
fn joint(curve: &Curve, next: &Curve, tolerance: f64) -> Point {
    let (end, start) = (curve.end(), next.from);
    let before = curve.pieces.len().checked_sub(2).map_or(curve.from, |piece| curve.pieces[piece].to);
    match (curve.pieces.last(), next.pieces.first()) {
        (Some(Piece { arc: Some(_), .. }), Some(Piece { arc: None, .. })) => start,
        (Some(Piece { arc: None, .. }), Some(Piece { arc: None, to })) if end != start => {
            let crossing = meeting_share(before, end, start, *to).map(|share| along(before, end, share));
            // Lines that are all but parallel cross anywhere.
            crossing.filter(|at| [end, start].iter().all(|end| distance(*at, *end) <= 2.0 * tolerance)).unwrap_or(end)
        }
        _ => end,
    }
}

/// Places where more than two ends of curves lie within `tolerance` of each other, m, which then are one.
pub fn branched(curves: &mut [Curve], tolerance: f64) -> Vec<Point> {
    let ends: Vec<Point> = curves.iter().flat_map(|curve| [curve.from, curve.end()]).collect();
    let near = |at: Point| ends.iter().filter(move |end| distance(**end, at) <= tolerance);
    let mut places: Vec<Point> = ends.iter().copied().filter(|at| near(*at).count() > 2).collect();
    places.dedup_by(|next, before| distance(*next, *before) <= tolerance);
    let place = |end: Point| places.iter().copied().find(|at| distance(*at, end) <= tolerance).unwrap_or(end);
    for curve in curves {
        let [from, to] = [curve.from, curve.end()].map(place);
        curve.from = from;
        curve.end_at(to);
    }
    places
}

/// Chains curves whose ends lie within `tolerance` of each other, m, where they may meet.
/// Errors: the place where more than two of them meet.
pub fn chained(mut curves: Vec<Curve>, tolerance: f64, may_meet: impl Fn(Point) -> bool) -> Result<Vec<Curve>, Point> {
    let is_near = |a: Point, b: Point| distance(a, b) <= tolerance;
    let mut chains = Vec::new();
    while !curves.is_empty() {
        let mut chain = curves.remove(0);
        for _ in 0..2 {
            while !chain.is_closed(tolerance) {
                let end = chain.end();
                if !may_meet(end) {
                    break;
                }
                let meets =
                    |curve: &Curve| !curve.is_closed(tolerance) && (is_near(curve.from, end) || is_near(curve.end(), end));
                let mut next = (0..curves.len()).filter(|&curve| meets(&curves[curve]));
                let Some(first) = next.next() else { break };
                fail_if!(next.next().is_some(), end);
                let next = curves.remove(first);
                let next = if is_near(next.from, end) { next } else { next.reversed() };
                chain.end_at(joint(&chain, &next, tolerance));
                chain.pieces.extend(next.pieces);
            }
            chain = chain.reversed();
        }
        if chain.pieces.len() > 1 && chain.is_closed(tolerance) {
            let at = joint(&chain, &chain, tolerance);
            chain.end_at(at);
            chain.from = at;
        }
        chains.push(chain);
    }
    Ok(chains)
}
