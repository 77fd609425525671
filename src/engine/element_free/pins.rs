//! Pins in the holes of a plate of nodes: what their forces do to all rims, and where they touch.
//!
//! Nodes are a third of a radius apart, far too coarse for the narrow contact of a loose pin. So a plate is taken as a plane with one hole,
//! known in closed form ([`super::pin_contact`]), and what it is beyond that: D, which is smooth on the rim, since loads e^(inθ) are felt at
//! a distance d as (R/d)^n. With the factor at hand, one column for each load H_k = cos nθ, sin nθ up to n = 4, at a hole where cracks begin up
//! to n = 12 and one that jumps there, gives
//! ```text
//! r_k = u of the plate under H_k - u of the plane with a hole,   N_k = ∫ H_k² dθ
//! D = Σ_k r_k ⟨H_k, ·⟩/N_k + Σ_k H_k ⟨r_k - P r_k, ·⟩/N_k,       P the projection on all H
//! ```
//! The second sum is the first turned round (Maxwell and Betti). Of what is read on a rim only these waves are kept, and the jump
//! where a crack begins at the hole, drawn out linearly round the rim: shorter ones are those of the nodes, and would show in the pressure.
//! A floating plate reacts to a single load at its three held unknowns; the reactions vanish with the sum of all loads.

use std::f64::consts::{PI, TAU};

use nalgebra::{Complex, DMatrix};
use rayon::prelude::*;

use super::boundary::motions;
use super::dissection::Factor;
use super::field::Discretisation;
use super::pin_contact::{Borne, PinRim, bear};
use crate::error::Result;
use crate::specimen::geometry::circle_crossing;
use crate::specimen::pin::{Contact, Pin};
use crate::specimen::{Bearing, Hole, Load, Point, Specimen};
use crate::williams::Elasticity;

/// Waves around a rim up to which the plate is not taken as a plane with one hole, and displacement is kept as it is read: without cracks from
/// it, and with, where nodes are finer ([`super::resolution`]).
const HARMONICS: [i32; 2] = [4, 12];
/// Places around a rim where displacement is read and harmonics are loaded.
const PLACES: usize = 180;
/// Columns that are solved for together.
const TOGETHER: usize = 16;
const TURN: f64 = TAU;

/// An elastic pin among the loads of a plate.
struct Bore<'a> {
    load: usize,
    hole: Hole,
    pin: &'a Pin,
    /// Direction of its force, rad.
    middle: f64,
    /// Force, N.
    force: f64,
    /// Where cracks begin at the hole, rad from its direction.
    mouths: Vec<f64>,
}

/// A load on the rim of a pin, 1 Pa, along the radius or the rim.
struct Mode {
    bore: usize,
    shape: Shape,
    is_tangential: bool,
}

/// Its course round the rim; all those of a rim are orthogonal.
#[derive(Clone)]
enum Shape {
    /// e^(inθ), its real part or its imaginary one.
    Wave { waves: i32, is_sine: bool },
    /// Sum of jumps ([`jump`]) at angles, each by its weight, without waves up to a number.
    Jumps { jumps: Vec<[f64; 2]>, without: i32 },
}

/// What waves up to a number leave of a jump by 1 at x = 0 that is drawn out linearly round the rim: Σ sin nx / πn of all shorter waves.
fn jump(x: f64, without: i32) -> f64 {
    let waves: f64 = (1..=without).map(f64::from).map(|n| (n * x).sin() / n).sum();
    0.5 - x.rem_euclid(TURN) / TURN - waves / PI
}

/// ∫ of the product of two such jumps that are x apart: Σ cos nx / πn², all waves of which make a parabola.
fn jumps_product(x: f64, without: i32) -> f64 {
    let x = x.rem_euclid(TURN);
    let waves: f64 = (1..=without).map(f64::from).map(|n| (n * x).cos() / (n * n)).sum();
    (PI * PI / 6.0 - 0.5 * PI * x + 0.25 * x * x - waves) / PI
}

impl Shape {
    fn at(&self, angle: f64) -> f64 {
        match self {
            Shape::Wave { waves, is_sine: false } => (f64::from(*waves) * angle).cos(),
            Shape::Wave { waves, .. } => (f64::from(*waves) * angle).sin(),
            Shape::Jumps { jumps, without } => jumps.iter().map(|[weight, place]| weight * jump(angle - place, *without)).sum(),
        }
    }

    /// N_k.
    fn norm(&self) -> f64 {
        match self {
            Shape::Wave { waves: 0, .. } => TURN,
            Shape::Wave { .. } => 0.5 * TURN,
            Shape::Jumps { jumps, without } => product(jumps, jumps, *without),
        }
    }

    /// u_r and u_θ, m, of a plane with a hole of this radius: F_n e^(inθ) moves it by R/2G F_n/(n+1) and R/2G κ F₋ₙ/(n-1). Of what jumps
    /// there are shorter waves only, which are not kept.
    fn plane(&self, angle: f64, is_tangential: bool, radius: f64, plate: Elasticity) -> [f64; 2] {
        let Shape::Wave { waves, is_sine } = *self else { return [0.0; 2] };
        let n = f64::from(waves);
        let half = if is_sine { Complex::new(0.0, -0.5) } else { Complex::new(0.5, 0.0) };
        let turned = if is_tangential { Complex::i() } else { Complex::new(1.0, 0.0) };
        let (forth, back) = (half * turned * Complex::cis(n * angle), half.conj() * turned * Complex::cis(-n * angle));
        let moved = match waves {
            0 => turned,
            1 => 0.5 * forth,
            _ => forth / (n + 1.0) + back * (plate.kappa / (n - 1.0)),
        };
        let u = moved * (0.5 * radius / plate.shear_modulus);
        [u.re, u.im]
    }
}

/// ∫ of the product of two sums of jumps.
fn product(a: &[[f64; 2]], b: &[[f64; 2]], without: i32) -> f64 {
    a.iter().flat_map(|[w, x]| b.iter().map(move |[v, y]| w * v * jumps_product(x - y, without))).sum()
}

impl Mode {
    /// On the plate along radius and rim, Pa.
    fn traction(&self, angle: f64) -> [f64; 2] {
        let size = self.shape.at(angle);
        if self.is_tangential { [0.0, size] } else { [size, 0.0] }
    }
}

/// u_r and u_θ, m, at the places of every pin.
type OnRims = Vec<Vec<[f64; 2]>>;

fn place_angle(place: usize) -> f64 {
    TURN * (place as f64 + 0.5) / PLACES as f64
}

/// Waves that are kept around a rim with these mouths of cracks.
fn kept_waves(mouths: &[f64]) -> i32 {
    HARMONICS[usize::from(!mouths.is_empty())]
}

/// The place after a mouth.
fn after(mouth: f64) -> usize {
    (mouth / TURN * PLACES as f64 + 0.5).rem_euclid(PLACES as f64) as usize % PLACES
}

/// What is read at the places of a rim without shorter waves than are kept, but for jumps at these angles.
fn smooth(mut read: Vec<[f64; 2]>, mouths: &[f64]) -> Vec<[f64; 2]> {
    let mut jumps = vec![[0.0; 2]; PLACES];
    for mouth in mouths {
        let after = after(*mouth);
        let before = (after + PLACES - 1) % PLACES;
        let jump = [0, 1].map(|part| read[after][part] - read[before][part]);
        for (k, sum) in jumps.iter_mut().enumerate() {
            let way = ((k + PLACES - after) % PLACES) as f64 + 0.5;
            (0..2).for_each(|part| sum[part] += jump[part] * (0.5 - way / PLACES as f64));
        }
    }
    read.iter_mut().zip(&jumps).for_each(|(u, jump)| *u = [u[0] - jump[0], u[1] - jump[1]]);
    let mut kept = jumps;
    for waves in 0..=kept_waves(mouths) {
        let size = if waves == 0 { 1.0 } else { 2.0 } / PLACES as f64;
        let angle = |place: usize| f64::from(waves) * place_angle(place);
        for shape in [f64::cos, f64::sin] {
            let sums = [0, 1].map(|part| read.iter().enumerate().map(|(k, u)| shape(angle(k)) * u[part]).sum::<f64>());
            kept.iter_mut().enumerate().for_each(|(k, u)| (0..2).for_each(|part| u[part] += size * shape(angle(k)) * sums[part]));
        }
    }
    kept
}

/// Between the places of a rim, in a straight line.
fn between(values: &[[f64; 2]], angle: f64) -> [f64; 2] {
    let at = (angle / TURN * PLACES as f64 - 0.5).rem_euclid(PLACES as f64);
    let (low, share) = (at as usize % PLACES, at.fract());
    [0, 1].map(|part| (1.0 - share) * values[low][part] + share * values[(low + 1) % PLACES][part])
}

impl Bore<'_> {
    fn axes(&self, angle: f64) -> [Point; 2] {
        let (sin, cos) = (self.middle + angle).sin_cos();
        [[cos, sin], [-sin, cos]]
    }

    fn at(&self, angle: f64) -> Point {
        let [out, _] = self.axes(angle);
        [0, 1].map(|i| self.hole.centre[i] + self.hole.radius * out[i])
    }
}

/// Elastic pins of a plate at a nominal load, Pa or N.
fn bores<'a>(specimen: &'a Specimen, plate: &Discretisation, nominal: f64) -> Vec<Bore<'a>> {
    let mut bores = Vec::new();
    let pieces = || plate.obstacles.cuts[..plate.cracks].iter().flat_map(|cut| cut.points.windows(2));
    for (load, of) in specimen.loads.iter().enumerate() {
        if let Load::Pin { hole, direction, force, contact: Bearing::Elastic(pin) } = of {
            let (middle, force, hole) = (direction[1].atan2(direction[0]), force * nominal, specimen.holes[*hole]);
            let crossing = |piece: &[Point]| {
                let [x, y] = circle_crossing(piece[0], piece[1], hole.centre, hole.radius)?;
                Some((y - hole.centre[1]).atan2(x - hole.centre[0]) - middle)
            };
            bores.push(Bore { load, hole, pin, middle, force, mouths: pieces().filter_map(crossing).collect() });
        }
    }
    bores
}

/// What elastic pins do on a plate.
pub struct Pins {
    /// Contact of each, with the index of its load.
    pub contacts: Vec<(usize, Contact)>,
    /// Forces on the unknowns, N.
    pub forces: Vec<f64>,
    /// What they do, see [`Borne::work`], J.
    pub work: f64,
}

/// Brings the elastic pins of a plate into contact beside `others`, the forces of its other loads, N, at a nominal load, Pa or N; `None`
/// without such pins.
/// Errors: [`Error::Mechanics`] where no contact is found, or a hole has too few nodes around it.
pub fn press_pins(
    specimen: &Specimen,
    plate: &Discretisation,
    factor: &Factor,
    others: &[f64],
    nominal: f64,
) -> Result<Option<Pins>> {
    let bores = bores(specimen, plate, nominal);
    if bores.is_empty() {
        return Ok(None);
    }
    let elasticity = plate.elasticity();
    let places =
        |bore: &Bore<'_>| (0..PLACES).map(|place| motions(plate, bore.at(place_angle(place)))).collect::<Result<Vec<_>>>();
    let rows = bores.iter().map(places).collect::<Result<Vec<_>>>()?;
    let modes = modes(&bores);
    let column = |mode: &Mode| {
        let (bore, mut column) = (&bores[mode.bore], vec![0.0; others.len()]);
        let area = bore.hole.radius * specimen.thickness * TURN / PLACES as f64;
        for (place, row) in rows[mode.bore].iter().enumerate() {
            push(&mut column, row, bore.axes(place_angle(place)), mode.traction(place_angle(place)).map(|size| size * area));
        }
        column
    };
    let mut columns: Vec<Vec<f64>> = modes.iter().map(column).collect();
    columns.push(others.to_vec());
    columns.par_chunks_mut(TOGETHER).for_each(|columns| factor.forward_together(columns));
    columns.par_iter_mut().for_each(|column| factor.backward(column));
    let on_rims = |u: &Vec<f64>| -> OnRims {
        let read = |(bore, rows): (&Bore<'_>, &Vec<Vec<(u32, Point)>>)| {
            let read = rows.iter().enumerate().map(|(place, row)| moved(u, row, bore.axes(place_angle(place))));
            smooth(read.collect(), &bore.mouths)
        };
        bores.iter().zip(&rows).map(read).collect()
    };
    let mut fields: Vec<OnRims> = columns.par_iter().map(on_rims).collect();
    let Some(beside) = fields.pop() else { return Ok(None) };
    for (mode, field) in modes.iter().zip(&mut fields) {
        for (place, u) in field[mode.bore].iter_mut().enumerate() {
            let radius = bores[mode.bore].hole.radius;
            let plane = mode.shape.plane(place_angle(place), mode.is_tangential, radius, elasticity);
            *u = [u[0] - plane[0], u[1] - plane[1]];
        }
    }
    let rims: Vec<PinRim> = bores
        .iter()
        .map(|bore| {
            let constants = elasticity.another(bore.pin.youngs_modulus, bore.pin.poisson_ratio);
            PinRim::new(bore.pin, constants, elasticity, [bore.hole.radius, specimen.thickness, bore.force])
        })
        .collect();
    let of_others: Vec<f64> =
        rims.iter().zip(&beside).flat_map(|(rim, field)| rim.angles.iter().flat_map(|&angle| between(field, angle))).collect();
    let Borne { contacts, work } = bear(&rims, elasticity, &of_others, finite(&rims, &modes, &fields))?;
    let mut forces = vec![0.0; others.len()];
    for (bore, contact) in bores.iter().zip(&contacts) {
        for piece in &contact.pieces {
            let row = motions(plate, bore.at(piece.angle))?;
            push(&mut forces, &row, bore.axes(piece.angle), piece.share.map(|share| share * bore.force));
        }
    }
    Ok(Some(Pins { contacts: bores.iter().map(|bore| bore.load).zip(contacts).collect(), forces, work }))
}

/// Loads on the rim of every pin.
fn modes(bores: &[Bore<'_>]) -> Vec<Mode> {
    let mut modes = Vec::new();
    for (bore, of) in bores.iter().enumerate() {
        let shapes = shapes(&of.mouths);
        for is_tangential in [false, true].into_iter().filter(|is_tangential| !is_tangential || of.pin.friction > 0.0) {
            modes.extend(shapes.iter().map(|shape| Mode { bore, shape: shape.clone(), is_tangential }));
        }
    }
    modes
}

/// Waves, and jumps between the places where cracks begin.
fn shapes(mouths: &[f64]) -> Vec<Shape> {
    let without = kept_waves(mouths);
    let waves = (0..=without).flat_map(|waves| {
        [false, true].into_iter().filter(move |is_sine| !is_sine || waves > 0).map(move |is_sine| Shape::Wave { waves, is_sine })
    });
    let mut jumps: Vec<Vec<[f64; 2]>> = Vec::new();
    for mouth in mouths {
        let mut next = vec![[1.0, TURN * after(*mouth) as f64 / PLACES as f64]];
        for other in &jumps {
            let share = product(&next, other, without) / product(other, other, without);
            next.extend(other.iter().map(|[weight, place]| [-share * weight, *place]));
        }
        // Cracks that begin at one place jump as one.
        if product(&next, &next, without) > 1e-3 * jumps_product(0.0, without) {
            jumps.push(next);
        }
    }
    waves.chain(jumps.into_iter().map(|jumps| Shape::Jumps { jumps, without })).collect()
}

/// D for all pieces of all rims, m/Pa.
fn finite(rims: &[PinRim], modes: &[Mode], fields: &[OnRims]) -> DMatrix<f64> {
    let pieces: Vec<(usize, f64)> =
        rims.iter().enumerate().flat_map(|(rim, of)| of.angles.iter().map(move |&angle| (rim, angle))).collect();
    let rests: Vec<OnRims> = fields.par_iter().map(|field| rest(field, modes)).collect();
    let table = |of: &dyn Fn(usize, usize, f64) -> [f64; 2]| {
        DMatrix::from_fn(2 * pieces.len(), modes.len(), |row, k| {
            let (rim, angle) = pieces[row / 2];
            of(k, rim, angle)[row % 2]
        })
    };
    let own = table(&|k, rim, angle| if modes[k].bore == rim { modes[k].traction(angle) } else { [0.0; 2] });
    let field = table(&|k, rim, angle| between(&fields[k][rim], angle));
    let rest = table(&|k, rim, angle| between(&rests[k][rim], angle));
    let weighed = |of: &DMatrix<f64>, weight: &dyn Fn(usize, usize) -> f64| {
        DMatrix::from_fn(of.nrows(), of.ncols(), |row, k| of[(row, k)] * weight(pieces[row / 2].0, k) / modes[k].shape.norm())
    };
    let loaded = weighed(&own, &|rim, _| rims[rim].width);
    // Work is force by way: lengths of rims of unlike radius count.
    let turned = weighed(&rest, &|rim, k| rims[rim].width * rims[rim].radius / rims[modes[k].bore].radius);
    let read = field * loaded.transpose() + own * turned.transpose();
    // What nodes and places leave of Maxwell's symmetry: in between.
    let area = |row: usize| rims[pieces[row / 2].0].width * rims[pieces[row / 2].0].radius;
    DMatrix::from_fn(read.nrows(), read.ncols(), |i, j| 0.5 * (read[(i, j)] + read[(j, i)] * area(j) / area(i)))
}

/// r - P r.
fn rest(field: &OnRims, modes: &[Mode]) -> OnRims {
    let mut rest = field.clone();
    for mode in modes {
        let tractions: Vec<[f64; 2]> = (0..PLACES).map(|place| mode.traction(place_angle(place))).collect();
        let sum: f64 = tractions.iter().zip(&field[mode.bore]).map(|(h, u)| h[0] * u[0] + h[1] * u[1]).sum();
        let size = sum * TURN / PLACES as f64 / mode.shape.norm();
        rest[mode.bore].iter_mut().zip(tractions).for_each(|(u, h)| *u = [u[0] - size * h[0], u[1] - size * h[1]]);
    }
    rest
}

/// Adds a force given in two axes.
fn push(forces: &mut [f64], row: &[(u32, Point)], axes: [Point; 2], size: [f64; 2]) {
    let force = [0, 1].map(|i| size[0] * axes[0][i] + size[1] * axes[1][i]);
    row.iter().for_each(|(unknown, [x, y])| forces[*unknown as usize] += force[0] * x + force[1] * y);
}

/// Displacement in two axes, m.
fn moved(u: &[f64], row: &[(u32, Point)], axes: [Point; 2]) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for (unknown, motion) in row {
        (0..2).for_each(|i| sum[i] += u[*unknown as usize] * motion[i]);
    }
    axes.map(|axis| axis[0] * sum[0] + axis[1] * sum[1])
}
