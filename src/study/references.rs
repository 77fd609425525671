//! Plates whose cracks were grown by finite elements, for comparison (`data/reference`, by the programs of `tests/reference`: quadratic
//! triangles, remeshed, interaction integral, maximum circumferential stress; lives right to 0.1 %).

use std::path::Path;

use super::cases::{AUTO, NODES, by_name};
use perilife_base::error::{Error, Result};
use perilife_base::monotone::Monotone;
use perilife_base::units::MM;
use perilife_growth::case::Case;
use perilife_growth::predict::{Prediction, StopReason};
use perilife_plate::specimen::Point;
use perilife_plate::specimen::geometry::{distance, distance_to_segment};

/// Shares of a tip's path at which cycles are compared: beyond half, since the first step of a reference is as long as it is coarse.
pub const SHARES: [f64; 3] = [0.5, 0.75, 0.95];

/// A plate and what finite elements say of it.
#[derive(Debug)]
pub struct Reference {
    /// As its files are called.
    pub name: &'static str,
    /// The case, and cycles and places of every tip.
    files: [&'static str; 2],
    pub ends_in_hole: bool,
}

macro_rules! reference {
    ($name:literal, $ends_in_hole:literal) => {
        Reference {
            name: $name,
            files: [
                include_str!(concat!("../../data/reference/", $name, ".toml")),
                include_str!(concat!("../../data/reference/", $name, ".csv")),
            ],
            ends_in_hole: $ends_in_hole,
        }
    };
}

pub const REFERENCES: [Reference; 9] = [
    reference!("slant_severance", false),
    reference!("hole_attracts", true),
    reference!("hole_missed", false),
    reference!("compact_one_hole_a", true),
    reference!("compact_one_hole_b", false),
    reference!("offset_edge_cracks", false),
    reference!("double_edge_notched", true),
    reference!("three_point_bending", true),
    reference!("three_cracks", false),
];

/// Spacing, mm, of the plate whose holes the default does not resolve.
const FINER: (&str, &str) = ("three_point_bending", "model.spacing_mm=0.5");

/// Cycles and places of a tip, m.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curve(pub Vec<(f64, Point)>);

impl Curve {
    pub fn of_tip(run: &Prediction, tip: usize) -> Self {
        Curve(run.curve.iter().map(|row| (row.cycles, row.tips[tip].position)).collect())
    }

    /// That of the tip of a run which starts nearest to a place.
    fn from(run: &Prediction, start: Point) -> Self {
        let gap = |tip: &usize| distance(run.curve[0].tips[*tip].position, start);
        let tip = (0..run.curve[0].tips.len()).min_by(|a, b| gap(a).total_cmp(&gap(b)));
        tip.map_or_else(Curve::default, |tip| Curve::of_tip(run, tip))
    }

    /// Length of the path, m.
    pub fn length(&self) -> f64 {
        self.0.windows(2).map(|pair| distance(pair[0].1, pair[1].1)).sum()
    }

    /// Cycles at a length of the path, by a monotone cubic between the points.
    pub fn cycles_at(&self, length: f64) -> f64 {
        let mut done = 0.0;
        let steps = self.0.windows(2).map(|pair| {
            done += distance(pair[0].1, pair[1].1);
            [done, pair[1].0]
        });
        let first = self.0.first().map(|first| [0.0, first.0]);
        Monotone::new(first.into_iter().chain(steps)).at(length)
    }

    /// Its part up to a length of the path.
    fn up_to(&self, length: f64) -> Self {
        let passed = (2..=self.0.len()).take_while(|&n| Curve(self.0[..n].to_vec()).length() <= length).last().unwrap_or(1);
        Curve(self.0[..passed.min(self.0.len())].to_vec())
    }

    /// Its part up to a number of cycles.
    pub fn until(&self, cycles: f64) -> Self {
        Curve(self.0.iter().copied().filter(|(n, _)| *n <= cycles).collect())
    }

    /// Distances of its places from the path of another, m.
    pub fn off(&self, other: &Curve) -> impl Iterator<Item = f64> {
        let off = |at: Point| {
            other.0.windows(2).map(|pair| distance_to_segment(at, pair[0].1, pair[1].1)).fold(f64::INFINITY, f64::min)
        };
        self.0.iter().map(move |(_, at)| off(*at))
    }

    /// Their root mean square over the length that both have, m: what lies beyond the other's end is no distance from it.
    pub fn rms_off(&self, other: &Curve) -> f64 {
        let common = self.up_to(other.length());
        (common.off(other).map(|off| off * off).sum::<f64>() / common.0.len() as f64).sqrt()
    }
}

/// How a tip went against a reference.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// Which of the reference's tips.
    pub tip: usize,
    /// Distance of the reference's places from the path, rms, m.
    pub rms: f64,
    /// Cycles at [`SHARES`] of the path, over those of the reference less 1, percent.
    pub cycles: [f64; 3],
    /// Length of the path over that of the reference.
    pub length: f64,
}

/// Every tip of a run against its reference, up to an x, m.
pub fn compare(run: &Prediction, reference: Vec<Curve>, x_end: f64) -> Vec<Compared> {
    let tip = |(tip, reference): (usize, Curve)| {
        let path = reference.0.first().map_or_else(Curve::default, |(_, start)| Curve::from(run, *start));
        let whole = reference.length();
        let kept = Curve(reference.0.into_iter().filter(|(_, at)| at[0] < x_end).collect());
        let common = kept.length().min(path.length());
        let cycles = SHARES.map(|share| 100.0 * (path.cycles_at(share * common) / kept.cycles_at(share * common) - 1.0));
        Compared { tip, rms: kept.rms_off(&path), cycles, length: path.length() / whole }
    };
    reference.into_iter().enumerate().map(tip).collect()
}

/// The error of largest size, with its sign.
pub fn largest(errors: impl IntoIterator<Item = f64>) -> f64 {
    errors.into_iter().fold(0.0, |most: f64, error| if error.abs() > most.abs() { error } else { most })
}

/// Curves of all tips of a table `cycles, tip, x_mm, y_mm, ...`.
pub fn tips_of_table(text: &str) -> Result<Vec<Curve>> {
    let mut tips: Vec<Curve> = Vec::new();
    for line in text.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let number = |i: usize| {
            let field = fields.get(i).and_then(|field| field.parse::<f64>().ok());
            field.ok_or_else(|| Error::Mechanics(format!("no number in column {} of \"{line}\"", i + 1)))
        };
        let tip = number(1)? as usize;
        tips.resize(tips.len().max(tip + 1), Curve::default());
        tips[tip].0.push((number(0)?, [number(2)? * MM, number(3)? * MM]));
    }
    Ok(tips)
}

impl Reference {
    pub fn named(name: &str) -> Result<&'static Reference> {
        let found = REFERENCES.iter().find(|reference| reference.name == name);
        found.ok_or_else(|| Error::Mechanics(format!("no reference {name}")))
    }

    /// Its case at the spacing that resolves it, other keys set.
    pub fn case(&self, set: &[String]) -> Result<Case> {
        let is_of_points = !set.iter().any(|key| key == NODES || key == AUTO);
        let spacing = (is_of_points && self.name == FINER.0).then(|| FINER.1.to_owned());
        let set: Vec<String> = spacing.into_iter().chain(set.iter().cloned()).collect();
        Case::from_toml(self.files[0], self.name, Path::new("."), &by_name(self.files[0], &set))
    }

    /// Cycles and places of its tips.
    pub fn tips(&self) -> Result<Vec<Curve>> {
        tips_of_table(self.files[1])
    }

    /// K_I and K_II of its first tip at the start, MPa√m.
    pub fn initial_factors(&self) -> Result<[f64; 2]> {
        let fields = self.files[1].lines().nth(1).map(|line| line.split(',').skip(4).map(str::parse).collect::<Vec<_>>());
        match fields.as_deref() {
            Some([Ok(k_i), Ok(k_ii)]) => Ok([*k_i, *k_ii]),
            _ => Err(Error::Mechanics(format!("no K in the first row of {}", self.name))),
        }
    }

    /// Whether a run ended in a hole where the reference does.
    pub fn ended_alike(&self, run: &Prediction) -> bool {
        run.stop == StopReason::EnteredHole || !self.ends_in_hole
    }
}
