//! Poisson's ratio.

use super::super::exact::{against_handbook, life_error, middle_tension};
use super::super::{Method, Run, Sweep};
use crate::error::Result;
use crate::verify::standard::standard_specimens;

/// Poisson's ratio in plane stress.
pub const PLANE_STRESS: Sweep = Sweep {
    name: "nu_plane_stress",
    about: "life of a middle tension panel, m 3, a/W 0.2 to 0.32, against quadrature; K for the plate on nodes",
    parameter: "Poisson's ratio, plane stress",
    unit: "",
    values: &[0.05, 0.1, 0.2, 0.25, 0.3, 0.333, 0.36, 0.4, 0.45, 0.48, 0.49, 0.499],
    usual: 0.3,
    is_continuous: true,
    bound_percent: 2.0,
    methods: &[
        Method { name: "law chosen by the program", measure: |nu, run| life(nu, run, "stress", &[]) },
        Method { name: "two_parameter", measure: |nu, run| life(nu, run, "stress", &["model.bond_law=two_parameter"]) },
        Method { name: "state_based", measure: |nu, run| life(nu, run, "stress", &["model.bond_law=state_based"]) },
        Method {
            name: "one_bond_two_parameter",
            measure: |nu, run| life(nu, run, "stress", &["model.bond_law=one_bond_two_parameter"]),
        },
        Method { name: "element_free_galerkin", measure: |nu, run| on_nodes(nu, run, "stress") },
    ],
};

/// Poisson's ratio in plane strain.
pub const PLANE_STRAIN: Sweep = Sweep {
    name: "nu_plane_strain",
    parameter: "Poisson's ratio, plane strain",
    values: &[0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.48, 0.49, 0.499],
    usual: 0.2,
    methods: &[
        Method { name: "law chosen by the program", measure: |nu, run| life(nu, run, "strain", &[]) },
        Method { name: "two_parameter", measure: |nu, run| life(nu, run, "strain", &["model.bond_law=two_parameter"]) },
        Method { name: "state_based", measure: |nu, run| life(nu, run, "strain", &["model.bond_law=state_based"]) },
        Method { name: "element_free_galerkin", measure: |nu, run| on_nodes(nu, run, "strain") },
    ],
    ..PLANE_STRESS
};

fn keys(nu: f64, plane: &str) -> [String; 2] {
    [format!("material.poisson_ratio={nu}"), format!("material.plane={plane}")]
}

fn life(nu: f64, run: &Run, plane: &str, law: &[&str]) -> Result<f64> {
    let [panel, ..] = standard_specimens();
    let keys = keys(nu, plane);
    let set = [&[&*keys[0], &*keys[1], "model.spacing_mm=1"], law].concat();
    life_error(run, &panel.from_to([20.0, 32.0]), &set)
}

fn on_nodes(nu: f64, run: &Run, plane: &str) -> Result<f64> {
    let keys = keys(nu, plane);
    // A spacing of points would be one of nodes.
    let text = middle_tension(100.0, 20.0, 1.0).replace("[model]\nspacing_mm = 1\n", "");
    against_handbook(&run.case(&text, &[&keys[0], &keys[1], "model.method=element_free_galerkin"])?)
}
