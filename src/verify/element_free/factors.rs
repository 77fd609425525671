//! K and stress of tips at a finer choice, in bending, near other tips and rims.

use std::f64::consts::PI;

use crate::case::Case;
use crate::element_free::basis::{BasisKind, Enrichment};
use crate::element_free::field::{Discretisation, Local};
use crate::element_free::solve::solve;
use crate::error::{Error, Result};
use crate::growth::element_free::{initial_cracks, initial_tips};
use crate::units::MM;
use crate::verify::collinear::Collinear;
use crate::verify::scene::{case, pulled_plate};
use crate::verify::standard::{ELEMENTS_OF_K, standard_specimens};
use crate::verify::table::Table;
use crate::williams::Elasticity;

use super::{METHOD, STRESS};

/// All rows.
pub fn rows(table: &mut Table) -> Result<()> {
    standard(table)?;
    bending(table)?;
    ahead_of_a_tip(table)?;
    collinear(table)?;
    near_holes(table)
}

/// K_I of a tip, Pa√m.
fn k_i(case: &Case, tip: usize) -> Result<f64> {
    Ok(initial_tips(case)?.get(tip).and_then(|tip| tip.factors).map_or(f64::NAN, |factors| factors[0]))
}

/// The standard specimens at the choice for one percent of life.
fn standard(table: &mut Table) -> Result<()> {
    for specimen in standard_specimens() {
        for [a, wanted] in specimen.factors_of_elements()?.into_iter().step_by(3) {
            let found = specimen.at(a, &[METHOD, "model.tolerance_percent=1"])?;
            let quantity = format!("{}, a {a} mm, nodes, tolerance 1 %: K_I in MPa√m", specimen.name);
            table.compare(quantity, k_i(&found, 0)? / 1e6, wanted / 1e6, 0.15, ELEMENTS_OF_K);
        }
    }
    Ok(())
}

/// Three-point bending, S/W = 4.
fn bending(table: &mut Table) -> Result<()> {
    const SOURCE: &str = "finite elements (tests/reference/README.md: 0.9964, 0.9990, 0.9969 of Brown and Srawley 1966)";
    for (share, elements) in [(0.2_f64, 0.9964), (0.4, 0.9990), (0.5, 0.9969)] {
        let tip = 40.0 * share - 20.0;
        let text = format!(
            "[specimen]\nkind = \"plate\"\nthickness_mm = 10\nwidth_mm = 340\nlength_mm = 40\ncracks = [{{ from_mm = [0, -20], to_mm = [0, {tip}] }}]\n\
             [material]\nyoungs_modulus_gpa = 70\npoisson_ratio = 0.3\nplane = \"stress\"\n\
             [loading]\nforce_max_n = 4000\nstress_ratio = 0.1\nrollers = [{{ at_mm = [0, 20], contact_width_mm = 0.2 }}, \
             {{ at_mm = [-80, -20], contact_width_mm = 0.2, share = 0.5 }}, {{ at_mm = [80, -20], contact_width_mm = 0.2, share = 0.5 }}]\n\
             [fatigue]\nparis_c_mm_per_cycle = 1e-8\nparis_m = 3\n"
        );
        // 3 F S/(2 B W²) of the force.
        let stress = 1.5 * 4000.0 * 0.160 / (0.010 * 0.040 * 0.040);
        let form = 1.090 - 1.735 * share + 8.20 * share.powi(2) - 14.18 * share.powi(3) + 14.57 * share.powi(4);
        let wanted = elements * form * stress * (PI * 40.0 * share * MM).sqrt();
        let found = k_i(&case(&text, &[METHOD])?, 0)?;
        table.compare(format!("three-point bending a/W {share}, nodes: K_I in MPa√m"), found / 1e6, wanted / 1e6, 0.3, SOURCE);
    }
    Ok(())
}

/// Rms error of the stress ahead of an edge crack by three bases on the same nodes, against that of linear polynomials.
fn ahead_of_a_tip(table: &mut Table) -> Result<()> {
    const SOURCE: &str = "K/√(2πr) times 1.005, 1.015, 1.074 at 0.1, 1, 5 mm (quarter-point elements), F 1.488";
    let text = pulled_plate("width_mm = 50\nlength_mm = 50\ncracks = [{ from_mm = [-25, 0], to_mm = [-15, 0] }]");
    let case = case(&text, &[METHOD])?;
    let k = 1.488 * STRESS * (PI * 10.0 * MM).sqrt();
    let error = |basis: BasisKind, enrichment: Enrichment, support: f64| -> Result<f64> {
        let (lines, tips) = initial_cracks(&case.specimen);
        let mut resolution = case.model.element_free.resolution;
        (resolution.far, resolution.basis, resolution.enrichment, resolution.support) = (2.5 * MM, basis, enrichment, support);
        let plate = Discretisation::new(&case.specimen, Elasticity::of(&case.material), &lines, &tips, &resolution)?;
        let solution = solve(&case.specimen, &plate, resolution.far, STRESS)?;
        let mut sum = 0.0;
        for (r, share) in [(0.1 * MM, 1.005), (1.0 * MM, 1.015), (5.0 * MM, 1.074)] {
            let known = plate.displacement(&solution.u, [-15.0 * MM + r, 0.0], &mut Local::default());
            let (_, gradient) = known.ok_or_else(|| Error::Mechanics("no node is in reach ahead of the tip".to_owned()))?;
            let [_, stress, _] = plate.elasticity().stress(&gradient);
            sum += (stress * (2.0 * PI * r).sqrt() / k / share - 1.0).powi(2) / 3.0;
        }
        Ok(100.0 * f64::sqrt(sum))
    };
    let linear = error(BasisKind::Linear, Enrichment::None, 2.5)?;
    for (name, enrichment, support) in
        [("fields as unknowns", Enrichment::Tip, 2.5), ("enriched basis", Enrichment::Intrinsic, 3.0)]
    {
        let enriched = error(BasisKind::Linear, enrichment, support)?;
        let quantity = format!("stress ahead of an edge crack, nodes, {name}: rms error, percent");
        table.error(quantity, enriched, 3.0, SOURCE);
        let quantity = format!("the same over a fifth of that of the linear basis ({linear:.1} %), percent");
        table.error(quantity, 100.0 * enriched / (0.2 * linear), 100.0, "at equal nodes; a fifth is asked for");
    }
    Ok(())
}

/// Two cracks on one line, the ligament between them down to a fifth of their length.
fn collinear(table: &mut Table) -> Result<()> {
    const SOURCE: &str = "two collinear cracks, closed form (Tada, Paris and Irwin 2000), finite width by the secant (0.1 %)";
    for (c, d) in [(1.0, 3.0), (0.5, 2.5), (0.2, 2.2)] {
        let cracks =
            format!("cracks = [{{ from_mm = [-{d}, 0], to_mm = [-{c}, 0] }}, {{ from_mm = [{c}, 0], to_mm = [{d}, 0] }}]");
        let case = case(&pulled_plate(&format!("width_mm = 100\nlength_mm = 150\n{cracks}")), &[METHOD])?;
        let wanted = Collinear { inner: c * MM, outer: d * MM }.intensity_in(100.0 * MM).map(|k| k * STRESS / 1e6);
        for (name, tip, wanted) in [("inner", 1, wanted[0]), ("outer", 0, wanted[1])] {
            let quantity = format!("two collinear cracks from {c} to {d} mm, {name} tip, nodes: K_I in MPa√m");
            table.compare(quantity, k_i(&case, tip)? / 1e6, wanted, 0.5, SOURCE);
        }
    }
    Ok(())
}

/// Tips within a radius of a hole, at the default choice against finer nodes with another basis.
fn near_holes(table: &mut Table) -> Result<()> {
    const SOURCE: &str = "own nodes of half the spacing, hold 6, enriched basis: self-convergence, no independent reference";
    const HOLE: &str = "holes = [{ x_mm = 10, y_mm = 0, diameter_mm = 12 }]\n";
    for (name, tip, keys) in [
        ("edge crack 3 mm ahead of a hole", 0, "cracks = [{ from_mm = [-50, 0], to_mm = [1, 0] }]"),
        ("crack with a tip 3.2 mm beside a hole", 1, "cracks = [{ from_mm = [-8, -9], to_mm = [12, -9] }]"),
        ("crack of 3 mm at a hole", 0, "cracks = [{ from_mm = [16, 0], to_mm = [19, 0] }]"),
    ] {
        let mut case = case(&pulled_plate(&format!("width_mm = 100\nlength_mm = 200\n{HOLE}{keys}")), &[METHOD])?;
        let found = k_i(&case, tip)?;
        let resolution = &mut case.model.element_free.resolution;
        (resolution.far, resolution.hold, resolution.in_radius) = (0.5 * resolution.far, 6.0, 2.0 * resolution.in_radius);
        (resolution.enrichment, resolution.support) = (Enrichment::Intrinsic, 3.0);
        let finer = k_i(&case, tip)?;
        table.compare(format!("{name}, nodes: K_I in MPa√m"), found / 1e6, finer / 1e6, 0.5, SOURCE);
    }
    Ok(())
}
