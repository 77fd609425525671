//! A run of cycles with all that was found about it: judged once, its record and tables made once, then its files, pictures and words.

use std::path::Path;

use serde_json::{Map, Value};

use super::answers::{Answers, Asked, InspectionsRecord};
use super::band::{Lives, Quality, band_words, known_within};
use super::chart::{self, LARGE, Mark, Series};
use super::checks::{Judgement, Message, Validity, messages};
use super::curve::{self, RunTables};
use super::factors;
use super::format::PLAIN;
use super::output::{Room, write_file, write_json, write_table};
use super::pictures::curves::{a_n_svg, k_svg};
use super::pictures::plate::{self, growth_svg, plate_svg};
use super::pictures::section::section_svg;
use super::pictures::stress::stress_svg;
use super::provenance::{self, MadeBy};
use super::record::{RESULT_FILE, RunRecord};
use super::snapshots::{self, DamagePicture, cycles_and_length};
use super::specimen_picture::{nodes_svg, tip_svg};
use super::spectrum::{self, spectrum_svg};
use perilife_base::columns::Table;
use perilife_base::error::{Error, Result};
use perilife_base::units::{KN, MM, MM_PER_CYCLE, MPA, MPA_SQRT_M, shown::crack_length, shown::name_of};
use perilife_calibration::inspection::InspectFrom;
use perilife_growth::case::{Case, Model, RECORD, needs};
use perilife_growth::predict::judgement::breaks_at_once;
use perilife_growth::predict::moment::stress_field;
use perilife_growth::predict::part_through::PartThroughLife;
use perilife_growth::predict::plastic_zone::{self, PlasticZone};
use perilife_growth::predict::residual_strength::{Strength, residual_strength};
use perilife_growth::predict::{Prediction, StopReason, fit_use};
use perilife_measured::MeasuredCurve;
use perilife_plate::specimen::handbook::handbook;
use perilife_plate::specimen::part_through::{SOURCE, STATED_ERROR};
use perilife_plate::specimen::{LengthConvention, LoadMeasure, Point};

/// Keys of the record that a listing of runs shows.
pub const FIGURES: [&str; 30] = [
    "life_cycles", "passes", "error_estimate_percent", "path_error_estimate_mm", "no_error_estimate", "cross_check", "band",
    "no_band", "inspection", "inspections", "fleet", "sensitivities", "life_is_lower_bound", "stop_reason", "stop_meaning",
    "crack_length_initial_mm", "crack_length_final_mm", "life_share_extrapolated", "refused", "verdict", "verdict_kind",
    "checks", "critical", "tips", "points", "points_solved", "blocks", "solves", "wall_s", "memory_mb",
];

/// What is wanted beside a run of cycles.
#[derive(Debug, Clone, Default)]
pub struct Wanted {
    pub strength: bool,
    /// Readings of the plate itself, set against its case, that narrow the band of what it has left.
    pub readings: Option<MeasuredCurve>,
    /// What is left from a crack length on, and how often to look.
    pub inspection: Option<InspectFrom>,
    /// How and when inspections find cracks, and lives at other input.
    pub asked: Asked,
    /// No bounds of the error of the life.
    pub no_estimate: bool,
    /// The life by the other engine, too.
    pub cross_check: bool,
}

#[derive(Debug)]
pub struct Judged {
    pub record: RunRecord,
    /// Curve and paths, each with its text.
    kept: [(Table, String); 2],
    judgement: Judgement,
    /// Its life and band, and what was asked of them.
    pub lives: Lives,
    quality: Quality,
    answers: Answers,
    strengths: Option<Vec<Strength>>,
}

/// The part of a result that a listing of runs shows, all that the user should know under `warnings`.
pub fn figures(result: &Value) -> Value {
    let warnings = result.get("refused").into_iter().chain(result["warnings"].as_array().into_iter().flatten()).cloned();
    let shown = FIGURES.iter().filter_map(|key| Some(((*key).to_owned(), result.get(key)?.clone())));
    shown.chain([("warnings".to_owned(), warnings.collect())]).collect::<Map<_, _>>().into()
}

impl Judged {
    /// Of a run.
    /// Errors: as [`Judgement::of`]; a damaged record.
    pub fn of(case: &Case, prediction: &Prediction, wanted: &Wanted) -> Result<Self> {
        let mut judgement = Judgement::of(case, prediction)?;
        // If that fails, the run itself is written all the same.
        let strengths = wanted.strength.then(|| residual_strength(case, &prediction.curve)).transpose();
        let mut lives = Lives::of(case, prediction, judgement.is_lower_bound)?;
        let quality = Quality::of(case, prediction, [!wanted.no_estimate, wanted.cross_check]);
        let narrowed = wanted.readings.as_ref().map_or(Ok(()), |curve| lives.narrow(curve));
        // A length that the crack never has is wrong input, and no result is written for it.
        if narrowed.is_ok() {
            wanted.inspection.map_or(Ok(()), |from| lives.inspect(from))?;
        }
        let answers = narrowed.and_then(|()| Answers::of(case, prediction, &lives, wanted.asked));
        let mut record = RunRecord::of(case, prediction, &judgement, &lives, &quality);
        let (strengths, missed) = strengths.map_or_else(|error| (None, Some(error)), |strengths| (strengths, None));
        let (answers, unanswered) = answers.map_or_else(|error| (Answers::default(), Some(error)), |answers| (answers, None));
        record.warnings.extend(answers.inspections.as_ref().and_then(InspectionsRecord::warning));
        record.inspections.clone_from(&answers.inspections);
        record.fleet = answers.fleet.as_ref().map(|fleet| fleet.record.clone());
        record.sensitivities = answers.sensitivities.as_ref().map(|all| all.0.clone());
        judgement.refusal = judgement.refusal.or(missed).or(unanswered);
        let kept = [curve::a_n(case, prediction, lives.columns()), curve::crack_path(prediction, &case.specimen.cracks)];
        let kept = kept.map(Table::with_text);
        record.made_by = MadeBy::of(&case.provenance, kept.iter().map(|(table, text)| (&*table.file, &**text)));
        Ok(Judged { record, kept, judgement, lives, quality, answers, strengths })
    }

    /// Checks that did not pass and warnings, the most severe first.
    pub fn messages(&self) -> Vec<Message> {
        messages(&self.record.checks, &self.record.warnings)
    }

    /// Why the run is not valid, though its files are written; taken once.
    pub fn take_refusal(&mut self) -> Option<Error> {
        self.judgement.refusal.take()
    }

    /// Its tables.
    /// Errors: a law whose rate is not known.
    pub fn tables(&self, case: &Case, prediction: &Prediction) -> Result<Vec<Table>> {
        let mut tables = self.kept.each_ref().map(|(table, _)| table.clone()).to_vec();
        if factors::are_known(prediction) {
            tables.push(factors::factors(case, prediction)?);
        }
        tables.extend(self.strengths.iter().map(|strengths| strength_table(case, strengths)));
        tables.extend(self.answers.tables());
        Ok(tables)
    }

    /// Writes its files into an empty folder.
    /// Errors: files that cannot be written.
    pub fn write(&self, folder: &Path, case: &Case, prediction: &Prediction) -> Result<()> {
        // Tables and figures first: what a full disk cuts off are pictures.
        self.kept.iter().try_for_each(|(table, text)| write_file(&folder.join(&table.file), text.as_bytes()))?;
        self.tables(case, prediction)?[self.kept.len()..].iter().try_for_each(|table| write_table(folder, table))?;
        if let Some(beta) = factors::beta(case, prediction).filter(|_| factors::are_known(prediction)) {
            write_file(&folder.join(factors::BETA_FILE), beta.as_bytes())?;
        }
        write_json(folder, RESULT_FILE, &self.record)?;
        write_input(folder, case)?;
        if !case.output.tables_only {
            self.answers.write(folder, case)?;
            self.draw(folder, case, prediction)?;
            self.strengths.as_ref().map_or(Ok(()), |strengths| write_strength(folder, case, strengths))?;
        }
        snapshots::write_wanted(folder, case.output, &prediction.grid, &prediction.snapshots)
    }

    /// Pictures of a run: plate, a-N, K and rates; damage of fatigue bonds; nodes and stress of the node model.
    fn draw(&self, folder: &Path, case: &Case, prediction: &Prediction) -> Result<()> {
        let tables = RunTables::of(&self.kept[0].0, &self.kept[1].0)?;
        let put = |name: &str, text: &str| write_file(&folder.join(name), text.as_bytes());
        // Where nothing grew there is no curve.
        if tables.rows.len() > 1 {
            put("a_n.svg", &a_n_svg(&self.record, &tables, LARGE))?;
            if let Some(k) = k_svg(&self.record, &tables, LARGE) {
                put("k.svg", &k)?;
            }
            self.draw_rates(folder, case, prediction)?;
        }
        if let Some(spectrum) = &case.loading.spectrum {
            put("spectrum.svg", &spectrum_svg(spectrum, LARGE))?;
        }
        let places = |path: Vec<(f64, Point)>| path.into_iter().map(|(_, position)| position).collect();
        let paths: Vec<Vec<Point>> = curve::paths(prediction, &case.specimen.cracks).into_iter().map(places).collect();
        if let Some(plate) = &self.record.plate {
            put("plate.svg", &plate_svg(plate, &tables, plate::SIZE))?;
            if case.output.animation {
                put("growth.svg", &growth_svg(plate, &self.record, &tables, plate::MOVING))?;
            }
        }
        if let Some(section) = section_svg(case, prediction) {
            put("section.svg", &section)?;
        }
        if let Some(snapshot) = prediction.snapshots.last().filter(|_| case.spends_bond_life()) {
            let (cracks, caption) = (&case.specimen.cracks, cycles_and_length(snapshot));
            DamagePicture { grid: &prediction.grid, snapshot, cracks, paths: &paths, caption: &caption }
                .write(&folder.join("damage.svg"))?;
        }
        match self.quality.stress.clone().map_or_else(|| stress_field(case, prediction), |field| Ok(Some(field))) {
            Ok(Some(field)) => put("stress.svg", &stress_svg(&field, &case.material, &case.specimen.holes))?,
            Ok(None) => {}
            // The answer counts without this picture.
            Err(error) => tracing::warn!("stress.svg is omitted: {error}"),
        }
        if matches!(case.model, Model::Nodes(_)) {
            put("nodes.svg", &nodes_svg(case, &paths)?)?;
            if let Some(around_tip) = tip_svg(case, &paths)? {
                put("nodes_tip.svg", &around_tip)?;
            }
        }
        Ok(())
    }

    /// `da_dn.svg`: rates of the tip that leads, whose rate the law is of, within the ΔK of the tests of the law and outside.
    fn draw_rates(&self, folder: &Path, case: &Case, prediction: &Prediction) -> Result<()> {
        let rates = prediction.curve.iter().map(|row| (row.delta_k / MPA_SQRT_M, row.growth_rate / MM_PER_CYCLE));
        let rates: Vec<(f64, f64)> = rates.filter(|(k, rate)| *k > 0.0 && *rate > 0.0).collect();
        let is_tested = |k: f64| self.record.law.range().is_none_or(|[low, high]| (low..=high).contains(&k));
        let of = |tested: bool| {
            rates.iter().map(move |&(k, rate)| if is_tested(k) == tested { (k, rate) } else { (f64::NAN, f64::NAN) })
        };
        let name = if self.record.law.range().is_some() { "within the tested ΔK" } else { "tested ΔK unknown" };
        let series = [
            Series { name: format!("predicted, {name}"), mark: Mark::Line, points: of(true).collect() },
            Series { name: "predicted, extrapolated".to_owned(), mark: Mark::Dashes, points: of(false).collect() },
        ];
        let shown: Vec<Series> = series.into_iter().filter(|series| series.points.iter().any(|(k, _)| k.is_finite())).collect();
        if shown.is_empty() {
            return Ok(());
        }
        chart::growth_rate(&folder.join("da_dn.svg"), &format!("{}: crack growth rate", case.name), &shown)
    }

    /// Lines of a summary, the answer first.
    pub fn words(&self, case: &Case, prediction: &Prediction) -> Vec<String> {
        let (is_refused, record) = (self.record.refused.is_some(), &self.record);
        let is_valid = record.verdict_kind != Validity::NotValid;
        let by_error = |life: f64| format!("{} cycles", PLAIN.by_error(life, record.error_estimate_percent));
        let life = record
            .life_cycles
            .map(|life| self.lives.life().map(|quantiles| band_words(&quantiles)).unwrap_or_else(|| by_error(life)));
        let run = match life {
            _ if breaks_at_once(case, prediction).is_some() => "no life: the plate fails in the first cycle".to_owned(),
            Some(life) if is_refused => format!("no valid life ({life} computed; see the failed check)"),
            Some(life) if !is_valid => format!("not valid (life {life} computed; see the failed check)"),
            Some(life) if prediction.stop == StopReason::EnteredHole => format!("{life} until the crack enters the hole"),
            Some(life) if record.life_is_lower_bound => format!("life ≥ {life}"),
            Some(life) if prediction.stop.is_lower_bound() => format!("{life} until the analysis stopped"),
            Some(life) => format!("life {life}"),
            None => "unlimited life (no crack grows under this load)".to_owned(),
        };
        // Those of a median life are others than those of the run.
        let passes = record.passes.filter(|passes| *passes > 0.0 && record.band.is_none());
        let passes = passes.map_or_else(String::new, |passes| format!(" ({} passes)", PLAIN.significant(passes, 4, f64::round)));
        let (name, run) = (&case.name, run + &passes);
        let mut lines = match self.answers.headline().filter(|_| is_valid) {
            // The run is one plate, and its life may exceed all of a fleet.
            Some(fleet) => vec![format!("{name}: {fleet}"), format!("  Nominal run    {run}")],
            None => vec![format!("{name}: {run}")],
        };
        lines.extend([
            format!("  Crack length   {}", length_words(case, prediction)),
            format!("  Ends by        {}", prediction.stop.meaning()),
        ]);
        lines.extend(through_words(case, prediction, &by_error).map(|words| format!("  Breakthrough   {words}")));
        lines.extend(phase_words(prediction, &by_error).map(|words| format!("  Initiation     {words}")));
        lines.extend(spectrum::words(case, prediction).map(|words| format!("  Load history   {words}")));
        let of_fleet = record.fleet.as_ref().and_then(|fleet| fleet.inspections.as_ref()?.interval());
        lines.extend(self.lives.words(of_fleet, record.error_estimate_percent));
        let known = self.lives.inspection().map(|inspection| known_within(inspection, record.error_estimate_percent));
        lines.extend(self.answers.words(known));
        lines.push(format!("  Validity       {}", record.verdict));
        lines.extend(self.quality.words());
        lines.push(format!("  Method         {}", method_words(case, prediction)));
        lines
    }

    pub fn details(&self, case: &Case, prediction: &Prediction) -> Vec<String> {
        let figures = &prediction.figures;
        let model = format!("{} points, {} rows of the curve, {} solves", figures.points, figures.blocks + 1, figures.solves);
        let lines = [
            (case.specimen.crack_lines().len() > 1).then(|| format!("  All cracks     {} (sum)", all_cracks(case, prediction))),
            fit_use::law_line(case).map(|law| format!("  Growth law     {law}")),
            zone_words(case, prediction).map(|zone| format!("  Plastic zone   {zone}")),
            self.quality.basis().map(|basis| format!("  Estimated by   {basis}")),
            (figures.solves > 0).then(|| format!("  Model          {model}, {:.0} MB", figures.memory_mb)),
        ];
        lines.into_iter().flatten().collect()
    }
}

/// Writes `case.toml` and the files that it names: the case as it was run.
pub fn write_input(folder: &Path, case: &Case) -> Result<()> {
    let mut input = provenance::table_of(&case.echo);
    let fitted = input.get_mut("fatigue").and_then(|fatigue| fatigue.as_table_mut()?.get_mut("fitted"));
    if let Some(record) = fitted.filter(|record| record.is_table()) {
        // A record that came with no file is one beside it.
        *record = RECORD.into();
    }
    provenance::write(folder, "predict", input, &case.provenance)
}

pub fn room(case: &Case) -> Room {
    let texts: usize = case.provenance.files.iter().map(|file| file.content.len()).sum();
    let tables = 32_000 + texts as u64;
    Room { tables, all: tables + needs::of_case(case).disk_bytes as u64 }
}

/// Both parts of a life that begins before its cracks have formed.
fn phase_words(prediction: &Prediction, cycles_words: &dyn Fn(f64) -> String) -> Option<String> {
    let phase = prediction.phase_one?;
    let [x, y] = phase.at.map(|x| x / MM);
    let concentration = phase.concentration.map_or_else(String::new, |k| format!(", K_tg = {k:.2}"));
    let local = format!("local stress range {:.1} MPa at ({x:.2}, {y:.2}) mm{concentration}", phase.range / MPA);
    Some(match phase.cycles {
        Some(cycles) if cycles <= prediction.life_cycles() => {
            let growth = cycles_words(prediction.life_cycles() - cycles);
            format!("{} to initiation ({local}), {growth} of growth", cycles_words(cycles))
        }
        Some(cycles) => format!("{}, more than stop.cycles_max ({local})", cycles_words(cycles)),
        None => format!("no initiation: below the endurance limit ({local})"),
    })
}

fn from_to(from: f64, to: f64) -> String {
    format!("{} → {} {}", crack_length(from), crack_length(to), name_of("mm"))
}

/// Growth by the length of the specimen: in a plate the sum of all cracks.
fn all_cracks(case: &Case, prediction: &Prediction) -> String {
    from_to(case.specimen.crack_length, prediction.crack_length_final())
}

/// Growth of the crack by the length of its standard, or of the governing crack.
fn length_words(case: &Case, prediction: &Prediction) -> String {
    let depths = case.specimen.part_through.zip(prediction.curve.last().and_then(|row| row.depth));
    let depths = depths.map(|(flaw, last)| format!(", depth {}", from_to(flaw.depth, last.depth)));
    let is_standard = case.specimen.convention == LengthConvention::MeanOfTips && case.specimen.tips.len() == 1;
    match prediction.leading_tip(&case.specimen).filter(|_| !is_standard) {
        Some((tip, [first, last])) => format!("{} (tip {tip} governs)", from_to(first, last)),
        None => all_cracks(case, prediction) + depths.as_deref().unwrap_or_default(),
    }
}

/// When a crack was through, and what the error of its K does to the life.
fn through_words(case: &Case, prediction: &Prediction, cycles_words: &dyn Fn(f64) -> String) -> Option<String> {
    let found = PartThroughLife::of(case, &prediction.curve)?;
    let [shorter, longer] = found.life_factors.map(|factor| factor * prediction.life_cycles());
    let longer = if longer.is_finite() { cycles_words(longer) } else { "unlimited".to_owned() };
    let when = if found.is_through { format!("after {}", cycles_words(found.cycles)) } else { "not reached".to_owned() };
    Some(format!(
        "{when}; life {} to {longer} for K ±{:.0} % of the part-through crack",
        cycles_words(shorter).trim_end_matches(" cycles"),
        100.0 * STATED_ERROR
    ))
}

/// Plastic zone at start and end against ligament, thickness and horizon; `None` without yield strength.
fn zone_words(case: &Case, prediction: &Prediction) -> Option<String> {
    let PlasticZone { first, last, .. } = plastic_zone::plastic_zone(case, &prediction.curve)?;
    let (horizon, thickness) = (prediction.figures.horizon, case.specimen.thickness);
    let (room, name) = last.room();
    let of_horizon = if horizon > 0.0 { format!(", {:.2} of the horizon", last.size / horizon) } else { String::new() };
    Some(format!(
        "{:.2} → {:.2} mm (at the end {:.3} of the {name}, {:.2} of the thickness{of_horizon})",
        first.size / MM,
        last.size / MM,
        last.size / room,
        last.size / thickness
    ))
}

/// Method, why it was chosen, formula, time.
fn method_words(case: &Case, prediction: &Prediction) -> String {
    let why = case.chosen.as_ref().map_or_else(String::new, |why| format!(" ({why})"));
    let of_front = case.specimen.part_through.map(|_| SOURCE);
    let method = match handbook(&case.specimen).map(|formula| formula.name).or(of_front) {
        Some(formula) if matches!(case.model, Model::Handbook(_)) => {
            let later = if prediction.figures.solves > 0 { ", then nodes" } else { "" };
            format!("handbook K ({formula}){later}")
        }
        _ => format!("{}{why}", case.model.method()),
    };
    let wall_s = prediction.figures.wall_s;
    let time = if wall_s < 0.1 { format!("{:.1} ms", 1e3 * wall_s) } else { format!("{wall_s:.1} s") };
    format!("{method}, {time}")
}

pub const RESIDUAL_STRENGTH_FILE: &str = "residual_strength.csv";

/// Unit of the load in columns and in the picture, its name there, and its size.
fn unit(case: &Case) -> (&'static str, &'static str, f64) {
    match case.specimen.load_measure {
        LoadMeasure::Stress => ("mpa", "Residual strength (gross stress), MPa", MPA),
        LoadMeasure::Force => ("kn", "Residual strength (force), kN", KN),
    }
}

/// Columns in `mpa` of gross stress or `kn` of force; empty where a strength is unknown.
pub fn strength_table(case: &Case, strengths: &[Strength]) -> Table {
    let (unit, _, size) = unit(case);
    Table::new(RESIDUAL_STRENGTH_FILE)
        .numbers("crack_length_mm", strengths.iter().map(|strength| strength.crack_length / MM))
        .numbers(format!("residual_strength_{unit}"), strengths.iter().map(|strength| strength.load() / size))
        .numbers(format!("by_toughness_{unit}"), strengths.iter().map(|strength| Some(strength.by_toughness? / size)))
        .numbers(format!("by_net_section_{unit}"), strengths.iter().map(|strength| Some(strength.by_net_section? / size)))
        .words("governed_by", strengths.iter().map(Strength::governed_by))
}

fn write_strength(folder: &Path, case: &Case, curve: &[Strength]) -> Result<()> {
    let (_, axis, size) = unit(case);
    let series = |name: &str, mark, pick: &dyn Fn(&Strength) -> Option<f64>| Series {
        name: name.to_owned(),
        mark,
        points: curve.iter().filter_map(|s| Some((s.crack_length / MM, pick(s)? / size))).collect(),
    };
    let has = |pick: fn(&Strength) -> Option<f64>| curve.iter().any(|strength| pick(strength).is_some());
    let name = match [has(|s| s.by_toughness), has(|s| s.by_net_section)] {
        [true, true] => "residual strength (lower of both)",
        [true, false] => "residual strength by fracture only (no yield strength given)",
        [false, _] => "residual strength by net-section yield only (no toughness given)",
    };
    let all = [
        series(name, Mark::Broad, &|s| Some(s.load())),
        series("fracture (K_c)", Mark::Line, &|s| s.by_toughness),
        series("net-section yield", Mark::Dashes, &|s| s.by_net_section),
        series("maximum load of the cycle", Mark::Line, &|s| Some(case.loading.at(s.crack_length))),
        series("required strength", Mark::Dashes, &|s| case.stop.required.map(|factor| factor * case.loading.at(s.crack_length))),
    ];
    let known: Vec<Series> = all.into_iter().filter(|series| !series.points.is_empty()).collect();
    let title = format!("{}: residual strength", case.name);
    chart::linear(&folder.join("residual_strength.svg"), &title, ["Crack length a, mm", axis], &known)
}
