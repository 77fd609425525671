//! How far a life can be trusted as a solution of its case: bounds of its error, and the life by the other engine.

use serde::{Deserialize, Serialize};

use super::format::two_digits;
use perilife_base::units::MM;
use perilife_growth::case::{Case, Method, Model, coarse_points, usual_nodes};
use perilife_growth::predict::error_estimate::{ErrorEstimate, error_estimate};
use perilife_growth::predict::{Prediction, Silent, predict};

/// What is known of the error of a life.
#[derive(Debug, Clone, Default)]
pub struct Quality {
    /// Bounds of the error, or why there are none; `None` where nobody asked.
    estimate: Option<std::result::Result<ErrorEstimate, String>>,
    pub(super) second: Option<SecondOpinion>,
}

/// `cross_check` of a result: the life by the other engine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SecondOpinion {
    pub method: String,
    /// Its cycles to the crack length that both reach, and those of the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycles: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycles_of_run: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub difference_percent: Option<f64>,
    /// Why there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
}

impl Quality {
    /// Of a run, whether bounds and a second opinion are asked for.
    pub fn of(case: &Case, prediction: &Prediction, [estimate, cross_check]: [bool; 2]) -> Quality {
        let estimate = (estimate && prediction.life().is_some()).then(|| error_estimate(case, prediction));
        let second = cross_check.then(|| second_opinion(case, prediction));
        Quality { estimate, second }
    }

    /// Bounds of the error of life, percent, and path, mm; why there are none.
    pub(super) fn stated(&self) -> ([Option<f64>; 2], Option<&String>) {
        let stated = self.estimate.as_ref().and_then(|estimate| estimate.as_ref().ok());
        let bounds = stated.map(|estimate| [estimate.life_percent, estimate.path / MM].map(two_digits));
        ([0, 1].map(|place| bounds.map(|both| both[place])), self.estimate.as_ref().and_then(|estimate| estimate.as_ref().err()))
    }

    /// In words: what the program chose, and how wrong it may be.
    pub fn words(&self, case: &Case) -> Vec<String> {
        let chosen = case.chosen.as_ref().map_or_else(String::new, |why| format!(", chosen: {why}"));
        let mut lines = vec![format!("  model          {}{chosen}", case.model.method())];
        lines.extend(self.estimate.as_ref().map(|estimate| match estimate {
            Ok(ErrorEstimate { life_percent, path, basis }) => {
                let path = if *path > 0.0 { format!(", {:.2} mm of the path", path / MM) } else { String::new() };
                format!("  error          at most {life_percent:.1} % of life{path} as a solution of this case ({basis})")
            }
            Err(why) => format!("  error          not stated: {why}"),
        }));
        lines.extend(self.second.as_ref().map(|second| match (second.cycles, second.cycles_of_run, second.difference_percent) {
            (Some(other), Some(own), Some(percent)) => {
                format!(
                    "  second opinion {}, coarse: {other:.0} cycles where this run has {own:.0} ({percent:+.1} %)",
                    second.method
                )
            }
            _ => format!("  second opinion {}: none, {}", second.method, second.failed.as_deref().unwrap_or_default()),
        }));
        lines
    }
}

/// The life by the engine that shares nothing with that of the run: nodes beside points and handbook, points beside nodes.
fn second_opinion(case: &Case, prediction: &Prediction) -> SecondOpinion {
    let of = |method: Method, found: std::result::Result<[f64; 2], String>| {
        let (cycles, failed) = (found.as_ref().ok().copied(), found.err());
        let difference_percent = cycles.map(|[other, own]| 100.0 * (other / own - 1.0));
        let [cycles, cycles_of_run] = [0, 1].map(|place| cycles.map(|both| both[place]));
        SecondOpinion { method: method.name().to_owned(), cycles, cycles_of_run, difference_percent, failed }
    };
    if !case.specimen.is_through() {
        return of(Method::ElementFreeGalerkin, Err("no other method knows a crack that does not go through".to_owned()));
    }
    let model = match case.model {
        Model::Nodes(_) => Model::Points(coarse_points(case)),
        Model::Handbook(_) | Model::Points(_) => Model::Nodes(usual_nodes(&case.specimen)),
    };
    let other = Case { model, chosen: None, ..case.driven_by_tips(case.specimen.clone()) };
    let cycles = predict(&other, &Silent).map_err(|error| error.to_string()).and_then(|second| {
        let common = prediction.crack_length_final().min(second.crack_length_final());
        let at = |run: &Prediction| run.cycles_at(common).filter(|cycles| *cycles > 0.0);
        at(&second).zip(at(prediction)).map(|(other, own)| [other, own]).ok_or_else(|| "its crack did not grow".to_owned())
    });
    of(model.method(), cycles)
}
