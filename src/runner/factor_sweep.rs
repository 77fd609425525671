//! A case of which K over crack length is asked.

use toml::Value;

use perilife_base::error::{Result, input};
use perilife_base::input::{Document, LENGTH};
use perilife_base::units::{MM, round_off, shown::length_given};
use perilife_growth::case::Case;
use perilife_growth::case::needs;
use perilife_plate::specimen::SpecimenKind;

/// Option that asks for it.
const KEY: &str = "--sweep";
const LENGTHS_MOST: f64 = 10_000.0;
/// Share of a step by which the last one may fall short.
const SLACK: f64 = 1e-6;

/// The lengths, m, of `first:last:step`, each as [`length_given`]; the last one is always among them.
/// Errors: [`perilife_base::error::Error::Input`] on the option.
pub fn lengths(asked: &str) -> Result<Vec<f64>> {
    let refuse = |problem: &str| input(KEY, asked, problem, "give first:last:step, such as 10:40:1 or 0.4in:1.6in:0.05in");
    let numbers = asked.split(':').map(|part| Some(round_off(length_given(part)? / MM))).collect::<Option<Vec<f64>>>();
    let Some([first, last, step]) = numbers.as_deref() else { return Err(refuse("is not three lengths")) };
    for number in [first, last, step] {
        LENGTH.read(KEY, *number)?;
    }
    if first >= last {
        return Err(refuse("must increase"));
    }
    let steps = ((last - first) / step - SLACK).ceil();
    if steps > LENGTHS_MOST {
        return Err(refuse("has more than 10000 lengths"));
    }
    let length = |i: usize| if i as f64 >= steps { *last } else { first + i as f64 * step };
    Ok((0..=steps as usize).map(|i| length(i) * MM).collect())
}

/// The case of a document whose crack is to be followed from the first of these lengths, m; where it stops is not looked at.
/// Errors: wrong input; a plate that this machine has no memory for.
pub fn case(document: &Document, lengths: &[f64]) -> Result<Case> {
    let mut start = document.clone();
    start.table.remove("stop");
    let kind = start.table.get("specimen").and_then(|specimen| specimen.get("kind")).and_then(Value::as_str);
    if kind.and_then(|kind| kind.parse().ok()).is_some_and(|kind: SpecimenKind| kind.sharing().is_some())
        && let Some(specimen) = start.table.get_mut("specimen").and_then(Value::as_table_mut)
    {
        specimen.insert("crack_length_mm".to_owned(), Value::Float(lengths[0] / MM));
    }
    let case = Case::plate_of(&start)?;
    needs::of_case(&case).within_machine().map_err(|error| document.locate(error))?;
    Ok(case)
}
