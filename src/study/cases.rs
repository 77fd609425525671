//! Cases of the verification, written as the user writes them. Keys that override theirs stand in one text, `section.key=value` with
//! blanks between them.
//!
//! Lives of standard specimens are compared with quadrature with K of finite elements. Plates of `data/reference` were grown by finite
//! elements (`tests/reference`: quadratic triangles, remeshed, interaction integral, maximum circumferential stress; lives right to 0.1 %).

use std::path::Path;

use include_dir::{Dir, File, include_dir};

use perilife_base::error::{Error, Result};
use perilife_base::input::Document;
use perilife_base::monotone::Monotone;
use perilife_base::quadrature::integrate;
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_calibration::median::cycles_of_run;
use perilife_growth::case::{Case, remove_law};
use perilife_growth::predict::{Prediction, Silent, StopReason, predict};
use perilife_plate::specimen::geometry::{distance, distance_to_segment};
use perilife_plate::specimen::handbook::handbook;
use perilife_plate::specimen::{LoadMeasure, Point, Specimen};

pub const NODES: &str = "model.method=element_free_galerkin";
/// Override for the choice of the program.
pub const AUTO: &str = "model.method=auto";
/// Override for points and bonds.
pub const POINTS: &str = "model.method=peridynamics";

pub fn overrides(keys: &str) -> Vec<String> {
    keys.split_whitespace().map(str::to_owned).collect()
}

pub fn case(text: &str, keys: &str) -> Result<Case> {
    case_of(text, &overrides(keys))
}

pub fn case_of(text: &str, set: &[String]) -> Result<Case> {
    Case::from_toml(text, "verification", Path::new("."), &by_name(text, set))
}

/// The keys with a method among them: that of points where neither they nor the text name one. What is compared is a method, not the choice
/// of the program.
pub fn by_name(text: &str, set: &[String]) -> Vec<String> {
    let is_named = text.contains("method = ") || set.iter().any(|key| key.starts_with("model.method="));
    (!is_named).then(|| POINTS.to_owned()).into_iter().chain(set.iter().cloned()).collect()
}

/// A plate from the text of a case, which need not have a crack; its fatigue law is not read.
pub fn plate_alone(text: &str, set: &[String]) -> Result<Case> {
    let mut document = Document::parse(text, "verification", Path::new("."), &by_name(text, set))?;
    remove_law(&mut document.table);
    Case::without_growth(document.table.clone(), &document.name, &document.folder)
}

/// K of finite elements: specimen, crack length in mm, K_I in MPa√m at 100 MPa or 10 kN. Right to 0.05 % (`tests/reference/README.md`).
const FACTORS: &str = include_str!("../../data/reference/standard_specimens.csv");
/// Keys of the first and the last crack length.
const RANGE: [&str; 2] = ["specimen.crack_length_mm=", "stop.crack_length_mm="];

/// First and last crack length of the keys, mm.
fn range(set: &[String]) -> Result<[f64; 2]> {
    let [first, last] = RANGE.map(|key| set.iter().rev().find_map(|set| set.strip_prefix(key)?.parse().ok()));
    first.zip(last).map(|(first, last)| [first, last]).ok_or_else(|| Error::Mechanics(format!("keys {RANGE:?} are missing")))
}

/// The largest error of the cycles of a run at shares of the growth, percent, against quadrature with the range of its keys alone.
pub fn growth_error(text: &str, set: &[String], run: &Prediction, shares: &[f64]) -> Result<f64> {
    let [from, to] = range(set)?;
    let own: Vec<String> = set.iter().filter(|key| RANGE.iter().any(|range| key.starts_with(range))).cloned().collect();
    let lengths: Vec<f64> = [0.0].iter().chain(shares).map(|share| from + share * (to - from)).collect();
    let points: Vec<(f64, f64)> = run.curve.iter().map(|point| (point.cycles, point.crack_length)).collect();
    let cycles = cycles_of_run(&points, &lengths.iter().map(|length| length * MM).collect::<Vec<_>>())?;
    let mut largest = 0.0_f64;
    for (length, cycles) in lengths.iter().zip(&cycles).skip(1) {
        let error = 100.0 * (cycles / by_quadrature(text, &own, Some(*length))? - 1.0);
        largest = if error.abs() > largest.abs() { error } else { largest };
    }
    Ok(largest)
}

/// Life by quadrature with K of finite elements, to the last length of the keys or to another, mm.
pub fn by_quadrature(text: &str, set: &[String], to: Option<f64>) -> Result<f64> {
    let [from, last] = range(set)?;
    let to = to.unwrap_or(last);
    let more = [format!("{}{to}", RANGE[1]), "model.method=handbook".to_owned()];
    let by_hand = case_of(text, &[set, &more].concat())?;
    Ok(predict(&by_hand, &Silent)?.life_cycles() * over_handbook(&by_hand, [from, to])?)
}

/// K_I of finite elements at a crack length of the table, mm, under the load of a case, Pa√m.
pub fn k_of_elements(case: &Case, length: f64) -> Result<f64> {
    let load = case.loading.maximum / load_of_table(&case.specimen);
    let found = known_factors(case.specimen.kind.name()).find(|[a, _]| *a == length);
    found.map(|[_, k]| k * load).ok_or_else(|| Error::Mechanics(format!("no K at {length} mm in the table")))
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

/// Shares of a tip's path at which cycles are compared: beyond half, since the first step of a reference is as long as it is coarse.
pub const SHARES: [f64; 3] = [0.5, 0.75, 0.95];

/// A plate and what finite elements say of it.
#[derive(Debug)]
pub struct Reference {
    pub name: &'static str,
    pub ends_in_hole: bool,
}

static FILES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../data/reference");

pub const REFERENCES: [Reference; 9] = [
    Reference { name: "slant_severance", ends_in_hole: false },
    Reference { name: "hole_attracts", ends_in_hole: true },
    Reference { name: "hole_missed", ends_in_hole: false },
    Reference { name: "compact_one_hole_a", ends_in_hole: true },
    Reference { name: "compact_one_hole_b", ends_in_hole: false },
    Reference { name: "offset_edge_cracks", ends_in_hole: false },
    Reference { name: "double_edge_notched", ends_in_hole: true },
    Reference { name: "three_point_bending", ends_in_hole: true },
    Reference { name: "three_cracks", ends_in_hole: false },
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

    fn up_to(&self, length: f64) -> Self {
        let passed = (2..=self.0.len()).take_while(|&n| Curve(self.0[..n].to_vec()).length() <= length).last().unwrap_or(1);
        Curve(self.0[..passed.min(self.0.len())].to_vec())
    }

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
    /// The case, `toml`, or cycles and places of every tip, `csv`.
    fn file(&self, ending: &str) -> &'static str {
        FILES.get_file(format!("{}.{ending}", self.name)).and_then(File::contents_utf8).unwrap_or_default()
    }

    pub fn named(name: &str) -> Result<&'static Reference> {
        let found = REFERENCES.iter().find(|reference| reference.name == name);
        found.ok_or_else(|| Error::Mechanics(format!("no reference {name}")))
    }

    /// Its case at the spacing that resolves it, other keys set.
    pub fn case(&self, set: &[String]) -> Result<Case> {
        let is_of_points = !set.iter().any(|key| key == NODES || key == AUTO);
        let spacing = (is_of_points && self.name == FINER.0).then(|| FINER.1.to_owned());
        let set: Vec<String> = spacing.into_iter().chain(set.iter().cloned()).collect();
        Case::from_toml(self.file("toml"), self.name, Path::new("."), &by_name(self.file("toml"), &set))
    }

    pub fn tips(&self) -> Result<Vec<Curve>> {
        tips_of_table(self.file("csv"))
    }

    /// K_I and K_II of its first tip at the start, MPa√m.
    pub fn initial_factors(&self) -> Result<[f64; 2]> {
        let fields = self.file("csv").lines().nth(1).map(|line| line.split(',').skip(4).map(str::parse).collect::<Vec<_>>());
        match fields.as_deref() {
            Some([Ok(k_i), Ok(k_ii)]) => Ok([*k_i, *k_ii]),
            _ => Err(Error::Mechanics(format!("no K in the first row of {}", self.name))),
        }
    }

    pub fn ended_alike(&self, run: &Prediction) -> bool {
        run.stop == StopReason::EnteredHole || !self.ends_in_hole
    }
}
