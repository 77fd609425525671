//! What is tested: a flat plate with an outline, holes, slots, cracks, loads and supports.
//!
//! Lengths in metres, the load direction of the standard specimens is y. A [`Specimen`] is fixed once built:
//! nothing in a run changes it. Cracks go through the thickness but for those of [`part_through`].

pub mod beta;
mod crack_line;
mod cracks;
pub mod drawing;
pub mod facets;
pub mod geometry;
pub mod green;
pub mod handbook;
pub mod keys;
pub mod limit_load;
pub mod named;
pub mod net_section;
pub mod part_through;
pub mod pin;
mod placement;
mod plate;
mod read;
mod standard;

pub use beta::BetaTable;
pub use crack_line::{CrackLine, LineEnd};
pub use cracks::LengthConvention;
pub use geometry::{Component, Edge};
pub use part_through::{FrontTip, PartThrough};
pub use pin::Bearing;
pub use read::{PART_THROUGH, from_value, mistakes};

pub type Point = [f64; 2];

perilife_base::kinds! {
    pub enum SpecimenKind for "specimen.kind" {
        MiddleTension = "middle_tension": "plate with a central crack, M(T) of ASTM E647; crack length = half length a",
        SingleEdgeTension = "single_edge_tension": "plate with one edge crack; needs ends = pinned, clamped or uniform_stress",
        DoubleEdgeTension = "double_edge_tension": "plate with two equal edge cracks; crack length = length of each",
        CompactTension = "compact_tension": "C(T) of ASTM E647, loaded by pins; crack length from the load line",
        Plate = "plate": "any outline with round holes, slots and straight through cracks at any angle",
        SurfaceCrack = "surface_crack": "semi-elliptical surface crack; crack length = half length c; Newman-Raju K until breakthrough",
        CornerCrack = "corner_crack": "quarter-elliptical corner crack; crack length = c along the face; Newman-Raju K until breakthrough",
        EmbeddedCrack = "embedded_crack": "elliptical embedded crack; crack length = half length c; Newman-Raju K until breakthrough",
        CornerCrackAtHole = "corner_crack_at_hole": "quarter-elliptical crack at a hole, one or both sides; crack length = c from the hole edge; Newman-Raju K until breakthrough",
        CrackAtHole = "crack_at_hole": "plate with a round hole and one or two through cracks; crack length from the hole edge",
        RowOfHoles = "row_of_holes": "row of holes with cracks (multiple-site damage, link-up); crack length from the hole edge",
        Lug = "lug": "lug loaded by a pin, straight or round head, cracks at the hole; crack length from the hole edge",
        EdgeNotch = "edge_notch": "plate with a U-shaped edge notch and a crack at its root; crack length from the notch root",
        StopHole = "stop_hole": "central crack with a stop hole at each end; needs [fatigue.initiation]; crack length = half length, center to tip beyond the hole",
        SingleEdgeBend = "single_edge_bend": "SE(B) of ASTM E399 and E1820 on three rollers, or four with inner_span_mm; crack length from the edge",
        EccentricSingleEdgeTension = "eccentric_single_edge_tension": "ESE(T) of ASTM E647 annex A3, loaded by pins; crack length from the edge",
        WedgeOpening = "wedge_opening": "modified WOL of Novak and Rolfe, half height 0.486 W, loaded by pins; crack length from the load line",
        Cruciform = "cruciform": "cruciform with a central crack, uniaxial or biaxial; crack length = half length",
    }

    pub enum Head for "specimen.head" {
        Straight = "straight": "square end, edge_distance_mm from the hole center",
        Round = "round": "half circle about the hole center",
    }

    /// How the ends of a single edge tension specimen are held.
    pub enum Ends for "specimen.ends" {
        Pinned = "pinned": "rigid grips free to rotate about a pin on the centerline",
        Clamped = "clamped": "rigid grips that cannot rotate",
        UniformStress = "uniform_stress": "uniform stress over both ends, the condition of the handbook formula",
    }
}

/// A circle cut out of the plate, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    pub centre: Point,
    pub radius: f64,
}

/// A straight slot of constant width with square ends, cut out of the plate, m: the middles of both ends, and the width across.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slot {
    pub from: Point,
    pub to: Point,
    pub width: f64,
}

/// A straight through crack, or a straight piece of one with bends; ends in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crack {
    pub from: Point,
    pub to: Point,
    /// Whether it goes on from the end of the crack before it in the list, as the next piece of the same line.
    pub continues: bool,
}

impl Crack {
    pub fn straight(from: Point, to: Point) -> Self {
        Crack { from, to, continues: false }
    }
}

/// Where growth can start, m: a crack end inside the plate, or the middle of a slot's end face that lies in the material
/// (unless a crack starts from that face).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipSeed {
    pub position: Point,
    /// Unit vector in which the crack or slot points, out of itself into the material.
    pub direction: Point,
    /// Whether this is the end face of a slot rather than the end of a sharp crack.
    pub from_slot: bool,
}

/// A load on part of the boundary, per unit of the case's load magnitude: on a straight stretch of the outline between two ends, m, or a pin.
#[derive(Debug, Clone, PartialEq)]
pub enum Load {
    /// Uniform traction, Pa per Pa of the case's nominal stress (so 1.0 normal to the edge for plain tension).
    Edge { from: Point, to: Point, traction: Point },
    /// Traction that varies linearly from one end to the other, Pa per Pa: bending in the plane.
    Bent { from: Point, to: Point, tractions: [Point; 2] },
    /// A pin, which bears on the rim of its hole. `force` is in N per unit of the case's nominal load (N per N, or N per Pa beside loaded edges), along
    /// the unit vector `direction`.
    Pin {
        /// Index into `Specimen::holes`.
        hole: usize,
        direction: Point,
        force: f64,
        contact: Bearing,
    },
}

/// Abscissas of the Gauss rule of two points on 0 to 1: force and moment of a traction that varies linearly are those of half of it there.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

impl Load {
    /// Whether it is a pin whose contact follows from the load.
    pub fn is_elastic_pin(&self) -> bool {
        matches!(self, Load::Pin { contact: Bearing::Elastic(_), .. })
    }

    /// The stretch of the outline that it loads, with the tractions at both ends; `None` of a pin.
    pub fn on_edge(&self) -> Option<(Point, Point, [Point; 2])> {
        match *self {
            Load::Edge { from, to, traction } => Some((from, to, [traction; 2])),
            Load::Bent { from, to, tractions } => Some((from, to, tractions)),
            Load::Pin { .. } => None,
        }
    }

    /// Two places with forces, N per m of thickness, that have force and moment of what acts on an edge from one share of its way to
    /// another; none of a pin.
    pub fn forces_between(&self, [start, end]: [f64; 2]) -> Vec<(Point, Point)> {
        let Some((from, to, tractions)) = self.on_edge() else { return Vec::new() };
        let half = 0.5 * (end - start) * geometry::distance(from, to);
        let at = |share: f64| {
            let share = start + share * (end - start);
            (geometry::along(from, to, share), geometry::along(tractions[0], tractions[1], share).map(|t| half * t))
        };
        GAUSS.map(at).to_vec()
    }
}

/// What holds a straight stretch of the outline between two ends, m, or the ends of a plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Support {
    /// Points within `depth` of the straight outline stretch `from`-`to` (at least one row) keep the named components at zero.
    Fixed { from: Point, to: Point, depth: f64, x: bool, y: bool },
    /// Both ends move as rigid blocks that do not rotate (clamped grips); the relative displacement along y is what the load asks.
    ClampedEnds,
    /// The straight stretch `from`-`to` is moved as it is: every place of it by `way` of the displacement of the load along the unit
    /// vector `direction`, so that it neither bends nor turns. Unless `held` at zero across the displacement it slides in its grip.
    Moved { from: Point, to: Point, direction: Point, way: f64, held: bool },
    /// Both ends move as rigid blocks that may rotate (pinned grips): end rows are made stiff, load is uniform over them.
    RigidEnds,
    /// What the body does not know of takes up the loads, so that they need not balance: supports and driven points of a fracture
    /// scene, or inertia.
    Elsewhere,
}

/// What the nominal load of a case means for this specimen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LoadMeasure {
    /// `stress_*_mpa`: gross stress; the force is stress x gross width x thickness.
    Stress,
    /// `force_*_n`: force on the pins.
    Force,
}

/// A plate as it is tested: geometry, loads, supports, where cracks start. All lengths in metres.
#[derive(Debug, Clone, PartialEq)]
pub struct Specimen {
    pub kind: SpecimenKind,
    /// Outline, counter-clockwise, not closed (last point differs from first).
    pub outline: Vec<Point>,
    pub holes: Vec<Hole>,
    pub slots: Vec<Slot>,
    pub cracks: Vec<Crack>,
    /// Crack ends that can grow, in the order of result columns.
    pub tips: Vec<TipSeed>,
    pub thickness: f64,
    /// Characteristic width of the specimen's standard: W, m (C(T): from the load line).
    pub width: f64,
    /// Width that the lattice spacing has to divide, m (C(T): 1.25 W).
    pub gross_width: f64,
    /// Lines through a horizontal and a vertical crack that must fall between two rows and columns of points; `None`: free.
    pub crack_plane_y: Option<f64>,
    pub crack_plane_x: Option<f64>,
    /// Crack length at the start in the specimen's convention, m.
    pub crack_length: f64,
    pub convention: LengthConvention,
    pub loads: Vec<Load>,
    /// Pressure on the faces of all cracks, also where they grow, per unit of nominal load: Pa per Pa, or Pa per N.
    pub crack_pressure: f64,
    pub load_measure: LoadMeasure,
    /// Supports; empty means the loads are in equilibrium by themselves and the plate floats.
    pub supports: Vec<Support>,
    /// Handbook K of a named plate under the loads that it brings along ([`named`]); `None` under others.
    pub own_formula: Option<handbook::HandbookFormula>,
    /// What of its crack does not go through the thickness; `cracks` and `tips` are then those that are seen from the front.
    pub part_through: Option<PartThrough>,
    /// β(a) of a table of the case, in place of a handbook's K.
    pub beta: Option<BetaTable>,
}

impl Specimen {
    /// A plate of a standard kind under uniform stress over its ends y = ±length/2, before cracks are put in.
    pub fn strip(kind: SpecimenKind, width: f64, length: f64, thickness: f64) -> Self {
        let (x, y) = (width / 2.0, length / 2.0);
        Specimen {
            kind,
            outline: vec![[-x, -y], [x, -y], [x, y], [-x, y]],
            holes: Vec::new(),
            slots: Vec::new(),
            cracks: Vec::new(),
            tips: Vec::new(),
            thickness,
            width,
            gross_width: width,
            crack_plane_y: Some(0.0),
            crack_plane_x: None,
            crack_length: 0.0,
            convention: LengthConvention::MeanOfTips,
            loads: vec![
                Load::Edge { from: [-x, y], to: [x, y], traction: [0.0, 1.0] },
                Load::Edge { from: [-x, -y], to: [x, -y], traction: [0.0, -1.0] },
            ],
            load_measure: LoadMeasure::Stress,
            crack_pressure: 0.0,
            supports: Vec::new(),
            own_formula: None,
            part_through: None,
            beta: None,
        }
    }

    /// Whether its ends are clamped or sides of it moved straight, so that they do not turn.
    pub fn has_straight_grips(&self) -> bool {
        self.supports.iter().any(|support| matches!(support, Support::ClampedEnds | Support::Moved { .. }))
    }

    /// Section over which the nominal stress makes the force `P` of the sides that are moved straight, m²: `P δ = Σ F_i u_i` with
    /// `u_i = way_i δ`.
    pub fn moved_section(&self) -> Option<f64> {
        let area = |support: &Support| match *support {
            Support::Moved { from, to, way, .. } => Some(way * geometry::distance(from, to) * self.thickness),
            _ => None,
        };
        self.supports.iter().filter_map(area).reduce(|sum, area| sum + area)
    }

    /// Size of the plate along y, m.
    pub fn length(&self) -> f64 {
        let [low, high] = geometry::bounding_box(&self.outline);
        high[1] - low[1]
    }

    /// Sizes of the flaws that spacing and horizon have to resolve, m: half length of a crack with two tips, whole length of one with
    /// one tip, length of a slot; C(T) from the load line.
    pub fn flaw_sizes(&self) -> Vec<f64> {
        if !self.kind.is_plate() {
            return vec![self.crack_length];
        }
        let cracks = self.crack_lines().into_iter().map(|line| line.length() / self.tips_of(&line).max(1) as f64);
        let slots = self.slots.iter().map(|slot| self.length_inside(slot.from, slot.to));
        cracks.chain(slots).collect()
    }

    /// The smallest of the [`Specimen::flaw_sizes`], m.
    pub fn smallest_flaw(&self) -> f64 {
        self.flaw_sizes().into_iter().fold(f64::INFINITY, f64::min)
    }

    /// Distance of a place from the nearest rim, m: outline, holes, slots.
    #[inline]
    pub fn rim_distance(&self, at: Point) -> f64 {
        let holes = self.holes.iter().map(|hole| (geometry::distance(at, hole.centre) - hole.radius).abs());
        let slots = self.slots.iter().map(|slot| geometry::distance_to_polygon(at, &slot.corners()));
        holes.chain(slots).fold(geometry::distance_to_polygon(at, &self.outline), f64::min)
    }

    /// Area of the material, m²: outline less holes and slots.
    pub fn area(&self) -> f64 {
        let holes: f64 = self.holes.iter().map(|hole| std::f64::consts::PI * hole.radius * hole.radius).sum();
        let slots: f64 = self.slots.iter().map(|slot| self.length_inside(slot.from, slot.to) * slot.width).sum();
        geometry::polygon_area(&self.outline) - holes - slots
    }
}
