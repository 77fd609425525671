//! Picture of the damaged plate: one square a point, coloured by the fraction of its bonds that cracks of the start cut or
//! that broke, or by stress on the deformed plate; crack path, colour bar, scale.

use std::path::Path;

use super::output::write_file;
use super::raster::{Canvas, Rgb, of_share};
use crate::error::{Error, Result};
use crate::predict::{PointGrid, Snapshot};
use crate::specimen::{Crack, Point};
use crate::units::{MM, MPA};

/// The plate's longer side has at least so many pixels.
const LONG_SIDE: f64 = 1000.0;
/// Width of the column with colour bar and legend, px.
const COLUMN: i64 = 330;
/// Height that column needs, px.
const COLUMN_HEIGHT: i64 = 470;
const MARGIN: i64 = 30;
const LETTER: i64 = 2;
const INK: Rgb = [40, 40, 40];
const INITIAL_CRACK: Rgb = [0, 0, 0];
const PATH: Rgb = [0, 150, 255];

/// What points are coloured by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointField {
    /// Fraction of a point's bonds that are gone: cut by a crack of the start, or broken.
    Damage,
    /// Von Mises stress, on the deformed plate.
    VonMises,
}

impl PointField {
    fn value(self, snapshot: &Snapshot, point: usize) -> f64 {
        match self {
            PointField::Damage => snapshot.damage.get(point).copied().unwrap_or(0.0),
            PointField::VonMises => snapshot.stress.get(point).copied().unwrap_or(0.0) / MPA,
        }
    }

    fn words(self) -> [&'static str; 2] {
        match self {
            PointField::Damage => ["damage", "bonds cut or broken"],
            PointField::VonMises => ["von Mises stress, MPa", "crack drawn open"],
        }
    }

    /// Upper end of the colour bar.
    fn full_scale(self, snapshot: &Snapshot) -> f64 {
        match self {
            PointField::Damage => full_scale(&snapshot.damage),
            PointField::VonMises => high_end(&snapshot.stress) / MPA,
        }
    }
}

/// What the picture shows.
#[derive(Debug, Clone, Copy)]
pub struct DamagePicture<'a> {
    /// Lattice of the points.
    pub grid: &'a PointGrid,
    /// State of the plate.
    pub snapshot: &'a Snapshot,
    /// What points are coloured by.
    pub field: PointField,
    /// Cracks of the start.
    pub cracks: &'a [Crack],
    /// Path of every tip, m.
    pub paths: &'a [Vec<Point>],
    /// Words below the legend: when this is.
    pub caption: &'a [String],
}

/// The caption of a snapshot of cycles.
pub fn cycles_and_length(snapshot: &Snapshot) -> [String; 2] {
    let cycles = super::axis::grouped(&format!("{:.0}", snapshot.cycles), " ");
    [format!("N = {cycles} cycles"), format!("crack length {:.2} mm", snapshot.crack_length / MM)]
}

impl DamagePicture<'_> {
    /// Writes the picture as PNG.
    pub fn write(&self, path: &Path) -> Result<()> {
        let bytes = self.png().map_err(|e| Error::file(path, "cannot draw", std::io::Error::other(e)))?;
        write_file(path, &bytes)
    }

    /// The picture as bytes of a PNG file.
    pub fn png(&self) -> std::result::Result<Vec<u8>, png::EncodingError> {
        self.canvas().png()
    }

    fn canvas(&self) -> Canvas {
        let view = View::of(self.grid);
        let height = view.height.max(COLUMN_HEIGHT) + 2 * MARGIN;
        let mut canvas = Canvas::new((view.width + COLUMN + 3 * MARGIN) as usize, height as usize);
        let full_scale = self.field.full_scale(self.snapshot);
        let is_deformed = self.field == PointField::VonMises;
        if is_deformed {
            self.draw_deformed(&mut canvas, &view, full_scale);
        } else {
            self.draw_points(&mut canvas, &view, full_scale);
        }
        // On a deformed plate an open crack shows by itself.
        let (paths, cracks) = if is_deformed { (&[][..], &[][..]) } else { (self.paths, self.cracks) };
        for path in paths {
            let line: Vec<[f64; 2]> = path.iter().map(|point| view.pixel(*point)).collect();
            canvas.line(&line, 2.5, PATH);
        }
        for crack in cracks {
            canvas.line(&[view.pixel(crack.from), view.pixel(crack.to)], 5.0, INITIAL_CRACK);
        }
        self.draw_column(&mut canvas, &view, full_scale);
        canvas
    }

    /// Every pixel asks which point it belongs to, so turned lattices need nothing special.
    fn draw_points(&self, canvas: &mut Canvas, view: &View, full_scale: f64) {
        let whole = of_share(0.0);
        for row in 0..view.height {
            for column in 0..view.width {
                let (x, y) = (MARGIN + column, MARGIN + row);
                let Some(point) = place_at(self.grid, view.point([x as f64 + 0.5, y as f64 + 0.5])) else { continue };
                let value = self.field.value(self.snapshot, point);
                canvas.set(x, y, if value == 0.0 { whole } else { of_share(value / full_scale) });
            }
        }
    }

    /// What is left of the displacements without the rigid motion and the uniform strain nearest to them, drawn larger so that the
    /// largest is a hundredth of the plate: a crack shows by how it opens.
    fn drawn_displacement(&self) -> Vec<Point> {
        let displacement = &self.snapshot.displacement;
        let mut at = vec![[0.0; 2]; displacement.len()];
        for (place, point) in self.grid.point_at.iter().enumerate() {
            if let Some(point) = point.filter(|point| (*point as usize) < at.len()) {
                at[point as usize] = position_of(self.grid, place);
            }
        }
        let count = at.len().max(1) as f64;
        let mean = |of: &dyn Fn(usize) -> f64| (0..at.len()).map(of).sum::<f64>() / count;
        let [x0, y0] = [mean(&|k| at[k][0]), mean(&|k| at[k][1])];
        let [xx, yy, xy] = [
            mean(&|k| (at[k][0] - x0).powi(2)),
            mean(&|k| (at[k][1] - y0).powi(2)),
            mean(&|k| (at[k][0] - x0) * (at[k][1] - y0)),
        ];
        let determinant = (xx * yy - xy * xy).max(f64::MIN_POSITIVE);
        let mut rest = displacement.clone();
        for i in 0..2 {
            let u0 = mean(&|k| displacement[k][i]);
            let [ux, uy] = [0, 1].map(|j| mean(&|k| (displacement[k][i] - u0) * (at[k][j] - [x0, y0][j])));
            let [gx, gy] = [(ux * yy - uy * xy) / determinant, (uy * xx - ux * xy) / determinant];
            rest.iter_mut().zip(&at).for_each(|(u, at)| u[i] -= u0 + gx * (at[0] - x0) + gy * (at[1] - y0));
        }
        let largest = rest.iter().map(|u| u[0].hypot(u[1])).fold(f64::MIN_POSITIVE, f64::max);
        let size = self.grid.columns.max(self.grid.rows) as f64 * self.grid.spacing;
        rest.iter().map(|u| u.map(|u| u * size / (100.0 * largest))).collect()
    }

    /// Every point as a square where it has moved to, a little larger than its share: faces that part leave a gap.
    fn draw_deformed(&self, canvas: &mut Canvas, view: &View, full_scale: f64) {
        let moved = self.drawn_displacement();
        let side = (1.3 * self.grid.spacing * view.pixels_per_metre).ceil() as i64;
        for (place, point) in self.grid.point_at.iter().enumerate() {
            let Some((point, u)) = point.and_then(|point| Some((point as usize, moved.get(point as usize)?))) else { continue };
            let at = position_of(self.grid, place);
            let [x, y] = view.pixel([at[0] + u[0], at[1] + u[1]]);
            let share = (self.field.value(self.snapshot, point) / full_scale).min(1.0);
            canvas.fill([x.round() as i64 - side / 2, y.round() as i64 - side / 2], [side, side], of_share(share));
        }
    }

    fn draw_column(&self, canvas: &mut Canvas, view: &View, full_scale: f64) {
        let left = 2 * MARGIN + view.width;
        let mut y = MARGIN;
        let say = |canvas: &mut Canvas, text: &str, dx: i64, y: i64| canvas.text(text, [left + dx, y], LETTER, INK);
        let [name, meaning] = self.field.words();
        say(canvas, name, 0, y);
        say(canvas, meaning, 0, y + 24);
        y += 60;
        let (bar, thick) = (200, 28);
        canvas.fill([left - 1, y - 1], [thick + 2, bar + 2], INK);
        for step in 0..bar {
            canvas.fill([left, y + step], [thick, 1], of_share(1.0 - (step as f64 + 0.5) / bar as f64));
        }
        for tick in 0..=5 {
            let at = y + bar - bar * tick / 5;
            canvas.fill([left + thick, at - 1], [6, 2], INK);
            say(canvas, &format!("{:.1$}", full_scale * tick as f64 / 5.0, 2), thick + 14, at - 7);
        }
        y += bar + 34;
        let is_deformed = self.field == PointField::VonMises;
        let lines = [("initial crack", INITIAL_CRACK, 5.0), ("crack path", PATH, 2.5)];
        for (name, colour, width) in lines.into_iter().filter(|_| !is_deformed) {
            canvas.line(&[[(left + 2) as f64, y as f64], [(left + 42) as f64, y as f64]], width, colour);
            say(canvas, name, 56, y - 7);
            y += 28;
        }
        let (length, name) = scale_bar(view.pixels_per_metre);
        y += 8;
        canvas.fill([left, y], [length, 3], INK);
        for end in [0, length - 3] {
            canvas.fill([left + end, y - 6], [3, 15], INK);
        }
        say(canvas, &name, length + 12, y - 6);
        y += 34;
        for line in self.caption {
            say(canvas, line, 0, y);
            y += 26;
        }
    }
}

/// From metres to pixels: y points up in the plate and down on the picture.
struct View {
    pixels_per_metre: f64,
    left: f64,
    top: f64,
    width: i64,
    height: i64,
}

impl View {
    fn of(grid: &PointGrid) -> View {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for (place, _) in grid.point_at.iter().enumerate().filter(|(_, point)| point.is_some()) {
            let position = position_of(grid, place);
            for axis in 0..2 {
                low[axis] = low[axis].min(position[axis]);
                high[axis] = high[axis].max(position[axis]);
            }
        }
        if low[0] > high[0] {
            (low, high) = ([0.0; 2], [grid.spacing; 2]);
        }
        // Half a square around the outermost points; a turned square reaches up to √2 of that.
        let half = 0.5 * grid.spacing * (grid.angle.cos().abs() + grid.angle.sin().abs());
        let size = [0, 1].map(|axis| high[axis] - low[axis] + 2.0 * half);
        // Whole pixels a point, so that all squares are equally large.
        let pixels_per_point = (LONG_SIDE * grid.spacing / size[0].max(size[1])).ceil().max(1.0);
        let pixels_per_metre = pixels_per_point / grid.spacing;
        let [width, height] = size.map(|length| ((length * pixels_per_metre).round() as i64).max(1));
        View { pixels_per_metre, left: low[0] - half, top: high[1] + half, width, height }
    }

    fn pixel(&self, point: Point) -> [f64; 2] {
        let scale = self.pixels_per_metre;
        [MARGIN as f64 + (point[0] - self.left) * scale, MARGIN as f64 + (self.top - point[1]) * scale]
    }

    fn point(&self, pixel: [f64; 2]) -> Point {
        let scale = self.pixels_per_metre;
        [self.left + (pixel[0] - MARGIN as f64) / scale, self.top - (pixel[1] - MARGIN as f64) / scale]
    }
}

/// Position of a lattice place, m.
pub(super) fn position_of(grid: &PointGrid, place: usize) -> Point {
    let (column, row) = ((place % grid.columns) as f64 * grid.spacing, (place / grid.columns) as f64 * grid.spacing);
    let (sin, cos) = grid.angle.sin_cos();
    [grid.origin[0] + cos * column - sin * row, grid.origin[1] + sin * column + cos * row]
}

/// Index of the point whose square holds a position.
fn place_at(grid: &PointGrid, position: Point) -> Option<usize> {
    let (dx, dy) = (position[0] - grid.origin[0], position[1] - grid.origin[1]);
    let (sin, cos) = grid.angle.sin_cos();
    let column = ((cos * dx + sin * dy) / grid.spacing).round();
    let row = ((cos * dy - sin * dx) / grid.spacing).round();
    let inside = column >= 0.0 && row >= 0.0 && column < grid.columns as f64 && row < grid.rows as f64;
    if !inside {
        return None;
    }
    grid.point_at.get(row as usize * grid.columns + column as usize).copied().flatten().map(|index| index as usize)
}

/// Upper end of a bar of stresses: what all but a hundredth of the points keep to, since it has no bound at a tip.
fn high_end(stress: &[f64]) -> f64 {
    let mut sorted: Vec<f64> = stress.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len().saturating_sub(1) * 99 / 100).copied().filter(|s| *s > 0.0).unwrap_or(MPA)
}

/// Upper end of the colour bar: half of the bonds, or all where a point has lost more. A straight crack through full
/// neighbourhoods cuts at most 11 of 28 bonds of a point at a horizon ratio of 3.015, so 0.5 shows it well.
fn full_scale(damage: &[f64]) -> f64 {
    if damage.iter().any(|d| *d > 0.5) { 1.0 } else { 0.5 }
}

/// A round length that is between 60 and 170 px long, with its name.
fn scale_bar(pixels_per_metre: f64) -> (i64, String) {
    let pixels_per_mm = pixels_per_metre * MM;
    let power = 10f64.powf((60.0 / pixels_per_mm).log10().floor());
    let length = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|mm| mm * pixels_per_mm >= 60.0).unwrap_or(power);
    let name = if length >= 1.0 { format!("{length:.0} mm") } else { format!("{length} mm") };
    ((length * pixels_per_mm).round() as i64, name)
}
