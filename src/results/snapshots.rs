//! Snapshots of a plate: `damage.svg`, the fraction of bonds of every point that cracks of the start cut or that broke; ParaView files, one per
//! snapshot and a `run.pvd` that lists them with the cycles as time.
//!
//! An unturned lattice is an image (`.vti`), places outside the material are blanked by `vtkGhostType`; a turned one is a mesh
//! of squares between points (`.vtu`). Coordinates in mm. Data are appended raw, little-endian, with 64-bit lengths
//! (VTK XML format 1.0).

use std::fmt::Write as _;
use std::path::Path;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::format::PLAIN;
use super::output::write_file;
use super::pictures::plate::scale_bar;
use super::specimen_picture::sketch::Sketch;
use perilife_base::error::{Error, Result};
use perilife_base::input::Output;
use perilife_base::raster::{PointGrid, Snapshot};
use perilife_base::units::{MM, MPA};
use perilife_plate::specimen::geometry::bounding_box;
use perilife_plate::specimen::{Crack, Point};

pub const PARAVIEW: &str = "paraview";

pub fn write_wanted(folder: &Path, output: Output, grid: &PointGrid, snapshots: &[Snapshot]) -> Result<()> {
    if !output.paraview || snapshots.is_empty() {
        return Ok(());
    }
    let paraview = folder.join(PARAVIEW);
    std::fs::create_dir(&paraview).map_err(|error| Error::file(&paraview, "cannot create the folder", error))?;
    write_series(&paraview, grid, snapshots)
}

/// Writes all snapshots into `folder` (which must exist), with `run.pvd` as the file to open.
pub fn write_series(folder: &Path, grid: &PointGrid, snapshots: &[Snapshot]) -> Result<()> {
    let extension = if grid.angle == 0.0 { "vti" } else { "vtu" };
    let mut list = String::from(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n",
    );
    for (number, snapshot) in snapshots.iter().enumerate() {
        let name = format!("plate_{number:04}.{extension}");
        let bytes = if grid.angle == 0.0 { image(grid, snapshot) } else { mesh(grid, snapshot) };
        write_file(&folder.join(&name), &bytes)?;
        // Writing to a String cannot fail.
        let _ = writeln!(list, "<DataSet timestep=\"{}\" group=\"\" part=\"0\" file=\"{name}\"/>", snapshot.cycles);
    }
    list.push_str("</Collection>\n</VTKFile>\n");
    write_file(&folder.join("run.pvd"), list.as_bytes())
}

pub fn image(grid: &PointGrid, snapshot: &Snapshot) -> Vec<u8> {
    let extent = format!("0 {} 0 {} 0 0", grid.columns.saturating_sub(1), grid.rows.saturating_sub(1));
    let (x, y, step) = (grid.origin[0] / MM, grid.origin[1] / MM, grid.spacing / MM);
    let mut data = Appended::default();
    let mut body = format!(
        "<ImageData WholeExtent=\"{extent}\" Origin=\"{x} {y} 0\" Spacing=\"{step} {step} {step}\">\n<Piece Extent=\"{extent}\">\n\
         <PointData Scalars=\"damage\" Vectors=\"displacement_mm\">\n"
    );
    data.fields(&mut body, snapshot, &grid.point_at);
    // 2 = hidden point: ParaView draws nothing there and filters leave it out.
    data.bytes(&mut body, "vtkGhostType", grid.point_at.iter().map(|point| if point.is_some() { 0 } else { 2 }));
    body.push_str("</PointData>\n</Piece>\n</ImageData>\n");
    data.file("ImageData", &body)
}

/// A snapshot on a turned lattice as `.vtu`: points of the material, squares between four neighbours.
pub fn mesh(grid: &PointGrid, snapshot: &Snapshot) -> Vec<u8> {
    let mut place_of: Vec<(u32, usize)> =
        grid.point_at.iter().enumerate().filter_map(|(place, p)| Some(((*p)?, place))).collect();
    place_of.sort_unstable();
    let squares = squares(grid, &place_of);
    let mut data = Appended::default();
    let mut body = format!(
        "<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<Points>\n",
        place_of.len(),
        squares.len()
    );
    let positions = place_of.iter().map(|(_, place)| position_of(grid, *place));
    data.reals(&mut body, "points", 3, positions.map(|[x, y]| [x / MM, y / MM, 0.0]));
    body.push_str("</Points>\n<Cells>\n");
    data.integers(&mut body, "connectivity", squares.iter().flatten().copied());
    data.integers(&mut body, "offsets", (1..=squares.len() as i64).map(|i| 4 * i));
    data.bytes(&mut body, "types", squares.iter().map(|_| 9)); // 9 = quadrilateral
    body.push_str("</Cells>\n<PointData Scalars=\"damage\" Vectors=\"displacement_mm\">\n");
    let points: Vec<Option<u32>> = place_of.iter().map(|(point, _)| Some(*point)).collect();
    data.fields(&mut body, snapshot, &points);
    body.push_str("</PointData>\n</Piece>\n</UnstructuredGrid>\n");
    data.file("UnstructuredGrid", &body)
}

/// Squares whose four corners are material, as positions in the sorted list of points, counter-clockwise.
fn squares(grid: &PointGrid, place_of: &[(u32, usize)]) -> Vec<[i64; 4]> {
    let mut number_at = vec![None; grid.point_at.len()];
    for (number, (_, place)) in (0i64..).zip(place_of) {
        number_at[*place] = Some(number);
    }
    let corner = |column: usize, row: usize| number_at[row * grid.columns + column];
    let mut squares = Vec::new();
    for row in 0..grid.rows.saturating_sub(1) {
        for column in 0..grid.columns.saturating_sub(1) {
            let corners = [corner(column, row), corner(column + 1, row), corner(column + 1, row + 1), corner(column, row + 1)];
            if let [Some(a), Some(b), Some(c), Some(d)] = corners {
                squares.push([a, b, c, d]);
            }
        }
    }
    squares
}

/// Arrays at the end of the file: each is its length in bytes as u64, then the bytes; the XML names the offset.
#[derive(Default)]
struct Appended {
    bytes: Vec<u8>,
}

impl Appended {
    /// The fields of a snapshot at these points; places without a point have those of whole material at rest.
    fn fields(&mut self, xml: &mut String, snapshot: &Snapshot, points: &[Option<u32>]) {
        let mut scalar = |name: &str, values: &[f64], whole: f64, unit: f64| {
            let at = |point: &Option<u32>| [point.map_or(whole, |p| values.get(p as usize).copied().unwrap_or(0.0) / unit)];
            self.reals(xml, name, 1, points.iter().map(at));
        };
        scalar("damage", &snapshot.damage, 0.0, 1.0);
        if !snapshot.remaining_life.is_empty() {
            scalar("remaining_life", &snapshot.remaining_life, 1.0, 1.0);
        }
        if !snapshot.stress.is_empty() {
            scalar("von_mises_mpa", &snapshot.stress, 0.0, MPA);
        }
        let moved = |point: &Option<u32>| {
            let u = point.and_then(|p| snapshot.displacement.get(p as usize));
            u.map_or([0.0; 3], |[x, y]| [x / MM, y / MM, 0.0])
        };
        self.reals(xml, "displacement_mm", 3, points.iter().map(moved));
    }

    fn reals<const N: usize>(&mut self, xml: &mut String, name: &str, components: usize, values: impl Iterator<Item = [f64; N]>) {
        let bytes: Vec<u8> = values.flatten().flat_map(f64::to_le_bytes).collect();
        self.array(xml, "Float64", name, components, &bytes);
    }

    fn integers(&mut self, xml: &mut String, name: &str, values: impl Iterator<Item = i64>) {
        let bytes: Vec<u8> = values.flat_map(i64::to_le_bytes).collect();
        self.array(xml, "Int64", name, 1, &bytes);
    }

    fn bytes(&mut self, xml: &mut String, name: &str, values: impl Iterator<Item = u8>) {
        let bytes: Vec<u8> = values.collect();
        self.array(xml, "UInt8", name, 1, &bytes);
    }

    fn array(&mut self, xml: &mut String, kind: &str, name: &str, components: usize, bytes: &[u8]) {
        let offset = self.bytes.len();
        // Writing to a String cannot fail.
        let _ = writeln!(
            xml,
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>"
        );
        self.bytes.extend((bytes.len() as u64).to_le_bytes());
        self.bytes.extend(bytes);
    }

    fn file(self, kind: &str, body: &str) -> Vec<u8> {
        let head = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
             {body}<AppendedData encoding=\"raw\">\n_"
        );
        let mut file = head.into_bytes();
        file.extend(self.bytes);
        file.extend(b"\n</AppendedData>\n</VTKFile>\n");
        file
    }
}

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

/// An image of so many columns and rows as PNG; four bytes a pixel: red, green, blue, cover.
pub fn png([columns, rows]: [usize; 2], pixels: &[u8]) -> std::result::Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, columns as u32, rows as u32);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(pixels)?;
    Ok(bytes)
}

/// An opaque colour, 8 bits a channel.
pub type Rgb = [u8; 3];

/// Colour of a share from 0 (pale sand) to 1 (deep violet).
///
/// The path runs through OKLab (Ottosson 2020) with lightness falling linearly, so equal steps of damage look equally large,
/// also in grey print; hue turns from yellow over red to violet.
pub fn of_share(share: f64) -> Rgb {
    let t = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
    let lightness = 0.94 - 0.70 * t;
    let chroma = 0.03 + 0.145 * (std::f64::consts::PI * t.powf(0.8)).sin().max(0.0) + 0.05 * t;
    let hue = (95.0 - 170.0 * t).to_radians();
    from_oklab(lightness, chroma * hue.cos(), chroma * hue.sin())
}

/// OKLab to sRGB (matrices of Ottosson 2020); colours beyond the screen's range are clipped.
fn from_oklab(lightness: f64, a: f64, b: f64) -> Rgb {
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    let linear = [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ];
    linear.map(|value| {
        let v = value.clamp(0.0, 1.0);
        let encoded = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
        (255.0 * encoded).round() as u8
    })
}
