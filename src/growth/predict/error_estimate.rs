//! How wrong a life may be: rates of a run against those by K on finer nodes at the same cracks.
//!
//! A life is `N = ∫ da / r(K)`, so that an error of K at the crack of a row, `δ = ln[r(K of finer nodes) / r(K of the run)]`, makes it wrong
//! by `δN = -∫ δ dN`. That is evaluated at some rows, their shares of the cycles as weights: of a run on nodes by one equilibrium each, on nodes
//! 1.5 times finer near tips and rims; beside one on points, nodes refine themselves at the first row and are as fine at the others. What two rungs
//! share, K of the finer ones and the lengths of steps, is added. So is the error of the path: the angles by which directions differ, over its growth.

use super::Prediction;
use super::laws::growth_law;
use super::moment::{Moment, SHOWN_AT, grown, rows_before_meeting};
use super::part_through::PartThroughLife;
use crate::case::{Case, Engine, Model, finer_nodes};
use crate::cracks::steering::{equivalent_factor, kink_angle};
use crate::cracks::{CrackedPlate, InitialTips, initial_tips_on};
use crate::nodes::NodePlate;
use crate::record::{CurvePoint, StopReason, TipRecord};
use perilife_base::parallel::in_pool;
use perilife_base::units::MM;
use perilife_laws::growth_law::GrowthLaw;
use perilife_nodes::resolution::ElementFreeSettings;
use perilife_plate::specimen::handbook::handbook;
use perilife_plate::specimen::part_through::STATED_ERROR;
use perilife_points::crack_tip::TipState;
use rayon::prelude::*;

/// Shares of the cycles at which K is solved for on finer nodes, of a run on nodes. With 0, 0.4 and 0.8 a bound of 1.0 % between two holes is 1.3 %.
const SHARES_OF_NODES: [f64; 2] = [0.3, 0.8];
/// Of a run on points: more change the bound little.
const SHARES_OF_POINTS: [f64; 3] = [0.0, 0.4, 0.8];
/// Factor on the differences of a run on points and on those by loads: between these rows they may be larger.
const BETWEEN: f64 = 2.0;
/// Share of the scatter of the differences of a run on nodes that is added to their mean: between these rows they are others.
const SCATTER: f64 = 0.5;
/// Error of K on the finer nodes, of runs on points and on nodes: 0.36 and 0.45 % of life at m = 3. Lives of 39 plates, corrected by the
/// finer nodes, err by up to 0.6 %, references by 0.1 to 0.6 %; two more plates err in ways that finer nodes do not show.
const FINER: [f64; 2] = [1.2e-3, 1.5e-3];
/// Error of cycles between rows over that asked of a step, of runs on points and on nodes.
const STEPS: [f64; 2] = [2.0, 0.5];
/// What a way is off by in any case, over the growth: straight pieces between turns of up to 5°.
const WAY: f64 = 2e-3;
/// Error of a life at m = 3 over the part of it in which tips have met rims or other cracks, where K is not solved for on finer nodes, of
/// runs on points and on nodes: on nodes six plates whose cracks join err by up to 0.3 %.
const AFTER_MEETING: [f64; 2] = [0.015, 0.0075];
/// Difference of K from the energy released from which nothing is said of the error of a life.
const CROSS_CHECK_MOST: f64 = 0.02;
/// Share of the load of a pin by which its contact may be off, beyond which nothing is said.
const CONTACT_MOST: f64 = 0.005;
/// Error of a path over the gap between a rim and a crack that passes it, from which nothing is said: K behind a rim falls with the gap.
const GAP_SHARE: f64 = 0.3;
/// The same of points, whose path is farther off: 0.2 made a life between two holes 4.1 % too long where 3.4 % were stated.
const GAP_SHARE_OF_POINTS: f64 = 0.15;
/// Factor by which a path may spread by the T-stress within `UNSTABLE_WITHIN` of a life, beyond which nothing is said: double cantilevers with a
/// bent crack spread by 18 and 22, and their lives differ by 3 % with the nodes; of a hundred other plates, but for straight cracks, none by more than 2.3.
const SPREAD_MOST: f64 = 7.0;
const UNSTABLE_WITHIN: f64 = 0.8;
/// Difference of angles, rad, below which a path is straight by symmetry: it has no deviation that could grow.
const STRAIGHT: f64 = 1e-6;
/// Percent of the life of a part-through crack at most that K has no stated error for.
const UNSTATED_MOST: f64 = 25.0;
/// Rate of a tip over that of the fastest from which it may end the life as well.
const ALIKE: f64 = 0.8;
/// Share of a life that must be looked at.
const LOOKED_AT_LEAST: f64 = 0.3;

/// Estimated numerical error of a run: plane linear elasticity with the given law solved exactly would differ by at most that.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorEstimate {
    pub life_percent: f64,
    /// Of the way of its cracks, m.
    pub path: f64,
    pub basis: String,
}

pub type Estimated = Result<(ErrorEstimate, Option<Moment>), String>;

/// Estimated error of a run, or why there is none.
pub fn error_estimate(case: &Case, prediction: &Prediction) -> Result<ErrorEstimate, String> {
    estimate(case, prediction).map(|found| found.0)
}

/// The same with the last plate that was solved for it, where its stress is all that the load makes.
pub fn estimate(case: &Case, prediction: &Prediction) -> Estimated {
    if prediction.life_cycles() <= 0.0 {
        return Err("no life".to_owned());
    }
    if prediction.stop == StopReason::NoConvergence {
        return Err("the solver did not converge".to_owned());
    }
    if let Some(check) = prediction.cross_check.filter(|check| check.difference.abs() > CROSS_CHECK_MOST) {
        return Err(format!("K differs by {:.1} % from the energy release rate", 100.0 * check.difference));
    }
    match case.engine() {
        Engine::Bonds | Engine::BondsThenPoints => {
            Err("bond failure by own strain does not converge with the lattice".to_owned())
        }
        Engine::PartThrough => of_part_through(case, prediction).map(|found| (found, None)),
        engine => {
            let law = growth_law(case).map_err(|error| error.to_string())?;
            match engine {
                Engine::Handbook => of_formula(case, prediction, &*law).map(|found| (found, None)),
                Engine::Nodes => by_finer_nodes(case, prediction, &*law, &SHARES_OF_NODES),
                _ => by_finer_nodes(case, prediction, &*law, &SHARES_OF_POINTS),
            }
        }
    }
}

/// A growth law at one stress ratio.
struct Rates<'a> {
    law: &'a dyn GrowthLaw,
    ratio: f64,
}

impl Rates<'_> {
    fn at(&self, factor: f64) -> f64 {
        self.law.rate(factor, self.ratio)
    }

    /// d ln r / d ln K.
    fn exponent(&self, factor: f64) -> f64 {
        const STEP: f64 = 1e-3;
        (self.at(factor * (1.0 + STEP)) / self.at(factor * (1.0 - STEP))).ln() / (2.0 * STEP)
    }
}

/// The error of the formula, by the exponent of the law.
fn of_formula(case: &Case, prediction: &Prediction, law: &dyn GrowthLaw) -> Result<ErrorEstimate, String> {
    let Some(formula) = handbook(&case.specimen) else { return Err("no handbook formula".to_owned()) };
    if case.specimen.beta.is_some() {
        return Err(format!("{} has no stated error of K", formula.name));
    }
    if !formula.holds_at(prediction.crack_length_final()) {
        return Err(format!("the crack grew beyond the range of the formula ({})", formula.range));
    }
    if case.loading.residual.is_some() {
        return Err("the error of K_res by a Green function is not stated in full".to_owned());
    }
    let rates = Rates { law, ratio: case.loading.ratio };
    let (life, mut sum) = (prediction.life_cycles(), 0.0);
    for pair in prediction.curve.windows(2) {
        let middle = 0.5 * (pair[0].crack_length + pair[1].crack_length);
        let exponent = rates.exponent(formula.k_i(middle, case.loading.at(middle)));
        let error = formula.error_at(middle) * exponent.abs();
        sum += if error.is_finite() { error } else { 1.0 } * (pair[1].cycles - pair[0].cycles);
    }
    Ok(ErrorEstimate {
        life_percent: 100.0 * sum / life,
        path: 0.0,
        basis: format!("formula {}: {}", formula.name, formula.range),
    })
}

/// What the stated error of K makes of the life before breakthrough. Cycles outside the range of that, and after breakthrough, count in full.
fn of_part_through(case: &Case, prediction: &Prediction) -> Result<ErrorEstimate, String> {
    let life = PartThroughLife::of(case, &prediction.curve).ok_or("no K of the crack")?;
    if case.specimen.part_through.is_some_and(|flaw| case.specimen.holes.len() > flaw.own_holes()) {
        return Err("the effect of the other holes on K of a part-through crack has no stated error".to_owned());
    }
    let cycles = prediction.life_cycles();
    let [outside, after] = [life.cycles_outside, cycles - life.cycles].map(|part| 100.0 * part / cycles);
    if outside + after > UNSTATED_MOST {
        return Err(format!(
            "K has no stated error for {after:.0} % of life after breakthrough, {outside:.0} % beyond its range"
        ));
    }
    let stated = life.life_factors.iter().map(|factor| 100.0 * (factor - 1.0).abs()).fold(0.0, f64::max);
    let basis = format!("K ±{:.0} %, {:.1} % of life without a stated error in full", 100.0 * STATED_ERROR, outside + after);
    let estimate = ErrorEstimate { life_percent: stated + outside + after, path: 0.0, basis };
    stated.is_finite().then_some(estimate).ok_or_else(|| "within the error of K there may be no growth".to_owned())
}

fn by_finer_nodes(case: &Case, prediction: &Prediction, law: &dyn GrowthLaw, shares: &[f64]) -> Estimated {
    let (life, rows) = (prediction.life_cycles(), rows_before_meeting(&prediction.curve));
    let end = rows.last().map_or(0.0, |row| row.cycles);
    if end < LOOKED_AT_LEAST * life {
        return Err("most of the life follows a tip reaching an edge, hole or crack".to_owned());
    }
    let rates = Rates { law, ratio: case.loading.ratio };
    let nearest = |share: f64| {
        let gap = |row: &usize| (rows[*row].cycles - share * life).abs();
        (0..rows.len()).filter(|row| rows[*row].is_solved).min_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap_or(0)
    };
    let mut asked: Vec<usize> = shares.iter().map(|share| nearest(*share)).collect();
    asked.dedup();
    let at_row = |row: usize, refined: Option<[u32; 2]>| Difference::at(case, finer_nodes(case, refined), rows, row, &rates);
    let of_run = (case.engine() == Engine::Nodes).then_some(prediction.figures.refined);
    let (first, others) = asked.split_at(usize::from(of_run.is_none()));
    let mut solved = first.iter().map(|&row| in_pool(|| at_row(row, None))).collect::<Result<Vec<_>, String>>()?;
    let refined = of_run.or_else(|| solved.first().map(|(_, moment)| moment.plate.statistics().refined));
    solved.extend(others.par_iter().map(|&row| at_row(row, refined)).collect::<Result<Vec<_>, String>>()?);
    let (found, moments): (Vec<(f64, Difference)>, Vec<Moment>) = solved.into_iter().unzip();
    // Every row stands for the cycles nearest to it.
    let mut largest_exponent: f64 = 0.0;
    let [mut of_life, mut mean, mut of_loads, mut of_angle] = [0.0; 4];
    for (i, (cycles, difference)) in found.iter().enumerate() {
        let from = if i == 0 { 0.0 } else { 0.5 * (found[i - 1].0 + cycles) };
        let to = found.get(i + 1).map_or(end, |next| 0.5 * (next.0 + cycles));
        let share = (to - from) / life;
        of_life += share * difference.rate.abs();
        mean += share * difference.rate;
        of_loads += share * difference.of_loads.abs();
        of_angle += difference.angle.abs() / found.len() as f64;
        largest_exponent = largest_exponent.max(difference.exponent.abs());
    }
    let looked_at = end / life;
    let deviations = found.iter().map(|(_, difference)| (difference.rate - mean / looked_at).powi(2));
    let scatter = looked_at * (deviations.sum::<f64>() / found.len() as f64).sqrt();
    let is_on_nodes = case.engine() == Engine::Nodes;
    let of_rates = if is_on_nodes { mean.abs() + SCATTER * scatter } else { BETWEEN * of_life };
    let [finer, steps, after_meeting] = [FINER, STEPS, AFTER_MEETING].map(|of| of[usize::from(is_on_nodes)]);
    let after = after_meeting * largest_exponent / 3.0 * (1.0 - looked_at);
    let steps = 0.01 * steps * case.fatigue.step_error_percent + prediction.figures.step_error.abs() / life;
    let growth = prediction.curve.last().map_or(0.0, |row| row.tips.iter().map(|tip| tip.growth).fold(0.0, f64::max));
    let path = growth * (of_angle + WAY);
    let share_of_gap = if is_on_nodes { GAP_SHARE } else { GAP_SHARE_OF_POINTS };
    if let Some(gap) = rim_passed(case, &prediction.curve).filter(|gap| path > share_of_gap * gap) {
        return Err(format!("the crack passes an edge at {:.2} mm, and its path is known to {:.2} mm only", gap / MM, path / MM));
    }
    let spread = spread_of_path(&prediction.curve, UNSTABLE_WITHIN * life);
    if of_angle > STRAIGHT && spread > SPREAD_MOST {
        return Err(format!("the crack path is unstable (T-stress > 0): deviations of it grow {spread:.0} times"));
    }
    let shown = moments.into_iter().rfind(|moment| moment.cycles <= SHOWN_AT * life && case.loading.residual.is_none());
    let estimate = ErrorEstimate {
        life_percent: 100.0 * (of_rates + BETWEEN * of_loads + finer * largest_exponent + after + steps),
        path,
        basis: format!("K at {} stages recomputed on finer nodes", found.len()),
    };
    Ok((estimate, shown))
}

/// Factor by which a deviation of the path of a tip grows until `cycles`, of the tip where that is the most: `exp ∫ 8 T²/K² da` over T > 0
/// (Cotterell and Rice 1980, of a crack in a large plate; a path with T < 0 is stable).
fn spread_of_path(curve: &[CurvePoint], cycles: f64) -> f64 {
    let of_tip = |tip: usize| {
        let rows = curve.windows(2).take_while(|pair| pair[1].cycles <= cycles);
        let exponents = rows.filter_map(|pair| {
            let [before, after] = [&pair[0].tips[tip], &pair[1].tips[tip]];
            let [k_i, k_ii] = before.factors?;
            let share = before.t_stress?.max(0.0) / k_i.hypot(k_ii);
            Some(8.0 * share * share * (after.growth - before.growth)).filter(|exponent| exponent.is_finite())
        });
        exponents.sum::<f64>().exp()
    };
    (0..curve.first().map_or(0, |row| row.tips.len())).map(of_tip).fold(1.0, f64::max)
}

/// The least distance at which a tip passes a rim, m: from where the way to the rim gets longer again.
fn rim_passed(case: &Case, curve: &[CurvePoint]) -> Option<f64> {
    let tips = curve.first().map_or(0, |row| row.tips.len());
    let passed = |tip: usize| {
        let gaps: Vec<f64> = curve.iter().map(|row| case.specimen.rim_distance(row.tips[tip].position)).collect();
        let least = gaps.windows(3).filter(|gap| gap[1] < gap[0] && gap[1] < gap[2]).map(|gap| gap[1]);
        least.fold(f64::INFINITY, f64::min)
    };
    Some((0..tips).map(passed).fold(f64::INFINITY, f64::min)).filter(|gap| gap.is_finite())
}

/// What finer nodes say at the cracks of a row.
struct Difference {
    /// ln of the rate of a tip by them over that of the run: of the tips that grow about as fast as the fastest the one that differs most.
    rate: f64,
    /// The same by the loads between which K is linear.
    of_loads: f64,
    /// Direction of growth of that tip by them less that of the run, rad.
    angle: f64,
    exponent: f64,
}

impl Difference {
    /// That of a row with its cycles, and the plate there on finer nodes.
    fn at(
        case: &Case,
        finer: ElementFreeSettings,
        rows: &[CurvePoint],
        row: usize,
        rates: &Rates<'_>,
    ) -> Result<((f64, Difference), Moment), String> {
        let finer = Case { specimen: grown(&case.specimen, &rows[..=row]), model: Model::Nodes(finer), ..case.clone() };
        let (InitialTips { tips, contact_residual, .. }, plate) =
            initial_tips_on::<NodePlate>(&finer).map_err(|error| format!("finer nodes: {error}"))?;
        if contact_residual > CONTACT_MOST {
            return Err(format!("pin contact is off by {:.2} % of the pin load", 100.0 * contact_residual));
        }
        let rate_of = |tip: &TipRecord| {
            tip.factors.map_or(0.0, |factors| rates.law.mean_rate(equivalent_factor(factors), rates.ratio, &tip.response))
        };
        let own = &rows[row].tips;
        let active = |tip: &usize| own[*tip].state == TipState::Active;
        let ratio = |a: &TipRecord, b: &TipRecord| (rate_of(a) / rate_of(b)).ln();
        let fastest = (0..own.len()).filter(active).map(|tip| rate_of(&own[tip])).fold(0.0, f64::max);
        let leads = (0..own.len()).filter(active).filter(|tip| rate_of(&own[*tip]) >= ALIKE * fastest);
        let off = |tip: &usize| ratio(&tips[*tip], &own[*tip]).abs();
        let lead = leads.max_by(|a, b| off(a).total_cmp(&off(b))).ok_or("no tip is open")?;
        let (Some(before), Some(now)) = (own[lead].factors, tips[lead].factors) else {
            return Err("K of the leading tip is not known on finer nodes".to_owned());
        };
        let (response, (_, are_all)) = (tips[lead].response, case.loading.lower_loads());
        let coarser = TipRecord { response: if are_all { response } else { response.coarser() }, ..tips[lead] };
        let (rate, of_loads) = (ratio(&tips[lead], &own[lead]), ratio(&coarser, &tips[lead]) / 3.0);
        let difference = Difference {
            rate,
            of_loads,
            angle: kink_angle(now) - kink_angle(before),
            exponent: rates.exponent(equivalent_factor(before)),
        };
        let is_known = [rate, of_loads, difference.angle, difference.exponent].iter().all(|value| value.is_finite());
        let (cycles, at) = (rows[row].cycles, rows[row].crack_length / MM);
        let found = ((cycles, difference), Moment { cycles, case: finer, plate });
        is_known.then_some(found).ok_or_else(|| format!("at {at:.3} mm the leading tip is at the threshold of its law"))
    }
}
