//! Fatigue bonds, driven by their own strain (`driver = "bond_strain"`): lives, paths, resolution.
//!
//! The rate of such bonds is controlled by the K of their tip, so that lives are those of K; these rows show how well the
//! controller holds in other specimens, lattices and resolutions, and what the bonds alone decide: where the crack goes and how
//! clean it is. Lives and paths of a run are those of K (`super::lives`, `super::paths`) unless a case asks otherwise.

mod grown;
mod paths;
mod resolution;
mod scene;
mod standard;

use super::Topic;

/// The topics, in the order in which a life is computed.
pub(super) const TOPICS: &[Topic] = &[
    Topic {
        name: "bond_strain_standard",
        about: "fatigue bonds: lives of standard specimens whatever p, Poisson's ratio, lattice and horizon ratio",
        misses: 0,
        fill: standard::rows,
    },
    Topic {
        name: "bond_strain_spacing",
        about: "fatigue bonds: one A for every spacing and horizon ratio",
        misses: 0,
        fill: resolution::spacing,
    },
    Topic {
        name: "bond_strain_clean_cracks",
        about: "fatigue bonds: broken bonds over those that a clean cut severs",
        misses: 0,
        fill: resolution::clean_cracks,
    },
    Topic {
        name: "bond_strain_paths",
        about: "fatigue bonds: kinks, cracks that join or turn into a hole, clean curved cracks",
        misses: 4,
        fill: paths::all,
    },
];
