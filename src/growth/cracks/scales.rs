//! What differs between the engines in how their tips are driven: lengths and shares, each with its reason. All else of the driver is
//! the same for points and for nodes.
//!
//! Points have one resolution everywhere, the horizon δ, and what is read at a tip scatters with how the lattice lies: steps are counted
//! in horizons, directions are smoothed over some of them, and what is nearer than a spacing is not resolved. Nodes are placed anew for
//! every equilibrium, finer the less room a tip has: steps are shares of that room, two readings tell how a crack curves, and nothing is
//! nearer than they resolve.

use crate::case::Case;
use perilife_laws::STEP_ERROR_PERCENT;
use perilife_nodes::field::Discretisation;

const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Scales of an engine. Lengths in m.
#[derive(Debug, Clone, Copy)]
pub struct Scales {
    /// Whether rates and aims are continued in the root of the length of crack, as K of kinks and short cracks asks, or in the growth.
    pub by_root: bool,
    pub step: StepScales,
    pub steering: SteeringScales,
    pub meeting: MeetingScales,
    /// Growth after a kink over which the field does not show it, so that K is that of a short kink.
    pub kink_unresolved: f64,
    /// Growth over which energies are compared.
    pub energy_interval: f64,
    /// Increments after which a run can be resumed, the solver being built anew.
    pub rows_per_checkpoint: usize,
}

#[derive(Debug, Clone, Copy)]
pub struct StepScales {
    /// What the parabola may add to the cycles of an increment, as share.
    pub error: f64,
    /// Share of all cycles so far from which an increment counts with all of that.
    pub error_counts_from: f64,
    /// Growth in the first increment at the most, where nothing is known yet of how rates change.
    pub first: f64,
    /// The same over what is allowed then.
    pub first_share: f64,
    /// First step of a kink at the most, in spacings at the tip.
    pub first_of_kink: f64,
    pub bounds: [f64; 2],
    /// A step over the last one: at the least and at the most.
    pub change: [f64; 2],
    /// Share of crack and room that a tip goes at the most.
    pub share: f64,
    /// Share of the way to a tip that it faces.
    pub share_to_joint: f64,
    /// How near a rim or crack is ahead, or 45° aside, for K to change fast, and growth at the most there.
    pub near: [f64; 2],
    /// Growth at the most after a corner until readings show how the crack curves.
    pub turning: f64,
    /// Turn in an increment at the most, rad.
    pub turn: f64,
    /// Growth in an increment that may turn more.
    pub turn_unless: f64,
    /// Share of the cycles so far that the way to a rim or another tip takes at the most where it is gone in one step.
    pub share_left: f64,
    /// How far ahead a rim or tip may be that is reached in one step where cycles are few, and how near it is reached at once.
    pub last: [f64; 2],
    /// How near a rim is that is reached in one step though it lies aside.
    pub last_aside: f64,
    /// Slack of a tip by far slower than the fastest, at the most.
    pub slack_most: f64,
}

#[derive(Debug, Clone, Copy)]
pub struct SteeringScales {
    /// Growth, in steps, whose aims show where the crack is heading.
    pub memory_steps: f64,
    /// Bounds of that growth.
    pub memory: [f64; 2],
    /// Aims that show it at the most, and while they zigzag.
    pub aims: [usize; 2],
    /// Spread of growth below which the slope of the aims says nothing.
    pub slope: f64,
    /// Turn from which a crack has a corner, rad: nothing before it says where it heads after it.
    pub corner: f64,
    /// The same at the end of a crack as it was drawn.
    pub corner_at_start: f64,
    /// Growth after a corner over which the direction is held.
    pub held: f64,
    /// Growth after that until aims show how the crack curves.
    pub found: f64,
}

/// Scales of obstacles and joints.
#[derive(Debug, Clone, Copy)]
pub struct MeetingScales {
    /// How far beyond its end a step is continued to see what it meets.
    pub through: f64,
    /// The same over the length of the step.
    pub through_share: f64,
    /// Distance of a rim beside a tip from which nothing is left between them.
    pub beside: f64,
    /// Distance between a tip and the place where another meets its crack within which both are joined if they face each other.
    pub joined: f64,
    /// Cosine between a tip and the way to another from which they face each other.
    pub facing: f64,
    /// Gap between tips that face each other from which K is not read.
    pub unread: f64,
    /// Distance of a rim that a tip passes from which what is between them is not resolved, and what would resolve it, in that.
    pub passing: f64,
}

impl Scales {
    /// Scales on points: horizon and spacing, m.
    pub fn of_points(case: &Case, horizon: f64, spacing: f64) -> Self {
        let percent = case.fatigue.step_error_percent;
        // Steps get shorter where a smaller error is asked for than by default.
        let measure = (percent / STEP_ERROR_PERCENT).sqrt().min(1.0) * horizon;
        Scales {
            // Bonds do not show a kink before it is as long as the core of its tip; after that cycles in the root make short slant cracks live
            // 0.4 to 0.7 % shorter, which are too short already (`tests/verification/cracked_plate.rs`).
            by_root: false,
            step: StepScales {
                error: 0.01 * percent,
                error_counts_from: 0.0,
                first: 0.15 * measure,
                first_share: 1.0,
                // The bonds show a kink once it is as long as the core of a tip: no shorter step would tell more.
                first_of_kink: f64::INFINITY,
                // Lives and paths against steps of a tenth: `tests/verification/tip_field.rs`.
                bounds: [0.2 * measure, 1.5 * measure],
                change: [0.0, 1.6],
                share: f64::INFINITY,
                share_to_joint: f64::INFINITY,
                near: [3.0 * horizon, 0.2 * measure],
                turning: 0.4 * measure,
                // With 2° cycles half way of an edge crack that curves into a hole are -0.7 instead of -0.5 % off finite elements, its
                // path 0.13 instead of 0.10 mm.
                turn: DEGREE * measure / horizon,
                turn_unless: 0.2 * measure,
                share_left: 5e-4,
                // What is left of the plate there is nearly a mechanism, and says nothing about its life.
                last: [4.0 * horizon, 0.0],
                last_aside: 4.0 * horizon,
                slack_most: 1.0,
            },
            steering: SteeringScales {
                // Steps are short where a crack curves; a line through more than that would trail behind. Like all lengths here no multiple
                // of a step: on a limit round-off would tell mirror twins apart. Aims scatter within 0.83 δ with how the points lie.
                memory_steps: 5.3,
                memory: [0.83 * horizon, 2.1 * horizon],
                aims: [usize::MAX; 2],
                slope: 0.15 * horizon,
                // Less is the scatter of one reading.
                corner: 8.0 * DEGREE,
                corner_at_start: 8.0 * DEGREE,
                // The core of the tip has to leave the corner first.
                held: 1.15 * horizon,
                found: 1.0 * horizon,
            },
            meeting: MeetingScales {
                through: 0.75 * spacing,
                through_share: 0.0,
                beside: 0.5 * spacing,
                joined: 1.0 * horizon,
                facing: 0.94,
                // Against finite elements of three collinear cracks K is read within 1 % at 1.7 horizons, 3 % high at 1.4 to 1, and 25 %
                // low at 0.7.
                unread: 1.6 * horizon,
                passing: 1.0 * spacing,
            },
            kink_unresolved: 0.3 * horizon,
            // Within it the cut bonds stand for a length that is right to 2 %.
            energy_interval: 5.0 * horizon,
            // Building the solver anew takes as long as three to four increments.
            rows_per_checkpoint: 32,
        }
    }

    /// Scales on nodes: spacing far from everything, m.
    pub fn of_nodes(case: &Case, far: f64) -> Self {
        let share = case.nodes().step_share;
        Scales {
            // Half as many increments as in the growth, with the same errors.
            by_root: true,
            step: StepScales {
                // What the parabola leaves is a fraction of what it adds.
                error: 0.025 * case.fatigue.step_error_percent,
                error_counts_from: 0.1,
                first: f64::INFINITY,
                first_share: 0.1,
                // Four times that is 0.4 % of life more wrong on half of the plates with kinks, and 3 % on one.
                first_of_kink: 0.075,
                bounds: [1e-6 * far, f64::INFINITY],
                change: [0.5, 2.0],
                share,
                // K rises fast between tips that join, and both come.
                share_to_joint: 0.12,
                near: [0.0, f64::INFINITY],
                turning: f64::INFINITY,
                // Between two equilibria a path is straight.
                turn: 5.0 * DEGREE,
                turn_unless: 0.0,
                share_left: 2e-3,
                last: [4.0 * Discretisation::size(&case.specimen), 2e-3 * far],
                last_aside: 2e-3 * far,
                slack_most: 4.0,
            },
            steering: SteeringScales {
                memory_steps: 0.0,
                memory: [f64::INFINITY; 2],
                // Beside a large stress along the crack K_II scatters, and two readings follow that: 258 instead of 168 increments of a wing crack.
                // A line through three or four that do not all zigzag trails behind a crack that curves.
                aims: [2, 4],
                slope: 0.0,
                corner: 5.0 * DEGREE,
                // Nothing is known before: twice what K_II of a crack that goes straight on is wrong by.
                corner_at_start: 0.25 * DEGREE,
                held: 0.0,
                found: 0.0,
            },
            meeting: MeetingScales {
                through: 0.0,
                through_share: 1e-3,
                beside: 0.0,
                joined: 0.0,
                facing: 0.8,
                unread: 0.0,
                passing: 0.0,
            },
            kink_unresolved: 0.0,
            energy_interval: far,
            // Nothing is built anew.
            rows_per_checkpoint: 8,
        }
    }
}
