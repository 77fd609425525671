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

use std::f64::consts::TAU;

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::boundary::motions;
use super::dissection::Factor;
use super::field::Discretisation;
use super::pin_contact::{Borne, PinRim, bear};
use super::rim_waves::{PLACES, Places, Shape};
use perilife_base::error::Result;
use perilife_plate::specimen::geometry::circle_crossing;
use perilife_plate::specimen::pin::{Contact, Pin};
use perilife_plate::specimen::{Bearing, Hole, Load, Point, Specimen};

/// Columns that are solved for together.
const TOGETHER: usize = 16;

/// An elastic pin among the loads of a plate.
struct Bore<'a> {
    load: usize,
    hole: Hole,
    pin: &'a Pin,
    /// Direction of its force, rad.
    middle: f64,
    /// Force, N.
    force: f64,
    /// Its rim, angles from its direction.
    places: Places,
}

/// A load on the rim of a pin, 1 Pa, along the radius or the rim.
struct Mode {
    bore: usize,
    shape: Shape,
    is_tangential: bool,
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
            bores.push(Bore { load, hole, pin, middle, force, places: Places::new(pieces().filter_map(crossing).collect()) });
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
    let places = |bore: &Bore<'_>| bore.places.angles().map(|angle| motions(plate, bore.at(angle))).collect::<Result<Vec<_>>>();
    let rows = bores.iter().map(places).collect::<Result<Vec<_>>>()?;
    let modes = modes(&bores);
    let column = |mode: &Mode| {
        let (bore, mut column) = (&bores[mode.bore], vec![0.0; others.len()]);
        let area = bore.hole.radius * specimen.thickness * TAU / PLACES as f64;
        for (angle, row) in bore.places.angles().zip(&rows[mode.bore]) {
            push(&mut column, row, bore.axes(angle), mode.traction(angle).map(|size| size * area));
        }
        column
    };
    let mut columns: Vec<Vec<f64>> = modes.iter().map(column).collect();
    columns.push(others.to_vec());
    columns.par_chunks_mut(TOGETHER).for_each(|columns| factor.forward_together(columns));
    columns.par_iter_mut().for_each(|column| factor.backward(column));
    let on_rims = |u: &Vec<f64>| -> OnRims {
        let read = |(bore, rows): (&Bore<'_>, &Vec<Vec<(u32, Point)>>)| {
            bore.places.smooth(bore.places.angles().zip(rows).map(|(angle, row)| moved(u, row, bore.axes(angle))).collect())
        };
        bores.iter().zip(&rows).map(read).collect()
    };
    let mut fields: Vec<OnRims> = columns.par_iter().map(on_rims).collect();
    let Some(beside) = fields.pop() else { return Ok(None) };
    for (mode, field) in modes.iter().zip(&mut fields) {
        let bore = &bores[mode.bore];
        for (angle, u) in bore.places.angles().zip(&mut field[mode.bore]) {
            let plane = mode.shape.plane(angle, mode.is_tangential, bore.hole.radius, elasticity);
            *u = [u[0] - plane[0], u[1] - plane[1]];
        }
    }
    let rims: Vec<PinRim> = bores
        .iter()
        .map(|bore| {
            let constants = elasticity.another(bore.pin.youngs_modulus, bore.pin.poisson_ratio);
            PinRim::new(bore.pin, constants, elasticity, [bore.hole.radius, specimen.thickness, bore.force], bore.places.mouths())
        })
        .collect();
    let places: Vec<&Places> = bores.iter().map(|bore| &bore.places).collect();
    let on_pieces = |(index, rim): (usize, &PinRim)| -> Vec<f64> {
        rim.angles.iter().flat_map(|&angle| places[index].between(&beside[index], angle)).collect()
    };
    let of_others: Vec<f64> = rims.iter().enumerate().flat_map(on_pieces).collect();
    let Borne { contacts, work } = bear(&rims, elasticity, &of_others, finite(&rims, &places, &modes, &fields))?;
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
        let shapes = of.places.shapes();
        for is_tangential in [false, true].into_iter().filter(|is_tangential| !is_tangential || of.pin.friction > 0.0) {
            modes.extend(shapes.iter().map(|shape| Mode { bore, shape: shape.clone(), is_tangential }));
        }
    }
    modes
}

/// D for all pieces of all rims, m/Pa.
fn finite(rims: &[PinRim], places: &[&Places], modes: &[Mode], fields: &[OnRims]) -> DMatrix<f64> {
    let pieces: Vec<(usize, f64)> =
        rims.iter().enumerate().flat_map(|(rim, of)| of.angles.iter().map(move |&angle| (rim, angle))).collect();
    let rests: Vec<OnRims> = fields.par_iter().map(|field| rest(field, places, modes)).collect();
    let table = |of: &dyn Fn(usize, usize, f64) -> [f64; 2]| {
        DMatrix::from_fn(2 * pieces.len(), modes.len(), |row, k| {
            let (rim, angle) = pieces[row / 2];
            of(k, rim, angle)[row % 2]
        })
    };
    let own = table(&|k, rim, angle| if modes[k].bore == rim { modes[k].traction(angle) } else { [0.0; 2] });
    let field = table(&|k, rim, angle| places[rim].between(&fields[k][rim], angle));
    let rest = table(&|k, rim, angle| places[rim].between(&rests[k][rim], angle));
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
fn rest(field: &OnRims, places: &[&Places], modes: &[Mode]) -> OnRims {
    let mut rest = field.clone();
    for mode in modes {
        let tractions: Vec<[f64; 2]> = places[mode.bore].angles().map(|angle| mode.traction(angle)).collect();
        let sum: f64 = tractions.iter().zip(&field[mode.bore]).map(|(h, u)| h[0] * u[0] + h[1] * u[1]).sum();
        let size = sum * TAU / PLACES as f64 / mode.shape.norm();
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
