//! What is tested: a flat plate with an outline, holes, slots, cracks, loads and supports.
//!
//! Lengths in metres, the load direction of the standard specimens is y. A [`Specimen`] is fixed once built:
//! nothing in a run changes it. Cracks go through the thickness; part-through and corner cracks are refused by name.

/// A point of the plate, metres.
pub type Point = [f64; 2];

crate::kinds! {
    /// Shapes a case can name.
    pub enum SpecimenKind for "specimen.kind" {
        MiddleTension = "middle_tension": "plate with a central crack, M(T) of ASTM E647; crack length = half length a",
        SingleEdgeTension = "single_edge_tension": "plate with one edge crack; needs ends = pinned, clamped or uniform_stress",
        DoubleEdgeTension = "double_edge_tension": "plate with two equal edge cracks; crack length = length of each",
        CompactTension = "compact_tension": "C(T) of ASTM E647, loaded by pins; crack length from the load line",
        Plate = "plate": "any outline with round holes, slots and straight through cracks at any angle",
    }
}

crate::kinds! {
    /// How the ends of a single edge tension specimen are held.
    pub enum Ends for "specimen.ends" {
        Pinned = "pinned": "rigid grips free to rotate about a pin on the centre line",
        Clamped = "clamped": "rigid grips that cannot rotate",
        UniformStress = "uniform_stress": "uniform stress over both ends, the condition of the handbook formula",
    }
}

/// A circle cut out of the plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    /// Centre, m.
    pub centre: Point,
    /// Radius, m.
    pub radius: f64,
}

/// A straight slot of constant width with square ends, cut out of the plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slot {
    /// Middle of one end, m.
    pub from: Point,
    /// Middle of the other end, m.
    pub to: Point,
    /// Width across, m.
    pub width: f64,
}

/// A straight through crack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crack {
    /// One end, m.
    pub from: Point,
    /// Other end, m.
    pub to: Point,
}

/// Where growth can start: a crack end inside the plate, or the middle of a slot's end face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipSeed {
    /// Position, m.
    pub position: Point,
    /// Unit vector in which the crack or slot points, out of itself into the material.
    pub direction: Point,
    /// Length of crack or slot this tip stands for, m: growth is added to the sum over tips in the specimen's convention.
    pub from_slot: bool,
}

/// A load on part of the boundary, per unit of the case's load magnitude.
#[derive(Debug, Clone, PartialEq)]
pub enum Load {
    /// Uniform traction on a straight stretch of the outline.
    /// `traction` is in Pa per Pa of the case's nominal stress (so 1.0 normal to the edge for plain tension).
    Edge { from: Point, to: Point, traction: Point },
    /// Bearing pressure of a pin on the side of a hole that faces `direction` (cosine distribution over the half circle).
    /// `force` is in N per N of the case's force, along the unit vector `direction`.
    Pin { hole: usize, direction: Point, force: f64 },
}

/// What is held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Support {
    /// Points within `depth` of the straight outline stretch `from`-`to` (at least one row) keep the named components at zero.
    Fixed { from: Point, to: Point, depth: f64, x: bool, y: bool },
    /// Both ends move as rigid blocks that do not rotate (clamped grips); the relative displacement along y is what the load asks.
    ClampedEnds,
    /// Both ends move as rigid blocks that may rotate (pinned grips): end rows are made stiff, load is uniform over them.
    RigidEnds,
}

/// How crack length is read, see [`Specimen::crack_length`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LengthConvention {
    /// Initial length plus the mean growth of all tips (half length of a central crack, each of two edge cracks, C(T)).
    MeanOfTips,
    /// Initial length of all cracks plus the growth of all tips.
    SumOfTips,
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
    /// Which shape it is.
    pub kind: SpecimenKind,
    /// Outline, counter-clockwise, not closed (last point differs from first).
    pub outline: Vec<Point>,
    /// Round holes.
    pub holes: Vec<Hole>,
    /// Slots.
    pub slots: Vec<Slot>,
    /// Through cracks at the start.
    pub cracks: Vec<Crack>,
    /// Crack ends that can grow, in the order of result columns.
    pub tips: Vec<TipSeed>,
    /// Thickness, m.
    pub thickness: f64,
    /// Characteristic width of the specimen's standard: W, m (C(T): from the load line).
    pub width: f64,
    /// Width that the lattice spacing has to divide, m (C(T): 1.25 W).
    pub gross_width: f64,
    /// A line y = const through a horizontal crack that must fall between two rows of points, and x likewise; None = free.
    pub crack_plane_y: Option<f64>,
    /// Crack length at the start in the specimen's convention, m.
    pub crack_length: f64,
    /// How growth of tips adds up to crack length.
    pub convention: LengthConvention,
    /// Loads per unit of nominal load.
    pub loads: Vec<Load>,
    /// Whether the nominal load is a stress or a force.
    pub load_measure: LoadMeasure,
    /// Supports; empty means the loads are in equilibrium by themselves and the plate floats.
    pub supports: Vec<Support>,
}

impl Specimen {
    /// Crack length in the convention of the specimen for given growths of its tips, m.
    #[must_use]
    pub fn crack_length_after(&self, growth_of_tips: &[f64]) -> f64 {
        let sum: f64 = growth_of_tips.iter().sum();
        match self.convention {
            LengthConvention::MeanOfTips => self.crack_length + sum / growth_of_tips.len().max(1) as f64,
            LengthConvention::SumOfTips => self.crack_length + sum,
        }
    }
}
