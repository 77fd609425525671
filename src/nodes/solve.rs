//! Equilibrium of a plate of nodes, and its displacement and stress on an even raster for pictures.

use rayon::prelude::*;

use super::assembly::{Scratch, add_cell, dilatation};
use super::boundary::{Boundary, Square, UNKNOWNS_OF_GRIP, press_cracks};
use super::cells::{QuadraturePoint, quadrature};
use super::contact::{Pressed, press};
use super::dissection::{Factor, Matrices, Member};
use super::field::{Discretisation, Local};
use super::front::Front;
use super::pins::press_pins;
use perilife_base::error::Result;
use perilife_base::raster::PointGrid;
use perilife_base::watch::{self, Stage};
use perilife_plate::loading::residual::ResidualStress;
use perilife_plate::material::Plane;
use perilife_plate::specimen::geometry::bounding_box;
use perilife_plate::specimen::pin::Contact;
use perilife_plate::specimen::{Point, Specimen};
use perilife_plate::williams::Elasticity;

/// Displacement of a plate under its loads.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Unknowns, m.
    pub u: Vec<f64>,
    /// Work of the loads `Σ f u`, J; of elastic pins what their contact says (`pins.rs`).
    pub work: f64,
    /// Points of integration.
    pub points: usize,
    /// Area of them, m².
    pub area: f64,
    /// Flanks of cracks in contact.
    pub pressed: Vec<Pressed>,
    /// Contact of elastic pins, with the index of the load.
    pub contacts: Vec<(usize, Contact)>,
    /// Unknowns under what a residual stress releases on the cracks alone, flanks free, m; nothing where there is none.
    pub of_residual: Vec<f64>,
}

impl Solution {
    /// Pressure of flanks in contact at a place of a crack, Pa.
    pub fn pressure_at(&self, at: Point) -> f64 {
        self.pressed.iter().find(|pressed| pressed.is_on(at)).map_or(0.0, |pressed| pressed.pressure)
    }

    /// Whether flanks are in contact up to a tip.
    pub fn is_closed(&self, tip: Point) -> bool {
        self.pressed.iter().any(|pressed| pressed.ends_at(tip))
    }
}

/// The matrices of a plate: those of cells, then those of supports.
struct Stiffness<'a> {
    plate: &'a Discretisation,
    thickness: f64,
    cells: &'a [(usize, Vec<QuadraturePoint>)],
    held: &'a [Square],
    /// First unknown of every node, and of every grip after them.
    first: &'a [u32],
}

impl Stiffness<'_> {
    fn members(&self) -> Vec<Member> {
        let of_cell = |(leaf, points): &(usize, Vec<QuadraturePoint>)| {
            let bounds = |of: fn(f64, f64) -> f64, from: f64| [0, 1].map(|i| points.iter().map(|p| p.at[i]).fold(from, of));
            let box_of_points = [bounds(f64::min, f64::INFINITY), bounds(f64::max, f64::NEG_INFINITY)];
            Member { at: self.plate.grid.middle(*leaf), nodes: self.plate.in_reach(*leaf, box_of_points) }
        };
        let of_support = |square: &Square| {
            let mut nodes: Vec<u32> = square.unknowns.iter().map(|unknown| self.node(*unknown)).collect();
            nodes.dedup();
            let at = &self.plate.nodes.at;
            Member { at: *at.get(nodes[0] as usize).unwrap_or(&at[0]), nodes }
        };
        let mut members: Vec<Member> = self.cells.par_iter().map(of_cell).collect();
        members.extend(self.held.iter().map(of_support));
        members
    }

    /// Node, or grip, that an unknown belongs to.
    fn node(&self, unknown: u32) -> u32 {
        self.first.partition_point(|first| *first <= unknown) as u32 - 1
    }
}

impl Matrices for Stiffness<'_> {
    fn add(&self, members: &[u32], places: &[u32], front: &mut Front) -> Result<()> {
        let mut scratch = Scratch::of(self.plate.nodes.at.len());
        for &member in members {
            let member = member as usize;
            if let Some((leaf, points)) = self.cells.get(member) {
                add_cell(self.plate, self.thickness, (*leaf, points), &mut scratch, places, front)?;
                continue;
            }
            let Square { unknowns, v, factor, .. } = &self.held[member - self.cells.len()];
            let place = |unknown: u32| {
                let node = self.node(unknown) as usize;
                (places[node] + unknown - self.first[node]) as usize
            };
            for (k, &a) in unknowns.iter().enumerate() {
                unknowns[..=k].iter().zip(v).for_each(|(&b, of_b)| front.add(place(a), place(b), factor * v[k] * of_b));
            }
        }
        Ok(())
    }
}

/// Solves `K u = f` at the nominal load `load`, Pa or N, by a Cholesky factor.
/// Errors: [`perilife_base::error::Error::LossOfStiffness`] where some part moves freely; nodes in reach of a point that do not span the basis;
/// the work was asked to end.
pub fn solve(specimen: &Specimen, plate: &Discretisation, far: f64, load: f64) -> Result<Solution> {
    solve_with(specimen, plate, far, load, None)
}

/// As [`solve`], with what a residual stress releases on the cracks: a second right-hand side of the same factor.
pub fn solve_with(
    specimen: &Specimen,
    plate: &Discretisation,
    far: f64,
    load: f64,
    residual: Option<&ResidualStress>,
) -> Result<Solution> {
    watch::at(Stage::Equilibrium, 0.0)?;
    let cells = quadrature(specimen, plate);
    plate.with_dilatation(|| dilatation(plate, &cells));
    let Boundary { mut forces, held, of_grips } = Boundary::new(specimen, plate, far)?;
    let grips = (plate.unknowns()..plate.unknowns() + of_grips).step_by(UNKNOWNS_OF_GRIP);
    let first: Vec<u32> = plate.first.iter().copied().chain(grips.map(|first| (first + UNKNOWNS_OF_GRIP) as u32)).collect();
    let stiffness = Stiffness { plate, thickness: specimen.thickness, cells: &cells, held: &held, first: &first };
    let factor = Factor::of(&stiffness.members(), &first, &stiffness)?;
    let section = specimen.moved_section();
    if section.is_none() {
        forces.iter_mut().for_each(|force| *force *= load);
    }
    let mut others = forces.clone();
    let pins = press_pins(specimen, plate, &factor, &others, load)?;
    if let Some(pins) = &pins {
        forces.iter_mut().zip(&pins.forces).for_each(|(force, of_pins)| *force += of_pins);
    }
    let mut y = forces;
    factor.forward(&mut y);
    let mut of_residual = Vec::new();
    if let Some(residual) = residual {
        of_residual = vec![0.0; y.len()];
        press_cracks(&mut of_residual, specimen, plate, &|at| residual.at(at))?;
        others.iter_mut().zip(&of_residual).for_each(|(force, released)| *force += released);
        factor.forward(&mut of_residual);
        y.iter_mut().zip(&of_residual).for_each(|(y, released)| *y += released);
        factor.backward(&mut of_residual);
    }
    let mut u = y.clone();
    factor.backward(&mut u);
    let mut pressed = press(specimen, plate, &factor, &y, &mut u)?;
    let work = match section {
        None => others.iter().zip(&u).map(|(f, u)| f * u).sum::<f64>() + pins.as_ref().map_or(0.0, |pins| pins.work),
        // Moved by 1 m, then scaled to the force of the load: contact of flanks changes with it in proportion.
        Some(section) => {
            let scale = load * section / held.iter().map(|square| square.reaction(&u)).sum::<f64>();
            u.iter_mut().for_each(|u| *u *= scale);
            pressed.iter_mut().for_each(|pressed| pressed.pressure *= scale);
            load * section * scale
        }
    };
    let points = cells.iter().map(|(_, points)| points.len()).sum();
    let area = cells.iter().flat_map(|(_, points)| points).map(|point| point.area).sum();
    let contacts = pins.map_or_else(Vec::new, |pins| pins.contacts);
    Ok(Solution { u, work, points, area, pressed, contacts, of_residual })
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
    /// τ_xy.
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
