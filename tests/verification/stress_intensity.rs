//! K_I from the energy released between two crack lengths, against handbook formulas.
//!
//! At constant load a crack that grows by da releases half the work the loads do: `G = d(f·u)/2 / (tips h da)`,
//! `K = √(E' G)`. Cracks one spacing longer and shorter give the central difference.

use perilife::case::Case;
use perilife::solver::SolverKind;
use perilife::specimen::handbook::handbook;
use perilife::units::MM;

use crate::plates::{PANEL, case};
use crate::statics::loaded;

/// K by energy release at a crack length, Pa√m, and the case of that length.
fn k_released(specimen: &str, set: &[String], crack_length_mm: f64, spacing_mm: f64) -> (f64, Case) {
    let with = |length: f64| -> Case {
        let own = [format!("specimen.crack_length_mm={length}"), format!("model.spacing_mm={spacing_mm}")];
        let all: Vec<&str> = own.iter().chain(set).map(String::as_str).collect();
        case(specimen, &all)
    };
    // The spacing that divides the width: then both cracks end at the same place between two columns.
    let here = with(crack_length_mm);
    let step = here.specimen.gross_width / (here.specimen.gross_width / (spacing_mm * MM)).round() / MM;
    let [shorter, longer] = [-step, step].map(|more| loaded(&with(crack_length_mm + more), SolverKind::Multigrid).unwrap().work);
    let tips = here.specimen.tips.len() as f64;
    let released = 0.5 * (longer - shorter) / (tips * here.specimen.thickness * 2.0 * step * MM);
    ((here.material.plane_modulus() * released).sqrt(), here)
}

/// The same over the handbook's K.
pub fn k_over_handbook(specimen: &str, set: &[String], crack_length_mm: f64, spacing_mm: f64) -> f64 {
    let (k, case) = k_released(specimen, set, crack_length_mm, spacing_mm);
    k / handbook(&case.specimen).unwrap().k_i(case.specimen.crack_length, case.loading.maximum)
}

const SPACING_MM: f64 = 1.5;
/// Half crack lengths of the panel from 4 horizons to 0.6 of the half width, mm.
const LENGTHS_MM: [f64; 3] = [18.2, 30.0, 45.0];

fn panel(rotation: &str, correction: &str, nu: f64) -> [f64; 3] {
    let set = [
        format!("model.rotation={rotation}"),
        format!("model.surface_correction={correction}"),
        format!("material.poisson_ratio={nu}"),
    ];
    LENGTHS_MM.map(|a| k_over_handbook(PANEL, &set, a, SPACING_MM))
}

#[test]
fn a_centre_crack_has_the_handbook_k_whatever_poissons_ratio() {
    for correction in ["balanced", "volume_and_surface", "none"] {
        let [a, b, c] = [0.1, 0.2, 0.3].map(|nu| {
            let ratios = panel("free", correction, nu);
            println!("{correction}, nu {nu}: K over handbook at {LENGTHS_MM:?} mm: {ratios:.4?}");
            ratios
        });
        for i in 0..LENGTHS_MM.len() {
            let at_length = [a[i], b[i], c[i]];
            for ratio in at_length {
                // Reached: 1.2 % balanced, 0.7 % with the classical correction, 2.2 % without; 4 % is what was asked for. What is
                // left falls with the spacing, see below.
                let bound = if correction == "none" { 0.025 } else { 0.0125 };
                assert!((ratio - 1.0).abs() < bound, "{correction}: {ratio} at {} mm", LENGTHS_MM[i]);
            }
            let (low, high) = at_length.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), &r| (l.min(r), h.max(r)));
            // Reached: 0.24 % balanced, 0.1 % with the classical correction.
            assert!(high - low < 0.003, "{correction}: {low} to {high} over nu at {} mm", LENGTHS_MM[i]);
        }
    }
}

/// Error of K with the balanced correction: 3.5 % at 3 mm, 1.0 % at 1.5 mm, 0.5 % at 0.75 mm (a = 18.2 mm, handbook good to 0.3 %).
#[test]
fn k_converges_with_the_spacing() {
    let set = ["model.surface_correction=balanced".to_owned()];
    let [coarse, middle, fine] = [3.0, 1.5, 0.75].map(|spacing| k_over_handbook(PANEL, &set, LENGTHS_MM[0], spacing) - 1.0);
    println!("balanced, K over handbook less 1 at 3, 1.5, 0.75 mm: {coarse:.4}, {middle:.4}, {fine:.4}");
    assert!(middle.abs() < 0.5 * coarse.abs() && fine.abs() < 0.7 * middle.abs());
}

/// A spring that resists the rotation of crack flanks carries part of the load past the tip: the test above can fail.
#[test]
fn the_resisted_law_loses_k_at_low_poissons_ratio() {
    let ratios = panel("resisted", "volume_and_surface", 0.1);
    println!("resisted, nu 0.1: K over handbook {ratios:.4?}");
    // Reached: 24 to 29 % low.
    assert!(ratios.iter().all(|&ratio| ratio < 0.95));
}

pub const SINGLE: &str = "kind=\"single_edge_tension\"\nwidth_mm=100\nlength_mm=300\nthickness_mm=2\ncrack_length_mm=30\n";

#[test]
fn the_other_specimens_have_the_handbook_k() {
    let [uniform, pinned] = ["uniform_stress", "pinned"].map(|ends| format!("{SINGLE}ends=\"{ends}\"\n"));
    let double = "kind=\"double_edge_tension\"\nwidth_mm=150\nlength_mm=300\nthickness_mm=2\ncrack_length_mm=30\n";
    let compact = "kind=\"compact_tension\"\nwidth_mm=100\nthickness_mm=5\ncrack_length_mm=40\n";
    // Bounds: what is reached, rounded up; the formulas themselves are good to 0.5 % (single edge, compact) and 1 %.
    for (name, specimen, spacing, lengths, bound) in [
        ("single edge", uniform.as_str(), 1.25, [23.0, 40.0, 58.0], 0.02),
        ("single edge, pinned", &pinned, 1.25, [23.0, 40.0, 58.0], 0.02),
        ("double edge", double, 1.5, [28.0, 40.0, 50.0], 0.02),
        ("compact", compact, 1.25, [25.0, 40.0, 60.0], 0.04),
    ] {
        for correction in ["balanced", "volume_and_surface"] {
            let set = [format!("model.surface_correction={correction}")];
            let ratios = lengths.map(|a| k_over_handbook(specimen, &set, a, spacing));
            println!("{correction}, {name}: K over handbook at {lengths:?} mm: {ratios:.4?}");
            assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < bound), "{correction}, {name}: {ratios:?}");
        }
    }
}

/// Clamped ends cannot turn and take the bending off the crack: F = K/(σ √(π a)) at a/W = 0.5 is 1.7 at length/width 4 and 1.3
/// at 2 instead of 2.83 (finite elements, two digits).
#[test]
fn clamped_ends_take_the_bending_off() {
    for (over_width, reference) in [(4.0, 1.7), (2.0, 1.3)] {
        let set = [format!("specimen.length_mm={}", 100.0 * over_width), "specimen.ends=clamped".to_owned()];
        let (k, case) = k_released(&format!("{SINGLE}ends=\"pinned\"\n"), &set, 50.0, 2.0);
        let factor = k / (case.loading.maximum * (std::f64::consts::PI * case.specimen.crack_length).sqrt());
        println!("clamped, length/width {over_width}: F = {factor:.3}");
        assert!((factor - reference).abs() < 0.1, "length/width {over_width}: {factor} against {reference}");
    }
}
