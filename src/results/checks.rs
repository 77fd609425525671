//! Checks of the validity of a life: what was found, its effect on the life, and a remedy; the verdict over all of them.

mod part_through;

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::format::{PLAIN, short};
use super::spectrum::retarded;
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

/// Effect on life, percent, above which a check is a caution; no effect is known more precisely.
const CAUTION_PERCENT: f64 = 1.0;
/// Share of life outside the tested ΔK above which the law is a caution.
const OUTSIDE_CAUTION: f64 = 0.05;
/// Thickness of the plate over that of the specimens, or the other way, up to which both have the same constraint at the tip.
const THICKNESS_ALIKE: f64 = 1.25;
/// Factor of the life by retardation above which it is a caution.
const RETARDED_CAUTION: f64 = 1.5;
/// Exponent where the law has none: what an error of K does to the rate.
const EXPONENT_USUAL: f64 = 3.0;

/// Result of one check.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The life is not valid.
    Failed,
    /// Valid for part of the life, or within the stated effect.
    Caution,
    /// The input does not suffice.
    NotChecked,
    Passed,
}

/// All checks together: may the life be used?
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Validity {
    Valid,
    Reservations,
    NotValid,
}

/// Direction of an effect on the computed life; of equal sizes the first matters most.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Too long.
    NonConservative,
    Either,
    /// Too short.
    Conservative,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Check {
    pub name: Cow<'static, str>,
    pub verdict: Verdict,
    /// Effect on the life, or the share of the life concerned, percent; `None` if unknown.
    pub effect_percent: Option<f64>,
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
            side: Some(Side::NonConservative),
            remedy: Some(remedy.to_owned()),
            ..Check::new(name, Verdict::NotChecked, words.to_owned())
        }
    }

    /// A check with an effect, percent.
    fn sized(name: &'static str, percent: f64, is_caution: bool, side: Side, words: String, remedy: &str) -> Self {
        let verdict = if is_caution { Verdict::Caution } else { Verdict::Passed };
        let remedy = is_caution.then(|| remedy.to_owned());
        Check { effect_percent: Some(percent), side: Some(side), remedy, ..Check::new(name, verdict, words) }
    }
}

/// Checks of a case before it is run.
pub fn of_case(case: &Case) -> Vec<Check> {
    let strengths = ["toughness", "ligament"].map(|name| strength(case, name));
    sorted(strengths.into_iter().chain(first_extrapolation(case)).collect(), case, None)
}

/// All checks of a life, by status and effect, the most severe first.
pub fn of_run(case: &Case, prediction: &Prediction) -> Vec<Check> {
    let mut checks = vec![toughness(case, prediction), ligament(case, prediction)];
    checks.extend(small_scale_yielding(case, prediction));
    checks.extend(extrapolation(case, prediction));
    checks.extend(cross_check(case, prediction));
    checks.extend(part_through::checks(case, prediction));
    checks.extend(retardation(case, prediction));
    sorted(checks, case, Some(prediction))
}

/// Growth data of the library are those of one lot.
fn growth_data(case: &Case) -> Option<Check> {
    case.growth_data.as_ref()?;
    let percent = 100.0 * (1.0 - 1.0 / BATCH_FACTOR);
    let words =
        format!("Growth data: library values; another lot may grow at {BATCH_FACTOR} times or 1/{BATCH_FACTOR} of the rate");
    Some(Check::sized("growth_data", percent, true, Side::Either, words, "fit the law to tests of this lot"))
}

/// With the checks of the law, the most severe first.
fn sorted(mut checks: Vec<Check>, case: &Case, prediction: Option<&Prediction>) -> Vec<Check> {
    let of_law = [stress_ratio(case, prediction), thickness(case), size(case), lack_of_fit(case), growth_data(case)];
    checks.extend(of_law.into_iter().flatten());
    let effect = |check: &Check| check.effect_percent.unwrap_or(0.0).abs();
    checks.sort_by(|a, b| {
        let by_size = (a.verdict as usize).cmp(&(b.verdict as usize)).then(effect(b).total_cmp(&effect(a)));
        by_size.then(a.side.cmp(&b.side))
    });
    checks
}

/// Whether the life is a lower bound: the checks of all that would end it sooner passed.
pub fn is_bound_below(case: &Case, prediction: &Prediction) -> bool {
    let passed = |check: &Check| check.verdict == Verdict::Passed;
    let is_checked = || {
        let yielding = small_scale_yielding(case, prediction);
        passed(&toughness(case, prediction)) && passed(&ligament(case, prediction)) && yielding.iter().all(passed)
    };
    prediction.stop == StopReason::RunOut || prediction.stop.is_lower_bound() && is_checked()
}

/// Checks, warnings and refusal of a run.
#[derive(Debug, Default)]
pub struct Judgement {
    /// The most severe first.
    pub checks: Vec<Check>,
    pub is_lower_bound: bool,
    /// Beside those of the run itself.
    pub warnings: Vec<String>,
    /// Why the life is not valid.
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
}

/// A message for the user: a check that did not pass, or a warning.
#[derive(Debug, Clone, PartialEq)]
pub struct Message {
    /// Name of the check; none of a warning.
    pub subject: Option<Cow<'static, str>>,
    /// `failed`, `caution`, `unchecked` or `warning`.
    pub kind: &'static str,
    pub text: String,
    pub remedy: Option<String>,
}

impl Message {
    fn of(check: &Check) -> Option<Self> {
        let kind = match check.verdict {
            Verdict::Failed => "failed",
            Verdict::Caution => "caution",
            Verdict::NotChecked => "unchecked",
            Verdict::Passed => return None,
        };
        Some(Message { subject: Some(check.name.clone()), kind, text: check.words.clone(), remedy: check.remedy.clone() })
    }

    pub fn warning(text: &str) -> Self {
        Message { subject: None, kind: "warning", text: text.to_owned(), remedy: None }
    }
}

/// Checks that did not pass, the most severe first, then warnings, and last what was not checked.
pub fn messages(checks: &[Check], warnings: &[String]) -> Vec<Message> {
    let (open, unchecked): (Vec<&Check>, Vec<&Check>) = checks.iter().partition(|check| check.verdict != Verdict::NotChecked);
    let warnings = warnings.iter().map(|line| Message::warning(line));
    open.into_iter().filter_map(Message::of).chain(warnings).chain(unchecked.into_iter().filter_map(Message::of)).collect()
}

/// The verdict over all checks.
pub fn validity(checks: &[Check]) -> Validity {
    match checks.iter().map(|check| check.verdict as usize).min() {
        Some(worst) if worst == Verdict::Failed as usize => Validity::NotValid,
        Some(worst) if worst < Verdict::Passed as usize => Validity::Reservations,
        _ => Validity::Valid,
    }
}

pub fn verdict(checks: &[Check]) -> String {
    let count = |verdict: Verdict| checks.iter().filter(|check| check.verdict == verdict).count();
    let cautions = count(Verdict::Caution);
    let some = [
        (count(Verdict::Failed), "failed"),
        (cautions, if cautions == 1 { "caution" } else { "cautions" }),
        (count(Verdict::NotChecked), "not checked"),
    ];
    let open: Vec<String> = some.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")).collect();
    match validity(checks) {
        Validity::Valid => format!("valid: all {} checks passed", checks.len()),
        Validity::Reservations => format!("valid with reservations: of {} checks {}", checks.len(), open.join(", ")),
        Validity::NotValid => format!("not valid: of {} checks {}", checks.len(), open.join(", ")),
    }
}

fn strength(case: &Case, name: &'static str) -> Check {
    let of_k = name == "toughness";
    let (is_given, is_asked, [what, missing, key, off]) = if of_k {
        let words = ["Fracture", "toughness", "material.toughness_mpa_sqrt_m", "toughness"];
        (case.material.toughness.is_some(), case.stop.by_toughness, words)
    } else {
        let words = ["Net-section yield", "yield strength", "material.yield_strength_mpa", "net_section"];
        (case.material.yield_strength.is_some(), case.stop.by_net_section, words)
    };
    let not_checked = |why: String, remedy: &str| Check::not_checked(name, &format!("{what}: not checked ({why})"), remedy);
    match (is_given, is_asked) {
        (false, _) => not_checked(format!("no {missing} given"), &format!("set {key}")),
        (true, false) => not_checked(format!("stop.{off} = false"), "remove that key"),
        (true, true) => Check::new(name, Verdict::Passed, format!("{what}: ends the life when reached")),
    }
}

fn toughness(case: &Case, prediction: &Prediction) -> Check {
    let given = strength(case, "toughness");
    let most = prediction.curve.iter().map(|row| row.k_max(&case.loading)).filter(|k| k.is_finite()).fold(f64::NAN, f64::max);
    match case.toughness_at_end() {
        Some(_) if most.is_nan() => {
            Check::not_checked("toughness", "Fracture: not checked (K not computed)", "use a method that computes K")
        }
        Some(toughness) => {
            let required = case.stop.required.unwrap_or(1.0);
            let [most_percent, end] = [100.0 * most / toughness, 100.0 / required];
            let words = format!("Fracture: K_max up to {most_percent:.0} % of K_c ({end:.0} % ends the life)");
            Check { words, verdict: of_first_load(prediction, required * most / toughness), ..given }
        }
        None => Check {
            words: given.words.clone()
                + &if most.is_nan() { String::new() } else { format!("; K_max reaches {:.0} MPa√m", most / MPA_SQRT_M) },
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
        let words = "Net-section yield: not checked (supports on both sides of every section)";
        return Check::not_checked(NAME, words, "give the loads at both ends instead of a support");
    }
    let required = case.stop.required.unwrap_or(1.0);
    let [most_percent, end] = [100.0 * most, 100.0 / required];
    let words =
        format!("Net-section yield: load up to {most_percent:.0} % of the plastic collapse load ({end:.0} % ends the life)");
    Check { words, verdict: of_first_load(prediction, required * most), ..given }
}

/// A strength that the first load exceeds leaves no life.
fn of_first_load(prediction: &Prediction, used: f64) -> Verdict {
    if prediction.stop.is_strength() && prediction.curve.len() == 1 && used >= 1.0 { Verdict::Failed } else { Verdict::Passed }
}

fn small_scale_yielding(case: &Case, prediction: &Prediction) -> Option<Check> {
    const NAME: &str = "small_scale_yielding";
    let zone = plastic_zone(case, &prediction.curve)?;
    let percent = 100.0 * zone.life_share_too_large;
    // A short crack at a hole outgrows its zone, and has another too large one at its end.
    let (is_first, never) = (zone.too_large_from == Some(zone.first.crack_length), zone.life_share_too_large >= 1.0);
    let words = match zone.too_large_from {
        None => "LEFM (small-scale yielding): valid to the end".to_owned(),
        Some(from) if never => format!("LEFM (small-scale yielding): not valid from the start (a = {})", two_digits(from)),
        Some(from) => {
            let again = if is_first { " and again at the end" } else { "" };
            let until = zone.too_large_to.map_or_else(|| again.to_owned(), |to| format!(" to {}", two_digits(to)));
            format!("LEFM (small-scale yielding): not valid from a = {}{until} ({percent:.1} % of life)", two_digits(from))
        }
    };
    let remedy = match zone.too_small {
        _ if never => "reduce the load, or start with a longer crack: K is not valid for this one",
        "ligament" => "stop the analysis at this length (stop.crack_length_mm): growth beyond it is underestimated",
        _ => "start with a longer crack: growth of shorter ones is underestimated",
    };
    let check = Check::sized(NAME, percent, never || percent > CAUTION_PERCENT, Side::NonConservative, words, remedy);
    Some(if never { Check { verdict: Verdict::Failed, ..check } } else { check })
}

/// A length in two digits, three above 10 mm.
fn two_digits(length: f64) -> String {
    PLAIN.length(length, usize::from(length < 10.0 * MM))
}

/// Life outside the tested ΔK, below and above.
fn extrapolation(case: &Case, prediction: &Prediction) -> Vec<Check> {
    let (Some([low, high]), Some(shares)) = (fit_use::fitted_range(case), fit_use::life_shares_outside(case, prediction)) else {
        return fit_use::fitted_range(case).is_none().then(unknown_range).into_iter().collect();
    };
    let of_side = |name, share: f64, side, words: String| {
        let is_refused = side == Side::NonConservative && share > fit_use::EXTRAPOLATION_REFUSED && !case.allow_extrapolation;
        let remedy = match side {
            Side::NonConservative => "test at higher ΔK, or stop earlier (stop.crack_length_mm)",
            _ if case.fatigue.threshold > 0.0 => "test at lower ΔK",
            _ => "test at lower ΔK, or set fatigue.delta_k_threshold_mpa_sqrt_m",
        };
        let check = Check::sized(name, 100.0 * share, share > OUTSIDE_CAUTION, side, words, remedy);
        if is_refused { Check { verdict: Verdict::Failed, ..check } } else { check }
    };
    let [below, above] = shares;
    vec![
        of_side(
            "extrapolation_below",
            below,
            Side::Conservative,
            format!(
                "Extrapolation: {:.1} % of life at ΔK below {low:.2} MPa√m, the lowest tested (usually conservative)",
                100.0 * below
            ),
        ),
        of_side(
            "extrapolation_above",
            above,
            Side::NonConservative,
            format!(
                "Extrapolation: {:.1} % of life at ΔK above {high:.2} MPa√m, the highest tested (non-conservative)",
                100.0 * above
            ),
        ),
    ]
}

fn unknown_range() -> Check {
    Check::not_checked(
        "extrapolation_above",
        "Extrapolation: not checked (law entered as constants; tested ΔK range unknown)",
        "fit a law to test data, or compare ΔK with the range of the source",
    )
}

/// What the handbook says of the first ΔK, under a spectrum of the cycles by which the crack grows there.
fn first_extrapolation(case: &Case) -> Option<Check> {
    let Some([low, high]) = fit_use::fitted_range(case) else { return Some(unknown_range()) };
    let first = first_delta_k(case)?;
    let [below, above] = fit_use::growth_shares_outside(case, first)?;
    let at = |share: f64| match case.loading.spectrum {
        Some(_) => format!("{:.0} % of the first growth", 100.0 * share),
        None => format!("first ΔK {:.2} MPa√m", first / MPA_SQRT_M),
    };
    if above > OUTSIDE_CAUTION {
        let words = format!("Extrapolation: {} is above the highest tested, {high:.2} MPa√m", at(above));
        let remedy = "reduce the load, or test at higher ΔK";
        let check = Check::sized("extrapolation_above", 100.0 * above, true, Side::NonConservative, words, remedy);
        let is_refused = above > fit_use::EXTRAPOLATION_REFUSED && !case.allow_extrapolation;
        return Some(if is_refused { Check { verdict: Verdict::Failed, ..check } } else { check });
    }
    (below > OUTSIDE_CAUTION).then(|| {
        let words = format!("Extrapolation: {} is below the lowest tested, {low:.2} MPa√m (usually conservative)", at(below));
        Check { side: Some(Side::Conservative), ..Check::new("extrapolation_below", Verdict::Caution, words) }
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
        "K: {:+.1} % against the energy release rate at a = {} ({:+.0} % in da/dN)",
        100.0 * check.difference,
        two_digits(check.crack_length),
        percent
    );
    // A K that is too large makes lives too short.
    let side = if check.difference > 0.0 { Side::Conservative } else { Side::NonConservative };
    let remedy = "reduce model.spacing_mm";
    Some(Check::sized("cross_check", percent.abs(), check.is_large(), side, words, remedy))
}

/// Life over that without retardation.
fn retardation(case: &Case, prediction: &Prediction) -> Option<Check> {
    const NAME: &str = "retardation";
    const REMEDY: &str = "fit its constant to a spectrum test, or compare with loading.retardation = \"none\"";
    let model = case.retardation.as_ref()?.kind;
    let Some((factor, least)) = retarded(prediction) else {
        let words = format!("Retardation: not checked (effect of {model} unknown; its constants are given, not fitted)");
        return Some(Check::not_checked(NAME, &words, REMEDY));
    };
    let times =
        if factor.is_finite() { format!("{least}{factor:.2} × the life without it") } else { "unlimited life".to_owned() };
    let words = format!("Retardation: {times} ({model}; constants given, not fitted)");
    let side = if factor > 1.0 { Side::NonConservative } else { Side::Conservative };
    let is_large = !(1.0 / RETARDED_CAUTION..=RETARDED_CAUTION).contains(&factor);
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
        LawSource::Fitted(_) => format!("Walker, γ = {} (assumed)", short(case.fatigue.walker_gamma)),
        _ => "the law".to_owned(),
    };
    let is_within = share <= OUTSIDE_CAUTION;
    let words = match is_within {
        true if share == 0.0 => format!("Stress ratio: R = {ratio}, as tested"),
        true => format!("Stress ratio: {:.1} % of growth outside the tested R = {of_law}", 100.0 * share),
        false if case.loading.spectrum.is_some() => {
            format!("Stress ratio: {:.0} % of growth outside the tested R = {of_law}, transferred by {by}", 100.0 * share)
        }
        false => format!("Stress ratio: R = {ratio}; law tested at R = {of_law}, transferred by {by}"),
    };
    let verdict = if is_within { Verdict::Passed } else { Verdict::Caution };
    let remedy = (!is_within).then(|| format!("test at R = {ratio}"));
    Some(Check { side: Some(Side::Either), remedy, ..Check::new(NAME, verdict, words) })
}

fn fitted(case: &Case) -> Option<&FittedRecord> {
    match &case.law {
        LawSource::Fitted(record) => Some(record),
        _ => None,
    }
}

/// Thickness of the plate against that of the specimens of the law: thicker ones grow faster (more constraint, less closure).
fn thickness(case: &Case) -> Option<Check> {
    const NAME: &str = "thickness";
    let (of_law, of_plate) = (fitted(case)?.thickness_mm, case.specimen.thickness / MM);
    let ratio = of_plate / of_law;
    let is_alike = (1.0 / THICKNESS_ALIKE..=THICKNESS_ALIKE).contains(&ratio);
    let direction = if is_alike {
        ""
    } else if ratio > 1.0 {
        " (non-conservative)"
    } else {
        " (conservative)"
    };
    let words = format!("Thickness: {of_plate:.2} mm; law tested on {of_law:.2} mm{direction}");
    let verdict = if is_alike { Verdict::Passed } else { Verdict::Caution };
    let side = if ratio > 1.0 { Side::NonConservative } else { Side::Conservative };
    let remedy = (!is_alike).then(|| "test specimens of the plate's thickness".to_owned());
    Some(Check { side: Some(side), remedy, ..Check::new(NAME, verdict, words) })
}

/// Sizes of a test specimen after ASTM E647, 7.1 and A1.3: C(T) W/20 ≤ B ≤ W/4 and a ≥ 0.2 W; M(T) B ≤ W/8.
fn size(case: &Case) -> Option<Check> {
    const NAME: &str = "e647_size";
    let specimen = &case.specimen;
    let (thickness, width, crack) = (specimen.thickness, specimen.width, specimen.crack_length);
    let wrong = match specimen.kind {
        SpecimenKind::CompactTension if thickness < width / 20.0 || thickness > width / 4.0 => {
            Some(format!("B = {:.2} mm is outside W/20 to W/4", thickness / MM))
        }
        SpecimenKind::CompactTension if crack < 0.2 * width => Some(format!("a = {:.2} mm is below 0.2 W", crack / MM)),
        SpecimenKind::MiddleTension if thickness > width / 8.0 => Some(format!("B = {:.2} mm is above W/8", thickness / MM)),
        SpecimenKind::CompactTension | SpecimenKind::MiddleTension => None,
        _ => return None,
    };
    let verdict = if wrong.is_some() { Verdict::Caution } else { Verdict::Passed };
    let words =
        format!("Specimen size: {}", wrong.map_or_else(|| "within ASTM E647".to_owned(), |wrong| format!("{wrong} (ASTM E647)")));
    Some(Check { side: Some(Side::Either), ..Check::new(NAME, verdict, words) })
}

/// Misfit of the law at the ends of the tested ΔK.
fn lack_of_fit(case: &Case) -> Option<Check> {
    let percent = fitted(case)?.lack_of_fit_percent?;
    let [sense, direction] = if percent > 0.0 { ["faster", "non-conservative"] } else { ["slower", "conservative"] };
    let words = format!(
        "Fit at the ends: measured growth is {:.0} % {sense} than the law at one end of the tested ΔK ({direction})",
        percent.abs()
    );
    let side = if percent > 0.0 { Side::NonConservative } else { Side::Conservative };
    let remedy = "fit another fatigue.growth_law, or use a table";
    Some(Check::sized("lack_of_fit", percent, percent.abs() > OUTSIDE_CAUTION * 100.0, side, words, remedy))
}
