//! THE MAIN PAGE: from a case to its a-N curve.
//!
//! Build the body; until there is a reason to stop: find equilibrium at maximum load, take the cyclic strain of the bonds
//! that age, choose the cycle block, spend bond life, break spent bonds, follow the crack tips. Command, service and
//! calibration all come through here.

mod curve;
mod end_of_life;
mod handbook;
pub mod memory;
mod outcome;
mod overload;
pub mod plastic_zone;
pub mod plate;
pub mod residual_strength;
mod snapshot;
mod start;
mod stop;
mod tip_end;

use std::time::Instant;

pub use outcome::{CurvePoint, Observer, Prediction, Progress, RunFigures, Silent, Snapshot, StopReason, TipRecord};

pub use crate::net::PointGrid;

use crate::body::{Body, Bond};
use crate::case::{Case, Method};
use crate::error::{Error, Result};
use crate::fatigue::ageing::{AgeingBond, ageing_bonds, candidates, strain_share, threshold_strain};
use crate::fatigue::block_control::{Around, BlockControl};
use crate::fatigue::crack_tip::{CrackTip, share_out};
use crate::fatigue::pieces::{Cut, set_aside};
use crate::fatigue::remaining_life::BondLife;
use crate::fatigue::{Block, FatigueLaw, FatigueSettings};
use crate::solver::Focus;
use crate::state::Bonds;
use curve::Track;
use end_of_life::first_end;
use overload::{are_within, overstretched, stretched};
use plate::Plate;
use snapshot::Album;
use start::Start;
use tip_end::{break_through, retire_tips};

/// Predicts the a-N curve of a case.
///
/// # Errors
/// Wrong input that shows only now (spacing against plate, no fatigue law), or mechanics that fail before there is a curve.
pub fn predict(case: &Case, observer: &dyn Observer) -> Result<Prediction> {
    match case.model.method {
        Method::Peridynamics => run(case, |horizon| case.fatigue_law(horizon), &mut Unrecorded, observer),
        Method::Handbook => handbook::run(case, observer),
    }
}

/// Takes down what a run does, block by block, so that it can be replayed.
pub trait Recorder {
    /// The plate with its initial cracks, before its first equilibrium.
    fn start(&mut self, _body: &Body, _bonds: &Bonds) {}
    /// One block: the strains its bonds aged by, the bonds it spent, and the crack length after it, m. Blocks before N = 0,
    /// in which the crack grows to its initial length, come first.
    fn block(&mut self, ageing: &[AgeingBond], spent: &[Bond], crack_length: f64);
}

/// Takes down nothing.
struct Unrecorded;

impl Recorder for Unrecorded {
    fn block(&mut self, _: &[AgeingBond], _: &[Bond], _: f64) {}
}

/// [`predict`] with any fatigue law (given the body's horizon) and a recorder.
///
/// # Errors
/// As [`predict`].
pub fn run(
    case: &Case,
    law: impl FnOnce(f64) -> Result<FatigueLaw>,
    recorder: &mut dyn Recorder,
    observer: &dyn Observer,
) -> Result<Prediction> {
    let started = Instant::now();
    // Whatever a run measures in spacings and horizons, it measures in those that its body has.
    let mut case = case.clone();
    case.model.spacing = case.model.fitting_spacing(&case.specimen);
    let case = &case;
    let (settings, model) = (&case.fatigue, &case.model);

    let start = Start::of(case)?;
    let specimen = &start.specimen;
    let plate = Plate::build(specimen, &case.specimen, &case.material, model)?;
    let body = &plate.body;
    let law = law(body.horizon())?;
    let share = strain_share(&case.loading, settings);
    let threshold = share * threshold_strain(settings, &case.material, body.horizon()) / case.loading.range_share();

    let mut bonds = Bonds::new(body);
    let mut life = BondLife::whole(bonds.multiplier.len());
    let mut tips = start.tips(body);
    let mut displacement = Vec::new();
    if start::cuts_in_two(body, &bonds, case) || set_aside(body, &mut bonds, &body.pre_cut) == Cut::Severed {
        return Err(Error::Mechanics(format!("{}: the initial cracks cut the plate in two", case.name)));
    }
    recorder.start(body, &bonds);
    let mut equilibrium = plate.equilibrium(model, &bonds, case.loading.maximum);
    let mut control = BlockControl::new(&settings.block, law.p, tips.len());
    if control.foresees() {
        equilibrium = equilibrium.foreseeing();
    }
    let mut iterations = equilibrium.solve(body, &bonds, &mut displacement)?;
    let mut solves = 1;

    let mut track = Track::new(case, start.records(&tips), equilibrium.work());
    let end = first_end(case);
    let mut album = Album::default();
    let mut broken_bonds = 0;
    let mut warnings = plate.warnings();
    // Bonds that come near the critical stretch, also away from the tips.
    let mut near_limit: Vec<Bond> = Vec::new();
    let stop = loop {
        // Cycles count from where every crack has its initial length.
        let counting = start.is_over(&tips);
        if counting && track.begin() {
            tips.iter_mut().for_each(CrackTip::leave_rails);
            let (picture, more) = equilibrium.picture(body, &bonds)?;
            iterations += more;
            album.open(&plate, &bonds, &picture, track.last());
        }

        // Which bonds age, and by how much strain a cycle.
        let near = if counting {
            candidates(body, &bonds, &tips, settings)
        } else {
            candidates(body, &bonds, &start.on_the_way(&tips), settings)
        };
        if counting {
            retire_tips(&mut tips, body, &case.specimen, &near, settings.zone_radius_horizons);
        }
        near_limit.retain(|&bond| bonds.is_intact(bond));
        let watched: Vec<Bond> = near.iter().chain(&near_limit).copied().collect();
        iterations += equilibrium.reach(body, &bonds, &watched, &focus(&tips, body, settings), &mut displacement)?;
        let mut ageing = ageing_bonds(body, &near, &displacement, &tips, settings, (share, threshold));
        control.correct(&equilibrium, body, &tips, &mut ageing);
        if let Some(reason) = stop::before_block(case, end, &track, &tips, &ageing) {
            break reason;
        }
        if let Some(tip) = stop::at_rim(body, &tips, settings) {
            warnings.push(plate.left_refinement(tip, settings.zone_radius_horizons));
            break StopReason::LeftRefinement;
        }

        // Spend life over the block; bonds at the end of theirs break.
        // A tip within a spacing of an edge or hole breaks through at once: the lattice cannot resolve what is left.
        let through = break_through(&mut tips, body, &bonds, &case.specimen);
        let block = if counting { &settings.block } else { &Block::NEXT_BREAK };
        let (cycles, mut spent) = if through.is_empty() { life.next_block(&law, block, &ageing) } else { (0.0, through) };
        if track.cycles_since_start() + cycles > case.stop.cycles_max {
            track.run_out(case.stop.cycles_max);
            break StopReason::RunOut;
        }
        life.spend(&law, cycles, &ageing);
        track.spend(cycles);

        // Break, and find the new equilibrium, until no bond is stretched beyond the critical stretch.
        let work_before = equilibrium.work();
        let mut newly = spent.clone();
        let mut overloaded = false;
        let outcome = loop {
            newly.iter().for_each(|&bond| bonds.cut(body, bond));
            let aside = match set_aside(body, &mut bonds, &newly) {
                Cut::Severed => break Some(StopReason::Severed),
                Cut::Whole(aside) => aside,
            };
            newly.extend(aside);
            equilibrium.broke(body, &bonds, &newly);
            let may_foresee = counting && !overloaded && are_within(equilibrium.window(), body, &near_limit);
            let around = Around { body, bonds: &bonds, tips: &tips, watched: &near };
            match control.settle(&mut equilibrium, around, &newly, may_foresee, &mut displacement) {
                Ok(None) => {}
                Ok(Some(more)) => (solves, iterations) = (solves + 1, iterations + more),
                // What is left after bonds broke by overload cannot carry the load: the plate is as good as in two.
                Err(_) if overloaded => break Some(StopReason::Severed),
                Err(_) => break Some(StopReason::NoConvergence),
            }
            newly = overstretched(body, &bonds, case, &displacement, &equilibrium);
            if equilibrium.is_whole() {
                near_limit = stretched(body, &bonds, case, &displacement, equilibrium.window());
            }
            overloaded |= !newly.is_empty();
            if overloaded && equilibrium.work() > GIVEN_WAY * work_before {
                break Some(StopReason::Severed);
            }
            spent.extend(&newly);
            if newly.is_empty() {
                break None;
            }
        };

        // Follow the tips and record.
        broken_bonds += spent.len();
        let shares = share_out(body, &tips, &spent);
        tips.iter_mut().zip(&shares).for_each(|(tip, broken)| tip.advance(body, &bonds, &case.specimen, broken));
        let work = if outcome.is_none() { equilibrium.work() } else { f64::NAN };
        track.record(start.records(&tips), broken_bonds, work, equilibrium.is_foreseen() && outcome.is_none());
        recorder.block(&ageing, &spent, track.last().crack_length);
        if counting && album.is_due(track.last()) && outcome.is_none() && !equilibrium.is_foreseen() {
            let (picture, more) = equilibrium.picture(body, &bonds)?;
            iterations += more;
            album.look(&plate, &bonds, &picture, track.last());
        }
        let going_on = observer.block_done(&track.progress(case));
        if let Some(reason) = outcome.or_else(|| stop::after_block(case, end, &track)) {
            break reason;
        }
        if !going_on {
            return Err(Error::Mechanics(format!("{}: the run was cancelled", case.name)));
        }
    };

    let stop = stop::settled(end, &track, stop);
    if !matches!(stop, StopReason::Severed | StopReason::NoConvergence) {
        iterations += equilibrium.complete(body, &bonds, &mut displacement)?;
        track.close(equilibrium.work());
    }
    album.finish(&plate, &bonds, &displacement, track.last());
    warnings.extend(track.warnings(case, body));
    let (curve, zero) = track.into_curve(case, body, end);
    album.count_from(zero, &curve);
    warnings.extend(plastic_zone::warnings(case, &curve));
    // Those since N = 0, one row each.
    let blocks = curve.len() - 1;
    Ok(Prediction {
        curve,
        stop,
        snapshots: album.snapshots,
        grid: plate.grid(),
        figures: RunFigures {
            points: plate.points(),
            points_solved: equilibrium.points(body),
            bonds: plate.bonds(),
            blocks,
            solves,
            iterations,
            spacing: body.lattice.spacing,
            horizon: body.horizon(),
            wall_s: started.elapsed().as_secs_f64(),
            memory_mb: memory::peak_mb(),
        },
        warnings,
    })
}

/// Where the solver has to expect the next breaks.
fn focus(tips: &[CrackTip], body: &Body, settings: &FatigueSettings) -> Vec<Focus> {
    // Bonds of the zone, bridges of the wake, and a spacing in which the crack may turn.
    let reach = (settings.zone_radius_horizons + 0.5).max(1.0) * body.horizon() + body.lattice.spacing;
    let active = tips.iter().filter(|tip| tip.is_active());
    active.map(|tip| Focus { position: tip.position, direction: tip.direction, wake: tip.wake.clone(), reach }).collect()
}

/// Growth of the load's work by overload within one block, at constant load, from which the plate counts as severed: it has
/// lost half of its stiffness without a cycle, and what is left only gets softer.
const GIVEN_WAY: f64 = 2.0;
