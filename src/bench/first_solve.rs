//! Set-up and first solve of growing plates: time, memory and how they grow.

use std::path::Path;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::clock::{Timing, cpu_seconds};
use super::exponent::growth_exponent;
use super::row::{Asked, Row};
use super::{Bench, Figure};
use crate::body::Body;
use crate::bond_law::BondLawKind;
use crate::calibration::median::median;
use crate::case::Case;
use crate::error::Result;
use crate::predict::memory;
use crate::solver::{Equilibrium, SolverKind};
use crate::state::Bonds;

const GROUP: &str = "first_solve";
/// Points of the plates.
const SIZES: [usize; 4] = [30_000, 120_000, 480_000, 1_000_000];
const SIZES_QUICK: [usize; 2] = [7_500, 30_000];
/// Laws with two and with three unknowns a point.
const LAWS: [BondLawKind; 2] = [BondLawKind::BondBased, BondLawKind::TwoParameter];
/// Exponent asked for.
const ASKED_EXPONENT: f64 = 1.15;
/// Bytes a point, processor seconds of the largest plate asked for, law by law; and its memory, bytes.
const ASKED_BYTES: [f64; 2] = [700.0, 1000.0];
const ASKED_CPU_S: [f64; 2] = [4.0, 8.0];
const ASKED_PEAK_MB: f64 = 1000.0;
/// Length over width of the plates, about that of fatigue panels.
const SLENDERNESS: f64 = 3.0;

/// One size to be measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Request {
    /// Law.
    pub law: BondLawKind,
    /// Points, about.
    pub points: usize,
}

/// What one size took.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FirstSolve {
    /// Points.
    pub points: usize,
    /// Wall time, s.
    pub wall_s: f64,
    /// Processor time, s; `None` where the system does not tell.
    pub cpu_s: Option<f64>,
    /// Peak of memory beyond what the process had before, bytes; `None` where the system does not tell.
    pub peak_bytes: Option<f64>,
    /// Iterations of the solver.
    pub iterations: usize,
}

/// Measures one size in this process: body, solver, first equilibrium of a plate with a middle crack of a fifth of its
/// width, all of it solved for.
///
/// The peak of memory is that of the process: only its first call measures memory well.
///
/// # Errors
/// As [`Body::build`] and [`Equilibrium::solve`].
pub fn first_solve(request: &Request) -> Result<FirstSolve> {
    let case = plate(request)?;
    let model = &case.model;
    let (memory_before, cpu_before, started) = (memory::resident_mb(), cpu_seconds(), Instant::now());
    let body =
        Body::build(&case.specimen, &case.material, &model.bond_law, model.spacing, model.horizon_ratio, model.lattice_angle)?;
    let bonds = Bonds::new(&body);
    let mut displacement = Vec::new();
    let mut equilibrium = Equilibrium::new(model.solver, model.symmetry, &body, &bonds, case.loading.maximum);
    let iterations = equilibrium.solve(&body, &bonds, &mut displacement)?;
    let known = |value: f64| value.is_finite().then_some(value);
    Ok(FirstSolve {
        points: body.points.len(),
        wall_s: started.elapsed().as_secs_f64(),
        cpu_s: known(cpu_seconds() - cpu_before),
        peak_bytes: known(1e6 * (memory::peak_mb() - memory_before)),
        iterations,
    })
}

fn plate(request: &Request) -> Result<Case> {
    let width = (request.points as f64 / SLENDERNESS).sqrt().round();
    let (length, crack) = ((request.points as f64 / width).round(), 0.1 * width);
    let poisson_ratio = if request.law == BondLawKind::BondBased { 1.0 / 3.0 } else { 0.33 };
    let text = format!(
        "[specimen]\nkind = \"middle_tension\"\nwidth_mm = {width:?}\nlength_mm = {length:?}\nthickness_mm = 2.0\n\
         crack_length_mm = {crack:?}\n[material]\nyoungs_modulus_gpa = 72.0\npoisson_ratio = {poisson_ratio:?}\n\
         plane = \"stress\"\n[loading]\nstress_max_mpa = 50.0\nstress_ratio = 0.1\n[model]\nspacing_mm = 1.0\n\
         symmetry = \"off\"\nbond_law = \"{}\"\nsolver = \"{}\"\n[fatigue]\na = 6450.0\np = 2.86\nhorizon_mm = 3.015\n",
        request.law,
        SolverKind::Multigrid
    );
    Case::from_toml(&text, GROUP, Path::new("."), &[])
}

/// All sizes with two and three unknowns a point, each in a process of its own.
///
/// # Errors
/// As [`first_solve`]; a process that cannot be started.
pub fn sizes(bench: &mut Bench<'_>) -> Result<()> {
    let sizes: &[usize] = if bench.effort.quick { &SIZES_QUICK } else { &SIZES };
    for (i, law) in LAWS.into_iter().enumerate() {
        let all: Vec<(FirstSolve, Timing)> =
            sizes.iter().map(|&points| one_size(bench, Request { law, points })).collect::<Result<_>>()?;
        let points: Vec<f64> = all.iter().map(|(size, _)| size.points as f64).collect();
        let walls: Vec<f64> = all.iter().map(|(_, timing)| timing.wall_s).collect();
        let figure = |what: &str, value, unit, asked| Figure {
            group: GROUP,
            quantity: format!("{law}: {what}"),
            value,
            unit,
            asked: Some(asked),
        };
        let exponent = growth_exponent(&points, &walls);
        bench.figure(figure("growth exponent of time", exponent, "", Asked::AtMost(ASKED_EXPONENT)));
        // A size at least was measured: the lists above are not empty.
        let Some((largest, timing)) = all.last() else { continue };
        let peak = largest.peak_bytes.unwrap_or(f64::NAN);
        let each = peak / largest.points as f64;
        bench.figure(figure("peak memory of the largest plate, a point", each, "bytes", Asked::AtMost(ASKED_BYTES[i])));
        bench.figure(figure("processor time of the largest plate", timing.cpu_s, "s", Asked::AtMost(ASKED_CPU_S[i])));
        bench.figure(figure("peak memory of the largest plate", 1e-6 * peak, "MB", Asked::AtMost(ASKED_PEAK_MB)));
    }
    Ok(())
}

fn one_size(bench: &mut Bench<'_>, request: Request) -> Result<(FirstSolve, Timing)> {
    let isolated = bench.isolated;
    let mut taken: Vec<FirstSolve> = Vec::new();
    let (last, process) = bench.time(|| {
        let size = isolated(&request)?;
        taken.push(size);
        Ok(size)
    })?;
    // Of the process itself, which takes its time to start, only the inside counts.
    let of = |pick: fn(&FirstSolve) -> f64| median(&taken.iter().map(pick).collect::<Vec<f64>>());
    let wall_s = of(|size| size.wall_s);
    let timing = Timing {
        wall_s,
        cpu_s: of(|size| size.cpu_s.unwrap_or(f64::NAN)),
        ratio: process.ratio * wall_s / process.wall_s,
        ..process
    };
    let about = "plate with a middle crack, body built and first equilibrium found";
    let row = Row::new(GROUP, about, "points", &format!("{} {} points", request.law, last.points), timing);
    let bytes_per_point = last.peak_bytes.map(|bytes| bytes / last.points as f64);
    let note = format!("{} iterations", last.iterations);
    bench.push(Row { points: last.points, bytes_per_point, note, ..row });
    Ok((last, timing))
}
