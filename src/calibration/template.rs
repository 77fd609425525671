//! The calibration file to write for a table of readings, filled with what the table says.

use std::path::Path;

use perilife_base::error::{Error, InputError, Result, fail_if};
use perilife_base::table::names::Role;
use perilife_base::units::{MM, round_off, shown::length_given};
use perilife_measured::{Import, SAME_LOAD, Survey, said_above, survey};
use perilife_plate::material::library::names;
use perilife_plate::specimen::SpecimenKind;

/// Refuses a table of readings that is given in place of a calibration file.
/// Errors: its remedy is the file to write.
pub fn refuse_table(path: &Path) -> Result<()> {
    if !path
        .extension()
        .is_some_and(|end| ["csv", "tsv", "txt", "dat", "xlsx"].iter().any(|table| end.eq_ignore_ascii_case(table)))
    {
        return Ok(());
    }
    let bytes = std::fs::read(path).map_err(|error| Error::file(path, "cannot read", error))?;
    let [name, stem] = [path.file_name(), path.file_stem()].map(|name| name.unwrap_or_default().to_string_lossy());
    let mut found = survey(&bytes, path, &Import::default());
    fail_if!(found.header.is_empty() && !found.problems.is_empty(), Error::Input(Box::new(found.problems.swap_remove(0))));
    let lines = lines(&name, &found);
    Err(Error::Input(Box::new(InputError {
        file: Some(path.to_path_buf()),
        problem: "is a table of readings, not a calibration file".to_owned(),
        remedy: format!("save these lines in its folder as {stem}.toml, fill in <...>, and calibrate that:\n\n{lines}"),
        ..InputError::default()
    })))
}

fn lines(name: &str, found: &Survey) -> String {
    let curves = &found.measured.curves;
    let columns = match &found.layout {
        Some(layout) => {
            let read = found.header.iter().zip(layout.keys(found.header.len())).filter(|(_, key)| !key.is_empty());
            format!("# columns: {}", read.map(|(header, key)| format!("{header} ({key})")).collect::<Vec<_>>().join(", "))
        }
        None => format!("columns = {{ cycles = <...>, length = <...> }} # names of {}", found.header.join(" | ")),
    };
    let number = |value: Option<f64>| value.map_or_else(|| "<...>".to_owned(), |value| round_off(value).to_string());
    let stated = |role: Role| {
        let of_curves = curves.iter().flat_map(|curve| curve.stated.iter().filter(|one| one.role == role));
        let mut values = of_curves.flat_map(|one| one.values.iter().copied());
        let first = values.next().filter(|value| value.is_finite())?;
        values.all(|value| (value - first).abs() <= SAME_LOAD * first).then_some(first / MM)
    };
    let is_central = !curves.is_empty() && curves.iter().all(|curve| curve.source.is_tip_to_tip);
    let of_kind = if is_central { Some(SpecimenKind::MiddleTension) } else { kind_above(&found.above) };
    let kind = of_kind.map_or_else(|| "<...> # perilife list specimen.kind".to_owned(), |kind| format!("{:?}", kind.name()));
    let tension = if of_kind == Some(SpecimenKind::CompactTension) { "" } else { "length_mm = <...> # of tension specimens\n" };
    let above = |labels: &[&str], of: fn(&str) -> Option<f64>| {
        let values: Vec<f64> = said_above(&found.above, labels).iter().filter_map(|value| of(value)).collect();
        values.first().copied().filter(|first| values.iter().all(|value| value == first))
    };
    let material = said_above(&found.above, &["material", "werkstoff", "alloy", "legierung"]).into_iter().next();
    let alloy = match material {
        Some(own) if names().contains(&own.to_lowercase()) => format!("{:?}", own.to_lowercase()),
        Some(own) => format!("<...> # Material in the file: {own}; perilife list material.name"),
        None => "<...> # perilife list material.name".to_owned(),
    };
    let first = curves.iter().filter_map(|curve| curve.crack_length.first()).copied().reduce(f64::min);
    let load = found.measured.load();
    let ratio = above(&["stress ratio", "load ratio", "force ratio", "r-ratio", "spannungsverhältnis", "r"], ratio_of);
    let of_load = |key: &str| {
        let said = load.get(key).copied().or(ratio.filter(|_| key == "stress_ratio"));
        format!("{key} = {}", number(said))
    };
    let maximum = load.keys().find(|key| **key != "stress_ratio").unwrap_or(&"force_max_kn");
    format!(
        "[measured]\nfiles = [{name:?}]\n{columns}\n[specimen]\nkind = {kind}\nwidth_mm = {}\n{tension}\
         thickness_mm = {}\ncrack_length_mm = {} # first reading\n[material]\nname = {alloy}\n[loading]\n{}\n{}",
        number(stated(Role::Width).or_else(|| above(&["width", "breite", "w"], millimetres))),
        number(stated(Role::Thickness).or_else(|| above(&["thickness", "dicke", "b"], millimetres))),
        number(first.map(|length| length / MM)),
        of_load(maximum),
        of_load("stress_ratio"),
    )
}

/// With a decimal point; `None` with a comma that may be one between thousands.
fn certain(text: &str) -> Option<String> {
    let digits = text.split_once(',').map_or(0, |(_, behind)| behind.bytes().take_while(u8::is_ascii_digit).count());
    (digits != 3).then(|| text.replace(',', "."))
}

/// A stress ratio; a length by the same letter has a unit.
fn ratio_of(text: &str) -> Option<f64> {
    certain(text)?.parse().ok().filter(|ratio| *ratio < 1.0)
}

/// A length with its unit, mm.
fn millimetres(text: &str) -> Option<f64> {
    let text = certain(text).filter(|text| ["mm", "in", "inch"].iter().any(|unit| text.ends_with(unit)))?;
    length_given(&text).map(|length| length / MM).filter(|length| *length > 0.0)
}

/// The kind of specimen whose designation or name is above a table; `None` where there are several.
fn kind_above(lines: &[Vec<String>]) -> Option<SpecimenKind> {
    let is_said = |kind: &SpecimenKind| {
        let designation = kind.meaning().split([' ', ',', ';']).find(|word| word.ends_with(')') && word.contains('('));
        let names = |field: &String| {
            field.to_lowercase().contains(&kind.name().replace('_', " "))
                || designation.is_some_and(|own| field.split([' ', ',', ':', '=']).any(|word| word == own))
        };
        lines.iter().flatten().any(names)
    };
    let mut said = SpecimenKind::all().filter(is_said);
    said.next().filter(|_| said.next().is_none())
}
