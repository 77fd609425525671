//! Runs that would count nonsense, or never end.

use perilife_base::error::Error;
use perilife_growth::predict::record::{BLOCKS_WITHOUT_GROWTH, Guard};
use perilife_growth::record::{CurvePoint, StopReason, TipRecord};

fn now(cycles: f64, crack_length: f64, tips: &[TipRecord]) -> CurvePoint {
    CurvePoint::bare(cycles, crack_length, tips.to_vec())
}

fn tip(growth: f64) -> TipRecord {
    TipRecord::unread(perilife_points::crack_tip::TipState::Active, [growth, 0.0], growth)
}

#[test]
fn what_is_no_number_ends_a_run_in_an_error() {
    let tips = [tip(1e-3)];
    for (before, cycles, crack_length, says) in [
        (0.0, f64::NAN, 0.01, "the cycles after a block came out as NaN"),
        (0.0, f64::INFINITY, 0.01, "the cycles after a block came out as inf"),
        (0.0, 10.0, f64::NAN, "the crack length after a block came out as NaN"),
        (20.0, 10.0, 0.01, "cycles fell from 20 to 10"),
    ] {
        match Guard::default().check(before, &now(cycles, crack_length, &tips)) {
            Err(Error::Mechanics(problem)) => assert!(problem.contains(says), "{problem}"),
            other => panic!("{other:?} instead of: {says}"),
        }
    }
    assert_eq!(Guard::default().check(0.0, &now(10.0, 0.01, &tips)).unwrap(), None);
}

#[test]
fn a_run_whose_tips_stand_still_ends() {
    let mut guard = Guard::default();
    // Growth before N = 0 is negative.
    for i in 0..BLOCKS_WITHOUT_GROWTH {
        let tips = [tip(-1e-3 + 1e-9 * i as f64), tip(0.0)];
        assert_eq!(guard.check(0.0, &now(0.0, 0.01, &tips)).unwrap(), None, "block {i} grew");
    }
    let still = [tip(-2e-3), tip(0.0)];
    for i in 1..BLOCKS_WITHOUT_GROWTH {
        assert_eq!(guard.check(0.0, &now(0.0, 0.01, &still)).unwrap(), None, "{i} blocks without growth");
    }
    assert_eq!(guard.check(0.0, &now(0.0, 0.01, &still)).unwrap(), Some(StopReason::NoGrowth));
}

#[test]
fn a_run_without_tips_has_none_to_watch() {
    let mut guard = Guard::default();
    assert!((0..2 * BLOCKS_WITHOUT_GROWTH).all(|_| guard.check(0.0, &now(0.0, 0.01, &[])).unwrap().is_none()));
}
