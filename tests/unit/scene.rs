//! A scene file as a whole: what is read, what is chosen where it says nothing.

use std::path::Path;

use perilife_base::error::Error;
use perilife_base::input::Document;
use perilife_growth::case::Case;
use perilife_plate::specimen::geometry::{distance, polygon_area};
use perilife_plate::specimen::{Edge, Support};
use perilife_points::bond_law::{BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_scenes::Scene;
use perilife_scenes::assembly::preview;
use perilife_scenes::failure::Failure;
use perilife_scenes::read::is_scene;
use perilife_scenes::scene::{
    Action, DamageEntry, DamageLaw, Discretisation, LoadRamp, Procedure, RefinedRegion, Region, SceneLaw, SceneSolver,
    ZeroEnergyControl,
};

use crate::support::rows::assert_refusal;

const PLATE: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 40\nlength_mm = 20\nthickness_mm = 2\n\
                     cracks = [{ from_mm = [-20, 0], to_mm = [0, 0] }]\n\
                     [material]\nyoungs_modulus_gpa = 65\npoisson_ratio = 0.2\ndensity_kg_m3 = 2235\nfracture_energy_j_m2 = 204\n";
const STEPS: &str = "[loading]\nkind = \"displacement\"\ndisplacement_mm = 0.1\nedges = [\"top\", \"bottom\"]\nsteps = 50\n";

fn read(text: &str, overrides: &[&str]) -> Result<Scene, Error> {
    let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
    Scene::from_toml(text, "scene", Path::new(""), &overrides)
}

fn steps(overrides: &[&str]) -> Scene {
    read(&format!("{PLATE}{STEPS}"), overrides).unwrap()
}

#[test]
fn what_is_left_out_is_chosen() {
    let scene = steps(&[]);
    let SceneLaw::Bonds(law) = scene.model.law else { panic!("bonds") };
    assert_eq!((law.kind, law.kernel), (BondLawKind::TwoParameter, Kernel::Conical));
    assert_eq!((law.rotation, law.surface_correction), (Rotation::Free, SurfaceCorrection::VolumeAndSurface));
    assert_eq!((scene.model.horizon_ratio, scene.model.lattice_angle, scene.model.finite), (3.015, 0.0, false));
    assert_eq!((scene.model.arrangement, scene.model.solver), (Discretisation::Lattice, SceneSolver::Secant));
    assert!((scene.model.spacing - 0.4e-3).abs() < 1e-12, "a hundredth of the width: {}", scene.model.spacing);
    assert_eq!((scene.damage.law, scene.damage.enters), (DamageLaw::None, DamageEntry::Influence));
    assert_eq!(scene.procedure, Procedure::QuasiStatic { steps: 50, iterations: None });
    assert!(scene.holds.is_empty() && scene.refinement.is_none() && scene.warnings.is_empty());
    assert_eq!(scene.echo["loading"]["steps"], 50);
}

/// With `growth` the energy of a bond is divided by the trapping of law, kernel and horizon ratio; a stretch that is given stays.
#[test]
fn the_calibration_sets_the_critical_stretch() {
    let of = |overrides: &[&str]| {
        let text = format!("{PLATE}{STEPS}[damage]\nlaw = \"critical_energy\"\n[model]\nspacing_mm = 1\n");
        let scene = read(&text, overrides).unwrap();
        let (net, _) = perilife_scenes::build(&scene).unwrap();
        let Failure::Energy(limits) = Failure::of(&scene, &net).unwrap() else { panic!("{scene:?}") };
        limits[0]
    };
    let table = [
        (&[][..], 1.50),
        (&["model.kernel=constant"], 1.45),
        (&["model.horizon_ratio=4"], 1.33),
        (&["model.horizon_ratio=4.5"], 1.215),
        (&["model.horizon_ratio=5"], 1.10),
        (&["model.horizon_ratio=6"], 1.0),
        (&["model.horizon_ratio=2.5"], 1.50),
        (&["model.bond_law=bond_based", "material.poisson_ratio=0.25", "material.plane=strain"], 1.41),
        (&["model.bond_law=one_bond_two_parameter"], 1.37),
        (&["model.bond_law=one_bond_two_parameter", "model.rotation=resisted"], 1.0),
    ];
    for (set, trapping) in table {
        let published = of(&[set, &["damage.calibration=bond_energy"]].concat());
        for grown in [of(set), of(&[set, &["damage.calibration=growth"]].concat())] {
            assert!(((published / grown).powi(2) / trapping - 1.0).abs() < 5e-3, "{set:?}: {grown} and {published}");
        }
    }
    assert_eq!(of(&["damage.critical_stretch=0.01"]), 0.01);
}

#[test]
fn kernel_and_solver_follow_law_and_procedure() {
    let kernel = |law: &str, nu: &str| {
        let scene = steps(&[&format!("model.bond_law={law}"), &format!("material.poisson_ratio={nu}")]);
        let SceneLaw::Bonds(law) = scene.model.law else { panic!("bonds") };
        law.kernel
    };
    assert_eq!(kernel("bond_based", "0.3333"), Kernel::Constant);
    assert_eq!(kernel("one_bond_two_parameter", "0.2"), Kernel::Constant);
    assert_eq!(kernel("two_parameter", "0.2"), Kernel::Conical);
    let scene = steps(&["model.bond_law=correspondence", "material.poisson_ratio=0.4"]);
    assert_eq!(scene.model.solver, SceneSolver::AdaptiveDynamicRelaxation);
    assert_eq!(scene.model.law, SceneLaw::Correspondence { control: ZeroEnergyControl::Silling, factor: 0.3 });
    let text = format!("{PLATE}{}", STEPS.replace("steps = 50", "duration_s = 1e-5\nramp_s = 1e-6\ntime_step_s = 1e-8"));
    let scene = read(&text, &[]).unwrap();
    assert_eq!(scene.model.solver, SceneSolver::VelocityVerlet);
    assert_eq!(scene.procedure, Procedure::Dynamic { duration: 1e-5, time_step: Some(1e-8) });
    assert!(scene.drives.iter().all(|drive| drive.rise == LoadRamp { from: 0.0, ramp: 1e-6 }));
    let scene = read(&format!("{PLATE}{}", STEPS.replace("steps = 50\n", "")), &[]).unwrap();
    assert_eq!(scene.procedure, Procedure::Static);
}

/// A load acts along the outward normal of its side, a platen against it, or along a direction; other components are free
/// unless they are held.
#[test]
fn loads_have_a_direction() {
    let actions = |loading: &str| -> Vec<Action> {
        let scene = read(
            &format!(
                "{PLATE}[loading]\n{loading}\n[supports]\ncorner = {{ from_mm = [-20, -10], to_mm = [-18, -9], fix = [\"x\", \"y\"] }}"
            ),
            &[],
        );
        scene.unwrap().drives.iter().map(|drive| drive.action).collect()
    };
    let up = "displacement_mm = 0.1\nedges = [\"top\"]\nsteps = 1";
    assert_eq!(actions(&format!("kind = \"displacement\"\n{up}")), [Action::Displacement([None, Some(1e-4)])]);
    let held = format!("kind = \"displacement\"\ntransverse = \"held\"\n{up}");
    assert_eq!(actions(&held), [Action::Displacement([Some(0.0), Some(1e-4)])]);
    let slanted = actions(&format!("kind = \"displacement\"\ndirection = [3, 4]\n{up}"));
    let Action::Displacement([Some(x), Some(y)]) = slanted[0] else { panic!("{slanted:?}") };
    assert!((x - 0.6e-4).abs() < 1e-18 && (y - 0.8e-4).abs() < 1e-18);
    assert_eq!(actions(&format!("kind = \"platens\"\n{up}")), [Action::Platen([-0.0, -1e-4])]);
    let pulled = actions("kind = \"traction\"\nstress_mpa = 12\nedges = [\"left\", \"right\"]");
    assert_eq!(pulled, [Action::Traction([-12e6, 0.0]), Action::Traction([12e6, 0.0])]);
    let thrown = "kind = \"velocity\"\nvelocity_mm_s = -500\ndirection = [0, 1]\nregions = [{ from_mm = [0, 8], to_mm = [5, 10] }]\nduration_s = 1e-6";
    assert_eq!(actions(thrown), [Action::Velocity([None, Some(-0.5)])]);
    let parts = "duration_s = 1e-6\nramp_s = 1e-7\nparts = [{ kind = \"traction\", stress_mpa = 1, edges = [\"top\"], range_mm = [-5, 5] }, { kind = \"velocity\", velocity_mm_s = 1, edges = [\"right\"] }]";
    assert_eq!(actions(parts), [Action::Traction([0.0, 1e6]), Action::Velocity([Some(1e-3), None])]);
}

/// Every load rises by itself: over its own time or that of all, at once where that is 0, and from its own start on.
#[test]
fn loads_rise_one_after_another() {
    let parts = "duration_s = 1e-4\nramp_s = 1e-5\nparts = [{ kind = \"traction\", stress_mpa = 1, edges = [\"top\", \"bottom\"] }, \
                 { kind = \"velocity\", velocity_mm_s = 1, edges = [\"right\"], from_s = 2e-5, ramp_s = 0 }, \
                 { kind = \"displacement\", displacement_mm = 1, edges = [\"left\"], from_s = 3e-5, ramp_s = 8e-5 }]";
    let scene = read(&format!("{PLATE}[loading]\n{parts}\n"), &[]).unwrap();
    let rises: Vec<LoadRamp> = scene.drives.iter().map(|drive| drive.rise).collect();
    let [common, sudden, late] = [(0.0, 1e-5), (2e-5, 0.0), (3e-5, 8e-5)].map(|(from, ramp)| LoadRamp { from, ramp });
    assert_eq!(rises, [common, common, sudden, late]);
    assert!(scene.warnings.iter().any(|line| line.contains("left") && line.contains("0.00011")), "{:?}", scene.warnings);
    let keys: Vec<&str> = scene.drives.iter().map(|drive| drive.key.as_str()).collect();
    assert_eq!(keys, ["loading.parts[0].edges", "loading.parts[0].edges", "loading.parts[1].edges", "loading.parts[2].edges"]);
    // One load has the keys of all.
    let text = STEPS.replace("steps = 50", "duration_s = 1e-5\nramp_s = 1e-6\nfrom_s = 2e-6");
    let scene = read(&format!("{PLATE}{text}"), &[]).unwrap();
    assert_eq!(scene.drives[0].rise, LoadRamp { from: 2e-6, ramp: 1e-6 });
    assert!(scene.warnings.is_empty());
}

/// Share, its slope and its integral agree, whatever start and length.
#[test]
fn a_rise_is_its_own_integral() {
    for rise in [LoadRamp { from: 0.0, ramp: 2.0 }, LoadRamp { from: 1.5, ramp: 2.0 }] {
        let (step, mut share, mut sum) = (1e-3, 0.0, 0.0);
        for i in 0..5000 {
            // Middles of steps: exact, since the corners lie between steps.
            let middle = (f64::from(i) + 0.5) * step;
            (share, sum) = (share + step * rise.slope(middle), sum + step * rise.share(middle));
            let end = middle + 0.5 * step;
            assert!((rise.share(end) - share).abs() < 1e-9, "{rise:?} at {end}: {} and {share}", rise.share(end));
            assert!((rise.sum(end) - sum).abs() < 1e-9, "{rise:?} at {end}: {} and {sum}", rise.sum(end));
        }
    }
    let sudden = LoadRamp { from: 1.5, ramp: 0.0 };
    assert_eq!([1.0, 1.5, 4.0].map(|time| sudden.share(time)), [0.0, 1.0, 1.0]);
    assert_eq!([1.0, 1.5, 4.0].map(|time| sudden.sum(time)), [0.0, 0.0, 2.5]);
    assert_eq!((LoadRamp::AT_ONCE.share(0.0), LoadRamp::AT_ONCE.sum(3.0), LoadRamp::AT_ONCE.slope(0.0)), (1.0, 3.0, 0.0));
}

/// Tractions stand on the plate in Pa, on the part of the side that is asked for.
#[test]
fn tractions_stand_on_the_plate() {
    let text =
        format!("{PLATE}[loading]\nkind = \"traction\"\nstress_mpa = 3\nedges = [\"top\", \"bottom\"]\nrange_mm = [-5, 10]");
    let scene = read(&text, &[]).unwrap();
    assert_eq!(scene.specimen.loads.len(), 2);
    for load in &scene.specimen.loads {
        let perilife_plate::specimen::Load::Edge { from, to, traction } = load else { panic!("{load:?}") };
        assert!((distance(*from, *to) - 15e-3).abs() < 1e-12);
        assert_eq!(traction[1].abs(), 3e6);
    }
    assert!(scene.specimen.supports.is_empty(), "balanced loads float");
    assert_eq!(scene.drives[0].region, Region::Edge { edge: Edge::Top, depth: 0.0, range: [-5e-3, 10e-3] });
    // What a support takes up need not balance.
    let text = text.replace("[\"top\", \"bottom\"]", "[\"top\"]") + "\n[supports]\nbottom = { rows_mm = 1.5, fix = [\"y\"] }";
    assert_eq!(read(&text, &[]).unwrap().specimen.supports, [Support::Elsewhere]);
}

#[test]
fn standard_specimens_lend_their_geometry() {
    let text = format!(
        "[specimen]\nkind = \"compact_tension\"\nwidth_mm = 50\nthickness_mm = 5\ncrack_length_mm = 20\n[material]\nname = \"q345\"\n{STEPS}"
    );
    let scene = read(&text, &[]).unwrap();
    assert!(scene.specimen.loads.is_empty() && scene.specimen.tips.len() == 1);
}

/// A plate without flaws may be torn, but not aged.
#[test]
fn a_scene_needs_no_crack() {
    let text = format!("{PLATE}{STEPS}").replace("cracks = [{ from_mm = [-20, 0], to_mm = [0, 0] }]\n", "");
    let scene = read(&text, &[]).unwrap();
    assert!(scene.specimen.tips.is_empty());
    assert!((scene.model.spacing - 0.4e-3).abs() < 1e-12);
    let fatigue = text.replace(STEPS, "[loading]\nstress_max_mpa = 1\nstress_ratio = 0\n[fatigue]\na = 1\np = 2\nhorizon_mm = 3");
    let refused = Case::from_toml(&fatigue, "case", Path::new(""), &[]);
    assert_refusal(refused, &["specimen.cracks", "nothing can grow without a crack or a notch"]);
}

/// A disc is round, counter-clockwise and its own mirror image to the last bit.
#[test]
fn a_diameter_gives_a_disc() {
    let outline = "width_mm = 40\nlength_mm = 20\n";
    let text = format!("{PLATE}{STEPS}").replace(outline, "diameter_mm = 25.4\n").replace("[-20, 0], to_mm", "[-5, 0], to_mm");
    let disc = read(&text, &[]).unwrap().specimen;
    assert_eq!(disc.outline.len(), 360);
    let whole = std::f64::consts::PI * 12.7e-3_f64.powi(2);
    let area = polygon_area(&disc.outline);
    assert!(area < whole && area > whole * (1.0 - 1e-4), "{area}");
    assert!(disc.outline.iter().all(|p| (distance(*p, [0.0, 0.0]) - 12.7e-3).abs() < 1e-15));
    let bits = |p: [f64; 2]| p.map(|x| (x + 0.0).to_bits());
    let all: std::collections::HashSet<[u64; 2]> = disc.outline.iter().map(|p| bits(*p)).collect();
    for &[x, y] in &disc.outline {
        assert!([[-x, y], [x, -y], [y, x]].iter().all(|image| all.contains(&bits(*image))));
    }
    for edge in Edge::ALL {
        assert_eq!(edge.stretches(&disc).len(), 1, "{edge}");
    }
}

#[test]
fn supports_hold_sides_parts_of_sides_and_boxes() {
    let text = format!(
        "{PLATE}{}[supports]\nbottom = {{ rows_mm = 1.5, fix = [\"x\", \"y\"] }}\nleft = {{ range_mm = [-8, -4], fix = [\"x\"] }}\n\
         pin = {{ from_mm = [5, 5], to_mm = [6, 4], fix = [\"y\"] }}",
        STEPS.replace("\"top\", \"bottom\"", "\"top\"")
    );
    let holds = read(&text, &[]).unwrap().holds;
    let regions: Vec<Region> = holds.iter().map(|hold| hold.region.clone()).collect();
    assert_eq!(regions[0], Region::Edge { edge: Edge::Bottom, depth: 1.5e-3, range: [f64::NEG_INFINITY, f64::INFINITY] });
    assert_eq!(regions[1], Region::Edge { edge: Edge::Left, depth: 0.0, range: [-8e-3, -4e-3] });
    assert_eq!(regions[2], Region::Box { low: [5e-3, 4e-3], high: [6e-3, 5e-3] });
    assert_eq!(holds.iter().map(|hold| hold.components).collect::<Vec<_>>(), [[true, true], [true, false], [false, true]]);
}

/// Stretches of the nonlinear law follow from the strengths; a bond breaks with hardly any force left.
#[test]
fn softening_follows_from_the_strengths() {
    let strengths =
        ["damage.law=nonlinear_two_parameter", "material.yield_strength_mpa=345", "material.tensile_strength_mpa=572"];
    let set = [&strengths[..], &["material.youngs_modulus_gpa=203"]].concat();
    let law = steps(&set).damage.nonlinear.unwrap();
    // Theory of the law: s_et = f_y / E = 1.700e-3, s_nt = f_t / E = 2.818e-3, and 1.2 % of the stiffness left at 5 s_nt.
    assert!((law.elastic - 1.700e-3).abs() < 1e-6 && (law.peak - 2.818e-3).abs() < 1e-6 && !law.printed);
    assert!((law.last - 5.0 * law.peak).abs() < 1e-12);
    assert!((law.share(law.last) - 0.0123).abs() < 1e-4, "{}", law.share(law.last));
    let own = "damage.law=nonlinear_two_parameter damage.elastic_stretch=0.001 damage.peak_stretch=0.002 damage.final_ratio=2 \
               damage.printed_law=true";
    let set: Vec<&str> = strengths[1..].iter().copied().chain(own.split_whitespace()).collect();
    let law = steps(&set).damage.nonlinear.unwrap();
    assert_eq!((law.elastic, law.peak, law.last, law.printed), (0.001, 0.002, 0.004, true));
}

#[test]
fn refined_regions_are_read() {
    let text = format!(
        "{PLATE}{STEPS}[model]\ndiscretisation = \"dual_horizon\"\n[refinement]\nregions = [{{ box_mm = [[5, 5], [-5, -5]], levels = 1 }}, \
         {{ band_mm = [[-10, 0], [10, 5]], width_mm = 4, levels = 2 }}, {{ around_flaws_mm = 3, levels = 2 }}]"
    );
    let regions = read(&text, &[]).unwrap().refinement.unwrap().regions;
    assert_eq!(regions[0], (RefinedRegion::Box { low: [-5e-3, -5e-3], high: [5e-3, 5e-3] }, 1));
    assert_eq!(regions[1], (RefinedRegion::Band { from: [-10e-3, 0.0], to: [10e-3, 5e-3], width: 4e-3 }, 2));
    assert_eq!(regions[2], (RefinedRegion::AroundFlaws { distance: 3e-3 }, 2));
}

/// What is looked at before a run is what the lattice has: 40 mm x 20 mm at 0.5 mm.
#[test]
fn a_preview_counts_points_and_loaded_points() {
    let scene = steps(&["model.spacing_mm=0.5", "loading.grip_mm=1"]);
    let preview = preview(&scene).unwrap();
    assert_eq!((preview.points, preview.loaded), (3200, vec![160, 160]));
    assert!(preview.cut > 0 && preview.horizons == [3.015 * 0.5e-3; 2] && preview.spacings == [0.5e-3; 2]);
}

/// Steps that do not come to rest belong to relaxation.
#[test]
fn iterations_of_a_step_are_read() {
    let scene = steps(&["loading.iterations_per_step=2"]);
    assert_eq!(scene.procedure, Procedure::QuasiStatic { steps: 50, iterations: Some(2) });
    assert_eq!(scene.model.solver, SceneSolver::AdaptiveDynamicRelaxation);
    let refusal = |overrides: &[&str], words: &str| {
        assert_refusal(read(&format!("{PLATE}{STEPS}"), overrides), &[words]);
    };
    refusal(&["loading.iterations_per_step=0"], "loading.iterations_per_step");
    refusal(&["loading.iterations_per_step=1", "model.solver=secant"], "model.solver");
    refusal(&["loading.iterations_per_step=1", "loading.kind=platens"], "platens");
    refusal(&["loading.iterations_per_step=1", "model.bond_law=correspondence"], "correspondence");
}

#[test]
fn scenes_and_cases_are_told_apart() {
    let is = |text: &str| is_scene(&Document::parse(text, "any", Path::new(""), &[]).unwrap().table);
    assert!(is(&format!("{PLATE}{STEPS}")));
    assert!(is("[damage]\n") && is("[loading]\nparts = []\n") && is("[micro_cracks]\nseed = 1"));
    assert!(!is("[loading]\nkind = \"constant_amplitude\"\n") && !is("[loading]\nkind = \"bogus\"\n") && !is("loading = 3"));
}

/// The example in the documentation of the reader can be read, and holds what it shows.
#[test]
fn the_documented_scene_is_right() {
    let source = include_str!("../../src/scenes/read/mod.rs");
    let example: Vec<&str> =
        source.lines().skip_while(|line| *line != "//! ```toml").skip(1).take_while(|line| *line != "//! ```").collect();
    let text: String = example.iter().map(|line| format!("{}\n", line.trim_start_matches("//! "))).collect();
    let scene = read(&text, &[]).unwrap();
    assert_eq!((scene.drives.len(), scene.holds.len(), scene.specimen.cracks.len()), (2, 1, 61));
}
