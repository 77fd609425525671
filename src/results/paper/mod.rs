//! The report of a run or a fit, to be printed and signed: one self-contained HTML file.
//!
//! Its source is the results folder; pictures are drawn again at the size of the page.

mod answers;
mod fit;
mod folder;
mod prediction;

use std::path::Path;

use serde_json::Value;
use toml::Table;

use super::chart::Size;
use super::format::{self, Format};
use super::output::{OutputFile, Sort};
use super::specimen_picture::sketch::escaped;
pub use folder::{Drawings, Source, curve, read};
use perilife_base::error::Result;
use perilife_base::input::{Document, Folder, Opened, Sections};
use perilife_base::keys::{Section, key, section};
use perilife_base::units::shown::told;

/// Mark at the head of a report by which a later one may replace it.
pub const SIGN: &str = "<meta name=\"generator\" content=\"perilife report\">";
const STYLE: &str = include_str!("paper.css");
const PRINT: Format = format::PRINT;
const CHART: Size = Size { width: 330.0, height: 215.0, text: 10.5 };

/// The report of a run or a fit, in the units that are shown.
pub fn html(source: &Source, signed: &Signed) -> String {
    let (title, body, version) = match source {
        Source::Run { run, tables, drawings } => prediction::body(run, tables, drawings, signed),
        Source::Lives { fit, plate, tables } => fit::of_lives(fit, plate.as_deref(), tables, signed),
        Source::Laws { fit, rates } => fit::of_laws(fit, rates, signed),
    };
    // The page footer is text within the style sheet: no character may end it.
    let number = signed.number_words().map_or_else(String::new, |number| number + ", ");
    let plain: String = (number + &title).chars().filter(|c| c.is_alphanumeric() || " ,.-_/".contains(*c)).take(110).collect();
    let style = STYLE.replace("FOOT", &format!("{plain}, perilife {version}"));
    let title = escaped(&title);
    let body = told(&body);
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n{SIGN}\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n<style>\n{style}</style>\n</head>\n\
         <body>\n<main>\n{body}</main>\n</body>\n</html>\n"
    )
}

/// Writes the report of a results folder; returns its size in bytes and whether it went into a file.
/// Errors: a folder without a whole run or fit; another file at `out`.
pub fn write(folder: &Path, out: &Path, signed: &Signed) -> Result<(usize, bool)> {
    let opened = Opened::default();
    let source = read(folder, &opened)?;
    let file = OutputFile::claim(out, Sort { option: "--out", sign: SIGN.as_bytes() }, &opened.so_far())?;
    let is_file = file.is_file();
    let page = html(&source, signed);
    file.write(page.as_bytes())?;
    Ok((page.len(), is_file))
}

fn known(value: Option<f64>, words: impl FnOnce(f64) -> String) -> String {
    value.map_or_else(|| "–".to_owned(), words)
}

fn recorded(text: Option<&str>) -> String {
    match text.map(str::trim).filter(|text| !text.is_empty()) {
        Some(text) => quoted(text),
        None => "<span class=\"blank\">not recorded</span>".to_owned(),
    }
}

fn quoted(text: &str) -> String {
    escaped(text).replace('"', "&quot;")
}

/// Text as markup, with the subscripts of its symbols.
fn prose(text: &str) -> String {
    const INDICES: [(&str, &str); 6] = [
        ("K_max", "K<sub>max</sub>"),
        ("P_max", "P<sub>max</sub>"),
        ("σ_YS", "σ<sub>YS</sub>"),
        ("σ_Y ", "σ<sub>Y</sub> "),
        ("K_c ", "K<sub>c</sub> "),
        ("K_II", "K<sub>II</sub>"),
    ];
    INDICES.iter().fold(quoted(text), |text, (plain, lowered)| text.replace(plain, lowered))
}

/// Head of the report.
fn letter(signed: &Signed, finished: Option<&str>) -> String {
    let laboratory = recorded(signed.laboratory.as_deref());
    let rows = [
        ("Report No.", Some(recorded(signed.number_words().as_deref()))),
        ("Customer", Some(recorded(signed.customer.as_deref()))),
        ("Project", signed.project.as_deref().map(quoted)),
        ("Reason for revision", signed.revision_reason.as_deref().map(quoted)),
        ("Date of issue", Some(recorded(signed.date.as_deref()))),
        ("Analyzed", finished.map(quoted)),
    ];
    let row = |(name, value): (&str, Option<String>)| Some(format!("<dt>{name}</dt><dd>{}</dd>", value?));
    let rows: String = rows.into_iter().filter_map(row).collect();
    format!("<header><div><p class=\"lab\">{laboratory}</p><p class=\"quiet\">Laboratory</p></div><dl>{rows}</dl></header>\n")
}

/// Three lines to sign on. No style sheet gives the number of pages to the text: it is written by hand, as signatures are.
fn signatures(signed: &Signed, first: &str) -> String {
    let line = |(what, who): (&str, &Option<String>)| {
        format!("<div><span></span>{what}, date: {}</div>", who.as_deref().map_or_else(String::new, quoted))
    };
    let lines = [(first, &signed.operator), ("Reviewed by", &signed.reviewer), ("Approved by", &signed.approver)].map(line);
    format!(
        "<div class=\"sign\">{}</div>\n<p class=\"small\">Number of pages: <span class=\"fill\"></span> (numbered in the footer). \
         Results apply only to the items described.</p>\n",
        lines.concat()
    )
}

/// Statement on the program: version and where its validation is documented.
fn software(version: &str, commit: Option<&str>) -> String {
    let commit =
        commit.map_or_else(String::new, |commit| format!(", commit {}", quoted(&commit.chars().take(12).collect::<String>())));
    format!(
        "<p class=\"small quiet\">Software: perilife {}{commit}. Validation against published tests: tests/VALIDATION.md of this version \
         (perilife validate); verification: tests/ACCURACY.md (perilife verify). Units: mm, MPa, MPa√m, mm/cycle. Inputs (SHA-256):</p>\n",
        recorded(Some(version))
    )
}

/// Head of a column of a table, and the class of its cells.
type Column = (&'static str, &'static str);

const fn text(head: &'static str) -> Column {
    (head, "")
}

/// Numbers are right-aligned.
const fn number(head: &'static str) -> Column {
    (head, " class=\"n\"")
}

/// A table; cells are markup.
fn table(class: &str, head: &[Column], rows: impl Iterator<Item = Vec<String>>) -> String {
    let names: String = head.iter().map(|(name, class)| format!("<th{class}>{name}</th>")).collect();
    let row = |cells: Vec<String>| {
        let cells = head.iter().zip(cells).map(|((_, class), cell)| format!("<td{class}>{cell}</td>"));
        format!("<tr>{}</tr>\n", cells.collect::<String>())
    };
    let rows: String = rows.map(row).collect();
    format!(
        "<div class=\"scroll\" tabindex=\"0\"><table class=\"{class}\"><thead><tr>{names}</tr></thead><tbody>\n{rows}</tbody></table></div>\n"
    )
}

/// Cards side by side: title, answer, explanation; all are markup but the title.
fn cards(class: &str, all: [(&str, String, String); 3]) -> String {
    let card = |(title, big, below): (&str, String, String)| {
        format!("<div><h2>{title}</h2><p class=\"big\">{big}</p><p>{below}</p></div>")
    };
    format!("<div class=\"answer {class}\">{}</div>\n", all.map(card).concat())
}

/// Rows of names and values; values are markup.
fn terms(rows: &[(&str, String)]) -> String {
    let row = |(name, value): &(&str, String)| format!("<dt>{name}</dt><dd>{value}</dd>");
    format!("<dl class=\"terms\">{}</dl>\n", rows.iter().map(row).collect::<String>())
}

fn title(words: &str) -> String {
    format!("<h1 class=\"sheet\">{words}</h1>\n")
}

/// A picture; the style sheet numbers it.
fn figure(svg: &str, caption: &str, class: &str) -> String {
    // Within HTML an SVG needs no namespace.
    let svg = svg.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
    format!("<figure class=\"{class}\">{svg}<figcaption>{caption}</figcaption></figure>\n")
}

/// A picture of the results folder at the width of the sheet; empty if the run has none.
fn picture(drawings: &Drawings, name: &str, caption: &str) -> String {
    drawings.get(name).map_or_else(String::new, |svg| figure(svg, caption, "wide"))
}

fn mark(holds: Option<bool>) -> String {
    let (class, word, drawing) = match holds {
        Some(true) => ("ok", "Passed", "<circle cx=\"9\" cy=\"9\" r=\"8\"/><path d=\"M5.2 9.2l2.6 2.7 5-5.6\"/>"),
        None => ("note", "Caution", "<path d=\"M9 1.6L17 16H1z\"/><path d=\"M9 6.5v4.4M9 12.6v1.6\"/>"),
        Some(false) => {
            ("bad", "Failed", "<path d=\"M5.8 1h6.4L17 5.8v6.4L12.2 17H5.8L1 12.2V5.8z\"/><path d=\"M6 6l6 6m0-6l-6 6\"/>")
        }
    };
    format!(
        "<svg class=\"mark {class}\" viewBox=\"0 0 18 18\" aria-hidden=\"true\" fill=\"none\" stroke=\"currentColor\" stroke-width=\"1.6\">\
         {drawing}</svg><span class=\"vh\">{word}</span>"
    )
}

fn hashes<'f>(files: impl Iterator<Item = (&'f str, &'f str)>, most: usize) -> String {
    let line = |(name, hash): (&str, &str)| {
        let name = Path::new(name).file_name().map_or(name.into(), |last| last.to_string_lossy());
        format!("{} SHA-256 {}", quoted(&name), quoted(hash))
    };
    let mut lines: Vec<String> = files.map(line).collect();
    let more = lines.len().saturating_sub(most);
    lines.truncate(most);
    if more > 0 {
        lines.push(format!("{more} more files in the folder"));
    }
    if lines.is_empty() {
        lines.push(recorded(None));
    }
    format!("<p class=\"hashes\">{}</p>\n", lines.join("<br>"))
}

const SECTION: &str = "report";

perilife_base::keys! {
    /// Section `[report]` of a file of report data; `None` is printed as "not recorded".
    #[derive(Debug, Clone, Default)]
    pub struct Signed {
        laboratory: Option<String> = key("laboratory", "Laboratory: name, address, accreditation");
        customer: Option<String> = key("customer", "Customer: name, contact");
        project: Option<String> = key("project", "Project");
        number: Option<String> = key("number", "Report number");
        revision: Option<String> = key("revision", "Revision");
        revision_reason: Option<String> = key("revision_reason", "Reason for the revision");
        date: Option<String> = key("date", "Date of issue");
        operator: Option<String> = key("operator", "Operator: tested or prepared by");
        reviewer: Option<String> = key("reviewer", "Reviewer");
        approver: Option<String> = key("approver", "Approver");
        product_form: Option<String> = key("product_form", "Product form and heat treatment");
        orientation: Option<String> = key("orientation", "Crack plane orientation: L-T, T-L, ...; location in the product");
        notch: Option<String> = key("notch", "Notch: form, preparation");
        precracking: Option<String> = key("precracking", "Precracking: final ΔK, R and crack size");
        machine: Option<String> = key("machine", "Test machine, load cell");
        waveform: Option<String> = key("waveform", "Waveform and frequency");
        environment: Option<String> = key("environment", "Environment: medium, temperature, humidity");
        crack_measurement: Option<String> = key("crack_measurement", "Crack size measurement: method, equipment");
        crack_resolution: Option<String> = key("crack_resolution", "Resolution of crack size");
        interruptions: Option<String> = key("interruptions", "Interruptions: occurrences that could affect the data");
    }
}

impl Signed {
    /// Reads section `[report]` of a TOML file; `set` are overrides `report.KEY=VALUE`.
    /// Errors: a file that cannot be read; an unknown key; a value that is not text.
    pub fn read(file: Option<&Path>, set: &[String]) -> Result<Self> {
        let document = match file {
            Some(path) => Document::read(path, set)?,
            None => Document::parse("", SECTION, Folder::none(), set)?,
        };
        let read = || section(Sections::of(&document.table, &[SECTION], &[])?.optional(SECTION), SECTION);
        read().map_err(|error| document.locate(error))
    }

    /// From the keys of section `[report]`.
    /// Errors: an unknown key; a value that is not text.
    pub fn of(keys: Table) -> Result<Self> {
        section(&keys.into(), SECTION)
    }

    pub(super) fn number_words(&self) -> Option<String> {
        let revision = self.revision.as_ref().map_or_else(String::new, |revision| format!(", revision {revision}"));
        Some(format!("{}{revision}", self.number.as_ref()?))
    }

    /// The test conditions that ASTM E647 asks for, with the labels of their keys; else what the files of readings note of them.
    pub(super) fn conditions(&self, noted: &Value) -> impl Iterator<Item = (&'static str, String)> {
        macro_rules! of {
            ($($key:ident),+) => { [$((stringify!($key), self.$key.as_deref())),+] };
        }
        let first = of!(product_form, orientation, notch, precracking, machine, waveform, environment);
        let all = first.into_iter().chain(of!(crack_measurement, crack_resolution, interruptions));
        let label = |name| Self::KEYS.iter().find(|key| key.name == name).map_or(name, |key| key.label_and_hint().0);
        let noted = move |name: &str| noted[name].as_str().map(|value| format!("{} (noted in the test file)", quoted(value)));
        all.map(move |(name, value)| (label(name), noted(name).filter(|_| value.is_none()).unwrap_or_else(|| recorded(value))))
    }
}
