//! Equilibrium of a plate of nodes, and its displacement and stress on an even raster for pictures.

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use super::assembly::{Scratch, add_cell, dilatation};
use super::boundary::{Boundary, Square, press_cracks};
use super::cells::{QuadraturePoint, quadrature};
use super::contact::{Flanks, Pressed, press};
use super::dilatation::split;
use super::dissection::{Factor, Matrices, Member};
use super::field::{Discretisation, Local};
use super::front::FrontalMatrix;
use super::part::Part;
use super::pins::PinColumns;
use perilife_base::error::Result;
use perilife_base::raster::PointGrid;
use perilife_base::watch::{self, Stage};
use perilife_plate::loading::residual::ResidualStress;
use perilife_plate::material::Plane;
use perilife_plate::specimen::geometry::bounding_box;
use perilife_plate::specimen::pin::Contact;
use perilife_plate::specimen::{Load, Point, Specimen};
use perilife_plate::williams::Elasticity;

/// A plate in equilibrium with a load.
#[derive(Debug, Clone)]
pub struct Loaded {
    /// The load over the nominal one.
    pub share: f64,
    /// Unknowns, m.
    pub u: Vec<f64>,
    /// Work of the loads `Σ f u`, J; of elastic pins what their contact says (`pins.rs`).
    pub work: f64,
    /// Flanks of cracks in contact.
    pub pressed: Vec<Pressed>,
    /// Unknowns with free flanks, m; nothing where none are in contact.
    pub free: Vec<f64>,
    /// Contact of elastic pins, with the index of the load.
    pub contacts: Vec<(usize, Contact)>,
}

impl Loaded {
    /// Pressure of flanks in contact at a place of a crack, Pa.
    pub fn pressure_at(&self, at: Point) -> f64 {
        self.pressed.iter().find(|pressed| pressed.is_on(at)).map_or(0.0, |pressed| pressed.pressure)
    }

    /// Whether flanks are in contact up to a tip.
    pub fn is_closed(&self, tip: Point) -> bool {
        self.pressed.iter().any(|pressed| pressed.ends_at(tip))
    }
}

/// A plate under its loads.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Under the nominal load.
    pub whole: Loaded,
    /// Under lower loads, ascending, where it does not follow the load in proportion.
    pub lower: Vec<Loaded>,
    /// Area of the points of integration, m².
    pub area: f64,
    /// Parts of the plate of which one was solved for: one of a plate that is not its own image.
    pub parts: usize,
}

/// The matrices of a plate: those of cells, then those of supports.
struct Stiffness<'a> {
    plate: &'a Discretisation,
    thickness: f64,
    cells: &'a [(usize, Vec<QuadraturePoint>)],
    part: &'a Part,
    /// Of threads that are done with theirs.
    scratch: Mutex<Vec<Scratch>>,
}

impl Stiffness<'_> {
    fn members(&self) -> Vec<Member> {
        let of_cell = |(leaf, points): &(usize, Vec<QuadraturePoint>)| {
            let bounds = |of: fn(f64, f64) -> f64, from: f64| [0, 1].map(|i| points.iter().map(|p| p.at[i]).fold(from, of));
            let box_of_points = [bounds(f64::min, f64::INFINITY), bounds(f64::max, f64::NEG_INFINITY)];
            let mut nodes = self.plate.in_reach(*leaf, box_of_points);
            nodes.iter_mut().for_each(|node| *node = self.part.node(*node));
            nodes.sort_unstable();
            nodes.dedup();
            Member { at: self.plate.grid.middle(*leaf), nodes }
        };
        let of_support = |square: &Square| {
            let mut nodes: Vec<u32> = square.unknowns.iter().map(|unknown| self.node(*unknown)).collect();
            nodes.dedup();
            let at = &self.plate.nodes.at;
            Member { at: *at.get(nodes[0] as usize).unwrap_or(&at[0]), nodes }
        };
        let mut members: Vec<Member> = self.cells.par_iter().map(of_cell).collect();
        members.extend(self.part.held.iter().map(of_support));
        members
    }

    /// Node, or grip, that an unknown belongs to.
    fn node(&self, unknown: u32) -> u32 {
        self.part.first.partition_point(|first| *first <= unknown) as u32 - 1
    }
}

impl Matrices for Stiffness<'_> {
    fn add(&self, members: &[u32], places: &[u32], front: &mut FrontalMatrix) -> Result<()> {
        let all = || self.scratch.lock().unwrap_or_else(PoisonError::into_inner);
        let spare = all().pop();
        let mut scratch = spare.unwrap_or_else(|| Scratch::of(self.plate.nodes.at.len()));
        for &member in members {
            let member = member as usize;
            if let Some((leaf, points)) = self.cells.get(member) {
                add_cell(self.plate, (self.part, self.thickness), (*leaf, points), &mut scratch, places, front)?;
                continue;
            }
            let Square { unknowns, v, factor, .. } = &self.part.held[member - self.cells.len()];
            let place = |unknown: u32| {
                let node = self.node(unknown) as usize;
                (places[node] + unknown - self.part.first[node]) as usize
            };
            for (k, &a) in unknowns.iter().enumerate() {
                unknowns[..=k].iter().zip(v).for_each(|(&b, of_b)| front.add(place(a), place(b), factor * v[k] * of_b));
            }
        }
        all().push(scratch);
        Ok(())
    }
}

/// Solves `K u = f` at the nominal load `load`, Pa or N, by a Cholesky factor.
/// Errors: [`perilife_base::error::Error::LossOfStiffness`] where some part moves freely; nodes in reach of a point that do not span the basis;
/// the work was asked to end.
pub fn solve(specimen: &Specimen, plate: &Discretisation, far: f64, load: f64) -> Result<Loaded> {
    Ok(solve_with(specimen, plate, far, load, (None, &[]))?.whole)
}

/// As [`solve`], with what a residual stress releases on the cracks, and under these lower loads over the nominal one, ascending, as far as the
/// plate does not follow the load in proportion: more right-hand sides of the same factor.
pub fn solve_with(
    specimen: &Specimen,
    plate: &Discretisation,
    far: f64,
    load: f64,
    (residual, lower): (Option<&ResidualStress>, &[f64]),
) -> Result<Solution> {
    watch::at(Stage::Equilibrium, 0.0)?;
    let mut boundary = Boundary::new(specimen, plate, far)?;
    if specimen.moved_section().is_none() {
        boundary.forces.iter_mut().for_each(|force| *force *= load);
    }
    let mut released = vec![0.0; boundary.forces.len()];
    if let Some(residual) = residual {
        press_cracks(&mut released, specimen, plate, &|at| residual.at(at))?;
    }
    let flanks = Flanks::of(specimen, plate);
    // Pins touch where they may; means of dilatation are of cells.
    let is_whole = specimen.loads.iter().any(Load::is_elastic_pin) || split(plate.elasticity()).1[1] > 0.0;
    let part = Part::of((specimen, plate), &boundary, [&boundary.forces, &released], &flanks.ends(), is_whole);
    let cells = quadrature(specimen, plate, &part.cells);
    plate.with_dilatation(|| dilatation(plate, &cells));
    let stiffness = Stiffness { plate, thickness: specimen.thickness, cells: &cells, part: &part, scratch: Mutex::default() };
    let factor = Factor::of(&stiffness.members(), &part.first, &stiffness)?;
    let pins = PinColumns::new(specimen, plate, &factor, boundary.forces.len())?;
    let flanks = flanks.of_part(&part);
    let balance =
        Balance { specimen, load, boundary: &boundary, released: &released, factor: &factor, part: &part, flanks, pins };
    let whole = balance.at(1.0)?;
    let lower = if residual.is_some() || balance.pins.is_some() || !whole.pressed.is_empty() {
        balance.lower(&whole, residual.is_some(), lower)?
    } else {
        Vec::new()
    };
    let area: f64 = cells.iter().flat_map(|(_, points)| points).map(|point| point.area).sum();
    Ok(Solution { whole, lower, area: part.parts() as f64 * area, parts: part.parts() })
}

/// Turns in which pins and flanks settle on each other at the most, and the change of the forces of flanks, over the largest, that is none.
const COUPLED_MOST: usize = 20;
const COUPLED: f64 = 1e-3;

/// The equilibrium of a plate whose stiffness is factored.
struct Balance<'a> {
    specimen: &'a Specimen,
    /// Pa or N.
    load: f64,
    /// Supports, and forces of the nominal load but for elastic pins, N; of a displacement those that move its places by 1 m.
    boundary: &'a Boundary,
    /// What the residual stress releases on the cracks, N.
    released: &'a [f64],
    factor: &'a Factor,
    part: &'a Part,
    flanks: Flanks,
    pins: Option<PinColumns<'a>>,
}

impl Balance<'_> {
    /// Under a share of the nominal load.
    fn at(&self, share: f64) -> Result<Loaded> {
        let Balance { specimen, load, boundary, released, factor, part, .. } = *self;
        let section = specimen.moved_section();
        let size = if section.is_some() { share.signum() } else { share };
        let others: Vec<f64> = boundary.forces.iter().zip(released).map(|(force, released)| size * force + released).collect();
        // Without load there are no pins.
        let columns = self.pins.as_ref().filter(|_| share > 0.0);
        let (mut beside, mut of_flanks) = (others.clone(), Vec::new());
        let mut turns = if columns.is_some() { COUPLED_MOST } else { 1 };
        let (mut u, mut contact, pins) = loop {
            let pins = columns.map(|columns| columns.press(&beside, share * load)).transpose()?;
            let mut y = others.clone();
            if let Some(pins) = &pins {
                y.iter_mut().zip(&pins.forces).for_each(|(y, of_pins)| *y += of_pins);
            }
            y = part.forces(&y);
            factor.forward(&mut y);
            let mut u = y.clone();
            factor.backward(&mut u);
            let contact = press(&self.flanks, factor, &y, &u)?;
            // Flanks that a pin presses together bear on it in turn.
            let forces = contact.as_ref().map_or_else(Vec::new, |contact| contact.forces.clone());
            let change =
                forces.iter().zip(&of_flanks).map(|(now, before): (&f64, &f64)| (now - before).abs()).fold(0.0, f64::max);
            let largest = forces.iter().map(|force| force.abs()).fold(0.0, f64::max);
            turns -= 1;
            if turns == 0 || forces.len() == of_flanks.len() && change <= COUPLED * largest {
                break (u, contact, pins);
            }
            beside = others.clone();
            beside.iter_mut().zip(&forces).for_each(|(other, of_flank)| *other += of_flank);
            of_flanks = forces;
        };
        let mut free = Vec::new();
        if let Some(contact) = &mut contact {
            free = part.whole(&std::mem::replace(&mut u, std::mem::take(&mut contact.u)));
        }
        u = part.whole(&u);
        let images = |own: Pressed| part.orbit(own.ends).into_iter().map(move |ends| Pressed { ends, ..own });
        let mut pressed: Vec<Pressed> =
            contact.map_or_else(Vec::new, |contact| contact.pressed).into_iter().flat_map(images).collect();
        let work = match section {
            None => others.iter().zip(&u).map(|(f, u)| f * u).sum::<f64>() + pins.as_ref().map_or(0.0, |pins| pins.work),
            // Moved by 1 m, then scaled to the force of the load: contact of flanks changes with it in proportion.
            Some(section) => {
                let reactions = boundary.held.iter().map(|square| square.reaction(&u)).sum::<f64>();
                let scale = share * load * section / reactions;
                u.iter_mut().chain(&mut free).for_each(|u| *u *= scale);
                pressed.iter_mut().for_each(|pressed| pressed.pressure *= scale);
                share.abs() * load * section * scale
            }
        };
        // Of lower loads nobody asks.
        let asked = columns.zip(pins).filter(|_| share == 1.0);
        let contacts = asked.map_or_else(Vec::new, |(columns, pins)| pins.contacts(columns, &u));
        Ok(Loaded { share, u, work, pressed, free, contacts })
    }

    /// Under lower loads, ascending, if it does not follow the load in proportion.
    fn lower(&self, whole: &Loaded, has_residual: bool, loads: &[f64]) -> Result<Vec<Loaded>> {
        let has_pins = !whole.contacts.is_empty();
        // A pin bears no pull; flanks alone are in contact as they are at every load of the same sign.
        let mut asked: Vec<f64> = loads.iter().map(|load| if has_pins { load.max(0.0) } else { *load }).collect();
        asked.dedup();
        asked.retain(|load| has_pins || has_residual || *load < 0.0);
        let Some(least) = asked.first().map(|load| self.at(*load)).transpose()? else { return Ok(Vec::new()) };
        let bends = has_pins || has_residual && !(whole.pressed.is_empty() && least.pressed.is_empty());
        let mut lower = vec![least];
        for load in asked.into_iter().skip(1).filter(|_| bends) {
            lower.push(self.at(load)?);
        }
        Ok(lower)
    }
}

/// Points of the raster in a far spacing: a dozen rasters of a run then have fewer places than its solves have points of integration.
const IN_SPACING: f64 = 4.0;

/// The raster of a plate whose nodes have the spacing `far`, m, away from everything.
pub fn raster(specimen: &Specimen, far: f64) -> PointGrid {
    let [low, high] = bounding_box(&specimen.outline);
    let spacing = far / IN_SPACING;
    let [columns, rows] = [0, 1].map(|i| ((high[i] - low[i]) / spacing).round().max(1.0) as usize);
    let spacing = ((high[0] - low[0]) / columns as f64).max((high[1] - low[1]) / rows as f64);
    let origin = [low[0] + 0.5 * spacing, low[1] + 0.5 * spacing];
    let mut next = 0;
    let mut point_at = Vec::with_capacity(columns * rows);
    for row in 0..rows {
        for column in 0..columns {
            let at = [origin[0] + column as f64 * spacing, origin[1] + row as f64 * spacing];
            let is_inside = specimen.contains(at);
            point_at.push(is_inside.then_some(next));
            next += u32::from(is_inside);
        }
    }
    PointGrid { spacing, columns, rows, origin, angle: 0.0, point_at }
}

/// Stress at a point, Pa.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stress {
    /// σ_x.
    pub x: f64,
    /// σ_y.
    pub y: f64,
    pub xy: f64,
    /// σ_z: 0 in plane stress, ν (σ_x + σ_y) in plane strain.
    pub across: f64,
}

impl Stress {
    /// Of a gradient of displacement ∂u_i/∂x_j.
    pub fn of(elasticity: Elasticity, plane: Plane, gradient: &[[f64; 2]; 2]) -> Self {
        let [x, y, xy] = elasticity.stress(gradient);
        // κ = 3 - 4ν in plane strain.
        let across = if plane == Plane::Strain { 0.25 * (3.0 - elasticity.kappa) * (x + y) } else { 0.0 };
        Stress { x, y, xy, across }
    }

    /// A multiple of it.
    pub fn times(self, share: f64) -> Self {
        let Stress { x, y, xy, across } = self;
        Stress { x: share * x, y: share * y, xy: share * xy, across: share * across }
    }

    /// That of von Mises, `√(½[(σ_x-σ_y)² + (σ_y-σ_z)² + (σ_z-σ_x)²] + 3 τ_xy²)`.
    pub fn von_mises(&self) -> f64 {
        let Stress { x, y, xy, across } = *self;
        (0.5 * ((x - y).powi(2) + (y - across).powi(2) + (across - x).powi(2)) + 3.0 * xy * xy).sqrt()
    }
}

/// Displacement, m, and von Mises stress, Pa, of the points of the raster, times `share`.
pub fn raster_fields(
    specimen: &Specimen,
    plate: &Discretisation,
    u: &[f64],
    far: f64,
    plane: Plane,
    share: f64,
) -> (Vec<Point>, Vec<f64>) {
    let PointGrid { spacing, columns, origin, point_at, .. } = raster(specimen, far);
    let at = |place: usize| [origin[0] + (place % columns) as f64 * spacing, origin[1] + (place / columns) as f64 * spacing];
    let places: Vec<usize> = (0..point_at.len()).filter(|&place| point_at[place].is_some()).collect();
    let of_place = |local: &mut Local, &place: &usize| {
        let Some((u, gradient)) = plate.displacement(u, at(place), local) else { return ([0.0; 2], 0.0) };
        (u.map(|u| share * u), share * Stress::of(plate.elasticity(), plane, &gradient).von_mises())
    };
    places.par_iter().map_init(Local::default, of_place).unzip()
}
