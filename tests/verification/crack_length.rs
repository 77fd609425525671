//! Rows of a curve: of one crack, with the error that is stated, as long as a laboratory would find it.

use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_growth::predict::error_estimate::error_estimate;
use perilife_growth::predict::{GoverningCrack, Prediction, Silent, predict};
use perilife_growth::record::CurvePoint;
use perilife_plate::specimen::Point;
use perilife_points::solver::SolverKind;
use perilife_study::cases::{AUTO, NODES, POINTS, Reference, case, compare, largest};

use crate::support::plates::{BOND_STRAIN, case as point_case, cracked_plate, pulled_plate};
use crate::support::rows::assert_refusal;
use crate::support::statics::loaded;

// A row of a curve is of one crack: its rate is the slope of its length, and a plate with several cracks ends where one has the length asked for.

/// A slant crack with two tips, two cracks of unlike length, and one from each edge: cracks, mm, and the length at which the run ends.
const PLATES: [(&str, &[[Point; 2]], f64); 3] = [
    ("slant", &[[[-5.0, -3.0], [5.0, 3.0]]], 30.0),
    ("two", &[[[-20.0, -12.0], [-8.0, -12.0]], [[8.0, 12.0], [18.0, 12.0]]], 24.0),
    ("edges", &[[[-40.0, 25.0], [-32.0, 25.0]], [[40.0, -25.0], [35.0, -25.0]]], 20.0),
];

/// Cycles that the rates of the rows give for the way of the crack: ∫ da/(da/dN), straight lines of 1/(da/dN) over a.
fn counted(run: &Prediction, governing: &GoverningCrack<'_>) -> f64 {
    let known = run.curve.iter().map(|row| (governing.length(row), 1.0 / governing.growth_rate(row)));
    let known: Vec<(f64, f64)> = known.filter(|(_, slowness)| slowness.is_finite()).collect();
    known.windows(2).map(|pair| (pair[1].0 - pair[0].0) * 0.5 * (pair[0].1 + pair[1].1)).sum()
}

#[test]
fn its_rate_is_the_slope_of_its_length() {
    for (name, cracks, stop) in PLATES {
        let text = cracked_plate(80.0, 120.0, cracks);
        let keys = format!("{NODES} stop.crack_length_mm={stop}");
        let case = case(&text, &keys).unwrap();
        let run = predict(&case, &Silent).unwrap();
        let governing = GoverningCrack::of(&case.specimen, &run.curve);
        let [first, last] = [&run.curve[0], &run.curve[run.curve.len() - 1]];
        let error = counted(&run, &governing) / run.life_cycles() - 1.0;
        assert!(error.abs() < 0.003, "{name}: {error}");
        // The crack that came to the length ends the run, whatever the others sum to.
        assert!((governing.length(last) / (stop * MM) - 1.0).abs() < 1e-9, "{name}: {}", governing.length(last) / MM);
        let longest = cracks.iter().map(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max);
        assert!((governing.length(first) / (longest * MM) - 1.0).abs() < 1e-9, "{name}: {}", governing.length(first) / MM);
        assert_eq!(governing.is_of_several(), cracks.len() > 1);
        // K of a row without equilibrium is not known.
        let is_above = |own: f64, of_all: f64| own > of_all * (1.0 + 1e-9);
        for row in &run.curve {
            assert!(governing.is_of_several() || governing.length(row) == row.crack_length);
            assert!(governing.length(row) <= row.crack_length && !is_above(governing.delta_k(row, 0.1), row.delta_k));
        }
    }
}

/// A length that the shortest crack has already is refused, one below the sum of all is not.
#[test]
fn the_length_to_stop_at_is_that_of_one_crack() {
    let text = cracked_plate(80.0, 120.0, PLATES[1].1);
    assert!(case(&text, &format!("{NODES} stop.crack_length_mm=11")).is_ok());
    let refused = case(&text, &format!("{NODES} stop.crack_length_mm=10"));
    assert_refusal(refused, &["stop.crack_length_mm = 10", "initial crack length 10 mm"]);
}

// The error that is stated with a life is above the one it has; `perilife verify estimates` has more plates and tolerances.

#[test]
fn a_life_is_within_the_error_that_is_stated() {
    for (name, model) in [("slant_severance", AUTO), ("hole_attracts", AUTO), ("slant_severance", POINTS)] {
        let reference = Reference::named(name).unwrap();
        let case = reference.case(&[model.to_owned()]).unwrap();
        let run = predict(&case, &Silent).unwrap();
        let stated = error_estimate(&case, &run).unwrap();
        let tips = compare(&run, reference.tips().unwrap(), f64::INFINITY);
        let off = largest(tips.iter().flat_map(|tip| tip.cycles)).abs();
        let path = tips.iter().map(|tip| tip.rms).fold(0.0, f64::max);
        println!(
            "{name} by {}: {off:.2} of {:.2} %, path {:.3} of {:.3} mm",
            case.model.method(),
            stated.life_percent,
            1e3 * path,
            1e3 * stated.path
        );
        assert!(off < stated.life_percent && path < stated.path, "{name}");
        // A bound that is far above says nothing.
        assert!(stated.life_percent < 3.0, "{name}: {stated:?}");
    }
}

/// A ligament between holes is what coarse nodes are worst at: the life errs by 1.6 %, and more is stated than of other plates.
#[test]
fn a_coarse_run_states_a_large_error() {
    let reference = Reference::named("double_edge_notched").unwrap();
    let coarse = reference.case(&[AUTO.to_owned(), "model.tolerance_percent=5".to_owned()]).unwrap();
    let run = predict(&coarse, &Silent).unwrap();
    let stated = error_estimate(&coarse, &run).unwrap().life_percent;
    let tips = compare(&run, reference.tips().unwrap(), f64::INFINITY);
    let off = largest(tips.iter().flat_map(|tip| tip.cycles)).abs();
    assert!(off > 1.0 && off < stated && stated < 4.0, "{off} of {stated}");
}

/// Where K asks for finer nodes near tips and rims alone, those far from them stay as they are.
#[test]
fn nodes_get_finer_where_k_asks_for_it() {
    let keys = [AUTO, "model.tolerance_percent=1", "stop.cycles_max=10"].map(str::to_owned);
    let run = predict(&Reference::named("three_point_bending").unwrap().case(&keys).unwrap(), &Silent).unwrap();
    let ([at_tips, far], k_i) = (run.figures.refined, run.curve[0].tips[0].factors.unwrap()[0] / MPA_SQRT_M);
    println!("{at_tips} and {far} times, {} nodes, {k_i:.4}", run.figures.points_solved);
    assert!(at_tips > far && (k_i / 12.954 - 1.0).abs() < 1.5e-3, "{at_tips} {far} {k_i}");
}

/// Every tip grows by its own rate over the same cycles, whichever leads: `∫ r dN` over the rows is what it has grown, but for steps at kinks. What a
/// tip is short of is made up for once, and takes no cycles.
#[test]
fn tips_that_lead_in_turn_grow_by_their_own_rates() {
    let text = cracked_plate(100.0, 200.0, &[[[-20.0, -4.0], [-8.0, -4.0]], [[8.0, 4.0], [20.0, 4.0]]]);
    let run = predict(&case(&text, NODES).unwrap(), &Silent).unwrap();
    let rows: Vec<_> = run.curve.iter().take_while(|row| row.cycles < 0.9 * run.life_cycles()).collect();
    for tip in 0..4 {
        let grown = |pair: &[&CurvePoint]| {
            let [from, to] = [0, 1].map(|row: usize| pair[row].tips[tip].growth_rate.unwrap());
            (pair[1].cycles - pair[0].cycles) * (to - from) / (to / from).ln()
        };
        let (by_rates, growth) = (rows.windows(2).map(grown).sum::<f64>(), rows.last().unwrap().tips[tip].growth);
        println!("tip {tip}: {:.4} by its rates, {:.4} mm", 1e3 * by_rates, 1e3 * growth);
        assert!((by_rates / growth - 1.0).abs() < 0.015, "tip {tip}: {by_rates} for {growth}");
    }
}

/// Bonds that fail by their own strain have no error that a finer lattice would tell.
#[test]
fn nothing_is_stated_of_bonds() {
    let case = Reference::named("slant_severance")
        .unwrap()
        .case(&["fatigue.driver=bond_strain".to_owned(), "stop.cycles_max=1".to_owned()]);
    let case = case.unwrap();
    let run = predict(&case, &Silent).unwrap();
    assert!(error_estimate(&case, &run).unwrap_err().contains("own strain"));
}

/// A crack that passes a hole at 0.03 mm hardly grows behind its rim: finite elements with steps of 0.004 mm give 1.04 million cycles, nodes 0.81 to 0.96
/// by how fine they are. The gap is less than what the path is known to.
#[test]
#[ignore = "long: ten seconds"]
fn nothing_is_stated_of_a_crack_that_grazes_a_hole() {
    let text = pulled_plate(
        "width_mm = 80\nlength_mm = 160\n\
         holes = [{ x_mm = 0, y_mm = 0, diameter_mm = 14 }, { x_mm = -24, y_mm = 2, diameter_mm = 10 }, { x_mm = 24, y_mm = 5, diameter_mm = 8 }]\n\
         cracks = [{ from_mm = [7, 0], to_mm = [10, 0] }]",
    );
    let case = case(&text, &format!("loading.stress_max_mpa=60 stop.crack_length_mm=22 {AUTO}")).unwrap();
    let run = predict(&case, &Silent).unwrap();
    let why = error_estimate(&case, &run).unwrap_err();
    println!("{why}");
    assert!(why.contains("passes an edge"), "{why}");
}

/// A bent crack in a double cantilever, T = 18 MPa at K_I = 2.5 MPa√m: lives with four settings of nodes and steps from 5.27 to 5.57 million cycles,
/// where 1.0 % would be stated. A straight one stays straight by symmetry.
#[test]
fn nothing_is_stated_of_a_path_that_is_unstable() {
    let why = |kink: f64| {
        let text = format!(
            "[specimen]\nkind = \"plate\"\nwidth_mm = 118\nlength_mm = 39.4\nthickness_mm = 1\n\
             holes = [{{ x_mm = -56, y_mm = 12, diameter_mm = 4 }}, {{ x_mm = -56, y_mm = -12, diameter_mm = 4 }}]\n\
             cracks = [{{ path_mm = [[-59, 0], [-19.6, 0], [-16.6, {kink}]] }}]\n\
             [material]\nyoungs_modulus_gpa = 206.8\npoisson_ratio = 0.3\nplane = \"strain\"\n[supports]\nright = {{ fix = [\"x\", \"y\"] }}\n\
             [loading]\nforce_max_n = 37\nstress_ratio = 0\npins = [{{ hole = 0, direction = [0, 1] }}, {{ hole = 1, direction = [0, -1] }}]\n\
             [fatigue]\nparis_c_mm_per_cycle = 1e-7\nparis_m = 3\n"
        );
        let case = case(&text, AUTO).unwrap();
        error_estimate(&case, &predict(&case, &Silent).unwrap()).err()
    };
    let is_unstable = |kink: f64| why(kink).is_some_and(|why| why.contains("path is unstable"));
    assert!(is_unstable(0.3) && !is_unstable(0.0));
}

// The crack length of a crack that bonds grew is the one a laboratory would find from the compliance of the same body.

fn panel(length: f64) -> String {
    format!("kind=\"middle_tension\"\nwidth_mm=90\nlength_mm=120\nthickness_mm=2\ncrack_length_mm={length}\n")
}

/// Compliance of the body with a straight cut of each length is inverted at the compliance of the grown crack. Runs by name, keys and error
/// while the front takes its shape.
fn compared(runs: &[(&str, &[&str], f64)]) {
    let cut: Vec<(f64, f64)> = (18..=32)
        .map(|a| {
            let case = point_case(&panel(f64::from(a)), &[BOND_STRAIN, "model.spacing_mm=1"]);
            (f64::from(a) * MM, loaded(&case, SolverKind::Multigrid).unwrap().work)
        })
        .collect();
    for (name, set, forming) in runs {
        let all = [&[BOND_STRAIN, "model.spacing_mm=1", "stop.crack_length_mm=30"], *set].concat();
        let run = predict(&point_case(&panel(20.0), &all), &Silent).unwrap();
        let by_compliance = |work: f64| {
            let pair = cut.windows(2).find(|pair| pair[1].1 >= work).unwrap();
            pair[0].0 + (work - pair[0].1) / (pair[1].1 - pair[0].1) * (pair[1].0 - pair[0].0)
        };
        for target in [20.0, 20.5, 21.0, 22.0, 24.0, 26.0, 28.0, 29.5] {
            let point = run.curve.iter().find(|point| point.crack_length >= target * MM).unwrap();
            let found = by_compliance(point.work);
            // In spacings of 1 mm: 0.114 (p = 4) and 0.078 while the front of a clean cut takes its shape, then 0.046.
            let allowed = if target <= 22.0 { *forming } else { 0.05 };
            assert!((point.crack_length - found).abs() < allowed * MM, "{name}: {} and {}", point.crack_length / MM, found / MM);
        }
    }
}

#[test]
fn a_grown_crack_is_as_long_as_its_compliance_says() {
    let exponents = [["fatigue.p=2", "stop.cycles_max=1e12"], ["fatigue.p=4", "stop.cycles_max=1e12"]];
    compared(&[("clean cut", &[], 0.1), ("p = 2", &exponents[0], 0.1), ("p = 4", &exponents[1], 0.12)]);
}
