//! Keys of `[specimen]` that several kinds share, and the keys of every kind.

use super::{SpecimenKind, named, part_through, plate, standard};
use perilife_base::error::{Error, Result};
use perilife_base::keys::{Field, Given, Key, Kinds, Section, key, length, mistakes};
use toml::Value;

pub(super) const WIDTH: Key = length("width_mm", "Width W");
pub(super) const LENGTH: Key = length("length_mm", "Length L: along the load");
pub(super) const THICKNESS: Key = length("thickness_mm", "Thickness B");
pub(super) const HOLE_DIAMETER: Key = length("hole_diameter_mm", "Hole diameter");
pub(super) const CRACK_LENGTH: Key = length("crack_length_mm", "Initial crack length a: from the edge");
/// Key of a table of β, which through cracks take beside the keys of their kind.
pub const BETA_FILE: Key =
    key("beta_file", "Table of β: K = β σ √(πa), CSV of crack_length_mm and beta; `perilife sif --sweep` writes one");
/// Key that names the kind.
pub const KIND: Key = Key { shape: <SpecimenKind as Field>::SHAPE, ..key("kind", "Kind of specimen") };
/// Keys that are not those of a kind.
const BESIDE: [&str; 2] = ["kind", BETA_FILE.name];

impl SpecimenKind {
    /// Its keys in `[specimen]`.
    pub fn keys(self) -> &'static [Key] {
        match (self, self.part_through()) {
            (_, Some(description)) => part_through::keys(description),
            (SpecimenKind::SingleEdgeTension, _) => standard::SingleEdge::KEYS,
            (SpecimenKind::CompactTension, _) => standard::Compact::KEYS,
            (SpecimenKind::Plate, _) => plate::Keys::KEYS,
            (kind, _) => kind.named().map_or(standard::Strip::KEYS, named::Description::keys),
        }
    }

    /// Whether a table of β takes the place of its K: holes that cracks run into on their way, and fronts, have no one K over one length.
    pub fn takes_beta(self) -> bool {
        self.part_through().is_none() && !matches!(self, SpecimenKind::RowOfHoles | SpecimenKind::StopHole)
    }

    /// Its section, every key of which has been looked at.
    /// Errors: all keys that are not known, missing or wrong by themselves.
    pub(super) fn given(self, value: &Value) -> Result<Given<'_>> {
        let given = Given::of(value, "specimen")?;
        Error::of_all(self.mistakes(given))?;
        Ok(given)
    }

    /// What is wrong with the keys of its section by themselves.
    pub(super) fn mistakes(self, given: Given<'_>) -> Vec<perilife_base::error::InputError> {
        let all: Vec<_> = SpecimenKind::ALL.iter().map(|kind| (kind.name(), kind.keys())).collect();
        mistakes(given, self.keys(), &BESIDE, Some(&Kinds { tag: "kind", own: self.name(), all: &all }))
    }
}
