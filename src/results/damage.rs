//! `damage.svg`: the plate with the fraction of bonds of every point that cracks of the start cut or that broke; crack path, colour bar, scale.

use std::path::Path;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::format::PLAIN;
use super::output::write_file;
use super::pictures::plate::scale_bar;
use super::raster::{of_share, png};
use super::specimen_picture::sketch::Sketch;
use perilife_base::error::{Error, Result};
use perilife_base::raster::{PointGrid, Snapshot};
use perilife_base::units::MM;
use perilife_plate::specimen::geometry::bounding_box;
use perilife_plate::specimen::{Crack, Point};

/// Longer side of the plate, px, and its shorter one at the least, so that the words beside it have room.
const LONG_SIDE: f64 = 700.0;
const SHORT_SIDE: f64 = 360.0;
/// Width of the column with colour bar and legend, and room around all, px.
const COLUMN: f64 = 190.0;
const MARGIN: f64 = 24.0;
const TEXT: f64 = 14.0;
const INK: &str = "#282828";
const PATH: &str = "#0096ff";

#[derive(Debug, Clone, Copy)]
pub struct DamagePicture<'a> {
    pub grid: &'a PointGrid,
    pub snapshot: &'a Snapshot,
    pub cracks: &'a [Crack],
    /// Path of every tip, m.
    pub paths: &'a [Vec<Point>],
    /// Words below the legend: when this is.
    pub caption: &'a [String],
}

pub fn cycles_and_length(snapshot: &Snapshot) -> [String; 2] {
    [format!("N = {} cycles", PLAIN.whole(snapshot.cycles)), format!("crack length {:.2} mm", snapshot.crack_length / MM)]
}

impl DamagePicture<'_> {
    pub fn write(&self, path: &Path) -> Result<()> {
        let svg = self.svg().map_err(|e| Error::file(path, "cannot draw", std::io::Error::other(e)))?;
        write_file(path, svg.as_bytes())
    }

    /// SVG text. Points are the pixels of an image within it.
    /// Errors: an image that cannot be encoded.
    pub fn svg(&self) -> std::result::Result<String, png::EncodingError> {
        let places = (0..self.grid.point_at.len()).filter(|place| self.grid.point_at[*place].is_some());
        let mut middles: Vec<Point> = places.map(|place| position_of(self.grid, place)).collect();
        if middles.is_empty() {
            middles.push([0.0; 2]);
        }
        let spacing = if self.grid.spacing.is_finite() { self.grid.spacing } else { MM };
        // Half a square around the outermost points; a turned square reaches up to √2 of that.
        let half = 0.5 * spacing * (self.grid.angle.cos().abs() + self.grid.angle.sin().abs());
        let [low, high] = bounding_box(&middles);
        let size = [0, 1].map(|axis| high[axis] - low[axis] + 2.0 * half);
        let scale = LONG_SIDE / size[0].max(size[1]);
        let [width, height] = size.map(|length| length * scale);
        let mut sketch = Sketch::new(scale, [MARGIN - (low[0] - half) * scale, MARGIN + (high[1] + half) * scale]);
        let full_scale = full_scale(&self.snapshot.damage);
        self.draw_points(&mut sketch, full_scale)?;
        for path in self.paths {
            let places: Vec<Point> = path.iter().map(|place| sketch.place(*place)).collect();
            sketch.path(&places, PATH, 1.8, "");
        }
        for crack in self.cracks {
            sketch.path(&[sketch.place(crack.from), sketch.place(crack.to)], "black", 3.5, "");
        }
        self.draw_column(&mut sketch, [2.0 * MARGIN + width, MARGIN], full_scale);
        let height = height.max(SHORT_SIDE) + 2.0 * MARGIN;
        scale_bar(&mut sketch, [2.0 * MARGIN + width, height - MARGIN], [scale * MM, size[0] / MM], TEXT);
        let sentence = format!("Damage (fraction of broken bonds) over the plate; {}", self.caption.join(", "));
        Ok(sketch.picture([width + COLUMN + 3.0 * MARGIN, height], &sentence))
    }

    /// Every place of the lattice is a pixel, clear where there is no material.
    fn draw_points(&self, sketch: &mut Sketch, full_scale: f64) -> std::result::Result<(), png::EncodingError> {
        let PointGrid { columns, rows, spacing, angle, .. } = *self.grid;
        if columns * rows == 0 {
            return Ok(());
        }
        let pixel = |place: usize| {
            let Some(point) = self.grid.point_at[place] else { return [0; 4] };
            let damage = self.snapshot.damage.get(point as usize).copied().unwrap_or(0.0);
            let [r, g, b] = of_share(damage / full_scale);
            [r, g, b, 255]
        };
        // The first row of an image is its upper one.
        let pixels: Vec<[u8; 4]> =
            (0..rows).rev().flat_map(|row| (0..columns).map(move |column| row * columns + column)).map(pixel).collect();
        let image = STANDARD.encode(png([columns, rows], pixels.as_flattened())?);
        let (sin, cos) = angle.sin_cos();
        // Upper left corner of the lattice: half a spacing beyond its last row and its first column.
        let [along, up] = [-0.5 * spacing, (rows as f64 - 0.5) * spacing];
        let corner = [self.grid.origin[0] + cos * along - sin * up, self.grid.origin[1] + sin * along + cos * up];
        let size = [columns, rows].map(|count| count as f64 * spacing * sketch.scale);
        sketch.image(sketch.place(corner), size, -angle.to_degrees(), &image);
        Ok(())
    }

    fn draw_column(&self, sketch: &mut Sketch, [left, top]: Point, full_scale: f64) {
        for (line, words) in ["Damage (fraction of", "broken bonds)"].into_iter().enumerate() {
            sketch.name([left, top + TEXT * (1.0 + 1.35 * line as f64)], words, "start", TEXT, INK);
        }
        let (bar, thick, parts, start) = (150.0, 20.0, 50, top + 44.0);
        for part in 0..parts {
            let [r, g, b] = of_share(1.0 - (f64::from(part) + 0.5) / f64::from(parts));
            let colour = format!("#{r:02x}{g:02x}{b:02x}");
            let [y, below] = [part, part + 1].map(|part| start + bar * f64::from(part) / f64::from(parts));
            sketch.area(&[[left, y], [left + thick, y], [left + thick, below + 0.4], [left, below + 0.4]], &colour, 1.0);
        }
        for tick in 0..=5 {
            let y = start + bar - bar * f64::from(tick) / 5.0;
            sketch.path(&[[left + thick, y], [left + thick + 5.0, y]], INK, 1.0, "");
            let words = format!("{:.1}", full_scale * f64::from(tick) / 5.0);
            sketch.name([left + thick + 9.0, y + 0.35 * TEXT], &words, "start", TEXT, INK);
        }
        let mut y = start + bar + 32.0;
        for (name, colour, width) in [("initial crack", "black", 3.5), ("crack path", PATH, 1.8)] {
            sketch.path(&[[left, y - 0.35 * TEXT], [left + 28.0, y - 0.35 * TEXT]], colour, width, "");
            sketch.name([left + 36.0, y], name, "start", TEXT, INK);
            y += 1.5 * TEXT;
        }
        for line in self.caption {
            y += 1.5 * TEXT;
            sketch.name([left, y], line, "start", TEXT, INK);
        }
    }
}

/// Position of a lattice place, m.
pub(super) fn position_of(grid: &PointGrid, place: usize) -> Point {
    let (column, row) = ((place % grid.columns) as f64 * grid.spacing, (place / grid.columns) as f64 * grid.spacing);
    let (sin, cos) = grid.angle.sin_cos();
    [grid.origin[0] + cos * column - sin * row, grid.origin[1] + sin * column + cos * row]
}

/// Upper end of the colour bar: half of the bonds, or all where a point has lost more. A straight crack through full
/// neighbourhoods cuts at most 11 of 28 bonds of a point at a horizon ratio of 3.015, so 0.5 shows it well.
fn full_scale(damage: &[f64]) -> f64 {
    if damage.iter().any(|d| *d > 0.5) { 1.0 } else { 0.5 }
}
