//! US customary units beside the metric ones of input files, tables and messages: how both are spelled, how large they are, and the one
//! rule by which a key or column goes from one system to the other.

use super::{GPA, INCH, KN, KSI, LBF, MM, MPA, MPA_SQRT_M, SQRT_INCH};

crate::kinds! {
    /// Units in which quantities are written and printed.
    pub enum System for "--units" {
        Si = "si": "mm, MPa, GPa, N, MPa√m, mm/cycle",
        Us = "us": "inch, ksi, Msi, lbf, kip, ksi√in, in/cycle",
    }
}

impl System {
    pub fn other(self) -> System {
        match self {
            System::Si => System::Us,
            System::Us => System::Si,
        }
    }
}

/// A unit of both systems, the metric one first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    suffix: [&'static str; 2],
    /// Name in words, pictures and messages.
    pub(super) word: [&'static str; 2],
    /// Metric units in one of the US.
    size: f64,
}

/// MPa√m in a ksi√in.
pub const KSI_SQRT_IN: f64 = KSI * SQRT_INCH / MPA_SQRT_M;

const fn unit(suffix: [&'static str; 2], word: [&'static str; 2], size: f64) -> Unit {
    Unit { suffix, word, size }
}

/// All of them; a name that ends as another does stands before that.
pub const UNITS: [Unit; 11] = [
    unit(["mpa_sqrt_m", "ksi_sqrt_in"], ["MPa√m", "ksi√in"], KSI_SQRT_IN),
    unit(["mm_per_cycle", "in_per_cycle"], ["mm/cycle", "in/cycle"], INCH / MM),
    unit(["mm_s", "in_s"], ["mm/s", "in/s"], INCH / MM),
    unit(["j_m2", "lbf_in"], ["J/m²", "lbf/in"], LBF / INCH),
    unit(["j", "in_lbf"], ["J", "in·lbf"], LBF * INCH),
    // Pounds of 0.453 592 37 kg.
    unit(["kg_m3", "lb_in3"], ["kg/m³", "lb/in³"], 0.453_592_37 / (INCH * INCH * INCH)),
    unit(["mm", "in"], ["mm", "inch"], INCH / MM),
    unit(["mpa", "ksi"], ["MPa", "ksi"], KSI / MPA),
    unit(["gpa", "msi"], ["GPa", "Msi"], 1e3 * KSI / GPA),
    unit(["kn", "kip"], ["kN", "kip"], 1e3 * LBF / KN),
    unit(["n", "lbf"], ["N", "lbf"], LBF),
];

/// Names that end as a unit does and are no number in it: an exponent, and formulas, whose reader knows their units.
const NO_QUANTITIES: [&str; 3] = ["nasgro_n", "residual_stress_mpa", "residual_stress_ksi"];

impl Unit {
    /// Its end of keys in a system.
    pub fn suffix(&self, of: System) -> &'static str {
        self.suffix[of as usize]
    }

    pub fn word(&self, of: System) -> &'static str {
        self.word[of as usize]
    }

    /// Units of `to` in one of the other system.
    pub fn factor(&self, to: System) -> f64 {
        if to == System::Us { 1.0 / self.size } else { self.size }
    }

    pub fn named(word: &str, of: System) -> Option<&'static Unit> {
        UNITS.iter().find(|unit| unit.word(of) == word)
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Renamed {
    pub name: String,
    /// What a number is multiplied by; of the level of a law, with ΔK^m, what it would be at the exponent 0.
    factor: f64,
    /// Of the level C of a law: the names its exponent may have, and what is taken off that (1 of Forman's, whose denominator has a K).
    exponent: Option<(Vec<String>, f64)>,
}

impl Renamed {
    /// What a number is multiplied by; `sibling` gives the numbers that stand beside it.
    ///
    /// The level of a law belongs to the unit of ΔK: `da/dN = C ΔK^m` has `C_mm = 25.4 C_in / 1.0988^m`, MPa√m in a ksi√in being 1.0988.
    /// Errors: the exponent that is missing, by its usual name.
    pub fn factor(&self, sibling: impl Fn(&str) -> Option<f64>) -> std::result::Result<f64, &str> {
        let Some((names, less)) = &self.exponent else { return Ok(self.factor) };
        let exponent = names.iter().find_map(|name| sibling(name)).ok_or_else(|| names.first().map_or("", String::as_str))?;
        let to_us = self.factor < 1.0;
        Ok(self.factor * KSI_SQRT_IN.powf(if to_us { exponent - less } else { less - exponent }))
    }
}

/// A key or column of one system as `to` names it; `None` where it has no unit of the other.
pub fn renamed(name: &str, to: System) -> Option<Renamed> {
    let from = to.other();
    let stem = |unit: &&Unit| {
        let stem = name.strip_suffix(unit.suffix(from))?;
        (stem.is_empty() || stem.ends_with('_')).then_some(stem)
    };
    let unit = UNITS.iter().find(|unit| stem(unit).is_some()).filter(|_| !NO_QUANTITIES.iter().any(|own| name.ends_with(own)))?;
    let stem = stem(&unit)?;
    let law = stem.strip_suffix("c_used_").or(stem.strip_suffix("c_")).filter(|law| law.ends_with('_'));
    let exponent = law.filter(|_| unit.suffix[0] == "mm_per_cycle").map(|law| {
        let own = if law.ends_with("nasgro_") { "n" } else { "m" };
        (vec![format!("{law}{own}"), "paris_m".to_owned(), "p".to_owned()], f64::from(u8::from(law.ends_with("forman_"))))
    });
    Some(Renamed { name: format!("{stem}{}", unit.suffix(to)), factor: unit.factor(to), exponent })
}

/// A number without what conversion adds behind its fifteenth digit: 6 inches are 152.4 mm.
pub fn clean(value: f64) -> f64 {
    // A decimal of 15 digits always parses; the fallback only spares a panic path.
    format!("{value:.14e}").parse().unwrap_or(value)
}
