//! What a column name means, in the words and units that laboratories write: `Crack size (mm)`, `Cycle Count`, `Pmax [kN]`, `a/mm`.
//!
//! A name is cut into words, a unit at its end taken off, and what is left has to be made of known words alone: `Crack length rate` is
//! no crack length. Words of a quantity that a test has beside cycles, length and load (K, COD, time, temperature, sizes) mark a column
//! that is none of these, so that it never becomes a specimen.

mod vocabulary;

use vocabulary::*;

use super::import::{CycleUnit, IntensityUnit, LengthUnit, LoadUnit, RateUnit, Unit};

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The name of the specimen.
    Specimen,
    /// Cycles.
    Cycles,
    /// Crack length.
    Length,
    /// Length of one crack on one side of the specimen.
    Side,
    /// Largest load of a cycle.
    Max,
    /// Smallest load of a cycle.
    Min,
    /// Largest less smallest load of a cycle.
    Range,
    /// Smallest over largest load.
    Ratio,
    /// A load, but the name does not say which.
    Load,
    /// Range of the stress intensity.
    DeltaK,
    /// da/dN.
    Rate,
    /// Width of the specimen.
    Width,
    /// Thickness of the specimen.
    Thickness,
    /// Another quantity of a test.
    Other,
    /// Nothing that the name says.
    Unknown,
}

/// The unit that a name says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Named {
    /// None.
    No,
    /// This one.
    Is(Unit),
    /// In brackets stands something else.
    Strange,
}

/// A column of a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Column {
    /// Place in the header, from 0.
    pub index: usize,
    /// What it holds.
    pub role: Role,
    /// In which unit.
    pub unit: Named,
    /// What a number is multiplied by for SI units, or cycles: the unit, and 0.5 where the length is tip to tip.
    pub factor: f64,
    /// Whether numbers are decimal logarithms, of the quantity in its unit.
    pub is_log: bool,
}

impl Column {
    /// A column of one quantity in its unit.
    pub(super) fn new(index: usize, role: Role, unit: Named) -> Column {
        let factor = if let Named::Is(unit) = unit { unit.si() } else { 1.0 };
        Column { index, role, unit, factor, is_log: false }
    }

    /// The same column in a unit that the name does not say.
    pub(super) fn in_unit(self, unit: Unit) -> Column {
        let own = Column::new(self.index, self.role, self.unit).factor;
        Column { unit: Named::Is(unit), factor: self.factor / own * unit.si(), ..self }
    }

    /// What a name means, whatever its case, blanks and brackets.
    pub(super) fn named(index: usize, name: &str) -> Column {
        of_words(name, |words, bracket| {
            let column = |role, unit| Column::new(index, role, unit);
            // A bare capital letter names a specimen as often as a crack length.
            if words.is_empty() || (words == ["a"] && bracket.is_empty() && name.trim() == "A") {
                return column(Role::Unknown, Named::No);
            }
            if any_in(words, SPECIMEN) && all_in(words, &[SPECIMEN, SPECIMEN_MORE]) {
                return column(Role::Specimen, Named::No);
            }
            let known = cycles(words, bracket).or_else(|| load(words, bracket)).or_else(|| length(words, bracket));
            if let Some((role, unit)) = known {
                let share = if words.contains(&"2a") { 0.5 } else { 1.0 };
                let column = column(role, unit);
                return Column { factor: share * column.factor, ..column };
            }
            if let Some(column) = of_rates(index, words, bracket).or_else(|| size(index, words, bracket)) {
                return column;
            }
            let is_other = [OTHER, MAX, MIN].iter().any(|list| any_in(words, list)) || load(words, &[]).is_some();
            column(if is_other { Role::Other } else { Role::Unknown }, Named::No)
        })
    }

    /// The column that the user gives a role, its unit still that of its name.
    pub(super) fn given(index: usize, role: Role, name: &str) -> Column {
        let own = Column::named(index, name);
        if role == Role::Length && own.factor < Column::new(index, Role::Length, own.unit).factor {
            return own;
        }
        if matches!(role, Role::DeltaK | Role::Rate) {
            return of_words(name, |words, bracket| of_quantity(index, role, words, bracket, &|_| true)).unwrap_or(Column::new(
                index,
                role,
                Named::No,
            ));
        }
        let known: fn(&[&str]) -> Option<Unit> = match role {
            Role::Cycles => cycle_unit,
            Role::Length | Role::Side => length_unit,
            Role::Max | Role::Min | Role::Range => load_unit,
            _ => return Column::new(index, role, Named::No),
        };
        let unit = of_words(name, |words, bracket| unit_of(words, bracket, known).last().map_or(Named::No, |(_, unit)| *unit));
        Column::new(index, role, unit)
    }
}

fn of_words<T>(name: &str, read: impl FnOnce(&[&str], &[&str]) -> T) -> T {
    let (words, bracket) = words(name);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let bracket: Vec<&str> = bracket.iter().map(String::as_str).collect();
    read(&words, &bracket)
}

fn any_in(words: &[&str], list: &str) -> bool {
    words.iter().any(|word| is_in(list, word))
}

/// Whether every word is one of the lists.
fn all_in(words: &[&str], lists: &[&str]) -> bool {
    words.iter().all(|word| lists.iter().any(|list| is_in(list, word)))
}

/// A unit at the end: of the bracket if there is one, else of the words. Gives the words without it.
fn unit_of<'w>(words: &'w [&'w str], bracket: &[&str], known: fn(&[&str]) -> Option<Unit>) -> Vec<(&'w [&'w str], Named)> {
    if !bracket.is_empty() && bracket != ["-"] {
        return vec![(words, known(bracket).map_or(Named::Strange, Named::Is))];
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

fn cycles(words: &[&str], bracket: &[&str]) -> Option<(Role, Named)> {
    // `kilocycles` has its unit in the word.
    let in_word = |words: &[&str]| {
        let mut ends = words.iter().filter(|word| word.ends_with("cycles") || word.ends_with("cycle"));
        ends.find_map(|word| cycle_unit(&[word]).filter(|unit| unit.si() > 1.0)).map(Named::Is)
    };
    unit_of(words, bracket, cycle_unit).into_iter().find_map(|(words, unit)| {
        let core = any_in(words, CYCLES) || words.last().is_some_and(|word| is_in(COUNTS, word));
        (core && all_in(words, &[CYCLES, CYCLES_MORE])).then(|| (Role::Cycles, in_word(words).unwrap_or(unit)))
    })
}

fn cycle_unit(words: &[&str]) -> Option<Unit> {
    let words = words.iter().map(|word| word.trim_start_matches('x')).filter(|word| !["", "in", "of"].contains(word));
    let words: Vec<&str> = words.collect();
    // `thousand cycles` is `thousand`.
    let words = match words.as_slice() {
        [number @ .., "cycles" | "cycle" | "zyklen"] if !number.is_empty() => number,
        words => words,
    };
    Unit::spelled(words, Unit::Cycles(CycleUnit::Cycles))
}

fn length(words: &[&str], bracket: &[&str]) -> Option<(Role, Named)> {
    unit_of(words, bracket, length_unit).into_iter().find_map(|(words, unit)| {
        let has = |list| any_in(words, list);
        let is_double = words == ["2a"] || (words.contains(&"2a") && all_in(words, &["2a", LENGTH, LENGTH_MORE]));
        if is_double || (has(LENGTH) && all_in(words, &[LENGTH, LENGTH_MORE])) {
            return Some((Role::Length, unit));
        }
        let sides = has(SIDES) && all_in(words, &[SIDES, SIDE_MORE, LENGTH, LENGTH_MORE]);
        let lettered = has(LENGTH) && has(SIDE_LETTERS) && all_in(words, &[SIDE_LETTERS, SIDE_MORE, LENGTH, LENGTH_MORE]);
        (sides || lettered).then_some((Role::Side, unit))
    })
}

fn length_unit(words: &[&str]) -> Option<Unit> {
    Unit::spelled(words, Unit::Length(LengthUnit::Millimetre))
}

fn load(words: &[&str], bracket: &[&str]) -> Option<(Role, Named)> {
    let ratio =
        matches!(words, ["r"] | ["r", "ratio"] | ["stress" | "load" | "force", "ratio"] | ["stress" | "load", "ratio", "r"]);
    if ratio && (bracket.is_empty() || bracket == ["-"]) {
        return Some((Role::Ratio, Named::No));
    }
    unit_of(words, bracket, load_unit).into_iter().find_map(|(words, unit)| {
        let has = |lists: &[&str]| lists.iter().any(|list| any_in(words, list));
        let stress = has(&[STRESS, MAX_STRESS, MIN_STRESS]);
        let lists = [FORCE, STRESS, LOAD_MORE, RANGE, PART, MAX, MIN, MAX_WORDS, MIN_WORDS, MAX_STRESS, MIN_STRESS];
        if !(stress || has(&[FORCE, MAX_WORDS, MIN_WORDS])) || !all_in(words, &lists) {
            return None;
        }
        // A unit of the other quantity is none: `stress max (kN)`.
        let unit = match unit {
            Named::Is(unit) if unit.is_stress() != stress => Named::Strange,
            unit => unit,
        };
        let (largest, smallest) = (has(&[MAX, MAX_WORDS, MAX_STRESS]), has(&[MIN, MIN_WORDS, MIN_STRESS]));
        let role = match (largest, smallest, has(&[RANGE])) {
            _ if has(&[PART]) => Role::Load,
            (true, false, false) => Role::Max,
            (false, true, false) => Role::Min,
            (false, false, true) => Role::Range,
            _ => Role::Load,
        };
        Some((role, unit))
    })
}

/// Most words of a unit of stress intensity or rate.
const UNIT_WORDS: usize = 5;

/// A column of ΔK or da/dN: `ΔK (MPa√m)`, `log da/dN [in/cycle]`, `delta_k_mpa_sqrt_m`.
fn of_rates(index: usize, words: &[&str], bracket: &[&str]) -> Option<Column> {
    let delta_k = of_quantity(index, Role::DeltaK, words, bracket, &|core| DELTA_K.contains(&core.join(" ").as_str()));
    delta_k.or_else(|| of_quantity(index, Role::Rate, words, bracket, &|core| RATE.contains(&core.join(" ").as_str())))
}

/// The column of a quantity whose unit may have blanks and brackets of its own: the longest unit at the end of all words counts.
fn of_quantity(index: usize, role: Role, words: &[&str], bracket: &[&str], is_core: &dyn Fn(&[&str]) -> bool) -> Option<Column> {
    let like = match role {
        Role::DeltaK => Unit::Intensity(IntensityUnit::MpaSqrtM),
        _ => Unit::Rate(RateUnit::Millimetre),
    };
    let all = [words, bracket].concat();
    let (is_log, all) = match all.as_slice() {
        ["log", "10", rest @ ..] | ["log" | "log10" | "lg", rest @ ..] => (true, rest),
        all => (false, all),
    };
    let cuts = (1..all.len()).filter(|cut| all.len() - cut <= UNIT_WORDS);
    let named = cuts.filter_map(|cut| Some((&all[..cut], Unit::spelled(&all[cut..], like)?))).next();
    let named = named.map(|(core, unit)| (core.strip_suffix(&["in"]).filter(|core| !core.is_empty()).unwrap_or(core), unit));
    let (core, unit) = match named {
        Some((core, unit)) => (core, Named::Is(unit)),
        None if bracket.is_empty() => (all, Named::No),
        None => (&all[..all.len() - bracket.len()], Named::Strange),
    };
    is_core(core).then(|| Column { is_log, ..Column::new(index, role, unit) })
}

/// A column of the width or thickness of the specimen, in a unit.
fn size(index: usize, words: &[&str], bracket: &[&str]) -> Option<Column> {
    unit_of(words, bracket, length_unit).into_iter().find_map(|(words, unit)| {
        let role = match words {
            ["w" | "width"] | ["specimen", "width"] => Role::Width,
            ["b" | "thickness"] | ["specimen", "thickness"] => Role::Thickness,
            _ => return None,
        };
        matches!(unit, Named::Is(_)).then(|| Column::new(index, role, unit))
    })
}

fn load_unit(words: &[&str]) -> Option<Unit> {
    Unit::spelled(words, Unit::Load(LoadUnit::Newton))
}

/// The unit of length that a name ends with, whatever else it says: a specimen's name in a wide table.
pub(super) fn length_unit_at_end(name: &str) -> Named {
    of_words(name, |words, bracket| match words {
        _ if !bracket.is_empty() => length_unit(bracket).map_or(Named::Strange, Named::Is),
        [.., last] if words.len() > 1 && *last != "m" => length_unit(&[last]).map_or(Named::No, Named::Is),
        _ => Named::No,
    })
}

/// A name with the unit of the row below it, unless it has one itself.
pub(super) fn with_unit(name: &str, unit: &str) -> String {
    let has_unit = Column::named(0, name).unit != Named::No;
    let unit = unit.trim_matches(['(', ')', '[', ']', '{', '}', ' ']);
    if has_unit || unit.is_empty() { name.to_owned() } else { format!("{name} [{unit}]") }
}

/// Whether a cell of a row below the header is a unit, or blank.
pub(super) fn is_unit_or_blank(cell: &str) -> bool {
    const MORE: [&[&str]; 12] =
        [&["s"], &["sec"], &["h"], &["hz"], &["c"], &["f"], &["k"], &["v"], &["mm", "cycle"], &["cm"], &["um"], &["gpa"]];
    let text = cell.trim_matches(['(', ')', '[', ']', '{', '}', ' ', '.']);
    if text.is_empty() || text.chars().all(|c| "-–—/%°1".contains(c)) {
        return true;
    }
    of_words(text, |words, _| {
        let k_or_stress = words.first().is_some_and(|word| ["mpa", "ksi", "kn", "n", "psi", "mpam", "mm", "kpa"].contains(word));
        [length_unit, load_unit, cycle_unit].iter().any(|known| known(words).is_some())
            || MORE.contains(&words)
            || (k_or_stress && words.len() <= 4)
    })
}
