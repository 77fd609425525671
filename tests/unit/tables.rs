//! Data frames against the plain arithmetic they stand beside.

use perilife_base::units::MM;
use perilife_calibration::median::pointwise_median_at;
use perilife_measured::{Import, MeasuredCurve, read};
use perilife_results::frames::{SHARES, cycle_quantiles, fit_curves, specimens, wide};
use perilife_tables::polars::prelude::{ParquetReader, SerReader};
use perilife_tables::{DataFrame, csv, join_by_specimen, parquet, wide_to_long};

use super::misfit::{exact_curve, fit_to, lengths, paris_model};

/// Numbers of a column, gaps as NaN.
fn numbers(table: &DataFrame, name: &str) -> Vec<f64> {
    table.column(name).unwrap().f64().unwrap().iter().map(|value| value.unwrap_or(f64::NAN)).collect()
}

fn some_curves() -> Vec<MeasuredCurve> {
    [2.6, 2.8, 2.9, 3.1, 3.2, 3.3].iter().enumerate().map(|(i, &p)| exact_curve(&format!("S{i}"), 1e-10, p)).collect()
}

#[test]
fn the_median_of_the_frame_is_the_plain_median() {
    for count in [1, 2, 5, 6] {
        let curves = &some_curves()[..count];
        let plain = pointwise_median_at(curves, &lengths()).unwrap();
        let frame = cycle_quantiles(curves, &lengths(), &SHARES).unwrap();
        let medians = numbers(&frame, "cycles_p50");
        assert_eq!(medians.len(), plain.cycles.len());
        for (framed, plain) in medians.iter().zip(&plain.cycles) {
            assert!((framed - plain).abs() <= 1e-9 * plain.abs(), "{count} curves: {framed} against {plain}");
        }
        let (low, high) = (numbers(&frame, "cycles_p05"), numbers(&frame, "cycles_p95"));
        assert!(low.iter().zip(&medians).zip(&high).all(|((low, median), high)| low <= median && median <= high));
    }
}

#[test]
fn wide_to_long_keeps_every_reading_and_leaves_gaps_out() {
    let mut curves = some_curves();
    curves[1].cycles.truncate(20);
    curves[1].crack_length.truncate(20);
    let back = wide_to_long(&wide(&curves, &lengths()).unwrap()).unwrap();
    let cycles: Vec<f64> = curves.iter().flat_map(|curve| curve.cycles.clone()).collect();
    let lengths: Vec<f64> = curves.iter().flat_map(|curve| &curve.crack_length).map(|length| length / MM).collect();
    for (column, direct) in [("cycles", cycles), ("crack_length_mm", lengths)] {
        let back = numbers(&back, column);
        assert_eq!(back.len(), direct.len());
        assert!(back.iter().zip(&direct).all(|(a, b)| (a - b).abs() <= 1e-12 * b.abs()), "{column}");
    }
}

#[test]
fn curves_are_joined_with_the_fit_of_their_specimen() {
    let fit = fit_to(&some_curves()[..3], None, &paris_model()).unwrap();
    let joined = join_by_specimen(&fit_curves(&fit.specimens).unwrap(), &specimens(&fit.specimens).unwrap()).unwrap();
    let names: Vec<&str> = joined.get_column_names().iter().map(|name| name.as_str()).collect();
    assert_eq!(&names[..4], ["specimen", "crack_length_mm", "cycles_measured", "cycles_fitted"]);
    let p = numbers(&joined, "p");
    for (row, specimen) in fit.specimens.iter().enumerate() {
        assert_eq!(p[row * lengths().len()], specimen.constants.p, "{}", specimen.name);
    }
}

#[test]
fn parquet_and_csv_give_back_the_same_curves() {
    let curves = some_curves();
    let folder = tempfile::tempdir().unwrap();
    let check = |name: &str, bytes: Vec<u8>| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        let back = read(&[path], &Import::default()).unwrap().curves;
        assert_eq!(back.len(), curves.len(), "{name}");
        for (back, curve) in back.iter().zip(&curves) {
            assert_eq!(back.specimen, curve.specimen, "{name}");
            assert_eq!(back.cycles, curve.cycles, "{name}: cycles keep every digit");
            let close = back.crack_length.iter().zip(&curve.crack_length).all(|(a, b)| (a - b).abs() < 1e-12 * MM);
            assert!(close, "{name}");
        }
    };
    let table = wide_to_long(&wide(&curves, &lengths()).unwrap()).unwrap();
    let stored = parquet(&table).unwrap();
    assert!(ParquetReader::new(std::io::Cursor::new(stored)).finish().unwrap().equals_missing(&table));
    check("long.csv", csv(&table).unwrap());
    check("wide.csv", csv(&wide(&curves, &lengths()).unwrap()).unwrap());
}
