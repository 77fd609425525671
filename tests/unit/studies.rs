//! Files of the studies: each is read, and what it must not hold is refused with a word about it.

use perilife_base::watch::Silent;
use perilife_study::chart::{Family, read_scenes};
use perilife_study::questions::{Asker, each};
use perilife_study::stability::{SLOW, read_sweeps};
use perilife_study::{TOPICS, read_topics};
use toml::Table;

use crate::support::rows::assert_refusal;

#[test]
fn every_file_is_read() {
    let topics = read_topics().unwrap();
    assert_eq!(topics.len(), TOPICS.len());
    assert!(topics.iter().all(|topic| !topic.ask.is_empty() && topic.about.len() > 5));
    let mut questions = 0;
    for topic in &topics {
        for ask in &topic.ask {
            each(ask, &topic.set, &mut |_, _| {
                questions += 1;
                Ok(())
            })
            .unwrap_or_else(|error| panic!("{}: {error}", topic.name));
        }
    }
    // 526 rows, and one that is not asked in its first case.
    assert_eq!(questions, 527);
    let (scenes, offers) = read_scenes().unwrap();
    assert!(scenes.len() >= 10 && offers.len() > Family::ALL.len());
    let sweeps = read_sweeps().unwrap();
    for (sweep, method) in SLOW {
        let found = sweeps.iter().find(|known| known.name == sweep).unwrap();
        assert!(found.methods.iter().any(|known| known.name == method), "{sweep}, {method}");
    }
}

/// The answer of a question, or what is wrong with it.
fn answers(question: &str, values: &str) -> Result<Vec<f64>, String> {
    let (question, values): (Table, Table) = (question.parse().unwrap(), values.parse().unwrap());
    let (asker, mut found) = (Asker::new(&Silent), Vec::new());
    each(&question, &values, &mut |question, values| {
        found.push(asker.ask(question, values).number(&question.read)?);
        Ok(())
    })
    .map_err(|error| error.to_string())?;
    Ok(found)
}

#[test]
fn axes_multiply_and_columns_go_together() {
    let over = "over = [{ a = [1, 2], b = [10, 20] }, { c = [0.5, \"=a\"] }]\n";
    assert_eq!(answers(&format!("{over}read = \"a + b*c\""), "").unwrap(), [6.0, 11.0, 12.0, 42.0]);
    // Rows have the keys of the table around them and their own; values of an axis go before those of `set`.
    let rows = "read = \"a\"\nset = { a = 1 }\nrows = [{}, { over = [{ a = [2, 3] }] }, { read = \"percent(a, b)\" }]";
    assert_eq!(answers(rows, "b = 2").unwrap(), [1.0, 2.0, 3.0, -50.0]);
}

#[test]
fn what_a_question_must_not_hold_is_named() {
    for (question, words) in [
        ("read = \"1\"\nreed = \"2\"", "reed"),
        ("read = \"1 +\"", "expected a number"),
        ("read = \"nothing\"\ncase = \"<none>\"", "none: is neither a value nor a reading"),
        ("read = \"life\"\nby = \"guess\"", "guess"),
        ("read = \"along\"\nby = \"plate_in_tension\"\nkeys = \"law=bond_based\"", "no kernel"),
        ("read = \"off\"\nby = \"patch\"\nkeys = \"law=guess\"", "guess"),
        ("read = \"1\"\nover = [{ a = [1, 2], b = [1] }]", "different lengths"),
        ("read = \"beside_life\"\nplate = \"three_cracks\"", "no reference case"),
        ("read = \"life\"\nplate = \"no_cracks\"", "no_cracks"),
        ("read = \"lives\"\nplate = \"slant_severance\"", "lives"),
        ("read = \"k_i(0)\"\nplate = \"slant_severance\"\nkeys = \"study.nothing=1\"", "study.nothing"),
    ] {
        assert_refusal(answers(question, ""), &[words]);
    }
}
