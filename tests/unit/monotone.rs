//! Cycles over crack length between rows.

use perilife_base::monotone::Monotone;

/// N(a) of da/dN = C ΔK³, ΔK ~ √a: rows a quarter of the first crack apart are read to 0.15 % of life, on straight lines to 0.8 %.
#[test]
fn lives_between_rows_of_a_power_law() {
    let cycles = |a: f64| 1.0 / 10.0_f64.sqrt() - 1.0 / a.sqrt();
    let rows: Vec<[f64; 2]> = (0..17).map(|i| 10.0 + 2.5 * f64::from(i)).map(|a| [a, cycles(a)]).collect();
    let (table, life) = (Monotone::new(rows.iter().copied()), cycles(50.0));
    let mut worst = [0.0_f64; 2];
    for a in (0..=400).map(|i| 10.0 + 0.1 * f64::from(i)) {
        let pair = rows.windows(2).find(|pair| a <= pair[1][0] + 1e-9).unwrap();
        let line = pair[0][1] + (a - pair[0][0]) / (pair[1][0] - pair[0][0]) * (pair[1][1] - pair[0][1]);
        worst = [worst[0].max((table.at(a) - cycles(a)).abs() / life), worst[1].max((line - cycles(a)).abs() / life)];
    }
    println!("{worst:?}");
    assert!(worst[0] < 2e-3 && worst[1] > 5.0 * worst[0], "{worst:?}");
    // The inverse is one.
    for (before, y) in [(0, cycles(10.7)), (5, cycles(24.0)), (15, cycles(49.9))] {
        let a = rows[before][0] + table.fraction(before, y) * 2.5;
        assert!((table.at(a) - y).abs() < 1e-12, "{a}");
    }
}

#[test]
fn a_table_never_falls_and_keeps_its_points() {
    let rows = [[0.0, 0.0], [1.0, 5.0], [1.0, 6.0], [2.0, 6.0], [3.0, 6.1], [10.0, 90.0]];
    let table = Monotone::new(rows.into_iter());
    let values: Vec<f64> = (0..=1000).map(|i| table.at(0.01 * f64::from(i))).collect();
    assert!(values.windows(2).all(|pair| pair[0] <= pair[1]));
    assert_eq!([table.at(0.0), table.at(1.0), table.at(2.0), table.at(3.0), table.at(10.0)], [0.0, 6.0, 6.0, 6.1, 90.0]);
    assert!(Monotone::new(std::iter::empty()).at(1.0).is_nan());
}
