//! Cracks driven by the K of their tips: what the ring reads, the criterion of direction, cuts, ends, symmetry. Lives and paths are
//! rows of `perilife verify`.

use std::f64::consts::PI;
use std::path::Path;

use perilife_growth::CrackGrowth;
use perilife_growth::case::{Case, RESIDUAL};
use perilife_growth::cracks::kink::coefficients;
use perilife_growth::cracks::steering::{equivalent_factor, kink_angle};
use perilife_growth::points::TipField;
use perilife_growth::predict::{Prediction, Silent, StopReason, increment, predict};
use perilife_laws::growth_law::Walker;
use perilife_plate::specimen::{CrackLine, LineEnd, Point};
use perilife_plate::williams::{Eigenfunction, Elasticity, Symmetry, coefficient_of_unit_factor};
use perilife_points::body::Bond;
use perilife_points::body::pre_crack::bonds_across;
use perilife_points::solver::field::Layout;
use perilife_points::state::Bonds;
use perilife_points::stress_intensity::TipFrame;
use perilife_points::stress_intensity::ring::{Balanced, RingGeometry};
use perilife_study::cases::by_name;

const REST: &str = r#"
[material]
youngs_modulus_gpa = 70.0
poisson_ratio = 0.3
plane = "stress"
[fatigue]
paris_c_mm_per_cycle = 1e-8
paris_m = 3.0
[stop]
cycles_max = 1e14
"#;

/// A case of these sections `[specimen]` and `[loading]`, with other keys set by `section.key=value`.
fn case(specimen: &str, loading: &str, set: &[&str]) -> Case {
    let overrides: Vec<String> = set.iter().map(|text| (*text).to_owned()).collect();
    let text = format!("[specimen]\n{specimen}\n[loading]\n{loading}\n{REST}");
    Case::from_toml(&text, "plate", Path::new("."), &by_name(&text, &overrides)).unwrap()
}

fn run(case: &Case) -> Prediction {
    predict(case, &Silent).unwrap()
}

const PULL: &str = "stress_max_mpa = 60\nstress_ratio = 0.1";

/// The near-tip field of given K_I and K_II, put on the points of a plate whatever the lattice, is read as these, and its tip is
/// found where it is.
#[test]
fn a_ring_reads_an_exact_field() {
    const T_STRESS: f64 = 3e6;
    let places = [1.0_f64, 1.3, 1.6];
    for (angle, end) in [0.0, 22.5, 45.0].into_iter().flat_map(|angle| places.map(|end| (angle, end))) {
        let case = case(
            &format!(
                "kind = \"plate\"\nwidth_mm = 60\nlength_mm = 60\nthickness_mm = 1\n\
                 cracks = [{{ from_mm = [-30, 0.001], to_mm = [{end}, 0.001] }}]"
            ),
            PULL,
            &[&format!("model.lattice_angle_deg={angle}"), "model.spacing_mm=1"],
        );
        let model = case.points();
        let body = model.body(&case.specimen, &case.material).unwrap();
        let bonds = Bonds::new(&body);
        let elasticity = Elasticity::of(&case.material);
        let (layout, tip) = (Layout::of(&body.lattice, body.stencil.unknowns), [end * 1e-3, 0.001e-3]);
        let frame = TipFrame { origin: tip, ahead: [1.0, 0.0] };
        let lines = [CrackLine::straight([-0.03, 0.001e-3], tip)];
        // Factors, and by how much of a spacing the field has its tip ahead of the line's end.
        // In the last there is a stress along the crack, too, whose quadrature disturbs the factors a little.
        for (wanted, shift, t_stress) in [
            ([1e6, 0.0], 0.0, 0.0),
            ([0.0, 1e6], 0.0, 0.0),
            ([1e6, -0.4e6], 0.0, 0.0),
            ([1e6, 0.0], 0.2, 0.0),
            ([1e6, -0.4e6], 0.2, 0.0),
            ([1e6, 0.0], 0.0, T_STRESS),
        ] {
            let mut displacement = layout.zeros();
            for &place in &body.points {
                let [x, y] = frame.local(body.lattice.position(place as usize));
                let x = x - shift * body.lattice.spacing;
                let (r, theta) = (x.hypot(y), y.atan2(x));
                let mut u: Point = [0.0; 2];
                for (symmetry, k) in [Symmetry::Opening, Symmetry::Sliding].into_iter().zip(wanted) {
                    let scale = k * coefficient_of_unit_factor(symmetry) / (2.0 * elasticity.shear_modulus);
                    let field = Eigenfunction { order: 1, symmetry }.displacement(elasticity.kappa, r, theta);
                    u = [u[0] + scale * field[0], u[1] + scale * field[1]];
                }
                // Uniform stress along the crack.
                let across = (elasticity.kappa - 3.0) / (elasticity.kappa + 1.0);
                u = [u[0] + t_stress / elasticity.plane_modulus * x, u[1] + across * t_stress / elasticity.plane_modulus * y];
                let at = layout.index(place as usize);
                let axes = body.lattice.to_axes(u);
                (displacement[at], displacement[at + layout.stride]) = (axes[0], axes[1]);
            }
            let plate =
                Balanced { body: &body, bonds: &bonds, displacement: &displacement, load: 0.0, lines: &lines, pressures: &[] };
            let surroundings = RingGeometry::new(&body, &case.specimen, &case.material);
            for horizons in [2.0, 3.0, 4.0] {
                let ring = surroundings.factors(plate, LineEnd { line: 0, at_last: true }, horizons * body.horizon());
                let read = ring.factors.map(|factor| factor / 1e6);
                let ahead = (ring.tip_offset / body.lattice.spacing) - shift;
                println!(
                    "lattice {angle}°, tip at {end}, ring {horizons}: {read:.4?} of {wanted:?}, ahead {ahead:+.4} off {shift}"
                );
                let [bound, bound_ahead] = if horizons > 2.5 { [0.003, 0.03] } else { [0.008, 0.08] };
                let bound = if t_stress == 0.0 { bound } else { bound + 0.002 };
                for mode in 0..2 {
                    assert!((read[mode] - wanted[mode] / 1e6).abs() < bound, "{angle} {end} {horizons} {read:?} {wanted:?}");
                }
                assert!(ahead.abs() < bound_ahead, "{angle} {end} {horizons} {ahead}");
                if shift == 0.0 && wanted[1] == 0.0 {
                    let bound = if horizons > 2.5 { 0.03 } else { 0.1 };
                    assert!(((ring.t_stress - t_stress) / T_STRESS).abs() < bound, "{angle} {end} {horizons} {}", ring.t_stress);
                }
            }
        }
    }
}

/// The criterion itself: pure modes, and the sense of the turn.
#[test]
fn the_criterion_of_circumferential_stress() {
    assert_eq!(kink_angle([1.0, 0.0]), 0.0);
    // cos θ = 1/3 in pure mode II.
    assert!((kink_angle([0.0, 1.0]) + (1.0_f64 / 3.0).acos()).abs() < 1e-12);
    assert_eq!(kink_angle([0.0, -1.0]), -kink_angle([0.0, 1.0]));
    assert!((equivalent_factor([0.0, 1.0]) - 2.0 / 3.0_f64.sqrt()).abs() < 1e-12);
    for k_ii in [-2.0, -0.3, 1e-9, 0.7] {
        let theta = kink_angle([1.0, k_ii]);
        assert!((theta.sin() + k_ii * (3.0 * theta.cos() - 1.0)).abs() < 1e-12, "{k_ii}");
        // It is the largest: no other direction opens more.
        let opening = |t: f64| (0.5 * t).cos() * ((0.5 * t).cos().powi(2) - 1.5 * k_ii * t.sin());
        assert!((-3000..=3000).all(|i| opening(1e-3 * f64::from(i)) <= equivalent_factor([1.0, k_ii]) + 1e-12), "{k_ii}");
    }
    // Flanks in contact do not open the crack.
    assert_eq!(equivalent_factor([-1.0, 0.0]), 0.0);
}

const PANEL: &str = "kind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 300\nthickness_mm = 2\ncrack_length_mm = 10";

/// Mirror images: both tips of a slant crack are images of each other, and a mirrored plate has the mirrored path.
#[test]
fn mirror_images_stay_mirror_images() {
    let path = |sign: f64, residual: f64| {
        let specimen = format!(
            "kind = \"plate\"\nwidth_mm = 80\nlength_mm = 120\nthickness_mm = 2\ncracks = [{{ from_mm = [-6, {}], to_mm = [6, {}] }}]",
            -4.0 * sign,
            4.0 * sign
        );
        let mut case = case(&specimen, PULL, &["model.spacing_mm=1", "stop.crack_length_mm=34"]);
        case.model.points_mut().unwrap().residual = residual;
        run(&case)
    };
    // Near the residual of runs by default, each by its own round-off.
    let [up, down] = [1.0, -1.0].map(|sign| path(sign, RESIDUAL).life_cycles());
    assert!((up / down - 1.0).abs() < 1e-5, "{up} {down}");
    let (up, down) = (path(1.0, 1e-8), path(-1.0, 1e-8));
    assert_eq!(up.curve.len(), down.curve.len());
    for (a, b) in up.curve.iter().zip(&down.curve) {
        assert!((a.cycles - b.cycles).abs() <= 1e-6 * a.cycles, "{} {}", a.cycles, b.cycles);
        for tip in 0..2 {
            let ([x, y], [u, v]) = (a.tips[tip].position, b.tips[tip].position);
            assert!((x - u).abs() < 1e-9 && (y + v).abs() < 1e-9, "{x} {y} against {u} {v}");
        }
        let [[x, y], [u, v]] = [0, 1].map(|tip: usize| a.tips[tip].position);
        assert!((x + u).abs() < 1e-9 && (y + v).abs() < 1e-9, "{x} {y} against {u} {v}");
    }
}

/// The crack is cut through: no bond is left across its line, on a row of points and across rows, straight and curved.
#[test]
fn no_bond_is_left_across_the_crack() {
    for (y, lattice) in [(0.0, 0.0), (0.5, 0.0), (0.3, 22.5)] {
        let specimen = format!(
            "kind = \"plate\"\nwidth_mm = 40\nlength_mm = 60\nthickness_mm = 2\nholes = [{{ x_mm = 6, y_mm = 7, diameter_mm = 8 }}]\ncracks = [{{ from_mm = [-20, {y}], to_mm = [-8, {y}] }}]"
        );
        let case = case(&specimen, PULL, &["model.spacing_mm=1", &format!("model.lattice_angle_deg={lattice}")]);
        let law = Walker { paris: case.paris_law().unwrap(), gamma: 1.0, threshold: 0.0 };
        let mut growth = TipField::start(&case, Box::new(law)).unwrap();
        let body = growth.body().unwrap();
        growth.open().unwrap();
        let mut turned = 0.0_f64;
        let mut goes_on = true;
        while goes_on {
            goes_on = increment(&mut growth).is_none();
            let line = &growth.state.lines[0];
            let across: Vec<Bond> = line.pieces().flat_map(|[a, b]| bonds_across(&body, a, b)).collect();
            assert!(!across.is_empty() && across.iter().all(|&bond| !growth.plate.bonds.is_intact(bond)), "{line:?}");
            turned = turned.max(line.direction(true)[1].abs());
        }
        assert!(turned > 0.1, "the hole turns the crack: {turned}");
    }
}

/// Two cracks of which one is below the threshold: it waits, the other grows to the end.
#[test]
fn a_tip_below_the_threshold_waits() {
    let specimen = "kind = \"plate\"\nwidth_mm = 80\nlength_mm = 160\nthickness_mm = 2\ncracks = [{ from_mm = [-40, 40], to_mm = [-26, 40] }, { from_mm = [-40, -40], to_mm = [-36, -40] }]";
    let run =
        run(&case(specimen, PULL, &["model.spacing_mm=1", "fatigue.delta_k_threshold_mpa_sqrt_m=9", "stop.crack_length_mm=26"]));
    assert_eq!(run.stop, StopReason::CrackLengthReached);
    let [long, short] = [0, 1].map(|tip: usize| run.curve.last().unwrap().tips[tip].growth);
    assert!(short == 0.0 && (long - 12e-3).abs() < 1e-9, "{long} {short}");
}

/// Ends: run-out at its cycles, toughness at its K, nothing above the threshold, the edge.
#[test]
fn reasons_to_stop() {
    let with = |set: &[&str]| run(&case(PANEL, PULL, &[&["model.spacing_mm=2"], set].concat()));
    let whole = with(&["stop.crack_length_mm=20"]);
    let half = 0.5 * whole.life_cycles();
    let run_out = with(&[&format!("stop.cycles_max={half}")]);
    assert_eq!((run_out.stop, run_out.life_cycles()), (StopReason::RunOut, half));
    let drawn =
        "kind = \"plate\"\nwidth_mm = 100\nlength_mm = 200\nthickness_mm = 2\ncracks = [{ from_mm = [-10, 0], to_mm = [10, 0] }]";
    let tough = run(&case(drawn, PULL, &["model.spacing_mm=2", "material.toughness_mpa_sqrt_m=16"]));
    assert_eq!(tough.stop, StopReason::Toughness);
    assert!((tough.curve.last().unwrap().delta_k / (0.9 * 16e6) - 1.0).abs() < 1e-9);
    let still = with(&["fatigue.delta_k_threshold_mpa_sqrt_m=30"]);
    assert_eq!((still.stop, still.curve.len()), (StopReason::NothingAges, 1));
    assert!(matches!(with(&[]).stop, StopReason::Severed | StopReason::LeftPlate));
}

/// Amestoy and Leblond: 1 - 3θ²/8 and -3θ/2 for small kinks; with the direction of either sense F₁₂ changes its sign, the others do not.
/// In pure sliding the largest K of a kink is 6 % above that of the largest circumferential stress (2/√3).
#[test]
fn a_short_kink_has_the_k_of_its_series() {
    let [f11, f12, g1] = coefficients(0.01);
    assert!((f11 - 1.0 + 3.0 / 8.0 * 1e-4).abs() < 1e-8 && (f12 + 0.015).abs() < 1e-6, "{f11}, {f12}");
    assert!((g1 - (2.0 * PI).powf(1.5) * (0.01 / PI).powi(2)).abs() < 1e-7, "{g1}");
    let (here, there) = (coefficients(1.2), coefficients(-1.2));
    assert_eq!([here[0], -here[1], here[2]], there);
    let at = kink_angle([0.0, 1.0]);
    let over = coefficients(at)[1] / equivalent_factor([0.0, 1.0]);
    assert!((over - 1.06).abs() < 0.01, "{at}: {over}");
}
