//! Loads and supports of a scene on the points of its net.

use super::scene::{Action, Region, Scene};
use crate::error::{Result, input_missing};
use crate::net::Net;
use crate::specimen::geometry::bounding_box;
use crate::specimen::{Edge, Point};

/// Prescribed motion of one component of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Held {
    /// Point.
    pub point: u32,
    /// Component, 0 or 1.
    pub component: usize,
    /// What it does.
    pub motion: Motion,
}

/// A prescribed motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// This displacement at full load, m.
    Displacement(f64),
    /// This velocity, m/s.
    Velocity(f64),
}

/// Points of a load with its direction: what displacement and load of the history are taken from.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Points.
    pub points: Vec<u32>,
    /// Unit vector.
    pub direction: Point,
    /// Force of a traction at full load along the direction, N; `None` where the motion is prescribed.
    pub force: Option<f64>,
}

/// Loads and supports.
#[derive(Debug, Clone, PartialEq)]
pub struct Boundary {
    /// Prescribed components.
    pub held: Vec<Held>,
    /// Forces at full load, N.
    pub forces: Vec<(u32, Point)>,
    /// Loads, in the order of the scene.
    pub groups: Vec<Group>,
    /// Points near loads and supports, whose bonds never fail.
    pub no_fail: Vec<bool>,
    /// Time over which loads rise, s.
    pub ramp: f64,
}

impl Boundary {
    /// Loads and supports of a scene; platens act through the interaction, not here.
    ///
    /// # Errors
    /// A region without points.
    pub fn of(scene: &Scene, net: &Net) -> Result<Boundary> {
        let mut boundary = Boundary {
            held: Vec::new(),
            forces: net.forces.clone(),
            groups: Vec::new(),
            no_fail: vec![false; net.len()],
            ramp: scene.drives.iter().map(|drive| drive.ramp).fold(0.0, f64::max),
        };
        for (i, drive) in scene.drives.iter().enumerate() {
            let key = format!("loading, part {i}");
            let points = points_of(&drive.region, scene, net);
            if points.is_empty() {
                return Err(input_missing(&key, "takes hold of no point", "move the region onto the plate"));
            }
            let (direction, force) = match drive.action {
                Action::Traction(traction) => {
                    let size = traction[0].hypot(traction[1]);
                    let direction = traction.map(|t| t / size);
                    let own = |force: &&(u32, Point)| points.binary_search(&force.0).is_ok();
                    let along = |force: &(u32, Point)| force.1[0] * direction[0] + force.1[1] * direction[1];
                    (direction, Some(net.forces.iter().filter(own).map(along).sum()))
                }
                Action::Displacement(components) => (boundary.hold(&points, components, Motion::Displacement), None),
                Action::Velocity(components) => (boundary.hold(&points, components, Motion::Velocity), None),
                Action::Platen(motion) => {
                    let size = motion[0].hypot(motion[1]);
                    (motion.map(|m| m / size), None)
                }
            };
            boundary.groups.push(Group { points, direction, force });
        }
        for hold in &scene.holds {
            let points = points_of(&hold.region, scene, net);
            let components = hold.components.map(|held| held.then_some(0.0));
            boundary.hold(&points, components, Motion::Displacement);
        }
        let seats = boundary.held.iter().map(|held| held.point).chain(boundary.forces.iter().map(|force| force.0));
        for point in seats.collect::<Vec<_>>() {
            boundary.no_fail[point as usize] = true;
            for (_, other, _) in net.bonds_of(point as usize) {
                boundary.no_fail[other] = true;
            }
        }
        Ok(boundary)
    }

    /// Holds points in motion; returns the direction of it.
    fn hold(&mut self, points: &[u32], components: [Option<f64>; 2], motion: impl Fn(f64) -> Motion) -> Point {
        for (component, value) in components.iter().enumerate() {
            let Some(value) = value else { continue };
            self.held.extend(points.iter().map(|&point| Held { point, component, motion: motion(*value) }));
        }
        let vector = components.map(|value| value.unwrap_or(0.0));
        let size = vector[0].hypot(vector[1]);
        if size > 0.0 { vector.map(|v| v / size) } else { [0.0, 0.0] }
    }

    /// Share of the full load at a time, s.
    #[must_use]
    pub fn level(&self, time: f64) -> f64 {
        if time >= self.ramp { 1.0 } else { time / self.ramp }
    }

    /// Displacement and velocity of a prescribed motion at a time, m and m/s.
    #[must_use]
    pub fn motion_at(&self, motion: Motion, time: f64) -> (f64, f64) {
        let rising = time < self.ramp;
        match motion {
            Motion::Displacement(value) if rising => (value * time / self.ramp, value / self.ramp),
            Motion::Displacement(value) => (value, 0.0),
            Motion::Velocity(value) if rising => (0.5 * value * time * time / self.ramp, value * time / self.ramp),
            Motion::Velocity(value) => (value * (time - 0.5 * self.ramp), value),
        }
    }

    /// Displacement of the loads along their direction, summed, and their mean force; `pull` is what the points' bonds do to them.
    /// Where some loads are prescribed motions, given forces beside them do not count.
    #[must_use]
    pub fn measure(&self, unknowns: usize, level: f64, u: &[f64], pull: &[f64]) -> (f64, f64) {
        let (mut displacement, mut load) = (0.0, 0.0);
        let moving = |group: &&Group| group.direction != [0.0, 0.0];
        let driven = self.groups.iter().filter(moving).any(|group| group.force.is_none());
        let counted = || self.groups.iter().filter(moving).filter(|group| group.force.is_none() || !driven);
        for group in counted() {
            let along = |values: &[f64]| -> f64 {
                let at = |&p: &u32| p as usize * unknowns;
                group.points.iter().map(at).map(|i| values[i] * group.direction[0] + values[i + 1] * group.direction[1]).sum()
            };
            displacement += along(u) / group.points.len() as f64;
            // A driven point is held against the pull of its bonds.
            load += group.force.map_or_else(|| -along(pull), |force| level * force);
        }
        (displacement, load / counted().count().max(1) as f64)
    }
}

/// Points of a region, ascending.
fn points_of(region: &Region, scene: &Scene, net: &Net) -> Vec<u32> {
    let all = || net.positions.iter().enumerate();
    match *region {
        Region::Box { low, high } => {
            let inside = |p: &Point| (0..2).all(|i| p[i] >= low[i] && p[i] <= high[i]);
            all().filter(|(_, p)| inside(p)).map(|(i, _)| i as u32).collect()
        }
        Region::Edge { edge, depth, range } => {
            let [low, high] = bounding_box(&scene.specimen.outline);
            let axis = usize::from(matches!(edge, Edge::Top | Edge::Bottom));
            let far = matches!(edge, Edge::Top | Edge::Right);
            let away = |p: &Point| if far { high[axis] - p[axis] } else { p[axis] - low[axis] };
            let nearest = net.positions.iter().map(away).fold(f64::INFINITY, f64::min);
            // At least the outermost row; a quarter of a spacing is safe against round-off.
            let least = all().map(|(i, _)| net.spacings[i]).fold(f64::INFINITY, f64::min);
            let depth = depth.max(nearest + 0.25 * least);
            let along = |p: &Point| p[1 - axis] >= range[0] && p[1 - axis] <= range[1];
            all().filter(|(_, p)| away(p) < depth && along(p)).map(|(i, _)| i as u32).collect()
        }
    }
}
