//! The calibration file to write for a table of readings, filled with what the table says.

use std::path::Path;

use crate::preamble::{Preamble, StatedMaterial};
use perilife_base::error::{Error, InputError, Result, fail_if};
use perilife_base::table::names::Role;
use perilife_base::units::{MM, round_off};
use perilife_measured::{Import, SAME_LOAD, Survey, survey};
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
    let said = Preamble::of(found);
    let of_kind = if is_central { Some(SpecimenKind::MiddleTension.name()) } else { said.kind };
    let kind = of_kind.map_or_else(|| "<...> # perilife list specimen.kind".to_owned(), |kind| format!("{kind:?}"));
    let tension =
        if of_kind == Some(SpecimenKind::CompactTension.name()) { "" } else { "length_mm = <...> # of tension specimens\n" };
    let open = "<...> # perilife list material.name";
    let alloy = match said.material {
        Some(StatedMaterial { name: Some(name), orientation: None, .. }) => format!("{name:?}"),
        Some(StatedMaterial { name: Some(name), orientation: Some(own), .. }) => {
            format!("{name:?} # no record of orientation {own}")
        }
        Some(own) => open.replace("# ", &format!("# Material in the file: {}; ", own.stated)),
        None => open.to_owned(),
    };
    let first = curves.iter().filter_map(|curve| curve.crack_length.first()).copied().reduce(f64::min);
    let load = found.measured.load();
    let of_load = |key: &str| {
        let value = load.get(key).copied().or(said.stress_ratio.filter(|_| key == "stress_ratio"));
        format!("{key} = {}", number(value))
    };
    let maximum = load.keys().find(|key| **key != "stress_ratio").unwrap_or(&"force_max_kn");
    format!(
        "[measured]\nfiles = [{name:?}]\n{columns}\n[specimen]\nkind = {kind}\nwidth_mm = {}\n{tension}\
         thickness_mm = {}\ncrack_length_mm = {} # first reading\n[material]\nname = {alloy}\n[loading]\n{}\n{}",
        number(stated(Role::Width).or(said.width_mm)),
        number(stated(Role::Thickness).or(said.thickness_mm)),
        number(first.map(|length| length / MM)),
        of_load(maximum),
        of_load("stress_ratio"),
    )
}
