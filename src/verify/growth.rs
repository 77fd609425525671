//! Does da/dN follow the power law of ΔK that the exponent p stands for?
//!
//! Steady growth gives `da/dN = C ΔK^p` (theory: bond lives of Silling and Askari 2014 integrated along the way of a bond
//! through the ageing zone), so the rate over `ΔK^p`, with ΔK of the handbook, must not depend on the crack length.

use super::scene::{PANEL, case};
use super::table::Table;
use crate::error::Result;
use crate::predict::{CurvePoint, Silent, predict};
use crate::units::MM;

/// Exponents of the study: low (2) to high (4), with those of aluminium between.
const EXPONENTS: [f64; 5] = [2.0, 2.5, 2.87, 3.2, 4.0];
/// Length of crack over which a local rate is taken, m: about one horizon of the panel's model, what a laboratory reads.
const WINDOW: f64 = 3.0 * MM;

/// Growth law of a middle-tension panel from 9 to 45 mm.
///
/// # Errors
/// As [`predict`].
pub fn middle_tension(table: &mut Table) -> Result<()> {
    for p in EXPONENTS {
        let panel = case(PANEL, &[&format!("fatigue.p={p}"), "stop.crack_length_mm=45"])?;
        let rates = local_rates(&predict(&panel, &Silent)?.curve, WINDOW);
        let (slope, scatter) = power_law(&rates, p);
        table.compare(format!("M(T) 9-45 mm, 1 mm spacing, p {p}: exponent of da/dN"), slope, p, 100.0 * 0.05 / p, SOURCE);
        table.error(format!("M(T) 9-45 mm, 1 mm spacing, p {p}: largest deviation of the local rate"), scatter, 4.0, SOURCE);
    }
    Ok(())
}

const SOURCE: &str = "power law with handbook K (secant; Feddersen 1966)";

/// Secant rates over windows of equal growth: (ΔK at the window's middle, da/dN), SI.
#[must_use]
pub fn local_rates(curve: &[CurvePoint], window: f64) -> Vec<(f64, f64)> {
    let mut rates = Vec::new();
    let mut from = 0;
    for to in 1..curve.len() {
        let grown = curve[to].crack_length - curve[from].crack_length;
        if grown >= window {
            let rate = grown / (curve[to].cycles - curve[from].cycles);
            let middle = 0.5 * (curve[to].crack_length + curve[from].crack_length);
            let inside = curve[from..=to].windows(2).find(|pair| pair[1].crack_length >= middle);
            rates.extend(inside.map(|pair| (pair[1].delta_k, rate)));
            from = to;
        }
    }
    rates
}

/// Slope of log rate over log ΔK, and the largest deviation in percent of a rate from the law of exponent `p` with the
/// constant that fits best.
#[must_use]
pub fn power_law(rates: &[(f64, f64)], p: f64) -> (f64, f64) {
    let count = rates.len() as f64;
    let logs: Vec<(f64, f64)> = rates.iter().map(|(k, rate)| (k.ln(), rate.ln())).collect();
    let mean = |pick: &dyn Fn(&(f64, f64)) -> f64| logs.iter().map(pick).sum::<f64>() / count;
    let (x, y) = (mean(&|l| l.0), mean(&|l| l.1));
    let slope = logs.iter().map(|l| (l.0 - x) * (l.1 - y)).sum::<f64>() / logs.iter().map(|l| (l.0 - x).powi(2)).sum::<f64>();
    let constant = mean(&|l| l.1 - p * l.0);
    let deviation = logs.iter().map(|l| 100.0 * (l.1 - p * l.0 - constant).exp_m1()).fold(0.0, |worst: f64, d| {
        if d.abs() > worst.abs() { d } else { worst }
    });
    (slope, deviation)
}
