//! Files of `data/materials`, built into the program, and a user's own in the same form.
//!
//! ```toml
//! title = "Aluminium alloy 2024-T3, sheet"
//! [youngs_modulus_gpa]
//! value = 73.1
//! source = "..."
//! ```
//! Every number stands with its source. Growth data are those of [`super::growth_data`]; the law of a test of one's own is what
//! `calibration/<name>/fitted.toml` holds.

use include_dir::{Dir, include_dir};
use serde::Deserialize;
use toml::Value;

use super::growth_data;
use crate::error::{Error, InputError, Result, input};
use crate::input::{Document, Folder, slice};
use crate::units::MM;

static FILES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../data/materials");

/// One number of a material file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Property {
    /// Value in the unit of its key.
    pub value: f64,
    /// Where it comes from.
    pub source: String,
    /// Thickness, orientation, heat treatment it holds for.
    pub note: Option<String>,
}

/// A material file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MaterialFile {
    /// What it is, in words.
    pub title: String,
    /// E, GPa.
    pub youngs_modulus_gpa: Property,
    /// ν.
    pub poisson_ratio: Property,
    /// Yield strength (0.2 % offset), MPa.
    pub yield_strength_mpa: Option<Property>,
    /// Fracture toughness, MPa√m.
    pub toughness_mpa_sqrt_m: Option<Property>,
    /// Fracture energy, J/m².
    pub fracture_energy_j_m2: Option<Property>,
    /// Density, kg/m³.
    pub density_kg_m3: Option<Property>,
    /// Tensile strength, MPa.
    pub tensile_strength_mpa: Option<Property>,
    /// Its growth law: keys of `[fatigue]`, files in them from the folder of the case.
    pub growth: Option<toml::Table>,
}

/// The growth law of a material, as keys of `[fatigue]`, for a plate of this thickness, m, and what it is; `None` of one without.
/// Errors: as [`find`].
pub fn growth(name: &str, thickness: f64, folder: &Folder) -> Result<Option<(toml::Table, String)>> {
    if let Some(record) = growth_data::record(name) {
        return Ok(Some((record.keys(thickness / MM), format!("{}: {}", record.title(), growth_data::SOURCE))));
    }
    let file = find(name, folder)?;
    Ok(file.growth.map(|keys| (keys, file.title)))
}

/// Names of the built-in materials, sorted.
pub fn names() -> Vec<String> {
    let mut names: Vec<String> = FILES
        .files()
        .map(|file| file.path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
        .collect();
    names.sort();
    names
}

/// Finds a material by the name of a built-in file, or by the path of an own `.toml` file in `folder`.
pub fn find(name: &str, folder: &Folder) -> Result<MaterialFile> {
    if name.ends_with(".toml") || name.contains(['/', '\\']) {
        let document = Document::in_folder(folder, name, &[])?;
        return read(&document).map_err(|error| document.locate(error));
    }
    let text = FILES.get_file(format!("{name}.toml")).and_then(|file| file.contents_utf8());
    let Some(text) = text else {
        if let Some(record) = growth_data::record(name) {
            return Ok(record.file());
        }
        let files = names().join(", ");
        let remedy = format!("use one of {files}, a record of `perilife list materials`, or the path of an own .toml file");
        return Err(input("material.name", format!("\"{name}\""), "is not a known material", remedy));
    };
    let document = Document::parse(text, name, Folder::none(), &[])?;
    read(&document)
}

/// Reads a material file; keys in messages are those of that file.
fn read(document: &Document) -> Result<MaterialFile> {
    slice(&Value::Table(document.table.clone()), "material").map_err(|error| match error {
        // In the file itself the keys stand at the top.
        Error::Input(trouble) => {
            let key = trouble.key.map(|key| key.trim_start_matches("material.").to_owned());
            Error::Input(Box::new(InputError { key, ..*trouble }))
        }
        other => other,
    })
}
