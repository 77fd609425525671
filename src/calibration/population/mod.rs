//! All specimens of a lot in one model: mixed effects on reading intervals.
//!
//! Every reading interval of every specimen, under its own loads, says `y = -ln(ΔN / ∫ da / rate)`: by how much the crack grew faster than
//! the law. `y = (b + m x + Σ c_k φ_k(x) of all) + b_i + m_i x of the specimen + e`: the shared law, departures (b_i, m_i) ~ N(0, T)
//! ([`Between`]), [`noise`] e along the crack. Variances by restricted maximum likelihood (`reml`), the law by generalised least squares;
//! since an interval is long beside the bend of the law, its integral is taken anew with the fitted law until that stands still.
//! [`intervals`] joins readings, [`forecast`] gives lives with their bands on any plate, [`student`] the quantiles.

mod assess;
pub mod forecast;
pub mod intervals;
pub mod lots;
pub mod noise;
pub mod plate;
mod reml;
pub mod student;

use nalgebra::Matrix2;
use serde::{Deserialize, Serialize};

use assess::assess;
use intervals::{IntervalRow, Specimen, rows};
use noise::Noise;
use perilife_base::error::{Error, Result, fail_if, input_missing};
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_laws::STEADY_EXPONENTS;
use perilife_laws::curve::{CurveLaw, EFFECTS, KNOTS, ROUGHNESS};
use reml::{Effects, EffectsMatrix, Group, PARAMETERS, Parameters, Penalty, estimate, likelihood, minimise};

const SPECIMENS_FOR_SCATTER: usize = 10;
/// τ: rms departure of a shape from a straight line, ln of rate.
const SHAPE_DEVIATION: f64 = 0.2;
/// Gain of the restricted likelihood, in its logarithm, from which on a law has a shape: of 200 made power laws with noise of 1 to 5 % none is
/// taken for a curve.
const SHAPE_GAIN_MIN: f64 = 0.5;
/// Range of ΔK, largest over smallest, from which on a law can have a shape.
const SHAPE_RANGE_MIN: f64 = 1.3;
/// Intervals for which a law can have a shape.
const SHAPE_INTERVALS_MIN: usize = KNOTS + 3;
/// Range of ΔK below which rates of every exponent are alike.
const RANGE_MIN: f64 = 1.01;
const SLOPE_START: f64 = 3.0;
const SLOPE_SAME: f64 = 1e-7;
const LAWS_MAX: usize = 60;
const ROUNDS_MAX: usize = 8;
/// Curvature by which a given slope is held.
const HELD: f64 = 1e14;

/// T: scatter between specimens.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Between {
    /// Standard deviation of ln rate at the pivot.
    pub level: f64,
    pub slope: f64,
    pub correlation: f64,
}

impl Between {
    fn matrix(&self) -> Matrix2<f64> {
        let both = self.correlation * self.level * self.slope;
        Matrix2::new(self.level * self.level, both, both, self.slope * self.slope)
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Member {
    pub name: String,
    /// ln rate at the pivot, most probable with what the others say.
    pub level: f64,
    /// Slope, most probable with what the others say.
    pub slope: f64,
    /// ln rate at the pivot and slope of its own readings alone, shape as of all; the slope that of the lot where it has one interval.
    pub own: [f64; 2],
    pub intervals: usize,
    /// Mean square of its noise over that of the model: far above 1 where the specimen is unlike the others.
    pub misfit: f64,
}

/// What the readings of a lot say of its law and its scatter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Population {
    /// V: covariance of level, slope and shape.
    pub covariance: [[f64; EFFECTS]; EFFECTS],
    /// ν of Student's t.
    pub freedom: f64,
    /// Whether part of the scatter is assumed, as of few specimens.
    pub assumed_scatter: bool,
    /// Negative logarithm of the restricted likelihood; compares fits of equal fixed effects.
    pub restricted_likelihood: f64,
    /// L: what is added to the level of the law so that it takes the cycles that were counted, all of a specimen as one life.
    pub level_of_lives: f64,
    /// Gain of the likelihood by a shape; `None` where the readings are too few or their range is too short for one.
    pub gain: Option<f64>,
    /// Standard error of the slope were it the same in all specimens: what the readings leave open, without scatter between specimens.
    pub slope_of_readings: f64,
    /// Law of the lot: the mean of ln rate.
    pub law: CurveLaw,
    pub between: Between,
    pub noise: Noise,
    pub specimens: Vec<Member>,
}

impl Population {
    pub fn life_law(&self) -> CurveLaw {
        CurveLaw { level: self.law.level + self.level_of_lives, ..self.law }
    }

    /// Standard errors of ln rate and local exponent of the law at a ΔK, Pa√m.
    pub fn errors_at(&self, delta_k: f64) -> [f64; 2] {
        let of = |design: [f64; EFFECTS]| {
            let row = |i: usize| (0..EFFECTS).map(|j| self.covariance[i][j] * design[j]).sum::<f64>();
            (0..EFFECTS).map(|i| design[i] * row(i)).sum::<f64>().max(0.0).sqrt()
        };
        [of(self.law.design(delta_k.ln())), of(self.law.design_slope(delta_k.ln()))]
    }

    /// Covariance of ln A (A the rate at 1 MPa√m) and the exponent of the law of all; with a given exponent of ln A alone. Level and slope
    /// are uncorrelated at the pivot. Each is as uncertain as the mean of those of the specimens, whose scatter is that of reading and of
    /// material together, and at least as the readings alone leave it.
    pub fn covariance_of_constants(&self, is_fitted: bool) -> [[f64; 2]; 2] {
        let n = self.specimens.len() as f64;
        let of_mean = |of: &dyn Fn(&Member) -> f64| {
            let mean = self.specimens.iter().map(of).sum::<f64>() / n;
            self.specimens.iter().map(|own| (of(own) - mean).powi(2)).sum::<f64>() / ((n - 1.0).max(1.0) * n)
        };
        let slope = of_mean(&|own| own.own[1]).max(self.slope_of_readings.powi(2));
        let level = of_mean(&|own| own.level);
        if !is_fitted {
            return [[level, 0.0], [0.0, 0.0]];
        }
        let pivot = (self.law.pivot / MPA_SQRT_M).ln();
        [[level + pivot * pivot * slope, -pivot * slope], [-pivot * slope, slope]]
    }
}

/// What is known of the variances before the readings: normal in the logarithm, and limits of what is told from none.
#[derive(Debug, Clone, Copy)]
struct Priors {
    /// Place and standard deviation of ln sd of level and slope, artanh of their correlation, ln s, ln ℓ, ln w, ln r.
    normal: [(f64, f64); PARAMETERS],
    least: [f64; PARAMETERS],
    most: [f64; PARAMETERS],
}

impl Priors {
    /// Of a number of specimens. Those of the noise are that of 2024-T3, so wide that two dozen intervals outweigh them.
    fn of(specimens: usize) -> Priors {
        let root_mm = MM.sqrt();
        let between = match specimens < SPECIMENS_FOR_SCATTER {
            true => [(lots::MEDIAN.ln(), lots::DEVIATION), (0.15_f64.ln(), lots::DEVIATION)],
            false => [(0.07_f64.ln(), 1.0), (0.15_f64.ln(), 0.8)],
        };
        let noise = [(0.16_f64.ln(), 2.0), ((0.67 * MM).ln(), 1.5), ((0.065 * root_mm).ln(), 2.0), ((0.01 * MM).ln(), 2.0)];
        Priors {
            normal: [between[0], between[1], (0.0, 1.0), noise[0], noise[1], noise[2], noise[3]],
            least: [1e-5, 1e-5, f64::NEG_INFINITY, 3e-4, 0.005 * MM, 3e-4 * root_mm, 1e-5 * MM].map(limit),
            most: [2.0, 5.0, f64::INFINITY, 3.0, 100.0 * MM, 3.0 * root_mm, 5.0 * MM].map(limit),
        }
    }

    fn penalty(&self, at: &Parameters) -> f64 {
        let mut values = *at;
        // w and r are sought in units of s.
        values[5] += at[3];
        values[6] += at[3];
        let one = |i: usize| {
            let (place, deviation) = self.normal[i];
            let outside = (self.least[i] - values[i]).max(values[i] - self.most[i]).max(0.0);
            0.5 * ((values[i] - place) / deviation).powi(2) + 100.0 * outside * outside
        };
        (0..PARAMETERS).map(one).sum()
    }

    fn start(&self, residual: f64) -> Parameters {
        let place = self.normal.map(|(place, _)| place);
        let scatter = place[3] + (residual / 0.22).clamp(1e-3, 10.0).ln();
        [place[0], place[1], place[2], scatter, place[4], place[5] - place[3], place[6] - place[3]]
    }
}

fn limit(value: f64) -> f64 {
    if value.is_finite() { value.ln() } else { value }
}

/// A law with its variances and their likelihood, priors counted.
#[derive(Clone, Copy)]
struct Found {
    law: CurveLaw,
    at: Parameters,
    value: f64,
}

/// Fits the model to specimens of one lot. `slope` is m where the user gives it.
///
/// The law has a shape where the likelihood says so: the penalty stands in that of both laws, so that readings of a plain power law, however
/// exact, give one.
/// Errors: no specimen; [`Error::Mechanics`] where the readings have no law, or do not tell its exponent.
pub fn fit(specimens: &[Specimen], slope: Option<f64>) -> Result<Population> {
    let priors = Priors::of(specimens.len());
    let no_law = || Error::Mechanics("no growth law can be fitted to the readings: the fit did not converge".to_owned());
    let law = start(specimens, slope)?;
    let count: usize = specimens.iter().map(|specimen| specimen.intervals.len()).sum();
    if slope.is_none() && (law.range_ratio() < RANGE_MIN || count < 2) {
        check_identified(&law, f64::INFINITY)?;
    }
    let at = priors.start(0.22);
    let law = settle(specimens, law, slope, &at).ok_or_else(no_law)?;
    let at = priors.start(rms(&groups(specimens, &law)));
    let straight = search(specimens, law, slope, &priors, at).ok_or_else(no_law)?;
    if slope.is_none() {
        check_identified(&straight.law, slope_of_readings(specimens, &straight).unwrap_or(f64::INFINITY))?;
    }
    let (mut found, mut gain) = (straight, None);
    if slope.is_none() && law.range_ratio() >= SHAPE_RANGE_MIN && count >= SHAPE_INTERVALS_MIN {
        let bent = CurveLaw { shape: Some([0.0; KNOTS]), ..straight.law };
        let bent = search(specimens, bent, slope, &priors, straight.at).ok_or_else(no_law)?;
        gain = Some(straight.value - bent.value);
        found = if straight.value - bent.value > SHAPE_GAIN_MIN && bent.law.rises() { bent } else { straight };
    }
    assess(specimens, &found, gain, slope).ok_or_else(no_law)
}

/// Variances and law in turn, until m stands still.
fn search(specimens: &[Specimen], mut law: CurveLaw, slope: Option<f64>, priors: &Priors, mut at: Parameters) -> Option<Found> {
    for round in 0..ROUNDS_MAX {
        let before = law;
        let groups = groups(specimens, &law);
        let penalty = penalty(&law, slope);
        at = minimise(&groups, &penalty, priors, &at);
        law = settle(specimens, law, slope, &at)?;
        let error = estimate(&groups, &at, &penalty)?.covariance[(1, 1)].max(0.0).sqrt();
        if round > 0 && (law.slope - before.slope).abs() < 10.0 * SLOPE_SAME + 1e-3 * error {
            break;
        }
    }
    let value = likelihood(&groups(specimens, &law), &at, &penalty(&law, slope))? + priors.penalty(&at);
    Some(Found { law, at, value })
}

/// Refuses readings whose m, with its standard error, is anywhere in the exponents that laws have.
fn check_identified(law: &CurveLaw, error: f64) -> Result<()> {
    let (low, high) = (STEADY_EXPONENTS.start(), STEADY_EXPONENTS.end());
    if STEADY_EXPONENTS.contains(&law.slope) && error < (high - low) / 12.0_f64.sqrt() {
        return Ok(());
    }
    Err(Error::Mechanics(format!(
        "the exponent cannot be determined: m = {:.3}, standard error {error:.2} in the search range {low} to {high}, ΔK \
         varies by a factor {:.4}; widen the window (measured.from_crack_length_mm and to_crack_length_mm), or fix p by [fit] \
         parameters = [\"a\"] and p = ...",
        law.slope,
        law.range_ratio()
    )))
}

/// Standard error of m were it the same in all specimens.
fn slope_of_readings(specimens: &[Specimen], found: &Found) -> Option<f64> {
    let mut at = found.at;
    at[1] = 1e-9_f64.ln();
    let found = estimate(&groups(specimens, &found.law), &at, &penalty(&found.law, None))?;
    Some(found.covariance[(1, 1)].max(0.0).sqrt())
}

fn start(specimens: &[Specimen], slope: Option<f64>) -> Result<CurveLaw> {
    let all = || specimens.iter().flat_map(|specimen| &specimen.intervals);
    let count = all().count();
    fail_if!(count == 0, input_missing("measured.files", "contain no growth", "give at least one specimen with two readings"));
    let (mut low, mut high, mut sum, mut cycles) = (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0);
    for interval in all() {
        for &end in interval.ends.iter().flatten().filter(|end| end.is_finite()) {
            (low, high) = (low.min(end), high.max(end));
        }
        cycles += interval.cycles;
        sum += interval.cycles * 0.5 * (interval.ends[0][0] + interval.ends[1][0]);
    }
    let (range, pivot) = ([low.exp(), high.exp()], (sum / cycles).exp());
    let mut law = CurveLaw { pivot, level: 0.0, slope: slope.unwrap_or(SLOPE_START), range, shape: None };
    let mean: f64 = all().map(|interval| rows(&law, std::slice::from_ref(interval))[0].log_cycles - interval.cycles.ln()).sum();
    law.level = mean / count as f64;
    Ok(law)
}

/// Penalty on the roughness of the shape (Wahba 1990), and of a slope that is given.
fn penalty(law: &CurveLaw, slope: Option<f64>) -> Penalty {
    let mut curvature = EffectsMatrix::zeros();
    curvature[(1, 1)] = if slope.is_some() { HELD } else { 0.0 };
    for (i, row) in ROUGHNESS.iter().enumerate() {
        row.iter().enumerate().for_each(|(j, value)| curvature[(2 + i, 2 + j)] = value / SHAPE_DEVIATION.powi(2));
    }
    let mut from_place = Effects::from(law.effects());
    from_place[1] -= slope.unwrap_or(law.slope);
    Penalty { curvature, from_place }
}

/// Specimens read alike together, with what the law misses.
fn groups(specimens: &[Specimen], law: &CurveLaw) -> Vec<Group> {
    let alike = |a: &Specimen, b: &Specimen| {
        a.intervals.len() == b.intervals.len()
            && a.intervals.iter().zip(&b.intervals).all(|(a, b)| a.from == b.from && a.to == b.to && a.log_k == b.log_k)
    };
    let mut groups: Vec<Group> = Vec::new();
    for (place, specimen) in specimens.iter().enumerate() {
        let known = groups.iter_mut().find(|group| alike(&specimens[group.members[0]], specimen));
        let residual = |rows: &[IntervalRow]| {
            rows.iter().zip(&specimen.intervals).map(|(row, own)| row.log_cycles - own.cycles.ln()).collect()
        };
        match known {
            Some(group) => {
                group.residuals.push(residual(&group.rows));
                group.members.push(place);
            }
            None => {
                let rows = rows(law, &specimen.intervals);
                groups.push(Group { residuals: vec![residual(&rows)], members: vec![place], rows });
            }
        }
    }
    groups
}

/// Root mean square of what the law misses, the mean of each specimen taken off.
fn rms(groups: &[Group]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for residual in groups.iter().flat_map(|group| &group.residuals) {
        let mean = residual.iter().sum::<f64>() / residual.len() as f64;
        sum += residual.iter().map(|r| (r - mean).powi(2)).sum::<f64>();
        count += residual.len() as f64;
    }
    (sum / count).sqrt()
}

/// The law at given variances: its integrals are taken with itself (Gauss-Newton).
fn settle(specimens: &[Specimen], mut law: CurveLaw, slope: Option<f64>, at: &Parameters) -> Option<CurveLaw> {
    for _ in 0..LAWS_MAX {
        let found = estimate(&groups(specimens, &law), at, &penalty(&law, slope))?;
        // A first step from afar must not go to laws that no metal has.
        let shortened = (1.0 / found.change[1].abs().max(1.0)).min(1.0);
        let change = found.change * shortened;
        law = law.with((Effects::from(law.effects()) + change).into());
        if change.iter().all(|change| change.abs() < SLOPE_SAME) {
            break;
        }
    }
    Some(law)
}
