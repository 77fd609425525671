//! `[specimen]` of an input file to a checked [`Specimen`]: each kind reads its own keys.

use toml::Value;

use super::{LengthConvention, Specimen, SpecimenKind, named, part_through, plate, standard};
use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{Folder, shorten, table_of};

/// Other names of flaws that do not go through the thickness, never treated as through cracks.
pub const PART_THROUGH: &[&str] = &[
    "part_through",
    "part_through_crack",
    "elliptical_crack",
    "semi_elliptical_crack",
    "quarter_elliptical_crack",
    "thumbnail_crack",
    "surface_crack_at_hole",
];

/// Keys that only such a flaw has.
const PART_THROUGH_KEYS: &[&str] = &[
    "crack_depth_mm",
    "crack_half_length_mm",
    "depth_mm",
    "surface_length_mm",
    "crack_shape",
    "aspect_ratio",
    "a_over_c",
    "corner_radius_mm",
];

/// What to give for a flaw that does not go through.
fn give_a_kind() -> String {
    let known: Vec<&str> =
        SpecimenKind::ALL.iter().filter(|kind| kind.part_through().is_some()).map(|kind| kind.name()).collect();
    format!("use one of {} with crack_depth_mm and crack_half_length_mm", known.join(", "))
}

impl Specimen {
    /// Whether something can grow in it.
    /// Errors: [`Error::Input`](perilife_base::error::Error::Input) on `specimen.cracks` of a plate without crack and slot.
    pub fn check_growth(&self) -> Result<()> {
        if self.cracks.is_empty() && self.slots.is_empty() {
            let problem = "is missing, and there is no notch either: nothing can grow";
            let what = if self.kind == SpecimenKind::Plate { "cracks or notches" } else { "it" };
            let remedy = format!("give {what}; for the stress of the plate `perilife sif --method element_free_galerkin`");
            return Err(input_missing(self.crack_key(), problem, remedy));
        }
        Ok(())
    }
}

/// Reads `[specimen]`, which may be a plate without cracks or notches. The standard kinds come with their loads; a `plate` is loaded by
/// `[loading]`. A drawing that it names lies in `folder`. What was done to ends of cracks goes into `notes`.
pub fn from_value(value: &Value, folder: &Folder, notes: &mut Vec<String>) -> Result<Specimen> {
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
        let problem = "is not the name of a crack that does not go through";
        return Err(input("specimen.kind", format!("\"{kind}\""), problem, give_a_kind()));
    }
    let kind = kind.parse::<SpecimenKind>()?;
    // Holes that cracks run into on their way, and fronts, have no one K over one length.
    let takes =
        |kind: SpecimenKind| kind.part_through().is_none() && !matches!(kind, SpecimenKind::RowOfHoles | SpecimenKind::StopHole);
    if let Some(given) = table.get("beta_file").filter(|_| !takes(kind)) {
        let known: Vec<&str> = SpecimenKind::ALL.iter().filter(|kind| takes(**kind)).map(|kind| kind.name()).collect();
        let problem = format!("does not go with {kind}, whose K is its own");
        let remedy = format!("leave it out, or use one of {}", known.join(", "));
        return Err(input(super::beta::KEY, shorten(given), problem, remedy));
    }
    if let Some(description) = kind.part_through() {
        return part_through::from_value(description, value, notes);
    }
    if let Some(key) = PART_THROUGH_KEYS.iter().find(|key| table.contains_key(**key)) {
        let problem = format!("describes a crack that does not go through, and the crack of {kind} does");
        return Err(input(&format!("specimen.{key}"), shorten(&table[*key]), problem, give_a_kind()));
    }
    if let Some(description) = kind.named() {
        let mut own = table.clone();
        let table_of_beta = own.remove("beta_file");
        let specimen = named::from_value(description, &Value::Table(own), notes)?;
        if let Some(given) = table_of_beta.filter(|_| specimen.convention == LengthConvention::SumOfTips) {
            let problem = "is one table, and cracks of unlike length have each their own K";
            return Err(input(super::beta::KEY, shorten(&given), problem, "leave it out, or give crack_length_mm"));
        }
        return Ok(specimen);
    }
    match kind {
        SpecimenKind::SingleEdgeTension => standard::single_edge_from_value(value),
        SpecimenKind::CompactTension => standard::compact_from_value(value),
        SpecimenKind::Plate => plate::from_value(value, folder, notes),
        _ => standard::from_value(kind, value),
    }
}
