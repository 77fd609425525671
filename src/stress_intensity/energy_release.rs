//! Energy released between slightly different crack lengths.
//!
//! At constant load a crack that grows by da releases half the work the loads do, `G = d(f·u)/2 / (h da)` a tip, and
//! `E' G = K_I² + K_II²` for growth straight ahead. The work is taken at three crack lengths; a parabola through them, over
//! the lengths that the cut bonds represent, has its slope at the length asked for.
//!
//! Straight growth alone cannot tell the modes apart. The mutual work of two loads can (Bueckner 1970, Z. Angew. Math.
//! Mech. 50:529; Rice 1972, Int. J. Solids Struct. 8:751): `E'/(2h) d(f·u^aux)/da = K_I K_I^aux + K_II K_II^aux`. Forces on
//! the crack faces that open or slide them are auxiliary loads of one mode each, and their own work tells their K^aux. What
//! is not symmetric about the crack plane and nearer to the tip than some lengths of those loads, such as a parallel crack,
//! gives them a little of the other mode: K_II then errs by about that share of K_I.

use std::time::Instant;

use super::face_loads::face_loads;
use super::{CrackedPlate, Intensity, MethodResult, StressIntensityMethod};
use crate::error::Result;
use crate::solver::field::Layout;
use crate::specimen::{Point, SpecimenKind};
use crate::state::Bonds;

/// Lengths of the method for a crack of one direction, in spacings.
struct Lengths {
    /// Growth between the crack lengths.
    step: f64,
    /// Distance of the auxiliary loads behind the tip.
    behind: f64,
    /// Half length and depth over which they are spread.
    reach: f64,
}

/// A crack along the rows or columns of points: the pattern of cut bonds repeats with every spacing, and points lie symmetric
/// about it, so that the loads can stand where nothing else disturbs their symmetry.
const ALIGNED: Lengths = Lengths { step: 1.0, behind: 2.25, reach: 2.1 };
/// Any other crack: enough bonds for the length they represent to be smooth (a whole number of patterns at 45°), and loads
/// spread over so many points that their places do not matter.
const SLANTED: Lengths = Lengths { step: 3.0 * std::f64::consts::SQRT_2, behind: 9.0, reach: 6.0 };
/// Largest step and distance of the loads as shares of the crack, and reach of the loads as share of the way to what is next.
const STEP_SHARE: f64 = 0.25;
const BEHIND_SHARE: f64 = 0.5;
const REACH_SHARE: f64 = 0.5;
/// Least reach in spacings: two rows of points on each side.
const REACH_MIN: f64 = 1.6;

/// Work of the loads at growths of a tip: (growth that the cut bonds represent, f·u).
type Works = Vec<(f64, f64)>;

/// Factors of the tips with these numbers.
///
/// # Errors
/// Mechanics without equilibrium at one of the crack lengths.
pub fn all_tips(plate: &mut CrackedPlate, tips: &[usize]) -> Result<Vec<MethodResult>> {
    if plate.case.specimen.kind == SpecimenKind::Plate {
        let started = Instant::now();
        let unmoved = plate.solve(&plate.growth_of_all(0.0))?.work;
        let shared = started.elapsed().as_secs_f64();
        return tips.iter().map(|&tip| one_tip(plate, tip, unmoved, shared)).collect();
    }
    // The standard specimens are symmetric about the crack plane, and their tips are each other's mirror images.
    let started = Instant::now();
    let step = lengths(plate, tips[0]).step;
    let mut works = Works::new();
    for growth in [-step, 0.0, step] {
        let field = plate.solve(&plate.growth_of_all(growth))?;
        let excess: f64 = tips.iter().map(|&tip| plate.represented(&field.specimen, tip).excess).sum();
        works.push((growth + excess / tips.len() as f64, field.work));
    }
    let released = slope_at_zero(&works) / tips.len() as f64;
    let k_i = squared_factor(plate, released).max(0.0).sqrt();
    let wall_s = started.elapsed().as_secs_f64();
    let result = |_| MethodResult {
        method: StressIntensityMethod::EnergyRelease,
        intensity: Intensity::both([k_i, 0.0]),
        note: None,
        wall_s,
    };
    Ok(tips.iter().map(result).collect())
}

/// Both modes of one tip that grows alone, from the work at growth 0 and at both sides of it; `shared` are the seconds the
/// former took.
fn one_tip(plate: &mut CrackedPlate, tip: usize, unmoved: f64, shared: f64) -> Result<MethodResult> {
    let started = Instant::now();
    let Lengths { step, behind, reach } = lengths(plate, tip);
    let frame = plate.frame(&plate.case.specimen, tip);
    let enough = reach >= REACH_MIN * plate.body.lattice.spacing && plate.body.boundary.clamped.is_empty();
    let auxiliary = if enough { face_loads(plate, &frame, behind, reach) } else { None };
    let mut total = Works::new();
    // Of the opening and the sliding load: their work with the plate's own load, and with themselves.
    let (mut mutual, mut own): ([Works; 2], [Works; 2]) = Default::default();
    for growth in [-step, 0.0, step] {
        let mut growths = plate.growth_of_all(0.0);
        growths[tip] = growth;
        let (specimen, bonds) = plate.cut(&growths)?;
        let at = growth + plate.represented(&specimen, tip).excess;
        if growth == 0.0 {
            total.push((at, unmoved));
            continue;
        }
        total.push((at, plate.solve(&growths)?.work));
        for (mode, forces) in auxiliary.iter().flatten().enumerate() {
            let works = auxiliary_works(plate, &bonds, forces)?;
            mutual[mode].push((at, works[0]));
            own[mode].push((at, works[1]));
        }
    }
    let total = squared_factor(plate, slope_at_zero(&total));
    let (intensity, note) = if auxiliary.is_some() {
        let factor = |mode: usize| {
            squared_factor(plate, mean_slope(&mutual[mode])) / squared_factor(plate, mean_slope(&own[mode])).max(0.0).sqrt()
        };
        (split(total, [factor(0), factor(1)]), None)
    } else {
        let note = "straight growth gives K_I² + K_II² only, and there is no room for loads on the crack faces, which would \
                    tell the modes apart; a smaller model.spacing_mm helps";
        (Intensity::default(), Some(note.to_owned()))
    };
    let wall_s = shared + started.elapsed().as_secs_f64();
    Ok(MethodResult { method: StressIntensityMethod::EnergyRelease, intensity, note, wall_s })
}

/// Work of the plate's own load over the displacement of forces on the crack faces, and of those forces themselves.
fn auxiliary_works(plate: &mut CrackedPlate, bonds: &Bonds, forces: &[(u32, Point)]) -> Result<[f64; 2]> {
    let (displacement, own) = plate.solve_forces(bonds, forces)?;
    let unit = work_of(&plate.layout(), &plate.body.boundary.forces, &displacement);
    Ok([plate.case.loading.maximum * unit, own])
}

/// The modes in the proportion that the mutual works show, with the size that the energy of the load itself has.
fn split(total: f64, mutual: [f64; 2]) -> Intensity {
    let size = mutual[0].hypot(mutual[1]);
    let scale = if size > 0.0 { total.max(0.0).sqrt() / size } else { 0.0 };
    Intensity::both(mutual.map(|k| scale * k))
}

/// `E' d(f·u)/da / 2h`: a product of two factors, Pa² m.
fn squared_factor(plate: &CrackedPlate, slope: f64) -> f64 {
    0.5 * plate.case.material.plane_modulus() * slope / plate.case.specimen.thickness
}

/// f·u of forces on points.
fn work_of(layout: &Layout, forces: &[(u32, Point)], displacement: &[f64]) -> f64 {
    let of_point = |&(place, f): &(u32, Point)| {
        let at = layout.index(place as usize);
        f[0] * displacement[at] + f[1] * displacement[at + layout.stride]
    };
    forces.iter().map(of_point).sum()
}

/// Lengths of the method at a tip, m.
fn lengths(plate: &CrackedPlate, tip: usize) -> Lengths {
    let (specimen, spacing) = (&plate.case.specimen, plate.body.lattice.spacing);
    let [x, y] = plate.body.lattice.to_axes(specimen.tips[tip].direction);
    // The tilt of a row over the crack's own length would be seen; what is smaller than this is a row.
    let chosen = if x.abs().min(y.abs()) < 1e-6 { ALIGNED } else { SLANTED };
    let crack = plate.crack_behind(specimen, tip);
    let next = plate.clear_radius(specimen, tip) + plate.body.horizon();
    Lengths {
        step: (chosen.step * spacing).min(STEP_SHARE * crack),
        behind: (chosen.behind * spacing).min(BEHIND_SHARE * crack),
        reach: (chosen.reach * spacing).min(REACH_SHARE * next),
    }
}

/// Slope of the line through two points.
fn mean_slope(points: &[(f64, f64)]) -> f64 {
    let [(x0, y0), (x1, y1)] = points[..] else { return f64::NAN };
    (y1 - y0) / (x1 - x0)
}

/// Slope at 0 of the parabola through three points.
fn slope_at_zero(points: &[(f64, f64)]) -> f64 {
    let [(x0, _), (x1, _), (x2, _)] = points[..] else { return f64::NAN };
    let (first, second) = (mean_slope(&points[..2]), mean_slope(&points[1..]));
    first - (second - first) / (x2 - x0) * (x0 + x1)
}
