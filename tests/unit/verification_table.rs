//! Verification rows as tables.

use perilife::report::verification::{markdown, summary};
use perilife::verify::{Row, Table};

/// Three topics: one with a miss beside a good row, one close to its bound, one whose only row misses.
fn rows() -> Vec<Row> {
    let mut far = Table::new("far");
    far.compare("a life", 1.01, 1.0, 5.0, "by hand");
    far.compare("another life", 1.2, 1.0, 5.0, "by hand");
    far.known_miss("too coarse");
    let mut near = Table::new("near");
    near.error("max |e|", -0.9, 1.0, "theory");
    near.error("mean |e|", 0.1, 1.0, "theory");
    near.known_miss("a row within its bound misses nothing");
    let mut missed = Table::new("missed");
    missed.error("angle", 12.0, 4.0, "theory");
    missed.known_miss("a wide zone");
    [far, near, missed].into_iter().flat_map(Table::into_rows).collect()
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

#[test]
fn the_table_of_all_rows_has_the_worst_first_with_the_reason_of_a_miss() {
    let text = markdown(&rows());
    let lines: Vec<&str> = text.lines().skip(2).collect();
    assert_eq!(lines.len(), 5);
    // 20 of 5 percent, 12 of 4, 0.9 of 1, 1 of 5, 0.1 of 1.
    for (line, words) in
        lines.iter().zip(["another life (known miss: too coarse)", "a wide zone", r"max \|e\|", "a life", r"mean \|e\|"])
    {
        assert!(line.contains(words), "{line}");
        // Six cells, no bar in them.
        assert_eq!(line.replace(r"\|", "").matches('|').count(), 7, "{line}");
    }
}
