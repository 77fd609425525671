//! What a column name means, in the words and units that laboratories write: `Crack size (mm)`, `Cycle Count`, `Pmax [kN]`, `a/mm`.
//!
//! A name is cut into words, a unit at its end taken off, and what is left has to be made of known words alone: `Crack length rate` is
//! no crack length. Words of a quantity that a test has beside cycles, length and load (K, COD, time, temperature, sizes) mark a column
//! that is none of these, so that it never becomes a specimen.

pub mod vocabulary;

use vocabulary::*;

use super::decimal::Numbers;
use super::units::{CycleUnit, IntensityUnit, LengthUnit, LoadUnit, RateUnit, Unit};

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
    /// Stress intensity at maximum load, in tables of rates.
    KMax,
    /// Stress intensity at minimum load, in tables of rates.
    KMin,
    /// da/dN.
    Rate,
    /// Width of the specimen.
    Width,
    /// Thickness of the specimen.
    Thickness,
    /// Whether a reading counts.
    Mark,
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
    /// How the decimal sign of its numbers is looked for.
    pub fn numbers(&self) -> Numbers {
        let counts = match self.role {
            Role::Cycles => self.factor == 1.0,
            Role::Max | Role::Min | Role::Range => self.factor < 1e3,
            _ => false,
        };
        Numbers { index: self.index, counts }
    }

    /// A column of one quantity in its unit.
    pub fn new(index: usize, role: Role, unit: Named) -> Column {
        let factor = if let Named::Is(unit) = unit { unit.si() } else { 1.0 };
        Column { index, role, unit, factor, is_log: false }
    }

    /// The same column in a unit that the name does not say.
    pub fn in_unit(self, unit: Unit) -> Column {
        let own = Column::new(self.index, self.role, self.unit).factor;
        Column { unit: Named::Is(unit), factor: self.factor / own * unit.si(), ..self }
    }

    /// Whether it holds lengths tip to tip (`2a`), of which the half is taken.
    pub fn is_tip_to_tip(&self) -> bool {
        self.factor < Column::new(self.index, self.role, self.unit).factor
    }

    /// The same column of lengths tip to tip.
    pub fn tip_to_tip(self) -> Column {
        Column { factor: 0.5 * self.factor, ..self }
    }

    /// What a name means, whatever its case, blanks and brackets.
    pub fn named(index: usize, name: &str) -> Column {
        of_words(name, |words, bracket| {
            let column = |role, unit| Column::new(index, role, unit);
            // A bare capital letter names a specimen as often as a crack length.
            if words.is_empty() || (words == ["a"] && bracket.is_empty() && name.trim() == "A") {
                return column(Role::Unknown, Named::No);
            }
            if any_in(words, SPECIMEN) && all_in(words, &[SPECIMEN, SPECIMEN_MORE]) {
                return column(Role::Specimen, Named::No);
            }
            if [MARKS, MARKS_KEEP, MARKS_OUT].iter().any(|list| any_in(words, list))
                && all_in(words, &[MARKS, MARKS_KEEP, MARKS_OUT, MARKS_MORE])
            {
                return column(Role::Mark, Named::No);
            }
            let known = cycles(words, bracket).or_else(|| load(words, bracket)).or_else(|| length(words, bracket));
            if let Some((role, unit)) = known {
                let column = column(role, unit);
                return if words.contains(&"2a") { column.tip_to_tip() } else { column };
            }
            if let Some(column) = of_rates(index, words, bracket).or_else(|| size(index, words, bracket)) {
                return column;
            }
            let is_other = [OTHER, MAX, MIN].iter().any(|list| any_in(words, list)) || load(words, &[]).is_some();
            // One in a unit of load is told of if it is not read.
            let in_units = unit_of(words, bracket, load_unit).into_iter().map(|(_, unit)| unit);
            let mut of_load =
                in_units.filter(|unit| matches!(unit, Named::Is(_)) && (!bracket.is_empty() || words.last() != Some(&"n")));
            match is_other {
                true => column(Role::Other, of_load.next().unwrap_or(Named::No)),
                false => column(Role::Unknown, Named::No),
            }
        })
    }

    /// What a name means in a table of rates: `Kmax (MPa√m)` and `K_min`, too.
    pub fn named_of_rates(index: usize, name: &str) -> Column {
        let of_end = |role: Role, list: &str| {
            let is_end = |core: &[&str]| match core.iter().position(|word| is_in(list, word)) {
                Some(place) => K_AT.contains(&&*[&core[..place], &core[place + 1..]].concat().join(" ")),
                None => matches!((core, role), (["kmax"], Role::KMax) | (["kmin"], Role::KMin)),
            };
            of_words(name, |words, bracket| of_quantity(index, role, words, bracket, &is_end))
        };
        of_end(Role::KMax, MAX).or_else(|| of_end(Role::KMin, MIN)).unwrap_or_else(|| Column::named(index, name))
    }

    /// The column that the user gives a role, its unit still that of its name.
    pub fn given(index: usize, role: Role, name: &str) -> Column {
        let own = Column::named(index, name);
        if matches!(role, Role::Length | Role::Side) && own.is_tip_to_tip() {
            return Column { role, ..own };
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

/// Longest name, bytes: what is longer is text that names nothing, and would be compared with every word that is known.
const NAME_MAX: usize = 200;

/// Asks the words of a name, and those of a bracket at its end.
pub fn of_words<T>(name: &str, read: impl FnOnce(&[&str], &[&str]) -> T) -> T {
    let (words, bracket) = words(if name.len() > NAME_MAX { "" } else { name });
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let bracket: Vec<&str> = bracket.iter().map(String::as_str).collect();
    read(&words, &bracket)
}

/// The unit of a name that is made up of a quantity, whose words are asked about, and perhaps a unit like this one; `None` of another name.
pub fn quantity(name: &str, like: Unit, is_core: impl Fn(&[&str]) -> bool) -> Option<Named> {
    let known: fn(&[&str]) -> Option<Unit> = if let Unit::Length(_) = like { length_unit } else { load_unit };
    of_words(name, |words, bracket| {
        unit_of(words, bracket, known).into_iter().find_map(|(words, unit)| is_core(words).then_some(unit))
    })
}

/// Whether words are made up of some lists, at least one of the first.
pub fn made_of(words: &[&str], core: &str, more: &[&str]) -> bool {
    any_in(words, core) && words.iter().all(|word| is_in(core, word) || more.iter().any(|list| is_in(list, word)))
}

/// Whether one of the words is in a list.
pub fn any_in(words: &[&str], list: &str) -> bool {
    words.iter().any(|word| is_in(list, word))
}

/// Whether a word of a text is one of a list.
pub fn says_one_of(text: &str, list: &str) -> bool {
    words(text).0.iter().any(|word| is_in(list, word))
}

/// Whether every word is one of the lists.
pub fn all_in(words: &[&str], lists: &[&str]) -> bool {
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
        let by_method = matches!(unit, Named::Is(_)) && has(METHODS);
        if (has(LENGTH) || by_method) && all_in(words, &[LENGTH, LENGTH_MORE, METHODS]) {
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
        let stress = has(&[STRESS, MAX_STRESS, MIN_STRESS, RANGE_STRESS]);
        let of_force = [FORCE, LOAD_MORE, RANGE, PART, MAX, MIN, MAX_WORDS, MIN_WORDS, RANGE_WORDS];
        let lists = [&of_force[..], &[STRESS, MAX_STRESS, MIN_STRESS, RANGE_STRESS]].concat();
        if !(stress || has(&[FORCE, MAX_WORDS, MIN_WORDS, RANGE_WORDS])) || !all_in(words, &lists) {
            return None;
        }
        // A unit of the other quantity is none: `stress max (kN)`.
        let unit = match unit {
            Named::Is(unit) if unit.is_stress() != stress => Named::Strange,
            unit => unit,
        };
        // `dF (Hz)` is no load, and `DP` may be the number of a data point.
        let is_short = matches!(words, ["dp" | "df" | "ds"]);
        if is_short && unit == Named::Strange {
            return None;
        }
        let (largest, smallest) = (has(&[MAX, MAX_WORDS, MAX_STRESS]), has(&[MIN, MIN_WORDS, MIN_STRESS]));
        let role = match (largest, smallest, has(&[RANGE, RANGE_WORDS, RANGE_STRESS])) {
            _ if has(&[PART]) || (is_short && unit == Named::No) => Role::Load,
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
        Role::Rate => Unit::Rate(RateUnit::Millimetre),
        _ => Unit::Intensity(IntensityUnit::MpaSqrtM),
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

/// The unit of cycles or length that a name ends with, whatever else it says: a specimen's name in a wide table.
pub fn unit_at_end(name: &str, role: Role) -> Named {
    let known = if role == Role::Cycles { cycle_unit } else { length_unit };
    // `CT-1000` and `plate m` end with no unit.
    let is_said = |unit: &[&str]| {
        let is_word = |word: &&str| word.starts_with('x') || (word.len() > 1 && word.chars().all(char::is_alphabetic));
        name.contains(['^', '³', '⁶', '×']) || unit.iter().any(is_word)
    };
    of_words(name, |words, bracket| {
        let mut readings = unit_of(words, bracket, known).into_iter().rev();
        let said = readings.find(|(rest, unit)| *unit == Named::No || !bracket.is_empty() || is_said(&words[rest.len()..]));
        said.map_or(Named::No, |(_, unit)| unit)
    })
}

/// Whether a specimen's name in a wide table says that its lengths are tip to tip (`P1 2a`) or the half (`P1 a`); `None` if neither.
pub fn says_tip_to_tip(name: &str) -> Option<bool> {
    of_words(name, |words, _| match words.contains(&"2a") {
        true => Some(true),
        false => words.contains(&"a").then_some(false),
    })
}

/// Whether a name is a word and perhaps a unit of length.
pub fn is_length_of(name: &str, word: &str) -> bool {
    of_words(name, |words, bracket| unit_of(words, bracket, length_unit).iter().any(|(words, _)| *words == [word]))
}

/// Characters of a cell in a row of units that is as good as blank.
const NO_UNIT: &str = "-–—/%°1";

/// A name with the unit of the row below it, unless it has one itself.
/// Errors: its own unit, where the row says another one.
pub fn with_unit(name: &str, unit: &str) -> std::result::Result<String, Unit> {
    let column = Column::named(0, name);
    let unit = unit.trim_matches(['(', ')', '[', ']', '{', '}', ' ']);
    if unit.chars().all(|c| NO_UNIT.contains(c)) && column.unit != Named::No {
        return Ok(name.to_owned());
    }
    let said = [column.unit, unit_at_end(name, Role::Length), unit_at_end(name, Role::Cycles)];
    for own in said.into_iter().filter_map(|named| if let Named::Is(own) = named { Some(own) } else { None }) {
        let below = of_words(unit, |words, _| match own {
            Unit::Cycles(_) => cycle_unit(words),
            _ => Unit::spelled(words, own),
        });
        match below {
            Some(below) if below == own => return Ok(name.to_owned()),
            Some(_) => return Err(own),
            None => {}
        }
    }
    let has_unit = column.unit != Named::No;
    Ok(if has_unit || unit.is_empty() { name.to_owned() } else { format!("{name} [{unit}]") })
}

/// Whether a cell of a row below the header is a unit, or blank.
pub fn is_unit_or_blank(cell: &str) -> bool {
    const MORE: [&[&str]; 12] =
        [&["s"], &["sec"], &["h"], &["hz"], &["c"], &["f"], &["k"], &["v"], &["mm", "cycle"], &["cm"], &["um"], &["gpa"]];
    let text = cell.trim_matches(['(', ')', '[', ']', '{', '}', ' ', '.']);
    if text.is_empty() || text.chars().all(|c| NO_UNIT.contains(c)) {
        return true;
    }
    of_words(text, |words, _| {
        let k_or_stress = words.first().is_some_and(|word| ["mpa", "ksi", "kn", "n", "psi", "mpam", "mm", "kpa"].contains(word));
        let is_of = |like| Unit::spelled(words, like).is_some();
        [length_unit, load_unit, cycle_unit].iter().any(|known| known(words).is_some())
            || is_of(Unit::Rate(RateUnit::Millimetre))
            || is_of(Unit::Intensity(IntensityUnit::MpaSqrtM))
            || MORE.contains(&words)
            || (k_or_stress && words.len() <= 4)
    })
}
