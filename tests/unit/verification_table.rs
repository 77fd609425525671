//! Verification rows as tables, and what is wrong with them.

use perilife_study::verification::{csv, line, markdown, object, summary};
use perilife_study::{Topic, VerificationRow, faults};

/// Three topics: one with a miss beside a good row, one close to its bound, one whose only row misses.
fn topics() -> [Topic; 3] {
    [("far", "lives", 1), ("near", "errors", 0), ("missed", "angles", 1)].map(|(name, about, misses)| Topic {
        name,
        about: about.to_owned(),
        misses,
        set: toml::Table::new(),
        ask: Vec::new(),
    })
}

fn row(topic: &'static str, quantity: &str, computed: f64, reference: Option<f64>, bound: f64) -> VerificationRow {
    let source = if reference.is_some() { "by hand" } else { "theory" };
    VerificationRow::new(topic, (quantity.to_owned(), source.to_owned()), computed, reference, bound)
}

fn rows() -> Vec<VerificationRow> {
    vec![
        row("far", "a life", 1.01, Some(1.0), 5.0),
        row("far", "another life", 1.2, Some(1.0), 5.0).with_miss("too coarse".to_owned(), 20.0),
        row("near", "max |e|", -0.9, None, 1.0),
        row("near", "mean |e|", 1e-14, None, 1e-10).with_miss("a row within its bound misses nothing".to_owned(), 2.0),
        row("missed", "angle", 12.0, None, 4.0).with_miss("a wide zone".to_owned(), -11.0),
    ]
}

#[test]
fn the_summary_has_the_worst_row_of_every_topic_and_counts_misses() {
    let lines: Vec<String> = summary(&rows()).lines().skip(2).map(str::to_owned).collect();
    assert_eq!(
        lines,
        [
            "| `missed` | 1 | 1 | angle | +12.0 % | 4.00 % |",
            r"| `near` | 2 | 0 | max \|e\| | -0.9 % | 1.00 % |",
            "| `far` | 2 | 1 | a life | +1.0 % | 5.00 % |",
        ]
    );
}

/// Summary first, then every topic with all its rows, each with its bounds, the reason of a miss and no digits of round-off.
#[test]
fn the_document_has_all_rows_of_every_topic() {
    let text = markdown(&topics().iter().collect::<Vec<_>>(), &rows());
    let [summary_at, far, near, missed] =
        ["| `far` |", "\n## far\n", "\n## near\n", "\n## missed\n"].map(|words| text.find(words));
    assert!(summary_at.is_some() && summary_at < far && far < near && near < missed, "{text}");
    for line in [
        "| a life | 1.010 | 1.000 | +1.00 | 5.00 | by hand |",
        "| another life (known miss: too coarse) | 1.200 | 1.000 | +20.00 | 5.00; known miss 22.00 | by hand |",
        r"| max \|e\| | -0.9000 | 0 | -0.90 | 1.00 | theory |",
        r"| mean \|e\| | 0 | 0 | 0.00 | 1.0e-10 | theory |",
        "| angle (known miss: a wide zone) | 12.00 | 0 | +12.00 | 4.00; known miss 12.10 | theory |",
    ] {
        assert!(text.lines().any(|found| found == line), "{line} in {text}");
    }
}

#[test]
fn both_bounds_of_a_known_miss_are_told() {
    let rows = rows();
    let told = &object(&rows)["rows"];
    assert_eq!((&told[1]["known_miss"], &told[1]["miss_bound_percent"]), (&"too coarse".into(), &(1.1 * 20.0).into()));
    assert!(told[0]["known_miss"].is_null() && told[0]["miss_bound_percent"].is_null());
    let table = csv(&rows);
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines[0].ends_with(",wall_s,miss_bound_percent"), "{}", lines[0]);
    assert!(lines[1].ends_with(',') && lines[2].ends_with(",22.000000"), "{table}");
    assert!(line(&rows[1]).contains("miss"), "{}", line(&rows[1]));
    assert!(line(&rows[1]).contains("(bound 5.00 %, known miss 22.00 %)"), "{}", line(&rows[1]));
}

/// A row fails beyond its bound without a reason, and beyond what is known and a tenth of it; an error that is no number fails.
#[test]
fn a_known_miss_must_not_grow() {
    let of = |error: f64, known: Option<f64>| {
        let row = row("far", "a life", error, None, 5.0);
        known.into_iter().fold(row, |row, known| row.with_miss("too coarse".to_owned(), known))
    };
    for (error, known, ok, fails) in [
        (4.9, None, true, false),
        (-5.1, None, false, true),
        (-5.1, Some(5.0), false, false),
        (21.9, Some(-20.0), false, false),
        (-22.1, Some(-20.0), false, true),
        (f64::NAN, Some(20.0), false, true),
    ] {
        let row = of(error, known);
        assert_eq!((row.ok(), row.fails()), (ok, fails), "{row:?}");
    }
    let [far, ..] = &topics();
    let words = faults(&[far], &[of(-22.1, Some(-20.0))]);
    assert_eq!(words, ["far: a life: error -22.100 % beyond its bound of 22.000 %"]);
}

/// Of every topic as many rows miss as are pinned, no more and no fewer.
#[test]
fn misses_are_counted() {
    let (own, mut rows) = (topics(), rows());
    let topics = own.iter().collect::<Vec<_>>();
    assert_eq!(faults(&topics, &rows), Vec::<String>::new());
    let miss = rows.remove(1);
    let words = faults(&topics, &rows);
    assert!(words.len() == 1 && words[0].contains("far: 0 rows miss their bounds, 1 are pinned"), "{words:?}");
    rows.extend([miss.clone(), miss]);
    let words = faults(&topics, &rows);
    assert!(words.len() == 1 && words[0].contains("far: 2 rows miss their bounds, 1 are pinned"), "{words:?}");
}
