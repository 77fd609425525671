//! `[supports]` of a scene: sides or boxes whose points stay where they are.

use serde::Deserialize;
use toml::Value;

use super::region;
use crate::error::{Result, input, input_missing};
use crate::fracture::scene::{Region, SceneSupport};
use crate::input::{shorten, slice, table_of};
use crate::specimen::{Component, Edge, Specimen};

/// A held side.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SideInput {
    #[serde(default)]
    rows_mm: f64,
    range_mm: Option<[f64; 2]>,
    fix: Vec<Component>,
}

/// A held box.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BoxInput {
    from_mm: [f64; 2],
    to_mm: [f64; 2],
    fix: Vec<Component>,
}

/// Reads `[supports]`: `bottom = { rows_mm, range_mm, fix }`, or under any other name `{ from_mm, to_mm, fix }`.
pub fn from_value(value: &Value, specimen: &Specimen) -> Result<Vec<SceneSupport>> {
    let mut holds = Vec::new();
    for (name, value) in table_of(value, "supports")? {
        let path = format!("supports.{name}");
        let (region, fix, key) = match name.parse::<Edge>() {
            Ok(side) => {
                let entry: SideInput = slice(value, &path)?;
                let (depth, range) = (format!("{path}.rows_mm"), format!("{path}.range_mm"));
                let region = region::edge(side, &path, (&depth, entry.rows_mm), (&range, entry.range_mm), specimen)?;
                (region, entry.fix, range)
            }
            Err(_) if value.as_table().is_some_and(|table| table.contains_key("rows_mm") || !table.contains_key("from_mm")) => {
                let remedy = "known sides: top, bottom, left, right; a box has from_mm, to_mm and fix";
                return Err(input(&path, shorten(value), "is neither a side of the plate nor a box", remedy));
            }
            Err(_) => {
                let entry: BoxInput = slice(value, &path)?;
                let (low, high) = region::corners(&path, [entry.from_mm, entry.to_mm], specimen)?;
                (Region::Box { low, high }, entry.fix, path.clone())
            }
        };
        if fix.is_empty() {
            let remedy = "give fix = [\"x\", \"y\"], [\"x\"] or [\"y\"]";
            return Err(input_missing(&format!("{path}.fix"), "holds nothing", remedy));
        }
        let components = [Component::X, Component::Y].map(|component| fix.contains(&component));
        holds.push(SceneSupport { region, components, key });
    }
    Ok(holds)
}
