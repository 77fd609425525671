//! What a plate of points and bonds shows: its fields, and what a rigid turn of it costs.

use super::Fields;
use perilife_points::body::lattice::LANES;
use perilife_points::body::{Body, Bond};
use perilife_points::net::Net;
use perilife_points::net::rigid::{RESISTED, turning_cost_of_springs, turning_warning};
use perilife_points::solver::field::Layout;
use perilife_points::state::Bonds;

/// Energy of a rigid turn over that of an extension, of the springs of a plate.
pub fn turning_cost(body: &Body) -> Option<f64> {
    turning_cost_of_springs(&Net::of_body(body))
}

/// What the user should know of a plate that a turn costs energy.
pub fn warning(body: &Body) -> Option<String> {
    body.stencil.resists_rotation().then(|| turning_warning(turning_cost(body), RESISTED)).flatten()
}

/// Displacement (x, y) in plate axes, m, damage and remaining life of the points of a body, from a displacement in its [`Layout`].
pub(super) fn fields(body: &Body, bonds: &Bonds, displacement: &[f64], lives: &[(Bond, f64)]) -> Fields {
    let layout = Layout::of(&body.lattice, body.stencil.unknowns);
    let places = body.places();
    let damage = |place: usize| {
        let (column, row) = body.lattice.column_row(place);
        if bonds.chunk_is_regular(row, column / LANES) {
            return 0.0;
        }
        let [mut whole, mut intact] = [0_u32; 2];
        for (k, &step) in body.steps.iter().enumerate() {
            for owner in [place, place.wrapping_add_signed(-step)] {
                let bond = k * places + owner;
                whole += u32::from(body.multiplier[bond] > 0.0);
                intact += u32::from(bonds.multiplier[bond] > 0.0);
            }
        }
        if whole == 0 { 1.0 } else { 1.0 - f64::from(intact) / f64::from(whole) }
    };
    let motion = |place: usize| {
        let at = layout.index(place);
        body.lattice.from_axes([displacement[at], displacement[at + layout.stride]])
    };
    let points = || body.points.iter().map(|&place| place as usize);
    let least = least_lives(body, bonds, lives);
    Fields {
        displacement: points().map(motion).collect(),
        damage: points().map(damage).collect(),
        remaining_life: points().map(|place| least[place]).collect(),
        stress: Vec::new(),
    }
}

/// Least remaining life of the intact bonds of every place.
fn least_lives(body: &Body, bonds: &Bonds, lives: &[(Bond, f64)]) -> Vec<f64> {
    let mut least = vec![1.0_f64; body.places()];
    for &(bond, life) in lives.iter().filter(|(bond, _)| bonds.is_intact(*bond)) {
        let (_, a, b) = body.ends(bond);
        for place in [a, b] {
            least[place] = least[place].min(life.clamp(0.0, 1.0));
        }
    }
    least
}
