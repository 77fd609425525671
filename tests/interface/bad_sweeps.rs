//! Sweep files that are wrong: refused before anything is run, with words.

use crate::interface::cli::{assert_refused, perilife};
use crate::interface::sweep::{GRID, folder_with};

#[test]
fn bad_designs_are_refused_before_anything_runs() {
    let grid = |vary: &str| format!("case = \"panel.toml\"\n[design]\nkind = \"grid\"\n[[vary]]\n{vary}");
    let random =
        |vary: &str| format!("case = \"panel.toml\"\n[design]\nkind = \"latin_hypercube\"\nsamples = 9\n[[vary]]\n{vary}");
    let length = "key = \"specimen.crack_length_mm\"\n";
    let table: Vec<(String, i32, Vec<&str>)> = vec![
        ("[design]\nkind = \"grid\"\n".to_owned(), 2, vec!["sweep.toml", "case: is missing"]),
        (
            "case = \"gone.toml\"\n[design]\nkind = \"grid\"\n[[vary]]\nkey = \"a.b\"\n".to_owned(),
            2,
            vec!["is not a key of a case"],
        ),
        (grid("key = \"specimen.crack_length_mm\"\nvalues = [1]\n").replace("panel", "gone"), 4, vec!["gone.toml: cannot read"]),
        ("case = \"panel.toml\"\n[design]\nkind = \"grid\"\n".to_owned(), 2, vec!["vary: is missing: no key varies"]),
        (
            grid("key = \"crack_length_mm\"\nvalues = [1]\n"),
            2,
            vec!["sweep.toml:5", "vary[0].key = \"crack_length_mm\"", "section.key"],
        ),
        (grid(&format!("{length}values = []\n")), 2, vec!["vary[0].values = []: is empty"]),
        (grid(&format!("{length}from = 8\nto = 9\n")), 2, vec!["vary[0].count: is missing"]),
        (
            grid(&format!("{length}from = 0\nto = 9\ncount = 3\nscale = \"log\"\n")),
            2,
            vec!["vary[0].from = 0: must be above zero"],
        ),
        (grid(&format!("{length}distribution = \"normal\"\n")), 2, vec!["vary[0].distribution", "this is a grid"]),
        (grid(&format!("{length}values = [8]\n[[vary]]\n{length}values = [9]\n")), 2, vec!["sweep.toml:8", "is given twice"]),
        (grid(&format!("{length}from = 8\nto = 9\ncount = 20000\n")), 2, vec!["vary[0].count = 20000"]),
        (
            grid(&format!(
                "{length}from = 8\nto = 9\ncount = 200\n[[vary]]\nkey = \"loading.stress_ratio\"\nfrom = 0\nto = 0.5\ncount = 51\n"
            )),
            2,
            vec!["10200 cases", "--most"],
        ),
        (random(&format!("{length}values = [8]\n")), 2, vec!["vary[0].values", "applies only to a grid"]),
        (
            random(&format!("{length}distribution = \"uniform\"\nfrom = 9\nto = 8\n")),
            2,
            vec!["vary[0].to = 8", "is not above from = 9"],
        ),
        (
            random(&format!("{length}distribution = \"normal\"\nmean = 9\nto = 8\n")),
            2,
            vec!["vary[0].to", "cannot be combined with"],
        ),
        (
            random(&format!("{length}distribution = \"log_normal\"\nmedian = 9\nfactor = 0.5\n")),
            2,
            vec!["factor = 0.5: must be above 1"],
        ),
        (
            random(&format!("{length}distribution = \"uniform\"\nfrom = 8\nto = 9\n")).replace("samples = 9\n", ""),
            2,
            vec!["design.samples: is missing"],
        ),
        (
            random(&format!("{length}distribution = \"uniform\"\nfrom = 8\nto = 9\n")).replace("samples = 9", "samples = 0"),
            2,
            vec!["design.samples = 0"],
        ),
        // Cases that are wrong: the sweep file, its line, the key of the case and its value.
        (grid(&format!("{length}values = [8.0, 90.0]\n")), 2, vec!["sweep.toml:5", "specimen.crack_length_mm = 90", "case 0002"]),
        (
            grid("key = \"specimen.crack_lenght_mm\"\nvalues = [8.0]\n"),
            2,
            vec!["sweep.toml:5", "specimen.crack_lenght_mm", "unknown key"],
        ),
        (
            grid("key = \"model.method\"\nvalues = [\"handbook\", \"guess\"]\n"),
            2,
            vec!["sweep.toml:5", "model.method = \"guess\"", "case 0002"],
        ),
        // A key that does not vary, wrong because of one that does.
        (
            grid(&format!("{length}values = [8.0, 50.0]\n")),
            2,
            vec!["panel.toml:19", "stop.crack_length_mm", "case 0002 of sweep.toml: specimen.crack_length_mm = 50"],
        ),
        (
            random(&format!("{length}distribution = \"normal\"\nmean = 1\nstandard_deviation = 5\n")),
            2,
            vec!["sweep.toml:6", "specimen.crack_length_mm = -", "must be above zero"],
        ),
        (
            "case = \"panel.toml\"\n[design]\nkind = \"fitted_scatter\"\nsamples = 9\n".to_owned(),
            2,
            vec!["panel.toml", "fatigue.fitted: is missing", "design.kind"],
        ),
        (
            random(&format!("{length}distribution = \"uniform\"\nfrom = 8\nto = 9\n"))
                .replace("samples", "scatter = \"constants\"\nsamples"),
            2,
            vec!["design.scatter", "cannot be combined with"],
        ),
    ];
    for (text, code, words) in table {
        let dir = folder_with(&text);
        println!("{text}");
        let output = perilife(dir.path(), &["sweep", "sweep.toml", "--out", "out"]);
        assert_refused(&output, code, &words);
        assert!(!dir.path().join("out").exists());
    }
    let dir = folder_with(GRID);
    for shard in ["0/3", "4/3", "1", "a/b"] {
        let output = perilife(dir.path(), &["sweep", "sweep.toml", "--out", "out", "--shard", shard]);
        assert_eq!(output.status.code(), Some(2), "{shard}");
    }
}
