//! What a case takes up is known before anything is laid out, and refused where it is too much.

use perilife_base::input::Folder;
use perilife_base::machine;
use perilife_growth::case::Case;
use perilife_growth::case::needs;
use perilife_points::bond_law::stencil::Stencil;
use perilife_scenes::Scene;

use crate::support::rows::assert_refusal;

const PLATE: &str = r#"
material = { name = "al2024-t3" }
loading = { stress_max_mpa = 50.0, stress_ratio = 0.1 }
fatigue = { paris_c_mm_per_cycle = 1e-7, paris_m = 3.0 }
"#;
const SQUARE: &str = r#"specimen = { kind = "plate", width_mm = 60.0, length_mm = 60.0, thickness_mm = 2.0, cracks = [{ from_mm = [-8.0, -2.0], to_mm = [8.0, 2.0] }] }"#;
/// Two flanges and a web of 4 mm, 7 m long: a third of a million points, and two hundred million places around them.
const THIN_ARMS: &str = r#"specimen = { kind = "plate", outline_mm = [[0, 0], [7000, 0], [7000, 4], [3502, 4], [3502, 6996], [7000, 6996], [7000, 7000], [0, 7000], [0, 6996], [3498, 6996], [3498, 4], [0, 4]], thickness_mm = 2.0, cracks = [{ from_mm = [3498, 3500], to_mm = [3499, 3500] }] }"#;

fn case(specimen: &str, model: &str) -> Case {
    Case::from_toml(&format!("{specimen}{PLATE}{model}"), "case", Folder::none(), &[]).unwrap()
}

/// Points and bonds of plates as they are built.
#[test]
fn points_and_bonds_are_those_of_the_plate() {
    let fine = r#"regions = [{ box_mm = [[-20, -8], [20, 8]], levels = 2 }]"#;
    let flaws =
        r#"regions = [{ around_flaws_mm = 8.0, levels = 2 }, { band_mm = [[-25, -9], [25, 9]], width_mm = 16.0, levels = 1 }]"#;
    let models = [
        "model = { spacing_mm = 0.5 }\n",
        "model = { spacing_mm = 0.5, horizon_ratio = 5.3 }\n",
        "model = { spacing_mm = 0.5, lattice_angle_deg = 30.0 }\n",
    ];
    for model in models {
        let case = case(SQUARE, model);
        let budget = needs::of_case(&case);
        let body = case.points().body(&case.specimen, &case.material).unwrap();
        let ratio = budget.points / body.points.len() as f64;
        println!("{:.0} points against {} of {}", budget.points, body.points.len(), model.trim());
        assert!((0.98..=1.02).contains(&ratio), "{ratio} of {model}");
        assert!(budget.places >= body.places() as f64 * 0.9, "{} places against {}", budget.places, body.places());
        let stencil = Stencil::new(&case.points().bond_law, &case.material, 0.5e-3, case.points().horizon_ratio, 2e-3).unwrap();
        assert!((budget.bonds / budget.points - stencil.bonds.len() as f64).abs() < 1e-9);
    }
    for (regions, most) in [(fine, 1.4), (flaws, 1.9)] {
        let levels = scene("spacing_mm = 2.0, discretisation = \"dual_horizon\"", &format!("refinement = {{ {regions} }}\n"));
        let (budget, points) = (levels.budget(), perilife_scenes::build(&levels).unwrap().0.len());
        let ratio = budget.points / points as f64;
        println!("{:.0} points against {points} of {regions}", budget.points);
        assert!((0.98..=1.02 * most).contains(&ratio), "{ratio} of {regions}");
    }
}

/// Each was laid out before it was counted: memory ran out, or a limit on points did not see them.
#[test]
fn plates_that_are_too_large_are_refused_with_a_spacing_that_fits() {
    const LIMIT: f64 = 4e9;
    let cases = [
        ("thin arms", THIN_ARMS, "model = { spacing_mm = 0.5 }\n"),
        ("long bonds", SQUARE, "model = { spacing_mm = 0.07, horizon_ratio = 12.0 }\n"),
    ];
    for (name, specimen, model) in cases {
        let large = case(specimen, model);
        let budget = needs::of_case(&large);
        let error = budget.within(LIMIT).unwrap_err();
        println!("{name}: {error}");
        assert_eq!(error.exit_code(), 2);
        let words = error.to_string();
        assert!(words.contains("model.spacing_mm = ") && words.contains("limit 4.00 GB"), "{words}");
        let spacing: f64 = words.split("give about ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        let set = format!("model.spacing_mm={spacing}");
        let coarser = Case::from_toml(&format!("{specimen}{PLATE}{model}"), "case", Folder::none(), &[set]);
        // A spacing that fits the memory may leave too few points on the crack, which is said by its own words.
        if let Ok(coarser) = coarser {
            needs::of_case(&coarser).within(LIMIT).unwrap_or_else(|error| panic!("{name} at {spacing} mm: {error}"));
        }
    }
    let levels = "refinement = { regions = [{ box_mm = [[-29, -29], [29, 29]], levels = 4 }] }\n";
    let levels = scene("spacing_mm = 0.12, discretisation = \"dual_horizon\"", levels).budget();
    assert!(levels.points > 4e7, "{:e}", levels.points);
    assert!(levels.within(LIMIT).unwrap_err().to_string().contains("smaller regions of [refinement]"));
    assert!(levels.within_points(1e6).unwrap_err().to_string().contains("points; limit 1.000e6"));
}

/// Fields for ParaView, which are most of what a run leaves, are counted where they are asked for.
#[test]
fn files_are_counted_as_they_are_asked_for() {
    let asked = "[output]\nparaview = true\n";
    for model in ["spacing_mm = 0.5", "method = \"element_free_galerkin\", nodes = 2000"] {
        let [without, with] = ["", asked].map(|more| needs::of_case(&case(SQUARE, &format!("model = {{ {model} }}\n{more}"))));
        let of_point = (with.disk_bytes - without.disk_bytes) / with.points;
        assert!(of_point > 1000.0 && without.disk_bytes < 5e6, "{model}: {of_point}");
    }
    let [without, with] = ["", asked].map(|more| scene("spacing_mm = 0.5", more).budget().disk_bytes);
    assert!(with > 5.0 * without, "{with} {without}");
}

#[test]
fn scenes_are_counted_too() {
    assert_refusal(scene("spacing_mm = 0.05, horizon_ratio = 9.0", "").budget().within(4e9), &["model.spacing_mm = 0.05"]);
}

const PULLED: &str = "loading = { kind = \"traction\", stress_mpa = 10.0, edges = [\"top\", \"bottom\"] }\n";
const STEEL: &str = "material = { youngs_modulus_gpa = 72.0, poisson_ratio = 0.3 }\n";

fn scene(model: &str, more: &str) -> Scene {
    let text = format!("{SQUARE}\n{STEEL}model = {{ {model} }}\n{PULLED}{more}");
    Scene::from_toml(&text, "scene", Folder::none(), &[]).unwrap()
}

#[test]
fn free_memory_is_the_least_of_what_there_is() {
    assert_eq!(machine::of_machine("MemTotal: 9 kB\nMemAvailable:    2048 kB\n"), Some(2048.0 * 1024.0));
    assert_eq!(machine::of_machine(""), None);
    assert_eq!(machine::of_group("max\n", "100\n", ""), None);
    assert_eq!(machine::of_group("1000\n", "300\n", "anon 200\ninactive_file 50\n"), Some(750.0));
    assert_eq!(machine::of_group("1000\n", "3000\n", ""), Some(0.0));
    let limits = |most: &str| {
        format!("Limit  Soft Limit  Hard Limit  Units\nMax address space         {most}            unlimited            bytes\n")
    };
    assert_eq!(machine::of_process(&limits("unlimited"), "VmSize: 1 kB"), None);
    assert_eq!(machine::of_process(&limits("4096"), "VmSize:   1 kB"), Some(3072.0));
    if cfg!(target_os = "linux") {
        assert!(machine::free_bytes().is_some_and(|free| free > 1e6));
    }
}
