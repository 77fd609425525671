//! `[specimen]` of an input file to a checked [`Specimen`]: each kind reads its own keys.

use toml::{Table, Value};

use super::keys::{BETA_FILE, KIND};
use super::{LengthConvention, Specimen, SpecimenKind, named, part_through, plate, standard};
use perilife_base::error::{Error, InputError, Result, input, input_missing};
use perilife_base::input::{Folder, shorten, table_of};
use perilife_base::keys::{self, Field, Given, Key, Kinds, Section};

/// Other names of flaws that do not go through the thickness, never treated as through cracks.
pub const PART_THROUGH: &[&str] = &[
    "part_through", "part_through_crack", "elliptical_crack", "semi_elliptical_crack", "quarter_elliptical_crack",
    "thumbnail_crack", "surface_crack_at_hole",
];

const PART_THROUGH_KEYS: &[&str] = &[
    "crack_depth_mm", "crack_half_length_mm", "depth_mm", "surface_length_mm", "crack_shape", "aspect_ratio", "a_over_c",
    "corner_radius_mm",
];

fn give_a_kind() -> String {
    let known: Vec<&str> =
        SpecimenKind::ALL.iter().filter(|kind| kind.part_through().is_some()).map(|kind| kind.name()).collect();
    format!("use one of {} with crack_depth_mm and crack_half_length_mm", known.join(", "))
}

impl SpecimenKind {
    /// Its keys in `[specimen]`.
    pub fn keys(self) -> &'static [Key] {
        match (self, self.part_through()) {
            (_, Some(description)) => part_through::keys(description),
            (SpecimenKind::SingleEdgeTension, _) => standard::SingleEdge::KEYS,
            (SpecimenKind::CompactTension, _) => standard::Compact::KEYS,
            (SpecimenKind::Plate, _) => plate::Keys::KEYS,
            (kind, _) => kind.named().map_or(standard::Strip::KEYS, named::SpecimenSpec::keys),
        }
    }

    /// Whether a table of β takes the place of its K: holes that cracks run into on their way, and fronts, have no one K over one length.
    pub fn takes_beta(self) -> bool {
        self.part_through().is_none() && !matches!(self, SpecimenKind::RowOfHoles | SpecimenKind::StopHole)
    }

    /// Whether its K under out-of-plane bending is known.
    pub fn takes_bending(self) -> bool {
        self.part_through().is_some_and(|description| description.bending.is_some())
    }

    /// Whether its crack length is the half of a central crack.
    pub fn has_half_length(self) -> bool {
        matches!(self, SpecimenKind::MiddleTension | SpecimenKind::Cruciform)
    }

    fn mistakes(self, given: Given<'_>) -> Vec<InputError> {
        let all: Vec<_> = SpecimenKind::ALL.iter().map(|kind| (kind.name(), kind.keys())).collect();
        keys::mistakes(
            given,
            &[self.keys(), &[BETA_FILE]].concat(),
            &["kind"],
            Some(&Kinds { tag: "kind", own: self.name(), all: &all }),
        )
    }
}

impl Specimen {
    /// Whether something can grow in it.
    /// Errors: [`Error::Input`] on `specimen.cracks` of a plate without crack and slot.
    pub fn check_growth(&self) -> Result<()> {
        if self.cracks.is_empty() && self.slots.is_empty() {
            let problem = "is missing: nothing can grow without a crack or a notch";
            let what = if self.kind == SpecimenKind::Plate { "cracks or notches" } else { "it" };
            let remedy = format!("give {what}; for the stress of the plate `perilife sif --method element_free_galerkin`");
            return Err(input_missing(self.crack_key(), problem, remedy));
        }
        Ok(())
    }
}

/// The kind that `[specimen]` names.
/// Errors: none, or one that is not known.
fn kind_of(table: &Table) -> Result<SpecimenKind> {
    let Some(kind) = table.get("kind") else { return Err(input_missing(SpecimenKind::KEY, "is missing", KIND.remedy())) };
    if let Some(kind) = kind.as_str().filter(|kind| PART_THROUGH.contains(kind)) {
        let problem = "is not a part-through crack";
        return Err(input(SpecimenKind::KEY, format!("\"{kind}\""), problem, give_a_kind()));
    }
    SpecimenKind::take(&KIND, SpecimenKind::KEY, kind)
}

/// What is wrong with the keys of `[specimen]` by themselves.
pub fn mistakes(value: &Value) -> Vec<InputError> {
    let found = Given::of(value, "specimen").and_then(|given| {
        let kind = kind_of(given.table)?;
        if let Some(key) = given.first(PART_THROUGH_KEYS).filter(|_| kind.part_through().is_none()) {
            let problem = format!("applies only to part-through cracks; {kind} has a through crack");
            return Err(given.refuse(key, problem, give_a_kind()));
        }
        Ok(kind.mistakes(given))
    });
    match found {
        Ok(found) => found,
        Err(Error::Input(error)) => error.each(),
        Err(_) => Vec::new(),
    }
}

/// Reads `[specimen]`, which may be a plate without cracks or notches. The standard kinds come with their loads; a `plate` is loaded by
/// `[loading]`. A drawing that it names lies in `folder`. What was done to ends of cracks goes into `notes`.
pub fn from_value(value: &Value, folder: &Folder, notes: &mut Vec<String>) -> Result<Specimen> {
    let table = table_of(value, "specimen")?;
    let kind = kind_of(table)?;
    Error::of_all(mistakes(value))?;
    if let Some(given) = table.get(BETA_FILE.name).filter(|_| !kind.takes_beta()) {
        let known: Vec<&str> = SpecimenKind::ALL.iter().filter(|kind| kind.takes_beta()).map(|kind| kind.name()).collect();
        let problem = format!("cannot be combined with {kind}, which has its own K");
        let remedy = format!("remove it, or use one of {}", known.join(", "));
        return Err(input(super::beta::KEY, shorten(given), problem, remedy));
    }
    if let Some(description) = kind.part_through() {
        return part_through::from_value(description, value, notes);
    }
    if let Some(description) = kind.named() {
        let specimen = named::from_value(description, value, notes)?;
        if let Some(given) = table.get(BETA_FILE.name).filter(|_| specimen.convention == LengthConvention::SumOfTips) {
            let problem = "one table cannot serve cracks of different length";
            return Err(input(super::beta::KEY, shorten(given), problem, "remove it, or give crack_length_mm"));
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
