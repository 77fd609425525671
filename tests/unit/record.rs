//! Rows of a run: mechanics that fail in mid-run keep those so far, and none tells a K that was not read for it.

use perilife_base::error::{Error, Result};
use perilife_growth::predict::record::Record;
use perilife_growth::predict::{Prediction, Silent};
use perilife_growth::record::{CurvePoint, StopReason, TipRecord};
use perilife_growth::{CrackGrowth, GrowthStatus, State};
use perilife_laws::response::Response;
use perilife_points::crack_tip::TipState;

use crate::support::hand_cases::{PANEL, hand_case};

/// A crack that grows by a millimetre in thousand cycles.
struct Steady(Vec<CurvePoint>);

impl Steady {
    fn grow(&mut self) {
        let growth = 1e-3 * self.0.len() as f64;
        self.0.push(CurvePoint {
            is_solved: true,
            cycles: 1e6 * growth,
            crack_length: 0.01 + growth,
            delta_k: 1e7,
            growth_rate: 1e-6,
            work: f64::NAN,
            limit_load: None,
            broken_bonds: 0,
            tips: vec![TipRecord {
                state: TipState::Active,
                position: [growth, 0.0],
                growth,
                factors: None,
                t_stress: None,
                response: Response::PROPORTIONAL,
                growth_rate: None,
            }],
            depth: None,
            response: Response::PROPORTIONAL,
        });
    }
}

impl CrackGrowth for Steady {
    fn open(&mut self) -> Result<()> {
        self.grow();
        Ok(())
    }

    fn now(&self) -> GrowthStatus<'_> {
        self.0.last().unwrap().status()
    }

    fn curve(&mut self) -> Vec<CurvePoint> {
        std::mem::take(&mut self.0)
    }

    fn state(&self) -> State {
        State::Rows(self.0.clone())
    }

    fn restore(&mut self, _: State) -> Result<bool> {
        Ok(false)
    }
}

/// A run whose third increment fails.
fn failing(error: fn() -> Error) -> Result<Prediction> {
    let case = hand_case(PANEL, &[]);
    Record::new(&case, &Silent).follow(&mut Steady(Vec::new()), |growth| {
        if growth.0.len() == 3 {
            return Err(error());
        }
        growth.grow();
        Ok(None)
    })
}

#[test]
fn an_error_of_mechanics_ends_the_run_with_the_rows_that_stand() {
    let run = failing(|| Error::Mechanics("the solver met its limit".to_owned())).unwrap();
    assert_eq!((run.stop, run.curve.len(), run.life_cycles()), (StopReason::NoConvergence, 3, 2000.0));
    assert!(run.warnings.iter().any(|warning| warning.contains("the solver met its limit")), "{:?}", run.warnings);
    let severed = failing(|| Error::LossOfStiffness).unwrap();
    assert_eq!((severed.stop, severed.curve.len()), (StopReason::Severed, 3));
}

#[test]
fn other_errors_are_the_callers() {
    let wrong = failing(|| perilife_base::error::input("fatigue.growth_table", 1.0, "ends too early", "give a longer one"));
    assert!(matches!(wrong, Err(Error::Input(_))));
}

#[test]
fn a_row_tells_no_k_that_was_not_read_for_it() {
    let case = hand_case(PANEL, &[]);
    let tip = |state| TipRecord {
        state,
        position: [0.0; 2],
        growth: 1e-3,
        factors: Some([1e7, 1e6]),
        t_stress: Some(1e6),
        response: Response::PROPORTIONAL,
        growth_rate: None,
    };
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
