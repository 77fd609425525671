//! What stands behind a life: every condition that it rests on, whether that holds, what it may do to the life, and what to do about it.

mod part_through;

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::format::{PLAIN, short};
use perilife_base::error::{Error, Result};
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_growth::case::record::FittedRecord;
use perilife_growth::case::{Case, LawSource};
use perilife_growth::predict::fit_use;
use perilife_growth::predict::judgement::{self, first_delta_k};
use perilife_growth::predict::plastic_zone::plastic_zone;
use perilife_growth::predict::{CurvePoint, Prediction, StopReason};
use perilife_plate::material::growth_data::BATCH_FACTOR;
use perilife_plate::specimen::SpecimenKind;

/// Lines that are printed below a verdict at the most.
const LINES_MOST: usize = 5;
/// Letters of a line at the most, so that it is one of 80 with what stands before it.
const LETTERS_MOST: usize = 71;
/// Effect on life, percent, from which a condition is doubtful; none has an effect that is known better.
const DOUBTFUL_PERCENT: f64 = 1.0;
/// Share of life outside the fitted ΔK range from which the law is doubtful.
const OUTSIDE_DOUBTFUL: f64 = 0.05;
/// Thickness of the plate over that of the specimens, or the other way, up to which both have the same constraint at the tip.
const THICKNESS_ALIKE: f64 = 1.25;
/// Factor of the life by retardation from which it is doubtful.
const RETARDED_DOUBTFUL: f64 = 1.5;
/// Exponent where the law has none: what an error of K does to the rate.
const EXPONENT_USUAL: f64 = 3.0;

/// Whether a condition holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// It does not, and the life is none.
    Fails,
    /// It does not hold all along; the effect says what that may do.
    Doubtful,
    /// It cannot be told.
    NotChecked,
    Holds,
}

/// On which side of the true life a life is where a condition does not hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Too short.
    Safe,
    /// Too long.
    Unsafe,
    Either,
}

/// One condition.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Check {
    pub name: Cow<'static, str>,
    pub verdict: Verdict,
    /// What it may do to the life, or the share of the life that it concerns, percent; `None` where nobody knows.
    pub effect_percent: Option<f64>,
    /// On which side of the true life the life is by that.
    pub side: Option<Side>,
    pub words: String,
    pub remedy: Option<String>,
}

impl Check {
    fn new(name: &'static str, verdict: Verdict, words: String) -> Self {
        Check { name: name.into(), verdict, effect_percent: None, side: None, words, remedy: None }
    }

    fn not_checked(name: &'static str, words: &str, remedy: &str) -> Self {
        Check {
            side: Some(Side::Unsafe),
            remedy: Some(remedy.to_owned()),
            ..Check::new(name, Verdict::NotChecked, words.to_owned())
        }
    }

    /// A condition that holds but for an effect, percent, on one side.
    fn sized(name: &'static str, percent: f64, doubtful: bool, side: Side, words: String, remedy: &str) -> Self {
        let verdict = if doubtful { Verdict::Doubtful } else { Verdict::Holds };
        let remedy = doubtful.then(|| remedy.to_owned());
        Check { effect_percent: Some(percent), side: Some(side), remedy, ..Check::new(name, verdict, words) }
    }
}

/// What can be told of a case before it is run.
pub fn of_case(case: &Case) -> Vec<Check> {
    let strengths = ["toughness", "ligament"].map(|name| strength(case, name));
    sorted(strengths.into_iter().chain(first_extrapolation(case)).collect(), case, None)
}

/// All conditions of a life, those that matter most first: what fails, what is doubtful by its effect, what was not checked, what holds.
pub fn of_run(case: &Case, prediction: &Prediction) -> Vec<Check> {
    let mut checks = vec![toughness(case, prediction), ligament(case, prediction)];
    checks.extend(small_scale_yielding(case, prediction));
    checks.extend(extrapolation(case, prediction));
    checks.extend(cross_check(case, prediction));
    checks.extend(part_through::checks(case, prediction));
    checks.extend(retardation(case, prediction));
    sorted(checks, case, Some(prediction))
}

/// Growth data of the library are those of one batch.
fn growth_data(case: &Case) -> Option<Check> {
    case.growth_data.as_ref()?;
    let percent = 100.0 * (1.0 - 1.0 / BATCH_FACTOR);
    let words = format!("growth data of the library: a batch may differ by a factor of {BATCH_FACTOR} in rate");
    Some(Check::sized("growth_data", percent, true, Side::Either, words, "calibrate the law to tests of this batch"))
}

/// With what the law says of the plate, those that matter most first.
fn sorted(mut checks: Vec<Check>, case: &Case, prediction: Option<&Prediction>) -> Vec<Check> {
    let of_law = [stress_ratio(case, prediction), thickness(case), size(case), lack_of_fit(case), growth_data(case)];
    checks.extend(of_law.into_iter().flatten());
    let effect = |check: &Check| check.effect_percent.unwrap_or(0.0).abs();
    checks.sort_by(|a, b| (a.verdict as usize).cmp(&(b.verdict as usize)).then(effect(b).total_cmp(&effect(a))));
    checks
}

/// Whether life may be said to be reached at the least: what would end it sooner was checked and holds.
pub fn is_bound_below(case: &Case, prediction: &Prediction) -> bool {
    let holds = |check: &Check| check.verdict == Verdict::Holds;
    let is_checked = || {
        let yielding = small_scale_yielding(case, prediction);
        holds(&toughness(case, prediction)) && holds(&ligament(case, prediction)) && yielding.iter().all(holds)
    };
    // A run that was cut off has lived so long already.
    prediction.stop == StopReason::RunOut || prediction.stop.is_lower_bound() && is_checked()
}

/// What a run was judged to be, once: how its life stands, what the user should know, whether it counts.
#[derive(Debug, Default)]
pub struct Judgement {
    /// Those that matter most first.
    pub checks: Vec<Check>,
    /// Whether the life is reached at the least.
    pub is_lower_bound: bool,
    /// What is to be said of it beyond what the run itself says.
    pub warnings: Vec<String>,
    /// Why it does not count.
    pub refusal: Option<Error>,
}

impl Judgement {
    /// Of a run.
    /// Errors: as [`judgement::judge`].
    pub fn of(case: &Case, prediction: &Prediction) -> Result<Self> {
        let warnings = judgement::judge(case, prediction)?;
        let (checks, is_lower_bound) = (of_run(case, prediction), is_bound_below(case, prediction));
        Ok(Judgement { checks, is_lower_bound, warnings, refusal: judgement::refusal(case, prediction) })
    }

    /// One line that says how the life stands.
    pub fn verdict(&self) -> String {
        verdict(&self.checks)
    }
}

/// One line that says how a life stands.
pub fn verdict(checks: &[Check]) -> String {
    let count = |verdict: Verdict| checks.iter().filter(|check| check.verdict == verdict).count();
    let some =
        [(count(Verdict::Fails), "failed"), (count(Verdict::Doubtful), "doubtful"), (count(Verdict::NotChecked), "not checked")];
    let open: Vec<String> = some.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")).collect();
    match (some[0].0, open.len()) {
        (0, 0) => format!("stands: all {} checks hold", checks.len()),
        (0, _) => format!("stands on conditions: of {} checks {}", checks.len(), open.join(", ")),
        _ => format!("not to be used: of {} checks {}", checks.len(), open.join(", ")),
    }
}

/// The lines below it: conditions that do not hold, at most five.
pub fn lines(checks: &[Check]) -> Vec<String> {
    let open = checks.iter().filter(|check| check.verdict != Verdict::Holds);
    // Cut between words.
    let cut = |words: &str, end: usize| format!("{}…", &words[..words[..end].rfind(' ').unwrap_or(end)]);
    let line = |words: &str| words.char_indices().nth(LETTERS_MOST).map_or_else(|| words.to_owned(), |(end, _)| cut(words, end));
    open.take(LINES_MOST).map(|check| line(&check.words)).collect()
}

fn strength(case: &Case, name: &'static str) -> Check {
    let of_k = name == "toughness";
    let (is_given, is_asked, [what, missing, key, off]) = if of_k {
        let words = ["fracture", "toughness", "material.toughness_mpa_sqrt_m", "toughness"];
        (case.material.toughness.is_some(), case.stop.by_toughness, words)
    } else {
        let words = ["yielding", "yield strength", "material.yield_strength_mpa", "net_section"];
        (case.material.yield_strength.is_some(), case.stop.by_net_section, words)
    };
    let not_checked = |why: String, remedy: &str| Check::not_checked(name, &format!("{what}: not checked, {why}"), remedy);
    match (is_given, is_asked) {
        (false, _) => not_checked(format!("no {missing} given"), &format!("give {key}")),
        (true, false) => not_checked(format!("turned off by stop.{off}"), "leave the key out"),
        (true, true) => Check::new(name, Verdict::Holds, format!("{name}: the life ends where it is reached")),
    }
}

fn toughness(case: &Case, prediction: &Prediction) -> Check {
    let given = strength(case, "toughness");
    let most = prediction.curve.iter().map(|row| row.k_max(&case.loading)).filter(|k| k.is_finite()).fold(f64::NAN, f64::max);
    match case.toughness_at_end() {
        Some(_) if most.is_nan() => Check::not_checked("toughness", "fracture: not checked, K of the tips is not known", ""),
        Some(toughness) => {
            let words = format!("fracture: K_max is {:.1} % of the toughness at the most", 100.0 * most / toughness);
            let required = case.stop.required.unwrap_or(1.0);
            Check { words, verdict: of_first_load(prediction, required * most / toughness), ..given }
        }
        None => Check {
            words: given.words.clone()
                + &if most.is_nan() { String::new() } else { format!("; K_max to {:.0} MPa√m", most / MPA_SQRT_M) },
            ..given
        },
    }
}

fn ligament(case: &Case, prediction: &Prediction) -> Check {
    const NAME: &str = "ligament";
    let given = strength(case, NAME);
    if case.yield_strength_at_end().is_none() {
        return given;
    }
    let load = |row: &CurvePoint| Some(case.loading.doing(row.work, row.crack_length) / row.limit_load?);
    let most = prediction.curve.iter().filter_map(load).filter(|used| used.is_finite()).fold(f64::NAN, f64::max);
    if most.is_nan() {
        let words = "yielding: not checked, supports on both sides of every section";
        return Check::not_checked(NAME, words, "give the loads of both ends instead of a support");
    }
    let required = case.stop.required.unwrap_or(1.0);
    let words = format!("section: the load is {:.1} % of its limit load at the most", 100.0 * most);
    Check { words, verdict: of_first_load(prediction, required * most), ..given }
}

/// A strength holds while a plate lives; one that the first load exceeds leaves no life.
fn of_first_load(prediction: &Prediction, used: f64) -> Verdict {
    if prediction.stop.is_strength() && prediction.curve.len() == 1 && used >= 1.0 { Verdict::Fails } else { Verdict::Holds }
}

fn small_scale_yielding(case: &Case, prediction: &Prediction) -> Option<Check> {
    const NAME: &str = "small_scale_yielding";
    let zone = plastic_zone(case, &prediction.curve)?;
    let percent = 100.0 * zone.life_share_too_large;
    let never = zone.too_large_to.is_none() && zone.too_large_from == Some(zone.first.crack_length);
    let words = match zone.too_large_from {
        None => "small-scale yielding: holds to the end".to_owned(),
        Some(from) if never => format!("small-scale yielding: not from N = 0, {}, on", two_digits(from)),
        Some(from) => {
            let until = zone.too_large_to.map_or_else(|| "on".to_owned(), |to| format!("to {}", two_digits(to)));
            format!("small-scale yielding: not from {} {until}, {percent:.1} % of life", two_digits(from))
        }
    };
    let remedy = match zone.too_small {
        _ if never => "reduce the load: K does not describe this crack",
        "ligament" => "end the life there by stop.crack_length_mm (of all cracks): beyond it cracks grow faster than K says",
        _ => "begin with a longer crack: shorter ones grow faster than K says",
    };
    let check = Check::sized(NAME, percent, never || percent > DOUBTFUL_PERCENT, Side::Unsafe, words, remedy);
    Some(if never { Check { verdict: Verdict::Fails, ..check } } else { check })
}

/// A length as the criterion deserves: two digits, and the third of a length of more than ten.
fn two_digits(length: f64) -> String {
    PLAIN.length(length, usize::from(length < 10.0 * MM))
}

/// Life outside the fitted range, below and above.
fn extrapolation(case: &Case, prediction: &Prediction) -> Vec<Check> {
    let (Some([low, high]), Some(shares)) = (fit_use::fitted_range(case), fit_use::life_shares_outside(case, prediction)) else {
        return fit_use::fitted_range(case).is_none().then(unknown_range).into_iter().collect();
    };
    let of_side = |name, share: f64, side, words: String| {
        let is_refused = side == Side::Unsafe && share > fit_use::EXTRAPOLATION_REFUSED && !case.allow_extrapolation;
        let remedy = match side {
            Side::Unsafe => "calibrate on longer cracks, or end the life sooner by stop.crack_length_mm",
            _ => "calibrate on slower growth, or give fatigue.delta_k_threshold_mpa_sqrt_m",
        };
        let check = Check::sized(name, 100.0 * share, share > OUTSIDE_DOUBTFUL, side, words, remedy);
        if is_refused { Check { verdict: Verdict::Fails, ..check } } else { check }
    };
    let [below, above] = shares;
    vec![
        of_side(
            "extrapolation_below",
            below,
            Side::Safe,
            format!("law: {:.1} % of life below ΔK {low:.2}, the lowest fitted (safe side)", 100.0 * below),
        ),
        of_side(
            "extrapolation_above",
            above,
            Side::Unsafe,
            format!("law: {:.1} % of life above ΔK {high:.2}, the highest fitted (unsafe side)", 100.0 * above),
        ),
    ]
}

fn unknown_range() -> Check {
    Check::not_checked(
        "extrapolation_above",
        "law: its range of ΔK is not known, constants given by hand",
        "calibrate on measured curves, or compare with the range of the source of the constants",
    )
}

/// What the handbook says of the first ΔK, under a spectrum of the cycles by which the crack grows there.
fn first_extrapolation(case: &Case) -> Option<Check> {
    let Some([low, high]) = fit_use::fitted_range(case) else { return Some(unknown_range()) };
    let first = first_delta_k(case)?;
    let [below, above] = fit_use::growth_shares_outside(case, first)?;
    let at = |share: f64| match case.loading.spectrum {
        Some(_) => format!("{:.0} % of growth at the start", 100.0 * share),
        None => format!("ΔK {:.2} at the start", first / MPA_SQRT_M),
    };
    if above > OUTSIDE_DOUBTFUL {
        let words = format!("law: {} is above the highest fitted ΔK, {high:.2}", at(above));
        let remedy = "lower the load, or calibrate on longer cracks";
        let check = Check::sized("extrapolation_above", 100.0 * above, true, Side::Unsafe, words, remedy);
        let is_refused = above > fit_use::EXTRAPOLATION_REFUSED && !case.allow_extrapolation;
        return Some(if is_refused { Check { verdict: Verdict::Fails, ..check } } else { check });
    }
    (below > OUTSIDE_DOUBTFUL).then(|| {
        let words = format!("law: {} is below the lowest fitted ΔK, {low:.2} MPa√m (safe)", at(below));
        Check { side: Some(Side::Safe), ..Check::new("extrapolation_below", Verdict::Doubtful, words) }
    })
}

fn cross_check(case: &Case, prediction: &Prediction) -> Option<Check> {
    let check = prediction.cross_check?;
    let exponent = match &case.law {
        LawSource::Fitted(record) => record.paris_m,
        LawSource::Paris(law) => law.m,
        LawSource::Inline(law) => law.p,
        LawSource::Factor(_) | LawSource::Missing(_) => EXPONENT_USUAL,
    };
    let percent = 100.0 * exponent * check.difference;
    let words = format!(
        "K: {:+.1} % from the energy of the plate at {}, {:+.0} % of da/dN there",
        100.0 * check.difference,
        two_digits(check.crack_length),
        percent
    );
    // A K that is too large makes lives too short.
    let side = if check.difference > 0.0 { Side::Safe } else { Side::Unsafe };
    let remedy = "give a smaller model.spacing_mm";
    Some(Check::sized("cross_check", percent.abs(), check.warning().is_some(), side, words, remedy))
}

/// Life over that without retardation, whose constants come from the case alone.
fn retardation(case: &Case, prediction: &Prediction) -> Option<Check> {
    const NAME: &str = "retardation";
    const REMEDY: &str = "fit its constant to a test under a spectrum, or compare with loading.retardation = \"none\"";
    let (model, is_cut_off) = (case.retardation.as_ref()?.kind, prediction.stop == StopReason::RunOut);
    let factor = prediction.life().unwrap_or(f64::INFINITY) / prediction.unretarded_cycles.unwrap_or(f64::NAN);
    // A run that is cut off may have come as far as the other, which then says nothing.
    if factor.is_nan() || is_cut_off && factor <= 1.0 {
        let words = format!("retardation: effect of {model} not known; given, not calibrated");
        return Some(Check::not_checked(NAME, &words, REMEDY));
    }
    let least = if is_cut_off { "≥ " } else { "" };
    let times = if factor.is_finite() { format!("{least}{factor:.2}× that") } else { "unlimited, not".to_owned() };
    let words = format!("retardation: life {times} without ({model}: given, not calibrated)");
    let side = if factor > 1.0 { Side::Unsafe } else { Side::Safe };
    let is_large = !(1.0 / RETARDED_DOUBTFUL..=RETARDED_DOUBTFUL).contains(&factor);
    Some(Check::sized(NAME, 100.0 * (1.0 - 1.0 / factor), is_large, side, words, REMEDY))
}

/// Stress ratios of the law against those of the cycles that grow the crack.
fn stress_ratio(case: &Case, prediction: Option<&Prediction>) -> Option<Check> {
    const NAME: &str = "stress_ratio";
    let [low, high] = fit_use::fitted_ratios(case)?;
    let share = fit_use::share_of_other_ratios(case, prediction)?;
    let from_to = |[low, high]: [f64; 2]| if low == high { short(low) } else { format!("{} to {}", short(low), short(high)) };
    let (ratio, of_law) = (from_to(case.loading.ratios()), from_to([low, high]));
    let by = match &case.law {
        LawSource::Fitted(_) => format!("Walker's γ = {}", short(case.fatigue.walker_gamma)),
        _ => "the law".to_owned(),
    };
    let is_within = share <= OUTSIDE_DOUBTFUL;
    let words = match is_within {
        true if share == 0.0 => format!("stress ratio: {ratio} is that of the law"),
        true => format!("stress ratio: {:.1} % of growth is outside R = {of_law} of the law", 100.0 * share),
        false if case.loading.spectrum.is_some() => {
            format!("stress ratio: {:.0} % of growth is outside R = {of_law}, by {by}", 100.0 * share)
        }
        false => format!("stress ratio: {ratio}, law of {of_law}, by {by}"),
    };
    let verdict = if is_within { Verdict::Holds } else { Verdict::Doubtful };
    let remedy = (!is_within).then(|| format!("calibrate at R = {ratio}"));
    Some(Check { side: Some(Side::Either), remedy, ..Check::new(NAME, verdict, words) })
}

fn fitted(case: &Case) -> Option<&FittedRecord> {
    match &case.law {
        LawSource::Fitted(record) => Some(record),
        _ => None,
    }
}

/// Thickness of the specimens of the law against that of the plate: thicker ones grow faster, by more constraint and less closure.
fn thickness(case: &Case) -> Option<Check> {
    const NAME: &str = "thickness";
    let (of_law, of_plate) = (fitted(case)?.thickness_mm, case.specimen.thickness / MM);
    let ratio = of_plate / of_law;
    let is_alike = (1.0 / THICKNESS_ALIKE..=THICKNESS_ALIKE).contains(&ratio);
    let words = format!("thickness: {of_plate:.2} mm, law of specimens of {of_law:.2} mm");
    let verdict = if is_alike { Verdict::Holds } else { Verdict::Doubtful };
    let side = if ratio > 1.0 { Side::Unsafe } else { Side::Safe };
    let remedy = (!is_alike).then(|| "calibrate on specimens of the thickness of the plate".to_owned());
    Some(Check { side: Some(side), remedy, ..Check::new(NAME, verdict, words) })
}

/// Sizes of a test specimen after ASTM E647, 7.1 and A1.3: C(T) W/20 ≤ B ≤ W/4 and a ≥ 0.2 W; M(T) B ≤ W/8.
fn size(case: &Case) -> Option<Check> {
    const NAME: &str = "e647_size";
    let specimen = &case.specimen;
    let (thickness, width, crack) = (specimen.thickness, specimen.width, specimen.crack_length);
    let wrong = match specimen.kind {
        SpecimenKind::CompactTension if thickness < width / 20.0 || thickness > width / 4.0 => {
            Some(format!("thickness {:.2} mm is not W/20 to W/4", thickness / MM))
        }
        SpecimenKind::CompactTension if crack < 0.2 * width => Some(format!("crack {:.2} mm is below 0.2 W", crack / MM)),
        SpecimenKind::MiddleTension if thickness > width / 8.0 => {
            Some(format!("thickness {:.2} mm is above W/8", thickness / MM))
        }
        SpecimenKind::CompactTension | SpecimenKind::MiddleTension => None,
        _ => return None,
    };
    let verdict = if wrong.is_some() { Verdict::Doubtful } else { Verdict::Holds };
    let words =
        wrong.map_or_else(|| "E647: sizes of the specimen are within its limits".to_owned(), |wrong| format!("E647: {wrong}"));
    Some(Check { side: Some(Side::Either), ..Check::new(NAME, verdict, words) })
}

/// What the law misses at the ends of its range.
fn lack_of_fit(case: &Case) -> Option<Check> {
    let percent = fitted(case)?.lack_of_fit_percent?;
    let sense = if percent > 0.0 { "faster" } else { "slower" };
    let words = format!("law: cracks grow {:.0} % {sense} than it at an end of its range", percent.abs());
    let side = if percent > 0.0 { Side::Unsafe } else { Side::Safe };
    let remedy = "calibrate with another fatigue.growth_law, or a table";
    Some(Check::sized("lack_of_fit", percent, percent.abs() > OUTSIDE_DOUBTFUL * 100.0, side, words, remedy))
}
