//! Both ends of a front through the cycles of a spectrum in their order, each with the plastic zone of its own last overload.
//!
//! The end that grows most, by length, is marched through the loads ([`March`]) over half a hundredth of its axis, and the other one over the same
//! cycles. K of each end between the start and the end of such a step is a power of e over its way (second order); where the other axis ends up is
//! taken from the step before and corrected until it holds. Zones are those of plane strain at an end inside the material, and those of the plane state
//! of the plate at a face.

use super::fronts::{Fronts, Grown};
use perilife_laws::growth_law::GrowthLaw;
use perilife_laws::retardation::{Laws, March, Marched, Retardation, Underway, between};
use perilife_plate::loading::spectrum::Spectrum;
use perilife_plate::material::Plane;

/// Growth of the leading axis in a step, over the axis.
const STEP: f64 = 0.005;
/// Least step: where K is infinite a shorter one ahead, the width ends.
const STEP_LEAST: f64 = 2e-6;
/// Corrections of the other axis in a step, and its change, over the axis, that needs no other.
const CORRECTIONS: usize = 4;
const SETTLED: f64 = 1e-3 * STEP;

/// What the order of the cycles of a spectrum needs.
pub struct Order {
    pub law: Box<dyn GrowthLaw>,
    pub model: Retardation,
}

/// The loads and the zones of a front.
pub(super) struct Overloads<'a> {
    spectrum: &'a Spectrum,
    order: Order,
    /// The model at the ends of a and c.
    models: [Retardation; 2],
    /// Where both ends stand after the last step, that at the face last.
    pub at: [Underway; 2],
    /// Which end leads, and what the other axis grew over it in the last step, each over its axis.
    lead: usize,
    share: f64,
}

struct Stepped {
    to: Grown,
    at: [Underway; 2],
    share: f64,
    /// Whether no later pass of the loads grows the leading end.
    is_arrested: bool,
}

impl<'a> Overloads<'a> {
    /// A front before its first cycle.
    pub fn start(fronts: &Fronts<'a>, spectrum: &'a Spectrum, order: Order) -> Self {
        let of_end = |inside: bool| {
            let plane = if inside { Plane::Strain } else { order.model.plane };
            Retardation { plane, ..order.model.clone() }
        };
        let models = fronts.flaw.ends_inside().map(of_end);
        let (axes, rates) = (fronts.flaw.start(), fronts.rates(fronts.flaw.start()));
        let [of_a, of_c] = [0, 1].map(|end| rates[end] / axes[end]);
        let (lead, share) = if of_a >= of_c { (0, of_c / of_a) } else { (1, of_a / of_c) };
        let share = if share.is_finite() { share } else { 1.0 };
        Overloads { spectrum, order, models, at: [Underway::start(spectrum); 2], lead, share }
    }

    /// The place after the next step, and its length; `None` where nothing grows or K is infinite.
    pub fn next(&mut self, fronts: &Fronts<'_>, from: Grown) -> Option<(Grown, f64)> {
        let mut step = STEP;
        let mut has_changed = false;
        loop {
            match self.stepped(fronts, from, step) {
                Some(stepped) if stepped.is_arrested && has_changed => return None,
                Some(stepped) if stepped.is_arrested => {
                    (self.lead, self.share, has_changed) = (1 - self.lead, 0.0, true);
                }
                Some(stepped) => return Some((stepped.to, step)),
                None if step <= STEP_LEAST => return None,
                None => step = (0.25 * step).max(STEP_LEAST),
            }
        }
    }

    /// The place after a step of this length.
    pub fn after(&self, fronts: &Fronts<'_>, from: Grown, step: f64) -> Grown {
        self.stepped(fronts, from, step).map_or(from, |stepped| stepped.to)
    }

    pub fn take(&mut self, fronts: &Fronts<'_>, from: Grown, step: f64) {
        if let Some(Stepped { at, share, .. }) = self.stepped(fronts, from, step) {
            (self.at, self.share) = (at, share);
            if share > 1.0 {
                (self.lead, self.share) = (1 - self.lead, 1.0 / share);
            }
        }
    }

    /// `None` where K at the end of the step is none.
    fn stepped(&self, fronts: &Fronts<'_>, from: Grown, step: f64) -> Option<Stepped> {
        let (lead, other) = (self.lead, 1 - self.lead);
        let start = fronts.flaw.start();
        let here = fronts.factors(from.axes);
        let cycles_max = fronts.case.stop.cycles_max;
        let mut share = self.share;
        let mut correction = 0;
        loop {
            let mut ahead = from.axes;
            ahead[lead] *= 1.0 + step;
            ahead[other] *= 1.0 + share * step;
            let there = fronts.factors(ahead);
            if !here.iter().chain(&there).all(|factor| factor.is_finite() && *factor > 0.0) {
                return None;
            }
            let k = |end: usize| between([here[end], there[end]], [from.axes[end] - start[end], ahead[end] - start[end]]);
            let (mut first, mut second) = (self.march(fronts, lead), self.march(fronts, other));
            let is_arrested = first.advance(&k(lead), ahead[lead] - start[lead], cycles_max) == Marched::Arrested;
            if second.advance(&k(other), f64::INFINITY, first.at.cycles) == Marched::Arrested {
                second.at.wait_for(&first.at);
            }
            let mut at = self.at;
            (at[lead], at[other]) = (first.at, second.at);
            let axes = [0, 1].map(|end| start[end] + at[end].a);
            let grown = |end: usize| axes[end] / from.axes[end] - 1.0;
            let found = if grown(lead) > 0.0 { grown(other) / grown(lead) } else { share };
            let is_settled = ((found - share) * step).abs() < SETTLED;
            correction += 1;
            if is_settled || correction == CORRECTIONS || is_arrested {
                let to = Grown { axes, cycles: first.at.cycles };
                return Some(Stepped { to, at, share: found, is_arrested });
            }
            share = found;
        }
    }

    fn march<'b>(&'b self, fronts: &'b Fronts<'_>, end: usize) -> March<'b> {
        let Order { law, .. } = &self.order;
        let laws = Laws { law: &**law, mean: &*fronts.law, retardation: Some(&self.models[end]) };
        let mut march = March::new(laws, self.spectrum, self.at[end]);
        march.start = fronts.flaw.start()[end];
        march
    }
}
