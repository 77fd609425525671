//! Standard specimens at default resolution, and their lives by quadrature with K of finite elements.

use super::scene::{MATERIAL_AND_LAW, PULL, case, points};
use crate::calibration::median::cycles_of_run;
use crate::case::Case;
use crate::error::{Error, Result};
use crate::predict::{Observer, Prediction, Silent, StopReason, predict};
use crate::quadrature::integrate;
use crate::specimen::handbook::handbook;
use crate::specimen::{LoadMeasure, Specimen};
use crate::units::{MM, MPA_SQRT_M};

/// K of finite elements: specimen, crack length in mm, K_I in MPa√m at 100 MPa or 10 kN.
const STANDARD_SPECIMENS: &str = include_str!("../../tests/reference/standard_specimens.csv");
/// Where the reference of [`Standard::over_quadrature`] comes from.
pub const ELEMENTS: &str = "quadrature, K of finite elements (tests/reference), 0.05 %";

/// Where the reference of [`Standard::factors_of_elements`] comes from.
pub const ELEMENTS_OF_K: &str = "finite elements (tests/reference/standard_specimens.csv), 0.05 %";

/// A specimen and the growth of its crack.
#[derive(Debug, Clone)]
pub struct Standard {
    /// As ASTM E647 has it.
    pub name: &'static str,
    text: String,
    /// First and last length, mm.
    pub range: [f64; 2],
}

/// M(T), C(T), SE(T) and DE(T), from a quarter to three quarters of their width about.
pub fn standard_specimens() -> [Standard; 4] {
    let pulled =
        |keys: &str| format!("{keys}\nlength_mm = {}\nthickness_mm = 2\n{PULL}", if keys.contains("single") { 150 } else { 300 });
    [
        Standard {
            name: "M(T)",
            text: pulled("kind = \"middle_tension\"\nwidth_mm = 100\ncrack_length_mm = 10"),
            range: [10.0, 38.0],
        },
        Standard {
            name: "C(T)",
            text: "kind = \"compact_tension\"\nwidth_mm = 50\nthickness_mm = 10\ncrack_length_mm = 15\n[loading]\nforce_max_n = 5000\nstress_ratio = 0.1\n".to_owned(),
            range: [15.0, 35.0],
        },
        Standard {
            name: "SE(T)",
            text: pulled("kind = \"single_edge_tension\"\nends = \"uniform_stress\"\nwidth_mm = 50\ncrack_length_mm = 8"),
            range: [8.0, 28.0],
        },
        Standard {
            name: "DE(T)",
            text: pulled("kind = \"double_edge_tension\"\nwidth_mm = 100\ncrack_length_mm = 12"),
            range: [12.0, 38.0],
        },
    ]
}

impl Standard {
    /// The same with another range of crack lengths, mm.
    pub fn from_to(mut self, range: [f64; 2]) -> Self {
        self.range = range;
        self
    }

    /// Life over that by quadrature of the same law with K of finite elements, other keys set by `section.key=value`.
    pub fn over_quadrature(&self, set: &[&str]) -> Result<f64> {
        self.over_quadrature_watched(set, &Silent)
    }

    /// [`Standard::over_quadrature`] with an observer of the run, which may end it.
    ///
    /// # Errors
    /// As [`predict`]; a run that ends before the last length.
    pub fn over_quadrature_watched(&self, set: &[&str], observer: &dyn Observer) -> Result<f64> {
        let run = predict(&self.case(set)?, observer)?;
        if run.stop != StopReason::CrackLengthReached {
            return Err(Error::Mechanics(format!("{} ended before its last length: {}", self.name, run.stop)));
        }
        Ok(run.life_cycles() / self.by_quadrature(set, self.range[1])?)
    }

    /// Life to a length, mm, by quadrature with K of finite elements, cycles.
    fn by_quadrature(&self, set: &[&str], to: f64) -> Result<f64> {
        let range = [self.range[0], to];
        let by_hand = self.clone().from_to(range).case(&[set, &["model.method=handbook"]].concat())?;
        Ok(predict(&by_hand, &Silent)?.life_cycles() * over_handbook(&by_hand, range)?)
    }

    /// The largest error of the cycles of a run at shares of the growth, percent, against [`Standard::over_quadrature`]'s reference.
    ///
    /// # Errors
    /// A run that ends before one of these lengths.
    pub fn error_percent(&self, run: &Prediction, shares: &[f64]) -> Result<f64> {
        let [from, to] = self.range;
        let lengths: Vec<f64> = [0.0].iter().chain(shares).map(|share| from + share * (to - from)).collect();
        let cycles = cycles_of_run(&points(run), &lengths.iter().map(|length| length * MM).collect::<Vec<_>>())?;
        let mut largest = 0.0_f64;
        for (length, cycles) in lengths.iter().zip(&cycles).skip(1) {
            let error = 100.0 * (cycles / self.by_quadrature(&[], *length)? - 1.0);
            largest = if error.abs() > largest.abs() { error } else { largest };
        }
        Ok(largest)
    }

    /// Life, cycles.
    pub fn life(&self, set: &[&str]) -> Result<f64> {
        Ok(predict(&self.case(set)?, &Silent)?.life_cycles())
    }

    /// Crack lengths, mm, with K_I of finite elements under the load of [`Standard::at`], Pa√m.
    pub fn factors_of_elements(&self) -> Result<Vec<[f64; 2]>> {
        let case = self.case(&[])?;
        let load = case.loading.maximum / load_of_table(&case.specimen);
        Ok(known_factors(case.specimen.kind.name()).map(|[a, k]| [a, k * load]).collect())
    }

    /// The case at a crack length, mm.
    pub fn at(&self, length: f64, set: &[&str]) -> Result<Case> {
        // Grown by nothing to speak of.
        self.clone().from_to([length, 1.001 * length]).case(set)
    }

    /// Its case, other keys set by `section.key=value`.
    pub fn case(&self, set: &[&str]) -> Result<Case> {
        let [from, to] = self.range;
        let range = [format!("specimen.crack_length_mm={from}"), format!("stop.crack_length_mm={to}")];
        case(&format!("[specimen]\n{}{MATERIAL_AND_LAW}", self.text), &[&[&*range[0], &*range[1]], set].concat())
    }
}

/// Load of the table: 100 MPa, or 10 kN.
fn load_of_table(specimen: &Specimen) -> f64 {
    if specimen.load_measure == LoadMeasure::Force { 1e4 } else { 1e8 }
}

/// Crack lengths, mm, and K_I, Pa√m, of a specimen of the table.
fn known_factors(name: &str) -> impl Iterator<Item = [f64; 2]> {
    STANDARD_SPECIMENS
        .lines()
        .filter_map(move |line| line.strip_prefix(name)?.strip_prefix(',')?.split_once(','))
        .filter_map(|(a, k)| Some([a.parse().ok()?, k.parse::<f64>().ok()? * MPA_SQRT_M]))
}

/// Life with K by finite elements over that with the handbook's, between two lengths, mm. Their ratio is taken linear between the
/// lengths of the table; K of finite elements is right to 0.05 % (`tests/reference/README.md`), the formulas to 0.1 to 1 %.
fn over_handbook(case: &Case, [from, to]: [f64; 2]) -> Result<f64> {
    let specimen = &case.specimen;
    let m = case.paris_law()?.m;
    let name = specimen.kind.name();
    let formula = handbook(specimen).ok_or_else(|| Error::Mechanics(format!("no handbook formula for {name}")))?;
    let load = load_of_table(specimen);
    let ratios: Vec<[f64; 2]> = known_factors(name).map(|[a, k]| [a, k / formula.k_i(a * MM, load)]).collect();
    let ratio = |a: f64| {
        let next = ratios.partition_point(|known| known[0] < a).clamp(1, ratios.len() - 1);
        let ([a0, r0], [a1, r1]) = (ratios[next - 1], ratios[next]);
        r0 + (a - a0) / (a1 - a0) * (r1 - r0)
    };
    let life = |k: &dyn Fn(f64) -> f64| integrate(|a| k(a).powf(-m), from, to, 1e-8).value;
    let by_formula = |a: f64| formula.k_i(a * MM, load) / MPA_SQRT_M;
    Ok(life(&|a| ratio(a) * by_formula(a)) / life(&by_formula))
}
