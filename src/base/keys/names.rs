//! Names of keys that are not use one of: whose they are, and which of the known ones was meant.

use toml::Value;

use super::{Given, Key, all};
use crate::error::InputError;
use crate::input::shorten;
use crate::kinds::meant;
use crate::units::us::{System, UNITS, renamed};

/// The kinds of a section that comes in kinds.
pub struct Kinds<'a> {
    /// Key that tells the kind.
    pub tag: &'a str,
    pub own: &'a str,
    pub all: &'a [(&'static str, &'static [Key])],
}

/// Symbols of engineers that stand for keys.
const SYMBOLS: [(&str, &str); 3] = [("R", "stress_ratio"), ("C", "paris_c_mm_per_cycle"), ("m", "paris_m")];

/// What a key is told that is not known here, and the known one that was meant.
pub(super) fn stranger(
    given: Given<'_>,
    name: &str,
    value: &Value,
    known: &[Key],
    beside: &[&str],
    kinds: Option<&Kinds<'_>>,
) -> (InputError, Option<String>) {
    let told = |problem: String, remedy: String| {
        let (key, value) = (Some(given.path_of(name)), Some(shorten(value)));
        InputError { key, value, problem, remedy, ..InputError::default() }
    };
    let names = || known.iter().map(|key| key.name).chain(beside.iter().copied());
    // The same quantity without a unit, or in another one.
    let is_meant =
        |known: &&str| stem(known).is_some_and(|own| own == name || name.rsplit_once('_').is_some_and(|(given, _)| given == own));
    if let Some(meant) = names().find(is_meant) {
        let twin = renamed(meant, System::Us).map_or_else(String::new, |twin| format!(" or {}", twin.name));
        return (told("unknown key".into(), format!("did you mean {meant}{twin}?")), Some(meant.to_owned()));
    }
    let Kinds { tag, own, all: kinds } = kinds.unwrap_or(&Kinds { tag: "", own: "", all: &[] });
    let has_it = |(_, keys): &&(&str, &'static [Key])| all(keys).iter().any(|key| key.name == name);
    let owners: Vec<&str> = kinds.iter().filter(has_it).map(|(kind, _)| *kind).collect();
    if let [first, ..] = owners[..] {
        let more = if owners.len() > 3 { format!(" and {} more", owners.len() - 3) } else { String::new() };
        let shown = owners.iter().take(3).copied().collect::<Vec<_>>().join(", ");
        let problem = format!("is not a key of {tag} = \"{own}\"; applies only to {shown}{more}");
        return (told(problem, format!("remove it, or use {tag} = \"{first}\"")), None);
    }
    let of_symbol = |known: &&str| SYMBOLS.iter().any(|(symbol, key)| symbol.eq_ignore_ascii_case(name) && key == known);
    let near = names().find(of_symbol).map(str::to_owned).or_else(|| nearest(name, names()));
    (told("unknown key".into(), meant(near.as_deref(), names())), near)
}

fn stem(name: &str) -> Option<&str> {
    UNITS.iter().find_map(|unit| name.strip_suffix(unit.suffix(System::Si))?.strip_suffix('_'))
}

/// The name that was meant, if one is near: a quarter of its letters may be wrong (put in, left out, changed, or swapped with the next one), three at
/// most; names of one or two letters are too short.
pub fn nearest<'n>(name: &str, known: impl Iterator<Item = &'n str>) -> Option<String> {
    let letters = name.chars().count();
    let most = (letters / 4).clamp(1, 3);
    // Lengths bound the distance, so that a name of a million letters is not compared letter by letter.
    let long = known.filter(|other| letters > 2 && other.chars().count().abs_diff(letters) <= most);
    let far = long.map(|other| (strsim::osa_distance(name, other), other)).filter(|(far, _)| *far <= most);
    far.min_by_key(|(far, _)| *far).map(|(_, other)| other.to_owned())
}
