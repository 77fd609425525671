//! Points and bonds of any arrangement: what the discretised plate of a fracture scene is, fixed once built.
//!
//! A bond has an owner and a partner and acts on both with opposite forces, so that momentum is exact whatever the
//! horizons. On a lattice every pair of points is one bond; with a dual horizon a pair of unequal horizons has up to two, each
//! with half of the micromodulus at its owner's horizon (Ren, Zhuang, Cai and Rabczuk 2016, IJNME 108:1451). Two halves between
//! equal horizons would always do the same, and are one bond.

use crate::body::Body;
use crate::predict::PointGrid;
use crate::specimen::Point;

/// A bond of a net.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NetBond {
    /// Owner.
    pub from: u32,
    /// Partner.
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
    #[must_use]
    pub fn tangent(&self) -> Point {
        [-self.normal[1], self.normal[0]]
    }
}

/// Points and bonds.
#[derive(Debug, Clone)]
pub struct Net {
    /// Positions, m, plate axes.
    pub positions: Vec<Point>,
    /// Volumes, m³.
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
    /// Whether bonds in the owner's horizon alone pull at the owner only: the variable horizon without its dual, whose forces do
    /// not balance and have no energy. Such bonds are no entries of their partner, so that the kernel need not ask.
    pub owner_only: bool,
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
    #[must_use]
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
            owner_only: false,
            pre_cut,
            unknowns: body.stencil.unknowns,
            rotation_length: lattice.spacing,
            forces: forces.map(|&(p, f)| (number[p as usize], lattice.from_axes(f))).collect(),
            grid: crate::predict::grid(body),
            entries: Vec::new(),
            starts: Vec::new(),
            warnings: Vec::new(),
            bonds,
        }
        .linked()
    }

    /// Fills in [`Net::entries`] from the bonds.
    #[must_use]
    pub fn linked(mut self) -> Net {
        let count = self.positions.len();
        let acting = |b: usize, bond: &NetBond| {
            let sides = if self.owner_only && b >= self.mutual { 1 } else { 2 };
            [(0, bond.from), (1, bond.to)].into_iter().take(sides)
        };
        let mut starts = vec![0_u32; count + 1];
        for (b, bond) in self.bonds.iter().enumerate() {
            acting(b, bond).for_each(|(_, end)| starts[end as usize + 1] += 1);
        }
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let mut next = starts.clone();
        let mut entries = vec![0_u32; starts[count] as usize];
        for (b, bond) in self.bonds.iter().enumerate() {
            for (side, end) in acting(b, bond) {
                entries[next[end as usize] as usize] = 2 * b as u32 + side;
                next[end as usize] += 1;
            }
        }
        (self.entries, self.starts) = (entries, starts);
        self
    }

    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there are no points.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// Bonds of a point with their other end: (bond, other point, whether this point owns it).
    pub fn bonds_of(&self, point: usize) -> impl Iterator<Item = (usize, usize, bool)> + '_ {
        self.entries[self.starts[point] as usize..self.starts[point + 1] as usize].iter().map(|&entry| {
            let (b, owned) = ((entry / 2) as usize, entry % 2 == 0);
            let bond = &self.bonds[b];
            (b, if owned { bond.to } else { bond.from } as usize, owned)
        })
    }

    /// Bonds in a point's own horizon with their other end.
    pub fn family_of(&self, point: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.bonds_of(point).filter(|&(b, _, owned)| owned || b < self.mutual).map(|(b, other, _)| (b, other))
    }
}
