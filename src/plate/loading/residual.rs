//! Residual stress of a plate without its cracks, by which K is shifted (superposition: Bueckner 1958, Trans. ASME 80:1225).
//!
//! A crack releases the tractions that the residual stress σ_res had across its line: on a face with outward normal m the plate gets
//! `t = -σ_res m`, as under a pressure σ_res·I. K of these is K_res; with free flanks a cycle then runs from `R K + K_res` to `K + K_res`.
//!
//! The stress is that in the axes of the plate: σ_y, and σ_x and τ_xy where they are given, else 0. From a file it is linear between its
//! points: in the triangles of Delaunay, or along a line where all points lie on one, and alike across that.

use std::fmt;
use std::path::Path;
use std::sync::Arc;

use spade::{DelaunayTriangulation, FloatTriangulation, HasPosition, Point2, Triangulation};
use toml::Value;

use super::Input;
use super::formula::{Formula, KNOWN};
use crate::specimen::geometry::{along, distance};
use crate::specimen::{CrackLine, Point};
use perilife_base::error::{Result, fail_if, input, input_missing};
use perilife_base::input::{Folder, shorten};
use perilife_base::table::names::{Kind, Named, Role};
use perilife_base::table::quantities::{Words, in_si, numbers};
use perilife_base::table::{self, Fault, whole_file};
use perilife_base::units::{INCH, KSI, MM, MPA, place_mm};

const FILE: &str = "loading.residual_stress_file";
/// A key of formulas, with metres and pascals in their units.
type Key = (&'static str, [f64; 2]);
/// Keys of formulas; the last one, without unit, is metric and refused beside keys in US units.
const FORMULAS: [Key; 3] = [
    ("loading.residual_stress_mpa", [MM, MPA]),
    ("loading.residual_stress_ksi", [INCH, KSI]),
    ("loading.residual_stress", [MM, MPA]),
];
/// Distance from a line over its length within which points lie on it, and beyond its ends within which they are at its end.
const ROUND_OFF: f64 = 1e-6;
const LOOKED_AT: usize = 40;
const MOST: f64 = 1e5;
/// σ_x, σ_y, τ_xy, Pa.
pub type Components = [f64; 3];

/// Traction over the force that a stress has across a facet of some unit normal.
pub fn across([xx, yy, xy]: Components, [x, y]: Point) -> Point {
    [xx * x + xy * y, xy * x + yy * y]
}

#[derive(Clone)]
pub struct ResidualStress {
    field: Field,
    words: String,
    sha256: String,
    key: &'static str,
}

/// Says what it depends on: functions of a formula lie elsewhere in every process, and a checkpoint knows its case by this.
impl fmt::Debug for ResidualStress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ResidualStress {:?}", (self.key, &self.words, &self.sha256))
    }
}

impl PartialEq for ResidualStress {
    fn eq(&self, other: &Self) -> bool {
        (self.key, &self.words, &self.sha256) == (other.key, &other.words, &other.sha256)
    }
}

#[derive(Debug, Clone)]
enum Field {
    /// With metres and pascals in their units.
    Formulas([Option<Formula>; 3], [f64; 2]),
    /// Along a straight line: its ends, then ways from the first one, m, ascending.
    Line([Point; 2], Vec<(f64, Components)>),
    Plane(Box<DelaunayTriangulation<Sample>>),
}

#[derive(Debug, Clone, Copy)]
struct Sample {
    at: Point,
    stress: Components,
}

impl HasPosition for Sample {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        Point2::new(self.at[0], self.at[1])
    }
}

impl ResidualStress {
    /// What `[loading]` says of it, if anything.
    /// Errors: a formula or file that cannot be read, by character or line.
    pub(super) fn read(given: &Input, folder: &Folder) -> Result<Option<Arc<ResidualStress>>> {
        let formulas = [&given.residual_stress_mpa, &given.residual_stress_ksi, &given.residual_stress];
        let mut formulas = FORMULAS.into_iter().zip(formulas).filter_map(|(key, given)| Some((key, given.as_ref()?)));
        // A second one has been refused.
        match (formulas.next(), &given.residual_stress_file) {
            (None, None) => Ok(None),
            (Some((key, given)), _) => of_formulas(key, given).map(|field| Some(Arc::new(field))),
            (None, Some(file)) => {
                let bytes = folder.read(file)?;
                let field = of_table(&bytes, &folder.path(file))?;
                let sha256 = perilife_base::input::sha256(&bytes);
                Ok(Some(Arc::new(ResidualStress { field, words: file.clone(), sha256, key: FILE })))
            }
        }
    }

    pub fn key(&self) -> &'static str {
        self.key
    }

    pub fn words(&self) -> &str {
        &self.words
    }

    /// The formula with its units, or the file. Metric ones are spelled out: their symbols would be told as US ones, the formula as it is.
    pub fn described(&self) -> String {
        match &self.field {
            Field::Formulas(_, [length, _]) => {
                let units = if *length == MM { "megapascals, x and y in millimeters" } else { "ksi, x and y in inch" };
                format!("residual stress {} ({units})", self.words.trim_matches('"'))
            }
            Field::Line(..) | Field::Plane(_) => format!("residual stress of {}", self.words),
        }
    }

    /// The stress at a place, m; `None` where it is not known.
    fn known(&self, at: Point) -> Option<Components> {
        let stress = match &self.field {
            Field::Formulas(formulas, [length, stress]) => {
                let place = at.map(|x| x / length);
                formulas.each_ref().map(|formula| formula.as_ref().map_or(0.0, |formula| stress * formula.at(place)))
            }
            Field::Line([from, to], samples) => {
                let length = distance(*from, *to);
                let way = [0, 1].map(|i| (at[i] - from[i]) * (to[i] - from[i]) / length).iter().sum::<f64>();
                if !(-ROUND_OFF * length..=(1.0 + ROUND_OFF) * length).contains(&way) {
                    return None;
                }
                let next = samples.partition_point(|(sample, _)| *sample < way).clamp(1, samples.len() - 1);
                let [(a, before), (b, after)] = [samples[next - 1], samples[next]];
                let share = ((way - a) / (b - a)).clamp(0.0, 1.0);
                [0, 1, 2].map(|i| before[i] + share * (after[i] - before[i]))
            }
            Field::Plane(triangles) => {
                let mut weights = Vec::with_capacity(3);
                triangles.barycentric().get_weights(Point2::new(at[0], at[1]), &mut weights);
                if weights.is_empty() {
                    return None;
                }
                weights.iter().fold([0.0; 3], |sum, (vertex, weight)| {
                    let of_vertex = triangles.vertex(*vertex).data().stress;
                    [0, 1, 2].map(|i| sum[i] + weight * of_vertex[i])
                })
            }
        };
        stress.iter().all(|component| component.is_finite()).then_some(stress)
    }

    /// The stress along a unit vector, Pa.
    pub fn along(&self, at: Point, [x, y]: Point) -> f64 {
        let [tx, ty] = across(self.at(at), [x, y]);
        tx * x + ty * y
    }

    /// The stress at a place, m; none where it is not known, which [`ResidualStress::check`] refuses.
    pub fn at(&self, at: Point) -> Components {
        self.known(at).unwrap_or_default()
    }

    /// Whether the stress is known at a place of a crack, m.
    /// Errors: it is not, with the place and how far the field goes.
    pub fn check(&self, at: Point) -> Result<()> {
        // A tip that has met a rim may lie beside it by a rounding.
        let is_near = |[x, y]: Point| self.known([at[0] + 1e-9 * x, at[1] + 1e-9 * y]).is_some();
        if [[0.0; 2], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]].into_iter().any(is_near) {
            return Ok(());
        }
        let (problem, remedy) = match &self.field {
            Field::Formulas(..) => ("is not a number".to_owned(), "give a formula with a value at every point of the crack path"),
            Field::Line([from, to], _) => {
                (format!("covers only {} to {}", place_mm(*from), place_mm(*to)), "give the stress along the whole crack path")
            }
            Field::Plane(triangles) => {
                let ends = |of: fn(f64, f64) -> f64, from: f64| {
                    let at = |axis: usize| triangles.vertices().map(|vertex| vertex.data().at[axis]).fold(from, of);
                    place_mm([at(0), at(1)])
                };
                let [low, high] = [ends(f64::min, f64::INFINITY), ends(f64::max, f64::NEG_INFINITY)];
                (format!("covers only part of {low} to {high}"), "give the stress along the whole crack path")
            }
        };
        let problem = format!("{problem}, and the crack is at {}", place_mm(at));
        Err(input(self.key, self.words(), problem, remedy))
    }

    /// Whether it is known all along cracks.
    pub fn check_cracks(&self, cracks: &[CrackLine]) -> Result<()> {
        let places = |[a, b]: [Point; 2]| (0..=LOOKED_AT).map(move |i| along(a, b, i as f64 / LOOKED_AT as f64));
        cracks.iter().flat_map(CrackLine::pieces).flat_map(places).try_for_each(|at| self.check(at))
    }
}

/// σ_y as a text, or a table of `x`, `y`, `xy`.
fn of_formulas((own, units): Key, given: &Value) -> Result<ResidualStress> {
    const REMEDY: &str = "give σ_y as \"formula of x, y\", or { x = \"...\", y = \"...\", xy = \"...\" }";
    let parse = |key: String, text: &str| {
        Formula::parse(text)
            .map_err(|problem| input(&key, shorten(&Value::from(text)), problem, format!("a formula has {KNOWN}")))
    };
    let field = match given {
        Value::String(text) => [None, Some(parse(own.to_owned(), text)?), None],
        Value::Table(table) => {
            let mut formulas = [None, None, None];
            for (name, value) in table {
                let key = format!("{own}.{name}");
                let place = ["x", "y", "xy"].iter().position(|known| known == name);
                let (Some(place), Some(text)) = (place, value.as_str()) else {
                    return Err(input(&key, shorten(value), "is not a formula of a component", REMEDY));
                };
                formulas[place] = Some(parse(key, text)?);
            }
            formulas
        }
        other => return Err(input(own, shorten(other), "is not a formula", REMEDY)),
    };
    fail_if!(field.iter().all(Option::is_none), input_missing(own, "gives no component", REMEDY));
    Ok(ResidualStress { field: Field::Formulas(field, units), words: given.to_string(), sha256: String::new(), key: own })
}

const WORDS: Words = Words {
    kind: Kind::ResidualStress,
    roles: &[],
    is_enough: |roles| [Role::X, Role::Y, Role::StressY].iter().all(|role| roles.contains(role)),
    columns: 3,
    remedy: "name the columns x_mm, y_mm, stress_mpa (or x_in, y_in, stress_ksi), and stress_x_mpa, shear_xy_mpa if available",
};

fn of_table(bytes: &[u8], file: &Path) -> Result<Field> {
    let table = table::read(bytes, file, &WORDS)?;
    let roles = WORDS.roles(&table)?;
    let unit = |column: usize, named: Named| in_si(&table, column, named, None);
    let factors = roles.iter().enumerate().map(|(column, (_, named))| unit(column, *named)).collect::<Result<Vec<f64>>>()?;
    let columns: Vec<(usize, bool)> = (0..roles.len()).map(|column| (column, false)).collect();
    let fault = |line: Option<usize>, key: &str, value: &str, problem: &str, remedy: &str| {
        Fault { line, key: Some(key), value: Some(value), ..whole_file(file) }.error(problem, remedy)
    };
    let mut samples = Vec::new();
    for (line, values) in numbers(&table, &columns)? {
        let of = |role: Role| roles.iter().position(|(own, _)| *own == role).map_or(0.0, |place| values[place] * factors[place]);
        let stress = [Role::StressX, Role::StressY, Role::ShearXy].map(of);
        if let Some(large) = stress.iter().map(|stress| stress / MPA).find(|stress| stress.abs() > MOST) {
            return Err(fault(Some(line), "stress", &large.to_string(), "is implausible in MPa", "check its unit"));
        }
        samples.push((line, Sample { at: [of(Role::X), of(Role::Y)], stress }));
    }
    let (first, last) = match samples.as_slice() {
        [(_, first), .., (_, last)] => (*first, *last),
        _ => return Err(fault(None, "row", "", "has fewer than two points", "give the stress along the whole crack path")),
    };
    let farthest = |from: Point| {
        let away = |sample: &&(usize, Sample)| distance(from, sample.1.at);
        samples.iter().max_by(|a, b| away(a).total_cmp(&away(b))).map_or(last.at, |(_, sample)| sample.at)
    };
    let from = farthest(first.at);
    let to = farthest(from);
    let length = distance(from, to);
    fail_if!(length <= 0.0, fault(Some(samples[1].0), "x", "", "repeats the previous point", "give each point once"));
    let beside = |at: Point| ((to[0] - from[0]) * (at[1] - from[1]) - (to[1] - from[1]) * (at[0] - from[0])).abs() / length;
    let same = |line: usize| fault(Some(line), "x", "", "repeats the point of another row", "give each point once");
    if samples.iter().all(|(_, sample)| beside(sample.at) < ROUND_OFF * length) {
        let mut ways: Vec<(usize, f64, Components)> =
            samples.iter().map(|(line, sample)| (*line, distance(from, sample.at), sample.stress)).collect();
        ways.sort_by(|a, b| a.1.total_cmp(&b.1));
        if let Some(pair) = ways.windows(2).find(|pair| pair[1].1 - pair[0].1 < ROUND_OFF * ROUND_OFF * length) {
            return Err(same(pair[1].0.max(pair[0].0)));
        }
        return Ok(Field::Line([from, to], ways.into_iter().map(|(_, way, stress)| (way, stress)).collect()));
    }
    let mut triangles = DelaunayTriangulation::new();
    for (line, sample) in samples {
        let before = triangles.num_vertices();
        triangles
            .insert(sample)
            .map_err(|error| fault(Some(line), "x", "", &format!("is not a position: {error}"), "check its unit"))?;
        fail_if!(triangles.num_vertices() == before, same(line));
    }
    Ok(Field::Plane(Box::new(triangles)))
}
