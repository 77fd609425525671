//! Golden lives: a-N figures that anyone can check with a pocket calculator or a closed form, by hand calculation and by peridynamics
//! with the same C and m.
//!
//! Units of the constants as in the input: mm/cycle and MPa√m.

use super::cases::run;
use super::table::Table;
use perilife_base::error::{Error, Result};
use perilife_base::units::{MM, MM_PER_CYCLE};
use perilife_calibration::rates::{RateMethod, rates};
use perilife_growth::predict::{Prediction, StopReason};
use perilife_measured::MeasuredCurve;

/// The panel of Virkler, Hillberry and Goel (1979) with the constants of Kotulski (1998), ln C = -26.155 and m = 2.874 in mm and
/// MPa√mm.
const PANEL: &str = "
    specimen = { kind = 'middle_tension', width_mm = 152.4, length_mm = 300.0, thickness_mm = 2.54, crack_length_mm = 9.0 }
    loading = { stress_range_mpa = 48.28, stress_ratio = 0.2 }
    fatigue = { paris_c_mm_per_cycle = 8.95422e-8, paris_m = 2.874 }";

/// A compact specimen of 50 mm.
const COMPACT: &str = "
    specimen = { kind = 'compact_tension', width_mm = 50.0, thickness_mm = 12.5, crack_length_mm = 12.5 }
    loading = { force_range_n = 8000.0, stress_ratio = 0.0 }
    fatigue = { paris_c_mm_per_cycle = 1.647547e-8, paris_m = 3.0 }
    stop = { crack_length_mm = 30.0 }";

/// A crack so small in its plate (20 mm in 60 m) that F = 1 to 1e-6.
const WIDE: &str = "
    specimen = { kind = 'middle_tension', width_mm = 60000.0, length_mm = 100000.0, thickness_mm = 1.0, crack_length_mm = 2.0 }
    loading = { stress_range_mpa = 100.0, stress_ratio = 0.0 }
    fatigue = { paris_c_mm_per_cycle = 1e-7, paris_m = 2.0 }
    stop = { crack_length_mm = 20.0 }";

/// Material and method of all.
const REST: &str = "
    material = { youngs_modulus_gpa = 73.1, poisson_ratio = 0.33 }
    model = { method = 'handbook' }";

/// A life.
struct Golden {
    what: &'static str,
    text: &'static str,
    keys: &'static str,
    /// Spacing of the run by peridynamics, mm.
    spacing: Option<f64>,
    /// Cycles.
    life: f64,
    /// Why it ends and at which crack length, mm, if not at a given one; the bound of that length by peridynamics, percent.
    end: Option<(StopReason, f64, f64)>,
    source: &'static str,
}

const QUADRATURE: &str = "quadrature of the Paris law with the secant formula, independent script";

#[rustfmt::skip]
const GOLDEN: [Golden; 6] = [
    golden("M(T) W 152.4 mm, range 48.28 MPa, 9 to 49.8 mm", PANEL, "stop.crack_length_mm=49.8",
        Some(1.0), 247_247.0, None, QUADRATURE),
    golden("M(T) W 152.4 mm, range 48.28 MPa, 20 to 49.8 mm", PANEL, "specimen.crack_length_mm=20 stop.crack_length_mm=49.8",
        Some(1.0), 91_814.0, None, QUADRATURE),
    golden("C(T) W 50 mm, B 12.5 mm, range 8 kN, 12.5 to 30 mm", COMPACT, "",
        Some(0.5), 127_411.0, None, "quadrature of the Paris law with the formula of ASTM E647, independent script"),
    golden("crack in a plate without end, range 100 MPa, m 2, 2 to 20 mm", WIDE, "",
        None, 732_935.6, None, "closed form ln(a_end/a_0) / (C Δσ² π)"),
    golden("M(T) of yield strength 345 MPa", PANEL, "material.yield_strength_mpa=345",
        Some(1.0), 254_287.0, Some((StopReason::NetSectionYield, 62.871, 0.1)),
        "W σ_max / (W - 2a) = yield strength; quadrature up to there"),
    golden("M(T) of toughness 40 MPa√m", PANEL, "material.yield_strength_mpa=345 material.toughness_mpa_sqrt_m=40",
        Some(1.0), 251_721.0, Some((StopReason::Toughness, 56.154, 1.0)),
        "K_max by the secant formula = toughness; quadrature up to there"),
];

const fn golden(
    what: &'static str,
    text: &'static str,
    keys: &'static str,
    spacing: Option<f64>,
    life: f64,
    end: Option<(StopReason, f64, f64)>,
    source: &'static str,
) -> Golden {
    Golden { what, text, keys, spacing, life, end, source }
}

/// Bounds of hand calculation and of peridynamics, percent.
const BOUND: f64 = 0.1;
const BOUND_ON_POINTS: f64 = 1.0;

/// Golden lives by hand calculation, and rates by the two methods of ASTM E647.
pub fn by_hand(table: &mut Table) -> Result<()> {
    for golden in &GOLDEN {
        row(table, golden, "", "", [BOUND; 2])?;
    }
    measured_rates(table);
    Ok(())
}

/// Golden lives by peridynamics.
pub fn on_points(table: &mut Table) -> Result<()> {
    for golden in &GOLDEN {
        let Some(spacing) = golden.spacing else { continue };
        let bound_of_end = golden.end.map_or(f64::NAN, |end| end.2);
        let keys = format!("model.method=peridynamics model.spacing_mm={spacing}");
        row(table, golden, &format!(", {spacing} mm spacing"), &keys, [BOUND_ON_POINTS, bound_of_end])?;
    }
    Ok(())
}

fn row(table: &mut Table, golden: &Golden, how: &str, keys: &str, [of_life, of_end]: [f64; 2]) -> Result<()> {
    let Golden { what, text, life, end, source, .. } = golden;
    let run = run(&format!("{text}{REST}"), &format!("{} {keys}", golden.keys))?;
    ended_by(&run, end.map_or(StopReason::CrackLengthReached, |end| end.0), what)?;
    table.compare(format!("{what}{how}: cycles"), run.life_cycles(), *life, of_life, source);
    if let Some((reason, length, _)) = end {
        table.compare(format!("{what}{how}: {reason} at a, mm"), run.crack_length_final() / MM, *length, of_end, source);
    }
    Ok(())
}

/// Whether a run ended for this reason.
pub(super) fn ended_by(run: &Prediction, reason: StopReason, what: &str) -> Result<()> {
    if run.stop == reason {
        return Ok(());
    }
    Err(Error::Mechanics(format!("{what}: stopped by {}, should be {reason}", run.stop)))
}

/// Seven readings of the median of 34 Virkler panels (Virkler, Hillberry and Goel 1979, odd numbers): cycles, crack length in mm.
const READINGS: [(f64, f64); 7] = [
    (157_635.0, 19.4),
    (159_114.5, 19.6),
    (160_502.5, 19.8),
    (161_755.5, 20.0),
    (162_949.0, 20.2),
    (164_131.5, 20.4),
    (165_058.0, 20.6),
];

/// Rates at these readings, computed by an independent script.
fn measured_rates(table: &mut Table) {
    let cycles = READINGS.iter().map(|reading| reading.0).collect();
    let curve = MeasuredCurve::new("median", cycles, READINGS.iter().map(|reading| reading.1 * MM).collect());
    for (method, length, rate) in [(RateMethod::Polynomial7, 19.997, 1.64009e-4), (RateMethod::Secant, 20.1, 1.67574e-4)] {
        let points = rates(&curve, method);
        let point = points.iter().find(|point| (point.crack_length / MM - length).abs() < 1e-3);
        let computed = point.map_or(f64::NAN, |point| point.rate / MM_PER_CYCLE);
        let what = format!("da/dN of the Virkler median at {length} mm, {method}, mm/cycle");
        table.compare(what, computed, rate, BOUND, "same readings, independent script");
        // Steps of 0.2 mm are shorter than E647 accepts, and a rate from them has to say so.
        let flagged = point.is_some_and(|point| point.flags.short_step);
        let what = format!("steps under 0.25 mm flagged at {length} mm, {method}");
        table.error(what, if flagged { 0.0 } else { 100.0 }, BOUND, "ASTM E647, 8.6.2");
    }
}
