//! `result.json` of a run of cycles as it is written and read back: its figures, what its life rests on, its law, what was asked, what made it.
//!
//! What is not known or does not exist is `null`; what only some runs have is left out of the others.

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use super::answers::{InspectionsRecord, SensitivityRecord};
use super::band::{BandRecord, Lives, OwnRecord, Quality, SecondOpinion};
use super::checks::{Check, Judgement, Validity, validity, verdict};
use super::fleet::FleetRecord;
use super::format::clean;
use super::model_words;
use super::pictures::plate::Plate;
use super::provenance::MadeBy;
use super::spectrum::SpectrumRecord;
use perilife_base::columns::Table;
use perilife_base::error::Result;
use perilife_base::units::{MM, MM_PER_CYCLE, MPA, MPA_SQRT_M};
use perilife_calibration::inspection::{Inspection, TipLengths};
use perilife_growth::case::record::{CurveRecord, LawRecord};
use perilife_growth::case::{Case, LawSource};
use perilife_growth::end_of_life::{critical_length, critical_lengths};
use perilife_growth::predict::fit_use::life_share_extrapolated;
use perilife_growth::predict::laws::paris_law;
use perilife_growth::predict::part_through::PartThroughLife;
use perilife_growth::predict::{CurvePoint, GoverningCrack, Prediction, StopReason, plastic_zone};
use perilife_growth::record::TipRecord;
use perilife_plate::specimen::part_through::{BREAK_THROUGH, Limit, STATED_ERROR};

pub const RESULT_FILE: &str = "result.json";

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    pub name: String,
    /// Cycles to the end; `None` of a life without end.
    pub life_cycles: Option<f64>,
    pub passes: Option<f64>,
    pub life_is_lower_bound: bool,
    pub stop_reason: StopReason,
    pub stop_meaning: String,
    pub converged: bool,
    pub crack_length_initial_mm: Option<f64>,
    pub crack_length_final_mm: Option<f64>,
    pub critical: Option<Critical>,
    pub tips: Vec<TipEnds>,
    pub part_through: Option<PartThroughEnds>,
    pub phase_one: Option<PhaseOneLife>,
    pub life_share_extrapolated: Option<f64>,
    pub plastic_zone: Option<PlasticZones>,
    pub k_cross_check: Option<EnergyBalance>,
    pub points: usize,
    pub points_solved: usize,
    pub bonds: usize,
    pub blocks: usize,
    pub solves: usize,
    pub solver_iterations: usize,
    pub wall_s: f64,
    pub memory_mb: f64,
    pub spectrum: Option<SpectrumRecord>,
    pub model: Map<String, Value>,
    pub law: LawUsed,
    pub verdict: String,
    pub verdict_kind: Validity,
    pub checks: Vec<Check>,
    pub warnings: Vec<String>,
    pub version: String,
    pub case: Value,
    pub band: Option<BandRecord>,
    pub no_band: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured: Option<OwnRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inspection: Option<Inspection>,
    pub error_estimate_percent: Option<f64>,
    pub path_error_estimate_mm: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub no_error_estimate: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cross_check: Option<SecondOpinion>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inspections: Option<InspectionsRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fleet: Option<FleetRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivities: Option<Vec<SensitivityRecord>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plate: Option<Plate>,
    #[serde(flatten)]
    pub made_by: MadeBy,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
}

/// The crack length at which the plate no longer bears its load, and by toughness and net section alone as far as formulas say them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Critical {
    pub crack_length_mm: f64,
    pub criterion: StopReason,
    pub meaning: String,
    pub by_toughness_mm: Option<f64>,
    pub by_net_section_mm: Option<f64>,
}

/// A tip at the start and at the end; of a plate also its crack, and whether that ends the life.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TipEnds {
    pub crack: Option<usize>,
    pub leads: bool,
    pub crack_length_initial_mm: Option<f64>,
    pub crack_length_final_mm: Option<f64>,
    pub state_initial: String,
    pub state: String,
    pub x_mm: f64,
    pub y_mm: f64,
    pub growth_mm: f64,
}

impl TipEnds {
    /// Lengths of the cracks of all tips, mm, by the table of their run; `None` of a standard specimen.
    /// Errors: a table without their growth.
    pub fn lengths(tips: &[TipEnds], table: &Table) -> Result<Option<TipLengths>> {
        let Some(leads) = tips.iter().position(|tip| tip.leads && tip.crack.is_some()) else { return Ok(None) };
        let of_tip = |tip: &TipEnds| {
            let Some(start) = tip.crack_length_initial_mm else { return Ok(Vec::new()) };
            let same = (0..tips.len()).filter(|other| tips[*other].crack == tip.crack);
            let growth = same.map(|other| table.get(&format!("tip{other}_growth_mm"))).collect::<Result<Vec<_>>>()?;
            Ok((0..table.rows()).map(|row| start + growth.iter().map(|column| column[row]).sum::<f64>()).collect())
        };
        Ok(Some(TipLengths { lengths: tips.iter().map(of_tip).collect::<Result<_>>()?, leads }))
    }
}

/// What became of a crack that did not go through at the start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PartThroughEnds {
    pub kind: String,
    pub cycles_at_break_through: Option<f64>,
    pub crack_length_at_break_through_mm: Option<f64>,
    pub crack_depth_initial_mm: f64,
    pub crack_depth_final_mm: f64,
    pub aspect_ratio_final: f64,
    pub depth_over_thickness: f64,
    pub rule: String,
    pub k_error_percent: f64,
    pub life_cycles_if_k_is_larger: Option<f64>,
    pub life_cycles_if_k_is_smaller: Option<f64>,
    pub outside_range: Vec<OutsideRange>,
}

/// How much of a life lies outside of a range of the formulas.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OutsideRange {
    pub of: String,
    pub range: [Option<f64>; 2],
    pub life_share: Option<f64>,
}

/// The part of a life before its cracks had formed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PhaseOneLife {
    pub cycles: Option<f64>,
    pub stress_range_mpa: f64,
    pub stress_concentration: Option<f64>,
    pub at_mm: [f64; 2],
    pub growth_cycles: Option<f64>,
}

/// Plastic zone at the first and the last row whose K is known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlasticZones {
    pub first: ZoneRecord,
    pub last: ZoneRecord,
    pub small_scale_yielding: bool,
    pub too_large_from_mm: Option<f64>,
    pub too_large_to_mm: Option<f64>,
    pub life_share_too_large: Option<f64>,
}

/// A plastic zone and what it has to be small against.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ZoneRecord {
    pub crack_length_mm: f64,
    pub k_max_mpa_sqrt_m: f64,
    pub size_mm: f64,
    pub over_horizon: Option<f64>,
    pub ligament_mm: Option<f64>,
    pub over_ligament: Option<f64>,
    /// Of cracks from a rim of a plate.
    pub over_crack: Option<f64>,
    pub over_thickness: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EnergyBalance {
    pub compared: usize,
    pub largest_difference_percent: f64,
    pub crack_length_mm: f64,
}

/// The constants as given, and those that were used: at this run's horizon, modulus and stress ratio.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LawUsed {
    /// `fitted`, `inline` or `missing`.
    pub source: String,
    pub law: Option<String>,
    pub curve: Option<CurveRecord>,
    pub a: Option<f64>,
    pub p: Option<f64>,
    pub p_error: Option<f64>,
    pub rate_constant: Option<f64>,
    pub horizon_mm: Option<f64>,
    pub a_used: Option<f64>,
    pub paris_c_mm_per_cycle: Option<f64>,
    pub paris_c_used_mm_per_cycle: Option<f64>,
    pub paris_m: Option<f64>,
    pub paris_m_error: Option<f64>,
    pub pivot_delta_k_mpa_sqrt_m: Option<f64>,
    pub rate_at_pivot_mm_per_cycle: Option<f64>,
    pub rate_at_pivot_relative_error: Option<f64>,
    pub delta_k_min_mpa_sqrt_m: Option<f64>,
    pub delta_k_max_mpa_sqrt_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub constants_si: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Of a law over K that was fitted to rates.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub record: Option<LawRecord>,
}

/// A figure without what conversion adds behind its digits; `None` of one that is not finite.
fn known(value: f64) -> Option<f64> {
    value.is_finite().then(|| clean(value))
}

impl RunRecord {
    /// Of a run, what it was judged to be, its lives and how good they are; what was asked beside them is added by who asked.
    pub fn of(case: &Case, prediction: &Prediction, judgement: &Judgement, lives: &Lives, quality: &Quality) -> Self {
        let ([error_estimate_percent, path_error_estimate_mm], not_stated) = quality.stated();
        let figures = &prediction.figures;
        let governing = GoverningCrack::of(&case.specimen, &prediction.curve);
        let length = |row: Option<&CurvePoint>| row.and_then(|row| known(governing.length(row) / MM));
        // What the run found comes first: it counts more than what an assumption may do.
        // A strength that the first load exceeds is the refusal, and is said once.
        let of_case = case.warnings.iter().filter(|line| judgement.refusal.is_none() || !line.starts_with("first load: "));
        let warnings = prediction.warnings.iter().chain(&judgement.warnings).chain(of_case);
        RunRecord {
            name: case.name.clone(),
            life_cycles: prediction.life(),
            passes: super::spectrum::passes(case, prediction),
            life_is_lower_bound: judgement.is_lower_bound,
            stop_reason: prediction.stop,
            stop_meaning: prediction.stop.meaning().to_owned(),
            converged: prediction.stop != StopReason::NoConvergence,
            crack_length_initial_mm: length(prediction.curve.first()),
            crack_length_final_mm: length(prediction.curve.last()),
            critical: critical(case, prediction),
            tips: tips(case, prediction),
            part_through: part_through(case, prediction),
            phase_one: phase_one(prediction),
            life_share_extrapolated: life_share_extrapolated(case, prediction),
            plastic_zone: plastic_zones(case, prediction),
            k_cross_check: prediction.cross_check.map(|check| EnergyBalance {
                compared: check.compared,
                largest_difference_percent: 100.0 * check.difference,
                crack_length_mm: clean(check.crack_length / MM),
            }),
            points: figures.points,
            points_solved: figures.points_solved,
            bonds: figures.bonds,
            blocks: figures.blocks,
            solves: figures.solves,
            solver_iterations: figures.iterations,
            wall_s: figures.wall_s,
            memory_mb: figures.memory_mb,
            spectrum: SpectrumRecord::of(case, prediction),
            model: model_words::object(&model_words::of_case(case, Some(figures))),
            law: LawUsed::of(case, prediction),
            verdict: verdict(&judgement.checks),
            verdict_kind: if judgement.refusal.is_some() { Validity::NotValid } else { validity(&judgement.checks) },
            checks: judgement.checks.clone(),
            warnings: warnings.cloned().collect(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            case: case.echo.clone(),
            band: lives.band_record(),
            no_band: lives.band.as_ref().err().cloned(),
            measured: lives.own_record(),
            inspection: lives.inspection().cloned(),
            error_estimate_percent,
            path_error_estimate_mm,
            no_error_estimate: not_stated.cloned(),
            cross_check: quality.second.clone(),
            inspections: None,
            fleet: None,
            sensitivities: None,
            plate: Some(Plate::of(case)),
            made_by: MadeBy::default(),
            refused: judgement.refusal.as_ref().map(ToString::to_string),
        }
    }

    /// The tip whose crack ends the life, and the length of that at the start and at the end, in a plate with several tips.
    pub fn leading_crack(&self) -> Option<(usize, [f64; 2])> {
        let leads = self.tips.iter().position(|tip| tip.leads && tip.crack.is_some()).filter(|_| self.tips.len() > 1)?;
        let tip = &self.tips[leads];
        Some((leads, [tip.crack_length_initial_mm?, tip.crack_length_final_mm?]))
    }
}

fn critical(case: &Case, prediction: &Prediction) -> Option<Critical> {
    let length = |row| GoverningCrack::of(&case.specimen, &prediction.curve).length(row);
    let by_run = prediction.curve.last().filter(|_| prediction.stop.is_strength()).map(|row| (length(row), prediction.stop));
    let (length, reason) = by_run.or_else(|| critical_length(case).map(|end| (end.crack_length, end.reason)))?;
    let [by_toughness_mm, by_net_section_mm] = critical_lengths(case).map(|end| end.map(|end| clean(end.crack_length / MM)));
    let (crack_length_mm, meaning) = (clean(length / MM), reason.meaning().to_owned());
    Some(Critical { crack_length_mm, criterion: reason, meaning, by_toughness_mm, by_net_section_mm })
}

fn phase_one(prediction: &Prediction) -> Option<PhaseOneLife> {
    let phase = prediction.phase_one?;
    Some(PhaseOneLife {
        cycles: phase.cycles,
        stress_range_mpa: clean(phase.range / MPA),
        stress_concentration: phase.concentration,
        at_mm: phase.at.map(|x| clean(x / MM)),
        growth_cycles: phase.cycles.map(|cycles| (prediction.life_cycles() - cycles).max(0.0)),
    })
}

fn part_through(case: &Case, prediction: &Prediction) -> Option<PartThroughEnds> {
    let (flaw, found) = case.specimen.part_through.zip(PartThroughLife::of(case, &prediction.curve))?;
    let PartThroughLife { cycles, axes, is_through, life_factors, outside, .. } = found;
    let life = prediction.life_cycles();
    let [depth, length] = axes.map(|length| clean(length / MM));
    let share = |(limit, cycles): &(&Limit, f64)| OutsideRange {
        of: limit.name.to_owned(),
        range: [known(limit.low), known(limit.high)],
        life_share: known(cycles / life),
    };
    Some(PartThroughEnds {
        kind: flaw.kind().name().to_owned(),
        cycles_at_break_through: is_through.then_some(cycles),
        crack_length_at_break_through_mm: is_through.then_some(length),
        crack_depth_initial_mm: clean(flaw.depth / MM),
        crack_depth_final_mm: depth,
        aspect_ratio_final: clean(axes[0] / axes[1]),
        depth_over_thickness: clean(axes[0] / flaw.through_depth()),
        rule: BREAK_THROUGH.to_owned(),
        k_error_percent: 100.0 * STATED_ERROR,
        life_cycles_if_k_is_larger: Some(life * life_factors[0]).filter(|cycles| cycles.is_finite()),
        life_cycles_if_k_is_smaller: Some(life * life_factors[1]).filter(|cycles| cycles.is_finite()),
        outside_range: outside.iter().map(share).collect(),
    })
}

fn tips(case: &Case, prediction: &Prediction) -> Vec<TipEnds> {
    let [Some(first), Some(last)] = [prediction.curve.first(), prediction.curve.last()] else { return Vec::new() };
    let leads = prediction.leading_tip(&case.specimen).map(|(tip, _)| tip);
    let of_tip = |(tip, (start, end)): (usize, (&TipRecord, &TipRecord))| {
        let length = |row: &CurvePoint| leads.and(row.crack_length_of(&case.specimen, tip)).map(|length| clean(length / MM));
        TipEnds {
            crack: leads.and(case.specimen.line_end(tip)).map(|end| end.line),
            leads: leads.is_none_or(|leads| leads == tip),
            crack_length_initial_mm: length(first),
            crack_length_final_mm: length(last),
            state_initial: start.state.name().to_owned(),
            state: end.state.name().to_owned(),
            x_mm: clean(end.position[0] / MM),
            y_mm: clean(end.position[1] / MM),
            growth_mm: clean(end.growth / MM),
        }
    };
    first.tips.iter().zip(&last.tips).enumerate().map(of_tip).collect()
}

fn plastic_zones(case: &Case, prediction: &Prediction) -> Option<PlasticZones> {
    let found = plastic_zone::plastic_zone(case, &prediction.curve)?;
    let zone = |zone: &plastic_zone::Zone| ZoneRecord {
        crack_length_mm: clean(zone.crack_length / MM),
        k_max_mpa_sqrt_m: clean(zone.k_max / MPA_SQRT_M),
        size_mm: clean(zone.size / MM),
        over_horizon: known(zone.size / prediction.figures.horizon),
        ligament_mm: known(zone.ligament / MM),
        over_ligament: known(zone.size / zone.ligament),
        over_crack: known(zone.size / zone.crack).filter(|_| zone.crack.is_finite()),
        over_thickness: clean(zone.size / case.specimen.thickness),
    };
    Some(PlasticZones {
        first: zone(&found.first),
        last: zone(&found.last),
        small_scale_yielding: found.too_large_from.is_none(),
        too_large_from_mm: found.too_large_from.map(|length| clean(length / MM)),
        too_large_to_mm: found.too_large_to.map(|length| clean(length / MM)),
        life_share_too_large: known(found.life_share_too_large),
    })
}

impl LawUsed {
    /// ΔK between which it was fitted, MPa√m.
    pub fn range(&self) -> Option<[f64; 2]> {
        let of_record = self.record.as_ref().map(|record| [record.delta_k_min_mpa_sqrt_m, record.delta_k_max_mpa_sqrt_m]);
        self.delta_k_min_mpa_sqrt_m.zip(self.delta_k_max_mpa_sqrt_m).map(|(low, high)| [low, high]).or(of_record)
    }

    fn of(case: &Case, prediction: &Prediction) -> Self {
        let hand = !case.spends_bond_life();
        let source = match &case.law {
            LawSource::Missing(_) => "missing",
            LawSource::Fitted(_) => "fitted",
            LawSource::Paris(_) | LawSource::Factor(_) if case.law_record.is_some() => "fitted",
            _ => "inline",
        };
        let given = LawUsed {
            source: source.to_owned(),
            a_used: case.fatigue_law(prediction.figures.horizon).ok().filter(|_| !hand).map(|law| law.a),
            paris_c_used_mm_per_cycle: paris_law(case).ok().filter(|_| hand).map(|law| clean(law.c / MM_PER_CYCLE)),
            record: case.law_record.as_deref().cloned(),
            ..LawUsed::default()
        };
        match &case.law {
            LawSource::Inline(law) => LawUsed { a: Some(law.a), p: Some(law.p), horizon_mm: known(law.horizon / MM), ..given },
            LawSource::Paris(law) => LawUsed { paris_c_mm_per_cycle: known(law.c / MM_PER_CYCLE), paris_m: Some(law.m), ..given },
            LawSource::Fitted(record) => LawUsed {
                law: Some(record.law.name().to_owned()),
                curve: record.curve.clone(),
                a: Some(record.a).filter(|a| a.is_finite()),
                p: Some(record.p),
                p_error: Some(record.p_error),
                rate_constant: record.rate_constant,
                horizon_mm: Some(record.horizon_mm).filter(|horizon| horizon.is_finite()),
                paris_c_mm_per_cycle: Some(record.paris_c_mm_per_cycle),
                paris_m: Some(record.paris_m),
                paris_m_error: Some(record.paris_m_error),
                pivot_delta_k_mpa_sqrt_m: Some(record.pivot_delta_k_mpa_sqrt_m),
                rate_at_pivot_mm_per_cycle: Some(record.rate_at_pivot_mm_per_cycle),
                rate_at_pivot_relative_error: Some(record.rate_at_pivot_relative_error),
                delta_k_min_mpa_sqrt_m: Some(record.delta_k_min_mpa_sqrt_m),
                delta_k_max_mpa_sqrt_m: Some(record.delta_k_max_mpa_sqrt_m),
                ..given
            },
            LawSource::Factor(law) => LawUsed { constants_si: Some(law.constants_si()), ..given },
            LawSource::Missing(path) => LawUsed { file: Some(path.display().to_string()), ..given },
        }
    }
}
