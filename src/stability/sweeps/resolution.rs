//! The horizon against what it has to resolve: crack, ligament, hole, another crack.
//!
//! The spacing is 1 mm, and the plate grows with what is resolved, so that its share of the error stays the same. Where a tip lies between
//! points is luck: every error is the worst of three places within a spacing.

use super::super::exact::{against_handbook, against_nodes, factors, middle_tension, percent};
use super::super::{Method, Run, Sweep};
use crate::case::HORIZON_RATIO;
use crate::error::Result;
use crate::units::MM;
use crate::verify::collinear::Collinear;
use crate::verify::scene::pulled_plate;

const RATIOS: &[f64] = &[0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0, 1.25, 1.6, 2.0];
/// Error of K that a life of m = 3 multiplies by three.
const BOUND: f64 = 2.0;

/// Shares of a spacing by which plates are wider, or cracks shifted.
const PLACES: [f64; 3] = [0.0, 0.35, 0.7];

/// The largest of the errors at all places.
fn worst(error: impl Fn(f64) -> Result<f64>) -> Result<f64> {
    PLACES.into_iter().try_fold(0.0_f64, |worst, place| {
        let error = error(place)?;
        // No number stays none.
        Ok(if error.abs() <= worst.abs() { worst } else { error })
    })
}

/// Horizon over half the length of a crack with two tips.
pub const CRACK_LENGTH: Sweep = Sweep {
    name: "crack_length",
    about: "K_I of a crack with two tips in a panel of 2a/W 0.25 against the handbook (Tada, 0.1 %)",
    parameter: "horizon over half the crack length",
    unit: "",
    values: RATIOS,
    usual: 0.3,
    is_continuous: true,
    bound_percent: BOUND,
    methods: &[Method { name: "tip_field", measure: half_crack }],
};

fn half_crack(ratio: f64, run: &Run) -> Result<f64> {
    let half = HORIZON_RATIO / ratio;
    worst(|place| against_handbook(&run.case(&middle_tension(8.0 * half + place, half, 1.0), &[])?))
}

/// Horizon over the length of an edge crack.
pub const EDGE_CRACK_LENGTH: Sweep = Sweep {
    name: "edge_crack_length",
    about: "K_I of an edge crack of a/W 0.17 against the plate on nodes",
    parameter: "horizon over the crack length",
    methods: &[Method { name: "tip_field", measure: edge_crack }],
    ..CRACK_LENGTH
};

fn edge_crack(ratio: f64, run: &Run) -> Result<f64> {
    let length = HORIZON_RATIO / ratio;
    worst(|place| {
        let width = 6.0 * length + place;
        let text = pulled_plate(&format!(
            "width_mm = {width}\nlength_mm = {}\ncracks = [{{ from_mm = [{}, 0], to_mm = [{}, 0] }}]",
            1.5 * width,
            -0.5 * width,
            length - 0.5 * width
        ));
        against_nodes(run, &text, &["model.spacing_mm=1"], 0)
    })
}

/// Horizon over the ligament between a tip and the edge.
pub const LIGAMENT: Sweep = Sweep {
    name: "ligament",
    about: "K_I of a panel of 2a/W 0.75 against the handbook (Tada, 0.1 %)",
    parameter: "horizon over the ligament",
    methods: &[Method { name: "tip_field", measure: ligament }],
    ..CRACK_LENGTH
};

fn ligament(ratio: f64, run: &Run) -> Result<f64> {
    let left = HORIZON_RATIO / ratio;
    worst(|place| {
        let width = 8.0 * left + place;
        against_handbook(&run.case(&middle_tension(width, 0.5 * width - left, 1.0), &[])?)
    })
}

/// Horizon over the distance of a tip from the rim of a hole ahead of it.
pub const HOLE_DISTANCE: Sweep = Sweep {
    name: "hole_distance",
    about: "K_I of an edge crack of 20 mm before a hole of 16 mm, against the plate on nodes",
    parameter: "horizon over the distance to a hole",
    methods: &[Method { name: "tip_field", measure: before_hole }],
    ..CRACK_LENGTH
};

fn before_hole(ratio: f64, run: &Run) -> Result<f64> {
    worst(|place| {
        let tip = place - 20.0;
        let text = pulled_plate(&format!(
            "width_mm = 80\nlength_mm = 120\nholes = [{{ x_mm = {}, y_mm = 0, diameter_mm = 16 }}]\n\
             cracks = [{{ from_mm = [-40, 0], to_mm = [{tip}, 0] }}]",
            tip + HORIZON_RATIO / ratio + 8.0
        ));
        against_nodes(run, &text, &["model.spacing_mm=1"], 0)
    })
}

/// Horizon over the diameter of a hole.
pub const HOLE_DIAMETER: Sweep = Sweep {
    name: "hole_diameter",
    about: "K_I of a crack whose tip lies half a diameter above the rim of a hole, against the plate on nodes",
    parameter: "horizon over the diameter of a hole",
    methods: &[Method { name: "tip_field", measure: beside_hole }],
    ..CRACK_LENGTH
};

fn beside_hole(ratio: f64, run: &Run) -> Result<f64> {
    // Hole, crack and plate in one proportion.
    let diameter = HORIZON_RATIO / ratio;
    worst(|place| {
        let x = diameter + place;
        let text = pulled_plate(&format!(
            "width_mm = {}\nlength_mm = {}\nholes = [{{ x_mm = {x}, y_mm = {}, diameter_mm = {diameter} }}]\n\
             cracks = [{{ from_mm = [{}, 0], to_mm = [{x}, 0] }}]",
            8.0 * diameter,
            10.0 * diameter,
            -diameter,
            -diameter,
        ));
        against_nodes(run, &text, &["model.spacing_mm=1"], 1)
    })
}

/// Horizon over the distance between the tips of two cracks on one line.
pub const CRACK_DISTANCE: Sweep = Sweep {
    name: "crack_distance",
    about: "K_I of the inner tips of two collinear cracks of 24 mm against the closed form (Tada, 0.3 % with the width)",
    parameter: "horizon over the distance to another crack",
    methods: &[Method { name: "tip_field", measure: collinear }],
    ..CRACK_LENGTH
};

fn collinear(ratio: f64, run: &Run) -> Result<f64> {
    let inner = 0.5 * HORIZON_RATIO / ratio;
    let outer = inner + 24.0;
    let width = 8.0 * outer;
    let pair = Collinear { inner: inner * MM, outer: outer * MM };
    worst(|place| {
        let [a, b, c, d] = [-outer, -inner, inner, outer].map(|x| x + place);
        let text = pulled_plate(&format!(
            "width_mm = {width}\nlength_mm = {}\n\
             cracks = [{{ from_mm = [{a}, 0], to_mm = [{b}, 0] }}, {{ from_mm = [{c}, 0], to_mm = [{d}, 0] }}]",
            1.5 * width
        ));
        let case = run.case(&text, &["model.spacing_mm=1"])?;
        let exact = case.loading.maximum * pair.intensity_in(width * MM)[0];
        Ok(percent(factors(&case, 1)?[0], exact))
    })
}
