//! Displacement and stress of a plate under its load, without growth, on nodes ([`perilife_nodes`]): largest stress on every rim and
//! stress concentration.
//!
//! `K_tg = σ_max / σ`, with σ the nominal stress on the loaded edges (gross section). Spacings in the radius of holes and fillets are doubled until the largest stress of every hole and arc changes by less than [`SETTLED`]; the change is
//! reported and is no bound of the error.

use crate::case::Case;
use perilife_base::error::{Error, Result};
use perilife_base::raster::PointGrid;
use perilife_nodes::crack::initial_cracks;
use perilife_nodes::field::Discretisation;
use perilife_nodes::resolution::Resolution;
use perilife_nodes::rim_stress::{RimStress, rim_stresses};
use perilife_nodes::solve::{raster, raster_fields, solve};
use perilife_nodes::stress_field::{Corner, stress_pieces};
use perilife_plate::specimen::Point;
use perilife_plate::williams::Elasticity;

/// Change of the largest stress of a rim from one spacing to the next below which it counts as settled.
pub const SETTLED: f64 = 3e-3;
/// Spacings in the radius of a hole or fillet to begin with.
const IN_RADIUS_FIRST: f64 = 4.0;
/// Reach of a hole or fillet in spacings of the coarser level: a ring of every level around it. Where a hole lies in a single cell that is halved
/// at its rim alone, peaks are half as large again.
const RIM_REACH: f64 = 6.0;
/// Spacings in the radius below which peaks may agree by chance.
const IN_RADIUS_LEAST: f64 = 16.0;
const REFINEMENTS: usize = 4;
/// Nodes beyond which no further refinement is begun: the next would have four times as many.
const NODES_MOST: usize = 12_000;

/// A plate under its maximum load.
#[derive(Debug, Clone)]
pub struct Stressed {
    /// Stress of every rim: holes, slots, outline.
    pub rims: Vec<RimStress>,
    /// Nominal stress on the loaded edges, Pa: of bent ones the mean, in pure bending that at their ends; `None` under forces.
    pub gross: Option<f64>,
    /// Largest change of a rim's peak in the last refinement, as a share; `None` where there was none.
    pub change: Option<f64>,
    /// Largest displacement, m, and where it is: of the points of the raster.
    pub moved: (f64, Point),
    /// How fine the last nodes were.
    pub resolution: Resolution,
    pub nodes: usize,
    pub unknowns: usize,
    pub solves: usize,
    /// Raster of the fields.
    pub grid: PointGrid,
    /// Displacement of its points, m.
    pub displacement: Vec<Point>,
    /// Von Mises stress of its points, Pa.
    pub stress: Vec<f64>,
    /// Stress over the plate as convex pieces.
    pub pieces: Vec<Vec<Corner>>,
}

impl Stressed {
    /// Stress over the gross stress, where that is known.
    pub fn concentration(&self, stress: f64) -> Option<f64> {
        self.gross.filter(|gross| *gross != 0.0).map(|gross| stress / gross)
    }

    /// Whether the peaks of all holes and arcs have settled.
    pub fn is_settled(&self) -> bool {
        self.change.is_none_or(|change| change < SETTLED)
    }
}

/// The plate of a case at its maximum load.
/// Errors: as [`solve`]; [`Error::Mechanics`] where cracks or supports leave a mechanism.
pub fn stressed(case: &Case) -> Result<Stressed> {
    let specimen = &case.specimen;
    let (lines, tips) = initial_cracks(specimen);
    let elasticity = Elasticity::of(&case.material);
    let mut resolution = case.nodes().resolution;
    let far = resolution.far;
    (resolution.in_radius, resolution.rim_reach) = (IN_RADIUS_FIRST, RIM_REACH);
    let (mut rims, mut solves): (Vec<RimStress>, usize) = (Vec::new(), 0);
    loop {
        let plate = Discretisation::new(specimen, elasticity, &lines, &tips, &resolution, None)?;
        let load = case.loading.maximum;
        let solution = solve(specimen, &plate, resolution.far, load).map_err(|error| match error {
            Error::LossOfStiffness => Error::Mechanics(format!("{}: what is left of the plate cannot carry its load", case.name)),
            other => other,
        })?;
        solves += 1;
        let share = case.loading.share(solution.work, case.specimen.crack_length);
        let found = rim_stresses(specimen, &plate, &solution.u, share)?;
        let change = largest_change(&rims, &found);
        rims = found;
        let nodes = plate.nodes.at.len();
        let is_settled = resolution.in_radius >= IN_RADIUS_LEAST && change.is_some_and(|change| change < SETTLED)
            || !rims.iter().any(|rim| rim.is_round);
        if is_settled || solves > REFINEMENTS || nodes > NODES_MOST {
            let (displacement, stress) = raster_fields(specimen, &plate, &solution.u, far, case.material.plane, share);
            let grid = raster(specimen, far);
            return Ok(Stressed {
                pieces: stress_pieces(specimen, &plate, &solution.u, case.material.plane, share),
                gross: specimen.gross_stress(share * load).map(|_| share * load),
                moved: most_moved(&grid, &displacement),
                resolution,
                nodes,
                unknowns: plate.unknowns(),
                solves,
                rims,
                change,
                grid,
                displacement,
                stress,
            });
        }
        resolution.in_radius *= 2.0;
    }
}

/// Largest relative change of the peaks of holes and arcs; over at least a tenth of the largest stress.
fn largest_change(before: &[RimStress], now: &[RimStress]) -> Option<f64> {
    let size = |rim: &RimStress| rim.peak().stress.abs();
    let tenth = 0.1 * now.iter().map(size).fold(0.0, f64::max);
    let smooth = before.iter().zip(now).filter(|(_, now)| now.is_round);
    let change = |(before, now): (&RimStress, &RimStress)| (size(now) - size(before)).abs() / size(now).max(tenth);
    smooth.map(change).max_by(f64::total_cmp)
}

/// Largest displacement of the points of a raster, m, and where.
fn most_moved(grid: &PointGrid, displacement: &[Point]) -> (f64, Point) {
    let places = grid.point_at.iter().enumerate().filter_map(|(place, point)| Some((place, (*point)? as usize)));
    let sizes = places.map(|(place, point)| (displacement[point][0].hypot(displacement[point][1]), place));
    let (size, place) = sizes.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, 0));
    let [column, row] = [place % grid.columns, place / grid.columns];
    (size, [grid.origin[0] + column as f64 * grid.spacing, grid.origin[1] + row as f64 * grid.spacing])
}
