//! One key that varies: `[[vary]]` of a sweep file.

use toml::Value;

use super::distribution::Distribution;
use perilife_base::error::{Error, Result, fail_if, input, input_missing};
use perilife_base::keys::{Given, key, section};
use perilife_growth::case::SECTIONS;
use perilife_laws::growth_law::description::law_keys;

perilife_base::kinds! {
    pub enum DesignKind for "design.kind" {
        Grid = "grid": "every combination of the values of all keys, the last key fastest",
        LatinHypercube = "latin_hypercube": "random (Latin hypercube): one value of each key from each stratum",
        FittedScatter = "fitted_scatter": "growth law sampled from the scatter of a calibration; other keys may vary too",
    }

    pub enum DistributionKind for "vary.distribution" {
        Uniform = "uniform": "uniform between from and to",
        LogUniform = "log_uniform": "uniform in the logarithm between from and to",
        Normal = "normal": "normal, with mean and standard_deviation",
        LogNormal = "log_normal": "the logarithm is normal, with median and standard_deviation_ln, or factor = exp of it",
    }

    /// How the values of a grid lie between two.
    pub enum Scale for "vary.scale" {
        Linear = "linear": "equal differences",
        Log = "log": "equal ratios",
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Vary {
    pub key: String,
    pub spread: Spread,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Spread {
    Values(Vec<Value>),
    Random(Distribution),
}

perilife_base::keys! {
    pub struct VaryKeys {
        key: String = key("key", "Key of the case: section.key");
        values: Option<Vec<Value>> = key("values", "Values: of a grid");
        from: Option<f64> = key("from", "Least value");
        to: Option<f64> = key("to", "Largest value");
        count: Option<usize> = key("count", "Number of values: of a grid, both ends included");
        scale: Option<Scale> = key("scale", "Scale: of a grid");
        distribution: Option<DistributionKind> = key("distribution", "Distribution: of a random design");
        mean: Option<f64> = key("mean", "Mean: of a normal distribution");
        standard_deviation: Option<f64> = key("standard_deviation", "Standard deviation: of a normal distribution");
        median: Option<f64> = key("median", "Median: of a log-normal distribution");
        factor: Option<f64> = key("factor", "Factor: exp of the standard deviation of ln");
        standard_deviation_ln: Option<f64> = key("standard_deviation_ln", "Standard deviation of ln");
    }
}

impl Vary {
    /// Reads one of a design of this kind; `path` is its place in the file, `most` the number of cases that there may be.
    pub(super) fn read(value: &Value, path: &str, kind: DesignKind, most: usize) -> Result<Self> {
        let (input, given) = (section::<VaryKeys>(value, path)?, Given::of(value, path)?);
        check_key(&input.key, path, kind)?;
        let reader = Reader { input: &input, given };
        let spread = match kind {
            DesignKind::Grid => reader.grid(most)?,
            DesignKind::LatinHypercube | DesignKind::FittedScatter => reader.random(kind)?,
        };
        Ok(Vary { key: input.key, spread })
    }
}

/// A key of a case, and not one that the design itself gives.
fn check_key(key: &str, path: &str, kind: DesignKind) -> Result<()> {
    let place = format!("{path}.key");
    let (section, rest) = key.split_once('.').unwrap_or((key, ""));
    if !SECTIONS.contains(&section) || rest.is_empty() {
        let remedy = format!("write section.key, for example specimen.crack_length_mm; sections: {}", SECTIONS.join(", "));
        return Err(input(&place, format!("\"{key}\""), "is not a key of a case", remedy));
    }
    if kind == DesignKind::FittedScatter && section == "fatigue" && law_keys().any(|key| key == rest) {
        let remedy = format!("remove it, or use design.kind = \"{}\"", DesignKind::LatinHypercube);
        return Err(input(&place, format!("\"{key}\""), format!("is already sampled by design.kind = \"{kind}\""), remedy));
    }
    Ok(())
}

struct Reader<'a> {
    input: &'a VaryKeys,
    given: Given<'a>,
}

const OF_DISTRIBUTIONS: [&str; 6] = ["distribution", "mean", "standard_deviation", "median", "factor", "standard_deviation_ln"];
const OF_SPACING: [&str; 4] = ["from", "to", "count", "scale"];

impl Reader<'_> {
    fn grid(&self, most: usize) -> Result<Spread> {
        let problem = "applies only to a random design; this is a grid";
        self.given.refuse_any(&OF_DISTRIBUTIONS, problem, "give values, or from, to and count")?;
        let Some(values) = &self.input.values else { return self.spaced(most) };
        self.given.refuse_any(&OF_SPACING, "conflicts with values", "give values, or from, to and count")?;
        fail_if!(values.is_empty(), input(&self.key("values"), "[]", "is empty", "give at least one value"));
        if let Some(value) = values.iter().find(|value| value.as_float().is_some_and(|number| !number.is_finite())) {
            return Err(input(&self.key("values"), value, "is not a finite number", "give finite numbers"));
        }
        Ok(Spread::Values(values.clone()))
    }

    /// `count` values between two, both among them.
    fn spaced(&self, most: usize) -> Result<Spread> {
        let (from, to) = (self.number("from", self.input.from)?, self.number("to", self.input.to)?);
        let count = self.input.count.ok_or_else(|| self.missing("count"))?;
        if !(2..=most.max(2)).contains(&count) {
            let remedy = format!("give 2 to {}", most.max(2));
            return Err(input(&self.key("count"), count, "is not a number of values between two", remedy));
        }
        let scale = self.input.scale.unwrap_or(Scale::Linear);
        if scale == Scale::Log {
            self.above_zero("from", from)?;
            self.above_zero("to", to)?;
        }
        let value = |i: usize| {
            let share = i as f64 / (count - 1) as f64;
            match scale {
                // The ends are those that were given, to the last bit.
                _ if i == 0 => from,
                _ if i + 1 == count => to,
                Scale::Linear => from + share * (to - from),
                Scale::Log => from * (to / from).powf(share),
            }
        };
        Ok(Spread::Values((0..count).map(|i| Value::Float(value(i))).collect()))
    }

    fn random(&self, kind: DesignKind) -> Result<Spread> {
        let input = self.input;
        let problem = format!("applies only to a grid; this is a design of kind \"{kind}\"");
        self.given.refuse_any(&["values", "count", "scale"], &problem, "give a distribution")?;
        let shape = input.distribution.ok_or_else(|| self.missing("distribution"))?;
        let own: &[&str] = match shape {
            DistributionKind::Uniform | DistributionKind::LogUniform => &["from", "to"],
            DistributionKind::Normal => &["mean", "standard_deviation"],
            DistributionKind::LogNormal => &["median", "factor", "standard_deviation_ln"],
        };
        let strangers: Vec<&str> =
            OF_DISTRIBUTIONS[1..].iter().chain(&OF_SPACING).copied().filter(|key| !own.contains(key)).collect();
        let problem = format!("cannot be combined with distribution = \"{shape}\"");
        self.given.refuse_any(&strangers, &problem, &format!("give {}", own.join(" and ")))?;
        Ok(Spread::Random(match shape {
            DistributionKind::Uniform => {
                let [from, to] = self.rising()?;
                Distribution::Uniform { from, to }
            }
            DistributionKind::LogUniform => {
                let [from, to] = self.rising()?;
                self.above_zero("from", from)?;
                Distribution::LogUniform { from, to }
            }
            DistributionKind::Normal => {
                let mean = self.number("mean", input.mean)?;
                let deviation = self.number("standard_deviation", input.standard_deviation)?;
                Distribution::Normal { mean, deviation: self.above_zero("standard_deviation", deviation)? }
            }
            DistributionKind::LogNormal => {
                let median = self.number("median", input.median)?;
                Distribution::LogNormal { median: self.above_zero("median", median)?, deviation_ln: self.deviation_ln()? }
            }
        }))
    }

    fn deviation_ln(&self) -> Result<f64> {
        match (self.input.factor, self.input.standard_deviation_ln) {
            (Some(factor), None) => {
                if factor.is_finite() && factor > 1.0 {
                    return Ok(factor.ln());
                }
                let remedy = "factor = exp(standard deviation of ln): 68 % within median ÷ or × factor";
                Err(input(&self.key("factor"), factor, "must be above 1", remedy))
            }
            (None, given) => {
                let deviation = self.number("standard_deviation_ln", given)?;
                self.above_zero("standard_deviation_ln", deviation)
            }
            (Some(factor), Some(_)) => {
                let problem = "conflicts with standard_deviation_ln";
                Err(input(&self.key("factor"), factor, problem, "remove one of them"))
            }
        }
    }

    fn rising(&self) -> Result<[f64; 2]> {
        let (from, to) = (self.number("from", self.input.from)?, self.number("to", self.input.to)?);
        fail_if!(from >= to, input(&self.key("to"), to, format!("is not above from = {from}"), "give from < to"));
        Ok([from, to])
    }

    fn number(&self, key: &str, value: Option<f64>) -> Result<f64> {
        let value = value.ok_or_else(|| self.missing(key))?;
        fail_if!(!value.is_finite(), input(&self.key(key), value, "is not a finite number", "give a finite number"));
        Ok(value)
    }

    fn above_zero(&self, key: &str, value: f64) -> Result<f64> {
        fail_if!(value <= 0.0, input(&self.key(key), value, "must be above zero", "give a number above zero"));
        Ok(value)
    }

    fn key(&self, key: &str) -> String {
        self.given.path_of(key)
    }

    fn missing(&self, key: &str) -> Error {
        let remedy = match key {
            "from" | "to" | "count" if self.input.distribution.is_none() => "give values, or from, to and count",
            "distribution" => "give uniform, log_uniform, normal or log_normal",
            _ => "give the parameters of the distribution; `perilife list` shows them",
        };
        input_missing(&self.key(key), "is missing", remedy)
    }
}
