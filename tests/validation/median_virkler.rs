//! The committed median table is the pointwise median of the measured curves, and a fit to it sees what the full one sees.

use std::fmt::Write as _;
use std::path::Path;

use perilife_base::units::MM;
use perilife_calibration::median::pointwise_median_at;
use perilife_measured::{Import, MeasuredCurve, read};

use crate::support::median::pointwise_median;
use crate::support::shared::shared;

const TABLE: &str = "calibration/al2024-t3/measured/virkler_median.csv";

fn measured() -> Option<Vec<MeasuredCurve>> {
    let path = shared("virkler/virkler.csv")?;
    let measured = read(&[path], &Import::default()).unwrap();
    assert!(measured.warnings.is_empty(), "{:?}", measured.warnings);
    assert_eq!(measured.curves.len(), 34);
    Some(measured.curves)
}

#[test]
fn the_committed_table_is_the_median_every_0_8_mm() {
    let Some(curves) = measured() else { return };
    let lengths: Vec<f64> = (0..=51).map(|i| (9.0 + 0.8 * f64::from(i)) * MM).collect();
    let median = pointwise_median_at(&curves, &lengths).unwrap();
    let mut table = String::from("specimen,cycles,crack_length_mm\n");
    for (cycles, length) in median.cycles.iter().zip(&lengths) {
        writeln!(table, "median,{cycles:.0},{:.1}", length / MM).unwrap();
    }
    let committed = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(TABLE)).unwrap_or_default();
    assert!(committed == table, "{TABLE} should read\n{table}");
}

/// `median.csv` was computed from the same curves by another program.
#[test]
fn the_median_at_every_reading_is_the_shared_one() {
    let (Some(curves), Some(path)) = (measured(), shared("virkler/median.csv")) else { return };
    let theirs = &read(&[path], &Import::default()).unwrap().curves[0];
    let ours = pointwise_median(&curves).unwrap();
    assert_eq!(ours.cycles.len(), 164);
    assert_eq!(ours.cycles, theirs.cycles);
}
