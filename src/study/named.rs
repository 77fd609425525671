//! Named plates: K on nodes beside the handbook of each, lives on nodes beside finite elements.

use super::cases::{NODES, case, run};
use super::table::Table;
use perilife_base::error::{Error, Result};
use perilife_base::units::MM;
use perilife_growth::predict::Prediction;
use perilife_growth::predict::tip_factors::{StressIntensityMethod, stress_intensity};
use perilife_plate::specimen::handbook::handbook_beside;
use perilife_points::crack_tip::TipState;

/// Where lives come from: quadratic triangles, remeshed in steps of 0.5 mm, and half of that with halved elements 0.04 % apart.
const ELEMENTS: &str = "finite elements of tests/reference (0.1 %)";
/// What nodes add to the error of a formula, percent.
const OF_NODES: f64 = 0.4;

/// All rows of the topic.
pub fn rows(table: &mut Table) -> Result<()> {
    factors(table)?;
    holes(table)?;
    places(table)
}

/// A plate by its keys, under this load.
fn text(specimen: &str, loading: &str) -> String {
    format!(
        "[specimen]\n{specimen}\n[material]\nyoungs_modulus_gpa = 73.1\npoisson_ratio = 0.33\nplane = \"stress\"\n\
         [loading]\n{loading}\nstress_ratio = 0.2\n[fatigue]\nparis_c_mm_per_cycle = 8.95422e-8\nparis_m = 2.874\n"
    )
}

/// K within what the source of a formula says of it.
fn factors(table: &mut Table) -> Result<()> {
    const BEAM: &str = "kind = \"single_edge_bend\"\nwidth_mm = 20\nthickness_mm = 10";
    const FOUR: &str = "kind = \"single_edge_bend\"\nwidth_mm = 20\nthickness_mm = 10\nspan_mm = 160\ninner_span_mm = 60";
    const ECCENTRIC: &str = "kind = \"eccentric_single_edge_tension\"\nwidth_mm = 40\nthickness_mm = 4";
    const WEDGE: &str = "kind = \"wedge_opening\"\nwidth_mm = 50\nthickness_mm = 10";
    const ONE: &str =
        "kind = \"crack_at_hole\"\nwidth_mm = 200\nlength_mm = 300\nthickness_mm = 2\nhole_diameter_mm = 20\ncracks = 1";
    const TWO: &str =
        "kind = \"crack_at_hole\"\nwidth_mm = 200\nlength_mm = 300\nthickness_mm = 2\nhole_diameter_mm = 20\ncracks = 2";
    const TENSION: &str = "stress_max_mpa = 50";
    const FORCE: &str = "force_max_n = 1000";
    for (name, keys, loading, lengths) in [
        ("SE(B), three points", BEAM, FORCE, &[6.0, 10.0, 14.0][..]),
        ("SE(B), four points", FOUR, FORCE, &[6.0, 10.0]),
        ("ESE(T)", ECCENTRIC, FORCE, &[10.0, 20.0, 28.0]),
        ("WOL", WEDGE, FORCE, &[15.0, 25.0, 35.0]),
        ("two cracks at a hole", TWO, TENSION, &[2.0, 10.0, 20.0]),
        ("one crack at a hole", ONE, TENSION, &[2.0, 10.0, 30.0]),
    ] {
        for length in lengths {
            let case = case(&text(&format!("{keys}\ncrack_length_mm = {length}"), loading), NODES)?;
            let formula = handbook_beside(&case.specimen);
            let formula = formula.ok_or_else(|| Error::Mechanics(format!("{name}: no handbook")))?;
            let tip = stress_intensity(&case, &[StressIntensityMethod::ElementFreeGalerkin])?.swap_remove(0);
            let ratio = tip.methods[0].intensity.k_i.unwrap_or(f64::NAN) / tip.handbook_k_i.unwrap_or(f64::NAN);
            let bound = 100.0 * formula.error_at(length * MM) + OF_NODES;
            table.compare(format!("{name}, a {length} mm: K_I on nodes over handbook"), ratio, 1.0, bound, formula.source);
        }
    }
    Ok(())
}

/// Cracks from 1.27 to 12 mm at a hole of radius 3.175 mm in a large plate, ΔS 90 MPa. In the width of 600 mm K of two cracks of 12 mm is 0.07 %
/// above that of a wider plate.
fn holes(table: &mut Table) -> Result<()> {
    let keys = "kind = \"crack_at_hole\"\nwidth_mm = 600\nlength_mm = 600\nthickness_mm = 2\nhole_diameter_mm = 6.35\ncrack_length_mm = 1.27";
    for (cracks, life) in [(1, 76_168.0), (2, 48_501.0)] {
        let text = text(&format!("{keys}\ncracks = {cracks}"), "stress_range_mpa = 90");
        let found = run(&text, &format!("{NODES} stop.crack_length_mm=12"))?.life_cycles();
        table.compare(format!("hole in a large plate, cracks: {cracks}, nodes: life"), found, life, 1.0, ELEMENTS);
    }
    Ok(())
}

/// A plate that was grown by finite elements.
struct Grown<'a> {
    name: &'a str,
    keys: &'a str,
    loading: &'a str,
    stop: &'a str,
    /// Tips, their places along x in mm, and the cycles there.
    places: &'a [(usize, &'a [(f64, f64)])],
    /// Tips that join another, and the cycles then.
    joins: &'a [(usize, f64)],
    /// Bound, percent.
    bound: f64,
}

/// Places on the way of several cracks.
fn places(table: &mut Table) -> Result<()> {
    let unequal = Grown {
        name: "unequal cracks at a hole",
        keys: "kind = \"crack_at_hole\"\nwidth_mm = 100\nlength_mm = 200\nthickness_mm = 2\nhole_diameter_mm = 10\ncrack_lengths_mm = [2, 4]",
        loading: "stress_max_mpa = 100",
        stop: "",
        places: &[
            (0, &[(15.0, 24_664.1), (20.0, 35_040.1), (25.0, 41_162.0)]),
            (1, &[(-10.0, 14_440.4), (-15.0, 29_089.8), (-20.0, 37_630.1)]),
        ],
        joins: &[],
        bound: 1.0,
    };
    let row = Grown {
        name: "row of three holes",
        keys: "kind = \"row_of_holes\"\nwidth_mm = 120\nlength_mm = 160\nthickness_mm = 2\nholes = 3\npitch_mm = 24\nhole_diameter_mm = 6\n\
               crack_lengths_mm = [[1, 1.5], [1.5, 1.5], [1, 1]]",
        loading: "stress_max_mpa = 80",
        stop: "stop.cycles_max=77000",
        places: &[(0, &[(-30.0, 40_714.3), (-40.0, 75_629.5)]), (5, &[(30.0, 43_580.2), (40.0, 76_080.8)])],
        joins: &[(1, 70_674.2), (3, 71_594.6)],
        bound: 2.0,
    };
    // Uniform stress at the held end.
    let lug = Grown {
        name: "lug",
        keys: "kind = \"lug\"\nwidth_mm = 50\nlength_mm = 100\nthickness_mm = 5\nhead = \"straight\"\nhole_diameter_mm = 20\n\
               crack_length_mm = 3\npin_half_angle_deg = 90",
        loading: "force_max_kn = 10",
        stop: "",
        places: &[(0, &[(15.0, 19_968.8), (18.0, 43_895.0), (21.0, 61_098.1)])],
        joins: &[],
        bound: 1.0,
    };
    for Grown { name, keys, loading, stop, places, joins, bound } in [unequal, row, lug] {
        let run = run(&text(keys, loading), &format!("{NODES} {stop}"))?;
        for &(tip, cycles) in joins {
            let joined = run.curve.iter().find(|row| row.tips[tip].state != TipState::Active);
            let found = joined.map_or(f64::NAN, |row| row.cycles);
            table.compare(format!("{name}, nodes: cycles until tip {tip} joins"), found, cycles, bound, ELEMENTS);
        }
        for (tip, places) in places {
            for (at, cycles) in *places {
                let quantity = format!("{name}, nodes: cycles of tip {tip} to x = {at} mm");
                table.compare(quantity, cycles_at(&run, *tip, *at), *cycles, bound, ELEMENTS);
            }
        }
    }
    Ok(())
}

/// Cycles at which a tip has come to x = `at`, mm, linear between rows.
fn cycles_at(run: &Prediction, tip: usize, at: f64) -> f64 {
    let place = |row: usize| run.curve[row].tips[tip].position[0] / MM;
    let passed = (1..run.curve.len()).find(|&row| (place(row - 1) - at) * (place(row) - at) <= 0.0);
    passed.map_or(f64::NAN, |row| {
        let share = (at - place(row - 1)) / (place(row) - place(row - 1));
        run.curve[row - 1].cycles + share * (run.curve[row].cycles - run.curve[row - 1].cycles)
    })
}
