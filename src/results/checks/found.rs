//! The checks themselves: strengths, validity of K, range of the law.

use super::{Check, NONE_PERCENT, Side, Verdict};
use crate::format::{PLAIN, short};
use crate::spectrum::retarded;
use perilife_base::input::Folder;
use perilife_base::units::{MM, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_growth::case::record::FittedRecord;
use perilife_growth::case::{Case, Engine, LawSource, library_law};
use perilife_growth::predict::fit_use;
use perilife_growth::predict::judgement::first_delta_k;
use perilife_growth::predict::part_through::PartThroughLife;
use perilife_growth::predict::plastic_zone::plastic_zone;
use perilife_growth::predict::{CurvePoint, Prediction};
use perilife_laws::growth_law::{GrowthLaw, Walker};
use perilife_plate::material::growth_data::{self, BATCH_FACTOR, GrowthRecord, MM_PER_INCH, MPA_SQRT_M_PER_KSI_SQRT_IN};
use perilife_plate::specimen::SpecimenKind;
use perilife_plate::specimen::handbook::handbook;
use perilife_plate::specimen::part_through::STATED_ERROR;

/// Effect on life, percent, above which a check is a caution; no effect is known more precisely.
const CAUTION_PERCENT: f64 = 1.0;
/// Share of life outside the tested ΔK above which the law is a caution.
const OUTSIDE_CAUTION: f64 = 0.05;
/// Thickness of the plate over that of the specimens, or the other way, up to which both have the same constraint at the tip.
const THICKNESS_ALIKE: f64 = 1.25;
/// Factor of the life by retardation above which it is a caution.
const RETARDED_CAUTION: f64 = 1.5;
/// Rate in the middle of the range of growth data, mm/cycle.
const RATE_MIDDLE: f64 = 1e-4;
/// Exponent where the law has none: what an error of K does to the rate.
const EXPONENT_USUAL: f64 = 3.0;

/// Those of a life that are not of its law alone.
pub(super) fn of_run(case: &Case, prediction: &Prediction) -> Vec<Check> {
    let mut checks = vec![toughness(case, prediction), ligament(case, prediction)];
    checks.extend(small_scale_yielding(case, prediction));
    checks.extend(extrapolation(case, prediction));
    checks.extend(cross_check(case, prediction));
    checks.extend(handbook_range(case, prediction));
    checks.extend(part_through(case, prediction));
    checks.extend(retardation(case, prediction));
    checks
}

pub(super) fn of_law(case: &Case, prediction: Option<&Prediction>) -> impl Iterator<Item = Check> {
    let of_test = [stress_ratio(case, prediction), thickness(case), size(case), lack_of_fit(case)];
    of_test.into_iter().chain([growth_data(case), units_of_c(case)]).flatten()
}

pub(super) fn strength(case: &Case, name: &'static str) -> Check {
    let (is_given, is_asked, [what, missing, key, off]) = if name == "toughness" {
        let words = ["Fracture", "toughness", "material.toughness_mpa_sqrt_m", "toughness"];
        (case.material.toughness.is_some(), case.stop.by_toughness, words)
    } else {
        let words = ["Net-section yield", "yield strength", "material.yield_strength_mpa", "net_section"];
        (case.material.yield_strength.is_some(), case.stop.by_net_section, words)
    };
    let not_checked = |why: String, remedy: &str| Check::not_checked(name, format!("{what}: not checked ({why})"), remedy);
    match (is_given, is_asked) {
        (false, _) => not_checked(format!("no {missing} given"), &format!("set {key}")),
        (true, false) => not_checked(format!("stop.{off} = false"), "remove that key"),
        (true, true) => Check::new(name, Verdict::Passed, format!("{what}: ends the life when reached")),
    }
}

/// How much of a strength the largest load takes; one that the first load exceeds leaves no life.
fn used(case: &Case, prediction: &Prediction, given: Check, [what, of]: [&str; 2], share: f64) -> Check {
    let required = case.stop.required.unwrap_or(1.0);
    let words = format!("{what} up to {:.0} % of {of} ({:.0} % ends the life)", 100.0 * share, 100.0 / required);
    let is_at_once = prediction.stop.is_strength() && prediction.curve.len() == 1 && required * share >= 1.0;
    Check { words, verdict: Verdict::Passed, ..given }.failed_if(is_at_once)
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.filter(|value| value.is_finite()).fold(f64::NAN, f64::max)
}

pub(super) fn toughness(case: &Case, prediction: &Prediction) -> Check {
    let given = strength(case, "toughness");
    let most = largest(prediction.curve.iter().map(|row| row.k_max(&case.loading)));
    match case.toughness_at_end() {
        Some(_) if most.is_nan() => {
            Check::not_checked("toughness", "Fracture: not checked (K not computed)", "use a method that computes K")
        }
        Some(toughness) => used(case, prediction, given, ["Fracture: K_max", "K_c"], most / toughness),
        None if most.is_nan() => given,
        None => Check { words: format!("{}; K_max reaches {:.0} MPa√m", given.words, most / MPA_SQRT_M), ..given },
    }
}

pub(super) fn ligament(case: &Case, prediction: &Prediction) -> Check {
    let given = strength(case, "ligament");
    if case.yield_strength_at_end().is_none() {
        return given;
    }
    let load = |row: &CurvePoint| Some(case.loading.doing(row.work, row.crack_length) / row.limit_load?);
    let most = largest(prediction.curve.iter().filter_map(load));
    if most.is_nan() {
        let words = "Net-section yield: not checked (supports on both sides of every section)";
        return Check::not_checked("ligament", words, "give the loads at both ends instead of a support");
    }
    used(case, prediction, given, ["Net-section yield: load", "the plastic collapse load"], most)
}

pub(super) fn small_scale_yielding(case: &Case, prediction: &Prediction) -> Option<Check> {
    let zone = plastic_zone(case, &prediction.curve)?;
    let percent = 100.0 * zone.life_share_too_large;
    // A short crack at a hole outgrows its zone, and has another too large one at its end.
    let (is_first, never) = (zone.too_large_from == Some(zone.first.crack_length), zone.life_share_too_large >= 1.0);
    let found = match zone.too_large_from.map(one_decimal) {
        None => "valid to the end".to_owned(),
        Some(from) if never => format!("not valid from the start (a = {from})"),
        Some(from) => {
            let again = if is_first { " and again at the end" } else { "" };
            let until = zone.too_large_to.map_or_else(|| again.to_owned(), |to| format!(" to {}", one_decimal(to)));
            let valid = if percent > CAUTION_PERCENT { "not valid" } else { "valid except" };
            format!("{valid} from a = {from}{until} ({percent:.1} % of life; limit {CAUTION_PERCENT} %)")
        }
    };
    let remedy = match zone.too_small {
        _ if never => "reduce the load, or start with a longer crack: K is not valid for this one",
        "ligament" => "stop the analysis at this length (stop.crack_length_mm): growth beyond it is underestimated",
        _ => "start with a longer crack: growth of shorter ones is underestimated",
    };
    let (words, is_caution) = (format!("LEFM (small-scale yielding): {found}"), never || percent > CAUTION_PERCENT);
    let check = Check::sized("small_scale_yielding", percent, is_caution, Side::NonConservative, words, remedy);
    Some(check.failed_if(never))
}

fn one_decimal(length: f64) -> String {
    PLAIN.length(length, 1)
}

/// Life outside the tested ΔK, below and above.
fn extrapolation(case: &Case, prediction: &Prediction) -> Vec<Check> {
    let Some([low, high]) = fit_use::fitted_range(case) else { return vec![unknown_range()] };
    let Some([below, above]) = fit_use::life_shares_outside(case, prediction) else { return Vec::new() };
    let of_side = |name, share: f64, side: Side, range: String, remedy| {
        let percent = 100.0 * share;
        let words = match percent < NONE_PERCENT {
            true => format!("Extrapolation: none {range}"),
            false if side == Side::Conservative => {
                format!("Extrapolation: {percent:.1} % of life at ΔK {range} (usually conservative)")
            }
            false => format!("Extrapolation: {percent:.1} % of life at ΔK {range} (non-conservative)"),
        };
        Check::sized(name, percent, share > OUTSIDE_CAUTION, side, words, remedy)
    };
    let lower = match case.fatigue.threshold > 0.0 {
        true => "test at lower ΔK",
        false => "test at lower ΔK, or set fatigue.delta_k_threshold_mpa_sqrt_m",
    };
    let higher = "test at higher ΔK, or stop earlier (stop.crack_length_mm)";
    let words = format!("below {low:.2} MPa√m, the lowest tested");
    let of_lower = of_side("extrapolation_below", below, Side::Conservative, words, lower);
    let words = format!("above {high:.2} MPa√m, the highest tested");
    let of_higher = of_side("extrapolation_above", above, Side::NonConservative, words, higher);
    vec![of_lower, of_higher.failed_if(is_refused(case, above))]
}

fn is_refused(case: &Case, share_above: f64) -> bool {
    share_above > fit_use::EXTRAPOLATION_REFUSED && !case.allow_extrapolation
}

fn unknown_range() -> Check {
    Check::not_checked(
        "extrapolation_above",
        "Extrapolation: not checked (law entered as constants; tested ΔK range unknown)",
        "fit a law to test data, or compare ΔK with the range of the source",
    )
}

/// What the handbook says of the first ΔK, under a spectrum of the cycles by which the crack grows there.
pub(super) fn first_extrapolation(case: &Case) -> Option<Check> {
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
        return Some(check.failed_if(is_refused(case, above)));
    }
    let words = format!("Extrapolation: {} is below the lowest tested, {low:.2} MPa√m (usually conservative)", at(below));
    let check = Check { side: Some(Side::Conservative), ..Check::new("extrapolation_below", Verdict::Caution, words) };
    (below > OUTSIDE_CAUTION).then_some(check)
}

fn cross_check(case: &Case, prediction: &Prediction) -> Option<Check> {
    let check = prediction.cross_check?;
    let exponent = match &case.law {
        LawSource::Fitted(record) => record.paris_m,
        LawSource::Paris(law) => law.m,
        LawSource::Inline(law) => law.p,
        LawSource::Factor(_) | LawSource::Missing(_) => EXPONENT_USUAL,
    };
    let (difference, at) = (100.0 * check.difference, one_decimal(check.crack_length));
    let percent = 100.0 * exponent * check.difference;
    let words = format!("K: {difference:+.1} % against the energy release rate at a = {at} ({percent:+.0} % in da/dN)");
    // A K that is too large makes lives too short.
    let side = Side::too_long(check.difference <= 0.0);
    Some(Check::sized("cross_check", percent.abs(), check.is_large(), side, words, "reduce model.spacing_mm"))
}

/// How much of the life the formula for K is not made for; a share that shows in no life is not worth a check.
fn handbook_range(case: &Case, prediction: &Prediction) -> Option<Check> {
    let formula = handbook(&case.specimen).filter(|_| case.engine() == Engine::Handbook)?;
    let is_outside = |pair: &&[CurvePoint]| !pair.iter().all(|row| formula.holds_at(row.crack_length));
    let outside: f64 = prediction.curve.windows(2).filter(is_outside).map(|pair| pair[1].cycles - pair[0].cycles).sum();
    let percent = 100.0 * outside / prediction.life_cycles();
    let words = format!("Handbook K: {percent:.1} % of life outside the range of {} ({})", formula.name, formula.range);
    let remedy = "start and stop within it, or use model.method = \"element_free_galerkin\"";
    let check = Check::sized("handbook_range", percent, percent > CAUTION_PERCENT, Side::Either, words, remedy);
    (percent > 0.1).then_some(check)
}

/// Effect of the stated error of K of a part-through crack on the life, and the share of life outside its range; none of an empty life.
fn part_through(case: &Case, prediction: &Prediction) -> Vec<Check> {
    let life = prediction.life_cycles();
    let found = PartThroughLife::of(case, &prediction.curve).filter(|_| life > 0.0);
    let check = |name, percent, found: String, remedy| {
        let words = format!("Newman-Raju K: {found}");
        Check::sized(name, percent, percent > CAUTION_PERCENT, Side::Either, words, remedy)
    };
    let of_error = |found: &PartThroughLife| {
        let [shorter, longer] = found.life_factors.map(|factor| 100.0 * (factor - 1.0));
        let larger = if longer.is_finite() { format!("{longer:+.1} %") } else { "unlimited".to_owned() };
        let percent = if longer.is_finite() { longer.max(-shorter) } else { 100.0 };
        let words = format!("±{:.0} % (source), {shorter:+.1} % to {larger} in life", 100.0 * STATED_ERROR);
        check("part_through_factors", percent, words, "apply a factor to the life, or compare with a test")
    };
    let of_range = |found: &PartThroughLife| {
        let percent = 100.0 * found.cycles_outside / life;
        let names: Vec<String> = found.outside.iter().map(|(limit, _)| limit.in_words()).collect();
        let outside = || format!("{percent:.1} % of life outside {}", names.join(", "));
        let words = if names.is_empty() { "within range".to_owned() } else { outside() };
        check("part_through_range", percent, words, "the source states no error there: stop earlier (stop.crack_depth_mm)")
    };
    found.iter().flat_map(|found| [of_error(found), of_range(found)]).collect()
}

/// Life over that without retardation.
fn retardation(case: &Case, prediction: &Prediction) -> Option<Check> {
    const NAME: &str = "retardation";
    const REMEDY: &str = "fit its constant to a spectrum test, or compare with loading.retardation = \"none\"";
    let model = case.retardation.as_ref()?.kind;
    let Some((factor, least)) = retarded(prediction) else {
        let words = format!("Retardation: not checked (effect of {model} unknown; its constants are given, not fitted)");
        return Some(Check::not_checked(NAME, words, REMEDY));
    };
    let times =
        if factor.is_finite() { format!("{least}{factor:.2} × the life without it") } else { "unlimited life".to_owned() };
    let words = format!("Retardation: {times} ({model}; constants given, not fitted)");
    let is_large = !(1.0 / RETARDED_CAUTION..=RETARDED_CAUTION).contains(&factor);
    Some(Check::sized(NAME, 100.0 * (1.0 - 1.0 / factor), is_large, Side::too_long(factor > 1.0), words, REMEDY))
}

/// Stress ratios of the law against those of the cycles that grow the crack.
fn stress_ratio(case: &Case, prediction: Option<&Prediction>) -> Option<Check> {
    let [low, high] = fit_use::fitted_ratios(case)?;
    let share = fit_use::share_of_other_ratios(case, prediction)?;
    let from_to = |[low, high]: [f64; 2]| if low == high { short(low) } else { format!("{} to {}", short(low), short(high)) };
    let (ratio, of_law) = (from_to(case.loading.ratios()), from_to([low, high]));
    let by = match &case.law {
        LawSource::Fitted(_) => format!("Walker, γ = {} (assumed)", short(case.fatigue.walker_gamma)),
        _ => "the law".to_owned(),
    };
    let (is_other, percent) = (share > OUTSIDE_CAUTION, 100.0 * share);
    let words = match is_other {
        false if share == 0.0 => format!("R = {ratio}, as tested"),
        false => format!("{percent:.1} % of growth outside the tested R = {of_law}"),
        true if case.loading.spectrum.is_some() => {
            format!("{percent:.0} % of growth outside the tested R = {of_law}, transferred by {by}")
        }
        true => format!("R = {ratio}; law tested at R = {of_law}, transferred by {by}"),
    };
    let remedy = format!("test at R = {ratio}");
    Some(Check::judged("stress_ratio", is_other, Side::Either, format!("Stress ratio: {words}"), &remedy))
}

fn fitted(case: &Case) -> Option<&FittedRecord> {
    if let LawSource::Fitted(record) = &case.law { Some(record) } else { None }
}

/// Thickness of the plate against that of the specimens of the law: thicker ones grow faster (more constraint, less closure).
fn thickness(case: &Case) -> Option<Check> {
    let (of_law, of_plate) = (fitted(case)?.thickness_mm, case.specimen.thickness / MM);
    let ratio = of_plate / of_law;
    let (side, is_other) = (Side::too_long(ratio > 1.0), !(1.0 / THICKNESS_ALIKE..=THICKNESS_ALIKE).contains(&ratio));
    let direction = if is_other { format!(" ({})", side.words()) } else { String::new() };
    let words = format!("Thickness: {of_plate:.2} mm; law tested on {of_law:.2} mm{direction}");
    Some(Check::judged("thickness", is_other, side, words, "test specimens of the plate's thickness"))
}

/// Sizes of a test specimen after ASTM E647, 7.1 and A1.3: C(T) W/20 ≤ B ≤ W/4 and a ≥ 0.2 W; M(T) B ≤ W/8.
fn size(case: &Case) -> Option<Check> {
    let specimen = &case.specimen;
    let (thickness, width, crack) = (specimen.thickness, specimen.width, specimen.crack_length);
    let b = |wrong: &str| Some(format!("B = {:.2} mm is {wrong}", thickness / MM));
    let wrong = match specimen.kind {
        SpecimenKind::CompactTension if thickness < width / 20.0 || thickness > width / 4.0 => b("outside W/20 to W/4"),
        SpecimenKind::CompactTension if crack < 0.2 * width => Some(format!("a = {:.2} mm is below 0.2 W", crack / MM)),
        SpecimenKind::MiddleTension if thickness > width / 8.0 => b("above W/8"),
        SpecimenKind::CompactTension | SpecimenKind::MiddleTension => None,
        _ => return None,
    };
    let verdict = if wrong.is_some() { Verdict::Caution } else { Verdict::Passed };
    let found = wrong.map_or_else(|| "within ASTM E647".to_owned(), |wrong| format!("{wrong} (ASTM E647)"));
    Some(Check { side: Some(Side::Either), ..Check::new("e647_size", verdict, format!("Specimen size: {found}")) })
}

/// Misfit of the law at the ends of the tested ΔK.
fn lack_of_fit(case: &Case) -> Option<Check> {
    let percent = fitted(case)?.lack_of_fit_percent?;
    let (side, size) = (Side::too_long(percent > 0.0), percent.abs());
    let (sense, direction) = (if percent > 0.0 { "faster" } else { "slower" }, side.words());
    let words = match size < 0.5 {
        true => "Fit at the ends: the law fits both ends of the tested ΔK within 1 %".to_owned(),
        false => format!(
            "Fit at the ends: measured growth is {size:.0} % {sense} than the law at one end of the tested ΔK ({direction})"
        ),
    };
    let remedy = "fit another fatigue.growth_law, or use a table";
    Some(Check::sized("lack_of_fit", percent, size > OUTSIDE_CAUTION * 100.0, side, words, remedy))
}

/// Growth data of the library are those of one lot.
fn growth_data(case: &Case) -> Option<Check> {
    case.growth_data.as_ref()?;
    let percent = 100.0 * (1.0 - 1.0 / BATCH_FACTOR);
    let words =
        format!("Growth data: library values; another lot may grow at {BATCH_FACTOR} times or 1/{BATCH_FACTOR} of the rate");
    Some(Check::sized("growth_data", percent, true, Side::Either, words, "fit the law to tests of this lot"))
}

/// Constants in inches under keys in mm: by the growth data of the named material, in the middle of their range, too slow as they stand and
/// right as in/cycle and ksi√in.
fn units_of_c(case: &Case) -> Option<Check> {
    let law: Box<dyn GrowthLaw> = match &case.law {
        _ if case.law_record.is_some() || case.growth_data.is_some() => return None,
        LawSource::Paris(paris) => Box::new(Walker { paris: *paris, gamma: 1.0, threshold: 0.0 }),
        LawSource::Factor(law) => Box::new(law.clone()),
        _ => return None,
    };
    let (name, ratio) = (&case.material.name, case.loading.ratio);
    let rate = |law: &dyn GrowthLaw, k: f64| law.rate(k * MPA_SQRT_M / (1.0 - ratio.max(0.0)), ratio) / MM_PER_CYCLE;
    let records = growth_data::records().into_iter().filter(|of| !name.is_empty() && of.name.starts_with(name.as_str()));
    let law_of = |of: GrowthRecord| library_law(&of.name, case.specimen.thickness, ratio, &Folder::none()).ok();
    let known: Vec<_> = records.filter_map(law_of).collect();
    let at = |k: f64| [f64::min, f64::max].map(|of| known.iter().map(|(law, _)| rate(&**law, k)).fold(f64::NAN, of));
    let middle = (3..=60).map(f64::from).find(|k| at(*k)[1] >= RATE_MIDDLE)?;
    let [low, high] = [at(middle)[0] / BATCH_FACTOR, at(middle)[1] * BATCH_FACTOR];
    let (metric, inch) = (rate(&*law, middle), MM_PER_INCH * rate(&*law, middle / MPA_SQRT_M_PER_KSI_SQRT_IN));
    let words = format!(
        "Units of C: at ΔK {middle} MPa√m {metric:.1e} mm/cycle as entered, {inch:.1e} if C is of in/cycle and ksi√in; {name} grows by \
         {low:.1e} to {high:.1e}"
    );
    let remedy = "enter constants of in/cycle and ksi√in by the keys in inches (paris_c_in_per_cycle)";
    let check = Check::sized("units_of_c", 100.0 * (inch / metric - 1.0), true, Side::NonConservative, words, remedy);
    (metric < low && (low..=high).contains(&inch)).then_some(check)
}
