//! THE MAIN PAGE: from a case to its a-N curve.
//!
//! Build the plate; until there is a reason to stop: find equilibrium at maximum load, let what drives the cracks act over a block
//! of cycles, cut the bonds that this takes. What drives them is K of their tips (`by_tips`, the default), or bonds that age by their
//! own strain (here: take the cyclic strain of the bonds that age, choose the cycle block, spend bond life, break spent bonds, follow
//! the crack tips), or K of a handbook, without any plate (`handbook`). Command, service and calibration all come through here.

pub mod bond_rate;
mod by_tips;
pub mod checkpoint;
mod course;
mod curve;
mod end_of_life;
pub mod factor_curve;
mod handbook;
pub mod laws;
pub mod memory;
mod outcome;
mod overload;
pub mod plastic_zone;
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
use crate::fatigue::block_control::Around;
use crate::fatigue::crack_tip::{CrackTip, share_out};
use crate::fatigue::pieces::{Cut, set_aside};
use crate::fatigue::{Block, FatigueLaw, FatigueSettings};
use crate::growth::plate::Plate;
use crate::solver::Focus;
use crate::state::Bonds;
use checkpoint::Checkpoint;
use course::Course;
use end_of_life::first_end;
use overload::{are_within, overstretched, stretched};
use start::Start;
use tip_end::{break_through, retire_tips};

/// Predicts the a-N curve of a case.
///
/// # Errors
/// Wrong input that shows only now (spacing against plate, no fatigue law), or mechanics that fail before there is a curve.
pub fn predict(case: &Case, observer: &dyn Observer) -> Result<Prediction> {
    match case.model.method {
        Method::Peridynamics if case.is_driven_by_tips() => by_tips::run(case, None, &*laws::growth_law(case)?, observer),
        Method::Peridynamics => run(case, |horizon| laws::bond_law(case, horizon), &mut Unrecorded, observer),
        Method::Handbook => handbook::run(case, observer),
    }
}

/// Goes on with a run of a case from a checkpoint of it; gives what [`predict`] gives, bit for bit, its wall time counted from the
/// start of the first run.
///
/// # Errors
/// As [`predict`]; [`Error::Input`] if the checkpoint is not one of this case.
pub fn resume(case: &Case, checkpoint: Checkpoint, observer: &dyn Observer) -> Result<Prediction> {
    checkpoint.check(case)?;
    if case.is_driven_by_tips() {
        return by_tips::run(case, Some(checkpoint), &*laws::growth_law(case)?, observer);
    }
    run_from(Some(checkpoint), case, |horizon| laws::bond_law(case, horizon), &mut Unrecorded, observer)
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
    run_from(None, case, law, recorder, observer)
}

/// The run of a case from its start, or from where an earlier one stood.
fn run_from(
    checkpoint: Option<Checkpoint>,
    case: &Case,
    law: impl FnOnce(f64) -> Result<FatigueLaw>,
    recorder: &mut dyn Recorder,
    observer: &dyn Observer,
) -> Result<Prediction> {
    let started = Instant::now();
    let hash = checkpoint::hash(case);
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

    let mut run = Course::start(case, body, start.tips(body), law.p);
    if start::cuts_in_two(body, &run.bonds, case) || set_aside(body, &mut run.bonds, &body.pre_cut) == Cut::Severed {
        return Err(Error::Mechanics(format!("{}: the initial cracks cut the plate in two", case.name)));
    }
    let earlier_s = checkpoint.map_or(Ok(0.0), |checkpoint| checkpoint.restore(&law, body, &mut run))?;
    recorder.start(body, &run.bonds);
    // From the bonds alone.
    let solver = |run: &Course| {
        let equilibrium = plate.equilibrium(model, &run.bonds, case.loading.maximum);
        if run.control.foresees() { equilibrium.foreseeing() } else { equilibrium }
    };
    let mut equilibrium = solver(&run);
    let mut displacement = Vec::new();
    run.iterations += equilibrium.solve(body, &run.bonds, &mut displacement)?;
    run.solves += 1;

    run.track.open(start.records(&run.tips), equilibrium.work());
    let end = first_end(case);
    let mut warnings = plate.warnings();
    let stop = loop {
        // Cycles count from where every crack has its initial length.
        let counting = start.is_over(&run.tips);
        if counting && run.track.begin() {
            run.tips.iter_mut().for_each(CrackTip::leave_rails);
            let (picture, more) = equilibrium.picture(body, &run.bonds)?;
            run.iterations += more;
            run.album.open(&plate, &run.bonds, &picture, run.track.last());
            run.album.show(&plate, observer);
        }

        // Which bonds may age, and which others are watched.
        let near = if counting {
            candidates(body, &run.bonds, &run.tips, settings)
        } else {
            candidates(body, &run.bonds, &start.on_the_way(&run.tips), settings)
        };
        run.near_limit.retain(|&bond| run.bonds.is_intact(bond));
        let watched: Vec<Bond> = near.iter().chain(&run.near_limit).copied().collect();

        // Where the solver has to work on the whole plate anyway, it begins anew from the bonds: nothing of what went before is
        // left but `run`, and a run taken up here goes on as this one does.
        if equilibrium.is_due(body, &watched) {
            tracing::debug!(solves = run.solves, "the solver begins anew from the bonds");
            let elapsed_s = earlier_s + started.elapsed().as_secs_f64();
            observer.may_keep(&|| Checkpoint::of(hash, &law, body, &run, &run.track.progress(case), elapsed_s));
            drop(equilibrium);
            equilibrium = solver(&run);
            let before = std::mem::take(&mut displacement);
            match equilibrium.solve(body, &run.bonds, &mut displacement) {
                Ok(more) => (run.solves, run.iterations) = (run.solves + 1, run.iterations + more),
                Err(_) => {
                    displacement = before;
                    break StopReason::NoConvergence;
                }
            }
        }

        // By how much strain a cycle they age.
        if counting {
            retire_tips(&mut run.tips, body, &case.specimen, &near, settings.zone_radius_horizons);
        }
        let focus = focus(&run.tips, body, settings);
        run.iterations += equilibrium.reach(body, &run.bonds, &watched, &focus, &mut displacement)?;
        let mut ageing = ageing_bonds(body, &near, &displacement, &run.tips, settings, (share, threshold));
        run.control.correct(&equilibrium, body, &run.tips, &mut ageing);
        if let Some(reason) = stop::before_block(case, end, &run.track, &run.tips, &ageing) {
            break reason;
        }
        if let Some(tip) = stop::at_rim(body, &run.tips, settings) {
            warnings.push(plate.left_refinement(tip, settings.zone_radius_horizons));
            break StopReason::LeftRefinement;
        }

        // Spend life over the block; bonds at the end of theirs break.
        // A tip within a spacing of an edge or hole breaks through at once: the lattice cannot resolve what is left.
        let through = break_through(&mut run.tips, body, &run.bonds, &case.specimen);
        let block = if counting { &settings.block } else { &Block::NEXT_BREAK };
        let (cycles, mut spent) = if through.is_empty() { run.life.next_block(&law, block, &ageing) } else { (0.0, through) };
        if run.track.cycles_since_start() + cycles > case.stop.cycles_max {
            run.track.run_out(case.stop.cycles_max);
            break StopReason::RunOut;
        }
        run.life.spend(&law, cycles, &ageing);
        run.track.spend(cycles);

        // Break, and find the new equilibrium, until no bond is stretched beyond the critical stretch.
        let work_before = equilibrium.work();
        let mut newly = spent.clone();
        let mut overloaded = false;
        let outcome = loop {
            newly.iter().for_each(|&bond| run.bonds.cut(body, bond));
            let aside = match set_aside(body, &mut run.bonds, &newly) {
                Cut::Severed => break Some(StopReason::Severed),
                Cut::Whole(aside) => aside,
            };
            newly.extend(aside);
            equilibrium.broke(body, &run.bonds, &newly);
            let may_foresee = counting && !overloaded && are_within(equilibrium.window(), body, &run.near_limit);
            let around = Around { body, bonds: &run.bonds, tips: &run.tips, watched: &near };
            match run.control.settle(&mut equilibrium, around, &newly, may_foresee, &mut displacement) {
                Ok(None) => {}
                Ok(Some(more)) => (run.solves, run.iterations) = (run.solves + 1, run.iterations + more),
                // What is left after bonds broke by overload cannot carry the load: the plate is as good as in two.
                Err(_) if overloaded => break Some(StopReason::Severed),
                Err(_) => break Some(StopReason::NoConvergence),
            }
            newly = overstretched(body, &run.bonds, case, &displacement, &equilibrium);
            if equilibrium.is_whole() {
                run.near_limit = stretched(body, &run.bonds, case, &displacement, equilibrium.window());
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
        run.broken_bonds += spent.len();
        let shares = share_out(body, &run.tips, &spent);
        let tips = run.tips.iter_mut().zip(&shares);
        tips.for_each(|(tip, broken)| tip.advance(body, &run.bonds, &case.specimen, broken));
        let work = if outcome.is_none() { equilibrium.work() } else { f64::NAN };
        let is_open = equilibrium.is_foreseen() && outcome.is_none();
        run.track.record(start.records(&run.tips), run.broken_bonds, work, is_open);
        recorder.block(&ageing, &spent, run.track.last().crack_length);
        if counting && run.album.is_due(run.track.last()) && outcome.is_none() && !equilibrium.is_foreseen() {
            let (picture, more) = equilibrium.picture(body, &run.bonds)?;
            run.iterations += more;
            run.album.look(&plate, &run.bonds, &picture, run.track.last());
            run.album.show(&plate, observer);
        }
        if counting {
            observer.grown(run.track.last().tips());
        }
        let going_on = observer.block_done(&run.track.progress(case));
        if let Some(reason) = outcome.or_else(|| stop::after_block(case, end, &run.track)) {
            break reason;
        }
        if !going_on {
            return Err(Error::Mechanics(format!("{}: the run was cancelled", case.name)));
        }
    };

    let Course { bonds, mut track, mut album, solves, mut iterations, .. } = run;
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
            wall_s: earlier_s + started.elapsed().as_secs_f64(),
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
