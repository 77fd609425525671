//! Points of several levels with horizon and dual horizon: the arrangement `dual_horizon`.
//!
//! Every refined point is split in four at ± a quarter of its spacing, again and again; the horizon is the same multiple of each
//! point's own spacing. A point x pulls every x' in its horizon `H_x = {x' : |x' - x| ≤ δ_x}` with half of the micromodulus at
//! δ_x, and is pulled by all in whose horizon it lies, the dual horizon `H'_x = {x' : x ∈ H_x'}`:
//!
//! ```text
//! ρ u''(x) = Σ_{H_x} f_xx' V' - Σ_{H'_x} f_x'x V' + b
//! ```
//!
//! (Ren, Zhuang, Cai and Rabczuk 2016, IJNME 108:1451; Ren, Zhuang and Rabczuk 2017, CMAME 318:762). A bond acts on both ends with
//! opposite forces, so momentum is exact; springs lie along their bonds or act with the couple of [`NetBond::lever`], so angular
//! momentum is exact too. Without the dual, the full micromodulus would act on the owner alone, and a uniform strain leave a resultant:
//! ghost forces.
//!
//! Uniform strain is in no equilibrium within a horizon of a change of level: a point there sees more on one side
//! than on the other, and the strain at rest is off by a quarter to a half. `surface_correction = "balanced"` takes that away
//! (`dual_horizon/balanced.rs`); limits of damage know nothing of it, so changes of level belong where no crack starts.
//!
//! [`NetBond::lever`]: perilife_points::net::NetBond::lever

mod balanced;
pub mod levels;
mod links;
mod loads;
pub mod regions;

use rayon::prelude::*;

use levels::Levels;
use links::Linking;
use loads::Sharing;
use perilife_base::error::{Result, input};
use perilife_base::raster::PointGrid;
use perilife_plate::material::Material;
use perilife_plate::specimen::geometry::segments_touch;
use perilife_plate::specimen::{Crack, Point, Specimen};
use perilife_points::body::balanced::load_rows;
use perilife_points::body::lattice::Lattice;
use perilife_points::body::obstacles::Obstacles;
use perilife_points::body::pre_crack::{cutting_line, through_mouths};
use perilife_points::bond_law::stencil::{Stencil, plane_stiffness, spring_material};
use perilife_points::bond_law::{BondLaw, BondLawKind, SurfaceCorrection};
use perilife_points::net::{Net, NetBond};
use perilife_points::refinement::Refinement;
use regions::Area;

/// What points of several levels are asked for.
#[derive(Debug, Clone, Copy)]
pub struct MultiLevelSpec<'a> {
    pub specimen: &'a Specimen,
    pub material: &'a Material,
    pub law: &'a BondLaw,
    /// Spacing of the coarsest level asked for, m.
    pub spacing: f64,
    /// Horizon over spacing, on all levels.
    pub horizon_ratio: f64,
    /// Angle of the lattice rows against x, rad.
    pub lattice_angle: f64,
    /// Where finer points lie; `None` leaves the coarsest level everywhere.
    pub refinement: Option<&'a Refinement>,
    /// Whether nothing holds the plate, so that its loads must balance.
    pub floating: bool,
}

/// Builds points and bonds.
/// Errors: wrong input, or choices that do not go together.
pub fn build(ask: &MultiLevelSpec<'_>) -> Result<Net> {
    let MultiLevelSpec { specimen, law, .. } = *ask;
    if law.kind == BondLawKind::StateBased {
        let problem = "has a dilatation of points, which \"dual_horizon\" does not support";
        return Err(input("model.bond_law", format!("\"{}\"", law.kind), problem, "use a bond-based or two-parameter law"));
    }
    let padding = 0;
    let lattice = Lattice::over(specimen, ask.spacing, ask.lattice_angle, padding)?;
    let areas = Area::all(specimen, ask.refinement, ask.horizon_ratio)?;
    let levels = Levels::over(specimen, lattice, &areas, ask.horizon_ratio)?;
    let stencil = |lattice: &Lattice| Stencil::new(law, ask.material, lattice.spacing, ask.horizon_ratio, specimen.thickness);
    let stencils = levels.lattices.iter().map(stencil).collect::<Result<Vec<Stencil>>>()?;
    let positions: Vec<_> = levels.leaves.iter().map(|&leaf| levels.position(leaf)).collect();
    let linking = Linking::new(specimen, &levels, &stencils, &positions);
    let mut bonds = linking.within_levels();
    let mutual = bonds.len();
    bonds.extend(linking.across_levels());
    let of_level = |of: fn(&Stencil) -> f64| levels.leaves.iter().map(|leaf| of(&stencils[leaf.level])).collect::<Vec<f64>>();
    let finest = levels.finest().spacing;
    let consistent = (law.surface_correction == SurfaceCorrection::Balanced).then(|| {
        let walls = &stencils[stencils.len() - 1];
        (Obstacles::of(specimen, walls.spacing, stencils[0].horizon), load_rows(&stencils[0]))
    });
    let sharing = Sharing::new(&levels, &positions, consistent);
    let forces = loads::forces(specimen, &sharing, ask.floating)?;
    let mut net = Net {
        pre_cut: cut_by(&through_mouths(specimen, finest), &bonds, &positions, finest),
        volumes: of_level(|stencil| stencil.spacing * stencil.spacing).into_iter().map(|a| a * specimen.thickness).collect(),
        spacings: of_level(|stencil| stencil.spacing),
        horizons: of_level(|stencil| stencil.horizon),
        mutual,
        unknowns: stencils[0].unknowns,
        rotation_length: stencils[0].spacing,
        forces,
        grid: grid(&levels),
        warnings: warnings(&levels),
        entries: Vec::new(),
        starts: Vec::new(),
        positions: positions.clone(),
        bonds,
    }
    .linked();
    match law.surface_correction {
        SurfaceCorrection::None => {}
        SurfaceCorrection::VolumeAndSurface => {
            let c11 = plane_stiffness(&spring_material(law, ask.material))[0];
            volume_and_surface(&mut net, &levels.lattices[0], c11);
        }
        SurfaceCorrection::Balanced => balanced::balance(&mut net, specimen, &levels, &stencils, &sharing)?,
    }
    Ok(net)
}

/// Bonds that cracks cut, ascending.
fn cut_by(cracks: &[Crack], bonds: &[NetBond], positions: &[Point], spacing: f64) -> Vec<u32> {
    let lines: Vec<_> = cracks.iter().map(|crack| cutting_line(spacing, crack.from, crack.to)).collect();
    let is_cut = |bond: &NetBond| {
        let (a, b) = (positions[bond.from as usize], positions[bond.to as usize]);
        lines.iter().any(|&[from, to]| segments_touch(a, b, from, to))
    };
    (0..bonds.len()).filter(|&b| is_cut(&bonds[b])).map(|b| b as u32).collect()
}

/// The finest lattice with every coarser point on all the places of its cell.
fn grid(levels: &Levels) -> PointGrid {
    let lattice = levels.finest();
    let places = (0..lattice.columns * lattice.rows).map(|i| ((i % lattice.columns) as i64, (i / lattice.columns) as i64));
    let point_at = places.map(|(column, row)| levels.point_over(column, row).map(|point| point as u32)).collect();
    lattice.grid(point_at)
}

/// What was split beyond what was asked for.
fn warnings(levels: &Levels) -> Vec<String> {
    let more = levels.splits.iter().enumerate().filter(|(_, [_, more])| *more > 0);
    more.map(|(level, [asked, more])| {
        format!(
            "refinement: {more} extra points of {:.4} mm were split ({asked} requested) so that neighboring levels differ by \
             one",
            1e3 * levels.lattices[level].spacing
        )
    })
    .collect()
}

/// Classical surface correction on points of any arrangement: energy factors of Madenci and Oterkus (2014, Peridynamic Theory and Its Applications, ch. 4 and 7) on a net.
///
/// Under uniaxial strain e along the rows or columns of the lattice a point stores `W_d(x)` in the bonds of its own horizon (half of a bond of both ends,
/// all of the half micromodulus of a bond of its own) instead of `W = C₁₁ e² V/2`; `g_d = W / W_d`. A bond with unit vector n
/// gets the factor `[(n_x/G_x)² + (n_y/G_y)²]^(-1/2)`; G is the mean of both ends for a bond of both, as on a lattice, and the
/// owner's own g for a bond in the owner's horizon alone: that bond is part of the owner's integral and of no other. The
/// factors so serve two ends at once: cut-off horizons at a rim, and sums over cells of two sizes where levels meet.
/// Computed once, on the uncracked plate. `c11` is that of the material that the springs stand for, Pa.
fn volume_and_surface(net: &mut Net, lattice: &Lattice, c11: f64) {
    let gains: Vec<[f64; 2]> = (0..net.len())
        .into_par_iter()
        .map(|i| {
            let mut energy = [0.0; 2];
            for (b, _) in net.family_of(i) {
                let bond = &net.bonds[b];
                let [nx, ny] = lattice.to_axes(bond.normal);
                let share = if b < net.mutual { 0.5 } else { 1.0 };
                let square = 0.5 * share * bond.length * bond.length;
                for (axis, n) in energy.iter_mut().zip([nx, ny]) {
                    *axis += square * (bond.k_n * n.powi(4) + bond.k_t * nx * nx * ny * ny);
                }
            }
            let exact = 0.5 * c11 * net.volumes[i];
            energy.map(|w| if w > 0.0 { exact / w } else { 1.0 })
        })
        .collect();
    for (b, bond) in net.bonds.iter_mut().enumerate() {
        let (own, other) = (gains[bond.from as usize], gains[bond.to as usize]);
        let gain = |axis: usize| if b < net.mutual { 0.5 * (own[axis] + other[axis]) } else { own[axis] };
        let [nx, ny] = lattice.to_axes(bond.normal);
        let factor = ((nx / gain(0)).powi(2) + (ny / gain(1)).powi(2)).powf(-0.5);
        bond.k_n *= factor;
        bond.k_t *= factor;
    }
}
