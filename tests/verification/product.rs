//! The matrix-free product K x against a matrix assembled bond by bond from its definition.

use nalgebra::{DMatrix, DVector};
use perilife_points::body::Body;
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_points::solver::field::{Layout, dot};
use perilife_points::solver::product::{Into, Product};
use perilife_points::solver::{Equilibrium, SolverKind, Symmetry};
use perilife_points::state::Bonds;

use crate::support::noise::Noise;
use crate::support::plates::{PANEL, case};
use crate::support::statics::{Loaded, corrected_laws, loaded};

/// A hole, a slant crack, and a slot from the edge: bonds of all sorts. A lattice of 18 x 24 places, so that several tasks
/// share a product.
const ODD: &str = "kind=\"plate\"\nwidth_mm=36\nlength_mm=48\nthickness_mm=2\nholes=[{x_mm=8,y_mm=10,diameter_mm=9}]\n\
                   cracks=[{from_mm=[-9,-6],to_mm=[3,1]}]\nnotches=[{from_mm=[-18,14],to_mm=[-8,14],width_mm=2}]\n";

fn odd_body(law: &BondLaw, set: &[&str]) -> (Body, Bonds) {
    let nu = match law.kind {
        BondLawKind::BondBased => 1.0 / 3.0,
        BondLawKind::TwoParameter | BondLawKind::OneBondTwoParameter => 0.25,
        BondLawKind::StateBased => 0.4,
    };
    odd_body_of(law, nu, set)
}

fn odd_body_of(law: &BondLaw, nu: f64, set: &[&str]) -> (Body, Bonds) {
    let names = [
        format!("model.bond_law={}", law.kind),
        format!("model.kernel={}", law.kernel),
        format!("model.rotation={}", law.rotation),
        format!("model.surface_correction={}", law.surface_correction),
        format!("material.poisson_ratio={nu}"),
    ];
    let all: Vec<&str> = names.iter().map(String::as_str).chain(set.iter().copied()).collect();
    let body = crate::support::statics::body(&case(ODD, &all));
    let bonds = Bonds::new(&body);
    (body, bonds)
}

/// Vector index of every unknown: the components of each point.
fn unknowns(body: &Body, layout: &Layout) -> Vec<usize> {
    let at = |&point: &u32| (0..layout.unknowns).map(move |c| layout.index(point as usize) + c * layout.stride);
    body.points.iter().flat_map(at).collect()
}

/// K from the energy `½ m [k_n (n·η)² + k_t (t·η - r (θ_i + θ_j))²]` of every bond, and that of the dilatation of every point.
fn assembled(body: &Body, bonds: &Bonds) -> DMatrix<f64> {
    let n = body.stencil.unknowns;
    let mut number = vec![usize::MAX; body.places()];
    body.points.iter().enumerate().for_each(|(i, &point)| number[point as usize] = i * n);
    let mut matrix = DMatrix::zeros(body.points.len() * n, body.points.len() * n);
    for bond in 0..body.multiplier.len() as u32 {
        if !bonds.is_intact(bond) {
            continue;
        }
        let (k, from, to) = body.ends(bond);
        let spring = &body.stencil.bonds[k];
        let share = f64::from(bonds.multiplier[bond as usize]);
        for (stiffness, axis, lever) in [(spring.k_n, spring.normal, 0.0), (spring.k_t, spring.tangent(), spring.lever)] {
            let mut row: Vec<(usize, f64)> = Vec::new();
            for (place, sign) in [(from, -1.0), (to, 1.0)] {
                row.extend((0..2).map(|c| (number[place] + c, sign * axis[c])));
                row.extend((n == 3).then_some((number[place] + 2, -lever)));
            }
            for &(i, a) in &row {
                for &(j, b) in &row {
                    matrix[(i, j)] += share * stiffness * a * b;
                }
            }
        }
    }
    add_dilatation(body, bonds, &number, &mut matrix);
    matrix
}

/// `½ κ V (Q/Q₀) θ²` of every point, `θ = 2 D / Q`, `D = Σ m k_n r n·(u' - u)`, `Q = Σ m k_n r²` over its intact bonds with their
/// multipliers m, Q₀ over all.
fn add_dilatation(body: &Body, bonds: &Bonds, number: &[usize], matrix: &mut DMatrix<f64>) {
    if body.stencil.dilatation == 0.0 {
        return;
    }
    let all = (0..body.multiplier.len() as u32).filter(|&bond| body.multiplier[bond as usize] > 0.0);
    let mut whole = vec![0.0; body.places()];
    let mut left = vec![0.0; body.places()];
    let mut rows: Vec<Vec<(usize, f64)>> = vec![Vec::new(); body.places()];
    for bond in all {
        let (k, from, to) = body.ends(bond);
        let spring = &body.stencil.bonds[k];
        let weight = spring.k_n * spring.length;
        for place in [from, to] {
            let [share, share_left] = [&body.multiplier, &bonds.multiplier].map(|m| f64::from(m[bond as usize]));
            whole[place] += share * weight * spring.length;
            if share_left > 0.0 {
                left[place] += share_left * weight * spring.length;
                for (end, sign) in [(from, -1.0), (to, 1.0)] {
                    rows[place].extend((0..2).map(|c| (number[end] + c, sign * share_left * weight * spring.normal[c])));
                }
            }
        }
    }
    for place in body.points.iter().map(|&place| place as usize).filter(|&place| left[place] > 0.0) {
        let stiffness = 4.0 * body.stencil.dilatation / (whole[place] * left[place]);
        for &(i, a) in &rows[place] {
            for &(j, b) in &rows[place] {
                matrix[(i, j)] += stiffness * a * b;
            }
        }
    }
}

fn applied(body: &Body, bonds: &Bonds, x: &[f64], into: Into, y: &mut [f64]) {
    match body.stencil.unknowns {
        3 => Product::<3>::new(body, vec![]).apply(bonds, &mut x.to_vec(), y, into),
        _ => Product::<2>::new(body, vec![]).apply(bonds, &mut x.to_vec(), y, into),
    }
}

fn random(layout: &Layout, unknowns: &[usize], seed: u64) -> Vec<f64> {
    let mut noise = Noise::new(seed);
    let mut x = layout.zeros();
    unknowns.iter().for_each(|&index| x[index] = noise.normal());
    x
}

#[test]
fn the_product_is_that_of_the_assembled_matrix() {
    // Rotations differ where bonds have tangential springs.
    for law in corrected_laws().filter(|law| law.kind.is_two_parameter() || law.rotation == Rotation::Free) {
        // Several tasks share a product at one horizon; the others need not be as large.
        for (ratio, spacing) in [(1.5, 3.0), (2.015, 3.0), (3.015, 2.0), (4.015, 3.0)] {
            let (body, bonds) =
                odd_body(&law, &[&format!("model.horizon_ratio={ratio}"), &format!("model.spacing_mm={spacing}")]);
            let layout = Layout::of(&body.lattice, body.stencil.unknowns);
            let unknowns = unknowns(&body, &layout);
            let matrix = assembled(&body, &bonds);
            let (x, z) = (random(&layout, &unknowns, 1), random(&layout, &unknowns, 2));
            let (mut kx, mut kz, mut difference) = (layout.zeros(), layout.zeros(), z.clone());
            applied(&body, &bonds, &x, Into::Set, &mut kx);
            applied(&body, &bonds, &z, Into::Set, &mut kz);
            applied(&body, &bonds, &x, Into::Subtract, &mut difference);
            let exact = &matrix * DVector::from_iterator(unknowns.len(), unknowns.iter().map(|&i| x[i]));
            let scale = exact.amax();
            for (row, &index) in unknowns.iter().enumerate() {
                assert!((kx[index] - exact[row]).abs() < 1e-13 * scale, "{law:?}, ratio {ratio}, row {row}");
                assert!((difference[index] - (z[index] - exact[row])).abs() < 1e-13 * scale, "{law:?}, ratio {ratio}, row {row}");
            }
            let (a, b) = (dot(&layout, &z, &kx), dot(&layout, &x, &kz));
            assert!((a - b).abs() < 1e-12 * scale * unknowns.len() as f64, "symmetry: {law:?}, ratio {ratio}");
        }
    }
}

/// Points for eigenvalues, whose time goes with the cube of their number.
const COARSE: &str = "model.spacing_mm=3";

/// A free plate in one piece moves as a rigid body without energy, and in no other way.
#[test]
fn the_stiffness_is_positive_but_for_rigid_motion() {
    for law in corrected_laws().filter(|law| law.surface_correction == SurfaceCorrection::VolumeAndSurface) {
        let (body, bonds) = odd_body(&law, &[COARSE]);
        let mut eigenvalues = assembled(&body, &bonds).symmetric_eigenvalues().as_slice().to_vec();
        eigenvalues.sort_by(f64::total_cmp);
        let top = eigenvalues[eigenvalues.len() - 1];
        let modes = eigenvalues.iter().filter(|&&value| value < 1e-10 * top).count();
        assert!(eigenvalues[0] > -1e-12 * top, "{law:?}: {:e}", eigenvalues[0] / top);
        let resisted = law.kind.is_two_parameter() && law.rotation == Rotation::Resisted;
        assert_eq!(modes, if resisted { 2 } else { 3 }, "{law:?}");
    }
}

/// Below ν = 1/3 the dilatation takes energy away; what the springs store is more, whatever has broken.
#[test]
fn the_state_based_law_is_stable_however_many_bonds_are_broken() {
    for kernel in Kernel::ALL {
        let surface_correction = SurfaceCorrection::VolumeAndSurface;
        let law = BondLaw { kind: BondLawKind::StateBased, kernel: *kernel, rotation: Rotation::Free, surface_correction };
        for share in [0.3, 0.6, 0.9] {
            let (body, mut bonds) = odd_body_of(&law, 0.0, &[COARSE]);
            let mut noise = Noise::new(7);
            // Normal numbers below this make up the share.
            let limit = match share {
                0.3 => -0.524,
                0.6 => 0.253,
                _ => 1.282,
            };
            for bond in 0..body.multiplier.len() as u32 {
                if bonds.is_intact(bond) && noise.normal() < limit {
                    bonds.cut(&body, bond);
                }
            }
            let mut eigenvalues = assembled(&body, &bonds).symmetric_eigenvalues().as_slice().to_vec();
            eigenvalues.sort_by(f64::total_cmp);
            let least = eigenvalues[0] / eigenvalues[eigenvalues.len() - 1];
            assert!(least > -1e-12, "{kernel}, {share}: {least:e}");
        }
    }
}

#[test]
fn threads_do_not_change_a_digit() {
    let threads = |count: usize| rayon::ThreadPoolBuilder::new().num_threads(count).build().unwrap();
    for rotation in Rotation::ALL {
        let case = case(PANEL, &["model.spacing_mm=3", &format!("model.rotation={rotation}")]);
        let [one, two] = [1, 2].map(|count| {
            threads(count).install(|| {
                let Loaded { body, mut bonds, mut displacement, iterations, .. } = loaded(&case, SolverKind::Multigrid).unwrap();
                // And once more with the hierarchy kept while bonds break.
                let mut equilibrium = Equilibrium::new(SolverKind::Multigrid, Symmetry::Off, &body, &bonds, case.loading.maximum);
                equilibrium.solve(&body, &bonds, &mut displacement).unwrap();
                let ahead = perilife_points::body::pre_crack::bonds_across(&body, [0.02, 0.0], [0.023, 0.0]);
                ahead.iter().for_each(|&bond| bonds.cut(&body, bond));
                equilibrium.bonds_changed(&body, &bonds, &ahead);
                let more = equilibrium.solve(&body, &bonds, &mut displacement).unwrap();
                (displacement, iterations, more, equilibrium.work())
            })
        });
        assert!(one == two, "{rotation}");
    }
}
