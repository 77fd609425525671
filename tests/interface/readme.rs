//! What README and guide show is what the program prints and draws today: their commands are run as they are shown.
//!
//! A block `toml NAME` or `csv NAME` is a file of the commands below it. A block `text` with lines `$ perilife ...` is a session: printed is what
//! is shown, first what goes to stdout, then what goes to stderr. Commands of a block `sh`, too slow or without an end, are parsed only.
//! With the variable PERILIFE_REFRESH the tests write what is printed today into the pages.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;

use clap::{Arg, Command, CommandFactory, Parser};
use perilife::commands::CommandLine;
use perilife::guide::PAGES;
use serde_json::Value;
use tempfile::{TempDir, tempdir};

use crate::interface::cli::{perilife, texts};
use crate::support::written::{hold, refreshes};

/// Pictures, and the files that the commands of the README write.
const PICTURES: [(&str, &str); 1] = [("slant_crack_plate.svg", "out/fit/slant_crack_plate/plate.svg")];
/// Pixels by which a place may differ: machines round differently.
const SLACK: f64 = 1.0;
/// Part by which a printed number may differ, apart from one unit of its last digit.
const PART: f64 = 1e-3;
/// How a command begins in a page.
const BEGINNINGS: [&str; 2] = ["cargo run -- ", "perilife "];
const GALLERY: &str = "src/guide/gallery.md";

/// Thousands that stand apart are one number.
fn joined(text: &str) -> String {
    let mut is_grouped = false;
    text.split(' ').fold(String::new(), |before, word| {
        let digits = before.chars().rev().take_while(char::is_ascii_digit).count();
        let is_whole = !before[..before.len() - digits].ends_with('.');
        let is_group = word.chars().take_while(char::is_ascii_digit).count() == 3;
        is_grouped = is_group && is_whole && ((1..=3).contains(&digits) || (is_grouped && digits > 3));
        let between = if is_grouped || before.is_empty() { "" } else { " " };
        before + between + word
    })
}

/// Words of a text without its numbers, and these, each with the unit of its last digit.
fn taken_apart(text: &str) -> (Vec<&str>, Vec<[f64; 2]>) {
    let pieces = || text.split([' ', ',', '"', '<', '>', '\n', '(', ')', ':', ';', '^']).filter(|piece| !piece.is_empty());
    let number = |piece: &str| {
        let (digits, power) = piece.split_once('e').unwrap_or((piece, "0"));
        let decimals = digits.split_once('.').map_or(0, |(_, decimals)| decimals.len() as i32);
        Some([piece.parse().ok()?, 10_f64.powi(power.parse::<i32>().ok()? - decimals)])
    };
    (pieces().filter(|piece| piece.parse::<f64>().is_err()).collect(), pieces().filter_map(number).collect())
}

/// Without the seconds of this machine.
fn timeless(line: &str) -> &str {
    let is_timed = line.ends_with(" s") || line.ends_with(" ms");
    if is_timed { line.rsplit_once(", ").map_or(line, |(before, _)| before) } else { line }
}

/// Fails unless both lines have the same words, and numbers that differ by rounding alone.
fn assert_same(page: &str, shown: &str, printed: &str) {
    let [shown_whole, printed_whole] = [shown, printed].map(|line| joined(timeless(line)));
    let ((words, numbers), (of_printed, printed_numbers)) = (taken_apart(&shown_whole), taken_apart(&printed_whole));
    let slack = |[number, unit]: [f64; 2]| PART * number.abs() + 1.01 * unit;
    let is_same = words == of_printed
        && numbers.len() == printed_numbers.len()
        && numbers.iter().zip(&printed_numbers).all(|(shown, printed)| (printed[0] - shown[0]).abs() <= slack(*shown));
    assert!(is_same, "{page} shows {shown:?}, printed is {printed:?}; PERILIFE_REFRESH=1 writes it");
}

/// Words of a command, in quotes or not; none of another program.
fn words_of(line: &str) -> Option<Vec<&str>> {
    let command = BEGINNINGS.iter().find_map(|beginning| line.strip_prefix(beginning))?;
    let command = command.split(" # ").next()?.split(" > ").next()?;
    let quoted = command.split('"').enumerate();
    Some(quoted.flat_map(|(at, part)| if at % 2 == 1 { vec![part] } else { part.split_whitespace().collect() }).collect())
}

/// A folder with the examples, as a clone has them.
fn folder() -> TempDir {
    let dir = tempdir().unwrap();
    for folder in ["data", "calibration"] {
        symlink(fs::canonicalize(folder).unwrap(), dir.path().join(folder)).unwrap();
    }
    dir
}

/// Runs the commands of a page in a folder; gives the page as it is to be, and the number of commands.
fn run(page: &str, text: &str, dir: &Path) -> (String, usize) {
    let (mut of_today, mut count, mut lines) = (String::new(), 0, text.lines().peekable());
    while let Some(line) = lines.next() {
        writeln!(of_today, "{line}").unwrap();
        let Some((kind, name)) = line.strip_prefix("```").map(|info| info.split_once(' ').unwrap_or((info, ""))) else {
            continue;
        };
        let mut block = Vec::new();
        while let Some(line) = lines.next_if(|line| !line.starts_with("```")) {
            block.push(line);
        }
        let (end, mut body) = (lines.next().expect("a block ends"), block.join("\n"));
        match kind {
            "toml" | "csv" if !name.is_empty() => fs::write(dir.join(name), format!("{body}\n")).unwrap(),
            "sh" => block.iter().filter_map(|line| words_of(line)).for_each(|words| {
                let parsed = CommandLine::try_parse_from([&["perilife"], &words[..]].concat());
                assert!(parsed.is_ok(), "{page}: {words:?}: {}", parsed.unwrap_err());
                let is_of_clone = |word: &&&str| word.starts_with("data/") || word.starts_with("calibration/");
                words.iter().filter(is_of_clone).for_each(|file| assert!(Path::new(file).exists(), "{page}: {file}"));
                count += 1;
            }),
            "text" if block[0].starts_with("$ ") => {
                count += block.iter().filter(|line| line.starts_with("$ ")).count();
                body = session(page, &block, dir);
            }
            _ => {}
        }
        writeln!(of_today, "{}\n{end}", body.trim_end()).unwrap();
    }
    (of_today, count)
}

/// Runs a session; gives it as it is today, and fails if it is another than shown, unless pages are refreshed.
fn session(page: &str, block: &[&str], dir: &Path) -> String {
    let mut today = String::new();
    for shown in block.chunk_by(|_, line| !line.starts_with("$ ")) {
        let words = words_of(&shown[0][2..]).unwrap_or_else(|| panic!("{page}: {} is not run", shown[0]));
        let output = perilife(dir, &words);
        assert_eq!(output.status.code(), Some(0), "{page}: {words:?}: {:?}", texts(&output));
        let printed = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap()).concat();
        if !refreshes() {
            assert_eq!(shown.len() - 1, printed.lines().count(), "{page}: {words:?} prints\n{printed}");
            shown[1..].iter().zip(printed.lines()).for_each(|(shown, printed)| assert_same(page, shown, printed));
        }
        writeln!(today, "{}\n{printed}", shown[0]).unwrap();
        today.truncate(today.trim_end().len());
        today.push('\n');
    }
    today
}

fn run_and_refresh(page: &str, dir: &Path) -> (String, usize) {
    let text = fs::read_to_string(page).unwrap();
    let (today, count) = run(page, &text, dir);
    if refreshes() {
        fs::write(page, &today).unwrap();
    }
    (text, count)
}

#[test]
fn what_the_readme_shows_is_of_today() {
    let dir = folder();
    let (readme, count) = run_and_refresh("README.md", dir.path());
    assert!(count >= 3 && readme.lines().count() <= 190, "{count} commands");
    for (picture, file) in PICTURES {
        assert!(readme.contains(&format!("data/pictures/{picture}")), "{picture} is shown");
        let now = fs::read_to_string(dir.path().join(file)).unwrap();
        let kept = fs::read_to_string(format!("data/pictures/{picture}")).unwrap();
        let remedy = format!("copy {file} of the README's commands to data/pictures/{picture}");
        let ((words, numbers), (of_kept, kept)) = (taken_apart(&now), taken_apart(&kept));
        assert!(words == of_kept && numbers.len() == kept.len(), "{picture} is another one: {remedy}");
        let off = numbers.iter().zip(&kept).map(|([a, _], [b, _])| (a - b).abs()).fold(0.0, f64::max);
        assert!(off <= SLACK, "{picture} is off by {off} px: {remedy}");
    }
}

/// Pages of the guide that are files of its folder.
fn pages() -> Vec<String> {
    let files = fs::read_dir("src/guide").unwrap().map(|entry| entry.unwrap().path().display().to_string());
    files.chain(["src/python/README.md".to_owned()]).collect()
}

#[test]
fn what_the_guide_shows_is_of_today() {
    let count: usize = pages().iter().map(|page| run_and_refresh(page, folder().path()).1).sum();
    assert!(count > 30, "{count} commands");
}

fn links(text: &str) -> BTreeSet<&str> {
    let ends = text.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
    ends.map(|(link, _)| link).filter(|link| !link.contains(':')).collect()
}

#[test]
fn every_page_is_in_the_index_and_every_link_leads_somewhere() {
    let names: BTreeSet<&str> = PAGES.iter().map(|(name, _)| *name).collect();
    let files = pages().iter().filter(|page| page.starts_with("src/guide")).count();
    assert_eq!(names.len(), files + 2, "every file of src/guide is a page; two are elsewhere");
    let index: BTreeSet<&str> = links(PAGES[0].1).iter().filter_map(|link| link.strip_suffix(".md")).chain(["index"]).collect();
    assert_eq!(index, names);
    for (name, text) in PAGES {
        for link in links(text).iter().filter(|link| !link.contains('/')) {
            assert!(link.strip_suffix(".md").is_some_and(|page| names.contains(page)), "{name} links to {link}");
        }
    }
    for page in pages().iter().map(String::as_str).chain(["README.md", "tests/README.md", "data/README.md"]) {
        let (text, folder) = (fs::read_to_string(page).unwrap(), Path::new(page).parent().unwrap());
        for link in links(&text).iter().filter(|link| link.contains('/')) {
            assert!(folder.join(link.split('#').next().unwrap()).exists(), "{page} links to {link}");
        }
    }
}

/// An argument in a row: how it is written, what it does, its default.
fn row(argument: &Arg) -> String {
    let values: Vec<String> = argument.get_value_names().into_iter().flatten().map(|name| format!("<{name}>")).collect();
    let values = if argument.get_action().takes_values() { values.join(" ") } else { String::new() };
    let name = argument.get_long().map_or_else(|| values.clone(), |long| format!("--{long} {values}"));
    let default: Vec<_> = argument.get_default_values().iter().map(|value| value.to_string_lossy()).collect();
    let default =
        if values.is_empty() || default.is_empty() { String::new() } else { format!(" [default: {}]", default.join(", ")) };
    let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
    format!("| `{}` | {} |\n", name.trim(), (help + &default).replace('|', "\\|"))
}

/// Sections of a command and those within it.
fn sections(name: &str, command: &Command, text: &mut String) {
    const OF_ALL: [&str; 6] = ["help", "version", "verbose", "units", "json", "quiet"];
    for command in command.get_subcommands().filter(|command| !command.is_hide_set() && command.get_name() != "help") {
        let name = format!("{name} {}", command.get_name());
        writeln!(text, "\n## `{name}`\n\n{}.", command.get_about().unwrap()).unwrap();
        let rows: String = command.get_arguments().filter(|one| !OF_ALL.contains(&one.get_id().as_str())).map(row).collect();
        if !rows.is_empty() {
            write!(text, "\n| argument, option | does |\n|---|---|\n{rows}").unwrap();
        }
        sections(&name, command, text);
    }
}

#[test]
fn the_page_of_commands_is_the_help() {
    let mut text = "# Commands\n\nWritten from the help of the program (`perilife COMMAND --help`). Options of all commands: `-v` (more), `-q` (less), \
                    `--json` (one object on stdout), `--units si|us`. Files may be `-`: stdin or stdout.\n"
        .to_owned();
    let mut command = CommandLine::command();
    command.build();
    sections("perilife", &command, &mut text);
    hold(&[("src/guide/commands.md", &text)]);
}

/// Examples: name and question, the first sentence of the file.
fn examples() -> Vec<(String, String)> {
    let files = fs::read_dir("data/cases").unwrap().map(|entry| entry.unwrap().path());
    let mut examples: Vec<_> = files
        .filter(|path| path.extension().is_some_and(|end| end == "toml"))
        .map(|path| {
            let text = fs::read_to_string(&path).unwrap();
            let (question, _) = text.lines().next().unwrap().trim_start_matches("# ").split_once('?').unwrap_or_else(|| {
                panic!("{}: line 1 is a question", path.display());
            });
            (path.file_stem().unwrap().to_str().unwrap().to_owned(), format!("{question}?"))
        })
        .collect();
    examples.sort();
    examples
}

#[test]
fn the_gallery_asks_the_question_of_every_example() {
    let gallery = fs::read_to_string(GALLERY).unwrap();
    let rows: Vec<&str> = gallery.lines().filter(|line| line.starts_with("| `")).collect();
    let wanted = examples();
    assert_eq!(rows.len(), wanted.len());
    for (row, (name, question)) in rows.iter().zip(&wanted) {
        assert!(row.starts_with(&format!("| `{name}` | {question} | ")), "{row} asks {question:?}");
    }
}

/// Answers and seconds of the gallery; with PERILIFE_REFRESH it is written.
#[test]
#[ignore = "long: all examples by the program"]
fn the_gallery_gives_the_answer_of_today() {
    let dir = folder();
    let gallery = fs::read_to_string(GALLERY).unwrap();
    let (head, _) = gallery.split_once("| `").unwrap();
    let mut today = head.to_owned();
    for (name, question) in examples() {
        let output = perilife(dir.path(), &["predict", &format!("data/cases/{name}.toml"), "--out", &name]);
        let (printed, _) = texts(&output);
        let result = fs::read_to_string(dir.path().join(&name).join("result.json")).unwrap();
        let result: Value = serde_json::from_str(&result).unwrap();
        let said = printed.lines().next().and_then(|line| line.strip_prefix(&format!("{name}: "))).unwrap();
        let answer = format!("{said}, `{}`", result["stop_reason"].as_str().unwrap());
        assert!(refreshes() || gallery.contains(&format!("| `{name}` | {question} | {answer} | ")), "{name}: {answer}");
        writeln!(today, "| `{name}` | {question} | {answer} | {:.1} |", result["wall_s"].as_f64().unwrap()).unwrap();
    }
    if refreshes() {
        fs::write(GALLERY, today).unwrap();
    }
}
