//! `[refinement]` of a scene: where finer points lie.

use serde::Deserialize;
use toml::Value;

use super::region;
use crate::error::{Result, input, input_missing};
use crate::fracture::scene::{RefinedRegion, Refinement};
use crate::input::{LENGTH, point, slice};
use crate::specimen::Specimen;
use crate::specimen::geometry::{bounding_box, distance};

/// Times that a point may be split in four.
const LEVELS_MAX: usize = 4;
/// More than this is a slip.
const REGIONS_MAX: usize = 50;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    regions: Vec<Value>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RegionInput {
    box_mm: Option<[[f64; 2]; 2]>,
    band_mm: Option<[[f64; 2]; 2]>,
    width_mm: Option<f64>,
    around_flaws_mm: Option<f64>,
    levels: usize,
}

/// Reads `[refinement]`.
pub fn from_value(value: &Value, specimen: &Specimen) -> Result<Refinement> {
    let input: Input = slice(value, "refinement")?;
    const KEY: &str = "refinement.regions";
    if input.regions.is_empty() || input.regions.len() > REGIONS_MAX {
        let remedy = format!("give 1 to {REGIONS_MAX} regions {{ box_mm = [[x, y], [x, y]], levels = 1 }}");
        return Err(crate::error::input(KEY, format!("{} regions", input.regions.len()), "is no refinement", remedy));
    }
    let of = |(i, value): (usize, &Value)| one(value, &format!("{KEY}[{i}]"), specimen);
    Ok(Refinement { regions: input.regions.iter().enumerate().map(of).collect::<Result<_>>()? })
}

fn one(value: &Value, path: &str, specimen: &Specimen) -> Result<(RefinedRegion, usize)> {
    let given: RegionInput = slice(value, path)?;
    let levels = given.levels;
    if levels == 0 || levels > LEVELS_MAX {
        let problem = "is no number of times that points are split in four";
        return Err(input(&format!("{path}.levels"), levels, problem, format!("give 1 to {LEVELS_MAX}")));
    }
    if let Some(width) = given.width_mm.filter(|_| given.band_mm.is_none()) {
        return Err(input(&format!("{path}.width_mm"), width, "is the width of a band, and there is none", "leave it out"));
    }
    let region = match (given.box_mm, given.band_mm, given.around_flaws_mm) {
        (Some(corners), None, None) => {
            let (low, high) = region::corners(&format!("{path}.box_mm"), corners, specimen)?;
            RefinedRegion::Box { low, high }
        }
        (None, Some(ends), None) => band(ends, given.width_mm, path, specimen)?,
        (None, None, Some(distance)) => {
            let key = format!("{path}.around_flaws_mm");
            if specimen.cracks.is_empty() && specimen.slots.is_empty() {
                return Err(input(&key, distance, "has nothing to lie around", "give cracks or notches, or a box"));
            }
            RefinedRegion::AroundFlaws { distance: LENGTH.read(&key, distance)? }
        }
        _ => {
            let problem = "is not one of box_mm, band_mm with width_mm, and around_flaws_mm";
            return Err(input_missing(path, problem, "give one of them, with levels"));
        }
    };
    Ok((region, levels))
}

fn band(ends: [[f64; 2]; 2], width: Option<f64>, path: &str, specimen: &Specimen) -> Result<RefinedRegion> {
    let key = format!("{path}.band_mm");
    let (from, to) = (point(&key, ends[0])?, point(&key, ends[1])?);
    if distance(from, to) < 1e-6 {
        return Err(input_missing(&key, "has no length: its ends coincide", "give two different points"));
    }
    let width_key = format!("{path}.width_mm");
    let width = width.ok_or_else(|| input_missing(&width_key, "is missing", "give the whole width of the band"))?;
    let width = LENGTH.read(&width_key, width)?;
    let half = width / 2.0;
    let low = [from[0].min(to[0]) - half, from[1].min(to[1]) - half];
    let high = [from[0].max(to[0]) + half, from[1].max(to[1]) + half];
    let [plate_low, plate_high] = bounding_box(&specimen.outline);
    if !region::overlap(low, high, plate_low, plate_high) {
        let problem =
            format!("lies outside the plate, which reaches from {} to {}", region::words(plate_low), region::words(plate_high));
        return Err(input_missing(&key, problem, "move it onto the plate"));
    }
    Ok(RefinedRegion::Band { from, to, width })
}
