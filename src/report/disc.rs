//! The displacement along the horizontal diameter of a disc for several strengths of springs against zero-energy modes.

use std::path::Path;

use super::chart::{Mark, Series, linear};
use crate::error::Result;
use crate::units::MM;
use crate::verify::disc::{self, ElasticDisc};

/// Draws u_x over x for the springs of a sweep, the default control and the reference.
pub fn springs_chart(path: &Path) -> Result<()> {
    let sweep = disc::sweep()?;
    let series = |name: String, of: &ElasticDisc, mark: Mark| Series {
        name,
        points: of.row.iter().map(|(x, u)| (x / MM, u / MM * 1e3)).collect(),
        mark,
    };
    let springs = sweep.springs.iter().map(|(c, of)| {
        // Without springs the points scatter.
        let mark = if *c == 0.0 { Mark::Dots } else { Mark::Line };
        series(format!("c_I = {}e23", c / 1e23), of, mark)
    });
    let mut all: Vec<Series> = springs.collect();
    all.push(series("silling".to_owned(), &sweep.silling, Mark::Dashes));
    let reference = series("silling, half the spacing".to_owned(), &sweep.fine, Mark::Circles);
    // One of four, so that the curves below stay to be seen.
    all.push(Series { points: reference.points.iter().copied().step_by(4).collect(), ..reference });
    let title = "Disc between platens: displacement along the horizontal diameter, springs of c_I in N/m⁷";
    linear(path, title, ["x, mm", "Displacement u_x, µm"], &all)
}
