//! The plate of a run as it is drawn: outline, holes, first cracks, loads, and what is said of it.

mod drawing;

pub(super) use drawing::colour;
pub(crate) use drawing::{Drawing, scale_bar};
pub use drawing::{MOVING, SIZE, growth_svg, plate_svg};

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::format::PLAIN;
use crate::model_words::{clean, loading, short};
use perilife_base::units::{GPA, MM, MPA, MPA_SQRT_M};
use perilife_growth::case::Case;
use perilife_plate::specimen::geometry::bounding_box;
use perilife_plate::specimen::{Load, Point, Specimen, Support};

/// The plate of a case as it is drawn: `plate` of `result.json`. Lengths in mm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plate {
    pub outline_mm: Vec<Point>,
    pub holes: Vec<HoleDrawn>,
    pub slots_mm: Vec<Vec<Point>>,
    /// Ends of the pieces of cracks at the start.
    pub cracks_mm: Vec<[Point; 2]>,
    /// What pulls or pushes.
    pub loads: Vec<LoadDrawn>,
    /// Ends of stretches that are held.
    pub held_mm: Vec<[Point; 2]>,
    pub load: String,
    /// The specimen in words: kind and sizes.
    #[serde(default)]
    pub specimen: String,
    #[serde(default)]
    pub material: String,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HoleDrawn {
    /// Middle, mm.
    pub x_mm: f64,
    /// Middle, mm.
    pub y_mm: f64,
    /// Diameter, mm.
    pub diameter_mm: f64,
}

/// A load: on a stretch of the outline, or, where both of its ends are one place, of a pin in a hole there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LoadDrawn {
    /// One end, mm.
    pub from_mm: Point,
    /// Other end, mm.
    pub to_mm: Point,
    /// Unit vector of the load on the plate.
    pub direction: Point,
    /// Load at both ends over the larger of them.
    #[serde(default = "even")]
    pub shares: [f64; 2],
}

fn even() -> [f64; 2] {
    [1.0; 2]
}

impl Plate {
    pub fn of(case: &Case) -> Self {
        let (specimen, material) = (specimen_words(case), material_words(case));
        Plate { specimen, material, ..Plate::of_specimen(&case.specimen, loading(case)) }
    }

    /// Of a specimen under a load, in words.
    pub fn of_specimen(specimen: &Specimen, load: String) -> Self {
        let hole = |hole: &perilife_plate::specimen::Hole| HoleDrawn {
            x_mm: clean(hole.centre[0] / MM),
            y_mm: clean(hole.centre[1] / MM),
            diameter_mm: clean(2.0 * hole.radius / MM),
        };
        Plate {
            outline_mm: specimen.outline.iter().map(mm).collect(),
            holes: specimen.holes.iter().map(hole).collect(),
            slots_mm: specimen.slots.iter().map(|slot| slot.corners().iter().map(mm).collect()).collect(),
            cracks_mm: specimen.cracks.iter().map(|crack| [mm(&crack.from), mm(&crack.to)]).collect(),
            loads: loads(specimen),
            held_mm: held(specimen),
            load,
            specimen: String::new(),
            material: String::new(),
        }
    }
}

fn specimen_words(case: &Case) -> String {
    let specimen = &case.specimen;
    let [low, high] = bounding_box(&specimen.outline);
    let [width, length, thickness] = [high[0] - low[0], high[1] - low[1], specimen.thickness].map(|size| short(size / MM));
    let of = [(specimen.holes.len(), "hole"), (specimen.slots.len(), "slot"), (specimen.crack_lines().len(), "crack")];
    let words = |(count, name): &(usize, &str)| format!(", {count} {name}{}", if *count == 1 { "" } else { "s" });
    let more: String = of.iter().filter(|(count, _)| *count > 0).map(words).collect();
    format!("{}, {width} × {length} × {thickness} mm{more}", specimen.kind.name().replace('_', " "))
}

fn material_words(case: &Case) -> String {
    let material = &case.material;
    // Strengths that a fit does not use are not there.
    let yields = material.yield_strength.map_or(String::new(), |strength| format!(", σ_Y {} MPa", PLAIN.four(strength / MPA)));
    let tough = material.toughness.map_or(String::new(), |k| format!(", K_c {} MPa√m", PLAIN.four(k / MPA_SQRT_M)));
    let modulus = PLAIN.four(material.youngs_modulus / GPA);
    let (name, ratio) = (&material.name, short(material.poisson_ratio));
    // Of a file its stem: where it lay is no part of what it says.
    let stem = Path::new(name).file_stem().filter(|_| name.ends_with(".toml")).map(|stem| stem.to_string_lossy());
    let name = stem.unwrap_or_else(|| if name.is_empty() { "user-defined".into() } else { name.into() });
    format!("{name}: E {modulus} GPa, ν {ratio}{yields}{tough}, plane {}", material.plane.name())
}

fn mm(point: &Point) -> Point {
    point.map(|metres| clean(metres / MM))
}

fn loads(specimen: &Specimen) -> Vec<LoadDrawn> {
    let stretch = |from: &Point, to: &Point, ends: [Point; 2]| {
        let larger = if ends[0][0].hypot(ends[0][1]) < ends[1][0].hypot(ends[1][1]) { ends[1] } else { ends[0] };
        let size = larger[0].hypot(larger[1]);
        let direction = larger.map(|part| part / size);
        let shares = ends.map(|[x, y]| (x * direction[0] + y * direction[1]) / size);
        (size > 0.0).then(|| LoadDrawn { from_mm: mm(from), to_mm: mm(to), direction, shares })
    };
    let of_load = |load: &Load| match load {
        Load::Edge { from, to, traction } => stretch(from, to, [*traction; 2]),
        Load::Bent { from, to, tractions } => stretch(from, to, *tractions),
        Load::Pin { hole, direction, .. } => {
            let centre = mm(&specimen.holes.get(*hole)?.centre);
            Some(LoadDrawn { from_mm: centre, to_mm: centre, direction: *direction, shares: even() })
        }
    };
    let of_support = |support: &Support| match support {
        Support::Moved { from, to, direction, way, .. } if *way > 0.0 => stretch(from, to, [*direction; 2]),
        _ => None,
    };
    specimen.loads.iter().filter_map(of_load).chain(specimen.supports.iter().filter_map(of_support)).collect()
}

fn held(specimen: &Specimen) -> Vec<[Point; 2]> {
    let [low, high] = bounding_box(&specimen.outline).map(|corner| mm(&corner));
    let of_support = |support: &Support| match support {
        Support::Fixed { from, to, .. } => vec![[mm(from), mm(to)]],
        Support::ClampedEnds | Support::RigidEnds => {
            vec![[low, [high[0], low[1]]], [[low[0], high[1]], high]]
        }
        Support::Moved { from, to, way, .. } if *way == 0.0 => vec![[mm(from), mm(to)]],
        Support::Moved { .. } | Support::Elsewhere => Vec::new(),
    };
    specimen.supports.iter().flat_map(of_support).collect()
}
