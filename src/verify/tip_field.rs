//! Cracks driven by the K of their tips: first kinks on turned lattices, lives of standard specimens against quadrature.

use std::f64::consts::PI;

use super::scene::case;
use super::table::Table;
use crate::error::Result;
use crate::growth::tip_field::steering::kink_angle;
use crate::predict::{Silent, predict};
use crate::quadrature::integrate;

const REST: &str = "
[material]
youngs_modulus_gpa = 70.0
poisson_ratio = 0.3
plane = \"stress\"
[fatigue]
paris_c_mm_per_cycle = 1e-8
paris_m = 3.0
[stop]
cycles_max = 1e14
";
const PULL: &str = "[loading]\nstress_max_mpa = 60\nstress_ratio = 0.1\n";

/// All rows of the topic.
///
/// # Errors
/// As [`predict`].
pub fn all(table: &mut Table) -> Result<()> {
    kinks(table)?;
    lives(table)?;
    variants(table)?;
    bending(table)
}

/// First kinks of a crack of half length 36 mm, six horizons, at β to the load in a plate 240 mm wide, whatever the lattice.
fn kinks(table: &mut Table) -> Result<()> {
    const BOUND_DEGREES: f64 = 1.5;
    for beta in [15.0_f64, 45.0, 75.0] {
        for lattice in [0.0, 10.0, 22.5, 37.0, 45.0] {
            let (sin, cos) = beta.to_radians().sin_cos();
            let [x, y] = [36.0 * sin, 36.0 * cos];
            let crack = format!("cracks = [{{ from_mm = [{}, {}], to_mm = [{x}, {y}] }}]", -x, -y);
            let text = format!(
                "[specimen]\nkind = \"plate\"\nwidth_mm = 240\nlength_mm = 240\nthickness_mm = 2\n{crack}\n{PULL}[model]\nspacing_mm = 2\n{REST}"
            );
            let case = case(&text, &[&format!("model.lattice_angle_deg={lattice}"), "stop.crack_length_mm=73"])?;
            let run = predict(&case, &Silent)?;
            let [a, b] = case.specimen.tips[1].direction;
            let [from, to] = [0, 1].map(|row: usize| run.curve[row].tips[1].position);
            let [u, v] = [0, 1].map(|i| to[i] - from[i]);
            let kink = (a * v - b * u).atan2(a * u + b * v).to_degrees();
            let theory = kink_angle([sin * sin, sin * cos]).to_degrees();
            table.compare(
                format!("crack at {beta}° to the load, lattice turned by {lattice}°: first kink of tip_field, degrees"),
                kink,
                theory,
                100.0 * BOUND_DEGREES / theory.abs(),
                "maximum circumferential stress (Erdogan and Sih 1963)",
            );
        }
    }
    Ok(())
}

/// Lives with given C and m against quadrature with handbook K, at default resolution; nothing is fitted.
fn lives(table: &mut Table) -> Result<()> {
    let specimens = [
        ("M(T)", format!("kind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 300\nthickness_mm = 2\ncrack_length_mm = 10\n{PULL}"), 38.0),
        (
            "C(T)",
            "kind = \"compact_tension\"\nwidth_mm = 50\nthickness_mm = 10\ncrack_length_mm = 15\n[loading]\nforce_max_n = 5000\nstress_ratio = 0.1\n"
                .to_owned(),
            35.0,
        ),
        (
            "SE(T)",
            format!("kind = \"single_edge_tension\"\nends = \"uniform_stress\"\nwidth_mm = 50\nlength_mm = 150\nthickness_mm = 2\ncrack_length_mm = 8\n{PULL}"),
            28.0,
        ),
        ("DE(T)", format!("kind = \"double_edge_tension\"\nwidth_mm = 100\nlength_mm = 300\nthickness_mm = 2\ncrack_length_mm = 12\n{PULL}"), 38.0),
    ];
    for (name, specimen, end) in specimens {
        for (m, nu, lattice) in
            [(2.0, 0.3, 0.0), (3.0, 0.3, 0.0), (4.5, 0.3, 0.0), (6.0, 0.3, 0.0), (3.0, 0.1, 0.0), (3.0, 0.3, 22.5)]
        {
            let end = format!("stop.crack_length_mm={end}");
            let set = [
                &*end,
                &format!("fatigue.paris_m={m}"),
                &format!("material.poisson_ratio={nu}"),
                &format!("model.lattice_angle_deg={lattice}"),
            ];
            let life = |more: &[&str]| -> Result<f64> {
                let case = case(&format!("[specimen]\n{specimen}{REST}"), &[&set[..], more].concat())?;
                Ok(predict(&case, &Silent)?.life_cycles())
            };
            let reference = life(&["model.method=handbook"])?;
            let (reference, source) = match name {
                "M(T)" => (reference * over_secant(m, [10.0, 38.0], 100.0), "Tada's factor of the secant, 0.1 %"),
                "DE(T)" => (reference, "Tada, Paris and Irwin 2000, 1 % of K"),
                "SE(T)" => (reference, "Tada, Paris and Irwin 2000, 0.5 % of K"),
                _ => (reference, "ASTM E647, 0.5 % of K"),
            };
            let what = format!("{name}, m {m}, nu {nu}, lattice {lattice}°: life of tip_field over quadrature with handbook K");
            table.compare(what, life(&[])?, reference, 1.0, source);
            table.known_miss(match name {
                "DE(T)" => "the formula for K is only good to 1 %, m times that in life",
                _ => "K of C(T) is read 0.3 % low against a formula that is good to 0.5 %, m times that in life",
            });
        }
    }
    Ok(())
}

/// The same panel by every law, kernel, ratio, spacing and plane state: m 3, a 20 to 32 mm.
fn variants(table: &mut Table) -> Result<()> {
    let specimen =
        format!("kind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 200\nthickness_mm = 2\ncrack_length_mm = 20\n{PULL}");
    let text = format!("[specimen]\n{specimen}{REST}");
    let strain = "material.plane=strain";
    let all: [(&str, &[&str]); 11] = [
        ("spacing 2 mm", &["model.spacing_mm=2"]),
        ("spacing 0.5 mm", &["model.spacing_mm=0.5"]),
        ("ratio 4.015", &["model.horizon_ratio=4.015"]),
        ("ratio 5.015", &["model.horizon_ratio=5.015"]),
        ("constant kernel", &["model.kernel=constant"]),
        ("bond_based", &["model.bond_law=bond_based", "material.poisson_ratio=0.3333333333"]),
        ("state_based, nu 0.2", &["model.bond_law=state_based", "material.poisson_ratio=0.2"]),
        ("nu 0.4", &["material.poisson_ratio=0.4"]),
        ("plane strain, nu 0.3", &[strain]),
        ("plane strain, nu 0.45", &[strain, "material.poisson_ratio=0.45"]),
        ("plane strain, nu 0.49", &[strain, "material.poisson_ratio=0.49"]),
    ];
    for (name, set) in all {
        let life = |more: &[&str]| -> Result<f64> {
            let set = [&["stop.crack_length_mm=32", "model.spacing_mm=1"], set, more].concat();
            Ok(predict(&case(&text, &set)?, &Silent)?.life_cycles())
        };
        let reference = life(&["model.method=handbook"])? * over_secant(3.0, [20.0, 32.0], 100.0);
        let what = format!("M(T), m 3, {name}: life of tip_field over quadrature with handbook K");
        table.compare(what, life(&[])?, reference, 1.0, "Tada's factor of the secant, 0.1 %");
        table.known_miss(
            "state-based points with `volume_and_surface` at the rims: K 0.4 % low; towards nu = 0.5 in plane strain the dilatation, of which \
             points have one value, stiffens the tip, and K is 3 to 6 % high at 0.49",
        );
    }
    Ok(())
}

/// K of single-edge bend specimens between rollers, span 4 W, at default resolution.
fn bending(table: &mut Table) -> Result<()> {
    // W 50 mm, B 10 mm, 8 kN: f(x) of ASTM E399, good to 0.5 %.
    let k = |x: f64| {
        let f = 3.0 * x.sqrt() * (1.99 - x * (1.0 - x) * (2.15 - 3.93 * x + 2.7 * x * x))
            / (2.0 * (1.0 + 2.0 * x) * (1.0 - x).powf(1.5));
        8e3 * 0.2 / (0.01 * 0.05_f64.powf(1.5)) * f / 1e6
    };
    for a in [15.0, 25.0] {
        let text = format!(
            "[specimen]\nkind = \"plate\"\nwidth_mm = 220\nlength_mm = 50\nthickness_mm = 10\n\
             cracks = [{{ from_mm = [0, -25], to_mm = [0, {}] }}]\n\
             [loading]\nforce_max_n = 8000\nstress_ratio = 0\n\
             rollers = [{{ at_mm = [0, 25], contact_width_mm = 0.5 }}, {{ at_mm = [-100, -25], contact_width_mm = 2, share = 0.5 }}, \
             {{ at_mm = [100, -25], contact_width_mm = 2, share = 0.5 }}]\n[model]\nspacing_mm = 0.5\n{REST}",
            a - 25.0
        );
        let case = case(&text, &[&format!("stop.crack_length_mm={}", a + 0.01)])?;
        let computed = predict(&case, &Silent)?.curve[0].delta_k / 1e6;
        let what = format!("bend specimen between rollers, a/W = {}: K of tip_field, MPa√m", a / 50.0);
        table.compare(what, computed, k(a / 50.0), 1.0, "ASTM E399, 0.5 %");
    }
    Ok(())
}

/// Life of middle tension by Tada's `K = σ√(πa) (1 - 0.025 x² + 0.06 x⁴) √sec(πx/2)`, x = 2a/W, good to 0.1 %, over that by the secant
/// alone, which lies up to 0.25 % above it; lengths in mm.
fn over_secant(m: f64, [from, to]: [f64; 2], width: f64) -> f64 {
    let secant = |a: f64| (a / (PI * a / width).cos()).sqrt();
    let tada = |a: f64| secant(a) * (1.0 - 0.1 * (a / width).powi(2) + 0.96 * (a / width).powi(4));
    let life = |factor: &dyn Fn(f64) -> f64| integrate(|a| factor(a).powf(-m), from, to, 1e-10).value;
    life(&tada) / life(&secant)
}
