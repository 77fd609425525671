//! The body that a run would compute, looked at before anything is solved.

use super::understood::{built, points_words};
use perilife_base::error::{Error, InputError, Result};
use perilife_growth::ageing::stuck;
use perilife_growth::case::needs;
use perilife_growth::case::{Case, Engine, Model, PointSettings, initial_plate};
use perilife_growth::plate;
use perilife_nodes::resolution::ElementFreeSettings;
use perilife_plate::specimen::Specimen;
use perilife_points::body::lattice::Lattice;
use perilife_points::budget::Budget;
use perilife_points::crack_tip::CrackTip;
use perilife_points::pieces::{Connectivity, remove_fragments};
use perilife_points::state::Bonds;
use perilife_results::model_words::{self, mm};

/// Bonds up to which the body is built, those of 4e5 points at the usual horizon; well below a second.
const BONDS_BUILT: f64 = 6e6;
/// Memory up to which it is: what takes long beside bonds are the equations of a rim, which are large where horizons are.
const BYTES_BUILT: f64 = 5e8;
/// Corners of an outline, holes and slots among them, with which a place is asked in no time.
const CORNERS_USUAL: f64 = 50.0;
/// Places up to which it is: an outline of thin arms has many that are empty, and each of them is asked whether it lies in the plate.
const PLACES_BUILT: f64 = 2e6;

/// Whether points and bonds are so few that a check lays them.
pub(super) fn is_quick(budget: &Budget, specimen: &Specimen) -> bool {
    let corners = specimen.outline.len() + specimen.holes.len() + 4 * specimen.slots.len();
    let asked = budget.places * (corners as f64 / CORNERS_USUAL).max(1.0);
    budget.bonds <= BONDS_BUILT && asked <= PLACES_BUILT && budget.bytes <= BYTES_BUILT
}

/// What the lattice makes of a case.
pub(super) struct Preview {
    /// Points, spacing and horizon in words.
    pub points: String,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Seconds of an increment on two processors for every node, with the look for its error.
const SECONDS_OF_NODE: f64 = 3.5e-5;
/// The same for every point.
const SECONDS_OF_POINT: f64 = 1.5e-6;
/// Increments of a life, and how many more of them every tip takes.
const INCREMENTS: [f64; 2] = [12.0, 7.0];

fn of_nodes(case: &Case, ElementFreeSettings { resolution, .. }: &ElementFreeSettings) -> Result<Preview> {
    let plate = initial_plate(case).map_err(as_input)?;
    let finest = plate.nodes.spacing.iter().copied().fold(f64::INFINITY, f64::min);
    let points = format!(
        "{} nodes, {} unknowns; spacing {} mm, {} mm at the finest, radius of influence {} spacings{}",
        plate.nodes.at.len(),
        plate.unknowns(),
        mm(resolution.far),
        mm(finest),
        resolution.support,
        time_words(case, SECONDS_OF_NODE * plate.nodes.at.len() as f64)
    );
    Ok(Preview { points, warnings: Vec::new() })
}

/// What a life takes, by the seconds of an increment; within a factor of three.
fn time_words(case: &Case, seconds: f64) -> String {
    let increments = INCREMENTS[0] + INCREMENTS[1] * case.specimen.tips.len() as f64;
    format!("; about {:.0} s", (increments * seconds).max(1.0))
}

/// Lays the lattice and, where that is quick, builds the body.
pub(super) fn preview(case: &Case) -> Result<Preview> {
    match &case.model {
        Model::Handbook(_) => Ok(Preview { points: "none (handbook K)".to_owned(), warnings: Vec::new() }),
        Model::Nodes(nodes) => of_nodes(case, nodes),
        Model::Points(points) => {
            let mut preview = of_points(case, points)?;
            if case.engine() == Engine::Points {
                preview.points += &time_words(case, SECONDS_OF_POINT * needs::of_case(case).points);
            }
            Ok(preview)
        }
    }
}

fn of_points(case: &Case, points: &PointSettings) -> Result<Preview> {
    let specimen = &case.specimen;
    let budget = needs::of_case(case);
    if !is_quick(&budget, specimen) {
        let padding = points.horizon_ratio.floor() as usize;
        let lattice = Lattice::over(specimen, points.spacing, points.lattice_angle, padding)?;
        let count = format!("about {:.0}", budget.points * (points.spacing / lattice.spacing).powi(2));
        return Ok(Preview { points: points_line(case, &count, lattice.spacing), warnings: Vec::new() });
    }
    let body = &points.body(specimen, &case.material).map_err(as_input)?;
    let mut bonds = Bonds::new(body);
    if remove_fragments(body, &mut bonds, &body.pre_cut) == Connectivity::Severed {
        return Err(as_input(Error::Mechanics("the initial cracks cut the plate in two".to_owned())));
    }
    let count = built([body.points.len(), body.bond_count, body.pre_cut.len()]);
    let tips: Vec<CrackTip> = specimen.tips.iter().map(|seed| CrackTip::at(seed, body)).collect();
    let held = stuck(body, &bonds, &tips, &case.fatigue).into_iter().map(|tip| {
        let [x, y] = tips[tip].position.map(mm);
        format!(
            "the crack tip at ({x}, {y}) mm is inside the no-failure zone of a load or support and will not grow; \
             move it one horizon away ({} mm), or load the plate elsewhere",
            mm(body.horizon())
        )
    });
    let warnings = plate::warning(body).into_iter().chain(held).collect();
    Ok(Preview { points: points_line(case, &count, body.lattice.spacing), warnings })
}

fn points_line(case: &Case, count: &str, spacing: f64) -> String {
    let sizes = [case.points().spacing, spacing * case.points().horizon_ratio];
    points_words(count, [spacing; 2], sizes, &model_words::of_case(case, None))
}

/// What a run would end with as mechanics is, seen before any run, input that has to change.
pub(super) fn as_input(error: Error) -> Error {
    match error {
        Error::Mechanics(problem) => Error::Input(Box::new(InputError { problem, ..InputError::default() })),
        other => other,
    }
}
