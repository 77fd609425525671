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
use toml::Value;

use super::growth_data::{self, GrowthRecord, MPA_PER_KSI};
use perilife_base::error::{Result, input};
use perilife_base::input::{Document, Folder};
use perilife_base::keys::{key, nearest, section};

static FILES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../data/materials");

perilife_base::keys! {
    #[derive(Debug, Clone, PartialEq)]
    pub struct Property {
        value: f64 = key("value", "Value: in the unit of its key");
        source: String = key("source", "Source");
        note: Option<String> = key("note", "Note: thickness, orientation, heat treatment");
    }
    #[derive(Debug, Clone, PartialEq)]
    pub struct MaterialFile {
        title: String = key("title", "Title");
        youngs_modulus_gpa: Property = key("youngs_modulus_gpa", "Young's modulus E");
        poisson_ratio: Property = key("poisson_ratio", "Poisson's ratio ν");
        yield_strength_mpa: Option<Property> = key("yield_strength_mpa", "Yield strength σY: 0.2 % offset");
        toughness_mpa_sqrt_m: Option<Property> = key("toughness_mpa_sqrt_m", "Fracture toughness Kc");
        fracture_energy_j_m2: Option<Property> = key("fracture_energy_j_m2", "Fracture energy");
        density_kg_m3: Option<Property> = key("density_kg_m3", "Density");
        tensile_strength_mpa: Option<Property> = key("tensile_strength_mpa", "Tensile strength");
        growth: Option<toml::Table> = key("growth", "Growth law: keys of [fatigue]");
    }
}

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

/// Name and title of every material.
pub fn titles() -> Vec<(String, String)> {
    let title = |name: String| find(&name, &Folder::none()).ok().map(|file| (name, file.title));
    let records = growth_data::records().into_iter().map(|record| (record.name.clone(), record.title()));
    names().into_iter().filter_map(title).chain(records).collect()
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
        let (files, records) = (names(), growth_data::records());
        let all = || files.iter().map(String::as_str).chain(records.iter().map(|record| record.name.as_str()));
        let part = || all().find(|known| known.contains(&name.to_lowercase())).map(str::to_owned);
        let near = nearest(name, all()).or_else(part);
        let near = near.map_or_else(String::new, |near| format!("did you mean \"{near}\"? "));
        let files = files.join(", ");
        let known = "an entry of `perilife list materials`, or the path of your own .toml file";
        let remedy = format!("{near}use one of {files}, {known}");
        return Err(input("material.name", format!("\"{name}\""), "unknown material", remedy));
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

fn read(document: &Document) -> Result<MaterialFile> {
    section(&Value::Table(document.table.clone()), "")
}
