//! How K of a tip follows the load of its cycles, and at which loads it is asked for.

use perilife_growth::cracks::tip::{AtLoad, Reading};
use perilife_laws::response::Response;
use perilife_plate::loading::spectrum::{Cycle, Spectrum};
use perilife_plate::loading::{LOWER_LOADS_MOST, Loading};

use crate::support::hand_cases::{PANEL, hand_case};

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
    assert_eq!(
        (plain.at(0.3), plain.ratio(-0.5), plain.range_share(-0.5), plain.cycle([0.2, 0.9])),
        (0.3, -0.5, 1.0, [0.9, 0.2])
    );
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
