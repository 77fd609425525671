//! What a column name means, in the words and units that laboratories write: `Crack size (mm)`, `Cycle Count`, `Pmax [kN]`, `a/mm`.
//!
//! A name is cut into words, a unit at its end taken off, and what is left has to be made of known words alone: `Crack length rate` is
//! no crack length. Words of a quantity that a test has beside cycles, length and load (K, COD, time, temperature, sizes) mark a column
//! that is none of these, so that it never becomes a specimen.

mod vocabulary;

use vocabulary::*;

use crate::calibration::import::{CycleUnit, LengthUnit, LoadUnit};

/// A unit as a name has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Named<U> {
    /// The name has none.
    No,
    /// This one.
    Is(U),
    /// In brackets stands something else.
    Strange,
}

/// Which load of a cycle a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LoadRole {
    /// The largest.
    Max,
    /// The smallest.
    Min,
    /// Smallest over largest.
    Ratio,
    /// Largest less smallest.
    Range,
    /// A load, but the name does not say which.
    Bare,
}

/// Meaning of a column name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Meaning {
    Specimen,
    Cycles(Named<CycleUnit>),
    Length(Named<LengthUnit>),
    /// Length of one crack on one side of the specimen.
    Side(Named<LengthUnit>),
    /// Twice the crack length: tip to tip of a central crack.
    Double(Named<LengthUnit>),
    Load(LoadRole, Named<LoadUnit>),
    /// Another quantity of a test.
    Other,
    Unknown,
}

/// The meaning of a column name, whatever its case, blanks and brackets.
pub(crate) fn meaning(name: &str) -> Meaning {
    let (words, bracket) = words(name);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let bracket: Vec<&str> = bracket.iter().map(String::as_str).collect();
    match words.as_slice() {
        [] => return Meaning::Unknown,
        // A bare capital letter names a specimen as often as a crack length.
        ["a"] if bracket.is_empty() && name.trim() == "A" => return Meaning::Unknown,
        _ => {}
    }
    if words.iter().any(|word| is_in(SPECIMEN, word)) && all_of(&words, &[SPECIMEN, SPECIMEN_MORE]) {
        return Meaning::Specimen;
    }
    cycles(&words, &bracket).or_else(|| load(&words, &bracket)).or_else(|| length(&words, &bracket)).unwrap_or_else(|| {
        let known = words.iter().any(|word| is_in(OTHER, word) || is_in(MAX, word) || is_in(MIN, word));
        if known || load(&words, &[]).is_some() { Meaning::Other } else { Meaning::Unknown }
    })
}

/// Whether every word is one of the lists.
fn all_of(words: &[&str], lists: &[&str]) -> bool {
    words.iter().all(|word| lists.iter().any(|list| is_in(list, word)))
}

/// A unit at the end: of the bracket if there is one, else of the words. Gives the words without it.
fn unit_of<'w, U>(words: &'w [&'w str], bracket: &[&str], known: fn(&[&str]) -> Option<U>) -> Vec<(&'w [&'w str], Named<U>)> {
    if !bracket.is_empty() && bracket != ["-"] {
        let unit = known(bracket).map_or(Named::Strange, Named::Is);
        return vec![(words, unit)];
    }
    let mut readings = vec![(words, Named::No)];
    for cut in (1..words.len()).rev().take(4) {
        if let Some(unit) = known(&words[cut..]) {
            // `crack length in mm`.
            let name = &words[..cut];
            let name = name.strip_suffix(&["in"]).filter(|name| !name.is_empty()).unwrap_or(name);
            readings.push((name, Named::Is(unit)));
        }
    }
    readings
}

fn cycles(words: &[&str], bracket: &[&str]) -> Option<Meaning> {
    let in_word = |words: &[&str]| {
        words.iter().find_map(|word| {
            let ends = word.ends_with("cycles") || word.ends_with("cycle");
            if !ends {
                None
            } else if is_in(KILO, word) {
                Some(CycleUnit::Kilocycles)
            } else if is_in(MEGA, word) {
                Some(CycleUnit::Megacycles)
            } else {
                None
            }
        })
    };
    let of_count = |words: &[&str]| words.last().is_some_and(|word| is_in(COUNTS, word));
    unit_of(words, bracket, cycle_unit).into_iter().find_map(|(words, unit)| {
        let core = words.iter().any(|word| is_in(CYCLES, word)) || of_count(words);
        if !core || !all_of(words, &[CYCLES, CYCLES_MORE]) {
            return None;
        }
        Some(Meaning::Cycles(match (in_word(words), unit) {
            (Some(unit), _) => Named::Is(unit),
            (None, unit) => unit,
        }))
    })
}

fn cycle_unit(words: &[&str]) -> Option<CycleUnit> {
    let words: Vec<&str> =
        words.iter().map(|word| word.trim_start_matches('x')).filter(|word| !["", "in", "of"].contains(word)).collect();
    match words.as_slice() {
        ["cycles" | "cycle" | "cyc" | "1" | "zyklen" | "count" | "counts" | "lw" | "n"] => Some(CycleUnit::Cycles),
        [one] | [one, "cycles" | "cycle" | "zyklen"] if is_in(KILO, one) => Some(CycleUnit::Kilocycles),
        [one] | [one, "cycles" | "cycle" | "zyklen"] if is_in(MEGA, one) => Some(CycleUnit::Megacycles),
        ["10", "3"] | ["10", "3", "cycles"] => Some(CycleUnit::Kilocycles),
        ["10", "6"] | ["10", "6", "cycles"] => Some(CycleUnit::Megacycles),
        _ => None,
    }
}

fn length(words: &[&str], bracket: &[&str]) -> Option<Meaning> {
    unit_of(words, bracket, length_unit).into_iter().find_map(|(words, unit)| {
        let has = |list: &str| words.iter().any(|word| is_in(list, word));
        let core = has(LENGTH) || words == ["crack", "size"];
        if words == ["2a"] || (words.contains(&"2a") && all_of(words, &["2a", LENGTH, LENGTH_MORE])) {
            return Some(Meaning::Double(unit));
        }
        if core && all_of(words, &[LENGTH, LENGTH_MORE]) {
            return Some(Meaning::Length(unit));
        }
        let sides = has(SIDES) && all_of(words, &[SIDES, SIDE_MORE, LENGTH, LENGTH_MORE]);
        let lettered = core && has(SIDE_LETTERS) && all_of(words, &[SIDE_LETTERS, SIDE_MORE, LENGTH, LENGTH_MORE]);
        (sides || lettered).then_some(Meaning::Side(unit))
    })
}

fn length_unit(words: &[&str]) -> Option<LengthUnit> {
    match words {
        ["mm" | "millimetre" | "millimeter" | "millimetres" | "millimeters"] => Some(LengthUnit::Millimetre),
        ["in" | "inch" | "inches"] => Some(LengthUnit::Inch),
        ["m" | "metre" | "meter" | "metres" | "meters"] => Some(LengthUnit::Metre),
        _ => None,
    }
}

fn load(words: &[&str], bracket: &[&str]) -> Option<Meaning> {
    let ratio =
        matches!(words, ["r"] | ["r", "ratio"] | ["stress" | "load" | "force", "ratio"] | ["stress" | "load", "ratio", "r"]);
    if ratio && (bracket.is_empty() || bracket == ["-"]) {
        return Some(Meaning::Load(LoadRole::Ratio, Named::No));
    }
    unit_of(words, bracket, load_unit).into_iter().find_map(|(words, unit)| {
        let has = |list: &str| words.iter().any(|word| is_in(list, word));
        let whole = [MAX_WORDS, MIN_WORDS, MAX_STRESS, MIN_STRESS];
        let core = has(FORCE) || has(STRESS) || whole.iter().any(|list| has(list));
        let stress = has(STRESS) || has(MAX_STRESS) || has(MIN_STRESS);
        let lists = [FORCE, STRESS, LOAD_MORE, RANGE, PART, MAX, MIN, MAX_WORDS, MIN_WORDS, MAX_STRESS, MIN_STRESS];
        if !core || !all_of(words, &lists) {
            return None;
        }
        // A unit of the other quantity is none: `stress max (kN)`.
        let unit = match unit {
            Named::Is(unit) if unit.is_stress() != stress => Named::Strange,
            unit => unit,
        };
        let [largest, smallest] =
            [[MAX, MAX_WORDS, MAX_STRESS], [MIN, MIN_WORDS, MIN_STRESS]].map(|lists| lists.into_iter().any(has));
        let role = match (largest, smallest, has(RANGE)) {
            _ if has(PART) => LoadRole::Bare,
            (true, false, false) => LoadRole::Max,
            (false, true, false) => LoadRole::Min,
            (false, false, true) => LoadRole::Range,
            _ => LoadRole::Bare,
        };
        Some(Meaning::Load(role, unit))
    })
}

fn load_unit(words: &[&str]) -> Option<LoadUnit> {
    match words {
        ["n" | "newton" | "newtons"] => Some(LoadUnit::Newton),
        ["kn" | "kilonewton" | "kilonewtons"] => Some(LoadUnit::Kilonewton),
        ["lbf" | "lb" | "lbs" | "pounds" | "pound"] => Some(LoadUnit::PoundForce),
        ["kip" | "kips" | "klbf" | "klb" | "klbs"] => Some(LoadUnit::Kip),
        ["kgf" | "kg" | "kp"] => Some(LoadUnit::KilogramForce),
        ["mpa"] | ["n", "mm2"] | ["n", "mm", "2"] => Some(LoadUnit::Megapascal),
        ["ksi"] => Some(LoadUnit::Ksi),
        _ => None,
    }
}

/// The unit of length that a name ends with, whatever else it says: a specimen's name in a wide table.
pub(crate) fn length_unit_at_end(name: &str) -> Named<LengthUnit> {
    let (words, bracket) = words(name);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let bracket: Vec<&str> = bracket.iter().map(String::as_str).collect();
    if !bracket.is_empty() {
        return length_unit(&bracket).map_or(Named::Strange, Named::Is);
    }
    match words.as_slice() {
        [.., last] if words.len() > 1 && *last != "m" => length_unit(&[last]).map_or(Named::No, Named::Is),
        _ => Named::No,
    }
}

/// Units of a column that the user names as one of these quantities.
pub(crate) fn units_of(name: &str) -> (Named<CycleUnit>, Named<LengthUnit>, Named<LoadUnit>) {
    let (words, bracket) = words(name);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let bracket: Vec<&str> = bracket.iter().map(String::as_str).collect();
    fn last<U: Copy>(words: &[&str], bracket: &[&str], known: fn(&[&str]) -> Option<U>) -> Named<U> {
        let ends = |reading: &(&[&str], Named<U>)| reading.1;
        unit_of(words, bracket, known).iter().map(ends).next_back().unwrap_or(Named::No)
    }
    (last(&words, &bracket, cycle_unit), last(&words, &bracket, length_unit), last(&words, &bracket, load_unit))
}

/// A name with the unit of the row below it, unless it has one itself.
pub(crate) fn with_unit(name: &str, unit: &str) -> String {
    let has_unit = match meaning(name) {
        Meaning::Cycles(unit) => unit != Named::No,
        Meaning::Length(unit) | Meaning::Side(unit) | Meaning::Double(unit) => unit != Named::No,
        Meaning::Load(_, unit) => unit != Named::No,
        _ => false,
    };
    let unit = unit.trim_matches(['(', ')', '[', ']', '{', '}', ' ']);
    if has_unit || unit.is_empty() { name.to_owned() } else { format!("{name} [{unit}]") }
}

/// Whether a cell of a row below the header is a unit, or blank.
pub(crate) fn is_unit_or_blank(cell: &str) -> bool {
    const MORE: [&[&str]; 12] =
        [&["s"], &["sec"], &["h"], &["hz"], &["c"], &["f"], &["k"], &["v"], &["mm", "cycle"], &["cm"], &["um"], &["gpa"]];
    let text = cell.trim_matches(['(', ')', '[', ']', '{', '}', ' ', '.']);
    if text.is_empty() || text.chars().all(|c| "-–—/%°1".contains(c)) {
        return true;
    }
    let (words, _) = words(text);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let k_or_stress = words.first().is_some_and(|word| ["mpa", "ksi", "kn", "n", "psi", "mpam", "mm", "kpa"].contains(word));
    length_unit(&words).is_some()
        || load_unit(&words).is_some()
        || cycle_unit(&words).is_some()
        || MORE.contains(&words.as_slice())
        || (k_or_stress && words.len() <= 4)
}
