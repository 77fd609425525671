//! Words that texts for users do not use: string literals of `src`, identifiers apart.

use std::fs;

use super::house::{rust_files, source};

const NOT_USED: &str = "stands|bears|anew|rim|rims|flanks|unlike|lies|tells|knows|moments|beside|at the most|this very|left out|\
    leave it out|goes on|asks for|asked for|does not go with|belongs to|hand calculation|not go through|holds no|as printed|\
    second opinion|twice in a row|takes hold|colour|centre|aluminium|neighbour|neighbouring|millimetre|trouble";
/// How many are left, by folder or file: these numbers only shrink.
const LEFT: [(&str, usize); 3] = [("results/", 4), ("runner/check/", 2), ("", 0)];

/// String literals of a source as words in lower case, a blank before and after each.
fn literals(source: &str) -> Vec<String> {
    let code = source.lines().filter(|line| !line.trim_start().starts_with("//")).map(|line| line.to_lowercase() + "\n");
    let code = code.collect::<String>().replace("'\"'", "").replace("\\\"", "'").replace("\\\n", "").replace("\\n", " ");
    let words = |text: &str| text.replace(|c: char| !c.is_alphanumeric() && c != '_', " ");
    let spaced = |text: &str| words(text).split_whitespace().map(|word| format!(" {word}")).collect::<String>() + " ";
    code.split('"').skip(1).step_by(2).map(spaced).collect()
}

#[test]
fn texts_use_the_words_of_the_field() {
    let mut left = LEFT.map(|(place, most)| (place, most, Vec::new()));
    for file in rust_files(&source()) {
        let name = file.strip_prefix(source()).unwrap().display().to_string();
        let place = left.iter_mut().find(|(place, ..)| name.starts_with(place)).unwrap();
        for text in literals(&fs::read_to_string(&file).unwrap()) {
            let found = NOT_USED.split('|').filter(|words| text.contains(&format!(" {words} ")));
            place.2.extend(found.map(|words| format!("{name}: \"{words}\" in{text}")));
        }
    }
    let grown = left.iter().filter(|(_, most, found)| found.len() > *most);
    let grown: Vec<_> = grown
        .map(|(place, most, found)| format!("{} of at most {most} in `{place}`:\n{}", found.len(), found.join("\n")))
        .collect();
    assert!(grown.is_empty(), "{}", grown.join("\n"));
    assert_eq!(literals("x(\"It Stands \\\n by\");\n  // \"rim\"\nlet c = '\"'; \"a_rim\""), [" it stands by ", " a_rim "]);
}
