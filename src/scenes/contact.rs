//! Flanks of cracks that the load presses together, for springs in equilibrium.
//!
//! A cut bond feels nothing, so that the flanks of a crack would pass through each other. In its place both of its ends get a column
//! across the crack: from the point x_i along the normal N of the crack to the field on the other side at `x_i + ξ_N N`, where
//! `ξ_N N` is the part of the bond ξ along N.
//!
//! ```text
//! g = N · (Σ s_k u_k - u_i)                     change of length of the column, m
//! k = ½ [k_n (n·N)² + k_t (t·N)²]               spring of the column, N/m, n and t along and across the bond
//! W = Σ ½ k g²  over the columns with g < 0     energy of the contact, J
//! ```
//!
//! The shares s_k of points beyond the crack (Σ s_k = 1, Σ s_k x_k = x_i + ξ_N N: moving least squares of first order, Lancaster and
//! Salkauskas 1981, Math. Comp. 37:141) make g that of the linear field there. So a column feels neither a rigid turn nor the sliding
//! of the flanks past each other, and under compression along N the columns of a bond have the energy that the bond had: a plate
//! pressed across its crack is as stiff as one without. g contains the elastic shortening of ξ_N, which the cut bond had too.
//!
//! Contact is without friction and does not adhere. Which columns are pressed is found by solving and looking again until none
//! changes, as a rule one to three times; a crack starts closed and without force, so that pressed columns stay the same while all loads
//! grow in proportion. Errors (`tests/verification/contact.rs`): 0.03 % of the load of a plate pressed across a level crack, and 0.03 %
//! at 20° to the lattice, where the energy of sliding is known; columns know nothing of strain along the flanks, so that a crack along a pulled plate, whose faces just touch, opens
//! by the contraction of about a horizon.
//!
//! The plane of an initial crack is that of its piece which the bond crosses. That of a crack that grew is the line through the
//! middles of the broken bonds around (largest principal axis within `AROUND` horizons); where they lie on no line (a cloud of
//! broken bonds, a branch) there is no plane and no column.

use super::bonds::BondState;
use super::quasi_static::stiffness::LinearSpring;
use super::scene::{Procedure, Scene, SceneLaw};
use perilife_base::raster::Snapshot;
use perilife_base::units::{MM, place_mm};
use perilife_plate::specimen::geometry::{Places, segments_touch};
use perilife_plate::specimen::{Crack, Point};
use perilife_points::body::pre_crack::cutting_line;
use perilife_points::body::sharing::linear_shares;
use perilife_points::net::Net;

/// Approach over the largest change of length of all columns from which one becomes pressed: below, mirror images and round-off decide.
const SLACK: f64 = 1e-3;
/// Distance, in horizons, within which broken bonds tell the plane of a crack that grew.
const AROUND: f64 = 1.5;
/// Scatter of the middles of broken bonds along the crack over that across, as variances, from which they lie on a line. A straight
/// cut has about 10.
const ELONGATED: f64 = 3.0;
/// Part of a bond along N, in spacings, that is none.
const LEAST: f64 = 1e-3;
/// Distance in spacings at which a point stands where a column ends.
const AT: f64 = 1e-6;
/// Overlap in spacings that is told of where nothing keeps flanks apart; an elastic strain of 0.3 % shortens the shortest columns by less.
pub const OVERLAP_TOLD: f64 = 5e-3;
/// Length in spacings up to which columns show overlap rather than elastic shortening.
const SHORT: f64 = 1.6;

/// What stands in for an end of a cut bond.
#[derive(Debug, Clone, PartialEq)]
struct Column {
    /// Twice the bond, plus one for its partner's end: ascending along the columns.
    id: u32,
    point: u32,
    /// Points beyond the crack with their shares.
    shares: Vec<(u32, f64)>,
    /// N, from the point to the other side.
    normal: Point,
    /// ξ_N, m.
    length: f64,
    /// k, N/m.
    stiffness: f64,
}

impl Column {
    /// g, m.
    fn gap(&self, u: &impl Fn(u32) -> Point) -> f64 {
        let [x, y] = self.shares.iter().fold(u(self.point).map(|u| -u), |[x, y], &(point, share)| {
            let there = u(point);
            [x + share * there[0], y + share * there[1]]
        });
        self.normal[0] * x + self.normal[1] * y
    }
}

/// Where and which way a bond crosses a crack.
#[derive(Debug, Clone, Copy)]
struct Plane {
    /// Unit vector across.
    normal: Point,
    /// A place of a crack that grew; initial cracks have pieces.
    through: Option<Point>,
}

/// How flanks stand to each other.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Touching {
    /// Columns across cracks.
    pub columns: usize,
    pub pressed: usize,
}

impl Touching {
    /// Share of the columns that are pressed; 0 without any.
    pub fn share(&self) -> f64 {
        if self.columns > 0 { self.pressed as f64 / self.columns as f64 } else { 0.0 }
    }
}

/// Contact of the flanks of a net.
pub struct NetContact<'n> {
    net: &'n Net,
    /// Initial cracks as they cut bonds.
    pieces: Vec<[Point; 2]>,
    is_initial: Vec<bool>,
    /// Points by cells as wide as the coarsest spacing.
    seats: Places,
    /// Middles of the broken bonds when columns were last built, by cells as wide as they are looked at.
    middles: Places,
    /// Broken bonds that the columns stand for.
    known: usize,
    columns: Vec<Column>,
    pressed: Vec<bool>,
    struts: Vec<LinearSpring>,
}

impl<'n> NetContact<'n> {
    /// Contact across the initial cracks of a net and what grows from them.
    pub fn new(net: &'n Net, cracks: &[Crack]) -> Self {
        let mut is_initial = vec![false; net.bonds.len()];
        net.pre_cut.iter().for_each(|&bond| is_initial[bond as usize] = true);
        NetContact {
            pieces: cracks.iter().map(|crack| cutting_line(net.grid.spacing, crack.from, crack.to)).collect(),
            is_initial,
            seats: Places::default(),
            middles: Places::default(),
            known: 0,
            columns: Vec::new(),
            pressed: Vec::new(),
            struts: Vec::new(),
            net,
        }
    }

    /// How the flanks stand.
    pub fn touching(&self) -> Touching {
        Touching { columns: self.columns.len(), pressed: self.struts.len() }
    }

    /// Pressed columns as springs between two points, for a factor that shall stand for them: the other side is the point with the
    /// largest share.
    pub fn struts(&self) -> &[LinearSpring] {
        &self.struts
    }

    /// Adds the forces of the pressed columns at a displacement; returns their energy, J.
    pub fn push(&self, u: &[f64], force: &mut [f64]) -> f64 {
        let (unknowns, at) = (self.net.unknowns, moved(self.net, u));
        let mut energy = 0.0;
        for (column, _) in self.columns.iter().zip(&self.pressed).filter(|(_, pressed)| **pressed) {
            let gap = column.gap(&at);
            let push = column.stiffness * gap;
            energy += 0.5 * push * gap;
            let mut add = |point: u32, share: f64| {
                let i = point as usize * unknowns;
                force[i] += share * push * column.normal[0];
                force[i + 1] += share * push * column.normal[1];
            };
            add(column.point, 1.0);
            column.shares.iter().for_each(|&(point, share)| add(point, -share));
        }
        energy
    }

    /// Looks which columns are pressed at an equilibrium; whether others are than before.
    pub fn settle(&mut self, bonds: &BondState, u: &[f64]) -> bool {
        let at = moved(self.net, u);
        if self.struts.is_empty() && !self.may_touch(bonds, &at) {
            return false;
        }
        self.build(bonds, true);
        let gaps: Vec<f64> = self.columns.iter().map(|column| column.gap(&at)).collect();
        let largest = gaps.iter().fold(0.0, |largest: f64, gap| largest.max(gap.abs()));
        let mut has_changed = false;
        for (pressed, &gap) in self.pressed.iter_mut().zip(&gaps) {
            let is = gap < if *pressed { 0.0 } else { -SLACK * largest };
            has_changed |= std::mem::replace(pressed, is) != is;
        }
        if has_changed {
            self.brace();
        }
        has_changed
    }

    /// Presses all columns, for pieces that nothing but contact holds; whether that is a change.
    pub fn press_all(&mut self, bonds: &BondState) -> bool {
        self.build(bonds, true);
        let has_changed = self.pressed.iter().any(|pressed| !pressed);
        self.pressed.fill(true);
        self.brace();
        has_changed
    }

    /// Largest overlap of flanks that nothing keeps apart, m, and where; `None` without cut bonds. Of grown cracks too where the bonds
    /// at this displacement are known.
    pub fn overlap(&mut self, bonds: &BondState, with_grown: bool, u: impl Fn(u32) -> Point) -> Option<(f64, Point)> {
        if !self.may_touch(bonds, &u) {
            return None;
        }
        self.build(bonds, with_grown);
        let net = self.net;
        let short = self.columns.iter().filter(|column| column.length <= SHORT * net.spacings[column.point as usize]);
        let overlaps = short.map(|column| (-column.gap(&u), net.positions[column.point as usize]));
        overlaps.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(overlap, _)| *overlap > 0.0)
    }

    /// Whether ends of broken bonds have come nearer to each other: else no flanks have, and nothing need be built.
    fn may_touch(&self, bonds: &BondState, u: &impl Fn(u32) -> Point) -> bool {
        let (mut least, mut most) = (0.0_f64, 0.0_f64);
        for (bond, _) in self.net.bonds.iter().zip(&bonds.share).filter(|(_, share)| **share == 0.0) {
            let (a, b) = (u(bond.from), u(bond.to));
            let longer = (b[0] - a[0]) * bond.normal[0] + (b[1] - a[1]) * bond.normal[1];
            (least, most) = (least.min(longer), most.max(longer.abs()));
        }
        least < -SLACK * most
    }

    /// Keeps the pressed columns as springs between two points.
    fn brace(&mut self) {
        let strut = |column: &Column| {
            let to = column.shares.iter().max_by(|a, b| a.1.total_cmp(&b.1))?.0;
            Some(LinearSpring { from: column.point, to, normal: column.normal, stiffness: column.stiffness })
        };
        let pressed = self.columns.iter().zip(&self.pressed).filter(|(_, pressed)| **pressed);
        self.struts = pressed.filter_map(|(column, _)| strut(column)).collect();
    }

    /// Pressed columns by their numbers; `None` before any column was built.
    pub fn pressed(&self) -> Option<Vec<u32>> {
        let pressed = self.columns.iter().zip(&self.pressed).filter(|(_, pressed)| **pressed);
        (self.known > 0).then(|| pressed.map(|(column, _)| column.id).collect())
    }

    /// Begins anew from these bonds with what [`NetContact::pressed`] gave.
    pub fn renew(&mut self, pressed: Option<&[u32]>, bonds: &BondState) {
        (self.known, self.columns, self.pressed, self.struts) = (0, Vec::new(), Vec::new(), Vec::new());
        if let Some(pressed) = pressed {
            self.build_with(bonds, true, pressed);
        }
    }

    /// Builds the columns of the bonds that are broken now; those that were pressed stay so.
    fn build(&mut self, bonds: &BondState, with_grown: bool) {
        let held = self.pressed().unwrap_or_default();
        self.build_with(bonds, with_grown, &held);
    }

    /// Builds the columns of the bonds that are broken now, unless they stand; those of these numbers are pressed.
    fn build_with(&mut self, bonds: &BondState, with_grown: bool, held: &[u32]) {
        let net = self.net;
        let is_meant = |b: &usize| bonds.share[*b] == 0.0 && (with_grown || self.is_initial[*b]);
        let broken: Vec<usize> = (0..net.bonds.len()).filter(is_meant).collect();
        if broken.len() == self.known {
            return;
        }
        self.known = broken.len();
        if self.seats.is_empty() {
            let coarsest = net.spacings.iter().fold(0.0, |most: f64, spacing| most.max(*spacing));
            self.seats = Places::of(coarsest, net.positions.iter().copied());
        }
        let widest = net.horizons.iter().fold(0.0, |most: f64, horizon| most.max(*horizon));
        self.middles = Places::of(AROUND * widest, broken.iter().map(|&b| middle(net, b)));
        let columns: Vec<Column> = broken.iter().flat_map(|&b| self.columns_of(b)).collect();
        self.pressed = columns.iter().map(|column| held.binary_search(&column.id).is_ok()).collect();
        self.columns = columns;
        self.brace();
    }

    /// Columns of a broken bond: of both ends, or of one with the whole spring; none where its crack has no plane.
    fn columns_of(&self, b: usize) -> Vec<Column> {
        let (net, bond) = (self.net, &self.net.bonds[b]);
        let Some(plane) = self.plane(b) else { return Vec::new() };
        let along = |v: Point| v[0] * plane.normal[0] + v[1] * plane.normal[1];
        let (n, t) = (along(bond.normal), along(bond.tangent()));
        let length = bond.length * n.abs();
        if length < LEAST * net.spacings[bond.from as usize] {
            return Vec::new();
        }
        let stiffness = bond.k_n * n * n + bond.k_t * t * t;
        let ends = [(0, bond.from, bond.to, n.signum()), (1, bond.to, bond.from, -n.signum())];
        let mut columns: Vec<Column> = ends
            .into_iter()
            .filter_map(|(end, point, beyond, sign)| {
                let normal = plane.normal.map(|x| sign * x);
                let from = net.positions[point as usize];
                let to = [from[0] + length * normal[0], from[1] + length * normal[1]];
                let shares = self.shares(to, beyond, plane)?;
                Some(Column { id: 2 * b as u32 + end, point, shares, normal, length, stiffness })
            })
            .collect();
        let part = 1.0 / columns.len().max(1) as f64;
        columns.iter_mut().for_each(|column| column.stiffness *= part);
        columns
    }

    /// Points on the side of `beyond` that stand for the field at a place, with their shares.
    fn shares(&self, place: Point, beyond: u32, plane: Plane) -> Option<Vec<(u32, f64)>> {
        let net = self.net;
        let spacing = net.spacings[beyond as usize];
        let side = |x: Point| plane.through.map_or(0.0, |at| (x[0] - at[0]) * plane.normal[0] + (x[1] - at[1]) * plane.normal[1]);
        let own = side(net.positions[beyond as usize]);
        let sees = |point: u32| {
            let x = net.positions[point as usize];
            side(x) * own >= 0.0 && !self.pieces.iter().any(|&[a, b]| segments_touch(place, x, a, b))
        };
        let away = |point: u32| {
            let x = net.positions[point as usize];
            [(x[0] - place[0]) / spacing, (x[1] - place[1]) / spacing]
        };
        let there = self.seats.near(place, AT * spacing).find(|&point| {
            let [x, y] = away(point);
            x.hypot(y) < AT && sees(point)
        });
        if let Some(point) = there {
            return Some(vec![(point, 1.0)]);
        }
        let candidates = |reach: f64| self.seats.near(place, reach * spacing).map(move |point| (point, away(point), 1.0));
        linear_shares(plane.normal, [1.0; 2], candidates, sees)
    }

    /// Plane of the crack that a broken bond crosses.
    fn plane(&self, b: usize) -> Option<Plane> {
        let (net, bond) = (self.net, &self.net.bonds[b]);
        if self.is_initial[b] {
            let (from, to) = (net.positions[bond.from as usize], net.positions[bond.to as usize]);
            let [p, q] = self.pieces.iter().find(|[p, q]| segments_touch(from, to, *p, *q))?;
            let [x, y] = perilife_plate::specimen::geometry::direction(*p, *q);
            return Some(Plane { normal: [-y, x], through: None });
        }
        let (at, reach) = (middle(net, b), AROUND * net.horizons[bond.from as usize]);
        let (mut count, mut sum, mut squares) = (0.0, [0.0; 2], [0.0; 3]);
        for place in self.middles.near(at, reach) {
            let [x, y] = self.middles.away(place, at);
            if x * x + y * y <= reach * reach {
                count += 1.0;
                (sum[0], sum[1]) = (sum[0] + x, sum[1] + y);
                (squares[0], squares[1], squares[2]) = (squares[0] + x * x, squares[1] + x * y, squares[2] + y * y);
            }
        }
        let mean = sum.map(|s| s / count);
        let [xx, xy, yy] = [
            squares[0] / count - mean[0] * mean[0],
            squares[1] / count - mean[0] * mean[1],
            squares[2] / count - mean[1] * mean[1],
        ];
        let (half, apart) = (0.5 * (xx + yy), (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt());
        if half + apart < ELONGATED * (half - apart) || apart == 0.0 {
            return None;
        }
        // Principal axis along the crack; N is across.
        let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
        let normal = [-angle.sin(), angle.cos()];
        let through = [at[0] + mean[0], at[1] + mean[1]];
        let side = |point: u32| {
            let x = net.positions[point as usize];
            (x[0] - through[0]) * normal[0] + (x[1] - through[1]) * normal[1]
        };
        // A bond that ends short of the line does not cross it.
        (side(bond.from) * side(bond.to) < 0.0).then_some(Plane { normal, through: Some(through) })
    }
}

/// What is to be said of a scene whose procedure has no contact, where flanks have passed through each other: looked for in all its
/// pictures.
pub fn warning(scene: &Scene, net: &Net, bonds: &BondState, pictures: &[Snapshot]) -> Option<String> {
    let mut contact = NetContact::new(net, &scene.specimen.cracks);
    let last = pictures.len().saturating_sub(1);
    let overlaps = pictures.iter().enumerate().filter_map(|(i, picture)| {
        // Which bonds had broken is known of the last picture alone.
        contact.overlap(bonds, i == last, |point| picture.displacement[point as usize])
    });
    let (overlap, at) = overlaps.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let spacing = net.grid.spacing;
    if overlap.is_nan() || overlap <= OVERLAP_TOLD * spacing {
        return None;
    }
    let springs = matches!(scene.model.law, SceneLaw::Bonds(_));
    let (what, remedy) = match scene.procedure {
        Procedure::Dynamic { .. } => ("motion in time".to_owned(), "without duration_s solver = \"secant\" supports it"),
        _ if !springs => ("bond_law = \"correspondence\"".to_owned(), "bond laws support it with solver = \"secant\""),
        _ => (format!("solver = \"{}\"", scene.model.solver), "solver = \"secant\" supports it"),
    };
    Some(format!(
        "contact: crack faces overlap near {} by up to {:.3e} mm, {:.2} % of the spacing: {what} has no crack-face contact, so load \
         and stress there are those of a crack that closes without force; {remedy}",
        place_mm(at),
        overlap / MM,
        100.0 * overlap / spacing
    ))
}

/// Displacement of the points of a net, m, of its unknowns.
fn moved<'u>(net: &Net, u: &'u [f64]) -> impl Fn(u32) -> Point + use<'u> {
    let unknowns = net.unknowns;
    move |point| [u[point as usize * unknowns], u[point as usize * unknowns + 1]]
}

/// Middle of a bond, m.
fn middle(net: &Net, b: usize) -> Point {
    let bond = &net.bonds[b];
    let (a, b) = (net.positions[bond.from as usize], net.positions[bond.to as usize]);
    [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
}
