//! A run that nobody computed, for tests of what is written about runs: a plate of 100 x 300 mm whose slant crack of
//! 10 mm turns level and grows at C ΔK^m with C = 1e-8, m = 3.

use std::f64::consts::PI;

use perilife_base::raster::{PointGrid, Snapshot};
use perilife_growth::case::Case;
use perilife_growth::predict::{CurvePoint, Prediction, RunFigures, StopReason, TipRecord};
use perilife_plate::specimen::{Crack, Point};
use perilife_points::crack_tip::TipState;
use perilife_points::solver::SolverUsed;
use perilife_results::run::{Judged, Wanted};

const SPACING: f64 = 1e-3;

/// The crack before N = 0: 10 mm long, 60° to the load.
pub fn cracks() -> Vec<Crack> {
    let (x, y) = (5e-3 * (PI / 6.0).cos(), 5e-3 * (PI / 6.0).sin());
    vec![Crack::straight([-x, -y], [x, y])]
}

/// The run, on a lattice turned by `angle`.
pub fn prediction(angle: f64) -> Prediction {
    let curve = curve();
    let grid = grid(angle);
    let snapshots = [0, curve.len() / 2, curve.len() - 1].map(|at| snapshot(&grid, &curve, at)).to_vec();
    let points = grid.point_at.iter().flatten().count();
    let figures = RunFigures {
        points,
        points_solved: points,
        bonds: 14 * points,
        blocks: curve.len() - 1,
        solves: curve.len(),
        iterations: 9 * curve.len(),
        refined: [0; 2],
        step_error: 0.0,
        solver: Some(SolverUsed::Multigrid),
        spacing: SPACING,
        horizon: 3.015 * SPACING,
        wall_s: 12.5,
        memory_mb: 87.0,
    };
    Prediction {
        curve,
        stop: StopReason::CrackLengthReached,
        snapshots,
        grid,
        figures,
        phase_one: None,
        cross_check: None,
        unretarded_cycles: None,
        warnings: vec!["made up".to_owned()],
    }
}

fn curve() -> Vec<CurvePoint> {
    let [x0, y0] = cracks()[0].to;
    let (mut cycles, mut curve) = (0.0, Vec::new());
    for step in 0..=180 {
        let growth = step as f64 * 0.2e-3 + 1e-5 * (7.0 * step as f64).sin() * f64::from(u8::from(step > 0));
        let crack_length = 10e-3 + 2.0 * growth;
        let delta_k = 63e6 * (PI * crack_length / 2.0).sqrt();
        let growth_rate = 1e-11 * (delta_k / 1e6).powi(3) * (1.0 + 0.1 * (11.0 * step as f64).sin());
        if step > 0 {
            cycles += 0.2e-3 / growth_rate;
        }
        let y = y0 + 1.2e-3 * (1.0 - (-growth / 2e-3).exp());
        let at = |sign: f64| tip([sign * (x0 + growth), sign * y], growth);
        let row = CurvePoint::bare(cycles, crack_length, vec![at(-1.0), at(1.0)]);
        curve.push(CurvePoint { delta_k, growth_rate, work: 1.0 + crack_length, broken_bonds: 9 * step, ..row });
    }
    curve
}

fn grid(angle: f64) -> PointGrid {
    // A lattice large enough for the plate at any angle; places outside the plate or in its hole stay empty.
    let (columns, rows) = if angle == 0.0 { (100, 300) } else { (320, 320) };
    let (sin, cos) = angle.sin_cos();
    let (dx, dy) = (0.5 * (columns - 1) as f64 * SPACING, 0.5 * (rows - 1) as f64 * SPACING);
    let origin = [-cos * dx + sin * dy, -sin * dx - cos * dy];
    let mut grid = PointGrid { spacing: SPACING, columns, rows, origin, angle, point_at: Vec::new() };
    let mut points = 0;
    for place in 0..columns * rows {
        let [x, y] = position(&grid, place);
        let hole = (x - 20e-3).hypot(y - 60e-3) < 12e-3;
        let material = x.abs() < 50e-3 && y.abs() < 150e-3 && !hole;
        grid.point_at.push(material.then_some(points));
        points += u32::from(material);
    }
    grid
}

fn position(grid: &PointGrid, place: usize) -> Point {
    let (x, y) = ((place % grid.columns) as f64 * SPACING, (place / grid.columns) as f64 * SPACING);
    let (sin, cos) = grid.angle.sin_cos();
    [grid.origin[0] + cos * x - sin * y, grid.origin[1] + sin * x + cos * y]
}

fn snapshot(grid: &PointGrid, curve: &[CurvePoint], at: usize) -> Snapshot {
    let [left, right] = [curve[at].tips[0].position, curve[at].tips[1].position];
    let path: Vec<Point> =
        curve[..=at].iter().rev().map(|p| p.tips[0].position).chain(curve[..=at].iter().map(|p| p.tips[1].position)).collect();
    let (mut damage, mut displacement) = (Vec::new(), Vec::new());
    for (place, _) in grid.point_at.iter().enumerate().filter(|(_, point)| point.is_some()) {
        let [x, y] = position(grid, place);
        let near = path.iter().map(|p| (p[0] - x).hypot(p[1] - y)).fold(f64::INFINITY, f64::min);
        let shadow = if x > left[0] && x < right[0] { 1.0 } else { 0.6 };
        damage.push((0.40 * shadow * (1.0 - near / 3.015e-3)).max(0.0));
        displacement.push([-3e-4 * x, 1e-3 * y]);
    }
    Snapshot {
        cycles: curve[at].cycles,
        crack_length: curve[at].crack_length,
        displacement,
        damage,
        remaining_life: Vec::new(),
        stress: Vec::new(),
    }
}

/// What was found about a run, without bounds of its error.
pub fn judged(case: &Case, run: &Prediction) -> Judged {
    Judged::of(case, run, &Wanted { no_estimate: true, ..Wanted::default() }).unwrap()
}

/// `result.json` of a run.
pub fn result(case: &Case, run: &Prediction) -> serde_json::Value {
    serde_json::to_value(judged(case, run).record).unwrap()
}

/// A tip at a place that has grown so far, whose K nobody read.
pub fn tip(position: Point, growth: f64) -> TipRecord {
    TipRecord::unread(TipState::Active, position, growth)
}
