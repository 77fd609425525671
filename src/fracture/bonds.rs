//! What changes in the bonds of a scene: damage and the history it depends on. Written by the interaction alone.

use super::net::Net;

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

impl BondState {
    /// Bonds of the plate with its cracks cut. Bonds with an end among the `no_fail` points never fail.
    #[must_use]
    pub fn new(net: &Net, no_fail: &[bool]) -> Self {
        let mut share = vec![1.0; net.bonds.len()];
        for &bond in &net.pre_cut {
            share[bond as usize] = 0.0;
        }
        let may_fail = net.bonds.iter().map(|bond| !no_fail[bond.from as usize] && !no_fail[bond.to as usize]).collect();
        BondState { peak: vec![0.0; share.len()], share, may_fail }
    }

    /// Damage φ = 1 - Σ μ V' / Σ V' of every point over its bonds (Silling and Askari 2005), 0 to 1. With a dual horizon
    /// only the bonds of the point's own horizon count.
    #[must_use]
    pub fn damage(&self, net: &Net) -> Vec<f64> {
        let of_point = |i: usize| {
            let (mut whole, mut intact) = (0.0, 0.0);
            for (b, other) in net.family_of(i) {
                whole += net.volumes[other];
                intact += if self.share[b] > 0.0 { net.volumes[other] } else { 0.0 };
            }
            if whole > 0.0 { 1.0 - intact / whole } else { 1.0 }
        };
        (0..net.len()).map(of_point).collect()
    }

    /// Bonds broken beside the cracks of the start.
    #[must_use]
    pub fn broken(&self, net: &Net) -> usize {
        self.share.iter().filter(|&&share| share == 0.0).count() - net.pre_cut.len()
    }
}
