//! K_I and K_II of every method against handbook formulas and closed forms.

use perilife::stress_intensity::{StressIntensityMethod, TipResult, stress_intensity};

use crate::plates::{PANEL, case};

/// Factors of the first tip of a case.
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

/// The same from the energy released.
pub fn k_over_handbook(specimen: &str, set: &[String], crack_length_mm: f64, spacing_mm: f64) -> f64 {
    ratio(StressIntensityMethod::EnergyRelease, specimen, set, crack_length_mm, spacing_mm)
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
                let bound = match correction {
                    "none" => 0.025,
                    "balanced" => 0.0125,
                    _ => 0.012,
                };
                assert!((ratio - 1.0).abs() < bound, "{correction}: {ratio} at {} mm", LENGTHS_MM[i]);
            }
            let (low, high) = at_length.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), &r| (l.min(r), h.max(r)));
            // Reached: 0.24 % balanced, 0.1 % with the classical correction.
            let spread = if correction == "balanced" { 0.003 } else { 0.002 };
            assert!(high - low < spread, "{correction}: {low} to {high} over nu at {} mm", LENGTHS_MM[i]);
        }
    }
}

/// K with the balanced correction at 3, 1.5 and 0.75 mm (a = 18.2 mm, two to eight horizons): within the 0.3 % of the handbook.
#[test]
fn k_does_not_depend_on_the_spacing() {
    let set = ["model.surface_correction=balanced".to_owned()];
    let errors = [3.0, 1.5, 0.75].map(|spacing| k_over_handbook(PANEL, &set, LENGTHS_MM[0], spacing) - 1.0);
    println!("balanced, K over handbook less 1 at 3, 1.5, 0.75 mm: {errors:.4?}");
    assert!(errors.iter().all(|error| error.abs() < 0.003), "{errors:?}");
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
        ("compact", compact, 1.25, [25.0, 40.0, 60.0], 0.015),
    ] {
        for correction in ["balanced", "volume_and_surface"] {
            let set = [format!("model.surface_correction={correction}")];
            let ratios = lengths.map(|a| k_over_handbook(specimen, &set, a, spacing));
            println!("{correction}, {name}: K over handbook at {lengths:?} mm: {ratios:.4?}");
            assert!(ratios.iter().all(|ratio| (ratio - 1.0).abs() < bound), "{correction}, {name}: {ratios:?}");
        }
    }
}

/// A compact specimen written as a plate, its pins touching over an arc: K of a short crack depends on how far the pressure
/// reaches round the hole. Over the formula of E647 at a/W = 0.25 finite elements give 0.9996, 1.0048 and 1.0239 for
/// half angles of 15, 45 and 90° (quadratic triangles, 8800 nodes, J over two rings).
#[test]
fn the_arc_of_a_pin_has_the_k_of_finite_elements() {
    let compact = "kind=\"compact_tension\"\nwidth_mm=100\nthickness_mm=5\ncrack_length_mm=25\n";
    let plate = "kind=\"plate\"\noutline_mm=[[-25,-60],[100,-60],[100,60],[-25,60]]\nthickness_mm=5\n\
                 holes=[{x_mm=0,y_mm=27.5,diameter_mm=25},{x_mm=0,y_mm=-27.5,diameter_mm=25}]\n\
                 cracks=[{from_mm=[-25,0],to_mm=[25,0]}]\n[loading]\nforce_max_n=4000.0\nstress_ratio=0.1\n";
    let (set, method) = (["model.spacing_mm=1.25".to_owned()], [StressIntensityMethod::DomainIntegral]);
    let k_i = |tip: &TipResult| tip.methods[0].intensity.k_i.unwrap();
    let specimen = first_tip(compact, &set, &method);
    let handbook = specimen.handbook_k_i.unwrap();
    let arcs = [(",contact_half_angle_deg=15", 0.9996), (",contact_half_angle_deg=45", 1.0048), ("", 1.0239)];
    let over_elements = arcs.map(|(half_angle, reference)| {
        let pin = |hole, y| format!("{{hole={hole},direction=[0,{y}]{half_angle}}}");
        let pins = format!("{plate}pins=[{},{}]\n", pin(0, 1), pin(1, -1));
        let tip = first_tip(&pins, &set, &method);
        println!("pins{half_angle}: K over E647 {:.4}, finite elements {reference}", k_i(&tip) / handbook);
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

/// Cracks of six horizons: what is asked for is 1.5 %, at every Poisson's ratio and at every place between two columns.
#[test]
fn every_method_agrees_with_the_handbook_between_columns_and_over_poissons_ratio() {
    for &method in StressIntensityMethod::ALL {
        let at = |a: f64, nu: f64| ratio(method, PANEL, &[format!("material.poisson_ratio={nu}")], a, 1.5);
        let lengths = [27.0, 27.4, 27.8, 28.2].map(|a| at(a, 0.3));
        let nus = [0.0, 0.15, 0.3333].map(|nu| at(27.0, nu));
        println!("{method}: over length {lengths:.4?}, over nu {nus:.4?}");
        for ratio in lengths.into_iter().chain(nus) {
            assert!((ratio - 1.0).abs() < 0.015, "{method}: {ratio}");
        }
        let spread =
            |values: &[f64]| values.iter().fold(f64::MIN, |m, &v| m.max(v)) - values.iter().fold(f64::MAX, |m, &v| m.min(v));
        // Reached: 0.2 % and 0.3 %. Without the correction to the length asked for, the first is 1.4 %.
        assert!(spread(&lengths) < 0.004 && spread(&nus) < 0.005, "{method}: {lengths:?} {nus:?}");
    }
}

/// `K_I = σ √(π a) cos²φ`, `K_II = σ √(π a) sin φ cos φ` for a crack φ off the horizontal under vertical tension, in an
/// infinite plate; this one is 14 a wide and 21 a long, which adds 1.3 % (secant of the width).
#[test]
fn a_slant_crack_has_both_modes_with_their_signs() {
    let a = 18.0;
    for phi in [30.0_f64, -30.0, 45.0] {
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
        let tips = stress_intensity(&case, &[StressIntensityMethod::DomainIntegral]).unwrap();
        let unit = 70e6 * (std::f64::consts::PI * a * 1e-3).sqrt() * 1.013;
        for result in tips.iter().flat_map(|tip| &tip.methods) {
            let [k_i, k_ii] = [result.intensity.k_i, result.intensity.k_ii].map(|k| k.unwrap() / unit);
            let errors = [k_i / (cos * cos) - 1.0, k_ii / (sin * cos) - 1.0];
            println!("{phi}°, {}: errors {errors:.4?}", result.method);
            assert!(errors.iter().all(|error| error.abs() < 0.03), "{phi}°, {}: {errors:?}", result.method);
        }
    }
}
