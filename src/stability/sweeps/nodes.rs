//! Nodes of the element-free Galerkin method.

use super::super::exact::{against_handbook, middle_tension};
use super::super::{Method, Run, Sweep};
use crate::case::Case;
use crate::error::Result;

/// Radius of influence.
pub const INFLUENCE_RADIUS: Sweep = Sweep {
    name: "influence_radius",
    about: "K_I of a middle tension panel, 2a/W 0.4, against the handbook (Tada, 0.1 %)",
    parameter: "radius of influence over the spacing of nodes",
    unit: "",
    values: &[1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0],
    usual: 2.5,
    is_continuous: true,
    bound_percent: 1.0,
    methods: &[
        Method { name: "element_free_galerkin, linear basis", measure: |radius, run| by_radius(radius, run, "linear") },
        Method { name: "element_free_galerkin, quadratic basis", measure: |radius, run| by_radius(radius, run, "quadratic") },
    ],
};

fn panel(run: &Run, set: &[&str]) -> Result<Case> {
    let text = middle_tension(100.0, 20.0, 1.0).replace("[model]\nspacing_mm = 1\n", "");
    run.case(&text, &[&["model.method=element_free_galerkin"], set].concat())
}

fn by_radius(radius: f64, run: &Run, basis: &str) -> Result<f64> {
    let mut case = panel(run, &[&format!("model.basis={basis}")])?;
    // The key begins at 1.5.
    case.model.element_free.resolution.support = radius;
    against_handbook(&case)
}

/// Where the crack lies between nodes.
pub const NODE_OFFSET: Sweep = Sweep {
    name: "node_offset",
    about: "K_I of a crack in the middle of a panel, 2a/W 0.4, moved along the load between rows of nodes, against the handbook (Tada, 0.1 %)",
    parameter: "distance of the crack from the middle over the spacing of nodes",
    values: &[0.0, 1e-9, 1e-6, 1e-3, 0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.99],
    usual: 0.0,
    methods: &[Method { name: "element_free_galerkin", measure: moved }],
    ..INFLUENCE_RADIUS
};

fn moved(share: f64, run: &Run) -> Result<f64> {
    let mut case = panel(run, &[])?;
    let by = share * case.model.element_free.resolution.far;
    for crack in &mut case.specimen.cracks {
        crack.from[1] += by;
        crack.to[1] += by;
    }
    case.specimen.tips.iter_mut().for_each(|tip| tip.position[1] += by);
    case.specimen.crack_plane_y = None;
    against_handbook(&case)
}
