//! Plates that engineers know by name, drawn from a few keys: what `plate` would give for the same outline, holes and cracks, with the
//! loads and supports that go with the name.
//!
//! Lengths of cracks are those from the rim, edge or load line that the name stands for. Where one length is given for all cracks
//! (`crack_length_mm`), the crack length of a run is the mean of the cracks; where every crack has its own (`crack_lengths_mm`), their sum
//! and that of what they grow, as of a `plate`. `edges`, `pins`, `rollers` of `[loading]` take the place of the loads that a
//! kind brings along, `[supports]` that of its supports; the formula of its K then goes, too.
//!
//! A file of the folder holds all that is said of one kind. A new one is such a file, its `mod` and place in `KINDS`, and its name in
//! [`SpecimenKind`].

mod crack_at_hole;
mod cruciform;
mod edge_notch;
mod lug;
mod row_of_holes;
mod shapes;
mod single_edge_bend;
mod stop_hole;
mod two_pins;

use toml::Value;

use super::handbook::HandbookFormula;
use super::plate::Drawing;
use super::{LengthConvention, Load, LoadMeasure, Specimen, SpecimenKind, Support};
use perilife_base::error::{Error, Result};
use perilife_base::input::shorten;
use perilife_base::keys::{Given, Key};

const KINDS: &[&SpecimenSpec] = &[
    &crack_at_hole::KIND,
    &row_of_holes::KIND,
    &lug::KIND,
    &edge_notch::KIND,
    &stop_hole::KIND,
    &single_edge_bend::KIND,
    &two_pins::ECCENTRIC,
    &two_pins::WEDGE,
    &cruciform::KIND,
];

pub struct SpecimenSpec {
    /// Its name in `specimen.kind`.
    pub kind: SpecimenKind,
    keys: &'static [Key],
    layout: fn(&Given<'_>) -> Result<Layout>,
}

impl SpecimenSpec {
    pub(super) fn keys(&self) -> &'static [Key] {
        self.keys
    }
}

#[derive(Default)]
struct Layout {
    drawing: Drawing,
    /// Forces on it, N per N; none where edges carry a stress.
    loads: Vec<Load>,
    supports: Vec<Support>,
    /// Length of each of its cracks, m, where that is one.
    crack_length: Option<f64>,
    formula: Option<HandbookFormula>,
}

impl SpecimenKind {
    /// What a named plate is; `None` of all other kinds.
    pub fn named(self) -> Option<&'static SpecimenSpec> {
        KINDS.iter().copied().find(|description| description.kind == self)
    }

    /// Key by which cracks of such a kind are given whose length is read like this.
    pub(super) fn crack_key(self, convention: LengthConvention) -> &'static str {
        match (self, convention) {
            (SpecimenKind::Plate, _) => "specimen.cracks",
            (SpecimenKind::StopHole, _) => "specimen.formed_length_mm",
            (SpecimenKind::CrackAtHole | SpecimenKind::RowOfHoles | SpecimenKind::Lug, LengthConvention::SumOfTips) => {
                "specimen.crack_lengths_mm"
            }
            _ => "specimen.crack_length_mm",
        }
    }

    /// Whether it is a plate of free shape, drawn or named: holes, cracks and loads of its own, no formulas of its standard.
    pub fn is_plate(self) -> bool {
        self == SpecimenKind::Plate || self.named().is_some()
    }
}

/// Reads `[specimen]` of a named plate.
/// Errors: as of a `plate`, named by the keys of the kind as far as they go.
pub(super) fn from_value(description: &SpecimenSpec, value: &Value, notes: &mut Vec<String>) -> Result<Specimen> {
    let Layout { drawing, loads, supports, crack_length, formula } = (description.layout)(&Given::of(value, "specimen")?)?;
    let convention = if crack_length.is_some() { LengthConvention::MeanOfTips } else { LengthConvention::SumOfTips };
    let crack_key = description.kind.crack_key(convention);
    let first = notes.len();
    let plate = drawing.specimen(description.kind, notes).map_err(|error| by_own_keys(error, crack_key, value))?;
    for note in &mut notes[first..] {
        if let Some((_, rest)) = note.split_once(CRACKS).and_then(|(_, rest)| rest.split_once(']')) {
            *note = format!("cracks: {crack_key}: a crack{rest}");
        }
    }
    let crack_length = crack_length.unwrap_or(plate.crack_length);
    let load_measure = if loads.is_empty() { LoadMeasure::Stress } else { LoadMeasure::Force };
    Ok(Specimen { loads, supports, crack_length, convention, load_measure, own_formula: formula, ..plate })
}

const CRACKS: &str = "specimen.cracks[";
const HOLES: &str = "specimen.holes[";

/// What a `plate` refuses, by the keys of a kind: its cracks by that of their lengths, its holes by their diameter.
fn by_own_keys(error: Error, crack_key: &'static str, value: &Value) -> Error {
    let Error::Input(mut refused) = error else { return error };
    let (own, remedy) = match refused.key.as_deref() {
        Some(key) if key.starts_with(CRACKS) => (crack_key, "at least one crack must end inside the material"),
        Some(key) if key.starts_with(HOLES) => ("specimen.hole_diameter_mm", "use a smaller one, or a larger plate"),
        _ => return Error::Input(refused),
    };
    let given = own.strip_prefix("specimen.").and_then(|key| value.get(key));
    refused.key = Some(own.to_owned());
    refused.value = given.map(shorten);
    refused.remedy = remedy.to_owned();
    Error::Input(refused)
}
