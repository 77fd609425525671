//! What is measured in a scene: every method with its resolutions, laws, solvers and steps.

use super::scene::Scene;
use crate::error::Result;
use crate::units::MM;

/// A choice of keys.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    /// Which family of methods it belongs to.
    pub family: Family,
    /// What tells it from the default of its family, in words; empty for that default.
    pub words: String,
    /// Keys that make it.
    pub set: Vec<String>,
    /// Whether a quick chart has it.
    pub is_quick: bool,
}

crate::kinds! {
    /// Families of methods: a colour of the chart each.
    pub enum Family for "method of the chart" {
        TipField = "tip_field": "points and bonds, cracks driven by the K of their tips: the default",
        ElementFree = "element_free_galerkin": "nodes without elements, cracks driven by the K of their tips",
        Handbook = "handbook": "quadrature of the growth law with K of a handbook",
        BondStrain = "bond_strain": "bonds that fail by their strain, at the rate of K",
        Published = "bond_strain_as_computed": "bonds that fail by their strain as computed: the published law",
        BondLaw = "bond_law": "another bond law, kernel or correction than the default",
        Solver = "solver": "another solver than the default",
    }
}

/// Spacings over the default one; those of a quick chart.
const SPACINGS: [(f64, bool); 4] = [(2.0, true), (1.5, true), (0.75, false), (0.5, false)];
/// Horizons over spacings beside the default one.
const HORIZON_RATIOS: [f64; 2] = [2.015, 4.015];
/// Errors of a step asked for beside the default one, percent.
const STEP_ERRORS: [f64; 2] = [2.0, 0.05];
/// Errors of nodes asked for beside the default one, percent; those of a quick chart.
const TOLERANCES: [(f64, bool); 2] = [(10.0, true), (1.0, true)];
/// Numbers of nodes far from cracks.
const NODES: [f64; 2] = [1000.0, 3000.0];
/// Scenes with growing cracks where laws, horizons and steps are varied: elsewhere they would say the same again.
const STUDIED: [&str; 4] = ["middle_tension", "single_edge", "slant_severance", "hole_entered"];
/// Scenes with growing cracks where solvers are varied.
const SOLVED: [&str; 2] = ["middle_tension", "slant_severance"];
/// Scenes where bonds that fail by their strain are run.
const FATIGUE_BONDS: [&str; 4] = STUDIED;
/// Bond laws beside the default one. The bond-based law has one Poisson's ratio.
const LAWS: [(&str, &[&str]); 4] = [
    ("bond_based", &["model.bond_law=bond_based", "material.poisson_ratio=0.3333333333"]),
    ("state_based", &["model.bond_law=state_based"]),
    ("one_bond_two_parameter", &["model.bond_law=one_bond_two_parameter"]),
    ("constant kernel", &["model.kernel=constant"]),
];
/// Solvers beside the default one.
const SOLVERS: [&str; 2] = ["multigrid", "direct"];

/// The choices of a scene, the default first.
pub fn choices(scene: &Scene) -> Result<Vec<Choice>> {
    let mut all = vec![choice(Family::TipField, "", &[], true)];
    let spacing = scene.case(&[])?.model.spacing / MM;
    all.extend(SPACINGS.map(|(share, is_quick)| {
        let spacing = (1e4 * share * spacing).round() / 1e4;
        choice(Family::TipField, &format!("spacing × {share}"), &[&format!("model.spacing_mm={spacing}")], is_quick)
    }));
    if !scene.grows() || STUDIED.contains(&scene.name) {
        all.extend(HORIZON_RATIOS.map(|ratio| {
            let set = format!("model.horizon_ratio={ratio}");
            choice(Family::TipField, &format!("horizon {ratio} spacings"), &[&set], false)
        }));
        all.extend(LAWS.map(|(words, set)| choice(Family::BondLaw, words, set, words == "state_based")));
    }
    if !scene.grows() || SOLVED.contains(&scene.name) {
        all.extend(SOLVERS.map(|solver| choice(Family::Solver, solver, &[&format!("model.solver={solver}")], false)));
    }
    if STUDIED.contains(&scene.name) {
        all.extend(STEP_ERRORS.map(|error| {
            let set = format!("fatigue.step_error_percent={error}");
            choice(Family::TipField, &format!("step to {error} %"), &[&set], false)
        }));
    }
    if scene.name == "hole_in_tension" {
        all.push(choice(Family::ElementFree, "", &[NODES_KEY], true));
    }
    if scene.has_crack() {
        all.push(choice(Family::ElementFree, "", &[NODES_KEY], true));
        all.extend(TOLERANCES.map(|(percent, is_quick)| {
            let set = format!("model.tolerance_percent={percent}");
            choice(Family::ElementFree, &format!("to {percent} %"), &[NODES_KEY, &set], is_quick)
        }));
        all.extend(NODES.map(|nodes| {
            let set = format!("model.nodes={nodes}");
            choice(Family::ElementFree, &format!("{nodes} nodes"), &[NODES_KEY, &set], false)
        }));
    }
    if scene.has_formula() {
        all.push(choice(Family::Handbook, "", &["model.method=handbook"], true));
    }
    if FATIGUE_BONDS.contains(&scene.name) {
        all.extend(fatigue_bonds(spacing));
    }
    Ok(all)
}

/// Bonds that fail by their strain.
fn fatigue_bonds(spacing: f64) -> Vec<Choice> {
    const DRIVER: &str = "fatigue.driver=bond_strain";
    let coarse = format!("model.spacing_mm={}", (2e4 * spacing).round() / 1e4);
    let mut all = Vec::new();
    for (family, rate) in [(Family::BondStrain, "stress_intensity"), (Family::Published, "bond_strain")] {
        let rate = format!("fatigue.growth_rate={rate}");
        all.push(choice(family, "", &[DRIVER, &rate], false));
        all.push(choice(family, "spacing × 2", &[DRIVER, &rate, &coarse], false));
    }
    all
}

/// The key of nodes.
const NODES_KEY: &str = "model.method=element_free_galerkin";

fn choice(family: Family, words: &str, set: &[&str], is_quick: bool) -> Choice {
    Choice { family, words: words.to_owned(), set: set.iter().map(|key| (*key).to_owned()).collect(), is_quick }
}

impl Choice {
    /// Its name in tables and in the chart.
    pub fn name(&self) -> String {
        if self.words.is_empty() { self.family.name().to_owned() } else { format!("{}, {}", self.family, self.words) }
    }

    /// Whether it is what runs when nothing is asked for.
    pub fn is_default(&self) -> bool {
        self.set.is_empty()
    }
}
