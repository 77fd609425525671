//! Equilibrium of a plate of points under the largest load and the lower ones that are asked for, flanks in contact under each.

use super::PointPlate;
use super::contact::Contact;
use crate::case::Case;
use crate::cracks::CrackedPlate;
use crate::cracks::tip::CracksState;
use perilife_base::error::Result;
use perilife_plate::loading::residual::Components;
use perilife_plate::specimen::{CrackLine, Point};

/// Solves of an increment with changing contact, after which the last set is taken: near the end places may flicker.
const CONTACT_SOLVES_MOST: usize = 20;
/// Overlap of flanks, in spacings times the mean strain of the plate, that is round-off.
const CONTACT_LEAST: f64 = 1e-3;
/// What is said where the least displacement may open what the largest presses shut.
const REVERSED: &str = "contact: growth of crack faces that the minimum displacement opens is not computed (non-conservative); \
                        use model.method = \"element_free_galerkin\"";

/// A plate of points under a load below the largest.
pub(super) struct LowerLoad {
    /// Over the largest.
    pub load: f64,
    pub contact: Contact,
    /// In the layout of the equilibrium, m.
    pub displacement: Vec<f64>,
}

impl PointPlate {
    /// Equilibrium without overlap of the faces after bonds were cut; the displacement is unchanged where there is none.
    pub(super) fn settle(&mut self, case: &Case, cracks: &CracksState, lines: &[CrackLine]) -> Result<()> {
        let body = &self.body.clone();
        self.equilibrium.bonds_changed(body, &self.bonds, &std::mem::take(&mut self.changed));
        self.contact.follow(body, &self.blunted(cracks, lines), case.material.plane_modulus());
        let (mut contact, mut displacement) = (std::mem::take(&mut self.contact), self.displacement.clone());
        let settled = self.settle_at(case, 1.0, &mut contact, &mut displacement);
        self.contact = contact;
        settled?;
        self.displacement = displacement;
        self.lower.clear();
        let has_residual = case.loading.residual.is_some();
        let mut is_in_contact = self.is_in_contact();
        if is_in_contact && case.loading.displacement().is_some() {
            is_in_contact = false;
            if case.loading.ratio < 0.0 && !self.warnings.iter().any(|warning| warning == REVERSED) {
                self.warnings.push(REVERSED.to_owned());
            }
        }
        // Flanks alone are in contact as they are at every load of the same sign.
        let loads: Vec<f64> =
            self.lower_loads.iter().copied().filter(|load| has_residual || is_in_contact && *load < 0.0).collect();
        let work = self.work;
        for load in loads {
            let (mut contact, mut displacement) = (self.contact.clone(), self.displacement.clone());
            let settled = self.settle_at(case, load, &mut contact, &mut displacement);
            self.work = work;
            settled?;
            let is_free = !self.is_in_contact() && contact.closed_places().next().is_none();
            self.lower.push(LowerLoad { load, contact, displacement });
            if is_free || !has_residual {
                // In a straight line from there.
                break;
            }
        }
        Ok(())
    }

    /// Equilibrium under a share of the load, with flanks that do not overlap.
    fn settle_at(&mut self, case: &Case, share: f64, contact: &mut Contact, displacement: &mut Vec<f64>) -> Result<()> {
        let body = &self.body.clone();
        for solve in 1..=CONTACT_SOLVES_MOST {
            self.equilibrium.set_contact(body, share, &contact.springs(&|at| released(case, share, at), body.thickness));
            self.iterations += self.equilibrium.solve(body, &self.bonds, displacement)?;
            self.solves += 1;
            self.work = self.equilibrium.work();
            let least = CONTACT_LEAST * self.mean_strain(case) * body.lattice.spacing;
            if solve == CONTACT_SOLVES_MOST || !contact.update(&self.layout(), displacement, least) {
                break;
            }
        }
        Ok(())
    }

    /// Root mean square of the strain, of which the energy of the plate tells.
    fn mean_strain(&self, case: &Case) -> f64 {
        let volume = case.specimen.area() * case.specimen.thickness;
        (self.work / (volume * case.material.youngs_modulus)).max(0.0).sqrt()
    }
}

/// What the flanks release under a share of the maximum load, Pa: pressure, and residual stress.
pub(super) fn released(case: &Case, share: f64, at: Point) -> Components {
    let [xx, yy, xy] = case.loading.residual.as_ref().map_or([0.0; 3], |residual| residual.at(at));
    let pressure = share * case.specimen.crack_pressure * case.loading.maximum;
    [xx + pressure, yy + pressure, xy]
}
