//! K of every tip: along a run, `factors.csv` and `beta.txt` for AFGROW; over crack length, the tables of `perilife sif --sweep`.

use perilife_base::columns::{Table, number_text};
use perilife_base::error::Result;
use perilife_base::units::shown::per;
use perilife_base::units::{MM, MM_PER_CYCLE, MPA, MPA_SQRT_M};
use perilife_growth::case::Case;
use perilife_growth::cracks::steering::equivalent_factor;
use perilife_growth::predict::factor_sweep::{FactorSweep, SweepRow};
use perilife_growth::predict::laws::growth_law;
use perilife_growth::predict::{CurvePoint, GoverningCrack, Prediction};
use perilife_laws::growth_law::GrowthLaw;
use perilife_plate::specimen::LoadMeasure;
use perilife_points::crack_tip::TipState;

pub const FACTORS_FILE: &str = "factors.csv";
/// Table of β over crack length of the tip that grows farthest.
pub const BETA_FILE: &str = "beta.txt";
/// What K of the tips of a run makes of them.
struct Factors<'a> {
    case: &'a Case,
    /// Gross stress at maximum load, Pa, where the load is one.
    stress: Option<f64>,
    /// Length, m, and tips of the crack of every tip; `None` beside a `plate`, and of the end of a slot.
    cracks: Vec<Option<(f64, Vec<usize>)>>,
}

impl<'a> Factors<'a> {
    fn of(case: &'a Case) -> Self {
        let (specimen, maximum) = (&case.specimen, case.loading.maximum);
        let is_plate = specimen.kind.is_plate();
        let of_load = if is_plate {
            specimen.gross_stress(maximum)
        } else {
            (specimen.load_measure == LoadMeasure::Stress).then_some(maximum)
        };
        let lines = specimen.crack_lines();
        let tips = 0..specimen.tips.len();
        let line_of: Vec<Option<usize>> = tips.clone().map(|tip| Some(specimen.line_end(tip)?.line)).collect();
        let crack = |tip: usize| {
            let line = line_of[tip].filter(|_| is_plate)?;
            Some((lines[line].length(), tips.clone().filter(|&other| line_of[other] == Some(line)).collect()))
        };
        Factors {
            case,
            stress: of_load.filter(|_| case.loading.displacement().is_none()),
            cracks: tips.clone().map(crack).collect(),
        }
    }

    /// K_eq at maximum load, Pa√m, NaN where K was not read; none where the load presses the tip shut.
    fn equivalent(point: &CurvePoint, tip: usize) -> f64 {
        let record = &point.tips[tip];
        match record.factors {
            Some(_) if record.state == TipState::Closed => 0.0,
            Some(factors) => equivalent_factor(factors),
            None => f64::NAN,
        }
    }

    /// The a of β, m; NaN for the end face of a slot.
    fn length(&self, point: &CurvePoint, tip: usize) -> f64 {
        if !self.case.specimen.kind.is_plate() {
            return point.crack_length;
        }
        self.cracks[tip].as_ref().map_or(f64::NAN, |(length, tips)| {
            (length + tips.iter().map(|&tip| point.tips[tip].growth).sum::<f64>()) / tips.len() as f64
        })
    }

    /// β = K_eq/(σ √(πa)), NaN where it has no meaning.
    fn beta(&self, point: &CurvePoint, tip: usize) -> f64 {
        let load = self.case.loading.at(point.crack_length) / self.case.loading.maximum;
        let root = (std::f64::consts::PI * self.length(point, tip)).sqrt();
        self.stress.map_or(f64::NAN, |stress| Self::equivalent(point, tip) / (load * stress * root))
    }
}

/// Whether K of a tip was read anywhere in the run: bonds driven by their own strain know none.
pub fn are_known(prediction: &Prediction) -> bool {
    prediction.curve.iter().flat_map(|point| &point.tips).any(|tip| tip.factors.is_some())
}

/// `factors.csv`: one row per tip and row of the curve, tip by tip. K at maximum load; ΔK = (1 - max(R, 0)) K_eq; da/dN is the law at
/// this ΔK (where a kink begins, `a_n.csv` has that of the kink). Cells are empty where K was not read: of a tip that has ended, and
/// where the plate is severed.
///
/// β = K_eq/(σ √(πa)) with the gross stress σ at maximum load, empty where the load is a force or a displacement. Its a, `beta_length_mm`,
/// is the crack length of the specimen's convention for standard kinds. For a `plate` it is half the length of the tip's own crack, kinks
/// included, or its whole length where that has one tip; empty for the end of a slot.
/// Last comes what a crack that did not go through does in the thickness, as tip `depth`.
/// Errors: a law whose rate is not known.
pub fn factors(case: &Case, prediction: &Prediction) -> Result<Table> {
    let (law, of_case) = (growth_law(case)?, Factors::of(case));
    let governing = GoverningCrack::of(&case.specimen, &prediction.curve);
    let of_tip = |tip: usize| {
        let of_row = |point: &CurvePoint| {
            let (record, k_eq) = (&point.tips[tip], Factors::equivalent(point, tip));
            let rate = if k_eq.is_nan() { k_eq } else { law.mean_rate(k_eq, case.loading.ratio, &record.response) };
            let [k_i, k_ii] = record.factors.unwrap_or([f64::NAN; 2]);
            FactorRow {
                tip: tip.to_string(),
                cycles: point.cycles,
                lengths: [governing.length(point), record.growth],
                factors: [k_i, k_ii, k_eq, record.response.range_share(case.loading.ratio) * k_eq],
                beta: [of_case.length(point, tip), of_case.beta(point, tip)],
                rate,
            }
        };
        prediction.curve.iter().map(of_row).collect::<Vec<_>>()
    };
    let rows: Vec<FactorRow> = (0..of_case.cracks.len()).flat_map(of_tip).chain(in_depth(case, prediction, &*law)).collect();
    let column = |of: fn(&FactorRow) -> f64| rows.iter().map(of);
    Ok(Table::new(FACTORS_FILE)
        .words("tip", rows.iter().map(|row| &row.tip))
        .exact("cycles", column(|row| row.cycles))
        .numbers("crack_length_mm", column(|row| row.lengths[0] / MM))
        .numbers("growth_mm", column(|row| row.lengths[1] / MM))
        .numbers("k_i_mpa_sqrt_m", column(|row| row.factors[0] / MPA_SQRT_M))
        .numbers("k_ii_mpa_sqrt_m", column(|row| row.factors[1] / MPA_SQRT_M))
        .numbers("k_eq_mpa_sqrt_m", column(|row| row.factors[2] / MPA_SQRT_M))
        .numbers("delta_k_mpa_sqrt_m", column(|row| row.factors[3] / MPA_SQRT_M))
        .numbers("beta_length_mm", column(|row| row.beta[0] / MM))
        .numbers("beta", column(|row| row.beta[1]))
        .numbers("da_dn_mm_per_cycle", column(|row| row.rate / MM_PER_CYCLE)))
}

/// A row of [`FACTORS_FILE`], SI.
struct FactorRow {
    tip: String,
    cycles: f64,
    /// Of the crack, and growth.
    lengths: [f64; 2],
    /// K_I, K_II, K_eq and ΔK.
    factors: [f64; 4],
    /// Its length and itself.
    beta: [f64; 2],
    rate: f64,
}

/// Rows of the deepest point of a crack that did not go through at the start, as tip `depth`: its own growth, and β with a the depth.
fn in_depth(case: &Case, prediction: &Prediction, law: &dyn GrowthLaw) -> Vec<FactorRow> {
    let stress = Factors::of(case).stress.unwrap_or(f64::NAN);
    let start = case.specimen.part_through.map_or(f64::NAN, |flaw| flaw.depth);
    let of_row = |point: &CurvePoint| {
        let (depth, k_i) = point.depth.and_then(|record| Some((record.depth, record.k_i?)))?;
        Some(FactorRow {
            tip: "depth".to_owned(),
            cycles: point.cycles,
            lengths: [point.crack_length, depth - start],
            factors: [k_i, 0.0, k_i, case.loading.range_share() * k_i],
            beta: [depth, k_i / (stress * (std::f64::consts::PI * depth).sqrt())],
            rate: law.rate(k_i, case.loading.ratio),
        })
    };
    prediction.curve.iter().filter_map(of_row).collect()
}

/// `beta.txt`: lines of a, in the unit that is shown, and β of `factors.csv` for the tip that grows farthest, with a rising: a table as AFGROW
/// takes it for a user-defined β, without a header. `None` where there is no β.
pub fn beta(case: &Case, prediction: &Prediction) -> Option<String> {
    let of_case = Factors::of(case);
    let last = prediction.curve.last()?;
    let lead = (0..of_case.cracks.len()).max_by(|&a, &b| {
        // Of equal ones the first.
        last.tips[a].growth.total_cmp(&last.tips[b].growth).then(b.cmp(&a))
    })?;
    let (mut text, mut longest) = (String::new(), 0.0);
    for point in &prediction.curve {
        let (length, beta) = (of_case.length(point, lead), of_case.beta(point, lead));
        if length > longest && beta > 0.0 {
            text += &format!("{} {}\n", number_text(length / MM * per("mm")), number_text(beta));
            longest = length;
        }
    }
    (!text.is_empty()).then_some(text)
}

/// What stands in the header of such a table, and of no other file.
pub const SIGN: &str = "crack_length_mm,tip,x_mm,y_mm,k_i_mpa_sqrt_m,k_ii_mpa_sqrt_m,t_stress_mpa,beta,cmod_mm";

/// The table of a sweep: a row for every length and tip; cells are empty of what the specimen has not.
pub fn table(sweep: &FactorSweep) -> Table {
    let of = |value: &dyn Fn(&SweepRow) -> Option<f64>| sweep.rows.iter().map(value).collect::<Vec<_>>();
    Table::new("sweep.csv")
        .numbers("crack_length_mm", of(&|row| Some(row.crack_length / MM)))
        .counts("tip", sweep.rows.iter().map(|row| row.tip))
        .numbers("x_mm", of(&|row| Some(row.position[0] / MM)))
        .numbers("y_mm", of(&|row| Some(row.position[1] / MM)))
        .numbers("k_i_mpa_sqrt_m", of(&|row| Some(row.factors[0] / MPA_SQRT_M)))
        .numbers("k_ii_mpa_sqrt_m", of(&|row| Some(row.factors[1] / MPA_SQRT_M)))
        .numbers("t_stress_mpa", of(&|row| Some(row.t_stress? / MPA)))
        .numbers("beta", of(&|row| Some(row.beta)))
        .numbers("cmod_mm", of(&|row| Some(row.mouth_opening? / MM)))
        .numbers("beta_length_mm", of(&|row| Some(row.beta_length / MM)))
        .numbers("load_line_displacement_mm", of(&|row| Some(row.load_line? / MM)))
        .numbers("back_face_strain", of(&|row| row.back_face_strain))
}

/// β of the tip that grows farthest over its own a, as [`perilife_plate::specimen::beta`] reads it.
pub fn beta_table(sweep: &FactorSweep) -> Table {
    let rows = || sweep.rows.iter().filter(|row| row.tip == sweep.lead && row.beta > 0.0);
    Table::new("beta.csv")
        .numbers("crack_length_mm", rows().map(|row| row.beta_length / MM))
        .numbers("beta", rows().map(|row| row.beta))
}
