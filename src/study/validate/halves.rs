//! Replicates: random halves of the specimens of a calibration, each of which predicts the lives of the other half.

use perilife_base::error::{Error, Result, input_missing};
use perilife_calibration::calibrate::Calibration;
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::median::{cycles_at, median};
use perilife_calibration::population::forecast::Life;
use perilife_calibration::population::plate::Plate;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::source::Test;
use super::{Row, Set, mean, record, run};

/// Specimens below which no half says how they scatter.
const SPECIMENS_MIN: usize = 4;
/// Quantiles of a score.
const LEVELS: usize = 100;

/// Fills a row from so many halves.
pub(super) fn fill(set: &Set, row: &mut Row, test: &Test, count: usize) -> Result<()> {
    let Some(Calibration::Lives(whole)) = set.calibration()? else {
        return Err(input_missing("measured.files", "are rates, which have no lives", "give readings of crack length"));
    };
    let specimens = whole.curves.len();
    if specimens < SPECIMENS_MIN {
        let problem = format!("have {specimens} specimens, fewer than the {SPECIMENS_MIN} that two halves need");
        return Err(input_missing("measured.files", problem, "give more specimens, or life_cycles"));
    }
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let (mut predicted, mut measured, mut scores, mut ends) = (Vec::new(), Vec::new(), Vec::new(), [Vec::new(), Vec::new()]);
    let mut lives_inside = 0;
    for _ in 0..count {
        let order = shuffled(specimens, &mut random);
        let (seen, held_out) = order.split_at(specimens / 2);
        let law = record(&Calibration::Lives(Box::new(part(&whole, seen))))?;
        let case = set.case(&test.case, Some(&law))?;
        let (prediction, found) = run(&case)?;
        let plate = Plate::of(&case, &prediction)?.ok();
        let ([low, high], plate) = found.band.zip(plate).ok_or_else(|| Error::Mechanics(format!("{}: no band", test.case)))?;
        let lives = held_out.iter().map(|&place| life(&whole, place, [case.specimen.crack_length, case.stop.crack_length]));
        let lives = lives.collect::<Result<Vec<f64>>>()?;
        scores.extend(self::scores(&plate.whole()?.1.life(), &lives));
        lives_inside += lives.iter().filter(|life| (low..=high).contains(*life)).count();
        row.judge(&found, test)?;
        predicted.push(found.life);
        measured.push(median(&lives));
        ends.iter_mut().zip([low, high]).for_each(|(ends, end)| ends.push(end));
    }
    let square = |(predicted, measured): (&f64, &f64)| (predicted / measured - 1.0).powi(2);
    row.ratio_rms_percent = Some(100.0 * (predicted.iter().zip(&measured).map(square).sum::<f64>() / count as f64).sqrt());
    row.crps_percent = Some(100.0 * scores.iter().sum::<f64>() / scores.len() as f64);
    (row.lives_inside, row.lives_measured) = (Some(lives_inside), scores.len());
    row.put(mean(&predicted), mean(&measured), Some(ends.map(|ends| mean(&ends))));
    Ok(())
}

/// Places in an order by chance (Fisher and Yates).
fn shuffled(count: usize, random: &mut ChaCha8Rng) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    (1..count).rev().for_each(|last| order.swap(last, (random.next_u64() % (last as u64 + 1)) as usize));
    order
}

/// A calibration with some of its specimens.
fn part(whole: &CalibrationCase, places: &[usize]) -> CalibrationCase {
    let mut part = whole.clone();
    part.curves = places.iter().map(|&place| whole.curves[place].clone()).collect();
    part.read.retain(|curve| part.curves.iter().any(|own| own.specimen == curve.specimen));
    part
}

/// Cycles of a specimen between two lengths, m.
fn life(whole: &CalibrationCase, place: usize, [from, to]: [f64; 2]) -> Result<f64> {
    let curve = &whole.curves[place];
    cycles_at(curve, to).zip(cycles_at(curve, from)).map(|(end, start)| end - start).ok_or_else(|| {
        let problem =
            format!("of specimen {} do not reach from the initial crack length of the case to its stop", curve.specimen);
        input_missing("measured.files", problem, "set stop.crack_length_mm of the case to a length that all specimens reach")
    })
}

/// Continuous ranked probability score of each measured life as twice the mean pinball loss over quantiles (Gneiting and Raftery 2007), over
/// that life.
fn scores(life: &Life, measured: &[f64]) -> Vec<f64> {
    let levels = (0..LEVELS).map(|i| (i as f64 + 0.5) / LEVELS as f64);
    let quantiles: Vec<[f64; 2]> = levels.map(|level| [level, life.quantile(level)]).collect();
    let score = |measured: &f64| {
        let loss = |[level, at]: &[f64; 2]| (f64::from(u8::from(measured < at)) - level) * (at - measured);
        2.0 * quantiles.iter().map(loss).sum::<f64>() / (LEVELS as f64 * measured)
    };
    measured.iter().map(score).collect()
}
