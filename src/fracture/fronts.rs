//! Crack fronts of a scene: points that have lost enough of their bonds, joined to the front they lie next to.
//!
//! A straight crack between two rows takes at most 11 of 28 bonds of a point (0.393) at a horizon ratio of 3.015, so a point
//! counts as cracked from a damage of 0.35 on. A front stands at the newly cracked point farthest from where it stood;
//! cracked points that lie near no front begin a new one.

use super::net::Net;
use super::outcome::PathPoint;
use crate::specimen::geometry::distance;
use crate::specimen::{Point, Specimen};

/// Damage from which a point is cracked.
pub const CRACKED: f64 = 0.35;
/// Distance in horizons within which a cracked point belongs to a front.
const REACH: f64 = 2.0;

/// Fronts on their way.
pub struct Fronts<'n> {
    net: &'n Net,
    cracked: Vec<bool>,
    places: Vec<Point>,
    /// Whether the points cracked at the start were taken down.
    begun: bool,
    /// What was taken down so far.
    pub path: Vec<PathPoint>,
}

impl<'n> Fronts<'n> {
    /// Fronts at the tips of the specimen.
    #[must_use]
    pub fn new(specimen: &Specimen, net: &'n Net) -> Self {
        let places: Vec<Point> = specimen.tips.iter().map(|tip| tip.position).collect();
        let start = |(tip, &position): (usize, &Point)| PathPoint { tip, step: 0, time: 0.0, position, damage: 0.0 };
        let path = places.iter().enumerate().map(start).collect();
        Fronts { net, cracked: vec![false; net.len()], places, begun: false, path }
    }

    /// Takes down where the fronts stand with this damage of the points.
    pub fn advance(&mut self, step: usize, time: f64, damage: &[f64]) {
        let new: Vec<usize> = (0..damage.len()).filter(|&i| damage[i] >= CRACKED && !self.cracked[i]).collect();
        new.iter().for_each(|&i| self.cracked[i] = true);
        if !std::mem::replace(&mut self.begun, true) {
            return;
        }
        let mut left = new;
        // A front may run through several points in one step: it takes what is near until nothing is.
        while !left.is_empty() {
            let mut moved = Vec::new();
            for tip in 0..self.places.len() {
                let at = self.places[tip];
                let near = |&&i: &&usize| distance(self.net.positions[i], at) <= REACH * self.net.horizons[i];
                let farthest = left.iter().filter(near).map(|&i| (distance(self.net.positions[i], at), i));
                let Some((_, i)) = farthest.max_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
                moved.push((tip, i));
                left.retain(|j| distance(self.net.positions[*j], at) > REACH * self.net.horizons[*j]);
            }
            if moved.is_empty() {
                let i = left[0];
                self.places.push(self.net.positions[i]);
                moved.push((self.places.len() - 1, i));
                left.remove(0);
            }
            for (tip, i) in moved {
                self.places[tip] = self.net.positions[i];
                self.path.push(PathPoint { tip, step, time, position: self.net.positions[i], damage: damage[i] });
            }
        }
    }
}
