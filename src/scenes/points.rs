//! Points and bonds of a scene, what they take up, and where loads and supports take hold of them: points, stretches of the outline, words.

use std::fmt;

use super::correspondence::NET_LAW;
use super::dual_horizon::{self, MultiLevelSpec};
use super::scene::{Action, Discretisation, LoadRamp, Region, Scene, SceneLaw, SceneLoad, SceneSolver};
use perilife_base::error::{Result, input};
use perilife_base::units::MM;
use perilife_plate::specimen::geometry::{along, bounding_box};
use perilife_plate::specimen::{Edge, Load, Point, Specimen};
use perilife_points::body::Body;
use perilife_points::bond_law::SurfaceCorrection;
use perilife_points::budget::{Budget, PointPlate};
use perilife_points::net::Net;

/// Bytes of a bond of a net, with its places in the lists of both ends. `perilife fracture` on a square of 100 mm with one slant crack under
/// traction with `duration_s`: 108 MB at 4e4 points, m = 3.015, and 259 MB at m = 6, of which lattice and rim take 61 and 77 MB.
const NET_BOND: f64 = 90.0;
/// The same under `correspondence`: 125 MB at 4e4 points, m = 3.015.
const CORRESPONDENCE_BOND: f64 = 120.0;

impl Scene {
    /// What it takes up, before anything is laid out.
    pub fn budget(&self) -> Budget {
        let model = &self.model;
        let plate = PointPlate {
            specimen: &self.specimen,
            spacing: model.spacing,
            horizon_ratio: model.horizon_ratio,
            lattice_angle: model.lattice_angle,
            refinement: self.refinement.as_ref(),
        };
        let (correction, of_bond) = match model.law {
            SceneLaw::Bonds(law) => (law.surface_correction, NET_BOND),
            SceneLaw::Correspondence { .. } => (SurfaceCorrection::None, CORRESPONDENCE_BOND),
        };
        // Static scenes: 241 MB at 1e4 points, m = 3.015; 145 MB at 2500 and m = 6.
        plate.budget(correction, of_bond, model.solver == SceneSolver::Secant).with_files(self.output)
    }
}

/// Points and bonds of a scene, and the lattice body behind them if there is one.
/// Errors: wrong input that shows only now, choices that do not go together.
pub fn build(scene: &Scene) -> Result<(Net, Option<Body>)> {
    let model = &scene.model;
    match (model.law, model.arrangement) {
        (law, Discretisation::Lattice) => {
            let law = match law {
                SceneLaw::Bonds(law) => law,
                SceneLaw::Correspondence { .. } => NET_LAW,
            };
            let body =
                Body::build(&scene.specimen, &scene.material, &law, model.spacing, model.horizon_ratio, model.lattice_angle)?;
            Ok((Net::of_body(&body), Some(body)))
        }
        (SceneLaw::Bonds(law), Discretisation::DualHorizon) => {
            let ask = MultiLevelSpec {
                specimen: &scene.specimen,
                material: &scene.material,
                law: &law,
                spacing: model.spacing,
                horizon_ratio: model.horizon_ratio,
                lattice_angle: model.lattice_angle,
                refinement: scene.refinement.as_ref(),
                // Where nothing holds the plate its loads must balance.
                floating: scene.specimen.supports.is_empty()
                    && scene.holds.is_empty()
                    && scene.drives.iter().all(|drive| matches!(drive.action, Action::Traction(_))),
            };
            Ok((dual_horizon::build(&ask)?, None))
        }
        (SceneLaw::Correspondence { .. }, arrangement) => {
            let problem = "does not support bond_law = \"correspondence\"";
            Err(input("model.discretisation", format!("\"{arrangement}\""), problem, "use \"lattice\""))
        }
    }
}

impl Region {
    /// The outermost row of a whole side.
    pub fn side(edge: Edge) -> Region {
        Region::Edge { edge, depth: 0.0, range: [f64::NEG_INFINITY, f64::INFINITY] }
    }

    /// Points within the region, ascending; of a side at least those of its outermost row.
    pub fn points(&self, net: &Net, specimen: &Specimen) -> Vec<u32> {
        let all = || net.positions.iter().enumerate();
        match *self {
            Region::Box { low, high } => {
                let inside = |p: &Point| (0..2).all(|i| p[i] >= low[i] && p[i] <= high[i]);
                all().filter(|(_, p)| inside(p)).map(|(i, _)| i as u32).collect()
            }
            Region::Edge { edge, depth, range } => {
                let [low, high] = bounding_box(&specimen.outline);
                let axis = usize::from(matches!(edge, Edge::Top | Edge::Bottom));
                let far = matches!(edge, Edge::Top | Edge::Right);
                let away = |p: &Point| if far { high[axis] - p[axis] } else { p[axis] - low[axis] };
                let along = |point: &usize| {
                    let at = net.positions[*point][1 - axis];
                    at >= range[0] && at <= range[1]
                };
                net.within(depth, away).filter(along).map(|point| point as u32).collect()
            }
        }
    }
}

impl SceneLoad {
    /// A load on the outermost row of a whole side, at once.
    pub fn on_side(edge: Edge, action: Action) -> SceneLoad {
        SceneLoad { region: Region::side(edge), action, rise: LoadRamp::AT_ONCE, key: "loading.edges".to_owned() }
    }

    /// A traction as loads of the plate; none where the load is something else, or the outline does not reach its part of the
    /// side.
    pub fn loads(&self, specimen: &Specimen) -> Vec<Load> {
        let (&Region::Edge { edge, range, .. }, Action::Traction(traction)) = (&self.region, self.action) else {
            return Vec::new();
        };
        let axis = usize::from(edge.normal()[0] != 0.0);
        let clipped = |(a, b): (Point, Point)| {
            let share = |at: f64| ((at - a[axis]) / (b[axis] - a[axis])).clamp(0.0, 1.0);
            let (first, second) = (share(range[0]), share(range[1]));
            let (from, to) = (first.min(second), first.max(second));
            (to > from).then(|| Load::Edge { from: along(a, b, from), to: along(a, b, to), traction })
        };
        edge.stretches(specimen).into_iter().filter_map(clipped).collect()
    }
}

impl fmt::Display for Region {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mm = |metres: f64| (metres / MM * 1e4).round() / 1e4;
        match *self {
            Region::Edge { edge, depth, range } => {
                write!(f, "{edge}")?;
                if range[0].is_finite() {
                    write!(f, " from {} to {} mm", mm(range[0]), mm(range[1]))?;
                }
                if depth > 0.0 { write!(f, ", {} mm deep", mm(depth)) } else { Ok(()) }
            }
            Region::Box { low, high } => {
                write!(f, "the box ({}, {}) to ({}, {}) mm", mm(low[0]), mm(low[1]), mm(high[0]), mm(high[1]))
            }
        }
    }
}
