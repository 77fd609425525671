//! Keys of `[model]`, and what those of the element-free Galerkin method say.

use serde::Deserialize;
use toml::{Table, Value};

use super::Method;
use crate::bond_law::{BondLawKind, Kernel, Rotation, SurfaceCorrection};
use crate::element_free::basis::{BasisKind, Enrichment};
use crate::element_free::resolution::{ElementFreeSettings, IN_RADIUS, Resolution};
use crate::error::{Result, input, input_missing};
use crate::input::{LENGTH, number};
use crate::solver::{SolverKind, Symmetry};
use crate::specimen::Specimen;
use crate::specimen::geometry::bounding_box;

/// By the error asked for, in percent of life: far spacings across the smaller side of the plate, largest step of a tip over its crack
/// and room, reach of a tip in spacings, radius of influence on linear polynomials. The worst of eighteen plates errs by 0.5, 0.7, 1.3 and
/// 1.6 % (`tests/verification/hard_plates.rs` has the hardest); an increment takes 1, 0.8, 0.55 and 0.4 of the time.
const RUNGS: [(f64, [f64; 4]); 4] = [
    (0.5, [20.0, 0.25, 4.0, 2.5]),
    (1.0, [14.0, 0.4, 3.0, 2.5]),
    (2.0, [10.0, 0.4, 3.0, 2.2]),
    (f64::INFINITY, [10.0, 0.4, 3.0, 2.0]),
];
/// Far spacings of a plate without crack over those of one with cracks: it is asked for stress along rims, which needs more than K.
const WITHOUT_CRACK: f64 = 2.0;
/// Error that is asked for where the case does not say.
const TOLERANCE_PERCENT: f64 = 2.0;
/// Share of the error of a life that K may have: its cube or fourth power makes the life.
const FACTOR_SHARE: f64 = 0.3;
/// Nodes far from cracks beyond which a spacing was hardly meant for nodes.
const NODES_USUAL: f64 = 5e3;
/// Spacings in the room of a tip.
const HOLD: f64 = 3.0;
/// Radius of influence of a node in its spacings, of quadratic polynomials.
const INFLUENCE_OF_QUADRATIC: f64 = 3.5;

/// Keys of `[model]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ModelKeys {
    pub method: Option<Method>,
    pub symmetry: Option<Symmetry>,
    pub bond_law: Option<BondLawKind>,
    pub kernel: Option<Kernel>,
    pub rotation: Option<Rotation>,
    pub surface_correction: Option<SurfaceCorrection>,
    pub spacing_mm: Option<f64>,
    pub horizon_ratio: Option<f64>,
    pub lattice_angle_deg: Option<f64>,
    pub solver: Option<SolverKind>,
    pub nodes: Option<f64>,
    pub tolerance_percent: Option<f64>,
    pub basis: Option<BasisKind>,
    pub enrichment: Option<Enrichment>,
    pub influence_radius: Option<f64>,
}

/// Keys that belong to the element-free Galerkin method.
pub(super) const OF_NODES: &[&str] = &["nodes", "tolerance_percent", "basis", "enrichment", "influence_radius"];
/// Keys that belong to points and bonds.
pub(super) const OF_POINTS: &[&str] =
    &["symmetry", "bond_law", "kernel", "rotation", "surface_correction", "horizon_ratio", "lattice_angle_deg", "solver"];

/// Makes `[model]` one of nodes: what it says of points goes, but for keys that were `asked` for beside the file.
pub(super) fn on_nodes(table: &mut Table, asked: impl Fn(&str) -> bool) {
    let model = table.entry("model").or_insert_with(|| Value::Table(Table::new()));
    let (Some(model), name) = (model.as_table_mut(), Method::ElementFreeGalerkin.name()) else { return };
    if model.get("method").and_then(Value::as_str) == Some(name) {
        return;
    }
    model.retain(|key, _| key != "spacing_mm" && !OF_POINTS.contains(&key) || asked(&format!("model.{key}")));
    model.insert("method".to_owned(), Value::String(name.to_owned()));
}

/// Refuses a key of `[model]` that does not go with the method.
pub(super) fn refuse(model: &Value, keys: &[&str], problem: &str, remedy: &str) -> Result<()> {
    match keys.iter().find(|key| model.get(**key).is_some()) {
        None => Ok(()),
        Some(key) => Err(input_missing(&format!("model.{key}"), problem, remedy)),
    }
}

/// What is to be said of a spacing that was meant for points: nodes are refined by themselves.
pub(super) fn too_fine(spacing_mm: f64, specimen: &Specimen, settings: &ElementFreeSettings) -> Option<String> {
    let nodes = specimen.area() / settings.resolution.far.powi(2);
    (nodes > NODES_USUAL).then(|| {
        format!(
            "model.spacing_mm = {spacing_mm} makes some {nodes:.0} nodes far from cracks: nodes are refined by themselves where tips, rims and \
             ligaments ask for it; leave the key out"
        )
    })
}

impl ModelKeys {
    /// What the keys of nodes say, and the choice of the program where they say nothing; `spacing_mm` is that far from cracks.
    pub(super) fn element_free(&self, spacing_mm: Option<f64>, specimen: &Specimen) -> Result<ElementFreeSettings> {
        let tolerance = number("an error in percent", 0.5, 20.0)
            .read("model.tolerance_percent", self.tolerance_percent.unwrap_or(TOLERANCE_PERCENT))?;
        let (_, [across, step_share, reach, of_linear]) =
            RUNGS.into_iter().find(|(percent, ..)| tolerance <= *percent).unwrap_or(RUNGS[RUNGS.len() - 1]);
        let [low, high] = bounding_box(&specimen.outline);
        let [width, height] = [0, 1].map(|i| high[i] - low[i]);
        let far = match (spacing_mm, self.nodes) {
            (Some(_), Some(nodes)) => {
                let problem = "stands beside model.spacing_mm, which says the same in other words";
                return Err(input("model.nodes", nodes, problem, "leave one of them out"));
            }
            (Some(spacing), None) => {
                let spacing = LENGTH.read("model.spacing_mm", spacing)?;
                let most = width.min(height) / 4.0;
                if spacing > most {
                    let problem = format!("leaves fewer than four spacings across the plate ({} mm)", 1e3 * width.min(height));
                    return Err(input("model.spacing_mm", 1e3 * spacing, problem, format!("give {:.4} mm or less", 1e3 * most)));
                }
                spacing
            }
            (None, Some(nodes)) => {
                let nodes = number("a number of nodes", 50.0, 1e5).read("model.nodes", nodes)?;
                (specimen.area() / nodes).sqrt()
            }
            (None, None) => width.min(height) / if specimen.tips.is_empty() { WITHOUT_CRACK * across } else { across },
        };
        let basis = self.basis.unwrap_or(if specimen.tips.is_empty() { BasisKind::Quadratic } else { BasisKind::Linear });
        let influence = number("a radius of influence in spacings", 1.5, 6.0)
            .read_optional("model.influence_radius", self.influence_radius)?;
        Ok(ElementFreeSettings {
            resolution: Resolution {
                far,
                hold: HOLD,
                reach,
                in_radius: IN_RADIUS,
                fineness: 1.0,
                support: influence.unwrap_or(if basis == BasisKind::Quadratic { INFLUENCE_OF_QUADRATIC } else { of_linear }),
                basis,
                enrichment: self.enrichment.unwrap_or(Enrichment::Tip),
            },
            step_share,
            tolerance: tolerance / 100.0 * FACTOR_SHARE,
            is_given: spacing_mm.is_some() || self.nodes.is_some(),
        })
    }
}
