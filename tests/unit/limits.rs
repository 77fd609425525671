//! The committed boundaries of methods, and what cases on both sides of them are told.

use std::path::Path;

use perilife_base::limits::{self, Limit};
use perilife_growth::case::Case;
use perilife_scenes::Scene;
use perilife_study::stability::SWEEPS;

use crate::support::rows::assert_refusal;

/// Relative distance from a boundary at which a case lies clearly on one side.
const ASIDE: f64 = 0.01;

/// The table is that of the sweeps there are: a method without a row was never measured, a row without a method is of another program.
#[test]
fn every_method_has_its_row() {
    let limits = limits::parse(limits::TABLE).unwrap();
    let mut known: Vec<(String, String, f64)> = Vec::new();
    for sweep in SWEEPS.iter() {
        known.extend(sweep.methods.iter().map(|method| (sweep.name.clone(), method.name.clone(), sweep.bound_percent)));
        assert!(sweep.values.windows(2).all(|pair| pair[0] < pair[1]), "{}: values rise", sweep.name);
        assert!(sweep.values.contains(&sweep.usual), "{}: the usual value is run", sweep.name);
    }
    let found: Vec<_> = limits.iter().map(|limit| (limit.sweep.clone(), limit.method.clone(), limit.bound_percent)).collect();
    assert_eq!(found, known);
    for limit in &limits {
        let [low, high] = limit.ends;
        let sweep = SWEEPS.iter().find(|sweep| sweep.name == limit.sweep).unwrap();
        assert!(low.is_none_or(|low| low <= sweep.usual) && high.is_none_or(|high| high >= sweep.usual), "{limit:?}");
        assert!(limit.is_safe == Some(true) || limit.ends == [None, None], "{limit:?}");
        assert!(limit.date.len() == 10 && !limit.version.is_empty(), "{limit:?}");
    }
}

#[test]
fn a_broken_table_is_refused() {
    let text = limits::TABLE;
    let head = text.lines().next().unwrap();
    for (broken, words) in [
        (text.replacen("low", "least", 1), "header"),
        (format!("{head}\na,b,c,true,1,2,3\n"), "7 fields"),
        (format!("{head}\na,b,c,true,x,2,3,0.1.0,2026-01-01\n"), "invalid float"),
    ] {
        assert_refusal(limits::parse(&broken), &[words]);
    }
}

const REST: &str = "[material]\nyoungs_modulus_gpa = 70\npoisson_ratio = 0.3\n[loading]\nstress_max_mpa = 60\nstress_ratio = 0.1\n[fatigue]\n\
    paris_c_mm_per_cycle = 1e-8\nparis_m = 3\n";

/// A panel or plate without model.
fn file(specimen: &str, model: &str) -> String {
    format!("[specimen]\nthickness_mm = 2\n{specimen}\n{REST}[model]\n{model}\n")
}

fn panel(keys: &[(&str, f64)], set: &str, model: &str) -> (String, Vec<String>) {
    let specimen = "kind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 200\ncrack_length_mm = 20";
    let mut overrides: Vec<String> = keys.iter().map(|(key, value)| format!("{key}={value}")).collect();
    overrides.extend(set.split_whitespace().map(str::to_owned));
    (file(specimen, model), overrides)
}

/// A case at a value of the parameter, and a word of the line that is told beyond the end; `None` for sweeps that no case is warned from.
fn at(limit: &Limit, value: f64) -> Option<((String, Vec<String>), String)> {
    let plate = |keys: String, what: &str| Some(((file(&keys, "spacing_mm = 1"), Vec::new()), format!("of the {what}")));
    let length = 3.015 / value;
    match (limit.sweep.as_str(), limit.method.as_str()) {
        ("crack_length", _) => plate(
            format!("kind = \"middle_tension\"\nwidth_mm = 200\nlength_mm = 300\ncrack_length_mm = {length}"),
            "half crack length",
        ),
        ("edge_crack_length", _) => plate(
            format!(
                "kind = \"plate\"\nwidth_mm = 200\nlength_mm = 200\ncracks = [{{ from_mm = [-100, 0], to_mm = [{}, 0] }}]",
                length - 100.0
            ),
            "length of an edge crack",
        ),
        ("ligament", _) => plate(
            format!("kind = \"middle_tension\"\nwidth_mm = 200\nlength_mm = 300\ncrack_length_mm = {}", 100.0 - length),
            "ligament ahead of a tip",
        ),
        ("hole_distance", _) => plate(
            format!(
                "kind = \"plate\"\nwidth_mm = 200\nlength_mm = 200\nholes = [{{ x_mm = {}, y_mm = 0, diameter_mm = 40 }}]\n\
                 cracks = [{{ from_mm = [-100, 0], to_mm = [-60, 0] }}]",
                length - 40.0
            ),
            "distance to a hole",
        ),
        ("hole_diameter", _) => plate(
            format!(
                "kind = \"plate\"\nwidth_mm = 200\nlength_mm = 200\nholes = [{{ x_mm = 40, y_mm = 40, diameter_mm = {length} }}]\n\
                 cracks = [{{ from_mm = [-100, 0], to_mm = [-60, 0] }}]"
            ),
            "diameter of a hole",
        ),
        ("crack_distance", _) => plate(
            format!(
                "kind = \"plate\"\nwidth_mm = 200\nlength_mm = 200\ncracks = [{{ from_mm = [-50, 0], to_mm = [0, 0] }}, \
                 {{ from_mm = [{length}, 0], to_mm = [{}, 0] }}]",
                length + 40.0
            ),
            "distance to another crack",
        ),
        ("horizon_ratio", "tip_field") => Some((
            panel(&[("model.horizon_ratio", value)], "material.poisson_ratio=0.3", "spacing_mm = 1"),
            "horizon_ratio".to_owned(),
        )),
        ("growth_step" | "severing_step", _) => Some((
            panel(&[("fatigue.step_error_percent", value)], "material.poisson_ratio=0.3", "spacing_mm = 1"),
            "step_error_percent".to_owned(),
        )),
        ("exponent", "tip_field") => {
            Some((panel(&[("fatigue.paris_m", value)], "material.poisson_ratio=0.3", "spacing_mm = 1"), "exponent".to_owned()))
        }
        // The key begins at 1.5: what lies below is refused, safe or not.
        ("influence_radius", method) if limit.ends[0].is_none_or(|low| low > 1.5) => {
            let basis = if method.contains("linear") { "model.basis=linear" } else { "model.basis=quadratic" };
            let model = "method = \"element_free_galerkin\"";
            let set = format!("material.poisson_ratio=0.3 {basis}");
            Some((panel(&[("model.influence_radius", value)], &set, model), "influence_radius".to_owned()))
        }
        ("nu_plane_stress" | "nu_plane_strain", method) => {
            let plane = limit.sweep.trim_start_matches("nu_plane_");
            let model = match method {
                "law chosen by the program" => "spacing_mm = 1".to_owned(),
                "element_free_galerkin" => "method = \"element_free_galerkin\"".to_owned(),
                law => format!("spacing_mm = 1\nbond_law = \"{law}\""),
            };
            Some((panel(&[("material.poisson_ratio", value)], &format!("material.plane={plane}"), &model), "ν ".to_owned()))
        }
        _ => None,
    }
}

/// Just inside nothing is said, just beyond a warning or a refusal names the end.
#[test]
fn cases_on_both_sides_of_every_boundary_are_told_apart() {
    let mut acting = 0;
    for limit in limits::all() {
        for (end, outwards) in limit.ends.into_iter().zip([-1.0, 1.0]) {
            let Some(end) = end else { continue };
            let told = |value: f64| {
                let ((text, set), word) = at(limit, value)?;
                Some(match Case::from_toml(&text, "side", Path::new("."), &set) {
                    Ok(case) => case.warnings.iter().any(|line| line.contains(&word) && line.contains(&format!("beyond {end}"))),
                    Err(error) => {
                        assert!(!error.to_string().is_empty());
                        true
                    }
                })
            };
            let (inside, beyond) = (end * (1.0 - outwards * ASIDE), end * (1.0 + outwards * ASIDE));
            let Some(is_told_inside) = told(inside) else { continue };
            assert!(!is_told_inside, "{} by {}: {inside} inside {end}", limit.sweep, limit.method);
            // A value that is no Poisson's ratio, or no key, is refused: that is told, too.
            assert_eq!(told(beyond), Some(true), "{} by {}: {beyond} beyond {end}", limit.sweep, limit.method);
            acting += 1;
        }
    }
    println!("{acting} boundaries");
    assert!(acting >= 6, "{acting}");
}

/// The same of the control of a correspondence scene: the narrower of its two ranges is told.
#[test]
fn a_control_beyond_its_range_is_told() {
    let ends = ["global", "nodal"].map(|ordinate| {
        limits::of("zero_energy_silling", &format!("correspondence, silling: {ordinate}")).expect("measured").ends
    });
    let high = ends.iter().filter_map(|ends| ends[1]).fold(f64::INFINITY, f64::min);
    let told = |factor: f64| {
        let text = format!(
            "[specimen]\nkind = \"plate\"\nwidth_mm = 20\nlength_mm = 40\nthickness_mm = 1\n[material]\nyoungs_modulus_gpa = 70\n\
             poisson_ratio = 0.3\n[model]\nbond_law = \"correspondence\"\nspacing_mm = 1\nzero_energy_factor = {factor}\n[loading]\n\
             kind = \"displacement\"\nedges = [\"top\", \"bottom\"]\ndisplacement_mm = 0.01\n"
        );
        let scene = Scene::from_toml(&text, "control", Path::new("."), &[]).unwrap();
        scene.warnings.iter().any(|line| line.contains("zero_energy_factor") && line.contains(&format!("beyond {high}")))
    };
    assert!(high.is_finite());
    assert!(!told(high * (1.0 - ASIDE)) && told(high * (1.0 + ASIDE)), "{high}");
}
