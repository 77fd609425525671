//! What a report says of a spectrum: the picture, what was understood of its file, how its order counts, and the life with and without that.

use serde_json::Value;

use super::numbers::{fixed, short, sized, whole};
use super::{Sheets, quoted, recorded, terms};

/// The section; nothing of a run under other loads.
pub fn section(result: &Value, sheets: &mut Sheets<'_>) -> String {
    let spectrum = &result["spectrum"];
    if !spectrum.is_object() {
        return String::new();
    }
    let title = sheets.title("Spectrum");
    let picture =
        sheets.picture("spectrum.svg", "A pass of the spectrum: maxima that are as large or larger, and cycles by their range");
    let understood = terms(&understood(spectrum, &result["case"]["loading"]));
    let counted = terms(&counted(result, spectrum));
    format!(
        "{title}{picture}<div class=\"cols\"><div><h2>As understood</h2>{understood}</div>\
         <div><h2>Order of cycles, and the life</h2>{counted}</div></div>\n"
    )
}

fn understood(spectrum: &Value, loading: &Value) -> Vec<(&'static str, String)> {
    let number = |key: &str| spectrum[key].as_f64();
    let known = |key: &str, words: fn(f64) -> String| number(key).map_or_else(|| recorded(None), words);
    let percent = |key: &str| loading[key].as_f64().map(short);
    let per_pass = number("cycles_per_pass").unwrap_or(f64::NAN);
    let scale = |(key, unit): (&str, &'static str)| loading[key].as_f64().map(|scale| (scale, unit));
    let largest = [("spectrum_scale_mpa", "MPa"), ("spectrum_scale_n", "N")].into_iter().find_map(scale).zip(number("largest"));
    let omitted = match (number("cycles_omitted_per_pass").filter(|omitted| *omitted > 0.0), percent("omission_percent")) {
        (Some(omitted), share) => format!(
            "{} of {} cycles of a pass, below {} % of the largest range",
            short(omitted),
            short(per_pass + omitted),
            share.unwrap_or_else(|| "a share".to_owned())
        ),
        (None, Some(share)) => format!("none lies below {share} % of the largest range"),
        (None, None) => "nothing".to_owned(),
    };
    let truncated = match number("truncated_at") {
        Some(share) => format!("peaks above {} % of the largest of the file", short(100.0 * share)),
        None => "nothing".to_owned(),
    };
    let level = |pair: &Value| Some(format!("{} above {} %", short(pair[1].as_f64()?), short(100.0 * pair[0].as_f64()?)));
    let levels: Vec<String> = spectrum["exceedances"].as_array().into_iter().flatten().filter_map(level).collect();
    let mut rows = vec![
        ("File", format!("{} ({})", recorded(spectrum["file"].as_str()), recorded(spectrum["format"].as_str()))),
        ("A pass", format!("{} cycles of {} kinds", short(per_pass), known("kinds_of_cycles", whole))),
        ("Left out", omitted),
        ("Cut off", truncated),
    ];
    rows.extend(largest.map(|((scale, unit), largest)| ("Largest load", format!("{} {unit}, gross", short(scale * largest)))));
    rows.extend([
        ("Smallest", known("smallest_over_largest", |share| format!("{} of the largest", short(share)))),
        ("Stress ratios", format!("{} to {}", known("stress_ratio_min", short), known("stress_ratio_max", short))),
        ("Maxima", format!("{} of the largest", levels.join(", "))),
        (
            "Passes",
            number("repeats").map_or_else(|| "again and again".to_owned(), |repeats| format!("{} at the most", short(repeats))),
        ),
    ]);
    rows
}

/// Model of retardation with its constants; life in cycles, in passes, and by the mean rate alone.
fn counted(result: &Value, spectrum: &Value) -> Vec<(&'static str, String)> {
    let model = &spectrum["retardation"];
    let name = model["model"].as_str();
    let per_pass = spectrum["cycles_per_pass"].as_f64();
    let passes = |cycles: f64| per_pass.map_or_else(String::new, |each| format!(", {} passes", fixed(cycles / each, 2)));
    let life = result["life_cycles"].as_f64();
    let mut rows = vec![(
        "Retardation",
        match name {
            Some("none") => "none: cracks grow by the mean rate of a pass".to_owned(),
            other => recorded(other),
        },
    )];
    for (key, value) in model.as_object().into_iter().flatten().filter(|(key, _)| *key != "model") {
        rows.push((
            "Constant",
            format!("{} {}", quoted(key), value.as_f64().map_or_else(|| "of each cycle".to_owned(), |value| sized(value, 4))),
        ));
    }
    rows.push(("Life", life.map_or_else(|| "unlimited".to_owned(), |life| format!("{} cycles{}", whole(life), passes(life)))));
    if let Some(mean) = spectrum["life_cycles_without_retardation"].as_f64().filter(|mean| *mean > 0.0) {
        let ratio = life.map_or_else(String::new, |life| format!("; the life is {} times that", fixed(life / mean, 2)));
        rows.push(("Without retardation", format!("{} cycles{}{ratio}", whole(mean), passes(mean))));
    }
    rows
}
