//! What a document asks for, read and found right; a document put together in code.

use std::path::Path;

use toml::{Table, Value};

use super::scene_results;
use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{Document, Folder};
use perilife_calibration::calibrate::Calibration;
use perilife_calibration::population::plate::lot_of;
use perilife_calibration::sweep::design::{CASES_MAX, is_sweep};
use perilife_calibration::sweep::{DrawnCase, Sweep};
use perilife_growth::case::{Case, Method, RECORD, needs, remove_law};
use perilife_growth::predict::tip_factors::StressIntensityMethod;
use perilife_measured::{Import, ratio_warnings};
use perilife_points::budget::Budget;
use perilife_results::band::no_band_to_narrow;
use perilife_results::output::{Room, RunKind};
use perilife_results::run::{self, Wanted};
use perilife_results::{fit, stresses};
use perilife_scenes::Scene;
use perilife_scenes::read::is_scene;

perilife_base::kinds! {
    /// What is done with a document.
    #[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = JobKind, rename_all = "snake_case"))]
    pub enum Kind for "kind" {
        Calibration = "calibration": "Fits the growth law to test data.",
        Prediction = "prediction": "Runs a case.",
        Scene = "scene": "Runs a fracture scene.",
        Sweep = "sweep": "Runs a parameter study.",
        Sif = "sif": "Stress intensity factors of a case.",
    }
}

impl Kind {
    /// The kind of run that a document of these sections is input of.
    pub fn of(table: &Table) -> Kind {
        match () {
            () if is_sweep(table) => Kind::Sweep,
            () if is_scene(table) => Kind::Scene,
            () if table.contains_key("measured") || table.contains_key("fit") => Kind::Calibration,
            () => Kind::Prediction,
        }
    }

    /// Its place in URLs.
    pub fn collection(self) -> &'static str {
        match self {
            Kind::Calibration => "calibrations",
            Kind::Prediction => "predictions",
            Kind::Scene => "scenes",
            Kind::Sweep => "sweeps",
            Kind::Sif => "sif",
        }
    }

    /// Options of its command that a job of it may have.
    pub fn options(self) -> &'static [&'static str] {
        match self {
            Kind::Sif => &["method"],
            Kind::Prediction => &["sensitivities", "residual_strength", "inspect_from_mm", "factor", "tip", "pod", "measured"],
            _ => &[],
        }
    }
}

/// A document read as what it asks for.
#[derive(Debug, Clone)]
pub enum Task {
    /// A case.
    Prediction {
        case: Box<Case>,
        /// What is wanted beside the run.
        wanted: Box<Wanted>,
    },
    Scene(Box<Scene>),
    /// A fit to a-N curves, or of laws over K to rates.
    Fit(Calibration),
    /// Stress intensity factors of a case.
    Factors {
        /// Its plate and load.
        case: Box<Case>,
        /// By which methods, each once.
        methods: Vec<StressIntensityMethod>,
        /// Whether nodes alone are asked for, which need no crack.
        on_nodes: bool,
    },
    /// A sweep with all its cases.
    Sweep {
        sweep: Box<Sweep>,
        cases: Vec<DrawnCase>,
    },
}

/// Points of a plate from which K on points takes minutes.
const POINTS_QUICK: f64 = 3e5;

/// The methods for K where none is named: all, or nodes alone where a small crack asks for many points.
fn quick_methods(case: &mut Case) -> Vec<StressIntensityMethod> {
    let points = needs::on_points(case).points;
    if points <= POINTS_QUICK || !case.specimen.is_through() {
        return StressIntensityMethod::ALL.to_vec();
    }
    let words = format!("only the node model was used ({points:.1e} points needed otherwise); use --method ring for points");
    case.warnings.push(format!("nodes: {words}"));
    vec![StressIntensityMethod::ElementFreeGalerkin]
}

impl Task {
    /// Reads a document as input of a kind of run; `methods` are names of [`StressIntensityMethod`] where that asks for them.
    pub fn read(kind: Kind, document: &Document, methods: &[String]) -> Result<Task> {
        Ok(match kind {
            Kind::Prediction => Task::Prediction { case: Box::new(Case::from_document(document)?), wanted: Box::default() },
            Kind::Scene => Task::Scene(Box::new(Scene::from_document(document)?)),
            Kind::Calibration => Task::Fit(Calibration::from_document(document)?),
            Kind::Sif => {
                let mut chosen: Vec<StressIntensityMethod> = Vec::new();
                for name in methods {
                    let method = name.parse()?;
                    if !chosen.contains(&method) {
                        chosen.push(method);
                    }
                }
                let is_of_nodes = chosen == [StressIntensityMethod::ElementFreeGalerkin];
                let mut case = Box::new(if is_of_nodes { Case::plate_on_nodes(document)? } else { Case::plate_of(document)? });
                let on_nodes = is_of_nodes
                    || chosen.is_empty() && case.chosen.is_none() && case.model.method() == Method::ElementFreeGalerkin;
                let methods = if chosen.is_empty() { quick_methods(&mut case) } else { chosen };
                Task::Factors { case, methods, on_nodes }
            }
            Kind::Sweep => Task::sweep(document.clone(), &[], CASES_MAX)?,
        })
    }

    /// Adds readings of the plate of a case, the bytes of any table that [`perilife_measured`] reads.
    /// Errors: a file of no readings or of several specimens, readings that are not of this plate, a case whose life has no band.
    pub fn read_plate(&mut self, document: &Document, file: &Path, bytes: &[u8]) -> Result<()> {
        let Task::Prediction { case, wanted } = self else {
            return Err(input("--measured", file.display(), "applies only to fatigue cases", "remove it"));
        };
        let import = Import { of_plate: true, ..Import::default() };
        let mut measured = perilife_measured::parse(bytes, file, &import)?;
        measured.compare_with(&case.specimen, &case.material, &case.loading)?;
        case.warnings.append(&mut measured.warnings);
        case.warnings.extend(ratio_warnings(&measured.curves, &case.loading));
        case.provenance = document.folder.opened().so_far();
        let [curve] = measured.curves.as_slice() else {
            let names: Vec<&str> = measured.curves.iter().map(|curve| &*curve.specimen).take(5).collect();
            let problem = format!("contains {} specimens ({}); expected one", measured.curves.len(), names.join(", "));
            return Err(input("--measured", file.display(), problem, "give a table with the readings of this plate only"));
        };
        lot_of(case)?.map_err(|why| no_band_to_narrow(curve, &why))?;
        wanted.readings = Some(curve.clone());
        Ok(())
    }

    /// Reads a sweep of at most so many cases, with overrides of design and case.
    pub fn sweep(document: Document, overrides: &[String], most: usize) -> Result<Task> {
        let sweep = Box::new(Sweep::with_overrides(document, overrides, most)?);
        let cases = sweep.cases()?;
        Ok(Task::Sweep { sweep, cases })
    }

    pub fn name(&self) -> &str {
        match self {
            Task::Prediction { case, .. } | Task::Factors { case, .. } => &case.name,
            Task::Scene(scene) => &scene.name,
            Task::Fit(calibration) => calibration.name(),
            Task::Sweep { sweep, .. } => &sweep.name,
        }
    }

    /// Warnings before it is run; those of a case are among the messages of its result.
    pub fn warnings(&self) -> &[String] {
        match self {
            Task::Scene(scene) => &scene.warnings,
            Task::Fit(calibration) => calibration.warnings(),
            Task::Prediction { .. } | Task::Factors { .. } | Task::Sweep { .. } => &[],
        }
    }

    /// What makes folders of its results.
    pub fn run_kind(&self) -> RunKind {
        match self {
            Task::Prediction { .. } => RunKind::Predict,
            Task::Factors { .. } => RunKind::Sif,
            Task::Scene(_) => RunKind::Fracture,
            Task::Fit(_) => RunKind::Calibrate,
            Task::Sweep { .. } => RunKind::Sweep,
        }
    }

    /// The case that its run follows through cycles.
    pub fn case(&self) -> Result<&Case> {
        match self {
            Task::Prediction { case, .. } => Ok(case),
            _ => Err(input("--checkpoint", self.name(), "does not support checkpoints", "remove it")),
        }
    }

    /// What its runs take up, of every `n`-th of many with `n` so that there are at most `most`; nothing of a fit to rates.
    pub fn budgets(&self, most: usize) -> Result<Vec<Budget>> {
        Ok(match self {
            Task::Prediction { case, .. } => vec![needs::of_case(case)],
            Task::Factors { case, methods, .. } => {
                let has_points = methods.iter().any(|method| *method != StressIntensityMethod::ElementFreeGalerkin);
                vec![if has_points { needs::on_points(case) } else { needs::of_case(case) }]
            }
            Task::Scene(scene) => vec![scene.budget()],
            Task::Fit(Calibration::Lives(calibration)) => vec![needs::of_case(&calibration.case)],
            Task::Fit(Calibration::Rates(_)) => Vec::new(),
            Task::Sweep { cases, .. } => {
                let step = cases.len().div_ceil(most).max(1);
                cases.iter().step_by(step).map(|case| Ok(needs::of_case(&case.read()?))).collect::<Result<_>>()?
            }
        })
    }

    /// Bytes that it will write, roughly; 0 where that is little.
    pub fn room(&self) -> Room {
        match self {
            Task::Prediction { case, .. } => run::room(case),
            Task::Scene(scene) => scene_results::room(scene),
            Task::Factors { case, .. } => stresses::room(case),
            Task::Fit(_) => fit::ROOM,
            Task::Sweep { .. } => Room::default(),
        }
    }
}

/// Sections of an input file in the making; the keys are those of the file.
///
/// ```
/// use perilife_growth::predict::{Silent, predict};
/// use perilife_runner::Draft;
/// use toml::toml;
///
/// let panel = Draft::new("panel")
///     .section("specimen", toml! {
///         kind = "middle_tension"
///         width_mm = 100.0
///         length_mm = 300.0
///         thickness_mm = 2.0
///         crack_length_mm = 5.0
///     })
///     .section("material", toml! { name = "al2024-t3" })
///     .section("loading", toml! {
///         stress_max_mpa = 80.0
///         stress_ratio = 0.1
///     })
///     .section("fatigue", toml! {
///         paris_c_mm_per_cycle = 8e-8
///         paris_m = 3.0
///     });
/// let shorter = predict(&panel.clone().section("loading", toml! { stress_max_mpa = 90.0 }).case()?, &Silent)?;
/// assert!(shorter.life_cycles() < predict(&panel.case()?, &Silent)?.life_cycles());
/// # Ok::<(), perilife_base::error::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Draft {
    name: String,
    table: Table,
    files: Vec<(String, Vec<u8>)>,
}

impl Draft {
    pub fn new(name: impl Into<String>) -> Self {
        Draft::of(name, Table::new())
    }

    pub fn of(name: impl Into<String>, table: Table) -> Self {
        Draft { name: name.into(), table, files: Vec::new() }
    }

    /// Adds keys to a section; those that it has already get the new values.
    pub fn section(mut self, section: &str, keys: Table) -> Self {
        extend(&mut self.table, section, keys);
        self
    }

    /// Adds a file that keys name, before any of that name in the current folder.
    pub fn file(mut self, name: impl Into<String>, content: impl Into<Vec<u8>>) -> Self {
        self.files.push((name.into(), content.into()));
        self
    }

    /// Adds a table of readings, in any form that a laboratory writes, for a calibration.
    pub fn readings(self, name: &str, content: impl Into<Vec<u8>>) -> Self {
        let mut files = self.table.get("measured").and_then(|measured| measured.get("files")?.as_array().cloned());
        let files = files.get_or_insert_default();
        files.push(name.into());
        let keys = Table::from_iter([("files".to_owned(), Value::from(std::mem::take(files)))]);
        self.section("measured", keys).file(name, content)
    }

    /// Puts the law of a fit in the place of the one it has: the text of `fitted.toml`
    /// ([`Fitted::record_text`](perilife_calibration::calibrate::Fitted::record_text)).
    pub fn law(mut self, record: &str) -> Self {
        put_law(&mut self.table, Table::from_iter([("fitted".to_owned(), RECORD.into())]));
        self.file(RECORD, record)
    }

    /// As a document, whose files lie in the current folder where they are not given.
    /// Errors: a value that has no form in TOML.
    pub fn document(&self) -> Result<Document> {
        let text = toml::to_string(&self.table)
            .map_err(|error| input_missing("case", format!("cannot be written as TOML: {error}"), "give tables of keys"))?;
        Document::parse(&text, &self.name, Folder::from(Path::new("")).anew_with(self.files.iter().cloned()), &[])
    }

    /// As a checked case.
    /// Errors: as [`Case::from_document`].
    pub fn case(&self) -> Result<Case> {
        Case::from_document(&self.document()?)
    }

    /// As a checked calibration.
    /// Errors: as [`Calibration::from_document`].
    pub fn calibration(&self) -> Result<Calibration> {
        Calibration::from_document(&self.document()?)
    }
}

/// Puts keys of a law into `[fatigue]` in the place of those that the table has.
pub fn put_law(table: &mut Table, law: Table) {
    remove_law(table);
    extend(table, "fatigue", law);
}

fn extend(table: &mut Table, section: &str, keys: Table) {
    let place = table.entry(section).or_insert_with(|| Table::new().into());
    match place {
        Value::Table(known) => known.extend(keys),
        other => *other = keys.into(),
    }
}
