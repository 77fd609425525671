//! Parts of the chart: fronts, machine, times in words.

use perilife_study::chart::{Machine, front};
use perilife_study::speed::seconds;

#[test]
fn the_machine_has_threads_and_an_instruction_set() {
    let machine = Machine::here();
    assert!(machine.threads > 0 && machine.instruction_set.starts_with(std::env::consts::ARCH), "{machine}");
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

#[test]
fn times_have_two_digits_and_a_unit_that_suits() {
    let looks =
        [(12.345, "12 s"), (1.2345, "1.2 s"), (0.01234, "12 ms"), (2.5e-4, "250 µs"), (f64::NAN, "-"), (1234.0, "1234 s")];
    looks.iter().for_each(|(value, text)| assert_eq!(seconds(*value), *text));
}
