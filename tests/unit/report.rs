//! Tables and `result.json`.

use perilife_base::columns::{exact_text, number_text};
use perilife_growth::predict::fit_use::life_share_extrapolated;
use perilife_results::{curve, factors};
use proptest::prelude::*;

use crate::support::{made_up_case, made_up_run};

fn significant_digits(text: &str) -> usize {
    let mantissa = text.split('e').next().unwrap();
    mantissa.trim_start_matches(['-', '0', '.']).bytes().filter(u8::is_ascii_digit).count()
}

proptest! {
    #[test]
    fn numbers_read_back_and_carry_ten_digits(value in any::<f64>().prop_filter("finite, not zero", |v| v.is_finite() && *v != 0.0)) {
        let text = exact_text(value);
        prop_assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits());
        prop_assert!(significant_digits(&text) >= 10, "{} for {:e}", text, value);
        let short = number_text(value);
        prop_assert!((short.parse::<f64>().unwrap() / value - 1.0).abs() < 1e-13 || value.abs() < 1e-300);
        prop_assert!(significant_digits(&short) >= 10, "{} for {:e}", short, value);
    }
}

#[test]
fn numbers_look_as_people_write_them() {
    let looks = [(0.0, "0"), (9.0, "9.000000000"), (1e7, "10000000.00"), (2.5e-5, "2.500000000e-5"), (f64::NAN, "")];
    for (value, text) in looks {
        assert_eq!(exact_text(value), text);
    }
    // 0.3 m in mm is 299.99999999999994 by IEEE division; the table says 300.
    assert_eq!(number_text(0.3 / 1e-3), "300.0000000");
}

#[test]
fn the_curve_table_reads_back() {
    let mut run = made_up_run::prediction(0.0);
    run.curve[3].delta_k = f64::NAN;
    let file = tempfile::NamedTempFile::new().unwrap();
    let table = curve::a_n(&made_up_case::case(), &run, None).csv();
    std::fs::write(file.path(), &table).unwrap();
    let rows = curve::read_a_n(file.path()).unwrap();
    assert_eq!(rows.len(), run.curve.len(), "one row per block and one for N = 0");
    for (row, point) in rows.iter().zip(&run.curve) {
        assert_eq!(row.cycles.to_bits(), point.cycles.to_bits(), "cycles are never rounded");
        assert!((row.crack_length_mm - 1e3 * point.crack_length).abs() < 1e-12 * row.crack_length_mm);
        assert_eq!(row.delta_k_mpa_sqrt_m.is_nan(), point.delta_k.is_nan());
    }
    assert!(table.starts_with(
        "cycles,crack_length_mm,delta_k_mpa_sqrt_m,da_dn_mm_per_cycle,broken_bonds,load_work_j,tip0_x_mm,tip0_y_mm,tip0_growth_mm,tip1_x_mm"
    ));
}

/// K_I of every tip is that of a straight crack of the length that both share; one stands still, and K of the last row was not read.
#[test]
fn factors_of_every_tip_stand_in_long_form() {
    let mut case = made_up_case::case();
    let mut run = made_up_run::prediction(0.0);
    let rows = run.curve.len();
    for (number, point) in run.curve.iter_mut().enumerate() {
        point.tips[1].growth *= 0.5;
        let length = 0.5 * (10e-3 + point.tips[0].growth + point.tips[1].growth);
        let k_i = 70e6 * (std::f64::consts::PI * length).sqrt();
        point.tips.iter_mut().for_each(|tip| tip.factors = (number + 1 < rows).then_some([k_i, 0.0]));
    }
    let table = factors::factors(&case, &run).unwrap().csv();
    let mut lines = table.lines();
    let head = "tip,cycles,crack_length_mm,growth_mm,k_i_mpa_sqrt_m,k_ii_mpa_sqrt_m,k_eq_mpa_sqrt_m,delta_k_mpa_sqrt_m,beta_length_mm,beta,da_dn_mm_per_cycle";
    assert_eq!(lines.next(), Some(head));
    let of = |line: &str| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect::<Vec<f64>>();
    let table: Vec<Vec<f64>> = lines.map(of).collect();
    assert_eq!(table.len(), 2 * rows, "a row for every tip and row of the curve");
    for (number, row) in table.iter().enumerate() {
        let point = &run.curve[number % rows];
        assert!(row[0] == (number / rows) as f64 && row[1] == point.cycles);
        assert!((row[2] / (1e3 * point.crack_length) - 1.0).abs() < 1e-12);
        if number % rows == rows - 1 {
            assert!(row[4..8].iter().chain(&row[9..]).all(|cell| cell.is_nan()), "{row:?}");
        } else {
            assert!((row[9] - 1.0).abs() < 1e-8 && (row[7] / (0.9 * row[4]) - 1.0).abs() < 1e-12 && row[6] == row[4], "{row:?}");
            assert!((row[10] / 1e-11).is_finite() && row[10] > 0.0);
        }
    }
    // The first tip grows farther.
    let beta = factors::beta(&case, &run).unwrap();
    let pairs: Vec<Vec<f64>> = beta.lines().map(|line| line.split(' ').map(|cell| cell.parse().unwrap()).collect()).collect();
    assert!(pairs.len() == rows - 1 && (pairs[0][0] - 5.0).abs() < 1e-6, "{:?}", pairs[0]);
    assert!(pairs.windows(2).all(|pair| pair[1][0] > pair[0][0]) && pairs.iter().all(|pair| (pair[1] - 1.0).abs() < 1e-8));
    // A force has no stress to compare with.
    case.specimen.load_measure = perilife_plate::specimen::LoadMeasure::Force;
    assert_eq!(factors::beta(&case, &run), None);
}

#[test]
fn a_broken_curve_table_names_line_and_column() {
    let head = "cycles,crack_length_mm,delta_k_mpa_sqrt_m,da_dn_mm_per_cycle";
    let broken = [
        ("N,a\n0,9\n".to_owned(), 1, "header"),
        (format!("{head}\n"), 1, "no row"),
        (format!("{head}\n0,9,,\nten,9,,\n"), 3, "cycles = \"ten\""),
        (format!("{head}\n0,9,,\n10,9,,\n5,9,,\n"), 4, "falls"),
        (format!("{head}\n0,,8,1e-5\n"), 2, "crack_length_mm"),
        (format!("{head}\n0,inf,8,1e-5\n"), 2, "crack_length_mm"),
    ];
    for (text, line, words) in broken {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), &text).unwrap();
        let error = curve::read_a_n(file.path()).unwrap_err();
        let message = error.to_string();
        assert_eq!(error.exit_code(), 2, "{message}");
        assert!(message.contains(&format!(":{line}: ")) && message.contains(words), "{message}");
    }
}

#[test]
fn every_tip_has_its_path_from_the_far_end_of_its_crack() {
    let run = made_up_run::prediction(0.0);
    let cracks = made_up_run::cracks();
    let table = curve::crack_path(&run, &cracks).csv();
    assert_eq!(table.lines().next(), Some("tip,cycles,x_mm,y_mm"));
    assert_eq!(table.lines().count(), 1 + 2 * (1 + run.curve.len()));
    let paths = curve::paths(&run, &cracks);
    // Tip 0 stands at the left end, `from`; its path comes from the right end, `to`.
    assert_eq!((paths[0][0], paths[1][0]), ((0.0, cracks[0].to), (0.0, cracks[0].from)));
    assert_eq!(curve::paths(&run, &[])[0][0], (0.0, run.curve[0].tips[0].position), "a slot's tip starts where it is");
}

#[test]
fn the_result_has_every_promised_key() {
    let (case, run) = (made_up_case::case(), made_up_run::prediction(0.0));
    let result = made_up_run::result(&case, &run);
    let promised = "life_cycles stop_reason crack_length_final_mm points points_solved bonds blocks solves wall_s memory_mb model version case \
                    warnings life_share_extrapolated";
    for key in promised.split_whitespace() {
        assert!(result.get(key).is_some(), "{key}");
    }
    assert_eq!(result["life_cycles"].as_f64(), Some(run.life_cycles()));
    assert_eq!(result["stop_reason"], "crack_length_reached");
    assert_eq!(result["case"], case.echo);
    assert_eq!(result["warnings"], serde_json::json!(["made up", "spacing moved"]));
    assert!(result["life_share_extrapolated"].is_null(), "an inline law has no fitted range");
    let why = &result["model"]["why"];
    assert_eq!(why["bond_law"], "given in the case");
    assert_eq!(result["law"]["a_used"], 1e5, "the same horizon, so the same A");
    assert!(why["kernel"].as_str().unwrap().starts_with("default"));
    // The run says what solved it, the reason what was asked for.
    assert_eq!(result["model"]["solver"], "multigrid");
    assert!(why["solver"].as_str().unwrap().contains("requested \"window\""), "{}", why["solver"]);
    assert!(why["spacing_mm"].as_str().unwrap().contains("moved from 1.010000 to 1.000000"));
}

#[test]
fn a_fitted_record_is_the_reason_for_its_choices() {
    let mut case = made_up_case::case();
    case.law = made_up_case::fitted(8.0, 25.0);
    let result = made_up_run::result(&case, &made_up_run::prediction(0.0));
    assert_eq!(result["model"]["why"]["bond_law"], "given in the case");
    assert!(result["model"]["why"]["kernel"].as_str().unwrap().starts_with("from the fitted law"));
    assert!(result["life_share_extrapolated"].as_f64().unwrap() < 0.1);
}

#[test]
fn life_outside_the_fitted_range_is_counted() {
    let mut case = made_up_case::case();
    let mut run = made_up_run::prediction(0.0);
    // ΔK rises linearly from 10 to 20 MPa√m over 100 cycles, in two blocks of unlike length.
    run.curve.truncate(3);
    for (point, (cycles, delta_k)) in run.curve.iter_mut().zip([(0.0, 10e6), (30.0, 13e6), (100.0, 20e6)]) {
        (point.cycles, point.delta_k) = (cycles, delta_k);
    }
    for (low, high, share) in [(10.0, 20.0, 0.0), (12.0, 20.0, 0.2), (12.0, 18.0, 0.4), (30.0, 40.0, 1.0), (1.0, 40.0, 0.0)] {
        case.law = made_up_case::fitted(low, high);
        let found = life_share_extrapolated(&case, &run).unwrap();
        assert!((found - share).abs() < 1e-5, "{low} to {high}: {found}");
    }
    run.curve.iter_mut().for_each(|point| point.delta_k = f64::NAN);
    assert_eq!(life_share_extrapolated(&case, &run), None);
}
