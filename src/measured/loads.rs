//! Loads of every reading, and what they are to the load of the case.
//!
//! The load at a reading is the one under which the crack grew there. Where it changes once between readings of equal loads (a step), the
//! growth up to the reading had the new load; where it changes from reading to reading (shedding), it went from one to the other.

use std::collections::BTreeMap;

use super::curve::{Loads, Measured, MeasuredCurve, READINGS_MIN, first_of};
use perilife_base::error::{Result, fail_if, input_missing};
use perilife_base::linear_fit::line;
use perilife_base::table::Fault;
use perilife_base::table::names::Role;
use perilife_base::units::{KN, MM, MPA, MPA_SQRT_M, round_off};
use perilife_plate::loading::{Loading, SAME_RATIO};
use perilife_plate::material::Material;
use perilife_plate::specimen::handbook::{HandbookFormula, handbook};
use perilife_plate::specimen::{LengthConvention, LoadMeasure, Specimen};

/// Loads within this share of each other are equal: machines hold theirs to one percent.
pub const SAME_LOAD: f64 = 0.01;
/// Share by which a column may differ from the case: formulas for K agree to less.
const STATED_DIFFERENCE: f64 = 0.02;
/// Share of the plate, multiple of the toughness and leap of K beyond which a reading is of the fracture and not of fatigue.
const LIGAMENT_LEFT: f64 = 0.95;
const TOUGHNESS_FACTOR: f64 = 1.5;
const LEAP_OF_K: f64 = 2.0;

impl Measured {
    /// The load of all readings in keys of `[loading]`; nothing where there is none, or several.
    pub fn load(&self) -> BTreeMap<&'static str, f64> {
        let loads: Vec<&Loads> = self.curves.iter().filter_map(|curve| curve.loads.as_ref()).collect();
        let Some(first) = loads.first().filter(|_| loads.len() == self.curves.len()) else { return BTreeMap::new() };
        let (key, unit) = match (first.measure, first.is_range) {
            (LoadMeasure::Force, false) => ("force_max_kn", KN),
            (LoadMeasure::Force, true) => ("force_range_kn", KN),
            (LoadMeasure::Stress, false) => ("stress_max_mpa", MPA),
            (LoadMeasure::Stress, true) => ("stress_range_mpa", MPA),
        };
        let is_alike = |loads: &&Loads| (loads.measure, loads.is_range) == (first.measure, first.is_range);
        let load = common(&loads, |loads| &loads.maximum, |load| SAME_LOAD * load.abs()).filter(|_| loads.iter().all(is_alike));
        let ratio = common(&loads, |loads| &loads.ratio, |ratio| SAME_LOAD * ratio.abs());
        let ratio = ratio.map(|ratio| ("stress_ratio", round_off(ratio)));
        load.map(|load| (key, round_off(load / unit))).into_iter().chain(ratio).collect()
    }

    /// The stress ratio of all readings where it is one, and not that of the case.
    pub fn other_ratio(&self, of_case: f64) -> Option<f64> {
        let loads: Vec<&Loads> = self.curves.iter().map(|curve| curve.loads.as_ref()).collect::<Option<_>>()?;
        let one = common(&loads, |loads| &loads.ratio, |_| SAME_RATIO)?;
        ((one - of_case).abs() > SAME_RATIO).then(|| round_off(one))
    }

    /// The same in words.
    pub fn load_words(&self) -> String {
        self.load().iter().map(|(key, value)| format!("{key} = {value}")).collect::<Vec<_>>().join(", ")
    }

    /// Warning of one load of all readings that is not that of the case.
    fn other_load(&self) -> Option<String> {
        let (load, factor) = (self.load_words(), *self.curves.first()?.load_factor.first()?);
        let is_other = !load.is_empty() && !load.starts_with("stress_ratio") && (factor - 1.0).abs() > STATED_DIFFERENCE;
        is_other.then(|| format!("loading: ΔK of the readings ({load}) is used, {factor:.3} times that of the case; correct one"))
    }

    /// Sets the readings against the specimen and the load of a case.
    /// Errors: readings beyond the specimen; loads that it cannot have.
    pub fn compare_with(&mut self, specimen: &Specimen, material: &Material, loading: &Loading) -> Result<()> {
        let problem = "depends on crack length; the load of readings comes from their own columns";
        let remedy = "give one number, and the load of every reading as a column such as force_max_n";
        fail_if!(let Some(course) = loading.course(), input_missing(&course.key, problem, remedy));
        let (limit, limit_name) = specimen.length_limit();
        self.take_whole_lengths(specimen);
        self.exclude_typing_errors();
        self.check_lengths(limit, limit_name)?;
        self.check_half_lengths(specimen)?;
        self.resolve_loads(specimen, loading)?;
        self.warnings.extend(self.other_load());
        self.curves.iter().try_for_each(|curve| compare(curve, specimen, loading))?;
        self.leave_fracture_out(specimen, material, loading)?;
        self.check_sides(specimen);
        Ok(())
    }

    /// Takes lengths tip to tip as they are where those of the specimen are such, too.
    fn take_whole_lengths(&mut self, specimen: &Specimen) {
        let is_whole = specimen.convention == LengthConvention::SumOfTips;
        for curve in self.curves.iter_mut().filter(|curve| is_whole && curve.source.is_tip_to_tip) {
            curve.crack_length.iter_mut().chain(&mut curve.side_difference).for_each(|length| *length *= 2.0);
            curve.source.length_unit *= 2.0;
            curve.source.is_tip_to_tip = false;
        }
    }

    /// Refuses lengths tip to tip of a central crack whose case has the half: a first reading that is twice the crack of the case.
    fn check_half_lengths(&self, specimen: &Specimen) -> Result<()> {
        let is_double =
            |curve: &&MeasuredCurve| (curve.crack_length[0] / specimen.crack_length - 2.0).abs() < STATED_DIFFERENCE / 4.0;
        let double = self.curves.iter().filter(|_| specimen.kind.has_half_length()).find(is_double);
        double.map_or(Ok(()), |curve| {
            let remedy =
                "name a column of full lengths 2a (mm), or give the length at the first reading as specimen.crack_length_mm";
            Err(curve.wrong_length(0, "is the full length 2a; the case uses the half length a", remedy))
        })
    }

    /// Takes readings of the fracture off the ends of the curves: those beyond 0.95 of the plate, those whose K is beyond 1.5 times the
    /// toughness, and, where no toughness is known, a last one whose K is twice that of the one before.
    /// Errors: fewer than [`READINGS_MIN`] readings before it.
    fn leave_fracture_out(&mut self, specimen: &Specimen, material: &Material, loading: &Loading) -> Result<()> {
        let formula = handbook(specimen);
        let (limit, limit_name) = specimen.length_limit();
        let mut left_out = Vec::new();
        for curve in &mut self.curves {
            let k_max = |reading: usize| {
                let factor = curve.load_factor.get(reading).copied().unwrap_or(1.0);
                formula.as_ref().map_or(f64::NAN, |formula| formula.k_i(curve.crack_length[reading], loading.maximum) * factor)
            };
            let is_last = |reading: usize| reading > 0 && reading + 1 == curve.cycles.len();
            let why = |reading: usize| match material.toughness {
                _ if curve.crack_length[reading] > LIGAMENT_LEFT * limit => {
                    Some(format!("{:.3} of the {limit_name}", curve.crack_length[reading] / limit))
                }
                Some(toughness) if k_max(reading) > TOUGHNESS_FACTOR * toughness => {
                    let [k_max, toughness] = [k_max(reading), toughness].map(|k| k / MPA_SQRT_M);
                    Some(format!("K_max {k_max:.1} MPa√m, fracture toughness {toughness:.1} MPa√m"))
                }
                None if is_last(reading) && k_max(reading) > LEAP_OF_K * k_max(reading - 1) && !follows(curve, &k_max) => {
                    let times = k_max(reading) / k_max(reading - 1);
                    Some(format!("K_max is {times:.1} times that of the previous reading, and the growth differs"))
                }
                _ => None,
            };
            let Some((first, why)) = (0..curve.cycles.len()).find_map(|reading| Some((reading, why(reading)?))) else { continue };
            if first < READINGS_MIN {
                let problem = format!("is at fracture ({why}); only {first} readings precede it");
                let remedy = format!("give at least {READINGS_MIN} readings of fatigue growth; check the unit and the load");
                return Err(curve.wrong_length(first, problem, remedy));
            }
            let more = curve.cycles.len() - first - 1;
            let more = if more > 0 { format!(", with the {more} after it") } else { String::new() };
            let (place, length) = (curve.place(first), round_off(curve.crack_length[first] / MM));
            left_out.push(format!("readings: {place}: reading at {length} mm is at fracture ({why}); excluded{more}"));
            *curve = curve.of_readings(&(0..first).collect::<Vec<_>>());
        }
        self.warnings.extend(first_of(left_out));
        Ok(())
    }

    /// Sets the load of every reading against that of the case: [`MeasuredCurve::load_factor`].
    /// Errors: stresses for a specimen that is loaded by a force on pins.
    pub fn resolve_loads(&mut self, specimen: &Specimen, loading: &Loading) -> Result<()> {
        let case_range = loading.maximum * loading.range_share();
        for curve in &mut self.curves {
            let Some(loads) = &curve.loads else { continue };
            let Some(per_load) = nominal_per_load(loads.measure, specimen) else {
                let problem = format!("has loads as stresses, but a {} needs a force on its pins", specimen.kind);
                return Err(curve.fault(0).error(problem, "give columns of force_max and force_min"));
            };
            let factor = |(&load, &ratio): (&f64, &f64)| {
                let ratio = if ratio.is_nan() { loading.ratio } else { ratio };
                let maximum = match loads.is_range {
                    _ if load.is_nan() => loading.maximum / per_load,
                    true => load / (1.0 - ratio),
                    false => load,
                };
                // As for the case, compression does not open a crack.
                maximum * per_load * (1.0 - ratio.max(0.0)) / case_range
            };
            let factors: Vec<f64> = loads.maximum.iter().zip(&loads.ratio).map(factor).collect();
            // Loads of the case as a machine keeps them are those of the case.
            let is_case = factors.iter().all(|factor| (factor - 1.0).abs() < 1e-6);
            curve.load_factor = if is_case { Vec::new() } else { factors };
        }
        Ok(())
    }
}

/// The value that all readings have but for a slack.
fn common(loads: &[&Loads], values: fn(&Loads) -> &Vec<f64>, slack: fn(f64) -> f64) -> Option<f64> {
    let mut all = loads.iter().flat_map(|loads| values(loads)).copied();
    let value = all.next()?;
    // NaN, which stands where the file says nothing, is like nothing.
    all.all(|other| (other - value).abs() <= slack(value)).then_some(value).filter(|value| value.is_finite())
}

/// Warnings of readings at other stress ratios than that of the case, where one law of one ratio is fitted to all.
pub fn ratio_warnings(curves: &[MeasuredCurve], loading: &Loading) -> Vec<String> {
    first_of(curves.iter().filter_map(|curve| ratio_warning(curve, curve.loads.as_ref()?, loading)).collect())
}

/// Whether the growth up to the last reading took the cycles that the power of K of the growth before it says, within a factor
/// [`LEAP_OF_K`].
fn follows(curve: &MeasuredCurve, k_max: &dyn Fn(usize) -> f64) -> bool {
    let last = curve.cycles.len() - 1;
    let rate = |i: usize| (curve.crack_length[i] - curve.crack_length[i - 1]) / (curve.cycles[i] - curve.cycles[i - 1]);
    let middle = |i: usize| (k_max(i) * k_max(i - 1)).sqrt().ln();
    let known: Vec<usize> = (1..last).filter(|&i| rate(i) > 0.0).collect();
    let [x, y]: [Vec<f64>; 2] =
        [&middle as &dyn Fn(usize) -> f64, &|i| rate(i).ln()].map(|of| known.iter().map(|&i| of(i)).collect());
    let Some(law) = line(&x, &y) else { return false };
    // Over a leap of K the mean rate is that of the mean cycles: K between the readings as a power of length.
    let (from, to) = (k_max(last - 1), k_max(last));
    let steps = 64;
    let slowness = |i: usize| (-law.at((from * (to / from).powf((i as f64 + 0.5) / f64::from(steps))).ln())).exp();
    let cycles = (0..steps as usize).map(slowness).sum::<f64>() / f64::from(steps)
        * (curve.crack_length[last] - curve.crack_length[last - 1]);
    let counted = curve.cycles[last] - curve.cycles[last - 1];
    (1.0 / LEAP_OF_K..=LEAP_OF_K).contains(&(counted / cycles))
}

/// Nominal load of the specimen over a load of a file; `None` where a stress is no load of it.
fn nominal_per_load(measure: LoadMeasure, specimen: &Specimen) -> Option<f64> {
    match (measure, specimen.load_measure) {
        (own, of_case) if own == of_case => Some(1.0),
        (LoadMeasure::Force, _) => Some(1.0 / (specimen.width * specimen.thickness)),
        (LoadMeasure::Stress, _) => None,
    }
}

/// Holds what the file says beside its readings against the case.
/// Errors: a size, a smallest load or a ΔK that is another one.
fn compare(curve: &MeasuredCurve, specimen: &Specimen, loading: &Loading) -> Result<()> {
    for stated in &curve.stated {
        let measure = if stated.is_stress { LoadMeasure::Stress } else { LoadMeasure::Force };
        let per_load = nominal_per_load(measure, specimen).unwrap_or(f64::NAN);
        let formula = handbook(specimen);
        let of_case = |reading: usize| match stated.role {
            Role::Width => specimen.width,
            Role::Thickness => specimen.thickness,
            Role::Min => loading.ratio * loading.maximum / per_load,
            _ => {
                let factor = curve.load_factor.get(reading).copied().unwrap_or(1.0);
                let delta_k = |formula: &HandbookFormula| {
                    formula.delta_k(curve.crack_length[reading], loading.maximum, loading.range_share()) * factor
                };
                formula.as_ref().map_or(f64::NAN, delta_k)
            }
        };
        // A smallest load of nothing is compared with the largest.
        let size = |reading: usize| if stated.role == Role::Min { loading.maximum / per_load } else { of_case(reading) };
        let mut apart: Vec<(f64, usize)> = (0..stated.values.len())
            .map(|reading| ((stated.values[reading] - of_case(reading)) / size(reading), reading))
            .filter(|(apart, _)| apart.is_finite())
            .collect();
        if apart.is_empty() {
            continue;
        }
        apart.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (typical, reading) = apart[apart.len() / 2];
        if typical.abs() <= STATED_DIFFERENCE {
            continue;
        }
        let value = round_off(stated.values[reading] / stated.factor).to_string();
        let of_case = round_off(of_case(reading) / stated.factor);
        let fault = Fault { key: Some(&stated.column), value: Some(&value), ..curve.fault(reading) };
        let (length, name) = (curve.crack_length[reading] / MM, &curve.specimen);
        let remedy = "correct the specimen and loading of the case, or correct or remove the column";
        return Err(fault.error(format!("is {of_case} by the case, at {length:.4} mm of specimen {name}"), remedy));
    }
    Ok(())
}

/// Range of load over that of the case along a crack.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadHistory {
    /// Lengths reached, rising, m.
    pub lengths: Vec<f64>,
    /// At the start and the end of the growth up to each of them.
    factors: Vec<(f64, f64)>,
}

impl LoadHistory {
    /// That at which the crack passed a length.
    pub fn at(&self, length: f64) -> f64 {
        let to = self.lengths.partition_point(|&reached| reached < length).min(self.lengths.len().saturating_sub(1));
        let Some(&(start, end)) = self.factors.get(to) else { return 1.0 };
        if to == 0 {
            return end;
        }
        let share = (length - self.lengths[to - 1]) / (self.lengths[to] - self.lengths[to - 1]);
        start + share.clamp(0.0, 1.0) * (end - start)
    }
}

fn ratio_warning(curve: &MeasuredCurve, loads: &Loads, loading: &Loading) -> Option<String> {
    let given = || loads.ratio.iter().copied().filter(|ratio| !ratio.is_nan());
    let (low, high) = (given().fold(f64::INFINITY, f64::min), given().fold(f64::NEG_INFINITY, f64::max));
    let apart = low - loading.ratio < -SAME_RATIO || high - loading.ratio > SAME_RATIO;
    (low <= high && apart).then(|| {
        format!(
            "loading: specimen {}: R of the readings is {low:.3} to {high:.3}; ΔK uses each reading's R, the law is recorded at \
             loading.stress_ratio = {}",
            curve.specimen, loading.ratio
        )
    })
}

impl MeasuredCurve {
    /// Range of load over that of the case at the start and the end of the growth up to each reading; the first reading has its own.
    pub fn step_factors(&self) -> Vec<(f64, f64)> {
        let factor = |i: usize| self.load_factor.get(i).copied().unwrap_or(1.0);
        let same = |i: usize, j: usize| (factor(i) / factor(j) - 1.0).abs() <= SAME_LOAD;
        let last = self.cycles.len().saturating_sub(1);
        let of_step = |i: usize| {
            let held_before = i < 2 || same(i - 2, i - 1);
            let held_after = i == last || same(i, i + 1);
            let is_step = i > 0 && !same(i - 1, i) && held_before && held_after;
            if i == 0 || is_step { (factor(i), factor(i)) } else { (factor(i - 1), factor(i)) }
        };
        (0..self.cycles.len()).map(of_step).collect()
    }

    pub fn load_history(&self) -> LoadHistory {
        let mut history =
            LoadHistory { lengths: Vec::with_capacity(self.cycles.len()), factors: Vec::with_capacity(self.cycles.len()) };
        for (&length, factors) in self.crack_length.iter().zip(self.step_factors()) {
            // Noise in a reading does not heal a crack.
            if history.lengths.last().is_none_or(|&last| length > last) {
                history.lengths.push(length);
                history.factors.push(factors);
            }
        }
        history
    }

    /// Whether the load is the same over some neighbouring readings.
    pub fn holds_load(&self, readings: std::ops::RangeInclusive<usize>) -> bool {
        let Some(factors) = self.load_factor.get(readings) else { return true };
        let (low, high) =
            factors.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &factor| (low.min(factor), high.max(factor)));
        high <= low * (1.0 + SAME_LOAD)
    }
}
