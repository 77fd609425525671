//! Time of a calibration over that of one run of its model.

use super::row::{Asked, Row};
use super::variant::DEFAULT;
use super::{Bench, Figure};
use crate::calibration::calibrate::calibrate;
use crate::calibration::case::CalibrationCase;
use crate::calibration::model::ForwardModel;
use crate::calibration::pd_model::PdModel;
use crate::error::Result;
use crate::predict::Silent;
use crate::verify::measured::{CALIBRATION, READINGS, at_hand};

const GROUP: &str = "calibration";
/// Forward runs that a calibration may take.
const ASKED: f64 = 3.5;

/// A and p fitted to the median of 34 panels of 2024-T3.
///
/// # Errors
/// As [`calibrate`].
pub fn median(bench: &mut Bench<'_>) -> Result<()> {
    let spacing = if bench.effort.quick { 3 } else { 1 };
    let text = CALIBRATION.replace("spacing_mm = 1.0", &format!("spacing_mm = {spacing}.0"));
    let text = format!("{text}\n[fatigue]\ndriver = \"bond_strain\"\n");
    let calibration = CalibrationCase::from_text(&text, "al2024-t3", at_hand(READINGS))?;
    let about = format!("Virkler panel, 9 to 49.8 mm, {spacing} mm");
    let (fit, fitted) = bench.time(|| calibrate(&calibration, &Silent))?;
    let row = Row::new(GROUP, &*about, DEFAULT, "fit of A and p to the median of 34 panels", fitted);
    bench.push(Row { note: format!("{} true runs of the model", fit.evaluations), ..row });
    let p = fit.record.constants.p;
    let model = PdModel::new(&calibration.case, &Silent)?;
    let (_, forward) = bench.time(|| model.run(p))?;
    bench.push(Row::new(GROUP, about, "forward run", &format!("one run at the fitted p = {p:.4}"), forward));
    bench.figure(Figure {
        group: GROUP,
        quantity: "fit over one forward run at the fitted p".to_owned(),
        value: fitted.ratio / forward.ratio,
        unit: "",
        asked: Some(Asked::AtMost(ASKED)),
    });
    Ok(())
}
