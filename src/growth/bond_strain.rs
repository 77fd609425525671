//! Cracks that go where bonds break, each bond spending its life by its own strain: dλ/dN = -A ε^p.
//!
//! Per cycle block: take the cyclic strain of the fatigue bonds, spend their lives until the next one breaks, break it, find the new
//! equilibrium, follow the tips. At N = 0 cracks and slots are clean cuts, and all bonds have their whole lives. A crack that began at a
//! slot goes on by the K of its tips ([`hand_over`]).

mod history;
pub mod hand_over;
mod overload;
mod stop;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::cross_check::CrossCheck;
use super::end_of_life::{End, first_end};
use super::points::initial_factor;
use super::record::{CurvePoint, StopReason, TipRecord};
use super::{CrackGrowth, Fields, SolverStatistics, plate};
use crate::ageing::{candidates, fatigue_bonds, strain_share, threshold_strain};
use crate::case::Case;
use history::{History, RunState};
use overload::{overstretched, stretched};
use perilife_base::error::{Error, Result};
use perilife_laws::curve::Shape;
use perilife_laws::{FatigueLaw, FatigueSettings};
use perilife_plate::specimen::handbook::{HandbookFormula, handbook};
use perilife_points::body::{Body, Bond};
use perilife_points::crack_tip::{CrackTip, share_out};
use perilife_points::pieces::{Connectivity, remove_fragments};
use perilife_points::solver::{Equilibrium, Focus, SolverUsed};
use stop::{break_through, retire_tips};

/// Rise of the load's work by overload within an increment at which the plate counts as severed: half its stiffness is lost.
const LOST_STIFFNESS: f64 = 2.0;
/// Lead of the broken bonds of a steady front over the sharp cut of the same compliance, in spacings: bonds still bridging
/// behind the tip hold the crack closed more than broken ones ahead open it. The length of a crack is the one its compliance
/// shows (`tests/verification/crack_length.rs`: 0.18 to 0.23 for p from 2 to 4).
const FRONT_OFFSET_SPACINGS: f64 = 0.2;

/// [`CrackGrowth`] by fatigue bonds.
pub struct BondStrain<'a> {
    case: &'a Case,
    body: Arc<Body>,
    law: FatigueLaw,
    /// What the rates that A and p were fitted to are beside them, and K of the specimen.
    shape: Option<(Shape, HandbookFormula)>,
    end: Option<End>,
    /// Strain of a cycle over that at maximum load, and the range of strain below which nothing ages.
    range: (f64, f64),
    run: RunState,
    equilibrium: Equilibrium,
    displacement: Vec<f64>,
    /// Bonds that may age in the next block.
    near: Vec<Bond>,
    /// These and others whose displacement has to be right after every break.
    watched: Vec<Bond>,
    is_closed: bool,
    /// K at maximum load, Pa√m, and crack length, m, of the first row.
    first: Option<(f64, f64)>,
    /// What the user should know that came up on the way.
    warnings: Vec<String>,
}

/// All that the next blocks depend on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BondStrainState {
    /// A, p and horizon of the fatigue law.
    law: [f64; 3],
    broken: Vec<Bond>,
    /// Lives that are not whole any more.
    life: Vec<(Bond, f64)>,
    tips: Vec<CrackTip>,
    near_limit: Vec<Bond>,
    past: History,
    broken_bonds: usize,
    statistics: SolverStatistics,
}

impl<'a> BondStrain<'a> {
    /// The plate with its cracks as they are cut, before its first equilibrium; the fatigue law is given the body's horizon, m.
    /// Errors: as [`Body::build`]; cracks that cut the plate in two, no fatigue law.
    pub fn start(case: &'a Case, law: impl FnOnce(f64) -> Result<FatigueLaw>) -> Result<Self> {
        let body = case.points().body(&case.specimen, &case.material)?;
        let law = law(body.horizon())?;
        let share = strain_share(&case.loading, &case.fatigue);
        let threshold = share * threshold_strain(&case.fatigue, &case.material, body.horizon()) / case.loading.range_share();
        let tips = case.specimen.tips.iter().map(|seed| CrackTip::at(seed, &body)).collect();
        let mut run = RunState::start(case, &body, tips);
        if remove_fragments(&body, &mut run.bonds, &body.pre_cut) == Connectivity::Severed {
            return Err(Error::Mechanics(format!("{}: the initial cracks cut the plate in two", case.name)));
        }
        let (shape, formula) = (case.shape()?, handbook(&case.specimen));
        let words = "bonds: bonds spend their lives by A and p, the best power law: the curve of the fitted rates needs K of the tip, and no \
                     formula has it here; fatigue.driver = \"tip_field\" goes by the curve";
        let is_without = shape.is_some() && formula.is_none();
        Ok(BondStrain {
            case,
            law,
            shape: shape.zip(formula),
            end: first_end(case),
            range: (share, threshold),
            equilibrium: solver(case, &body, &run),
            run,
            displacement: Vec::new(),
            near: Vec::new(),
            watched: Vec::new(),
            is_closed: false,
            first: None,
            warnings: is_without.then(|| words.to_owned()).into_iter().collect(),
            body: Arc::new(body),
        })
    }

    /// The first equilibrium of the bonds as they stand.
    fn settle_first(&mut self) -> Result<()> {
        self.run.iterations += self.equilibrium.solve(&self.body, &self.run.bonds, &mut self.displacement)?;
        self.run.solves += 1;
        Ok(())
    }

    /// Finds which bonds may age next and which others are watched.
    fn look_around(&mut self) {
        let run = &mut self.run;
        self.near = candidates(&self.body, &run.bonds, &run.tips, &self.case.fatigue);
        run.near_limit.retain(|&bond| run.bonds.is_intact(bond));
        self.watched = self.near.iter().chain(&run.near_limit).copied().collect();
    }

    /// Every tip with its growth, at the end of the sharp crack of the same compliance.
    fn records(&self) -> Vec<TipRecord> {
        let lead = FRONT_OFFSET_SPACINGS * self.body.lattice.spacing;
        let record = |tip: &CrackTip| {
            let lead = lead * (tip.growth / self.body.horizon()).min(1.0);
            let position = [0, 1].map(|i| tip.position[i] - lead * tip.direction[i]);
            TipRecord::unread(tip.state, position, tip.growth - lead)
        };
        self.run.tips.iter().map(record).collect()
    }

    /// Breaks bonds and solves until none exceeds the critical stretch; all that broke, and why there is no equilibrium.
    fn break_bonds(&mut self, first: Vec<Bond>) -> (Vec<Bond>, Option<StopReason>) {
        let body = &self.body.clone();
        let (case, run, equilibrium) = (self.case, &mut self.run, &mut self.equilibrium);
        let work_before = equilibrium.work();
        let mut spent = first.clone();
        let mut newly = first;
        let mut overloaded = false;
        loop {
            newly.iter().for_each(|&bond| run.bonds.cut(body, bond));
            let aside = match remove_fragments(body, &mut run.bonds, &newly) {
                Connectivity::Severed => return (spent, Some(StopReason::Severed)),
                Connectivity::Connected(aside) => aside,
            };
            newly.extend(aside);
            equilibrium.bonds_changed(body, &run.bonds, &newly);
            match equilibrium.solve(body, &run.bonds, &mut self.displacement) {
                Ok(more) => (run.solves, run.iterations) = (run.solves + 1, run.iterations + more),
                // What is left after bonds broke by overload cannot carry the load: the plate is as good as in two.
                Err(error) if overloaded || matches!(error, Error::LossOfStiffness) => return (spent, Some(StopReason::Severed)),
                Err(_) => return (spent, Some(StopReason::NoConvergence)),
            }
            newly = overstretched(body, &run.bonds, case, &self.displacement, equilibrium);
            if equilibrium.is_whole() {
                run.near_limit = stretched(body, &run.bonds, case, &self.displacement, equilibrium.window());
            }
            overloaded |= !newly.is_empty();
            if overloaded && equilibrium.work() > LOST_STIFFNESS * work_before {
                return (spent, Some(StopReason::Severed));
            }
            spent.extend(&newly);
            if newly.is_empty() {
                return (spent, None);
            }
        }
    }

    /// One cycle block, until the next break, which makes one row; the reason why there is no next one. A block that finds that reason
    /// before anything happens makes no row.
    /// Errors: no equilibrium before the block.
    pub fn next_break(&mut self) -> Result<Option<StopReason>> {
        let body = &self.body.clone();
        let (case, settings) = (self.case, &self.case.fatigue);

        // By how much strain a cycle bonds age.
        let run = &mut self.run;
        retire_tips(&mut run.tips, body, &case.specimen, &self.near, settings.zone_radius_horizons);
        let focus = focus(&run.tips, body, settings);
        run.iterations += self.equilibrium.reach(body, &run.bonds, (&self.watched, &focus), &mut self.displacement)?;
        run.had_window |= self.equilibrium.used() == SolverUsed::Window;
        let ageing = fatigue_bonds(body, &self.near, &self.displacement, self.range);
        if let Some(reason) = stop::before_block(case, self.end, &run.track, &run.tips, &ageing) {
            return Ok(Some(reason));
        }

        // Spend life over the block; bonds at the end of theirs break.
        // A tip within a spacing of an edge or hole breaks through at once: the lattice cannot resolve what is left.
        let through = break_through(&mut run.tips, body, &run.bonds, &case.specimen);
        let law = shaped(&self.law, self.shape.as_ref(), case, run.track.last().crack_length);
        let (cycles, first) = if through.is_empty() { run.life.until_next_break(&law, &ageing) } else { (0.0, through) };
        if run.track.cycles() + cycles > case.stop.cycles_max {
            run.track.run_out(case.stop.cycles_max);
            return Ok(Some(StopReason::RunOut));
        }
        run.life.spend(&law, cycles, &ageing);
        run.track.spend(cycles);
        let (spent, reason) = self.break_bonds(first);

        // Follow the tips and record.
        let run = &mut self.run;
        run.broken_bonds += spent.len();
        let shares = share_out(body, &run.tips, &spent);
        let tips = run.tips.iter_mut().zip(&shares);
        tips.for_each(|(tip, broken)| tip.advance(body, &run.bonds, &case.specimen, broken));
        let work = if reason.is_none() { self.equilibrium.work() } else { f64::NAN };
        let records = self.records();
        let run = &mut self.run;
        run.track.record(records, run.broken_bonds, work);
        // The length averaged over a spacing of growth is known up to a known end once the run is a spacing further; the curve stops there.
        let (last, spacing) = (run.track.last(), case.points().spacing);
        let is_past = |end: &End| end.length_of(&case.specimen, last) >= end.crack_length + spacing;
        let reason = reason.or_else(|| self.end.filter(is_past).map(|end| end.reason));
        if reason.is_none() {
            self.look_around();
        }
        Ok(reason)
    }

    /// All that the next blocks depend on.
    pub fn state(&self) -> BondStrainState {
        let run = &self.run;
        BondStrainState {
            law: constants(&self.law),
            broken: run.bonds.broken(&self.body),
            life: run.life.begun(),
            tips: run.tips.clone(),
            near_limit: run.near_limit.clone(),
            past: run.track.past.clone(),
            broken_bonds: run.broken_bonds,
            statistics: self.statistics(),
        }
    }

    /// Goes on from a state, in place of the first row; whether it is one of this plate and law.
    /// Errors: no equilibrium.
    pub fn restore(&mut self, state: BondStrainState) -> Result<bool> {
        let (body, run) = (self.body.clone(), &mut self.run);
        let places = body.multiplier.len();
        let mut named = state.near_limit.iter().chain(state.life.iter().map(|(bond, _)| bond)).chain(&state.broken);
        let known = named.all(|&bond| (bond as usize) < places);
        let tips = run.tips.len();
        if !(known && state.law == constants(&self.law) && state.tips.len() == tips && state.past.fits(tips)) {
            return Ok(false);
        }
        state.broken.iter().for_each(|&bond| run.bonds.cut(&body, bond));
        state.life.iter().for_each(|&(bond, life)| run.life.set(bond, life));
        (run.tips, run.near_limit) = (state.tips, state.near_limit);
        run.track.past = state.past;
        (run.broken_bonds, run.solves, run.iterations) =
            (state.broken_bonds, state.statistics.solves, state.statistics.iterations);
        run.had_window = state.statistics.solver == Some(SolverUsed::Window);
        self.equilibrium = solver(self.case, &body, run);
        self.settle_first()?;
        self.look_around();
        Ok(true)
    }
}

impl CrackGrowth for BondStrain<'_> {
    fn open(&mut self) -> Result<()> {
        self.settle_first()?;
        let records = self.records();
        self.run.track.record(records, 0, self.equilibrium.work());
        self.look_around();
        Ok(())
    }

    fn now(&self) -> &CurvePoint {
        self.run.track.last()
    }

    fn body(&self) -> Option<Arc<Body>> {
        Some(self.body.clone())
    }

    fn fields(&mut self) -> Result<Option<Fields>> {
        let (body, bonds) = (&self.body, &self.run.bonds);
        if self.is_closed {
            return Ok(Some(plate::fields(body, bonds, &self.displacement, &self.run.life.begun())));
        }
        let (picture, more) = self.equilibrium.picture(body, bonds)?;
        self.run.iterations += more;
        Ok(Some(plate::fields(&self.body, &self.run.bonds, &picture, &self.run.life.begun())))
    }

    /// Where the solver has to work on the whole plate anyway.
    fn should_rebuild_solver(&self) -> bool {
        self.equilibrium.should_rebuild(&self.body, &self.watched)
    }

    fn rebuild_solver(&mut self) -> Result<()> {
        tracing::debug!(solves = self.run.solves, "the solver restarts from the bonds");
        let (body, run) = (&self.body, &mut self.run);
        self.equilibrium = solver(self.case, body, run);
        let before = std::mem::take(&mut self.displacement);
        match self.equilibrium.solve(body, &run.bonds, &mut self.displacement) {
            Ok(more) => (run.solves, run.iterations) = (run.solves + 1, run.iterations + more),
            Err(error) => {
                self.displacement = before;
                return Err(error);
            }
        }
        Ok(())
    }

    fn close(&mut self, stop: StopReason) -> Result<StopReason> {
        let (body, run) = (&self.body, &mut self.run);
        // Of a plate its sections are known afterwards, with its curve.
        let at_section = stop::at_section(self.case, &run.track.curve(self.case, body, self.end));
        self.end = [self.end, at_section].into_iter().flatten().min_by(|a, b| a.crack_length.total_cmp(&b.crack_length));
        let stop = stop::settled(self.end, (&run.track, &self.case.specimen), stop);
        if !matches!(stop, StopReason::Severed | StopReason::NoConvergence) {
            run.iterations += self.equilibrium.complete(body, &run.bonds, &mut self.displacement)?;
        }
        self.warnings.extend(run.track.warnings(self.case, body));
        self.is_closed = true;
        Ok(stop)
    }

    fn curve(&mut self) -> Vec<CurvePoint> {
        let curve = self.run.track.curve(self.case, &self.body, self.end);
        let range_share = self.case.loading.range_share();
        self.first = curve.first().map(|row| (row.delta_k / range_share, row.crack_length));
        curve
    }

    fn cross_check(&self, _cycles: f64) -> Option<CrossCheck> {
        let (k_max, crack_length) = self.first.filter(|(k_max, _)| k_max.is_finite())?;
        let difference = k_max / initial_factor(self.case)? - 1.0;
        Some(CrossCheck { compared: 1, difference, crack_length })
    }

    fn statistics(&self) -> SolverStatistics {
        let RunState { solves, iterations, had_window, .. } = self.run;
        let solver = if had_window { SolverUsed::Window } else { self.equilibrium.used() };
        SolverStatistics {
            points_solved: self.equilibrium.points(&self.body),
            solves,
            iterations,
            refined: [0; 2],
            step_error: 0.0,
            solver: Some(solver),
        }
    }

    fn warnings(&self) -> Vec<String> {
        self.warnings.iter().cloned().chain(self.why_no_tips()).collect()
    }
}

/// Solver of the bonds as they stand, which knows nothing of what went before.
fn solver(case: &Case, body: &Body, run: &RunState) -> Equilibrium {
    Equilibrium::new(case.points().solver, case.points().symmetry, body, &run.bonds, case.loading.maximum)
}

/// Where the solver has to expect the next breaks.
fn focus(tips: &[CrackTip], body: &Body, settings: &FatigueSettings) -> Vec<Focus> {
    // Bonds of the zone, bridges of the wake, and a spacing in which the crack may turn.
    let reach = (settings.zone_radius_horizons + 0.5).max(1.0) * body.horizon() + body.lattice.spacing;
    let active = tips.iter().filter(|tip| tip.is_active());
    active.map(|tip| Focus { position: tip.position, direction: tip.direction, wake: tip.wake.clone(), reach }).collect()
}

/// The law at a crack length, m: A times the rate of the fitted curve over that of its power law at the K of the formula there.
fn shaped(law: &FatigueLaw, shape: Option<&(Shape, HandbookFormula)>, case: &Case, length: f64) -> FatigueLaw {
    let factor = shape.map_or(1.0, |(shape, formula)| {
        let k_max = formula.k_i(length, case.loading.maximum);
        let factor = shape.factor(k_max, case.loading.ratio, case.fatigue.walker_gamma);
        if factor.is_finite() { factor } else { 1.0 }
    });
    FatigueLaw { a: law.a * factor, ..*law }
}

fn constants(law: &FatigueLaw) -> [f64; 3] {
    [law.a, law.p, law.horizon]
}
