//! Problems of `../shared/data/field/mechanics5`: contact, pins, plates and input, against finite elements and formulas of others.

use std::fs;
use std::path::{Path, PathBuf};

use perilife_base::units::MPA_SQRT_M;
use perilife_growth::case::{Case, Method};
use perilife_growth::cracks::initial_tips;
use perilife_growth::cracks::steering::{equivalent_factor, factor_across, kink_angle};
use perilife_growth::nodes::NodePlate;
use perilife_growth::points::PointPlate;
use perilife_growth::predict::tip_factors::{StressIntensityMethod, stress_intensity};
use perilife_growth::predict::{Prediction, Silent, error_estimate::error_estimate, predict};
use perilife_plate::specimen::geometry::distance;
use perilife_plate::specimen::{Bearing, Load};

use crate::interface::cli::{perilife, texts};
use crate::support::field::{command, folder, is_near, predicted};
use crate::support::rows::{assert_holds, rows};
use crate::support::shared::shared;

// Contact that does not follow the load in proportion, against finite elements with contact of others (`../shared/data/field/mechanics5`): residual stress that presses flanks, pins with clearance; and spectra beside constant amplitude.

fn run(name: &str, set: &[String]) -> Option<(Case, Prediction)> {
    let case = Case::from_file(&shared(&format!("field/mechanics5/{name}.toml"))?, set).unwrap();
    let run = predict(&case, &Silent).unwrap();
    Some((case, run))
}

#[test]
fn both_ends_of_a_cycle_have_their_own_contact() {
    for (name, [largest, least], life, bound) in rows::<Vec<(String, [f64; 2], f64, f64)>>("mechanics5_plates", "ends") {
        let Some((case, run)) = run(&name, &[]) else { return };
        let first = &run.curve[0];
        let (k_i, ratio) = (first.tips[0].factors.unwrap()[0] / MPA_SQRT_M, first.response.ratio(case.loading.ratio));
        let stated = error_estimate(&case, &run).unwrap().life_percent;
        assert!((k_i / largest - 1.0).abs() < 0.006 && (ratio - least / largest).abs() < 0.003, "{name}: {k_i}, {ratio}");
        assert!((run.life_cycles() / life - 1.0).abs() < bound && stated < 3.0, "{name}: {}, {stated}", run.life_cycles());
    }
}

/// A pin with clearance: K_I at both ends, and R_eff of K_eq from them, in the direction that the largest load gives the crack.
#[test]
fn a_pin_with_clearance_has_its_own_contact_at_both_ends() {
    let name = "pin_load_ratio/lug_r5";
    let Some((case, run)) = run(name, &[]) else { return };
    let of = |force: f64| {
        let set = [format!("loading.force_max_n={force}"), "model.method=element_free_galerkin".to_owned()];
        let case = Case::from_file(&shared(&format!("field/mechanics5/{name}.toml")).unwrap(), &set).unwrap();
        initial_tips::<NodePlate>(&case).unwrap().tips[0].factors.unwrap().map(|k| k / MPA_SQRT_M)
    };
    let [largest, least] = [1e4, 5e3].map(of);
    assert!((largest[0] / 16.336 - 1.0).abs() < 0.002 && (least[0] / 8.588 - 1.0).abs() < 0.002, "{largest:?}, {least:?}");
    let right = factor_across(least, kink_angle(largest)) / equivalent_factor(largest);
    assert!((run.curve[0].response.ratio(case.loading.ratio) - right).abs() < 0.001, "{right}");
}

/// Cold-worked hole, whose mouths close at the least load: K at 12 MPa is that of points, which take contact another way, and not that of flanks
/// that overlap, 0.35 and 1.2 MPa√m.
#[test]
fn mouths_that_close_hold_a_crack_open() {
    let Some(path) = shared("field/mechanics5/residual_with_contact/guard_cold_hole.toml") else { return };
    for end in [7.3, 10.0] {
        let cracks = format!(
            "specimen.cracks=[{{ from_mm = [4.0, 0.0], to_mm = [{end}, 0.0] }}, {{ from_mm = [-4.0, 0.0], to_mm = [-{end}, 0.0] }}]"
        );
        let of = |method: &str| {
            let set = [cracks.clone(), "loading.stress_max_mpa=12".to_owned(), format!("model.method={method}")];
            Case::from_file(&path, &set).unwrap()
        };
        let [nodes, points] = [
            initial_tips::<NodePlate>(&of("element_free_galerkin")).unwrap(),
            initial_tips::<PointPlate>(&of("peridynamics")).unwrap(),
        ]
        .map(|found| (found.tips[0].factors.unwrap()[0] / MPA_SQRT_M, found.in_contact));
        assert!(nodes.1 && points.1 && (nodes.0 / points.0 - 1.0).abs() < 0.015, "{end} mm: {nodes:?}, {points:?}");
    }
}

/// A spectrum of cycles of one kind is constant amplitude, with contact that changes from one end to the other as well.
#[test]
fn a_spectrum_of_equal_cycles_is_constant_amplitude() {
    let folder = tempfile::tempdir().unwrap();
    for (name, method, load, ratio) in [
        ("residual_with_contact/pressed_middle_r5", "element_free_galerkin", "stress_max_mpa = 40.0", 0.5),
        ("residual_with_contact/pressed_middle_r5", "peridynamics", "stress_max_mpa = 40.0", 0.5),
        ("pin_load_ratio/lug_r5", "element_free_galerkin", "force_max_n = 10000.0", 0.5),
    ] {
        let set = [format!("model.method={method}")];
        let Some((_, of_cycles)) = run(name, &set) else { return };
        let text = fs::read_to_string(shared(&format!("field/mechanics5/{name}.toml")).unwrap()).unwrap();
        let scale = load.replace("stress_max_mpa", "spectrum_scale_mpa").replace("force_max_n", "spectrum_scale_n");
        let of_spectrum = text
            .replace(load, &format!("kind = \"spectrum\"\nspectrum_file = \"one.csv\"\n{scale}"))
            .lines()
            .filter(|line| !line.starts_with("stress_ratio"))
            .collect::<Vec<_>>()
            .join("\n");
        fs::write(folder.path().join("one.csv"), format!("max,min,count\n1,{ratio},10\n")).unwrap();
        let path = folder.path().join("case.toml");
        fs::write(&path, of_spectrum).unwrap();
        let spectrum = predict(&Case::from_file(&path, &set).unwrap(), &Silent).unwrap();
        let off = spectrum.life_cycles() / of_cycles.life_cycles() - 1.0;
        println!("{name}, {method}: {:.1}, {:.1}: {off:+.2e}", spectrum.life_cycles(), of_cycles.life_cycles());
        assert!(off.abs() < 1e-3, "{name}, {method}: {off}");
    }
}

// Pins that touch beside the mouth of a crack (`field/mechanics5/pin_at_mouth` of the shared data): K by finite elements with contact.

/// K of a file, MPa√m, and the residual of its contact.
fn found(file: &str, others: &[&str]) -> Option<([f64; 2], f64)> {
    let path = shared(&format!("field/mechanics5/pin_at_mouth/{file}.toml"))?;
    let text = std::fs::read_to_string(&path).unwrap();
    let overrides: Vec<String> =
        ["model.method=\"element_free_galerkin\""].iter().chain(others).map(|&one| one.to_owned()).collect();
    let case = Case::from_toml(&text, file, path.parent().unwrap(), &overrides).unwrap();
    let k = initial_tips::<NodePlate>(&case).unwrap().tips[0].factors.unwrap();
    let Load::Pin { contact: Bearing::Elastic(pin), .. } = &case.specimen.loads[0] else { panic!("{file}: no pin") };
    Some((k.map(|k| k / MPA_SQRT_M), pin.found.as_ref().unwrap().residual))
}

#[test]
fn pins_lean_on_mouths_of_cracks() {
    for (file, k_i, k_ii, share) in rows::<Vec<(String, f64, f64, f64)>>("mechanics5_plates", "pins_at_mouths") {
        for finer in [&[][..], &["model.tolerance_percent=0.5"]] {
            let Some((k, residual)) = found(&file, finer) else { return };
            let off = [k[0] - k_i, k[1] - k_ii].map(|off| off / k_i);
            assert!(off.iter().all(|off| off.abs() < share), "{file} {finer:?}: {k:?}");
            assert!(residual < 0.006, "{file} {finer:?}: {residual}");
        }
    }
}

/// The remedy keeps the crack.
#[test]
fn part_through_cracks_beside_pins_are_refused() {
    let Some(path) = shared("field/mechanics5/refusals/corner_pin.toml") else { return };
    let output = perilife(path.parent().unwrap(), &["check", "corner_pin.toml"]);
    let (_, stderr) = texts(&output);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("loading.pins") && stderr.contains("through crack as long as its larger axis"), "{stderr}");
}

// Plates on nodes against finite elements and formulas of others (`../shared/data/field/mechanics5`): nearly incompressible ones, cracks from slots, and what held before.

fn file(name: &str) -> Option<PathBuf> {
    shared(&format!("field/mechanics5/{name}.toml"))
}

fn is_near_of_plates(found: f64, right: f64, percent: f64, what: &str) {
    assert!((found / right - 1.0).abs() < 0.01 * percent, "{what}: {found} for {right}");
}

/// Cycles at which tips that face each other first come within a gap, m.
fn cycles_at_gap(run: &Prediction, gap: f64) -> f64 {
    let least = |row: usize| {
        let at: Vec<_> = run.curve[row].tips.iter().filter_map(|tip| Some((tip.position, tip.factors?))).collect();
        let pairs = at.iter().enumerate().flat_map(|(k, a)| at[..k].iter().map(move |b| distance(a.0, b.0)));
        pairs.fold(f64::INFINITY, f64::min)
    };
    let row = (1..run.curve.len()).find(|row| least(*row) < gap).unwrap();
    let (before, after) = (least(row - 1), least(row));
    let share = (before - gap) / (before - after);
    run.curve[row - 1].cycles + share * (run.curve[row].cycles - run.curve[row - 1].cycles)
}

#[test]
fn lives_of_plates_by_default() {
    for (name, right, percent, stated) in rows::<Vec<(String, f64, f64, f64)>>("mechanics5_plates", "lives") {
        let Some(path) = file(&name) else { return };
        let case = Case::from_file(&path, &[]).unwrap();
        assert!(case.model.method() != Method::Peridynamics, "{name}");
        let run = predict(&case, &Silent).unwrap();
        is_near_of_plates(run.life_cycles(), right, percent, &name);
        let found = error_estimate(&case, &run).unwrap().life_percent;
        let off = 100.0 * (run.life_cycles() / right - 1.0).abs();
        println!("{name}: {off:.2} of {found:.2} %");
        assert!(found < stated && off < found, "{name}: {off:.2} of {found:.2} % stated");
    }
}

#[test]
fn rows_of_holes_link_up() {
    for (name, right) in [("guards/row", 31_996.0), ("guards/row_pins", 26_543.0)] {
        let Some(path) = file(name) else { return };
        let run = predict(&Case::from_file(&path, &[]).unwrap(), &Silent).unwrap();
        is_near_of_plates(cycles_at_gap(&run, 0.6e-3), right, 0.5, name);
    }
}

#[test]
fn stress_at_a_stop_hole() {
    let Some(path) = file("guards/stop_hole") else { return };
    let run = predict(&Case::from_file(&path, &[]).unwrap(), &Silent).unwrap();
    is_near_of_plates(1e-6 * run.phase_one.unwrap().range, 231.1, 0.3, "stop hole");
}

#[test]
fn factors_of_plates_on_nodes() {
    for (name, key, right) in rows::<Vec<(String, String, Vec<[f64; 4]>)>>("mechanics5_plates", "factors") {
        let Some(path) = file(&name) else { return };
        let set: Vec<String> = Some(key.clone()).filter(|key| !key.is_empty()).into_iter().collect();
        let case = Case::from_file(&path, &set).unwrap();
        let tips = stress_intensity(&case, &[StressIntensityMethod::ElementFreeGalerkin]).unwrap();
        for (tip, right) in tips.iter().zip(right) {
            let intensity = tip.methods[0].intensity;
            let [k_i, k_ii] = [intensity.k_i, intensity.k_ii].map(|k| 1e-6 * k.unwrap());
            assert!((k_i - right[0]).abs() < right[1] && (k_ii - right[2]).abs() < right[3], "{name} {key}: {k_i} {k_ii}");
        }
    }
}

/// What counts at every point up to ν = 0.4 goes over into means of cells beyond it.
#[test]
fn factors_are_continuous_where_means_begin() {
    let Some(path) = file("nu_near_half/lug_arc_499") else { return };
    let of = |nu: &str| {
        let case = Case::from_file(&path, &[format!("material.poisson_ratio={nu}"), "model.nodes=5000".to_owned()]).unwrap();
        1e-6 * stress_intensity(&case, &[StressIntensityMethod::ElementFreeGalerkin]).unwrap()[0].methods[0]
            .intensity
            .k_i
            .unwrap()
    };
    is_near_of_plates(of("0.4001"), of("0.4"), 0.1, "K beyond ν = 0.4");
}

// Input of `field/mechanics5` of the shared data: units of formulas, words of refusals, rollers.

/// A file with one text for another.
fn changed(folder: &Path, file: &str, [old, new]: [&str; 2]) -> String {
    let text = fs::read_to_string(folder.join(file)).unwrap();
    assert!(text.contains(old), "{old} in {file}");
    fs::write(folder.join("changed.toml"), text.replace(old, new)).unwrap();
    "changed.toml".to_owned()
}

#[test]
fn a_formula_of_residual_stress_has_the_units_of_its_key() {
    let Some(dir) = folder("field/mechanics5/formula_units") else { return };
    let (folder, bare) = (dir.path(), "residual_stress = \"-20*exp(-x^2)\"");
    for set in ["", " --set material.poisson_ratio=0.3"] {
        let (code, said) = command(folder, &format!("predict us_residual.toml{set} --out none"));
        assert_eq!(code, 2, "{said}");
        assert_holds(
            &said,
            "us_residual.toml:15 | loading.residual_stress =  | specimen.width_in | residual_stress_ksi | \
            residual_stress_mpa",
        );
    }
    let rows: String =
        (-150..=150).map(|i| f64::from(i) / 100.0).map(|x| format!("{x},0,{}\n", -20.0 * (-x * x).exp())).collect();
    fs::write(folder.join("field.csv"), format!("x_in,y_in,stress_ksi\n{rows}")).unwrap();
    // One field in four forms: 20 ksi are 137.895 MPa.
    let forms = [
        ("_ksi = \"-20*exp(-x^2)\"", " -20*exp(-x^2) (ksi, x and y in inch)"),
        ("_ksi = { y = \"-20*exp(-x^2)\" }", " { y = \"-20*exp(-x^2)\" } (ksi, x and y in inch)"),
        (
            "_mpa = \"-137.89514586336*exp(-(x/25.4)^2)\"",
            " -137.89514586336*exp(-(x/25.4)^2) (megapascals, x and y in millimeters)",
        ),
        ("_file = \"field.csv\"", " of field.csv;"),
    ];
    let mut first = None;
    for (form, words) in forms {
        let file = changed(folder, "us_residual.toml", [bare, &format!("residual_stress{form}")]);
        let (said, result) = predicted(folder, &format!("{file} --units us"));
        let life = result["life_cycles"].as_f64().unwrap();
        // 580 776 cycles with `tolerance_percent = 0.5`.
        is_near(&result["life_cycles"], 580_776.0, 1e-3, form);
        is_near(&result["life_cycles"], *first.get_or_insert(life), if form.contains("file") { 1e-3 } else { 1e-5 }, form);
        assert!(!said.contains("error:"), "{said}");
        fs::remove_dir_all(folder.join("out")).unwrap();
        let (_, said) = command(folder, &format!("check {file} --units us"));
        assert!(said.contains(&format!("residual stress{words}")), "{said}");
    }
    let file = changed(folder, "us_residual.toml", [bare, "residual_stress_ksi = \"1\"\nresidual_stress_mpa = \"7\""]);
    let (code, said) = command(folder, &format!("check {file}"));
    assert!(code == 2 && said.contains("loading.residual_stress_ksi = \"1\""), "{said}");
    assert!(said.contains("conflicts with residual_stress_mpa"), "{said}");
}

#[test]
fn refusals_do_not_lead_to_another_plate() {
    let Some(dir) = folder("field/mechanics5/refusals") else { return };
    for file in ["ellipse.toml", "round_rect.toml"] {
        let (code, said) = command(dir.path(), &format!("check {file}"));
        assert!(code == 2 && said.contains("save it as DXF") && said.contains("circles") && !said.contains("remove"), "{said}");
    }
    let loads = [
        ("stress_max_mpa = -100.0", "stress_ratio = minimum / maximum"),
        ("stress_range_mpa = -100.0", "maximum - minimum"),
        ("force_max_kn = -40.0", "stress_ratio = minimum / maximum"),
        ("kind = \"displacement\"\ndisplacement_max_mm = -0.1", "stress_ratio = minimum / maximum"),
    ];
    for (load, remedy) in loads {
        let file = changed(dir.path(), "compress.toml", ["stress_max_mpa = -100.0", load]);
        let (code, said) = command(dir.path(), &format!("check {file}"));
        for word in
            [load.rsplit('\n').next().unwrap().split(' ').next().unwrap(), "compression alone does not grow a crack", remedy]
        {
            assert!(code == 2 && said.contains(word), "{word} in {said}");
        }
    }
    // What is asked for is taken.
    let file = changed(dir.path(), "compress.toml", ["-100.0\nstress_ratio = 0.1", "50.0\nstress_ratio = -2"]);
    let (code, said) = command(dir.path(), &format!("check {file}"));
    assert_eq!(code, 0, "{said}");
}

/// The work of narrow rollers does not depend on how nodes lie beside them, and what is left of a severed plate asks for no warning.
#[test]
fn narrow_rollers_do_work_over_their_width() {
    let Some(dir) = folder("validation/pmma_scb_30") else { return };
    for width in ["1.0", "0.2"] {
        let file = changed(dir.path(), "case.toml", ["contact_width_mm = 1.0", &format!("contact_width_mm = {width}")]);
        for tolerance in ["2", "0.5"] {
            let (said, result) = predicted(dir.path(), &format!("{file} --set model.tolerance_percent={tolerance}"));
            let check = &result["k_cross_check"]["largest_difference_percent"];
            assert!(check.as_f64().is_some_and(|difference| difference.abs() < 0.5), "{width}, {tolerance}: {check}");
            assert!(result["error_estimate_percent"].as_f64().is_some_and(|error| error < 3.0), "{width}, {tolerance}: {said}");
            assert!(!said.contains("crack-face contact cannot") && result["stop_reason"] == "left_plate", "{said}");
            fs::remove_dir_all(dir.path().join("out")).unwrap();
        }
    }
}
