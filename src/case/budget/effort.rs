//! Computing time of a case, about, in seconds of one core: solves times the time of one.
//!
//! With the points P, the bonds of a point b and `w = b/14` (14 are those of the usual horizon), one solve or time step takes
//!
//! ```text
//! window            WINDOW P w^1.2      bond by bond   BOND_BREAK P w        explicit step   STEP P w
//! multigrid         MULTIGRID P w^1.2   relaxation     RELAXATION P^1.5 w
//! factor of points  FACTOR P^1.5 w      nodes          NODES P^1.5
//! ```
//!
//! Coefficients are processor times of whole runs, pictures among them, over points and solves, and stand beside the runs they are of
//! (a crack of 10 mm in a plate of 100 by 300 mm, severed at last). Machines differ, and so does the number of solves: what is computed
//! here is refused only where it is [`MARGIN`] times what is allowed.

use super::Budget;
use crate::case::{Case, Method};
use crate::error::{Result, input};
use crate::fatigue::Driver;
use crate::levels::Discretisation;
use crate::solver::SolverKind;

/// Computing time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Seconds of one core.
    pub seconds: f64,
    /// It goes with 1/Δ to this power.
    pub power: f64,
    /// What else makes it less.
    pub other_keys: &'static str,
}

/// Estimate over limit from which a case is refused.
pub const MARGIN: f64 = 3.0;
/// Bonds that a point owns at the usual horizon.
const BONDS_USUAL: f64 = 14.0;
/// Increments of tips that are driven by K until a plate is severed: 26 to 57 at 7.5e3 to 7.5e5 points.
const INCREMENTS: f64 = 30.0;
/// 1.6, 6.9, 24.6 and 111 s at 1.2e4, 4.7e4, 1.9e5 and 7.5e5 points, m = 3.015, in 30, 35, 40 and 59 solves; 18 s at 3e4, m = 6, in 28.
const WINDOW: f64 = 4e-6;
/// 5.5 s at 3e4 points in 30 solves.
const MULTIGRID: f64 = 6e-6;
/// 22 s at 7500 points in 27 solves. As [`STEP`] has it, that is about 8 √P time steps for a solve.
const RELAXATION: f64 = 1.3e-6;
/// 19 s at 7500 points in 27 solves; three levels: 9 s at 6808 points in 18 solves.
const FACTOR: f64 = 1.1e-6;
/// Driven by the strain of bonds: 3.0 and 28 s at 7500 and 3e4 points in 906 and 1890 solves.
const BOND_BREAK: f64 = 4.8e-7;
/// Of these solves, over √P.
const BREAKS: f64 = 10.5;
/// 6.6 and 20 s at up to 3818 and 7488 nodes in 34 solves.
const NODES: f64 = 8.5e-7;
/// An explicit step of a scene: 17 s at 41 200 points in 2506 steps, 5.2 s at 10 600 in 2992, 1.7 s at 2776 in 4660; 14 s at 20 000 and
/// m = 6.015 in 292.
const STEP: f64 = 1.7e-7;

impl Effort {
    /// None worth counting.
    pub const NONE: Effort = Effort { seconds: 0.0, power: 1.0, other_keys: "" };

    /// So many time steps, whose number goes with 1/Δ to a power.
    pub fn of_steps(steps: f64, power: f64, points: f64, bonds: f64) -> Effort {
        Effort { seconds: steps * STEP * points * bonds / BONDS_USUAL, power: 2.0 + power, other_keys: "" }
    }

    /// So many solves by relaxation.
    pub fn of_relaxation(solves: f64, points: f64, bonds: f64) -> Effort {
        Effort { seconds: solves * RELAXATION * points.powf(1.5) * bonds / BONDS_USUAL, power: 3.0, other_keys: "" }
    }

    /// So many solves that factorise all points.
    pub fn of_factors(solves: f64, points: f64, bonds: f64) -> Effort {
        Effort { seconds: solves * FACTOR * points.powf(1.5) * bonds / BONDS_USUAL, power: 3.0, other_keys: "" }
    }

    /// A prediction on so many points or nodes, with so many bonds each.
    pub(super) fn of_case(case: &Case, points: f64, bonds: f64) -> Effort {
        let model = &case.model;
        let with = |seconds: f64, power: f64| Effort { seconds, power, other_keys: "" };
        match model.method {
            Method::Handbook => return Effort::NONE,
            Method::ElementFreeGalerkin => return with(INCREMENTS * NODES * points.powf(1.5), 3.0),
            Method::Peridynamics => {}
        }
        let by_bonds = case.fatigue.driver == Driver::BondStrain;
        let (solves, power) = if by_bonds { (BREAKS * points.sqrt(), 1.0) } else { (INCREMENTS, 0.0) };
        let on_lattice = |each: f64| with(solves * each * points * (bonds / BONDS_USUAL).powf(1.2), 2.0);
        let effort = match model.solver {
            SolverKind::AdaptiveDynamicRelaxation => Effort::of_relaxation(solves, points, bonds),
            // The break of a bond is an update of the plate around its tips, not a solve.
            SolverKind::Window if by_bonds => with(solves * BOND_BREAK * points * bonds / BONDS_USUAL, 2.0),
            _ if model.arrangement != Discretisation::Lattice => Effort::of_factors(solves, points, bonds),
            SolverKind::Direct => Effort::of_factors(solves, points, bonds),
            SolverKind::Window => on_lattice(WINDOW),
            SolverKind::Multigrid => on_lattice(MULTIGRID),
        };
        Effort { power: effort.power + power, ..effort }
    }
}

impl Budget {
    /// Refuses what would compute far longer than so many seconds of one core.
    pub fn within_time(&self, seconds: f64) -> Result<()> {
        let Effort { seconds: about, power, other_keys } = self.effort;
        if about <= MARGIN * seconds {
            return Ok(());
        }
        let problem = format!(
            "makes {:.2e} points and takes about {} of computing on one core, far more than the {} allowed",
            self.points,
            duration(about),
            duration(seconds)
        );
        self.refusal(problem, (about / seconds).powf(power.recip()), other_keys)
    }

    /// What it takes up, in words.
    pub fn words(&self) -> String {
        let megabytes = |bytes: f64| if bytes < 1e9 { format!("{:.0} MB", bytes / 1e6) } else { super::gigabytes(bytes) };
        let (time, memory, disk) = (duration(self.effort.seconds), megabytes(self.bytes), megabytes(self.disk_bytes));
        format!("a run takes about {time} on one core, {memory} of memory and {disk} of files")
    }
}

/// Refuses a sweep of so many cases that would compute far longer than allowed, all times in seconds of one core.
///
/// # Errors
/// [`crate::Error::Input`] on `design` with both times.
pub fn within_time_of_sweep(cases: usize, about: f64, allowed: f64) -> Result<()> {
    if about <= MARGIN * allowed {
        return Ok(());
    }
    let problem =
        format!("take about {} of computing on one core, far more than the {} allowed", duration(about), duration(allowed));
    Err(input("design", format!("{cases} cases"), problem, "give fewer cases, or a coarser model.spacing_mm"))
}

/// A time in words.
fn duration(seconds: f64) -> String {
    match seconds {
        ..1.0 => "1 s".to_owned(),
        ..120.0 => format!("{seconds:.0} s"),
        ..7200.0 => format!("{:.0} min", seconds / 60.0),
        ..3.6e8 => format!("{:.0} h", seconds / 3600.0),
        _ => format!("{:.1e} h", seconds / 3600.0),
    }
}
