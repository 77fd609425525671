//! `fit.json`: what a fit found, as it is written, read back and said in words. Units as in the names of keys, cycles else; `null` what is
//! not known.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::case::CalibrationCase;
use super::criterion::Criterion;
use super::fit::{Bonds, Fit};
use super::lack_of_fit::MisfitAtEnds;
use super::laws::case::LawCase;
use super::laws::fit::LawFit;
use super::laws::{FitLaw, LawFits};
use super::population::Population;
use super::results::{record, tidy};
use super::search::{Constants, FittedCurve};
use perilife_base::units::{MM, MM_PER_CYCLE, shown::crack_length, shown::name_of};
use perilife_growth::case::record::{CurveRecord, FittedLaw, SourceFile};
use perilife_laws::FatigueLaw;
use perilife_laws::growth_law::GrowthLawKind;
use perilife_laws::paris::ParisLaw;
use perilife_measured::LeaveOut;

type Figure = Option<f64>;

/// A fit as `fit.json` has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged, try_from = "Value")]
pub enum FitRecord {
    Lives(Box<LivesRecord>),
    Rates(Box<RatesRecord>),
}

/// A fit to lives; keys of `fitted.toml` mean what they mean there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LivesRecord {
    pub a: Figure,
    pub p: f64,
    pub horizon_mm: Figure,
    pub spacing_mm: Figure,
    pub paris_c_mm_per_cycle: f64,
    pub paris_m: f64,
    pub paris_m_error: f64,
    pub pivot_delta_k_mpa_sqrt_m: f64,
    pub rate_at_pivot_mm_per_cycle: f64,
    pub rate_at_pivot_relative_error: Figure,
    pub p_error: f64,
    /// `fitted`, `given`, `not_identified`, or the file of a record.
    pub p_source: String,
    pub criterion: Criterion,
    /// Of (ln A, p).
    pub covariance: [[Figure; 2]; 2],
    /// Relative scatter of the cycles between readings.
    pub increment_scatter: Figure,
    pub rms_life_error: Figure,
    pub life_measured: Figure,
    pub life_fitted: Figure,
    /// Name of the curve that the lives are of: that of a specimen, or `median` or `mean`.
    pub fitted_to: String,
    pub from_crack_length_mm: f64,
    pub to_crack_length_mm: f64,
    pub delta_k_min_mpa_sqrt_m: f64,
    pub delta_k_max_mpa_sqrt_m: f64,
    pub specimens: Vec<SpecimenRecord>,
    pub law: FittedLaw,
    pub curve: Option<CurveRecord>,
    pub misfit_at_ends: MisfitAtEnds,
    pub power_law_misfit_at_ends: Option<MisfitAtEnds>,
    pub population: Option<Population>,
    pub left_out: Vec<LeaveOut>,
    /// Runs that gave K.
    pub evaluations: usize,
    pub wall_s: f64,
    pub warnings: Vec<String>,
    pub version: String,
    pub material: String,
    pub stress_ratio: f64,
    pub sources: Vec<SourceFile>,
    /// What its folder has beside it: test, criteria, plate and provenance.
    #[serde(flatten)]
    pub beside: Value,
}

#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct SpecimenRecord {
    pub name: String,
    /// A at the horizon of the record, 1/cycle; C in m/cycle of a fit without bonds.
    pub a: f64,
    /// p, or m.
    pub p: f64,
    /// C and m that these are.
    pub paris_c_mm_per_cycle: f64,
    pub paris_m: f64,
    pub life_measured: Figure,
    pub life_fitted: Figure,
    pub rms_life_error: Figure,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RatesRecord {
    pub law: GrowthLawKind,
    pub law_asked_for: FitLaw,
    /// Criterion of the next best law less that of the chosen one.
    pub aicc_margin: Figure,
    pub next_best: Option<GrowthLawKind>,
    pub constants: Map<String, Value>,
    pub standard_errors: Map<String, Value>,
    pub rms_log_rate: Figure,
    pub rates: usize,
    pub effective_rates: f64,
    pub stress_ratios: Vec<f64>,
    pub delta_k_min_mpa_sqrt_m: f64,
    pub delta_k_max_mpa_sqrt_m: f64,
    pub candidates: Vec<CandidateRecord>,
    pub material: String,
    pub wall_s: f64,
    pub warnings: Vec<String>,
    pub version: String,
    pub sources: Vec<SourceFile>,
    /// How the tables were read, in words of the summary.
    #[serde(skip)]
    read: Vec<String>,
}

/// One of the laws that were compared.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CandidateRecord {
    pub law: GrowthLawKind,
    pub constants: Map<String, Value>,
    pub standard_errors: Map<String, Value>,
    pub fitted_constants: usize,
    pub rms_log_rate: Figure,
    pub aicc: Figure,
    pub delta_aicc: Figure,
    pub left_out: Option<String>,
}

/// Only fits to rates have candidates: read by that, an error names the key that is wrong.
impl TryFrom<Value> for FitRecord {
    type Error = serde_json::Error;

    fn try_from(value: Value) -> Result<Self, serde_json::Error> {
        match value.get("candidates") {
            Some(_) => serde_json::from_value(value).map(FitRecord::Rates),
            None => serde_json::from_value(value).map(FitRecord::Lives),
        }
    }
}

impl FitRecord {
    /// Lines of a summary, the answer first, and those of a long one.
    pub fn words(&self) -> [Vec<String>; 2] {
        match self {
            FitRecord::Lives(fit) => fit.words(),
            FitRecord::Rates(fit) => fit.words(),
        }
    }
}

fn known(value: f64) -> Figure {
    Some(value).filter(|value| value.is_finite())
}

impl LivesRecord {
    /// That of a fit that took `wall_s` seconds.
    pub fn of(calibration: &CalibrationCase, fit: &Fit, wall_s: f64) -> Self {
        let law = record(calibration, fit);
        let lengths = || fit.record.crack_length.iter().map(|length| tidy(length / MM));
        let modulus = calibration.case.material.plane_modulus();
        let of_curve = |curve| SpecimenRecord::of(curve, fit.bonds, modulus);
        let specimens = fit.specimens.iter().map(of_curve).collect();
        let whole = of_curve(&fit.record);
        LivesRecord {
            a: known(law.a),
            p: law.p,
            horizon_mm: known(law.horizon_mm),
            spacing_mm: known(law.spacing_mm),
            paris_c_mm_per_cycle: law.paris_c_mm_per_cycle,
            paris_m: law.paris_m,
            paris_m_error: law.paris_m_error,
            pivot_delta_k_mpa_sqrt_m: law.pivot_delta_k_mpa_sqrt_m,
            rate_at_pivot_mm_per_cycle: law.rate_at_pivot_mm_per_cycle,
            rate_at_pivot_relative_error: known(law.rate_at_pivot_relative_error),
            p_error: law.p_error,
            p_source: calibration.exponent.source_over(fit.paris.delta_k_max / fit.paris.delta_k_min).to_owned(),
            criterion: calibration.criterion,
            covariance: fit.confidence.covariance.map(|row| row.map(known)),
            increment_scatter: known(fit.confidence.increment_scatter),
            rms_life_error: whole.rms_life_error,
            life_measured: whole.life_measured,
            life_fitted: whole.life_fitted,
            fitted_to: whole.name,
            from_crack_length_mm: lengths().fold(f64::INFINITY, f64::min),
            to_crack_length_mm: lengths().fold(0.0, f64::max),
            delta_k_min_mpa_sqrt_m: law.delta_k_min_mpa_sqrt_m,
            delta_k_max_mpa_sqrt_m: law.delta_k_max_mpa_sqrt_m,
            specimens,
            law: law.law,
            curve: law.curve,
            misfit_at_ends: fit.misfit_at_ends,
            power_law_misfit_at_ends: fit.power_law_misfit,
            population: fit.population.clone(),
            left_out: law.left_out,
            evaluations: fit.own_path.as_ref().map_or(1, |path| path.runs),
            wall_s,
            warnings: calibration.warnings.iter().chain(&fit.warnings).cloned().collect(),
            version: law.version,
            material: law.material,
            stress_ratio: law.stress_ratio,
            sources: law.sources,
            beside: json!({}),
        }
    }

    fn words(&self) -> [Vec<String>; 2] {
        let source = match &*self.p_source {
            "fitted" => String::new(),
            "not_identified" => " (cannot be determined: assumed)".to_owned(),
            "given" => " (given)".to_owned(),
            file => format!(" (from {file})"),
        };
        let error = |error: f64, digits: usize| if error > 0.0 { format!(" ± {error:.digits$}") } else { String::new() };
        let [measured, fitted, rms, rate_error] =
            [self.life_measured, self.life_fitted, self.rms_life_error, self.rate_at_pivot_relative_error]
                .map(|figure| figure.unwrap_or(f64::NAN));
        let life = 100.0 * (fitted / measured - 1.0);
        let [from, to] = [self.from_crack_length_mm, self.to_crack_length_mm].map(|length| crack_length(length * MM));
        let (rate, pivot) = (self.rate_at_pivot_mm_per_cycle, self.pivot_delta_k_mpa_sqrt_m);
        let (c, m) = (self.paris_c_mm_per_cycle, self.paris_m);
        let [low, high] = [self.delta_k_min_mpa_sqrt_m, self.delta_k_max_mpa_sqrt_m];
        let (count, of_law) = (self.specimens.len(), if self.curve.is_some() { "power law of the curve, " } else { "" });
        let (mm, s) = (name_of("mm"), if count == 1 { "" } else { "s" });
        let mut lines = vec![
            format!("{}, R = {}: {of_law}da/dN = {c:.3e} ΔK^{m:.3} (mm/cycle, MPa√m)", self.material, self.stress_ratio),
            format!("  Exponent       m = {m:.3}{}{source}", error(self.paris_m_error, 3)),
            format!("  Rate           {rate:.3e} mm/cycle ± {:.1} % at the reference ΔK = {pivot:.2} MPa√m", 100.0 * rate_error),
            format!("  Tested ΔK      {low:.2} to {high:.2} MPa√m (a = {from} to {to} {mm}, {count} specimen{s})"),
            format!("  Fit            life {life:+.2} %, rms {:.1} % (fitted to {})", 100.0 * rms, self.fitted_to),
        ];
        match (&self.curve, self.population.as_ref().and_then(|population| population.gain)) {
            (Some(curve), _) => lines.extend(self.words_of(curve)),
            (None, Some(gain)) => lines.push(format!("  Selection      Paris: no curve fits better (gain {gain:.1})")),
            (None, None) => {}
        }
        lines.push(format!("  At the ends    {}", self.misfit_at_ends.words()));
        lines.extend(self.left_out.iter().map(|one| format!("  Excluded       {} ({})", one.place(), one.reason)));
        // Fits with handbook K have no bonds: their p is m.
        let of_bonds = self.a.zip(self.horizon_mm).map(|(a, horizon)| {
            format!("  Bonds          A = {a:.4e}, p = {:.3}{} at horizon {horizon:.4} mm", self.p, error(self.p_error, 3))
        });
        let lives = format!("measured {measured:.0}, fitted {fitted:.0} cycles; {:.1} s", self.wall_s);
        let of_lives = format!("  Life           {lives}; ± is one standard error");
        [lines, of_bonds.into_iter().chain([of_lives]).collect()]
    }

    fn words_of(&self, curve: &CurveRecord) -> Vec<String> {
        let misses = |misfit: MisfitAtEnds| format!("; misfit of the power law: {}", misfit.words());
        let (misses, specimens) = (self.power_law_misfit_at_ends.map_or_else(String::new, misses), self.specimens.len());
        let head = format!("  Selection      curve (gain {:.1} over a power law, {specimens} specimens{misses})", curve.gain);
        let row = |i: usize| {
            let (k, rate, error) =
                (curve.delta_k_mpa_sqrt_m[i], curve.da_dn_mm_per_cycle[i], 100.0 * curve.da_dn_relative_error[i]);
            format!("    ΔK {k:>7.3}   da/dN {rate:.3e} ± {error:.1} %   m {:.2} ± {:.2}", curve.m[i], curve.m_error[i])
        };
        std::iter::once(head).chain((0..curve.m.len()).map(row)).collect()
    }
}

impl SpecimenRecord {
    fn of(curve: &FittedCurve, bonds: Option<Bonds>, modulus: f64) -> Self {
        let Constants { a, p } = curve.constants;
        let of_bonds =
            |Bonds { rate_constant, horizon, .. }| ParisLaw::of_bonds(&FatigueLaw { a, p, horizon }, rate_constant, modulus).c;
        SpecimenRecord {
            name: curve.name.clone(),
            a,
            p,
            paris_c_mm_per_cycle: bonds.map_or(a, of_bonds) / MM_PER_CYCLE,
            paris_m: p,
            life_measured: known(curve.life_measured()),
            life_fitted: known(curve.life_fitted()),
            rms_life_error: known(curve.rms_life_error()),
        }
    }
}

impl RatesRecord {
    /// That of a fit that took `wall_s` seconds.
    pub fn of(case: &LawCase, fits: &LawFits, wall_s: f64) -> Self {
        let candidates: Vec<CandidateRecord> =
            fits.candidates.iter().map(|law| CandidateRecord::of(law, fits.least_aicc())).collect();
        let CandidateRecord { law, constants, standard_errors, rms_log_rate, .. } = candidates[fits.chosen].clone();
        let [low, high] = case.delta_k_range();
        let units = case.units.iter().map(|line| format!("  Units          {line}"));
        let range = case.range.map(|range| format!("  ΔK at R < 0    {range}: {}", range.meaning()));
        RatesRecord {
            law,
            law_asked_for: case.law,
            aicc_margin: fits.margin.map(|(_, margin)| margin),
            next_best: fits.margin.map(|(kind, _)| kind),
            constants,
            standard_errors,
            rms_log_rate,
            rates: case.rows.len(),
            effective_rates: fits.effective_rates,
            stress_ratios: case.ratios(),
            delta_k_min_mpa_sqrt_m: low,
            delta_k_max_mpa_sqrt_m: high,
            candidates,
            material: case.material.clone(),
            wall_s,
            warnings: case.warnings.iter().chain(&fits.warnings).cloned().collect(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            sources: case.sources.clone(),
            read: units.chain(range).collect(),
        }
    }

    fn words(&self) -> [Vec<String>; 2] {
        let ratios = self.stress_ratios.iter().map(f64::to_string).collect::<Vec<_>>().join(", ");
        let (low, high) = (self.delta_k_min_mpa_sqrt_m, self.delta_k_max_mpa_sqrt_m);
        let constant = |(key, value): (&String, &Value)| {
            let error = self.standard_errors.get(key);
            let error = error.map_or_else(|| "(given)".to_owned(), |error| format!("± {}", figure(error, 2)));
            format!("    {key:<28} {} {error}", figure(value, 5))
        };
        let next = self.next_best.zip(self.aicc_margin);
        let asked = match (self.law_asked_for, next) {
            (FitLaw(None), Some((_, margin))) if margin < 0.0 => "by its residuals, less than half of the others",
            (FitLaw(None), _) => "lowest AICc",
            _ => "given",
        };
        let margin = match next {
            Some((next, margin)) if margin >= 0.0 => format!("; {next} is {margin:.1} higher{}", strength(margin)),
            Some((next, margin)) => format!("; {next} is {:.1} lower", -margin),
            None => "; no other law could be fitted".to_owned(),
        };
        let rms = self.rms_log_rate.unwrap_or(f64::NAN);
        let mut lines = vec![format!("{}: {} law at R = {ratios}", self.material, self.law)];
        lines.extend(self.constants.iter().map(constant));
        lines.extend([
            format!("  Data           {} rates, ΔK {low:.2} to {high:.2} MPa√m", self.rates),
            format!("  Selection      {asked}{margin}"),
            format!("  Scatter        rms {rms:.3} in ln(da/dN)"),
        ]);
        lines.extend(self.read.iter().cloned());
        let rejected = |law: &CandidateRecord| Some(format!("  Rejected       {}: {}", law.law, law.left_out.as_ref()?));
        lines.extend(self.candidates.iter().filter_map(rejected));
        let fitted = self.candidates.iter().filter(|law| law.left_out.is_none());
        let details = fitted.map(|law| {
            let [rms, delta] = [law.rms_log_rate, law.delta_aicc].map(|figure| figure.unwrap_or(f64::NAN));
            format!("  {:<14} {} constants, rms {rms:.3} in ln(da/dN), ΔAICc {delta:.1}", law.law, law.fitted_constants)
        });
        [lines, details.chain(["  ±              one standard error".to_owned()]).collect()]
    }
}

impl CandidateRecord {
    fn of(law: &LawFit, least_aicc: f64) -> Self {
        let error = |constant: &super::laws::fit::Constant| Some((constant.key.to_owned(), json!(constant.error?)));
        CandidateRecord {
            law: law.kind,
            constants: law.known_constants().map(|constant| (constant.key.to_owned(), json!(constant.value))).collect(),
            standard_errors: law.constants.iter().filter_map(error).collect(),
            fitted_constants: law.fitted,
            rms_log_rate: known(law.rms()),
            aicc: known(law.aicc),
            delta_aicc: known(law.aicc - least_aicc),
            left_out: law.left_out.clone(),
        }
    }
}

/// What a difference of the criterion is worth (Burnham and Anderson 2002).
fn strength(margin: f64) -> &'static str {
    match margin {
        margin if margin < 2.0 => " (no clear difference)",
        margin if margin > 10.0 => "",
        _ => " (some evidence)",
    }
}

fn figure(value: &Value, digits: usize) -> String {
    let value = value.as_f64().unwrap_or(f64::INFINITY);
    if value != 0.0 && !(1e-3..1e4).contains(&value.abs()) {
        return format!("{value:.*e}", digits - 1);
    }
    let before = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    format!("{value:.*}", (digits as i32 - 1 - before).max(0) as usize)
}
