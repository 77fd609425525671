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

use std::path::Path;

use include_dir::{Dir, include_dir};
use serde::Deserialize;
use toml::Value;

use super::growth_data::{self, GrowthRecord, MPA_PER_KSI};
use perilife_base::error::{Error, InputError, Result, input};
use perilife_base::input::{Document, Folder, slice};

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
    /// Its growth law: keys of `[fatigue]`, files in them as seen from the folder of the case.
    pub growth: Option<toml::Table>,
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
        let mut file = read(&document).map_err(|error| document.locate(error))?;
        file.growth.iter_mut().for_each(|keys| from_folder_of(name, keys));
        return Ok(file);
    }
    let text = FILES.get_file(format!("{name}.toml")).and_then(|file| file.contents_utf8());
    let Some(text) = text else {
        if let Some(record) = growth_data::record(name) {
            return Ok(of_record(&record));
        }
        let files = names().join(", ");
        let remedy = format!("use one of {files}, a record of `perilife list materials`, or the path of an own .toml file");
        return Err(input("material.name", format!("\"{name}\""), "is not a known material", remedy));
    };
    let document = Document::parse(text, name, Folder::none(), &[])?;
    read(&document)
}

/// Files that `[growth]` of a material file names, which lie beside it.
fn from_folder_of(name: &str, keys: &mut toml::Table) {
    for key in ["fitted", "growth_table"] {
        let value = keys.get_mut(key).and_then(|value| if value.is_table() { value.get_mut("file") } else { Some(value) });
        if let Some(Value::String(file)) = value {
            *file = Path::new(name).with_file_name(&*file).display().to_string();
        }
    }
}

/// What a record of growth data says of its material beside the growth.
fn of_record(record: &GrowthRecord) -> MaterialFile {
    let property = |value: f64| Property { value, source: growth_data::SOURCE.to_owned(), note: None };
    let family = |value: f64| Property { source: "MIL-HDBK-5J, typical of the alloy's family".to_owned(), ..property(value) };
    MaterialFile {
        title: record.title(),
        youngs_modulus_gpa: family(record.youngs_modulus_gpa),
        poisson_ratio: family(record.poisson_ratio),
        yield_strength_mpa: Some(property(record.yield_ksi * MPA_PER_KSI)),
        tensile_strength_mpa: Some(property(record.tensile_ksi * MPA_PER_KSI)),
        toughness_mpa_sqrt_m: None,
        fracture_energy_j_m2: None,
        density_kg_m3: None,
        growth: None,
    }
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
