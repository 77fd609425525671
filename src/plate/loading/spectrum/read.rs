//! A spectrum from its file: which format it has, what it says, and what of it is left out.

use super::classes::{classes, kinds};
use super::content::{Content, RawCycle};
use super::rainflow::{Counted, rainflow};
use super::rows::{fault, rows};
use super::{Cycle, Spectrum, fastran, spx, sub, table};
use crate::loading::Input;
use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{Folder, number};

perilife_base::kinds! {
    /// How a spectrum is written.
    pub enum SpectrumFormat for "loading.spectrum_format" {
        Cycles = "cycles": "CSV with the columns max, min, cycles, in order, each maximum before its minimum",
        TurningPoints = "turning_points": "one column of loads, counted by rainflow (ASTM E1049), each cycle at the place of its maximum",
        Spx = "spx": "AFGROW .spx: XML with elements B (Mx, Mn, C) in every SubSpectrum",
        Sub = "sub": "AFGROW .sub: a title with the number of rows, then rows max min cycles",
        Fastran = "fastran": "FASTRAN: a title, points Smax Smin INVERT ICLIP, then turning points as whole numbers",
    }
}

/// Keys that belong to a spectrum, beside its scale.
fn given(input: &Input) -> [(&'static str, bool); 5] {
    let Input { spectrum_file, spectrum_format, omission_percent, truncation_percent, repeats, .. } = input;
    [
        ("spectrum_file", spectrum_file.is_some()),
        ("spectrum_format", spectrum_format.is_some()),
        ("omission_percent", omission_percent.is_some()),
        ("truncation_percent", truncation_percent.is_some()),
        ("repeats", repeats.is_some()),
    ]
}

/// Refuses the keys of spectra where the loads are none.
pub(in crate::loading) fn refuse(input: &Input) -> Result<()> {
    let remedy = "give kind = \"spectrum\", or leave it out";
    perilife_base::input::refuse_given(
        "loading",
        &given(input),
        "belongs to a spectrum, and the kind of loading is another",
        remedy,
    )
}

impl Spectrum {
    /// The spectrum that `[loading]` asks for, its file read from a folder.
    /// Errors: no file, or one that cannot be read, each by file, line and value; percentages beyond reason.
    pub(in crate::loading) fn read(input: &Input, folder: &Folder) -> Result<Spectrum> {
        let file = input.spectrum_file.as_deref().ok_or_else(|| {
            let remedy = "name a file with the columns max, min, cycles, one column of turning points, or .spx, .sub, FASTRAN";
            input_missing("loading.spectrum_file", "is missing, and kind is \"spectrum\"", remedy)
        })?;
        let percent = |key: &str, value: Option<f64>, [low, high]: [f64; 2]| {
            number("a percentage", low, high).read_optional(&format!("loading.{key}"), value)
        };
        let omission = percent("omission_percent", input.omission_percent, [0.0, 99.0])?.unwrap_or(0.0) / 100.0;
        let truncation = percent("truncation_percent", input.truncation_percent, [1.0, 100.0])?.unwrap_or(100.0) / 100.0;
        let repeats = number("a number of passes", 1e-6, 1e12).read_optional("loading.repeats", input.repeats)?;
        let bytes = folder.read(file)?;
        let read = || {
            let text = String::from_utf8_lossy(&bytes);
            let text = text.trim_start_matches('\u{feff}');
            let format = input.spectrum_format.unwrap_or_else(|| guess(file, text));
            let cycles = checked(content(format, text)?)?;
            let sha256 = perilife_base::input::sha256(&bytes);
            Spectrum::of(cycles, [omission, truncation]).map(|spectrum| Spectrum {
                file: file.to_owned(),
                format,
                repeats,
                sha256,
                ..spectrum
            })
        };
        read().map_err(|error| error.in_file(&folder.path(file)))
    }

    /// The spectrum of cycles of any unit: peaks cut at the share `truncation` of the largest, ranges below the share `omission` of the
    /// largest left out.
    /// Errors: no cycle whose maximum is above zero.
    pub fn of(cycles: Vec<Cycle>, [omission, truncation]: [f64; 2]) -> Result<Spectrum> {
        let most = cycles.iter().map(|cycle| cycle.max).fold(f64::NEG_INFINITY, f64::max);
        if most <= 0.0 {
            let problem = "holds no load above zero: no cycle opens a crack";
            return Err(input("max", most, problem, "give tension as positive values"));
        }
        let cut = most * truncation;
        let share = |cycle: Cycle| Cycle { max: cycle.max.min(cut) / cut, min: cycle.min / cut, ..cycle };
        // A cycle above the cut is gone with it.
        let mut left: Vec<Cycle> = cycles.into_iter().map(share).filter(|cycle| cycle.max > cycle.min).collect();
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
            cycles: left,
            per_pass,
            omitted: all - per_pass,
            largest: [most, cut],
            repeats: None,
            ratios,
            classes: classes(&kinds, per_pass),
            kinds: kinds.len(),
            sha256: String::new(),
        })
    }
}

/// The format by the end of the name, or else by what the first lines hold.
fn guess(file: &str, text: &str) -> SpectrumFormat {
    let ending = file.rsplit_once('.').map(|(_, ending)| ending.to_lowercase()).unwrap_or_default();
    let mut lines = rows(text).map(|(_, line)| line);
    let (first, second) = (lines.next().unwrap_or_default(), lines.next().unwrap_or_default());
    match ending.as_str() {
        "spx" => SpectrumFormat::Spx,
        "sub" => SpectrumFormat::Sub,
        _ if first.starts_with('<') => SpectrumFormat::Spx,
        _ if !table::names_cycles(first) && fastran::is_of(second) => SpectrumFormat::Fastran,
        _ if table::names_cycles(first) || table::is_several(second) => SpectrumFormat::Cycles,
        _ if table::is_numbers(first) && table::is_several(first) => SpectrumFormat::Cycles,
        _ => SpectrumFormat::TurningPoints,
    }
}

fn content(format: SpectrumFormat, text: &str) -> Result<Content> {
    match format {
        SpectrumFormat::Cycles => table::cycles(rows(text)),
        SpectrumFormat::TurningPoints => table::points(rows(text)),
        SpectrumFormat::Spx => spx::read(text),
        SpectrumFormat::Sub => sub::read(rows(text)),
        SpectrumFormat::Fastran => fastran::read(rows(text)),
    }
}

/// The cycles of a file.
/// Errors: none at all, a minimum that is not below its maximum, a number of cycles that is none.
fn checked(content: Content) -> Result<Vec<Cycle>> {
    let raw = match content {
        Content::Points(points) => return of_points(&points),
        Content::Cycles(raw) => raw,
    };
    if raw.is_empty() {
        return Err(input_missing("spectrum", "holds no cycles", "give at least one row max, min, cycles"));
    }
    for RawCycle { line, max, min, count } in raw.iter().copied() {
        let (column, value, problem, remedy) = if min > max {
            let remedy = "give the maximum first; points in time order are read by spectrum_format = \"turning_points\"";
            ("min", min, format!("is above the maximum {max}"), remedy)
        } else if min == max {
            ("min", min, "is the maximum: at a stress ratio of 1 nothing changes in a cycle".to_owned(), "leave the row out")
        } else if !(count > 0.0 && count <= 1e15) {
            ("cycles", count, "is no number of cycles".to_owned(), "give a number above zero")
        } else {
            continue;
        };
        return Err(fault(Some(line), column, &value.to_string(), &problem, remedy));
    }
    Ok(raw.into_iter().map(|RawCycle { max, min, count, .. }| Cycle { max, min, count }).collect())
}

/// Cycles of turning points, each at the place of its maximum, where its growth happens and its plastic zone is made. A pass ends where the
/// next begins, so that its way back to the first point counts.
fn of_points(points: &[f64]) -> Result<Vec<Cycle>> {
    let closed: Vec<f64> = points.iter().chain(points.first()).copied().collect();
    let mut counted = rainflow(&closed);
    if counted.is_empty() {
        let problem = "is too few: a cycle needs a maximum and a minimum";
        return Err(input("turning points", points.len(), problem, "give at least two loads that differ"));
    }
    counted.sort_by_key(Counted::place_of_maximum);
    let cycle = |cycle: &Counted| {
        let [a, b] = cycle.ends;
        Cycle { max: a.max(b), min: a.min(b), count: cycle.count }
    };
    Ok(counted.iter().map(cycle).collect())
}
