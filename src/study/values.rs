//! Values by name, formulas over them, and texts with formulas in angle brackets: what lets one line of a study stand for many.
//!
//! A value that begins with `=` is a formula itself. `<formula>` in a text becomes its value, `<formula:2>` with two decimals; a name of
//! a text becomes that text, in which brackets are filled again.

use std::f64::consts::PI;
use std::str::FromStr;

use toml::{Table, Value};

use perilife_base::error::{Error, Result, fail_if};
use perilife_growth::cracks::steering::kink_angle;
use perilife_plate::loading::formula::Formula;

/// What a name stands for that is no value: a reading of a run. `None` of a name that nobody knows.
pub type Reading<'a> = &'a dyn Fn(&str, &[f64]) -> Option<Result<f64>>;

const DEPTH_MOST: usize = 8;

#[derive(Clone, Copy)]
pub struct Values<'a> {
    pub table: &'a Table,
    pub reading: Reading<'a>,
}

pub fn wrong(what: &str, problem: impl std::fmt::Display) -> Error {
    Error::Mechanics(format!("data/studies: {what}: {problem}"))
}

impl<'a> Values<'a> {
    pub fn alone(table: &'a Table) -> Self {
        Values { table, reading: &|_, _| None }
    }

    pub fn number(&self, formula: &str) -> Result<f64> {
        let read = Formula::parse_named(formula).map_err(|problem| wrong(formula, problem))?;
        read.of_names(|name, values| self.named(name, values))
    }

    pub fn figure(&self, value: &Value) -> Result<f64> {
        match value {
            Value::Integer(whole) => Ok(*whole as f64),
            Value::Float(number) => Ok(*number),
            Value::String(formula) => self.number(formula.strip_prefix('=').unwrap_or(formula)),
            other => Err(wrong(&other.to_string(), "is neither a number nor a formula")),
        }
    }

    fn named(&self, name: &str, values: &[f64]) -> Result<f64> {
        match self.table.get(name).filter(|_| values.is_empty()) {
            Some(value) => self.figure(value),
            None => match closed(name, values) {
                Some(value) => Ok(value),
                None => (self.reading)(name, values).unwrap_or_else(|| Err(wrong(name, "is neither a value nor a reading"))),
            },
        }
    }

    pub fn text(&self, text: &str) -> Result<String> {
        self.filled(text, DEPTH_MOST)
    }

    fn filled(&self, text: &str, depth: usize) -> Result<String> {
        let mut all = String::new();
        let mut rest = text;
        while let Some((before, after)) = rest.split_once('<') {
            let (inner, behind) = after.split_once('>').ok_or_else(|| wrong(text, "has no closing angle bracket"))?;
            all += before;
            all += &match (inner.rsplit_once(':'), self.table.get(inner)) {
                (_, Some(Value::String(own))) if depth > 0 && !own.starts_with('=') => self.filled(own, depth - 1)?,
                (Some((formula, decimals)), _) => {
                    let decimals: usize = decimals.parse().map_err(|_| wrong(inner, "has no number of decimals"))?;
                    format!("{:.decimals$}", self.number(formula)?)
                }
                _ => self.number(inner)?.to_string(),
            };
            rest = behind;
        }
        Ok(all + rest)
    }
}

/// Every combination of the values of some axes, the first outermost. The columns of an axis go together; what is no list stays.
pub fn combinations(axes: &[Table]) -> Result<Vec<Table>> {
    axes.iter().try_fold(vec![Table::new()], |before, axis| {
        let lengths: Vec<usize> = axis.values().filter_map(|column| Some(column.as_array()?.len())).collect();
        let count = lengths.iter().copied().max().unwrap_or(1);
        fail_if!(lengths.iter().any(|length| *length != count), wrong(&axis.to_string(), "has columns of different lengths"));
        let place = |at: usize| axis.iter().map(move |(name, column)| (name.clone(), column.get(at).unwrap_or(column).clone()));
        let longer =
            |table: &Table| (0..count).map(|at| table.clone().into_iter().chain(place(at)).collect()).collect::<Vec<Table>>();
        Ok(before.iter().flat_map(longer).collect())
    })
}

pub fn closed(name: &str, values: &[f64]) -> Option<f64> {
    match (name, values) {
        ("percent", [computed, truth]) => Some(percent(*computed, *truth)),
        ("round", [value]) => Some(value.round()),
        ("part", [value]) => Some(value.fract()),
        ("radians", [degrees]) => Some(degrees.to_radians()),
        ("degrees", [radians]) => Some(radians.to_degrees()),
        // Largest circumferential stress (Erdogan and Sih 1963), rad.
        ("kink", [k_i, k_ii]) => Some(kink_angle([*k_i, *k_ii])),
        ("collinear_inner", [inner, outer, width]) => Some(Collinear { inner: *inner, outer: *outer }.intensity_in(*width)[0]),
        ("collinear_outer", [inner, outer, width]) => Some(Collinear { inner: *inner, outer: *outer }.intensity_in(*width)[1]),
        ("collinear_growth", [inner, outer, ligament, width, stress, p]) => {
            Some(growth_integral(Collinear { inner: *inner, outer: *outer }, *ligament, *width, *stress, *p))
        }
        ("strip_with_hole", [x]) => Some(concentration_of(*x)),
        _ => None,
    }
}

pub fn percent(computed: f64, truth: f64) -> f64 {
    100.0 * (computed / truth - 1.0)
}

/// Largest stress over that far away of a hole of d/W = x in a strip in tension: (3 - 3.14 x + 3.667 x² - 1.527 x³)/(1 - x), a fit to
/// Howland 1930 within 0.5 % (Pilkey and Pilkey 2008).
#[allow(clippy::approx_constant, reason = "a coefficient of the fit, not π")]
pub fn concentration_of(x: f64) -> f64 {
    (3.0 - x * (3.14 - x * (3.667 - 1.527 * x))) / (1.0 - x)
}

/// Two equal cracks at c < |x| < d in an infinite plate under uniform stress across them (Tada, Paris and Irwin 2000, The Stress Analysis of
/// Cracks Handbook): `K_inner = σ √π (d² e - c²) / √(c (d² - c²))`, `K_outer = σ √(π d) (1 - e) / k`, with `k² = 1 - c²/d²` and
/// `e = E(k)/K(k)` of the complete elliptic integrals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Collinear {
    /// Half of the ligament between the cracks, m.
    pub inner: f64,
    /// Half of the distance between the outer tips, m.
    pub outer: f64,
}

impl Collinear {
    /// K over the stress of the inner and of the outer tips, √m.
    pub fn intensity(&self) -> [f64; 2] {
        let (c, d) = (self.inner, self.outer);
        let modulus = (1.0 - (c / d).powi(2)).sqrt();
        let e = elliptic_ratio(modulus);
        [PI.sqrt() * (d * d * e - c * c) / (c * (d * d - c * c)).sqrt(), (PI * d).sqrt() * (1.0 - e) / modulus]
    }

    /// Half length of the single crack that disturbs the plate far away as much as the two do, m.
    ///
    /// On the line of the cracks, far off, `σ_y/σ = 1 + a²/(2x²)` for a crack of half length a, and
    /// `1 + ((c² + d²)/2 - e d²)/x²` for two.
    pub fn equivalent_crack(&self) -> f64 {
        let (c, d) = (self.inner, self.outer);
        let e = elliptic_ratio((1.0 - (c / d).powi(2)).sqrt());
        (c * c + d * d - 2.0 * e * d * d).sqrt()
    }

    /// [`Collinear::intensity`] in a plate of finite width, times `√(sec(π a/W))` of the equivalent crack (Feddersen 1966):
    /// the free sides raise the stress around both cracks alike, to the leading order in a/W.
    pub fn intensity_in(&self, width: f64) -> [f64; 2] {
        let sides = (PI * self.equivalent_crack() / width).cos().powf(-0.5);
        self.intensity().map(|k| k * sides)
    }
}

/// E(k)/K(k) by the arithmetic-geometric mean: `1 - Σ 2^(n-1) c_n²` (Abramowitz and Stegun 1964, 17.6).
fn elliptic_ratio(modulus: f64) -> f64 {
    let (mut a, mut b, mut c) = (1.0_f64, (1.0 - modulus * modulus).sqrt(), modulus);
    let (mut sum, mut power) = (0.5 * c * c, 0.5);
    // Converges quadratically; eight means leave nothing for any modulus a plate can have.
    for _ in 0..8 {
        (a, b, c) = (0.5 * (a + b), (a * b).sqrt(), 0.5 * (a - b));
        power *= 2.0;
        sum += power * c * c;
    }
    1.0 - sum
}

/// ∫ dN C of the inner tips growing from `start` until their half ligament is `ligament`, m, by `da/dN = C ΔK^p` at a stress
/// range of `stress`; the outer tips grow meanwhile (classical Runge-Kutta over the inner tips' way).
pub fn growth_integral(start: Collinear, ligament: f64, width: f64, stress: f64, p: f64) -> f64 {
    const STEPS: usize = 400;
    let step = (start.inner - ligament) / STEPS as f64;
    // Per metre of the inner tips: (C dN, growth of the outer tips).
    let slope = |way: f64, outer: f64| {
        let [k_inner, k_outer] = Collinear { inner: start.inner - way, outer }.intensity_in(width);
        ((stress * k_inner).powf(-p), (k_outer / k_inner).powf(p))
    };
    let (mut cycles, mut outer) = (0.0, start.outer);
    for i in 0..STEPS {
        let way = i as f64 * step;
        let a = slope(way, outer);
        let b = slope(way + 0.5 * step, outer + 0.5 * step * a.1);
        let c = slope(way + 0.5 * step, outer + 0.5 * step * b.1);
        let d = slope(way + step, outer + step * c.1);
        cycles += step / 6.0 * (a.0 + 2.0 * b.0 + 2.0 * c.0 + d.0);
        outer += step / 6.0 * (a.1 + 2.0 * b.1 + 2.0 * c.1 + d.1);
    }
    cycles
}

pub type Figures = Vec<(&'static str, f64)>;

pub struct Keys<'a>(pub &'a [String]);

impl Keys<'_> {
    pub fn get<T: FromStr>(&self, name: &str) -> Result<T> {
        let value = self.0.iter().find_map(|key| key.strip_prefix(name)?.strip_prefix('='));
        let read = value.and_then(|value| value.parse().ok());
        read.ok_or_else(|| Error::Mechanics(format!("data/studies: keys \"{}\": no {name}", self.0.join(" "))))
    }
}
