//! What is measured in a scene: every method with its resolutions, laws, solvers and steps.

use serde::Deserialize;
use toml::Table;

use super::{Panel, READ};
use crate::cases::overrides;
use crate::values::Values;
use perilife_base::error::Result;
use perilife_base::units::MM;

#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    pub family: Family,
    /// What tells it from the default of its family, in words; empty for that default.
    pub words: String,
    pub set: Vec<String>,
    pub is_quick: bool,
}

perilife_base::kinds! {
    /// Families of methods: a colour of the chart each.
    pub enum Family for "method of the chart" {
        Auto = "auto": "default (automatic choice)",
        TipField = "tip_field": "points and bonds, growth driven by K",
        ElementFree = "element_free_galerkin": "element-free Galerkin nodes, growth driven by K",
        Handbook = "handbook": "handbook K, life by quadrature",
        BondStrain = "bond_strain": "bond_strain (published bond law)",
        BondLaw = "bond_law": "another bond law, kernel or correction than the default",
        Solver = "solver": "another solver than the default",
    }
}

/// A choice that the file offers to scenes with a tag, or to all.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Offer {
    family: Family,
    #[serde(default)]
    words: String,
    /// Keys, with formulas of the default `spacing_mm` of the scene.
    #[serde(default)]
    keys: String,
    #[serde(default)]
    quick: bool,
    tag: Option<String>,
}

/// The choices of a scene, the default first.
pub fn choices(panel: &Panel) -> Result<Vec<Choice>> {
    let spacing_mm = panel.case(&[])?.points().spacing / MM;
    let values = Table::from_iter([("spacing_mm".to_owned(), spacing_mm.into())]);
    let offered = READ.1.iter().filter(|offer| offer.tag.as_ref().is_none_or(|tag| panel.is(tag)));
    let choice = |offer: &Offer| {
        let set = overrides(&Values::alone(&values).text(&offer.keys)?);
        Ok(Choice { family: offer.family, words: offer.words.clone(), set, is_quick: offer.quick })
    };
    offered.map(choice).collect()
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
