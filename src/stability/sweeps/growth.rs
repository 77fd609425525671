//! Where a crack turns, and what the stress along it does.

use std::f64::consts::PI;

use super::super::exact::{factors, percent, tips};
use super::super::{Method, Run, Sweep};
use crate::case::Case;
use crate::error::{Error, Result};
use crate::growth::tip_field::steering::kink_angle;
use crate::units::MM;
use crate::verify::scene::pulled_plate;

/// Mode mixity of a first kink.
pub const KINK_MIXITY: Sweep = Sweep {
    name: "kink_mixity",
    about: "first kink of a slant crack of 48 mm in a wide plate against the largest circumferential stress (Erdogan and Sih 1963), \
            in percent of the kink in pure mode II, 70.5 degrees",
    parameter: "mixity atan(K_II / K_I)",
    unit: "degrees",
    values: &[0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 75.0, 80.0, 85.0, 88.0, 90.0],
    usual: 0.0,
    is_continuous: true,
    bound_percent: 2.0,
    methods: &[
        Method { name: "tip_field", measure: |mixity, run| kink(mixity, &slanted(mixity, run, "model.spacing_mm=2")?) },
        Method {
            name: "element_free_galerkin",
            measure: |mixity, run| kink(mixity, &slanted(mixity, run, "model.method=element_free_galerkin")?),
        },
    ],
};

/// A crack whose normal makes this angle with the load: K_II / K_I is its tangent.
fn slanted(mixity: f64, run: &Run, key: &str) -> Result<Case> {
    let (sin, cos) = mixity.to_radians().sin_cos();
    let [x, y] = [24.0 * cos, 24.0 * sin];
    let crack = format!("cracks = [{{ from_mm = [{}, {}], to_mm = [{x}, {y}] }}]", -x, -y);
    run.case(&pulled_plate(&format!("width_mm = 400\nlength_mm = 400\n{crack}")), &[key])
}

fn kink(mixity: f64, case: &Case) -> Result<f64> {
    let found = factors(case, 1)?;
    if found[0].hypot(found[1]) < 1e-3 * case.loading.maximum * (PI * 24.0 * MM).sqrt() {
        return Err(Error::Mechanics("the load does not open or shear the crack".to_owned()));
    }
    let (sin, cos) = mixity.to_radians().sin_cos();
    // The upper face of a crack that rises to the right is pulled to the right: K_II > 0 at the right tip.
    let theory = kink_angle([cos * cos, sin * cos]);
    let whole = kink_angle([0.0, 1.0]).abs();
    Ok(100.0 * (kink_angle(found) - theory) / whole)
}

/// Stress along the crack.
pub const BIAXIALITY: Sweep = Sweep {
    name: "biaxiality",
    about: "K_I against that without stress along the crack, and T against T at 0 plus that stress; square plate, 2a/W 0.2",
    parameter: "stress along the crack over stress across it",
    unit: "",
    values: &[-4.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 3.0, 4.0],
    usual: 0.0,
    is_continuous: true,
    bound_percent: 1.0,
    methods: &[
        Method { name: "tip_field: K_I", measure: |ratio, run| biaxial(ratio, run, false) },
        Method { name: "tip_field: T", measure: |ratio, run| biaxial(ratio, run, true) },
    ],
};

fn biaxial(ratio: f64, run: &Run, is_t: bool) -> Result<f64> {
    let text = pulled_plate("width_mm = 150\nlength_mm = 150\ncracks = [{ from_mm = [-15, 0], to_mm = [15, 0] }]");
    let at = |ratio: f64| -> Result<[f64; 2]> {
        let case = run.case(&text, &["model.spacing_mm=1", &format!("loading.stress_parallel_ratio={ratio}")])?;
        let tip = tips(&case)?[0];
        let k = tip.factors.map_or(f64::NAN, |factors| factors[0]);
        Ok([k, tip.t_stress.unwrap_or(f64::NAN) / case.loading.maximum])
    };
    let [[k, t], [k_alone, t_alone]] = [at(ratio)?, at(0.0)?];
    // T is of the size of the stress across the crack.
    Ok(if is_t { 100.0 * (t - t_alone - ratio) } else { percent(k, k_alone) })
}
