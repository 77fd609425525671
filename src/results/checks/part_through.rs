//! Checks of K of a part-through crack.

use super::{CAUTION_PERCENT, Check, Side};
use perilife_growth::case::Case;
use perilife_growth::predict::Prediction;
use perilife_growth::predict::part_through::PartThroughLife;
use perilife_plate::specimen::part_through::STATED_ERROR;

/// Effect of the stated error of K on the life, and the share of life outside its range; none of a through crack or an empty life.
pub(super) fn checks(case: &Case, prediction: &Prediction) -> Vec<Check> {
    let life = prediction.life_cycles();
    match PartThroughLife::of(case, &prediction.curve).filter(|_| life > 0.0) {
        Some(found) => vec![of_error(&found), of_range(&found, life)],
        None => Vec::new(),
    }
}

fn of_error(found: &PartThroughLife) -> Check {
    let [shorter, longer] = found.life_factors.map(|factor| 100.0 * (factor - 1.0));
    let larger = if longer.is_finite() { format!("{longer:+.0} %") } else { "unlimited".to_owned() };
    let words = format!("Newman-Raju K: ±{:.0} % (source), {shorter:+.0} % to {larger} in life", 100.0 * STATED_ERROR);
    let percent = if longer.is_finite() { longer.max(-shorter) } else { 100.0 };
    let remedy = "apply a factor to the life, or compare with a test";
    Check::sized("part_through_factors", percent, percent > CAUTION_PERCENT, Side::Either, words, remedy)
}

fn of_range(found: &PartThroughLife, life: f64) -> Check {
    let percent = 100.0 * found.cycles_outside / life;
    let names: Vec<String> = found.outside.iter().map(|(limit, _)| limit.in_words()).collect();
    let words = match names.len() {
        0 => "Newman-Raju K: within range".to_owned(),
        _ => format!("Newman-Raju K: {percent:.1} % of life outside {}", names.join(", ")),
    };
    let remedy = "the source states no error there: stop earlier (stop.crack_depth_mm)";
    Check::sized("part_through_range", percent, percent > CAUTION_PERCENT, Side::Either, words, remedy)
}
