//! `perilife sif`: stress intensity factors of every crack tip; on nodes also the stress of the plate, with or without cracks.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use super::console::Console;
use crate::case::budget::Budget;
use crate::case::{Case, Method};
use crate::error::{Error, Result, input};
use crate::fatigue::crack_tip::TipState;
use crate::input::Document;
use crate::predict::tip_factors::{MethodResult, StressIntensityMethod, TipResult, stress_intensity};
use crate::report::output::{OutputFolder, RunKind};
use crate::report::stresses;
use crate::stress_concentration::{Stressed, stressed};
use crate::units::{MM, MPA, MPA_SQRT_M};

/// Arguments of `perilife sif`.
#[derive(Debug, clap::Args)]
#[command(
    after_long_help = "On nodes (--method element_free_galerkin) a plate needs no crack: printed are the largest and least stress along every rim, where they\n\
                       are, and the stress concentration over the gross stress. DIR gets result.json, von_mises.png, nodes.svg and paraview/run.pvd."
)]
pub struct Args {
    /// Case file (a calibration file does as well); its fatigue law is not needed
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// Methods: ring, element_free_galerkin, energy_release; all where none is given
    #[arg(long, value_name = "METHOD", num_args = 1.., help_heading = "Method")]
    pub method: Vec<String>,
    /// Folder for stress and displacement of the plate on nodes (with --method element_free_galerkin); replaced if an earlier run made it
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub out: Option<PathBuf>,
    /// Override a key of the case (repeatable), e.g. --set specimen.crack_length_mm=20
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE", help_heading = "Input")]
    pub set: Vec<String>,
    /// What is printed.
    #[command(flatten)]
    pub console: Console,
}

/// Runs `perilife sif`.
///
/// # Errors
/// Wrong input, mechanics without equilibrium, or no method that gives a factor of any tip.
pub fn run(args: &Args) -> Result<()> {
    let document = Document::read(&args.case, &args.set)?;
    let found = run_on(&document, &args.method, args.out.as_deref(), &args.console)?;
    args.console.object(&found)
}

/// Factors and stresses of the case of a document, by these methods or by all: the object of `--json`.
pub fn run_on(document: &Document, method: &[String], out: Option<&Path>, console: &Console) -> Result<Value> {
    let methods = methods(method)?;
    let case = Case::plate_of(document)?;
    Budget::of(&case).within_machine().map_err(|error| document.locate(error))?;
    let is_on_nodes = methods == [StressIntensityMethod::ElementFreeGalerkin]
        || method.is_empty() && case.model.method == Method::ElementFreeGalerkin;
    let has_cracks = case.specimen.tips.iter().any(|tip| !tip.from_slot);
    // Claimed first: a folder that cannot be written should not cost a run.
    let folder = out.map(|out| claim(out, &case, &methods)).transpose()?;
    for warning in case.warnings.iter().map(String::as_str).chain(folder.as_ref().and_then(OutputFolder::warning)) {
        console.warn(warning);
    }
    let mut found = Map::new();
    if has_cracks || !is_on_nodes {
        let tips = stress_intensity(&case, &methods).map_err(|error| document.locate(error))?;
        tell_tips(&case, &tips, console)?;
        found.insert("tips".to_owned(), tips.iter().map(object).collect());
    }
    if folder.is_some() || !has_cracks {
        let stressed = stressed(&case).map_err(|error| document.locate(error))?;
        tell_stresses(&case, &stressed, console)?;
        found.insert("stresses".to_owned(), stresses::object(&stressed));
        if let Some(mut folder) = folder {
            let result = Value::Object(found.clone());
            folder.fill(|path| stresses::write(path, &case, &stressed, &result))?;
            console.say(&format!("results in {}", folder.name().display()));
            drop(folder.finish()?);
        }
    }
    Ok(Value::Object(found))
}

/// The folder for stresses on nodes.
fn claim(out: &Path, case: &Case, methods: &[StressIntensityMethod]) -> Result<OutputFolder> {
    if !methods.contains(&StressIntensityMethod::ElementFreeGalerkin) {
        let problem = "takes the stress of the plate on nodes, and no method has nodes";
        return Err(input("--out", out.display(), problem, "add --method element_free_galerkin, or leave --out out"));
    }
    OutputFolder::claim(out, RunKind::Sif, &case.provenance, stresses::room(case))
}

fn tell_tips(case: &Case, tips: &[TipResult], console: &Console) -> Result<()> {
    let results = || tips.iter().flat_map(|tip| &tip.methods);
    if results().all(|result| result.intensity.k_i.is_none()) {
        let notes: Vec<&str> = results().filter_map(|result| result.note.as_deref()).collect();
        return Err(Error::Mechanics(format!("{}: {}", case.name, notes.first().unwrap_or(&"no method gives a factor"))));
    }
    let mut said: Vec<String> = Vec::new();
    for result in results() {
        let Some(words) = result.note.as_ref().map(|note| format!("{}: {note}", result.method)) else { continue };
        if !said.contains(&words) {
            console.warn(&words);
            said.push(words);
        }
    }
    console.result(&table(tips))
}

fn tell_stresses(case: &Case, stressed: &Stressed, console: &Console) -> Result<()> {
    stresses::warnings(stressed).iter().for_each(|warning| console.warn(warning));
    console.result(&stresses::table(stressed))?;
    let gross = stressed.gross.map_or(String::new(), |gross| format!(", gross stress {:.3} MPa", gross / MPA));
    let settled = stressed.change.map_or(String::new(), |change| format!(", last change {:.2} %", 100.0 * change));
    let (nodes, solves) = (stressed.nodes, stressed.solves);
    let moved = stressed.moved.0 / MM;
    console
        .say(&format!("{}: {nodes} nodes after {solves} solves{settled}{gross}; largest displacement {moved:.6} mm", case.name));
    Ok(())
}

/// The methods of these names, each once; all where no name is given.
fn methods(names: &[String]) -> Result<Vec<StressIntensityMethod>> {
    let mut methods: Vec<StressIntensityMethod> = Vec::new();
    for name in names {
        let method = name.parse()?;
        if !methods.contains(&method) {
            methods.push(method);
        }
    }
    Ok(if methods.is_empty() { StressIntensityMethod::ALL.to_vec() } else { methods })
}

fn in_mpa(factor: Option<f64>) -> Option<f64> {
    factor.map(|k| k / MPA_SQRT_M)
}

fn object(tip: &TipResult) -> Value {
    let mut methods = Map::new();
    for MethodResult { method, intensity, t_stress, is_closed, note, wall_s } in &tip.methods {
        let mut entry = json!({
            "k_i_mpa_sqrt_m": in_mpa(intensity.k_i), "k_ii_mpa_sqrt_m": in_mpa(intensity.k_ii), "wall_s": wall_s
        });
        if *is_closed {
            entry["state"] = json!(TipState::Closed.name());
        }
        if let Some(t_stress) = t_stress {
            entry["t_stress_mpa"] = json!(t_stress / MPA);
        }
        if let Some(note) = note {
            entry["note"] = json!(note);
        }
        methods.insert(method.name().to_owned(), entry);
    }
    let [x, y] = tip.tip.position;
    json!({
        "x_mm": x / MM, "y_mm": y / MM, "direction": tip.tip.direction,
        "methods": methods, "handbook_k_i_mpa_sqrt_m": in_mpa(tip.handbook_k_i)
    })
}

/// One line a tip and method; K in MPa√m.
fn table(tips: &[TipResult]) -> String {
    let mut text = format!(
        "{:>10} {:>10}  {:<14} {:>12} {:>12} {:>9} {:>12} {:>8}\n",
        "x_mm", "y_mm", "method", "K_I MPa√m", "K_II MPa√m", "T MPa", "handbook K_I", "time s"
    );
    let words = |factor: Option<f64>| in_mpa(factor).map_or_else(|| "-".to_owned(), |k| format!("{k:.4}"));
    for tip in tips {
        let [x, y] = tip.tip.position.map(|metres| metres / MM);
        for result in &tip.methods {
            // Writing to a String cannot fail.
            let _ = writeln!(
                text,
                "{x:>10.4} {y:>10.4}  {:<14} {:>12} {:>12} {:>9} {:>12} {:>8.2}",
                result.method,
                words(result.intensity.k_i),
                words(result.intensity.k_ii),
                result.t_stress.map_or_else(|| "-".to_owned(), |t| format!("{:.2}", t / MPA)),
                words(tip.handbook_k_i),
                result.wall_s
            );
        }
    }
    text
}
