//! Spectrum of FASTRAN: a title; `points Smax Smin INVERT ICLIP`; then so many whole numbers, maxima and minima in turn.
//!
//! The largest of the numbers stands for Smax and the smallest for Smin, others between them in proportion.

use super::columns;
use super::content::Content;
use super::rows::{Row, cells, fault, number};
use perilife_base::error::Result;

const REMEDY: &str = "give a title, a line `points Smax Smin INVERT ICLIP`, then that number of peaks and valleys";

/// The five numbers of the second line, if it is one.
fn header(line: &str) -> Option<[f64; 5]> {
    let values: Vec<f64> = cells(line).map(|cell| cell.parse().ok()).collect::<Option<_>>()?;
    <[f64; 5]>::try_from(values).ok().filter(|[points, most, least, ..]| points.fract() == 0.0 && *points >= 2.0 && most > least)
}

/// Whether the second line of a text is such a header, below a title that is no row of five columns.
pub(super) fn is_of(first: &str, second: &str) -> bool {
    header(second).is_some() && header(first).is_none() && !columns::is_header(first)
}

/// Reads the turning points.
pub(super) fn read<'a>(mut rows: impl Iterator<Item = Row<'a>>) -> Result<Content> {
    rows.next();
    let (line, text) = rows.next().unwrap_or((1, ""));
    let Some([points, most, least, invert, clip]) = header(text) else {
        return Err(fault(Some(line), "header", text, "is not `points Smax Smin INVERT ICLIP`", REMEDY));
    };
    for (name, value) in [("INVERT", invert), ("ICLIP", clip)] {
        if value != 0.0 {
            let remedy = "write the final points, with 0 here; truncation_percent clips peaks";
            return Err(fault(Some(line), name, &value.to_string(), "is not supported (it changes the points)", remedy));
        }
    }
    let mut found = Vec::new();
    for (line, text) in rows {
        for cell in cells(text) {
            found.push(number(line, "point", cell)?);
        }
    }
    if found.len() != points as usize {
        let problem = format!("is not the number of points that follow, {}", found.len());
        return Err(fault(Some(line), "points", &points.to_string(), &problem, REMEDY));
    }
    let ends = found.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(*x), high.max(*x)]);
    let scale = (most - least) / (ends[1] - ends[0]);
    // Where all are equal nothing turns, which is refused where points are counted.
    let value = |x: f64| if scale.is_finite() { least + scale * (x - ends[0]) } else { x };
    Ok(Content::Points(found.into_iter().map(value).collect()))
}
