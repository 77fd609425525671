//! What a life depends on that is no plate: lengths of blocks, exponent, which bonds age.

use super::super::exact::{life_error, percent};
use super::super::{Method, Run, Sweep};
use crate::error::{Error, Result};
use crate::predict::StopReason;
use crate::verify::scene::pulled_plate;
use crate::verify::standard::{Standard, standard_specimens};

/// Error of a block that is asked for.
pub const STEP_ERROR: Sweep = Sweep {
    name: "growth_step",
    about: "life of a middle tension panel, m 3, a/W 0.1 to 0.38, against quadrature",
    parameter: "fatigue.step_error_percent",
    unit: "%",
    values: &[0.01, 0.05, 0.2, 1.0, 3.0, 10.0],
    usual: 0.2,
    is_continuous: true,
    bound_percent: 1.0,
    methods: &[Method { name: "tip_field", measure: by_step_error }],
};

fn by_step_error(percent: f64, run: &Run) -> Result<f64> {
    let [panel, ..] = standard_specimens();
    life_error(run, &panel, &[&format!("fatigue.step_error_percent={percent}"), "model.spacing_mm=1"])
}

/// The same until a slant crack severs its plate.
pub const SEVERING_STEP: Sweep = Sweep {
    name: "severing_step",
    about: "life of a plate with a slant crack until it is in two, against blocks on nodes without elements (0.5 %)",
    bound_percent: 2.0,
    methods: &[Method { name: "tip_field", measure: until_severed }],
    ..STEP_ERROR
};

fn until_severed(step_error: f64, run: &Run) -> Result<f64> {
    let text = pulled_plate("width_mm = 40\nlength_mm = 56\ncracks = [{ from_mm = [-6, -4], to_mm = [6, 4] }]");
    let life = |keys: &[&str]| -> Result<f64> {
        let done = run.predict(&run.case(&text, keys)?)?;
        match done.stop {
            StopReason::Severed | StopReason::LeftPlate => Ok(done.life_cycles()),
            other => Err(Error::Mechanics(format!("the run ended before the plate was in two: {other}"))),
        }
    };
    let exact = life(&["model.method=element_free_galerkin", "model.tolerance_percent=1"])?;
    Ok(percent(life(&["model.spacing_mm=1", &format!("fatigue.step_error_percent={step_error}")])?, exact))
}

/// Exponent of the growth law.
pub const EXPONENT: Sweep = Sweep {
    name: "exponent",
    about: "life of a middle tension panel, a/W 0.2 to 0.26, against quadrature",
    parameter: "exponent p = m",
    unit: "",
    values: &[1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0],
    usual: 3.0,
    is_continuous: true,
    bound_percent: 2.0,
    methods: &[
        Method { name: "tip_field", measure: |m, run| by_exponent(m, run, &[]) },
        Method { name: "bond_strain at the rate of K", measure: |m, run| by_exponent(m, run, &["fatigue.driver=bond_strain"]) },
        Method {
            name: "bond_strain by its own strain",
            measure: |m, run| by_exponent(m, run, &["fatigue.driver=bond_strain", "fatigue.growth_rate=bond_strain"]),
        },
    ],
};

/// A short way of the panel, for bonds that are solved for one by one.
fn short_panel() -> Standard {
    let [panel, ..] = standard_specimens();
    panel.from_to([20.0, 26.0])
}

fn by_exponent(m: f64, run: &Run, driver: &[&str]) -> Result<f64> {
    let key = format!("fatigue.paris_m={m}");
    life_error(run, &short_panel(), &[&[&*key, "model.spacing_mm=1"], driver].concat())
}

fn by_ageing(m: f64, run: &Run, ageing: &str) -> Result<f64> {
    let key = format!("fatigue.paris_m={m}");
    let by_strain = ["fatigue.driver=bond_strain", "fatigue.growth_rate=bond_strain"];
    life_error(run, &short_panel(), &[&[&*key, "model.spacing_mm=2", ageing], &by_strain[..]].concat())
}

/// Which bonds age.
pub const AGEING: Sweep = Sweep {
    name: "ageing",
    about: "bonds by their own strain, all of them or those at the tips: life of a middle tension panel, a/W 0.2 to 0.26, against quadrature",
    bound_percent: 10.0,
    methods: &[
        Method { name: "bond_strain, ageing crack_tip", measure: |m, run| by_ageing(m, run, "fatigue.ageing=crack_tip") },
        Method { name: "bond_strain, ageing everywhere", measure: |m, run| by_ageing(m, run, "fatigue.ageing=everywhere") },
    ],
    ..EXPONENT
};
