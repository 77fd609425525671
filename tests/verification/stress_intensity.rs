//! K_I and K_II where `perilife verify stress_intensity` has no row: pins, clamped ends, places between columns, signs.

use perilife_growth::predict::tip_factors::{StressIntensityMethod, TipResult, stress_intensity};

use crate::support::plates::{PANEL, case};

fn first_tip(specimen: &str, set: &[String], methods: &[StressIntensityMethod]) -> TipResult {
    let all: Vec<&str> = set.iter().map(String::as_str).collect();
    stress_intensity(&case(specimen, &all), methods).unwrap().remove(0)
}

/// K_I by one method over the handbook's at a crack length.
fn ratio(method: StressIntensityMethod, specimen: &str, set: &[String], crack_length_mm: f64, spacing_mm: f64) -> f64 {
    let own = [format!("specimen.crack_length_mm={crack_length_mm}"), format!("model.spacing_mm={spacing_mm}")];
    let tip = first_tip(specimen, &own.iter().chain(set).cloned().collect::<Vec<_>>(), &[method]);
    tip.methods[0].intensity.k_i.unwrap() / tip.handbook_k_i.unwrap()
}

/// The same from the ring.
pub fn k_over_handbook(specimen: &str, set: &[String], crack_length_mm: f64, spacing_mm: f64) -> f64 {
    ratio(StressIntensityMethod::Ring, specimen, set, crack_length_mm, spacing_mm)
}

/// A spring that resists the rotation of crack flanks carries part of the load past the tip.
#[test]
fn the_resisted_law_loses_k_at_low_poissons_ratio() {
    let set = ["model.rotation=resisted", "model.surface_correction=volume_and_surface", "material.poisson_ratio=0.1"];
    let ratios = [18.2, 30.0, 45.0].map(|a| k_over_handbook(PANEL, &set.map(str::to_owned), a, 1.5));
    // Reached: 24 to 29 % low.
    assert!(ratios.iter().all(|&ratio| ratio < 0.95));
}

pub const SINGLE: &str = "kind=\"single_edge_tension\"\nwidth_mm=100\nlength_mm=300\nthickness_mm=2\ncrack_length_mm=30\n";

/// A compact specimen written as a plate, its pins touching over an arc: K of a short crack depends on how far the pressure
/// reaches round the hole. Over the formula of E647 at a/W = 0.25 finite elements give 0.9996, 1.0048 and 1.0239 for
/// half angles of 15, 45 and 90° (quadratic triangles, 8800 nodes, J over two rings).
#[test]
fn the_arc_of_a_pin_has_the_k_of_finite_elements() {
    let compact = "kind=\"compact_tension\"\nwidth_mm=100\nthickness_mm=5\ncrack_length_mm=25\n";
    let plate = "kind=\"plate\"\noutline_mm=[[-25,-60],[100,-60],[100,60],[-25,60]]\nthickness_mm=5\n\
                 holes=[{x_mm=0,y_mm=27.5,diameter_mm=25},{x_mm=0,y_mm=-27.5,diameter_mm=25}]\n\
                 cracks=[{from_mm=[-25,0],to_mm=[25,0]}]\n[loading]\nforce_max_n=4000.0\nstress_ratio=0.1\n";
    let (set, method) = (["model.spacing_mm=1.25".to_owned()], [StressIntensityMethod::Ring]);
    let k_i = |tip: &TipResult| tip.methods[0].intensity.k_i.unwrap();
    let specimen = first_tip(compact, &set, &method);
    let handbook = specimen.handbook_k_i.unwrap();
    let arcs =
        [(",contact_half_angle_deg=15", 0.9996), (",contact_half_angle_deg=45", 1.0048), (",contact_half_angle_deg=90", 1.0239)];
    let over_elements = arcs.map(|(half_angle, reference)| {
        let pin = |hole, y| format!("{{hole={hole},direction=[0,{y}]{half_angle}}}");
        let pins = format!("{plate}pins=[{},{}]\n", pin(0, 1), pin(1, -1));
        let tip = first_tip(&pins, &set, &method);
        if half_angle.ends_with("15") {
            assert!((k_i(&tip) / k_i(&specimen) - 1.0).abs() < 1e-6, "the plate is the specimen");
        }
        k_i(&tip) / handbook / reference
    });
    for ratio in over_elements {
        // Reached: 0.35 %, and 0.1 % between arcs.
        assert!((ratio - 1.0).abs() < 0.01 && (ratio / over_elements[0] - 1.0).abs() < 0.002, "{over_elements:?}");
    }
}

/// Clamped ends cannot turn and take the bending off the crack: F = K/(σ √(π a)) at a/W = 0.5 is 1.7 at length/width 4 and 1.3
/// at 2 instead of 2.83 (finite elements, two digits).
#[test]
fn clamped_ends_take_the_bending_off() {
    for (over_width, reference) in [(4.0, 1.7), (2.0, 1.3)] {
        let set = [format!("specimen.length_mm={}", 100.0 * over_width), "specimen.ends=clamped".to_owned()]
            .into_iter()
            .chain(["specimen.crack_length_mm=50".to_owned(), "model.spacing_mm=2".to_owned()]);
        let tip = first_tip(&format!("{SINGLE}ends=\"pinned\"\n"), &set.collect::<Vec<_>>(), StressIntensityMethod::ALL);
        for result in &tip.methods {
            let factor = result.intensity.k_i.unwrap() / (70e6 * (std::f64::consts::PI * 50e-3).sqrt());
            println!("clamped, length/width {over_width}, {}: F = {factor:.3}", result.method);
            assert!((factor - reference).abs() < 0.05, "length/width {over_width}: {factor} against {reference}");
        }
        assert_eq!(tip.handbook_k_i, None, "the formula is for ends that turn");
    }
}

/// Cracks of six horizons: what is asked for is 1.5 %, at every place between two columns.
#[test]
fn every_method_agrees_with_the_handbook_between_columns() {
    for &method in StressIntensityMethod::ALL {
        let lengths = [27.0, 27.4, 27.8, 28.2].map(|a| ratio(method, PANEL, &[], a, 1.5));
        assert!(lengths.iter().all(|ratio| (ratio - 1.0).abs() < 0.015), "{method}: {lengths:?}");
        let (low, high) = lengths.iter().fold((f64::MAX, f64::MIN), |(low, high), &v| (low.min(v), high.max(v)));
        // Reached: 0.2 %. Without the correction to the length asked for it is 1.4 %.
        assert!(high - low < 0.004, "{method}: {lengths:?}");
    }
}

/// `K_I = σ √(π a) cos²φ`, `K_II = σ √(π a) sin φ cos φ` for a crack φ off the horizontal under vertical tension, in an
/// infinite plate; this one is 14 a wide and 21 a long, which adds 1.3 % (secant of the width).
#[test]
fn a_slant_crack_has_both_modes_with_their_signs() {
    let a = 18.0;
    for phi in [30.0_f64, -30.0] {
        let (sin, cos) = phi.to_radians().sin_cos();
        let (x, y) = (a * cos, a * sin);
        let specimen = format!(
            "kind=\"plate\"\nwidth_mm={}\nlength_mm={}\nthickness_mm=2\ncracks=[{{from_mm=[{},{}],to_mm=[{x},{y}]}}]\n",
            14.0 * a,
            21.0 * a,
            -x,
            -y
        );
        let case = case(&specimen, &["model.spacing_mm=1"]);
        let tips = stress_intensity(&case, &[StressIntensityMethod::Ring]).unwrap();
        let unit = 70e6 * (std::f64::consts::PI * a * 1e-3).sqrt() * 1.013;
        for result in tips.iter().flat_map(|tip| &tip.methods) {
            let [k_i, k_ii] = [result.intensity.k_i, result.intensity.k_ii].map(|k| k.unwrap() / unit);
            let errors = [k_i / (cos * cos) - 1.0, k_ii / (sin * cos) - 1.0];
            assert!(errors.iter().all(|error| error.abs() < 0.03), "{phi}°, {}: {errors:?}", result.method);
        }
    }
}
