//! `summary.md`: what to use when, in one screen, written from the measured points.

use std::fmt::Write as _;

use super::{Origin, digits, seconds};
use crate::chart::{Chart, Family, Panel, Point};
use perilife_calibration::median::median;

/// Errors, percent, for which the fastest choice is told.
const WITHIN_PERCENT: [f64; 4] = [10.0, 5.0, 2.0, 1.0];

/// A choice over all scenes in which cracks grow and which have it.
#[derive(Debug, Clone, PartialEq)]
pub struct Overall {
    pub name: String,
    /// Scenes with a result.
    pub done: usize,
    pub of: usize,
    /// Its largest error, percent.
    pub worst_percent: f64,
    /// The scene of that error.
    pub worst_in: &'static str,
    /// Median of its times, s.
    pub median_s: f64,
    pub on_front: usize,
}

/// Choices over the scenes in which cracks grow, in their order.
fn overall(chart: &Chart) -> Vec<Overall> {
    let growing: Vec<&Point> = chart.points.iter().filter(|point| point.panel.grows()).collect();
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
        own.iter().filter_map(|point| point.place().map(|(time, error)| (time, error, point.panel.name.as_str()))).collect();
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
    let scenes = chart.scenes().into_iter().filter(|panel| panel.grows()).count();
    let fits = |choice: &Overall| choice.done == scenes && choice.worst_percent <= percent;
    overall(chart).into_iter().filter(fits).min_by(|a, b| a.median_s.total_cmp(&b.median_s))
}

/// Scenes whose default is not on the front, each with the point nearest to the truth of those that are faster and nearer.
pub fn beaten(chart: &Chart) -> Vec<(&'static Panel, Option<&Point>)> {
    let of_scene = |panel: &'static Panel| {
        let (time, error) = chart.of(panel).find(|point| point.choice.is_default() && !point.is_on_front)?.place()?;
        let on_front = chart.of(panel).filter(|point| point.is_on_front).filter_map(|point| Some((point, point.place()?)));
        let beats = on_front.filter(|(_, place)| place.0 <= time && place.1 <= error);
        Some((panel, beats.min_by(|a, b| a.1.1.total_cmp(&b.1.1)).map(|(point, _)| point)))
    };
    chart.scenes().into_iter().filter_map(of_scene).collect()
}

/// Families that are on no front though they have results.
pub fn never_on_front(chart: &Chart) -> Vec<Family> {
    let of = |family: Family| chart.points.iter().filter(move |point| point.choice.family == family);
    let never = |family: &Family| of(*family).any(|point| point.place().is_some()) && !of(*family).any(|point| point.is_on_front);
    Family::ALL.iter().copied().filter(never).collect()
}

/// When to take a method; `None` of what is a choice within one.
fn when(family: Family) -> Option<&'static str> {
    match family {
        Family::Auto => Some("default, except for the cases below"),
        Family::Handbook => Some("a standard specimen within the range of its formula"),
        Family::ElementFree => Some("any other plate: curved, short and several cracks, holes, edges, crack-face contact"),
        Family::TipField => Some("bonds and their remaining life, damage, bond laws; cross-check"),
        Family::BondStrain => Some("cracks from slots; the published law"),
        Family::BondLaw | Family::Solver => None,
    }
}

pub fn markdown(chart: &Chart, origin: &Origin) -> String {
    // Writing to a String cannot fail.
    let mut text = "# Choice of method\n\n".to_owned();
    for sentence in sentences(chart) {
        let _ = writeln!(text, "- {sentence}");
    }
    let growing = overall(chart);
    let methods = Family::ALL.iter().filter_map(|family| {
        let choice = growing.iter().find(|choice| choice.name == family.name())?;
        let (error, time) = (digits(choice.worst_percent), seconds(choice.median_s));
        when(*family).map(|when| format!("| {} | {when} | {error} % | {time} |\n", choice.name))
    });
    let methods: String = methods.collect();
    if !methods.is_empty() {
        text += "\n| method | use for | largest error of life | median time |\n|---|---|---|---|\n";
        text += &methods;
    }
    if !growing.is_empty() {
        text += "\nOver the scenes in which cracks grow:\n\n| choice | largest error of life | in | median time | on the front of | results |\n\
                 |---|---|---|---|---|---|\n";
        for choice in &growing {
            let Overall { name, done, of, worst_percent, worst_in, median_s, on_front } = choice;
            let _ = writeln!(
                text,
                "| {name} | {} % | {worst_in} | {} | {on_front} | {done} of {of} |",
                digits(*worst_percent),
                seconds(*median_s)
            );
        }
    }
    text += "\nDefault, scene by scene:\n\n| scene | error | path, mm | time | solves | MB | on the front |\n|---|---|---|---|---|---|---|\n";
    for point in chart.points.iter().filter(|point| point.choice.is_default()) {
        let _ = writeln!(text, "{}", default_row(point));
    }
    let failed: Vec<&Point> = chart.points.iter().filter(|point| point.place().is_none()).collect();
    if !failed.is_empty() {
        text += "\nWithout a result:\n\n";
        for point in failed {
            let _ = writeln!(
                text,
                "- {}, {}: {}: {}",
                point.panel.name,
                point.choice.name(),
                point.status(),
                point.outcome.reason().unwrap_or_default()
            );
        }
    }
    text += "\nC and m of the growth law are given; nothing is fitted to a scene. The beam with three holes has points of 0.5 \
             mm by default. Bond-based plates have a Poisson's ratio of 1/3, which changes no K under given loads. Errors are \
             the largest at 50, 75 and 95 % of the growth; those of a plate in tension and of a hole are static. Each run is \
             a separate process, set-up included, pictures not.\n";
    let _ = writeln!(text, "\n{}", origin.footer(chart));
    text
}

/// The sentences that README repeats.
fn sentences(chart: &Chart) -> Vec<String> {
    let mut all = Vec::new();
    let within: Vec<String> = WITHIN_PERCENT
        .iter()
        .map(|&percent| match fastest_within(chart, percent) {
            Some(choice) => {
                format!("{percent} %: {} ({}, at most {} %)", choice.name, seconds(choice.median_s), digits(choice.worst_percent))
            }
            None => format!("{percent} %: none"),
        })
        .collect();
    all.push(format!("Fastest within an error of life in every scene (median time, largest error): {}.", within.join("; ")));
    if let Some(hand) = overall(chart).into_iter().find(|choice| choice.name == Family::Handbook.name()) {
        all.push(format!(
            "Where a handbook has K(a), quadrature takes {} with an error of at most {} %.",
            seconds(hand.median_s),
            digits(hand.worst_percent)
        ));
    }
    let losers = beaten(chart);
    let defaults = chart.points.iter().filter(|point| point.choice.is_default() && point.place().is_some()).count();
    let name = |(panel, by): &(&Panel, Option<&Point>)| {
        panel.name.clone() + &by.map_or_else(String::new, |by| format!(" by {}", by.choice.name()))
    };
    let named: Vec<String> = losers.iter().map(name).collect();
    all.push(match named.is_empty() {
        true => format!("The default is on the front in all {defaults} scenes."),
        false => format!(
            "The default is on the front in {} of {defaults} scenes; beaten in {}.",
            defaults - named.len(),
            named.join(", ")
        ),
    });
    let never: Vec<&str> = never_on_front(chart).iter().map(|family| family.name()).collect();
    if !never.is_empty() {
        all.push(format!("On no front: {}.", never.join(", ")));
    }
    all
}

fn default_row(point: &Point) -> String {
    let run = point.outcome.done();
    format!(
        "| {} | {} | {} | {} | {} | {} | {} |",
        point.panel.name,
        run.map_or_else(|| point.status().to_string(), |run| format!("{} %", digits(run.error_percent))),
        run.and_then(|run| run.path_rms_mm).map_or_else(String::new, digits),
        seconds(point.wall_s().unwrap_or(f64::NAN)),
        run.map_or_else(String::new, |run| run.solves.to_string()),
        run.map_or_else(String::new, |run| digits(run.memory_mb)),
        if point.is_on_front { "yes" } else { "no" }
    )
}
