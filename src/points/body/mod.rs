//! The specimen as points and bonds: everything about the discretised plate that a run does not change.
//!
//! A bond is owned by its lower point and named by `bond = k x places + place`, k counting the stencil.
//! Its stiffness is the spring of the stencil times a multiplier: 0 absent, 1 inside the body, other values where a
//! surface correction acts.

pub mod balanced;
pub mod boundary;
mod block_cholesky;
mod couples;
pub mod lattice;
pub mod mirror;
pub mod obstacles;
pub mod pre_crack;
pub mod severed;
pub mod sharing;
pub mod surface_correction;

use crate::bond_law::stencil::{Stencil, spring_material};
use crate::bond_law::{BondLaw, SurfaceCorrection};
use boundary::Boundary;
use lattice::Lattice;
use mirror::{Flips, Mirror};
use obstacles::Obstacles;
use perilife_base::error::{Error, Result};
use perilife_base::raster::PointGrid;
use perilife_base::watch::{self, Stage};
use perilife_plate::loading::pieces::load_pieces;
use perilife_plate::material::Material;
use perilife_plate::specimen::facets::facets;
use perilife_plate::specimen::{Point, Specimen};
use sharing::Sharing;

/// A bond: `k x places + place` of its owner.
pub type Bond = u32;

/// A discretised plate.
#[derive(Debug, Clone)]
pub struct Body {
    pub lattice: Lattice,
    /// Bonds of a point and their springs.
    pub stencil: Stencil,
    /// Memory distance of every stencil bond.
    pub steps: Vec<isize>,
    /// Memory index of every point, row by row.
    pub points: Vec<u32>,
    /// Whether a place holds a point.
    pub is_point: Vec<bool>,
    /// Stiffness multiplier of every bond of the uncracked plate.
    pub multiplier: Vec<f32>,
    /// Bonds that the initial cracks cut.
    pub pre_cut: Vec<Bond>,
    /// Places whose bonds never fail: near loads and supports.
    pub no_fail: Vec<bool>,
    /// Loads and supports.
    pub boundary: Boundary,
    /// Number of bonds of the uncracked plate.
    pub bond_count: usize,
    /// Thickness, m.
    pub thickness: f64,
    /// Lines of symmetry at which it ends, if it is part of a plate.
    pub mirror: Mirror,
}

impl Body {
    /// The raster of its lattice.
    #[inline]
    pub fn grid(&self) -> PointGrid {
        let mut point_at = vec![None; self.lattice.columns * self.lattice.rows];
        for (i, &place) in self.points.iter().enumerate() {
            let (column, row) = self.lattice.column_row(place as usize);
            point_at[row * self.lattice.columns + column] = Some(i as u32);
        }
        self.lattice.grid(point_at)
    }

    /// Discretises a specimen.
    /// Errors: Poisson's ratio outside the law's range, a spacing that does not suit the plate, more bonds than fit.
    pub fn build(
        specimen: &Specimen,
        material: &Material,
        law: &BondLaw,
        spacing: f64,
        horizon_ratio: f64,
        angle: f64,
    ) -> Result<Body> {
        let padding = horizon_ratio.floor() as usize;
        let lattice = Lattice::over(specimen, spacing, angle, padding)?;
        let stencil = Stencil::new(law, material, lattice.spacing, horizon_ratio, specimen.thickness)?;
        let places = lattice.places();
        if places.saturating_mul(stencil.bonds.len()) > u32::MAX as usize {
            return Err(Error::Mechanics(format!(
                "{places} lattice positions with {} bonds each exceed the limit; increase the spacing",
                stencil.bonds.len()
            )));
        }
        let mut is_point = vec![false; places];
        let mut points = Vec::new();
        for row in 0..lattice.rows {
            watch::at(Stage::Points, row as f64 / lattice.rows as f64)?;
            for column in 0..lattice.columns {
                if specimen.has_point_at(lattice.position_of(column as f64, row as f64), lattice::ON_RIM * lattice.spacing) {
                    let place = lattice.place(column, row);
                    is_point[place] = true;
                    points.push(place as u32);
                }
            }
        }
        let steps: Vec<isize> = stencil.bonds.iter().map(|bond| lattice.step(bond.dx, bond.dy)).collect();
        let multiplier = uncut_bonds(specimen, &lattice, &stencil, &steps, &is_point, &points)?;
        let bond_count = multiplier.iter().filter(|&&m| m > 0.0).count();
        // The sharing reads the lattice beside the body that takes it over.
        let (grid, occupied) = (lattice.clone(), is_point.clone());
        let sharing = match law.surface_correction {
            SurfaceCorrection::Balanced => {
                let obstacles = Obstacles::of(specimen, lattice.spacing, stencil.horizon);
                Sharing::consistent(&grid, &occupied, obstacles, balanced::load_rows(&stencil))
            }
            SurfaceCorrection::None | SurfaceCorrection::VolumeAndSurface => Sharing::nearest(&grid, &occupied),
        };
        watch::at(Stage::Loads, 0.0)?;
        let boundary = Boundary::of(specimen, &lattice, &stencil, &sharing, &points)?;
        let no_fail = boundary.no_fail(&lattice, stencil.horizon);
        let mut body = Body {
            lattice,
            stencil,
            steps,
            points,
            is_point,
            multiplier,
            pre_cut: Vec::new(),
            no_fail,
            boundary,
            bond_count,
            thickness: specimen.thickness,
            mirror: Mirror::default(),
        };
        watch::at(Stage::Rim, 0.0)?;
        match law.surface_correction {
            SurfaceCorrection::None => {}
            SurfaceCorrection::VolumeAndSurface => {
                surface_correction::volume_and_surface(&mut body, &spring_material(law, material))
            }
            SurfaceCorrection::Balanced => {
                let rim = facets(specimen, body.lattice.spacing);
                balanced::balance(&mut body, &rim, &sharing)?;
                if body.stencil.unknowns == 3 {
                    let loads = load_pieces(specimen, body.lattice.spacing);
                    body.boundary.couples = couples::couples(&body, material, &rim, &loads);
                }
            }
        }
        watch::at(Stage::Loads, 0.5)?;
        body.boundary.balance(&body.lattice)?;
        body.boundary.stiffen_grips(&body.lattice, &body.steps, &mut body.multiplier);
        body.pre_cut = pre_crack::bonds_cut_by(&body, specimen);
        Ok(body)
    }

    /// Number of lattice places, padding included.
    #[inline]
    pub fn places(&self) -> usize {
        self.is_point.len()
    }

    /// Horizon δ, m.
    #[inline]
    pub fn horizon(&self) -> f64 {
        self.stencil.horizon
    }

    /// Stencil entry, owner and partner of a bond.
    #[inline]
    pub fn ends(&self, bond: Bond) -> (usize, usize, usize) {
        let (k, place) = (bond as usize / self.places(), bond as usize % self.places());
        (k, place, place.wrapping_add_signed(self.steps[k]))
    }

    /// Both bonds of a place along every entry of the stencil, whether they carry or not: which entry, +1 of the owner and -1 of the other
    /// end, the bond, the opposite end.
    #[inline]
    pub fn around(&self, place: usize) -> impl Iterator<Item = (usize, f64, usize, usize)> + '_ {
        let places = self.places();
        self.steps.iter().enumerate().flat_map(move |(k, &step)| {
            let behind = place.wrapping_add_signed(-step);
            [(k, 1.0, k * places + place, place.wrapping_add_signed(step)), (k, -1.0, k * places + behind, behind)]
        })
    }

    /// The point behind a place: itself, or that whose mirror image it is, and how it is mirrored.
    #[inline]
    pub fn behind(&self, place: usize) -> (usize, Flips) {
        self.mirror.behind(&self.lattice, place)
    }

    /// Rigid motions that cost nothing: along the rows, along the columns, turning.
    #[inline]
    pub fn free_motion(&self) -> [bool; 3] {
        let [across, along] = [0, 1].map(|axis| self.boundary.floating && self.mirror.lines[axis].is_none());
        [across, along, across && along && !self.stencil.resists_rotation()]
    }

    /// Middle of a bond, m.
    #[inline]
    pub fn middle(&self, bond: Bond) -> Point {
        let (_, from, to) = self.ends(bond);
        let (a, b) = (self.lattice.position(from), self.lattice.position(to));
        [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
    }

    /// Whether no end of the bond lies in a no-fail zone.
    #[inline]
    pub fn can_fail(&self, bond: Bond) -> bool {
        let (_, from, to) = self.ends(bond);
        !self.no_fail[from] && !self.no_fail[to]
    }
}

/// Points between two marks of progress.
const POINTS_PER_MARK: usize = 4096;

/// Multipliers of the uncracked plate: 1 where both ends are points and the bond stays inside the material.
fn uncut_bonds(
    specimen: &Specimen,
    lattice: &Lattice,
    stencil: &Stencil,
    steps: &[isize],
    is_point: &[bool],
    points: &[u32],
) -> Result<Vec<f32>> {
    let places = lattice.places();
    let mut multiplier = vec![0.0_f32; places * stencil.bonds.len()];
    let obstacles = Obstacles::of(specimen, lattice.spacing, stencil.horizon);
    for (i, &point) in points.iter().enumerate() {
        if i % POINTS_PER_MARK == 0 {
            watch::at(Stage::Bonds, i as f64 / points.len() as f64)?;
        }
        let place = point as usize;
        let here = lattice.position(place);
        let near = obstacles.near(here);
        for (k, &step) in steps.iter().enumerate() {
            let other = place.wrapping_add_signed(step);
            if is_point[other] && !(near && obstacles.block(here, lattice.position(other))) {
                multiplier[k * places + place] = 1.0;
            }
        }
    }
    Ok(multiplier)
}
