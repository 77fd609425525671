//! Numerical error of a life, and the life by another method.

use serde::{Deserialize, Serialize};

use super::format::{PLAIN, short, two_digits};
use perilife_base::units::MM;
use perilife_growth::case::{Case, Method, Model, coarse_points, usual_nodes};
use perilife_growth::predict::error_estimate::{ErrorEstimate, error_estimate};
use perilife_growth::predict::{Prediction, Silent, predict};

/// Estimated error of a life, and its cross-check.
#[derive(Debug, Clone, Default)]
pub struct Quality {
    /// `None` where not asked for; else the estimate, or why there is none.
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
    /// Of a run, with an estimate and a cross-check if asked for.
    pub fn of(case: &Case, prediction: &Prediction, [estimate, cross_check]: [bool; 2]) -> Quality {
        let estimate = (estimate && prediction.life().is_some()).then(|| error_estimate(case, prediction));
        let second = cross_check.then(|| second_opinion(case, prediction));
        Quality { estimate, second }
    }

    /// What the estimate is based on.
    pub(super) fn basis(&self) -> Option<&str> {
        self.estimate.as_ref()?.as_ref().ok().map(|estimate| &*estimate.basis)
    }

    /// Estimated error of life, percent, and path, mm; why there is none.
    pub(super) fn stated(&self) -> ([Option<f64>; 2], Option<&String>) {
        let stated = self.estimate.as_ref().and_then(|estimate| estimate.as_ref().ok());
        let bounds = stated.map(|estimate| [estimate.life_percent, estimate.path / MM].map(two_digits));
        ([0, 1].map(|place| bounds.map(|both| both[place])), self.estimate.as_ref().and_then(|estimate| estimate.as_ref().err()))
    }

    /// Lines of a summary.
    pub fn words(&self) -> Vec<String> {
        let of_estimate = |estimate: &std::result::Result<ErrorEstimate, String>| match estimate {
            Ok(ErrorEstimate { life_percent, path, .. }) => {
                let path =
                    if *path > 0.0 { format!(", ≤ {} mm in the path", short(two_digits(path / MM))) } else { String::new() };
                format!("  Accuracy       numerical error ≤ {life_percent:.1} % of life{path} (estimate)")
            }
            Err(why) => format!("  Accuracy       numerical error not estimated: {why}"),
        };
        let mut lines: Vec<String> = self.estimate.iter().map(of_estimate).collect();
        lines.extend(self.second.as_ref().map(|second| match (second.cycles, second.cycles_of_run, second.difference_percent) {
            (Some(other), Some(own), Some(percent)) => {
                let [other, own] = [other, own].map(|cycles| PLAIN.whole(cycles));
                format!("  Cross-check    {} (coarse): {other} cycles, this run {own} ({percent:+.1} %)", second.method)
            }
            _ => format!("  Cross-check    {}: none, {}", second.method, second.failed.as_deref().unwrap_or_default()),
        }));
        lines
    }
}

/// The life with K by another method: nodes for points and handbook, points for nodes.
fn second_opinion(case: &Case, prediction: &Prediction) -> SecondOpinion {
    let of = |method: Method, found: std::result::Result<[f64; 2], String>| {
        let (cycles, failed) = (found.as_ref().ok().copied(), found.err());
        let difference_percent = cycles.map(|[other, own]| 100.0 * (other / own - 1.0));
        let [cycles, cycles_of_run] = [0, 1].map(|place| cycles.map(|both| both[place]));
        SecondOpinion { method: method.name().to_owned(), cycles, cycles_of_run, difference_percent, failed }
    };
    if !case.specimen.is_through() {
        return of(Method::ElementFreeGalerkin, Err("no other method supports part-through cracks".to_owned()));
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
