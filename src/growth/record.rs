//! What a run takes down block by block, whatever drives its cracks.

use serde::{Deserialize, Serialize};

use crate::case::Case;
use perilife_laws::response::Response;
use perilife_plate::loading::Loading;
use perilife_plate::specimen::geometry::along;
use perilife_plate::specimen::{CrackLine, Point, Specimen, TipSeed};
use perilife_points::crack_tip::TipState;

perilife_base::kinds! {
    /// Why a run ended.
    pub enum StopReason for "stop_reason" {
        CrackLengthReached = "crack_length_reached": "crack length limit reached (stop.crack_length_mm)",
        CrackDepthReached = "crack_depth_reached": "crack depth limit reached (stop.crack_depth_mm)",
        BrokenThrough = "broken_through": "breakthrough; growth of the through crack is not computed",
        Toughness = "toughness": "fracture: K_max reached K_c",
        NetSectionYield = "net_section_yield": "net-section yield: the load reached the plastic collapse load",
        Severed = "severed": "complete separation, or the remaining ligament lost its stiffness",
        LeftPlate = "left_plate": "every crack tip reached an edge",
        EnteredHole = "entered_hole": "the crack ran into a hole; re-initiation is not computed",
        CracksJoined = "cracks_joined": "the cracks linked up; growth of the joined crack is not computed",
        LigamentUnresolved = "ligament_unresolved": "ligament smaller than the point spacing",
        NothingAges = "nothing_ages": "no crack grows under these loads: unlimited life",
        NoGrowth = "no_growth": "numerical stop: bonds broke without crack growth",
        RequiredStrength = "required_strength": "residual strength fell below the required strength (stop.required_strength_mpa or limit_load_factor)",
        RunOut = "run_out": "run-out: cycle limit reached (stop.cycles_max)",
        NoConvergence = "no_convergence": "the solver did not converge",
        Stopped = "stopped": "stopped by a user; the curve so far",
    }
}

impl StopReason {
    /// Whether the analysis ended before the life: growth beyond a hole, a link-up, a breakthrough or the cycle limit is not computed.
    pub fn is_lower_bound(self) -> bool {
        use StopReason::{BrokenThrough, CracksJoined, EnteredHole, LigamentUnresolved, RunOut, Stopped};
        matches!(self, BrokenThrough | EnteredHole | CracksJoined | LigamentUnresolved | RunOut | Stopped)
    }

    /// Whether the load reached a strength of the plate.
    pub fn is_strength(self) -> bool {
        matches!(self, StopReason::Toughness | StopReason::NetSectionYield | StopReason::RequiredStrength)
    }
}

/// What ends a step of a stage of a life other than its next row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Turn {
    /// The next stage takes over.
    HandOver,
    Stop(StopReason),
}

/// State of one tip at a recorded step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TipRecord {
    pub state: TipState,
    /// Position, m.
    pub position: Point,
    /// Growth since N = 0, m.
    pub growth: f64,
    /// K_I and K_II at maximum load, Pa√m; `None` where nobody reads them, as of a tip that has ended.
    pub factors: Option<[f64; 2]>,
    /// Stress along the crack T at maximum load, Pa; `None` where `factors` is.
    pub t_stress: Option<f64>,
    /// How K_eq follows the load.
    pub response: Response,
    /// Growth rate, m/cycle; `None` where `factors` is in runs by K.
    pub growth_rate: Option<f64>,
}

impl TipRecord {
    /// A tip with nothing read around it.
    pub fn unread(state: TipState, position: Point, growth: f64) -> Self {
        TipRecord { state, position, growth, factors: None, t_stress: None, response: Response::PROPORTIONAL, growth_rate: None }
    }

    /// A tip that has grown straight ahead.
    pub fn ahead(seed: &TipSeed, growth: f64) -> Self {
        let towards = [0, 1].map(|i| seed.position[i] + seed.direction[i]);
        TipRecord::unread(TipState::Active, along(seed.position, towards, growth), growth)
    }
}

/// The end in the thickness of the front of a crack that did not go through at the start, at a recorded step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct DepthRecord {
    /// Semi-axis a, m; where the crack is through, that at which it was.
    pub depth: f64,
    /// K_I there at maximum load, Pa√m; `None` once the crack is through.
    pub k_i: Option<f64>,
    /// Growth rate there, m/cycle; `None` once the crack is through.
    pub growth_rate: Option<f64>,
}

/// One cycle block of a finished run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CurvePoint {
    /// Whether an equilibrium (or a formula) was solved here; else the row lies between two that were.
    pub is_solved: bool,
    /// Cycles since N = 0.
    pub cycles: f64,
    /// Crack length in the specimen's convention, m.
    pub crack_length: f64,
    /// Range of the stress intensity factor, Pa√m (handbook where there is one, else from the energy release rate); NaN where unknown.
    pub delta_k: f64,
    /// Growth rate da/dN, m/cycle.
    pub growth_rate: f64,
    /// Work of the loads over the displacement at maximum load, f·u, J: twice the strain energy, the load squared times the
    /// compliance; NaN where the plate is severed and in hand calculation.
    pub work: f64,
    /// Plastic collapse load of the weakest section, Pa or N; `None` without yield strength or a section that carries it.
    pub limit_load: Option<f64>,
    /// Bonds broken since the start, initial cracks not counted.
    pub broken_bonds: usize,
    /// Tips, in the order of `Specimen::tips`.
    pub tips: Vec<TipRecord>,
    /// What a crack that did not go through at the start does in the thickness; `None` of through cracks.
    pub depth: Option<DepthRecord>,
    /// How K of the tip that leads follows the load.
    pub response: Response,
}

impl CurvePoint {
    /// A row of these tips, of which no K, rate, work or limit load is known.
    pub fn bare(cycles: f64, crack_length: f64, tips: Vec<TipRecord>) -> Self {
        CurvePoint {
            is_solved: true,
            cycles,
            crack_length,
            delta_k: f64::NAN,
            growth_rate: f64::NAN,
            work: f64::NAN,
            limit_load: None,
            broken_bonds: 0,
            tips,
            depth: None,
            response: Response::PROPORTIONAL,
        }
    }

    /// Whether it is of the front of a crack that does not go through.
    pub fn is_of_front(&self) -> bool {
        self.depth.is_some_and(|depth| depth.k_i.is_some())
    }

    /// The row of tips that are driven by their K; `lead` is K_eq, Pa√m, and da/dN, m/cycle, of the fastest, and `cracks` what the tips end.
    ///
    /// What the tips carry of K was read in the last equilibrium. Without one for this row (`work` is NaN), and of a tip that has ended
    /// with it, that is K of the row before, and not told again.
    pub fn of_tips(
        case: &Case,
        [cycles, work]: [f64; 2],
        broken_bonds: usize,
        (mut tips, cracks): (Vec<TipRecord>, &[CrackLine]),
        lead: Option<(f64, f64)>,
    ) -> CurvePoint {
        let is_read = |tip: &TipRecord| !work.is_nan() && matches!(tip.state, TipState::Active | TipState::Closed);
        let unread = tips.iter_mut().filter(|tip| !is_read(tip));
        unread.for_each(|tip| (tip.factors, tip.t_stress, tip.growth_rate) = (None, None, None));
        let lead = lead.filter(|_| !work.is_nan());
        let growths: Vec<f64> = tips.iter().map(|tip| tip.growth).collect();
        let (k_max, growth_rate) = lead.unwrap_or((f64::NAN, f64::NAN));
        let crack_length = case.specimen.crack_length_after(&growths);
        CurvePoint {
            limit_load: case.limit_load(crack_length, cracks),
            delta_k: case.loading.range_share() * k_max,
            growth_rate,
            work,
            broken_bonds,
            ..CurvePoint::bare(cycles, crack_length, tips)
        }
    }

    /// The row of a tip whose K follows the load so, with its largest K, Pa√m.
    pub fn with_response(self, k_max: f64, response: Response, loading: &Loading) -> CurvePoint {
        let row = CurvePoint { response, ..self };
        CurvePoint { delta_k: row.range_share(loading) * k_max, ..row }
    }

    /// Growth of all tips together, m.
    pub fn growth(&self) -> f64 {
        self.tips.iter().map(|tip| tip.growth).sum()
    }

    /// Share of K_max that counts as range, as [`Loading::range_share`], of the largest cycle.
    pub fn range_share(&self, loading: &Loading) -> f64 {
        self.response.range_share(loading.ratio)
    }

    /// K at maximum load that leads, Pa√m; NaN where unknown.
    pub fn k_max(&self, loading: &Loading) -> f64 {
        self.delta_k / self.range_share(loading)
    }

    /// That of cycles whose loads are larger by a factor.
    pub fn k_max_at(&self, load: f64, loading: &Loading) -> f64 {
        self.response.largest_at(load, loading.ratio) * self.k_max(loading)
    }

    /// Length of the crack that a tip ends, with the growth of all its tips, m; `None` of the end of a slot.
    pub fn crack_length_of(&self, specimen: &Specimen, tip: usize) -> Option<f64> {
        let line = specimen.line_end(tip)?.line;
        let is_of_line = |other: &usize| specimen.line_end(*other).is_some_and(|end| end.line == line);
        let growth: f64 = (0..self.tips.len()).filter(is_of_line).map(|other| self.tips[other].growth).sum();
        Some(specimen.crack_lines()[line].length() + growth)
    }

    /// The row at a share of the way from another to this one; bonds broken are those of this one.
    pub fn between(self, before: &CurvePoint, share: f64) -> CurvePoint {
        let mix = |a: f64, b: f64| a + share * (b - a);
        let tip = |(a, b): (&TipRecord, &TipRecord)| TipRecord {
            state: b.state,
            position: [0, 1].map(|i| mix(a.position[i], b.position[i])),
            growth: mix(a.growth, b.growth),
            factors: a.factors.zip(b.factors).map(|(a, b)| [0, 1].map(|i| mix(a[i], b[i]))),
            t_stress: a.t_stress.zip(b.t_stress).map(|(a, b)| mix(a, b)),
            response: a.response.between(&b.response, share),
            growth_rate: a.growth_rate.zip(b.growth_rate).map(|(a, b)| mix(a, b)),
        };
        CurvePoint {
            is_solved: false,
            cycles: mix(before.cycles, self.cycles),
            crack_length: mix(before.crack_length, self.crack_length),
            delta_k: mix(before.delta_k, self.delta_k),
            growth_rate: mix(before.growth_rate, self.growth_rate),
            work: mix(before.work, self.work),
            limit_load: before.limit_load.zip(self.limit_load).map(|(before, now)| mix(before, now)),
            broken_bonds: self.broken_bonds,
            tips: before.tips.iter().zip(&self.tips).map(tip).collect(),
            depth: self.depth,
            response: before.response.between(&self.response, share),
        }
    }
}
