//! What a life depends on: Poisson's ratio, horizon, lengths of blocks, exponent, which bonds age.

use super::{Run, SWEEP, Sweep};
use crate::cases::{NODES, case, cracked_plate, middle_tension};
use crate::scene::{Scene, percent};
use crate::standard::MIDDLE_TENSION;
use perilife_base::error::{Error, Result};
use perilife_growth::predict::{StopReason, predict};

/// Error of the life of the panel grown between two lengths, mm, with points of 1 mm unless the keys say otherwise.
fn life(range: [f64; 2], keys: &str, run: &Run) -> Result<f64> {
    Scene::Life(MIDDLE_TENSION.from_to(range)).error(&format!("model.spacing_mm=1 {keys}"), run)
}

/// Keys of bonds by their own strain.
const BY_STRAIN: &str = "fatigue.driver=bond_strain";

/// Poisson's ratio in plane stress.
pub const PLANE_STRESS: Sweep = Sweep {
    name: "nu_plane_stress",
    about: "life of a middle tension panel, m 3, a/W 0.2 to 0.32, against quadrature; K for the plate on nodes",
    parameter: "Poisson's ratio, plane stress",
    values: &[0.05, 0.1, 0.2, 0.25, 0.3, 0.333, 0.36, 0.4, 0.45, 0.48, 0.49, 0.499],
    usual: 0.3,
    methods: &[
        ("law chosen by the program", |nu, run| by_ratio(nu, run, "plane=stress")),
        ("two_parameter", |nu, run| by_ratio(nu, run, "plane=stress model.bond_law=two_parameter")),
        ("state_based", |nu, run| by_ratio(nu, run, "plane=stress model.bond_law=state_based")),
        ("one_bond_two_parameter", |nu, run| by_ratio(nu, run, "plane=stress model.bond_law=one_bond_two_parameter")),
        ("element_free_galerkin", |nu, run| on_nodes(nu, run, "plane=stress")),
    ],
    ..SWEEP
};

/// Poisson's ratio in plane strain.
pub const PLANE_STRAIN: Sweep = Sweep {
    name: "nu_plane_strain",
    parameter: "Poisson's ratio, plane strain",
    values: &[0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.48, 0.49, 0.499],
    usual: 0.2,
    methods: &[
        ("law chosen by the program", |nu, run| by_ratio(nu, run, "plane=strain")),
        ("two_parameter", |nu, run| by_ratio(nu, run, "plane=strain model.bond_law=two_parameter")),
        ("state_based", |nu, run| by_ratio(nu, run, "plane=strain model.bond_law=state_based")),
        ("element_free_galerkin", |nu, run| on_nodes(nu, run, "plane=strain")),
    ],
    ..PLANE_STRESS
};

fn by_ratio(nu: f64, run: &Run, keys: &str) -> Result<f64> {
    life([20.0, 32.0], &format!("material.poisson_ratio={nu} material.{keys}"), run)
}

fn on_nodes(nu: f64, run: &Run, plane: &str) -> Result<f64> {
    let panel = Scene::Handbook(middle_tension(100.0, 20.0, ""));
    panel.error(&format!("material.poisson_ratio={nu} material.{plane} {NODES}"), run)
}

/// Horizon over spacing.
pub const HORIZON_RATIO: Sweep = Sweep {
    name: "horizon_ratio",
    about: "life of a middle tension panel, m 3, a/W 0.25 to 0.32, against quadrature; bonds by their own strain",
    parameter: "horizon over spacing",
    values: &[1.2, 1.5, 1.75, 2.015, 2.5, 3.015, 3.5, 4.015, 5.015, 6.015, 7.015, 8.015],
    usual: 3.015,
    methods: &[
        ("tip_field", |ratio, run| by_horizon(ratio, run, "")),
        ("bond_strain by its own strain", |ratio, run| by_horizon(ratio, run, BY_STRAIN)),
    ],
    ..SWEEP
};

fn by_horizon(ratio: f64, run: &Run, driver: &str) -> Result<f64> {
    life([25.0, 32.0], &format!("model.horizon_ratio={ratio} {driver}"), run)
}

/// Error of a block that is asked for.
pub const STEP_ERROR: Sweep = Sweep {
    name: "growth_step",
    about: "life of a middle tension panel, m 3, a/W 0.1 to 0.38, against quadrature",
    parameter: "fatigue.step_error_percent",
    unit: "%",
    values: &[0.01, 0.05, 0.2, 1.0, 3.0, 10.0],
    usual: 0.2,
    bound_percent: 1.0,
    methods: &[("tip_field", |error, run| life(MIDDLE_TENSION.range, &format!("fatigue.step_error_percent={error}"), run))],
    ..SWEEP
};

/// The same until a slant crack severs its plate.
pub const SEVERING_STEP: Sweep = Sweep {
    name: "severing_step",
    about: "life of a plate with a slant crack until it is in two, against blocks on nodes without elements (0.5 %)",
    bound_percent: 2.0,
    methods: &[("tip_field", until_severed)],
    ..STEP_ERROR
};

fn until_severed(step_error: f64, run: &Run) -> Result<f64> {
    let text = cracked_plate(40.0, 56.0, &[[[-6.0, -4.0], [6.0, 4.0]]]);
    let life = |keys: &str| -> Result<f64> {
        let done = predict(&case(&text, keys)?, run)?;
        match done.stop {
            StopReason::Severed | StopReason::LeftPlate => Ok(done.life_cycles()),
            other => Err(Error::Mechanics(format!("the run ended before the plate was in two: {other}"))),
        }
    };
    let exact = life(&format!("{NODES} model.tolerance_percent=0.5"))?;
    Ok(percent(life(&format!("model.spacing_mm=1 fatigue.step_error_percent={step_error}"))?, exact))
}

/// Exponent of the growth law.
pub const EXPONENT: Sweep = Sweep {
    name: "exponent",
    about: "life of a middle tension panel, a/W 0.2 to 0.26, against quadrature",
    parameter: "exponent p = m",
    values: &[1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0],
    usual: 3.0,
    methods: &[
        ("tip_field", |m, run| by_exponent(m, run, "")),
        ("bond_strain by its own strain", |m, run| by_exponent(m, run, BY_STRAIN)),
    ],
    ..SWEEP
};

/// A short way of the panel, for bonds that are solved for one by one.
fn by_exponent(m: f64, run: &Run, keys: &str) -> Result<f64> {
    life([20.0, 26.0], &format!("fatigue.paris_m={m} {keys}"), run)
}

/// Which bonds age.
pub const AGEING: Sweep = Sweep {
    name: "ageing",
    about: "bonds by their own strain, all of them or those at the tips: life of a middle tension panel, a/W 0.2 to 0.26, against quadrature",
    bound_percent: 10.0,
    methods: &[
        ("bond_strain, ageing crack_tip", |m, run| by_ageing(m, run, "crack_tip")),
        ("bond_strain, ageing everywhere", |m, run| by_ageing(m, run, "everywhere")),
    ],
    ..EXPONENT
};

fn by_ageing(m: f64, run: &Run, ageing: &str) -> Result<f64> {
    by_exponent(m, run, &format!("model.spacing_mm=2 fatigue.ageing={ageing} {BY_STRAIN}"))
}
