//! The program beside truths that it did not give itself: one judge with four questions.
//!
//! Knows: topics of `verify`, published tests of `validate`, scenes and choices of `chart`, sweeps of `stability`, their tables and pictures.
//! Must not know: terminals, networks.
//!
//! Imports any member but `service`; only the commands import it.
//!
//! A question has a case, a reading and a truth, and stands in a file of `data/studies` ([`questions`]). Topics of `verify` bound its
//! error at the default; [`chart`] sets it beside the time that it costs, over methods and resolutions; [`stability`] follows it over one
//! parameter until it passes a bound.
//!
//! A row of `perilife verify` has computed, reference, error, bound, source. Bounds are
//! demands on the program, not records of what it reaches: a row that misses its bound fails the command, unless it carries the reason
//! of a known miss and stays within the second bound that comes with it. How many rows of a topic miss is pinned, so that neither a
//! new miss nor the end of an old one goes unseen.

pub mod cases;
pub mod chart;
pub mod computations;
pub mod dual_horizon;
pub mod moving;
pub mod questions;
pub mod speed;
pub mod stability;
pub mod stability_table;
pub mod subject;
pub mod tasks;
pub mod uniform_tension;
pub mod validate;
pub mod values;
pub mod verification;

use std::sync::LazyLock;
use std::time::Instant;

use serde::Deserialize;
use toml::Table as Toml;

use chart::{Family, SCENES, Status};
use perilife_base::error::Result;
use perilife_base::kinds::KindLine;
use perilife_base::watch::Silent;
use questions::{Asker, Question, SHARED, each, file, read};
use stability::SWEEPS;
use tasks::{chosen, side_by_side};
use values::combinations;

pub use verification::{KnownMiss, VerificationRow};

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Topic {
    /// Name, as `perilife verify NAME` takes it: that of its file.
    #[serde(skip)]
    pub name: &'static str,
    pub about: String,
    /// How many of its rows are known to miss their bounds.
    #[serde(default)]
    pub misses: usize,
    #[serde(default)]
    pub set: Toml,
    pub ask: Vec<Toml>,
}

macro_rules! files {
    ($($name:literal),+ $(,)?) => { [$(($name, include_str!(concat!("../../data/studies/", $name, ".toml")))),+] };
}

/// Files of all topics, in the order in which a life is computed.
const FILES: [(&str, &str); 22] = files![
    "tension_plate", "static_scenes", "stress_concentration", "stress_intensity", "named_plates", "pins", "golden",
    "golden_peridynamics", "life", "poissons_ratio", "spacing", "orientation", "same_plate", "blocks", "biaxial", "paths",
    "measured", "pbx_disc", "dual_horizon", "scene_strength", "estimates", "hand_over",
];

/// All topics from their files; `tests/unit/studies.rs` reads them with their errors.
pub fn read_topics() -> Result<Vec<Topic>> {
    let shared = file("shared.toml", SHARED)?;
    let topic = |&(name, text): &(&'static str, &str)| {
        let topic: Topic = read(file(name, text)?)?;
        Ok(Topic { name, set: shared.clone().into_iter().chain(topic.set).collect(), ..topic })
    };
    FILES.iter().map(topic).collect()
}

pub static TOPICS: LazyLock<Vec<Topic>> = LazyLock::new(|| read_topics().unwrap_or_default());

pub fn topics(names: &[String]) -> Result<Vec<&'static Topic>> {
    if TOPICS.is_empty() {
        read_topics()?;
    }
    chosen(&TOPICS, |topic| topic.name, names, "NAME", "is not a verification topic")
}

impl Topic {
    fn rows(&self) -> Result<Vec<VerificationRow>> {
        let (mut rows, mut last, asker) = (Vec::new(), Instant::now(), Asker::new(&Silent));
        for questions in &self.ask {
            each(questions, &self.set, &mut |question, values| {
                if let Some(row) = answer(self.name, &asker, question, values)? {
                    rows.push(VerificationRow { wall_s: last.elapsed().as_secs_f64(), ..row });
                    last = Instant::now();
                }
                Ok(())
            })?;
        }
        Ok(rows)
    }
}

/// The row of a question; `None` of one that is not asked with these values.
fn answer(topic: &'static str, asker: &Asker<'_>, question: &Question, values: &Toml) -> Result<Option<VerificationRow>> {
    let asking = asker.ask(question, values);
    if question.when.as_ref().map_or(Ok(1.0), |when| asking.figure(when))? <= 0.0 {
        return Ok(None);
    }
    let computed = if question.spread.is_empty() { asking.number(&question.read)? } else { spread(asker, question, values)? };
    let bound = question.bound.as_ref().map_or(Ok(0.0), |bound| asking.figure(bound))?;
    let words = (asking.text(&question.quantity)?, asking.text(&question.source)?);
    let truth = question.truth.as_ref().map(|truth| asking.figure(truth)).transpose()?;
    let row = VerificationRow::new(topic, words, computed, truth, bound);
    let Some(miss) = &question.miss else { return Ok(Some(row)) };
    let known = asking.figure(&miss.known)?;
    Ok(Some(if known != 0.0 { row.with_miss(asking.text(&miss.reason)?, known) } else { row }))
}

/// Largest less least value of a reading over its axes.
fn spread(asker: &Asker<'_>, question: &Question, values: &Toml) -> Result<f64> {
    let over = combinations(&question.spread)?.into_iter();
    let read = |chosen: Toml| asker.ask(question, &values.clone().into_iter().chain(chosen).collect()).number(&question.read);
    let all = over.map(read).collect::<Result<Vec<f64>>>()?;
    let [least, most] = [f64::min, f64::max].map(|of| all.iter().copied().reduce(of).unwrap_or(f64::NAN));
    Ok(most - least)
}

/// Rows of some topics in their order. `done` hears of every topic as it ends.
pub fn rows(topics: &[&'static Topic], done: &(dyn Fn(&Topic, &[VerificationRow]) + Sync)) -> Result<Vec<VerificationRow>> {
    let tables = side_by_side(topics, |topic| {
        let rows = topic.rows();
        rows.iter().for_each(|rows| done(topic, rows));
        rows
    });
    Ok(tables.into_iter().collect::<Result<Vec<Vec<VerificationRow>>>>()?.concat())
}

/// What is wrong with the rows of some topics, a line each: rows that fail, and topics of which another number of rows misses
/// its bounds than is pinned.
pub fn faults(topics: &[&Topic], rows: &[VerificationRow]) -> Vec<String> {
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

/// Names of topics, scenes and sweeps, as `perilife list` shows them: key, name, meaning.
pub fn catalogue() -> Vec<(String, String, String)> {
    let words = |line: KindLine| (line.key.to_owned(), line.name.to_owned(), line.meaning.to_owned());
    let mut all = Vec::new();
    all.extend(TOPICS.iter().map(|topic| ("verify NAME".to_owned(), topic.name.to_owned(), topic.about.clone())));
    all.extend(validate::built_in().into_iter().map(|(name, title)| ("validate NAME".to_owned(), name, title)));
    all.extend(SCENES.iter().map(|scene| ("chart SCENE".to_owned(), scene.name.clone(), scene.about.clone())));
    all.extend([Family::lines(), Status::lines(), validate::Kind::lines()].into_iter().flatten().map(words));
    all.extend(SWEEPS.iter().map(|sweep| ("stability NAME".to_owned(), sweep.name.clone(), sweep.about.clone())));
    all
}
