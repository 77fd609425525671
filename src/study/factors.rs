//! Stress intensity factors of every method against handbooks, closed forms and finite elements.

use std::f64::consts::PI;

use super::cases::{MATERIAL_AND_LAW, NODES, STRESS, case, cracked_plate, cracks, pulled_plate, slanted};
use super::collinear::Collinear;
use super::scene::{Scene, factors};
use super::standard::STANDARD;
use super::table::Table;
use perilife_base::error::Result;
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_growth::case::{Case, Model};
use perilife_growth::predict::tip_factors::{StressIntensityMethod, stress_intensity};
use perilife_nodes::basis::Enrichment;
use perilife_plate::specimen::Point;

/// Material, load and model of scenes by `stress_intensity`; cracks are at least six horizons long.
const REST: &str = r#"
[material]
youngs_modulus_gpa = 72.0
poisson_ratio = 0.3
plane = "stress"
[loading]
stress_max_mpa = 100.0
stress_ratio = 0.1
[model]
spacing_mm = 1.5
[fatigue]
a = 6450.0
p = 2.86
horizon_mm = 3.015
"#;
const SPACING_MM: f64 = 1.5;
const MIDDLE: &str = "kind = \"middle_tension\"\nwidth_mm = 150\nlength_mm = 300\nthickness_mm = 2\ncrack_length_mm = 28";
const SINGLE: &str = "kind = \"single_edge_tension\"\nwidth_mm = 120\nlength_mm = 360\nthickness_mm = 2\ncrack_length_mm = 30\n\
                      ends = \"uniform_stress\"";
const DOUBLE: &str = "kind = \"double_edge_tension\"\nwidth_mm = 150\nlength_mm = 300\nthickness_mm = 2\ncrack_length_mm = 30";
const COMPACT: &str = "kind = \"compact_tension\"\nwidth_mm = 120\nthickness_mm = 5\ncrack_length_mm = 48";

const ALL: &[StressIntensityMethod] = StressIntensityMethod::ALL;
/// The method that tells the modes of a crack apart on points.
const RING: &[StressIntensityMethod] = &[StressIntensityMethod::Ring];

/// All rows of the topic.
pub fn all(table: &mut Table) -> Result<()> {
    handbooks(table)?;
    slanted_cracks(table)?;
    two_cracks(table)?;
    bending(table)?;
    on_nodes(table)?;
    near_holes(table)
}

fn scene(specimen: &str, keys: &str) -> Result<Case> {
    let force = specimen.contains("compact_tension");
    let rest = if force { REST.replace("stress_max_mpa = 100.0", "force_max_n = 10000.0") } else { REST.to_owned() };
    case(&format!("[specimen]\n{specimen}\n{rest}"), keys)
}

/// K_I of the standard specimens over their handbooks': by Poisson's ratio, bond law, plane state, spacing and surface correction. That
/// lives do not depend on Poisson's ratio is the topic `poissons_ratio`.
fn handbooks(table: &mut Table) -> Result<()> {
    const FINE: &str = "specimen.width_mm=152.4 specimen.crack_length_mm=18.2";
    const STATE_BASED: &str = "model.bond_law=state_based";
    for (name, specimen, keys, methods, bound) in [
        ("M(T) a/W 0.19, nu 0", MIDDLE, ["material.poisson_ratio=0", ""], ALL, 1.5),
        ("M(T) a/W 0.19, nu 0.3333", MIDDLE, ["material.poisson_ratio=0.3333", ""], ALL, 1.5),
        ("M(T) a/W 0.19, state_based, nu 0.4", MIDDLE, [STATE_BASED, "material.poisson_ratio=0.4"], RING, 1.5),
        ("M(T) a/W 0.19, state_based, plane strain", MIDDLE, [STATE_BASED, "material.plane=strain"], RING, 1.5),
        ("SE(T) a/W 0.25", SINGLE, [""; 2], ALL, 1.5),
        ("SE(T) a/W 0.25, pinned", SINGLE, ["specimen.ends=pinned", ""], ALL, 1.5),
        ("DE(T) 2a/W 0.4", DOUBLE, [""; 2], ALL, 1.5),
        // Its tip lies close to the holes, so that K depends on where the pins push.
        ("C(T) a/W 0.25", COMPACT, ["specimen.crack_length_mm=30", ""], ALL, 1.5),
        ("C(T) a/W 0.4", COMPACT, [""; 2], ALL, 1.5),
        ("M(T) a/W 0.12, spacing 3 mm", MIDDLE, [FINE, "model.spacing_mm=3"], RING, 0.3),
        ("M(T) a/W 0.12, spacing 1.5 mm", MIDDLE, [FINE, "model.spacing_mm=1.5"], RING, 0.3),
        ("M(T) a/W 0.12, spacing 0.75 mm", MIDDLE, [FINE, "model.spacing_mm=0.75"], RING, 0.3),
        ("M(T) a/W 0.19, volume_and_surface", MIDDLE, ["model.surface_correction=volume_and_surface", ""], RING, 1.2),
        ("M(T) a/W 0.19, no surface correction", MIDDLE, ["model.surface_correction=none", ""], RING, 2.5),
    ] {
        let source = match specimen {
            MIDDLE => "Feddersen 1966 (0.3 %)",
            DOUBLE => "Tada, Paris and Irwin 2000 (1 %)",
            COMPACT => "ASTM E647 (0.5 %)",
            _ => "Tada, Paris and Irwin 2000 (0.5 %)",
        };
        let tips = stress_intensity(&scene(specimen, &keys.join(" "))?, methods)?;
        let handbook = tips[0].handbook_k_i.unwrap_or(f64::NAN);
        for found in &tips[0].methods {
            // Pins that press over ±15° have K 0.2 % below the formula of C(T) by finite elements (tests/reference).
            let bound = match (found.method, specimen) {
                (StressIntensityMethod::ElementFreeGalerkin, COMPACT) => 0.5,
                (StressIntensityMethod::ElementFreeGalerkin, _) => 0.3,
                _ => bound,
            };
            let ratio = found.intensity.k_i.unwrap_or(f64::NAN) / handbook;
            table.compare(format!("{name}: K_I by {} over handbook", found.method), ratio, 1.0, bound, source);
        }
    }
    Ok(())
}

/// K_I and K_II of a tip of cracks in a wide plate over those of theory, unit σ√(πa) of a crack `half` spacings long on either side; the
/// cracks are given in half cracks, the plate is `width` of them wide. A reference of 0 is left out.
fn compare_tips(
    table: &mut Table,
    ends: &[[Point; 2]],
    (half, width): (f64, f64),
    methods: &[StressIntensityMethod],
    source: &str,
    known: &[(String, usize, [f64; 2])],
) -> Result<()> {
    let a = half * SPACING_MM;
    let ends: Vec<[Point; 2]> = ends.iter().map(|ends| ends.map(|end| end.map(|x| x * a))).collect();
    let size = format!("width_mm = {}\nlength_mm = {}", width * a, 1.5 * width * a);
    let tips = stress_intensity(&scene(&format!("kind = \"plate\"\nthickness_mm = 2\n{size}\n{}", cracks(&ends)), "")?, methods)?;
    let unit = 100e6 * (PI * a * MM).sqrt();
    for (name, tip, wanted) in known {
        for found in &tips[*tip].methods {
            let factors = [found.intensity.k_i, found.intensity.k_ii];
            for (mode, (factor, wanted)) in ["K_I", "K_II"].into_iter().zip(factors.into_iter().zip(*wanted)) {
                if wanted != 0.0 {
                    let quantity = format!("{name}: {mode} by {}, unit σ√(πa)", found.method);
                    table.compare(quantity, factor.unwrap_or(f64::NAN) / unit, wanted, 3.0, source);
                }
            }
        }
    }
    Ok(())
}

/// Slanted cracks in a wide plate: `K_I = σ √(π a) sin²β`, `K_II = σ √(π a) sin β cos β`, β to the load; on points and on nodes.
fn slanted_cracks(table: &mut Table) -> Result<()> {
    for beta in [60.0_f64, 45.0] {
        let (sin, cos) = beta.to_radians().sin_cos();
        let known = [(format!("crack {beta}° to the load, a 8 horizons"), 0, [sin * sin, sin * cos])];
        let source = "infinite plate (Tada, Paris and Irwin 2000); plate 20 a wide, 30 a long";
        compare_tips(table, &[[[-sin, -cos], [sin, cos]]], (24.0, 20.0), RING, source, &known)?;
    }
    let unit = STRESS * (PI * MM).sqrt();
    for beta in [15.0_f64, 30.0, 45.0, 60.0, 75.0] {
        let (sin, cos) = beta.to_radians().sin_cos();
        let found = factors(&case(&cracked_plate(80.0, 80.0, &[slanted(1.0, beta)]), NODES)?, 1)?.map(|factor| factor / unit);
        let wanted = [sin * sin, sin * cos];
        for (mode, (found, wanted)) in ["K_I", "K_II"].into_iter().zip([found[0], found[1].abs()].into_iter().zip(wanted)) {
            let quantity = format!("crack at {beta}° to the load, nodes: error of {mode} over |K|, percent");
            table.error(quantity, 100.0 * (found - wanted) / sin, 0.4, "infinite plate (0.05 %)");
        }
    }
    Ok(())
}

/// Two equal cracks on one line and two above each other, in wide plates.
fn two_cracks(table: &mut Table) -> Result<()> {
    // Inner tips a half crack from the middle (c = 0.5, d = 1.5 crack lengths).
    let source = "two collinear cracks, closed form with elliptic integrals (Tada, Paris and Irwin 2000)";
    let known = [("outer", 0, 1.0280), ("inner", 1, 1.0480)]
        .map(|(name, tip, wanted)| (format!("two collinear cracks, {name} tip"), tip, [wanted, 0.0]));
    compare_tips(table, &[[[-3.0, 0.0], [-1.0, 0.0]], [[1.0, 0.0], [3.0, 0.0]]], (18.0, 24.0), ALL, source, &known)?;
    // Distance over crack length, K_I and size of K_II.
    for (distance, k_i, k_ii) in [(0.5, 0.773, 0.117), (1.0, 0.843, 0.061)] {
        let ends = [-distance, distance].map(|y| [[-1.0, y], [1.0, y]]);
        // The right tip of the lower crack slides in the positive sense.
        let known = [(format!("two stacked cracks, distance {distance} of their length"), 1, [k_i, k_ii])];
        let source = "integral equation of two stacked cracks in an infinite plate, three digits";
        compare_tips(table, &ends, (18.0, 20.0), RING, source, &known)?;
    }
    for (c, d) in [(1.0, 3.0), (0.5, 2.5), (0.2, 2.2)] {
        let text = cracked_plate(100.0, 150.0, &[[[-d, 0.0], [-c, 0.0]], [[c, 0.0], [d, 0.0]]]);
        let known = Collinear { inner: c * MM, outer: d * MM }.intensity_in(100.0 * MM).map(|k| k * STRESS / MPA_SQRT_M);
        for (name, tip, known) in [("inner", 1, known[0]), ("outer", 0, known[1])] {
            let quantity = format!("two collinear cracks from {c} to {d} mm, {name} tip, nodes: K_I in MPa√m");
            let truth = "two collinear cracks, closed form (Tada, Paris and Irwin 2000), finite width by the secant (0.1 %)";
            let scene = Scene::Tip { text: text.clone(), tip, known, unit: MPA_SQRT_M, truth };
            table.judge(quantity, &scene, NODES, 0.5)?;
        }
    }
    Ok(())
}

/// Single-edge bend specimens between rollers, span 4 W.
fn bending(table: &mut Table) -> Result<()> {
    let bent = |[width, length, half_span]: [f64; 3], a: f64, force: f64, contacts: [f64; 2]| {
        let (below, above) = (-0.5 * length, 0.5 * length);
        format!(
            "[specimen]\nkind = \"plate\"\nthickness_mm = 10\nwidth_mm = {width}\nlength_mm = {length}\n{}\n\
             [loading]\nforce_max_n = {force}\nstress_ratio = 0\nrollers = [{{ at_mm = [0, {above}], contact_width_mm = {} }}, \
             {{ at_mm = [-{half_span}, {below}], contact_width_mm = {}, share = 0.5 }}, \
             {{ at_mm = [{half_span}, {below}], contact_width_mm = {}, share = 0.5 }}]\n{MATERIAL_AND_LAW}",
            cracks(&[[[0.0, below], [0.0, a + below]]]),
            contacts[0],
            contacts[1],
            contacts[1]
        )
    };
    for x in [0.3_f64, 0.5] {
        let f = 3.0 * x.sqrt() * (1.99 - x * (1.0 - x) * (2.15 - 3.93 * x + 2.7 * x * x))
            / (2.0 * (1.0 + 2.0 * x) * (1.0 - x).powf(1.5));
        let known = 8e3 * 0.2 / (0.01 * 0.05_f64.powf(1.5)) * f / MPA_SQRT_M;
        let text = bent([220.0, 50.0, 100.0], 50.0 * x, 8e3, [0.5, 2.0]);
        let scene = Scene::Tip { text, tip: 0, known, unit: MPA_SQRT_M, truth: "ASTM E399, 0.5 %" };
        table.judge(format!("bend specimen between rollers, a/W = {x}: K, MPa√m"), &scene, "model.spacing_mm=0.5", 1.0)?;
    }
    for (share, elements) in [(0.2_f64, 0.9964), (0.4, 0.9990), (0.5, 0.9969)] {
        // 3 F S/(2 B W²) of the force.
        let stress = 1.5 * 4000.0 * 0.160 / (0.010 * 0.040 * 0.040);
        let form = 1.090 - 1.735 * share + 8.20 * share.powi(2) - 14.18 * share.powi(3) + 14.57 * share.powi(4);
        let known = elements * form * stress * (PI * 40.0 * share * MM).sqrt() / MPA_SQRT_M;
        let truth = "finite elements (tests/reference/README.md: 0.9964, 0.9990, 0.9969 of Brown and Srawley 1966)";
        let text = bent([340.0, 40.0, 80.0], 40.0 * share, 4e3, [0.2, 0.2]);
        let scene = Scene::Tip { text, tip: 0, known, unit: MPA_SQRT_M, truth };
        table.judge(format!("three-point bending a/W {share}, nodes: K_I in MPa√m"), &scene, NODES, 0.3)?;
    }
    Ok(())
}

/// Standard specimens at the choice for half a percent of life, and edge cracks in a square and in a long plate, on nodes.
fn on_nodes(table: &mut Table) -> Result<()> {
    for specimen in STANDARD {
        for [a, known] in specimen.factors_of_elements()?.into_iter().step_by(3) {
            let quantity = format!("{}, a {a} mm, nodes, tolerance 0.5 %: K_I in MPa√m", specimen.name);
            let truth = "finite elements (tests/reference, standard_specimens.csv), 0.05 %";
            let scene = Scene::Tip { text: specimen.text(), tip: 0, known: known / MPA_SQRT_M, unit: MPA_SQRT_M, truth };
            let at = format!("specimen.crack_length_mm={a} stop.crack_length_mm={}", 1.001 * a);
            table.judge(quantity, &scene, &format!("{NODES} model.tolerance_percent=0.5 {at}"), 0.15)?;
        }
    }
    for (share, height, known) in [(0.2, 50.0, 1.4869), (0.2, 200.0, 1.3673), (0.5, 50.0, 3.0087), (0.5, 200.0, 2.8246)] {
        let a = 50.0 * share;
        let unit = STRESS * (PI * a * MM).sqrt();
        let text = cracked_plate(50.0, height, &[[[-25.0, 0.0], [a - 25.0, 0.0]]]);
        let scene = Scene::Tip { text, tip: 0, known, unit, truth: "finite elements (tests/reference/edge_cracks.py), 0.005 %" };
        table.judge(format!("edge crack a/W {share}, height {height} mm, nodes: F"), &scene, NODES, 0.3)?;
    }
    Ok(())
}

/// Tips within a radius of a hole, on nodes at the default choice against finer nodes with another basis.
fn near_holes(table: &mut Table) -> Result<()> {
    const SOURCE: &str = "own nodes of half the spacing, hold 6, enriched basis: self-convergence, no independent reference";
    for (name, tip, ends) in [
        ("edge crack 3 mm ahead of a hole", 0, [[-50.0, 0.0], [1.0, 0.0]]),
        ("crack with a tip 3.2 mm beside a hole", 1, [[-8.0, -9.0], [12.0, -9.0]]),
        ("crack of 3 mm at a hole", 0, [[16.0, 0.0], [19.0, 0.0]]),
    ] {
        let keys = "width_mm = 100\nlength_mm = 200\nholes = [{ x_mm = 10, y_mm = 0, diameter_mm = 12 }]";
        let mut case = case(&pulled_plate(&format!("{keys}\n{}", cracks(&[ends]))), NODES)?;
        let found = factors(&case, tip)?[0];
        let mut nodes = case.nodes();
        let resolution = &mut nodes.resolution;
        (resolution.far, resolution.hold, resolution.in_radius) = (0.5 * resolution.far, 6.0, 2.0 * resolution.in_radius);
        (resolution.enrichment, resolution.support) = (Enrichment::Intrinsic, 3.0);
        case.model = Model::Nodes(nodes);
        let finer = factors(&case, tip)?[0];
        table.compare(format!("{name}, nodes: K_I in MPa√m"), found / MPA_SQRT_M, finer / MPA_SQRT_M, 0.5, SOURCE);
    }
    Ok(())
}
