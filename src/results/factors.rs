//! K of every tip along a run: `factors.csv` for people and programs, `beta.txt` for AFGROW.

use std::fmt::Write as _;

use super::csv::{exact, number};
use perilife_base::error::Result;
use perilife_base::units::{MM, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_growth::case::Case;
use perilife_growth::cracks::steering::equivalent_factor;
use perilife_growth::predict::laws::growth_law;
use perilife_growth::predict::{CurvePoint, GoverningCrack, Prediction};
use perilife_laws::growth_law::GrowthLaw;
use perilife_plate::specimen::LoadMeasure;
use perilife_points::crack_tip::TipState;

/// Table of K of every tip.
pub const FACTORS_FILE: &str = "factors.csv";
/// Table of β over crack length of the tip that grows farthest.
pub const BETA_FILE: &str = "beta.txt";
/// Columns of [`FACTORS_FILE`].
pub const FACTOR_COLUMNS: [&str; 11] = [
    "tip",
    "cycles",
    "crack_length_mm",
    "growth_mm",
    "k_i_mpa_sqrt_m",
    "k_ii_mpa_sqrt_m",
    "k_eq_mpa_sqrt_m",
    "delta_k_mpa_sqrt_m",
    "beta_length_mm",
    "beta",
    "da_dn_mm_per_cycle",
];

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
pub fn factors(case: &Case, prediction: &Prediction) -> Result<String> {
    let (law, of_case) = (growth_law(case)?, Factors::of(case));
    let governing = GoverningCrack::of(&case.specimen, &prediction.curve);
    let mut text = FACTOR_COLUMNS.join(",") + "\n";
    for tip in 0..of_case.cracks.len() {
        for point in &prediction.curve {
            let record = &point.tips[tip];
            let k_eq = Factors::equivalent(point, tip);
            let range_share = record.response.range_share(case.loading.ratio);
            let rate = if k_eq.is_nan() { k_eq } else { law.mean_rate(k_eq, case.loading.ratio, &record.response) };
            let lengths = [governing.length(point), record.growth].map(|length| number(length / MM)).join(",");
            let [k_i, k_ii] = record.factors.unwrap_or([f64::NAN; 2]);
            let known = [k_i, k_ii, k_eq, range_share * k_eq].map(|k| number(k / MPA_SQRT_M)).join(",");
            let beta = [of_case.length(point, tip) / MM, of_case.beta(point, tip)].map(number).join(",");
            // Writing to a String cannot fail.
            let _ = writeln!(text, "{tip},{},{lengths},{known},{beta},{}", exact(point.cycles), number(rate / MM_PER_CYCLE));
        }
    }
    text.push_str(&in_depth(case, prediction, &*law));
    Ok(text)
}

/// Rows of the deepest point of a crack that did not go through at the start, as tip `depth`: its own growth, and β with a the depth.
fn in_depth(case: &Case, prediction: &Prediction, law: &dyn GrowthLaw) -> String {
    let (mut text, stress) = (String::new(), Factors::of(case).stress.unwrap_or(f64::NAN));
    let start = case.specimen.part_through.map_or(f64::NAN, |flaw| flaw.depth);
    for point in &prediction.curve {
        let Some((depth, k_i)) = point.depth.and_then(|record| Some((record.depth, record.k_i?))) else { continue };
        let lengths = [point.crack_length, depth - start].map(|length| number(length / MM)).join(",");
        let known = [k_i, 0.0, k_i, case.loading.range_share() * k_i].map(|k| number(k / MPA_SQRT_M)).join(",");
        let beta = [depth / MM, k_i / (stress * (std::f64::consts::PI * depth).sqrt())].map(number).join(",");
        let rate = law.rate(k_i, case.loading.ratio) / MM_PER_CYCLE;
        // Writing to a String cannot fail.
        let _ = writeln!(text, "depth,{},{lengths},{known},{beta},{}", exact(point.cycles), number(rate));
    }
    text
}

/// `beta.txt`: lines of a, mm, and β of `factors.csv` for the tip that grows farthest, with a rising: a table as AFGROW takes it for
/// a user-defined β, without a header. `None` where there is no β.
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
            let _ = writeln!(text, "{} {}", number(length / MM), number(beta)); // a String takes all
            longest = length;
        }
    }
    (!text.is_empty()).then_some(text)
}
