//! Cycles that are alike as one: what a mean of rates over a pass needs of the spectrum.

use std::collections::HashMap;

use super::Cycle;

/// Kinds of cycles up to which each is a class of its own.
const EXACT: usize = 1024;
/// Width of a class in ln K_max and in ln ΔK. Within a class of width w the mean of a power m of K, taken as the power of the mean of order
/// [`ORDER`], is off by m (m - ORDER) w²/24: 5e-5 at m = 5 and 2e-5 at 2, if every cycle were in the widest spread.
const WIDTH: f64 = 0.0125;
/// Order of the mean that a class keeps of the maxima and the ranges in it.
const ORDER: f64 = 3.5;

/// Cycles of one maximum and one minimum, both over the largest load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Class {
    pub max: f64,
    pub min: f64,
    /// How many of the cycles of a pass, over all of them.
    pub share: f64,
}

/// Kinds of cycles: pairs of maximum and minimum that differ, with how often there is each, by rising size; those that open no crack among
/// them.
pub(super) fn kinds(cycles: &[Cycle]) -> Vec<Cycle> {
    let mut sorted = cycles.to_vec();
    sorted.sort_unstable_by(|a, b| a.max.total_cmp(&b.max).then(a.min.total_cmp(&b.min)).then(a.count.total_cmp(&b.count)));
    sorted.dedup_by(|next, kept| {
        let is_same = next.max == kept.max && next.min == kept.min;
        kept.count += if is_same { next.count } else { 0.0 };
        is_same
    });
    sorted
}

/// Classes of the kinds, few enough for sums over them: every kind by itself up to a thousand, else those
/// within 1.25 % in maximum and in range together, which keeps means of powers 2 to 5 of both within 1e-4; `per_pass` are all cycles.
pub(super) fn classes(kinds: &[Cycle], per_pass: f64) -> Vec<Class> {
    let class = |max: f64, min: f64, count: f64| Class { max, min, share: count / per_pass };
    if kinds.len() <= EXACT {
        return kinds.iter().map(|kind| class(kind.max, kind.min, kind.count)).collect();
    }
    let mut bins: HashMap<(bool, [i32; 2]), [f64; 3]> = HashMap::new();
    let bin = |value: f64| (value.ln() / WIDTH).floor() as i32;
    for kind in kinds {
        // The whole range, also below zero: laws differ in what compression counts.
        let sums = bins.entry((kind.max > 0.0, [bin(kind.max.abs()), bin(kind.range())])).or_default();
        let terms = [1.0, kind.max.abs().powf(ORDER), kind.range().powf(ORDER)];
        sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += kind.count * term);
    }
    let mut classes: Vec<Class> = bins
        .into_iter()
        .map(|((opens, _), [count, max, range])| {
            let [max, range] = [max, range].map(|sum| (sum / count).powf(1.0 / ORDER));
            let max = if opens { max } else { -max };
            class(max, max - range, count)
        })
        .collect();
    // Sums over them are the same in every run.
    classes.sort_by(|a, b| a.max.total_cmp(&b.max).then(a.min.total_cmp(&b.min)));
    classes
}
