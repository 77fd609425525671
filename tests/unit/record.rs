//! Rows of a run: mechanics that fail in mid-run keep those so far, and none tells a K that was not read for it.

use std::cell::OnceCell;

use perilife_base::error::{Error, Result};
use perilife_growth::hand_calculation::HandCalculation;
use perilife_growth::predict::chain::{Chain, Stage};
use perilife_growth::predict::record::Record;
use perilife_growth::predict::{Prediction, Silent, predict};
use perilife_growth::record::{CurvePoint, StopReason, TipRecord};
use perilife_laws::growth_law::GrowthLaw;
use perilife_points::crack_tip::TipState;

use crate::support::hand_cases::{PANEL, hand_case};

/// A law that knows no rate, or says that it ends, from a K on, Pa√m.
#[derive(Debug)]
struct Ending {
    at: f64,
    is_refused: bool,
}

impl GrowthLaw for Ending {
    fn rate(&self, k_max: f64, _: f64) -> f64 {
        if k_max < self.at || self.is_refused { 1e-24 * k_max.powi(2) } else { f64::NAN }
    }

    fn beyond(&self, k_max: f64, _: f64) -> Option<String> {
        (k_max >= self.at).then(|| "ends too early".to_owned())
    }

    fn is_refused_beyond(&self) -> bool {
        self.is_refused
    }
}

/// A run whose law ends where the crack has grown by half.
fn ending(is_refused: bool) -> Result<Prediction> {
    let case = hand_case(PANEL, &[]);
    let whole = predict(&case, &Silent).unwrap();
    let at = whole.curve.iter().find(|row| row.crack_length > 0.0135).unwrap().k_max(&case.loading);
    let (growth, later) = (HandCalculation::start(&case, Box::new(Ending { at, is_refused })).unwrap(), OnceCell::new());
    Record::new(&case, &Silent).follow(Chain::of(&case, &later, Stage::Formula(growth)), None)
}

#[test]
fn an_error_of_mechanics_ends_the_run_with_the_rows_that_stand() {
    let run = ending(false).unwrap();
    assert_eq!(run.stop, StopReason::NoConvergence);
    let last = run.crack_length_final();
    assert!(run.curve.len() > 10 && (0.0133..0.0137).contains(&last) && run.life_cycles() > 0.0, "{last}");
    assert!(run.warnings.iter().any(|warning| warning.contains("is no number")), "{:?}", run.warnings);
}

#[test]
fn other_errors_are_the_callers() {
    assert!(
        matches!(ending(true), Err(Error::Input(error)) if error.problem.contains("ends too early, at a crack length of 13."))
    );
}

#[test]
fn a_row_tells_no_k_that_was_not_read_for_it() {
    let case = hand_case(PANEL, &[]);
    let tip = |state| TipRecord { factors: Some([1e7, 1e6]), t_stress: Some(1e6), ..TipRecord::unread(state, [0.0; 2], 1e-3) };
    let states = [TipState::Active, TipState::Closed, TipState::EnteredHole, TipState::LeftPlate, TipState::LinkedUp];
    let row = |work| CurvePoint::of_tips(&case, [1e3, work], 5, (states.map(tip).to_vec(), &[]), Some((2e7, 1e-7)));
    let settled = row(1.0);
    assert!(settled.delta_k > 0.0 && settled.growth_rate == 1e-7);
    let known = |row: &CurvePoint| row.tips.iter().map(|tip| tip.factors.is_some() && tip.t_stress.is_some()).collect::<Vec<_>>();
    assert_eq!(known(&settled), [true, true, false, false, false]);
    // Without an equilibrium there is none of any tip, nor between such a row and the one before.
    let severed = row(f64::NAN);
    for row in [severed.clone().between(&settled, 0.5), severed] {
        assert!(row.delta_k.is_nan() && row.growth_rate.is_nan() && known(&row) == [false; 5], "{row:?}");
        assert!(row.crack_length == settled.crack_length && row.cycles == 1e3);
    }
}
