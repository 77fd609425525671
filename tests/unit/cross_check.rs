//! K of a run against an independent one.

use perilife_growth::cross_check::{EnergyBalance, ReleasedEnergy};

const HORIZON: f64 = 3e-3;

/// Blocks of one horizon each: what tips and plate give off, J, and cycles.
fn balance(blocks: &[[f64; 3]]) -> EnergyBalance {
    let mut balance = EnergyBalance::default();
    for (i, &[of_tips, of_plate, cycles]) in blocks.iter().enumerate() {
        let block = ReleasedEnergy { of_tips, of_plate, growth: HORIZON, lengthening: HORIZON, cycles };
        balance.take(block, (i + 1) as f64 * HORIZON, 5.0 * HORIZON);
    }
    balance
}

#[test]
fn the_largest_difference_that_matters_is_told() {
    // Two intervals of five horizons; energy goes with K².
    let even = [[1.0, 1.0, 100.0]; 5];
    let high = [[1.21, 1.0, 10.0]; 5];
    let both = balance(&[even, high].concat());
    let check = both.check(550.0).unwrap();
    assert_eq!(check.compared, 2);
    assert!((check.difference - 0.1).abs() < 1e-12 && (check.crack_length - 7.5 * HORIZON).abs() < 1e-12, "{check:?}");
    assert!(check.is_large());
    // Where the second interval is a hundredth of the life it matters to nobody.
    let check = both.check(5000.0).unwrap();
    assert!(check.compared == 1 && check.difference.abs() < 1e-12 && !check.is_large(), "{check:?}");
    assert!(balance(&even[..4]).check(400.0).is_none(), "not far enough");
}

/// A plate that takes up energy while its crack grows has no K: that cannot pass for agreement.
#[test]
fn falling_energy_is_a_difference() {
    let check = balance(&[[1.0, -0.5, 1.0]; 5]).check(5.0).unwrap();
    assert!(check.difference == 1.0 && check.is_large(), "{check:?}");
}
