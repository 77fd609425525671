//! Questions of the studies as data: a case, its keys, what is read of it, its truth. One runner asks them all.
//!
//! A question is a table of [`Question`]. With `rows` it is several: each row has the keys of the table around it and its own. `over` is a list of
//! axes, tables of lists whose columns go together; axes multiply, the first outermost. `set` names values. Every text may hold formulas in
//! angle brackets, over values and closed forms (`values.rs`), readings of the case (`subject.rs`)
//! or of the computation that `by` names (`computations.rs`), and the same of `beside`, another case, behind `beside_`.

use std::cell::{OnceCell, RefCell};
use std::rc::Rc;

use serde::Deserialize;
use toml::{Table, Value};

use super::cases::{Reference, overrides};
use super::computations::computed;
use super::subject::{Source, Subject, Watcher, once};
use super::values::Figures;
use super::values::{Values, combinations, wrong};
use perilife_base::error::{Error, Result};

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Question {
    /// What computes: the case (where left out), `plate`, the same without crack and law, or a computation by its name.
    by: Option<String>,
    case: String,
    /// A plate of `data/reference` in its place.
    plate: String,
    keys: String,
    /// Another case, or the same with other keys.
    beside: Option<Beside>,
    /// Reasons for which a run may end; any where left out.
    ends: Vec<String>,
    /// Whether it is asked: where this is above zero.
    pub when: Option<Value>,
    /// Axes over which the reading is taken: its largest less its least value counts.
    pub spread: Vec<Table>,
    pub quantity: String,
    pub read: String,
    /// What it should be; left out, the reading is itself an error in percent.
    pub truth: Option<Value>,
    pub bound: Option<Value>,
    pub source: String,
    /// Why the bound is missed, and the error that is known (0: none).
    pub miss: Option<Miss>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Beside {
    /// Its text; that of the question where left out.
    case: Option<String>,
    keys: String,
}

/// A bound that is known to be missed.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Miss {
    /// Error that is known, percent; 0 of rows that keep their bound.
    pub known: Value,
    pub reason: String,
}

pub const SHARED: &str = include_str!("../../data/studies/shared.toml");

/// The table of a file of studies. Errors: the name of the file with what is wrong.
pub fn file(name: &str, text: &str) -> Result<Table> {
    text.parse().map_err(|error| wrong(name, error))
}

/// A table in its form; keys that nobody knows are refused.
pub fn read<T: serde::de::DeserializeOwned>(table: Table) -> Result<T> {
    let words = table.get("name").or(table.get("quantity")).map_or_else(String::new, Value::to_string);
    T::deserialize(table).map_err(|error| wrong(&words, error))
}

/// Goes through the questions of a table in their order, each with its values.
pub fn each(table: &Table, values: &Table, ask: &mut dyn FnMut(&Question, &Table) -> Result<()>) -> Result<()> {
    let mut own = table.clone();
    let axes =
        own.remove("over").map_or_else(|| Ok(Vec::new()), Vec::<Table>::deserialize).map_err(|error| wrong("over", error))?;
    let set = own.remove("set").map_or_else(|| Ok(Table::new()), Table::deserialize).map_err(|error| wrong("set", error))?;
    let rows = own.remove("rows").map(Vec::<Table>::deserialize).transpose().map_err(|error| wrong("rows", error))?;
    for chosen in combinations(&axes)? {
        let values: Table = values.clone().into_iter().chain(set.clone()).chain(chosen).collect();
        match &rows {
            None => ask(&read(own.clone())?, &values)?,
            Some(rows) => {
                for row in rows {
                    each(&own.clone().into_iter().chain(row.clone()).collect(), &values, ask)?;
                }
            }
        }
    }
    Ok(())
}

enum Asked<'o> {
    Case(Box<Subject<'o>>),
    Computed(Figures),
}

fn source(question: &Question, case: &str, plate: &str) -> Result<Option<Source>> {
    Ok(match question.by.as_deref() {
        None if !plate.is_empty() => Some(Source::Grown(Reference::named(plate)?)),
        None => Some(Source::Text(case.to_owned())),
        Some("plate") => Some(Source::Alone(case.to_owned())),
        Some(_) => None,
    })
}

/// How many cases are kept for further questions.
const KEPT: usize = 6;

pub struct Asker<'o> {
    observer: &'o dyn Watcher,
    kept: RefCell<Vec<(String, Rc<Asked<'o>>)>>,
}

impl<'o> Asker<'o> {
    pub fn new(observer: &'o dyn Watcher) -> Self {
        Asker { observer, kept: RefCell::default() }
    }

    pub fn ask<'a>(&'a self, question: &'a Question, values: &'a Table) -> Asking<'a, 'o> {
        Asking { asker: self, question, values, own: OnceCell::new(), beside: OnceCell::new() }
    }

    fn asked(&self, question: &Question, case: &str, plate: &str, set: &[String]) -> Result<Rc<Asked<'o>>> {
        let by = question.by.as_deref().unwrap_or_default();
        let key = format!("{by}\n{case}\n{plate}\n{}", set.join("\n"));
        if let Some((_, found)) = self.kept.borrow().iter().find(|(known, _)| *known == key) {
            return Ok(found.clone());
        }
        let made = Rc::new(match source(question, case, plate)? {
            Some(source) => Asked::Case(Box::new(Subject::new(source, set, self.observer)?)),
            None => Asked::Computed(computed(by, case, set, self.observer)?),
        });
        let mut kept = self.kept.borrow_mut();
        kept.insert(0, (key, made.clone()));
        kept.truncate(KEPT);
        Ok(made)
    }
}

pub struct Asking<'a, 'o> {
    asker: &'a Asker<'o>,
    question: &'a Question,
    values: &'a Table,
    own: OnceCell<Rc<Asked<'o>>>,
    beside: OnceCell<Rc<Asked<'o>>>,
}

impl<'o> Asking<'_, 'o> {
    pub fn figure(&self, value: &Value) -> Result<f64> {
        Values { table: self.values, reading: &|name, values| Some(self.reading(name, values)) }.figure(value)
    }

    pub fn number(&self, formula: &str) -> Result<f64> {
        Values { table: self.values, reading: &|name, values| Some(self.reading(name, values)) }.number(formula)
    }

    pub fn text(&self, text: &str) -> Result<String> {
        Values { table: self.values, reading: &|name, values| Some(self.reading(name, values)) }.text(text)
    }

    /// Takes a subject that has its keys already.
    pub fn of_subject(self, subject: Subject<'o>) -> Self {
        let _ = self.own.set(Rc::new(Asked::Case(Box::new(subject))));
        self
    }

    /// The case with further keys.
    pub fn subject(&self, more: &[String]) -> Result<Subject<'o>> {
        let (case, plate, keys) = self.texts()?;
        let source = source(self.question, &case, &plate)?.ok_or_else(|| wrong(&keys, "has no case"))?;
        Subject::new(source, &[overrides(&keys), more.to_vec()].concat(), self.asker.observer)
    }

    pub fn size(&self) -> (usize, usize) {
        self.own.get().map_or((0, 0), |own| if let Asked::Case(subject) = &**own { subject.size() } else { (0, 0) })
    }

    /// Case, plate and keys, which know values alone.
    fn texts(&self) -> Result<(String, String, String)> {
        let (Question { case, plate, keys, .. }, values) = (self.question, Values::alone(self.values));
        Ok((values.text(case)?, values.text(plate)?, values.text(keys)?))
    }

    fn own(&self) -> Result<&Rc<Asked<'o>>> {
        once(&self.own, || {
            let (case, plate, keys) = self.texts()?;
            self.ended(self.asker.asked(self.question, &case, &plate, &overrides(&keys))?)
        })
    }

    fn beside(&self) -> Result<&Rc<Asked<'o>>> {
        once(&self.beside, || {
            let beside = self.question.beside.as_ref().ok_or_else(|| wrong(&self.question.quantity, "has no reference case"))?;
            let (case, plate, _) = self.texts()?;
            let case = beside.case.as_ref().map_or(Ok(case), |case| self.text(case))?;
            self.ended(self.asker.asked(self.question, &case, &plate, &overrides(&self.text(&beside.keys)?))?)
        })
    }

    /// A run that has ended by one of the reasons that are asked for.
    fn ended(&self, asked: Rc<Asked<'o>>) -> Result<Rc<Asked<'o>>> {
        let ends = &self.question.ends;
        if let (Asked::Case(subject), false) = (&*asked, ends.is_empty()) {
            let stop = subject.run()?.stop;
            if !ends.iter().map(|end| self.text(end)).collect::<Result<Vec<_>>>()?.iter().any(|end| end == stop.name()) {
                return Err(Error::Mechanics(format!("the run did not end by {}: {stop}", ends.join(" or "))));
            }
        }
        Ok(asked)
    }

    fn reading(&self, name: &str, values: &[f64]) -> Result<f64> {
        match name.strip_prefix("beside_") {
            Some(name) => {
                let (own, beside) = (self.own()?, self.beside()?);
                let of_both = match (&**own, &**beside) {
                    (Asked::Case(own), Asked::Case(beside)) => own.beside(beside, name),
                    _ => None,
                };
                of_both.unwrap_or_else(|| beside.reading(name, values))
            }
            None => self.own()?.reading(name, values),
        }
    }
}

impl Asked<'_> {
    fn reading(&self, name: &str, values: &[f64]) -> Result<f64> {
        match self {
            Asked::Case(subject) => subject.read(name, values),
            Asked::Computed(figures) => {
                let found = figures.iter().find(|(known, _)| *known == name);
                found.map(|(_, value)| *value).ok_or_else(|| wrong(name, "is neither a value nor a figure of the computation"))
            }
        }
    }
}
