//! The topics of `perilife verify`: cheap ones with every run of the tests, all of them where that is asked for.

use perilife_study::verification::{line, markdown};
use perilife_study::{Topic, VerificationRow, faults, rows, topics};

/// Topics of a few seconds each.
const CHEAP: [&str; 7] = ["golden", "static_scenes", "dual_horizon", "golden_peridynamics", "same_plate", "named_plates", "pins"];

/// The rows of the topics with these names, of which none fails and as many miss as are pinned.
fn sound(names: &[&str]) -> (Vec<&'static Topic>, Vec<VerificationRow>) {
    let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
    let topics = topics(&names).unwrap();
    let rows = rows(&topics, &|_, rows| rows.iter().for_each(|row| println!("{}", line(row)))).unwrap();
    let faults = faults(&topics, &rows);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    (topics, rows)
}

#[test]
fn cheap_topics_keep_their_bounds() {
    let (topics, rows) = sound(&CHEAP);
    for topic in topics {
        let of_topic = rows.iter().filter(|row| row.name == topic.name).count();
        assert!(of_topic >= 4, "{}: {of_topic} rows", topic.name);
    }
}

#[test]
#[ignore = "long: the whole verification, three minutes"]
fn the_table_of_all_topics_is_what_the_program_computes() {
    let (topics, rows) = sound(&[]);
    let written = std::fs::read_to_string("tests/ACCURACY.md").unwrap();
    assert!(
        written == markdown(&topics, &rows),
        "tests/ACCURACY.md is out of date; `perilife verify --markdown tests/ACCURACY.md` writes it"
    );
}
