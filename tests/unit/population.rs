//! The model of a lot on readings that are made: exact laws, known noise, and what a life may be asked of.

use perilife_base::error::Error;
use perilife_base::quadrature::integrate;
use perilife_base::units::{MM, MPA, MPA_SQRT_M};
use perilife_calibration::population::forecast::{Basis, CELLS, Lot, tolerance_factor};
use perilife_calibration::population::intervals::{INTERVALS_MAX, Interval, IntervalReading, Specimen, cells};
use perilife_calibration::population::lots::{BETWEEN_LOTS, DEVIATION, FREEDOM, MEDIAN};
use perilife_calibration::population::student::{normal_cdf, t_quantile};
use perilife_calibration::population::{Population, fit};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// ΔK (Pa√m) of a central crack in a panel under a range of stress (MPa).
fn panel(width: f64, stress: f64) -> impl Fn(f64) -> f64 {
    let pi = std::f64::consts::PI;
    move |a| stress * MPA * (pi * a / (pi * a / width).cos()).sqrt()
}

/// Cycles of a law between two lengths; `rate` in m/cycle of ΔK in MPa√m.
fn cycles(from: f64, to: f64, delta_k: &dyn Fn(f64) -> f64, rate: &dyn Fn(f64) -> f64) -> f64 {
    integrate(|a| 1.0 / rate(delta_k(a) / MPA_SQRT_M), from, to, 1e-12).value
}

/// Readings at lengths (mm) of a crack that follows a law.
fn exact(lengths: &[f64], delta_k: &dyn Fn(f64) -> f64, rate: &dyn Fn(f64) -> f64) -> Vec<IntervalReading> {
    let since = |length: f64| cycles(lengths[0] * MM, length * MM, delta_k, rate);
    lengths.iter().map(|&a| IntervalReading { length: a * MM, cycles: since(a), counts: true }).collect()
}

/// Equally spaced lengths, mm.
fn spaced(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| from + (to - from) * i as f64 / (count - 1) as f64).collect()
}

/// Specimens of `da/dN = C f ΔK^m` with C 1e-11 m/cycle and a factor f each, under loads of their own, read a few times over long growths.
fn sparse_lot(m: f64) -> Vec<Specimen> {
    let lot: [(&[f64], f64, f64); 5] = [
        (&[8.0, 30.0, 50.0], 30.0, 1.0),
        (&[9.0, 20.0, 35.0, 60.0], 45.0, 1.1),
        (&[10.0, 14.0, 25.0, 33.0, 45.0], 60.0, 0.9),
        (&[8.5, 40.0, 62.0], 80.0, 1.2),
        (&[12.0, 28.0, 44.0, 62.0], 38.0, 0.8),
    ];
    let one = |(i, (lengths, stress, factor)): (usize, (&[f64], f64, f64))| {
        let delta_k = panel(152.4 * MM, stress);
        let mut readings = exact(lengths, &delta_k, &|k| 1e-11 * factor * k.powf(m));
        // One reading stands twice in the table, and the cycles of another do too.
        readings.insert(1, readings[1]);
        readings.push(IntervalReading { length: lengths[lengths.len() - 1] * MM + 0.1 * MM, ..readings[readings.len() - 1] });
        Specimen::new(&format!("S{i}"), &readings, &delta_k, INTERVALS_MAX).unwrap()
    };
    lot.into_iter().enumerate().map(one).collect()
}

/// Level of the law `C ΔK^m` (MPa√m) at the pivot of a lot.
fn level_of(lot: &Population, c: f64, m: f64) -> f64 {
    c.ln() + m * (lot.law.pivot / MPA_SQRT_M).ln()
}

#[test]
fn few_exact_readings_over_long_growths_give_their_law() {
    for m in [2.2, 3.0, 4.1] {
        let specimens = sparse_lot(m);
        for count in [1, 2, 5] {
            let lot = fit(&specimens[..count], None).unwrap();
            assert!((lot.law.slope - m).abs() < 2e-4, "{count} specimens: {} for {m}", lot.law.slope);
            for (member, factor) in lot.specimens.iter().zip([1.0, 1.1, 0.9, 1.2, 0.8]) {
                assert!((member.own[1] - m).abs() < 1e-3, "own slope of {}: {:?}", member.name, member.own);
                let level = level_of(&lot, 1e-11 * factor, m);
                assert!((member.level - level).abs() < 1e-3, "{}: {} for {level}", member.name, member.level);
            }
            // Of two intervals and two constants nothing is left to judge their error by.
            assert!(count == 1 || lot.slope_of_readings < 0.01, "{:?}", lot.law);
        }
    }
}

/// Levels of specimens that were read at unlike ΔK are no slope.
#[test]
fn the_slope_is_within_those_of_the_specimens() {
    let lot: [(usize, f64, f64, f64, f64); 4] =
        [(30, 9.0, 25.0, 35.0, 1.0), (25, 24.0, 60.0, 60.0, 1.1), (6, 8.0, 50.0, 45.0, 1.5), (2, 17.0, 65.0, 55.0, 0.7)];
    let one = |(i, (count, from, to, stress, factor)): (usize, (usize, f64, f64, f64, f64))| {
        let delta_k = panel(152.4 * MM, stress);
        let m = [2.95, 2.97, 2.96, 2.96][i];
        let readings = exact(&spaced(from, to, count), &delta_k, &|k| 1e-11 * factor * k.powf(m));
        Specimen::new(&format!("S{i}"), &readings, &delta_k, INTERVALS_MAX).unwrap()
    };
    let lot = fit(&lot.into_iter().enumerate().map(one).collect::<Vec<_>>(), None).unwrap();
    let own: Vec<f64> = lot.specimens.iter().filter(|member| member.intervals > 1).map(|member| member.own[1]).collect();
    let (least, most) = own.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), m| (low.min(*m), high.max(*m)));
    assert!(lot.law.shape.is_none() && (least - 1e-3..=most + 1e-3).contains(&lot.law.slope), "{own:?}: {:?}", lot.law);
}

#[test]
fn the_range_is_that_of_every_specimen_under_its_own_load() {
    let lot = fit(&sparse_lot(3.0), None).unwrap();
    let [low, high] = [panel(152.4 * MM, 30.0)(8.0 * MM), panel(152.4 * MM, 80.0)(62.0 * MM)];
    assert!((lot.law.range[0] / low - 1.0).abs() < 1e-6 && (lot.law.range[1] / high - 1.0).abs() < 1e-6, "{:?}", lot.law);
    assert!(lot.law.range[0] < lot.law.pivot && lot.law.pivot < lot.law.range[1]);
}

#[test]
fn readings_that_tell_no_rate_are_joined() {
    let at = |length: f64, cycles: f64| IntervalReading { length: length * MM, cycles, counts: true };
    let readings =
        [at(10.0, 0.0), at(10.0, 500.0), at(10.5, 900.0), at(10.5, 1000.0), at(11.0, 1000.0), at(10.8, 1400.0), at(11.6, 2000.0)];
    let delta_k = panel(0.1, 50.0);
    let joined = Specimen::new("a", &readings, &delta_k, INTERVALS_MAX).unwrap().intervals;
    let ends: Vec<[f64; 3]> = joined.iter().map(|i| [i.from / MM, i.to / MM, i.cycles]).collect();
    assert_eq!(ends.len(), 3, "{ends:?}");
    for (found, expected) in ends.iter().zip([[10.0, 10.5, 900.0], [10.5, 11.0, 100.0], [11.0, 11.6, 1000.0]]) {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} for {expected:?}");
    }
    // A growth that does not count is in no interval.
    let mut parted = exact(&spaced(10.0, 20.0, 11), &delta_k, &|k| 1e-11 * k.powi(3));
    parted[4].counts = false;
    let parted = Specimen::new("b", &parted, &delta_k, INTERVALS_MAX).unwrap().intervals;
    assert_eq!(parted.len(), 9);
    assert!(parted.iter().all(|i| i.to < 13.1 * MM || i.from > 13.9 * MM));
    // Many readings make few intervals of the same growth and cycles.
    let many = exact(&spaced(10.0, 30.0, 1000), &delta_k, &|k| 1e-11 * k.powi(3));
    let few = Specimen::new("c", &many, &delta_k, INTERVALS_MAX).unwrap().intervals;
    assert!((40..=INTERVALS_MAX).contains(&few.len()), "{}", few.len());
    let sum: f64 = few.iter().map(|i| i.cycles).sum();
    assert!((sum / many[999].cycles - 1.0).abs() < 1e-12);
}

#[test]
fn noise_of_single_readings_is_not_taken_for_growth() {
    let delta_k = panel(0.1, 50.0);
    let mut normal = Normals::new(3);
    let mut readings = exact(&spaced(10.0, 30.0, 400), &delta_k, &|k| 1e-11 * k.powi(3));
    readings.iter_mut().for_each(|reading| reading.length += 0.05 * MM * normal.next());
    let specimen = Specimen::new("a", &readings, &delta_k, INTERVALS_MAX).unwrap();
    assert!(specimen.intervals.iter().all(|i| i.to - i.from > 0.15 * MM));
    let lot = fit(&[specimen], None).unwrap();
    assert!((lot.law.slope - 3.0).abs() < 3.0 * lot.slope_of_readings + 0.01, "{} {:?}", lot.law.slope, lot.law);
    assert!((lot.noise.reading / (0.05 * MM)).ln().abs() < 0.7, "{:?}", lot.noise);
}

#[test]
fn a_load_that_changes_at_a_reading_is_that_of_its_growth() {
    let delta_k = |a: f64| panel(0.1, if a < 20.0 * MM { 40.0 } else { 55.0 })(a);
    let rate = |k: f64| 1e-11 * k.powf(3.3);
    let since =
        |a: f64| cycles(10.0 * MM, a.min(20.0 * MM), &delta_k, &rate) + cycles(20.0 * MM, a.max(20.0 * MM), &delta_k, &rate);
    let readings: Vec<IntervalReading> = [10.0, 13.0, 20.0, 27.0, 33.0]
        .iter()
        .map(|a| IntervalReading { length: a * MM, cycles: since(a * MM), counts: true })
        .collect();
    let lot = fit(&[Specimen::new("a", &readings, &delta_k, INTERVALS_MAX).unwrap()], None).unwrap();
    assert!((lot.law.slope - 3.3).abs() < 1e-3, "{}", lot.law.slope);
}

#[test]
fn a_bent_law_has_its_shape_and_a_power_law_none() {
    let bent = |k: f64| 1e-11 * 12.0_f64.powi(3) * (k / 12.0).powf(if k < 12.0 { 4.5 } else { 2.5 });
    let lot_of = |rate: &dyn Fn(f64) -> f64| {
        let one = |(i, stress): (usize, f64)| {
            let delta_k = panel(0.12, stress);
            let readings = exact(&spaced(8.0 + i as f64, 42.0, 12), &delta_k, rate);
            Specimen::new(&format!("{i}"), &readings, &delta_k, INTERVALS_MAX).unwrap()
        };
        fit(&[40.0, 50.0, 60.0].into_iter().enumerate().map(one).collect::<Vec<_>>(), None).unwrap()
    };
    let lot = lot_of(&bent);
    assert!(lot.law.shape.is_some());
    let [below, above] = [9.0, 22.0].map(|k| {
        let [low, high] = [0.999, 1.001].map(|factor| lot.law.log_rate(factor * k * MPA_SQRT_M));
        (high - low) / (1.001_f64 / 0.999).ln()
    });
    assert!((below - 4.5).abs() < 0.3 && (above - 2.5).abs() < 0.3, "{below} {above}");
    let delta_k = panel(0.12, 45.0);
    let life = lot.forecast(&cells(10.0 * MM, 40.0 * MM, CELLS, &delta_k).unwrap(), None, Lot::Same).unwrap().life();
    let truth = cycles(10.0 * MM, 40.0 * MM, &delta_k, &bent);
    assert!((life.median / truth - 1.0).abs() < 0.02, "{} for {truth}", life.median);
    assert!(lot_of(&|k| 1e-11 * k.powf(3.4)).law.shape.is_none());
}

/// Standard normal numbers, sums of twelve.
struct Normals(ChaCha8Rng);

impl Normals {
    fn new(seed: u64) -> Self {
        Normals(ChaCha8Rng::seed_from_u64(seed))
    }

    fn next(&mut self) -> f64 {
        (0..12).map(|_| self.0.next_u64() as f64 / 2.0_f64.powi(64)).sum::<f64>() - 6.0
    }
}

/// Specimens with scatter between them, noise along the crack that forgets itself over 0.5 mm at 10 MPa√m, and errors of reading.
fn noisy_lot(count: usize, spread: f64, scatter: f64, seed: u64) -> Vec<Specimen> {
    let mut normal = Normals::new(seed);
    let delta_k = panel(0.15, 50.0);
    let (steps, from, growth) = (50, 9.0 * MM, 0.7 * MM);
    let one = |i: usize| {
        let level = spread * normal.next();
        let (mut process, mut sum, mut readings) = (scatter * normal.next(), 0.0, vec![]);
        for step in 0..=steps {
            let a = from + growth * step as f64;
            readings.push(IntervalReading { length: a + 0.05 * MM * normal.next(), cycles: sum, counts: true });
            // Twenty pieces between two readings.
            for piece in 0..20 {
                let middle = a + growth * (f64::from(piece) + 0.5) / 20.0;
                let k = delta_k(middle) / MPA_SQRT_M;
                let memory = (-(growth / 20.0) * (10.0 / k).powi(2) / (0.5 * MM)).exp();
                process = memory * process + (1.0 - memory * memory).sqrt() * scatter * normal.next();
                sum += growth / 20.0 / (1e-11 * k.powi(3) * (level + process).exp());
            }
        }
        Specimen::new(&format!("{i}"), &readings, &delta_k, INTERVALS_MAX).unwrap()
    };
    (0..count).map(one).collect()
}

#[test]
fn noise_and_scatter_that_were_put_in_are_found() {
    let lot = fit(&noisy_lot(14, 0.08, 0.2, 5), None).unwrap();
    // Three standard errors each, of their logarithms, by the second derivatives of the likelihood at its minimum.
    for (name, found, truth, error) in [
        ("scatter between specimens", lot.between.level, 0.08, 0.302),
        ("scatter along the crack", lot.noise.scatter, 0.2, 0.065),
        ("length of the noise", lot.noise.length, 0.5 * MM, 0.165),
        ("errors of reading", lot.noise.reading, 0.05 * MM, 0.121),
    ] {
        assert!((found / truth).ln().abs() < 3.0 * error, "{name}: {found} for {truth}");
    }
    let error = lot.covariance[1][1].sqrt();
    assert!((lot.law.slope - 3.0).abs() < 3.0 * error && error < 0.1, "{} {error}", lot.law.slope);
    assert!(!lot.assumed_scatter && lot.freedom == 13.0);
    assert!(lot.specimens.iter().all(|member| (0.3..2.5).contains(&member.misfit)), "{:?}", lot.specimens);
}

/// Cells from 9 to 40 mm of the plate of [`noisy_lot`].
fn path(from: f64) -> Vec<Interval> {
    cells(from * MM, 40.0 * MM, CELLS, &panel(0.15, 50.0)).unwrap()
}

#[test]
fn own_readings_tell_a_fast_specimen() {
    let lot = fit(&noisy_lot(12, 0.1, 0.1, 6), None).unwrap();
    let plate = panel(0.15, 50.0);
    let rate = |k: f64| 1.2e-11 * k.powi(3);
    let own = Specimen::new("own", &exact(&spaced(9.0, 25.0, 21), &plate, &rate), &plate, INTERVALS_MAX).unwrap();
    let [alike, known] = [None, Some(&own)].map(|own| lot.forecast(&path(25.0), own, Lot::Same).unwrap().life());
    let truth = cycles(25.0 * MM, 40.0 * MM, &plate, &rate);
    assert!((known.median / truth).ln().abs() < 0.4 * (alike.median / truth).ln().abs(), "{known:?} {alike:?} {truth}");
    assert!(known.deviation < 0.8 * alike.deviation, "{known:?} {alike:?}");
    let other = lot.forecast(&path(25.0), None, Lot::Other).unwrap().life();
    assert!((other.deviation.powi(2) - alike.deviation.powi(2) - BETWEEN_LOTS.powi(2)).abs() < 0.004, "{other:?} {alike:?}");
}

/// One specimen: the median scatter of the lots assumed, as that of the lot and of the new one, with six degrees of freedom.
#[test]
fn of_one_specimen_the_scatter_is_assumed() {
    let lot = fit(&noisy_lot(1, 0.0, 0.05, 7), None).unwrap();
    assert!(lot.assumed_scatter && lot.freedom == FREEDOM);
    let half = |which: Lot| {
        let band = lot.forecast(&path(9.0), None, which).unwrap().life().band(0.9);
        0.5 * (band[1] / band[0]).ln()
    };
    assert!((0.31..0.4).contains(&half(Lot::Same)), "{}", half(Lot::Same));
    assert!((0.66..0.76).contains(&half(Lot::Other)), "a factor of two each way: {}", half(Lot::Other));
}

#[test]
fn mean_cycles_do_not_depend_on_the_cells_of_another_plate() {
    let lot = fit(&noisy_lot(12, 0.08, 0.2, 8), None).unwrap();
    let plate = panel(0.6, 35.0);
    let of = |count| lot.forecast(&cells(15.0 * MM, 60.0 * MM, count, &plate).unwrap(), None, Lot::Same).unwrap().life();
    let [coarse, fine] = [of(12), of(150)];
    for probability in [0.05, 0.5, 0.95] {
        let ratio = coarse.quantile(probability) / fine.quantile(probability);
        assert!((ratio - 1.0).abs() < 0.003, "{ratio} at {probability}");
    }
    // A short growth averages over less of the noise.
    let short = lot.forecast(&cells(15.0 * MM, 17.0 * MM, CELLS, &plate).unwrap(), None, Lot::Same).unwrap().life();
    assert!(short.deviation > 1.2 * fine.deviation, "{short:?} {fine:?}");
}

#[test]
fn outside_the_range_a_life_is_wider_and_then_refused() {
    let lot = fit(&noisy_lot(12, 0.08, 0.2, 9), None).unwrap();
    let under = |factor: f64| {
        let plate = panel(0.15, 50.0 * factor);
        lot.forecast(&cells(9.0 * MM, 40.0 * MM, CELLS, &plate).unwrap(), None, Lot::Same)
    };
    let [inside, lower] = [1.0, 0.6].map(|factor| under(factor).unwrap());
    assert!(inside.share_outside == 0.0 && lower.share_outside > 0.5, "{}", lower.share_outside);
    assert!(lower.life().deviation > 1.2 * inside.life().deviation);
    assert!(matches!(lower.basis(Basis::B), Err(Error::Input(_))));
    let refusal = under(0.4).unwrap_err().to_string();
    assert!(refusal.contains("more than a factor 2 outside the tested"), "{refusal}");
    let life = inside.life();
    let [a, b] = [Basis::A, Basis::B].map(|basis| inside.basis(basis).unwrap());
    assert!(a < b && b < life.quantile(0.1) && a < life.quantile(0.01));
    let own = &noisy_lot(1, 0.0, 0.1, 1)[0];
    assert!(lot.forecast(&path(9.0), Some(own), Lot::Same).unwrap().basis(Basis::B).is_err());
    let two = fit(&noisy_lot(2, 0.08, 0.2, 9), None).unwrap();
    let refusal = two.forecast(&path(9.0), None, Lot::Same).unwrap().basis(Basis::B).unwrap_err().to_string();
    assert!(refusal.contains("too few specimens for a basis value"), "{refusal}");
}

#[test]
fn an_exponent_that_readings_do_not_tell_is_asked_for() {
    let delta_k = |_: f64| 12.0 * MPA_SQRT_M;
    let readings: Vec<IntervalReading> = (0..20)
        .map(|i| IntervalReading { length: (10.0 + f64::from(i)) * MM, cycles: 1e4 * f64::from(i), counts: true })
        .collect();
    let specimen = [Specimen::new("a", &readings, &delta_k, INTERVALS_MAX).unwrap()];
    let refusal = fit(&specimen, None).unwrap_err();
    assert!(matches!(&refusal, Error::Mechanics(text) if text.contains("the exponent cannot be determined")), "{refusal}");
    let held = fit(&specimen, Some(2.9)).unwrap();
    assert!((held.law.slope - 2.9).abs() < 1e-9, "{}", held.law.slope);
    assert!((held.law.log_rate(12.0 * MPA_SQRT_M) - 1e-7_f64.ln()).abs() < 1e-4);
    assert!(fit(&[], None).is_err());
    let still = [IntervalReading { length: 0.01, cycles: 0.0, counts: true }; 3];
    assert!(matches!(Specimen::new("b", &still, &delta_k, INTERVALS_MAX), Err(Error::Input(_))));
}

/// Student's t by tables; k of tolerance bounds by those of Owen (1963) and the trial of the model.
#[test]
fn quantiles_are_those_of_tables() {
    assert!((normal_cdf(1.281_551_565_544_6) - 0.9).abs() < 1e-14 && (normal_cdf(-2.326_347_874_040_8) - 0.01).abs() < 1e-14);
    for (probability, freedom, value) in
        [(0.95, 3.0, 2.353_363), (0.975, 10.0, 2.228_139), (0.05, 33.0, -1.692_360), (0.9, 1.0, 3.077_684)]
    {
        assert!((t_quantile(probability, freedom) - value).abs() < 2e-6, "{}", t_quantile(probability, freedom));
    }
    for (specimens, b, a) in [(3, 6.155, 10.55), (5, 3.407, 5.741), (10, 2.355, 3.981), (34, 1.740, 3.007), (100, 1.527, 2.684)] {
        assert!((tolerance_factor(Basis::B, specimens) - b).abs() < 6e-4);
        assert!((tolerance_factor(Basis::A, specimens) - a).abs() < 6e-3);
    }
}

#[test]
fn the_model_goes_through_its_record() {
    let lot = fit(&sparse_lot(3.0), None).unwrap();
    let text = toml::to_string(&lot).unwrap();
    assert_eq!(toml::from_str::<Population>(&text).unwrap(), lot);
}

/// Specimens of a lot, or of a laboratory's tests under one load, and their standard deviation of ln life: of C(T) of 7075 from its coefficient of
/// variation 0.15, of 10Ni steel 2 sd of rate, 27 %.
const LOTS: [(u32, f64); 5] = [(34, 0.071), (26, 0.149), (21, 0.194), (3, 0.052), (15, 0.135)];
/// Mean + 2 sd over mean rate of steels in air, R < 0.5 and R ≥ 0.5 (BS 7910:2013).
const MEAN_PLUS_TWO: [f64; 2] = [1.70, 2.20];

/// Median and scatter of sd over the lots by restricted likelihood on a grid, the freedom by the quantiles of the mixture, and the sd between lots.
#[test]
fn the_assumed_scatter_is_that_of_the_lots() {
    let fit = |tau: f64| {
        let rows = LOTS.iter().map(|(n, deviation)| (deviation.ln(), 1.0 / (tau * tau + 0.5 / f64::from(n - 1))));
        let [sum, all] = rows.clone().fold([0.0; 2], |[sum, all], (x, w)| [sum + x * w, all + w]);
        let of = |(x, w): (f64, f64)| w.ln() - w * (x - sum / all).powi(2);
        (0.5 * rows.map(of).sum::<f64>() - 0.5 * all.ln(), tau, (sum / all).exp())
    };
    let best = (1..400).map(|i| fit(f64::from(i) * 0.0025)).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    assert!((best.1 - DEVIATION).abs() < 0.005 && (best.2 / MEDIAN - 1.0).abs() < 0.01, "{best:?}");
    // P(|Z| e^(τ U) > q) over a grid of U, Z and U normal.
    let q = perilife_calibration::population::student::t_quantile(0.95, FREEDOM);
    let grid = (-600..=600).map(|i| f64::from(i) * 0.01);
    let beyond = |u: f64| 2.0 * (1.0 - normal_cdf(q * (-DEVIATION * u).exp()));
    let (p, all) = grid.fold((0.0, 0.0), |(p, all), u| (p + (-0.5 * u * u).exp() * beyond(u), all + (-0.5 * u * u).exp()));
    assert!((p / all - 0.1).abs() < 0.005, "{}", p / all);
    let squares: f64 = MEAN_PLUS_TWO.iter().map(|ratio| (0.5 * ratio.ln()).powi(2)).sum();
    assert!((BETWEEN_LOTS / (0.5 * squares - MEDIAN * MEDIAN).sqrt() - 1.0).abs() < 0.01);
}
