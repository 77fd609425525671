//! β(a) out of a sweep and back in by `specimen.beta_file`; compliance of a compact specimen.

use perilife_base::input::Folder;
use perilife_base::units::MM;
use perilife_growth::case::Case;
use perilife_growth::predict::factor_sweep::{FactorSweep, factor_sweep};
use perilife_growth::predict::{Silent, predict};
use perilife_results::factors::{SIGN, beta_table, table};

use crate::support::hand_cases::{ALL, PANEL, hand_case, try_hand_case_in};
use crate::support::plates::try_case;
use crate::support::rows::{assert_refusal, rows};

/// Lengths from one to another, mm, in so many steps.
fn lengths([from, to]: [f64; 2], steps: usize) -> Vec<f64> {
    (0..=steps).map(|i| (from + (to - from) * i as f64 / steps as f64) * MM).collect()
}

fn life(specimen: &str, set: &[&str], beta: &str) -> f64 {
    let folder = Folder::at_hand([("beta.csv".to_owned(), beta.as_bytes().to_vec())]);
    let case = try_hand_case_in(&format!("{specimen}beta_file = \"beta.csv\"\n"), set, folder).unwrap();
    predict(&case, &Silent).unwrap().life_cycles()
}

fn sweep(case: &Case, range: [f64; 2], steps: usize) -> FactorSweep {
    factor_sweep(case, &lengths(range, steps), false, &Silent).unwrap()
}

/// K of a formula, 1 mm apart, read back: the life of the formula, of pulled specimens and of one on pins.
#[test]
fn a_handbook_read_back_gives_its_own_life() {
    for (specimen, range) in ALL.into_iter().zip([[9.0, 49.0], [8.0, 28.0], [8.0, 28.0], [12.5, 32.5]]) {
        let stop = format!("stop.crack_length_mm={}", range[1]);
        let case = hand_case(specimen, &[&stop]);
        let own = predict(&case, &Silent).unwrap().life_cycles();
        let steps = (range[1] - range[0]) as usize;
        let text = beta_table(&sweep(&case, range, steps)).csv();
        assert_eq!(text.lines().count(), steps + 2, "{text}");
        let ratio = life(specimen, &[&stop], &text) / own;
        assert!((ratio - 1.0).abs() < 1e-6, "{specimen}: {ratio}");
    }
}

/// K of a run on nodes, 0.25 mm apart, read back: the life of the law over K of that run as it is between, whose crack has two tips.
#[test]
fn a_run_on_nodes_read_back_gives_the_life_of_its_own_factors() {
    let plate = "kind = \"plate\"\nwidth_mm = 100.0\nlength_mm = 200.0\nthickness_mm = 2.0\n\
                 cracks = [{ from_mm = [-8, 0], to_mm = [8, 0] }]\n";
    let set = ["model.method=element_free_galerkin", "stop.crack_length_mm=40"];
    let by_nodes = try_hand_case_in(plate, &set, Folder::none()).unwrap();
    let (c, m) = (8.95422e-8 * MM, 2.874);
    let dense = sweep(&by_nodes, [16.0, 40.0], 480);
    let of_tip: Vec<_> = dense.rows.iter().filter(|row| row.tip == 0).collect();
    // Both tips lengthen the crack; Simpson's rule over 0.1 mm.
    let inverse: Vec<f64> =
        of_tip.iter().map(|row| 0.5 / c * (by_nodes.loading.range_share() * row.factors[0] / 1e6).powf(-m)).collect();
    let own: f64 = inverse.windows(3).step_by(2).map(|at| (at[0] + 4.0 * at[1] + at[2]) * 0.1 * MM / 6.0).sum();
    let found = sweep(&by_nodes, [16.0, 40.0], 96);
    let first = &found.rows[0];
    assert!((first.beta_length / MM - 8.0).abs() < 1e-9 && (first.crack_length / MM - 16.0).abs() < 1e-9, "{first:?}");
    let ratio = life(plate, &set[1..], &beta_table(&found).csv()) / own;
    assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");
}

/// K between the solves of a sweep is that of plates cut at its lengths: a central crack within what its formula is right to, and a crack at a
/// hole read back gives the life of its run on nodes.
#[test]
fn a_sweep_has_the_factors_of_every_length() {
    let panel = "kind = \"plate\"\nwidth_mm = 100.0\nlength_mm = 300.0\nthickness_mm = 2.0\n\
                 cracks = [{ from_mm = [-10, 0], to_mm = [10, 0] }]\n";
    let case = try_hand_case_in(panel, &["model.method=element_free_galerkin"], Folder::none()).unwrap();
    let found = sweep(&case, [20.0, 80.0], 60);
    let (mut off, mut rows_off) = (0.0_f64, 0.0_f64);
    // Tada, 0.1 % for any 2a/W.
    let of = |x: f64| (1.0 - 0.025 * x.powi(2) + 0.06 * x.powi(4)) / (std::f64::consts::FRAC_PI_2 * x).cos().sqrt();
    for row in &found.rows {
        off = off.max((row.beta / of(row.crack_length / (100.0 * MM)) - 1.0).abs());
    }
    // The rows of a prediction, whose steps are longer, up to a crack of half the width.
    for row in predict(&case, &Silent).unwrap().curve.iter().filter(|row| row.crack_length < 50.0 * MM) {
        let stress = case.loading.range_share() * case.loading.maximum * (0.5 * std::f64::consts::PI * row.crack_length).sqrt();
        rows_off = rows_off.max((row.delta_k / stress / of(row.crack_length / (100.0 * MM)) - 1.0).abs());
    }
    assert!(off < 0.002 && rows_off < 0.003, "{off} {rows_off}");

    let hole = "kind = \"crack_at_hole\"\nwidth_mm = 100.0\nlength_mm = 200.0\nthickness_mm = 2.0\nhole_diameter_mm = 10.0\ncrack_length_mm = 2.0\n";
    let stop = "stop.crack_length_mm=20";
    let by_nodes = try_hand_case_in(hole, &["model.method=element_free_galerkin", stop], Folder::none()).unwrap();
    let own = predict(&by_nodes, &Silent).unwrap().life_cycles();
    let ratio = life(hole, &[stop], &beta_table(&sweep(&by_nodes, [2.0, 20.0], 18)).csv()) / own;
    assert!((ratio - 1.0).abs() < 2e-3, "{ratio}");
}

/// Compliance of a compact specimen over a/W by the polynomials of ASTM E647-15 (A1, table A1.1, E v B/P at the front face and on the load
/// line; back-face strain X: Riddell and Piascik 1999), which give a/W within 0.1 % of W; opening of the panel by Tada.
#[test]
fn compliance_is_that_of_the_standard() {
    let specimen = ALL[3];
    let case = hand_case(specimen, &[]);
    let (width, thickness, load) = (50.0 * MM, 12.5 * MM, case.loading.maximum);
    let modulus = case.material.plane_modulus();
    let solved = |case: &Case, range, steps| factor_sweep(case, &lengths(range, steps), true, &Silent).unwrap();
    // As its crack is at every length, and as a run on nodes leaves it.
    let by_nodes = hand_case(specimen, &["model.method=element_free_galerkin"]);
    let rows = [solved(&case, [15.0, 40.0], 5).rows, solved(&by_nodes, [15.0, 40.0], 5).rows].concat();
    let inverse = |u: f64, c: [f64; 6]| c.iter().rev().fold(0.0, |sum, c| sum * u + c);
    for row in &rows {
        let u = |compliance: f64| 1.0 / (compliance.sqrt() + 1.0);
        let of = |opening: f64| u(modulus * opening * thickness / load);
        let at_front = inverse(of(row.mouth_opening.unwrap()), [1.0010, -4.6695, 18.460, -236.82, 1214.9, -2143.6]);
        let on_line = inverse(of(row.load_line.unwrap()), [1.0002, -4.0632, 11.242, -106.04, 464.33, -650.68]);
        let strain = -row.back_face_strain.unwrap();
        let at_back = inverse(u(strain * modulus * thickness * width / load), [1.0033, -2.35, 1.3694, -15.294, 63.182, -74.42]);
        let asked = row.crack_length / width;
        for (what, told) in [("front", at_front), ("load line", on_line), ("back face", at_back)] {
            assert!((told - asked).abs() < 0.005, "{what}: a/W {told} for {asked}");
        }
    }
    // v = 4σa/E' V(2a/W), V = -0.071 - 0.535 x + 0.169 x² + 0.020 x³ - 1.071/x ln(1 - x), ±0.6 %.
    let panel = hand_case(PANEL, &[]);
    let found = solved(&panel, [20.0, 30.0], 1);
    let row = &found.rows[2];
    let x = 2.0 * row.crack_length / (152.4 * MM);
    let v = -0.071 - 0.535 * x + 0.169 * x * x + 0.020 * x.powi(3) - 1.071 / x * (1.0 - x).ln();
    let opening = 4.0 * panel.loading.maximum * row.crack_length / panel.material.plane_modulus() * v;
    let ratio = row.mouth_opening.unwrap() / opening;
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
}

#[test]
fn the_table_has_the_columns_of_the_contract() {
    let case = hand_case(PANEL, &[]);
    let text = table(&factor_sweep(&case, &lengths([9.0, 11.0], 1), true, &Silent).unwrap()).csv();
    let contract = "crack_length_mm,tip,x_mm,y_mm,k_i_mpa_sqrt_m,k_ii_mpa_sqrt_m,t_stress_mpa,beta,cmod_mm,\
                    beta_length_mm,load_line_displacement_mm,back_face_strain";
    assert_eq!(text.lines().next(), Some(contract));
    assert!(text.starts_with(SIGN) && text.lines().count() == 5, "{text}");
    let row: Vec<f64> = text.lines().nth(4).unwrap().split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
    // σ √(πa) of 60.35 MPa and 11 mm times √(sec(π 11/152.4)).
    assert!((row[4] - 11.3653).abs() < 0.001 && row[2] == 11.0 && (row[7] - 1.01305).abs() < 1e-4 && row[8] > 0.0, "{row:?}");
}

/// Every table that is none, with what its message names.
#[test]
fn tables_that_are_none_are_refused_by_line_and_value() {
    for [text, words] in rows::<Vec<[String; 2]>>("beta_table", "no_tables") {
        let folder = Folder::at_hand([("beta.csv".to_owned(), text.as_bytes().to_vec())]);
        let set = ["stop.crack_length_mm=49.8"];
        let specimen = format!("{PANEL}beta_file = \"beta.csv\"\n");
        let run = try_hand_case_in(&specimen, &set, folder).and_then(|case| predict(&case, &Silent));
        assert_refusal(run, &[&words]);
    }
    let same: Vec<String> = rows("beta_table", "same");
    let lives: Vec<f64> = same.iter().map(|text| life(PANEL, &["stop.crack_length_mm=49.8"], text)).collect();
    assert!(lives.iter().all(|life| (life / lives[0] - 1.0).abs() < 1e-9), "{lives:?}");
    // A way to K beside it, cracks of unlike length, slots and lengths that are not reached.
    let good = || Folder::at_hand([("beta.csv".to_owned(), b"crack_length_mm,beta\n1,1\n90,1.2\n".to_vec())]);
    let plate = "kind = \"plate\"\nwidth_mm = 100.0\nlength_mm = 200.0\nthickness_mm = 2.0\nbeta_file = \"beta.csv\"\n";
    let unlike = "cracks = [{ from_mm = [-50, 0], to_mm = [-40, 0] }, { from_mm = [50, 0], to_mm = [44, 0] }]\n";
    let slot = "notches = [{ from_mm = [-50, 0], to_mm = [-40, 0], width_mm = 2 }]\n";
    let refused = [
        (format!("{PANEL}beta_file = \"beta.csv\"\n"), "model.method=element_free_galerkin", "finds K itself"),
        (format!("{plate}{unlike}"), "model.method=handbook", "different length, a = 6 and 10 mm"),
        (format!("{plate}{slot}"), "model.method=handbook", "requires cracks, not slots"),
    ];
    for (specimen, set, words) in refused {
        assert_refusal(try_hand_case_in(&specimen, &[set], good()), &["specimen.beta_file", words]);
    }
    let slant = try_case(
        "kind = \"plate\"\nwidth_mm = 100\nlength_mm = 200\nthickness_mm = 2\ncracks = [{ from_mm = [-50, 0], to_mm = [-40, 0] }]\n",
        &[],
    );
    let refused = factor_sweep(&slant.unwrap(), &lengths([5.0, 20.0], 3), false, &Silent);
    assert_refusal(refused, &["--sweep = 5", "initial crack length 10 mm"]);
    let named = try_case(
        "kind = \"crack_at_hole\"\nwidth_mm = 100\nlength_mm = 200\nthickness_mm = 2\nhole_diameter_mm = 10\ncrack_length_mm = 8\n",
        &[],
    );
    let refused = factor_sweep(&named.unwrap(), &lengths([5.0, 20.0], 3), false, &Silent);
    assert_refusal(refused, &["begin there, or give a smaller specimen.crack_length_mm"]);
}
