//! An input file to a checked [`Case`]: each room reads its section, then the sections are checked against each other.

use std::path::{Path, PathBuf};

use toml::{Table, Value};

use super::fatigue::StopKeys;
use super::fatigue_keys::{FatigueKeys, key_that_asks_for_bonds};
use super::fleet::{Fleet, FleetKeys};
use super::model_keys::{ModelKeys, on_nodes};
use super::{
    Case, Choices, Engine, LawSource, Method, boundaries, choose, fatigue, law, law_source, model, pins, remove_law, residual,
};
use crate::case::record::FittedRecord;
use perilife_base::error::{Error, InputError, Result, input, input_missing};
use perilife_base::input::{
    Document, Folder, ForeignSections, LEVELS_OF_SCENES, OF_SCENES, OpenedFile, Output, Provenance, Sections, value_at,
};
use perilife_base::keys::{self, Given, Key, Section};
use perilife_base::units::{MM, MM_PER_CYCLE, MPA};
use perilife_laws::growth_law::description::law_keys;
use perilife_laws::growth_law::{FactorLaw, GrowthLaw, GrowthLawKind, Walker, doubt};
use perilife_laws::paris::ParisLaw;
use perilife_laws::retardation::{Retardation, retardation_keys};
use perilife_plate::loading::LoadingKind;
use perilife_plate::{loading, material, specimen};
use perilife_points::bond_law::SurfaceCorrection;

/// What a record is called that came with no file.
pub const RECORD: &str = "fitted.toml";
/// Sections of a case file.
pub const SECTIONS: &[&str] = &["specimen", "material", "loading", "supports", "model", "fatigue", "stop", "fleet", "output"];

/// Sections of other files.
const STRANGERS: &[ForeignSections] = &[
    (&["refinement"], "is a section of fracture scenes: a fatigue case has points of one spacing", LEVELS_OF_SCENES),
    (
        &["measured", "fit"],
        "is a section of calibration files, not of cases",
        "run `perilife calibrate` on it, or remove the section",
    ),
    (
        &["damage", "micro_cracks"],
        "is a section of fracture scenes, not of fatigue cases",
        "run `perilife fracture` on it, or remove the section",
    ),
];

impl Case {
    /// Reads a case file; `overrides` are `section.key=value`.
    pub fn from_file(path: &Path, overrides: &[String]) -> Result<Self> {
        Self::from_document(&Document::read(path, overrides)?)
    }

    /// Reads a case from text; files it names lie in `folder`.
    pub fn from_toml(text: &str, name: &str, folder: impl Into<Folder>, overrides: &[String]) -> Result<Self> {
        Self::from_document(&Document::parse(text, name, folder, overrides)?)
    }

    /// Reads a case from a parsed document, which gives errors their line. The case must have a fatigue law.
    pub fn from_document(document: &Document) -> Result<Self> {
        Self::complete(document).map_err(|error| document.locate(error))
    }

    /// The same, with errors that do not know their line.
    pub fn complete(document: &Document) -> Result<Self> {
        let case = Self::from_table(document.table.clone(), &document.name, &document.folder)?;
        if matches!(&case.law, LawSource::Missing(path) if path.as_os_str().is_empty()) {
            // Says what is missing and what to give.
            return Err(law::missing(case.model.method(), Path::new("")));
        }
        Ok(case)
    }

    /// Reads a case from text whose law is that of `record`, whatever its own says; files it names lie in `folder`.
    pub fn from_toml_with_law(text: &str, name: &str, folder: impl Into<Folder>, record: FittedRecord) -> Result<Self> {
        let mut document = Document::parse(text, name, folder, &[])?;
        remove_law(&mut document.table);
        let read = || Self::from_table(document.table.clone(), name, &document.folder)?.with_law(record);
        read().map_err(|error| document.locate(error))
    }

    /// Builds a case from a table of sections. Errors name the key; file and line are named by who has the text
    /// ([`Document::locate`]).
    ///
    /// A table without fatigue law is accepted, since a calibration has none yet: the law is then
    /// [`LawSource::Missing`] with an empty path.
    pub fn from_table(table: Table, name: &str, folder: &Folder) -> Result<Self> {
        let case = Self::without_growth(table, name, folder)?;
        case.specimen.check_growth()?;
        Ok(case)
    }

    /// Specimen, material, load and model of a case or calibration file, of which nothing asks for the fatigue law, nor for a crack.
    pub fn plate_of(document: &Document) -> Result<Self> {
        let mut table = document.table.clone();
        table.remove("measured");
        table.remove("fit");
        remove_law(&mut table);
        Case::without_growth(table, &document.name, &document.folder).map_err(|error| document.locate(error))
    }

    /// The same on nodes, whatever method the file has; its keys of points are left out.
    pub fn plate_on_nodes(document: &Document) -> Result<Self> {
        let mut nodes = document.clone();
        on_nodes(&mut nodes.table, |key| document.is_overridden(key));
        Self::plate_of(&nodes)
    }

    /// As [`Case::from_table`], of a plate in which nothing need be able to grow: for its stress alone.
    pub fn without_growth(table: Table, name: &str, folder: &Folder) -> Result<Self> {
        refuse_scene(&table)?;
        let sections = Sections::of(&table, SECTIONS, STRANGERS)?;
        Error::of_all(mistakes(&sections))?;
        let echo = sections.echo()?;
        let mut warnings = Vec::new();
        let mut choices = Choices::default();
        let mut specimen = specimen::from_value(sections.required("specimen")?, folder, &mut warnings)?;
        let material = material::from_value(sections.required("material")?, folder, &mut warnings)?;
        let (of_loading, beside) = (sections.required("loading")?, retardation_keys());
        let loading = loading::from_values(of_loading, sections.given("supports"), (folder, &beside), &mut specimen)?;
        if let Some(file) = value_at(sections.required("specimen")?, "beta_file").and_then(Value::as_str) {
            specimen.read_beta(file, folder)?;
        }
        let (with_law, law_record) = law_source::expanded(sections.optional("fatigue"), folder)?.unzip();
        let section = with_law.as_ref().unwrap_or(sections.optional("fatigue"));
        let of_library = law_source::of_library(section, sections.required("material")?, specimen.thickness, folder)?;
        let (with_growth, growth_data) = of_library.unzip();
        let with_growth = with_growth.as_ref().unwrap_or(section);
        if key_that_asks_for_bonds(with_growth).is_none() {
            warnings.extend(specimen.leave_notch_ends());
        }
        let asked =
            choose::Sections { model: sections.optional("model"), fatigue: with_growth, output: sections.optional("output") };
        let (model, chosen) = model::from_value(&asked, (&specimen, &material, &loading), &mut choices, &mut warnings)?;
        let fatigue = fatigue::from_value(with_growth, model.method(), (&specimen, &material, &loading), folder, &mut choices)?;
        let stop = fatigue::stop_from_value(sections.optional("stop"), (&specimen, &material, &loading))?;
        let threshold = Some(fatigue.settings.threshold).filter(|threshold| *threshold > 0.0);
        let own = || match &fatigue.law {
            Some(LawSource::Factor(law)) => law.own_threshold(0.0),
            _ => None,
        };
        let retardation = Retardation::read(of_loading, &loading, &material, threshold.or_else(own))?;
        let mut case = Case {
            name: name.to_owned(),
            specimen,
            material,
            loading,
            model,
            chosen,
            fatigue: fatigue.settings,
            retardation,
            law: LawSource::Missing(PathBuf::new()),
            stop,
            fleet: sections.given("fleet").map(Fleet::from_value).transpose()?,
            output: Output::from_value(sections.optional("output"))?,
            warnings,
            echo,
            provenance: Provenance::default(),
            allow_extrapolation: fatigue.allow_extrapolation,
            lot: fatigue.lot,
            choices,
            law_record,
            growth_data,
        };
        pins::settle(&mut case)?;
        if matches!(case.engine(), Engine::Points | Engine::Handbook) && case.choices.surface_correction.is_none() {
            case.model.take_most_accurate_rim();
        }
        match fatigue.law {
            Some(LawSource::Fitted(record)) => law::adopt(&mut case, *record)?,
            Some(LawSource::Factor(law)) => {
                // Where the rate has no limit the plate breaks.
                let limits = [case.material.toughness, law.toughness()];
                case.material.toughness = limits.into_iter().flatten().min_by(f64::total_cmp);
                case.law = LawSource::Factor(law);
            }
            Some(source) => case.law = source,
            None => {}
        }
        model::check_law(&case)?;
        check_load(&case)?;
        if case.loading.spectrum.is_some() && case.spends_bond_life() {
            let problem = "is counted by da/dN of K, and bonds that lose life by their own strain have none";
            let remedy = "use fatigue.driver = \"tip_field\", with sharp cracks, or model.method = \"handbook\"";
            return Err(input("loading.kind", "\"spectrum\"", problem, remedy));
        }
        residual::check(&case)?;
        case.warnings.extend(boundaries::first_load_warning(&case).map(|line| format!("first load: {line}")));
        let lines = law_lines(&case)?;
        case.warnings.extend(lines);
        case.provenance = folder.opened().so_far();
        Ok(case)
    }

    /// The same case with the law of `record` and its rules about bond law, zone, stress ratio and elastic constants.
    pub fn with_law(mut self, record: FittedRecord) -> Result<Self> {
        let before = law_lines(&self)?;
        self.warnings.retain(|line| !before.contains(line));
        let fatigue = self.echo.as_object_mut().map(|case| case.entry("fatigue").or_insert_with(|| serde_json::json!({})));
        if let Some(keys) = fatigue.and_then(|fatigue| fatigue.as_object_mut()) {
            for key in law_keys() {
                keys.shift_remove(key);
            }
            keys.insert("fitted".into(), serde_json::to_value(&record).unwrap_or_default());
        }
        self.law_record = None;
        self.growth_data = None;
        if let Ok(text) = toml::to_string(&record) {
            let file = OpenedFile { name: RECORD.to_owned(), path: None, id: None, content: text.into_bytes().into() };
            self.provenance.files.push(file);
        }
        law::adopt(&mut self, record)?;
        model::check_law(&self)?;
        residual::check(&self)?;
        let lines = law_lines(&self)?;
        self.warnings.extend(lines);
        Ok(self)
    }
}

/// Sections of a case whose keys are one list, those of laws and of retardation not among them.
const KEYS: [(&str, &[Key]); 7] = [
    ("material", material::Input::KEYS),
    ("loading", loading::Input::KEYS),
    ("model", ModelKeys::KEYS),
    ("fatigue", FatigueKeys::KEYS),
    ("stop", StopKeys::KEYS),
    ("fleet", FleetKeys::KEYS),
    ("output", Output::KEYS),
];

/// Every section of a case but `[specimen]` and `[supports]` with its keys.
pub fn keys() -> Vec<(&'static str, Vec<Key>)> {
    let more = |section: &str| match section {
        "loading" => perilife_laws::retardation::keys_to_tell(),
        "fatigue" => perilife_laws::growth_law::description::keys_to_tell(),
        _ => Vec::new(),
    };
    let all = |(section, own): &(&'static str, &[Key])| {
        let is_new = |key: &Key| own.iter().all(|known| known.name != key.name);
        (*section, own.iter().copied().chain(more(section).into_iter().filter(is_new)).collect())
    };
    KEYS.iter().map(all).collect()
}

/// What is wrong with the keys of the sections by themselves, all of it at once.
fn mistakes(sections: &Sections<'_>) -> Vec<InputError> {
    let laws: Vec<&str> = law_keys().collect();
    let mut all = sections.given("specimen").map_or_else(Vec::new, specimen::mistakes);
    for (section, keys) in KEYS {
        let Some(value) = sections.given(section) else { continue };
        // What is no table was refused before.
        let Ok(given) = Given::of(value, section) else { continue };
        all.extend(match section {
            "loading" => loading::mistakes(value, &retardation_keys()),
            "fatigue" => keys::mistakes(given, keys, &laws, None),
            _ => keys::mistakes(given, keys, &[], None),
        });
    }
    all
}

/// A scene is told by the levels of its points or the kind of its load, whatever else is not right for a case in it.
fn refuse_scene(table: &Table) -> Result<()> {
    const KIND: &str = "loading.kind";
    if let Some(given) = table.get("model").and_then(|model| value_at(model, "discretisation")) {
        return Err(input("model.discretisation", given, "is not a key of fatigue cases", LEVELS_OF_SCENES));
    }
    let kind = table.get("loading").and_then(|loading| value_at(loading, "kind")).and_then(Value::as_str);
    // Both have loads that are a displacement; only that of a scene has one size without maximum or range.
    let is_of_one_size = table.get("loading").is_some_and(|loading| value_at(loading, "displacement_mm").is_some());
    let of_scenes = |kind: &&str| is_of_one_size || OF_SCENES.iter().any(|(key, names)| *key == KIND && names.contains(kind));
    let Some(kind) = kind.filter(of_scenes) else { return Ok(()) };
    let known = LoadingKind::ALL.iter().map(|kind| kind.name()).collect::<Vec<_>>().join(", ");
    let problem = "is for fracture scenes, not for fatigue cases";
    Err(input(KIND, format!("\"{kind}\""), problem, format!("run `perilife fracture`, or use one of {known}")))
}

/// Loads that only growth by K of the tips on points knows.
fn check_load(case: &Case) -> Result<()> {
    if let Some(course) = case.loading.course().filter(|_| matches!(case.engine(), Engine::Bonds | Engine::BondsThenPoints)) {
        let problem = "is a load that follows the crack, and bonds that lose life by their own strain know one load";
        return Err(input_missing(&course.key, problem, "use fatigue.driver = \"tip_field\", or give one number"));
    }
    let pressed = case.specimen.crack_pressure > 0.0;
    let (key, value, what) = match case.loading.displacement() {
        Some(most) => ("loading.kind", "\"displacement\"".to_owned(), format!("cycles of {} mm are", most / MM)),
        None if pressed => (
            "loading.crack_pressure_mpa",
            (case.specimen.crack_pressure * case.loading.maximum / MPA).to_string(),
            "pressure on cracks is".to_owned(),
        ),
        None => return Ok(()),
    };
    if !case.is_driven_by_tips() {
        let problem = format!("{what} known to peridynamics driven by the field of every tip alone");
        let remedy = if case.specimen.is_through() {
            "use model.method = \"peridynamics\" and fatigue.driver = \"tip_field\""
        } else {
            "give cycles of a load: K of a part-through crack is known under those alone"
        };
        return Err(input(key, value, problem, remedy));
    }
    let correction = case.points().bond_law.surface_correction;
    let is_on_points = case.model.method() == Method::Peridynamics;
    if is_on_points && case.specimen.moved_section().is_some() && correction != SurfaceCorrection::Balanced {
        // K of a strip with twenty points over its height is off by 1 to 3 %, and the error falls with the spacing only.
        let problem = "does not know where an edge is that loading.grip = \"straight\" moves: loads act half a spacing inside";
        return Err(input("model.surface_correction", correction, problem, "give \"balanced\", or loading.grip = \"mean\""));
    }
    Ok(())
}

/// Warnings of law and horizon of this case.
fn law_lines(case: &Case) -> Result<Vec<String>> {
    let (mut lines, units): (Vec<String>, _) = (Vec::new(), |line: String| format!("units: {line}"));
    // Of a spectrum the cycles count by their share of the growth (`predict::fit_use`).
    match (&case.loading.spectrum, &case.law_record) {
        (Some(spectrum), _) => lines.extend(spectrum.notes.iter().cloned()),
        (None, Some(record)) => lines.extend(law_source::ratio_line(record, case.loading.ratio, "loading.stress_ratio")?),
        (None, None) => {}
    }
    match &case.law {
        LawSource::Inline(_) => lines.extend(inline_line(case)),
        LawSource::Paris(law) => lines.extend(doubt(&steady(*law), case.loading.ratio).map(units)),
        LawSource::Factor(law) => {
            lines.extend(doubt(&FactorLaw { threshold: 0.0, ..law.clone() }, case.loading.ratio).map(units));
            lines.extend(law.table.iter().flat_map(|table| table.lines(case.loading.ratios())));
        }
        LawSource::Fitted(record) => {
            let law = ParisLaw { c: record.paris_c_mm_per_cycle * MM_PER_CYCLE, m: record.paris_m };
            lines.extend(doubt(&steady(law), record.stress_ratio).map(units));
            lines.extend(law::record_lines(case, record)?);
        }
        LawSource::Missing(path) if path.as_os_str().is_empty() => {}
        LawSource::Missing(path) => {
            lines.push(format!("law: {} does not exist yet: write it with `perilife calibrate`", path.display()));
        }
    }
    lines.extend(compression_line(case));
    lines.extend(boundaries::lines(case).into_iter().map(|line| format!("tested range: {line}")));
    if case.spends_bond_life() {
        lines.extend(coarse_line(case));
    }
    Ok(lines)
}

/// A power of ΔK whose rates are looked at.
fn steady(paris: ParisLaw) -> Walker {
    Walker { paris, gamma: 1.0, threshold: 0.0 }
}

/// Compression in a cycle is ignored, whatever Walker's exponent.
fn compression_line(case: &Case) -> Option<String> {
    let counts = matches!(&case.law, LawSource::Factor(law) if GrowthLaw::least_ratio(law).is_finite());
    let law = GrowthLawKind::all().find(|kind| kind.0.compression.is_some())?;
    let [ratio, _] = case.loading.ratios();
    (ratio < 0.0 && !counts).then(|| {
        format!(
            "loading: R = {}: the compressive part of the cycle is ignored (treated as R = 0, non-conservative); growth_law = \"{law}\" includes it",
            (1e4 * ratio).round() / 1e4
        )
    })
}

/// An inline `a` belongs to the default law, kernel and zone; another choice is the user's to answer for.
fn inline_line(case: &Case) -> Option<String> {
    use perilife_points::bond_law::{BondLawKind, Kernel, Rotation};
    let mut other = Vec::new();
    let (law, choices) = (case.points().bond_law.kind, &case.choices);
    other.extend((law != BondLawKind::TwoParameter).then(|| format!("bond_law {law}")));
    other.extend(choices.kernel.filter(|kernel| *kernel != Kernel::Conical).map(|kernel| format!("kernel {kernel}")));
    other.extend(choices.rotation.filter(|rotation| *rotation != Rotation::Free).map(|rotation| format!("rotation {rotation}")));
    other.extend(
        choices.ageing.filter(|ageing| *ageing != perilife_laws::Ageing::CrackTip).map(|ageing| format!("ageing {ageing}")),
    );
    other.extend(
        choices.zone_radius_horizons.filter(|radius| *radius != 0.5).map(|radius| format!("zone_radius_horizons {radius}")),
    );
    let list = other.join(", ");
    (!other.is_empty()).then(|| format!("law: a, p apply to the default bond law, kernel and zone; used here with {list}"))
}

/// Below three spacings a point has too few neighbours for rates that do not depend on their number. Measured (middle tension,
/// W 110 mm, a 20 to 27 mm, spacing 1 mm, p = 2.87, ν 0.2 and 0.33): life over that at 3.015 0.63 to 0.66 at 1.5 (0.60 at
/// a 14 mm, ν 0.3), 0.85 to 1.11 from 1.9 to 2.5, 0.97 at 2.9.
fn coarse_line(case: &Case) -> Option<String> {
    let ratio = case.points().horizon_ratio;
    let error = match ratio {
        _ if ratio < 1.9 => "about 40 % too short",
        _ if ratio < 2.9 => "up to 15 % off",
        _ => return None,
    };
    Some(format!("bonds: horizon_ratio {ratio} is too small: with the same A the life is {error}; use 3 or more"))
}
