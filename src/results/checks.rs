//! Checks of the validity of a life: what was found, its effect on the life, and a remedy; the verdict over all of them.

mod found;

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use perilife_base::error::{Error, Result};
use perilife_growth::case::Case;
use perilife_growth::predict::judgement;
use perilife_growth::predict::{Prediction, StopReason};

/// Share of a life, percent, below which it is none with one decimal.
pub const NONE_PERCENT: f64 = 0.05;

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

impl Side {
    /// Of an effect that makes the computed life too long, or too short.
    fn too_long(is_too_long: bool) -> Self {
        if is_too_long { Side::NonConservative } else { Side::Conservative }
    }

    pub fn words(self) -> &'static str {
        match self {
            Side::NonConservative => "non-conservative",
            Side::Either => "either direction",
            Side::Conservative => "conservative",
        }
    }
}

impl Check {
    fn new(name: &'static str, verdict: Verdict, words: impl Into<String>) -> Self {
        Check { name: name.into(), verdict, effect_percent: None, side: None, words: words.into(), remedy: None }
    }

    fn not_checked(name: &'static str, words: impl Into<String>, remedy: &str) -> Self {
        Check {
            side: Some(Side::NonConservative),
            remedy: Some(remedy.to_owned()),
            ..Check::new(name, Verdict::NotChecked, words)
        }
    }

    /// A caution with its remedy, or passed.
    fn judged(name: &'static str, is_caution: bool, side: Side, words: impl Into<String>, remedy: &str) -> Self {
        let verdict = if is_caution { Verdict::Caution } else { Verdict::Passed };
        let remedy = is_caution.then(|| remedy.to_owned());
        Check { side: Some(side), remedy, ..Check::new(name, verdict, words) }
    }

    fn sized(name: &'static str, percent: f64, is_caution: bool, side: Side, words: String, remedy: &str) -> Self {
        Check { effect_percent: Some(percent), ..Check::judged(name, is_caution, side, words, remedy) }
    }

    fn failed_if(self, is_failed: bool) -> Self {
        Check { verdict: if is_failed { Verdict::Failed } else { self.verdict }, ..self }
    }
}

pub fn of_case(case: &Case) -> Vec<Check> {
    let strengths = ["toughness", "ligament"].map(|name| found::strength(case, name));
    sorted(strengths.into_iter().chain(found::first_extrapolation(case)).collect(), case, None)
}

/// All checks of a life, by status and effect, the most severe first.
pub fn of_run(case: &Case, prediction: &Prediction) -> Vec<Check> {
    sorted(found::of_run(case, prediction), case, Some(prediction))
}

/// With the checks of the law, the most severe first.
fn sorted(mut checks: Vec<Check>, case: &Case, prediction: Option<&Prediction>) -> Vec<Check> {
    checks.extend(found::of_law(case, prediction));
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
        let ends = [found::toughness(case, prediction), found::ligament(case, prediction)];
        ends.iter().chain(&found::small_scale_yielding(case, prediction)).all(passed)
    };
    prediction.stop == StopReason::RunOut || prediction.stop.is_lower_bound() && is_checked()
}

#[derive(Debug, Default)]
pub struct Judgement {
    /// The most severe first.
    pub checks: Vec<Check>,
    pub is_lower_bound: bool,
    /// Beside those of the run itself.
    pub warnings: Vec<String>,
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
    /// Name of the check or the warning.
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

    /// Of a line `NAME: what was found`; names are listed in the guide (`src/guide/validity.md`).
    pub fn warning(line: &str) -> Self {
        let subject = line.split_once(": ").map(|(name, _)| name.to_owned().into());
        Message { subject, kind: "warning", text: line.to_owned(), remedy: None }
    }
}

/// Checks that did not pass, the most severe first, then warnings, and last what was not checked.
pub fn messages(checks: &[Check], warnings: &[String]) -> Vec<Message> {
    let (open, unchecked): (Vec<&Check>, Vec<&Check>) = checks.iter().partition(|check| check.verdict != Verdict::NotChecked);
    let warnings = warnings.iter().map(|line| Message::warning(line));
    open.into_iter().filter_map(Message::of).chain(warnings).chain(unchecked.into_iter().filter_map(Message::of)).collect()
}

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
