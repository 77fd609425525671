//! What is measured in a scene: every method with its resolutions, laws, solvers and steps.

use super::Panel;
use crate::cases::{AUTO, NODES, POINTS, overrides};
use perilife_base::error::Result;
use perilife_base::units::MM;

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

perilife_base::kinds! {
    /// Families of methods: a colour of the chart each.
    pub enum Family for "method of the chart" {
        Auto = "auto": "what the program chooses for the scene: the default",
        TipField = "tip_field": "points and bonds, cracks driven by the K of their tips",
        ElementFree = "element_free_galerkin": "nodes without elements, cracks driven by the K of their tips",
        Handbook = "handbook": "quadrature of the growth law with K of a handbook",
        BondStrain = "bond_strain": "bonds that fail by their own strain: the published law",
        BondLaw = "bond_law": "another bond law, kernel or correction than the default",
        Solver = "solver": "another solver than the default",
    }
}

/// Scenes with growing cracks where laws, horizons, steps and bonds that fail by their strain are varied: elsewhere they would say the
/// same again.
const STUDIED: [&str; 4] = ["middle_tension", "single_edge", "slant_severance", "hole_entered"];
/// Scenes with growing cracks where solvers are varied.
const SOLVED: [&str; 2] = ["middle_tension", "slant_severance"];
/// Bond laws beside the default one. The bond-based law has one Poisson's ratio.
const LAWS: [(&str, &str); 4] = [
    ("bond_based", "model.bond_law=bond_based material.poisson_ratio=0.3333333333"),
    ("state_based", "model.bond_law=state_based"),
    ("one_bond_two_parameter", "model.bond_law=one_bond_two_parameter"),
    ("constant kernel", "model.kernel=constant"),
];

/// The choices of a scene, the default first.
pub fn choices(panel: &Panel) -> Result<Vec<Choice>> {
    use Family::{Auto, BondLaw, BondStrain, ElementFree, Handbook, Solver, TipField};
    let mut all = Vec::new();
    let mut add = |family: Family, words: String, keys: &str, is_quick: bool| {
        all.push(Choice { family, words, set: overrides(keys), is_quick });
    };
    let scene = &panel.scene;
    let is_among = |names: &[&str]| names.contains(&panel.name);
    let spacing = scene.case(&[])?.points().spacing / MM;
    let spaced = |times: f64| format!("model.spacing_mm={}", (1e4 * times * spacing).round() / 1e4);
    if scene.grows() {
        add(Auto, String::new(), AUTO, true);
        for percent in [5.0, 1.0, 0.5] {
            add(Auto, format!("to {percent} %"), &format!("{AUTO} model.tolerance_percent={percent}"), true);
        }
    }
    add(TipField, String::new(), if scene.grows() { POINTS } else { "" }, true);
    for (times, is_quick) in [(2.0, true), (1.5, true), (0.75, false), (0.5, false)] {
        add(TipField, format!("spacing × {times}"), &spaced(times), is_quick);
    }
    if !scene.grows() || is_among(&STUDIED) {
        for ratio in [2.015, 4.015] {
            add(TipField, format!("horizon {ratio} spacings"), &format!("model.horizon_ratio={ratio}"), false);
        }
        for (words, keys) in LAWS {
            add(BondLaw, words.to_owned(), keys, words == "state_based");
        }
    }
    if !scene.grows() || is_among(&SOLVED) {
        for solver in ["multigrid", "direct"] {
            add(Solver, solver.to_owned(), &format!("model.solver={solver}"), false);
        }
    }
    if is_among(&STUDIED) {
        for error in [2.0, 0.05] {
            add(TipField, format!("step to {error} %"), &format!("fatigue.step_error_percent={error}"), false);
        }
    }
    if scene.has_crack() || panel.name == "hole_in_tension" {
        add(ElementFree, String::new(), NODES, true);
    }
    if scene.has_crack() {
        for percent in [10.0, 1.0] {
            add(ElementFree, format!("to {percent} %"), &format!("{NODES} model.tolerance_percent={percent}"), true);
        }
        for nodes in [1000.0, 3000.0] {
            add(ElementFree, format!("{nodes} nodes"), &format!("{NODES} model.nodes={nodes}"), false);
        }
    }
    if scene.has_formula() {
        add(Handbook, String::new(), "model.method=handbook", true);
    }
    if is_among(&STUDIED) {
        const KEYS: &str = "fatigue.driver=bond_strain";
        add(BondStrain, String::new(), KEYS, false);
        add(BondStrain, "spacing × 2".to_owned(), &format!("{KEYS} {}", spaced(2.0)), false);
    }
    Ok(all)
}

impl Choice {
    /// Its name in tables and in the chart.
    pub fn name(&self) -> String {
        if self.words.is_empty() { self.family.name().to_owned() } else { format!("{}, {}", self.family, self.words) }
    }

    /// Whether it is what runs when nothing is asked for.
    pub fn is_default(&self) -> bool {
        self.words.is_empty() && (self.family == Family::Auto || self.set.is_empty())
    }
}
