//! Couples that belong to a traction where the balanced correction leaves the rotation of points out of balance.
//!
//! In uniform stress σ the bonds of a corner point turn it by a couple `M : σ` = `a (σ_xx - σ_yy) + 2 b σ_xy`, with lever l,
//! `a = Σ m k_t l r n_x n_y / 2G` and `b = -½ Σ m k_t l r (n_x² - n_y²) / 2G`. In equilibrium the load brings the opposite
//! couple: the consistent couple of a distributed load, as beams have it. A load on part of the rim knows only
//! its own traction `t = σ n`, so the couple is written as `Σ w (B n)·t` over the rim near the point, with the smallest B
//! for which that is M : σ in every uniform stress.

use super::Body;
use crate::bond_law::stencil::plane_stiffness;
use perilife_plate::loading::pieces::LoadPiece;
use perilife_plate::material::Material;
use perilife_plate::specimen::Point;
use perilife_plate::specimen::facets::Facet;
use perilife_plate::specimen::geometry::Places;

/// Ratio of the principal values of `Σ w n nᵀ` below which the rim near a point counts as straight.
const STRAIGHT: f64 = 1e-6;
/// Couple over that of one bond direction alone below which a point counts as balanced.
const BALANCED: f64 = 1e-9;

/// Couples on points at unit nominal load, N (conjugate to rotation times spacing), by place.
pub(super) fn couples(body: &Body, material: &Material, rim: &[Facet], loads: &[LoadPiece]) -> Vec<(u32, f64)> {
    // Points out of balance lie up to two reaches behind the rim; both sides of a corner must be seen from there.
    let radius = 2.0 * body.stencil.reach as f64 + 2.0;
    let rim_seats = Places::of(radius, rim.iter().map(|facet| body.lattice.locate(facet.at)));
    let load_seats = Places::of(radius, loads.iter().map(|load| body.lattice.locate(load.facet.at)));
    let [c11, c12] = plane_stiffness(material);
    let least = BALANCED * body.stencil.bonds.iter().map(|bond| bond.k_t * bond.lever * bond.length).sum::<f64>();
    let couple = |&place: &u32| -> Option<(u32, f64)> {
        let (column, row) = body.lattice.column_row(place as usize);
        let at = [column as f64, row as f64];
        near(&load_seats, at, radius).next()?;
        let turning = turning(body, place as usize);
        if turning.iter().all(|t| t.abs() <= least) {
            return None;
        }
        let mut spread = [0.0; 3];
        for (i, weight) in near(&rim_seats, at, radius) {
            let [x, y] = body.lattice.to_axes(rim[i].normal);
            let area = weight * rim[i].length * body.thickness;
            spread = [spread[0] + area * x * x, spread[1] + area * x * y, spread[2] + area * y * y];
        }
        let b = smallest(turning.map(|t| t / (c11 - c12)), spread)?;
        let share = |(i, weight): (usize, f64)| {
            let ([x, y], t) = (body.lattice.to_axes(loads[i].facet.normal), body.lattice.to_axes(loads[i].force));
            weight * ((b[0][0] * x + b[0][1] * y) * t[0] + (b[1][0] * x + b[1][1] * y) * t[1])
        };
        Some((place, near(&load_seats, at, radius).map(share).sum()))
    };
    body.points.iter().filter_map(couple).filter(|couple| couple.1 != 0.0).collect()
}

/// a and b of a point times 2G, N·m/m: couple that keeps its rotation zero under unit deviatoric strains.
fn turning(body: &Body, place: usize) -> [f64; 2] {
    body.around(place).fold([0.0; 2], |sum, (k, _, named, _)| {
        let bond = &body.stencil.bonds[k];
        let ([x, y], multiplier) = (bond.normal, f64::from(body.multiplier[named]));
        let turn = multiplier * bond.k_t * bond.lever * bond.length;
        [sum[0] + turn * x * y, sum[1] - 0.5 * turn * (x * x - y * y)]
    })
}

/// The smallest B with `½ (B S + S Bᵀ) = [[a, b], [b, -a]]` for the symmetric S = [s_xx, s_xy, s_yy]; where S is of rank one
/// (straight rim) the part that no traction on it can see is left out.
fn smallest([a, b]: [f64; 2], [xx, xy, yy]: [f64; 3]) -> Option<[[f64; 2]; 2]> {
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    let (sin, cos) = angle.sin_cos();
    let (mean, half) = (0.5 * (xx + yy), (0.5 * (xx - yy)).hypot(xy));
    let (large, small) = (mean + half, (mean - half).max(0.0));
    if large <= 0.0 {
        return None;
    }
    // In the principal axes of S: M₁₁ = B₁₁ s₁, M₂₂ = B₂₂ s₂, M₁₂ = (B₁₂ s₂ + B₂₁ s₁)/2.
    let (c2, s2) = (cos * cos - sin * sin, 2.0 * sin * cos);
    let (m11, m12) = (a * c2 + b * s2, b * c2 - a * s2);
    let square = large * large + small * small;
    let p = [
        [m11 / large, 2.0 * m12 * small / square],
        [2.0 * m12 * large / square, if small > STRAIGHT * large { -m11 / small } else { 0.0 }],
    ];
    // Back to the axes of the lattice: R P Rᵀ with the principal vectors as columns of R.
    let r = [[cos, -sin], [sin, cos]];
    let entry = |i: usize, j: usize| (0..2).map(|k| (0..2).map(|l| r[i][k] * p[k][l] * r[j][l]).sum::<f64>()).sum::<f64>();
    Some([[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]])
}

/// Places, in spacings, within a radius with a weight that falls smoothly to 0 there.
fn near(places: &Places, at: Point, radius: f64) -> impl Iterator<Item = (usize, f64)> + '_ {
    places.near(at, radius).filter_map(move |i| {
        let [x, y] = places.away(i, at);
        let away = x.hypot(y) / radius;
        (away < 1.0).then(|| (i as usize, (1.0 - away * away).powi(2)))
    })
}
