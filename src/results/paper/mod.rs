//! A report that a laboratory signs: one HTML file with all that it shows, for paper and screens, of a run or a fit.
//!
//! It is made of what stands in the folder: `result.json` with `a_n.csv` and `crack_path.csv`, or `fit.json` with its tables. The pictures
//! are those of the folder, drawn anew for the size of the page.

mod answers;
mod drawings;
mod fit;
mod folder;
mod part_through;
mod prediction;
mod spectrum;

pub use drawings::Drawings;
pub use folder::{Source, read};

use std::path::Path;

use super::chart::Size;
use super::format::{self, Format};
use super::output::{OutputFile, Sort};
use super::specimen_picture::sketch::escaped;
use perilife_base::error::Result;
use perilife_base::input::Opened;
use perilife_base::units::shown::told;

/// What stands near the beginning of a report, and of no other file.
pub const SIGN: &str = "<meta name=\"generator\" content=\"perilife report\">";
const STYLE: &str = include_str!("paper.css");
/// Numbers of a report.
const PRINT: Format = format::PRINT;
/// Size of a chart in a report, px.
const CHART: Size = Size { width: 330.0, height: 215.0, text: 10.5 };

/// Who made the test or the computation, and when; `None` is printed as "not recorded".
#[derive(Debug, Clone, Default)]
pub struct Signed {
    pub laboratory: Option<String>,
    pub operator: Option<String>,
    pub reviewer: Option<String>,
    pub date: Option<String>,
}

/// The report of a run or a fit, in the units that are shown.
pub fn html(source: &Source, signed: &Signed) -> String {
    let (title, body, version) = match source {
        Source::Run { run, tables, drawings } => prediction::body(run, tables, drawings, signed),
        Source::Lives { fit, plate, tables } => fit::of_lives(fit, plate.as_ref(), tables, signed),
        Source::Laws { fit, rates } => fit::of_laws(fit, rates, signed),
    };
    // The foot of a page stands in the style sheet: nothing there may end its text.
    let plain: String = title.chars().filter(|c| c.is_alphanumeric() || " ,.-_".contains(*c)).take(90).collect();
    let style = STYLE.replace("FOOT", &format!("perilife {version}, {plain}"));
    let title = escaped(&title);
    let body = told(&body);
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n{SIGN}\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n<style>\n{style}</style>\n</head>\n\
         <body>\n<main>\n{body}</main>\n</body>\n</html>\n"
    )
}

/// Writes the report of what stands in `folder`; gives its bytes, and whether it went into a file.
/// Errors: a folder without a whole run or fit; a file in the way.
pub fn write(folder: &Path, out: &Path, signed: &Signed) -> Result<(usize, bool)> {
    let opened = Opened::default();
    let source = read(folder, &opened)?;
    let file = OutputFile::claim(out, Sort { option: "--out", sign: SIGN.as_bytes() }, &opened.so_far())?;
    let is_file = file.is_file();
    let page = html(&source, signed);
    file.write(page.as_bytes())?;
    Ok((page.len(), is_file))
}

/// The commit of the program, where it is known.
fn commit_words(commit: Option<&str>) -> String {
    commit.map_or_else(String::new, |commit| format!(", commit {}", quoted(&commit.chars().take(12).collect::<String>())))
}

/// What is known, in words, else a dash.
fn known(value: Option<f64>, words: impl FnOnce(f64) -> String) -> String {
    value.map_or_else(|| "–".to_owned(), words)
}

/// Text, or that nobody has recorded it.
fn recorded(text: Option<&str>) -> String {
    match text.map(str::trim).filter(|text| !text.is_empty()) {
        Some(text) => quoted(text),
        None => "<span class=\"blank\">not recorded</span>".to_owned(),
    }
}

/// Text as markup takes it, also between quotes.
fn quoted(text: &str) -> String {
    escaped(text).replace('"', "&quot;")
}

/// Text with the indices of its symbols lowered, as markup.
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

/// Laboratory, name of the report, dates.
fn letter(signed: &Signed, name: &str, finished: Option<&str>) -> String {
    let [laboratory, date, finished] = [signed.laboratory.as_deref(), signed.date.as_deref(), finished].map(recorded);
    format!(
        "<header><div><p class=\"lab\">{laboratory}</p><p class=\"quiet\">Laboratory or office</p></div>\
         <dl><dt>Report of</dt><dd>{}</dd><dt>Date</dt><dd>{date}</dd><dt>Computed</dt><dd>{finished}</dd></dl></header>\n",
        quoted(name)
    )
}

/// Three lines to sign on.
fn signatures(signed: &Signed, first: &str) -> String {
    let line = |what: &str, who: Option<&str>| format!("<div><span></span>{what}, date: {}</div>", recorded(who));
    let [operator, reviewer] = [signed.operator.as_deref(), signed.reviewer.as_deref()];
    format!(
        "<div class=\"sign\">{}{}<div><span></span>Approved by, date</div></div>\n",
        line(first, operator),
        line("Checked by", reviewer)
    )
}

/// Rows of names and values; values are markup.
fn terms(rows: &[(&str, String)]) -> String {
    let row = |(name, value): &(&str, String)| format!("<dt>{name}</dt><dd>{value}</dd>");
    format!("<dl class=\"terms\">{}</dl>\n", rows.iter().map(row).collect::<String>())
}

fn figure(svg: &str, caption: &str, class: &str) -> String {
    // Within HTML a drawing needs no name of its language.
    let svg = svg.replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
    format!("<figure class=\"{class}\">{svg}<figcaption>{caption}</figcaption></figure>\n")
}

/// Pictures on the sheets behind the first, numbered on.
struct Sheets<'d> {
    drawings: &'d Drawings,
    /// Number of the last figure.
    last: usize,
    has_begun: bool,
}

impl Sheets<'_> {
    /// Behind the first sheet.
    fn begin(drawings: &Drawings, last: usize) -> Sheets<'_> {
        Sheets { drawings, last, has_begun: false }
    }

    /// Title of a section; the first one begins a sheet.
    fn title(&mut self, words: &str) -> String {
        let class = if self.has_begun { "sheet" } else { "sheet paged" };
        self.has_begun = true;
        format!("<h1 class=\"{class}\">{words}</h1>\n")
    }

    /// A drawing of the folder as wide as the sheet; nothing where the run has none.
    fn picture(&mut self, name: &str, caption: &str) -> String {
        let drawings = self.drawings;
        drawings.get(name).map_or_else(String::new, |svg| self.figure(svg, caption))
    }

    /// A drawing with its number.
    fn figure(&mut self, svg: &str, caption: &str) -> String {
        self.last += 1;
        figure(svg, &format!("Figure {}. {caption}.", self.last), "wide")
    }
}

/// A sign with its word for those who do not see it.
fn mark(holds: Option<bool>) -> String {
    let (class, word, drawing) = match holds {
        Some(true) => ("ok", "Holds", "<circle cx=\"9\" cy=\"9\" r=\"8\"/><path d=\"M5.2 9.2l2.6 2.7 5-5.6\"/>"),
        None => ("note", "Remark", "<path d=\"M9 1.6L17 16H1z\"/><path d=\"M9 6.5v4.4M9 12.6v1.6\"/>"),
        Some(false) => {
            ("bad", "Does not hold", "<path d=\"M5.8 1h6.4L17 5.8v6.4L12.2 17H5.8L1 12.2V5.8z\"/><path d=\"M6 6l6 6m0-6l-6 6\"/>")
        }
    };
    format!(
        "<svg class=\"mark {class}\" viewBox=\"0 0 18 18\" aria-hidden=\"true\" fill=\"none\" stroke=\"currentColor\" stroke-width=\"1.6\">\
         {drawing}</svg><span class=\"vh\">{word}</span>"
    )
}

/// Files with their hashes, at most so many.
fn hashes<'f>(files: impl Iterator<Item = (&'f str, &'f str)>, most: usize) -> String {
    let line = |(name, hash): (&str, &str)| {
        let name = Path::new(name).file_name().map_or(name.into(), |last| last.to_string_lossy());
        format!("{} SHA-256 {}", quoted(&name), quoted(hash))
    };
    let mut lines: Vec<String> = files.map(line).collect();
    let more = lines.len().saturating_sub(most);
    lines.truncate(most);
    if more > 0 {
        lines.push(format!("and {more} more in the folder"));
    }
    if lines.is_empty() {
        lines.push(recorded(None));
    }
    format!("<p class=\"hashes\">{}</p>\n", lines.join("<br>"))
}
