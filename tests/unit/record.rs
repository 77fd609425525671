//! Rows of a run: what is read, guarded, checked and kept of it.

use std::cell::OnceCell;

use perilife_base::error::{Error, Result};
use perilife_growth::cracks::tip::{AtLoad, Reading};
use perilife_growth::cross_check::{EnergyBalance, ReleasedEnergy};
use perilife_growth::hand_calculation::HandCalculation;
use perilife_growth::predict::chain::{Chain, Stage};
use perilife_growth::predict::record::{BLOCKS_WITHOUT_GROWTH, Guard, Record};
use perilife_growth::predict::{Prediction, Silent, predict};
use perilife_growth::record::{CurvePoint, StopReason, TipRecord};
use perilife_laws::growth_law::GrowthLaw;
use perilife_laws::response::Response;
use perilife_plate::loading::spectrum::{Cycle, Spectrum};
use perilife_plate::loading::{LOWER_LOADS_MOST, Loading};
use perilife_points::crack_tip::TipState;

use crate::support::hand_cases::{PANEL, hand_case};
use crate::support::made_up_run::tip;

// Rows of a run: mechanics that fail in mid-run keep those so far, and none tells a K that was not read for it.

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

// Runs that would count nonsense, or never end.

fn now(cycles: f64, crack_length: f64, tips: &[TipRecord]) -> CurvePoint {
    CurvePoint::bare(cycles, crack_length, tips.to_vec())
}

#[test]
fn what_is_no_number_ends_a_run_in_an_error() {
    let tips = [tip([1e-3, 0.0], 1e-3)];
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
        let growth = -1e-3 + 1e-9 * i as f64;
        let tips = [tip([growth, 0.0], growth), tip([0.0; 2], 0.0)];
        assert_eq!(guard.check(0.0, &now(0.0, 0.01, &tips)).unwrap(), None, "block {i} grew");
    }
    let still = [tip([-2e-3, 0.0], -2e-3), tip([0.0; 2], 0.0)];
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

// How K of a tip follows the load of its cycles, and at which loads it is asked for.

fn read(factors: [f64; 2], is_closed: bool) -> Reading {
    Reading {
        factors,
        t_stress: 0.0,
        ahead: [1.0, 0.0],
        spacing: 1e-3,
        length_offset: 0.0,
        is_closed,
        of_pressure: 0.0,
        response: Response::PROPORTIONAL,
    }
}

fn at(load: f64, k_i: f64, free: Option<f64>) -> AtLoad {
    AtLoad { load, factors: [k_i, 0.0], t_stress: load, is_closed: k_i == 0.0, free: free.map(|k| [k, 0.0]) }
}

#[test]
fn lines_between_loads_and_ratios() {
    let plain = Response::PROPORTIONAL;
    let found = (plain.at(0.3), plain.ratio(-0.5), plain.range_share(-0.5), plain.cycle([0.2, 0.9]));
    assert_eq!(found, (0.3, -0.5, 1.0, [0.9, 0.2]));
    // K_res is a fifth of K_max: K = 0.2 + 0.8 f.
    let residual = Response::of_residual(0.2);
    for (found, right) in
        [(residual.at(0.5), 0.6), (residual.at(-0.25), 0.0), (residual.ratio(0.5), 0.6), (residual.at(1.5), 1.4)]
    {
        assert!((found - right).abs() < 1e-12, "{found} for {right}");
    }
    let bent = Response::new(&[[0.0, 0.3], [0.5, 0.4], [1.0, 1.0]]);
    assert!((bent.at(0.25) - 0.35).abs() < 1e-12 && (bent.between(&plain, 0.5).at(0.5) - 0.45).abs() < 1e-12, "{bent:?}");
    assert!(bent.is_near(&bent) && !bent.is_near(&plain) && (bent.coarser().at(0.5) - 0.65).abs() < 1e-12);
    // What is not known is a proportion.
    assert!(Response::new(&[[0.0, f64::NAN], [1.0, 1.0]]).is_proportional() && Response::new(&[[1.0, 1.0]]).is_proportional());
}

/// A tip that superposition closes at no load, and that a quarter of it opens: from 1/6 on along the branch of the open tip.
#[test]
fn a_tip_opens_where_its_branch_begins() {
    let reading = read([10.0, 0.0], false);
    let lower = [at(0.0, 0.0, Some(-5.0)), at(0.25, 1.0, None), at(0.5, 4.0, None)];
    let found = reading.beside(at(1.0, 10.0, None), &lower, false).response;
    for (load, right) in [(0.0, -0.5), (1.0 / 6.0, 0.0), (0.2, 0.04), (0.25, 0.1), (0.75, 0.7), (1.0, 1.0)] {
        assert!((found.at(load) - right).abs() < 1e-12, "{} at {load}", found.at(load));
    }
}

/// Without residual stress K is 0 at no load; a tip that only the least load opens has its K, and the ratio of the load turned round.
#[test]
fn a_lower_load_may_drive_a_tip_most() {
    let shut = read([0.0, 0.0], true);
    let found = shut.beside(at(1.0, 0.0, None), &[at(-0.5, 8.0, None)], true);
    assert!(found.factors == [8.0, 0.0] && found.t_stress == -0.5 && !found.is_closed);
    let Reading { response, .. } = found;
    for (load, right) in [(-0.5, 1.0), (-0.25, 0.5), (0.0, 0.0), (1.0, -2.0)] {
        assert!((response.at(load) - right).abs() < 1e-12, "{} at {load}", response.at(load));
    }
    assert!((response.ratio(-0.5) + 2.0).abs() < 1e-12 && response.range_share(-0.5) == 1.0);
    // Of a spectrum whose largest cycle does not open it, the ratio is that of the least load.
    assert!((response.ratio(0.2) + 2.0).abs() < 1e-12, "{}", response.ratio(0.2));
}

#[test]
fn loads_are_the_ends_of_cycles_or_parts_of_their_weight() {
    let loading = |cycles: Vec<Cycle>| {
        let spectrum = Spectrum::of(cycles, [0.0, 1.0]).unwrap();
        Loading { spectrum: Some(std::sync::Arc::new(spectrum)), ..hand_case(PANEL, &[]).loading.clone() }
    };
    let cycle = |max: f64, min: f64, count: f64| Cycle { max, min, count };
    let few = loading(vec![cycle(1.0, 0.0, 1.0), cycle(0.2, 0.05, 1e6)]).lower_loads();
    assert_eq!(few, (vec![0.0, 0.05, 0.2], true));
    // The small cycles have nearly all of the weight: the least load of all, and their ends.
    let mut many: Vec<Cycle> = (1..=20).map(|k| cycle(0.5 + 0.02 * f64::from(k), 0.4, 1.0)).collect();
    many.extend([cycle(1.0, -0.3, 1.0), cycle(0.35, 0.05, 1e9)]);
    let (loads, are_all) = loading(many).lower_loads();
    assert!(!are_all && loads.len() <= LOWER_LOADS_MOST && loads.is_sorted(), "{loads:?}");
    assert_eq!(loads, [-0.3, 0.05, 0.35]);
}

// K of a run against an independent one.

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
