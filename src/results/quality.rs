//! How far a life can be trusted as a solution of its case: bounds of its error, and the life by the other engine.

use serde_json::{Value, json};

use perilife_base::units::MM;
use perilife_growth::case::{Case, Method, Model, coarse_points, usual_nodes};
use perilife_growth::predict::error_estimate::{ErrorEstimate, error_estimate};
use perilife_growth::predict::{Prediction, Silent, predict};

/// What is known of the error of a life.
#[derive(Debug, Clone, Default)]
pub struct Quality {
    /// Bounds of the error, or why there are none; `None` where nobody asked.
    estimate: Option<std::result::Result<ErrorEstimate, String>>,
    second: Option<SecondOpinion>,
}

/// The life by the other engine.
#[derive(Debug, Clone)]
struct SecondOpinion {
    method: &'static str,
    /// Its cycles to the crack length that both reach, and those of the run; in words why there are none.
    cycles: std::result::Result<[f64; 2], String>,
}

impl Quality {
    /// Of a run, whether bounds and a second opinion are asked for.
    pub fn of(case: &Case, prediction: &Prediction, [estimate, cross_check]: [bool; 2]) -> Quality {
        let estimate = (estimate && prediction.life().is_some()).then(|| error_estimate(case, prediction));
        let second = cross_check.then(|| second_opinion(case, prediction));
        Quality { estimate, second }
    }

    /// Adds it to `result.json`.
    pub fn add_to(&self, result: &mut Value) {
        let Some(object) = result.as_object_mut() else { return };
        let stated = self.estimate.as_ref().and_then(|estimate| estimate.as_ref().ok());
        let two_digits = |value: f64| format!("{value:.1e}").parse::<f64>().unwrap_or(value);
        object.insert("error_estimate_percent".to_owned(), json!(stated.map(|estimate| two_digits(estimate.life_percent))));
        object.insert("path_error_estimate_mm".to_owned(), json!(stated.map(|estimate| two_digits(estimate.path / MM))));
        if let Some(Err(why)) = &self.estimate {
            object.insert("no_error_estimate".to_owned(), json!(why));
        }
        let Some(SecondOpinion { method, cycles }) = &self.second else { return };
        let found = match cycles {
            Ok([other, own]) => json!({
                "method": method, "cycles": other, "cycles_of_run": own, "difference_percent": 100.0 * (other / own - 1.0),
            }),
            Err(why) => json!({ "method": method, "failed": why }),
        };
        object.insert("cross_check".to_owned(), found);
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
        lines.extend(self.second.as_ref().map(|SecondOpinion { method, cycles }| match cycles {
            Ok([other, own]) => {
                let percent = 100.0 * (other / own - 1.0);
                format!("  second opinion {method}, coarse: {other:.0} cycles where this run has {own:.0} ({percent:+.1} %)")
            }
            Err(why) => format!("  second opinion {method}: none, {why}"),
        }));
        lines
    }
}

/// The life by the engine that shares nothing with that of the run: nodes beside points and handbook, points beside nodes.
fn second_opinion(case: &Case, prediction: &Prediction) -> SecondOpinion {
    if !case.specimen.is_through() {
        let cycles = Err("no other method knows a crack that does not go through".to_owned());
        return SecondOpinion { method: Method::ElementFreeGalerkin.name(), cycles };
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
    SecondOpinion { method: model.method().name(), cycles }
}
