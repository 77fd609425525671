//! Parts of the chart: fronts, places of samples, and what is made of them.

use perilife::chart::extrapolation::{Sampled, places};
use perilife::chart::machine::Machine;
use perilife::chart::pareto::front;
use perilife::report::speed::seconds;

#[test]
fn vectors_hold_whole_doubles() {
    let machine = Machine::here();
    assert!(machine.simd_bits >= 64 && machine.simd_bits.is_power_of_two() && machine.threads > 0, "{machine}");
    assert!(!machine.instruction_set.contains('('), "{machine}");
}

#[test]
fn beaten_points_are_left_out() {
    let points = [(1.0, 3.0), (2.0, 4.0), (0.5, 8.0), (4.0, 1.0), (3.0, 1.0), (5.0, f64::NAN), (9.0, 2.0)];
    assert_eq!(front(&points), [2, 0, 4]);
}

#[test]
fn round_off_earns_no_place() {
    assert_eq!(front(&[(1.0, 2.0), (3.0, 2.0 * (1.0 - 1e-6))]), [0]);
    assert_eq!(front(&[(1.0, 2.0), (3.0, 2.0 * (1.0 - 1e-2))]), [0, 1]);
    assert_eq!(front(&[(1.0, 2.0), (2.0, 0.0), (3.0, 0.0)]), [0, 1], "no error at all earns one, but once");
}

#[test]
fn nothing_has_no_front() {
    assert!(front(&[]).is_empty() && front(&[(f64::INFINITY, 1.0), (1.0, f64::NAN)]).is_empty());
}

fn sampled(blocks: &[(usize, f64)]) -> Sampled {
    Sampled { start_s: 3.0, blocks: blocks.to_vec(), work: f64::NAN, broken_bonds: 0 }
}

#[test]
fn equal_blocks_add_up() {
    assert!((sampled(&[(2, 0.5), (7, 0.5)]).whole(10) - 8.0).abs() < 1e-12);
    assert_eq!(sampled(&[(4, 0.5)]).whole(0), 3.0, "a run without a break has its first solve");
}

#[test]
fn blocks_between_lie_on_the_line() {
    // 1, 1 (level before), then 1, 2, 3 (line), then 3 (level after).
    assert!((sampled(&[(1, 1.0), (3, 3.0)]).whole(5) - (3.0 + 1.0 + 1.0 + 2.0 + 3.0 + 3.0)).abs() < 1e-12);
    // Time that grows linearly along the run is summed exactly when sampled in the middle of equal parts, but for the ends.
    let line: Vec<(usize, f64)> = places(100, 20).into_iter().map(|block| (block, block as f64)).collect();
    let exact = (0..100).sum::<usize>() as f64;
    assert!((sampled(&line).whole(100) - 3.0 - exact).abs() < 0.01 * exact);
}

#[test]
fn nothing_measured_gives_no_number() {
    assert!(sampled(&[]).whole(4).is_nan());
}

#[test]
fn places_are_spread_over_the_run() {
    assert_eq!(places(100, 20), (0..20).map(|i| 2 + 5 * i).collect::<Vec<_>>());
    assert_eq!(places(10, 0), [1, 3, 5, 7, 9]);
    assert_eq!(places(3, 20), [0, 1, 2]);
    assert!(places(0, 20).is_empty());
}

#[test]
fn times_have_two_digits_and_a_unit_that_suits() {
    let looks =
        [(12.345, "12 s"), (1.2345, "1.2 s"), (0.01234, "12 ms"), (2.5e-4, "250 µs"), (f64::NAN, "-"), (1234.0, "1234 s")];
    looks.iter().for_each(|(value, text)| assert_eq!(seconds(*value), *text));
}
