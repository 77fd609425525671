//! The element-free Galerkin method: shape functions, patch, interaction integral, bases, growth on hard plates.

use std::f64::consts::PI;

use perilife_base::input::Folder;
use perilife_base::quadrature::integrate;
use perilife_growth::case::Case;
use perilife_growth::predict::tip_factors::{StressIntensityMethod, stress_intensity};
use perilife_growth::predict::{Prediction, Silent, predict};
use perilife_growth::record::{StopReason, TipRecord};
use perilife_nodes::basis::{BasisKind, Enrichment, Value};
use perilife_nodes::crack::{Tip, TipAxes};
use perilife_nodes::factors::{TipFactors, integral, read};
use perilife_nodes::field::{Discretisation, Local};
use perilife_nodes::resolution::{IN_RADIUS, RIM_REACH, Resolution};
use perilife_nodes::solve::{Loaded, Solution, solve, solve_with};
use perilife_plate::material::{Material, Plane};
use perilife_plate::specimen::{CrackLine, Specimen};
use perilife_plate::williams::{Eigenfunction, Elasticity, Symmetry, coefficient_of_unit_factor};
use perilife_study::cases::{NODES as METHOD, case, case_of};

use crate::support::plates::{cracked_plate, cracks, pulled_plate};

const BASES: [(BasisKind, Enrichment, f64); 4] = [
    (BasisKind::Linear, Enrichment::Tip, 2.5),
    (BasisKind::Linear, Enrichment::None, 2.5),
    (BasisKind::Quadratic, Enrichment::None, 3.5),
    (BasisKind::Linear, Enrichment::Intrinsic, 3.0),
];

/// Lengths of crack that belong to the tips of a specimen.
fn tips(specimen: &Specimen) -> (Vec<CrackLine>, Vec<Tip>) {
    let lines = specimen.crack_lines();
    let tip = |tip: usize| {
        // The end of a slot is none.
        let end = specimen.line_end(tip)?;
        let line = &lines[end.line];
        Some(Tip { end, length: line.length() / specimen.tips_of(line) as f64 })
    };
    let tips = (0..specimen.tips.len()).filter_map(tip).collect();
    (lines, tips)
}

/// Nodes of a case with `across` spacings over its width.
fn nodes(case: &Case, across: f64, (basis, enrichment, support): (BasisKind, Enrichment, f64)) -> (Discretisation, f64) {
    let (lines, tips) = tips(&case.specimen);
    let far = case.specimen.width / across;
    let resolution = Resolution {
        far,
        hold: 3.0,
        reach: 4.0,
        in_radius: IN_RADIUS,
        rim_reach: RIM_REACH,
        fineness: 1.0,
        support,
        basis,
        enrichment,
    };
    let elasticity = Elasticity::of(&case.material);
    (Discretisation::new(&case.specimen, elasticity, &lines, &tips, &resolution, None).unwrap(), far)
}

/// A plate with a crack that bends, one at a hole, a slot and a re-entrant corner.
fn crowded_plate() -> Case {
    let text = pulled_plate(
        "outline_mm = [[-50, -100], [50, -100], [50, 100], [0, 100], [0, 60], [-50, 60]]\n\
         holes = [{ x_mm = 20, y_mm = -30, diameter_mm = 16 }]\n\
         notches = [{ from_mm = [-50, -60], to_mm = [-35, -60], width_mm = 3 }]\n\
         cracks = [{ path_mm = [[-50, 0], [-40, 0], [-34, 5], [-30, 10.5]] }, { from_mm = [28, -30], to_mm = [35, -27] }]",
    );
    case(&text, &format!("loading.edges=[\"bottom\"] supports.top.fix=[\"x\",\"y\"] {METHOD}")).unwrap()
}

#[test]
fn shape_functions_reproduce_linear_fields_beside_cracks_holes_and_corners() {
    let case = crowded_plate();
    for choice in BASES {
        let (plate, far) = nodes(&case, 12.0, choice);
        let mut local = Local::default();
        let mut seen = 0;
        for place in 0..4000 {
            let at = [-0.05 + 0.1 * ((place * 37) % 4001) as f64 / 4001.0, -0.1 + 0.2 * ((place * 1009) % 4003) as f64 / 4003.0];
            if !case.specimen.contains(at) || !plate.at(plate.grid.leaf(at), at, &mut local) {
                continue;
            }
            seen += 1;
            let node = |value: &Value| plate.nodes.at[value.node as usize];
            let sum = |of: &dyn Fn(&Value) -> f64| -> f64 { local.values.iter().map(of).sum() };
            // Of the enriched basis both moments are far from unit.
            let bound = if choice.1 == Enrichment::Intrinsic { 1e-7 } else { 1e-10 };
            for (found, wanted, size) in [
                (sum(&|value| value.value), 1.0, 1.0),
                (sum(&|value| value.value * node(value)[0]), at[0], far),
                (sum(&|value| value.value * node(value)[1]), at[1], far),
                (sum(&|value| value.gradient[0]), 0.0, 1.0 / far),
                (sum(&|value| value.gradient[0] * node(value)[0]), 1.0, 1.0),
                (sum(&|value| value.gradient[0] * node(value)[1]), 0.0, 1.0),
            ] {
                // Sums of slopes cancel over the finest spacing.
                let finest = plate.nodes.spacing.iter().copied().fold(f64::INFINITY, f64::min);
                assert!((found - wanted).abs() < bound * size * (far / finest), "{choice:?} at {at:?}: {found} for {wanted}");
            }
        }
        assert!(seen > 2500, "{seen} points see enough nodes");
    }
}

#[test]
fn a_patch_in_uniform_tension_is_in_equilibrium_within_a_thousandth() {
    let text = pulled_plate("width_mm = 50\nlength_mm = 100\ncracks = [{ from_mm = [-25, 0], to_mm = [-15, 0] }]");
    let mut case = case(&text, "").unwrap();
    case.specimen.cracks.clear();
    case.specimen.tips.clear();
    let (plate, far) = nodes(&case, 10.0, BASES[0]);
    let Solution { whole: solution, area, .. } =
        solve_with(&case.specimen, &plate, far, case.loading.maximum, (None, &[])).unwrap();
    assert!((area - case.specimen.area()).abs() < 1e-12 * area, "the cells cover the plate");
    let (strain, nu) = (case.loading.maximum / case.material.youngs_modulus, case.material.poisson_ratio);
    let mut local = Local::default();
    for at in [[0.0, 0.0], [0.0201, 0.0402], [-0.013, 0.0317], [0.024, -0.049]] {
        let (_, [[xx, xy], [yx, yy]]) = plate.displacement(&solution.u, at, &mut local).unwrap();
        for (found, wanted) in [(xx, -nu * strain), (yy, strain), (xy + yx, 0.0)] {
            assert!((found - wanted).abs() < 1e-3 * strain, "{found} for {wanted} at {at:?}");
        }
    }
    let work = case.loading.maximum.powi(2) / case.material.youngs_modulus * case.specimen.area() * case.specimen.thickness;
    assert!((solution.work / work - 1.0).abs() < 1e-3, "{} for {work}", solution.work);
}

#[test]
fn the_integral_reads_the_fields_of_williams() {
    for plane in [Plane::Stress, Plane::Strain] {
        let elasticity = Elasticity::of(&Material::elastic(72e9, 0.3, plane));
        let axes = TipAxes { at: [0.3, -0.2], ahead: [0.8, 0.6], back: vec![[0.3, -0.2], [-0.5, -0.8]], spacing: 0.01 };
        let (k, t) = ([3e6, -2e6], 5e6);
        let field = |at: [f64; 2]| {
            let (r, theta) = axes.polar(at);
            let mut sum = [[0.0; 2]; 2];
            let mut add = |order: i32, symmetry: Symmetry, size: f64| {
                let gradient = Eigenfunction { order, symmetry }.gradient(elasticity.kappa, r, theta);
                for i in 0..2 {
                    for j in 0..2 {
                        sum[i][j] += size * gradient[i][j] / (2.0 * elasticity.shear_modulus);
                    }
                }
            };
            add(1, Symmetry::Opening, k[0] * coefficient_of_unit_factor(Symmetry::Opening));
            add(1, Symmetry::Sliding, k[1] * coefficient_of_unit_factor(Symmetry::Sliding));
            // The first function of order 2 has σ_xx = 4 a.
            add(2, Symmetry::Opening, t / 4.0);
            add(3, Symmetry::Opening, 1e7);
            add(4, Symmetry::Sliding, 2e7);
            Ok(sum)
        };
        let read = integral(&axes, elasticity, 0.05, &|_| [0.0; 3], field).unwrap();
        for (found, wanted) in [(read.factors[0], k[0]), (read.factors[1], k[1]), (read.t_stress, t)] {
            assert!((found / wanted - 1.0).abs() < 1e-3, "{plane}: {found} for {wanted}");
        }
    }
}

/// Stress ahead of an edge crack at some distances, over K/√(2πr) with K of finite elements (F = 1.488, square plate, a/W 0.2).
/// That of the continuum is 1.005, 1.015 and 1.074 at 0.1, 1 and 5 mm (quarter-point elements).
#[test]
fn near_tip_fields_bring_the_stress_ahead_of_a_tip_that_polynomials_miss() {
    let text = pulled_plate("width_mm = 50\nlength_mm = 50\ncracks = [{ from_mm = [-25, 0], to_mm = [-15, 0] }]");
    let case = case(&text, METHOD).unwrap();
    let k = 1.488 * case.loading.maximum * (PI * 0.01).sqrt();
    let error = |choice| {
        let (plate, far) = nodes(&case, 20.0, choice);
        let solution = solve(&case.specimen, &plate, far, case.loading.maximum).unwrap();
        let mut local = Local::default();
        let ahead = [(1e-4, 1.005), (1e-3, 1.015), (5e-3, 1.074)].map(|(r, share): (f64, f64)| {
            let (_, gradient) = plate.displacement(&solution.u, [-0.015 + r, 0.0], &mut local).unwrap();
            let [_, stress, _] = Elasticity::of(&case.material).stress(&gradient);
            stress * (2.0 * PI * r).sqrt() / k / share - 1.0
        });
        (ahead.iter().map(|error| error * error).sum::<f64>() / 3.0).sqrt()
    };
    let [fields, linear, quadratic, intrinsic] = BASES.map(error);
    assert!(fields < 0.03 && intrinsic < 0.03, "{fields} with fields as unknowns, {intrinsic} with those in the basis");
    assert!(linear > 5.0 * fields && quadratic > 5.0 * fields, "{linear}, {quadratic} with polynomials alone");
}

/// Slots whose walls lie on lines of the grid have no two nodes in one place where they meet the outline: K goes on smoothly there.
#[test]
fn a_slot_along_a_line_of_the_grid_is_a_slot_like_others() {
    let k = |width: f64| {
        let keys = format!(
            "[specimen]\nkind = \"plate\"\nwidth_mm = 100.0\nlength_mm = 200.0\nthickness_mm = 2.5\n\
             cracks = [{{ from_mm = [-50, 0], to_mm = [-40, 0] }}]\n\
             notches = [{{ from_mm = [-50, 50], to_mm = [-45, 50], width_mm = {width} }}]\n[material]\nyoungs_modulus_gpa = 72\n\
             poisson_ratio = 0.3\n[loading]\nstress_max_mpa = 70\nstress_ratio = 0.1\n[model]\nmethod = \"element_free_galerkin\"\n"
        );
        let case = Case::without_growth(keys.parse().unwrap(), "slot", &Folder::none()).unwrap();
        let tips = stress_intensity(&case, &[StressIntensityMethod::ElementFreeGalerkin]).unwrap();
        tips[0].methods[0].intensity.k_i.unwrap() / 1e6
    };
    for (on_line, beside) in [(1.25, 1.2501), (2.5, 2.501)] {
        let [on_line, beside] = [on_line, beside].map(k);
        assert!((on_line / beside - 1.0).abs() < 1e-3, "{on_line} {beside}");
    }
}

/// Straight lines between rows are the curve: beside a run with steps a fifth as long they are off by 0.2 % of life at most, lines between rows
/// with an equilibrium of their own by more than twice that.
#[test]
fn straight_lines_between_rows_are_the_curve() {
    let run = |keys: &str| {
        let text = cracked_plate(100.0, 200.0, &[[[-50.0, 0.0], [-40.0, 0.0]]]);
        predict(&case(&text, &format!("loading.stress_max_mpa=40 {METHOD} {keys}")).unwrap(), &Silent).unwrap()
    };
    let [usual, fine] = ["", "fatigue.step_error_percent=0.05"].map(run);
    let mut solved = usual.clone();
    solved.curve.retain(|row| row.is_solved);
    let [start, end] = [&fine.curve[0], &fine.curve[fine.curve.len() - 1]].map(|row| row.crack_length);
    let off = |run: &Prediction| {
        let off = |share: f64| {
            let [cycles, right] = [run, &fine].map(|run| run.cycles_at(start + share * (end - start)).unwrap());
            (cycles - right).abs() / fine.life_cycles()
        };
        (1..400).map(|i| off(f64::from(i) / 410.0)).fold(0.0, f64::max)
    };
    let [all, solved] = [off(&usual), off(&solved)];
    println!("{all} {solved}, {} rows of {}", usual.curve.len(), fine.curve.len());
    assert!(all < 2e-3 && solved > 2.0 * all, "{all}, {solved}");
}

/// A plate that is its own image is solved by a part of it: with the same nodes under a residual stress of next to nothing that is not, and so
/// solved whole, K, work and contact are the same to 1e-9. On slant cracks and at holes some points are level with a corner, past which a whole
/// plate sees them on one side alone, by round-off, which is 7e-5 of K.
#[test]
fn a_part_of_a_symmetric_plate_stands_for_it() {
    let square = "width_mm = 100\nlength_mm = 100\n";
    let plate = |ends: &[[[f64; 2]; 2]]| pulled_plate(&format!("{square}{}", cracks(ends)));
    let with = |more: &str| pulled_plate(&format!("{square}{more}"));
    let [centre, slant, high] = [[[-10.0, 0.0], [10.0, 0.0]], [[-8.0, -5.0], [8.0, 5.0]], [[-10.0, 3.0], [10.0, 3.0]]];
    let at_hole = cracks(&[[[-15.0, 0.0], [-5.0, 0.0]], [[5.0, 0.0], [15.0, 0.0]]]);
    let held = "[supports]\nbottom = { fix = [\"x\", \"y\"] }\n";
    let moved = "kind = \"displacement\"\ndisplacement_max_mm = 0.05";
    let clamped = "kind = \"single_edge_tension\"\nwidth_mm = 50\nlength_mm = 100\ncrack_length_mm = 20\nends = \"clamped\"\n";
    let residual = "-90 * exp(-(x/20)^2)";
    // Name, case, sign of the load, parts, whether flanks are in contact, and by how much whole plates are off, over K.
    let (same, level) = (1e-9, 1e-4);
    let rows = [
        ("centre crack", plate(&[centre]), 1.0, 4, false, same),
        ("overlap", plate(&[centre]), -1.0, 4, true, same),
        ("slant crack", plate(&[slant]), 1.0, 2, false, level),
        ("flanks that slide", plate(&[slant]), -1.0, 2, true, level),
        ("bent crack", with("cracks = [{ path_mm = [[-12, -5], [-8, 0], [8, 0], [12, 5]] }]"), 1.0, 2, false, level),
        ("edge crack", plate(&[[[-50.0, 0.0], [-30.0, 0.0]]]), 1.0, 2, false, same),
        ("hole", with(&format!("holes = [{{ x_mm = 0, y_mm = 0, diameter_mm = 10 }}]\n{at_hole}")), 1.0, 4, false, level),
        ("two cracks", plate(&[[[-25.0, -4.0], [-8.0, -4.0]], [[8.0, 4.0], [25.0, 4.0]]]), 1.0, 2, false, same),
        ("held below", plate(&[high]) + held, 1.0, 2, false, same),
        ("moved", plate(&[high]).replace("stress_max_mpa = 60", moved) + held, 1.0, 2, false, same),
        (
            "clamped",
            plate(&[centre]).replace("kind = \"plate\"", clamped).replace(square, "").replace(&cracks(&[centre]), ""),
            1.0,
            2,
            false,
            same,
        ),
        ("residual stress", plate(&[centre]), 1.0, 4, true, level),
        ("one of its own", plate(&[[[-20.0, 5.0], [10.0, 3.0]]]), 1.0, 1, false, same),
    ];
    for (name, text, sign, parts, is_in_contact, most) in rows {
        let case = case(&text, "").unwrap_or_else(|error| panic!("{name}: {error}"));
        let (plate, far) = nodes(&case, 20.0, BASES[0]);
        let [part, whole] = [0.0, 1.0].map(|times| {
            let (own, size) = if name == "residual stress" { (residual, 1e-4) } else { ("0", 1e-9) };
            let other = format!("{} * (x + 30)", times * size);
            let formula = format!("loading.residual_stress_mpa={{ y = \"{own}\", xy = \"{other}\" }}");
            let stressed =
                case_of(&cracked_plate(100.0, 100.0, &[centre]), &[formula, "fatigue.walker_gamma=1".to_owned()]).unwrap();
            let load = sign * case.loading.maximum;
            let solution = solve_with(&case.specimen, &plate, far, load, (stressed.loading.residual.as_deref(), &[0.1])).unwrap();
            let stress = |_| [0.0; 3];
            let factors: Vec<TipFactors> =
                (0..plate.axes.len()).map(|tip| read(&plate, &solution.whole.u, tip, 1.0, &stress).unwrap()).collect();
            (factors, solution)
        });
        assert_eq!([part.1.parts, whole.1.parts], [parts, 1], "{name}");
        let largest = whole.0.iter().flat_map(|tip| tip.factors).fold(0.0_f64, |largest, k| largest.max(k.abs()));
        for (of_part, of_whole) in part.0.iter().zip(&whole.0) {
            let off = (0..2).map(|mode| (of_part.factors[mode] - of_whole.factors[mode]).abs()).fold(0.0, f64::max);
            assert!(off < most * largest, "{name}: {of_part:?}, {of_whole:?}");
        }
        let is_near = |a: f64, b: f64| (a - b).abs() <= most * b.abs();
        assert!(is_near(part.1.area, whole.1.area) && is_near(part.1.whole.work, whole.1.whole.work), "{name}");
        let pressure = |loaded: &Loaded| loaded.pressed.iter().map(|pressed| pressed.pressure).fold(0.0, f64::max);
        let (loads, of_whole) = ([&part.1, &whole.1].map(|of| std::iter::once(&of.whole).chain(&of.lower)), &whole.1.lower);
        assert_eq!(part.1.lower.len(), of_whole.len(), "{name}");
        let [of_part, of_whole] = loads;
        for (of_part, of_whole) in of_part.zip(of_whole) {
            assert_eq!(of_part.pressed.len(), of_whole.pressed.len(), "{name}");
            assert!((pressure(of_part) - pressure(of_whole)).abs() <= 10.0 * most * pressure(of_whole), "{name}");
        }
        assert_eq!(!part.1.whole.pressed.is_empty(), is_in_contact, "{name}");
    }
}

/// Cracks that are images of each other by half a turn stay so to the end, where they curve, take turns in leading and meet, at every fineness: one
/// that gets ahead would stay there, since the longer crack grows faster.
#[test]
fn images_grow_as_images() {
    let two = &[[[-20.0, -4.0], [-8.0, -4.0]], [[8.0, 4.0], [20.0, 4.0]]];
    let offset = &[[[-40.0, 5.0], [-28.0, 5.0]], [[28.0, -5.0], [40.0, -5.0]]];
    let plates = [("two cracks", cracked_plate(100.0, 200.0, two)), ("from both edges", cracked_plate(80.0, 160.0, offset))];
    for (name, text) in plates {
        for percent in [5, 1] {
            let run = predict(&case(&text, &format!("{METHOD} model.tolerance_percent={percent}")).unwrap(), &Silent).unwrap();
            for tips in run.curve.iter().map(|row| &row.tips) {
                let pairs = tips.iter().zip(tips.iter().rev());
                let off =
                    |(a, b): (&TipRecord, &TipRecord)| (0..2).map(|i| (a.position[i] + b.position[i]).abs()).fold(0.0, f64::max);
                assert!(pairs.map(off).fold(0.0, f64::max) < 1e-9, "{name} at {percent} %: {tips:?}");
            }
        }
    }
}

/// Finite elements with first steps of 0.004 mm (`tests/reference`): the crack passes the hole at 3.2 mm in the last 0.2 % of its life, and is at
/// (30.00, 1.41) mm after 1 221 390 cycles. Steps count by their cycles, so that the way behind the hole is known to half a millimetre.
#[test]
fn a_crack_that_passes_a_hole_does_not_run_into_it_however_few_cycles_are_left() {
    let end = [-40.0 + 9.0 * 0.5_f64.cos(), 9.0 * 0.5_f64.sin()];
    let holes = "holes = [{ x_mm = 8, y_mm = -6, diameter_mm = 10 }]";
    let text = pulled_plate(&format!("width_mm = 80\nlength_mm = 160\n{holes}\n{}", cracks(&[[[-40.0, 0.0], end]])));
    let run = predict(&case(&text, &format!("loading.stress_max_mpa=45 {METHOD}")).unwrap(), &Silent).unwrap();
    let places: Vec<[f64; 2]> = run.curve.iter().map(|row| row.tips[0].position.map(|x| 1e3 * x)).collect();
    let beyond = places.iter().position(|[x, _]| *x > 30.0).unwrap_or_else(|| panic!("{} at {:?} mm", run.stop, places.last()));
    let [[x0, y0], [x1, y1]] = [places[beyond - 1], places[beyond]];
    let y = y0 + (30.0 - x0) / (x1 - x0) * (y1 - y0);
    println!("{:.0} cycles, y {y:.2} mm, {}", run.curve[beyond].cycles, run.stop);
    assert!((run.curve[beyond].cycles / 1_221_390.0 - 1.0).abs() < 3e-3 && (y - 1.41).abs() < 0.5, "{y} mm");
}

/// A rate without bound at K_c ends a life there, whatever step meets it: the life is `∫ da / r` over the K of a run by Paris.
#[test]
fn rates_without_bound_end_at_k_c() {
    let run = |law: &str| {
        let crack = cracks(&[[[5.0, 0.0], [8.0, 0.0]]]);
        let plate = format!("width_mm = 100\nlength_mm = 200\nholes = [{{ x_mm = 0, y_mm = 0, diameter_mm = 10 }}]\n{crack}");
        let text = format!(
            "[specimen]\nkind = \"plate\"\nthickness_mm = 2\n{plate}\n[loading]\nstress_max_mpa = 100\nstress_ratio = 0.1\n\
             [material]\nyoungs_modulus_gpa = 70\npoisson_ratio = 0.3\n[fatigue]\n{law}"
        );
        predict(&case_of(&text, &[METHOD.to_owned()]).unwrap(), &Silent).unwrap()
    };
    let rows: Vec<[f64; 2]> = run("paris_c_mm_per_cycle = 1e-8\nparis_m = 3\n[stop]\ncrack_length_mm = 42")
        .curve
        .iter()
        .map(|row| [row.crack_length * 1e3, row.delta_k / 1e6])
        .collect();
    let [forman, nasgro] = [
        "growth_law = \"forman\"\nforman_c_mm_per_cycle = 1e-6\nforman_m = 3\nk_c_mpa_sqrt_m = 60",
        "growth_law = \"nasgro\"\nnasgro_c_mm_per_cycle = 1e-8\nnasgro_n = 3\nnasgro_p = 0\nnasgro_q = 1\nnasgro_alpha = 2\n\
         nasgro_smax_over_flow = 0.3\nnasgro_delta_k_0_mpa_sqrt_m = 2\nk_c_mpa_sqrt_m = 60",
    ]
    .map(run);
    for run in [&forman, &nasgro] {
        let last = run.curve.last().unwrap();
        assert_eq!(run.stop, StopReason::Toughness);
        assert!((last.delta_k / 54e6 - 1.0).abs() < 1e-6 && last.cycles.is_finite(), "{} Pa√m", last.delta_k);
    }
    // ln K linear between rows; 1/r falls to nothing at (1-R) K_c = 54 MPa√m.
    let inverse = |k: f64| (54.0 - k).max(0.0) / (1e-6 * k.powi(3));
    let life: f64 = rows
        .windows(2)
        .map(|pair| {
            let [[a, k], [then, k_then]] = [pair[0], pair[1]];
            (then - a) * integrate(|x| inverse(k * (k_then / k).powf(x)), 0.0, 1.0, 1e-10).value
        })
        .sum();
    println!("{} cycles, {life} by the integral", forman.life_cycles());
    assert!((forman.life_cycles() / life - 1.0).abs() < 0.0015, "{life}");
}
