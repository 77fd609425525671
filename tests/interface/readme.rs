//! What the README shows is what the program prints and draws today: its commands are run as they stand there.

use std::fs;
use std::os::unix::fs::symlink;

use tempfile::tempdir;

use crate::interface::cli::{perilife, texts};

/// Pictures, and the files that the commands of the README write.
const PICTURES: [(&str, &str); 1] = [("slant_crack_plate.svg", "out/fit/slant_crack_plate/plate.svg")];
/// Pixels by which a place may differ: machines round differently.
const SLACK: f64 = 1.0;
/// Part by which a printed number may differ, beside one unit of its last digit.
const PART: f64 = 1e-3;

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

/// Commands of the README with the lines that it shows below each.
fn commands(readme: &str) -> Vec<(Vec<&str>, Vec<&str>)> {
    let shown =
        readme.split("```text\n").skip(1).filter_map(|block| block.split_once("\n```")).flat_map(|(block, _)| block.lines());
    let mut commands: Vec<(Vec<&str>, Vec<&str>)> = Vec::new();
    for line in shown {
        match (line.strip_prefix("$ cargo run -- "), commands.last_mut()) {
            (Some(command), _) => commands.push((command.split(' ').collect(), Vec::new())),
            (None, Some((_, lines))) => lines.push(line),
            (None, None) => panic!("{line:?} stands below no command"),
        }
    }
    commands
}

/// Without the seconds of this machine.
fn timeless(line: &str) -> &str {
    if line.ends_with(" s") { line.rsplit_once(", ").map_or(line, |(before, _)| before) } else { line }
}

#[test]
fn what_the_readme_shows_is_of_today() {
    let readme = fs::read_to_string("README.md").unwrap();
    let (dir, commands) = (tempdir().unwrap(), commands(&readme));
    assert!(commands.len() >= 2 && commands.iter().all(|(_, lines)| !lines.is_empty()), "{commands:?}");
    for folder in ["data", "calibration"] {
        symlink(fs::canonicalize(folder).unwrap(), dir.path().join(folder)).unwrap();
    }
    for (command, shown) in commands {
        let output = perilife(dir.path(), &command);
        assert_eq!(output.status.code(), Some(0), "{:?}", texts(&output));
        // Each channel in its own order.
        for (is_warning, printed) in [(false, output.stdout), (true, output.stderr)] {
            let printed = String::from_utf8(printed).unwrap();
            let shown =
                shown.iter().filter(|line| line.contains(" messages, largest: ") == is_warning).map(|line| timeless(line));
            let printed = printed.lines().map(timeless);
            assert_eq!(shown.clone().count(), printed.clone().count(), "{command:?} prints\n{:#?}", printed.collect::<Vec<_>>());
            for (shown, printed) in shown.zip(printed) {
                let ((words, numbers), (of_printed, printed_numbers)) = (taken_apart(shown), taken_apart(printed));
                assert_eq!(words, of_printed, "the README shows {shown:?}, printed is {printed:?}");
                assert_eq!(numbers.len(), printed_numbers.len(), "the README shows {shown:?}, printed is {printed:?}");
                for ([shown_number, unit], [number, _]) in numbers.into_iter().zip(printed_numbers) {
                    let slack = PART * shown_number.abs() + 1.01 * unit;
                    assert!((number - shown_number).abs() <= slack, "the README shows {shown:?}, printed is {printed:?}");
                }
            }
        }
    }
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
