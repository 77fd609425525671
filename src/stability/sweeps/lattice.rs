//! The lattice: neighbours of a point, rows against the crack, where a hole lies on it, the size of the plate.

use super::super::exact::{against_handbook, against_nodes, life_error, middle_tension};
use super::super::{Method, Run, Sweep};
use crate::error::Result;
use crate::verify::scene::pulled_plate;
use crate::verify::standard::standard_specimens;

/// Horizon over spacing.
pub const HORIZON_RATIO: Sweep = Sweep {
    name: "horizon_ratio",
    about: "life of a middle tension panel, m 3, a/W 0.25 to 0.32, against quadrature; bonds at the rate of K and by their own strain",
    parameter: "horizon over spacing",
    unit: "",
    values: &[1.2, 1.5, 1.75, 2.015, 2.5, 3.015, 3.5, 4.015, 5.015, 6.015, 7.015, 8.015],
    usual: 3.015,
    is_continuous: true,
    bound_percent: 2.0,
    methods: &[
        Method { name: "tip_field", measure: |ratio, run| life(ratio, run, &[]) },
        Method { name: "bond_strain at the rate of K", measure: |ratio, run| life(ratio, run, &["fatigue.driver=bond_strain"]) },
        Method {
            name: "bond_strain by its own strain",
            measure: |ratio, run| life(ratio, run, &["fatigue.driver=bond_strain", "fatigue.growth_rate=bond_strain"]),
        },
    ],
};

fn life(ratio: f64, run: &Run, driver: &[&str]) -> Result<f64> {
    let [panel, ..] = standard_specimens();
    let key = format!("model.horizon_ratio={ratio}");
    life_error(run, &panel.from_to([25.0, 32.0]), &[&[&*key, "model.spacing_mm=1"], driver].concat())
}

/// Angle of the rows against the crack.
pub const LATTICE_ANGLE: Sweep = Sweep {
    name: "lattice_angle",
    about: "K_I of a middle tension panel, 2a/W 0.4, against the handbook (Tada, 0.1 %)",
    parameter: "angle of the crack to the rows",
    unit: "degrees",
    values: &[0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0, 90.0],
    usual: 0.0,
    is_continuous: true,
    bound_percent: 1.0,
    methods: &[Method { name: "tip_field", measure: turned }],
};

fn turned(angle: f64, run: &Run) -> Result<f64> {
    let key = format!("model.lattice_angle_deg={angle}");
    against_handbook(&run.case(&middle_tension(100.0, 20.0, 1.0), &[&key])?)
}

/// Where a hole with a crack lies between the points.
pub const HOLE_OFFSET: Sweep = Sweep {
    name: "hole_offset",
    about: "K_I of a crack of 6 mm that starts at a hole of 12 mm, at 20 places of the hole within a spacing, against the plate on nodes",
    parameter: "number of the place",
    unit: "",
    values: &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0, 16.0, 17.0, 18.0, 19.0, 20.0],
    usual: 1.0,
    is_continuous: false,
    bound_percent: 2.0,
    methods: &[Method { name: "tip_field", measure: offset_hole }],
};

fn offset_hole(number: f64, run: &Run) -> Result<f64> {
    // Places that fill a square evenly, whatever their number: the generalised golden ratio (Roberts 2018).
    const PLASTIC: f64 = 1.324_717_957_244_746;
    let [x, y] = [PLASTIC, PLASTIC * PLASTIC].map(|root| (number / root).fract());
    let text = pulled_plate(&format!(
        "width_mm = 60\nlength_mm = 90\nholes = [{{ x_mm = {x}, y_mm = {y}, diameter_mm = 12 }}]\n\
         cracks = [{{ from_mm = [{}, {y}], to_mm = [{}, {y}] }}]",
        x + 6.0,
        x + 12.0
    ));
    against_nodes(run, &text, &["model.spacing_mm=1"], 0)
}

/// Width of the plate: no method may know a unit of length.
pub const PLATE_SIZE: Sweep = Sweep {
    name: "plate_size",
    about: "K_I of a middle tension panel of 50 spacings, 2a/W 0.4, against the handbook (Tada, 0.1 %)",
    parameter: "width of the plate",
    unit: "mm",
    values: &[0.1, 1.0, 10.0, 100.0, 1e3, 1e4],
    usual: 100.0,
    is_continuous: true,
    bound_percent: 2.0,
    methods: &[
        Method { name: "tip_field", measure: |width, run| sized(width, run, &[]) },
        Method { name: "element_free_galerkin", measure: sized_nodes },
    ],
};

fn sized(width: f64, run: &Run, set: &[&str]) -> Result<f64> {
    against_handbook(&run.case(&middle_tension(width, 0.2 * width, 0.02 * width), set)?)
}

fn sized_nodes(width: f64, run: &Run) -> Result<f64> {
    let spacing = format!("model.spacing_mm={}", width / 14.0);
    sized(width, run, &[&spacing, "model.method=element_free_galerkin"])
}
