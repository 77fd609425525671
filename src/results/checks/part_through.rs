//! Whether K of a crack that does not go through is known well enough.

use super::{Check, DOUBTFUL_PERCENT, Side};
use perilife_growth::case::Case;
use perilife_growth::predict::Prediction;
use perilife_growth::predict::part_through::PartThroughLife;
use perilife_plate::specimen::part_through::STATED_ERROR;

/// What the stated error of K does to the life, and how much of the life lies where none is stated; nothing of a crack that goes through from the
/// start, or of a life of no cycles.
pub(super) fn checks(case: &Case, prediction: &Prediction) -> Vec<Check> {
    let life = prediction.life_cycles();
    match PartThroughLife::of(case, &prediction.curve).filter(|_| life > 0.0) {
        Some(found) => vec![of_error(&found), of_range(&found, life)],
        None => Vec::new(),
    }
}

fn of_error(found: &PartThroughLife) -> Check {
    let [shorter, longer] = found.life_factors.map(|factor| 100.0 * (factor - 1.0));
    let larger = if longer.is_finite() { format!("{longer:+.0} %") } else { "no end".to_owned() };
    let words = format!("K in depth: ±{:.0} % by its source, {shorter:+.0} % to {larger} of life", 100.0 * STATED_ERROR);
    let percent = if longer.is_finite() { longer.max(-shorter) } else { 100.0 };
    let remedy = "divide the life by a factor, or compare with a test of such a crack";
    Check::sized("part_through_factors", percent, percent > DOUBTFUL_PERCENT, Side::Either, words, remedy)
}

fn of_range(found: &PartThroughLife, life: f64) -> Check {
    let percent = 100.0 * found.cycles_outside / life;
    let names: Vec<String> = found.outside.iter().map(|(limit, _)| limit.in_words()).collect();
    let words = match names.len() {
        0 => "K in depth: within the range of its formulas".to_owned(),
        _ => format!("K in depth: {percent:.1} % of life not at {}", names.join(", ")),
    };
    let remedy = "the error of K is not stated there: end the life sooner by stop.crack_depth_mm";
    Check::sized("part_through_range", percent, percent > DOUBTFUL_PERCENT, Side::Either, words, remedy)
}
