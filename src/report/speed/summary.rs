//! `summary.md`: what to use when, in one screen, written from the measured points.

use std::fmt::Write as _;

use super::{Origin, digits, seconds};
use crate::verify::chart::summary::{Overall, WITHIN_PERCENT, beaten, fastest_within, never_on_front, overall};
use crate::verify::chart::{Chart, Family, Point};

/// The summary.
pub fn markdown(chart: &Chart, origin: &Origin) -> String {
    // Writing to a String cannot fail.
    let mut text = "# What to use when\n\n".to_owned();
    for sentence in sentences(chart) {
        let _ = writeln!(text, "- {sentence}");
    }
    let growing = overall(chart);
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
    text += "\nOmissions and tweaking: C and m of the growth law are given, nothing is fitted to a scene. The beam with three holes has points of \
             0.5 mm by default. Bond-based plates have a Poisson's ratio of 1/3, which changes no K under given loads. Errors are the largest \
             at 50, 75 and 95 % of the growth; those of a plate in tension and of a hole are static. Each run is a process of its own, set-up \
             included, pictures not.\n";
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
            "Where a handbook has K(a), quadrature takes {} and errs by {} % at most.",
            seconds(hand.median_s),
            digits(hand.worst_percent)
        ));
    }
    let losers = beaten(chart);
    let defaults = chart.points.iter().filter(|point| point.choice.is_default() && point.place().is_some()).count();
    let named = losers.iter().map(|beaten| {
        let by = beaten.by.map_or_else(String::new, |by| format!(" by {}", by.choice.name()));
        format!("{}{by}", beaten.panel.name)
    });
    let named: Vec<String> = named.collect();
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
