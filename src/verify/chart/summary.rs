//! What a chart says: which choice is fastest within an error, where the default is beaten, what is never on a front.

use super::{Chart, Family, Panel, Point};
use crate::calibration::median::median;

/// Errors, percent, for which the fastest choice is told.
pub const WITHIN_PERCENT: [f64; 4] = [10.0, 5.0, 2.0, 1.0];

/// A choice over all scenes in which cracks grow and which have it.
#[derive(Debug, Clone, PartialEq)]
pub struct Overall {
    /// Its name.
    pub name: String,
    /// Scenes with a result.
    pub done: usize,
    /// Scenes that have it.
    pub of: usize,
    /// Its largest error, percent.
    pub worst_percent: f64,
    /// The scene of that error.
    pub worst_in: &'static str,
    /// Median of its times, s.
    pub median_s: f64,
    /// Scenes where it is on the front.
    pub on_front: usize,
}

/// A scene whose default is not on its front, and the point that is both faster and nearer to the truth.
#[derive(Debug, Clone)]
pub struct Beaten<'c> {
    /// Scene.
    pub panel: &'static Panel,
    /// The default.
    pub default: &'c Point,
    /// The nearest to the truth of those that beat it.
    pub by: Option<&'c Point>,
}

/// Choices over the scenes in which cracks grow, in their order.
pub fn overall(chart: &Chart) -> Vec<Overall> {
    let growing: Vec<&Point> = chart.points.iter().filter(|point| point.panel.scene.grows()).collect();
    let mut names: Vec<String> = Vec::new();
    for point in &growing {
        let name = point.choice.name();
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names.into_iter().filter_map(|name| of_choice(&growing, name)).collect()
}

fn of_choice(growing: &[&Point], name: String) -> Option<Overall> {
    let own: Vec<&&Point> = growing.iter().filter(|point| point.choice.name() == name).collect();
    let results: Vec<(f64, f64, &'static str)> =
        own.iter().filter_map(|point| point.place().map(|(time, error)| (time, error, point.panel.name))).collect();
    let worst = results.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Overall {
        done: results.len(),
        of: own.len(),
        worst_percent: worst.1,
        worst_in: worst.2,
        median_s: median(&results.iter().map(|(time, ..)| *time).collect::<Vec<_>>()),
        on_front: own.iter().filter(|point| point.is_on_front).count(),
        name,
    })
}

/// The choice with the least median time that is within an error in every scene in which cracks grow.
pub fn fastest_within(chart: &Chart, percent: f64) -> Option<Overall> {
    let scenes = chart.scenes().into_iter().filter(|panel| panel.scene.grows()).count();
    let fits = |choice: &Overall| choice.done == scenes && choice.worst_percent <= percent;
    overall(chart).into_iter().filter(fits).min_by(|a, b| a.median_s.total_cmp(&b.median_s))
}

/// Scenes whose default is not on the front.
pub fn beaten(chart: &Chart) -> Vec<Beaten<'_>> {
    let of_scene = |panel: &'static Panel| -> Option<Beaten<'_>> {
        let all: Vec<&Point> = chart.of(panel).collect();
        let default = all.iter().copied().find(|point| point.choice.is_default()).filter(|point| !point.is_on_front)?;
        let place = default.place()?;
        let beats =
            |point: &&Point| point.is_on_front && point.place().is_some_and(|(time, error)| time <= place.0 && error <= place.1);
        let nearest = |a: &&Point, b: &&Point| {
            a.place().map(|p| p.1).partial_cmp(&b.place().map(|p| p.1)).unwrap_or(std::cmp::Ordering::Equal)
        };
        Some(Beaten { panel, default, by: all.iter().copied().filter(beats).min_by(nearest) })
    };
    chart.scenes().into_iter().filter_map(of_scene).collect()
}

/// Families that are on no front though they have results.
pub fn never_on_front(chart: &Chart) -> Vec<Family> {
    let of = |family: Family| chart.points.iter().filter(move |point| point.choice.family == family);
    let never = |family: &Family| of(*family).any(|point| point.place().is_some()) && !of(*family).any(|point| point.is_on_front);
    Family::ALL.iter().copied().filter(never).collect()
}
