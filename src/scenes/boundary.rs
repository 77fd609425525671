//! Loads and supports of a scene on the points of its net.

use super::bonds::BondState;
use super::points::build;
use super::scene::{Action, LoadRamp, Region, Scene};
use perilife_base::error::{Result, input};
use perilife_base::units::MM;
use perilife_plate::specimen::{Point, Support};
use perilife_points::net::Net;

/// Prescribed motion of one component of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Held {
    pub point: u32,
    /// Component, 0 or 1.
    pub component: usize,
    pub motion: Motion,
    /// How that rises in time.
    pub rise: LoadRamp,
}

impl Held {
    /// Displacement and velocity at a time, m and m/s.
    pub fn at(&self, time: f64) -> (f64, f64) {
        match self.motion {
            Motion::Displacement(value) => (value * self.rise.share(time), value * self.rise.slope(time)),
            Motion::Velocity(value) => (value * self.rise.sum(time), value * self.rise.share(time)),
        }
    }
}

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
    pub points: Vec<u32>,
    pub direction: Point,
    /// Force of a traction at full load along the direction, N; `None` where the motion is prescribed.
    pub force: Option<f64>,
    /// How the load rises in time.
    pub rise: LoadRamp,
}

/// Forces that rise together.
#[derive(Debug, Clone, PartialEq)]
pub struct Push {
    /// How they rise in time.
    pub rise: LoadRamp,
    /// Forces at full load, N.
    pub forces: Vec<(u32, Point)>,
}

/// Loads and supports.
#[derive(Debug, Clone, PartialEq)]
pub struct Boundary {
    pub held: Vec<Held>,
    /// All forces at full load, N.
    pub forces: Vec<(u32, Point)>,
    /// The same by how they rise in time.
    pub pushes: Vec<Push>,
    /// Loads, in the order of the scene.
    pub groups: Vec<Group>,
    /// Points near loads and supports, whose bonds never fail.
    pub no_fail: Vec<bool>,
}

impl Boundary {
    /// Loads and supports of a scene; platens act through the interaction, not here.
    /// Errors: a region without points; as [`build`] where tractions rise at different times.
    pub fn of(scene: &Scene, net: &Net) -> Result<Boundary> {
        let mut boundary = Boundary {
            held: Vec::new(),
            forces: net.forces.clone(),
            pushes: pushes(scene, net)?,
            groups: Vec::new(),
            no_fail: vec![false; net.len()],
        };
        for drive in &scene.drives {
            let points = points_of(&drive.region, &drive.key, scene, net)?;
            let rise = drive.rise;
            let (direction, force) = match drive.action {
                Action::Traction(traction) => {
                    let size = traction[0].hypot(traction[1]);
                    let direction = traction.map(|t| t / size);
                    let own = |force: &&(u32, Point)| points.binary_search(&force.0).is_ok();
                    let along = |force: &(u32, Point)| force.1[0] * direction[0] + force.1[1] * direction[1];
                    let pushes = boundary.pushes.iter().filter(|push| push.rise == rise);
                    (direction, Some(pushes.flat_map(|push| &push.forces).filter(own).map(along).sum()))
                }
                Action::Displacement(components) => (boundary.hold(&points, components, Motion::Displacement, rise), None),
                Action::Velocity(components) => (boundary.hold(&points, components, Motion::Velocity, rise), None),
                Action::Platen(motion) => {
                    let size = motion[0].hypot(motion[1]);
                    (motion.map(|m| m / size), None)
                }
            };
            boundary.groups.push(Group { points, direction, force, rise });
        }
        for hold in &scene.holds {
            let points = points_of(&hold.region, &hold.key, scene, net)?;
            let components = hold.components.map(|held| held.then_some(0.0));
            boundary.hold(&points, components, Motion::Displacement, LoadRamp::AT_ONCE);
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
    fn hold(&mut self, points: &[u32], components: [Option<f64>; 2], motion: impl Fn(f64) -> Motion, rise: LoadRamp) -> Point {
        for (component, value) in components.iter().enumerate() {
            let Some(value) = value else { continue };
            // Overlapping loads may tell a point the same motion; its work counts once.
            let known: std::collections::HashSet<u32> =
                self.held.iter().filter(|held| held.component == component).map(|held| held.point).collect();
            let new = points.iter().filter(|point| !known.contains(point));
            self.held.extend(new.map(|&point| Held { point, component, motion: motion(*value), rise }));
        }
        let vector = components.map(|value| value.unwrap_or(0.0));
        let size = vector[0].hypot(vector[1]);
        if size > 0.0 { vector.map(|v| v / size) } else { [0.0, 0.0] }
    }

    /// [`measured`](Self::measured) where all loads have grown in proportion to a share of the full one.
    pub fn measure(&self, unknowns: usize, level: f64, u: &[f64], pull: &[f64]) -> (f64, f64) {
        self.measured(unknowns, |_| level, u, pull)
    }

    /// Displacement of the loads along their direction, summed, and their mean force at the `level` of each group, in m and N; `pull` is what
    /// the points' bonds do to them. Where some loads are prescribed motions, given forces beside them do not count.
    pub fn measured(&self, unknowns: usize, level: impl Fn(&Group) -> f64, u: &[f64], pull: &[f64]) -> (f64, f64) {
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
            load += group.force.map_or_else(|| -along(pull), |force| level(group) * force);
        }
        (displacement, load / counted().count().max(1) as f64)
    }

    /// Whether no way of intact bonds leads from the first load to some other load or support.
    pub fn is_separated(&self, net: &Net, bonds: &BondState) -> bool {
        let Some(&start) = self.groups.first().and_then(|group| group.points.first()) else { return false };
        let mut reached = vec![false; net.len()];
        let mut open = vec![start as usize];
        reached[start as usize] = true;
        while let Some(point) = open.pop() {
            for (b, other, _) in net.bonds_of(point) {
                if bonds.share[b] > 0.0 && !reached[other] {
                    reached[other] = true;
                    open.push(other);
                }
            }
        }
        let others = self.groups.iter().flat_map(|group| &group.points).chain(self.held.iter().map(|held| &held.point));
        others.into_iter().any(|&point| !reached[point as usize])
    }
}

/// Forces of the tractions by how they rise. Forces of one rise are those of the net; those of several are found by putting the
/// loads of each on the plate alone.
fn pushes(scene: &Scene, net: &Net) -> Result<Vec<Push>> {
    let tractions = || scene.drives.iter().filter(|drive| matches!(drive.action, Action::Traction(_)));
    let mut rises: Vec<LoadRamp> = Vec::new();
    for drive in tractions() {
        if !rises.contains(&drive.rise) {
            rises.push(drive.rise);
        }
    }
    if let [] | [_] = rises[..] {
        return Ok(vec![Push { rise: rises.first().copied().unwrap_or(LoadRamp::AT_ONCE), forces: net.forces.clone() }]);
    }
    let of_rise = |rise: LoadRamp| {
        let mut alone = scene.clone();
        alone.specimen.loads =
            tractions().filter(|drive| drive.rise == rise).flat_map(|drive| drive.loads(&scene.specimen)).collect();
        // Some of the loads need not balance by themselves.
        alone.specimen.supports = vec![Support::Elsewhere];
        Ok(Push { rise, forces: build(&alone)?.0.forces })
    };
    rises.into_iter().map(of_rise).collect()
}

/// Points of a region, ascending.
/// Errors: a region without points; `key` names it.
fn points_of(region: &Region, key: &str, scene: &Scene, net: &Net) -> Result<Vec<u32>> {
    let points = region.points(net, &scene.specimen);
    if points.is_empty() {
        let spacing = (scene.model.spacing / MM * 1e4).round() / 1e4;
        let problem = format!("contains no point (spacing {spacing} mm)");
        let remedy = "make it wider than that, move it onto a row of points, or reduce model.spacing_mm";
        return Err(input(key, region, problem, remedy));
    }
    Ok(points)
}
