//! Section of a report on spectrum loading: picture, file as read, load interaction, life with and without retardation.

use super::{Drawings, PRINT, picture, quoted, recorded, terms, title};
use crate::record::RunRecord;
use crate::spectrum::SpectrumRecord;
use perilife_growth::predict::StopReason;

/// The section; empty for other loads.
pub fn section(run: &RunRecord, drawings: &Drawings) -> String {
    let Some(spectrum) = &run.spectrum else { return String::new() };
    let title = title("Spectrum");
    let picture = picture(drawings, "spectrum.svg", "Spectrum (one pass): peak exceedances and range histogram.");
    let (understood, counted) = (terms(&understood(run, spectrum)), terms(&counted(run, spectrum)));
    format!(
        "{title}{picture}<div class=\"cols\"><div><h2>Input</h2>{understood}</div>\
         <div><h2>Load interaction</h2>{counted}</div></div>\n"
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
            "{} of {} cycles per pass (range below {} % of the largest)",
            short(omitted),
            short(per_pass + omitted),
            share.unwrap_or_else(|| "a share".to_owned())
        ),
        Some(share) => format!("none (all above {share} % of the largest range)"),
        None => "none".to_owned(),
    };
    let cut_off = spectrum
        .truncated_at
        .map_or_else(|| "none".to_owned(), |share| format!("peaks above {} % of the largest in the file", short(100.0 * share)));
    let level = |[level, count]: &[f64; 2]| format!("{} above {} %", short(*count), short(100.0 * level));
    let levels: Vec<String> = spectrum.exceedances.iter().map(level).collect();
    let kinds = PRINT.whole(spectrum.kinds_of_cycles as f64);
    let mut rows = vec![
        ("File", format!("{} ({})", recorded(Some(&spectrum.file)), recorded(Some(&spectrum.format)))),
        ("Pass", format!("{} cycles, {kinds} different", short(per_pass))),
        ("Omitted", left_out),
        ("Clipped", cut_off),
    ];
    rows.extend(scale.map(|(scale, unit)| ("Maximum load", format!("{} {unit}, gross", short(scale * spectrum.largest)))));
    rows.extend([
        ("Minimum load", format!("{} of the maximum", short(spectrum.smallest_over_largest))),
        ("Stress ratios", format!("{} to {}", short(spectrum.stress_ratio_min), short(spectrum.stress_ratio_max))),
        ("Peaks per pass", format!("{} of the maximum", levels.join(", "))),
        ("Passes", spectrum.repeats.map_or_else(|| "repeated to the end".to_owned(), |most| format!("at most {}", short(most)))),
    ]);
    rows
}

/// Retardation model with its constants; life in cycles and passes, and without retardation.
fn counted(run: &RunRecord, spectrum: &SpectrumRecord) -> Vec<(&'static str, String)> {
    let cycles =
        |cycles: f64| format!("{} cycles, {} passes", PRINT.whole(cycles), PRINT.fixed(cycles / spectrum.cycles_per_pass, 2));
    let mut rows = vec![(
        "Retardation",
        match spectrum.retardation.get("model").and_then(|model| model.as_str()) {
            Some("none") => "none (mean growth rate per pass)".to_owned(),
            other => recorded(other),
        },
    )];
    for (key, value) in spectrum.retardation.iter().filter(|(key, _)| *key != "model") {
        let value = value.as_f64().map_or_else(|| "per cycle".to_owned(), |value| PRINT.sized(value, 4));
        rows.push(("Constant", format!("{} {value}", quoted(key))));
    }
    rows.push(("Life", run.life_cycles.map_or_else(|| "unlimited".to_owned(), cycles)));
    if let Some(mean) =
        spectrum.life_cycles_without_retardation.filter(|mean| *mean > 0.0 && run.stop_reason != StopReason::RunOut)
    {
        let ratio = run
            .life_cycles
            .map_or_else(String::new, |life| format!("; life with retardation = {} × this", PRINT.fixed(life / mean, 2)));
        rows.push(("Without retardation", format!("{}{ratio}", cycles(mean))));
    }
    rows
}
