//! The program beside truths that it did not give itself: one judge with three questions.
//!
//! Knows: topics of `verify`, published tests of `validate`, scenes and choices of `chart`, sweeps of `stability`, their tables and pictures.
//! Must not know: terminals, networks.
//!
//! Imports any member but `service`; only the commands import it.
//!
//! A [`scene::Scene`] has a case, a truth and the truth's uncertainty, and says how far the case with some keys is from it. [`verify`](rows)
//! bounds that error (and figures that are no such scene) at the default; [`chart`] sets it beside the time that it costs, over
//! methods and resolutions; [`stability`] follows it over one parameter until it passes a bound.
//!
//! A topic of `perilife verify` is a function that fills a [`Table`] with rows: computed, reference, error, bound, source. Bounds are
//! demands on the program, not records of what it reaches: a row that misses its bound fails the command, unless it carries the reason
//! of a known miss and stays within the second bound that comes with it. How many rows of a topic miss is pinned, so that neither a
//! new miss nor the end of an old one goes unseen.

pub mod cases;
pub mod catalogue;
pub mod chart;
pub mod collinear;
pub mod disc;
pub mod dual_horizon;
pub mod estimates;
mod factors;
mod golden;
mod hand_over;
mod lives;
mod measured;
mod named;
mod paths;
mod pins;
pub mod references;
mod rims;
pub mod scene;
pub mod scene_strength;
pub mod speed;
pub mod stability;
pub mod stability_picture;
pub mod stability_table;
pub mod standard;
mod static_scenes;
pub mod table;
pub mod tasks;
pub mod tension_plate;
pub mod uniform_tension;
pub mod validate;
pub mod verification;

use perilife_base::error::Result;
use tasks::{chosen, side_by_side};

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

const fn topic(name: &'static str, about: &'static str, misses: usize, fill: fn(&mut Table) -> Result<()>) -> Topic {
    Topic { name, about, misses, fill }
}

/// All topics, in the order in which a life is computed.
pub const TOPICS: &[Topic] = &[
    topic("tension_plate", "displacements of a plate in uniform tension", 2, tension_plate::rows),
    topic("static_scenes", "scenes without time against uniform tension and shear", 5, static_scenes::rows),
    topic("stress_concentration", "holes, an elliptical opening and a notch on nodes without elements", 0, rims::rows),
    topic(
        "stress_intensity",
        "K of standard specimens, slanted, edge, stacked and collinear cracks, in bending and beside holes, by every method",
        0,
        factors::all,
    ),
    topic(
        "named_plates",
        "cracks at holes, rows of holes, lugs, bent and eccentric specimens: K beside handbooks, lives beside finite elements",
        0,
        named::rows,
    ),
    topic("pins", "pins in contact: arcs by Persson, arcs and K of compact specimens and lugs by finite elements", 0, pins::rows),
    topic("golden", "golden lives by hand calculation, rates of readings", 0, golden::by_hand),
    topic("golden_peridynamics", "the golden lives by peridynamics", 0, golden::on_points),
    topic("life", "lives of standard specimens by m, bond law, kernel and on nodes against quadrature", 0, lives::standard),
    topic("poissons_ratio", "life at equal K whatever Poisson's ratio and plane state", 1, lives::poissons_ratio),
    topic("spacing", "life at every spacing and horizon ratio", 0, lives::spacing),
    topic("orientation", "lives and paths on turned lattices", 0, lives::orientation),
    topic("same_plate", "one plate drawn, mirrored and scaled", 0, lives::same_plate),
    topic("blocks", "life and path over the length of cycle blocks", 0, lives::blocks),
    topic("biaxial", "stress along the crack does not count", 0, lives::biaxial),
    topic("paths", "first kinks, cracks that join, curved cracks beside finite elements, on points and on nodes", 3, paths::all),
    topic("measured", "the fit to a measured panel, and its C and m by hand calculation in other specimens", 0, measured::all),
    topic(
        "pbx_disc",
        "correspondence: Brazilian disc between platens against Hondros, springs against zero-energy modes",
        3,
        disc::rows,
    ),
    topic(
        "dual_horizon",
        "points of several levels in scenes: momentum, uniform strain across a change of level, counts",
        1,
        dual_horizon::rows,
    ),
    topic(
        "scene_strength",
        "scenes that break: load at which a crack grows against Griffith's by law and lattice angle, branches of a crack in motion",
        0,
        scene_strength::rows,
    ),
    topic("estimates", "bounds stated for the error of lives against what they are wrong by", 0, estimates::rows),
    topic("hand_over", "cracks that bonds began at a slot: life left where K of the tip takes over", 0, hand_over::rows),
];

/// The topics of these names, all where no name is given.
pub fn topics(names: &[String]) -> Result<Vec<&'static Topic>> {
    chosen(TOPICS, |topic| topic.name, names, "NAME", "is not a verification topic")
}

/// Rows of some topics in their order. `done` hears of every topic as it ends.
pub fn rows(topics: &[&'static Topic], done: &(dyn Fn(&Topic, &[Row]) + Sync)) -> Result<Vec<Row>> {
    let tables = side_by_side(topics, |topic| {
        let mut table = Table::new(topic.name);
        let rows = (topic.fill)(&mut table).map(|()| table.into_rows());
        rows.iter().for_each(|rows| done(topic, rows));
        rows
    });
    Ok(tables.into_iter().collect::<Result<Vec<Vec<Row>>>>()?.concat())
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
