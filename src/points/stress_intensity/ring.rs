//! Interaction integral around a tip of a crack that may bend, with holes, edges and other cracks nearby.
//!
//! With an auxiliary near-tip field of one pure mode (Yau, Wang and Corten 1980, J. Appl. Mech. 47:335; domain form Shih,
//! Moran and Nakamura 1986, Int. J. Fract. 30:79)
//!
//! `K = (E'/2) [ ∫_A P_j q_,j dA - ∫_S P_j m_j q ds ]`, `P_j = σ_ij u^aux_i,1 + σ^aux_ij u_i,1 - σ_ik ε^aux_ik δ_1j`,
//!
//! for K^aux = 1, q being 1 inside the ring and 0 outside it. P is free of divergence, so that the second integral, over all
//! rims of the material within the outer radius with outward normal m, makes up for what is not ring: faces of the own crack
//! where it leaves the line straight behind its tip, holes, edges, faces of other cracks. Real tractions there are those of the
//! loads and of flanks in contact: `P_j m_j = t_i u^aux_i,1 + σ^aux_ij m_j u_i,1 - σ_ik ε^aux_ik m_1`. On the free faces of a straight
//! crack it vanishes.
//!
//! The auxiliary field is continued across ±π to the faces of the real crack: angles are counted from x₁ to the face on the
//! side of a point, wherever it lies. It stays in equilibrium there and only its tractions on the faces are not zero.
//!
//! Outside its core a nonlocal body has the field of a sharp crack whose tip lies a little ahead of where the cut bonds end. A field
//! shifted by x is `u - x u_,1`, so with an auxiliary field `U` whose derivative `U_,1` is that of K^aux = 1 (the term r^{3/2} of
//! Williams' series, which is orthogonal to all others of the field) the same integral gives K x.
//!
//! With the field of a force F along x₁ at the tip as auxiliary field, whose stress is `σ_rr = -F cos θ / (π r)` and which leaves the
//! faces free, the integral is the stress along the crack (Kfouri 1986, Int. J. Fract. 30:301): `T = E' / F [...]`. With a pressure p on
//! the faces at the tip the field has the stress -p across the crack as well, of which the jump of the auxiliary displacement makes p: T is
//! what is read less p.
//!
//! The bonds near the tip, where the displacement of a nonlocal body is not that of a sharp crack, lie inside the ring and take
//! no part.

use std::cell::RefCell;
use std::collections::{HashMap, HashSet};

use super::crack_faces::{CrackFaces, FaceSegment, cells_along, cells_at, continued, parts};
use super::gradient::{Derivatives, TipFrame, derivatives_at};
use crate::body::Body;
use crate::body::pre_crack::{as_cut, faces, places_near};
use crate::solver::field::Layout;
use crate::state::Bonds;
use perilife_plate::loading::pieces::{LoadPiece, load_pieces};
use perilife_plate::material::Material;
use perilife_plate::specimen::facets::{Facet, facets};
use perilife_plate::specimen::geometry::{Places, distance, distance_to_segment};
use perilife_plate::specimen::{CrackLine, LineEnd, Point, Specimen, Support};
use perilife_plate::williams::{Eigenfunction, Elasticity, Symmetry, coefficient_of_unit_factor, force_gradient};

/// Inner radius over outer radius. With these and the smooth weight an exact field on rows at 0, 22.5 and 45° is read 0.1 % low on a
/// ring of three horizons, wherever its tip lies between the points, within 0.02 %.
const INNER_SHARE: f64 = 0.3;
/// Inner radius at least, in horizons, where that leaves half of the ring.
const INNER_HORIZONS: f64 = 0.75;
/// Distance from a tip, in horizons, within which faces are not read: the core is not that of a sharp crack.
const CORE_HORIZONS: f64 = 0.75;
/// Intact bonds of a point from which the derivatives of its displacement are known.
const NEIGHBOURS_LEAST: usize = 6;
/// Distance between cracks, in spacings, that are joined.
const JOINED_SPACINGS: f64 = 1e-3;
/// Distance of a joint of cracks from a tip, in horizons, from which the ring ends there: a smaller one would say less.
const JOINT_HORIZONS: f64 = 2.0;
/// Relative difference of distances that are equal.
const EQUAL: f64 = 1e-3;
/// Pieces of a crack face per spacing.
const PIECES_PER_SPACING: f64 = 2.0;
/// Room left, in horizons, between a ring and what it cannot take in: another tip, a support.
const ROOM_HORIZONS: f64 = 0.2;

/// Auxiliary fields: of K_I and K_II, and those whose derivatives over x₁ they are.
const AUXILIARY: [(i32, Symmetry); 4] =
    [(1, Symmetry::Opening), (1, Symmetry::Sliding), (3, Symmetry::Opening), (3, Symmetry::Sliding)];

/// A value for each of the [`AUXILIARY`] fields, and for that of a force at the tip.
type PerAuxiliary = [f64; 5];

/// What does not change around the tips of a plate.
#[derive(Debug, Clone)]
pub struct RingGeometry {
    layout: Layout,
    elasticity: Elasticity,
    /// Pieces of the rim, and whether nothing presses on them.
    rim: Vec<(Facet, bool)>,
    loads: Vec<LoadPiece>,
    supports: Vec<[Point; 2]>,
    specimen: Specimen,
    rim_cells: HashSet<usize>,
}

/// Plate in equilibrium around its tips.
#[derive(Clone, Copy)]
pub struct Balanced<'a> {
    pub body: &'a Body,
    /// Which of them carry.
    pub bonds: &'a Bonds,
    /// Displacement in the layout of [`Layout::of`], m.
    pub displacement: &'a [f64],
    /// Nominal load, Pa or N.
    pub load: f64,
    /// All cracks as they are cut.
    pub lines: &'a [CrackLine],
    /// Flanks in contact, both of every place.
    pub pressures: &'a [FlankPressure],
}

/// Traction on a piece of flank: that of a pressure, or what a residual stress releases there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlankPressure {
    /// The piece; its normal points out of the material.
    pub facet: Facet,
    /// Traction on the material, Pa.
    pub traction: Point,
}

impl FlankPressure {
    /// What of it presses on the material, Pa.
    fn pressure(&self) -> f64 {
        -(self.traction[0] * self.facet.normal[0] + self.traction[1] * self.facet.normal[1])
    }
}

/// K_I and K_II, and the ring they were read on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingFactors {
    /// K_I and K_II, Pa√m.
    pub factors: [f64; 2],
    /// Stress along the crack T, Pa.
    pub t_stress: f64,
    /// How far ahead of the end of the line the field has its tip, m: of both modes together, the larger counting more.
    pub tip_offset: f64,
    /// The same of either mode.
    pub tip_offsets: [f64; 2],
    /// Outer radius of the ring, m.
    pub radius: f64,
    /// What the pressure between flanks adds to K_I, Pa√m.
    pub of_pressure: f64,
}

impl RingGeometry {
    /// Rim, loads and supports of a specimen.
    pub fn new(body: &Body, specimen: &Specimen, material: &Material) -> Self {
        let spacing = body.lattice.spacing;
        let held = specimen.supports.iter().filter_map(|support| match *support {
            Support::Fixed { from, to, .. } | Support::Moved { from, to, .. } => Some([from, to]),
            _ => None,
        });
        let loads = load_pieces(specimen, spacing);
        // Loaded pieces by cells of one spacing: on a long rim, all pairs take longer than an equilibrium.
        let loaded = Places::of(spacing, loads.iter().map(|load| load.facet.at));
        let is_free = |facet: &Facet| {
            let near = loaded.near(facet.at, 0.25 * spacing).map(|load| loaded.away(load, facet.at));
            near.into_iter().all(|[x, y]| x.hypot(y) > 0.25 * spacing)
        };
        let rim: Vec<(Facet, bool)> = facets(specimen, spacing).into_iter().map(|facet| (facet, is_free(&facet))).collect();
        RingGeometry {
            layout: Layout::of(&body.lattice, body.stencil.unknowns),
            elasticity: Elasticity::of(material),
            rim_cells: rim.iter().flat_map(|(facet, _)| cells_at(body, facet.at)).collect(),
            rim,
            loads,
            supports: held.collect(),
            specimen: specimen.clone(),
        }
    }

    /// Largest outer radius for a tip, m: up to `wanted`, short of the other end of its crack, other tips and supports, and not beyond a
    /// joint of cracks that is not near.
    pub fn radius(&self, body: &Body, lines: &[CrackLine], end: LineEnd, tips: &[LineEnd], wanted: f64) -> f64 {
        let here = lines[end.line].end(end.at_last);
        let others = tips.iter().filter(|other| **other != end).map(|other| distance(here, lines[other.line].end(other.at_last)));
        let supports = self.supports.iter().map(|[a, b]| distance_to_segment(here, *a, *b));
        // Past a joint the auxiliary field can follow one of the arms only.
        let slack = JOINED_SPACINGS * body.lattice.spacing;
        let own = &lines[end.line];
        let other_lines = lines.iter().enumerate().filter(|(line, _)| *line != end.line).map(|(_, line)| line);
        let on_own = other_lines.flat_map(|line| {
            let ends = [true, false].map(|at_last| line.end(at_last)).into_iter().filter(|&at| own.distance(at) < slack);
            let own_ends = [true, false].map(|at_last| own.end(at_last)).into_iter().filter(|&at| line.distance(at) < slack);
            ends.chain(own_ends).collect::<Vec<_>>()
        });
        let joints = on_own.map(|at| distance(here, at)).filter(|away| *away > JOINT_HORIZONS * body.horizon());
        let room = ROOM_HORIZONS * body.horizon();
        others.chain(supports).chain(joints.map(|away| away + room)).fold(f64::INFINITY, f64::min).min(wanted + room) - room
    }

    /// K_I and K_II of a tip by a ring of some outer radius, m.
    pub fn factors(&self, plate: Balanced<'_>, end: LineEnd, outer: f64) -> RingFactors {
        let Balanced { body, lines, .. } = plate;
        let line = &lines[end.line];
        let frame = TipFrame { origin: line.end(end.at_last), ahead: line.direction(end.at_last) };
        let own = CrackFaces::new(body, &continued(lines, end, JOINED_SPACINGS * body.lattice.spacing), end.at_last, &frame);
        let inner = (INNER_SHARE * outer).max((INNER_HORIZONS * body.horizon()).min(0.5 * outer));
        let around = RingIntegral { surroundings: self, plate, frame, own, inner, outer, known: RefCell::default() };
        let mut sums: PerAuxiliary = [0.0; 5];
        let mut add = |part: PerAuxiliary| sums.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        let near = |at: Point| distance(at, frame.origin) < outer;
        let spacing = body.lattice.spacing;
        let is_piece_near = |[a, b]: &[Point; 2]| distance_to_segment(frame.origin, *a, *b) < outer + 2.0 * spacing;
        let pieces = lines.iter().flat_map(CrackLine::pieces).filter(is_piece_near);
        let cracks: Vec<[Point; 2]> = pieces.map(|piece| as_cut(body, piece)).collect();
        // The weight has a slope on the ring only.
        let with_slope = inner - spacing..outer + spacing;
        let is_near = |cell: &usize| with_slope.contains(&distance(body.lattice.position(*cell), frame.origin));
        let rim_cells = self.rim_cells.iter().copied();
        // A point that hangs on a few bonds says nothing: its cell is that of its neighbours.
        let is_known = |place: usize| plate.bonds.intact_at(body, place) >= NEIGHBOURS_LEAST;
        let loose = places_near(body, frame.origin, frame.origin, outer + spacing).filter(|place| !is_known(*place));
        let cut: HashSet<usize> = rim_cells.chain(cells_along(body, &cracks)).chain(loose).filter(is_near).collect();
        for place in places_near(body, frame.origin, frame.origin, outer).filter(|place| !cut.contains(place)) {
            let at = body.lattice.position(place);
            add(around.area(at, place, 1.0));
        }
        for FaceSegment { at, place, share } in parts(body, &self.specimen, &cracks, &cut, is_known) {
            add(around.area(at, place, share));
        }
        self.rim.iter().filter(|(facet, _)| near(facet.at)).for_each(|(facet, free)| add(around.rim(facet, *free)));
        self.loads.iter().filter(|piece| near(piece.facet.at)).for_each(|piece| add(around.load(piece)));
        for (index, line) in lines.iter().enumerate() {
            // The way back from the tip in the sense of its own line.
            for piece in line.pieces().filter(|[a, b]| distance_to_segment(frame.origin, *a, *b) < outer) {
                faces(as_cut(body, piece), spacing / PIECES_PER_SPACING).filter(|facet| near(facet.at)).for_each(|facet| {
                    if index != end.line || distance(facet.at, frame.origin) > CORE_HORIZONS * body.horizon() {
                        let is_pressed = |place: &FlankPressure| distance(place.facet.at, facet.at) < 0.5 * place.facet.length;
                        add(around.rim(&facet, !plate.pressures.iter().any(is_pressed)));
                    }
                });
            }
        }
        let pressed = || plate.pressures.iter().filter(|flank| near(flank.facet.at));
        let nearest = pressed().map(|flank| distance(flank.facet.at, frame.origin)).fold(f64::INFINITY, f64::min);
        let mut of_pressure = 0.0;
        for flank in pressed() {
            // The last piece reaches up to the tip of the ring.
            let is_last = nearest < spacing && distance(flank.facet.at, frame.origin) < (1.0 + EQUAL) * nearest;
            let part = around.pressure(flank, is_last);
            of_pressure += 0.5 * self.elasticity.plane_modulus * part[0];
            add(part);
        }
        // That of the places nearest to a tip is not: a pressed crack ends in a soft core.
        let beside = |flank: &&FlankPressure| {
            let away = distance(flank.facet.at, frame.origin) / body.horizon();
            (CORE_HORIZONS..2.0 * CORE_HORIZONS).contains(&away)
        };
        let count = pressed().filter(beside).count();
        let is_pressed = nearest < spacing && count > 0;
        let at_tip =
            if is_pressed { pressed().filter(beside).map(FlankPressure::pressure).sum::<f64>() / count as f64 } else { 0.0 };
        let [k_i, k_ii, shifted_i, shifted_ii, half_t] = sums.map(|sum| 0.5 * self.elasticity.plane_modulus * sum);
        let tip_offset = (k_i * shifted_i + k_ii * shifted_ii) / (k_i * k_i + k_ii * k_ii);
        RingFactors {
            factors: [k_i, k_ii],
            t_stress: 2.0 * half_t - at_tip,
            tip_offset,
            tip_offsets: [shifted_i / k_i, shifted_ii / k_ii],
            radius: outer,
            of_pressure,
        }
    }
}

/// A ring around a tip.
struct RingIntegral<'a> {
    surroundings: &'a RingGeometry,
    plate: Balanced<'a>,
    frame: TipFrame,
    own: CrackFaces,
    inner: f64,
    outer: f64,
    /// Derivatives at points that were asked for: those beside a rim serve many pieces of it.
    known: RefCell<HashMap<usize, Option<Derivatives>>>,
}

impl RingIntegral<'_> {
    /// q and its slope over r: 1 - 10t³ + 15t⁴ - 6t⁵ over the ring, whose curvature is continuous at both of its rims.
    fn weight(&self, r: f64) -> (f64, f64) {
        let t = ((r - self.inner) / (self.outer - self.inner)).clamp(0.0, 1.0);
        let [square, rest] = [t * t, 1.0 - t];
        (1.0 - t * square * (10.0 - 15.0 * t + 6.0 * square), -30.0 * square * rest * rest / (self.outer - self.inner))
    }

    /// Gradients of the auxiliary displacements in the frame.
    fn auxiliary(&self, r: f64, theta: f64) -> [[[f64; 2]; 2]; 5] {
        let elasticity @ Elasticity { kappa, shear_modulus, .. } = self.surroundings.elasticity;
        let [a, b, c, d] = AUXILIARY.map(|(order, symmetry)| {
            // The derivative over x₁ of the function of order 3 is 3/2 of that of order 1.
            let scale = coefficient_of_unit_factor(symmetry) / (2.0 * shear_modulus) / if order == 3 { 1.5 } else { 1.0 };
            Eigenfunction { order, symmetry }.gradient(kappa, r, theta).map(|row| row.map(|g| scale * g))
        });
        [a, b, c, d, force_gradient(elasticity, r, theta)]
    }

    fn derivatives(&self, place: usize) -> Option<Derivatives> {
        let Balanced { body, bonds, displacement, .. } = self.plate;
        let find = || derivatives_at(body, bonds, &self.surroundings.layout, displacement, &self.frame, place);
        *self.known.borrow_mut().entry(place).or_insert_with(find)
    }

    /// The gradient at a place of the plate, by the derivatives at one of its points.
    fn gradient_towards(&self, at: Point, place: usize) -> Option<[[f64; 2]; 2]> {
        let from = self.plate.body.lattice.position(place);
        Some(self.derivatives(place)?.at(self.frame.vector([at[0] - from[0], at[1] - from[1]])))
    }

    /// P_j q_,j of a share of a cell at a position, its field that of a point, times the area.
    fn area(&self, at: Point, place: usize, share: f64) -> PerAuxiliary {
        let spacing = self.plate.body.lattice.spacing;
        let (r, theta) = self.own.polar(self.frame.local(at));
        let (_, slope) = self.weight(r);
        if slope == 0.0 {
            return [0.0; 5];
        }
        let Some(gradient) = self.gradient_towards(at, place) else { return [0.0; 5] };
        let q = [slope * theta.cos(), slope * theta.sin()];
        let area = share * spacing * spacing;
        let elasticity = &self.surroundings.elasticity;
        self.auxiliary(r, theta).map(|auxiliary| area * elasticity.interaction(&gradient, &auxiliary, q))
    }

    /// -P_j m_j q of a piece of free rim times its length.
    fn rim(&self, facet: &Facet, is_free: bool) -> PerAuxiliary {
        let lattice = &self.plate.body.lattice;
        let inside = [0, 1].map(|i| facet.at[i] - 1e-6 * lattice.spacing * facet.normal[i]);
        let (r, theta) = self.own.polar(self.frame.local(inside));
        let (q, _) = self.weight(r);
        let Some(gradient) = self.place_behind(facet).and_then(|place| self.gradient_towards(facet.at, place)) else {
            return [0.0; 5];
        };
        let normal = self.frame.vector(facet.normal);
        let elasticity = &self.surroundings.elasticity;
        let gradient = if is_free { without_traction(&gradient, normal, elasticity) } else { gradient };
        self.auxiliary(r, theta)
            .map(|auxiliary| -elasticity.interaction_on_face(&gradient, &auxiliary, normal) * q * facet.length)
    }

    /// The same of a load on the rim: -t_i u^aux_i,1 q.
    fn load(&self, piece: &LoadPiece) -> PerAuxiliary {
        let (r, theta) = self.own.polar(self.frame.local(piece.facet.at));
        let (q, _) = self.weight(r);
        let scale = self.plate.load / self.surroundings.specimen.thickness;
        let [t1, t2] = self.frame.vector(piece.force).map(|force| scale * force);
        self.auxiliary(r, theta).map(|auxiliary| -(t1 * auxiliary[0][0] + t2 * auxiliary[1][0]) * q)
    }

    /// The same of a traction on a flank, -p m of a pressure p. The auxiliary gradient goes with r^-½ over the piece, which is taken as if
    /// it lay straight behind the tip: `∫ r^-½ dr` in place of its middle.
    fn pressure(&self, flank: &FlankPressure, is_last: bool) -> PerAuxiliary {
        let FlankPressure { facet, traction } = *flank;
        let spacing = self.plate.body.lattice.spacing;
        let inside = [0, 1].map(|i| facet.at[i] - 1e-6 * spacing * facet.normal[i]);
        let (r, theta) = self.own.polar(self.frame.local(inside));
        let (q, _) = self.weight(r);
        let [near, far] = [if is_last { 0.0 } else { (r - 0.5 * facet.length).max(0.0) }, r + 0.5 * facet.length];
        let length = 2.0 * (far.sqrt() - near.sqrt()) * r.sqrt();
        let [t1, t2] = self.frame.vector(traction).map(|t| t * length);
        self.auxiliary(r, theta).map(|auxiliary| -(t1 * auxiliary[0][0] + t2 * auxiliary[1][0]) * q)
    }

    /// The point of the material nearest to a piece of rim, on its side.
    fn place_behind(&self, facet: &Facet) -> Option<usize> {
        let body = self.plate.body;
        let spacing = body.lattice.spacing;
        let depth = |place: usize| {
            let at = body.lattice.position(place);
            (facet.at[0] - at[0]) * facet.normal[0] + (facet.at[1] - at[1]) * facet.normal[1]
        };
        let wanted = [0, 1].map(|i| facet.at[i] - 0.5 * spacing * facet.normal[i]);
        places_near(body, wanted, wanted, 1.5 * spacing)
            .filter(|&place| depth(place) > 0.0)
            .map(|place| (distance(body.lattice.position(place), wanted), place))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, place)| place)
    }
}

/// The gradient on a rim without traction: derivatives along it as they are, those across it from `σ m = 0`. Close to a rim the
/// neighbours of a point lie on one side, and tell the former better than the latter.
fn without_traction(gradient: &[[f64; 2]; 2], [m1, m2]: [f64; 2], elasticity: &Elasticity) -> [[f64; 2]; 2] {
    let (t1, t2) = (-m2, m1);
    let along = gradient.map(|row| row[0] * t1 + row[1] * t2);
    let (stretch, turn) = (along[0] * t1 + along[1] * t2, along[0] * m1 + along[1] * m2);
    // Strain across over strain along in uniaxial stress, -ν or -ν/(1-ν): (κ-3)/(κ+1).
    let across = (elasticity.kappa - 3.0) / (elasticity.kappa + 1.0) * stretch;
    let normal = [across * m1 - turn * t1, across * m2 - turn * t2];
    [0, 1].map(|i| [along[i] * t1 + normal[i] * m1, along[i] * t2 + normal[i] * m2])
}
