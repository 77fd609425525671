//! A crack grown by fatigue, bond by bond.

use std::collections::HashSet;

use crate::body::pre_crack::bonds_across;
use crate::body::severed::severed_weight;
use crate::body::{Body, Bond};
use crate::case::Case;
use crate::error::{Error, Result};
use crate::growth::bond_strain::BondStrain;
use crate::growth::{CrackGrowth, State};
use crate::predict::laws::bond_rates;
use crate::predict::{CurvePoint, StopReason};
use crate::specimen::Point;
use crate::specimen::geometry::distance;

/// A finished run with the bonds that broke in it.
pub struct Grown {
    /// Why it ended.
    pub stop: StopReason,
    /// Its curve.
    pub curve: Vec<CurvePoint>,
    /// The plate with its initial cracks cut.
    pub body: Body,
    /// Bonds that broke beyond the initial cracks, ascending.
    pub broken: Vec<Bond>,
}

/// Grows the cracks of a case by fatigue bonds.
pub fn grow(case: &Case) -> Result<Grown> {
    let mut growth = BondStrain::start(case, |horizon| bond_rates(case, horizon))?;
    growth.open()?;
    let stop = loop {
        if let Some(stop) = growth.next_break()? {
            break growth.close(stop)?;
        }
    };
    let State::Bonds(state) = growth.state() else {
        return Err(Error::Mechanics(format!("{}: no fatigue bonds", case.name)));
    };
    let (specimen, model) = (&case.specimen, &case.model);
    let body = Body::build(specimen, &case.material, &model.bond_law, model.spacing, model.horizon_ratio, model.lattice_angle)?;
    // A run starts with shorter cracks and grows them to their length: that is no growth. Ascending, as the state has them.
    let broken = state.broken().iter().copied().filter(|bond| body.pre_cut.binary_search(bond).is_err()).collect();
    Ok(Grown { stop, curve: growth.curve().0, body, broken })
}

impl Grown {
    /// Centre of the broken bonds whose middle lies between two distances from a point, m, each weighted with the length of
    /// crack it stands for; NaN where none broke.
    pub fn centre_of_broken(&self, around: Point, distances: std::ops::Range<f64>) -> Point {
        let (mut sum, mut weights) = ([0.0; 2], 0.0);
        for &bond in &self.broken {
            let middle = self.body.middle(bond);
            if distances.contains(&distance(around, middle)) {
                let weight = severed_weight(&self.body, self.body.ends(bond).0);
                sum = [0, 1].map(|i| sum[i] + weight * middle[i]);
                weights += weight;
            }
        }
        sum.map(|s| s / weights)
    }

    /// Places of a tip, from its initial one on.
    pub fn path(&self, tip: usize) -> Vec<Point> {
        self.curve.iter().map(|point| point.tips[tip].position).collect()
    }

    /// Share of the bonds across the line between two points that still hold; 0 where there are none.
    pub fn intact_across(&self, a: Point, b: Point) -> f64 {
        let across = bonds_across(&self.body, a, b);
        let holds = |bond: &&Bond| self.broken.binary_search(bond).is_err() && self.body.pre_cut.binary_search(bond).is_err();
        across.iter().filter(holds).count() as f64 / across.len().max(1) as f64
    }

    /// Broken bonds over those that clean cuts along the paths of all tips sever.
    pub fn broken_over_cut(&self) -> f64 {
        let tips = self.curve.first().map_or(0, |point| point.tips.len());
        let severed: HashSet<Bond> = (0..tips)
            .flat_map(|tip| {
                let path = self.path(tip);
                let cut = path.windows(2).flat_map(|step| bonds_across(&self.body, step[0], step[1]));
                cut.collect::<Vec<_>>()
            })
            .filter(|bond| self.body.pre_cut.binary_search(bond).is_err())
            .collect();
        self.broken.len() as f64 / severed.len() as f64
    }
}
