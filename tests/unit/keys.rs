//! What holds of every key because it is declared: nobody writes these rows.

use std::path::Path;

use perilife_base::error::Error;
use perilife_base::input::{Document, Folder};
use perilife_base::keys::told::Told;
use perilife_base::keys::{Given, Key, Kinds, Need, Shape, all, mistakes};
use perilife_base::units::us::{System, renamed};
use perilife_plate::specimen::SpecimenKind;
use perilife_runner::catalogue;
use toml::{Table, Value};

use crate::support::written::hold;

use crate::support::rows::assert_says;

/// A value that a key takes.
fn some(key: &Key, shape: Shape) -> Value {
    let middle = key.quantity.map_or(1.0, |q| if q.low <= 1.0 && q.high >= 1.0 { 1.0 } else { q.low });
    match shape {
        Shape::Number => Value::Float(middle),
        Shape::Whole => Value::Integer(middle as i64),
        Shape::Flag => Value::Boolean(true),
        Shape::Text | Shape::Other(_) => "x".into(),
        Shape::Choice(lines) => lines()[0].name.into(),
        Shape::Numbers(n) => Value::Array(vec![Value::Float(middle); n]),
        Shape::List(inner) => Value::Array(vec![some(key, *inner)]),
        Shape::Table(keys) => Value::Table(filled(keys)),
    }
}

/// A table of the keys that are needed.
fn filled(keys: &[Key]) -> Table {
    let needed = all(keys).into_iter().filter(|key| key.need == Need::Required && key.group.is_none());
    needed.map(|key| (key.name.to_owned(), some(&key, key.shape))).collect()
}

/// Sections of every sort of file, and tables below them.
fn sections() -> Vec<Told> {
    let mut found = [catalogue::told(), catalogue::beside()].concat();
    let mut at = 0;
    while let Some(told) = found.get(at).cloned() {
        for key in all(&told.keys) {
            if let Shape::Table(keys @ [_, ..]) | Shape::List(&Shape::Table(keys @ [_, ..])) = key.shape {
                let section = format!("{}.{}", told.section, key.name);
                found.push(Told { section, keys: keys.to_vec(), tag: None, ..told.clone() });
            }
        }
        at += 1;
    }
    found
}

/// What a section says of a table.
fn told_of(told: &Told, table: &Table) -> Vec<String> {
    let kinds: Vec<_> = SpecimenKind::ALL.iter().map(|kind| (kind.name(), kind.keys())).collect();
    let kinds = told.tag.map(|(tag, own)| Kinds { tag, own, all: &kinds });
    let given = Given { table, path: &told.section };
    mistakes(given, &told.keys, &[], kinds.as_ref()).iter().map(ToString::to_string).collect()
}

/// A section whose one key has this value.
fn with(told: &Told, key: &Key, value: Value) -> Vec<String> {
    let mut table = filled(&told.keys);
    table.insert(key.name.to_owned(), value);
    told_of(told, &table)
}

#[test]
fn every_key_refuses_values_of_another_sort_and_beyond_reason() {
    let mut rows = 0;
    for told in sections() {
        for key in all(&told.keys) {
            let path = format!("{}.{}", told.section, key.name);
            if !matches!(key.shape, Shape::Other("a valid value")) {
                let wrong = with(&told, &key, Value::Datetime("1979-05-27".parse().unwrap()));
                assert_eq!(wrong.len(), 1, "{wrong:?}");
                assert!(wrong[0].starts_with(&format!("{path} = 1979-05-27: is not ")) && wrong[0].contains("; "), "{wrong:?}");
                rows += 1;
            }
            if let Shape::Choice(_) | Shape::List(&Shape::Choice(_)) = key.shape {
                let name = Value::from("nowhere");
                let value = if matches!(key.shape, Shape::List(_)) { Value::Array(vec![name]) } else { name };
                let wrong = with(&told, &key, value);
                assert!(wrong.len() == 1 && wrong[0].contains("= \"nowhere\": unknown kind; "), "{wrong:?}");
                rows += 1;
            }
            if let (Shape::Whole, Some(range)) = (key.shape, key.quantity) {
                for value in [range.low - 1.0, range.high + 1.0] {
                    let wrong = with(&told, &key, Value::Integer(value as i64));
                    assert!(wrong.len() == 1 && wrong[0].starts_with(&path) && wrong[0].contains(": is not "), "{wrong:?}");
                    rows += 1;
                }
            }
            let Some(quantity) = key.quantity.filter(|_| matches!(key.shape, Shape::Number)) else { continue };
            for (value, words) in [
                (1e305, "out of range"),
                (-1e305, if quantity.low > 0.0 { "above zero" } else { "out of range" }),
                (f64::NAN, "finite"),
            ] {
                let wrong = with(&told, &key, Value::Float(value));
                let is_said = wrong.len() == 1 && wrong[0].starts_with(&path) && wrong[0].contains(words);
                assert!(is_said && wrong[0].contains("between"), "{path} = {value}: {words} in {wrong:?}");
                rows += 1;
            }
        }
    }
    assert!(rows > 600, "{rows}");
}

#[test]
fn every_needed_key_is_missed_and_a_good_section_is_taken() {
    for told in sections() {
        let good = filled(&told.keys);
        assert!(told_of(&told, &good).is_empty(), "{}: {:?}", told.section, told_of(&told, &good));
        for name in good.keys() {
            let mut table = good.clone();
            table.remove(name);
            let wrong = told_of(&told, &table);
            assert_eq!(wrong.len(), 1);
            assert!(wrong[0].starts_with(&format!("{}.{name}: is missing; ", told.section)), "{wrong:?}");
        }
    }
}

#[test]
fn of_keys_that_say_the_same_one_is_given() {
    let mut rows = 0;
    for told in sections() {
        let keys = all(&told.keys);
        for (i, key) in keys.iter().enumerate().filter(|(_, key)| key.group.is_some()) {
            let Some(other) = keys[..i].iter().find(|other| other.group == key.group) else { continue };
            let mut table = filled(&told.keys);
            for key in [key, other] {
                table.insert(key.name.to_owned(), some(key, key.shape));
            }
            let wrong = told_of(&told, &table);
            assert!(
                wrong.iter().any(|wrong| wrong.contains(&format!("conflicts with {}; give exactly one of ", other.name))),
                "{}: {wrong:?}",
                key.name
            );
            rows += 1;
        }
    }
    assert!(rows > 5, "{rows}");
}

/// The name of a key in US units.
fn twin_of(key: &Key) -> Option<String> {
    renamed(key.name, System::Us).filter(|twin| twin.factor(|_| None).is_ok()).map(|twin| twin.name)
}

#[test]
fn every_twin_is_refused_in_its_own_units_and_beside_its_key() {
    let mut rows = 0;
    for told in catalogue::told() {
        let section = told.section.split('.').next().unwrap();
        for key in all(&told.keys).into_iter().filter(|key| matches!(key.shape, Shape::Number)) {
            let Some((twin, quantity)) = twin_of(&key).zip(key.quantity) else { continue };
            let both = format!("[{section}]\n{} = {}\n{twin} = 1.0\n", key.name, some(&key, key.shape));
            let error = Document::parse(&both, "both.toml", Folder::none(), &[]).unwrap_err().to_string();
            let words = format!("{section}.{twin} = 1.0: conflicts with {section}.{} = ", key.name);
            assert!(error.starts_with(&words), "{error}");
            let large = format!("[{section}]\n{twin} = {:e}\n", 10.0 * quantity.high);
            let document = Document::parse(&large, "large.toml", Folder::none(), &[]).unwrap();
            let mut table = filled(&told.keys);
            table.extend(document.table[section].as_table().unwrap().clone());
            let wrong = mistakes(Given { table: &table, path: section }, &told.keys, &[], None);
            let error = document.locate(Error::Input(Box::new(wrong.into_iter().next().unwrap()))).to_string();
            assert!(error.starts_with(&format!("{section}.{twin} = ")) && error.contains("out of range"), "{error}");
            rows += 1;
        }
    }
    assert!(rows > 100, "{rows}");
}

#[test]
fn a_slip_of_the_pen_gets_the_name_that_was_meant() {
    for told in sections() {
        for key in all(&told.keys).into_iter().filter(|key| key.name.len() > 7) {
            let mut name = key.name.to_owned();
            name.remove(3);
            let mut table = filled(&told.keys);
            table.remove(key.name);
            table.insert(name, some(&key, key.shape));
            let wrong = told_of(&told, &table);
            assert_eq!(wrong.len(), 1, "the key that was meant is not missing, too: {wrong:?}");
            assert!(wrong[0].contains("did you mean "), "{wrong:?}");
        }
    }
}

#[test]
fn every_key_is_told_everywhere_with_its_twin() {
    let (schema, manual, stub) = (catalogue::schema().to_string(), catalogue::manual(), catalogue::stub());
    for told in catalogue::told() {
        let own = told.schema();
        for key in all(&told.keys) {
            let (label, _) = key.label_and_hint();
            // K_c and δ_max are symbols, crack_length a name.
            let is_plain = label.split(' ').all(|word| !word.contains('_') || word.chars().count() < 6);
            assert!(!label.is_empty() && is_plain, "{}.{}: {label}", told.section, key.name);
            assert_eq!(own["properties"][key.name]["title"], label, "{}", key.name);
            assert!(manual.contains(&format!("| `{}`", key.name)), "{}", key.name);
            assert!(stub.contains(&format!("    {}: ", key.name)), "{}", key.name);
            assert!(schema.contains(&format!("\"{}\"", key.name)));
            assert!(told.lines().iter().any(|line| line[0] == format!("{}.{}", told.section, key.name)), "{}", key.name);
            if let Some(twin) = twin_of(&key) {
                assert!(own["properties"].get(&twin).is_some() && stub.contains(&format!("    {twin}: ")), "{twin}");
            }
        }
    }
}

#[test]
fn the_guide_and_the_stub_say_what_the_keys_say() {
    let head = "# Keys of input files\n\nWritten from the keys of the program (`perilife list keys`). A key in mm, MPa, GPa, N, kN or MPa√m has a twin in US units.\n\n";
    let page = format!("{head}{}\n", catalogue::manual().trim_end());
    hold(&[("src/python/perilife/sections.py", &catalogue::stub()), ("src/guide/keys.md", &page)]);
}

#[test]
fn all_mistakes_of_a_file_are_told_at_once() {
    let text = "[specimen]\nkind = \"middle_tension\"\nwidht_mm = 100\nlength_mm = -3\nthickness_mm = 2\ncrack_length_mm = 5\n\
                [material]\nname = \"al2024-t3\"\n[loading]\nstress_max_mpa = 50\nstress_ratio = \"low\"\n[stop]\ncycles_max = 0\n";
    let error = perilife_growth::case::Case::from_toml(text, "case", Path::new(""), &[]).unwrap_err();
    let Error::Input(input) = &error else { panic!("{error}") };
    assert_eq!(input.more.len(), 3, "{error}");
    let message = error.to_string();
    assert!(message.starts_with("4 mistakes\n1. "), "{message}");
    assert_says(
        &message,
        &[
            "did you mean width_mm?",
            "2. specimen.length_mm",
            "3. loading.stress_ratio = \"low\": is not a number",
            "4. stop.cycles_max",
        ],
    );
    let lines: Vec<_> = input.clone().each().iter().map(|one| one.line).collect();
    assert_eq!(lines, [Some(3), Some(4), Some(11), Some(13)]);
}
