//! A run of cycles: all its files.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::{Value, json};

use super::answers::Answers;
use super::band::Lives;
use super::chart::{self, LARGE, Mark, Series};
use super::csv;
use super::damage::{DamagePicture, cycles_and_length};
pub use super::json::result;
use super::output::{Room, write_file};
use super::pictures::curves::{a_n_svg, k_svg};
use super::pictures::plate::{self, Plate, growth_svg, plate_svg};
use super::pictures::section::section_svg;
use super::pictures::spectrum::spectrum_svg;
use super::pictures::stress::stress_svg;
use super::pictures::tables::RunTables;
use super::quality::Quality;
use super::specimen_picture::{nodes_svg, tip_svg};
use super::{checks, factors, json, provenance, spectrum, vtk};
use perilife_base::error::Result;
use perilife_base::units::{KN, MM, MM_PER_CYCLE, MPA, MPA_SQRT_M};
use perilife_growth::case::needs;
use perilife_growth::case::{Case, Model, RECORD};
use perilife_growth::predict::fit_use;
use perilife_growth::predict::judgement::{breaks_at_once, refusal};
use perilife_growth::predict::moment::stress_field;
use perilife_growth::predict::part_through::PartThroughLife;
use perilife_growth::predict::plastic_zone::{self, PlasticZone};
use perilife_growth::predict::residual_strength::Strength;
use perilife_growth::predict::{Prediction, StopReason};
use perilife_plate::specimen::handbook::handbook;
use perilife_plate::specimen::part_through::{SOURCE, STATED_ERROR};
use perilife_plate::specimen::{LengthConvention, LoadMeasure, Point};

/// Table of the ways of the tips.
pub const CRACK_PATH_FILE: &str = "crack_path.csv";

/// Keys of `result.json` that a listing of runs shows.
pub const FIGURES: [&str; 29] = [
    "life_cycles",
    "passes",
    "error_estimate_percent",
    "path_error_estimate_mm",
    "no_error_estimate",
    "cross_check",
    "band",
    "no_band",
    "inspection",
    "inspections",
    "fleet",
    "sensitivities",
    "life_is_lower_bound",
    "stop_reason",
    "stop_meaning",
    "crack_length_initial_mm",
    "crack_length_final_mm",
    "life_share_extrapolated",
    "refused",
    "verdict",
    "checks",
    "critical",
    "tips",
    "points",
    "points_solved",
    "blocks",
    "solves",
    "wall_s",
    "memory_mb",
];

/// A run as its folder keeps it: what is drawn and read from later.
#[derive(Debug, Clone)]
pub struct Kept {
    /// Content of `result.json`.
    pub result: Value,
    /// `a_n.csv`.
    pub a_n: String,
    /// `crack_path.csv`.
    pub crack_path: String,
}

impl Kept {
    /// Of a run and what was found about it.
    pub fn of(case: &Case, prediction: &Prediction, (lives, quality, answers): (&Lives, &Quality, &Answers)) -> Self {
        let mut result = json::result(case, prediction);
        lives.add_to(&mut result);
        quality.add_to(&mut result);
        answers.add_to(&mut result);
        let a_n = lives.beside(csv::a_n(case, prediction));
        let crack_path = csv::crack_path(prediction, &case.specimen.cracks);
        if let Some(object) = result.as_object_mut() {
            object.insert("plate".to_owned(), json!(Plate::of(case)));
        }
        provenance::add(&mut result, &case.provenance, &[(csv::A_N_FILE, &a_n), (CRACK_PATH_FILE, &crack_path)]);
        if let (Some(refusal), Some(object)) = (refusal(case, prediction), result.as_object_mut()) {
            object.insert("refused".to_owned(), refusal.to_string().into());
        }
        Kept { result, a_n, crack_path }
    }
}

/// Writes all files of a run into `folder`.
pub fn write(folder: &Path, case: &Case, prediction: &Prediction, answers: &Answers, kept: &Kept) -> Result<()> {
    let Kept { result, a_n, crack_path } = kept;
    // Tables and figures first: what a full disk cuts off are pictures.
    write_file(&folder.join(csv::A_N_FILE), a_n.as_bytes())?;
    write_file(&folder.join(CRACK_PATH_FILE), crack_path.as_bytes())?;
    if factors::are_known(prediction) {
        write_file(&folder.join(factors::FACTORS_FILE), factors::factors(case, prediction)?.as_bytes())?;
        if let Some(beta) = factors::beta(case, prediction) {
            write_file(&folder.join(factors::BETA_FILE), beta.as_bytes())?;
        }
    }
    write_file(&folder.join(json::RESULT_FILE), format!("{result:#}\n").as_bytes())?;
    let mut input = provenance::table_of(&case.echo);
    let fitted = input.get_mut("fatigue").and_then(|fatigue| fatigue.as_table_mut()?.get_mut("fitted"));
    if let Some(record) = fitted.filter(|record| record.is_table()) {
        // A record that came with no file stands in one beside it.
        *record = RECORD.into();
    }
    provenance::write(folder, "predict", input, &case.provenance)?;
    answers.write(folder, case)?;
    draw(folder, case, prediction, result, [a_n, crack_path])?;
    vtk::write_wanted(folder, case.output, &prediction.grid, &prediction.snapshots)
}

/// Bytes that a run of this case will write, roughly.
pub fn room(case: &Case) -> Room {
    let texts: usize = case.provenance.files.iter().map(|file| file.content.len()).sum();
    let tables = 32_000 + texts as u64;
    Room { tables, all: tables + needs::of_case(case).disk_bytes as u64 }
}

/// The pictures of a run: plate, crack length, K and rates; damage where bonds drive the cracks by their own strain; nodes and stress of a
/// plate of nodes.
fn draw(folder: &Path, case: &Case, prediction: &Prediction, result: &Value, [a_n, path]: [&str; 2]) -> Result<()> {
    let tables = RunTables::read([a_n, csv::A_N_FILE], [path, CRACK_PATH_FILE])?;
    let put = |name: &str, text: &str| write_file(&folder.join(name), text.as_bytes());
    put("a_n.svg", &a_n_svg(result, &tables, LARGE))?;
    if let Some(k) = k_svg(result, &tables, LARGE) {
        put("k.svg", &k)?;
    }
    // Of the tip that leads, whose rate the law is of.
    let points: Vec<(f64, f64)> =
        prediction.curve.iter().map(|row| (row.delta_k / MPA_SQRT_M, row.growth_rate / MM_PER_CYCLE)).collect();
    if points.iter().any(|(x, y)| *x > 0.0 && *y > 0.0) {
        let rates = Series { name: "predicted, one point per cycle block".to_owned(), mark: Mark::Dots, points };
        chart::growth_rate(&folder.join("da_dn.svg"), &format!("{}: growth rate", case.name), &[rates])?;
    }
    if let Some(spectrum) = &case.loading.spectrum {
        put("spectrum.svg", &spectrum_svg(spectrum, LARGE))?;
    }
    let paths: Vec<Vec<Point>> = csv::paths(prediction, &case.specimen.cracks)
        .into_iter()
        .map(|path| path.into_iter().map(|(_, position)| position).collect())
        .collect();
    let plate = Plate::of(case);
    put("plate.svg", &plate_svg(&plate, &tables, plate::SIZE))?;
    if let Some(section) = section_svg(case, prediction) {
        put("section.svg", &section)?;
    }
    if case.output.animation {
        put("growth.svg", &growth_svg(&plate, result, &tables, plate::MOVING))?;
    }
    if let Some(snapshot) = prediction.snapshots.last().filter(|_| case.spends_bond_life()) {
        let (cracks, caption) = (&case.specimen.cracks, cycles_and_length(snapshot));
        DamagePicture { grid: &prediction.grid, snapshot, cracks, paths: &paths, caption: &caption }
            .write(&folder.join("damage.svg"))?;
    }
    match stress_field(case, prediction) {
        Ok(Some(field)) => put("stress.svg", &stress_svg(&field, &case.material))?,
        Ok(None) => {}
        // The answer counts without this picture.
        Err(error) => tracing::warn!("stress.svg is left out: {error}"),
    }
    if matches!(case.model, Model::Nodes(_)) {
        put("nodes.svg", &nodes_svg(case, &paths)?)?;
        if let Some(around_tip) = tip_svg(case, &paths)? {
            put("nodes_tip.svg", &around_tip)?;
        }
    }
    Ok(())
}

/// What came of a run, in words.
pub fn words(case: &Case, prediction: &Prediction, lives: &Lives, quality: &Quality) -> Vec<String> {
    let checks = checks::of_run(case, prediction);
    let cycles = prediction.life().map(|life| lives.life_words().unwrap_or_else(|| format!("{life:.1} cycles")));
    let mut lines = vec![
        match cycles {
            _ if breaks_at_once(case, prediction).is_some() => format!("{}: no life, the first load breaks the plate", case.name),
            Some(life) if refusal(case, prediction).is_some() => {
                format!("{}: no life that counts, {life} were computed", case.name)
            }
            Some(life) if prediction.stop == StopReason::EnteredHole => format!("{}: {life} to the hole", case.name),
            Some(life) if checks::is_bound_below(case, prediction) => format!("{}: life at least {life}", case.name),
            Some(life) if prediction.stop.is_lower_bound() => format!("{}: {life} to the end of the run", case.name),
            Some(life) => format!("{}: life {life}", case.name),
            None => format!("{}: life unlimited", case.name),
        },
        format!("  crack length   {}", length_words(case, prediction)),
        format!("  stopped        {}: {}", prediction.stop, prediction.stop.meaning()),
        format!("  verdict        {}", checks::verdict(&checks)),
    ];
    lines.extend(through_words(case, prediction).map(|words| format!("  break-through  {words}")));
    lines.extend(phase_words(prediction).map(|words| format!("  phase I        {words}")));
    lines.extend(spectrum::words(case, prediction).map(|passes| format!("  spectrum       {passes}")));
    lines.extend(lives.words());
    lines.extend(fit_use::law_line(case).map(|law| format!("  law            {law}")));
    lines.extend(zone_words(case, prediction).map(|zone| format!("  plastic zone   {zone}")));
    lines.extend(quality.words(case));
    lines.push(format!("  computed       {}", computed(case, prediction)));
    lines
}

/// Both parts of a life that begins before its cracks have formed.
fn phase_words(prediction: &Prediction) -> Option<String> {
    let phase = prediction.phase_one?;
    let [x, y] = phase.at.map(|x| x / MM);
    let concentration = phase.concentration.map_or_else(String::new, |k| format!(", {k:.2} times the gross stress"));
    let local = format!("local stress range {:.1} MPa at ({x:.2}, {y:.2}) mm{concentration}", phase.range / MPA);
    Some(match phase.cycles {
        Some(cycles) if cycles <= prediction.life_cycles() => {
            format!(
                "{cycles:.1} cycles until the cracks have formed ({local}); phase II {:.1}",
                prediction.life_cycles() - cycles
            )
        }
        Some(cycles) => format!("{cycles:.1} cycles, beyond the end of the run ({local})"),
        None => format!("without end, no crack forms ({local})"),
    })
}

/// Warnings of a run that its checks say in a line each.
pub fn told_by_checks(case: &Case, prediction: &Prediction) -> Vec<String> {
    let yielding = plastic_zone::warnings(case, &prediction.curve).into_iter().filter(|line| line.starts_with("small-scale"));
    let cross_check = prediction.cross_check.and_then(|check| check.warning());
    yielding.chain(cross_check).chain(fit_use::extrapolated(case, prediction)).collect()
}

/// How far the crack grew: by the length of the standard of the specimen, or that of the crack whose tip leads, and what all of them sum to.
fn length_words(case: &Case, prediction: &Prediction) -> String {
    let (from, to) = (case.specimen.crack_length / MM, prediction.crack_length_final() / MM);
    let depths = case.specimen.part_through.zip(prediction.curve.last().and_then(|row| row.depth));
    let depths = depths.map(|(flaw, last)| format!(", depth {:.3} mm to {:.3} mm", flaw.depth / MM, last.depth / MM));
    let of_standard = || format!("{from:.3} mm to {to:.3} mm{}", depths.as_deref().unwrap_or_default());
    match prediction.leading_tip(&case.specimen) {
        // Of one crack the length is that from where its specimen counts it.
        Some(_) if case.specimen.convention == LengthConvention::MeanOfTips && case.specimen.tips.len() == 1 => of_standard(),
        Some((tip, [first, last])) => {
            let all = if case.specimen.crack_lines().len() > 1 {
                format!("; all cracks {from:.3} mm to {to:.3} mm")
            } else {
                String::new()
            };
            format!("tip {tip}: its crack {:.3} mm to {:.3} mm{all}", first / MM, last / MM)
        }
        None => of_standard(),
    }
}

/// When a crack was through, and what the error of its K does to the life.
fn through_words(case: &Case, prediction: &Prediction) -> Option<String> {
    let found = PartThroughLife::of(case, &prediction.curve)?;
    let [shorter, longer] = found.life_factors.map(|factor| factor * prediction.life_cycles());
    let longer = if longer.is_finite() { format!("{longer:.0}") } else { "no end".to_owned() };
    let when = if found.is_through { format!("after {:.1} cycles (a/t = 1)", found.cycles) } else { "not reached".to_owned() };
    Some(format!("{when}; with K of the part-through crack ±{:.0} % life {shorter:.0} to {longer}", 100.0 * STATED_ERROR))
}

/// Plastic zone at start and end against ligament, thickness and horizon; `None` without yield strength.
fn zone_words(case: &Case, prediction: &Prediction) -> Option<String> {
    let PlasticZone { first, last, .. } = plastic_zone::plastic_zone(case, &prediction.curve)?;
    let (horizon, thickness) = (prediction.figures.horizon, case.specimen.thickness);
    let (room, name) = last.room();
    let of_horizon = if horizon > 0.0 { format!(", {:.2} of the horizon", last.size / horizon) } else { String::new() };
    Some(format!(
        "{:.3} mm to {:.3} mm ({:.3} of the {name}, {:.2} of the thickness{of_horizon})",
        first.size / MM,
        last.size / MM,
        last.size / room,
        last.size / thickness
    ))
}

fn computed(case: &Case, prediction: &Prediction) -> String {
    let figures = &prediction.figures;
    match case.model {
        Model::Points(_) => format!(
            "{} points, {} cycle blocks, {} solves, {:.1} s",
            figures.points, figures.blocks, figures.solves, figures.wall_s
        ),
        Model::Nodes(_) => format!(
            "up to {} nodes, {} cycle blocks, {} solves, {:.2} s",
            figures.points, figures.blocks, figures.solves, figures.wall_s
        ),
        Model::Handbook(_) => {
            let of_front = case.specimen.part_through.map(|_| SOURCE);
            let formula = handbook(&case.specimen).map(|formula| formula.name).or(of_front).unwrap_or("");
            if figures.solves > 0 {
                let (points, rows) = (figures.points, figures.blocks + 1);
                let nodes = format!("then {} solves on up to {points} nodes", figures.solves);
                return format!("by hand calculation: {formula}, {nodes}, {rows} rows, {:.2} s", figures.wall_s);
            }
            format!("by hand calculation: {formula}, {} rows, {:.2} ms", figures.blocks + 1, 1e3 * figures.wall_s)
        }
    }
}

/// Table of the residual strength.
pub const RESIDUAL_STRENGTH_FILE: &str = "residual_strength.csv";

/// Unit of the load in columns and in the picture, its name there, and its size.
fn unit(case: &Case) -> (&'static str, &'static str, f64) {
    match case.specimen.load_measure {
        LoadMeasure::Stress => ("mpa", "Residual strength (gross stress), MPa", MPA),
        LoadMeasure::Force => ("kn", "Residual strength (force), kN", KN),
    }
}

/// `crack_length_mm,residual_strength_*,by_toughness_*,by_net_section_*,governed_by` with `mpa` of gross stress or `kn` of force;
/// empty where a strength is not known.
pub fn strength_table(case: &Case, curve: &[Strength]) -> String {
    let (unit, _, size) = unit(case);
    let mut text = format!("crack_length_mm,residual_strength_{unit},by_toughness_{unit},by_net_section_{unit},governed_by\n");
    let field = |load: Option<f64>| load.map_or_else(String::new, |load| csv::number(load / size));
    for strength in curve {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{},{},{},{},{}",
            csv::number(strength.crack_length / MM),
            csv::number(strength.load() / size),
            field(strength.by_toughness),
            field(strength.by_net_section),
            strength.governed_by()
        );
    }
    text
}

/// Writes `residual_strength.csv` and its picture into the folder of a run.
pub fn write_strength(folder: &Path, case: &Case, curve: &[Strength]) -> Result<()> {
    write_file(&folder.join(RESIDUAL_STRENGTH_FILE), strength_table(case, curve).as_bytes())?;
    let (_, axis, size) = unit(case);
    let series = |name: &str, mark, pick: &dyn Fn(&Strength) -> Option<f64>| Series {
        name: name.to_owned(),
        mark,
        points: curve.iter().filter_map(|s| Some((s.crack_length / MM, pick(s)? / size))).collect(),
    };
    let all = [
        series("residual strength", Mark::Line, &|s| Some(s.load())),
        series("by toughness", Mark::Dashes, &|s| s.by_toughness),
        series("by net-section yield", Mark::Dashes, &|s| s.by_net_section),
        series("maximum load of the cycle", Mark::Dots, &|s| Some(case.loading.at(s.crack_length))),
        series("required strength", Mark::Dashes, &|s| case.stop.required.map(|factor| factor * case.loading.at(s.crack_length))),
    ];
    let known: Vec<Series> = all.into_iter().filter(|series| !series.points.is_empty()).collect();
    let title = format!("{}: residual strength", case.name);
    chart::linear(&folder.join("residual_strength.svg"), &title, ["Crack length a, mm", axis], &known)
}
