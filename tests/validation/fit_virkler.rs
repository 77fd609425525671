//! The calibration on real curves, with hand calculation (Paris growth, handbook K) in the place of the peridynamic model:
//! what the search, the specimens and the confidence do on real scatter, in a second.

use perilife_base::units::{MM, MPA};
use perilife_calibration::criterion::Criterion;
use perilife_calibration::fit::{Fit, FitTask, fit};
use perilife_calibration::power_law::PowerLaw;
use perilife_measured::{Import, Measured, read};

use crate::support::shared::shared;

pub fn delta_k(a: f64) -> f64 {
    let pi = std::f64::consts::PI;
    48.28 * MPA * (pi * a / (pi * a / (152.4 * MM)).cos()).sqrt()
}

fn fit_to(file: &str, criterion: Criterion) -> Option<Fit> {
    let measured = read(&[shared(file)?], &Import::default()).unwrap();
    measured.check_lengths(76.2 * MM, "half width").unwrap();
    let Measured { curves, .. } = measured.window(Some(9.0 * MM), Some(49.8 * MM)).unwrap();
    let model = PowerLaw::new(9.0 * MM, 49.8 * MM, &delta_k).unwrap();
    Some(fit(&FitTask { curves: &curves, fixed_p: None, criterion, delta_k: &delta_k }, &model).unwrap())
}

#[test]
fn the_median_is_fitted_to_one_percent_of_life() {
    let Some(fit) = fit_to("virkler/median.csv", Criterion::BothEnds) else { return };
    println!("{:?}\n{:?} rms {}", fit.record.constants, fit.paris, fit.record.rms_life_error());
    println!("{:?}, p ± {}", fit.confidence, fit.p_error());
    assert!(fit.record.rms_life_error() < 0.02);
    assert!((fit.record.life_fitted() / fit.record.life_measured() - 1.0).abs() < 0.025);
    assert!((2.7..3.3).contains(&fit.paris.m), "m = {}", fit.paris.m);
    // The rate there by fits of rates and of life: 9.40e-5 to 9.63e-5 mm/cycle at 11.4 MPa√m.
    let rate = fit.paris.c * 11.4_f64.powf(fit.paris.m);
    assert!((9.3e-5..9.8e-5).contains(&rate), "rate at 11.4: {rate}");
}

/// `m_integrated` and `log10C_integrated` of `paris_fits.csv` are plain least squares on the integrated curve of each specimen.
#[test]
fn every_specimen_gets_the_constants_of_an_independent_fit() {
    let (Some(fit), Some(fits)) = (fit_to("virkler/virkler.csv", Criterion::FirstReading), shared("virkler/paris_fits.csv"))
    else {
        return;
    };
    let mut reader = csv::Reader::from_path(fits).unwrap();
    for (row, specimen) in reader.deserialize::<std::collections::HashMap<String, String>>().zip(&fit.specimens) {
        let row = row.unwrap();
        assert_eq!(row["specimen"], specimen.name);
        let number = |column: &str| row[column].parse::<f64>().unwrap();
        let (m, rms) = (number("m_integrated"), number("rms_rel_integrated"));
        println!(
            "{}: p {:.4} against {m}, rms {:.5} against {rms}",
            specimen.name,
            specimen.constants.p,
            specimen.rms_life_error()
        );
        assert!((specimen.constants.p - m).abs() < 0.02, "{}: p {} against {m}", specimen.name, specimen.constants.p);
        assert!(
            (specimen.rms_life_error() - rms).abs() < 1e-3,
            "{}: rms {} against {rms}",
            specimen.name,
            specimen.rms_life_error()
        );
        assert!((specimen.life_measured() - number("cycles_to_49_8mm")).abs() < 0.5);
    }
}
