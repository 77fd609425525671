//! Pictures of the README are what the program draws today.

use std::fs;

use tempfile::tempdir;

use crate::interface::cli::{perilife, texts};

/// What makes each: the case it is of, and the file of its run.
const PICTURES: [(&str, &str, &str); 1] = [("slant_crack_plate.svg", "data/cases/slant_crack_plate.toml", "plate.svg")];
/// Pixels by which a place may differ: machines round differently.
const SLACK: f64 = 1.0;

/// Words of a picture without its numbers, and these.
fn taken_apart(svg: &str) -> (Vec<&str>, Vec<f64>) {
    let pieces: Vec<&str> = svg.split([' ', ',', '"', '<', '>', '\n']).filter(|piece| !piece.is_empty()).collect();
    let numbers = pieces.iter().filter_map(|piece| piece.parse().ok()).collect();
    (pieces.into_iter().filter(|piece| piece.parse::<f64>().is_err()).collect(), numbers)
}

#[test]
fn pictures_of_the_readme_are_of_today() {
    let readme = fs::read_to_string("README.md").unwrap();
    for (picture, case, file) in PICTURES {
        assert!(readme.contains(&format!("data/pictures/{picture}")), "{picture} is shown");
        let (dir, case) = (tempdir().unwrap(), fs::canonicalize(case).unwrap());
        let output = perilife(dir.path(), &["predict", case.to_str().unwrap(), "--out", "run", "--no-estimate"]);
        assert_eq!(output.status.code(), Some(0), "{:?}", texts(&output));
        let now = fs::read_to_string(dir.path().join("run").join(file)).unwrap();
        let kept = fs::read_to_string(format!("data/pictures/{picture}")).unwrap();
        let remedy = format!("`perilife predict {} --out run`, then copy run/{file} to data/pictures/{picture}", case.display());
        let ((words, numbers), (of_kept, kept)) = (taken_apart(&now), taken_apart(&kept));
        assert_eq!(words, of_kept, "{picture}: {remedy}");
        assert_eq!(numbers.len(), kept.len(), "{picture}: {remedy}");
        let off = numbers.iter().zip(&kept).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off <= SLACK, "{picture} is off by {off} px: {remedy}");
    }
}
