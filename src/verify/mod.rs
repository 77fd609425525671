//! Built-in verification: figures of the program beside those of theory, handbooks and measurements.
//!
//! A topic is a function that fills a [`Table`] with rows: computed, reference, error, bound, source. Bounds are demands on
//! the program, not records of what it reaches: a row that misses its bound fails the command, unless it carries the reason of
//! a known miss and stays within the second bound that comes with it. How many rows of a topic miss is pinned, so that neither a
//! new miss nor the end of an old one goes unseen.

pub mod biaxial;
mod bond_strain;
pub mod collinear;
pub mod disc;
pub mod dual_horizon;
pub mod element_free;
pub mod golden;
pub mod golden_peridynamics;
pub mod lives;
pub mod measured;
pub mod paths;
pub mod poissons_ratio;
pub mod references;
pub mod resolution;
pub mod scene;
pub mod standard;
pub mod state_based;
pub mod static_scenes;
pub mod steps;
pub mod stress_intensity;
pub mod table;
pub mod tension_plate;
pub mod uniform_tension;

use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use crate::error::{Result, input};
pub use table::{KnownMiss, Row, Table};

/// A group of rows that are computed together.
pub struct Topic {
    /// Name, as `perilife verify NAME` takes it.
    pub name: &'static str,
    /// What its rows show.
    pub about: &'static str,
    /// How many of its rows are known to miss their bounds.
    pub misses: usize,
    /// Computes the rows.
    pub fill: fn(&mut Table) -> Result<()>,
}

/// Topics of the default model, in the order in which a life is computed.
const TOPICS: &[Topic] = &[
    Topic { name: "tension_plate", about: "displacements of a plate in uniform tension", misses: 2, fill: tension_plate::rows },
    Topic {
        name: "static_scenes",
        about: "scenes without time against uniform tension and shear",
        misses: 5,
        fill: static_scenes::rows,
    },
    Topic {
        name: "stress_intensity",
        about: "K_I and K_II of standard specimens, slanted cracks and two cracks, by every method",
        misses: 0,
        fill: stress_intensity::all,
    },
    Topic {
        name: "element_free",
        about: "stress concentration, K, kinks, lives and paths on nodes without elements",
        misses: 5,
        fill: element_free::all,
    },
    Topic { name: "golden", about: "golden lives by hand calculation, rates of readings", misses: 0, fill: golden::by_hand },
    Topic {
        name: "life",
        about: "lives of standard specimens by m, bond law and kernel against quadrature",
        misses: 0,
        fill: lives::all,
    },
    Topic {
        name: "golden_peridynamics",
        about: "the golden lives by peridynamics",
        misses: 0,
        fill: golden_peridynamics::by_tips,
    },
    Topic {
        name: "poissons_ratio",
        about: "life at equal K whatever Poisson's ratio and plane state",
        misses: 1,
        fill: poissons_ratio::rows,
    },
    Topic { name: "spacing", about: "life at every spacing and horizon ratio", misses: 0, fill: resolution::spacing },
    Topic { name: "orientation", about: "lives and paths on turned lattices", misses: 0, fill: resolution::orientation },
    Topic { name: "same_plate", about: "one plate drawn, mirrored and scaled", misses: 0, fill: resolution::same_plate },
    Topic { name: "blocks", about: "life and path over the length of cycle blocks", misses: 0, fill: steps::rows },
    Topic { name: "biaxial", about: "stress along the crack does not count", misses: 0, fill: biaxial::rows },
    Topic {
        name: "paths",
        about: "first kinks, cracks that join, curved cracks beside finite elements",
        misses: 3,
        fill: paths::all,
    },
    Topic {
        name: "measured",
        about: "the fit to a measured panel, and its C and m by hand calculation in other specimens",
        misses: 0,
        fill: measured::all,
    },
    Topic {
        name: "state_based",
        about: "Poisson's ratios that springs alone cannot have: displacements and K of the state-based law",
        misses: 0,
        fill: state_based::rows,
    },
    Topic {
        name: "pbx_disc",
        about: "correspondence: Brazilian disc between platens against Hondros, springs against zero-energy modes",
        misses: 3,
        fill: disc::rows,
    },
    Topic {
        name: "dual_horizon",
        about: "points of several levels: momentum, ghost forces, uniform strain across a change of level, counts",
        misses: 3,
        fill: dual_horizon::rows,
    },
];

/// All topics: lives and paths by K of the tips first, fatigue bonds last.
pub fn all_topics() -> impl Iterator<Item = &'static Topic> {
    TOPICS.iter().chain(bond_strain::TOPICS)
}

/// The topics of these names, all where no name is given.
///
/// # Errors
/// A name that no topic bears.
pub fn topics(names: &[String]) -> Result<Vec<&'static Topic>> {
    if names.is_empty() {
        return Ok(all_topics().collect());
    }
    let known = || all_topics().map(|topic| topic.name).collect::<Vec<_>>().join(", ");
    let find = |name: &String| {
        all_topics()
            .find(|topic| topic.name == name)
            .ok_or_else(|| input("NAME", name, "is not a verification topic", format!("known are {}", known())))
    };
    names.iter().map(find).collect()
}

/// Rows of some topics in their order, computed side by side on the processors there are. `done` hears of every topic as it
/// ends.
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

/// What is wrong with the rows of some topics, a line each: rows that fail, and topics of which another number of rows misses
/// its bounds than is pinned.
pub fn faults(topics: &[&Topic], rows: &[Row]) -> Vec<String> {
    let failing = rows.iter().filter(|row| row.fails()).map(|row| {
        let bound = row.known_miss.as_ref().map_or(row.bound_percent, |miss| miss.bound_percent);
        format!("{}: {}: error {:+.3} % beyond its bound of {bound:.3} %", row.name, row.quantity, row.error_percent)
    });
    let miscounted = topics.iter().filter_map(|topic| {
        let found = rows.iter().filter(|row| row.name == topic.name && !row.ok()).count();
        let Topic { name, misses, .. } = topic;
        (found != *misses).then(|| format!("{name}: {found} rows miss their bounds, {misses} are pinned (`misses` of the topic)"))
    });
    failing.chain(miscounted).collect()
}
