//! Keys of `[specimen]` that several kinds share.

use super::SpecimenKind;
use perilife_base::keys::{Field, Key, Need, key, length};

pub(super) const WIDTH: Key = length("width_mm", "Width W");
pub(super) const LENGTH: Key = length("length_mm", "Length L: along the load");
pub(super) const THICKNESS: Key = length("thickness_mm", "Thickness B");
pub(super) const HOLE_DIAMETER: Key = length("hole_diameter_mm", "Hole diameter");
pub(super) const CRACK_LENGTH: Key = length("crack_length_mm", "Initial crack length a: from the edge");
/// Key of a table of β, which through cracks take beside the keys of their kind.
pub const BETA_FILE: Key = Key {
    need: Need::Optional,
    check: <String as Field>::check,
    ..key("beta_file", "Table of β: K = β σ √(πa), CSV of crack_length_mm and beta; `perilife sif --sweep` writes one")
};
pub const KIND: Key = Key { shape: <SpecimenKind as Field>::SHAPE, ..key("kind", "Kind of specimen") };
