//! Bodies without cycles: all laws, a plate in equilibrium, stretches of its bonds.

use perilife_base::error::Result;
use perilife_growth::ageing::stretch;
use perilife_growth::case::Case;
use perilife_plate::material::{Material, Plane};
use perilife_points::body::{Body, Bond};
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_points::solver::field::Layout;
use perilife_points::solver::{Equilibrium, SolverKind, Symmetry};
use perilife_points::state::Bonds;

/// Every bond law with every kernel and rotation.
pub fn laws() -> impl Iterator<Item = (BondLawKind, Kernel, Rotation)> {
    let kernels = Kernel::ALL.iter().flat_map(|&kernel| Rotation::ALL.iter().map(move |&rotation| (kernel, rotation)));
    BondLawKind::ALL.iter().flat_map(move |&kind| kernels.clone().map(move |(kernel, rotation)| (kind, kernel, rotation)))
}

/// The same with every surface correction they go with.
pub fn corrected_laws() -> impl Iterator<Item = BondLaw> {
    laws().flat_map(|(kind, kernel, rotation)| {
        SurfaceCorrection::ALL
            .iter()
            .map(move |&surface_correction| BondLaw { kind, kernel, rotation, surface_correction })
            .filter(|law| (law.kind, law.surface_correction) != (BondLawKind::StateBased, SurfaceCorrection::Balanced))
    })
}

/// A material that the law can represent: bond-based has one Poisson's ratio, state-based goes beyond it.
pub fn material(kind: BondLawKind, plane: Plane) -> Material {
    let limit = perilife_points::bond_law::stencil::poisson_limit(plane);
    let share = match kind {
        BondLawKind::BondBased => 1.0,
        BondLawKind::TwoParameter | BondLawKind::OneBondTwoParameter => 0.7,
        BondLawKind::StateBased => 1.2,
    };
    Material::elastic(200e9, limit * share, plane)
}

pub fn body(case: &Case) -> Body {
    let model = case.points();
    model.body(&case.specimen, &case.material).unwrap()
}

/// A plate in equilibrium.
#[derive(Clone)]
pub struct Loaded {
    pub body: Body,
    pub bonds: Bonds,
    pub displacement: Vec<f64>,
    pub work: f64,
    pub iterations: usize,
    /// Points that were solved for.
    pub solved: usize,
}

/// The plate of a case at maximum load, by factorisation without a solver.
pub fn loaded(case: &Case, solver: impl Into<Option<SolverKind>>) -> Result<Loaded> {
    let body = body(case);
    let bonds = Bonds::new(&body);
    loaded_by(body, bonds, case.loading.maximum, solver, case.points().symmetry)
}

/// A plate with these bonds under a load, solved as a whole.
pub fn loaded_with(body: Body, bonds: Bonds, load: f64, solver: impl Into<Option<SolverKind>>) -> Result<Loaded> {
    loaded_by(body, bonds, load, solver, Symmetry::Off)
}

fn loaded_by(body: Body, bonds: Bonds, load: f64, solver: impl Into<Option<SolverKind>>, symmetry: Symmetry) -> Result<Loaded> {
    let mut displacement = Vec::new();
    let mut equilibrium = Equilibrium::new(solver, symmetry, &body, &bonds, load);
    let iterations = equilibrium.solve(&body, &bonds, &mut displacement)?;
    let solved = equilibrium.points(&body);
    Ok(Loaded { work: equilibrium.work(), body, bonds, displacement, iterations, solved })
}

impl Loaded {
    /// Stretch of every intact bond.
    pub fn stretches(&self) -> Vec<f64> {
        let layout = Layout::of(&self.body.lattice, self.body.stencil.unknowns);
        (0..self.body.multiplier.len() as Bond)
            .filter(|&bond| self.bonds.is_intact(bond))
            .map(|bond| stretch(&self.body, &layout, &self.displacement, bond))
            .collect()
    }
}
