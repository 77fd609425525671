//! Bonds that age by their own strain (`driver = "bond_strain"`): growth law, paths, resolution, blocks.
//!
//! These rows show what such bonds are good for and where they see the rows of points; lives and paths of a run are those of K
//! (`super::lives`, `super::paths`) unless a case asks otherwise.

mod blocks;
mod golden;
mod grown;
mod growth;
mod paths;
mod resolution;
mod scene;
mod standard;
mod state_based;

use super::Topic;

/// The topics, in the order in which a life is computed.
pub(super) const TOPICS: &[Topic] = &[
    Topic {
        name: "bond_strain_growth_law",
        about: "ageing bonds: da/dN of a middle-tension panel against the power law of ΔK",
        fill: growth::middle_tension,
    },
    Topic {
        name: "bond_strain_one_line",
        about: "ageing bonds: one A for middle tension, single edge and compact tension",
        fill: growth::specimens,
    },
    Topic {
        name: "bond_strain_poissons_ratio",
        about: "ageing bonds: one growth rate at equal K whatever Poisson's ratio, plane state and bond law",
        fill: growth::poissons_ratio,
    },
    Topic {
        name: "bond_strain_state_based",
        about: "ageing bonds: growth law and lattices with the state-based law",
        fill: state_based::rows,
    },
    Topic { name: "bond_strain_biaxial", about: "ageing bonds: stress along the crack does not count", fill: growth::biaxial },
    Topic {
        name: "bond_strain_spacing",
        about: "ageing bonds: one A for every spacing and horizon ratio",
        fill: resolution::spacing,
    },
    Topic { name: "bond_strain_orientation", about: "ageing bonds: life on turned lattices", fill: resolution::orientation },
    Topic {
        name: "bond_strain_standard",
        about: "ageing bonds: lives of standard specimens whatever p, Poisson's ratio, lattice and horizon ratio",
        fill: standard::rows,
    },
    Topic {
        name: "bond_strain_clean_cracks",
        about: "ageing bonds: broken bonds over those that a clean cut severs",
        fill: resolution::clean_cracks,
    },
    Topic {
        name: "bond_strain_blocks",
        about: "ageing bonds: life over the size of cycle blocks, controlled or not",
        fill: blocks::rows,
    },
    Topic {
        name: "bond_strain_paths",
        about: "ageing bonds: kinks, cracks that join or turn into a hole, clean curved cracks",
        fill: paths::all,
    },
    Topic {
        name: "bond_strain_golden",
        about: "ageing bonds: the golden lives, with an A fitted to hand calculation",
        fill: golden::by_bonds,
    },
    Topic {
        name: "bond_strain_life",
        about: "ageing bonds: lives of whole runs against quadrature with handbook K",
        fill: growth::lives,
    },
];
