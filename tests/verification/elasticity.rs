//! Uniform strain stores the energy of the continuum, rigid motion none: for every bond law, kernel, rotation, plane state
//! and horizon.

use perilife_plate::material::{Material, Plane};
use perilife_plate::specimen::Specimen;
use perilife_points::body::Body;
use perilife_points::bond_law::stencil::{Stencil, plane_stiffness, poisson_limit};
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_points::solver::field::{Layout, dot};
use perilife_points::solver::product::{Into, Product};
use perilife_points::state::Bonds;

use crate::support::plates::{case, try_case};
use crate::support::statics::{corrected_laws, laws, material};

const RATIOS: [f64; 6] = [1.5, 2.015, 3.015, 4.015, 5.015, 6.015];
const SPACING: f64 = 1e-3;
const THICKNESS: f64 = 1e-3;

/// Strains (xx, yy, xy): two uniaxial ones and shear, and each turned.
fn strains() -> Vec<[f64; 3]> {
    let turned = |[xx, yy, xy]: [f64; 3], degrees: f64| {
        let (s, c) = degrees.to_radians().sin_cos();
        [
            c * c * xx + s * s * yy - 2.0 * s * c * xy,
            s * s * xx + c * c * yy + 2.0 * s * c * xy,
            s * c * (xx - yy) + (c * c - s * s) * xy,
        ]
    };
    let plain = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    plain.into_iter().flat_map(|strain| [0.0, 15.0, 30.0, 45.0].map(|degrees| turned(strain, degrees))).collect()
}

/// W = ½ e:C:e, J/m³.
fn exact_energy(material: &Material, [xx, yy, xy]: [f64; 3]) -> f64 {
    let [c11, c12] = plane_stiffness(material);
    0.5 * (c11 * (xx * xx + yy * yy) + 2.0 * c12 * xx * yy + 4.0 * 0.5 * (c11 - c12) * xy * xy)
}

/// Energy per volume of an interior point under a displacement gradient, its own rotation at `turn`.
fn stored_energy(stencil: &Stencil, thickness: f64, gradient: [[f64; 2]; 2], turn: f64) -> f64 {
    let bonds = stencil.bonds.iter().map(|bond| {
        let xi = [bond.normal[0] * bond.length, bond.normal[1] * bond.length];
        let eta = gradient.map(|row| row[0] * xi[0] + row[1] * xi[1]);
        let along = |n: [f64; 2]| n[0] * eta[0] + n[1] * eta[1];
        let shear = along(bond.tangent()) - bond.length * turn;
        0.5 * bond.k_n * along(bond.normal).powi(2) + 0.5 * bond.k_t * shear * shear
    });
    // Of its bonds a point owns one half; of the other half it stores half the energy and gives half of its own.
    let dilatation = gradient[0][0] + gradient[1][1];
    (bonds.sum::<f64>() + 0.5 * stencil.dilatation * dilatation * dilatation) / (stencil.spacing * stencil.spacing * thickness)
}

/// A square of `count` x `count` points without cracks.
fn square(count: usize) -> Specimen {
    let side = count as f64 * SPACING;
    let half = 0.5 * side;
    let mut plate =
        case("kind=\"plate\"\nwidth_mm=100\nlength_mm=100\nthickness_mm=1\ncracks=[{from_mm=[-5,0],to_mm=[5,0]}]\n", &[])
            .specimen;
    plate.outline = vec![[-half, -half], [half, -half], [half, half], [-half, half]];
    (plate.width, plate.gross_width, plate.crack_plane_y) = (side, side, None);
    plate.cracks.clear();
    plate.tips.clear();
    plate.loads.clear();
    plate
}

fn body(law: &BondLaw, material: &Material, ratio: f64) -> Body {
    let count = 4 * ratio.floor() as usize + 9;
    Body::build(&square(count), material, law, SPACING, ratio, 0.0).unwrap()
}

/// Bonds of a point far inside: the classical correction changes them too, the balanced one those at the rim only.
fn stencil_inside(law: &BondLaw, material: &Material, ratio: f64) -> Stencil {
    match law.surface_correction {
        SurfaceCorrection::VolumeAndSurface => body(law, material, ratio).stencil,
        SurfaceCorrection::None | SurfaceCorrection::Balanced => Stencil::new(law, material, SPACING, ratio, THICKNESS).unwrap(),
    }
}

/// Places all of whose bonds are those of the infinite lattice.
fn interior(body: &Body) -> Vec<usize> {
    let places = body.places();
    let whole = |&place: &usize| {
        body.steps.iter().enumerate().all(|(k, &step)| {
            body.multiplier[k * places + place] == 1.0 && body.multiplier[k * places + place.wrapping_add_signed(-step)] == 1.0
        })
    };
    body.points.iter().map(|&point| point as usize).filter(whole).collect()
}

/// Places where uniform strain leaves no force: those of the interior, and for a state-based law those whose neighbours all are,
/// since the dilatation of a point at the rim pulls more.
fn settled(body: &Body, law: &BondLaw) -> Vec<usize> {
    let interior = interior(body);
    let is_inside = |place: usize| interior.binary_search(&place).is_ok();
    let among = |&place: &usize| {
        let ends = |&step: &isize| is_inside(place.wrapping_add_signed(step)) && is_inside(place.wrapping_add_signed(-step));
        law.kind != BondLawKind::StateBased || body.steps.iter().all(ends)
    };
    interior.iter().copied().filter(among).collect()
}

/// K x of a field given in plate coordinates as (u, v, rotation angle), and the field itself.
fn forces(body: &Body, field: impl Fn([f64; 2]) -> [f64; 3]) -> (Layout, Vec<f64>, Vec<f64>) {
    let layout = Layout::of(&body.lattice, body.stencil.unknowns);
    let (mut x, mut y) = (layout.zeros(), layout.zeros());
    for &point in &body.points {
        let [u, v, turn] = field(body.lattice.position(point as usize));
        let values = [u, v, turn * body.lattice.spacing];
        let at = layout.index(point as usize);
        (0..layout.unknowns).for_each(|c| x[at + c * layout.stride] = values[c]);
    }
    let bonds = Bonds::new(body);
    match body.stencil.unknowns {
        3 => Product::<3>::new(body, vec![]).apply(&bonds, &mut x.clone(), &mut y, Into::Set),
        _ => Product::<2>::new(body, vec![]).apply(&bonds, &mut x.clone(), &mut y, Into::Set),
    }
    (layout, x, y)
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::max)
}

/// Moduli that are matched to the lattice (`none`) are exact for every strain. The classical ones are matched to uniaxial
/// strain along the rows; what is left in shear and turned strain is the error of summing the integral on a few points.
#[test]
fn uniform_strain_stores_the_energy_of_the_continuum() {
    let mut classical = [[0.0_f64; 6]; 5];
    for plane in Plane::ALL {
        for law in corrected_laws() {
            let material = material(law.kind, *plane);
            for (i, ratio) in RATIOS.into_iter().enumerate() {
                let stencil = stencil_inside(&law, &material, ratio);
                for strain in strains() {
                    let [xx, yy, xy] = strain;
                    let stored = stored_energy(&stencil, THICKNESS, [[xx, xy], [xy, yy]], 0.0);
                    let error = (stored / exact_energy(&material, strain) - 1.0).abs();
                    let along_rows = xy == 0.0 && xx * yy == 0.0;
                    if law.surface_correction != SurfaceCorrection::VolumeAndSurface || along_rows {
                        assert!(error < 1e-12, "{law:?}, {plane}, ratio {ratio}, strain {strain:?}: {error:e}");
                    } else {
                        let row = match (law.kind, law.kernel) {
                            (BondLawKind::TwoParameter, Kernel::Conical) => 0,
                            (BondLawKind::TwoParameter, Kernel::Constant) => 1,
                            (BondLawKind::StateBased, Kernel::Conical) => 3,
                            (BondLawKind::StateBased, Kernel::Constant) => 4,
                            (BondLawKind::BondBased | BondLawKind::OneBondTwoParameter, _) => 2,
                        };
                        classical[row][i] = classical[row][i].max(error);
                    }
                }
            }
        }
    }
    println!("classical moduli, largest energy error in shear and turned strain, by horizon ratio {RATIOS:?}: {classical:.4?}");
    // Measured here, rounded up: conical and constant two-parameter law, bond-based, conical and constant state-based. Horizon ratio 1.5 has eight bonds.
    let bounds = [
        [0.49, 0.060, 0.013, 0.015, 0.003, 0.004],
        [0.07, 0.170, 0.021, 0.016, 0.056, 0.034],
        [0.81, 0.230, 0.061, 0.020, 0.061, 0.037],
        [0.73, 0.095, 0.020, 0.024, 0.004, 0.007],
        [0.11, 0.262, 0.033, 0.026, 0.088, 0.054],
    ];
    for (errors, bounds) in classical.iter().zip(bounds) {
        for ((error, bound), ratio) in errors.iter().zip(bounds).zip(RATIOS) {
            assert!(*error < bound, "horizon ratio {ratio}: {error} against {bound}");
        }
    }
}

/// For every law by these horizon ratios and planes.
fn strained_and_moved(choices: &[(f64, Plane)]) {
    for (ratio, plane) in choices.iter().copied() {
        for law in corrected_laws() {
            let material = material(law.kind, plane);
            let body = body(&law, &material, ratio);
            let inside = settled(&body, &law);
            // A stretch of 1 in the stiffest bond: what forces are compared with.
            let scale = largest(body.stencil.bonds.iter().map(|bond| bond.k_n * bond.length));
            let at = |layout: &Layout, y: &[f64], place: usize| {
                largest((0..layout.unknowns).map(|c| y[layout.index(place) + c * layout.stride]))
            };
            let context = |what: &str| format!("{what}: {law:?}, {plane}, ratio {ratio}");
            for [xx, yy, xy] in strains() {
                let (layout, _, y) = forces(&body, |[x, z]| [xx * x + xy * z, xy * x + yy * z, 0.0]);
                let force = largest(inside.iter().map(|&place| at(&layout, &y, place)));
                assert!(force < 1e-11 * scale, "{} {:e}", context("strain"), force / scale);
            }
            let (layout, _, y) = forces(&body, |_| [SPACING, -0.5 * SPACING, 0.0]);
            let force = largest(body.points.iter().map(|&place| at(&layout, &y, place as usize)));
            assert!(force < 1e-12 * scale, "{} {:e}", context("translation"), force / scale);

            let (layout, x, y) = forces(&body, |[x, z]| [-z, x, 1.0]);
            let energy = 0.5 * dot(&layout, &x, &y);
            let free = !law.kind.is_two_parameter() || law.rotation == Rotation::Free;
            let whole = scale * SPACING * body.points.len() as f64;
            assert_eq!(free, energy.abs() < 1e-12 * whole, "{} {:e}", context("rotation"), energy / whole);
        }
    }
}

#[test]
fn uniform_strain_is_in_equilibrium_inside_and_rigid_motion_everywhere() {
    strained_and_moved(&[(1.5, Plane::Stress), (2.015, Plane::Strain), (3.015, Plane::Stress), (4.015, Plane::Strain)]);
}

#[test]
#[ignore = "long: half a minute; cargo test elasticity -- --ignored"]
fn uniform_strain_is_in_equilibrium_at_every_horizon() {
    strained_and_moved(
        &RATIOS.map(|ratio| Plane::ALL.iter().map(move |plane| (ratio, *plane))).into_iter().flatten().collect::<Vec<_>>(),
    );
}

/// W = π c_t δ⁴ ω²/40 (conical) and π c_t δ⁴ ω²/8 (constant kernel) are both (C₁₁ - 3 C₁₂) ω² with the published c_t
/// (integrated by hand from the energy of a bond; theory of Prakash and Seidel 2015).
#[test]
fn the_resisted_law_stores_energy_in_a_rigid_rotation() {
    let turn = [[0.0, -1.0], [1.0, 0.0]];
    let mut classical = Vec::new();
    for plane in Plane::ALL {
        for law in corrected_laws().filter(|law| law.kind.is_two_parameter() && law.rotation == Rotation::Resisted) {
            let material = material(law.kind, *plane);
            let [c11, c12] = plane_stiffness(&material);
            for ratio in RATIOS {
                let stencil = stencil_inside(&law, &material, ratio);
                let stored = stored_energy(&stencil, THICKNESS, turn, 0.0) / (c11 - 3.0 * c12);
                if law.surface_correction != SurfaceCorrection::VolumeAndSurface {
                    assert!((stored - 1.0).abs() < 1e-11, "{law:?}, {plane}, ratio {ratio}: {stored}");
                } else if law.kind == BondLawKind::TwoParameter {
                    classical.push((law.kernel, ratio, stored));
                }
                // The point turning with the plate costs nothing.
                assert!(stored_energy(&stencil, THICKNESS, turn, 1.0).abs() < 1e-12 * c11);
            }
        }
    }
    println!("classical moduli, W / ((C11 - 3 C12) ω²): {classical:.4?}");
    for (kernel, ratio, stored) in classical {
        // The sum over few bonds stands for the integral: 2 % with eight and twelve neighbours and for the constant kernel,
        // whose bonds at the rim weigh most; 0.5 % for the conical one from 28 neighbours on. Eight conical bonds: 13 %.
        let bound = match (kernel, ratio) {
            (Kernel::Conical, 1.5) => 0.14,
            (Kernel::Conical, 3.0..) => 0.005,
            (_, 2.0..3.0) => 0.05,
            _ => 0.02,
        };
        assert!((stored - 1.0).abs() < bound, "{kernel}, ratio {ratio}: {stored}");
    }
}

/// E = 200 GPa, ν = 0.3, δ = 0.03015 m, h = 1 m, plane stress, conical kernel: `c_n(0) = 40 E / (π δ⁴ (1-ν))`,
/// `c_t(0) = 40 E (1-3ν) / (π δ⁴ (1-ν²))`, worked out by hand.
#[test]
fn the_published_moduli_come_out() {
    let material = Material { poisson_ratio: 0.3, ..material(BondLawKind::TwoParameter, Plane::Stress) };
    let law = BondLaw {
        kind: BondLawKind::TwoParameter,
        kernel: Kernel::Conical,
        rotation: Rotation::Free,
        surface_correction: SurfaceCorrection::VolumeAndSurface,
    };
    let stencil = Stencil::new(&law, &material, 0.01, 3.015, 1.0).unwrap();
    let nearest = stencil.bonds.iter().find(|bond| (bond.dx, bond.dy) == (1, 0)).unwrap();
    let shape = (1.0 - nearest.length / stencil.horizon) * 0.01_f64.powi(4);
    for (computed, reference) in [(nearest.k_n / shape, 4.4024e18), (nearest.k_t / shape, 3.3865e17)] {
        assert!((computed / reference - 1.0).abs() < 2e-5, "{computed:e} against {reference:e}");
    }
}

#[test]
fn poissons_ratio_beyond_the_law_is_refused_by_name() {
    for plane in Plane::ALL {
        for (kind, kernel, rotation) in laws().filter(|law| law.0 != BondLawKind::StateBased) {
            let limit = poisson_limit(*plane);
            let mut nus = vec![limit + 0.02];
            nus.extend((kind == BondLawKind::BondBased).then_some(limit - 0.02));
            for nu in nus {
                let law = BondLaw { kind, kernel, rotation, surface_correction: SurfaceCorrection::None };
                let material = Material { poisson_ratio: nu, ..material(kind, *plane) };
                let by_stencil = Stencil::new(&law, &material, SPACING, 3.015, 1e-3).unwrap_err();
                let set =
                    [format!("model.bond_law={kind}"), format!("material.poisson_ratio={nu}"), format!("material.plane={plane}")];
                let by_case = try_case(crate::support::plates::PANEL, &set.each_ref().map(String::as_str)).unwrap_err();
                for error in [by_stencil, by_case] {
                    assert_eq!(error.exit_code(), 2);
                    let text = error.to_string();
                    assert!(text.contains("material.poisson_ratio") && text.contains(kind.name()), "{text}");
                    // The law that helps is named.
                    assert!(text.contains(if nu > limit { "state_based" } else { "two_parameter" }), "{text}");
                }
            }
        }
    }
}
