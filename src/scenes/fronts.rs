//! Crack fronts of a scene: points that have lost enough of their bonds, joined to the front they lie ahead of.
//!
//! A straight crack between two rows takes at most 11 of 28 bonds of a point (0.393) at a horizon ratio of 3.015, so a point
//! counts as cracked from a damage of 0.35 on. A front moves to the cracked point farthest ahead of it; a crack that grows
//! wider behind its front moves nothing. Points cracked away from every front and its way begin a new one: a branch, or a crack
//! from a place where there was none.

use serde::{Deserialize, Serialize};

use super::outcome::PathPoint;
use perilife_plate::specimen::geometry::{direction, distance};
use perilife_plate::specimen::{Point, Specimen};
use perilife_points::net::Net;

/// Damage from which a point is cracked.
pub const CRACKED: f64 = 0.35;
/// Damage at which the literature of dual-horizon plates (Ren, Zhuang, Cai and Rabczuk 2016) logs place, time and speed of cracking. A
/// straight crack along the rows never gets there; one that turns or kinks does.
pub const LOGGED: f64 = 0.5;
/// Distance in horizons within which a cracked point belongs to a front or to its way.
const REACH: f64 = 2.0;
/// Distance in spacings that a point has to lie ahead of a front to move it.
const AHEAD: f64 = 0.25;

/// A crack front on its way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct DynamicFront {
    at: Point,
    /// Unit vector of growth over the last horizon; zero before there was any.
    direction: Point,
    way: Vec<Point>,
    /// When it came here, s.
    time: f64,
    /// Where it stood at the last earlier time, and when it came there.
    before: (Point, f64),
}

impl DynamicFront {
    /// How far a point lies ahead, m; `None` where it is out of reach, behind, or farther aside than ahead by more than a spacing.
    fn ahead(&self, point: Point, spacing: f64, horizon: f64) -> Option<f64> {
        let away = distance(point, self.at);
        let step = [point[0] - self.at[0], point[1] - self.at[1]];
        let [x, y] = self.direction;
        if self.direction == [0.0; 2] {
            return (away <= REACH * horizon).then_some(away);
        }
        let (forward, aside) = (step[0] * x + step[1] * y, (step[1] * x - step[0] * y).abs());
        (away <= REACH * horizon && forward > AHEAD * spacing && aside <= forward + spacing).then_some(forward)
    }

    fn starting(at: Point, direction: Point, time: f64) -> Self {
        DynamicFront { at, direction, way: vec![at], time, before: (at, time) }
    }

    /// Moves on; returns the speed, m/s, 0 where no time has passed.
    fn move_to(&mut self, point: Point, horizon: f64, time: f64) -> f64 {
        if time > self.time {
            (self.before, self.time) = ((self.at, self.time), time);
        }
        let (from, since) = self.before;
        let speed = if time > since { distance(from, point) / (time - since) } else { 0.0 };
        self.at = point;
        self.way.push(point);
        let back = self.way.iter().rev().find(|&&at| distance(at, point) >= horizon).or(self.way.first());
        let since = back.map_or([0.0; 2], |&back| direction(back, point));
        if since != [0.0; 2] {
            self.direction = since;
        }
        speed
    }
}

pub struct Fronts<'n> {
    net: &'n Net,
    /// Damage from which a point is cracked.
    threshold: f64,
    standing: Standing,
}

/// Where all fronts are, and what they did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    cracked: Vec<bool>,
    fronts: Vec<DynamicFront>,
    /// Whether the points cracked at the start were taken down.
    begun: bool,
    /// Where fronts stood, in the order of time.
    path: Vec<PathPoint>,
}

impl<'n> Fronts<'n> {
    /// Fronts of points with this damage, at the tips of the specimen.
    pub fn new(specimen: &Specimen, net: &'n Net, threshold: f64) -> Self {
        let front = |tip: &perilife_plate::specimen::TipSeed| DynamicFront::starting(tip.position, tip.direction, 0.0);
        let fronts: Vec<DynamicFront> = specimen.tips.iter().map(front).collect();
        let (step, [time, damage, speed]) = (0, [0.0; 3]);
        let start = |(tip, front): (usize, &DynamicFront)| PathPoint { tip, step, time, position: front.at, damage, speed };
        let path = fronts.iter().enumerate().map(start).collect();
        Fronts { net, threshold, standing: Standing { cracked: vec![false; net.len()], fronts, begun: false, path } }
    }

    pub fn standing(&self) -> &Standing {
        &self.standing
    }

    /// Puts them where they stood; whether they are those of this net.
    pub fn restore(&mut self, standing: Standing) -> bool {
        let fits = standing.cracked.len() == self.net.len();
        self.standing = standing;
        fits
    }

    /// Where they stood, in the order of time.
    pub fn into_path(self) -> Vec<PathPoint> {
        self.standing.path
    }

    /// Takes down where the fronts stand with this damage of the points.
    pub fn advance(&mut self, step: usize, time: f64, damage: &[f64]) {
        let cracked = &mut self.standing.cracked;
        let mut left: Vec<usize> = (0..damage.len()).filter(|&i| damage[i] >= self.threshold && !cracked[i]).collect();
        left.iter().for_each(|&i| cracked[i] = true);
        if !std::mem::replace(&mut self.standing.begun, true) {
            return;
        }
        // A front may run through several points in one step: it goes on until nothing lies ahead of any.
        while !left.is_empty() {
            let moves = self.moves(&left);
            for &(tip, i) in &moves {
                let position = self.net.positions[i];
                let speed = self.standing.fronts[tip].move_to(position, self.net.horizons[i], time);
                self.standing.path.push(PathPoint { tip, step, time, position, damage: damage[i], speed });
            }
            if moves.is_empty() {
                let Some((first, front)) = self.new_front(&left, time) else { break };
                let (tip, position) = (self.standing.fronts.len(), front.at);
                self.standing.path.push(PathPoint { tip, step, time, position, damage: damage[first], speed: 0.0 });
                self.standing.fronts.push(front);
                left.retain(|&i| i != first);
            }
        }
    }

    /// A front at that of the points away from all fronts and ways that lies nearest to one; a branch points away from where it
    /// came off, a crack far from all others anywhere.
    fn new_front(&self, points: &[usize], time: f64) -> Option<(usize, DynamicFront)> {
        let off = |&i: &usize| {
            let (at, horizon) = (self.net.positions[i], self.net.horizons[i]);
            let ways = self.standing.fronts.iter().flat_map(|front| &front.way);
            let from = ways.min_by(|a, b| distance(**a, at).total_cmp(&distance(**b, at)));
            let away = from.map_or(f64::INFINITY, |&from| distance(from, at));
            let start = from.filter(|_| away <= 2.0 * REACH * horizon).map_or([0.0; 2], |&from| direction(from, at));
            (away > REACH * horizon).then_some((away, i, DynamicFront::starting(at, start, time)))
        };
        let nearest = points.iter().filter_map(off).min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some((nearest.1, nearest.2))
    }

    /// The point farthest ahead of every front that has one; a point counts for the front nearest to it.
    fn moves(&self, points: &[usize]) -> Vec<(usize, usize)> {
        let mut best: Vec<Option<(f64, usize)>> = vec![None; self.standing.fronts.len()];
        for &i in points {
            let (at, spacing, horizon) = (self.net.positions[i], self.net.spacings[i], self.net.horizons[i]);
            let fronts = self.standing.fronts.iter().enumerate();
            let near = fronts.filter_map(|(tip, front)| Some((tip, front.ahead(at, spacing, horizon)?)));
            let away = |tip: usize| distance(self.standing.fronts[tip].at, at);
            let nearest = near.min_by(|a, b| away(a.0).total_cmp(&away(b.0)));
            if let Some((tip, forward)) = nearest
                && best[tip].is_none_or(|(most, _)| forward > most)
            {
                best[tip] = Some((forward, i));
            }
        }
        best.iter().enumerate().filter_map(|(tip, best)| best.map(|(_, i)| (tip, i))).collect()
    }
}
