//! The units in which this process writes and prints, said once at its start, as its log is, or for one piece of work. Inside, everything
//! stays as it is.

use std::cell::Cell;
use std::sync::OnceLock;

use super::us::{System, Unit, renamed};
use super::words::{in_units, with_keys};
use super::{INCH, MM};

static SHOWN: OnceLock<System> = OnceLock::new();

/// Has all that follows written and printed in these units; only the first call counts.
pub fn show(system: System) {
    let _ = SHOWN.set(system);
}

thread_local! {
    static HERE: Cell<Option<System>> = const { Cell::new(None) };
}

/// Has `work` write and print in these units on this thread, whatever the process does.
pub fn within<T>(system: System, work: impl FnOnce() -> T) -> T {
    struct Back(Option<System>);
    impl Drop for Back {
        fn drop(&mut self) {
            HERE.set(self.0);
        }
    }
    let _back = Back(HERE.replace(Some(system)));
    work()
}

pub fn asked() -> Option<System> {
    HERE.get().or_else(|| SHOWN.get().copied())
}

pub fn shown() -> System {
    asked().unwrap_or(System::Si)
}

/// Words with their quantities in the units that are shown, and keys as they are in these.
pub fn told(words: &str) -> String {
    if shown() == System::Si { words.to_owned() } else { with_keys(words, shown()) }
}

/// The same of words about a file, whose keys stay as it has them.
pub fn told_of_file(words: &str) -> String {
    if shown() == System::Si { words.to_owned() } else { in_units(words, shown()) }
}

/// Units that are shown in one metric unit of this name: what a number is multiplied by that is written without it.
pub fn per(metric: &str) -> f64 {
    let unit = Unit::named(metric, System::Si).filter(|_| shown() == System::Us);
    unit.map_or(1.0, |unit| unit.factor(System::Us))
}

/// A length that a user types, m: `0.25in`, `6.35mm`, or a number in the unit that is shown.
pub fn length_given(text: &str) -> Option<f64> {
    let units = [("mm", MM), ("inch", INCH), ("in", INCH)];
    let given = units.into_iter().find_map(|(unit, size)| Some((text.trim().strip_suffix(unit)?, size)));
    let (number, size) = given.unwrap_or((text, if shown() == System::Us { INCH } else { MM }));
    Some(number.trim().parse::<f64>().ok()? * size)
}

/// A crack length, m, in the unit that is shown: 5.00, 73.2 and 0.127 mm, 0.2000 inch; 9.9999 mm are 10.0.
pub fn crack_length(metres: f64) -> String {
    let (length, digits) = (metres / MM * per("mm"), if shown() == System::Us { 3.0 } else { 2.0 });
    format!("{length:.*}", (digits - (1.0005 * length.max(1e-9)).log10().floor()).max(1.0) as usize)
}

/// Name of the unit that is shown in place of a metric one.
pub fn name_of(metric: &'static str) -> &'static str {
    Unit::named(metric, System::Si).map_or(metric, |unit| unit.word(shown()))
}

/// A column of a printed table with the unit that is shown.
pub fn column(metric: &str) -> String {
    renamed(metric, System::Us).filter(|_| shown() == System::Us).map_or_else(|| metric.to_owned(), |new| new.name)
}
