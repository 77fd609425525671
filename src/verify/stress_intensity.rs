//! Stress intensity factors of every method against handbooks and closed forms.

use std::f64::consts::PI;

use super::scene::case;
use super::table::Table;
use crate::case::Case;
use crate::error::Result;
use crate::predict::tip_factors::{StressIntensityMethod, TipResult, stress_intensity};

/// Material, load and model of all scenes; cracks are at least six horizons long.
const REST: &str = r#"
[material]
youngs_modulus_gpa = 72.0
poisson_ratio = 0.3
plane = "stress"
[loading]
stress_max_mpa = 100.0
stress_ratio = 0.1
[model]
spacing_mm = 1.5
[fatigue]
a = 6450.0
p = 2.86
horizon_mm = 3.015
"#;
pub(super) const MIDDLE: &str =
    "kind = \"middle_tension\"\nwidth_mm = 150\nlength_mm = 300\nthickness_mm = 2\ncrack_length_mm = 28\n";
const SINGLE: &str = "kind = \"single_edge_tension\"\nwidth_mm = 120\nlength_mm = 360\nthickness_mm = 2\ncrack_length_mm = 30\nends = \"uniform_stress\"\n";
const DOUBLE: &str = "kind = \"double_edge_tension\"\nwidth_mm = 150\nlength_mm = 300\nthickness_mm = 2\ncrack_length_mm = 30\n";
const COMPACT: &str = "kind = \"compact_tension\"\nwidth_mm = 120\nthickness_mm = 5\ncrack_length_mm = 48\n";
/// Its tip lies close to the holes, so that K depends on where the pins push.
const COMPACT_SHORT: &str = "kind = \"compact_tension\"\nwidth_mm = 120\nthickness_mm = 5\ncrack_length_mm = 30\n";
/// Spacings in half a crack of the plates that stand for an infinite one.
const HALF_CRACK: f64 = 18.0;
const SPACING_MM: f64 = 1.5;
const STRESS: f64 = 100e6;
/// Methods that tell the modes of a crack apart.
const BOTH_MODES: &[StressIntensityMethod] = &[StressIntensityMethod::Ring];

pub(super) fn scene(specimen: &str, set: &[&str]) -> Result<Case> {
    let text = format!("[specimen]\n{specimen}{REST}");
    let text =
        if specimen.contains("compact_tension") { text.replace("stress_max_mpa = 100.0", "force_max_n = 10000.0") } else { text };
    case(&text, set)
}

/// All rows of the topic.
pub fn all(table: &mut Table) -> Result<()> {
    standard_specimens(table)?;
    models(table)?;
    slanted_cracks(table)?;
    two_cracks(table)
}

/// K of the standard specimens and its independence of Poisson's ratio.
pub fn standard_specimens(table: &mut Table) -> Result<()> {
    let mut of_nu: Vec<Vec<f64>> = vec![Vec::new(); StressIntensityMethod::ALL.len()];
    for nu in [0.0, 0.1, 0.2, 0.3, 0.3333] {
        let panel = scene(MIDDLE, &[&format!("material.poisson_ratio={nu}")])?;
        for (values, (method, ratio)) in of_nu.iter_mut().zip(over_handbook(&panel)?) {
            values.push(ratio);
            let quantity = format!("M(T) a/W 0.19, nu {nu}: K_I by {method} over handbook");
            table.compare(quantity, ratio, 1.0, bound(method), "Feddersen 1966 (0.3 %)");
        }
    }
    for (values, method) in of_nu.iter().zip(StressIntensityMethod::ALL) {
        let (low, high) = values.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &v| (low.min(v), high.max(v)));
        table.error(
            format!("M(T): spread of K_I by {method} over nu 0 to 1/3"),
            100.0 * (high - low),
            0.5,
            "K does not depend on nu",
        );
    }
    for (name, specimen, source) in [
        ("SE(T) a/W 0.25", SINGLE, "Tada, Paris and Irwin 2000 (0.5 %)"),
        ("SE(T) a/W 0.25, pinned", &SINGLE.replace("uniform_stress", "pinned"), "Tada, Paris and Irwin 2000 (0.5 %)"),
        ("DE(T) 2a/W 0.4", DOUBLE, "Tada, Paris and Irwin 2000 (1 %)"),
        ("C(T) a/W 0.25", COMPACT_SHORT, "ASTM E647 (0.5 %)"),
        ("C(T) a/W 0.4", COMPACT, "ASTM E647 (0.5 %)"),
    ] {
        for (method, ratio) in over_handbook(&scene(specimen, &[])?)? {
            table.compare(format!("{name}: K_I by {method} over handbook"), ratio, 1.0, bound(method), source);
        }
    }
    Ok(())
}

/// Error of K_I over a handbook's, percent, that a method keeps to.
fn bound(method: StressIntensityMethod) -> f64 {
    if method == StressIntensityMethod::ElementFreeGalerkin { 0.3 } else { 1.5 }
}

/// K_I by the energy released with other spacings and surface corrections than the default.
fn models(table: &mut Table) -> Result<()> {
    let mut row = |what: String, set: &[&str], bound: f64| -> Result<()> {
        let tips = stress_intensity(&scene(MIDDLE, set)?, &[StressIntensityMethod::EnergyRelease])?;
        let ratio = tips[0].methods[0].intensity.k_i.zip(tips[0].handbook_k_i).map_or(f64::NAN, |(k, handbook)| k / handbook);
        table.compare(format!("{what}: K_I by energy_release over handbook"), ratio, 1.0, bound, "Feddersen 1966 (0.3 %)");
        Ok(())
    };
    for spacing in [3.0, 1.5, 0.75] {
        let key = format!("model.spacing_mm={spacing}");
        let set = ["specimen.width_mm=152.4", "specimen.crack_length_mm=18.2", &key];
        row(format!("M(T) a/W 0.12, spacing {spacing} mm"), &set, 0.3)?;
    }
    for (correction, bound) in [("volume_and_surface", 1.2), ("none", 2.5)] {
        for nu in [0.1, 0.3] {
            let set = [format!("model.surface_correction={correction}"), format!("material.poisson_ratio={nu}")];
            row(format!("M(T) a/W 0.19, surface correction {correction}, nu {nu}"), &[&set[0], &set[1]], bound)?;
        }
    }
    Ok(())
}

/// K_I of the first tip over the handbook's, for every method.
pub(super) fn over_handbook(case: &Case) -> Result<Vec<(StressIntensityMethod, f64)>> {
    let tips = stress_intensity(case, StressIntensityMethod::ALL)?;
    let handbook = tips[0].handbook_k_i.unwrap_or(f64::NAN);
    Ok(tips[0].methods.iter().map(|m| (m.method, m.intensity.k_i.unwrap_or(f64::NAN) / handbook)).collect())
}

/// Cracks of half length 1, by their ends.
type Cracks<'a> = &'a [[[f64; 2]; 2]];

/// A plate `width` half cracks wide and one and a half times as long; K over σ √(π a) of the tips is what is wanted.
fn plate(cracks: Cracks, half_crack_spacings: f64, width: f64, methods: &[StressIntensityMethod]) -> Result<Vec<TipResult>> {
    let a = half_crack_spacings * SPACING_MM;
    let crack = |ends: &[[f64; 2]; 2]| {
        let [[x, y], [u, v]] = ends.map(|end| end.map(|c| c * a));
        format!("{{ from_mm = [{x}, {y}], to_mm = [{u}, {v}] }}")
    };
    let cracks: Vec<String> = cracks.iter().map(crack).collect();
    let (width, length) = (width * a, 1.5 * width * a);
    let specimen = format!(
        "kind = \"plate\"\nwidth_mm = {width}\nlength_mm = {length}\nthickness_mm = 2\ncracks = [{}]\n",
        cracks.join(", ")
    );
    stress_intensity(&scene(&specimen, &[])?, methods)
}

/// Both factors of a tip against K over σ √(π a) of theory; a reference of 0 is left out.
fn compare_tip(table: &mut Table, name: &str, tip: &TipResult, half_crack_spacings: f64, reference: [f64; 2], source: &str) {
    let unit = STRESS * (PI * half_crack_spacings * SPACING_MM * 1e-3).sqrt();
    for result in &tip.methods {
        let factors = [result.intensity.k_i, result.intensity.k_ii];
        for (mode, (factor, reference)) in ["K_I", "K_II"].into_iter().zip(factors.into_iter().zip(reference)) {
            if reference != 0.0 {
                let computed = factor.unwrap_or(f64::NAN) / unit;
                table.compare(format!("{name}: {mode} by {}, unit σ√(πa)", result.method), computed, reference, 3.0, source);
            }
        }
    }
}

/// Slanted cracks in a wide plate: `K_I = σ √(π a) sin²β`, `K_II = σ √(π a) sin β cos β`, β to the load.
pub fn slanted_cracks(table: &mut Table) -> Result<()> {
    const HALF: f64 = 24.0;
    for to_horizontal in [30.0_f64, 45.0] {
        let (sin, cos) = to_horizontal.to_radians().sin_cos();
        let tips = plate(&[[[-cos, -sin], [cos, sin]]], HALF, 20.0, BOTH_MODES)?;
        let source = "infinite plate (Tada, Paris and Irwin 2000); plate 20 a wide, 30 a long";
        let name = format!("crack {}° to the load, a 8 horizons", 90.0 - to_horizontal);
        compare_tip(table, &name, &tips[0], HALF, [cos * cos, sin * cos], source);
    }
    Ok(())
}

/// Two equal cracks on one line and two above each other, in wide plates.
pub fn two_cracks(table: &mut Table) -> Result<()> {
    // Inner tips a half crack from the middle (c = 0.5, d = 1.5 crack lengths).
    let tips = plate(&[[[-3.0, 0.0], [-1.0, 0.0]], [[1.0, 0.0], [3.0, 0.0]]], HALF_CRACK, 24.0, StressIntensityMethod::ALL)?;
    let source = "two collinear cracks, closed form with elliptic integrals (Tada, Paris and Irwin 2000)";
    for (name, tip, reference) in [("outer", 0, 1.0280), ("inner", 1, 1.0480)] {
        compare_tip(table, &format!("two collinear cracks, {name} tip"), &tips[tip], HALF_CRACK, [reference, 0.0], source);
    }
    // Distance over crack length, K_I and size of K_II.
    for (distance, k_i, k_ii) in [(0.5, 0.773, 0.117), (1.0, 0.843, 0.061)] {
        let tips =
            plate(&[[[-1.0, -distance], [1.0, -distance]], [[-1.0, distance], [1.0, distance]]], HALF_CRACK, 20.0, BOTH_MODES)?;
        let name = format!("two stacked cracks, distance {distance} of their length");
        // The right tip of the lower crack slides in the positive sense.
        let source = "integral equation of two stacked cracks in an infinite plate, three digits";
        compare_tip(table, &name, &tips[1], HALF_CRACK, [k_i, k_ii], source);
    }
    Ok(())
}
