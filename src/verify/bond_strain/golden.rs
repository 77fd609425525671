//! The golden lives once more, by peridynamics.
//!
//! C and m are translated into bonds as a user does it: p = m, and A from one panel whose a-N curve hand calculation gives
//! (least squares in cycles at equal length; lives go with 1/A exactly). With that A other lengths and another specimen are
//! computed, and compared with hand calculation for them.

use crate::calibration::criterion::Criterion;
use crate::calibration::misfit::inverse_a;
use crate::calibration::model::cycles_since_first;
use crate::error::Result;
use crate::predict::{Prediction, Silent, StopReason, predict};
use crate::units::MM;
use crate::verify::Table;
use crate::verify::golden::{COMPACT, PANEL, ended_by};
use crate::verify::scene::{case, points};

/// Bound of the golden lives by peridynamics, percent.
const BOUND: f64 = 5.0;
/// Any A will do: lives are scaled to the one that fits.
const BONDS: [&str; 4] = ["model.method=peridynamics", "fatigue.driver=bond_strain", "fatigue.a=1e4", "fatigue.horizon_mm=3.015"];
/// Keys of the law over K, in whose place that of bonds stands.
const LAW_OVER_K: &str = "paris_";
/// Lengths at which a panel is compared with its hand calculation, mm apart.
const STEP_MM: usize = 1;

/// Golden lives by peridynamics, 1 mm spacing in the panel and 0.5 mm in the compact specimen.
///
/// # Errors
/// As [`predict`]; a life that ends for another reason than it should.
pub fn by_bonds(table: &mut Table) -> Result<()> {
    let m = ["fatigue.p=2.874", "model.spacing_mm=1"];
    let strong = [&m[..], &["material.yield_strength_mpa=345"]].concat();
    let whole = bonds(PANEL, &strong)?;
    ended_by(&whole, StopReason::NetSectionYield, "M(T) of yield strength 345 MPa")?;
    let scale = scale(&whole, PANEL, &[], [9, 49])?;
    let life = |run: &Prediction, from: f64, to: f64| -> Result<f64> {
        Ok(scale * cycles_since_first(&points(run), &[from * MM, to * MM])?[1])
    };
    let source = "golden life by hand calculation; A fitted to the same panel from 9 to 49 mm";
    table.compare("M(T) 9 to 49.8 mm, 1 mm spacing: cycles", life(&whole, 9.0, 49.8)?, 247_247.0, BOUND, source);
    table.compare("M(T) to K_max = 40 MPa√m at 56.154 mm: cycles", life(&whole, 9.0, 56.154)?, 251_721.0, BOUND, source);
    table.compare("M(T) to net-section yield: cycles", scale * whole.life_cycles(), 254_287.0, BOUND, source);
    table.compare(
        "M(T) net-section yield at a, mm",
        whole.crack_length_final() / MM,
        62.871,
        0.1,
        "W σ_max / (W - 2a) = 345 MPa",
    );

    let later = bonds(PANEL, &[&m[..], &["specimen.crack_length_mm=20", "stop.crack_length_mm=49.8"]].concat())?;
    let source = "golden life by hand calculation; A fitted to the panel from 9 mm";
    table.compare("M(T) 20 to 49.8 mm, 1 mm spacing: cycles", scale * later.life_cycles(), 91_814.0, BOUND, source);
    compact(table)
}

/// Another specimen at another spacing, with the A of a panel.
fn compact(table: &mut Table) -> Result<()> {
    let length = "specimen.crack_length_mm=20";
    let paris = ["fatigue.paris_m=3", "fatigue.paris_c_mm_per_cycle=1.647547e-8", length];
    let panel = bonds(PANEL, &[length, "fatigue.p=3", "model.spacing_mm=1", "stop.crack_length_mm=49.8"])?;
    let scale = scale(&panel, PANEL, &paris, [20, 49])?;
    let run = bonds(COMPACT, &["fatigue.p=3", "model.spacing_mm=0.5"])?;
    let source = "golden life by hand calculation; A fitted to a middle-tension panel";
    table.compare("C(T) 12.5 to 30 mm, 0.5 mm spacing: cycles", scale * run.life_cycles(), 127_411.0, BOUND, source);
    Ok(())
}

fn bonds(text: &str, set: &[&str]) -> Result<Prediction> {
    let text: Vec<&str> = text.lines().filter(|line| !line.starts_with(LAW_OVER_K)).collect();
    predict(&case(&text.join("\n"), &[&BONDS[..], set].concat())?, &Silent)
}

/// What the cycles of a run have to be multiplied with to be nearest to hand calculation between two lengths in mm.
fn scale(run: &Prediction, text: &str, set: &[&str], window_mm: [usize; 2]) -> Result<f64> {
    let end = format!("stop.crack_length_mm={}", window_mm[1]);
    let by_hand = predict(&case(text, &[set, &[&end]].concat())?, &Silent)?;
    let lengths: Vec<f64> = (window_mm[0]..=window_mm[1]).step_by(STEP_MM).map(|length| length as f64 * MM).collect();
    Ok(inverse_a(
        Criterion::FirstReading,
        &cycles_since_first(&points(run), &lengths)?,
        &cycles_since_first(&points(&by_hand), &lengths)?,
    ))
}
