//! The committed boundaries are those of this program: a fresh quick run finds them again.

use perilife_base::limits;
use perilife_study::stability::{Effort, run, sweeps};

/// Sweeps that take seconds, of several methods each: of which ends, all of them together at least.
const QUICK: ([&str; 1], usize) = (["crack_length"], 1);
const LONG: ([&str; 4], usize) = (["ligament", "density_factor", "influence_radius", "time_step"], 3);
/// The quick run narrows an end to 20 %, from between fewer values.
const APART: f64 = 0.25;

fn check<const N: usize>((names, ends_least): ([&str; N], usize)) {
    let chosen = sweeps(&names.map(str::to_owned)).unwrap();
    let records = run(&chosen, Effort::QUICK, &|_| ());
    let mut ends = 0;
    for record in &records {
        let limit = limits::of(&record.sweep.name, record.method).expect("a row of every method");
        let name = format!("{} by {}", record.sweep.name, record.method);
        println!("{name}: {:?}, committed {:?}", record.ends, limit.ends);
        assert_eq!(record.is_safe, limit.is_safe, "{name}");
        for (fresh, committed) in record.ends.into_iter().zip(limit.ends) {
            assert_eq!(fresh.is_some(), committed.is_some(), "{name}: {fresh:?} and {committed:?}");
            if let (Some(fresh), Some(committed)) = (fresh, committed) {
                assert!((fresh / committed - 1.0).abs() < APART, "{name}: {fresh} and {committed}");
                ends += 1;
            }
        }
    }
    assert!(ends >= ends_least, "{ends}");
}

#[test]
fn a_fresh_run_finds_the_committed_boundaries() {
    check(QUICK);
}

#[test]
#[ignore = "long: a minute"]
fn a_fresh_run_finds_more_committed_boundaries() {
    check(LONG);
}
