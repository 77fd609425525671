//! Every kind of every key of the input files.

use serde_json::{Map, Value, json};

use perilife_base::input::Folder;
use perilife_base::keys::told::{self, Told};
use perilife_base::keys::{Key, Need, Section};
use perilife_base::kinds::KindLine;
use perilife_base::units::shown;
use perilife_base::units::us::System;
use perilife_calibration::case::MeasuredKeys;
use perilife_calibration::exponent::FitKeys;
use perilife_calibration::laws::case::{LawKeys, RatesKeys};
use perilife_calibration::rates::RateMethod;
use perilife_calibration::sweep::{DesignKeys, VaryKeys};
use perilife_growth::case;
use perilife_growth::case::record::FittedLaw;
use perilife_growth::predict::StopReason;
use perilife_growth::predict::tip_factors::StressIntensityMethod;
use perilife_laws::growth_law::GrowthLawKind;
use perilife_laws::growth_law::description::Constant;
use perilife_laws::retardation::{Constant as Retarding, RetardationKind};
use perilife_plate::loading::{LoadingKind, SupportEntry};
use perilife_plate::material::growth_data::{self, GrowthRecord};
use perilife_plate::material::{Plane, library};
use perilife_plate::specimen::beta;
use perilife_plate::specimen::keys::BETA_FILE;
use perilife_plate::specimen::{Edge, SpecimenKind};
use perilife_points::bond_law::BondLawKind;
use perilife_points::crack_tip::TipState;
use perilife_points::solver::SolverUsed;
use perilife_results::paper::Signed;
use perilife_scenes::SceneEnd;
use perilife_scenes::scene::PointLaw;

/// Kinds that pins or rollers load, by a force.
const BY_FORCE: [SpecimenKind; 5] = {
    use SpecimenKind::{CompactTension, EccentricSingleEdgeTension, Lug, SingleEdgeBend, WedgeOpening};
    [CompactTension, EccentricSingleEdgeTension, Lug, SingleEdgeBend, WedgeOpening]
};

/// Every line, in the order of an input file: key, name, meaning.
pub fn lines() -> Vec<(String, String, String)> {
    let of_keys = told().into_iter().chain(beside()).flat_map(|told| told.choices());
    let of_others = [
        PointLaw::lines(),
        BondLawKind::lines(),
        System::lines(),
        FittedLaw::lines(),
        RateMethod::lines(),
        SolverUsed::lines(),
        StopReason::lines(),
        TipState::lines(),
        SceneEnd::lines(),
        StressIntensityMethod::lines(),
    ];
    let words = |line: KindLine| (line.key.to_owned(), line.name.to_owned(), line.meaning.to_owned());
    let of_all = SpecimenKind::lines().into_iter().chain(of_keys).chain(of_others.into_iter().flatten());
    let mut all: Vec<(String, String, String)> = Vec::new();
    for line in of_all.map(words) {
        // Of a name that cases and scenes know the first meaning is told; a load has both.
        let is_told = |known: &(String, String, String)| known.2 == line.2 || line.0 != LoadingKind::KEY;
        if !all.iter().any(|known| (&known.0, &known.1) == (&line.0, &line.1) && is_told(known)) {
            all.push(line);
        }
    }
    all.extend(library::names().into_iter().map(|name| {
        let meaning = library::find(&name, &Folder::none()).map_or_else(
            |error| error.to_string(),
            |file| {
                shown::told(&format!("{}; E {} GPa, nu {}", file.title, file.youngs_modulus_gpa.value, file.poisson_ratio.value))
            },
        );
        ("material.name".to_owned(), name, meaning)
    }));
    let record = |record: GrowthRecord| {
        let meaning = format!("{}; with growth data, {}", record.title(), record.checked());
        ("material.name".to_owned(), record.name, meaning)
    };
    all.extend(growth_data::records().into_iter().map(record));
    all.push((
        "specimen.outline_file".to_owned(),
        "part.dxf".to_owned(),
        "a plate from a DXF drawing: layers outline, holes (full circles), cracks".to_owned(),
    ));
    all.push((
        beta::KEY.to_owned(),
        "beta.csv".to_owned(),
        "table crack_length_mm,beta (K = β σ √(πa)); `perilife sif --sweep` writes one".to_owned(),
    ));
    all
}

/// Every section of case and calibration files with its keys.
pub fn told() -> Vec<Told> {
    let told = |section: &str, meaning: &str, keys: Vec<Key>| {
        let is_needed = ["material", "loading"].contains(&section);
        Told { section: section.to_owned(), meaning: meaning.to_owned(), tag: None, is_needed, keys }
    };
    let of_kind = |kind: &SpecimenKind| {
        let beta = kind.takes_beta().then_some(BETA_FILE);
        let keys = kind.keys().iter().copied().chain(beta).collect();
        Told { tag: Some(("kind", kind.name())), is_needed: true, ..told(&format!("specimen.{kind}"), kind.meaning(), keys) }
    };
    let meaning = |section: &str| match section {
        "material" => "Material: a name, constants, or both (constants override the name's)",
        "loading" => "Cyclic load, displacement or spectrum, and where it acts",
        "model" => "Method and resolution",
        "fatigue" => "Growth law, driver, initiation",
        "stop" => "End of the analysis",
        "fleet" => "A fleet: scatter of cracks, loads and laws",
        _ => "Additional result files",
    };
    let sides = Edge::ALL.iter().map(|edge| Key::of_choice::<SupportEntry>(edge.name(), "Support of this side"));
    let measured = [MeasuredKeys::KEYS, RatesKeys::KEYS].concat().into_iter().map(|key| Key { need: Need::Optional, ..key });
    let fit = FitKeys::KEYS.iter().copied().chain(LawKeys::KEYS[1..].iter().copied());
    let mut all: Vec<Told> = SpecimenKind::ALL.iter().map(of_kind).collect();
    all.extend(case::keys().into_iter().map(|(section, keys)| told(section, meaning(section), keys)));
    all.push(told("supports", "Supported sides of a plate, by name", sides.collect()));
    all.push(told("measured", "Test data of a calibration: a-N readings, or tables of rates", measured.collect()));
    all.push(told("fit", "Fit: law, exponent, criterion", fit.collect()));
    all
}

/// Sections of sweeps, of scenes (their own keys) and of report data.
pub fn beside() -> Vec<Told> {
    let told = |file: &str, section: &str, keys: &[Key]| {
        let (section, meaning) = (format!("{file}.{section}"), format!("Section of a {file}"));
        Told { section, meaning, tag: None, is_needed: false, keys: keys.to_vec() }
    };
    let sweep = [("design", DesignKeys::KEYS), ("vary[]", VaryKeys::KEYS)].map(|(section, keys)| told("sweep", section, keys));
    sweep
        .into_iter()
        .chain(perilife_scenes::read::keys().into_iter().map(|(section, keys)| told("scene", section, keys)))
        .chain([Told {
            section: "report".to_owned(),
            meaning: "Report data (`report --data`)".to_owned(),
            ..told("", "", Signed::KEYS)
        }])
        .collect()
}

pub fn schema() -> Value {
    told::schema("perilife case or calibration", &told())
}

pub fn manual() -> String {
    told().iter().chain(&beside()).map(Told::manual).collect()
}

/// Every section as a class of the Python package.
pub fn stub() -> String {
    let head = "\"\"\"Sections of input files as dicts (written by a test from the keys of the program).\"\"\"\n\nfrom __future__ import annotations\n\n\
                from typing import TYPE_CHECKING, Literal, TypedDict\n\nif TYPE_CHECKING:\n    from typing_extensions import Required\n\n\n";
    format!("{head}{}", told().iter().map(Told::stub).collect::<String>().trim_end().to_owned() + "\n")
}

/// Such lines as one object, with what forms are made from: schema, traits of specimens, constants of laws and models of retardation.
pub fn json(lines: Vec<(String, String, String)>) -> Value {
    let kinds = lines.into_iter().map(|(key, name, meaning)| json!({ "key": key, "name": name, "meaning": meaning }));
    let of_law = |own: &Constant| json!({ "key": own.key, "needed": own.default.is_none() });
    // A threshold of the law, which it may have, is taken for a constant.
    let of_model = |own: &Retarding| json!({ "key": own.key, "needed": (own.default)(Plane::Stress, Some(1.0)).is_none() });
    let told = |name: &str, constants: Vec<Value>| json!({ "name": name, "constants": constants });
    let retardation = |model: RetardationKind| told(model.name(), model.0.constants.iter().map(of_model).collect());
    let traits = |kind: &SpecimenKind| {
        let (force, bending, part_through) = (BY_FORCE.contains(kind), kind.takes_bending(), kind.part_through().is_some());
        json!({ "name": kind.name(), "takes_force": force, "takes_bending": bending, "is_part_through": part_through })
    };
    let beside: Map<String, Value> = beside().iter().map(|told| (told.section.clone(), told.schema())).collect();
    json!({
        "kinds": kinds.collect::<Vec<_>>(),
        "specimens": SpecimenKind::ALL.iter().map(traits).collect::<Vec<_>>(),
        "others": beside,
        "laws": GrowthLawKind::all().map(|law| told(law.name(), law.0.constants.iter().map(of_law).collect())).collect::<Vec<_>>(),
        "form": schema(),
        "retardations": RetardationKind::all().map(retardation).collect::<Vec<_>>(),
    })
}
