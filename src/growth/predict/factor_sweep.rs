//! K, T, β and compliance of growing cracks over crack length, for `perilife sif --sweep`.
//!
//! K is that of a prediction: of a handbook at every length, else of a run in which the cracks grow along their own path by K^3
//! ([`factor_curve`](super::factor_curve)), smooth between its rows. At every length the plate is then solved on nodes with its cracks as
//! they stand there, which gives what nobody needs for growth:
//! ```text
//! CMOD   opening of the flanks, across the crack, at its mouth: on the rim that it starts from, or in the middle of a crack with two tips
//! v_LL   displacement of the load: of C(T) the opening of the flanks on the load line; else (Σ f u)/P, that on which the loads do their work
//! ε_BF   strain along y at the back face ahead of an edge crack: of C(T) and SE(T), over a gauge of W/50
//! ```

use std::f64::consts::PI;

use rayon::prelude::*;

use super::factor_curve::{EXPONENT_USUAL, TipFactors, solved, unit_growth};
use super::moment::{grown, rows_before_meeting};
use super::{CurvePoint, GoverningCrack, Observer};
use crate::CrackGrowth;
use crate::case::{Case, Engine};
use crate::cracks::steering::equivalent_factor;
use crate::cracks::{CrackedPlate, Cracks};
use crate::nodes::NodePlate;
use perilife_base::blended::Blended;
use perilife_base::error::{Error, Result, input, input_missing};
use perilife_base::units::{MM, round_mm};
use perilife_laws::growth_law::Walker;
use perilife_laws::paris::ParisLaw;
use perilife_plate::loading::LoadControl;
use perilife_plate::specimen::geometry::{along, direction, distance, distance_to_segment};
use perilife_plate::specimen::handbook::handbook;
use perilife_plate::specimen::{CrackLine, LengthConvention, LoadMeasure, Point, Specimen, SpecimenKind};

/// Distance from a crack face at which it is read, over the crack length: at its end, and between its ends.
const BESIDE: [f64; 2] = [1e-4, 1e-3];
/// Way of a mouth into the material at which it is read, over the length of the crack: both flanks are then in the plate, up to 60° of slant.
const INSIDE: f64 = 2e-4;
/// Gauge on the back face over the width.
const GAUGE: f64 = 0.02;
/// Share by which K_eq of two tips may differ that are alike.
const ALIKE: f64 = 0.01;
/// `fatigue.step_error_percent` of the run at the most: K between its rows is then right to 0.2 % (test).
const STEP_ERROR_PERCENT: f64 = 0.02;
/// Share of a length within which two are the same.
const SAME: f64 = 1e-9;

/// One tip at one crack length, at maximum load.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepRow {
    /// Crack length in the specimen's convention, m.
    pub crack_length: f64,
    /// Its place in `Specimen::tips`.
    pub tip: usize,
    /// Where it stands, m.
    pub position: Point,
    /// K_I and K_II, Pa√m.
    pub factors: [f64; 2],
    /// Stress along the crack, Pa.
    pub t_stress: Option<f64>,
    /// The a of β, m: the crack length, of a `plate` the length of its own crack over its tips.
    pub beta_length: f64,
    /// K_eq/(σ √(πa)), σ as [`Specimen::beta_stress`].
    pub beta: f64,
    /// CMOD of its crack, m.
    pub mouth_opening: Option<f64>,
    /// v_LL, m; `None` of a plate under stress.
    pub load_line: Option<f64>,
    pub back_face_strain: Option<f64>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct FactorSweep {
    /// Length by length, tip by tip.
    pub rows: Vec<SweepRow>,
    /// The tip that grows farthest, whose β is that of the plate.
    pub lead: usize,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// K of a case, whose crack is as long as the first of these lengths or a `plate` shorter, m, rising, and what takes a solve at every length
/// if `has_compliance`.
/// Errors: cracks that are none, lengths that the crack does not reach, displacement in place of load; as [`super::predict`].
pub fn factor_sweep(case: &Case, lengths: &[f64], has_compliance: bool, observer: &dyn Observer) -> Result<FactorSweep> {
    let case = &ready(case, lengths)?;
    let mut warnings = Vec::new();
    let stands = if case.engine() == Engine::Handbook {
        by_formula(case, lengths, &mut warnings)?
    } else {
        by_run(case, lengths, observer, &mut warnings)?
    };
    let compliance = |stand: &Stand| has_compliance.then(|| Compliance::of(case, stand)).transpose();
    let found = stands.par_iter().map(compliance).collect::<Result<Vec<_>>>()?;
    let mut rows = Vec::new();
    for ((Stand { specimen, factors, t_stress }, length), compliance) in stands.iter().zip(lengths).zip(found) {
        let beside = compliance.as_ref();
        for (tip, seed) in specimen.tips.iter().enumerate() {
            let beta_length = beta_length(specimen, tip);
            let stress = specimen.beta_stress(case.loading.maximum);
            rows.push(SweepRow {
                crack_length: *length,
                tip,
                position: seed.position,
                factors: factors[tip],
                t_stress: t_stress[tip].or(beside.and_then(|found| found.t_stress[tip])),
                beta_length,
                beta: equivalent_factor(factors[tip]) / (stress * (PI * beta_length).sqrt()),
                mouth_opening: beside.and_then(|found| found.mouths[tip]),
                load_line: beside.and_then(|found| found.load_line),
                back_face_strain: beside.and_then(|found| found.back_face_strain),
            });
        }
    }
    let tips = case.specimen.tips.len();
    let lead = lead(&rows, tips);
    warnings.extend(unlike(&rows, tips, lead));
    Ok(FactorSweep { rows, lead, warnings })
}

/// The case without ends other than the last length.
fn ready(case: &Case, lengths: &[f64]) -> Result<Case> {
    const KEY: &str = "--sweep";
    let (specimen, [first, .., last]) = (&case.specimen, lengths) else {
        return Err(input_missing(KEY, "needs two lengths or more", "give first:last:step in mm, such as 10:40:1"));
    };
    if !specimen.is_through() || !specimen.has_sharp_tips() {
        let problem = "needs sharp cracks through the thickness, and tips of every one of them";
        return Err(input_missing(KEY, problem, format!("remove it, or give {}", specimen.crack_key())));
    }
    if specimen.crack_pressure > 0.0 {
        let problem = "goes with --sweep no more than cycles of a displacement: β is K over the stress of a load";
        return Err(input_missing("loading.crack_pressure_mpa", problem, "leave --sweep out: K under pressure is that of `sif`"));
    }
    if case.loading.control != LoadControl::Load {
        let problem = "needs one load on edges or holes: β is K over its stress";
        return Err(input_missing(KEY, problem, "give loading.stress_max_mpa or force_max_n"));
    }
    let start = specimen.shortest_crack();
    if *first < start * (1.0 - SAME) {
        let problem = format!("begins below the initial crack length {} mm of the plate", round_mm(start));
        return Err(input(KEY, round_mm(*first), problem, format!("begin there, or give a smaller {}", specimen.crack_key())));
    }
    let (limit, name) = specimen.length_limit();
    if specimen.convention == LengthConvention::MeanOfTips && *last >= limit {
        return Err(input(KEY, round_mm(*last), format!("is beyond the {name} {} mm", round_mm(limit)), "end before"));
    }
    let mut case = case.clone();
    (case.stop.crack_length, case.stop.required) = (*last, None);
    (case.stop.by_toughness, case.stop.by_net_section) = (false, false);
    // A life takes longer steps than a table of K.
    case.fatigue.step_error_percent = case.fatigue.step_error_percent.min(STEP_ERROR_PERCENT);
    Ok(case)
}

/// The plate at one of the lengths.
struct Stand {
    specimen: Specimen,
    factors: Vec<[f64; 2]>,
    t_stress: Vec<Option<f64>>,
}

fn by_formula(case: &Case, lengths: &[f64], warnings: &mut Vec<String>) -> Result<Vec<Stand>> {
    let none = || input_missing("model.method", "has no K(a) for this specimen", "remove it");
    let formula = handbook(&case.specimen).ok_or_else(none)?;
    case.specimen.beta.as_ref().map_or(Ok(()), |table| table.check_end(lengths[lengths.len() - 1]))?;
    let outside = lengths.iter().filter(|length| !formula.holds_at(**length)).count();
    if outside > 0 {
        warnings.push(format!(
            "formula range: {outside} of {} lengths lie outside the range of {} ({})",
            lengths.len(),
            formula.name,
            formula.range
        ));
    }
    let tips = case.specimen.tips.len();
    let stand = |&length: &f64| Stand {
        specimen: case.specimen.grown_alike(length),
        factors: vec![[formula.k_i(length, case.loading.maximum), 0.0]; tips],
        t_stress: vec![None; tips],
    };
    Ok(lengths.iter().map(stand).collect())
}

/// The plate as a run leaves it, K and T of its rows smooth in between.
fn by_run(case: &Case, lengths: &[f64], observer: &dyn Observer, warnings: &mut Vec<String>) -> Result<Vec<Stand>> {
    let run = unit_growth(case, EXPONENT_USUAL, observer)?;
    warnings.extend(run.warnings);
    let mut rows = rows_before_meeting(&run.curve).to_vec();
    let governing = GoverningCrack::of(&case.specimen, &run.curve);
    rows.iter_mut().for_each(|row| row.crack_length = governing.length(row));
    rows.dedup_by(|next, before| next.crack_length <= before.crack_length);
    let last = lengths[lengths.len() - 1];
    let reached = rows.last().map_or(0.0, |row| row.crack_length);
    if rows.len() < 2 || reached < last * (1.0 - SAME) {
        return Err(Error::Mechanics(format!(
            "{}: a tip has met an edge, a hole or a crack at a length of {:.3} mm, before {:.3} mm: end --sweep there",
            case.name,
            reached / MM,
            last / MM
        )));
    }
    let tips: Vec<TipCurves> = (0..case.specimen.tips.len()).map(|tip| TipCurves::of(&rows, tip)).collect();
    let stand = |&length: &f64| Stand {
        specimen: grown(&case.specimen, &up_to(&rows, length)),
        factors: tips.iter().map(|tip| tip.factors(length)).collect(),
        t_stress: tips.iter().map(|tip| Some(tip.t_stress.at(length)).filter(|t| t.is_finite())).collect(),
    };
    Ok(lengths.iter().map(stand).collect())
}

/// K and T of a tip between the rows of a run.
struct TipCurves {
    /// K_eq, which the growth follows.
    equivalent: TipFactors,
    /// Angle of K_II over K_I, rad.
    angle: Blended,
    t_stress: Blended,
}

impl TipCurves {
    fn of(rows: &[CurvePoint], tip: usize) -> Self {
        let factors = |row: &CurvePoint| row.tips[tip].factors.unwrap_or([f64::NAN; 2]);
        let over_length =
            |value: &dyn Fn(&CurvePoint) -> f64| Blended::new(solved(rows).map(|row| (row.crack_length, value(row))));
        TipCurves {
            equivalent: TipFactors::new(solved(rows).map(|row| (row.crack_length, equivalent_factor(factors(row))))),
            angle: over_length(&|row| factors(row)[1].atan2(factors(row)[0])),
            t_stress: over_length(&|row| row.tips[tip].t_stress.unwrap_or(f64::NAN)),
        }
    }

    /// K_I and K_II at a length, m; NaN around rows in which the load presses the tip shut.
    fn factors(&self, length: f64) -> [f64; 2] {
        let (sin, cos) = self.angle.at(length).sin_cos();
        let scale = self.equivalent.at(length) / equivalent_factor([cos, sin]);
        [scale * cos, scale * sin]
    }
}

/// The rows up to a length, the last one there.
fn up_to(rows: &[CurvePoint], length: f64) -> Vec<CurvePoint> {
    let after = rows.partition_point(|row| row.crack_length < length * (1.0 - SAME)).clamp(1, rows.len() - 1);
    let (before, next) = (&rows[after - 1], &rows[after]);
    let share = ((length - before.crack_length) / (next.crack_length - before.crack_length)).clamp(0.0, 1.0);
    let mut passed = rows[..after].to_vec();
    passed.push(CurvePoint { is_solved: true, crack_length: length, ..next.clone().between(before, share) });
    passed
}

/// The a of β of a tip, m.
fn beta_length(specimen: &Specimen, tip: usize) -> f64 {
    let lines = specimen.crack_lines();
    match specimen.line_end(tip).filter(|_| specimen.kind == SpecimenKind::Plate) {
        Some(end) => lines[end.line].length() / specimen.tips_of(&lines[end.line]).max(1) as f64,
        None => specimen.crack_length,
    }
}

/// The tip whose crack has grown most from the first length to the last; of equal ones the first.
fn lead(rows: &[SweepRow], tips: usize) -> usize {
    let (first, last) = (&rows[..tips], &rows[rows.len() - tips..]);
    let gone = |tip: usize| {
        let [from, to] = [first[tip].position, last[tip].position];
        (to[0] - from[0]).hypot(to[1] - from[1])
    };
    (1..tips).fold(0, |lead, tip| if gone(tip) > gone(lead) * (1.0 + 1e-6) { tip } else { lead })
}

/// Warning of tips with different K.
fn unlike(rows: &[SweepRow], tips: usize, lead: usize) -> Option<String> {
    let differs = |rows: &[SweepRow]| {
        let of_lead = equivalent_factor(rows[lead].factors);
        rows.iter().any(|row| (equivalent_factor(row.factors) / of_lead - 1.0).abs() > ALIKE)
    };
    rows.chunks(tips).any(differs).then(|| {
        format!(
            "tips: tips have different K: grown with m = {EXPONENT_USUAL}; the table holds β of tip {lead}, and a life from it grows all tips equally"
        )
    })
}

/// What the plate on nodes says at one length.
struct Compliance {
    t_stress: Vec<Option<f64>>,
    mouths: Vec<Option<f64>>,
    load_line: Option<f64>,
    back_face_strain: Option<f64>,
}

impl Compliance {
    fn of(case: &Case, stand: &Stand) -> Result<Self> {
        let case = &Case { specimen: stand.specimen.clone(), ..case.clone() };
        let law = Walker { paris: ParisLaw { c: 1.0, m: 1.0 }, gamma: 1.0, threshold: 0.0 };
        let mut cracks = Cracks::<NodePlate>::start(case, Box::new(law))?;
        cracks.open()?;
        let (specimen, plate) = (&case.specimen, &cracks.plate);
        let lines = specimen.crack_lines();
        let opening = |line: &CrackLine, (at, share): (Point, f64)| {
            let beside = flanks(line, at, share)?;
            let [left, right] = [plate.displacement(case, beside.0[0])?, plate.displacement(case, beside.0[1])?];
            Some((left[0] - right[0]) * beside.1[0] + (left[1] - right[1]) * beside.1[1])
        };
        let mouth = |tip: usize| {
            let line = &lines[specimen.line_end(tip)?.line];
            opening(line, mouth(specimen, line))
        };
        let is_compact = specimen.kind == SpecimenKind::CompactTension;
        let load = match specimen.load_measure {
            LoadMeasure::Force => Some(case.loading.maximum),
            LoadMeasure::Stress if specimen.kind == SpecimenKind::Plate || case.loading.parallel_ratio != 0.0 => None,
            LoadMeasure::Stress => Some(case.loading.maximum * specimen.width * specimen.thickness),
        };
        Ok(Compliance {
            t_stress: cracks.now().tips.iter().map(|tip| tip.t_stress).collect(),
            mouths: (0..specimen.tips.len()).map(mouth).collect(),
            load_line: if is_compact { opening(&lines[0], ([0.0; 2], BESIDE[1])) } else { load.map(|load| plate.work() / load) },
            back_face_strain: back_face_strain(case, plate),
        })
    }
}

/// Two places on the flanks of a crack at a place on it, left and right of it by a share of its length, and the unit vector from right to left.
fn flanks(line: &CrackLine, at: Point, share: f64) -> Option<([Point; 2], Point)> {
    let nearest = |piece: &[Point; 2]| distance_to_segment(at, piece[0], piece[1]);
    let [from, to] = line.pieces().min_by(|a, b| nearest(a).total_cmp(&nearest(b)))?;
    let [x, y] = direction(from, to);
    let (across, by) = ([-y, x], share * line.length());
    Some(([1.0, -1.0].map(|side| [0, 1].map(|i| at[i] + side * by * across[i])), across))
}

/// Where a crack is open: just inside the end that is no tip, or half way between two tips; and how far from it its flanks are read.
fn mouth(specimen: &Specimen, line: &CrackLine) -> (Point, f64) {
    let is_tip = |at_last: bool| specimen.tips.iter().any(|tip| tip.position == line.end(at_last));
    let inside = INSIDE * line.length();
    match [false, true].into_iter().find(|&at_last| !is_tip(at_last)) {
        Some(true) => (way(line, line.length() - inside), BESIDE[0]),
        Some(false) => (way(line, inside), BESIDE[0]),
        None => (way(line, 0.5 * line.length()), BESIDE[1]),
    }
}

/// The place on a line at a way from its first end, m.
fn way(line: &CrackLine, mut way: f64) -> Point {
    for [from, to] in line.pieces() {
        let length = distance(from, to);
        if way <= length {
            return along(from, to, way / length);
        }
        way -= length;
    }
    line.end(true)
}

fn back_face_strain(case: &Case, plate: &NodePlate) -> Option<f64> {
    let specimen = &case.specimen;
    let back = match specimen.kind {
        SpecimenKind::CompactTension => specimen.width,
        SpecimenKind::SingleEdgeTension => specimen.width / 2.0,
        _ => return None,
    };
    let half = 0.5 * GAUGE * specimen.width;
    let [up, down] = [half, -half].map(|y| plate.displacement(case, [back * (1.0 - 1e-9), y]));
    Some((up?[1] - down?[1]) / (2.0 * half))
}
