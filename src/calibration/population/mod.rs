//! All specimens of a lot in one model: mixed effects on reading intervals.
//!
//! Every reading interval of every specimen, under its own loads, says `y = -ln(ΔN / ∫ da / rate)`: by how much the crack grew faster than
//! the law. `y = (b + m x + Σ c_k φ_k(x) of all) + b_i + m_i x of the specimen + e`: the shared [`law`], departures (b_i, m_i) ~ N(0, T)
//! ([`Between`]), [`noise`] e along the crack. Variances by restricted maximum likelihood (`reml`), the law by generalised least squares;
//! since an interval is long beside the bend of the law, its integral is taken anew with the fitted law until that stands still.
//! [`intervals`] joins readings, [`forecast`] gives lives with their bands on any plate, [`student`] the quantiles.

pub mod forecast;
pub mod intervals;
pub mod law;
pub mod lots;
pub mod noise;
pub mod plate;
mod reml;
pub mod student;

use nalgebra::{Matrix2, Vector2};
use serde::{Deserialize, Serialize};

use intervals::{Interval, Specimen};
use law::{EFFECTS, KNOTS, MeanLaw, Row};
use noise::{Noise, cholesky, whiten};
use perilife_base::error::{Error, Result, input_missing};
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_laws::STEADY_EXPONENTS;
use reml::{Effects, Group, PARAMETERS, Parameters, Penalty, departures, estimate, likelihood, minimise, uncertainty, variances};

/// Specimens from which on no scatter is assumed.
const SPECIMENS_FOR_SCATTER: usize = 10;
/// Standard deviation of the ridge on the shape.
const SHAPE_DEVIATION: f64 = 0.3;
/// Range of ΔK, largest over smallest, from which on a law can have a shape.
const SHAPE_RANGE_MIN: f64 = 1.3;
/// Intervals for which a law can have a shape.
const SHAPE_INTERVALS_MIN: usize = 5 * KNOTS;
/// Range of ΔK below which rates of every exponent are alike.
const RANGE_MIN: f64 = 1.01;
/// Exponent from which the search for the law starts.
const SLOPE_START: f64 = 3.0;
/// Change of m at which the law stands still.
const SLOPE_SAME: f64 = 1e-7;
/// Most integrals with a new law.
const LAWS_MAX: usize = 60;
/// Most searches for the variances.
const ROUNDS_MAX: usize = 8;
/// Curvature by which a given slope is held.
const HELD: f64 = 1e14;
/// Steps of the own law of a specimen.
const OWN_STEPS: usize = 12;

/// T: scatter between specimens.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Between {
    /// Standard deviation of ln rate at the pivot.
    pub level: f64,
    /// Standard deviation of the slope.
    pub slope: f64,
    /// Correlation of both.
    pub correlation: f64,
}

impl Between {
    fn matrix(&self) -> Matrix2<f64> {
        let both = self.correlation * self.level * self.slope;
        Matrix2::new(self.level * self.level, both, both, self.slope * self.slope)
    }
}

/// Standard errors; of variances of their natural logarithm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Of ln rate at the pivot.
    pub level: f64,
    /// Of the slope.
    pub slope: f64,
    /// Of the slope were it the same in all specimens: what the readings leave open, without scatter between specimens.
    pub slope_of_readings: f64,
    /// Of the shape.
    pub shape: [f64; KNOTS],
    /// Of ln sd of the level between specimens.
    pub between_level: f64,
    /// Of ln sd of the slope between specimens.
    pub between_slope: f64,
    /// Of artanh of their correlation.
    pub correlation: f64,
    /// Of ln s.
    pub scatter: f64,
    /// Of ln ℓ.
    pub length: f64,
    /// Of ln w.
    pub white: f64,
    /// Of ln r.
    pub reading: f64,
}

/// One specimen in the lot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Member {
    /// Name.
    pub name: String,
    /// ln rate at the pivot, most probable with what the others say.
    pub level: f64,
    /// Slope, most probable with what the others say.
    pub slope: f64,
    /// ln rate at the pivot and slope of its own readings alone, shape as of all; the slope that of the lot where it has one interval.
    pub own: [f64; 2],
    /// Intervals that its readings make up.
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
    /// κ: variance of the noise of the calibration's intervals, weighted with their cycles; keeps mean cycles free of the size of cells.
    pub interval_variance: f64,
    /// Negative logarithm of the restricted likelihood; compares fits of equal fixed effects.
    pub restricted_likelihood: f64,
    /// Law of the lot.
    pub law: MeanLaw,
    /// The same model with a law that has no shape: its slope is the m of Paris that all readings agree on best.
    pub power_law: MeanLaw,
    /// T.
    pub between: Between,
    /// Noise along a crack.
    pub noise: Noise,
    /// Standard errors of all that.
    pub errors: Errors,
    /// Specimens.
    pub specimens: Vec<Member>,
}

impl Population {
    /// Covariance of ln A (A the rate at 1 MPa√m) and the exponent of the law of all; with a given exponent of ln A alone. Level and slope
    /// are uncorrelated at the pivot. Each is as uncertain as the mean of those of the specimens, whose scatter is that of reading and of
    /// material together, and at least as the readings alone leave it.
    pub fn covariance_of_constants(&self, is_fitted: bool) -> [[f64; 2]; 2] {
        let n = self.specimens.len() as f64;
        let of_mean = |of: &dyn Fn(&Member) -> f64| {
            let mean = self.specimens.iter().map(of).sum::<f64>() / n;
            self.specimens.iter().map(|own| (of(own) - mean).powi(2)).sum::<f64>() / ((n - 1.0).max(1.0) * n)
        };
        let slope = of_mean(&|own| own.own[1]).max(self.errors.slope_of_readings.powi(2));
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
    /// Smallest of them.
    least: [f64; PARAMETERS],
    /// Largest of them.
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

    /// Where the search starts: noise as large as the residuals of the law.
    fn start(&self, residual: f64) -> Parameters {
        let place = self.normal.map(|(place, _)| place);
        let scatter = place[3] + (residual / 0.22).clamp(1e-3, 10.0).ln();
        [place[0], place[1], place[2], scatter, place[4], place[5] - place[3], place[6] - place[3]]
    }
}

/// Logarithm of a limit; no limit where there is none.
fn limit(value: f64) -> f64 {
    if value.is_finite() { value.ln() } else { value }
}

/// A law with its variances and their likelihood, priors counted.
#[derive(Clone, Copy)]
struct Found {
    law: MeanLaw,
    at: Parameters,
    value: f64,
}

/// Fits the model to specimens of one lot. `slope` is m where the user gives it.
///
/// The law has a shape where the likelihood says so: the ridge makes that of both laws comparable, so that readings of a plain power law,
/// however exact, give one.
/// Errors: no specimen; [`Error::Mechanics`] where the readings have no law, or do not tell its exponent.
pub fn fit(specimens: &[Specimen], slope: Option<f64>) -> Result<Population> {
    let priors = Priors::of(specimens.len());
    let no_law = || Error::Mechanics("the readings give no growth law: their rates have no smallest misfit".to_owned());
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
    let mut found = straight;
    if law.range_ratio() >= SHAPE_RANGE_MIN && count >= SHAPE_INTERVALS_MIN {
        let bent = MeanLaw { shape: Some([0.0; KNOTS]), ..straight.law };
        let bent = search(specimens, bent, slope, &priors, straight.at).ok_or_else(no_law)?;
        found = if bent.value < straight.value { bent } else { straight };
    }
    assess(specimens, &found, &straight, slope, &priors).ok_or_else(no_law)
}

/// Variances and law in turn, until m stands still.
fn search(specimens: &[Specimen], mut law: MeanLaw, slope: Option<f64>, priors: &Priors, mut at: Parameters) -> Option<Found> {
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
fn check_identified(law: &MeanLaw, error: f64) -> Result<()> {
    let (low, high) = (STEADY_EXPONENTS.start(), STEADY_EXPONENTS.end());
    if STEADY_EXPONENTS.contains(&law.slope) && error < (high - low) / 12.0_f64.sqrt() {
        return Ok(());
    }
    Err(Error::Mechanics(format!(
        "the readings do not tell the exponent: m = {:.3}, its standard error is {error:.2} where {low} to {high} are searched, and ΔK varies \
         by a factor {:.4}; widen the window (measured.from_crack_length_mm and to_crack_length_mm), or fix p by [fit] parameters = \
         [\"a\"] and p = ...",
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

/// Range, pivot, and the power law from which the search starts.
fn start(specimens: &[Specimen], slope: Option<f64>) -> Result<MeanLaw> {
    let all = || specimens.iter().flat_map(|specimen| &specimen.intervals);
    let count = all().count();
    if count == 0 {
        return Err(input_missing("measured.files", "hold no growth", "give at least one specimen with two readings"));
    }
    let (mut low, mut high, mut sum, mut cycles) = (f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0);
    for interval in all() {
        for &end in &interval.ends {
            (low, high) = (low.min(end), high.max(end));
        }
        cycles += interval.cycles;
        sum += interval.cycles * 0.5 * (interval.ends[0] + interval.ends[1]);
    }
    let (range, pivot) = ([low.exp(), high.exp()], (sum / cycles).exp());
    let mut law = MeanLaw { pivot, level: 0.0, slope: slope.unwrap_or(SLOPE_START), range, shape: None };
    let mean: f64 = all().map(|interval| law.rows(std::slice::from_ref(interval))[0].log_cycles - interval.cycles.ln()).sum();
    law.level = mean / count as f64;
    Ok(law)
}

/// Ridge of the shape, and of a slope that is given.
fn penalty(law: &MeanLaw, slope: Option<f64>) -> Penalty {
    let mut curvature = Effects::repeat(SHAPE_DEVIATION.powi(-2));
    (curvature[0], curvature[1]) = (0.0, if slope.is_some() { HELD } else { 0.0 });
    let mut from_place = Effects::from(law.effects());
    from_place[1] -= slope.unwrap_or(law.slope);
    Penalty { curvature, from_place }
}

/// Specimens read alike together, with what the law misses.
fn groups(specimens: &[Specimen], law: &MeanLaw) -> Vec<Group> {
    let alike = |a: &Specimen, b: &Specimen| {
        a.intervals.len() == b.intervals.len()
            && a.intervals.iter().zip(&b.intervals).all(|(a, b)| a.from == b.from && a.to == b.to && a.points == b.points)
    };
    let mut groups: Vec<Group> = Vec::new();
    for (place, specimen) in specimens.iter().enumerate() {
        let known = groups.iter_mut().find(|group| alike(&specimens[group.members[0]], specimen));
        let residual =
            |rows: &[Row]| rows.iter().zip(&specimen.intervals).map(|(row, own)| row.log_cycles - own.cycles.ln()).collect();
        match known {
            Some(group) => {
                group.residuals.push(residual(&group.rows));
                group.members.push(place);
            }
            None => {
                let rows = law.rows(&specimen.intervals);
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
fn settle(specimens: &[Specimen], mut law: MeanLaw, slope: Option<f64>, at: &Parameters) -> Option<MeanLaw> {
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

/// All results at the variances that were found.
fn assess(specimens: &[Specimen], best: &Found, straight: &Found, slope: Option<f64>, priors: &Priors) -> Option<Population> {
    let Found { law, at, .. } = best;
    let (law, at) = (*law, at);
    let groups = groups(specimens, &law);
    let penalty = penalty(&law, slope);
    let found = estimate(&groups, at, &penalty)?;
    let (between, noise) = variances(at);
    let mut members = vec![None; specimens.len()];
    let (mut cycles, mut noisy) = (0.0, 0.0);
    for group in &groups {
        let of_group = departures(group, at, &found.change)?;
        for (&place, (own, misfit)) in group.members.iter().zip(of_group) {
            let specimen = &specimens[place];
            members[place] = Some(Member {
                name: specimen.name.clone(),
                level: law.level + own[0],
                slope: law.slope + own[1],
                own: own_law(&specimen.intervals, &law, &noise)?,
                intervals: specimen.intervals.len(),
                misfit,
            });
            for (row, interval) in group.rows.iter().zip(&specimen.intervals) {
                cycles += interval.cycles;
                noisy += interval.cycles * (noise.variance(row) + noise.reading_variance(row));
            }
        }
    }
    let error = |i: usize| found.covariance[(i, i)].max(0.0).sqrt();
    let of_variances = uncertainty(&groups, &penalty, priors, at);
    let variance_error = |weights: &[(usize, f64)]| {
        let Some(covariance) = &of_variances else { return f64::NAN };
        let pair = |(i, a): &(usize, f64)| weights.iter().map(|(j, b)| a * b * covariance[(*i, *j)]).sum::<f64>();
        weights.iter().map(pair).sum::<f64>().max(0.0).sqrt()
    };
    let few = specimens.len() < SPECIMENS_FOR_SCATTER;
    let freedom = specimens.len() as f64 - 1.0 + if few { lots::FREEDOM } else { 0.0 };
    Some(Population {
        law,
        power_law: straight.law,
        between,
        noise,
        errors: Errors {
            level: error(0),
            slope: error(1),
            slope_of_readings: if slope.is_some() { 0.0 } else { slope_of_readings(specimens, best)? },
            shape: std::array::from_fn(|k| if law.shape.is_some() { error(2 + k) } else { 0.0 }),
            between_level: variance_error(&[(0, 1.0)]),
            between_slope: variance_error(&[(1, 1.0)]),
            correlation: variance_error(&[(2, 1.0)]),
            scatter: variance_error(&[(3, 1.0)]),
            length: variance_error(&[(4, 1.0)]),
            white: variance_error(&[(3, 1.0), (5, 1.0)]),
            reading: variance_error(&[(3, 1.0), (6, 1.0)]),
        },
        covariance: found.covariance.transpose().into(),
        freedom,
        assumed_scatter: few,
        interval_variance: noisy / cycles,
        restricted_likelihood: likelihood(&groups, at, &penalty)?,
        specimens: members.into_iter().collect::<Option<_>>()?,
    })
}

/// ln rate at the pivot and slope of the readings of one specimen, the shape being that of the lot.
fn own_law(intervals: &[Interval], lot: &MeanLaw, noise: &Noise) -> Option<[f64; 2]> {
    let n = intervals.len();
    let mut law = *lot;
    for _ in 0..OWN_STEPS {
        let rows = law.rows(intervals);
        let mut factor = noise.covariance(&rows);
        cholesky(&mut factor, n)?;
        let line = |(row, own): (&Row, &Interval)| [row.design[0], row.design[1], row.log_cycles - own.cycles.ln()];
        let mut white: Vec<f64> = rows.iter().zip(intervals).flat_map(line).collect();
        whiten(&factor, n, &mut white, 3);
        let (mut curvature, mut right) = (Matrix2::zeros(), Vector2::zeros());
        for row in white.chunks_exact(3) {
            let x = Vector2::new(row[0], row[1]);
            curvature += x * x.transpose();
            right += x * row[2];
        }
        let level_only = Vector2::new(right[0] / curvature[(0, 0)], 0.0);
        let change = if n < 2 { level_only } else { curvature.try_inverse().map_or(level_only, |inverse| inverse * right) };
        law.level += change[0];
        law.slope += change[1].clamp(-1.0, 1.0);
        if change.amax() < SLOPE_SAME {
            break;
        }
    }
    Some([law.level, law.slope])
}
