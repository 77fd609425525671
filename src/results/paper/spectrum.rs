//! What a report says of a spectrum: the picture, what was understood of its file, how its order counts, and the life with and without that.

use super::{PRINT, Sheets, quoted, recorded, terms};
use crate::record::RunRecord;
use crate::spectrum::SpectrumRecord;

/// The section; nothing of a run under other loads.
pub fn section(run: &RunRecord, sheets: &mut Sheets<'_>) -> String {
    let Some(spectrum) = &run.spectrum else { return String::new() };
    let title = sheets.title("Spectrum");
    let picture =
        sheets.picture("spectrum.svg", "A pass of the spectrum: maxima that are as large or larger, and cycles by their range");
    let (understood, counted) = (terms(&understood(run, spectrum)), terms(&counted(run, spectrum)));
    format!(
        "{title}{picture}<div class=\"cols\"><div><h2>As understood</h2>{understood}</div>\
         <div><h2>Order of cycles, and the life</h2>{counted}</div></div>\n"
    )
}

fn understood(run: &RunRecord, spectrum: &SpectrumRecord) -> Vec<(&'static str, String)> {
    let (short, loading) = (|value: f64| PRINT.short(value), &run.case["loading"]);
    let percent = loading["omission_percent"].as_f64().map(short);
    let (per_pass, omitted) = (spectrum.cycles_per_pass, spectrum.cycles_omitted_per_pass);
    let scale = |(key, unit): (&str, &'static str)| Some((loading[key].as_f64()?, unit));
    let scale = [("spectrum_scale_mpa", "MPa"), ("spectrum_scale_n", "N")].into_iter().find_map(scale);
    let left_out = match percent {
        share if omitted > 0.0 => format!(
            "{} of {} cycles of a pass, below {} % of the largest range",
            short(omitted),
            short(per_pass + omitted),
            share.unwrap_or_else(|| "a share".to_owned())
        ),
        Some(share) => format!("none lies below {share} % of the largest range"),
        None => "nothing".to_owned(),
    };
    let cut_off = spectrum.truncated_at.map_or_else(
        || "nothing".to_owned(),
        |share| format!("peaks above {} % of the largest of the file", short(100.0 * share)),
    );
    let level = |[level, count]: &[f64; 2]| format!("{} above {} %", short(*count), short(100.0 * level));
    let levels: Vec<String> = spectrum.exceedances.iter().map(level).collect();
    let kinds = PRINT.whole(spectrum.kinds_of_cycles as f64);
    let mut rows = vec![
        ("File", format!("{} ({})", recorded(Some(&spectrum.file)), recorded(Some(&spectrum.format)))),
        ("A pass", format!("{} cycles of {kinds} kinds", short(per_pass))),
        ("Left out", left_out),
        ("Cut off", cut_off),
    ];
    rows.extend(scale.map(|(scale, unit)| ("Largest load", format!("{} {unit}, gross", short(scale * spectrum.largest)))));
    rows.extend([
        ("Smallest", format!("{} of the largest", short(spectrum.smallest_over_largest))),
        ("Stress ratios", format!("{} to {}", short(spectrum.stress_ratio_min), short(spectrum.stress_ratio_max))),
        ("Maxima", format!("{} of the largest", levels.join(", "))),
        ("Passes", spectrum.repeats.map_or_else(|| "again and again".to_owned(), |most| format!("{} at the most", short(most)))),
    ]);
    rows
}

/// Model of retardation with its constants; life in cycles, in passes, and by the mean rate alone.
fn counted(run: &RunRecord, spectrum: &SpectrumRecord) -> Vec<(&'static str, String)> {
    let cycles =
        |cycles: f64| format!("{} cycles, {} passes", PRINT.whole(cycles), PRINT.fixed(cycles / spectrum.cycles_per_pass, 2));
    let mut rows = vec![(
        "Retardation",
        match spectrum.retardation.get("model").and_then(|model| model.as_str()) {
            Some("none") => "none: cracks grow by the mean rate of a pass".to_owned(),
            other => recorded(other),
        },
    )];
    for (key, value) in spectrum.retardation.iter().filter(|(key, _)| *key != "model") {
        let value = value.as_f64().map_or_else(|| "of each cycle".to_owned(), |value| PRINT.sized(value, 4));
        rows.push(("Constant", format!("{} {value}", quoted(key))));
    }
    rows.push(("Life", run.life_cycles.map_or_else(|| "unlimited".to_owned(), cycles)));
    if let Some(mean) = spectrum.life_cycles_without_retardation.filter(|mean| *mean > 0.0) {
        let ratio =
            run.life_cycles.map_or_else(String::new, |life| format!("; the life is {} times that", PRINT.fixed(life / mean, 2)));
        rows.push(("Without retardation", format!("{}{ratio}", cycles(mean))));
    }
    rows
}
