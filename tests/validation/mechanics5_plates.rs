//! Plates on nodes against finite elements and formulas of others (`../shared/data/field/mechanics5`): nearly incompressible ones, cracks from
//! slots, and what held before.

use std::path::PathBuf;

use perilife_growth::case::{Case, Method};
use perilife_growth::predict::tip_factors::{StressIntensityMethod, stress_intensity};
use perilife_growth::predict::{Prediction, Silent, error_estimate::error_estimate, predict};
use perilife_plate::specimen::geometry::distance;

use crate::support::rows::rows;
use crate::support::shared::shared;

fn file(name: &str) -> Option<PathBuf> {
    shared(&format!("field/mechanics5/{name}.toml"))
}

fn is_near(found: f64, right: f64, percent: f64, what: &str) {
    println!("{what}: {found:.6}, right {right}, {:+.2} %", 100.0 * (found / right - 1.0));
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
        is_near(run.life_cycles(), right, percent, &name);
        let found = error_estimate(&case, &run).unwrap().life_percent;
        assert!(found < stated, "{name}: {found:.2} % stated");
    }
}

#[test]
fn rows_of_holes_link_up() {
    for (name, right) in [("guards/row", 31_996.0), ("guards/row_pins", 26_543.0)] {
        let Some(path) = file(name) else { return };
        let run = predict(&Case::from_file(&path, &[]).unwrap(), &Silent).unwrap();
        is_near(cycles_at_gap(&run, 0.6e-3), right, 0.5, name);
    }
}

#[test]
fn stress_at_a_stop_hole() {
    let Some(path) = file("guards/stop_hole") else { return };
    let run = predict(&Case::from_file(&path, &[]).unwrap(), &Silent).unwrap();
    is_near(1e-6 * run.phase_one.unwrap().range, 231.1, 0.3, "stop hole");
}

/// File, what is set beside it, and of every tip K_I and K_II with their bounds, MPa√m.
type Factors = (&'static str, &'static str, &'static [[f64; 4]]);

/// Finite elements, at 0.48 to 0.495 of K_I alone; M(T) does not depend on ν.
const FACTORS: [Factors; 9] = [
    ("nu_near_half/mt499", "", &[[15.218, 0.03, 0.0, 0.02]; 2]),
    ("nu_near_half/mt499", "material.poisson_ratio=0.46", &[[15.218, 0.05, 0.0, 0.02]; 2]),
    ("nu_near_half/lug_arc_499", "", &[[16.609, 0.03, -1.415, 0.02]]),
    ("nu_near_half/lug_arc_499", "material.poisson_ratio=0.495", &[[16.606, 0.03, 0.0, f64::INFINITY]]),
    ("nu_near_half/guard_lug_arc_49", "", &[[16.598, 0.03, 0.0, f64::INFINITY]]),
    ("nu_near_half/guard_lug_arc_49", "material.poisson_ratio=0.48", &[[16.582, 0.03, 0.0, f64::INFINITY]]),
    ("guards/drawing_arcs", "", &[[9.122, 0.03, 0.022, 0.02]]),
    ("guards/overlap", "", &[[22.387, 0.05, -0.326, 0.02], [1.187, 0.02, -1.158, 0.02]]),
    ("guards/bent_edge_pressed", "", &[[2.559, 0.02, 0.0, 0.02]]),
];

#[test]
fn factors_of_plates_on_nodes() {
    for (name, key, right) in FACTORS {
        let Some(path) = file(name) else { return };
        let set: Vec<String> = Some(key.to_owned()).filter(|key| !key.is_empty()).into_iter().collect();
        let case = Case::from_file(&path, &set).unwrap();
        let tips = stress_intensity(&case, &[StressIntensityMethod::ElementFreeGalerkin]).unwrap();
        for (tip, right) in tips.iter().zip(right) {
            let intensity = tip.methods[0].intensity;
            let [k_i, k_ii] = [intensity.k_i, intensity.k_ii].map(|k| 1e-6 * k.unwrap());
            println!("{name} {key}: {k_i:.3} {k_ii:.3} for {right:?}");
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
    is_near(of("0.4001"), of("0.4"), 0.1, "K beyond ν = 0.4");
}
