//! The mean length over one spacing of growth: no stairs, no shift, fixed ends.

use perilife_laws::growth_rate::LengthAverage;

/// A crack that grows steadily by 0.01 a cycle, recorded as breaks of uneven size in a pattern that repeats every 0.9.
fn staircase(breaks: usize) -> (Vec<f64>, Vec<f64>) {
    let mut cycles = vec![0.0];
    let mut lengths = vec![5.0];
    for i in 0..breaks {
        let period = (i / 3 + 1) as f64;
        cycles.push(90.0 * (i / 3) as f64 + [20.0, 35.0, 90.0][i % 3]);
        lengths.push(5.0 + 0.9 * (period - 1.0) + [0.5, 0.7, 0.9][i % 3]);
    }
    (cycles, lengths)
}

#[test]
fn stairs_vanish_and_steady_growth_stays() {
    let (cycles, lengths) = staircase(90);
    let averaged = LengthAverage::new(&cycles, &lengths, 0.9).of_rising(&lengths);
    let steady = |n: f64| 5.0 + 0.01 * n;
    let roughness = |values: &[f64], from: usize, to: usize| {
        let off: Vec<f64> = (from..to).map(|i| values[i] - steady(cycles[i])).collect();
        off.iter().copied().fold(f64::NEG_INFINITY, f64::max) - off.iter().copied().fold(f64::INFINITY, f64::min)
    };
    // Away from the ends, where the whole window fits.
    assert!(roughness(&lengths, 5, 85) > 0.3);
    assert!(roughness(&averaged, 5, 85) < 1e-9, "{}", roughness(&averaged, 5, 85));
    assert!(averaged.windows(2).all(|pair| pair[1] >= pair[0]));
    assert_eq!((averaged[0], averaged[90]), (lengths[0], lengths[90]));
}

#[test]
fn a_straight_curve_stays_itself_and_a_sudden_jump_is_not_smeared() {
    let cycles: Vec<f64> = (0..50).map(f64::from).collect();
    let straight: Vec<f64> = cycles.iter().map(|n| 3.0 + 0.2 * n).collect();
    for (mean, length) in LengthAverage::new(&cycles, &straight, 1.0).of(&straight).iter().zip(&straight) {
        assert!((mean - length).abs() < 1e-12, "{mean} and {length}");
    }
    // The last ligament breaks in no time: what stood before the jump stays below it.
    let jump_cycles = [0.0, 10.0, 20.0, 30.0, 30.0, 30.0];
    let jump = [1.0, 1.1, 1.2, 1.3, 4.0, 9.0];
    let mean = LengthAverage::new(&jump_cycles, &jump, 1.0).of_rising(&jump);
    assert!(mean[3] < 1.31 && mean[5] == 9.0, "{mean:?}");
}

#[test]
fn runs_of_one_or_two_rows_stay() {
    assert_eq!(LengthAverage::new(&[0.0], &[2.0], 1.0).of(&[2.0]), [2.0]);
    assert_eq!(LengthAverage::new(&[0.0, 7.0], &[2.0, 2.5], 1.0).of(&[2.0, 2.5]), [2.0, 2.5]);
}
