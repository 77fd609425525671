//! What a case will take up, by arithmetic on its numbers alone: nothing is laid out for it.
//!
//! With the area A of the plate, the spacing Δ_l of level l, the area Z_l of points of level l and finer, b bonds a point (lattice vectors of
//! a half plane within the horizon ratio m, some π m²/2), and the length U of all rims and both flanks of all cracks:
//!
//! ```text
//! points  P = A / Δ_0² + Σ_l Z_l (1/Δ_l² - 1/Δ_(l-1)²)     bonds  B = b P
//! places  L = columns × rows of the lattices around the plate, and m rows of padding on every side
//! rim     R = min(U / Δ, P / m)
//! bytes     = BASE + (PLACE + PLACE_BOND b) L + rim(m) R, and factor(m) P ln P where all points are factorised
//! ```
//!
//! Z_l is bounded by the regions, each wider by the rings of levels around it. Coefficients are those of peak memory (`/usr/bin/time -v`) of
//! `perilife predict` on a square of 100 mm with one slant crack, which no symmetry halves, and stand beside the runs they are of.

use crate::bond_law::SurfaceCorrection;
use crate::refinement::{RefinedRegion, Refinement};
use crate::spacing::HORIZON_RATIO;
use perilife_base::error::{Result, input};
use perilife_base::input::Output;
use perilife_base::machine;
use perilife_base::units::{MM, round_mm};
use perilife_plate::specimen::Specimen;
use perilife_plate::specimen::geometry::{bounding_box, distance};

/// What a case will take up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// Points, or nodes; with levels an upper bound but for what the rims cut off.
    pub points: f64,
    /// Places of the lattices that hold them, empty ones among them.
    pub places: f64,
    pub bonds: f64,
    /// Memory at the peak of a run, bytes.
    pub bytes: f64,
    /// Pictures, tables and, where they are asked for, ParaView files, bytes.
    pub disk_bytes: f64,
    /// Bytes that go with the square of 1/Δ.
    of_area: f64,
    /// Bytes that go with 1/Δ.
    of_rim: f64,
    /// Spacing asked for, of the coarsest level, m.
    spacing: f64,
    /// What of the keys makes it large beside the spacing.
    other_keys: &'static str,
}

/// Points and bonds of a plate, of a case or a scene.
#[derive(Debug, Clone, Copy)]
pub struct PointPlate<'a> {
    pub specimen: &'a Specimen,
    /// Spacing of the coarsest level, m.
    pub spacing: f64,
    /// Horizon over spacing.
    pub horizon_ratio: f64,
    /// Angle of the lattice rows against x, rad.
    pub lattice_angle: f64,
    /// Where finer points lie.
    pub refinement: Option<&'a Refinement>,
}

/// Bytes of a process that has nothing but a case of hand calculation: 28 MB.
const BASE: f64 = 28e6;
/// Bytes of a lattice place and of each of its bonds, of which a body and the state of its bonds keep four each. With surface correction
/// `volume_and_surface` and the window: 59 and 127 MB at 4e4 and 1.6e5 points, m = 3.015; 76 and 172 MB at m = 6; 134 MB at 4e4 and m = 12.
/// The formula gives 61, 130, 77, 189 and 147 MB. Multigrid: 59 MB at 4e4.
const PLACE: f64 = 350.0;
/// See [`PLACE`]. Of empty places alone (`check` of an I of thin arms, 1.78e6 places) 209 MB at m = 3.015 and 724 MB at m = 6.
const PLACE_BOND: f64 = 8.0;
/// Bytes of a spacing of rim under `volume_and_surface`.
const RIM_PLAIN: f64 = 14e3;
/// Bytes of a spacing of rim under `balanced`, whose equations couple m rows of points. With the window: 77, 132 and 241 MB at 1e4, 4e4
/// and 1.6e5 points, m = 3.015; 290, 576 and 1166 MB at m = 6; 1237 and 2744 MB at 1e4 and m = 9 and 12.
const RIM_BALANCED: &Curve = &[(3.015, 94e3), (6.0, 545e3), (9.0, 2.55e6), (12.0, 5.9e6)];
/// Bytes over P ln P of a sparse factor of all points, which nested dissection fills in so: 242 MB at 1e4 points, m =
/// 3.015. Three levels, whose equilibrium is factorised whole: 232 and 982 MB at 8848 and 34 300 points, m = 3.015; 422 MB at 8848 and m = 5.
const FACTOR: &Curve = &[(3.015, 2.7e3), (5.0, 4.9e3)];
/// Bytes of a node of the element-free method: 247 MB with `nodes = 5000`.
const NODE: f64 = 44e3;
/// Bytes on disk for ParaView: a dozen moments of 140 bytes a point.
const DISK_POINT: f64 = 12.0 * 140.0;
/// The same of a node, with the raster of its fields: 20 MB with `nodes = 5000`.
const DISK_NODE: f64 = 4e3;
/// Bytes on disk of the pictures of a point: 120 kB at 2e4 points, tables among them.
const PICTURE_POINT: f64 = 10.0;
/// The same of a node, which charts of nodes show one by one: 1.9 MB at 1200 nodes beside those that refine them.
const PICTURE_NODE: f64 = 1.5e3;
/// Bytes on disk of charts and tables.
const DISK_BASE: f64 = 5e5;

/// Bytes by horizon ratio.
pub type Curve = [(f64, f64)];

impl PointPlate<'_> {
    /// Lattice vectors within the horizon in a half plane: bonds of a point inside.
    pub fn bonds_of_point(&self) -> f64 {
        let reach = self.horizon_ratio.floor() as i32;
        let near = |dx: i32, dy: i32| f64::from(dx * dx + dy * dy).sqrt() <= self.horizon_ratio;
        let half = (0..=reach).flat_map(|dy| (-reach..=reach).map(move |dx| (dx, dy)));
        half.filter(|&(dx, dy)| (dy > 0 || dx > 0) && near(dx, dy)).count() as f64
    }

    /// Places of a lattice of this spacing around the plate, padded on every side.
    fn places_at(&self, spacing: f64) -> f64 {
        let [low, high] = bounding_box(&self.specimen.outline);
        let [width, height] = [0, 1].map(|i| high[i] - low[i]);
        let (sin, cos) = self.lattice_angle.sin_cos();
        let count = |a: f64, b: f64| ((width * a.abs() + height * b.abs()) / spacing).ceil() + 2.0 * self.horizon_ratio.floor();
        count(cos, sin) * count(sin, cos)
    }

    /// Times that points of the finest level were split.
    fn deepest(&self) -> usize {
        self.refinement.map_or(0, Refinement::deepest)
    }

    fn spacing_of(&self, level: usize) -> f64 {
        self.spacing / 2.0_f64.powi(level as i32)
    }

    /// Area of the points of this level and finer ones, m², or more.
    fn area_of(&self, level: usize) -> f64 {
        let regions = self.refinement.map_or(&[][..], |refinement| &refinement.regions);
        let of_region = |(region, levels): &(RefinedRegion, usize)| {
            // Places whose middle lies in the region are split, and then those whose horizon reaches over two levels.
            let ring = |finer: usize| (self.horizon_ratio + 1.0) * self.spacing_of(finer - 1);
            let rings: f64 = (level..*levels).map(ring).sum();
            area(region, rings + self.spacing_of(level - 1), self.specimen)
        };
        let areas = regions.iter().filter(|(_, levels)| *levels >= level).map(of_region);
        areas.sum::<f64>().min(self.specimen.area())
    }

    pub fn points(&self) -> f64 {
        let density = |level: usize| self.spacing_of(level).powi(-2);
        let finer = (1..=self.deepest()).map(|level| self.area_of(level) * (density(level) - density(level - 1)));
        self.specimen.area() * density(0) + finer.sum::<f64>()
    }

    /// Places of the lattices of all levels.
    pub fn places(&self) -> f64 {
        (0..=self.deepest()).map(|level| self.places_at(self.spacing_of(level))).sum()
    }

    /// Spacings on all rims and both flanks of all cracks, at the finest spacing.
    fn rim(&self) -> f64 {
        let specimen = self.specimen;
        let outline = (0..specimen.outline.len())
            .map(|i| distance(specimen.outline[i], specimen.outline[(i + 1) % specimen.outline.len()]));
        let holes = specimen.holes.iter().map(|hole| 2.0 * std::f64::consts::PI * hole.radius);
        let slots = specimen.slots.iter().map(|slot| 2.0 * (distance(slot.from, slot.to) + slot.width));
        let cracks = specimen.cracks.iter().map(|crack| 2.0 * distance(crack.from, crack.to));
        let length: f64 = outline.chain(holes).chain(slots).chain(cracks).sum();
        // Of thin arms all points are at a rim.
        (length / self.finest()).min(self.points() / self.horizon_ratio)
    }

    /// What it takes up, with so many bytes a bond of a net beside the lattice, and with or without a factor
    /// of all points.
    pub fn budget(&self, correction: SurfaceCorrection, of_net_bond: f64, is_factorised: bool) -> Budget {
        let (points, places, bonds) = (self.points(), self.places(), self.bonds_of_point());
        let factor = if is_factorised { along(FACTOR, self.horizon_ratio) * points.max(2.0).ln() } else { 0.0 };
        let of_area = (PLACE + PLACE_BOND * bonds) * places + (of_net_bond * bonds + factor) * points;
        let of_rim = match correction {
            SurfaceCorrection::Balanced => along(RIM_BALANCED, self.horizon_ratio),
            SurfaceCorrection::None | SurfaceCorrection::VolumeAndSurface => RIM_PLAIN,
        } * self.rim();
        let other_keys = match self.refinement {
            Some(_) => ", fewer levels or smaller regions of [refinement]",
            None if self.horizon_ratio > HORIZON_RATIO => ", or a smaller model.horizon_ratio",
            None => "",
        };
        let (bytes, disk_bytes) = (BASE + of_area + of_rim, DISK_BASE);
        let (bonds, spacing) = (bonds * points, self.spacing);
        Budget { points, places, bonds, bytes, disk_bytes, of_area, of_rim, spacing, other_keys }
    }

    /// Spacing of the finest level, m.
    pub fn finest(&self) -> f64 {
        self.spacing_of(self.deepest())
    }
}

/// Area of the places within `wider` of a region, m², or more.
fn area(region: &RefinedRegion, wider: f64, specimen: &Specimen) -> f64 {
    let around = |length: f64, wide: f64| 2.0 * wide * length + std::f64::consts::PI * wide * wide;
    match *region {
        RefinedRegion::Box { low, high } => {
            let [least, most] = bounding_box(&specimen.outline);
            let side = |i: usize| ((high[i] + wider).min(most[i]) - (low[i] - wider).max(least[i])).max(0.0);
            side(0) * side(1)
        }
        RefinedRegion::Band { from, to, width } => around(distance(from, to), 0.5 * width + wider),
        RefinedRegion::AroundFlaws { distance: away } => {
            let wide = away + wider;
            let cracks = specimen.cracks.iter().map(|crack| around(distance(crack.from, crack.to), wide));
            let slots = specimen.slots.iter().map(|slot| around(distance(slot.from, slot.to), wide + 0.5 * slot.width));
            cracks.chain(slots).sum()
        }
    }
}

/// A curve at a ratio: powers between its points and beyond its last one.
fn along(curve: &Curve, ratio: f64) -> f64 {
    let last = curve.len() - 1;
    let upper = curve.partition_point(|(at, _)| *at < ratio).clamp(1, last);
    let [(x0, y0), (x1, y1)] = [curve[upper - 1], curve[upper]];
    y0 * (ratio.max(curve[0].0) / x0).powf((y1 / y0).ln() / (x1 / x0).ln())
}

impl Budget {
    /// The same with the files that are asked for.
    pub fn with_files(self, output: Output) -> Budget {
        // Nodes lie on no lattice.
        let (pictures, fields) = if self.places == 0.0 { (PICTURE_NODE, DISK_NODE) } else { (PICTURE_POINT, DISK_POINT) };
        let of_point = pictures + if output.paraview { fields } else { 0.0 };
        Budget { disk_bytes: self.disk_bytes + of_point * self.points, ..self }
    }

    /// That of a hand calculation.
    pub fn of_formula() -> Budget {
        Budget { bytes: BASE, disk_bytes: DISK_BASE, ..Budget::none() }
    }

    /// Nodes of a plate of this area, m², so far apart, m, away from cracks and rims, which are few beside them where memory matters.
    pub fn of_nodes(area: f64, far: f64) -> Budget {
        let nodes = area / (far * far);
        let of_area = NODE * nodes;
        Budget { points: nodes, bytes: BASE + of_area, disk_bytes: DISK_BASE, of_area, spacing: far, ..Budget::none() }
    }

    fn none() -> Budget {
        let [points, places, bonds, bytes, disk_bytes, of_area, of_rim, spacing] = [0.0; 8];
        Budget { points, places, bonds, bytes, disk_bytes, of_area, of_rim, spacing, other_keys: "" }
    }

    /// Refuses what takes up more than so many bytes of memory.
    /// Errors: [`perilife_base::error::Error::Input`] on `model.spacing_mm` with both figures and a spacing that fits, or on `model.nodes` with
    /// such a number.
    pub fn within(&self, bytes: f64) -> Result<()> {
        if self.bytes <= bytes {
            return Ok(());
        }
        let problem = format!(
            "needs {:.2e} points, {:.2e} lattice positions and {:.2e} bonds, about {} of memory; limit {}",
            self.points,
            self.places,
            self.bonds,
            gigabytes(self.bytes),
            gigabytes(bytes)
        );
        // of_area / x² + of_rim / x = what is left
        let left = (bytes - BASE).max(0.01 * bytes);
        let coarser = (self.of_rim + (self.of_rim.powi(2) + 4.0 * left * self.of_area).sqrt()) / (2.0 * left);
        self.refusal(problem, coarser, self.other_keys)
    }

    /// Refuses more points than so many.
    pub fn within_points(&self, most: f64) -> Result<()> {
        if self.points <= most {
            return Ok(());
        }
        let problem = format!("gives {:.3e} points; limit {most:.3e}", self.points);
        self.refusal(problem, (self.points / most).sqrt(), self.other_keys)
    }

    fn refusal(&self, problem: String, coarser: f64, other_keys: &str) -> Result<()> {
        // Nodes lie on no lattice.
        if self.places == 0.0 {
            let fewer = (0.9 * self.points / coarser.powi(2)).max(1.0);
            let digit = 10.0_f64.powf(fewer.log10().floor() - 2.0).max(1.0);
            let remedy = format!("give about {} or fewer", (fewer / digit).floor() * digit);
            return Err(input("model.nodes", self.points.round(), problem, remedy));
        }
        let spacing = self.spacing / MM;
        let wide = 1.05 * spacing * coarser;
        // Three digits, upwards.
        let digit = 10.0_f64.powf(wide.log10().floor() - 2.0);
        let wide = round_mm((wide / digit).ceil() * digit * MM);
        Err(input("model.spacing_mm", round_mm(self.spacing), problem, format!("give about {wide} mm or more{other_keys}")))
    }

    /// What it takes up, in words.
    pub fn words(&self) -> String {
        format!("about {} of memory, {} of files", megabytes(self.bytes), megabytes(self.disk_bytes))
    }

    /// Refuses what takes up more memory than this process may still take ([`machine::free_bytes`]).
    pub fn within_machine(&self) -> Result<()> {
        machine::free_bytes().map_or(Ok(()), |free| self.within(free))
    }
}

fn megabytes(bytes: f64) -> String {
    if bytes < 1e9 { format!("{:.0} MB", bytes / 1e6) } else { gigabytes(bytes) }
}

fn gigabytes(bytes: f64) -> String {
    format!("{:.2} GB", bytes / 1e9)
}
