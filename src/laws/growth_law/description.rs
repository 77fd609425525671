//! What a law of growth says of itself: its name, its constants with their keys and bounds, and how rates are fitted by it.

use toml::Value;

use super::{FactorLaw, GrowthLawKind};
use perilife_base::error::{Result, input_missing};
use perilife_base::input::{Folder, INTENSITY, Quantity, number, value_at};
use perilife_base::keys::{Field, Key, Shape};
use perilife_base::kinds::KindLine;
use perilife_base::units::MM_PER_CYCLE;
use perilife_plate::material::Material;

perilife_base::kinds! {
    /// What K and R beyond the rows of a table of rates do.
    pub enum TableEnds for "fatigue.growth_table_ends" {
        Refused = "refused": "extrapolation is refused",
        Held = "held": "rate of the last row or ratio; a warning gives the share of life",
    }
}

/// A law of growth: its formula, and it in the words and numbers of input files. Formulas take the constants in SI units, in their order.
pub struct GrowthLawSpec {
    pub name: &'static str,
    pub meaning: &'static str,
    /// Its constants: the level C, by which all rates are in proportion, first; then the exponent of ΔK.
    pub constants: &'static [Constant],
    /// da/dN, m/cycle, at K_max, Pa√m, and R; infinite where the crack grows without limit.
    pub rate: fn(&[f64], f64, f64) -> f64,
    /// ΔK, Pa√m, up to which that is 0, at R; asked for of laws with a constant of [`Role::Threshold`].
    pub threshold: fn(&[f64], f64) -> f64,
    /// Reads it from a case; `None` for bonds and powers of ΔK, either of which can stand for the other.
    pub read: Option<fn(&Given<'_>, &'static GrowthLawSpec) -> Result<FactorLaw>>,
    /// Keys of its own that are no constants.
    pub others: &'static [Key],
    /// What to give where constants are missing.
    pub complete: &'static str,
    /// Meaning as one of the laws that rates are fitted by.
    pub fit: Option<&'static str>,
    pub factors: &'static [Factor],
    /// Whether it holds at other stress ratios than those of its rates.
    pub takes_ratio: bool,
    /// What of it takes the compression of a cycle into account, and the stress ratio down to which that is known.
    pub compression: Option<(&'static str, f64)>,
}

/// A factor of a law: what it is of, and constants, in the units of their keys, at which it is 1; the first one does that alone.
pub type Factor = (&'static str, &'static [(&'static str, f64)]);

/// What a law is where its file says nothing: a formula of its constants.
pub(super) const UNSAID: GrowthLawSpec = GrowthLawSpec {
    name: "",
    meaning: "",
    constants: &[],
    rate: |_, _, _| f64::NAN,
    threshold: |_, _| 0.0,
    read: Some(|given, law| Ok(FactorLaw::new(law, given.constants(law)?))),
    others: &[],
    complete: "give all constants of the law",
    fit: None,
    factors: &[],
    takes_ratio: true,
    compression: None,
};

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Role {
    Plain,
    /// K_max at which a crack grows without limit; a case without it takes the toughness of the material. A search has the variable u of
    /// `K_max (1 + e^u)`, above every K_max of the rates.
    Toughness,
    /// Proportional to the threshold. A search has the variable u of `ΔK_max / (1 + e^-u)`, ΔK_max being the one at which the first of the
    /// rates would stand still.
    Threshold,
}

#[derive(Debug, Clone, Copy)]
pub struct Constant {
    /// Key in `[fatigue]`.
    pub key: &'static str,
    /// Name among the constants in SI units of a result; constants of one name are a list there, the last one first.
    pub name: &'static str,
    pub quantity: Quantity,
    pub role: Role,
    /// Whether it is the exponent of ΔK.
    pub is_exponent: bool,
    /// Value in a case that does not give it; `None`: it is refused.
    pub default: Option<f64>,
    /// Value in a fit where it is not given; `None`: it is searched.
    pub held: Option<f64>,
    pub bounds: [f64; 2],
    pub starts: [f64; 2],
    pub needs: Evidence,
    /// Standard error above which it is not determined: a share of its value, or an absolute one where it needs several ratios.
    pub error_max: f64,
}

/// Rates from which a constant can be determined: in words, and whether at several stress ratios.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence(pub &'static str, pub bool);

pub(super) const NEAR_FRACTURE: Evidence = Evidence("needs rates near fracture", false);
pub(super) const NEAR_THRESHOLD: Evidence = Evidence("needs rates near the threshold", false);
pub(super) const RATIOS: Evidence = Evidence("needs rates at several stress ratios", true);
const POWER: Evidence = Evidence("needs rates over a wide range of ΔK", false);
const THRESHOLD: &str = "delta_k_threshold_mpa_sqrt_m";
/// Level C of a law.
pub(super) const fn rate_of(what: &'static str) -> Quantity {
    Quantity { unit: "mm/cycle", si: MM_PER_CYCLE, ..number(what, 1e-60, 1e3) }
}
/// K_c, which several laws have.
pub const K_C: Constant = Constant {
    role: Role::Toughness,
    ..Constant::new("k_c_mpa_sqrt_m", "k_c", TOUGHNESS).searched([-6.9, 2.9], [-2.0, 0.5], NEAR_FRACTURE, 1.0)
};
const TOUGHNESS: Quantity = Quantity { what: "a fracture toughness Kc", ..INTENSITY };
/// Walker's exponent, which several laws have.
pub const GAMMA: Constant =
    Constant::new("walker_gamma", "gamma", OF_WALKER).searched([0.0, 2.0], [0.5; 2], RATIOS, f64::INFINITY);
const OF_WALKER: Quantity = number("a Walker exponent γ", 0.0, 2.0);

impl Constant {
    /// A constant that a case has to give and no search looks for.
    pub const fn new(key: &'static str, name: &'static str, quantity: Quantity) -> Self {
        let (bounds, starts, needs) = ([f64::NAN; 2], [f64::NAN; 2], POWER);
        let (role, is_exponent, default, held, error_max) = (Role::Plain, false, None, None, 0.0);
        Constant { key, name, quantity, role, is_exponent, default, held, bounds, starts, needs, error_max }
    }

    /// The exponent of ΔK.
    pub const fn exponent(key: &'static str, name: &'static str, what: &'static str) -> Self {
        let constant = Constant::new(key, name, number(what, 0.5, 20.0)).searched([0.5, 20.0], [3.0; 2], POWER, 1.0);
        Constant { is_exponent: true, ..constant }
    }

    pub const fn searched(self, bounds: [f64; 2], starts: [f64; 2], needs: Evidence, error_max: f64) -> Self {
        Constant { bounds, starts, needs, error_max, ..self }
    }

    pub fn is_shared(&self) -> bool {
        [K_C.key, GAMMA.key].contains(&self.key)
    }
}

impl GrowthLawSpec {
    fn own_keys(&self) -> Vec<&'static str> {
        let constants = self.constants.iter().filter(|constant| !constant.is_shared());
        constants.map(|constant| constant.key).chain(self.others.iter().map(|key| key.name)).collect()
    }

    /// The law with constants in the units of their keys.
    pub fn of(&'static self, constants: impl Iterator<Item = f64>) -> FactorLaw {
        FactorLaw::new(self, constants.zip(self.constants).map(|(value, constant)| value * constant.quantity.si).collect())
    }

    /// Place of the constant that is this to the rates.
    pub fn place(&self, role: Role) -> Option<usize> {
        self.constants.iter().position(|constant| constant.role == role)
    }

    /// Refuses constants of other laws, which no reader looks for; `is_given` is whether `[fatigue]` has a key.
    pub fn refuse_foreign(&self, is_given: &dyn Fn(&str) -> bool) -> Result<()> {
        let is_foreign = |key: &str| is_given(key) && self.constants.iter().all(|constant| constant.key != key);
        let own_threshold = self.place(Role::Threshold).filter(|_| is_given(THRESHOLD)).map(|place| self.constants[place].key);
        let (key, problem, remedy) = match own_threshold {
            _ if is_foreign(GAMMA.key) => (GAMMA.key, "cannot be combined with", "or use growth_law = \"walker\"".to_owned()),
            Some(own) => (THRESHOLD, "cannot be combined with", format!("and give {own}")),
            None if is_foreign(K_C.key) => (K_C.key, "is not a constant of", "or give material.toughness_mpa_sqrt_m".to_owned()),
            None => return Ok(()),
        };
        let why = if key == THRESHOLD { ", which has its own threshold" } else { "" };
        let problem = format!("{problem} growth_law \"{}\"{why}", self.name);
        Err(input_missing(&format!("fatigue.{key}"), problem, format!("remove it, {remedy}")))
    }
}

/// Rows of a file of rates, as whoever reads such files gives them.
#[derive(Debug, Clone, PartialEq)]
pub struct Rates {
    pub file: String,
    /// Names of its columns of ΔK and da/dN.
    pub columns: [String; 2],
    /// Whether the file, or the user, says the stress ratio.
    pub says_ratio: bool,
    pub notes: Vec<String>,
    pub rows: Vec<RatedRow>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RatedRow {
    pub line: usize,
    pub ratio: f64,
    /// ΔK, Pa√m, and da/dN, m/cycle.
    pub pair: [f64; 2],
}

/// `[fatigue]` and what its law needs to know about the rest of the case.
pub struct Given<'a> {
    pub section: &'a Value,
    pub material: &'a Material,
    /// Smallest and largest stress ratio of the cycles of the case.
    pub ratios: [f64; 2],
    pub folder: &'a Folder,
    /// Reads the table of rates that a key names; `None` where the case does not give it.
    pub rates: fn(&Given<'_>, &str) -> Result<Option<Rates>>,
}

impl Given<'_> {
    /// The value of a key.
    /// Errors: another kind of value.
    pub fn get<T: Field>(&self, key: &str) -> Result<Option<T>> {
        let take = |value| T::take(&Key::of_choice::<T>("", ""), &format!("fatigue.{key}"), value);
        value_at(self.section, key).map(take).transpose()
    }

    /// The constants of a law in SI units, in their order.
    /// Errors: one that is missing, or beyond its bounds.
    pub fn constants(&self, law: &GrowthLawSpec) -> Result<Vec<f64>> {
        let is_one = |(_, own): &Factor| matches!(self.get::<f64>(own[0].0), Ok(Some(value)) if value == own[0].1);
        let of_one =
            |key: &str| law.factors.iter().filter(|factor| is_one(factor)).flat_map(|(_, own)| *own).find(|own| own.0 == key);
        let value = |constant: &Constant| {
            let path = format!("fatigue.{}", constant.key);
            match (self.get(constant.key)?, constant.default) {
                (Some(value), _) => constant.quantity.read(&path, value),
                (None, Some(value)) => Ok(value * constant.quantity.si),
                (None, None) if constant.role == Role::Toughness => {
                    self.material.toughness.or(of_one(constant.key).map(|own| own.1)).ok_or_else(|| {
                        let problem = "is missing, and the material has no toughness";
                        input_missing(&path, problem, "give the K at which growth becomes unstable")
                    })
                }
                (None, None) => {
                    let why = if constant.name == "horizon" { ": A depends on the horizon" } else { "" };
                    Err(input_missing(&path, format!("is missing{why}"), law.complete))
                }
            }
        };
        law.constants.iter().map(value).collect()
    }

    /// The same; `None` where the case gives none of them.
    pub fn all_or_none(&self, law: &GrowthLawSpec) -> Result<Option<Vec<f64>>> {
        let is_given = law.own_keys().into_iter().any(|key| value_at(self.section, key).is_some());
        is_given.then(|| self.constants(law)).transpose()
    }
}

/// Keys that give a law, those of laws with the same ones together, and the laws of the keys: of two only `growth_law` tells, or a key that
/// they share with others. A record holds constants of bonds and of powers of ΔK.
pub fn keys_of_laws() -> Vec<(Vec<&'static str>, Vec<GrowthLawKind>)> {
    let mut groups: Vec<(_, Vec<_>)> =
        vec![(vec!["fitted"], GrowthLawKind::all().filter(|kind| kind.0.read.is_none()).collect())];
    for kind in GrowthLawKind::all() {
        let keys = kind.0.own_keys();
        match groups.iter_mut().find(|(known, _)| *known == keys) {
            Some((_, kinds)) => kinds.push(kind),
            None => groups.push((keys, vec![kind])),
        }
    }
    groups
}

/// The growth law that stands with its material, which takes the place of this name before a law is read.
pub const LIBRARY: KindLine = KindLine { key: GrowthLawKind::KEY, name: "library", meaning: "growth data of material.name" };

/// Names of `growth_law`.
pub fn choices() -> Vec<KindLine> {
    GrowthLawKind::lines().into_iter().chain([LIBRARY]).collect()
}

/// Keys of `[fatigue]` that give a law, for whoever tells of them.
pub fn keys_to_tell() -> Vec<Key> {
    let fitted = Key::of_choice::<String>("fitted", "Fitted law: file that `perilife calibrate` wrote");
    let law = Key::of_choice::<GrowthLawKind>("growth_law", "Growth law: default by the constants given");
    let mut keys = vec![fitted, Key { shape: Shape::Choice(choices), ..law }];
    for constant in GrowthLawKind::all().flat_map(|kind| kind.0.constants) {
        if keys.iter().all(|key| key.name != constant.key) {
            keys.push(Key::of_constant(constant.key, constant.quantity, ""));
        }
    }
    keys.extend(GrowthLawKind::all().flat_map(|kind| kind.0.others));
    keys
}

/// Every key that gives a law, those that several laws have last.
pub fn law_keys() -> impl Iterator<Item = &'static str> {
    keys_of_laws().into_iter().flat_map(|(keys, _)| keys).chain(["growth_law", K_C.key])
}
