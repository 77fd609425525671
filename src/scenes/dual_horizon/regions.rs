//! Areas of finer points, as a case or a scene asks for them.

use perilife_base::error::{Error, Result, input, input_missing};
use perilife_plate::specimen::geometry::{bounding_box, distance_to_polygon, distance_to_segment, point_in_polygon};
use perilife_plate::specimen::{Point, Specimen};
use perilife_points::refinement::{RefinedRegion, Refinement};

const LEVELS_MAX: usize = 8;
/// Horizon ratio from which on the points beside a change of level lie in each other's horizons: the farthest of the four
/// parts next to a coarse point is √(0.75² + 0.25²) coarse spacings away, and its horizon half of the coarse one.
const OVERLAP_RATIO: f64 = 1.582;

/// An area and how often its points are split.
#[derive(Debug, Clone, Copy)]
pub struct Area<'s> {
    specimen: &'s Specimen,
    region: &'s RefinedRegion,
    /// Times its points are split in four.
    pub levels: usize,
    /// Number in the list of regions.
    index: usize,
}

impl<'s> Area<'s> {
    /// Areas of a plate.
    /// Errors: levels out of range, areas outside the plate, horizons that do not overlap where levels meet.
    pub fn all(specimen: &'s Specimen, refinement: Option<&'s Refinement>, ratio: f64) -> Result<Vec<Area<'s>>> {
        let regions = refinement.map_or(&[][..], |refinement| &refinement.regions);
        let area =
            |(index, (region, levels)): (usize, &'s (RefinedRegion, usize))| Area { specimen, region, levels: *levels, index };
        let areas: Vec<Area> = regions.iter().enumerate().map(area).collect();
        for area in &areas {
            area.check(ratio)?;
        }
        Ok(areas)
    }

    fn check(&self, ratio: f64) -> Result<()> {
        if self.levels == 0 || self.levels > LEVELS_MAX {
            let key = format!("refinement.regions[{}].levels", self.index);
            return Err(input(&key, self.levels, "is not a number of levels", format!("give 1 to {LEVELS_MAX}")));
        }
        if ratio < OVERLAP_RATIO {
            let problem = format!(
                "is too small: the horizons of a point and of its {} neighboring parts do not overlap",
                4_usize.pow(self.levels as u32)
            );
            return Err(input("model.horizon_ratio", ratio, problem, format!("give {OVERLAP_RATIO} or more; 3.015 is usual")));
        }
        let [low, high] = bounding_box(&self.specimen.outline);
        match *self.region {
            RefinedRegion::Box { low: from, high: to } => {
                if (0..2).any(|i| to[i] <= from[i]) {
                    return Err(self.refusal("is not a box: its second corner must be above and right of its first", "swap them"));
                }
                if (0..2).any(|i| to[i] <= low[i] || from[i] >= high[i]) {
                    return Err(self.refusal("is outside the plate", "move it onto the plate"));
                }
            }
            RefinedRegion::Band { width, .. } if width.is_nan() || width <= 0.0 => {
                return Err(self.refusal("is a band without width", "give width_mm above 0"));
            }
            RefinedRegion::AroundFlaws { .. } if self.specimen.cracks.is_empty() && self.specimen.slots.is_empty() => {
                return Err(self.refusal("requires cracks or notches", "give cracks or notches, or a box or band"));
            }
            _ => {}
        }
        Ok(())
    }

    /// An error about this area.
    pub fn refusal(&self, problem: &str, remedy: &str) -> Error {
        input_missing(&format!("refinement.regions[{}]", self.index), problem, remedy)
    }

    /// Whether a place lies in the area.
    pub fn holds(&self, at: Point) -> bool {
        match *self.region {
            RefinedRegion::Box { low, high } => (0..2).all(|i| at[i] >= low[i] && at[i] <= high[i]),
            RefinedRegion::Band { from, to, width } => distance_to_segment(at, from, to) <= 0.5 * width,
            RefinedRegion::AroundFlaws { distance } => {
                self.specimen.cracks.iter().any(|crack| distance_to_segment(at, crack.from, crack.to) <= distance)
                    || self.specimen.slots.iter().any(|slot| {
                        let corners = slot.corners();
                        point_in_polygon(at, &corners) || distance_to_polygon(at, &corners) <= distance
                    })
            }
        }
    }
}
