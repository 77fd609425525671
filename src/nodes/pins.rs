//! Pins in the holes of a plate of nodes: what their forces do to all rims, and where they touch.
//!
//! Nodes are a fifth of a radius apart, far too coarse for the narrow contact of a loose pin. So a plate is taken as a plane with one hole,
//! known in closed form ([`super::pin_contact`]), and what it is beyond that, carried by orthonormal functions Q of the angle
//! ([`super::rim_waves`]). With the factor `K = L Lᵀ` at hand, f_k the forces on nodes of a pressure Q_k and `Y = L⁻¹ f`,
//! ```text
//! D = Σ_kl Q_k (Y_k·Y_l - ⟨Q_k, u of the plane under Q_l⟩) ⟨Q_l, ·⟩
//! ```
//! is symmetric, as Maxwell and Betti have it. Of what other loads do to a rim the part in Q counts.
//! A floating plate reacts to a single load at its three held unknowns; the reactions vanish with the sum of all loads.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::boundary::motions;
use super::dissection::Factor;
use super::field::Discretisation;
use super::front::dot;
use super::pin_contact::{PinRim, Search, Solved};
use super::resolution::mouths;
use super::rim_waves::{Shapes, on_diagonal};
use perilife_base::error::Result;
use perilife_plate::specimen::pin::{Contact, Pin};
use perilife_plate::specimen::{Bearing, Hole, Load, Specimen};

/// Columns that are solved for together.
const TOGETHER: usize = 16;

/// Displacement outwards as a row of the unknowns.
type Row = Vec<(u32, f64)>;

/// An elastic pin among the loads of a plate.
struct Bore<'a> {
    load: usize,
    hole: Hole,
    pin: &'a Pin,
    /// Direction of its force, rad.
    middle: f64,
    /// Force, N per N or per Pa.
    force: f64,
    /// On its rim, angles from its direction.
    shapes: Shapes,
    /// Finer ones, by which contact is checked.
    finer: Shapes,
    /// Of the places of its shapes.
    rows: Vec<Row>,
}

impl Bore<'_> {
    /// Displacement outwards at an angle.
    fn row(&self, plate: &Discretisation, angle: f64) -> Result<Row> {
        let (sin, cos) = (self.middle + angle).sin_cos();
        let at = [self.hole.centre[0] + self.hole.radius * cos, self.hole.centre[1] + self.hole.radius * sin];
        Ok(motions(plate, at)?.into_iter().map(|(unknown, [x, y])| (unknown, x * cos + y * sin)).collect())
    }

    /// What unknowns, m, move its rim outwards.
    fn moved(&self, u: &[f64]) -> DVector<f64> {
        let moved = |row: &Row| row.iter().map(|&(unknown, by)| by * u[unknown as usize]).sum();
        DVector::from_iterator(self.rows.len(), self.rows.iter().map(moved))
    }
}

/// Elastic pins of a plate.
fn bores<'a>(specimen: &'a Specimen, plate: &Discretisation) -> Result<Vec<Bore<'a>>> {
    let mut bores = Vec::new();
    for (load, of) in specimen.loads.iter().enumerate() {
        let Load::Pin { hole, direction, force, contact: Bearing::Elastic(pin) } = of else { continue };
        let (middle, force, hole) = (direction[1].atan2(direction[0]), *force, specimen.holes[*hole]);
        let mouths = plate.obstacles.cuts[..plate.cracks].iter().flat_map(|cut| mouths(&cut.points, hole));
        let angles: Vec<f64> = mouths.map(|[x, y]| (y - hole.centre[1]).atan2(x - hole.centre[0]) - middle).collect();
        let (shapes, finer) = (Shapes::new(angles.clone(), false), Shapes::new(angles, true));
        let mut bore = Bore { load, hole, pin, middle, force, shapes, finer, rows: Vec::new() };
        bore.rows = bore.shapes.angles().map(|angle| bore.row(plate, angle)).collect::<Result<_>>()?;
        bores.push(bore);
    }
    Ok(bores)
}

fn push(forces: &mut [f64], row: &Row, size: f64) {
    row.iter().for_each(|&(unknown, by)| forces[unknown as usize] += size * by);
}

/// Elastic pins of a plate, and what it answers to them, for any load.
pub struct PinColumns<'a> {
    plate: &'a Discretisation,
    factor: &'a Factor,
    thickness: f64,
    bores: Vec<Bore<'a>>,
    /// ∫ of every shape and of u_r of its rim under every one, over the radius of that, 1/Pa; without what the plane does.
    products: DMatrix<f64>,
}

/// What elastic pins do on a plate.
pub struct Pins {
    /// Forces on the unknowns, N.
    pub forces: Vec<f64>,
    /// What they do, see [`Search::work`], J.
    pub work: f64,
    search: Search,
    /// Without forces of the pins, of every piece, m.
    moved: DVector<f64>,
    solved: Solved,
    /// ∫ of the finer shapes of every bore and of u_r that contact was found with.
    assumed: DVector<f64>,
}

impl<'a> PinColumns<'a> {
    /// Those of the elastic pins of a plate; `None` without such pins.
    /// Errors: a hole has too few nodes around it.
    pub fn new(specimen: &'a Specimen, plate: &'a Discretisation, factor: &'a Factor, unknowns: usize) -> Result<Option<Self>> {
        let bores = bores(specimen, plate)?;
        if bores.is_empty() {
            return Ok(None);
        }
        let count = |bore: &Bore<'_>| bore.shapes.at_places.ncols();
        let all: Vec<(&Bore<'_>, usize)> = bores.iter().flat_map(|bore| (0..count(bore)).map(move |k| (bore, k))).collect();
        let column = |&(bore, k): &(&Bore<'_>, usize)| {
            let mut column = vec![0.0; unknowns];
            let places = bore.shapes.at_places.column(k);
            let width = TAU / bore.rows.len() as f64;
            bore.rows.iter().zip(places.iter()).for_each(|(row, size)| push(&mut column, row, size * width * specimen.thickness));
            column
        };
        let mut columns: Vec<Vec<f64>> = all.par_iter().map(column).collect();
        columns.par_chunks_mut(TOGETHER).for_each(|columns| factor.forward_together(columns));
        let of = |i: usize| columns[..=i].iter().map(|other| dot(other, &columns[i]) / specimen.thickness).collect();
        let lower: Vec<Vec<f64>> = (0..columns.len()).into_par_iter().map(of).collect();
        let planes = bores.iter().map(|bore| bore.shapes.of_plane(&bore.shapes.spectrum, 1.0, plate.elasticity()));
        let products = DMatrix::from_fn(all.len(), all.len(), |i, j| lower[i.max(j)][i.min(j)]) - on_diagonal(planes);
        Ok(Some(PinColumns { plate, factor, thickness: specimen.thickness, bores, products }))
    }

    /// Brings pins into contact beside `others`, the forces of other loads, N, at a nominal load, Pa or N.
    /// Errors: [`perilife_base::error::Error::Mechanics`] where no contact is found.
    pub fn press(&self, others: &[f64], nominal: f64) -> Result<Pins> {
        let elasticity = self.plate.elasticity();
        let rim = |bore: &Bore<'_>| {
            let constants = elasticity.another(bore.pin.youngs_modulus, bore.pin.poisson_ratio);
            let sizes = [bore.hole.radius, self.thickness, bore.force * nominal];
            PinRim::new(bore.pin, constants, elasticity, sizes, &bore.shapes.mouths)
        };
        let rims: Vec<PinRim> = self.bores.iter().map(rim).collect();
        let mut u = others.to_vec();
        self.factor.solve(&mut u);
        let of_others = stacked(self.bores.iter().map(|bore| bore.shapes.parts(&bore.moved(&u))));
        let shapes = self.on_all(&rims, |bore| &bore.shapes);
        let compliance = (&shapes * &self.products * shapes.transpose()) / self.thickness;
        let moved = &shapes * &of_others;
        let search = Search::new(rims, compliance, elasticity);
        let solved = search.settle(&moved)?;
        let smooth = of_others + &self.products * shapes.tr_mul(&solved.force) * (search.scale[0] / self.thickness);
        let (mut forces, mut assumed, mut rest) = (vec![0.0; others.len()], Vec::new(), smooth.as_slice());
        for (index, pressed) in search.pressed(&solved).into_iter().enumerate() {
            let (bore, rim) = (&self.bores[index], &search.rims[index]);
            for &(own, pressure) in &pressed {
                push(&mut forces, &bore.row(self.plate, rim.angles[own])?, pressure * rim.area());
            }
            let pieces: Vec<(f64, f64)> = pressed.iter().map(|&(own, p)| (rim.angles[own], p * rim.width)).collect();
            let of_plane = bore.finer.plane_under(&pieces, rim.radius, elasticity);
            let (own, others) = rest.split_at(bore.shapes.at_places.ncols());
            rest = others;
            let own = &bore.shapes.at_places * DVector::from_column_slice(own);
            assumed.push(bore.finer.parts(&own) + of_plane);
        }
        Ok(Pins { forces, work: search.work(&solved), search, moved, solved, assumed: stacked(assumed.into_iter()) })
    }

    /// All shapes at all pieces; 0 at those of other rims.
    fn on_all(&self, rims: &[PinRim], shapes: for<'b> fn(&'b Bore<'a>) -> &'b Shapes) -> DMatrix<f64> {
        on_diagonal(self.bores.iter().zip(rims).map(|(bore, rim)| shapes(bore).at(&rim.angles)))
    }
}

impl Pins {
    /// Contact of every pin, with the index of its load and its residual in the plate whose unknowns are u, m.
    pub fn contacts(&self, columns: &PinColumns<'_>, u: &[f64]) -> Vec<(usize, Contact)> {
        let off = stacked(columns.bores.iter().map(|bore| bore.finer.parts(&bore.moved(u)))) - &self.assumed;
        let moved = &self.moved + columns.on_all(&self.search.rims, |bore| &bore.finer) * off;
        let shifted = self.search.settle(&moved).map(|other| self.search.shifted(&self.solved, &other));
        let contact = |(index, pressed): (usize, Vec<(usize, f64)>)| {
            let residual = shifted.as_ref().map_or(f64::INFINITY, |shares| shares[index]);
            (columns.bores[index].load, Contact { residual, ..self.search.contact(index, &pressed) })
        };
        self.search.pressed(&self.solved).into_iter().enumerate().map(contact).collect()
    }
}

/// Parts of all bores, one below the other.
fn stacked(parts: impl Iterator<Item = DVector<f64>>) -> DVector<f64> {
    DVector::from_vec(parts.flat_map(|part| part.data.as_vec().clone()).collect())
}
