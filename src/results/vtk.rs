//! ParaView files: one file per snapshot and a `run.pvd` that lists them with the cycles as time.
//!
//! An unturned lattice is an image (`.vti`), places outside the material are blanked by `vtkGhostType`; a turned one is a mesh
//! of squares between points (`.vtu`). Coordinates in mm. Data are appended raw, little-endian, with 64-bit lengths
//! (VTK XML format 1.0).

use std::fmt::Write as _;
use std::path::Path;

use super::damage::position_of;
use super::output::write_file;
use perilife_base::error::{Error, Result};
use perilife_base::input::Output;
use perilife_base::raster::{PointGrid, Snapshot};
use perilife_base::units::{MM, MPA};

/// Folder of the ParaView files in that of a run.
pub const PARAVIEW: &str = "paraview";

/// Writes all snapshots into the folder of a run where `[output]` asks for them.
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

/// A snapshot on an unturned lattice as `.vti`.
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
    data.reals(
        &mut body,
        "points",
        3,
        place_of.iter().map(|(_, place)| {
            let [x, y] = position_of(grid, *place);
            [x / MM, y / MM, 0.0]
        }),
    );
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
