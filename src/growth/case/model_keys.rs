//! Keys of `[model]`, and what those of the element-free Galerkin method say.

use toml::{Table, Value};

use super::{Case, Method, Model};
use perilife_base::error::{Result, input};
use perilife_base::keys::{Given, Key, Section, key, length, number};
use perilife_base::units::round_mm;
use perilife_nodes::basis::{BasisKind, Enrichment};
use perilife_nodes::resolution::{ElementFreeSettings, IN_RADIUS, RIM_REACH, Resolution};
use perilife_plate::specimen::Specimen;
use perilife_plate::specimen::geometry::bounding_box;
use perilife_points::bond_law::{BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_points::solver::{SolverKind, Symmetry};

/// By the error asked for, in percent of life: far spacings across the smaller side of the plate, largest step of a tip over its crack
/// and room, reach of a tip in spacings, radius of influence on linear polynomials. Of the nine plates of `data/reference` the worst errs by 1.6 % of
/// life where 5 are asked for, by 1.2 where 2 are, and by 0.7 where 0.5 are, the others by 0.8, 0.7 and 0.2 (`perilife verify estimates`).
/// With a radius of 2.0 at 2 % runs take 0.76 of the time and lives of 29 plates err by 0.42 instead of 0.29 % on average, eight by 0.3 to 0.5 % more;
/// corrected by the mean of the bound's differences where that exceeds their scatter by 0.37, seven by 0.3 to 0.9 % more.
const RUNGS: [(f64, [f64; 4]); 4] = [
    (0.5, [20.0, 0.25, 4.0, 2.5]),
    (1.0, [14.0, 0.4, 3.0, 2.5]),
    (2.0, [10.0, 0.4, 3.0, 2.2]),
    (f64::INFINITY, [10.0, 0.4, 3.0, 2.0]),
];
/// Far spacings of a plate without crack over those of one with cracks: it is asked for stress along rims, which needs more than K.
const WITHOUT_CRACK: f64 = 2.0;
/// Error that is asked for where the case does not say.
const TOLERANCE_PERCENT: f64 = 2.0;
/// Least error that can be asked for.
const TOLERANCE_LEAST: f64 = 0.5;
/// Nodes over those of a run that asks for nearly that error, by which it is judged.
const FINER: f64 = 1.5;
/// Reach of a tip with them, in spacings: with four, bounds are nearly the same.
const REACH_OF_FINER: f64 = 3.0;
/// How much finer nodes get each time that K of the initial tips asks for it.
pub const REFINED: f64 = 1.5;
/// Share of the error of a life that K may have: its cube or fourth power makes the life.
const FACTOR_SHARE: f64 = 0.3;
/// Nodes far from cracks beyond which a spacing was hardly meant for nodes.
const NODES_USUAL: f64 = 5e3;
/// Spacings in the room of a tip.
const HOLD: f64 = 3.0;
/// Radius of influence of a node in its spacings, of quadratic polynomials.
const INFLUENCE_OF_QUADRATIC: f64 = 3.5;

const POINTS: &[&str] = &["peridynamics", "handbook"];
const NODES: &[&str] = &["element_free_galerkin"];
/// Of handbook, too, which the program takes where its formula is good enough.
const CHOSEN: &[&str] = &["element_free_galerkin", "handbook"];
/// That of points, or of nodes far from cracks.
const SPACING: &str = "spacing_mm";

const fn of(owners: &'static [&'static str], key: Key) -> Key {
    key.only("method", owners)
}

perilife_base::keys! {
    pub struct ModelKeys {
        method: Method = key("method", "Method"), or "auto" Method::Auto;
        spacing: Option<f64> = length(SPACING, "Spacing: of points, or of nodes far from cracks");
        symmetry: Option<Symmetry> = of(POINTS, key("symmetry", "Symmetry: model half or a quarter of the plate"));
        bond_law: Option<BondLawKind> = of(POINTS, key("bond_law", "Bond law: default by Poisson's ratio"));
        kernel: Option<Kernel> = of(POINTS, key("kernel", "Kernel: weight of bonds over their length"));
        rotation: Option<Rotation> = of(POINTS, key("rotation", "Rotation: free or resisted rigid rotation of bonds"));
        surface_correction: Option<SurfaceCorrection> = of(POINTS, key("surface_correction", "Surface correction: at the boundary"));
        horizon_ratio: Option<f64> = of(POINTS, number("horizon_ratio", "Horizon ratio: horizon over spacing; default 3.015", "a horizon ratio", 1.5, 12.0));
        lattice_angle_deg: Option<f64> = of(POINTS, number("lattice_angle_deg", "Lattice angle, °: of rows of points against x", "an angle in degrees", -90.0, 90.0));
        solver: Option<SolverKind> = of(POINTS, key("solver", "Solver"));
        nodes: Option<f64> = of(NODES, number("nodes", "Number of nodes: far from cracks", "a number of nodes", 50.0, 1e5));
        tolerance_percent: f64 = of(CHOSEN, number("tolerance_percent", "Target accuracy, % of life", "an error in percent", TOLERANCE_LEAST, 20.0)), or "2" TOLERANCE_PERCENT;
        basis: Option<BasisKind> = of(NODES, key("basis", "Basis: polynomials of the nodes"));
        enrichment: Option<Enrichment> = of(NODES, key("enrichment", "Enrichment: functions of the tips"));
        influence_radius: Option<f64> = of(NODES, number("influence_radius", "Radius of influence: of a node, in spacings", "a radius of influence in spacings", 1.5, 6.0));
    }
}

/// A key of `[model]` that asks for its first owner where the method is left open; `spacing_mm` asks for points.
pub(super) fn telling_key(model: &Value) -> Option<(&'static str, Method)> {
    let owners = |key: &Key| key.only.map_or(if key.name == SPACING { POINTS } else { CHOSEN }, |(_, owners)| owners);
    let key = ModelKeys::KEYS.iter().find(|key| owners(key) != CHOSEN && model.get(key.name).is_some())?;
    Some((key.name, if owners(key) == POINTS { Method::Peridynamics } else { Method::ElementFreeGalerkin }))
}

/// Refuses a key of `[model]` that does not go with the method.
pub(super) fn refuse_strangers(model: &Given<'_>, method: Method, chosen: Option<&str>) -> Result<()> {
    let strange =
        |key: &&Key| key.only.is_some_and(|(_, owners)| !owners.contains(&method.name())) && model.first(&[key.name]).is_some();
    let Some((key, (_, owners))) = ModelKeys::KEYS.iter().find(strange).and_then(|key| Some((key, key.only?))) else {
        return Ok(());
    };
    let (owner, why) = (owners[0], chosen.map_or_else(String::new, |why| format!(" ({why})")));
    let problem = format!("applies only to model.method = \"{owner}\"; the method is \"{method}\"{why}");
    Err(model.refuse(key.name, problem, format!("remove it, or use model.method = \"{owner}\"")))
}

/// Makes `[model]` one of nodes: what it says of points goes, but for keys that were `asked` for beside the file.
pub(super) fn on_nodes(table: &mut Table, asked: impl Fn(&str) -> bool) {
    let model = table.entry("model").or_insert_with(|| Value::Table(Table::new()));
    let (Some(model), name) = (model.as_table_mut(), Method::ElementFreeGalerkin.name()) else { return };
    if model.get("method").and_then(Value::as_str) == Some(name) {
        return;
    }
    let of_points = |name: &str| {
        name == SPACING || ModelKeys::KEYS.iter().any(|key| key.name == name && key.only.is_some_and(|own| own.1 == POINTS))
    };
    model.retain(|name, _| !of_points(name) || asked(&format!("model.{name}")));
    model.insert("method".to_owned(), Value::String(name.to_owned()));
}

/// What is to be said of a spacing that was meant for points: nodes are refined by themselves.
pub(super) fn too_fine(spacing: f64, specimen: &Specimen, settings: &ElementFreeSettings) -> Option<String> {
    let nodes = specimen.area() / settings.resolution.far.powi(2);
    (nodes > NODES_USUAL).then(|| {
        format!(
            "spacing: model.spacing_mm = {} gives about {nodes:.0} nodes far from cracks: nodes refine automatically at tips, edges \
             and ligaments; remove the key",
            round_mm(spacing)
        )
    })
}

/// Nodes where a case says nothing of them.
pub fn usual_nodes(specimen: &Specimen) -> ElementFreeSettings {
    let basis = if specimen.tips.is_empty() { BasisKind::Quadratic } else { BasisKind::Linear };
    nodes_for(specimen, TOLERANCE_PERCENT, basis)
}

/// Nodes by which K of a case is judged, made finer `refined` times, where that is known by itself: for the least error that can be asked for;
/// of a case on nodes with the radius of influence of those, finer than the run near tips and rims, and as fine far from them, finer still beside
/// a run with such a radius.
pub fn finer_nodes(case: &Case, refined: Option<[u32; 2]>) -> ElementFreeSettings {
    let mut nodes = nodes_for(&case.specimen, TOLERANCE_LEAST, BasisKind::Linear);
    let [mut near, far] = refined.unwrap_or_default().map(|times| REFINED.powi(times as i32));
    if let Model::Nodes(own) = case.model {
        let of_own = own.resolution;
        let is_as_fine = own.is_given || of_own.support >= nodes.resolution.support;
        let times = if is_as_fine { FINER } else { 1.0 };
        nodes.resolution.far = nodes.resolution.far.min(of_own.far) / times;
        nodes.resolution.reach = REACH_OF_FINER.max(of_own.reach);
        nodes.resolution.support = nodes.resolution.support.max(of_own.support);
        near *= FINER;
    }
    nodes.resolution = nodes.resolution.finer([near, far]);
    nodes.is_final = refined.is_some();
    nodes
}

/// Smaller side of the plate, m.
fn smaller_side(specimen: &Specimen) -> f64 {
    let [low, high] = bounding_box(&specimen.outline);
    (high[0] - low[0]).min(high[1] - low[1])
}

/// Nodes for an error asked for, percent of life.
fn nodes_for(specimen: &Specimen, percent: f64, basis: BasisKind) -> ElementFreeSettings {
    let (_, [across, step_share, reach, of_linear]) =
        RUNGS.into_iter().find(|(most, _)| percent <= *most).unwrap_or(RUNGS[RUNGS.len() - 1]);
    let across = if specimen.tips.is_empty() { WITHOUT_CRACK * across } else { across };
    ElementFreeSettings {
        resolution: Resolution {
            far: smaller_side(specimen) / across,
            hold: HOLD,
            reach,
            in_radius: IN_RADIUS,
            rim_reach: RIM_REACH,
            fineness: 1.0,
            support: if basis == BasisKind::Quadratic { INFLUENCE_OF_QUADRATIC } else { of_linear },
            basis,
            enrichment: Enrichment::Tip,
        },
        step_share,
        tolerance: percent / 100.0 * FACTOR_SHARE,
        is_given: false,
        is_final: false,
    }
}

impl ModelKeys {
    /// What the keys of nodes say, and the choice of the program where they say nothing; `spacing_mm` is that far from cracks.
    pub(super) fn nodes(&self, specimen: &Specimen) -> Result<ElementFreeSettings> {
        let usual = usual_nodes(specimen);
        let mut settings = nodes_for(specimen, self.tolerance_percent, self.basis.unwrap_or(usual.resolution.basis));
        let resolution = &mut settings.resolution;
        match (self.spacing, self.nodes) {
            (Some(_), Some(nodes)) => {
                let problem = "conflicts with model.spacing_mm";
                return Err(input("model.nodes", nodes, problem, "remove one of them"));
            }
            (Some(spacing), None) => {
                let side = smaller_side(specimen);
                let most = side / 4.0;
                if spacing > most {
                    let problem = format!("leaves fewer than four spacings across the plate ({} mm)", 1e3 * side);
                    return Err(input("model.spacing_mm", 1e3 * spacing, problem, format!("give {:.4} mm or less", 1e3 * most)));
                }
                resolution.far = spacing;
            }
            (None, nodes) => resolution.far = nodes.map_or(resolution.far, |nodes| (specimen.area() / nodes).sqrt()),
        }
        resolution.support = self.influence_radius.unwrap_or(resolution.support);
        resolution.enrichment = self.enrichment.unwrap_or(resolution.enrichment);
        settings.is_given = self.spacing.is_some() || self.nodes.is_some();
        Ok(settings)
    }
}
