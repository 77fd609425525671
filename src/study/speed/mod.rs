//! The speed-accuracy chart as files: table, picture, summary.

mod picture;

use std::fmt::Write as _;
use std::path::Path;

use super::chart::schedule::Model;
use super::chart::{Chart, Family, Panel, Point};
use perilife_base::cells::defused;
use perilife_base::columns::exact_text as exact;
use perilife_base::error::Result;
use perilife_calibration::median::median;
use perilife_results::format;
use perilife_results::output::write_file;
pub use picture::svg;

pub const FILES: [&str; 3] = ["chart.csv", "chart.svg", "summary.md"];

#[derive(Debug, Clone)]
pub struct Origin {
    pub command: String,
    pub date: String,
}

impl Origin {
    pub fn now(command: String) -> Origin {
        Origin { command, date: format::now() }
    }

    /// The line under chart and tables: command, machine, threads, version, date.
    pub fn footer(&self, chart: &Chart) -> String {
        let reference = seconds(chart.reference_s);
        format!("`{}` · {} · reference run {reference} · {}", self.command, chart.machine, self.date)
    }
}

pub fn write(folder: &Path, chart: &Chart, origin: &Origin) -> Result<()> {
    let texts = [csv(chart), svg(chart, origin), markdown(chart, origin)];
    FILES.iter().zip(texts).try_for_each(|(file, text)| write_file(&folder.join(file), text.as_bytes()))
}

pub const COLUMNS: &str = "scene,method,driver,bond_law,solver,discretisation,spacing_mm,horizon_ratio,step,points,solves,error_percent,\
                           path_rms_mm,truth,truth_uncertainty_percent,wall_s,time_ratio,runs,spread_percent,memory_mb,threads,version,\
                           extrapolated,status,command,choice,on_front,reason";

/// `chart.csv`: one row a point, in the order of scenes and choices.
pub fn csv(chart: &Chart) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing into memory cannot fail.
    let _ = writer.write_record(COLUMNS.split(','));
    for point in &chart.points {
        let _ = writer.write_record(fields(point, chart).iter().map(|text| defused(text).into_owned()));
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

fn fields(point: &Point, chart: &Chart) -> Vec<String> {
    let (scene, run) = (point.panel, point.outcome.done());
    let model = |of: fn(&Model) -> &str| run.map_or_else(String::new, |run| of(&run.model).to_owned());
    let number = |value: Option<f64>| value.map_or_else(String::new, exact);
    let count = |value: Option<usize>| value.map_or_else(String::new, |count| count.to_string());
    vec![
        point.panel.name.clone(),
        point.choice.family.name().to_owned(),
        model(|model| &model.driver),
        model(|model| &model.bond_law),
        model(|model| &model.solver),
        model(|model| &model.discretisation),
        number(run.and_then(|run| run.model.spacing_mm)),
        number(run.and_then(|run| run.model.horizon_ratio)),
        number(run.and_then(|run| run.model.step)),
        count(run.map(|run| run.points)),
        count(run.map(|run| run.solves)),
        number(run.map(|run| run.error_percent)),
        number(run.and_then(|run| run.path_rms_mm)),
        scene.truth.clone(),
        exact(scene.uncertainty_percent),
        number(point.wall_s()),
        number(point.time_ratio()),
        point.walls.len().to_string(),
        number(point.spread_percent()),
        number(run.map(|run| run.memory_mb)),
        chart.machine.threads.to_string(),
        chart.machine.version.to_owned(),
        // The column is older than the rule that every time is measured.
        false.to_string(),
        point.status().name().to_owned(),
        point.command(),
        point.choice.name(),
        point.is_on_front.to_string(),
        point.outcome.reason().unwrap_or_default().to_owned(),
    ]
}

pub fn seconds(value: f64) -> String {
    match value {
        v if v.is_nan() => "-".to_owned(),
        v if v < 1e-3 => format!("{} µs", digits(1e6 * v)),
        v if v < 1.0 => format!("{} ms", digits(1e3 * v)),
        v => format!("{} s", digits(v)),
    }
}

/// Two significant digits, more of whole numbers.
pub fn digits(value: f64) -> String {
    let size = value.abs();
    match size {
        s if s.is_nan() => "-".to_owned(),
        0.0 => "0".to_owned(),
        s if s < 1e-3 => format!("{value:.1e}"),
        s => {
            let decimals = (1 - s.log10().floor() as i32).clamp(0, 5) as usize;
            format!("{value:.decimals$}")
        }
    }
}

/// Errors, percent, for which the fastest choice is told.
const WITHIN_PERCENT: [f64; 4] = [10.0, 5.0, 2.0, 1.0];

/// A choice over all scenes in which cracks grow and which have it.
#[derive(Debug, Clone, PartialEq)]
pub struct Overall {
    pub name: String,
    pub done: usize,
    pub of: usize,
    pub worst_percent: f64,
    pub worst_in: &'static str,
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
