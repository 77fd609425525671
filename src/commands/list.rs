//! `perilife list`: every kind of every key.

use crate::bond_law::{BondLawKind, Kernel, Rotation, SurfaceCorrection};
use crate::case::{Discretisation, Failure, Method, Symmetry};
use crate::error::Result;
use crate::fatigue::{Ageing, BlockKind, Precrack};
use crate::kinds::KindLine;
use crate::loading::LoadingKind;
use crate::material::{Plane, library};
use crate::predict::StopReason;
use crate::solver::SolverKind;
use crate::specimen::{Component, Edge, Ends, SpecimenKind};

/// List every kind that an input file can name
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Print one JSON object on stdout
    #[arg(long)]
    pub json: bool,
}

/// Every line, in the order of an input file.
#[must_use]
pub fn lines() -> Vec<(String, String, String)> {
    let groups: [Vec<KindLine>; 7] = [
        SpecimenKind::lines(),
        vec![SpecimenKind::not_covered()],
        Ends::lines(),
        Plane::lines(),
        LoadingKind::lines(),
        Edge::lines(),
        Component::lines(),
    ];
    let later: [Vec<KindLine>; 13] = [
        Method::lines(),
        BondLawKind::lines(),
        Kernel::lines(),
        Rotation::lines(),
        SurfaceCorrection::lines(),
        Discretisation::lines(),
        Symmetry::lines(),
        SolverKind::lines(),
        Ageing::lines(),
        Precrack::lines(),
        BlockKind::lines(),
        Failure::lines(),
        StopReason::lines(),
    ];
    let words = |line: KindLine| (line.key.to_owned(), line.name.to_owned(), line.meaning.to_owned());
    let mut all: Vec<_> = groups.into_iter().flatten().map(words).collect();
    all.extend(library::names().into_iter().map(|name| {
        let meaning = library::find(&name, std::path::Path::new("")).map_or_else(
            |error| error.to_string(),
            |file| format!("{}; E {} GPa, nu {}", file.title, file.youngs_modulus_gpa.value, file.poisson_ratio.value),
        );
        ("material.name".to_owned(), name, meaning)
    }));
    all.extend(later.into_iter().flatten().map(words));
    all
}

/// Prints the list in aligned columns, or as JSON.
pub fn run(args: &Args) -> Result<()> {
    let lines = lines();
    if args.json {
        let kinds: Vec<_> = lines.iter().map(|(key, name, meaning)| serde_json::json!({ "key": key, "name": name, "meaning": meaning })).collect();
        println!("{:#}", serde_json::json!({ "kinds": kinds }));
        return Ok(());
    }
    let widest = |pick: fn(&(String, String, String)) -> &String| lines.iter().map(|line| pick(line).chars().count()).max().unwrap_or(0);
    let (key_width, name_width) = (widest(|line| &line.0), widest(|line| &line.1));
    for (key, name, meaning) in &lines {
        println!("{key:<key_width$}  {name:<name_width$}  {meaning}");
    }
    Ok(())
}
