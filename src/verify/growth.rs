//! Does da/dN follow the power law of ΔK that the exponent p stands for, in every specimen and with one A?
//!
//! Steady growth gives `da/dN = C ΔK^p` (bond lives of Silling and Askari 2014 integrated along the way of a bond through the
//! ageing zone), so the rate over `ΔK^p`, with ΔK of the handbook, must depend neither on crack length nor on the specimen.

use super::scene::{PANEL, case};
use super::table::Table;
use crate::case::Case;
use crate::error::Result;
use crate::predict::{CurvePoint, Prediction, Silent, predict};
use crate::specimen::handbook::handbook;
use crate::units::MM;

/// Exponents of the study: low (2) to high (4), with those of aluminium between.
const EXPONENTS: [f64; 5] = [2.0, 2.5, 2.87, 3.2, 4.0];
/// Exponent of the comparison of specimens.
const EXPONENT: f64 = 2.87;
/// Length of crack over which a local rate is taken, m: what a laboratory reads.
const WINDOW: f64 = 3.0 * MM;

const SOURCE: &str = "power law with handbook K";

/// Growth law of a middle-tension panel from 9 to 45 mm.
///
/// # Errors
/// As [`predict`].
pub fn middle_tension(table: &mut Table) -> Result<()> {
    for p in EXPONENTS {
        let panel = case(PANEL, &["model.spacing_mm=1", &format!("fatigue.p={p}"), "stop.crack_length_mm=45"])?;
        let constants = constants(&panel, &predict(&panel, &Silent)?.curve, p);
        let (slope, deviation) = power_law(&constants);
        let scene = format!("M(T) 9-45 mm, spacing 1 mm, p {p}");
        table.compare(format!("{scene}: exponent of da/dN"), p + slope, p, 100.0 * 0.05 / p, SOURCE);
        table.error(format!("{scene}: largest deviation of a rate over 3 mm"), deviation, 4.0, SOURCE);
    }
    Ok(())
}

/// Middle tension, single edge and compact tension with one A.
///
/// # Errors
/// As [`predict`].
pub fn specimens(table: &mut Table) -> Result<()> {
    let scenes: [(&str, &[&str]); 3] = [
        ("M(T) W 152.4, a 20-45 mm", &["specimen.crack_length_mm=20", "stop.crack_length_mm=45"]),
        (
            "single edge, W 100, a 20-50 mm",
            &[
                "specimen.kind=single_edge_tension",
                "specimen.ends=uniform_stress",
                "specimen.width_mm=100",
                "specimen.crack_length_mm=20",
                "stop.crack_length_mm=50",
            ],
        ),
        ("compact tension, W 100, a 30-60 mm", &[]),
    ];
    let mut all: Vec<(f64, f64)> = Vec::new();
    let mut of_scene = Vec::new();
    for (name, set) in scenes {
        let text = if set.is_empty() { COMPACT } else { PANEL };
        let scene = case(text, &[set, &["model.spacing_mm=1", &format!("fatigue.p={EXPONENT}")]].concat())?;
        let constants = constants(&scene, &predict(&scene, &Silent)?.curve, EXPONENT);
        all.extend(&constants);
        of_scene.push((name, constants));
    }
    let common = all.iter().map(|(_, c)| c.ln()).sum::<f64>() / all.len() as f64;
    for (name, constants) in of_scene {
        let worst = constants.iter().map(|(_, c)| 100.0 * (c.ln() - common).exp_m1()).fold(0.0, larger);
        table.error(format!("{name}, 1 mm: largest deviation from the common line, one A"), worst, 5.0, SOURCE);
    }
    Ok(())
}

/// A C(T) specimen of the same alloy.
const COMPACT: &str = r#"
[specimen]
kind = "compact_tension"
width_mm = 100.0
thickness_mm = 5.0
crack_length_mm = 30.0
[material]
youngs_modulus_gpa = 73.1
poisson_ratio = 0.33
plane = "stress"
[loading]
force_range_n = 4000.0
stress_ratio = 0.2
[fatigue]
a = 1.6e4
p = 2.87
horizon_mm = 3.015
[stop]
crack_length_mm = 60.0
"#;

/// The stress along the crack has no K and must not count.
///
/// # Errors
/// As [`predict`].
pub fn biaxial(table: &mut Table) -> Result<()> {
    let life = |ratio: &str| -> Result<f64> {
        let set = ["specimen.width_mm=200", "specimen.length_mm=200", "specimen.crack_length_mm=10", "stop.crack_length_mm=30"];
        let ratio = format!("loading.stress_parallel_ratio={ratio}");
        Ok(predict(&case(PANEL, &[&set[..], &["model.spacing_mm=1", &ratio]].concat())?, &Silent)?.life_cycles())
    };
    let alone = life("0")?;
    for ratio in ["-1", "1"] {
        let quantity = format!("square plate 200 mm, a 10-30 mm: life at biaxiality {ratio} over that at 0");
        table.compare(quantity, life(ratio)? / alone, 1.0, 4.0, "K does not depend on the stress along the crack");
    }
    Ok(())
}

/// Lives of whole runs against the handbook's power law with the constant of the middle of the panel.
///
/// # Errors
/// As [`predict`].
pub fn lives(table: &mut Table) -> Result<()> {
    let panel = case(PANEL, &["model.spacing_mm=1", "stop.crack_length_mm=49.8"])?;
    let run: Prediction = predict(&panel, &Silent)?;
    let settled = cycles_at(&run.curve, 45.0 * MM) - cycles_at(&run.curve, 20.0 * MM);
    let constant = growth_integral(&panel, 20.0 * MM, 45.0 * MM, EXPONENT) / settled;
    for (from, to) in [(9.0, 49.8), (20.0, 49.8)] {
        let cycles = cycles_at(&run.curve, to * MM) - cycles_at(&run.curve, from * MM);
        let by_hand = growth_integral(&panel, from * MM, to * MM, EXPONENT) / constant;
        let quantity = format!("M(T) {from}-{to} mm, 1 mm: life over quadrature with C of 20-45 mm");
        table.compare(quantity, cycles / by_hand, 1.0, 5.0, SOURCE);
    }
    Ok(())
}

/// Constants C = ∫ da/ΔK^p / ΔN over windows of equal growth: (ΔK in the middle of the window, C), SI.
fn constants(case: &Case, curve: &[CurvePoint], p: f64) -> Vec<(f64, f64)> {
    let Some(formula) = handbook(&case.specimen) else { return Vec::new() };
    let (first, last) = (curve[0].crack_length, curve[curve.len() - 1].crack_length);
    let windows = ((last - first) / WINDOW * (1.0 + 1e-9)).floor() as usize;
    (0..windows)
        .map(|i| {
            let (from, to) = (first + i as f64 * WINDOW, first + (i + 1) as f64 * WINDOW);
            let cycles = cycles_at(curve, to) - cycles_at(curve, from);
            let middle = formula.delta_k(0.5 * (from + to), case.loading.maximum, case.loading.range_share());
            (middle, growth_integral(case, from, to, p) / cycles)
        })
        .collect()
}

/// ∫ da / ΔK^p between two lengths with the handbook's K, by Simpson's rule.
fn growth_integral(case: &Case, from: f64, to: f64, p: f64) -> f64 {
    const PARTS: usize = 200;
    let Some(formula) = handbook(&case.specimen) else { return f64::NAN };
    let step = (to - from) / PARTS as f64;
    let value = |i: usize| {
        let weight = if i == 0 || i == PARTS { 1.0 } else { 2.0 + 2.0 * (i % 2) as f64 };
        weight * formula.delta_k(from + i as f64 * step, case.loading.maximum, case.loading.range_share()).powf(-p)
    };
    (0..=PARTS).map(value).sum::<f64>() * step / 3.0
}

/// Cycles at which a curve reaches a length, linear between rows.
#[must_use]
pub fn cycles_at(curve: &[CurvePoint], crack_length: f64) -> f64 {
    let next = curve.partition_point(|point| point.crack_length < crack_length * (1.0 - 1e-12)).min(curve.len() - 1);
    if next == 0 {
        return curve[0].cycles;
    }
    let (a, b) = (&curve[next - 1], &curve[next]);
    let share = ((crack_length - a.crack_length) / (b.crack_length - a.crack_length)).clamp(0.0, 1.0);
    a.cycles + share * (b.cycles - a.cycles)
}

/// Least squares slope of ln C over ln ΔK, which is what the exponent is off by, and the largest deviation from the mean C in
/// percent.
fn power_law(constants: &[(f64, f64)]) -> (f64, f64) {
    let count = constants.len() as f64;
    let (x, y) = constants.iter().fold((0.0, 0.0), |(x, y), (k, c)| (x + k.ln() / count, y + c.ln() / count));
    let cross: f64 = constants.iter().map(|(k, c)| (k.ln() - x) * (c.ln() - y)).sum();
    let slope = cross / constants.iter().map(|(k, _)| (k.ln() - x).powi(2)).sum::<f64>();
    (slope, constants.iter().map(|(_, c)| 100.0 * (c.ln() - y).exp_m1()).fold(0.0, larger))
}

fn larger(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}
