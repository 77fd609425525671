//! Built-in verification: figures of the program beside those of theory, handbooks and measurements.
//!
//! A topic is a function that fills a [`Table`] with rows: computed, reference, error, bound, source. Bounds are demands on
//! the program, not records of what it reaches: a row that misses its bound either fails the command or carries the reason
//! of a known miss.

pub mod blocks;
pub mod collinear;
pub mod disc;
pub mod dual_horizon;
pub mod golden;
pub mod golden_peridynamics;
pub mod grown;
pub mod growth;
pub mod measured;
pub mod paths;
pub mod resolution;
pub mod scene;
pub mod state_based;
pub mod static_scenes;
pub mod stress_intensity;
pub mod table;
pub mod tension_plate;
mod tip_field;
pub mod uniform_tension;

use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use crate::error::{Result, input};
pub use table::{Row, Table};

/// A group of rows that are computed together.
pub struct Topic {
    /// Name, as `perilife verify NAME` takes it.
    pub name: &'static str,
    /// What its rows show.
    pub about: &'static str,
    /// Computes the rows.
    pub fill: fn(&mut Table) -> Result<()>,
}

/// All topics, in the order in which a life is computed.
pub const TOPICS: &[Topic] = &[
    Topic { name: "tension_plate", about: "displacements of a plate in uniform tension", fill: tension_plate::rows },
    Topic { name: "static_scenes", about: "scenes without time against uniform tension and shear", fill: static_scenes::rows },
    Topic {
        name: "stress_intensity",
        about: "K_I and K_II of standard specimens, slanted cracks and two cracks, by every method",
        fill: stress_intensity::all,
    },
    Topic { name: "golden", about: "golden lives by hand calculation, rates of readings", fill: golden::by_hand },
    Topic {
        name: "golden_peridynamics",
        about: "the golden lives by peridynamics with an A fitted to hand calculation",
        fill: golden_peridynamics::by_bonds,
    },
    Topic {
        name: "growth_law",
        about: "da/dN of a middle-tension panel against the power law of ΔK",
        fill: growth::middle_tension,
    },
    Topic { name: "one_line", about: "one A for middle tension, single edge and compact tension", fill: growth::specimens },
    Topic { name: "spacing", about: "one A for every spacing and horizon ratio", fill: resolution::spacing },
    Topic { name: "orientation", about: "life on turned lattices", fill: resolution::orientation },
    Topic { name: "blocks", about: "life over the size of cycle blocks, controlled or not", fill: blocks::rows },
    Topic { name: "clean_cracks", about: "broken bonds over those that a clean cut severs", fill: resolution::clean_cracks },
    Topic {
        name: "state_based",
        about: "Poisson's ratios that springs alone cannot have: displacements, K and growth law of the state-based law",
        fill: state_based::rows,
    },
    Topic {
        name: "poissons_ratio",
        about: "one growth rate at equal K whatever Poisson's ratio and plane state",
        fill: growth::poissons_ratio,
    },
    Topic {
        name: "tip_field",
        about: "cracks driven by the K of their tips: first kinks, lives against quadrature",
        fill: tip_field::all,
    },
    Topic { name: "paths", about: "kinks, cracks that join or turn into a hole, clean curved cracks", fill: paths::all },
    Topic { name: "biaxial", about: "stress along the crack does not count", fill: growth::biaxial },
    Topic {
        name: "measured",
        about: "the fit to a measured panel, and its C and m by hand calculation in other specimens",
        fill: measured::all,
    },
    Topic {
        name: "pbx_disc",
        about: "correspondence: Brazilian disc between platens against Hondros, springs against zero-energy modes",
        fill: disc::rows,
    },
    Topic {
        name: "dual_horizon",
        about: "points of several levels: momentum, ghost forces, uniform strain across a change of level, counts",
        fill: dual_horizon::rows,
    },
    Topic { name: "life", about: "lives of whole runs against quadrature with handbook K", fill: growth::lives },
];

/// The topics of these names, all where no name is given.
///
/// # Errors
/// A name that no topic bears.
pub fn topics(names: &[String]) -> Result<Vec<&'static Topic>> {
    if names.is_empty() {
        return Ok(TOPICS.iter().collect());
    }
    let known = || TOPICS.iter().map(|topic| topic.name).collect::<Vec<_>>().join(", ");
    let find = |name: &String| {
        TOPICS
            .iter()
            .find(|topic| topic.name == name)
            .ok_or_else(|| input("NAME", name, "is not a verification topic", format!("known are {}", known())))
    };
    names.iter().map(find).collect()
}

/// Rows of some topics in their order, computed side by side on the processors there are. `done` hears of every topic as it
/// ends.
///
/// # Errors
/// That of the first topic that has one.
pub fn rows(topics: &[&'static Topic], done: &(dyn Fn(&Topic, &[Row]) + Sync)) -> Result<Vec<Row>> {
    let next = AtomicUsize::new(0);
    let computed = Mutex::new(Vec::new());
    let work = || {
        while let Some((at, topic)) = Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|at| Some((at, topics.get(at)?))) {
            let mut table = Table::new(topic.name);
            let rows = (topic.fill)(&mut table).map(|()| table.into_rows());
            rows.iter().for_each(|rows| done(topic, rows));
            computed.lock().unwrap_or_else(PoisonError::into_inner).push((at, rows));
        }
    };
    let workers = thread::available_parallelism().map_or(1, NonZero::get).min(topics.len());
    thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(work);
        }
    });
    let mut computed = computed.into_inner().unwrap_or_else(PoisonError::into_inner);
    computed.sort_by_key(|(at, _)| *at);
    let tables: Vec<Vec<Row>> = computed.into_iter().map(|(_, rows)| rows).collect::<Result<_>>()?;
    Ok(tables.concat())
}
