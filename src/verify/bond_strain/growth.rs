//! Does da/dN follow the power law of ΔK that the exponent p stands for, in every specimen and with one A?
//!
//! Steady growth gives `da/dN = C ΔK^p` (bond lives of Silling and Askari 2014 integrated along the way of a bond through the
//! ageing zone), so the rate over `ΔK^p`, with ΔK of the handbook, must depend neither on crack length nor on the specimen.

use super::scene::PANEL;
use crate::calibration::model::cycles_since_first;
use crate::case::Case;
use crate::error::Result;
use crate::line::line;
use crate::predict::{Prediction, Silent, predict};
use crate::quadrature::integrate;
use crate::specimen::handbook::delta_k;
use crate::units::MM;
use crate::verify::Table;
use crate::verify::scene::{case, points};

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
    EXPONENTS.into_iter().try_for_each(|p| panel_follows(table, "", &[], p))
}

/// Exponent and largest deviation of the panel's rates from the power law, with these keys beside the usual ones.
///
/// # Errors
/// As [`predict`].
pub(super) fn panel_follows(table: &mut Table, what: &str, set: &[&str], p: f64) -> Result<()> {
    let exponent = format!("fatigue.p={p}");
    let panel = case(PANEL, &[&["model.spacing_mm=1", &exponent, "stop.crack_length_mm=45"], set].concat())?;
    let constants = constants(&panel, &predict(&panel, &Silent)?, p)?;
    let (slope, deviation) = power_law(&constants);
    let scene = format!("{what}M(T) 9-45 mm, spacing 1 mm, p {p}");
    table.compare(format!("{scene}: exponent of da/dN"), p + slope, p, 100.0 * 0.05 / p, SOURCE);
    table.error(format!("{scene}: largest deviation of a rate over 3 mm"), deviation, 4.0, SOURCE);
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
        let constants = constants(&scene, &predict(&scene, &Silent)?, EXPONENT)?;
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
driver = "bond_strain"
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
    let settled = cycles_between(&run, 20.0 * MM, 45.0 * MM)?;
    let constant = growth_integral(&panel, 20.0 * MM, 45.0 * MM, EXPONENT) / settled;
    for (from, to) in [(9.0, 49.8), (20.0, 49.8)] {
        let cycles = cycles_between(&run, from * MM, to * MM)?;
        let by_hand = growth_integral(&panel, from * MM, to * MM, EXPONENT) / constant;
        let quantity = format!("M(T) {from}-{to} mm, 1 mm: life over quadrature with C of 20-45 mm");
        table.compare(quantity, cycles / by_hand, 1.0, 5.0, SOURCE);
    }
    Ok(())
}

/// One growth rate at equal K for every law, Poisson's ratio and plane state, A moving with E'^p as that of a fitted law does.
///
/// # Errors
/// As [`predict`].
pub fn poissons_ratio(table: &mut Table) -> Result<()> {
    let life = |law: &str, plane: &str, nu: f64| -> Result<f64> {
        let keys = [format!("model.bond_law={law}"), format!("material.plane={plane}"), format!("material.poisson_ratio={nu}")];
        let set = ["specimen.width_mm=120", "specimen.length_mm=160", "specimen.crack_length_mm=20", "stop.crack_length_mm=30"];
        let case = case(PANEL, &[&set[..], &keys.each_ref().map(String::as_str)].concat())?;
        Ok(predict(&case, &Silent)?.life_cycles() / case.material.plane_modulus().powf(EXPONENT))
    };
    let aluminium = life("two_parameter", "stress", 0.33)?;
    for (law, plane, nu) in [
        ("two_parameter", "stress", 0.1),
        ("two_parameter", "stress", 0.2),
        ("two_parameter", "stress", 0.3),
        ("two_parameter", "strain", 0.2),
        ("state_based", "stress", 0.2),
        ("state_based", "stress", 0.4),
        ("state_based", "strain", 0.3),
        ("state_based", "strain", 0.4),
    ] {
        let quantity = format!("M(T) a 20-30 mm: life of {law} in plane {plane} at nu {nu} over two_parameter at 0.33");
        table.compare(quantity, life(law, plane, nu)? / aluminium, 1.0, 4.0, "equal K, equal C and m");
    }
    Ok(())
}

/// Constants C = ∫ da/ΔK^p / ΔN over windows of equal growth: (ΔK in the middle of the window, C), SI.
fn constants(case: &Case, run: &Prediction, p: f64) -> Result<Vec<(f64, f64)>> {
    let (first, last) = (case.specimen.crack_length, run.crack_length_final());
    let windows = ((last - first) / WINDOW * (1.0 + 1e-9)).floor() as usize;
    let constant = |i: usize| {
        let (from, to) = (first + i as f64 * WINDOW, first + (i + 1) as f64 * WINDOW);
        let middle = delta_k(&case.specimen, 0.5 * (from + to), case.loading.maximum, case.loading.range_share());
        Ok((middle.unwrap_or(f64::NAN), growth_integral(case, from, to, p) / cycles_between(run, from, to)?))
    };
    (0..windows).map(constant).collect()
}

/// ∫ da / ΔK^p between two lengths with the handbook's K.
pub(super) fn growth_integral(case: &Case, from: f64, to: f64, p: f64) -> f64 {
    let range = |length: f64| delta_k(&case.specimen, length, case.loading.maximum, case.loading.range_share());
    integrate(|length| range(length).map_or(f64::NAN, |k| k.powf(-p)), from, to, 1e-9).value
}

/// Cycles between two lengths of a run.
pub(super) fn cycles_between(run: &Prediction, from: f64, to: f64) -> Result<f64> {
    Ok(cycles_since_first(&points(run), &[from, to])?[1])
}

/// Least squares slope of ln C over ln ΔK, which is what the exponent is off by, and the largest deviation from the mean C in
/// percent.
fn power_law(constants: &[(f64, f64)]) -> (f64, f64) {
    let (log_k, log_c): (Vec<f64>, Vec<f64>) = constants.iter().map(|(k, c)| (k.ln(), c.ln())).unzip();
    let slope = line(&log_k, &log_c).map_or(f64::NAN, |line| line.slope);
    let mean = log_c.iter().sum::<f64>() / log_c.len() as f64;
    (slope, log_c.iter().map(|c| 100.0 * (c - mean).exp_m1()).fold(0.0, larger))
}

fn larger(a: f64, b: f64) -> f64 {
    if b.abs() > a.abs() { b } else { a }
}
