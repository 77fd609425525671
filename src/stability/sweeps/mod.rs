//! The sweeps: one parameter each.

mod growth;
mod lattice;
mod levels;
mod lives;
mod material;
mod nodes;
mod readings;
mod resolution;
mod solvers;
mod steps;
mod zero_energy;

use super::Sweep;

/// All sweeps, in the order in which a life is computed.
pub const SWEEPS: &[&Sweep] = &[
    &zero_energy::SPRING,
    &zero_energy::SILLING,
    &material::PLANE_STRESS,
    &material::PLANE_STRAIN,
    &lattice::HORIZON_RATIO,
    &lattice::LATTICE_ANGLE,
    &lattice::HOLE_OFFSET,
    &lattice::PLATE_SIZE,
    &levels::LEVEL_JUMP,
    &resolution::CRACK_LENGTH,
    &resolution::EDGE_CRACK_LENGTH,
    &resolution::LIGAMENT,
    &resolution::HOLE_DISTANCE,
    &resolution::HOLE_DIAMETER,
    &resolution::CRACK_DISTANCE,
    &growth::KINK_MIXITY,
    &growth::BIAXIALITY,
    &lives::STEP_ERROR,
    &lives::SEVERING_STEP,
    &lives::EXPONENT,
    &lives::AGEING,
    &steps::TIME_STEP,
    &steps::LOAD_STEPS,
    &solvers::DENSITY_FACTOR,
    &solvers::LAST_LIGAMENT,
    &nodes::INFLUENCE_RADIUS,
    &nodes::NODE_OFFSET,
    &readings::NOISE,
    &readings::COUNT,
];
