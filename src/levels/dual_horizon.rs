//! Points of several levels with horizon and dual horizon: the arrangements `dual_horizon` and `variable_horizon`.
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
//! momentum is exact too. Without the dual (`variable_horizon`), the full micromodulus acts on the owner alone, and a
//! uniform strain at rest leaves a resultant: ghost forces.
//!
//! Uniform strain is in no equilibrium within a horizon of a change of level, dual or not: a point there sees more on one side
//! than on the other, and the strain at rest is off by a quarter to a half. `surface_correction = "balanced"` takes that away
//! (`dual_horizon/balanced.rs`); limits of damage know nothing of it, so changes of level belong where no crack starts.
//!
//! [`NetBond::lever`]: super::NetBond::lever

mod balanced;
pub mod levels;
mod links;
mod loads;
pub mod regions;
mod surface;

use super::{Discretisation, Net, NetBond, PointGrid, Refinement};
use crate::body::balanced::load_rows;
use crate::body::facets::Obstacles;
use crate::body::lattice::Lattice;
use crate::body::pre_crack::{cutting_line, through_mouths};
use crate::bond_law::stencil::{Stencil, plane_stiffness, spring_material};
use crate::bond_law::{BondLaw, BondLawKind, SurfaceCorrection};
use crate::error::{Result, input};
use crate::material::Material;
use crate::specimen::geometry::segments_touch;
use crate::specimen::{Crack, Point, Specimen};
use levels::Levels;
use links::Linking;
use loads::Sharing;
use regions::Area;

/// What points of several levels are asked for.
#[derive(Debug, Clone, Copy)]
pub struct MultiLevelSpec<'a> {
    /// Plate, its cracks as they are cut.
    pub specimen: &'a Specimen,
    /// The same plate, its cracks as regions around flaws mean them.
    pub flaws: &'a Specimen,
    /// Material.
    pub material: &'a Material,
    /// Law of the bonds.
    pub law: &'a BondLaw,
    /// Spacing of the coarsest level asked for, m.
    pub spacing: f64,
    /// Horizon over spacing, on all levels.
    pub horizon_ratio: f64,
    /// Angle of the lattice rows against x, rad.
    pub lattice_angle: f64,
    /// With or without the dual horizon.
    pub arrangement: Discretisation,
    /// Where finer points lie; `None` leaves the coarsest level everywhere.
    pub refinement: Option<&'a Refinement>,
    /// Whether nothing holds the plate, so that its loads must balance.
    pub floating: bool,
}

/// Points of several levels.
#[derive(Debug, Clone)]
pub struct MultiLevelMesh {
    /// Points and bonds.
    pub net: Net,
    /// The lattices they stand on.
    pub levels: Levels,
    /// Bonds and springs of the lattice of every level.
    pub stencils: Vec<Stencil>,
    /// Points at whose rim a load acts, ascending.
    pub loaded: Vec<u32>,
}

/// Builds points and bonds.
///
/// # Errors
/// Wrong input, or choices that do not go together.
pub fn build(ask: &MultiLevelSpec<'_>) -> Result<MultiLevelMesh> {
    let MultiLevelSpec { specimen, law, arrangement, .. } = *ask;
    if law.kind == BondLawKind::StateBased {
        let problem = format!("has a dilatation of every point, and \"{arrangement}\" joins points by springs only");
        return Err(input("model.bond_law", format!("\"{}\"", law.kind), problem, "use a bond-based or two-parameter law"));
    }
    if arrangement == Discretisation::VariableHorizon && law.surface_correction == SurfaceCorrection::Balanced {
        let problem = format!("balances springs that pull both ends, and \"{arrangement}\" has others");
        return Err(input("model.surface_correction", "\"balanced\"", problem, "use \"none\" or \"volume_and_surface\""));
    }
    let padding = 0;
    let lattice = Lattice::over(specimen, ask.spacing, ask.lattice_angle, padding)?;
    let areas = Area::all(ask.flaws, ask.refinement, ask.horizon_ratio)?;
    let levels = Levels::over(specimen, lattice, &areas, ask.horizon_ratio)?;
    let stencil = |lattice: &Lattice| Stencil::new(law, ask.material, lattice.spacing, ask.horizon_ratio, specimen.thickness);
    let stencils = levels.lattices.iter().map(stencil).collect::<Result<Vec<Stencil>>>()?;
    let positions: Vec<_> = levels.leaves.iter().map(|&leaf| levels.position(leaf)).collect();
    let linking = Linking::new(specimen, &levels, &stencils, &positions, arrangement);
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
    let loaded = loads::seats(specimen, &sharing);
    let mut net = Net {
        pre_cut: cut_by(&through_mouths(specimen, finest), &bonds, &positions, finest),
        volumes: of_level(|stencil| stencil.spacing * stencil.spacing).into_iter().map(|a| a * specimen.thickness).collect(),
        spacings: of_level(|stencil| stencil.spacing),
        horizons: of_level(|stencil| stencil.horizon),
        mutual,
        owner_only: arrangement == Discretisation::VariableHorizon,
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
            surface::volume_and_surface(&mut net, &levels.lattices[0], c11);
        }
        SurfaceCorrection::Balanced => balanced::balance(&mut net, specimen, &levels, &stencils, &sharing)?,
    }
    Ok(MultiLevelMesh { net, levels, stencils, loaded })
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
    PointGrid::of_lattice(lattice, point_at)
}

/// What was split beyond what was asked for.
fn warnings(levels: &Levels) -> Vec<String> {
    let more = levels.splits.iter().enumerate().filter(|(_, [_, more])| *more > 0);
    more.map(|(level, [asked, more])| {
        format!(
            "refinement: {more} points of {:.4} mm were split beside the {asked} asked for, so that levels within a horizon differ by one",
            1e3 * levels.lattices[level].spacing
        )
    })
    .collect()
}
