//! Types that a key can have.

use toml::Value;

use super::{Given, Key, Need, Shape, meant, nearest};
use crate::error::{Error, Result, input};
use crate::input::{OF_SCENES, PLANNED, number_of, shorten};
use crate::kinds::Named;

/// A type of a field of a section: which values it takes, and how it is read.
pub trait Field: Sized {
    const SHAPE: Shape;
    const NEED: Need = Need::Required;

    /// From the value of a key, found at `path`, in SI units.
    /// Errors: a value of another sort, or beyond reason.
    fn take(key: &Key, path: &str, value: &Value) -> Result<Self>;

    /// What it is where the key is not there; `None`: it is needed.
    fn absent() -> Option<Self> {
        None
    }

    /// Of a part of a section: from the keys of the section.
    fn part(_: &Given<'_>) -> Option<Result<Self>> {
        None
    }

    /// From the table of the section.
    /// Errors: a key that is missing; those of [`Field::take`].
    fn read(given: &Given<'_>, key: &Key) -> Result<Self> {
        if let Some(part) = Some(key.name).filter(|name| name.is_empty()).and_then(|_| Self::part(given)) {
            return part;
        }
        match given.table.get(key.name) {
            Some(value) => Self::take(key, &given.path_of(key.name), value),
            None => Self::absent().ok_or_else(|| given.missing(key)),
        }
    }

    /// Whether a value would be taken.
    /// Errors: as [`Field::take`].
    fn check(key: &Key, path: &str, value: &Value) -> Result<()> {
        Self::take(key, path, value).map(drop)
    }
}

/// What a value of another sort is told.
pub fn refuse<T>(key: &Key, path: &str, value: &Value, shape: Shape) -> Result<T> {
    Err(input(path, shorten(value), format!("is not {}", shape.words()), key.remedy()))
}

/// A number of a key in SI units, within its range.
pub fn quantity(key: &Key, path: &str, value: &Value) -> Result<f64> {
    let number = plain(key, path, value)?;
    key.quantity.map_or(Ok(number), |quantity| quantity.read(path, number))
}

/// The same in the unit of the key, whatever its size.
fn plain(key: &Key, path: &str, value: &Value) -> Result<f64> {
    let shape = if matches!(key.shape, Shape::Other(_)) { key.shape } else { Shape::Number };
    number_of(value).map_or_else(|| refuse(key, path, value, shape), Ok)
}

impl Field for f64 {
    const SHAPE: Shape = Shape::Number;
    fn take(key: &Key, path: &str, value: &Value) -> Result<Self> {
        quantity(key, path, value)
    }
}

impl<T: Field, const N: usize> Field for [T; N] {
    const SHAPE: Shape = Shape::Numbers(N);
    fn take(key: &Key, path: &str, value: &Value) -> Result<Self> {
        let Some(list) = value.as_array().filter(|list| list.len() == N) else { return refuse(key, path, value, Self::SHAPE) };
        let all =
            list.iter().enumerate().map(|(i, value)| T::take(key, &format!("{path}[{i}]"), value)).collect::<Result<Vec<T>>>()?;
        all.try_into().or_else(|_| refuse(key, path, value, Self::SHAPE))
    }
}

macro_rules! whole {
    ($($T:ty),+) => { $(
        impl Field for $T {
            const SHAPE: Shape = Shape::Whole;
            fn take(key: &Key, path: &str, value: &Value) -> Result<Self> {
                let Some(whole) = value.as_integer().and_then(|whole| <$T>::try_from(whole).ok()) else { return refuse(key, path, value, Self::SHAPE) };
                match key.quantity {
                    Some(range) if !(range.low..=range.high).contains(&(whole as f64)) => {
                        let between = if range.high - range.low <= 1.0 { "or" } else { "to" };
                        let remedy = if key.remedy.is_empty() { format!("give {} from {} to {}", range.what, range.low, range.high) } else { key.remedy.to_owned() };
                        Err(input(path, whole, format!("is not {} {between} {}", range.low, range.high), remedy))
                    }
                    _ => Ok(whole),
                }
            }
        }
    )+ };
}
whole!(usize, u64);

/// Types that a value is, or is not.
macro_rules! values {
    ($($T:ty: $shape:expr, $of:expr;)+) => { $(
        impl Field for $T {
            const SHAPE: Shape = $shape;
            fn take(key: &Key, path: &str, value: &Value) -> Result<Self> {
                let of: fn(&Value) -> Option<$T> = $of;
                of(value).map_or_else(|| refuse(key, path, value, Self::SHAPE), Ok)
            }
        }
    )+ };
}
values! {
    bool: Shape::Flag, Value::as_bool;
    String: Shape::Text, |value| value.as_str().map(str::to_owned);
    std::path::PathBuf: Shape::Text, |value| value.as_str().map(Into::into);
    toml::Table: Shape::Table(&[]), |value| value.as_table().cloned();
    // What its reader looks at by itself.
    Value: Shape::Other("a valid value"), |value| Some(value.clone());
}

impl Field for std::collections::BTreeMap<String, f64> {
    const SHAPE: Shape = Shape::Table(&[]);
    fn take(key: &Key, path: &str, value: &Value) -> Result<Self> {
        let table = toml::Table::take(key, path, value)?;
        table.iter().map(|(name, value)| Ok((name.clone(), f64::take(key, &format!("{path}.{name}"), value)?))).collect()
    }
}

impl<T: Field> Field for Option<T> {
    const SHAPE: Shape = T::SHAPE;
    const NEED: Need = Need::Optional;
    fn take(key: &Key, path: &str, value: &Value) -> Result<Self> {
        T::take(key, path, value).map(Some)
    }
    fn absent() -> Option<Self> {
        Some(None)
    }
}

impl<T: Field> Field for Vec<T> {
    const SHAPE: Shape = Shape::List(&T::SHAPE);
    fn take(key: &Key, path: &str, value: &Value) -> Result<Self> {
        // One pair where a list of them belongs is told of the list.
        let is_one =
            |list: &&Vec<Value>| matches!(T::SHAPE, Shape::Numbers(_)) && list.first().is_some_and(|first| !first.is_array());
        let Some(list) = value.as_array().filter(|list| !is_one(list)) else { return refuse(key, path, value, Self::SHAPE) };
        let (mut all, mut wrong) = (Vec::with_capacity(list.len()), Vec::new());
        for (i, value) in list.iter().enumerate() {
            match T::take(key, &format!("{path}[{i}]"), value) {
                Ok(one) => all.push(one),
                Err(Error::Input(error)) => wrong.extend(error.each()),
                Err(other) => return Err(other),
            }
        }
        Error::of_all(wrong).map(|()| all)
    }
}

impl<T: Named> Field for T {
    const SHAPE: Shape = Shape::Choice(T::lines);
    fn take(_: &Key, path: &str, value: &Value) -> Result<Self> {
        let lines = T::lines();
        let list = meant(None, lines.iter().map(|line| line.name));
        let Some(text) = value.as_str() else { return Err(input(path, shorten(value), "is not text in quotes", list)) };
        if let Some(found) = T::find(text) {
            return Ok(found);
        }
        let listed = |list: &[(&str, &[&str])]| list.iter().any(|(key, names)| *key == path && names.contains(&text));
        let (problem, remedy) = if listed(OF_SCENES) {
            ("applies only to fracture scenes", format!("run `perilife fracture`, or {list}"))
        } else if listed(PLANNED) {
            ("is not supported yet", list)
        } else {
            let near = nearest(text, lines.iter().map(|line| line.name));
            ("unknown kind", near.map_or(list, |near| format!("did you mean \"{near}\"?")))
        };
        Err(input(path, shorten(value), problem, remedy))
    }
}

/// A quantity in SI units within the range of its key, or 0 for none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrNone(pub f64);

impl Field for OrNone {
    const SHAPE: Shape = Shape::Number;
    fn take(key: &Key, path: &str, value: &Value) -> Result<Self> {
        if number_of(value) == Some(0.0) { Ok(OrNone(0.0)) } else { quantity(key, path, value).map(OrNone) }
    }
}

/// A number in the unit of its key, within its range, for whoever compares it with others in that unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plain(pub f64);

impl Field for Plain {
    const SHAPE: Shape = Shape::Number;
    fn take(key: &Key, path: &str, value: &Value) -> Result<Self> {
        quantity(key, path, value)?;
        plain(key, path, value).map(Plain)
    }
}
