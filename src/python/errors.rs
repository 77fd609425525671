//! Errors of the engine as exceptions of the package, with the messages of the command line.

use std::path::Path;

use perilife_base::error::Error;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};

/// The exception of `perilife.errors` that an error is; what names file, key, value, problem and remedy is an attribute of it.
pub fn raised(error: Error) -> PyErr {
    Python::attach(|py| exception(py, &error).unwrap_or_else(|failed| failed))
}

fn exception(py: Python<'_>, error: &Error) -> PyResult<PyErr> {
    let named = |path: &Path| path.display().to_string();
    let (class, attributes) = match error {
        Error::Input(trouble) => {
            let file = trouble.file.as_deref().map(named);
            let line = trouble.line.filter(|_| file.is_some());
            let texts = [("file", file.as_ref()), ("key", trouble.key.as_ref()), ("value", trouble.value.as_ref())];
            let attributes: Bound<'_, PyDict> = texts.into_py_dict(py)?;
            attributes.set_item("line", line)?;
            attributes.set_item("problem", &trouble.problem)?;
            attributes.set_item("remedy", &trouble.remedy)?;
            ("InputError", attributes)
        }
        Error::Mechanics(_) | Error::LossOfStiffness => ("MechanicsError", PyDict::new(py)),
        Error::File { path, source, .. } => {
            let attributes = PyDict::new(py);
            attributes.set_item("filename", named(path))?;
            attributes.set_item("errno", source.raw_os_error())?;
            ("FileError", attributes)
        }
    };
    let class = py.import("perilife.errors")?.getattr(class)?;
    Ok(PyErr::from_value(class.call((error.to_string(),), Some(&attributes))?))
}
