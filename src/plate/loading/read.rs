//! `[loading]` of an input file: how large the cycles are.

use std::sync::Arc;

use toml::Value;

use super::course::{LoadCourse, Size};
use super::residual::ResidualStress;
use super::spectrum::Spectrum;
use super::{
    DISPLACEMENT, Input, LoadControl, Loading, LoadingKind, OF_SPECTRUM, PLACES, UNIT_FORCE, UNIT_STRESS, boundary, grips,
};
use crate::specimen::{LengthConvention, LoadMeasure, Specimen};
use perilife_base::error::{self, Error, InputError, Result, fail_if, input, input_missing};
use perilife_base::input::{FORCE, FORCE_KN, Folder, Quantity, STRESS};
use perilife_base::keys::{Given, Plain, Section};
use perilife_base::units::MPA;

const SEQUENCES: &[&str] = &["sequence", "sequences", "blocks", "spectrum", "history", "rainflow", "overloads"];

/// Keys that do not say whether they mean maximum or range.
const BARE: &[&str] = &[
    "stress", "stress_mpa", "stress_amplitude_mpa", "stress_mean_mpa", "stress_min_mpa", "force", "force_n", "force_kn", "load",
    "load_n", "load_kn",
];

const MAGNITUDES: &str = "stress_max_mpa, stress_range_mpa, force_max_n, force_range_n, force_max_kn, force_range_kn";
const SCALES: &str = "spectrum_scale_mpa, spectrum_scale_n";
const DISPLACEMENTS: &str = "displacement_max_mm, displacement_range_mm";

/// Reads `[loading]` and `[supports]`, puts loads and supports of a `plate` on `specimen`, and gives the cycles. A spectrum lies in `folder`;
/// keys `beside` those of the loads are read by others.
pub fn from_values(
    loading: &Value,
    supports: Option<&Value>,
    (folder, beside): (&Folder, &[&str]),
    specimen: &mut Specimen,
) -> Result<Loading> {
    Error::of_all(mistakes(loading, beside))?;
    let given = Given::of(loading, "loading")?;
    let input = Input::read(&given)?;
    grips::refuse(&given, &input)?;
    let spectrum = if input.kind == LoadingKind::Spectrum {
        // What is missing in the case is told before what is wrong in the file.
        Magnitude::read(&input, specimen)?;
        Some(Spectrum::read(&input, folder)?)
    } else {
        let of_spectra: Vec<&str> =
            Input::KEYS.iter().filter(|key| key.only == Some(OF_SPECTRUM) && key.group.is_none()).map(|key| key.name).collect();
        let problem = "applies only to kind = \"spectrum\"";
        given.refuse_any(&of_spectra, problem, "set kind = \"spectrum\", or remove it")?;
        None
    };
    let ratio = match &spectrum {
        Some(spectrum) => ratio_of(spectrum, input.stress_ratio)?,
        None => read_ratio(input.stress_ratio)?,
    };
    let residual = ResidualStress::read(&input, folder)?;
    let is_of_load = input.kind == LoadingKind::ConstantAmplitude;
    if is_of_load && input.crack_pressure.is_some() && input.magnitudes().all(|(_, given, ..)| given.is_none()) {
        return Ok(Loading { residual, ..pressure_alone(&given, &input, supports, specimen, ratio)? });
    }
    let magnitude = Magnitude::read(&input, specimen)?;
    let parallel_ratio = input.parallel_ratio;
    let area = boundary::apply(&given, &input, supports, specimen)?;
    read_bending(&input, specimen)?;
    if let Some(flaw) = specimen.part_through.as_ref().filter(|flaw| parallel_ratio != 0.0 && flaw.radius > 0.0) {
        let problem = format!("changes the stress at the hole; K of a {} does not include it", flaw.kind());
        let remedy = "remove it only if the sides are not loaded; crack_at_hole (through crack) supports it";
        return Err(error::input("loading.stress_parallel_ratio", parallel_ratio, problem, remedy));
    }
    // A range is maximum - minimum, hence maximum (1 - R), also where R is negative.
    let largest = match &spectrum {
        Some(spectrum) => magnitude.value * spectrum.largest[1],
        None if magnitude.is_range => magnitude.value / (1.0 - ratio),
        None => magnitude.value,
    };
    let of_load = match magnitude.course {
        Some(course) => {
            refuse_beside(&magnitude.key, &magnitude.given, &input, specimen)?;
            LoadControl::Follows(Arc::new(course))
        }
        None => LoadControl::Load,
    };
    let (maximum, control) = match (specimen.load_measure, magnitude.of) {
        (LoadMeasure::Stress, Of::Stress) | (LoadMeasure::Force, Of::Force) => (largest, of_load),
        (LoadMeasure::Stress, Of::Force) => (largest / area, of_load),
        (LoadMeasure::Force, Of::Stress) => {
            let is_plate = specimen.kind.is_plate();
            let who = if is_plate { "a plate loaded by pins or rollers" } else { specimen.kind.name() };
            let problem = format!("is a stress; {who} needs a force");
            return Err(error::input(&magnitude.key, &magnitude.given, problem, "give force_max_n or force_range_n (or _kn)"));
        }
        (measure, Of::Displacement) => {
            let beside = if parallel_ratio == 0.0 { &["crack_pressure_mpa"][..] } else { &["stress_parallel_ratio"] };
            let problem = "cannot be combined with cycles of a displacement";
            given.refuse_any(beside, problem, "give cycles of the load")?;
            let (unit, section) = match measure {
                LoadMeasure::Stress => {
                    grips::apply(&given, &input, specimen)?;
                    (UNIT_STRESS, specimen.moved_section().unwrap_or(area))
                }
                LoadMeasure::Force => (UNIT_FORCE, 1.0),
            };
            (unit, LoadControl::Displacement { maximum: largest, section })
        }
    };
    if let Some(pressure) = read_crack_pressure(&input, specimen)? {
        specimen.crack_pressure = pressure / maximum;
    }
    Ok(Loading { maximum, control, ratio, spectrum: spectrum.map(Arc::new), parallel_ratio, residual })
}

/// Refuses what does not follow the crack as the load does, and cracks of which none is the one that it follows.
fn refuse_beside(key: &str, given: &Size, input: &Input, specimen: &Specimen) -> Result<()> {
    let one = "give one number";
    let (problem, remedy) = if input.crack_pressure.is_some() {
        ("cannot be combined with loading.crack_pressure_mpa, which is constant", one)
    } else if specimen.part_through.is_some() {
        ("depends on the length of a through crack; this crack is part-through", one)
    } else if specimen.convention == LengthConvention::SumOfTips && specimen.crack_lines().len() > 1 {
        ("depends on the length of one crack; the plate has several", "give one number, or a plate with one crack")
    } else {
        return Ok(());
    };
    Err(error::input(key, given, problem, remedy))
}

/// Pressure on the cracks and no other load: the nominal load is the pressure.
fn pressure_alone(
    given: &Given<'_>,
    input: &Input,
    supports: Option<&Value>,
    specimen: &mut Specimen,
    ratio: f64,
) -> Result<Loading> {
    let problem = "gives where a load acts, but only crack_pressure_mpa is set";
    let beside = [&PLACES[..], &["stress_parallel_ratio", "edge_bending_ratio"]].concat();
    given.refuse_any(&beside, problem, &format!("remove it, or give one of {MAGNITUDES}"))?;
    boundary::read_supports(supports, specimen)?;
    let maximum = read_crack_pressure(input, specimen)?.unwrap_or_default();
    specimen.loads.clear();
    specimen.load_measure = LoadMeasure::Stress;
    specimen.crack_pressure = 1.0;
    Ok(Loading { maximum, control: LoadControl::Load, ratio, spectrum: None, parallel_ratio: 0.0, residual: None })
}

/// Largest pressure on the faces of the cracks, Pa, with a plate that has cracks to press on.
fn read_crack_pressure(input: &Input, specimen: &Specimen) -> Result<Option<f64>> {
    const KEY: &str = "loading.crack_pressure_mpa";
    let Some(pressure) = input.crack_pressure else { return Ok(None) };
    let given = pressure / MPA;
    let problem = || format!("cannot be combined with {}, whose handbook K includes its own load only", specimen.kind);
    fail_if!(!specimen.kind.is_plate(), error::input(KEY, given, problem(), "use kind = \"plate\""));
    fail_if!(specimen.cracks.is_empty(), error::input(KEY, given, "requires a crack", "give specimen.cracks"));
    Ok(Some(pressure))
}

/// Puts the bending that goes with the tension on a crack that does not go through.
fn read_bending(input: &Input, specimen: &mut Specimen) -> Result<()> {
    const KEY: &str = "loading.bending_ratio";
    const UNBENT: &str = "use a kind with K under bending: surface_crack, corner_crack or corner_crack_at_hole";
    let Some(ratio) = input.bending_ratio else { return Ok(()) };
    let (kind, all_holes) = (specimen.kind, specimen.holes.len());
    match specimen.part_through.as_mut() {
        Some(flaw) if ratio > 0.0 && all_holes > flaw.own_holes() => {
            let problem = "conflicts with specimen.holes: no K of a crack under bending includes holes";
            return Err(error::input(KEY, ratio, problem, "use another program; either alone is a different problem"));
        }
        Some(flaw) if kind.takes_bending() || ratio == 0.0 => flaw.bending_ratio = ratio,
        Some(_) => {
            let problem = format!("cannot be combined with {kind}, whose K is for tension only");
            return Err(error::input(KEY, ratio, problem, UNBENT));
        }
        None => {
            let problem = format!("is out-of-plane bending, not supported for {kind} (through crack)");
            return Err(error::input(KEY, ratio, problem, UNBENT));
        }
    }
    Ok(())
}

/// What is wrong with the keys of `[loading]` by themselves; keys `beside` those of the loads are read by others.
pub fn mistakes(loading: &Value, beside: &[&str]) -> Vec<InputError> {
    let one = |error: Error| if let Error::Input(error) = error { error.each() } else { Vec::new() };
    let given = match Given::of(loading, "loading") {
        Ok(given) => given,
        Err(error) => return one(error),
    };
    // First, since "unknown key" would not tell the user what to do.
    if let Some(key) = given.first(SEQUENCES) {
        let remedy = "write the sequence into a file: kind = \"spectrum\", spectrum_file = \"...\" and spectrum_scale_mpa, or \
                      give constant amplitude: stress_range_mpa or stress_max_mpa with stress_ratio";
        return one(given.refuse(key, "is not a key of a load sequence", remedy));
    }
    if let Some(key) = given.first(BARE) {
        if key.contains("_min") {
            return one(given.refuse(key, "is not a key", "give the maximum with stress_ratio = minimum / maximum"));
        }
        return one(given.refuse(key, "ambiguous: maximum or range?", format!("give exactly one of {MAGNITUDES}")));
    }
    perilife_base::keys::mistakes(given, Input::KEYS, beside, None)
}

/// R of the largest cycle of a spectrum, beside which none is given.
fn ratio_of(spectrum: &Spectrum, given: Option<f64>) -> Result<f64> {
    // Of the cycle with the largest load; of several the least.
    let largest = spectrum.cycles.iter().filter(|cycle| cycle.max == 1.0);
    let of_largest = largest.map(|cycle| cycle.min).fold(f64::INFINITY, f64::min);
    given.map_or(Ok(of_largest), |given| {
        let problem = "conflicts with the spectrum, which gives R of each cycle";
        Err(input("loading.stress_ratio", given, problem, "remove it"))
    })
}

fn read_ratio(ratio: Option<f64>) -> Result<f64> {
    let remedy = "give R = minimum / maximum, 0 for pulsating load";
    ratio.ok_or_else(|| input_missing("loading.stress_ratio", "is missing", remedy))
}

impl Input {
    fn magnitudes(&self) -> impl Iterator<Item = (&'static str, Option<Size>, Quantity, Of)> {
        let scale = |given: Option<Plain>| given.map(|given| Size::One(given.0));
        [
            ("stress_max_mpa", self.stress_max_mpa.clone(), STRESS, Of::Stress),
            ("stress_range_mpa", self.stress_range_mpa.clone(), STRESS, Of::Stress),
            ("force_max_n", self.force_max_n.clone(), FORCE, Of::Force),
            ("force_range_n", self.force_range_n.clone(), FORCE, Of::Force),
            ("force_max_kn", self.force_max_kn.clone(), FORCE_KN, Of::Force),
            ("force_range_kn", self.force_range_kn.clone(), FORCE_KN, Of::Force),
            ("spectrum_scale_mpa", scale(self.spectrum_scale_mpa), STRESS, Of::Stress),
            ("spectrum_scale_n", scale(self.spectrum_scale_n), FORCE, Of::Force),
            ("displacement_max_mm", scale(self.displacement_max_mm), DISPLACEMENT, Of::Displacement),
            ("displacement_range_mm", scale(self.displacement_range_mm), DISPLACEMENT, Of::Displacement),
        ]
        .into_iter()
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Of {
    Stress,
    Force,
    Displacement,
}

struct Magnitude {
    key: String,
    /// As given, in the unit of its key.
    given: Size,
    /// Pa, N or m; of a load that follows the crack that at the initial crack length.
    value: f64,
    course: Option<LoadCourse>,
    is_range: bool,
    of: Of,
}

impl Magnitude {
    fn read(slice: &Input, specimen: &Specimen) -> Result<Self> {
        let kind = slice.kind;
        let (wanted, example) = match kind {
            LoadingKind::ConstantAmplitude => (MAGNITUDES, "loading.stress_max_mpa"),
            LoadingKind::Displacement => (DISPLACEMENTS, "loading.displacement_max_mm"),
            LoadingKind::Spectrum => (SCALES, "loading.spectrum_scale_mpa"),
        };
        let remedy = format!("give exactly one of {wanted}");
        // A second one has been refused.
        let mut given = slice.magnitudes().filter_map(|(key, value, quantity, of)| Some((key, value?, quantity, of)));
        let (key, given, quantity, of) = given.next().ok_or_else(|| input_missing(example, "no load given", &remedy))?;
        let path = format!("loading.{key}");
        if !wanted.split(", ").any(|known| known == key) {
            return Err(input(&path, given, format!("cannot be combined with kind = \"{kind}\""), remedy));
        }
        if matches!(given, Size::One(load) if load < 0.0) {
            let problem = "must be above zero: compression alone does not grow a crack";
            let remedy = "give the maximum tension (range: maximum - minimum); for compression set stress_ratio = minimum / \
                          maximum below 0";
            return Err(input(&path, given, problem, remedy));
        }
        let (value, course) = given.read(&path, quantity, specimen.crack_length)?;
        Ok(Magnitude { key: path, given, value, course, is_range: key.contains("range"), of })
    }
}
