//! A method across the values of a sweep, and the ends of its safe range.

use std::time::Instant;

use super::budget::within;
use super::{Effort, Method, Outcome, Record, Status, Sweep};

/// Bisections of an end at the most: enough for 2 % of a range of one decade.
const BISECTIONS_MAX: usize = 8;

/// Runs a method at every value and narrows the ends of its safe range.
pub(super) fn walk(sweep: &'static Sweep, method: &'static Method, effort: Effort) -> Record {
    let begun = Instant::now();
    let measure = |value: f64| (value, within(effort.budget, |run| (method.measure)(value, run)));
    let mut points: Vec<(f64, Outcome)> = chosen(sweep, effort.stride).into_iter().map(measure).collect();
    let is_stable = |point: &(f64, Outcome)| point.1.status(sweep.bound_percent) == Status::Stable;
    let at_usual = points.iter().position(|point| point.0 == sweep.usual);
    let is_safe = at_usual.map(|at| &points[at]).filter(|point| !matches!(point.1, Outcome::Unfinished(_))).map(is_stable);
    let usual = at_usual.filter(|_| is_safe == Some(true));
    let mut ends = [None, None];
    if let Some(usual) = usual {
        let below = points[..usual].iter().rposition(|point| !is_stable(point));
        let above = points[usual..].iter().position(|point| !is_stable(point)).map(|more| usual + more);
        let is_judged = |at: &usize| !matches!(points[*at].1, Outcome::Unfinished(_));
        let (below, above) = (below.filter(is_judged), above.filter(is_judged));
        let pairs = [below.map(|at| (points[at + 1].0, points[at].0)), above.map(|at| (points[at - 1].0, points[at].0))];
        for (end, pair) in ends.iter_mut().zip(pairs) {
            let Some((mut inside, mut beyond)) = pair else { continue };
            for _ in 0..BISECTIONS_MAX {
                if !sweep.is_continuous || (beyond - inside).abs() <= effort.resolution * beyond.abs().max(inside.abs()) {
                    break;
                }
                let point = measure(between(inside, beyond));
                let is_judged = !matches!(point.1, Outcome::Unfinished(_));
                if is_stable(&point) {
                    inside = point.0;
                } else {
                    beyond = point.0;
                }
                points.push(point);
                if !is_judged {
                    break;
                }
            }
            *end = Some(inside);
        }
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    Record { sweep, method: method.name, points, ends, is_safe, wall_s: begun.elapsed().as_secs_f64() }
}

/// Every so many-th value, the first, the last and the usual one among them.
fn chosen(sweep: &Sweep, stride: usize) -> Vec<f64> {
    let last = sweep.values.len() - 1;
    let is_chosen = |(at, value): &(usize, &f64)| at % stride == 0 || *at == last || **value == sweep.usual;
    sweep.values.iter().enumerate().filter(is_chosen).map(|(_, value)| *value).collect()
}

/// The middle, of ratios where both are above zero.
fn between(a: f64, b: f64) -> f64 {
    if a > 0.0 && b > 0.0 { (a * b).sqrt() } else { 0.5 * (a + b) }
}
