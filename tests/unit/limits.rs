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

/// A case at a value of the parameter, and a word of the line that is told beyond the end; `None` for sweeps that no case is warned from.
fn at(limit: &Limit, value: f64) -> Option<((String, Vec<String>), String)> {
    let length = 3.015 / value;
    let strip = |crack: f64| format!("kind = \"middle_tension\"\nwidth_mm = 200\nlength_mm = 300\ncrack_length_mm = {crack}");
    let crack = |from: f64, to: f64| format!("{{ from_mm = [{from}, 0], to_mm = [{to}, 0] }}");
    let hole = |x: f64, y: f64, d: f64| format!("holes = [{{ x_mm = {x}, y_mm = {y}, diameter_mm = {d} }}]\n");
    let plate = |hole: String, cracks: &[String]| {
        format!("kind = \"plate\"\nwidth_mm = 200\nlength_mm = 200\n{hole}cracks = [{}]", cracks.join(", "))
    };
    let edge = [crack(-100.0, -60.0)];
    let drawn = match limit.sweep.as_str() {
        "crack_length" => Some((strip(length), "half crack length")),
        "edge_crack_length" => Some((plate(String::new(), &[crack(-100.0, length - 100.0)]), "length of an edge crack")),
        "ligament" => Some((strip(100.0 - length), "ligament ahead of a tip")),
        "hole_distance" => Some((plate(hole(length - 40.0, 0.0, 40.0), &edge), "distance to a hole")),
        "hole_diameter" => Some((plate(hole(40.0, 40.0, length), &edge), "diameter of a hole")),
        "crack_distance" => {
            let both = [crack(-50.0, 0.0), crack(length, length + 40.0)];
            Some((plate(String::new(), &both), "distance to another crack"))
        }
        _ => None,
    };
    if let Some((specimen, what)) = drawn {
        return Some(((file(&specimen, "spacing_mm = 1"), Vec::new()), format!("of the {what}")));
    }
    let nodes = "method = \"element_free_galerkin\"".to_owned();
    let (key, set, model, word) = match (limit.sweep.as_str(), limit.method.as_str()) {
        ("horizon_ratio", "tip_field") => ("model.horizon_ratio", String::new(), None, "horizon_ratio"),
        ("growth_step" | "severing_step", _) => ("fatigue.step_error_percent", String::new(), None, "step_error_percent"),
        ("exponent", "tip_field") => ("fatigue.paris_m", String::new(), None, "exponent"),
        // The key begins at 1.5: what lies below is refused, safe or not.
        ("influence_radius", method) if limit.ends[0].is_none_or(|low| low > 1.5) => {
            let basis = if method.contains("linear") { "linear" } else { "quadratic" };
            ("model.influence_radius", format!("model.basis={basis}"), Some(nodes), "influence_radius")
        }
        ("nu_plane_stress" | "nu_plane_strain", method) => {
            let model = match method {
                "law chosen by the program" => None,
                "element_free_galerkin" => Some(nodes),
                law => Some(format!("spacing_mm = 1\nbond_law = \"{law}\"")),
            };
            let plane = limit.sweep.trim_start_matches("nu_plane_");
            ("material.poisson_ratio", format!("material.plane={plane}"), model, "ν ")
        }
        _ => return None,
    };
    let specimen = "kind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 200\ncrack_length_mm = 20";
    let set = [format!("{key}={value}"), set].into_iter().filter(|set| !set.is_empty()).collect();
    Some(((file(specimen, model.as_deref().unwrap_or("spacing_mm = 1")), set), word.to_owned()))
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
                    Err(error) => !error.to_string().is_empty(),
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
