//! What a case will take up ([`perilife_points::budget`]).

use super::{Case, Model, PointSettings};
use perilife_nodes::resolution::ElementFreeSettings;
use perilife_points::budget::{Budget, PointPlate};

/// What a case takes up.
pub fn of_case(case: &Case) -> Budget {
    let of_nodes = |nodes: &ElementFreeSettings| Budget::of_nodes(case.specimen.area(), nodes.resolution.far);
    let budget = match &case.model {
        // Once its crack is through it grows on nodes.
        Model::Handbook(_) if !case.specimen.is_through() => of_nodes(&case.nodes()),
        Model::Handbook(_) => Budget::of_formula(),
        Model::Nodes(nodes) => of_nodes(nodes),
        Model::Points(_) => return on_points(case),
    };
    budget.with_files(case.output)
}

/// What the plate of a case takes up on points, whatever its model.
pub fn on_points(case: &Case) -> Budget {
    let points = case.points();
    let PointSettings { spacing, horizon_ratio, lattice_angle, .. } = points;
    let plate = PointPlate { specimen: &case.specimen, spacing, horizon_ratio, lattice_angle, refinement: None };
    plate.budget(points.bond_law.surface_correction, 0.0, false).with_files(case.output)
}
