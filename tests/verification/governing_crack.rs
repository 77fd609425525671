//! A row of a curve is of one crack: its rate is the slope of its length, and a plate with several cracks ends where one has the length asked for.

use perilife_base::units::MM;

use perilife_growth::predict::{GoverningCrack, Prediction, Silent, predict};
use perilife_plate::specimen::Point;
use perilife_study::cases::{NODES, case};

use crate::support::plates::cracked_plate;

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
        println!("{name}: {} rows, ∫ da/(da/dN) off by {:+.2} % of the cycles", run.curve.len(), 100.0 * error);
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
    let error = case(&text, &format!("{NODES} stop.crack_length_mm=10")).unwrap_err().to_string();
    assert!(error.contains("stop.crack_length_mm = 10") && error.contains("initial crack length 10 mm"), "{error}");
}
