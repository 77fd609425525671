//! `[refinement]` of a scene: where finer points lie, and how points of several levels reach each other.

use toml::Value;

use perilife_base::error::{Result, input, input_missing};
use perilife_base::keys::{coordinate, key, length, number, section};
use perilife_base::units::{given_mm, round_mm};
use perilife_plate::specimen::geometry::{bounding_box, distance};
use perilife_plate::specimen::{Point, Specimen};

/// More than this is a slip.
const REGIONS_MAX: usize = 50;

perilife_base::kinds! {
    /// How points lie and reach each other.
    pub enum Discretisation for "model.discretisation" {
        Lattice = "lattice": "square lattice of one spacing",
        DualHorizon = "dual_horizon": "points of several levels, each split in four where refinement.regions say, with horizon and dual horizon (Ren et al. 2016); fracture scenes",
    }
}

/// Where finer points lie.
#[derive(Debug, Clone, PartialEq)]
pub struct Refinement {
    /// Regions with the number of times their points are split in four.
    pub regions: Vec<(RefinedRegion, usize)>,
}

/// A region of finer points.
#[derive(Debug, Clone, PartialEq)]
pub enum RefinedRegion {
    /// An upright box, m.
    Box {
        /// Lower left corner, m.
        low: Point,
        /// Upper right corner, m.
        high: Point,
    },
    /// Points within half a width of a line, m.
    Band {
        /// One end, m.
        from: Point,
        /// Other end, m.
        to: Point,
        /// Whole width, m.
        width: f64,
    },
    /// Points within so many metres of every crack and notch, levels graded outwards.
    AroundFlaws {
        /// Distance, m.
        distance: f64,
    },
}

impl Refinement {
    /// Times that the points of the finest level were split in four.
    pub fn deepest(&self) -> usize {
        self.regions.iter().map(|(_, levels)| *levels).max().unwrap_or(0)
    }

    pub fn words(&self) -> String {
        format!("{} regions, up to {} levels", self.regions.len(), self.deepest())
    }
}

perilife_base::keys! {
    /// Keys of `[refinement]`.
    pub struct RefinementKeys {
        regions: Vec<RegionKeys> = key("regions", "Regions of finer points");
    }
}
perilife_base::keys! {
    /// A region of finer points.
    pub struct RegionKeys {
        corners: Option<[Point; 2]> = coordinate("box_mm", "Box: two opposite corners [[x, y], [x, y]]");
        band: Option<[Point; 2]> = coordinate("band_mm", "Band: ends of its line [[x, y], [x, y]]");
        width: Option<f64> = length("width_mm", "Width of the band: full width");
        around_flaws: Option<f64> = length("around_flaws_mm", "Around every crack and notch: distance");
        levels: usize = number("levels", "Levels: successive splits of a point into four", "a number of levels", 1.0, 4.0);
    }
}

/// Reads `[refinement]`.
pub fn from_value(value: &Value, specimen: &Specimen) -> Result<Refinement> {
    let input: RefinementKeys = section(value, "refinement")?;
    const KEY: &str = "refinement.regions";
    if input.regions.is_empty() || input.regions.len() > REGIONS_MAX {
        let remedy = format!("give 1 to {REGIONS_MAX} regions {{ box_mm = [[x, y], [x, y]], levels = 1 }}");
        return Err(perilife_base::error::input(KEY, format!("{} regions", input.regions.len()), "is not a refinement", remedy));
    }
    let of = |(i, given): (usize, &RegionKeys)| one(given, &format!("{KEY}[{i}]"), specimen);
    Ok(Refinement { regions: input.regions.iter().enumerate().map(of).collect::<Result<_>>()? })
}

fn one(given: &RegionKeys, path: &str, specimen: &Specimen) -> Result<(RefinedRegion, usize)> {
    if let Some(width) = given.width.filter(|_| given.band.is_none()) {
        let problem = "is the width of a band, and there is no band";
        return Err(input(&format!("{path}.width_mm"), round_mm(width), problem, "remove it"));
    }
    let region = match (given.corners, given.band, given.around_flaws) {
        (Some(ends), None, None) => {
            let (low, high) = corners(&format!("{path}.box_mm"), ends, specimen)?;
            RefinedRegion::Box { low, high }
        }
        (None, Some(ends), None) => band(ends, given.width, path, specimen)?,
        (None, None, Some(distance)) => {
            let key = format!("{path}.around_flaws_mm");
            if specimen.cracks.is_empty() && specimen.slots.is_empty() {
                return Err(input(
                    &key,
                    round_mm(distance),
                    "has no crack or notch to refine",
                    "give cracks or notches, or a box",
                ));
            }
            RefinedRegion::AroundFlaws { distance }
        }
        _ => {
            let problem = "is not one of box_mm, band_mm with width_mm, and around_flaws_mm";
            return Err(input_missing(path, problem, "give one of them, with levels"));
        }
    };
    Ok((region, given.levels))
}

fn band([from, to]: [Point; 2], width: Option<f64>, path: &str, specimen: &Specimen) -> Result<RefinedRegion> {
    let key = format!("{path}.band_mm");
    if distance(from, to) < 1e-6 {
        return Err(input_missing(&key, "has zero length: its ends coincide", "give two different points"));
    }
    let width_key = format!("{path}.width_mm");
    let width = width.ok_or_else(|| input_missing(&width_key, "is missing", "give the full width of the band"))?;
    let half = width / 2.0;
    let low = [from[0].min(to[0]) - half, from[1].min(to[1]) - half];
    let high = [from[0].max(to[0]) + half, from[1].max(to[1]) + half];
    on_plate(&key, low, high, specimen)?;
    Ok(RefinedRegion::Band { from, to, width })
}

/// Lower left and upper right corner of a box given by two opposite corners, m, which meets the plate.
pub fn corners(path: &str, [from, to]: [Point; 2], specimen: &Specimen) -> Result<(Point, Point)> {
    let low = [from[0].min(to[0]), from[1].min(to[1])];
    let high = [from[0].max(to[0]), from[1].max(to[1])];
    if low[0] == high[0] || low[1] == high[1] {
        return Err(input_missing(path, "encloses no area", "give two opposite corners of a box"));
    }
    on_plate(path, low, high, specimen)?;
    Ok((low, high))
}

fn on_plate(path: &str, low: Point, high: Point, specimen: &Specimen) -> Result<()> {
    let [plate_low, plate_high] = bounding_box(&specimen.outline);
    if overlap(low, high, plate_low, plate_high) {
        return Ok(());
    }
    let problem = format!("is outside the plate, {} to {}", given_mm(plate_low), given_mm(plate_high));
    Err(input_missing(path, problem, "move it onto the plate"))
}

/// Whether two boxes share an area.
pub fn overlap(low: Point, high: Point, other_low: Point, other_high: Point) -> bool {
    (0..2).all(|i| low[i] < other_high[i] && other_low[i] < high[i])
}
