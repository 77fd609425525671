//! `[specimen]` of an input file to a checked [`Specimen`]: each kind reads its own keys.

use toml::Value;

use super::{Specimen, SpecimenKind, plate, standard};
use crate::error::{Result, input, input_missing};
use crate::input::{shorten, table_of};
use crate::kinds::KindLine;

/// Flaws that do not go through the thickness. They are refused by name, never treated as through cracks.
pub const PART_THROUGH: &[&str] = &[
    "part_through",
    "part_through_crack",
    "surface_crack",
    "corner_crack",
    "embedded_crack",
    "elliptical_crack",
    "semi_elliptical_crack",
    "thumbnail_crack",
];

/// Keys that only such a flaw has.
const PART_THROUGH_KEYS: &[&str] =
    &["depth_mm", "crack_depth_mm", "surface_length_mm", "crack_shape", "aspect_ratio", "a_over_c", "corner_radius_mm"];

const ONLY_THROUGH: &str = "only through cracks in plates are supported: the crack has the same length on both faces";

impl SpecimenKind {
    /// The line of `perilife list` that says what no kind covers.
    pub fn not_covered() -> KindLine {
        KindLine {
            key: Self::KEY,
            name: "(not: part-through)",
            meaning: "through cracks in plates only; part-through, surface, corner and embedded cracks are refused by name",
        }
    }
}

impl Specimen {
    /// Whether something can grow in it.
    /// Errors: [`Error::Input`](crate::Error::Input) on `specimen.cracks` of a plate without crack and slot.
    pub fn check_growth(&self) -> Result<()> {
        if self.cracks.is_empty() && self.slots.is_empty() {
            let problem = "is missing, and there is no notch either: nothing can grow";
            let remedy = "give cracks or notches; for the stress of the plate `perilife sif --method element_free_galerkin`";
            return Err(input_missing("specimen.cracks", problem, remedy));
        }
        Ok(())
    }
}

/// Reads `[specimen]`, which may be a plate without cracks or notches. The standard kinds come with their loads; a `plate` is loaded by
/// `[loading]`. What was done to ends of cracks goes into `notes`.
pub fn from_value(value: &Value, notes: &mut Vec<String>) -> Result<Specimen> {
    let table = table_of(value, "specimen")?;
    let kind = match table.get("kind") {
        None => {
            let known: Vec<&str> = SpecimenKind::ALL.iter().map(|kind| kind.name()).collect();
            return Err(input_missing("specimen.kind", "is missing", format!("use one of {}", known.join(", "))));
        }
        Some(Value::String(kind)) => kind,
        Some(other) => return Err(input("specimen.kind", shorten(other), "is not text in quotes", "give the name of a kind")),
    };
    if PART_THROUGH.contains(&kind.as_str()) {
        return Err(input("specimen.kind", format!("\"{kind}\""), "is not a through crack", ONLY_THROUGH));
    }
    if let Some(key) = PART_THROUGH_KEYS.iter().find(|key| table.contains_key(**key)) {
        let key = format!("specimen.{key}");
        return Err(input(&key, shorten(&table[&key[9..]]), "describes a crack that does not go through", ONLY_THROUGH));
    }
    match kind.parse()? {
        kind @ (SpecimenKind::MiddleTension | SpecimenKind::DoubleEdgeTension) => standard::from_value(kind, value),
        SpecimenKind::SingleEdgeTension => standard::single_edge_from_value(value),
        SpecimenKind::CompactTension => standard::compact_from_value(value),
        SpecimenKind::Plate => plate::from_value(value, notes),
    }
}
