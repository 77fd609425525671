//! The golden lives once more, by peridynamics with the same C and m.

use super::golden::{COMPACT, PANEL, ended_by};
use super::scene::case;
use super::table::Table;
use crate::error::Result;
use crate::predict::{Silent, StopReason, predict};
use crate::units::MM;

/// Bound of a life, percent.
const BOUND: f64 = 1.0;
const SOURCE: &str = "golden life by hand calculation";

/// Golden lives, 1 mm spacing in the panel and 0.5 mm in the compact specimen.
///
/// # Errors
/// As [`predict`]; a life that ends for another reason than it should.
pub fn by_tips(table: &mut Table) -> Result<()> {
    let run = |text: &str, set: &[&str]| predict(&case(text, &[&["model.method=peridynamics"], set].concat())?, &Silent);
    for (from, to, cycles) in [(9.0, 49.8, 247_247.0), (9.0, 56.154, 251_721.0), (20.0, 49.8, 91_814.0)] {
        let range = [format!("specimen.crack_length_mm={from}"), format!("stop.crack_length_mm={to}")];
        let run = run(PANEL, &["model.spacing_mm=1", &range[0], &range[1]])?;
        ended_by(&run, StopReason::CrackLengthReached, "M(T)")?;
        table.compare(format!("M(T) {from} to {to} mm, 1 mm spacing: cycles"), run.life_cycles(), cycles, BOUND, SOURCE);
    }
    let whole = run(PANEL, &["model.spacing_mm=1", "material.yield_strength_mpa=345"])?;
    ended_by(&whole, StopReason::NetSectionYield, "M(T) of yield strength 345 MPa")?;
    table.compare("M(T) to net-section yield: cycles", whole.life_cycles(), 254_287.0, BOUND, SOURCE);
    let end = whole.crack_length_final() / MM;
    table.compare("M(T) net-section yield at a, mm", end, 62.871, 0.1, "W σ_max / (W - 2a) = 345 MPa");
    let compact = run(COMPACT, &["model.spacing_mm=0.5"])?;
    table.compare("C(T) 12.5 to 30 mm, 0.5 mm spacing: cycles", compact.life_cycles(), 127_411.0, BOUND, SOURCE);
    Ok(())
}
