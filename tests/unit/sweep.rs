//! Sweeps: designs, distributions, and laws that scatter.

use std::path::Path;

use perilife_base::input::{Document, Folder};
use perilife_base::units::{MM, MM_PER_CYCLE};
use perilife_calibration::population::student::normal_cdf;
use perilife_calibration::record::SpecimenRecord;
use perilife_calibration::sweep::distribution::{Distribution, hypercube, normal_quantile, quantile};
use perilife_calibration::sweep::scatter::{LawScatter, SpecimenFits, slope};
use perilife_calibration::sweep::{DrawnCase, Sweep};
use perilife_growth::case::record::FittedRecord;
use perilife_growth::case::{Case, fitted_record};
use perilife_growth::predict::{Silent, predict};

use crate::support::daily::PANEL;
use crate::support::desk::desk;

#[test]
fn every_stratum_is_met_once() {
    for (samples, columns) in [(1, 2), (7, 3), (200, 2)] {
        let rows = hypercube(samples, columns, 42);
        for column in 0..columns {
            let mut strata: Vec<usize> = rows.iter().map(|row| (row[column] * samples as f64) as usize).collect();
            assert!(rows.iter().all(|row| 0.0 < row[column] && row[column] < 1.0));
            strata.sort_unstable();
            assert_eq!(strata, (0..samples).collect::<Vec<_>>());
        }
    }
}

#[test]
fn the_seed_decides() {
    let rows = hypercube(50, 2, 3);
    assert_eq!(rows, hypercube(50, 2, 3));
    assert_ne!(rows, hypercube(50, 2, 4));
    // One more column leaves the others as they are.
    assert!(rows.iter().zip(hypercube(50, 3, 3)).all(|(two, three)| two[..] == three[..2]));
    // The stream is documented: it must stay what it is.
    assert_eq!(hypercube(3, 1, 1).iter().map(|row| (row[0] * 3.0) as usize).collect::<Vec<_>>(), ORDER_OF_SEED_1);
    // Columns are paired at random: 200 pairs correlate by 0.07 or so.
    let rows = hypercube(200, 2, 5);
    let correlation = 12.0 * rows.iter().map(|row| (row[0] - 0.5) * (row[1] - 0.5)).sum::<f64>() / 200.0;
    assert!(correlation.abs() < 0.25, "{correlation}");
}

const ORDER_OF_SEED_1: [usize; 3] = [1, 2, 0];

/// Tables give these (e.g. Wichura 1988); the middle, both sides and both tails of the approximation.
#[test]
fn normal_quantiles() {
    let known = [
        (0.5, 0.0),
        (0.25, -0.674_489_750_196_081_7),
        (0.975, 1.959_963_984_540_054),
        (0.001, -3.090_232_306_167_813_5),
        (1e-20, -9.262_340_089_798_408),
    ];
    for (p, z) in known {
        assert!((normal_quantile(p) - z).abs() <= 4e-16 * f64::max(1.0, z.abs()) * 2.0, "{p}: {}", normal_quantile(p));
    }
    // It is the inverse of the distribution, and odd, everywhere.
    for p in (1..200).map(|i| f64::from(i) / 200.0) {
        assert!((normal_cdf(normal_quantile(p)) - p).abs() < 1e-14);
        assert!((normal_quantile(1.0 - p) + normal_quantile(p)).abs() < 1e-14);
    }
}

#[test]
fn distributions_have_their_quantiles() {
    let at = |distribution: Distribution, p| distribution.quantile(p);
    assert_eq!(at(Distribution::Uniform { from: 2.0, to: 4.0 }, 0.25), 2.5);
    assert!((at(Distribution::LogUniform { from: 1.0, to: 100.0 }, 0.5) - 10.0).abs() < 1e-12);
    let one_sigma = 0.841_344_746_068_542_9;
    assert!((at(Distribution::Normal { mean: 9.0, deviation: 0.5 }, one_sigma) - 9.5).abs() < 1e-14);
    assert!((at(Distribution::LogNormal { median: 8.0, deviation_ln: 2f64.ln() }, one_sigma) - 16.0).abs() < 1e-13);
}

/// Hyndman and Fan's definition 7, as R and NumPy have it by default.
#[test]
fn quantiles_of_a_sample() {
    let sample = [15.0, 20.0, 35.0, 40.0, 50.0];
    for (q, value) in [(0.0, 15.0), (0.05, 16.0), (0.4, 29.0), (0.5, 35.0), (1.0, 50.0)] {
        assert!((quantile(&sample, q) - value).abs() < 1e-12, "{q}");
    }
    assert!(quantile(&[], 0.5).is_nan() && quantile(&[3.0], 0.95) == 3.0);
}

/// Reads the sweep of this design of [`PANEL`].
fn sweep(design: &str) -> perilife_base::error::Result<Sweep> {
    let dir = desk(&[("panel.toml", &PANEL), ("sweep.toml", &format!("case = \"panel.toml\"\n{design}"))]);
    Sweep::with_overrides(Document::read(&dir.path().join("sweep.toml"), &[])?, &[], 1000)
}

fn drawn(design: &str) -> Vec<DrawnCase> {
    sweep(design).and_then(|sweep| sweep.cases()).unwrap()
}

#[test]
fn a_grid_runs_through_the_last_key_first() {
    let cases = drawn(
        "[design]\nkind = \"grid\"\n[[vary]]\nkey = \"specimen.crack_length_mm\"\nvalues = [8.0, 9]\n\
         [[vary]]\nkey = \"loading.stress_range_mpa\"\nfrom = 10\nto = 1000\ncount = 3\nscale = \"log\"\n",
    );
    let values: Vec<Vec<f64>> = cases
        .iter()
        .map(|case| case.values.iter().map(|value| value.as_float().or(value.as_integer().map(|n| n as f64)).unwrap()).collect())
        .collect();
    let expected = [[8.0, 10.0], [8.0, 100.0], [8.0, 1000.0], [9.0, 10.0], [9.0, 100.0], [9.0, 1000.0]];
    for (found, expected) in values.iter().zip(expected) {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    }
    assert_eq!((values.len(), values[2][1], cases[4].label()), (6, 1000.0, "0005".to_owned()));
    let case = cases[4].read().unwrap();
    assert_eq!((case.name.as_str(), case.specimen.crack_length), ("panel_0005", 9.0 * MM));
    // Every input has its hash.
    let mut hashes: Vec<&String> = cases.iter().map(|case| &case.hash).collect();
    hashes.sort();
    hashes.dedup();
    assert_eq!(hashes.len(), 6);
}

#[test]
fn a_random_design_is_reproducible() {
    let design = |seed: u64| {
        format!(
            "[design]\nkind = \"latin_hypercube\"\nsamples = 20\nseed = {seed}\n\
             [[vary]]\nkey = \"specimen.crack_length_mm\"\ndistribution = \"normal\"\nmean = 9\nstandard_deviation = 0.2\n"
        )
    };
    assert_eq!(drawn(&design(1)), drawn(&design(1)));
    assert_ne!(drawn(&design(1)), drawn(&design(2)));
}

fn record() -> FittedRecord {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("calibration/al2024-t3");
    fitted_record("fitted.toml", &Folder::from(folder.as_path())).unwrap()
}

/// The same as a record of hand calculation.
fn record_by_hand() -> FittedRecord {
    let record = record();
    let (m, pivot) = (record.paris_m, record.pivot_delta_k_mpa_sqrt_m);
    let [a, horizon_mm, spacing_mm] = [f64::NAN; 3];
    let rate_at_pivot_mm_per_cycle = record.paris_c_mm_per_cycle * pivot.powf(m);
    let method = "handbook".to_owned();
    FittedRecord { method, rate_constant: None, a, p: m, horizon_mm, spacing_mm, rate_at_pivot_mm_per_cycle, ..record }
}

/// Rate at the pivot by C and m, mm/cycle.
fn rate(record: &FittedRecord) -> f64 {
    record.paris_c_mm_per_cycle * record.pivot_delta_k_mpa_sqrt_m.powf(record.paris_m)
}

#[test]
fn the_middle_of_the_scatter_is_the_record() {
    for record in [record(), record_by_hand()] {
        let drawn = LawScatter::of_constants(record.clone()).unwrap().draw([0.5, 0.5]).unwrap();
        assert_eq!((drawn.p, drawn.paris_m), (record.p, record.paris_m));
        assert!((rate(&drawn) / rate(&record) - 1.0).abs() < 1e-12);
        assert!(record.a.is_nan() || (drawn.a / record.a - 1.0).abs() < 1e-12);
    }
}

/// Sample mean and covariance of pairs.
fn moments(pairs: &[[f64; 2]]) -> ([f64; 2], [[f64; 2]; 2]) {
    let n = pairs.len() as f64;
    let mean = [0, 1].map(|i| pairs.iter().map(|pair| pair[i]).sum::<f64>() / n);
    let of = |i: usize, j: usize| pairs.iter().map(|pair| (pair[i] - mean[i]) * (pair[j] - mean[j])).sum::<f64>() / (n - 1.0);
    (mean, [[of(0, 0), of(0, 1)], [of(1, 0), of(1, 1)]])
}

/// Laws drawn from eight specimens scatter as these do: the rate at the pivot with p, and so ln A with p, whatever the slope
/// between the two is.
#[test]
fn the_scatter_is_that_of_the_specimens() {
    for record in [record(), record_by_hand()] {
        let by_hand = record.a.is_nan();
        let middle = if by_hand { record.paris_c_mm_per_cycle * MM_PER_CYCLE } else { record.a };
        let specimens =
            [(0.05, 0.10), (-0.02, 0.18), (0.08, -0.15), (0.01, 0.02), (-0.06, -0.20), (0.03, -0.05), (-0.1, 0.12), (0.02, 0.0)];
        let at = slope(&record).unwrap();
        let fits = specimens.map(|(rate, p): (f64, f64)| SpecimenRecord {
            a: middle * (rate - at * p).exp(),
            p: record.p + p,
            ..SpecimenRecord::default()
        });
        let of_fits = fits.clone().map(|fit| [fit.a.ln(), fit.p]);
        let scatter = LawScatter::of_specimens(record.clone(), &SpecimenFits { p: record.p, specimens: fits.to_vec() }).unwrap();
        let expected = moments(&specimens.map(|(rate, p)| [record.rate_at_pivot_mm_per_cycle.ln() + rate, record.p + p]));
        for i in 0..2 {
            assert!((scatter.mean[i] - expected.0[i]).abs() < 1e-9);
            assert!((0..2).all(|j| (scatter.covariance[i][j] - expected.1[i][j]).abs() < 1e-9));
        }

        let draws: Vec<FittedRecord> = hypercube(4000, 2, 9).iter().map(|row| scatter.draw([row[0], row[1]]).unwrap()).collect();
        for drawn in &draws {
            // Whatever is drawn, C and m give the rate that was drawn.
            assert!((rate(drawn) / drawn.rate_at_pivot_mm_per_cycle - 1.0).abs() < 1e-12);
        }
        let constant = |drawn: &FittedRecord| if by_hand { drawn.paris_c_mm_per_cycle * MM_PER_CYCLE } else { drawn.a };
        let of_rates = draws.iter().map(|drawn| [drawn.rate_at_pivot_mm_per_cycle.ln(), drawn.p]).collect::<Vec<_>>();
        let of_constants = draws.iter().map(|drawn| [constant(drawn).ln(), drawn.p]).collect::<Vec<_>>();
        for (found, (mean, covariance)) in [(of_rates, expected), (of_constants, moments(&of_fits))] {
            let (found_mean, found_covariance) = moments(&found);
            for i in 0..2 {
                assert!((found_mean[i] - mean[i]).abs() < 0.01 * covariance[i][i].sqrt());
                for j in 0..2 {
                    let size = (covariance[i][i] * covariance[j][j]).sqrt();
                    // The hypercube leaves the pairs to chance: 1/sqrt(4000) = 0.016.
                    assert!(
                        (found_covariance[i][j] - covariance[i][j]).abs() < 0.05 * size,
                        "{found_covariance:?} {covariance:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn too_few_specimens_and_strangers_are_refused() {
    let fits = |p: f64, count: usize| SpecimenFits {
        p,
        specimens: vec![SpecimenRecord { a: 7000.0, p: 3.0, ..SpecimenRecord::default() }; count],
    };
    let refused = |fits: SpecimenFits| LawScatter::of_specimens(record(), &fits).unwrap_err().to_string();
    assert!(refused(fits(record().p, 4)).contains("4 specimens: are too few"));
    assert!(refused(fits(3.1, 9)).contains("differs from the exponent in fit.json"));
    let exact = FittedRecord { rate_at_pivot_relative_error: 0.0, p_error: 0.0, ..record() };
    assert!(LawScatter::of_constants(exact).unwrap_err().to_string().contains("no errors to sample"));
}

/// Cycles from 23 to 31 mm, where ΔK passes the pivot, by this law and method.
fn cycles_about_the_pivot(law: &FittedRecord, method: &str) -> f64 {
    let text = PANEL.split("[fatigue]").next().unwrap().to_owned() + "[stop]\ncrack_length_mm = 33\n";
    let overrides = [
        format!("model.method={method}"),
        "model.spacing_mm=2".to_owned(),
        "specimen.crack_length_mm=20".to_owned(),
        "fatigue.fitted=fitted.toml".to_owned(),
    ];
    let files = [("fitted.toml".to_owned(), toml::to_string(law).unwrap().into_bytes())];
    let document = Document::parse(&text, "pivot", Folder::at_hand(files), &overrides).unwrap();
    let run = predict(&Case::from_document(&document).unwrap(), &Silent).unwrap();
    let cycles_at = |length: f64| {
        let next = run.curve.iter().position(|point| point.crack_length >= length).unwrap();
        let (a, b) = (&run.curve[next - 1], &run.curve[next]);
        a.cycles + (length - a.crack_length) / (b.crack_length - a.crack_length) * (b.cycles - a.cycles)
    };
    cycles_at(31.0 * MM) - cycles_at(23.0 * MM)
}

/// What A and p make of bonds is what C and m make of ΔK: at two standard errors of p either way the plate of bonds grows, against
/// the record, as the drawn C and m say. A slope wrong by 0.1 would show as 1.2 %.
#[test]
fn bonds_grow_at_the_drawn_rate() {
    let scatter = LawScatter::of_constants(record()).unwrap();
    let reference = ["peridynamics", "handbook"].map(|method| cycles_about_the_pivot(&record(), method));
    for probabilities in [[0.977_25, 0.5], [0.022_75, 0.158_7]] {
        let drawn = scatter.draw(probabilities).unwrap();
        assert!((drawn.p - record().p).abs() > 1.8 * record().p_error);
        let [bonds, by_hand] = ["peridynamics", "handbook"].map(|method| cycles_about_the_pivot(&drawn, method));
        let (bonds, by_hand) = (bonds / reference[0], by_hand / reference[1]);
        println!("{probabilities:?}: bonds {bonds:.4}, by hand {by_hand:.4}");
        assert!((bonds / by_hand - 1.0).abs() < 0.01, "{bonds} {by_hand}");
    }
}
