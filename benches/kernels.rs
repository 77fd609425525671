//! Kernels of the equilibrium solver on one thread: `cargo bench --profile dev --bench kernels`.
//!
//! Items are directed bonds: both directions of every bond of an interior point, 28 at a horizon of 3.015 spacings, so that
//! the rates of all kernels compare. `_cracked` runs on a plate whose every chunk has a broken bond.

use std::sync::OnceLock;

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use perilife_growth::case::Case;
use perilife_points::body::Body;
use perilife_points::net::Net;
use perilife_points::solver::field::{Layout, dot};
use perilife_points::solver::multigrid::Multigrid;
use perilife_points::solver::multigrid::fine::Fine;
use perilife_points::solver::product::{Into, Product};
use perilife_points::state::Bonds;
use perilife_scenes::bonds::BondState;
use perilife_scenes::failure::Failure;
use perilife_scenes::interaction::{Damaging, Interaction};
use perilife_scenes::lattice_springs::LatticeSprings;
use perilife_scenes::springs::Springs;

/// Points of the plate, about.
const POINTS: f64 = 300_000.0;
const SAMPLES: u32 = 9;

fn main() {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("the pool is built once, before its first use");
    divan::main();
}

/// A plate, its product and vectors, with N unknowns a point.
struct Scene<const N: usize> {
    body: Body,
    bonds: Bonds,
    cracked: Bonds,
    product: Product<N>,
    x: Vec<f64>,
    y: Vec<f64>,
}

impl<const N: usize> Scene<N> {
    fn new() -> Self {
        let body = body(if N == 3 { "two_parameter" } else { "bond_based" });
        let bonds = Bonds::new(&body);
        let mut cracked = bonds.clone();
        // One bond of every eighth point broken: no chunk is left regular, and the plate is still one.
        for &place in body.points.iter().filter(|&&place| body.lattice.column_row(place as usize).0 % 8 == 3) {
            if cracked.is_intact(place) {
                cracked.cut(&body, place);
            }
        }
        let product = Product::new(&body, Vec::new());
        let layout = Layout::of(&body.lattice, N);
        let mut x = layout.zeros();
        for (i, &place) in body.points.iter().enumerate() {
            for c in 0..N {
                x[layout.index(place as usize) + c * layout.stride] = ((i * (c + 3)) % 1013) as f64 - 506.0;
            }
        }
        let y = x.clone();
        Scene { body, bonds, cracked, product, x, y }
    }

    fn fine(&self) -> Fine<'_, N> {
        Fine { body: &self.body, bonds: &self.bonds, product: &self.product }
    }

    fn directed_bonds(&self) -> ItemsCount {
        ItemsCount::new(2 * self.body.stencil.bonds.len() * self.body.points.len())
    }
}

fn body(law: &str) -> Body {
    let width = (POINTS / 2.0).sqrt().round();
    let nu = if law == "bond_based" { 1.0 / 3.0 } else { 0.3 };
    let (law, rotation) = law.strip_suffix("_resisted").map_or((law, "free"), |law| (law, "resisted"));
    let text = format!(
        "[specimen]\nkind=\"middle_tension\"\nwidth_mm={width}\nlength_mm={}\nthickness_mm=2\ncrack_length_mm={}\n\
         [material]\nyoungs_modulus_gpa=72\npoisson_ratio={nu}\nplane=\"stress\"\n[loading]\nstress_max_mpa=70\nstress_ratio=0.1\n\
         [model]\nbond_law=\"{law}\"\nrotation=\"{rotation}\"\nspacing_mm=1\n[fatigue]\na=1e4\np=3\nhorizon_mm=3.015\n",
        2.0 * width,
        width / 5.0
    );
    let case = Case::from_toml(&text, "bench", std::path::Path::new("."), &[]).expect("a case as its documentation says");
    case.points().body(&case.specimen, &case.material).expect("a plain plate")
}

fn two() -> &'static Scene<2> {
    static SCENE: OnceLock<Scene<2>> = OnceLock::new();
    SCENE.get_or_init(Scene::new)
}

fn three() -> &'static Scene<3> {
    static SCENE: OnceLock<Scene<3>> = OnceLock::new();
    SCENE.get_or_init(Scene::new)
}

fn product<const N: usize>(bencher: Bencher, scene: &Scene<N>, bonds: &Bonds) {
    let (mut x, mut y) = (scene.x.clone(), scene.y.clone());
    bencher.counter(scene.directed_bonds()).bench_local(|| {
        scene.product.apply(black_box(bonds), &mut x, &mut y, Into::Set);
    });
}

fn v_cycle<const N: usize>(bencher: Bencher, scene: &Scene<N>) {
    let mut multigrid = Multigrid::new(&scene.fine());
    bencher.counter(scene.directed_bonds()).bench_local(|| multigrid.precondition(&scene.fine(), black_box(&scene.x)).len());
}

fn set_up<const N: usize>(bencher: Bencher, scene: &Scene<N>) {
    bencher.counter(scene.directed_bonds()).bench_local(|| Multigrid::new(&scene.fine()));
}

fn scalar_product<const N: usize>(bencher: Bencher, scene: &Scene<N>) {
    let layout = scene.product.layout();
    bencher.counter(scene.directed_bonds()).bench_local(|| dot(layout, black_box(&scene.x), &scene.y));
}

macro_rules! kernels {
    ($unknowns:ident, $scene:ident, $law:literal) => {
        mod $unknowns {
            use super::*;

            #[divan::bench(sample_count = SAMPLES)]
            fn product(bencher: Bencher) {
                super::product(bencher, $scene(), &$scene().bonds);
            }

            #[divan::bench(sample_count = SAMPLES)]
            fn product_cracked(bencher: Bencher) {
                super::product(bencher, $scene(), &$scene().cracked);
            }

            #[divan::bench(sample_count = SAMPLES)]
            fn v_cycle(bencher: Bencher) {
                super::v_cycle(bencher, $scene());
            }

            #[divan::bench(sample_count = SAMPLES)]
            fn scalar_product(bencher: Bencher) {
                super::scalar_product(bencher, $scene());
            }

            #[divan::bench(sample_count = 3, sample_size = 1)]
            fn set_up(bencher: Bencher) {
                super::set_up(bencher, $scene());
            }

            #[divan::bench(sample_count = 3, sample_size = 1)]
            fn body(bencher: Bencher) {
                bencher.counter($scene().directed_bonds()).bench_local(|| super::body($law));
            }
        }
    };
}

kernels!(two_unknowns, two, "bond_based");
kernels!(three_unknowns, three, "two_parameter");

/// Forces of explicit motion, damage included: true stretch of the bond-based law and small strain of both springs, by the
/// lattice kernel and by the list of bonds.
mod forces {
    use super::*;

    fn forces(bencher: Bencher, finite: bool, list: bool) {
        let body = super::body(if finite { "bond_based" } else { "one_bond_two_parameter_resisted" });
        let net = Net::of_body(&body);
        let mut bonds = BondState::new(&net, &vec![false; net.len()]);
        let failure = Failure::Stretch(vec![0.02; net.len()]);
        let u: Vec<f64> = (0..2 * net.len()).map(|i| ((i * 7) % 1013) as f64 * 1e-9).collect();
        let mut force = vec![0.0; u.len()];
        let mut fast = LatticeSprings::new(&net, &body, &bonds, &failure, finite).expect("two unknowns, one limit");
        let mut slow = Springs::new(&net, failure, finite);
        let interaction: &mut dyn Interaction = if list { &mut slow } else { &mut fast };
        let items = ItemsCount::new(2 * net.bonds.len());
        bencher
            .counter(items)
            .bench_local(|| interaction.internal_force(black_box(&u), &mut bonds, Damaging::Allowed, &mut force));
    }

    #[divan::bench(sample_count = SAMPLES)]
    fn true_stretch_lattice(bencher: Bencher) {
        forces(bencher, true, false);
    }

    #[divan::bench(sample_count = SAMPLES)]
    fn true_stretch_list(bencher: Bencher) {
        forces(bencher, true, true);
    }

    #[divan::bench(sample_count = SAMPLES)]
    fn small_strain_lattice(bencher: Bencher) {
        forces(bencher, false, false);
    }

    #[divan::bench(sample_count = SAMPLES)]
    fn small_strain_list(bencher: Bencher) {
        forces(bencher, false, true);
    }
}
