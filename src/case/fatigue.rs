//! `[fatigue]` and `[stop]` of an input file: how bonds age, where the law comes from, when a run stops.

use std::path::Path;

use serde::Deserialize;
use toml::Value;

use super::choices::{Choices, Failure};
use super::{LawSource, Stop};
use crate::calibration::record::FittedRecord;
use crate::error::{Error, Result, input, input_missing};
use crate::fatigue::{Ageing, Block, BlockKind, FatigueLaw, FatigueSettings, OVERLOAD_STRETCH, Precrack};
use crate::input::{Document, INTENSITY, LENGTH, number, slice};
use crate::specimen::{LengthConvention, Specimen, SpecimenKind};

/// Radius of the ageing zone: a narrower zone breaks bonds beside the crack path less often, see the growth law.
const ZONE_RADIUS: f64 = 0.5;
const CYCLES_MAX: f64 = 1e9;

/// Keys of `[fatigue]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Input {
    fitted: Option<String>,
    a: Option<f64>,
    p: Option<f64>,
    horizon_mm: Option<f64>,
    ageing: Option<Ageing>,
    zone_radius_horizons: Option<f64>,
    precrack: Option<Precrack>,
    block: Option<BlockKind>,
    block_cycles: Option<f64>,
    bonds_per_block: Option<u32>,
    critical_stretch: Option<f64>,
    walker_gamma: Option<f64>,
    delta_k_threshold_mpa_sqrt_m: Option<f64>,
    allow_extrapolation: Option<bool>,
    #[serde(rename = "failure")]
    _failure: Option<Failure>,
}

/// `[fatigue]`, read.
pub(super) struct Fatigue {
    pub settings: FatigueSettings,
    /// `None` where the file gives no law, as in a calibration.
    pub law: Option<LawSource>,
    pub allow_extrapolation: bool,
}

/// Reads `[fatigue]`; a fitted record is looked for from `base_dir`. Explicit choices go into `choices`.
pub(super) fn from_value(value: &Value, base_dir: &Path, choices: &mut Choices) -> Result<Fatigue> {
    let input: Input = slice(value, "fatigue")?;
    choices.ageing = input.ageing;
    choices.zone_radius_horizons =
        number("a radius in horizons", 0.05, 10.0).read_optional("fatigue.zone_radius_horizons", input.zone_radius_horizons)?;
    choices.walker_gamma = number("a Walker exponent", 0.0, 2.0).read_optional("fatigue.walker_gamma", input.walker_gamma)?;
    let stretch = number("a stretch", 1e-9, 10.0).read_optional("fatigue.critical_stretch", input.critical_stretch)?;
    let threshold = INTENSITY.read_optional(
        "fatigue.delta_k_threshold_mpa_sqrt_m",
        input.delta_k_threshold_mpa_sqrt_m.filter(|value| *value != 0.0),
    )?;
    let settings = FatigueSettings {
        ageing: choices.ageing.unwrap_or(Ageing::CrackTip),
        zone_radius_horizons: choices.zone_radius_horizons.unwrap_or(ZONE_RADIUS),
        precrack: input.precrack.unwrap_or(Precrack::SteadyProfile),
        block: read_block(&input)?,
        critical_stretch: stretch.unwrap_or(OVERLOAD_STRETCH),
        walker_gamma: choices.walker_gamma.unwrap_or(1.0),
        threshold: threshold.unwrap_or(0.0),
    };
    Ok(Fatigue { settings, law: read_law(&input, base_dir)?, allow_extrapolation: input.allow_extrapolation.unwrap_or(false) })
}

fn read_block(slice: &Input) -> Result<Block> {
    let kind = slice.block.unwrap_or(BlockKind::UntilNextBreak);
    let cycles = number("a number of cycles", 1e-3, 1e12).read_optional("fatigue.block_cycles", slice.block_cycles)?;
    match (kind, cycles, slice.bonds_per_block) {
        (BlockKind::Fixed, None, _) => {
            return Err(input_missing(
                "fatigue.block_cycles",
                "is missing, and block is \"fixed\"",
                "give the cycles of a block",
            ));
        }
        (BlockKind::Fixed, _, Some(bonds)) => {
            return Err(input(
                "fatigue.bonds_per_block",
                bonds,
                "does not go with block = \"fixed\"",
                "leave it out, or use block = \"until_next_break\"",
            ));
        }
        (BlockKind::UntilNextBreak, Some(cycles), _) => {
            return Err(input(
                "fatigue.block_cycles",
                cycles,
                "does not go with block = \"until_next_break\"",
                "leave it out, or use block = \"fixed\"",
            ));
        }
        _ => {}
    }
    let bonds = slice.bonds_per_block.unwrap_or(1);
    number("a number of bonds", 1.0, 1e6).read("fatigue.bonds_per_block", f64::from(bonds))?;
    Ok(Block { kind, cycles: cycles.unwrap_or(f64::INFINITY), bonds: bonds as usize })
}

fn read_law(slice: &Input, base_dir: &Path) -> Result<Option<LawSource>> {
    let inline = [("a", slice.a), ("p", slice.p), ("horizon_mm", slice.horizon_mm)];
    if let Some(fitted) = &slice.fitted {
        if let Some((key, value)) = inline.iter().find_map(|(key, value)| Some((key, (*value)?))) {
            return Err(input(
                &format!("fatigue.{key}"),
                value,
                "stands beside fitted: the law is given twice",
                "give fitted, or a, p and horizon_mm",
            ));
        }
        return read_record(&base_dir.join(fitted)).map(Some);
    }
    if inline.iter().all(|(_, value)| value.is_none()) {
        return Ok(None);
    }
    if let Some((key, _)) = inline.iter().find(|(_, value)| value.is_none()) {
        let why = if *key == "horizon_mm" { ": A is meaningless without the horizon it belongs to" } else { "" };
        return Err(input_missing(
            &format!("fatigue.{key}"),
            format!("is missing{why}"),
            "give a, p and horizon_mm together, or fitted",
        ));
    }
    let need = |i: usize| inline[i].1.unwrap_or(f64::NAN);
    Ok(Some(LawSource::Inline(FatigueLaw {
        a: number("a constant in 1/cycle", 1e-60, 1e100).read("fatigue.a", need(0))?,
        p: number("an exponent", 0.5, 20.0).read("fatigue.p", need(1))?,
        horizon: LENGTH.read("fatigue.horizon_mm", need(2))?,
    })))
}

/// Reads a `fitted.toml`; one that does not exist (yet) is [`LawSource::Missing`].
fn read_record(path: &Path) -> Result<LawSource> {
    match Document::read(path, &[]) {
        Ok(document) => {
            let record = slice::<FittedRecord>(&Value::Table(document.table.clone()), "record").and_then(|record| {
                super::law::check_record(&record)?;
                Ok(record)
            });
            let at_top = |error| match error {
                Error::Input(mut trouble) => {
                    trouble.key = trouble.key.map(|key| key.trim_start_matches("record.").to_owned());
                    trouble.remedy.push_str("; this file is written by `perilife calibrate`");
                    Error::Input(trouble)
                }
                other => other,
            };
            record.map(|record| LawSource::Fitted(Box::new(record))).map_err(|error| document.locate(at_top(error)))
        }
        Err(Error::File { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => {
            Ok(LawSource::Missing(path.to_path_buf()))
        }
        Err(other) => Err(other),
    }
}

/// Keys of `[stop]`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StopInput {
    crack_length_mm: Option<f64>,
    cycles_max: Option<f64>,
}

/// Reads `[stop]`.
pub(super) fn stop_from_value(value: &Value, specimen: &Specimen) -> Result<Stop> {
    let slice: StopInput = slice(value, "stop")?;
    let crack_length = LENGTH.read_optional("stop.crack_length_mm", slice.crack_length_mm)?;
    if let (Some(length), Some(given)) = (crack_length, slice.crack_length_mm) {
        const KEY: &str = "stop.crack_length_mm";
        if length <= specimen.crack_length {
            let start = super::model::round_mm(specimen.crack_length);
            return Err(input(
                KEY,
                given,
                format!("is not beyond the initial crack length {start} mm"),
                "give a longer crack, or leave it out",
            ));
        }
        let limit = match specimen.kind {
            SpecimenKind::MiddleTension | SpecimenKind::DoubleEdgeTension => specimen.width / 2.0,
            _ => specimen.width,
        };
        if specimen.convention == LengthConvention::MeanOfTips && length >= limit {
            let limit = super::model::round_mm(limit);
            return Err(input(
                KEY,
                given,
                format!("is beyond the plate, which ends at {limit} mm"),
                "give a shorter crack, or leave it out",
            ));
        }
    }
    let cycles_max = number("a number of cycles", 1.0, 1e15).read("stop.cycles_max", slice.cycles_max.unwrap_or(CYCLES_MAX))?;
    Ok(Stop { crack_length: crack_length.unwrap_or(f64::INFINITY), cycles_max })
}
