//! Points of several levels: what the dual horizon keeps, and what a change of level does to uniform strain.

use super::uniform_tension::{self, laws, rest_within_rim, steel, strip};
use super::values::Figures;
use perilife_base::error::{Error, Result};
use perilife_base::units::MM;
use perilife_plate::material::{Material, Plane};
use perilife_plate::specimen::{Crack, Hole, Point, Slot, Specimen};
use perilife_points::bond_law::stencil::poisson_limit;
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_points::net::{Net, NetBond};
use perilife_scenes::bonds::BondState;
use perilife_scenes::failure::Failure;
use perilife_scenes::interaction::{Damaging, Interaction};
use perilife_scenes::scene::{Discretisation, RefinedRegion, Refinement, Scene, SceneLaw};
use perilife_scenes::springs::Springs;

/// The published law: bond-based, constant kernel on the stretch, partial volumes, no surface correction.
pub const PUBLISHED: BondLaw = BondLaw {
    kind: BondLawKind::BondBased,
    kernel: Kernel::Constant,
    rotation: Rotation::Resisted,
    surface_correction: SurfaceCorrection::None,
};
const STRAIN: f64 = 1e-3;
/// Spacing of their coarse points, m.
const SPACING: f64 = 2.0 * MM;

/// A material that springs can be: E = 200 GPa, plane stress, ν that of the bond-based law or 0.7 of it.
pub fn material(law: &BondLaw) -> Material {
    let share = if law.kind == BondLawKind::BondBased { 1.0 } else { 0.7 };
    steel(share * poisson_limit(Plane::Stress))
}

/// A plate that nothing loads or breaks, on a dual horizon with finer points in these regions.
pub fn scene(specimen: Specimen, law: BondLaw, spacing: f64, regions: &[(RefinedRegion, usize)]) -> Scene {
    let mut scene = Scene::bare("levels", specimen, material(&law), SceneLaw::Bonds(law), spacing);
    scene.model.arrangement = Discretisation::DualHorizon;
    scene.refinement = Some(Refinement { regions: regions.to_vec() });
    scene
}

/// A plate of 100 x 60 mm without loads.
fn plain() -> Specimen {
    Specimen { loads: Vec::new(), thickness: 2.0 * MM, ..strip(100.0 * MM, 60.0 * MM) }
}

/// [`plain`] with all that a bond can meet: hole, slot and slant crack; its points are split in four twice around them, and once along
/// a side.
fn flawed(law: BondLaw) -> Scene {
    let mut specimen = plain();
    let mm = |point: Point| point.map(|x| x * MM);
    specimen.holes.push(Hole { centre: mm([22.0, 12.0]), radius: 6.0 * MM });
    specimen.slots.push(Slot { from: mm([-50.0, -5.0]), to: mm([-30.0, -5.0]), width: 2.0 * MM });
    specimen.cracks.push(Crack::straight(mm([0.0, -14.0]), mm([9.0, -10.0])));
    let side = RefinedRegion::Box { low: mm([-50.0, -30.0]), high: mm([50.0, -24.0]) };
    scene(specimen, law, SPACING, &[(RefinedRegion::AroundFlaws { distance: 3.0 * MM }, 2), (side, 1)])
}

/// Forces of whole springs at a displacement, N.
pub fn forces(net: &Net, u: &[f64]) -> Vec<f64> {
    let mut bonds = BondState::new(net, &vec![false; net.len()]);
    let mut force = vec![0.0; u.len()];
    Springs::new(net, Failure::Never, false).internal_force(u, &mut bonds, Damaging::Frozen, &mut force);
    force
}

/// What the forces of a net, which are to cancel, leave at a displacement: the resultant over the sum of the sizes of all forces, and the
/// moment, couples among it, over the sum of force times distance from the middle.
fn left(net: &Net, u: &[f64]) -> [f64; 2] {
    let n = net.unknowns;
    let (mut sum, mut moment, mut size, mut lever) = ([0.0; 2], 0.0, 0.0, 0.0);
    for (f, x) in forces(net, u).chunks_exact(n).zip(&net.positions) {
        sum = [sum[0] + f[0], sum[1] + f[1]];
        moment += x[0] * f[1] - x[1] * f[0] + if n == 3 { net.rotation_length * f[2] } else { 0.0 };
        size += f[0].abs() + f[1].abs();
        lever += (f[0].abs() + f[1].abs()) * x[0].hypot(x[1]);
    }
    [sum[0].hypot(sum[1]) / size, moment.abs() / lever]
}

/// A plate with finer points in its middle whose rim has uniform tension along x, as it comes to rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Least and largest local strain over the nominal one, between neighbours of a row of one level.
    pub strains: [f64; 2],
    /// Largest error of a displacement along x over strain times length.
    pub off: f64,
}

/// The patch of a law, its middle 40 mm wide.
pub fn patch(law: BondLaw) -> Result<Patch> {
    let half = [20.0 * MM, 30.0 * MM];
    let scene = scene(plain(), law, SPACING, &[(RefinedRegion::Box { low: half.map(|x| -x), high: half }, 1)]);
    let net = perilife_scenes::build(&scene)?.0;
    let (n, nu, size) = (net.unknowns, scene.material.poisson_ratio, net.len() * net.unknowns);
    let (mut exact, mut held) = (vec![0.0; size], vec![false; size]);
    for (i, x) in net.positions.iter().enumerate() {
        (exact[n * i], exact[n * i + 1]) = (STRAIN * x[0], -nu * STRAIN * x[1]);
        let rim = x[0].abs() > 44.0 * MM || x[1].abs() > 24.0 * MM;
        (held[n * i], held[n * i + 1]) = (rim, rim);
    }
    let u = rest_within_rim(&net, &exact, held.clone())?;
    let off = u.chunks_exact(n).zip(exact.chunks_exact(n)).fold(0.0, |m: f64, (a, b)| m.max((a[0] - b[0]).abs()));
    let between = |bond: &NetBond| {
        let (a, b) = (bond.from as usize, bond.to as usize);
        let free = !held[n * a] && !held[n * b];
        let neighbours = free && bond.normal[1].abs() < 1e-9 && bond.length < 1.01 * net.spacings[a];
        neighbours.then(|| (u[n * b] - u[n * a]) / (net.positions[b][0] - net.positions[a][0]) / STRAIN)
    };
    let strains = net.bonds[..net.mutual].iter().filter_map(between);
    let strains = strains.fold([f64::INFINITY, 0.0], |[low, high], s| [low.min(s), high.max(s)]);
    Ok(Patch { strains, off: off / (STRAIN * 100.0 * MM) })
}

/// The mixed-mode plate of Nooru-Mohamed with its refined ligament, as shipped.
const TWO_LEVELS: &str = include_str!("../../data/cases/fracture/mixed_mode_two_levels.toml");
/// The same with fine points everywhere.
const UNIFORM: &str = include_str!("../../data/cases/fracture/mixed_mode_uniform.toml");

/// Points of the mixed-mode plate: with 2.5 mm alone, those that the ligament is made of, those of 1.25 mm into
/// which they are split, all with the refined ligament, with 1.25 mm everywhere.
pub fn counts() -> Result<Figures> {
    let read = |text: &str| Scene::from_toml(text, "mixed_mode", std::path::Path::new("."), &[]);
    let two_levels = read(TWO_LEVELS)?;
    let net = perilife_scenes::build(&two_levels)?.0;
    let coarse = perilife_scenes::build(&Scene { refinement: None, ..two_levels })?.0.len();
    let fine = net.spacings.iter().filter(|&&spacing| spacing < 2.0 * MM).count();
    let uniform = perilife_scenes::build(&read(UNIFORM)?)?.0.len();
    let counts = [coarse, coarse - (net.len() - fine), fine, net.len(), uniform].map(|count| count as f64);
    Ok(["coarse", "split", "fine", "both", "uniform"].into_iter().zip(counts).collect())
}

/// The patch of the published law, or of the one whose changes of level are balanced.
pub fn patch_of(law: &str) -> Result<Figures> {
    let law = match law {
        "published" => PUBLISHED,
        "balanced" => BALANCED,
        other => return Err(Error::Mechanics(format!("data/studies: law={other}: neither published nor balanced"))),
    };
    let Patch { strains: [low, high], off } = patch(law)?;
    Ok(vec![("least", low), ("largest", high), ("off", off)])
}

/// The law whose changes of level are balanced.
pub(super) const BALANCED: BondLaw = BondLaw { rotation: Rotation::Resisted, ..uniform_tension::BALANCED };

/// Resultant and moment of a disorderly displacement on three levels around flaws, largest of all laws; the least moment of laws whose
/// tangential springs resist rotation.
pub fn momentum() -> Result<Figures> {
    let (mut force, mut moment, mut couple, mut count) = (0.0_f64, 0.0_f64, f64::INFINITY, 0.0);
    for law in laws().filter(|law| law.surface_correction != SurfaceCorrection::Balanced).chain([BALANCED]) {
        let net = perilife_scenes::build(&flawed(law))?.0;
        // Sines of large arguments: neighbours have nothing in common.
        let u: Vec<f64> = (0..net.len() * net.unknowns).map(|i| 1e-6 * (1e3 * i as f64).sin()).collect();
        let [resultant, turning] = left(&net, &u);
        force = force.max(resultant);
        if law.kind.is_two_parameter() && law.rotation == Rotation::Resisted {
            couple = couple.min(turning);
        } else {
            moment = moment.max(turning);
        }
        count += 1.0;
    }
    Ok(vec![("force", force), ("moment", moment), ("couple", couple), ("laws", count)])
}
