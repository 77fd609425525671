//! What the Python package `perilife` is built on: documents from dicts and files, runs under the eyes of Python.
//!
//! Knows: Python's values, errors, threads and signals.
//! Must not know: mechanics; everything runs through `runner`.
//!
//! Imports `runner` and what it imports.

mod document;
mod errors;
mod run;
mod values;
mod watcher;

/// `perilife._perilife`.
#[pyo3::pymodule]
mod _perilife {
    use std::collections::HashMap;
    use std::path::PathBuf;

    use perilife_base::input::Folder;
    use perilife_base::units::MM;
    use perilife_calibration::inspection::InspectFrom;
    use perilife_growth::predict::factor_sweep::factor_sweep;
    use perilife_measured::Import;
    use perilife_plate::material::{growth_data, library};
    use perilife_results::paper::{self, Signed};
    use perilife_results::{factors as tables, provenance};
    use perilife_runner::check::check as check_document;
    use perilife_runner::{Kind, Task};
    use pyo3::prelude::*;

    use crate::document::document;
    use crate::errors::raised;
    #[pymodule_export]
    use crate::run::Run;
    use crate::watcher::watched;

    /// Says once what the package was built from.
    #[pymodule_init]
    fn init(_module: &Bound<'_, PyModule>) -> PyResult<()> {
        if let Some(commit) = option_env!("PERILIFE_COMMIT") {
            provenance::built_from(commit);
        }
        Ok(())
    }

    /// Options of a run of cycles.
    #[derive(FromPyObject)]
    #[pyo3(from_item_all)]
    struct Wishes {
        error_estimate: bool,
        cross_check: bool,
        residual_strength: bool,
        sensitivities: bool,
        inspect_from_mm: Option<f64>,
        factor: f64,
        tip: Option<usize>,
        pod: Option<String>,
        measured: Option<PathBuf>,
    }

    /// Runs a document as what `kind` says: `calibration`, `prediction`, `scene` or `sif`.
    #[pyfunction]
    #[pyo3(signature = (kind, source, name, set, law, files, *, methods, wishes, progress))]
    #[expect(clippy::too_many_arguments, reason = "the package names every one of them")]
    fn run(
        py: Python<'_>,
        kind: &str,
        source: &Bound<'_, PyAny>,
        name: &str,
        set: Vec<String>,
        law: Option<&Bound<'_, PyAny>>,
        files: HashMap<String, Vec<u8>>,
        methods: Vec<String>,
        wishes: Option<Wishes>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Run> {
        let kind: Kind = kind
            .parse()
            .map_err(|error: perilife_base::error::Error| pyo3::exceptions::PyValueError::new_err(error.to_string()))?;
        let document = document(source, name, &set, law, files)?;
        let work = |told: &crate::watcher::Told| {
            let mut task = Task::read(kind, &document, &methods)?;
            task.budgets(1)?.iter().try_for_each(|budget| budget.within_machine())?;
            if let Some(file) = wishes.as_ref().and_then(|wishes| wishes.measured.as_ref()) {
                let bytes = document.folder.opened().read(file, &file.display().to_string())?;
                task.read_plate(&document, file, &bytes)?;
            }
            if let (Task::Prediction { wanted, .. }, Some(wishes)) = (&mut task, &wishes) {
                (wanted.no_estimate, wanted.cross_check) = (!wishes.error_estimate, wishes.cross_check);
                (wanted.strength, wanted.asked.sensitivities) = (wishes.residual_strength, wishes.sensitivities);
                wanted.asked.detection = wishes.pod.as_deref().map(str::parse).transpose()?;
                let names = ["inspect_from_mm", "factor", "tip"];
                wanted.inspection = wishes.inspect_from_mm.map(|crack_length_mm| InspectFrom {
                    crack_length_mm,
                    tip: wishes.tip,
                    factor: wishes.factor,
                    names,
                });
            }
            Run::of(task, document.folder.opened().so_far(), told)
        };
        watched(py, progress, |told| work(told).map_err(|error| document.locate(error)))
    }

    /// K over the crack lengths `first:last:step` in mm: its table, the β table of the tip that grows farthest, that tip, and warnings.
    #[pyfunction]
    fn sif_sweep(
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        name: &str,
        set: Vec<String>,
        lengths: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(String, String, usize, Vec<String>)> {
        let document = document(source, name, &set, None, HashMap::new())?;
        let work = |told: &crate::watcher::Told| {
            let lengths = perilife_runner::factors::lengths(lengths)?;
            let case = perilife_runner::factors::case(&document, &lengths)?;
            let found = factor_sweep(&case, &lengths, true, told)?;
            let warnings = [case.warnings, found.warnings.clone()].concat();
            Ok((tables::table(&found).csv(), tables::beta_table(&found).csv(), found.lead, warnings))
        };
        watched(py, progress, |told| work(told).map_err(|error| document.locate(error)))
    }

    /// What was understood of a document, as JSON, and its drawing.
    #[pyfunction]
    fn check(
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        name: &str,
        set: Vec<String>,
        law: Option<&Bound<'_, PyAny>>,
        files: HashMap<String, Vec<u8>>,
    ) -> PyResult<(String, String)> {
        let document = document(source, name, &set, law, files)?;
        watched(py, None, |_| {
            let task = Task::read(Kind::of(&document.table), &document, &[])?;
            check_document(&document, &task).map(|checked| (checked.json().to_string(), checked.drawn.svg().unwrap_or_default()))
        })
    }

    /// Readings of a laboratory's table: columns `specimen`, `cycles`, `crack_length_mm`, and what the user should know.
    #[pyfunction]
    #[expect(clippy::type_complexity, reason = "three columns and warnings")]
    fn read_table(py: Python<'_>, file: PathBuf) -> PyResult<(Vec<String>, Vec<f64>, Vec<f64>, Vec<String>)> {
        let measured = py.detach(|| perilife_measured::read(&[file], &Import::default())).map_err(raised)?;
        let (mut specimens, mut cycles, mut lengths) = (Vec::new(), Vec::new(), Vec::new());
        for curve in measured.curves {
            specimens.extend(curve.cycles.iter().map(|_| curve.specimen.clone()));
            cycles.extend(&curve.cycles);
            lengths.extend(curve.crack_length.iter().map(|length| length / MM));
        }
        Ok((specimens, cycles, lengths, measured.warnings))
    }

    /// Name, words, E in GPa, ν, yield strength in MPa and toughness in MPa√m of the materials of the library, and whether growth
    /// data are there.
    #[pyfunction]
    #[expect(clippy::type_complexity, reason = "one row of a table")]
    fn materials() -> PyResult<Vec<(String, String, Option<f64>, Option<f64>, Option<f64>, Option<f64>, bool)>> {
        let mut rows = Vec::new();
        for name in library::names() {
            let file = library::find(&name, &Folder::none()).map_err(raised)?;
            let value = |property: Option<library::Property>| property.map(|property| property.value);
            let [yield_strength, toughness] = [value(file.yield_strength_mpa), value(file.toughness_mpa_sqrt_m)];
            let elastic = [file.youngs_modulus_gpa, file.poisson_ratio].map(|property| Some(property.value));
            let has_growth = file.growth.is_some() || growth_data::record(&name).is_some();
            rows.push((name, file.title, elastic[0], elastic[1], yield_strength, toughness, has_growth));
        }
        for record in growth_data::records() {
            if rows.iter().all(|row| row.0 != record.name) {
                let title = record.title();
                rows.push((record.name, title, None, None, None, None, true));
            }
        }
        Ok(rows)
    }

    /// Writes the report of a results folder.
    #[pyfunction]
    fn report(py: Python<'_>, folder: PathBuf, out: PathBuf, data: Option<PathBuf>, overrides: Vec<String>) -> PyResult<()> {
        let signed = Signed::read(data.as_deref(), &overrides).map_err(raised)?;
        py.detach(|| paper::write(&folder, &out, &signed)).map(drop).map_err(raised)
    }
}
