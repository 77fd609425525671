//! `chart.svg`: a panel a scene, seconds against percent on common logarithmic scales, colour a method, mark a solver.

use std::f64::consts::PI;
use std::path::Path;

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::{Origin, seconds};
use crate::error::{Error, Result};
use crate::report::axis::Axis;
use crate::report::labels::{Box2, place_labels};
use crate::report::plot::{
    Area, COLOURS, Drawn, FINE, Frame, INK, Layout, dashes, filled, font, frame, line, picture, rectangle, stroke, words,
};
use crate::verify::chart::{Chart, Family, Panel, Point};

/// Size of a panel, of the head and of the foot, px, and how the frame of a panel is laid out.
const PANEL: [u32; 2] = [430, 330];
const HEAD: u32 = 104;
const FOOT: u32 = 44;
const LAYOUT: Layout = Layout { margins: [34, 14, 4, 6], labels: [40, 54], fonts: [11, 12] };
const COLUMNS: usize = 3;
/// Errors, percent, and seconds between which the scales lie, whatever lies beyond.
const ERRORS: [f64; 2] = [0.002, 100.0];
const SECONDS_LEAST: f64 = 0.02;
/// 95 % quantile of the lives of 34 equal panels over their median of 253 726 cycles from 9 to 49.8 mm, less one, percent (Virkler, Hillberry
/// and Goel 1979).
const SCATTER_PERCENT: f64 = 12.3;

const GREY: RGBColor = RGBColor(91, 102, 117);
const PALE: RGBColor = RGBColor(136, 147, 161);
const DEFAULT: RGBColor = RGBColor(242, 193, 78);
const SCATTER: RGBColor = RGBColor(122, 83, 0);

/// The picture.
pub fn svg(chart: &Chart, origin: &Origin) -> Result<String> {
    let scenes = chart.scenes();
    let columns = scenes.len().clamp(1, COLUMNS);
    let rows = scenes.len().div_ceil(columns).max(1) as u32;
    let size = (PANEL[0] * columns.max(2) as u32, HEAD + PANEL[1] * rows + FOOT);
    let longest = chart.points.iter().filter_map(|point| Some(point.range_s()?[1])).fold(10.0, f64::max);
    let most_s = 10.0_f64.powf((1.3 * longest).log10().ceil());
    let drawn = picture(size, |root| {
        head(root, chart, f64::from(size.0))?;
        for (place, panel) in scenes.iter().enumerate() {
            let at = [PANEL[0] * (place % columns) as u32, HEAD + PANEL[1] * (place / columns) as u32];
            draw(root, panel, &chart.of(panel).collect::<Vec<_>>(), at, most_s)?;
        }
        let footer = origin.footer(chart).replace('`', "");
        words(root, &footer, [16.0, f64::from(size.1) - 20.0], 12, (HPos::Left, GREY))
    });
    drawn.map_err(|error| Error::file(Path::new("chart.svg"), "cannot draw", std::io::Error::other(error.to_string())))
}

/// Title, and what colours and marks mean.
fn head(root: &Area<'_>, chart: &Chart, width: f64) -> Drawn {
    words(root, "What a result costs, and how far off it is", [16.0, 20.0], 18, (HPos::Left, INK))?;
    let mut x = 16.0;
    for family in chart.families().into_iter().filter(|family| *family != Family::Solver) {
        mark(root, "window", [x + 5.0, 48.0], 5.0, &colour(family), &colour(family))?;
        words(root, family.name(), [x + 15.0, 48.0], 12, (HPos::Left, INK))?;
        x += 30.0 + width_of(family.name());
    }
    x = 16.0;
    for solver in ["window", "multigrid", "direct", "quadrature"] {
        mark(root, solver, [x + 5.0, 68.0], 5.0, &WHITE, &GREY)?;
        words(root, solver, [x + 15.0, 68.0], 12, (HPos::Left, INK))?;
        x += 30.0 + width_of(solver);
    }
    let note = "Filled and named: no other point is both faster and nearer to the truth. Star: the choice of the program for an error asked for. Bars: least \
                and largest time.";
    words(root, &note[..note.len().min((width / 5.8) as usize)], [16.0, 88.0], 12, (HPos::Left, GREY))
}

fn colour(family: Family) -> RGBColor {
    match family {
        Family::TipField | Family::Solver => COLOURS[0],
        Family::Auto => COLOURS[2],
        Family::ElementFree => COLOURS[1],
        Family::Handbook => INK,
        Family::BondStrain => COLOURS[3],
        Family::BondLaw => COLOURS[5],
    }
}

fn width_of(words: &str) -> f64 {
    6.4 * words.chars().count() as f64
}

/// The mark of a solver about a centre.
fn mark(root: &Area<'_>, solver: &str, at: [f64; 2], r: f64, fill: &RGBColor, rim: &RGBColor) -> Drawn {
    let corners: &[[f64; 2]] = match solver {
        "multigrid" => &[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]],
        "direct" => &[[0.0, -1.25], [1.25, 0.0], [0.0, 1.25], [-1.25, 0.0]],
        "quadrature" => &[[0.0, -1.2], [1.1, 0.9], [-1.1, 0.9]],
        // A circle.
        _ => &std::array::from_fn::<[f64; 2], 24, _>(|i| (PI * i as f64 / 12.0).sin_cos().into()),
    };
    outlined(root, corners.iter().map(|[u, v]| [at[0] + r * u, at[1] + r * v]).collect(), fill, rim)
}

/// A filled polygon with a rim.
fn outlined(root: &Area<'_>, mut corners: Vec<[f64; 2]>, fill: &RGBColor, rim: &RGBColor) -> Drawn {
    filled(root, &corners, fill)?;
    corners.extend(corners.first().copied());
    line(root, &corners, 1.2, rim)
}

/// A panel with its points, its upper left corner at a place.
fn draw(root: &Area<'_>, panel: &Panel, points: &[&Point], [left, top]: [u32; 2], most_s: f64) -> Drawn {
    let fine = |length: u32| (length * FINE) as i32;
    let area = root.clone().shrink((fine(left), fine(top)), (fine(PANEL[0]), fine(PANEL[1])));
    words(&area, panel.about, [16.0, 14.0], 14, (HPos::Left, INK))?;
    let quantity = panel.scene.quantity().split(',').next().unwrap_or_default();
    let axes = [Axis::logarithmic_between(SECONDS_LEAST, most_s), Axis::logarithmic_between(ERRORS[0], ERRORS[1])];
    let mut chart = frame(&area, &LAYOUT, axes, ["Time of a run, s", &format!("Error of {quantity}, %")])?;
    limits(&mut chart, panel, most_s)?;
    let held = |(time, error): (f64, f64)| (time.clamp(SECONDS_LEAST, most_s), error.clamp(ERRORS[0], ERRORS[1]));
    front(&mut chart, points, most_s, held)?;
    // Places in the whole picture, px.
    let place = |chart: &Frame<'_>, at: (f64, f64)| {
        let (x, y) = chart.backend_coord(&held(at));
        [x, y].map(|length| f64::from(length) / f64::from(FINE))
    };
    let mut drawn: Vec<(&Point, [f64; 2])> =
        points.iter().filter_map(|point| Some((*point, place(&chart, point.place()?)))).collect();
    // What counts is drawn last, on top.
    drawn.sort_by_key(|(point, _)| (point.is_on_front, point.choice.is_default()));
    for (point, at) in &drawn {
        let (Some(run), Some(range)) = (point.outcome.done(), point.range_s()) else { continue };
        let colour = colour(point.choice.family);
        line(root, &range.map(|time| place(&chart, (time, run.error_percent))), 1.0, &colour)?;
        if point.choice.is_default() || point.choice.family == Family::Auto {
            outlined(root, star(*at), &DEFAULT, &INK)?;
        }
        mark(root, &run.model.solver, *at, 4.6, if point.is_on_front { &colour } else { &WHITE }, &colour)?;
    }
    let (x, y) = chart.plotting_area().get_pixel_range();
    let pixels = |low: i32, high: i32| [low, high].map(|length| f64::from(length) / f64::from(FINE));
    let ([x0, x1], [y0, y1]) = (pixels(x.start, x.end), pixels(y.start, y.end));
    let inside = Box2 { low: [x0, y0], high: [x1, y1] };
    left_out(root, points, inside)?;
    names(root, &drawn, inside)
}

/// Scatter of the material, and what the truth cannot tell.
fn limits(chart: &mut Frame<'_>, panel: &Panel, most_s: f64) -> Drawn {
    let uncertainty = panel.scene.truth_uncertainty_percent();
    let small = |colour: &RGBColor| font(11, *colour);
    let right = most_s / (most_s / SECONDS_LEAST).powf(0.62);
    if uncertainty > ERRORS[0] {
        let shade = RGBColor(233, 237, 242).mix(0.7).filled();
        chart.draw_series([Rectangle::new([(SECONDS_LEAST, ERRORS[0]), (most_s, uncertainty)], shade)])?;
        chart.draw_series([Text::new("below the error of the truth", (right, 2.5 * ERRORS[0]), small(&GREY))])?;
    }
    if panel.scene.grows() {
        dashes(chart, vec![(SECONDS_LEAST, SCATTER_PERCENT), (most_s, SCATTER_PERCENT)], stroke(&SCATTER, 1.0))?;
        chart.draw_series([Text::new("scatter of equal panels, 12 %", (right, 2.0 * SCATTER_PERCENT), small(&SCATTER))])?;
    }
    Ok(())
}

/// Steps through the points that no other one beats.
fn front(chart: &mut Frame<'_>, points: &[&Point], most_s: f64, held: impl Fn((f64, f64)) -> (f64, f64)) -> Drawn {
    let mut front: Vec<(f64, f64)> =
        points.iter().filter(|point| point.is_on_front).filter_map(|point| point.place()).map(held).collect();
    front.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut steps = Vec::new();
    for (time, error) in front {
        let before = steps.last().map_or(ERRORS[1], |last: &(f64, f64)| last.1);
        steps.extend([(time, before), (time, error)]);
    }
    let last = steps.last().map(|last| (most_s, last.1));
    chart.draw_series(LineSeries::new(steps.into_iter().chain(last), stroke(&INK, 1.4)))?;
    Ok(())
}

/// Grey crosses for what was refused, failed or not done.
fn left_out(root: &Area<'_>, points: &[&Point], frame: Box2) -> Drawn {
    let count = points.iter().filter(|point| point.place().is_none()).count();
    if count == 0 {
        return Ok(());
    }
    let y = frame.low[1] + 10.0;
    words(root, "no result", [frame.high[0] - 12.0 * count as f64 - 6.0, y], 12, (HPos::Right, PALE))?;
    for at in 0..count {
        let x = frame.high[0] - 12.0 * at as f64 - 8.0;
        line(root, &[[x - 4.0, y - 4.0], [x + 4.0, y + 4.0]], 1.6, &PALE)?;
        line(root, &[[x - 4.0, y + 4.0], [x + 4.0, y - 4.0]], 1.6, &PALE)?;
    }
    Ok(())
}

/// Names of the points on the front, of the default and of the published law.
fn names(root: &Area<'_>, drawn: &[(&Point, [f64; 2])], frame: Box2) -> Drawn {
    let is_named = |point: &Point| point.is_on_front || point.choice.is_default() || point.choice.family == Family::BondStrain;
    let named: Vec<usize> = (0..drawn.len()).filter(|&i| is_named(drawn[i].0)).collect();
    let places: Vec<[f64; 2]> = drawn.iter().map(|(_, at)| *at).collect();
    let texts: Vec<String> = named.iter().map(|&i| short_name(drawn[i].0)).collect();
    let sizes: Vec<[f64; 2]> = texts.iter().map(|text| [0.88 * width_of(text), 13.0]).collect();
    for ((&i, spot), text) in named.iter().zip(place_labels(frame, &places, &[], &named, &sizes)).zip(&texts) {
        let near = spot.nearest(places[i]);
        if (near[0] - places[i][0]).hypot(near[1] - places[i][1]) > 14.0 {
            line(root, &[places[i], near], 0.7, &PALE)?;
        }
        rectangle(root, [spot.low, spot.high], &WHITE.mix(0.8))?;
        words(root, text, spot.centre(), 11, (HPos::Center, colour(drawn[i].0.choice.family)))?;
    }
    Ok(())
}

/// The name of a point beside its mark.
fn short_name(point: &Point) -> String {
    let family = match point.choice.family {
        Family::Auto => "auto",
        Family::TipField => "tips",
        Family::ElementFree => "nodes",
        Family::Handbook => "handbook",
        Family::BondStrain => "published law",
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

/// A star of five points about a centre.
fn star([x, y]: [f64; 2]) -> Vec<[f64; 2]> {
    let corner = |i: usize| {
        let (sin, cos) = (PI * i as f64 / 5.0).sin_cos();
        let r = if i.is_multiple_of(2) { 10.0 } else { 4.5 };
        [x + r * sin, y - r * cos]
    };
    (0..10).map(corner).collect()
}
