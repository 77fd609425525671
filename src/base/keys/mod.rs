//! A key of an input file, declared once: reader, refusals, `perilife list keys`, JSON Schema, form of the page, table of the guide and Python stub
//! all come from its [`Key`].
//!
//! [`keys!`](crate::keys!) ties keys to the fields of a struct in SI units; a field is `name: Type = key`, then `or "words" value` where it may be
//! left out. Relations between keys are checked by whoever reads the struct.

mod field;
mod names;
pub mod told;

pub use crate::kinds::meant;
pub use field::{Field, OrNone, Plain, quantity, refuse};
pub use names::{Kinds, nearest};

use toml::Table;
pub use toml::Value;

use crate::error::{Error, InputError, Result, input, input_missing};
use crate::input::{
    COORDINATE, FORCE, FORCE_KN, FRACTURE_ENERGY, INTENSITY, LENGTH, MODULUS, Quantity, STRESS, number as plain, shorten,
    table_of,
};
use crate::kinds::KindLine;

/// A key of a section. Everything that tells a user of it reads this.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    /// As users write it, with its metric unit. Empty of a part, whose keys stand beside those of the section.
    pub name: &'static str,
    /// For users: `Label: hint`.
    pub text: &'static str,
    pub quantity: Option<Quantity>,
    /// Which values it takes; from the type of its field.
    pub shape: Shape,
    pub need: Need,
    /// Of keys of which at most one is given: what they say.
    pub group: Option<&'static str>,
    /// Key of the section, and its values with which this one goes; `None`: with all.
    pub only: Option<(&'static str, &'static [&'static str])>,
    /// What to give where it is missing; empty: what its quantity says.
    pub remedy: &'static str,
    /// Looks at its value alone; from the type of its field.
    pub check: fn(&Key, &str, &Value) -> Result<()>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    Required,
    Optional,
    /// Taken where it is left out, in words: "4 W".
    Or(&'static str),
}

#[derive(Debug, Clone, Copy)]
pub enum Shape {
    Number,
    Whole,
    Flag,
    Text,
    Choice(fn() -> Vec<KindLine>),
    Numbers(usize),
    /// What its reader takes, in words: "a number or \"pure\"".
    Other(&'static str),
    List(&'static Shape),
    Table(&'static [Key]),
}

/// A struct in SI units with the keys that it is read from.
pub trait Section: Sized {
    const KEYS: &'static [Key];
    /// Reads it; every key alone has been looked at.
    /// Errors: a key that is missing.
    fn read(given: &Given<'_>) -> Result<Self>;
}

/// A table of the file that is being read.
#[derive(Debug, Clone, Copy)]
pub struct Given<'a> {
    pub table: &'a Table,
    pub path: &'a str,
}

impl Key {
    /// A key of this name; the text is `Label: hint`.
    pub const fn new(name: &'static str, text: &'static str) -> Key {
        let (shape, need) = (Shape::Text, Need::Required);
        Key { name, text, quantity: None, shape, need, group: None, only: None, remedy: "", check: |_, _, _| Ok(()) }
    }

    /// A number of a table of constants, which may be left out; what it is called is what its quantity is.
    pub fn of_constant(name: &'static str, quantity: Quantity, remedy: &'static str) -> Key {
        let text = quantity.what.trim_start_matches("a ").trim_start_matches("an ");
        let check = |key: &Key, path: &str, value: &Value| self::quantity(key, path, value).map(drop);
        Key { shape: Shape::Number, need: Need::Optional, check, remedy, ..Key::new(name, text).of(quantity) }
    }

    /// A name of a choice, which may be left out.
    pub const fn of_choice<T: Field>(name: &'static str, text: &'static str) -> Key {
        Key { shape: T::SHAPE, need: Need::Optional, check: T::check, ..Key::new(name, text) }
    }

    pub const fn of(self, quantity: Quantity) -> Key {
        Key { quantity: Some(quantity), ..self }
    }

    /// It goes with these values of another key only.
    pub const fn only(self, key: &'static str, values: &'static [&'static str]) -> Key {
        Key { only: Some((key, values)), ..self }
    }

    /// At most one of those that say the same is given.
    pub const fn group(self, what: &'static str) -> Key {
        Key { group: Some(what), ..self }
    }

    pub const fn missing(self, remedy: &'static str) -> Key {
        Key { remedy, ..self }
    }

    /// The same key with another text.
    pub const fn said(self, text: &'static str) -> Key {
        Key { text, ..self }
    }

    pub fn remedy(&self) -> String {
        match (self.quantity, self.shape) {
            _ if !self.remedy.is_empty() => self.remedy.to_owned(),
            (Some(quantity), Shape::Number) => quantity.remedy(),
            (_, Shape::Choice(lines)) => meant(None, lines().iter().map(|line| line.name)),
            (_, shape) => format!("give {}", shape.words()),
        }
    }
}

pub const fn key(name: &'static str, text: &'static str) -> Key {
    Key::new(name, text)
}
/// A part, whose keys stand beside those of the section.
pub const fn part() -> Key {
    Key::new("", "")
}

macro_rules! quantities {
    ($($name:ident of $QUANTITY:ident),+) => { $(
        pub const fn $name(name: &'static str, text: &'static str) -> Key { Key::new(name, text).of($QUANTITY) }
    )+ };
}
quantities!(length of LENGTH, coordinate of COORDINATE, stress of STRESS, modulus of MODULUS, force of FORCE);
quantities!(force_kn of FORCE_KN, intensity of INTENSITY, energy of FRACTURE_ENERGY);

/// A number without unit; `what` has its article: "a ratio".
pub const fn number(name: &'static str, text: &'static str, what: &'static str, low: f64, high: f64) -> Key {
    Key::new(name, text).of(plain(what, low, high))
}

impl Shape {
    /// In a reader's words, with its article.
    pub fn words(&self) -> &'static str {
        match self {
            Shape::Number => "a number",
            Shape::Whole => "a whole number, zero or more",
            Shape::Flag => "true or false",
            Shape::Text | Shape::Choice(_) => "text in quotes",
            Shape::Numbers(2) => "a pair of numbers, such as [1, 2]",
            Shape::Numbers(_) => "a list of three numbers",
            Shape::Other(words) => words,
            Shape::List(Shape::Numbers(_)) => "a list of pairs, such as [[1, 2], [3, 4]]",
            Shape::List(Shape::Table(_)) => "a list of tables [{ key = value }]",
            Shape::List(_) => "a list [...]",
            Shape::Table(_) => "a table of keys",
        }
    }
}

impl<'a> Given<'a> {
    /// The table at `path`.
    /// Errors: anything else.
    pub fn of(value: &'a Value, path: &'a str) -> Result<Self> {
        Ok(Given { table: table_of(value, path)?, path })
    }

    pub fn path_of(&self, name: &str) -> String {
        if self.path.is_empty() { name.to_owned() } else { format!("{}.{name}", self.path) }
    }

    pub fn missing(&self, key: &Key) -> Error {
        input_missing(&self.path_of(key.name), "is missing", key.remedy())
    }

    /// An error about a key by what stands there.
    pub fn refuse(&self, name: &str, problem: impl Into<String>, remedy: impl Into<String>) -> Error {
        match self.table.get(name) {
            Some(value) => input(&self.path_of(name), shorten(value), problem, remedy),
            None => input_missing(&self.path_of(name), problem, remedy),
        }
    }

    pub fn first<'n>(&self, names: &[&'n str]) -> Option<&'n str> {
        names.iter().copied().find(|name| self.table.contains_key(*name))
    }

    pub fn refuse_any(&self, names: &[&str], problem: &str, remedy: &str) -> Result<()> {
        self.first(names).map_or(Ok(()), |name| Err(self.refuse(name, problem, remedy)))
    }
}

/// Reads the section at `path`.
/// Errors: all keys that are not known, missing or wrong by themselves, as one.
///
/// ```
/// use perilife_base::keys::{key, length, section};
/// perilife_base::keys! { #[derive(Debug)] pub struct Strip { width: f64 = length("width_mm", "Width W"); name: Option<String> = key("name", "Name"); } }
/// let read = |text: &str| section::<Strip>(&text.parse::<toml::Table>().unwrap().into(), "strip");
/// assert_eq!(read("width_mm = 50").unwrap().width, 0.05);
/// assert_eq!(read("widht_mm = 50").unwrap_err().to_string(), "strip.widht_mm = 50: unknown key; did you mean width_mm?");
/// ```
pub fn section<S: Section>(value: &Value, path: &str) -> Result<S> {
    section_beside(value, path, &[])
}

/// The same of a section that has keys `beside`, which others read.
pub fn section_beside<S: Section>(value: &Value, path: &str, beside: &[&str]) -> Result<S> {
    let given = Given::of(value, path)?;
    Error::of_all(mistakes(given, S::KEYS, beside, None))?;
    S::read(&given)
}

/// All that is wrong with the keys of a section by themselves.
pub fn mistakes(given: Given<'_>, keys: &[Key], beside: &[&str], kinds: Option<&Kinds<'_>>) -> Vec<InputError> {
    let known = all(keys);
    let (mut found, mut meant) = (Vec::new(), Vec::new());
    for (name, value) in given.table.iter().filter(|(name, _)| !beside.contains(&name.as_str())) {
        match known.iter().find(|key| key.name == name) {
            Some(key) => {
                if let Err(Error::Input(error)) = (key.check)(key, &given.path_of(name), value) {
                    found.extend(error.each());
                }
            }
            None => {
                let (error, near) = names::stranger(given, name, value, &known, beside, kinds);
                found.push(error);
                meant.extend(near);
            }
        }
    }
    let is_missed = |key: &&Key| key.need == Need::Required && key.group.is_none() && !given.table.contains_key(key.name);
    let missed = known.iter().filter(is_missed).filter(|key| !meant.iter().any(|name| name == key.name));
    found.extend(missed.filter_map(|key| if let Error::Input(error) = given.missing(key) { Some(*error) } else { None }));
    for (i, key) in known.iter().enumerate().filter(|(_, key)| key.group.is_some() && given.table.contains_key(key.name)) {
        let Some(first) = known[..i].iter().find(|other| other.group == key.group && given.table.contains_key(other.name)) else {
            continue;
        };
        let problem = format!("conflicts with {}", first.name);
        let alike: Vec<&str> =
            known.iter().filter(|other| (other.group, other.only) == (key.group, key.only)).map(|other| other.name).collect();
        if let Error::Input(error) = given.refuse(key.name, problem, format!("give exactly one of {}", alike.join(", "))) {
            found.push(*error);
        }
    }
    found
}

/// Keys one by one, those of parts among them.
pub fn all(keys: &[Key]) -> Vec<Key> {
    let own = |key: &Key| match key.shape {
        Shape::Table(part) if key.name.is_empty() => all(part),
        _ => vec![*key],
    };
    keys.iter().flat_map(own).collect()
}

/// Declares sections: structs in SI units with their keys.
#[macro_export]
macro_rules! keys {
    ($( $(#[$outer:meta])* $vis:vis struct $S:ident { $( $(#[$inner:meta])* $f:ident : $T:ty = $key:expr $(, or $words:literal $default:expr)? ; )* } )+) => { $(
        $(#[$outer])*
        $vis struct $S { $( $(#[$inner])* pub $f: $T, )* }

        impl $crate::keys::Section for $S {
            const KEYS: &'static [$crate::keys::Key] = &[ $( $crate::keys::Key {
                shape: <$T as $crate::keys::Field>::SHAPE,
                need: $crate::keys!(@need $T $(, $words)?),
                check: <$T as $crate::keys::Field>::check,
                ..$key
            } ),* ];

            fn read(given: &$crate::keys::Given<'_>) -> $crate::Result<Self> {
                let mut keys = Self::KEYS.iter();
                $( let $f: $T = $crate::keys!(@read given, keys, $T $(, $default)?); )*
                Ok($S { $($f),* })
            }
        }

        impl $crate::keys::Field for $S {
            const SHAPE: $crate::keys::Shape = $crate::keys::Shape::Table(<$S as $crate::keys::Section>::KEYS);
            fn take(_: &$crate::keys::Key, path: &str, value: &$crate::keys::Value) -> $crate::Result<Self> { $crate::keys::section(value, path) }
            fn part(given: &$crate::keys::Given<'_>) -> Option<$crate::Result<Self>> { Some($crate::keys::Section::read(given)) }
        }
    )+ };
    (@need $T:ty) => { <$T as $crate::keys::Field>::NEED };
    (@need $T:ty, $words:literal) => { $crate::keys::Need::Or($words) };
    (@read $given:ident, $keys:ident, $T:ty) => {
        match $keys.next() { Some(key) => <$T as $crate::keys::Field>::read($given, key)?, None => unreachable!("a key for every field") }
    };
    (@read $given:ident, $keys:ident, $T:ty, $default:expr) => {
        match $keys.next() { Some(key) => <Option<$T> as $crate::keys::Field>::read($given, key)?.unwrap_or_else(|| $default), None => unreachable!("a key for every field") }
    };
}
