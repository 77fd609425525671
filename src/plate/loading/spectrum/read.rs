//! A spectrum from its file: which format it has, what it says, and what of it is left out.

use std::borrow::Cow;
use std::path::Path;

use super::classes::{classes, kinds};
use super::content::{Content, RawCycle, SpectrumFormat};
use super::formats::{self, fault, rows};
use super::rainflow::rainflow;
use super::{Cycle, PERIOD_MOST, Spectrum, columns, is_whole};
use crate::loading::Input;
use perilife_base::error::{Result, fail_if, input, input_missing};
use perilife_base::input::Folder;
use perilife_base::keys::Plain;
use perilife_base::table::units::{LoadUnit, Unit};
use perilife_base::table::{decoded, is_workbook};

impl Spectrum {
    /// The spectrum that `[loading]` asks for, its file read from a folder.
    /// Errors: no file, or one that cannot be read, each by file, line and value; percentages beyond reason.
    pub(in crate::loading) fn read(input: &Input, folder: &Folder) -> Result<Spectrum> {
        let file = input.spectrum_file.as_deref().ok_or_else(|| {
            let remedy = "name a file with the columns max, min, cycles, one column of peaks and valleys, or .spx, .sub, FASTRAN";
            input_missing("loading.spectrum_file", "is missing (required by kind = \"spectrum\")", remedy)
        })?;
        let (omission, truncation) = (input.omission_percent / 100.0, input.truncation_percent / 100.0);
        let repeats = input.repeats;
        let scale = match (input.spectrum_scale_mpa, input.spectrum_scale_n) {
            (Some(Plain(scale)), _) => (Unit::Load(LoadUnit::Megapascal), scale),
            (None, scale) => (Unit::Load(LoadUnit::Newton), scale.map_or(1.0, |given| given.0)),
        };
        let (bytes, path) = (folder.read(file)?, folder.path(file));
        let read = || {
            let (format, content, mut notes) = content(&bytes, &path, input.spectrum_format, scale)?;
            let cycles = cycles_of(content, &mut notes)?;
            let sha256 = perilife_base::input::sha256(&bytes);
            let of_file = |note: String| if note.contains(file) { note } else { format!("spectrum: {file}: {note}") };
            Spectrum::of(cycles, [omission, truncation]).map(|spectrum| Spectrum {
                file: file.to_owned(),
                format,
                repeats,
                notes: notes.into_iter().map(of_file).collect(),
                sha256,
                ..spectrum
            })
        };
        read().map_err(|error| error.in_file(&path))
    }

    /// The spectrum of cycles of any unit: peaks cut at the share `truncation` of the largest, ranges below the share `omission` of the
    /// largest left out.
    /// Errors: no cycle whose maximum is above zero.
    pub fn of(cycles: Vec<Cycle>, [omission, truncation]: [f64; 2]) -> Result<Spectrum> {
        let most = cycles.iter().map(|cycle| cycle.max).fold(f64::NEG_INFINITY, f64::max);
        fail_if!(most <= 0.0, input("max", most, "contains no tensile load", "give tension as positive values"));
        let cut = most * truncation;
        let share = |cycle: Cycle| Cycle { max: cycle.max.min(cut) / cut, min: cycle.min / cut, ..cycle };
        // A cycle above the cut is gone with it.
        let mut left: Vec<Cycle> = cycles.into_iter().map(share).filter(|cycle| cycle.max > cycle.min).collect();
        let top = left.iter().map(|cycle| cycle.max).fold(0.0, f64::max);
        let problem = "omits every tensile cycle";
        fail_if!(top <= 0.0, input("loading.truncation_percent", 100.0 * truncation, problem, "change the level, or remove it"));
        // The largest may be gone with the cut.
        left.iter_mut().for_each(|cycle| (cycle.max, cycle.min) = (cycle.max / top, cycle.min / top));
        let cut = cut * top;
        let all: f64 = left.iter().map(|cycle| cycle.count).sum();
        let least = omission * left.iter().map(Cycle::range).fold(0.0, f64::max);
        left.retain(|cycle| cycle.range() >= least);
        let per_pass = left.iter().map(|cycle| cycle.count).sum();
        let kinds = kinds(&left);
        let ratios = left.iter().filter_map(Cycle::ratio);
        let ratios = ratios.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], ratio| [low.min(ratio), high.max(ratio)]);
        Ok(Spectrum {
            file: String::new(),
            format: SpectrumFormat::Cycles,
            period: period(&left),
            cycles: left,
            per_pass,
            omitted: all - per_pass,
            largest: [most, cut],
            repeats: None,
            ratios,
            classes: classes(&kinds, per_pass),
            kinds: kinds.len(),
            notes: Vec::new(),
            sha256: String::new(),
        })
    }
}

fn period(cycles: &[Cycle]) -> f64 {
    let mut fractions: Vec<f64> = cycles.iter().map(|cycle| cycle.count).filter(|count| count.fract() != 0.0).collect();
    fractions.sort_by(f64::total_cmp);
    fractions.dedup();
    let period = (1..PERIOD_MOST).find(|passes| fractions.iter().all(|count| is_whole(*count, *passes as f64)));
    period.unwrap_or(PERIOD_MOST) as f64
}

/// Format and content of a file, with what is to be said of them; the format by its key, the end of the name, or what the first lines hold.
fn content(
    bytes: &[u8],
    file: &Path,
    asked: Option<SpectrumFormat>,
    scale: (Unit, f64),
) -> Result<(SpectrumFormat, Content, Vec<String>)> {
    if is_workbook(bytes, file) {
        return columns::read(bytes, file, asked, scale);
    }
    let text = decoded(bytes, file)?;
    let ending = file.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    let mut lines = rows(&text).map(|(_, line)| line);
    let (first, second) = (lines.next().unwrap_or_default(), lines.next().unwrap_or_default());
    let format = asked.or(match ending.as_str() {
        "spx" => Some(SpectrumFormat::Spx),
        "sub" => Some(SpectrumFormat::Sub),
        _ if first.starts_with('<') => Some(SpectrumFormat::Spx),
        _ if formats::is_fastran(first, second) => Some(SpectrumFormat::Fastran),
        _ => None,
    });
    let content = match format {
        Some(SpectrumFormat::Spx) => formats::spx(&text)?,
        Some(SpectrumFormat::Sub) => formats::sub(rows(&text))?,
        Some(SpectrumFormat::Fastran) => formats::fastran(rows(&text))?,
        Some(SpectrumFormat::Cycles | SpectrumFormat::TurningPoints) | None => {
            return columns::read(without_remarks(&text).as_bytes(), file, format, scale);
        }
    };
    Ok((format.unwrap_or(SpectrumFormat::Cycles), content, Vec::new()))
}

/// The text without remarks behind numbers; lines of nothing but a remark stay, since one may be the header.
fn without_remarks(text: &str) -> Cow<'_, str> {
    let is_numbers = |text: &str| text.trim_start().starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    let has_remark = |line: &str| line.contains('#') && is_numbers(line);
    if !text.lines().any(has_remark) {
        return Cow::Borrowed(text);
    }
    let kept = text.lines().map(|line| if has_remark(line) { line.split('#').next().unwrap_or_default() } else { line });
    Cow::Owned(kept.collect::<Vec<_>>().join("\n"))
}

/// The cycles of a file, rows in which nothing changes left out, which a note says.
/// Errors: none at all, a minimum above its maximum, a number of cycles that is none.
fn cycles_of(content: Content, notes: &mut Vec<String>) -> Result<Vec<Cycle>> {
    let raw = match content {
        Content::Points(points) => return of_points(&points),
        Content::Cycles(raw) => raw,
    };
    let mut cycles = Vec::with_capacity(raw.len());
    let mut passed_over: Vec<usize> = Vec::new();
    for RawCycle { line, max, min, count } in raw {
        let remedy = "give the maximum first; for peaks and valleys in time order set spectrum_format = \"turning_points\"";
        fail_if!(min > max, fault(Some(line), "min", &min.to_string(), &format!("is above the maximum {max}"), remedy));
        fail_if!(
            !(0.0..=1e15).contains(&count),
            fault(Some(line), "cycles", &count.to_string(), "is not a number of cycles", "give a number of 0 or more",)
        );
        if min == max || count == 0.0 {
            passed_over.push(line);
        } else {
            cycles.push(Cycle { max, min, count });
        }
    }
    let problem = "contains no cycles: no row has a range and a count above 0";
    fail_if!(cycles.is_empty(), input_missing("spectrum", problem, "give at least one row max, min, cycles with a range"));
    if let Some(first) = passed_over.first() {
        let rows = if passed_over.len() == 1 { "1 row is".to_owned() } else { format!("{} rows are", passed_over.len()) };
        notes.push(format!("{rows} omitted: no range or a count of 0 (first: line {first})"));
    }
    Ok(cycles)
}

/// Cycles of the turning points of a pass that comes again and again, each at the place of its maximum, where its growth happens and its plastic
/// zone is made.
fn of_points(points: &[f64]) -> Result<Vec<Cycle>> {
    let mut counted = rainflow(points);
    let problem = "is too few: a cycle needs a maximum and a minimum";
    fail_if!(counted.is_empty(), input("turning points", points.len(), problem, "give at least two loads that differ"));
    counted.sort_by_key(|cycle| cycle.places);
    Ok(counted.iter().map(|cycle| Cycle { max: cycle.max, min: cycle.min, count: 1.0 }).collect())
}
