//! Cycles at which readings, and rows of a run, reach a length; several specimens as one curve, the pointwise median of cycles at equal
//! crack length.

use perilife_base::error::{Error, Result, fail_if, input_missing};
use perilife_base::monotone::Monotone;
use perilife_base::units::MM;
use perilife_measured::{MeasuredCurve, READINGS_MIN};

/// Two lengths that differ by less are the same grid point, m.
const SAME_LENGTH: f64 = 1e-9;

/// Cycles at which a measured curve first reaches a crack length (linear between readings), or `None` outside its range.
///
/// Readings that fall back below an earlier one do not count: noise in a reading does not heal a crack.
pub fn cycles_at(curve: &MeasuredCurve, crack_length: f64) -> Option<f64> {
    Rising::of(curve).cycles_at(crack_length)
}

/// The readings of a curve at which it was longer than ever before: what [`cycles_at`] goes by, for many lengths.
pub struct Rising {
    readings: Vec<(f64, f64)>,
}

impl Rising {
    pub fn of(curve: &MeasuredCurve) -> Rising {
        let mut readings: Vec<(f64, f64)> = Vec::with_capacity(curve.cycles.len());
        for (&length, &cycles) in curve.crack_length.iter().zip(&curve.cycles) {
            if readings.last().is_none_or(|&(longest, _)| length > longest) {
                readings.push((length, cycles));
            }
        }
        Rising { readings }
    }

    /// The readings (m, cycles) around a length that lies between two; `None` at a reading, or outside.
    pub(super) fn around(&self, crack_length: f64) -> Option<[(f64, f64); 2]> {
        let place = self.readings.partition_point(|&(a, _)| a < crack_length && (crack_length - a).abs() > SAME_LENGTH);
        let after = *self.readings.get(place).filter(|(a, _)| (crack_length - a).abs() > SAME_LENGTH)?;
        Some([*self.readings.get(place.checked_sub(1)?)?, after])
    }

    pub fn cycles_at(&self, crack_length: f64) -> Option<f64> {
        // The first reading that is as long or longer.
        let place = self.readings.partition_point(|&(a, _)| a < crack_length && (crack_length - a).abs() > SAME_LENGTH);
        let &(a, n) = self.readings.get(place)?;
        if (crack_length - a).abs() <= SAME_LENGTH {
            return Some(n);
        }
        let &(longest, at) = self.readings.get(place.checked_sub(1)?)?;
        Some(at + (n - at) * (crack_length - longest) / (a - longest))
    }
}

/// Median of a non-empty set of numbers: the middle one, or the mean of the two in the middle.
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => sorted[middle],
        _ => 0.5 * (sorted[middle - 1] + sorted[middle]),
    }
}

/// Lengths at which several curves can be compared: their own readings where all were read at the same lengths, else as
/// many equally spaced ones as the curves have readings (median), over the range that all of them cover.
pub fn common_lengths(curves: &[MeasuredCurve]) -> Result<Vec<f64>> {
    let first =
        curves.first().ok_or_else(|| input_missing("measured.files", "contain no curve", "give at least one specimen"))?;
    let same = |curve: &MeasuredCurve| {
        curve.crack_length.len() == first.crack_length.len()
            && curve.crack_length.iter().zip(&first.crack_length).all(|(a, b)| (a - b).abs() <= SAME_LENGTH)
    };
    let rises = first.crack_length.windows(2).all(|pair| pair[1] > pair[0]);
    if rises && curves.iter().all(same) {
        return Ok(first.crack_length.clone());
    }
    let start = curves.iter().filter_map(|curve| curve.crack_length.first().copied()).fold(0.0, f64::max);
    let longest = |curve: &MeasuredCurve| curve.crack_length.iter().copied().fold(0.0, f64::max);
    let end = curves.iter().map(longest).fold(f64::INFINITY, f64::min);
    let problem = "contain specimens whose crack lengths do not overlap: no common median";
    let remedy = "calibrate them one by one, or give curves over the same range";
    fail_if!(end - start <= SAME_LENGTH, input_missing("measured.files", problem, remedy));
    let counts: Vec<f64> = curves.iter().map(|curve| curve.cycles.len() as f64).collect();
    let points = (median(&counts) as usize).max(READINGS_MIN);
    let step = (end - start) / (points - 1) as f64;
    Ok((0..points).map(|point| if point + 1 == points { end } else { start + step * point as f64 }).collect())
}

/// Pointwise median of several curves at given lengths: at each one the median over specimens of the cycles since the
/// first of these lengths. Counting from there matters: specimens start their counters at different lengths.
pub fn pointwise_median_at(curves: &[MeasuredCurve], lengths: &[f64]) -> Result<MeasuredCurve> {
    let mut cycles = Vec::with_capacity(lengths.len());
    let rising: Vec<Rising> = curves.iter().map(Rising::of).collect();
    let starts: Vec<Option<f64>> = rising.iter().map(|curve| curve.cycles_at(*lengths.first()?)).collect();
    for &length in lengths {
        let mut since_start = Vec::with_capacity(curves.len());
        for ((curve, rising), start) in curves.iter().zip(&rising).zip(&starts) {
            match (rising.cycles_at(length), *start) {
                (Some(n), Some(start)) => since_start.push(n - start),
                _ => {
                    let problem = format!("do not reach {:.4} mm in specimen {}", length / MM, curve.specimen);
                    let remedy = "choose lengths that every specimen covers";
                    return Err(input_missing("measured.files", problem, remedy));
                }
            }
        }
        cycles.push(median(&since_start));
    }
    Ok(MeasuredCurve::new("median", cycles, lengths.to_vec()))
}

/// Slack of the ends of a run against readings, m.
const LENGTH_SLACK: f64 = 1e-9;

/// Cycles from the first of `lengths` (m) to each of them, linear between the points (cycles, crack length in m) of a dense table.
/// Errors: a length that the table does not reach.
pub fn cycles_since_first(table: &[(f64, f64)], lengths: &[f64]) -> Result<Vec<f64>> {
    since_first(table, lengths, |before, share| {
        let [from, to] = [table[before].0, table[before + 1].0];
        from + share * (to - from)
    })
}

/// The same of the rows of a run, by a monotone cubic between them: they lie two to four millimetres apart, and on straight lines
/// cycles were up to 1 % off.
/// Errors: a length that the run does not reach.
pub fn cycles_of_run(rows: &[(f64, f64)], lengths: &[f64]) -> Result<Vec<f64>> {
    let table = Monotone::new(rows.iter().map(|(cycles, length)| [*length, *cycles]));
    since_first(rows, lengths, |before, share| table.between(before, share))
}

fn since_first(curve: &[(f64, f64)], lengths: &[f64], between: impl Fn(usize, f64) -> f64) -> Result<Vec<f64>> {
    let at: Vec<f64> = lengths.iter().map(|&length| cycles_reaching(curve, &between, length)).collect::<Result<_>>()?;
    let start = at.first().copied().unwrap_or(0.0);
    Ok(at.into_iter().map(|n| n - start).collect())
}

fn cycles_reaching(curve: &[(f64, f64)], between: impl Fn(usize, f64) -> f64, length: f64) -> Result<f64> {
    let outside = |problem: String| Err(Error::Mechanics(problem));
    let (Some(first), Some(last)) = (curve.first(), curve.last()) else {
        return outside("the run gave no a-N curve".to_owned());
    };
    let mm = |length: f64| length / MM;
    if length <= first.1 {
        if length >= first.1 - LENGTH_SLACK {
            return Ok(first.0);
        }
        return outside(format!("the run starts at {:.4} mm, after the reading at {:.4} mm", mm(first.1), mm(length)));
    }
    let next = curve.partition_point(|point| point.1 < length);
    match curve.get(next) {
        None if length <= last.1 + LENGTH_SLACK => Ok(last.0),
        None => outside(format!("the run ends at {:.4} mm, before the reading at {:.4} mm", mm(last.1), mm(length))),
        Some(&(_, to)) => {
            let from = curve[next - 1].1; // next > 0: the first point lies below `length`
            Ok(between(next - 1, (length - from) / (to - from)))
        }
    }
}

/// Median of the size of a normal quantity over its standard deviation.
pub const NORMAL_MEDIAN: f64 = 0.6745;
/// Standard deviations from the mean beyond which a value counts less (Huber 1964, 95 % efficiency).
const HUBER: f64 = 1.345;
const HUBER_STEPS: usize = 60;

/// Mean of which values far from the median count less; the plain one of fewer than three.
pub fn huber_mean(values: &[f64]) -> f64 {
    let mean = |weight: &dyn Fn(f64) -> f64| {
        values.iter().map(|v| weight(*v) * v).sum::<f64>() / values.iter().map(|v| weight(*v)).sum::<f64>()
    };
    if values.len() < 3 {
        return mean(&|_| 1.0);
    }
    let middle = median(values);
    let deviation = median(&values.iter().map(|v| (v - middle).abs()).collect::<Vec<_>>()) / NORMAL_MEDIAN;
    let limit = (HUBER * deviation).max(f64::MIN_POSITIVE);
    (0..HUBER_STEPS).fold(middle, |at, _| mean(&|v| (limit / (v - at).abs()).min(1.0)))
}
