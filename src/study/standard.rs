//! Standard specimens at default resolution, and their lives by quadrature with K of finite elements.

use super::cases::{MATERIAL_AND_LAW, case_of, overrides, points};
use perilife_base::error::{Error, Result};
use perilife_base::quadrature::integrate;
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_calibration::median::cycles_of_run;
use perilife_growth::case::Case;
use perilife_growth::predict::{Prediction, Silent, StopReason, predict};
use perilife_plate::specimen::handbook::handbook;
use perilife_plate::specimen::{LoadMeasure, Specimen};

/// K of finite elements: specimen, crack length in mm, K_I in MPa√m at 100 MPa or 10 kN. Right to 0.05 % (`tests/reference/README.md`).
const FACTORS: &str = include_str!("../../data/reference/standard_specimens.csv");

/// A specimen and the growth of its crack.
#[derive(Debug, Clone, Copy)]
pub struct Standard {
    /// As ASTM E647 has it.
    pub name: &'static str,
    /// Its sections `[specimen]` and `[loading]`.
    keys: &'static str,
    /// First and last length, mm.
    pub range: [f64; 2],
}

/// M(T), 2a/W 0.2 to 0.76.
pub const MIDDLE_TENSION: Standard = Standard {
    name: "M(T)",
    keys: "kind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 300\nthickness_mm = 2\ncrack_length_mm = 10\n\
           [loading]\nstress_max_mpa = 60\nstress_ratio = 0.1\n",
    range: [10.0, 38.0],
};
/// C(T), a/W 0.3 to 0.7.
pub const COMPACT_TENSION: Standard = Standard {
    name: "C(T)",
    keys: "kind = \"compact_tension\"\nwidth_mm = 50\nthickness_mm = 10\ncrack_length_mm = 15\n\
           [loading]\nforce_max_n = 5000\nstress_ratio = 0.1\n",
    range: [15.0, 35.0],
};
/// SE(T), a/W 0.16 to 0.56.
pub const SINGLE_EDGE: Standard = Standard {
    name: "SE(T)",
    keys: "kind = \"single_edge_tension\"\nends = \"uniform_stress\"\nwidth_mm = 50\nlength_mm = 150\nthickness_mm = 2\n\
           crack_length_mm = 8\n[loading]\nstress_max_mpa = 60\nstress_ratio = 0.1\n",
    range: [8.0, 28.0],
};
/// DE(T), 2a/W 0.24 to 0.76.
pub const DOUBLE_EDGE: Standard = Standard {
    name: "DE(T)",
    keys: "kind = \"double_edge_tension\"\nwidth_mm = 100\nlength_mm = 300\nthickness_mm = 2\ncrack_length_mm = 12\n\
           [loading]\nstress_max_mpa = 60\nstress_ratio = 0.1\n",
    range: [12.0, 38.0],
};
/// All of them.
pub const STANDARD: [Standard; 4] = [MIDDLE_TENSION, COMPACT_TENSION, SINGLE_EDGE, DOUBLE_EDGE];

impl Standard {
    /// The same with another range of crack lengths, mm.
    pub const fn from_to(self, range: [f64; 2]) -> Self {
        Standard { range, ..self }
    }

    /// Its case, other keys set.
    pub fn case(&self, set: &[String]) -> Result<Case> {
        let [from, to] = self.range;
        let range = format!("specimen.crack_length_mm={from} stop.crack_length_mm={to}");
        case_of(&self.text(), &[&overrides(&range), set].concat())
    }

    /// The life of a run over that by quadrature with the same keys and K of finite elements.
    pub fn over_quadrature(&self, run: &Prediction, set: &[String]) -> Result<f64> {
        if run.stop != StopReason::CrackLengthReached {
            return Err(Error::Mechanics(format!("{} ended before its last length: {}", self.name, run.stop)));
        }
        Ok(run.life_cycles() / self.by_quadrature(set, self.range[1])?)
    }

    /// The largest error of the cycles of a run at shares of the growth, percent, against quadrature.
    pub fn largest_error(&self, run: &Prediction, shares: &[f64]) -> Result<f64> {
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

    /// Life to a length, mm, by quadrature with K of finite elements, cycles.
    fn by_quadrature(&self, set: &[String], to: f64) -> Result<f64> {
        let range = [self.range[0], to];
        let by_hand = self.from_to(range).case(&[set, &overrides("model.method=handbook")].concat())?;
        Ok(predict(&by_hand, &Silent)?.life_cycles() * over_handbook(&by_hand, range)?)
    }

    /// Crack lengths, mm, with K_I of finite elements under the load of the case, Pa√m.
    pub fn factors_of_elements(&self) -> Result<Vec<[f64; 2]>> {
        let case = self.case(&[])?;
        let load = case.loading.maximum / load_of_table(&case.specimen);
        Ok(known_factors(case.specimen.kind.name()).map(|[a, k]| [a, k * load]).collect())
    }

    /// Text of its case.
    pub fn text(&self) -> String {
        format!("[specimen]\n{}{MATERIAL_AND_LAW}", self.keys)
    }
}

/// Load of the table: 100 MPa, or 10 kN.
fn load_of_table(specimen: &Specimen) -> f64 {
    if specimen.load_measure == LoadMeasure::Force { 1e4 } else { 1e8 }
}

/// Crack lengths, mm, and K_I, Pa√m, of a specimen of the table.
fn known_factors(name: &str) -> impl Iterator<Item = [f64; 2]> {
    FACTORS
        .lines()
        .filter_map(move |line| line.strip_prefix(name)?.strip_prefix(',')?.split_once(','))
        .filter_map(|(a, k)| Some([a.parse().ok()?, k.parse::<f64>().ok()? * MPA_SQRT_M]))
}

/// Life with K by finite elements over that with the handbook's, between two lengths, mm. Their ratio is taken linear between the
/// lengths of the table; the formulas are right to 0.1 to 1 %.
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
