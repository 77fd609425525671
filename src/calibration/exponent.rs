//! Where the exponent of a fit comes from: fitted, given, or taken from a record because the window does not tell it.

use crate::calibration::fit::DELTA_K_RATIO_MIN;
use crate::case::{Method, fitted_record};
use crate::error::Result;
use crate::input::Folder;

/// The exponent of a calibration before its fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Exponent {
    /// Its value; `None` where it is fitted.
    pub fixed: Option<f64>,
    /// Standard error of a value from a record, else 0.
    pub error: f64,
    /// `fitted`, `given`, `not_identified`, or the file of the record.
    pub source: String,
    /// What the user should know about it.
    pub warning: Option<String>,
}

impl Exponent {
    /// Fitted where the window spans a factor [`DELTA_K_RATIO_MIN`] in ΔK.
    pub fn fitted(delta_k_ratio: f64) -> Self {
        let source = if delta_k_ratio < DELTA_K_RATIO_MIN { "not_identified" } else { "fitted" };
        Exponent { fixed: None, error: 0.0, source: source.to_owned(), warning: None }
    }

    /// Its source once a fit has shown by which factor ΔK varies, as a drawn plate does only then.
    pub fn source_over(&self, delta_k_ratio: f64) -> String {
        match self.fixed {
            None => Self::fitted(delta_k_ratio).source,
            Some(_) => self.source.clone(),
        }
    }

    /// As the file gives it.
    pub fn given(p: f64) -> Self {
        Exponent { fixed: Some(p), error: 0.0, source: "given".to_owned(), warning: None }
    }

    /// Of a record: p, or m for hand calculation.
    pub fn of_record(file: &str, folder: &Folder, method: Method) -> Result<Self> {
        let record = fitted_record(file, folder)?;
        let (p, error) = match method {
            Method::Peridynamics => (record.p, record.p_error),
            Method::Handbook | Method::ElementFreeGalerkin => (record.paris_m, record.paris_m_error),
        };
        Ok(Exponent { fixed: Some(p), error, source: file.to_owned(), warning: None })
    }

    /// The exponent of a record where the window does not tell it, else the fitted one.
    pub fn record_if_needed(file: &str, folder: &Folder, method: Method, delta_k_ratio: f64) -> Result<Self> {
        let of_record = Self::of_record(file, folder, method)?;
        let (p, error) = (of_record.fixed.unwrap_or(f64::NAN), of_record.error);
        if delta_k_ratio < DELTA_K_RATIO_MIN {
            let warning = format!(
                "the fit window spans only a factor {delta_k_ratio:.2} in ΔK (at least {DELTA_K_RATIO_MIN} tells p): \
                 p = {p:.4} ± {error:.4} is taken from {file}"
            );
            return Ok(Exponent { warning: Some(warning), ..of_record });
        }
        let warning = format!("the fit window spans a factor {delta_k_ratio:.2} in ΔK and tells p: {file} is not used");
        Ok(Exponent { warning: Some(warning), ..Self::fitted(delta_k_ratio) })
    }
}
