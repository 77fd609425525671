//! Points and bonds of any arrangement: what a discretised plate is where a lattice of one spacing will not do, fixed once built.
//!
//! A bond has an owner and a partner and acts on both with opposite forces, so that momentum is exact whatever the
//! horizons. On a lattice every pair of points is one bond; with a dual horizon a pair of unequal horizons has up to two, each
//! with half of the micromodulus at its owner's horizon (Ren, Zhuang, Cai and Rabczuk 2016, IJNME 108:1451). Two halves between
//! equal horizons would always do the same, and are one bond.

pub mod rigid;

use rayon::prelude::*;

use crate::body::Body;
use perilife_base::raster::PointGrid;
use perilife_plate::specimen::Point;

/// Points that one task gathers forces of.
const TASK: usize = 4096;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NetBond {
    pub from: u32,
    pub to: u32,
    /// Length |ξ|, m.
    pub length: f64,
    /// Unit vector from owner to partner, plate axes.
    pub normal: Point,
    /// Normal spring, N/m.
    pub k_n: f64,
    /// Tangential spring, N/m.
    pub k_t: f64,
    /// Lever of the rotation unknowns on the shear, half length over [`Net::rotation_length`].
    pub lever: f64,
}

impl NetBond {
    /// Unit vector across the bond (normal turned by +90°).
    #[inline]
    pub fn tangent(&self) -> Point {
        [-self.normal[1], self.normal[0]]
    }

    /// Relative displacement of its ends along and across it, `η·n` and `η·t - r (θ + θ')`, m, with N unknowns a point.
    #[inline(always)]
    pub fn deformation<const N: usize>(&self, u: &[f64]) -> [f64; 2] {
        let (a, b) = (self.from as usize * N, self.to as usize * N);
        let (eta, n) = ([u[b] - u[a], u[b + 1] - u[a + 1]], self.normal);
        let across = eta[1] * n[0] - eta[0] * n[1];
        let turning = if N == 3 { self.lever * (u[a + 2] + u[b + 2]) } else { 0.0 };
        [eta[0] * n[0] + eta[1] * n[1], across - turning]
    }

    /// Force on the owner of a bond that pulls so hard along `n` and across it, and the couple on both ends with three unknowns, N.
    #[inline(always)]
    pub fn force<const N: usize>(&self, n: Point, normal: f64, tangential: f64) -> [f64; 3] {
        let couple = if N == 3 { tangential * self.lever } else { 0.0 };
        [normal * n[0] - tangential * n[1], normal * n[1] + tangential * n[0], couple]
    }
}

/// Points and bonds.
#[derive(Debug, Clone)]
pub struct Net {
    /// Positions, m, plate axes.
    pub positions: Vec<Point>,
    pub volumes: Vec<f64>,
    /// Spacing of every point's own level, m.
    pub spacings: Vec<f64>,
    /// Horizon of every point, m.
    pub horizons: Vec<f64>,
    /// Bonds, by owner: first those of both horizons, then those of one ([`Net::mutual`]).
    pub bonds: Vec<NetBond>,
    /// Bonds of the points, owned or not, for point i those from `starts[i]` to `starts[i + 1]`: bond times two, plus one where the
    /// point is the partner.
    pub entries: Vec<u32>,
    /// See [`Net::entries`].
    pub starts: Vec<u32>,
    /// So many bonds, the first, lie in the horizons of both ends and stand for both directions of a pair; the bonds behind them
    /// lie in the owner's alone. On a lattice all are of the first sort.
    pub mutual: usize,
    /// Bonds that cracks cut.
    pub pre_cut: Vec<u32>,
    /// Unknowns of a point: two displacements, and where rotation is free θ = φ times [`Net::rotation_length`], m.
    pub unknowns: usize,
    /// Length by which rotations are scaled, m.
    pub rotation_length: f64,
    /// Forces of the tractions at full load, plate axes, N.
    pub forces: Vec<(u32, Point)>,
    /// Lattice of the pictures: the finest level where there are several.
    pub grid: PointGrid,
    /// What the user should know.
    pub warnings: Vec<String>,
}

impl Net {
    /// The net of a lattice body, with the springs, corrections and loads it has.
    pub fn of_body(body: &Body) -> Net {
        let lattice = &body.lattice;
        let places = body.places();
        let mut number = vec![u32::MAX; places];
        for (i, &place) in body.points.iter().enumerate() {
            number[place as usize] = i as u32;
        }
        let volume = lattice.spacing * lattice.spacing * body.thickness;
        let (mut bonds, mut pre_cut) = (Vec::with_capacity(body.bond_count), Vec::new());
        let cut: std::collections::HashSet<u32> = body.pre_cut.iter().copied().collect();
        for (i, &place) in body.points.iter().enumerate() {
            let place = place as usize;
            for (k, (bond, &step)) in body.stencil.bonds.iter().zip(&body.steps).enumerate() {
                let named = k * places + place;
                let multiplier = f64::from(body.multiplier[named]);
                if multiplier > 0.0 {
                    if cut.contains(&(named as u32)) {
                        pre_cut.push(bonds.len() as u32);
                    }
                    bonds.push(NetBond {
                        from: i as u32,
                        to: number[place.wrapping_add_signed(step)],
                        length: bond.length,
                        normal: lattice.from_axes(bond.normal),
                        k_n: multiplier * bond.k_n,
                        k_t: multiplier * bond.k_t,
                        lever: bond.lever,
                    });
                }
            }
        }
        let count = body.points.len();
        let forces = body.boundary.forces.iter();
        Net {
            positions: body.points.iter().map(|&p| lattice.position(p as usize)).collect(),
            volumes: vec![volume; count],
            spacings: vec![lattice.spacing; count],
            horizons: vec![body.horizon(); count],
            mutual: bonds.len(),
            pre_cut,
            unknowns: body.stencil.unknowns,
            rotation_length: lattice.spacing,
            forces: forces.map(|&(p, f)| (number[p as usize], lattice.from_axes(f))).collect(),
            grid: body.grid(),
            entries: Vec::new(),
            starts: Vec::new(),
            warnings: Vec::new(),
            bonds,
        }
        .linked()
    }

    /// Fills in [`Net::entries`] from the bonds.
    pub fn linked(mut self) -> Net {
        let count = self.positions.len();
        let ends = |bond: &NetBond| [(0, bond.from), (1, bond.to)];
        let mut starts = vec![0_u32; count + 1];
        for (_, end) in self.bonds.iter().flat_map(ends) {
            starts[end as usize + 1] += 1;
        }
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut entries = vec![0_u32; starts[count] as usize];
        for (b, bond) in self.bonds.iter().enumerate() {
            for (side, end) in ends(bond) {
                entries[next[end as usize] as usize] = 2 * b as u32 + side;
                next[end as usize] += 1;
            }
        }
        (self.entries, self.starts) = (entries, starts);
        self
    }

    /// Number of points.
    #[inline]
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are no points.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Bonds of a point with their other end: (bond, other point, whether this point owns it).
    #[inline]
    pub fn bonds_of(&self, point: usize) -> impl Iterator<Item = (usize, usize, bool)> + '_ {
        self.entries[self.starts[point] as usize..self.starts[point + 1] as usize].iter().map(|&entry| {
            let (b, owned) = ((entry / 2) as usize, entry % 2 == 0);
            let bond = &self.bonds[b];
            (b, if owned { bond.to } else { bond.from } as usize, owned)
        })
    }

    /// Points that are nearer to something than `depth`, m, and at the least the nearest row of every level.
    pub fn within(&self, depth: f64, away: impl Fn(&Point) -> f64) -> impl Iterator<Item = usize> {
        let away: Vec<f64> = self.positions.iter().map(away).collect();
        let nearest = away.iter().copied().fold(f64::INFINITY, f64::min);
        // A row lies half a spacing inside; a quarter more is safe against round-off.
        let limit = move |own: f64| depth.max(0.75 * own).max(nearest + 0.25 * own);
        let is_within: Vec<bool> = away.iter().zip(&self.spacings).map(|(away, &own)| *away < limit(own)).collect();
        (0..is_within.len()).filter(move |&point| is_within[point])
    }

    /// Bonds in a point's own horizon with their other end.
    #[inline]
    pub fn family_of(&self, point: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.bonds_of(point).filter(|&(b, _, owned)| owned || b < self.mutual).map(|(b, other, _)| (b, other))
    }

    /// Forces on the points, N unknowns each, from what every bond does to its owner ([`NetBond::force`]): point by point, in
    /// parallel and always in the same order.
    pub fn gather<const N: usize>(&self, pulls: &[[f64; 3]], force: &mut [f64]) {
        force.par_chunks_mut(TASK * N).enumerate().for_each(|(task, force)| {
            for (i, force) in force.chunks_exact_mut(N).enumerate() {
                let point = task * TASK + i;
                let mut sum = [0.0; 3];
                for &entry in &self.entries[self.starts[point] as usize..self.starts[point + 1] as usize] {
                    let pull = &pulls[(entry / 2) as usize];
                    let sign = if entry % 2 == 0 { 1.0 } else { -1.0 };
                    sum = [sum[0] + sign * pull[0], sum[1] + sign * pull[1], sum[2] + pull[2]];
                }
                force.copy_from_slice(&sum[..N]);
            }
        });
    }

    /// Damage φ = 1 - Σ μ V' / Σ V' of every point over its bonds (Silling and Askari 2005), 0 to 1, where every bond has a share
    /// of its stiffness. With a dual horizon only the bonds of the point's own horizon count.
    pub fn damage(&self, share: &[f64]) -> Vec<f64> {
        let of_point = |i: usize| {
            let (mut whole, mut intact) = (0.0, 0.0);
            for (b, other) in self.family_of(i) {
                whole += self.volumes[other];
                intact += if share[b] > 0.0 { self.volumes[other] } else { 0.0 };
            }
            if whole > 0.0 { 1.0 - intact / whole } else { 1.0 }
        };
        (0..self.len()).map(of_point).collect()
    }
}
