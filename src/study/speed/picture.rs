//! `chart.svg`: a panel a scene, seconds against percent on common logarithmic scales, colour a method, mark a solver.

use std::f64::consts::PI;

use super::{Origin, seconds};
use crate::chart::{Chart, Family, Panel, Point};
use perilife_results::axis::{Axis, Box2, place_labels};
use perilife_results::chart::{COMPUTED, Frame, INK, NOTE, SECOND, Size, width_of};
use perilife_results::specimen_picture::sketch::Sketch;

/// Size of a panel, and of the head and the foot, px.
const PANEL: Size = Size { width: 430.0, height: 330.0, text: 11.5 };
const HEAD: f64 = 104.0;
const FOOT: f64 = 36.0;
const COLUMNS: usize = 3;
/// Errors, percent, and seconds between which the scales lie, whatever lies beyond.
const ERRORS: [f64; 2] = [0.002, 100.0];
const SECONDS_LEAST: f64 = 0.02;
/// 95 % quantile over median (253 726 cycles, 9 to 49.8 mm) of 34 equal panels, less one, percent (Virkler, Hillberry and Goel 1979).
const SCATTER_PERCENT: f64 = 12.3;
const SCATTER: &str = "specimen-to-specimen scatter, 12 %";

const GREY: &str = "#55606d";
const PALE: &str = "#8893a1";
const SHADE: &str = "#e9edf2";
const DEFAULT: &str = "#f2c14e";
type Pixel = [f64; 2];

pub fn svg(chart: &Chart, origin: &Origin) -> String {
    let scenes = chart.scenes();
    let columns = scenes.len().clamp(1, COLUMNS);
    let rows = scenes.len().div_ceil(columns).max(1);
    let size = [PANEL.width * columns.max(2) as f64, HEAD + PANEL.height * rows as f64 + FOOT];
    let longest = chart.points.iter().filter_map(|point| Some(point.range_s()?[1])).fold(10.0, f64::max);
    let most_s = 10.0_f64.powf((1.3 * longest).log10().ceil());
    let mut sketch = Sketch::new(1.0, [0.0; 2]);
    head(&mut sketch, chart);
    for (place, panel) in scenes.iter().enumerate() {
        let at = [PANEL.width * (place % columns) as f64, HEAD + PANEL.height * (place / columns) as f64];
        sketch.within(at, [PANEL.width, PANEL.height], draw(panel, &chart.of(panel).collect::<Vec<_>>(), most_s));
    }
    let footer = origin.footer(chart).replace('`', "");
    sketch.name([16.0, size[1] - 14.0], &footer, "start", 12.0, GREY);
    sketch.picture(size, "Run time against error, one panel per scene")
}

fn head(sketch: &mut Sketch, chart: &Chart) {
    sketch.name([16.0, 26.0], "Run time against error", "start", 18.0, INK);
    let mut x = 16.0;
    let has_points = |family: &Family| chart.points.iter().any(|point| point.choice.family == *family);
    for family in Family::ALL.iter().copied().filter(|family| *family != Family::Solver && has_points(family)) {
        mark(sketch, "window", [x + 5.0, 48.0], 5.0, colour(family), colour(family));
        sketch.name([x + 15.0, 52.0], family.name(), "start", 12.0, INK);
        x += 34.0 + width_of(family.name(), 12.0);
    }
    x = 16.0;
    for solver in ["window", "multigrid", "direct", "quadrature"] {
        mark(sketch, solver, [x + 5.0, 68.0], 5.0, "white", GREY);
        sketch.name([x + 15.0, 72.0], solver, "start", 12.0, INK);
        x += 34.0 + width_of(solver, 12.0);
    }
    let note = "Filled, named: Pareto front (no point is faster and more accurate). Star: default. Bars: min and max time.";
    sketch.name([16.0, 92.0], note, "start", 12.0, GREY);
}

fn colour(family: Family) -> &'static str {
    match family {
        Family::TipField | Family::Solver => COMPUTED,
        Family::Auto => "#1b8a6b",
        Family::ElementFree => SECOND,
        Family::Handbook => INK,
        Family::BondStrain => "#8a4fa3",
        Family::BondLaw => "#4fa3d1",
    }
}

fn mark(sketch: &mut Sketch, solver: &str, at: Pixel, r: f64, fill: &str, rim: &str) {
    let corners: &[Pixel] = match solver {
        "multigrid" => &[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]],
        "direct" => &[[0.0, -1.25], [1.25, 0.0], [0.0, 1.25], [-1.25, 0.0]],
        "quadrature" => &[[0.0, -1.2], [1.1, 0.9], [-1.1, 0.9]],
        // A circle.
        _ => &std::array::from_fn::<Pixel, 24, _>(|i| (PI * i as f64 / 12.0).sin_cos().into()),
    };
    outlined(sketch, corners.iter().map(|[u, v]| [at[0] + r * u, at[1] + r * v]).collect(), fill, rim);
}

fn outlined(sketch: &mut Sketch, mut corners: Vec<Pixel>, fill: &str, rim: &str) {
    sketch.area(&corners, fill, 1.0);
    corners.extend(corners.first().copied());
    sketch.path(&corners, rim, 1.2, "");
}

fn draw(panel: &Panel, points: &[&Point], most_s: f64) -> Sketch {
    let quantity = panel.quantity.split(',').next().unwrap_or_default();
    let axes = [Axis::logarithmic_between(SECONDS_LEAST, most_s), Axis::logarithmic_between(ERRORS[0], ERRORS[1])];
    let mut frame = Frame::new(PANEL, &panel.about, axes, ["Run time, s", &format!("Error of {quantity}, %")], &[]);
    let mut taken = limits(&mut frame, panel, most_s);
    let held = |[time, error]: [f64; 2]| [time.clamp(SECONDS_LEAST, most_s), error.clamp(ERRORS[0], ERRORS[1])];
    let steps = front(points, most_s, held);
    frame.line(&steps, INK, 1.4, "");
    let mut drawn: Vec<(&Point, Pixel)> =
        points.iter().filter_map(|point| Some((*point, frame.at(held(point.place()?.into()))))).collect();
    // What counts is drawn last, on top.
    drawn.sort_by_key(|(point, _)| (point.is_on_front, point.choice.is_default()));
    for (point, at) in &drawn {
        let (Some(run), Some(range)) = (point.outcome.done(), point.range_s()) else { continue };
        let colour = colour(point.choice.family);
        let bar = range.map(|time| frame.at(held([time, run.error_percent])));
        frame.sketch().path(&bar, colour, 1.0, "");
        if point.choice.is_default() || point.choice.family == Family::Auto {
            outlined(frame.sketch(), star(*at), DEFAULT, INK);
        }
        mark(frame.sketch(), &run.model.solver, *at, 4.6, if point.is_on_front { colour } else { "white" }, colour);
    }
    let [left, top, right, bottom] = frame.room();
    let inside = Box2 { low: [left, top], high: [right, bottom] };
    left_out(frame.sketch(), points, inside);
    taken.extend(steps.iter().map(|step| frame.at(*step)));
    names(frame.sketch(), &drawn, &taken, inside);
    frame.into_sketch()
}

/// Scatter of the material, and what the truth cannot tell; the line of the scatter, px.
fn limits(frame: &mut Frame, panel: &Panel, most_s: f64) -> Vec<Pixel> {
    let uncertainty = panel.uncertainty_percent;
    let [left, _, right, bottom] = frame.room();
    if uncertainty > ERRORS[0] {
        frame.below(uncertainty, [SECONDS_LEAST, most_s], SHADE, 0.8);
        frame.sketch().name([right - 4.0, bottom - 6.0], "below the reference uncertainty", "end", PANEL.text, GREY);
    }
    if !panel.grows() {
        return Vec::new();
    }
    let y = frame.at([most_s, SCATTER_PERCENT])[1];
    frame.line(&[[SECONDS_LEAST, SCATTER_PERCENT], [most_s, SCATTER_PERCENT]], NOTE, 1.0, "3 3");
    frame.sketch().name([right - 4.0, y - 4.0], SCATTER, "end", PANEL.text, NOTE);
    // Neither the line nor its words are covered by a name.
    let words = right - 4.0 - width_of(SCATTER, PANEL.text);
    vec![[words, y - 9.0], [right, y - 9.0], [right, y], [left, y], [f64::NAN; 2]]
}

/// Steps through the points that no other one beats.
fn front(points: &[&Point], most_s: f64, held: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<[f64; 2]> {
    let on_front = points.iter().filter(|point| point.is_on_front).filter_map(|point| point.place());
    let mut front: Vec<[f64; 2]> = on_front.map(|place| held(place.into())).collect();
    front.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut steps: Vec<[f64; 2]> = Vec::new();
    for [time, error] in front {
        let before = steps.last().map_or(ERRORS[1], |last| last[1]);
        steps.extend([[time, before], [time, error]]);
    }
    let last = steps.last().map(|last| [most_s, last[1]]);
    steps.into_iter().chain(last).collect()
}

/// Grey crosses for what was refused, failed or not done.
fn left_out(sketch: &mut Sketch, points: &[&Point], frame: Box2) {
    let count = points.iter().filter(|point| point.place().is_none()).count();
    if count == 0 {
        return;
    }
    let y = frame.low[1] + 10.0;
    sketch.name([frame.high[0] - 12.0 * count as f64 - 6.0, y + 4.0], "no result", "end", 11.0, PALE);
    for at in 0..count {
        let x = frame.high[0] - 12.0 * at as f64 - 8.0;
        sketch.cross([x, y], 4.0, PALE, 1.6);
    }
}

/// Names of the points on the front, of the default and of the published law, off the lines that are `taken`.
fn names(sketch: &mut Sketch, drawn: &[(&Point, Pixel)], taken: &[Pixel], frame: Box2) {
    let is_named = |point: &Point| point.is_on_front || point.choice.is_default() || point.choice.family == Family::BondStrain;
    let named: Vec<usize> = (0..drawn.len()).filter(|&i| is_named(drawn[i].0)).collect();
    let places: Vec<Pixel> = drawn.iter().map(|(_, at)| *at).collect();
    let texts: Vec<String> = named.iter().map(|&i| short_name(drawn[i].0)).collect();
    let sizes: Vec<Pixel> = texts.iter().map(|text| [width_of(text, 11.0), 13.0]).collect();
    for ((&i, spot), text) in named.iter().zip(place_labels(frame, &places, taken, &named, &sizes)).zip(&texts) {
        let near = spot.nearest(places[i]);
        if (near[0] - places[i][0]).hypot(near[1] - places[i][1]) > 14.0 {
            sketch.path(&[places[i], near], PALE, 0.7, "");
        }
        let [x, y] = spot.centre();
        sketch.name([x, y + 4.0], text, "middle", 11.0, colour(drawn[i].0.choice.family));
    }
}

fn short_name(point: &Point) -> String {
    let family = match point.choice.family {
        Family::Auto => "auto",
        Family::TipField => "tips",
        Family::ElementFree => "nodes",
        Family::Handbook => "handbook",
        Family::BondStrain => "bond_strain",
        Family::BondLaw | Family::Solver => "",
    };
    match (family, point.choice.words.as_str()) {
        (family, "") if point.wall_s().is_some_and(|wall| wall < SECONDS_LEAST) => {
            format!("{family}, {}", seconds(point.wall_s().unwrap_or(f64::NAN)))
        }
        (family, "") => family.to_owned(),
        ("", words) => words.to_owned(),
        (family, words) => format!("{family}, {words}"),
    }
}

fn star([x, y]: Pixel) -> Vec<Pixel> {
    let corner = |i: usize| {
        let (sin, cos) = (PI * i as f64 / 5.0).sin_cos();
        let r = if i.is_multiple_of(2) { 10.0 } else { 4.5 };
        [x + r * sin, y - r * cos]
    };
    (0..10).map(corner).collect()
}
