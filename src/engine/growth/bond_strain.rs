//! Cracks that go where bonds break, each bond spending its life by its own strain.
//!
//! Per cycle block: take the cyclic strain of the fatigue bonds, spend their lives until the next one breaks, break it, find the new
//! equilibrium, follow the tips. Cracks are first grown to their initial lengths (`precrack`); N = 0 is there.

mod overload;
mod growth_rate_control;
mod precrack;
mod stop;
mod history;

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::cross_check::CrossCheck;
use super::end_of_life::{End, first_end};
use super::record::{CurvePoint, StopReason};
use super::points::initial_factor;
use super::{CrackGrowth, Fields, GrowthStatus, SolverStatistics, State, plate};
use crate::body::{Body, Bond};
use crate::case::Case;
use crate::error::{Error, Result};
use crate::fatigue::ageing::{FatigueBond, candidates, fatigue_bonds, strain_share, threshold_strain};
use crate::fatigue::crack_tip::{CrackTip, share_out};
use crate::fatigue::growth_law::GrowthLaw;
use crate::fatigue::pieces::{Connectivity, remove_fragments};
use crate::fatigue::{FatigueLaw, FatigueSettings};
use crate::solver::{Equilibrium, Focus, SolverUsed};
use growth_rate_control::{GrowthRateControl, TipRateControl};
use history::{History, RunState};
use overload::{overstretched, stretched};
use precrack::Precrack;
use stop::{break_through, retire_tips};

/// Growth of the load's work by overload within one block, at constant load, from which the plate counts as severed: it has
/// lost half of its stiffness without a cycle, and what is left only gets softer.
const LOST_STIFFNESS: f64 = 2.0;
/// Share of a bond's whole life within which the next break is one of those before it.
const AT_ONCE: f64 = 1e-6;

/// What bonds are spent by.
pub struct BondRates {
    /// Their law.
    pub bonds: FatigueLaw,
    /// The rate of their tip over its K, where that sets how fast they are spent.
    pub over_k: Option<Box<dyn GrowthLaw>>,
}

/// [`CrackGrowth`] by fatigue bonds.
pub struct BondStrain<'a> {
    case: &'a Case,
    body: Arc<Body>,
    law: FatigueLaw,
    pace: Option<GrowthRateControl>,
    start: Precrack,
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
    pace: Option<Vec<TipRateControl>>,
    past: History,
    broken_bonds: usize,
    statistics: SolverStatistics,
}

impl BondStrainState {
    /// All bonds that are broken, those of the initial cracks among them, ascending.
    pub fn broken(&self) -> &[Bond] {
        &self.broken
    }
}

impl<'a> BondStrain<'a> {
    /// The plate with its cracks as they are cut, before its first equilibrium; the fatigue law is given the body's horizon, m.
    /// Errors: as [`Body::build`]; a crack too short to be grown, cracks that cut the plate in two, no fatigue law.
    pub fn start(case: &'a Case, rates: impl FnOnce(f64) -> Result<BondRates>) -> Result<Self> {
        let start = Precrack::of(case)?;
        let body = case.model.body(&start.specimen, &case.material)?;
        let BondRates { bonds: law, over_k } = rates(body.horizon())?;
        let share = strain_share(&case.loading, &case.fatigue);
        // A rate over K has its threshold in K.
        let threshold = match over_k {
            Some(_) => 0.0,
            None => share * threshold_strain(&case.fatigue, &case.material, body.horizon()) / case.loading.range_share(),
        };
        let pace = over_k.map(|over_k| GrowthRateControl::new(case, &start, &body, over_k));
        let mut run = RunState::start(case, &body, start.tips(&body));
        if precrack::cuts_in_two(&body, &run.bonds, case)
            || remove_fragments(&body, &mut run.bonds, &body.pre_cut) == Connectivity::Severed
        {
            return Err(Error::Mechanics(format!("{}: the initial cracks cut the plate in two", case.name)));
        }
        Ok(BondStrain {
            case,
            law,
            pace,
            start,
            end: first_end(case),
            range: (share, threshold),
            equilibrium: solver(case, &body, &run),
            run,
            displacement: Vec::new(),
            near: Vec::new(),
            watched: Vec::new(),
            is_closed: false,
            first: None,
            warnings: Vec::new(),
            body: Arc::new(body),
        })
    }

    /// The first equilibrium of the bonds as they stand.
    fn settle_first(&mut self) -> Result<()> {
        self.run.iterations += self.equilibrium.solve(&self.body, &self.run.bonds, &mut self.displacement)?;
        self.run.solves += 1;
        Ok(())
    }

    /// Lets cycles count where every crack has its initial length, and finds which bonds may age next and which others are watched.
    fn look_around(&mut self) {
        let (case, run) = (self.case, &mut self.run);
        let body = &self.body;
        let counting = self.start.is_over(&run.tips);
        if counting && run.track.begin() {
            run.tips.iter_mut().for_each(CrackTip::leave_fixed_line);
            self.pace.iter_mut().for_each(GrowthRateControl::begin);
        }
        self.near = if counting {
            candidates(body, &run.bonds, &run.tips, &case.fatigue)
        } else {
            candidates(body, &run.bonds, &self.start.on_the_way(&run.tips), &case.fatigue)
        };
        run.near_limit.retain(|&bond| run.bonds.is_intact(bond));
        self.watched = self.near.iter().chain(&run.near_limit).copied().collect();
    }

    /// The fatigue bonds, by the strains of the displacement at hand.
    fn ageing(&mut self) -> Vec<FatigueBond> {
        let (body, run) = (&self.body, &self.run);
        // Growth to the initial lengths is none of the load's: no threshold holds it up.
        let (share, threshold) = self.range;
        let threshold = if run.track.is_counting() { threshold } else { 0.0 };
        let mut ageing = fatigue_bonds(body, &self.near, &self.displacement, (share, threshold));
        if let Some(pace) = &mut self.pace {
            pace.set(body, &run.tips, &self.law, &mut ageing);
        }
        ageing
    }

    /// Breaks bonds, and finds the new equilibrium, until no bond is stretched beyond the critical stretch; all that broke, and
    /// why there is no equilibrium any more.
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
        let counting = self.start.is_over(&self.run.tips);

        // By how much strain a cycle bonds age.
        let run = &mut self.run;
        if counting {
            retire_tips(&mut run.tips, body, &case.specimen, &self.near, settings.zone_radius_horizons);
        }
        let focus = focus(&run.tips, body, settings);
        run.iterations += self.equilibrium.reach(body, &run.bonds, &self.watched, &focus, &mut self.displacement)?;
        run.had_window |= self.equilibrium.used() == SolverUsed::Window;
        let mut ageing = self.ageing();
        // Not while bonds break that would break together but for round-off: mirror twins would be seen at unequal lengths.
        let is_due = self.pace.as_ref().is_some_and(|pace| pace.is_due(body, &self.run.tips));
        if is_due && self.run.life.share_to_next_break(&self.law, &ageing) > AT_ONCE {
            let run = &mut self.run;
            run.iterations += self.equilibrium.complete(body, &run.bonds, &mut self.displacement)?;
            let records = self.start.records(&run.tips);
            if let Some(pace) = &mut self.pace {
                pace.read(body, &run.bonds, &self.displacement, &run.tips, &records);
            }
            ageing = self.ageing();
        }
        let run = &mut self.run;
        if let Some(reason) = stop::before_block(case, self.end, &run.track, &run.tips, &ageing) {
            return Ok(Some(reason));
        }

        // Spend life over the block; bonds at the end of theirs break.
        // A tip within a spacing of an edge or hole breaks through at once: the lattice cannot resolve what is left.
        let through = break_through(&mut run.tips, body, &run.bonds, &case.specimen);
        let (cycles, first) = if through.is_empty() { run.life.until_next_break(&self.law, &ageing) } else { (0.0, through) };
        if run.track.cycles_since_start() + cycles > case.stop.cycles_max {
            run.track.run_out(case.stop.cycles_max);
            return Ok(Some(StopReason::RunOut));
        }
        run.life.spend(&self.law, cycles, &ageing);
        run.track.spend(cycles);
        if let Some(pace) = &mut self.pace {
            pace.spend(body, &run.tips, &self.law, cycles, &ageing);
        }
        let (spent, reason) = self.break_bonds(first);

        // Follow the tips and record.
        let run = &mut self.run;
        run.broken_bonds += spent.len();
        let shares = share_out(body, &run.tips, &spent);
        let tips = run.tips.iter_mut().zip(&shares);
        tips.for_each(|(tip, broken)| tip.advance(body, &run.bonds, &case.specimen, broken));
        let work = if reason.is_none() { self.equilibrium.work() } else { f64::NAN };
        let records = self.start.records(&run.tips);
        if let Some(pace) = &mut self.pace {
            pace.follow(body, &run.tips, &records);
        }
        run.track.record(records, run.broken_bonds, work);
        let reason = reason.or_else(|| stop::after_block(case, self.end, &run.track));
        if reason.is_none() {
            self.look_around();
        }
        Ok(reason)
    }
}

impl CrackGrowth for BondStrain<'_> {
    fn open(&mut self) -> Result<()> {
        self.settle_first()?;
        self.run.track.open(self.start.records(&self.run.tips), self.equilibrium.work());
        self.look_around();
        Ok(())
    }

    fn now(&self) -> GrowthStatus<'_> {
        let track = &self.run.track;
        let row = track.last();
        GrowthStatus {
            cycles: track.cycles_since_start(),
            cycles_of_run: row.cycles,
            crack_length: row.crack_length,
            delta_k: f64::NAN,
            tips: row.tips(),
            is_counting: track.is_counting(),
        }
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
        tracing::debug!(solves = self.run.solves, "the solver begins anew from the bonds");
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

    fn state(&self) -> State {
        let run = &self.run;
        State::Bonds(BondStrainState {
            law: constants(&self.law),
            broken: run.bonds.broken(&self.body),
            life: run.life.begun(),
            tips: run.tips.clone(),
            near_limit: run.near_limit.clone(),
            pace: self.pace.as_ref().map(GrowthRateControl::state),
            past: run.track.past().clone(),
            broken_bonds: run.broken_bonds,
            statistics: self.statistics(),
        })
    }

    fn restore(&mut self, state: State) -> Result<bool> {
        let State::Bonds(state) = state else { return Ok(false) };
        let (body, run) = (self.body.clone(), &mut self.run);
        let places = body.multiplier.len();
        let mut named = state.near_limit.iter().chain(state.life.iter().map(|(bond, _)| bond)).chain(&state.broken);
        let known = named.all(|&bond| (bond as usize) < places);
        let tips = run.tips.len();
        if !(known && state.law == constants(&self.law) && state.tips.len() == tips && state.past.fits(tips)) {
            return Ok(false);
        }
        match (&mut self.pace, state.pace) {
            (None, None) => {}
            (Some(pace), Some(before)) => {
                if !pace.restore(before, state.past.is_counting()) {
                    return Ok(false);
                }
            }
            _ => return Ok(false),
        }
        state.broken.iter().for_each(|&bond| run.bonds.cut(&body, bond));
        state.life.iter().for_each(|&(bond, life)| run.life.set(bond, life));
        (run.tips, run.near_limit) = (state.tips, state.near_limit);
        run.track.go_on_from(state.past);
        (run.broken_bonds, run.solves, run.iterations) =
            (state.broken_bonds, state.statistics.solves, state.statistics.iterations);
        run.had_window = state.statistics.solver == Some(SolverUsed::Window);
        self.equilibrium = solver(self.case, &body, run);
        self.settle_first()?;
        self.look_around();
        Ok(true)
    }

    fn close(&mut self, stop: StopReason) -> Result<StopReason> {
        let (body, run) = (&self.body, &mut self.run);
        // Of a plate its sections are known afterwards, with its curve.
        let at_section = stop::at_section(self.case, &run.track.curve(self.case, body, self.end).0);
        self.end = [self.end, at_section].into_iter().flatten().min_by(|a, b| a.crack_length.total_cmp(&b.crack_length));
        let stop = stop::settled(self.end, &run.track, stop);
        if !matches!(stop, StopReason::Severed | StopReason::NoConvergence) {
            run.iterations += self.equilibrium.complete(body, &run.bonds, &mut self.displacement)?;
        }
        self.warnings.extend(run.track.warnings(self.case, body));
        self.is_closed = true;
        Ok(stop)
    }

    fn curve(&mut self) -> (Vec<CurvePoint>, f64) {
        let (curve, zero) = self.run.track.curve(self.case, &self.body, self.end);
        let range_share = self.case.loading.range_share();
        self.first = curve.first().map(|row| (row.delta_k / range_share, row.crack_length));
        (curve, zero)
    }

    fn cross_check(&self, _cycles: f64) -> Option<CrossCheck> {
        let (k_max, crack_length) = self.first.filter(|(k_max, _)| k_max.is_finite())?;
        let difference = k_max / initial_factor(self.case)? - 1.0;
        Some(CrossCheck { compared: 1, difference, crack_length })
    }

    fn statistics(&self) -> SolverStatistics {
        let RunState { solves, iterations, had_window, .. } = self.run;
        let solver = if had_window { SolverUsed::Window } else { self.equilibrium.used() };
        SolverStatistics { points_solved: self.equilibrium.points(&self.body), solves, iterations, solver: Some(solver) }
    }

    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }
}

/// Solver of the bonds as they stand, which knows nothing of what went before.
fn solver(case: &Case, body: &Body, run: &RunState) -> Equilibrium {
    Equilibrium::new(case.model.solver, case.model.symmetry, body, &run.bonds, case.loading.maximum)
}

/// Where the solver has to expect the next breaks.
fn focus(tips: &[CrackTip], body: &Body, settings: &FatigueSettings) -> Vec<Focus> {
    // Bonds of the zone, bridges of the wake, and a spacing in which the crack may turn.
    let reach = (settings.zone_radius_horizons + 0.5).max(1.0) * body.horizon() + body.lattice.spacing;
    let active = tips.iter().filter(|tip| tip.is_active());
    active.map(|tip| Focus { position: tip.position, direction: tip.direction, wake: tip.wake.clone(), reach }).collect()
}

fn constants(law: &FatigueLaw) -> [f64; 3] {
    [law.a, law.p, law.horizon]
}
