//! What all cases of a sweep should be known of, told once.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::sweep::Outcome;
use crate::sweep::draw::label;

/// Warnings that the figures list at most.
const WARNINGS_MAX: usize = 20;

/// Warnings by number of cases; those that differ in their numbers only are one, told by the first case that has it. Where they begin with a
/// share, as of a life outside the range of a formula, the largest stands beside it.
pub(super) fn warnings(outcomes: &[Option<Outcome>]) -> Vec<Value> {
    let mut found: BTreeMap<String, Vec<(usize, &str)>> = BTreeMap::new();
    for (i, outcome) in outcomes.iter().enumerate() {
        for warning in outcome.iter().flat_map(|outcome| &outcome.warnings) {
            let words = warning.chars().filter(|c| !c.is_ascii_digit()).collect();
            found.entry(words).or_default().push((i + 1, warning));
        }
    }
    let mut found: Vec<Vec<(usize, &str)>> = found.into_values().collect();
    found.sort_by_key(|all| (std::cmp::Reverse(all.len()), all[0].0));
    let told = |all: Vec<(usize, &str)>| {
        let (first, text) = all[0];
        let shares = all.iter().filter_map(|(case, text)| Some((text.split_once(" % ")?.0.parse::<f64>().ok()?, *case)));
        let largest = shares.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        json!({
            "cases": all.len(),
            "first": label(first),
            "warning": text,
            "largest_percent": largest.map(|(share, _)| share),
            "largest_in": largest.map(|(_, case)| label(case)),
        })
    };
    found.into_iter().take(WARNINGS_MAX).map(told).collect()
}
