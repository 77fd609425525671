//! What a column name means, by the vocabulary of `data/columns.toml`: `Crack size (mm)`, `Cycle Count`, `Pmax [kN]`, `a/mm`.
//!
//! A name is folded to words, a unit at its end taken off, and what is left has to be one form of the vocabulary as a whole: `Crack length
//! rate` is not a crack length. A name with a word of loads, lengths or cycles that is not a form is never taken for a specimen.

use std::collections::{BTreeMap, HashMap};
use std::sync::LazyLock;

use serde::Deserialize;

use super::decimal::Numbers;
use super::units::{CycleUnit, IntensityUnit, LengthUnit, LoadUnit, RateUnit, Unit};
use super::words::{COLUMNS, words};

/// Longest name that can be a form, bytes.
const NAME_MAX: usize = 200;

/// Kind of table, which has forms of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    Readings,
    /// Rates over ΔK: the forms of readings, K_max and K_min.
    Rates,
    /// Cycles or turning points of a spectrum.
    Spectrum,
    ResidualStress,
    /// β over crack length: the forms of readings, and β.
    Beta,
}

impl Kind {
    /// Its parts of the vocabulary, those looked at first.
    fn parts(self) -> impl Iterator<Item = &'static Part> {
        let readings = matches!(self, Kind::Rates | Kind::Beta).then_some(Kind::Readings);
        [self].into_iter().chain(readings).filter_map(|kind| PARTS.get(&kind))
    }
}

/// What a column holds; loads are those of a cycle, K those of tables of rates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    Specimen,
    /// Cycles, or how often a cycle occurs.
    Cycles,
    Length,
    /// Crack length by an instrument.
    Method,
    Side,
    Max,
    Min,
    Range,
    Amplitude,
    Mean,
    /// Smallest over largest load.
    Ratio,
    /// Loads in their order.
    Value,
    DeltaK,
    KMax,
    KMin,
    /// da/dN.
    Rate,
    Width,
    Thickness,
    Counts,
    CountsNot,
    /// Of several specimens or of a model.
    Statistic,
    X,
    Y,
    StressY,
    StressX,
    ShearXy,
    Beta,
    Other,
    /// Speaks of cycles, crack length or load, and is not a form of them.
    Unclear,
    Unknown,
}

/// What the forms of a role may have behind them: a unit of a quantity, or none; or what else they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Measure {
    /// Whatever stands in brackets.
    Text,
    Number,
    Length,
    /// A unit, without which the name is not a form.
    LengthSaid,
    Cycles,
    /// No unit, or this one.
    Kilocycles,
    Megacycles,
    Force,
    ForceSaid,
    Stress,
    StressSaid,
    /// A unit of force or of stress.
    Load,
    Intensity,
    Rate,
    /// Not forms but words: a name with one of them has the role.
    Words,
    /// Words: a name of them alone has the role.
    OnlyWords,
}

const LENGTH: Unit = Unit::Length(LengthUnit::Millimetre);
const CYCLES: Unit = Unit::Cycles(CycleUnit::Cycles);
const LOAD: Unit = Unit::Load(LoadUnit::Newton);
const INTENSITY: Unit = Unit::Intensity(IntensityUnit::MpaSqrtM);
const RATE: Unit = Unit::Rate(RateUnit::Millimetre);
type Forms = BTreeMap<Role, BTreeMap<Measure, String>>;
/// Forms and words of a kind of table, with what they mean.
type Part = HashMap<String, Vec<(Role, Measure)>>;

static PARTS: LazyLock<HashMap<Kind, Part>> = LazyLock::new(|| {
    let of = |forms: &Forms| {
        let mut part = Part::new();
        for (role, measure, text) in
            forms.iter().flat_map(|(role, by)| by.iter().map(move |(measure, text)| (*role, *measure, text)))
        {
            let between: fn(char) -> bool = if measure < Measure::Words { |c| c == ',' } else { char::is_whitespace };
            let own = text.split(between).map(|form| words(form).0.join(" ")).filter(|form| !form.is_empty());
            own.for_each(|form| part.entry(form).or_default().push((role, measure)));
        }
        part
    };
    let mut kinds = COLUMNS.clone();
    kinds.remove("units");
    let kinds: HashMap<Kind, Forms> = kinds.try_into().unwrap_or_default();
    kinds.iter().map(|(kind, forms)| (*kind, of(forms))).collect()
});

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Named {
    No,
    Is(Unit),
    /// In brackets stands something else.
    Strange,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Column {
    /// Place in the header, from 0.
    pub index: usize,
    pub role: Role,
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

    /// Whether it holds a crack length, or that on one side.
    pub fn is_length(&self) -> bool {
        matches!(self.role, Role::Length | Role::Method | Role::Side)
    }

    /// What a name means in a kind of table.
    pub fn named(kind: Kind, index: usize, name: &str) -> Column {
        let unknown = Column::new(index, Role::Unknown, Named::No);
        // A bare capital letter names a specimen as often as a crack length.
        if name.len() > NAME_MAX || name.trim() == "A" {
            return unknown;
        }
        let (all, plain) = words(name);
        let own: Vec<String> = all.iter().map(|word| if word == "2a" { "a".to_owned() } else { word.clone() }).collect();
        let log = usize::from(is_log(&own)) + usize::from(own.starts_with(&["log".to_owned(), "10".to_owned()]));
        let Some((role, unit)) = meaning(kind, &own[log..], plain.saturating_sub(log)) else {
            return by_word(kind, index, name, &all[..plain]).unwrap_or(unknown);
        };
        let column = Column { is_log: log > 0, ..Column::new(index, role, unit) };
        match (log > 0, all.iter().any(|word| word == "2a") && column.is_length()) {
            (true, _) if !matches!(role, Role::DeltaK | Role::KMax | Role::KMin | Role::Rate) => unknown,
            // `max (%)` has a unit that is none of loads.
            _ if unit == Named::No && name.contains('%') => Column { unit: Named::Strange, ..column },
            (_, true) => column.tip_to_tip(),
            _ => column,
        }
    }

    /// The column that the user gives a role, its unit still that of its name.
    pub fn given(index: usize, role: Role, name: &str) -> Column {
        let own = Column::named(Kind::Readings, index, name);
        let like = match role {
            Role::Length | Role::Side if own.is_tip_to_tip() => return Column { role, ..own },
            Role::Cycles => CYCLES,
            Role::Length | Role::Side => LENGTH,
            Role::Max | Role::Min | Role::Range => LOAD,
            Role::DeltaK => INTENSITY,
            Role::Rate => RATE,
            _ => return Column::new(index, role, Named::No),
        };
        let is_log = is_log(&words(name).0) && matches!(role, Role::DeltaK | Role::Rate);
        Column { is_log, ..Column::new(index, role, unit_at_end(name, like, false)) }
    }
}

/// Whether words begin with that of a decimal logarithm.
fn is_log(words: &[String]) -> bool {
    words.first().is_some_and(|word| ["log", "log10", "lg"].contains(&word.as_str()))
}

/// The form that words are as a whole, perhaps with a unit behind it; the first `plain` of them stand before a bracket.
fn meaning(kind: Kind, words: &[String], plain: usize) -> Option<(Role, Named)> {
    let of_cut = |cut: usize| {
        let form = words[..cut].join(" ");
        let meant = kind.parts().filter_map(|part| part.get(&form)).flatten();
        meant.filter_map(|(role, measure)| Some((*role, measure.unit(&words[cut..], cut == plain)?))).next()
    };
    (1..=words.len()).rev().find_map(of_cut)
}

impl Measure {
    /// The unit that words behind a form are, which may be a bracket; `None` where the form cannot have them.
    fn unit(self, words: &[String], is_bracket: bool) -> Option<Named> {
        let (like, own) = match self {
            Measure::Text => return (words.is_empty() || is_bracket).then_some(Named::No),
            Measure::Number => return words.is_empty().then_some(Named::No),
            Measure::Words | Measure::OnlyWords => return None,
            Measure::Length | Measure::LengthSaid => (LENGTH, None),
            Measure::Cycles => (CYCLES, None),
            Measure::Kilocycles => (CYCLES, Some(Unit::Cycles(CycleUnit::Kilocycles))),
            Measure::Megacycles => (CYCLES, Some(Unit::Cycles(CycleUnit::Megacycles))),
            Measure::Force | Measure::ForceSaid | Measure::Stress | Measure::StressSaid | Measure::Load => (LOAD, None),
            Measure::Intensity => (INTENSITY, None),
            Measure::Rate => (RATE, None),
        };
        // `crack length in mm`.
        let spelled = Unit::spelled(words, like)
            .or_else(|| Unit::spelled(words.split_first().filter(|(first, _)| *first == "in")?.1, like));
        let fits = |unit: Unit| match self {
            Measure::Force | Measure::ForceSaid => !unit.is_stress(),
            Measure::Stress | Measure::StressSaid => unit.is_stress(),
            _ => own.is_none_or(|own| own == unit),
        };
        let named = match spelled {
            Some(unit) if fits(unit) => Named::Is(unit),
            // A unit of the other quantity is none, `stress max (kN)`, nor a second one of cycles, `kilocycles (millions)`.
            Some(_) => Named::Strange,
            None if words.is_empty() => own.map_or(Named::No, Named::Is),
            None if is_bracket => Named::Strange,
            None => return None,
        };
        let is_said = matches!(self, Measure::LengthSaid | Measure::ForceSaid | Measure::StressSaid);
        (!is_said || matches!(named, Named::Is(_))).then_some(named)
    }
}

/// The column of a name that is not a form, by the words in it before a bracket.
fn by_word(kind: Kind, index: usize, name: &str, words: &[String]) -> Option<Column> {
    let is = |word: &String, role: Role, measure: Measure| {
        kind.parts().filter_map(|part| part.get(word)).flatten().any(|own| *own == (role, measure))
    };
    // `S1 kilocycles` is a specimen.
    let end = (1..words.len()).find(|cut| Unit::spelled(&words[*cut..], CYCLES).is_some()).unwrap_or(words.len());
    let has = |role: Role, words: &[String]| words.iter().any(|word| is(word, role, Measure::Words));
    if kind == Kind::Spectrum && words.iter().all(|word| is(word, Role::Other, Measure::OnlyWords)) || has(Role::Other, words) {
        // One in a unit of load is told of if it is not read.
        let unit = unit_at_end(name, LOAD, false);
        let is_unit = words.last().is_some_and(|word| word != "n") || name.ends_with([')', ']', '}']);
        let unit = if is_unit && unit != Named::Strange { unit } else { Named::No };
        return Some(Column::new(index, Role::Other, unit));
    }
    has(Role::Unclear, &words[..end]).then(|| Column::new(index, Role::Unclear, Named::No))
}

/// The unit that a name ends with, whatever else it says.
fn unit_at_end(name: &str, like: Unit, is_of_specimen: bool) -> Named {
    let (all, plain) = words(name);
    let has_bracket = plain < all.len();
    // `CT-1000` and `plate m` are names that end with no unit.
    let is_word = |word: &String| word.starts_with('x') || (word.len() > 1 && word.chars().all(char::is_alphabetic));
    let is_said = |unit: &[String]| has_bracket || name.contains(['^', '³', '⁶', '×']) || unit.iter().any(is_word);
    let cuts = (1..all.len()).filter(|cut| !is_of_specimen || is_said(&all[*cut..]));
    let said = cuts.filter_map(|cut| Unit::spelled(&all[cut..], like)).map(Named::Is).next();
    said.unwrap_or(if has_bracket { Named::Strange } else { Named::No })
}

/// The unit of cycles or length that the name of a specimen in a wide table ends with.
pub fn unit_of_specimen(name: &str, role: Role) -> Named {
    unit_at_end(name, if role == Role::Cycles { CYCLES } else { LENGTH }, true)
}

/// Whether a specimen's name in a wide table says that its lengths are tip to tip (`P1 2a`) or the half (`P1 a`); `None` if neither.
pub fn says_tip_to_tip(name: &str) -> Option<bool> {
    let (all, plain) = words(name);
    let has = |word: &str| all[..plain].iter().any(|own| own == word);
    if has("2a") { Some(true) } else { has("a").then_some(false) }
}

/// Characters of a cell in a row of units that is as good as blank.
const NO_UNIT: &str = "-–—/%°1";

/// A name with the unit of the row below it, unless it has one itself.
/// Errors: its own unit, where the row says another one.
pub fn with_unit(name: &str, unit: &str) -> std::result::Result<String, Unit> {
    let named = Column::named(Kind::Readings, 0, name).unit;
    let unit = unit.trim_matches(['(', ')', '[', ']', '{', '}', ' ']);
    if unit.chars().all(|c| NO_UNIT.contains(c)) && named != Named::No {
        return Ok(name.to_owned());
    }
    let below = words(unit).0;
    for said in [named, unit_of_specimen(name, Role::Length), unit_of_specimen(name, Role::Cycles)] {
        let Named::Is(own) = said else { continue };
        match Unit::spelled(&below, own) {
            Some(below) if below == own => return Ok(name.to_owned()),
            Some(_) => return Err(own),
            None => {}
        }
    }
    Ok(if named != Named::No || unit.is_empty() { name.to_owned() } else { format!("{name} [{unit}]") })
}

/// Whether a cell of a row below the header is a unit, or blank.
pub fn is_unit_or_blank(cell: &str) -> bool {
    let text = cell.trim_matches(['(', ')', '[', ']', '{', '}', ' ', '.']);
    text.chars().all(|c| NO_UNIT.contains(c)) || (text.len() <= NAME_MAX && Unit::is_known(&words(text).0.join(" ")))
}
