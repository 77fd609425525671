//! What the lines above the table of a laboratory's file say of its test; what is not certain is not said.

use std::collections::HashSet;

use perilife_base::table::units::{LengthUnit, Unit};
use perilife_base::table::words::words;
use perilife_base::units::{MM, round_off};
use perilife_measured::{Survey, said_above};
use perilife_plate::material::{growth_data, library};
use perilife_plate::specimen::SpecimenKind;
use serde::Serialize;

/// What the lines above a table say of the test; null where they do not say it, or not certainly.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Preamble {
    /// Kind of specimen, as `specimen.kind`.
    pub kind: Option<&'static str>,
    pub width_mm: Option<f64>,
    pub thickness_mm: Option<f64>,
    pub stress_ratio: Option<f64>,
    pub material: Option<StatedMaterial>,
}

/// A material as a file states it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct StatedMaterial {
    /// Its words.
    pub stated: String,
    /// Name in the library; null where the library does not have it, or several.
    pub name: Option<String>,
    /// Orientation in the file that no record of this alloy is of.
    pub orientation: Option<String>,
}

/// Lines, and letters of one, in which a test is described.
const LINES_MAX: usize = 60;
const LINE_MAX: usize = 500;
const WIDTH: [&str; 5] = ["specimen width", "width", "breite", "probenbreite", "w"];
const THICKNESS: [&str; 5] = ["specimen thickness", "thickness", "dicke", "probendicke", "b"];
const RATIO: [&str; 7] = ["stress ratio", "load ratio", "force ratio", "r-ratio", "r ratio", "spannungsverhältnis", "r"];
const MATERIAL: [&str; 8] = [
    "specimen material", "base material", "material", "alloy", "werkstoffnummer", "werkstoffbezeichnung", "werkstoff",
    "legierung",
];
/// Kinds whose names are words of any report.
const OF_ANY: [SpecimenKind; 4] =
    [SpecimenKind::Plate, SpecimenKind::SurfaceCrack, SpecimenKind::CornerCrack, SpecimenKind::EmbeddedCrack];

impl Preamble {
    pub fn of(found: &Survey) -> Preamble {
        let is_short = |line: &&Vec<String>| line.iter().map(String::len).sum::<usize>() <= LINE_MAX;
        let above = found.above.iter().take(LINES_MAX).filter(is_short);
        let lines: Vec<Vec<String>> = above.map(|line| line.iter().flat_map(|field| cut(field)).collect()).collect();
        let one = |labels: &[&str], is_length| {
            let mut values = said_above(&lines, labels).into_iter().filter_map(|value| number(&value, labels, is_length));
            let first = values.next()?;
            values.all(|value| value == first).then_some(first)
        };
        Preamble {
            kind: kind_in(&lines.concat().join(" ; ")),
            width_mm: one(&WIDTH, true),
            thickness_mm: one(&THICKNESS, true),
            stress_ratio: one(&RATIO, false),
            material: material_in(&lines, found.measured.curves.first().and_then(|curve| curve.source.noted[0].as_deref())),
        }
    }
}

/// A field cut where another quantity begins: `W = 50 mm B = 5 mm`; not in `notch width W = 1 mm`.
fn cut(field: &str) -> Vec<String> {
    const BEFORE: [&str; 8] = ["specimen", "panel", "sheet", "test", "amplitude", "loading", "at", "probe"];
    let mut parts = vec![String::new()];
    for word in field.replace(" =", "=").replace(" :", ":").split_whitespace() {
        let own = parts.last().map_or("", |part| part.trim_end());
        let is_done = has_digit(own) || own.ends_with([':', ')']) || BEFORE.iter().any(|word| own.to_lowercase().ends_with(word));
        if is_done && word.contains(['=', ':']) {
            parts.push(String::new());
        }
        parts.last_mut().into_iter().for_each(|part| *part += &format!("{word} "));
    }
    parts.iter().map(|part| part.trim_end().to_owned()).collect()
}

fn has_digit(text: &str) -> bool {
    text.contains(|c: char| c.is_ascii_digit())
}

/// The one number of a value, as a length in mm by its unit, or without any; `None` with a comma that may be one between thousands.
fn number(value: &str, labels: &[&str], is_length: bool) -> Option<f64> {
    let mut numbers = value.split(|c: char| !c.is_ascii_digit() && !"+-.,".contains(c)).filter(|part| has_digit(part));
    let own = numbers.next().filter(|_| numbers.next().is_none())?;
    let digits = own.split_once(',').map_or(0, |(_, behind)| behind.bytes().take_while(u8::is_ascii_digit).count());
    let number: f64 = own.replace(',', ".").parse().ok().filter(|_| digits != 3)?;
    let is_label = |word: &str| labels.iter().any(|label| label.eq_ignore_ascii_case(word));
    let parts = |text: &str| words(text).0.into_iter().filter(|word| !is_label(word)).collect::<Vec<_>>();
    let [before, behind] = value.split_once(own).map(|(before, behind)| [parts(before), parts(behind)])?;
    if !is_length {
        return (number < 1.0 && before.is_empty() && behind.is_empty()).then_some(number);
    }
    let unit = if before.is_empty() { behind.get(..1)? } else { &before };
    let unit = Unit::spelled(unit, Unit::Length(LengthUnit::Millimetre))?;
    Some(round_off(number * unit.si() / MM)).filter(|length| *length > 0.0)
}

/// The kind of specimen whose designation or name a text has; `None` where there are several.
fn kind_in(text: &str) -> Option<&'static str> {
    let in_words = |kind: SpecimenKind| kind.name().replace('_', " ");
    let named = named_in(text, SpecimenKind::all().map(in_words).collect());
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let is_word = |word: &str| {
        let around: Vec<&str> = text.split(word).collect();
        around.windows(2).any(|pair| !pair[0].ends_with(is_part) && !pair[1].starts_with(is_part))
    };
    let is_said = |kind: &SpecimenKind| {
        let own = kind.meaning().split([' ', ',', ';']).find_map(|word| word.strip_suffix(')')?.split_once('('));
        let is_designated = |(head, load)| ["(", " (", "-", ""].iter().any(|sign| is_word(&format!("{head}{sign}{load}")));
        own.is_some_and(is_designated) || !OF_ANY.contains(kind) && named.contains(&in_words(*kind))
    };
    let mut said = SpecimenKind::all().filter(is_said);
    said.next().filter(|_| said.next().is_none()).map(SpecimenKind::name)
}

/// The material that is stated, or else of which an alloy is named.
fn material_in(lines: &[Vec<String>], orientation: Option<&str>) -> Option<StatedMaterial> {
    // Without its family: 2024-T3, Ti-6Al-4V.
    let alloy_of = |title: &str| -> String {
        let alloy = title.split(',').next().unwrap_or_default();
        alloy.split(' ').skip_while(|word| has_digit(alloy) && !has_digit(word)).collect::<Vec<_>>().join(" ")
    };
    // `Material name: ...`, but not `Material properties: ...`; without a sign between them a designation.
    let value = |value: String| match value.split_once([':', '=']) {
        Some((head, own)) => {
            ["name", "grade", "spec", "specification", "no", "no."].contains(&head.trim()).then(|| own.trim().to_owned())
        }
        None => {
            let ends = |field: &String| {
                field.strip_suffix(&value).is_some_and(|label| label.is_empty() || label.trim_end().ends_with([':', '=']))
            };
            (value.split(' ').next().is_some_and(has_digit) || lines.iter().flatten().any(ends)).then_some(value)
        }
    };
    let mut stated: Vec<String> = said_above(lines, &MATERIAL).into_iter().filter_map(value).collect();
    stated.dedup();
    let library = library::titles();
    let exact = library.iter().find(|(name, _)| stated.len() == 1 && name.eq_ignore_ascii_case(&stated[0]));
    // A number alone is an alloy only where it is stated as one.
    let alloys = library.iter().map(|(_, title)| alloy_of(title)).filter(|alloy| !stated.is_empty() || alloy.contains('-'));
    let text = if stated.is_empty() { lines.concat().join(" ; ") } else { stated.join(" ; ") };
    let named = exact.map_or_else(|| named_in(&text, alloys.collect()), |(_, title)| vec![alloy_of(title)]);
    let stated = Some(if stated.is_empty() { &named } else { &stated }.join(", ")).filter(|stated| !stated.is_empty())?;
    // Records of this orientation before files, which are of none, and these before other records.
    let rank = |name: &str, title: &str| match orientation.is_some_and(|own| title.contains(own)) {
        true => 0,
        false => 1 + usize::from(growth_data::record(name).is_some()),
    };
    let ranked = || library.iter().filter(|(_, title)| named == [alloy_of(title)]).map(|own| (rank(&own.0, &own.1), own));
    let best = ranked().map(|(rank, _)| rank).min();
    let mut fitting = ranked().filter(|(rank, _)| Some(*rank) == best).map(|(_, own)| own);
    let name = exact.or_else(|| fitting.next().filter(|_| fitting.next().is_none())).map(|(name, _)| name.clone());
    let orientation = orientation.filter(|_| best.is_some_and(|best| best > 0)).map(str::to_owned);
    Some(StatedMaterial { stated, name, orientation })
}

/// Names that are words of a text, however their parts are set apart, without those in a longer one: EN AW-2024 T3 is 2024-T3, 2024-T351 is not.
fn named_in(text: &str, mut names: Vec<String>) -> Vec<String> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let of_family =
        |own: String| ["en", "aw", "aa", "al"].iter().fold(own, |own, sign| own.strip_prefix(sign).unwrap_or(&own).to_owned());
    let said = (1..=6).flat_map(|count| words.windows(count)).map(|words| plain(&words.join(" ")));
    let said: HashSet<String> = said.flat_map(|own| [own.clone(), of_family(own)]).collect();
    names.retain(|name| said.contains(&plain(name)));
    names.sort();
    names.dedup();
    let is_part = |name: &str| names.iter().any(|other| other != name && format!(" {other} ").contains(&format!(" {name} ")));
    names.iter().filter(|name| !is_part(name)).cloned().collect()
}

/// Lower-case letters, digits and points; of what is between, a sign between digits.
fn plain(text: &str) -> String {
    let mut plain = String::new();
    for part in text.to_lowercase().split(|c: char| !c.is_alphanumeric() && !".;".contains(c)) {
        let is_apart = plain.ends_with(|c: char| c.is_ascii_digit()) && part.starts_with(|c: char| c.is_ascii_digit());
        plain += &format!("{}{part}", if is_apart { "-" } else { "" });
    }
    plain.trim_end_matches('.').to_owned()
}
