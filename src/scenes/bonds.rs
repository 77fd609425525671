//! What changes in the bonds of a scene: damage and the history it depends on. Written by the interaction alone.

use serde::{Deserialize, Serialize};

use perilife_points::net::Net;

/// State of every bond of a net.
#[derive(Debug, Clone, PartialEq)]
pub struct BondState {
    /// Share of its stiffness that a bond still has, 1 - D; 0 broken.
    pub share: Vec<f64>,
    /// Largest stretch so far, for laws with history.
    pub peak: Vec<f64>,
    /// Whether a bond may fail; not near loads and supports.
    pub may_fail: Vec<bool>,
}

/// What has changed in the bonds of a net.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KeptBonds {
    #[serde(with = "perilife_base::sealed::mostly_one")]
    share: Vec<f64>,
    #[serde(with = "perilife_base::sealed::mostly_zero")]
    peak: Vec<f64>,
}

impl BondState {
    /// Bonds of the plate with its cracks cut. Bonds with an end among the `no_fail` points never fail.
    pub fn new(net: &Net, no_fail: &[bool]) -> Self {
        let mut share = vec![1.0; net.bonds.len()];
        for &bond in &net.pre_cut {
            share[bond as usize] = 0.0;
        }
        let may_fail = net.bonds.iter().map(|bond| !no_fail[bond.from as usize] && !no_fail[bond.to as usize]).collect();
        BondState { peak: vec![0.0; share.len()], share, may_fail }
    }

    pub fn kept(&self) -> KeptBonds {
        KeptBonds { share: self.share.clone(), peak: self.peak.clone() }
    }

    /// Puts the bonds where they stood; whether they are those of this net.
    pub fn restore(&mut self, kept: KeptBonds) -> bool {
        let fits = [&kept.share, &kept.peak].iter().all(|values| values.len() == self.share.len());
        if fits {
            (self.share, self.peak) = (kept.share, kept.peak);
        }
        fits
    }

    /// Damage of every point ([`Net::damage`]), 0 to 1.
    pub fn damage(&self, net: &Net) -> Vec<f64> {
        net.damage(&self.share)
    }

    /// Bonds broken beside the cracks of the start.
    pub fn broken(&self, net: &Net) -> usize {
        self.share.iter().filter(|&&share| share == 0.0).count() - net.pre_cut.len()
    }
}
