//! Motion in time by velocity Verlet (Swope, Andersen, Berens and Wilson 1982; in the half-step form):
//!
//! ```text
//! v(n+1/2) = v(n) + Δt/2 a(n)      u(n+1) = u(n) + Δt v(n+1/2)
//! a(n+1) = (L(u(n+1)) + b) / ρ     v(n+1) = v(n+1/2) + Δt/2 a(n+1)
//! ```
//!
//! The step is stable below `2/ω`, ω² the largest eigenvalue of stiffness over mass, bounded point by point (Gershgorin).
//! Free rotations get the inertia at which they are exactly as fast as the displacements: they have no part in the motion
//! that is asked for, and shall not shorten the step.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::bonds::BondState;
use super::boundary::{Boundary, Held};
use super::checkpoint::{Course, of_another};
use super::interaction::{Damaging, Interaction, Memory};
use super::outcome::{HistoryRow, SceneEnd};
use super::scene::LoadRamp;
use perilife_base::error::{Result, input};
use perilife_plate::specimen::Point;
use perilife_points::net::Net;

/// Share of the stability bound that the program's own step takes. The energy of velocity Verlet wavers with the square of the
/// step: a plate torn in two (50 mm, spacing 1 mm, 8 m/s) has 0.27 to 0.34 % of the work astray for a moment, by law.
const SAFETY: f64 = 0.7;
/// Rows of the history at the most; with more steps every so many-th is kept.
const ROWS: usize = 4000;
/// Steps between two looks at the energy: a blow-up is found within 10.
const WATCH: usize = 5;
/// Energy from nowhere over the largest energy so far at which the motion counts as blown up.
const FROM_NOWHERE: f64 = 0.5;

/// State of the motion: displacement, velocity, force of the bonds; layout of [`Interaction`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Displacement, m.
    pub u: Vec<f64>,
    /// Velocity, m/s.
    pub v: Vec<f64>,
    /// Force of the bonds, N.
    pub force: Vec<f64>,
}

/// Where a run stands after a step: all that its next steps depend on beside bonds and interaction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    step: usize,
    motion: Motion,
    /// Work of loads and driven points so far but that of platens, J.
    work: f64,
    /// Energy taken by damage so far, J.
    fracture: f64,
    /// Largest energy so far, J.
    largest: f64,
}

/// Masses of all unknowns, kg: `ρ V` of the displacements; rotations as said above.
pub fn masses(net: &Net, density: f64, bound: &[[f64; 2]]) -> Vec<f64> {
    let translations = || net.volumes.iter().map(|volume| density * volume);
    let fastest = translations().zip(bound).map(|(mass, bound)| bound[0] / mass).fold(0.0, f64::max);
    let unknowns = net.unknowns;
    let of_point = |(mass, bound): (f64, &[f64; 2])| {
        let mut masses = [mass, mass, bound[1] / fastest];
        if bound[1] == 0.0 {
            masses[2] = mass;
        }
        masses.into_iter().take(unknowns)
    };
    translations().zip(bound).flat_map(of_point).collect()
}

/// Largest stable time step, s.
pub fn stable_step(net: &Net, density: f64, bound: &[[f64; 2]]) -> f64 {
    let fastest = net.volumes.iter().zip(bound).map(|(volume, bound)| bound[0] / (density * volume)).fold(0.0, f64::max);
    2.0 / fastest.sqrt()
}

/// The time step: the one asked for, or the program's own.
/// Errors: a step above the stable one.
pub fn time_step(asked: Option<f64>, stable: f64) -> Result<f64> {
    match asked {
        Some(step) if step > stable => {
            let problem = format!("is above the stable step of this body, {stable:.4e} s");
            Err(input("loading.time_step_s", step, problem, "use a smaller one, or remove it"))
        }
        Some(step) => Ok(step),
        None => Ok(SAFETY * stable),
    }
}

impl Standing {
    /// Whether it is that of so many unknowns.
    fn has(&self, unknowns: usize) -> bool {
        [&self.motion.u, &self.motion.v, &self.motion.force].iter().all(|values| values.len() == unknowns)
    }
}

/// How forces rise, and what they are at full size by unknowns, N.
type Push = (LoadRamp, Vec<(usize, f64)>);

/// A motion to be followed.
pub struct Simulation<'a> {
    /// Masses of all unknowns, kg.
    pub masses: &'a [f64],
    /// Time step, s.
    pub step: f64,
    pub steps: usize,
}

impl Simulation<'_> {
    /// Follows the motion from rest, or from where it is taken up; returns why it ended, the last state, and the evaluations of the
    /// forces.
    /// Errors: a run that was cancelled, a checkpoint of another one.
    pub fn follow(
        &self,
        interaction: &mut dyn Interaction,
        bonds: &mut BondState,
        course: &mut Course<'_>,
    ) -> Result<(SceneEnd, Motion, usize)> {
        let boundary = course.log.boundary;
        let unknowns = interaction.unknowns();
        let size = self.masses.len();
        let held: Vec<(usize, Held)> =
            boundary.held.iter().map(|held| (held.point as usize * unknowns + held.component, *held)).collect();
        let mut at = match course.take_up::<(Standing, Memory)>(bonds)? {
            None => self.start(interaction, bonds, &held),
            Some((at, memory)) if at.has(size) && interaction.restore(&memory, bonds) => at,
            Some(_) => return Err(of_another()),
        };
        let pushes = pushes(boundary, unknowns);
        let mut external = vec![0.0; size];
        push_at(&pushes, at.step as f64 * self.step, &mut external);
        let stride = self.steps.div_ceil(ROWS).max(1);
        let mut end = SceneEnd::Done;
        for step in at.step + 1..=self.steps {
            let Standing { motion, .. } = &mut at;
            let (before, time) = ((step - 1) as f64 * self.step, step as f64 * self.step);
            self.drift(motion, &external);
            let mut driven = 0.0;
            let moved: Vec<f64> = held
                .iter()
                .map(|(i, held)| {
                    let at = held.at(time).0;
                    let moved = at - held.at(before).0;
                    motion.u[*i] = at;
                    // Half of the work of the force that holds the point; the other half with the new force.
                    driven -= 0.5 * motion.force[*i] * moved;
                    moved
                })
                .collect();
            let pushed = self.pushed(&pushes, &motion.v, [before, time]);
            interaction.load_at(time);
            let reaction = interaction.internal_force(&motion.u, bonds, Damaging::Allowed, &mut motion.force);
            push_at(&pushes, time, &mut external);
            self.kick(motion, &external);
            for ((i, held), moved) in held.iter().zip(&moved) {
                let (was, is) = (held.at(before).1, held.at(time).1);
                motion.v[*i] = is;
                // What holds the point also brings its own mass into motion.
                driven += 0.5 * self.masses[*i] * (is * is - was * was) - 0.5 * motion.force[*i] * moved;
            }
            at.step = step;
            at.work += driven + pushed;
            let platens = interaction.driven();
            at.fracture += reaction.released;
            course.log.broke(step, reaction.broken);
            let look = step % WATCH == 0 || step % stride == 0 || step == self.steps;
            if look {
                let all_work = at.work + platens.map_or(0.0, |driven| driven.work);
                let of_points = || boundary.measured(unknowns, |group| group.rise.share(time), &at.motion.u, &at.motion.force);
                let (displacement, load) = platens.map_or_else(of_points, |driven| (driven.displacement, driven.load));
                let (kinetic, strain, fracture) = (self.kinetic(&at.motion.v), reaction.strain, at.fracture);
                let row =
                    HistoryRow { step, time, displacement, load, broken_bonds: 0, kinetic, strain, fracture, work: all_work };
                at.largest = at.largest.max(row.kinetic.max(row.strain).max(row.work.abs()));
                let nowhere = (row.kinetic + row.strain + row.fracture - row.work).abs();
                // A negated comparison, so that NaN counts as blown up.
                let is_still = at.largest == 0.0 && !nowhere.is_nan();
                if !(nowhere <= FROM_NOWHERE * at.largest + self.lag(&pushes, time) || is_still) {
                    end = SceneEnd::Unstable;
                    break;
                }
                if step % stride == 0 || step == self.steps {
                    course.log.row(row, &at.motion.u, bonds);
                    course.step_done(step as f64 / self.steps as f64)?;
                    course.may_keep(bonds, || (&at, interaction.memory()));
                }
            }
        }
        let evaluations = self.steps + 1;
        Ok((end, at.motion, evaluations))
    }

    /// At rest, but for what the loads drive.
    fn start(&self, interaction: &mut dyn Interaction, bonds: &mut BondState, held: &[(usize, Held)]) -> Standing {
        let size = self.masses.len();
        let mut motion = Motion { u: vec![0.0; size], v: vec![0.0; size], force: vec![0.0; size] };
        interaction.load_at(0.0);
        for (i, held) in held {
            motion.v[*i] = held.at(0.0).1;
        }
        let work = self.kinetic(&motion.v);
        interaction.internal_force(&motion.u, bonds, Damaging::Frozen, &mut motion.force);
        Standing { step: 0, motion, work, fracture: 0.0, largest: 0.0 }
    }

    /// First half: velocity to the half step, displacement to the new step.
    fn drift(&self, motion: &mut Motion, external: &[f64]) {
        let (step, half) = (self.step, 0.5 * self.step);
        let force = &motion.force;
        motion.u.par_iter_mut().with_min_len(LEAST).zip(&mut motion.v).enumerate().for_each(|(i, (u, v))| {
            *v += half * (force[i] + external[i]) / self.masses[i];
            *u += step * *v;
        });
    }

    /// Second half: velocity to the new step.
    fn kick(&self, motion: &mut Motion, external: &[f64]) {
        let half = 0.5 * self.step;
        let force = &motion.force;
        motion.v.par_iter_mut().with_min_len(LEAST).enumerate().for_each(|(i, v)| {
            *v += half * (force[i] + external[i]) / self.masses[i];
        });
    }

    /// Work of the given forces over a step with these half-step velocities, J.
    fn pushed(&self, pushes: &[Push], v: &[f64], [before, time]: [f64; 2]) -> f64 {
        let power = |(rise, forces): &Push| {
            let whole: f64 = forces.iter().map(|&(i, force)| force * v[i]).sum();
            0.5 * (rise.share(before) + rise.share(time)) * whole
        };
        self.step * pushes.iter().map(power).sum::<f64>()
    }

    /// Kinetic energy before its work, J: forces that come in from one step to the next have moved the points half a step ahead of
    /// what they have worked, `Δt²/8 Σ f²/m`. All there is in the first step of a load that rises from nothing.
    fn lag(&self, pushes: &[Push], time: f64) -> f64 {
        let of_push = |(rise, forces): &Push| {
            let squares: f64 = forces.iter().map(|&(i, force)| force * force / self.masses[i]).sum();
            rise.share(time).powi(2) * squares
        };
        // Twice, for points that two loads push, and for round-off.
        0.25 * self.step * self.step * pushes.iter().map(of_push).sum::<f64>()
    }

    fn kinetic(&self, v: &[f64]) -> f64 {
        let parts: Vec<f64> = v
            .par_chunks(LEAST)
            .zip(self.masses.par_chunks(LEAST))
            .map(|(v, m)| v.iter().zip(m).map(|(v, m)| 0.5 * m * v * v).sum())
            .collect();
        parts.iter().sum()
    }
}

/// Forces of the loads at full size by unknowns, N, with how they rise.
fn pushes(boundary: &Boundary, unknowns: usize) -> Vec<Push> {
    let by_unknown = |&(point, force): &(u32, Point)| {
        let at = point as usize * unknowns;
        [(at, force[0]), (at + 1, force[1])]
    };
    boundary.pushes.iter().map(|push| (push.rise, push.forces.iter().flat_map(by_unknown).collect())).collect()
}

/// Writes the forces of the loads at a time, s, into those on all unknowns, N.
fn push_at(pushes: &[Push], time: f64, external: &mut [f64]) {
    for (_, forces) in pushes {
        forces.iter().for_each(|&(i, _)| external[i] = 0.0);
    }
    for (rise, forces) in pushes {
        let share = rise.share(time);
        forces.iter().for_each(|&(i, force)| external[i] += share * force);
    }
}

/// Unknowns a task works through at the least.
const LEAST: usize = 8192;
