//! Drawing into SVG, for every chart: places in pixels, words, lines, areas, and a frame of two axes.

use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::Axis;
use super::output::write_file;
use crate::error::{Error, Result};

/// The library places everything on whole pixels. Drawing four times as large and shrinking by the view box keeps flat curves smooth.
pub(super) const FINE: u32 = 4;
/// Colours that differ in lightness too (Okabe and Ito 2008, safe for colour-blind readers); black is for measured points.
pub(super) const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];
pub(super) const INK: RGBColor = RGBColor(40, 40, 40);

/// What drawing comes to; the library's error stands for nothing that can happen to a string.
pub(super) type Drawn<T = ()> = std::result::Result<T, Box<dyn std::error::Error>>;
pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type Frame<'a> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<Axis, Axis>>;

/// A length in pixels as the library draws it.
pub(super) fn px(length: u32) -> i32 {
    (length * FINE) as i32
}

/// A place in pixels as the library draws it.
fn at([x, y]: [f64; 2]) -> (i32, i32) {
    let fine = |length: f64| (length * f64::from(FINE)).round() as i32;
    (fine(x), fine(y))
}

/// A stroke of so many pixels.
pub(super) fn stroke(colour: &impl Color, width: f64) -> ShapeStyle {
    ShapeStyle::from(colour).stroke_width((width * f64::from(FINE)).round() as u32)
}

/// A font of so many pixels.
pub(super) fn font(size: u32, colour: RGBColor) -> TextStyle<'static> {
    // The library divides sizes by 1.24 when it writes SVG.
    ("sans-serif", f64::from(size * FINE) * 1.24).into_font().color(&colour)
}

/// Words on a line whose middle is at this height; `from` says which end of them stands at the place.
pub(super) fn words(area: &Area<'_>, text: &str, place: [f64; 2], size: u32, (from, colour): (HPos, RGBColor)) -> Drawn {
    area.draw(&Text::new(text.to_owned(), at(place), font(size, colour).pos(Pos::new(from, VPos::Center))))?;
    Ok(())
}

/// A line through places.
pub(super) fn line(area: &Area<'_>, places: &[[f64; 2]], width: f64, colour: &impl Color) -> Drawn {
    area.draw(&PathElement::new(places.iter().map(|place| at(*place)).collect::<Vec<_>>(), stroke(colour, width)))?;
    Ok(())
}

/// A filled polygon.
pub(super) fn filled(area: &Area<'_>, corners: &[[f64; 2]], colour: &impl Color) -> Drawn {
    area.draw(&Polygon::new(corners.iter().map(|place| at(*place)).collect::<Vec<_>>(), colour.filled()))?;
    Ok(())
}

/// A filled upright rectangle between two corners.
pub(super) fn rectangle(area: &Area<'_>, corners: [[f64; 2]; 2], colour: &impl Color) -> Drawn {
    area.draw(&Rectangle::new(corners.map(at), colour.filled()))?;
    Ok(())
}

/// How a frame is laid out, px.
pub(super) struct Layout {
    /// Margins: top, right, bottom, left.
    pub margins: [u32; 4],
    /// Room below and left of the frame for its numbers.
    pub labels: [u32; 2],
    /// Sizes of numbers and of names.
    pub fonts: [u32; 2],
}

/// A frame with its axes, mesh and names.
pub(super) fn frame<'a>(area: &Area<'a>, layout: &Layout, [x, y]: [Axis; 2], [x_name, y_name]: [&str; 2]) -> Drawn<Frame<'a>> {
    let (x_labels, y_labels) = (x.labels(), y.labels());
    let [top, right, bottom, left] = layout.margins.map(px);
    let mut chart = ChartBuilder::on(area)
        .margin_top(top)
        .margin_right(right)
        .margin_bottom(bottom)
        .margin_left(left)
        .x_label_area_size(px(layout.labels[0]))
        .y_label_area_size(px(layout.labels[1]))
        .build_cartesian_2d(x, y)?;
    let grey = |value: u8| stroke(&RGBColor(value, value, value), 1.0);
    let [numbers, names] = layout.fonts;
    chart
        .configure_mesh()
        .x_labels(x_labels)
        .y_labels(y_labels)
        .bold_line_style(grey(205))
        .light_line_style(grey(235))
        .axis_style(stroke(&INK, 1.0))
        .set_all_tick_mark_size(px(5))
        .label_style(font(numbers, INK))
        .axis_desc_style(font(names, INK))
        .x_desc(x_name)
        .y_desc(y_name)
        .draw()?;
    Ok(chart)
}

/// Dashes through points in the units of a frame.
pub(super) fn dashes(chart: &mut Frame<'_>, points: Vec<(f64, f64)>, style: ShapeStyle) -> Drawn {
    chart.draw_series(DashedLineSeries::new(points, 9 * FINE, 6 * FINE, style))?;
    Ok(())
}

/// What `draw` draws, as a picture of this size.
pub(super) fn picture((width, height): (u32, u32), draw: impl FnOnce(&Area<'_>) -> Drawn) -> Drawn<String> {
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, (width * FINE, height * FINE)).into_drawing_area();
        root.fill(&WHITE)?;
        draw(&root)?;
        root.present()?;
    }
    let large = format!("width=\"{}\" height=\"{}\"", width * FINE, height * FINE);
    Ok(svg.replacen(&large, &format!("width=\"{width}\" height=\"{height}\""), 1))
}

/// Writes a picture into a file.
pub(super) fn save(path: &Path, size: (u32, u32), draw: impl FnOnce(&Area<'_>) -> Drawn) -> Result<()> {
    let svg = picture(size, draw);
    let svg = svg.map_err(|error| Error::file(path, "cannot draw", std::io::Error::other(error.to_string())))?;
    write_file(path, svg.as_bytes())
}
