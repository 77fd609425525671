//! The speed-accuracy chart: a panel a scene, time over the reference run against error, both logarithmic, with the Pareto front.

use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::Axis;
use super::chart::{COLOURS, FINE, INK, font, px, save};
use super::labels::{Box2, place_labels};
use crate::bench::variant::VARIED;
use crate::bench::{Outcome, Row};
use crate::error::Result;

/// Size of a panel; height of title, legend and footer, px.
const PANEL: (u32, u32) = (640, 440);
const HEAD: u32 = 84;
const FOOT: u32 = 54;
/// Margins of the plotting area inside a panel: left, right, top, bottom, px.
const MARGINS: [u32; 4] = [86, 16, 38, 60];
const LABEL_SIZE: u32 = 13;
/// Errors, percent, beyond which a run says nothing and has no mark: one of them would squeeze all others together.
const ERROR_MAX: f64 = 100.0;

type Drawn = std::result::Result<(), Box<dyn std::error::Error>>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Writes the chart of the groups that have errors; `false`, and no file, where none has.
///
/// # Errors
/// [`crate::Error::File`] if the file cannot be written.
pub fn speed_accuracy(path: &Path, outcome: &Outcome) -> Result<bool> {
    let mut groups: Vec<&'static str> = outcome.rows.iter().filter(|row| drawn(row).is_some()).map(|row| row.group).collect();
    groups.dedup();
    if groups.is_empty() {
        return Ok(false);
    }
    let columns = groups.len().min(2) as u32;
    let rows = (groups.len() as u32).div_ceil(columns);
    // One panel alone is made wide enough for the legend.
    let size = (PANEL.0 * columns.max(2), HEAD + PANEL.1 * rows + FOOT);
    save(path, size, |svg| draw(svg, size, (columns, rows), outcome, &groups))?;
    Ok(true)
}

fn draw(svg: &mut String, size: (u32, u32), (columns, rows): (u32, u32), outcome: &Outcome, groups: &[&str]) -> Drawn {
    let root = SVGBackend::with_string(svg, (size.0 * FINE, size.1 * FINE)).into_drawing_area();
    root.fill(&WHITE)?;
    let (head, rest) = root.split_vertically(px(HEAD));
    let (body, foot) = rest.split_vertically(px(PANEL.1 * rows));
    legend(&head, size.0, outcome, groups)?;
    let lines = [
        format!("Reference run, time 1: {}, by the default model: {:.3} s", outcome.reference, outcome.reference_s),
        format!("Medians of repeats, each over the reference run beside it.  {}", outcome.machine),
    ];
    for (line, height) in lines.into_iter().zip([16, 36]) {
        foot.draw(&Text::new(line, (px(size.0 / 2), px(height)), font(13).pos(Pos::new(HPos::Center, VPos::Center))))?;
    }
    for (area, group) in body.split_evenly((rows as usize, columns as usize)).iter().zip(groups) {
        let of_group: Vec<&Row> = outcome.rows.iter().filter(|row| row.group == *group && drawn(row).is_some()).collect();
        panel(area, &of_group)?;
    }
    root.present()?;
    Ok(())
}

/// Place of a row in the chart, if it has one.
fn drawn(row: &Row) -> Option<(f64, f64)> {
    row.place().filter(|(_, error)| *error <= ERROR_MAX)
}

/// Title and the marks of what was varied.
fn legend(area: &Area<'_>, width: u32, outcome: &Outcome, groups: &[&str]) -> Drawn {
    let middle = Pos::new(HPos::Center, VPos::Center);
    let title = "Speed and accuracy: what a result costs and how far it is from the reference";
    area.draw(&Text::new(title, (px(width / 2), px(20)), font(17).pos(middle)))?;
    let of_chart = |row: &&Row| groups.contains(&row.group) && drawn(row).is_some();
    let varied: Vec<usize> =
        (0..VARIED.len()).filter(|&i| outcome.rows.iter().filter(of_chart).any(|row| row.varied == VARIED[i])).collect();
    let extrapolated = outcome.rows.iter().filter(of_chart).any(|row| row.timing.extrapolated_from.is_some());
    let mut words: Vec<(Option<usize>, &str)> = varied.iter().map(|&i| (Some(i), VARIED[i])).collect();
    words.push((None, "Pareto front"));
    // Two lines, each centred.
    let width_of = |text: &str| 40 + text_width(text, 14) as u32;
    let total: u32 = words.iter().map(|(_, text)| width_of(text)).sum();
    let mut x = width.saturating_sub(total) / 2;
    let left = Pos::new(HPos::Left, VPos::Center);
    for (series, text) in words {
        let at = (px(x + 10), px(46));
        match series {
            Some(series) => mark(area, at, series, true)?,
            None => {
                let style = ShapeStyle::from(&INK).stroke_width(FINE + FINE / 2);
                area.draw(&PathElement::new(vec![(px(x), px(46)), (px(x + 20), px(46))], style))?;
            }
        }
        area.draw(&Text::new(text.to_owned(), (px(x + 26), px(46)), font(14).pos(left)))?;
        x += width_of(text);
    }
    let mut note = "each mark differs from the default in one choice; those on the front are named".to_owned();
    if extrapolated {
        note += "; hollow: extrapolated from measured blocks";
    }
    let beyond = outcome.rows.iter().filter(|row| row.place().is_some() && drawn(row).is_none()).count();
    if beyond > 0 {
        note += &format!("; {beyond} beyond {ERROR_MAX} % left out");
    }
    area.draw(&Text::new(note, (px(width / 2), px(68)), font(13).pos(middle)))?;
    Ok(())
}

/// One scene.
fn panel(area: &Area<'_>, rows: &[&Row]) -> Drawn {
    // A panel without rows is not drawn.
    let Some(first) = rows.first() else { return Ok(()) };
    let places: Vec<(f64, f64)> = rows.iter().filter_map(|row| row.place()).collect();
    let (width, _) = area.dim_in_pixel();
    let middle = Pos::new(HPos::Center, VPos::Center);
    area.draw(&Text::new(first.scene.clone(), (width as i32 / 2, px(20)), font(15).pos(middle)))?;
    let axes = [Axis::logarithmic_wide(places.iter().map(|p| p.0)), Axis::logarithmic_wide(places.iter().map(|p| p.1))];
    let [x, y] = axes;
    let (x_labels, y_labels) = (x.labels(), y.labels());
    let mut chart = ChartBuilder::on(area)
        .margin_left(px(8))
        .margin_right(px(MARGINS[1]))
        .margin_top(px(MARGINS[2]))
        .margin_bottom(px(6))
        .x_label_area_size(px(MARGINS[3] - 6))
        .y_label_area_size(px(MARGINS[0] - 8))
        .build_cartesian_2d(x, y)?;
    let thin = |grey: u8| ShapeStyle::from(&RGBColor(grey, grey, grey)).stroke_width(FINE);
    let of = first.error.as_ref().map_or("", |error| error.of);
    let name = of.split(',').next().unwrap_or(of);
    chart
        .configure_mesh()
        .x_labels(x_labels)
        .y_labels(y_labels)
        .bold_line_style(thin(210))
        .light_line_style(thin(238))
        .axis_style(ShapeStyle::from(&INK).stroke_width(FINE))
        .set_all_tick_mark_size(px(4))
        .label_style(font(13))
        .axis_desc_style(font(14))
        .x_desc("Time over that of the reference run")
        .y_desc(format!("Error of {name}, %"))
        .draw()?;
    let mut front: Vec<&Row> = rows.iter().copied().filter(|row| row.on_front).collect();
    front.sort_by(|a, b| a.timing.ratio.total_cmp(&b.timing.ratio));
    let line = ShapeStyle::from(&INK).stroke_width(FINE + FINE / 2);
    chart.draw_series(LineSeries::new(front.iter().filter_map(|row| row.place()), line))?;
    let pixels: Vec<(i32, i32)> = places.iter().map(|place| chart.backend_coord(place)).collect();
    let base = area.get_base_pixel();
    let local: Vec<(i32, i32)> = pixels.iter().map(|p| (p.0 - base.0, p.1 - base.1)).collect();
    // The default is drawn last, on top.
    for (row, at) in rows.iter().zip(&local).rev() {
        mark(area, *at, series_of(row), row.timing.extrapolated_from.is_none())?;
    }
    let corners: Vec<(i32, i32)> = front.iter().filter_map(|row| row.place()).map(|place| chart.backend_coord(&place)).collect();
    let line: Vec<(i32, i32)> = corners.iter().map(|p| (p.0 - base.0, p.1 - base.1)).collect();
    names(area, rows, &local, &line, chart.plotting_area().get_pixel_range())
}

/// Names of the points on the front, where nothing else is; `line` is that of the front.
fn names(
    area: &Area<'_>,
    rows: &[&Row],
    at: &[(i32, i32)],
    line: &[(i32, i32)],
    (x, y): (std::ops::Range<i32>, std::ops::Range<i32>),
) -> Drawn {
    let base = area.get_base_pixel();
    let scale = f64::from(FINE);
    let frame = Box2 {
        low: [f64::from(x.start - base.0) / scale, f64::from(y.start - base.1) / scale],
        high: [f64::from(x.end - base.0) / scale, f64::from(y.end - base.1) / scale],
    };
    let whole = |&(x, y): &(i32, i32)| [f64::from(x) / scale, f64::from(y) / scale];
    let points: Vec<[f64; 2]> = at.iter().map(whole).collect();
    let line: Vec<[f64; 2]> = line.iter().map(whole).collect();
    let named: Vec<usize> = (0..rows.len()).filter(|&i| rows[i].on_front).collect();
    let sizes: Vec<[f64; 2]> =
        named.iter().map(|&i| [text_width(&rows[i].choice, LABEL_SIZE), f64::from(LABEL_SIZE) + 3.0]).collect();
    let boxes = place_labels(frame, &points, &line, &named, &sizes);
    for (&i, spot) in named.iter().zip(boxes) {
        let centre = spot.centre();
        let fine = |p: [f64; 2]| ((p[0] * scale) as i32, (p[1] * scale) as i32);
        let near = spot.nearest(points[i]);
        if (near[0] - points[i][0]).hypot(near[1] - points[i][1]) > 12.0 {
            let style = ShapeStyle::from(&INK.mix(0.5)).stroke_width(FINE / 2);
            area.draw(&PathElement::new(vec![fine(points[i]), fine(near)], style))?;
        }
        let corners = [fine(spot.low), fine(spot.high)];
        area.draw(&Rectangle::new(corners, WHITE.mix(0.8).filled()))?;
        let colour = COLOURS_OF[series_of(rows[i])];
        let style = font(LABEL_SIZE).color(&colour).pos(Pos::new(HPos::Center, VPos::Center));
        area.draw(&Text::new(rows[i].choice.clone(), fine(centre), style))?;
    }
    Ok(())
}

/// Colours of what is varied: black for the default.
const COLOURS_OF: [RGBColor; VARIED.len()] = [INK, COLOURS[0], COLOURS[1], COLOURS[2], COLOURS[3], RGBColor(60, 140, 200)];

fn series_of(row: &Row) -> usize {
    VARIED.iter().position(|varied| *varied == row.varied).unwrap_or(0)
}

/// The mark of a series, in shape and colour: shapes tell them apart in grey print.
fn mark(area: &Area<'_>, at: (i32, i32), series: usize, filled: bool) -> Drawn {
    let colour = COLOURS_OF[series];
    let style = if filled { colour.filled() } else { ShapeStyle::from(&colour).stroke_width(FINE + FINE / 2) };
    let polygon = |corners: &[(f64, f64)]| -> Vec<(i32, i32)> {
        let unit = f64::from(px(5));
        corners.iter().map(|(x, y)| (at.0 + (unit * x) as i32, at.1 + (unit * y) as i32)).collect()
    };
    let outline: &[(f64, f64)] = match series {
        0 => return Ok(area.draw(&Circle::new(at, px(6), style))?),
        1 => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
        2 => &[(0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)],
        3 => return Ok(area.draw(&Circle::new(at, px(5), style))?),
        4 => &[(0.0, -1.3), (1.0, 0.0), (0.0, 1.3), (-1.0, 0.0)],
        5 => &[(0.0, 1.2), (1.1, -0.8), (-1.1, -0.8)],
        _ => &[
            (-1.2, -0.4),
            (-0.4, -0.4),
            (-0.4, -1.2),
            (0.4, -1.2),
            (0.4, -0.4),
            (1.2, -0.4),
            (1.2, 0.4),
            (0.4, 0.4),
            (0.4, 1.2),
            (-0.4, 1.2),
            (-0.4, 0.4),
            (-1.2, 0.4),
        ],
    };
    let mut corners = polygon(outline);
    if filled {
        area.draw(&Polygon::new(corners, style))?;
    } else {
        corners.push(corners[0]);
        area.draw(&PathElement::new(corners, style))?;
    }
    Ok(())
}

/// Width of a text in a font without serifs, px: about six tenths of its size a letter.
fn text_width(text: &str, size: u32) -> f64 {
    0.62 * f64::from(size) * text.chars().count() as f64
}
