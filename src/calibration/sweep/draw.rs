//! The cases of a sweep: each whole in itself, all read before any is run.

use rayon::prelude::*;
use sha2::{Digest, Sha256};
use toml::{Table, Value};

use super::design::Sweep;
use super::distribution::hypercube;
use super::scatter::{self, LawScatter};
use super::vary::{DesignKind, Spread};
use perilife_base::error::{Error, InputError, Result, input_missing};
use perilife_base::input::{Document, Folder, value_at};
use perilife_growth::case::record::FittedRecord;
use perilife_growth::case::{Case, LawSource, Method, fitted_record, remove_law};

const FITTED: &str = "fitted.toml";

#[derive(Debug, Clone, PartialEq)]
pub struct DrawnCase {
    pub number: usize,
    /// Its name: that of the base case with the number.
    pub name: String,
    /// What it has for each of [`Sweep::columns`].
    pub values: Vec<Value>,
    /// TOML with everything in place.
    pub text: String,
    pub files: Vec<(String, Vec<u8>)>,
    /// Hash of version, text and files: the same hash, the same result.
    pub hash: String,
}

impl DrawnCase {
    pub fn read(&self) -> Result<Case> {
        let folder = Folder::at_hand(self.files.iter().cloned());
        Case::from_document(&Document::parse(&self.text, &self.name, folder, &[])?)
    }

    pub fn label(&self) -> String {
        label(self.number)
    }
}

/// Number of a case with leading zeros.
pub fn label(number: usize) -> String {
    format!("{number:04}")
}

/// What one case has for the keys that vary, and its law if laws scatter.
struct Draw {
    values: Vec<Value>,
    law: Option<FittedRecord>,
}

impl Sweep {
    /// What differs between cases: keys of the case, then figures of its law if laws scatter.
    pub fn columns(&self) -> Vec<String> {
        let keys = self.design.vary.iter().map(|one| one.key.clone());
        let law: &[&str] = match self.design.kind {
            DesignKind::FittedScatter if self.is_by_hand() => {
                &["fitted.rate_at_pivot_mm_per_cycle", "fitted.paris_m", "fitted.paris_c_mm_per_cycle"]
            }
            DesignKind::FittedScatter => &["fitted.rate_at_pivot_mm_per_cycle", "fitted.p", "fitted.a"],
            DesignKind::Grid | DesignKind::LatinHypercube => &[],
        };
        keys.chain(law.iter().map(|key| (*key).to_owned())).collect()
    }

    /// Whether the base case is one of hand calculation, which asks for C and m and not for A and p.
    fn is_by_hand(&self) -> bool {
        let method = value_at(&Value::Table(self.base.table.clone()), "model.method")
            .and_then(|method| method.as_str().map(str::to_owned));
        [Method::Handbook, Method::ElementFreeGalerkin].iter().any(|known| method.as_deref() == Some(known.name()))
    }

    /// All cases, in order, each of them read and found right.
    /// Errors: the first that is wrong, with the sweep file where it is about a key that varies; files that cannot be read.
    pub fn cases(&self) -> Result<Vec<DrawnCase>> {
        let draws = self.draws()?;
        let built: Vec<Result<DrawnCase>> = draws.par_iter().enumerate().map(|(i, draw)| self.build(i + 1, draw)).collect();
        // The first in order, not the first in time.
        built.into_iter().collect()
    }

    fn draws(&self) -> Result<Vec<Draw>> {
        let design = &self.design;
        let count = design.cases;
        if design.kind == DesignKind::Grid {
            return Ok((0..count).map(|i| Draw { values: self.combination(i), law: None }).collect());
        }
        let law = if design.kind == DesignKind::FittedScatter { Some(self.law()?) } else { None };
        let columns = design.vary.len();
        // The law stands behind the keys: the same keys get the same values with and without it.
        let rows = hypercube(count, columns + if law.is_some() { 2 } else { 0 }, design.seed);
        let draw = |row: &Vec<f64>| -> Result<Draw> {
            let of_key = |(one, probability): (&super::Vary, &f64)| match &one.spread {
                Spread::Random(distribution) => Value::Float(distribution.quantile(*probability)),
                // Refused when the file was read; the first value is as good as any.
                Spread::Values(values) => values[0].clone(),
            };
            let values = design.vary.iter().zip(row).map(of_key).collect();
            let law = law.as_ref().map(|law| law.draw([row[columns], row[columns + 1]])).transpose()?;
            Ok(Draw { values, law })
        };
        rows.iter().map(draw).collect()
    }

    /// Values of one combination of a grid, the last key fastest.
    fn combination(&self, mut number: usize) -> Vec<Value> {
        let mut values: Vec<Value> = Vec::with_capacity(self.design.vary.len());
        for one in self.design.vary.iter().rev() {
            if let Spread::Values(all) = &one.spread {
                values.push(all[number % all.len()].clone());
                number /= all.len();
            }
        }
        values.reverse();
        values
    }

    fn law(&self) -> Result<LawScatter> {
        let fitted =
            value_at(&Value::Table(self.base.table.clone()), "fatigue.fitted").and_then(|name| name.as_str().map(str::to_owned));
        let Some(fitted) = fitted else {
            let problem = format!("is missing (required by design.kind = \"{}\")", DesignKind::FittedScatter);
            let remedy = "give the fitted.toml of `perilife calibrate`";
            return Err(self.base.locate(input_missing("fatigue.fitted", problem, remedy)));
        };
        let record = fitted_record(&fitted, &self.base.folder)?;
        scatter::read(record, &fitted, &self.base.folder, self.design.scatter)
    }

    fn build(&self, number: usize, draw: &Draw) -> Result<DrawnCase> {
        let mut document = self.base.clone();
        for (i, (one, value)) in self.design.vary.iter().zip(&draw.values).enumerate() {
            let place = |error| self.document.locate(error);
            document.put(&one.key, value.clone()).map_err(|problem| {
                let value = format!("\"{}\"", one.key);
                place(perilife_base::error::input(&format!("vary[{i}].key"), value, problem, "give a key of the case"))
            })?;
        }
        let mut drawn = Vec::new();
        let mut values = draw.values.clone();
        if let Some(law) = &draw.law {
            remove_law(&mut document.table);
            let fatigue = document.table.entry("fatigue").or_insert_with(|| Table::new().into());
            if let Some(fatigue) = fatigue.as_table_mut() {
                fatigue.insert("fitted".to_owned(), FITTED.into());
            }
            drawn.push((FITTED.to_owned(), text_of(law, "record")?.into_bytes()));
            values.push(Value::Float(law.rate_at_pivot_mm_per_cycle));
            let pair = if self.is_by_hand() { [law.paris_m, law.paris_c_mm_per_cycle] } else { [law.p, law.a] };
            values.extend(pair.map(Value::Float));
        }
        document.name = format!("{}_{}", self.base.name, label(number));
        document.folder = self.base.folder.anew_with(drawn);
        let name = document.name.clone();
        let text = text_of(&document.table, "case")?;
        let mut case = DrawnCase { number, name, values, text, files: Vec::new(), hash: String::new() };
        // Reading it is what tells which files it names, whatever the keys.
        read(&document).map_err(|error| self.blame(&case, error))?;
        let opened = document.folder.opened().so_far().files;
        // No output goes over them; those that were drawn lie nowhere.
        let on_disk = opened.iter().filter(|file| file.path.is_some()).cloned();
        on_disk.for_each(|file| self.document.folder.opened().add(file));
        case.files = opened.into_iter().map(|file| (file.name, file.content.to_vec())).collect();
        case.hash = hash(&case.text, &case.files);
        Ok(case)
    }

    /// Says where in the sweep an error in one of its cases comes from.
    fn blame(&self, case: &DrawnCase, error: Error) -> Error {
        let Error::Input(mut trouble) = error else { return error };
        let sweep = format!("{}.toml", self.document.name);
        let words = self.columns().into_iter().zip(&case.values).map(|(key, value)| format!("{key} = {value}"));
        let which = format!(" (case {} of {sweep}: {})", case.label(), words.collect::<Vec<_>>().join(", "));
        let is_own = trouble.file.is_none();
        if is_own {
            // The line is one of a text that nobody has seen.
            trouble.line = None;
        }
        let of_key =
            |key: &String| self.design.vary.iter().position(|one| key == &one.key || key.starts_with(&format!("{}.", one.key)));
        if let Some(place) = trouble.key.as_ref().filter(|_| is_own).and_then(of_key) {
            let there = input_missing(&format!("vary[{place}].key"), "", "");
            if let Error::Input(there) = self.document.locate(there) {
                trouble = Box::new(InputError { file: there.file, line: there.line, ..*trouble });
            }
            trouble.problem.push_str(&which);
            return Error::Input(trouble);
        }
        trouble.problem.push_str(&which);
        self.base.locate(Error::Input(trouble))
    }
}

/// The case of a document whose errors are to be placed by the sweep; it must be ready to run.
fn read(document: &Document) -> Result<()> {
    match Case::complete(document)?.law {
        LawSource::Missing(path) => Err(Error::file(&path, "cannot read", std::io::ErrorKind::NotFound.into())),
        _ => Ok(()),
    }
}

fn text_of(value: &impl serde::Serialize, what: &str) -> Result<String> {
    toml::to_string(value)
        .map_err(|error| input_missing(what, format!("cannot be written as TOML: {error}"), "write it as plain TOML"))
}

/// SHA-256 of all that a result depends on, hexadecimal.
fn hash(text: &str, files: &[(String, Vec<u8>)]) -> String {
    let mut hash = Sha256::new();
    let parts = files.iter().flat_map(|(name, content)| [name.as_bytes(), content]);
    for part in [env!("CARGO_PKG_VERSION").as_bytes(), text.as_bytes()].into_iter().chain(parts) {
        // With its length, so that no two lists of parts run together to the same bytes.
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part);
    }
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
