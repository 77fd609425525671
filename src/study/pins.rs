//! Pins that touch their holes where elasticity says: contact by Persson, contact and K of compact specimens by finite elements.

use std::f64::consts::PI;

use super::cases::{NODES, case, plate_alone};
use super::table::Table;
use perilife_base::error::{Error, Result};
use perilife_base::units::MPA_SQRT_M;
use perilife_growth::case::Case;
use perilife_growth::cracks::initial_tips;
use perilife_growth::nodes::NodePlate;
use perilife_plate::specimen::pin::Contact;
use perilife_plate::specimen::{Bearing, Load};

/// Material and law of all plates.
const REST: &str = "[material]\nyoungs_modulus_gpa = 70\npoisson_ratio = 0.3\nplane = \"stress\"\n\
                    [fatigue]\nparis_c_mm_per_cycle = 1e-8\nparis_m = 3\n";
/// Where K under contact comes from.
const ELEMENTS: &str = "finite elements with contact (tests/reference/pin_contact.py)";
/// By how much an end of contact may be off, degrees: nodes are a third of a radius apart, sides of the elements 1.4° long.
const OFF: f64 = 3.0;

/// All rows of the topic.
pub fn rows(table: &mut Table) -> Result<()> {
    persson(table)?;
    compact(table)?;
    lugs(table)
}

/// The contact of the pin that a load is, once it was sought.
fn contact(case: &Case, load: usize) -> Result<&Contact> {
    let found = match &case.specimen.loads[load] {
        Load::Pin { contact: Bearing::Elastic(pin), .. } => pin.found.as_deref(),
        _ => None,
    };
    found.ok_or_else(|| Error::Mechanics(format!("{}: no pin in contact", case.name)))
}

/// K_I of the first tip at the start, MPa√m.
fn k_i(case: &Case) -> Result<f64> {
    Ok(initial_tips::<NodePlate>(case)?.tips[0].factors.map_or(f64::NAN, |factors| factors[0]) / MPA_SQRT_M)
}

/// A row on an end of contact, both in degrees.
fn end(table: &mut Table, name: String, found: f64, wanted: f64, source: &str) {
    table.error(format!("{name} {wanted}°, % of {OFF}°"), 100.0 * (found - wanted) / OFF, 100.0, source);
}

/// Half angles ε of a pin in a hole of a large plate of the same material: with b = tan(ε/2) it is
/// `E' ΔR/Q = (2 - ln(b² + 1) - 2b⁴) / (π b² (b² + 1))`, Q the force over the thickness. Hertz has its first term; without clearance ε is 84.8°.
fn persson(table: &mut Table) -> Result<()> {
    const SOURCE: &str = "Persson 1964; Ciavarella and Decuzzi 2001, IJSS 38:4507, large plate";
    let (radius, force) = (10.0, 1000.0);
    for half_angle in [15.0_f64, 35.0, 60.0, 78.0] {
        let b = (0.5 * half_angle.to_radians()).tan();
        let clearance = (2.0 - (b * b + 1.0).ln() - 2.0 * b.powi(4)) / (PI * b * b * (b * b + 1.0)) * force / 70e3;
        let text = format!(
            "[specimen]\nkind = \"plate\"\nwidth_mm = 800\nlength_mm = 800\nthickness_mm = 1\nholes = [{{ x_mm = 0, y_mm = 0, \
             diameter_mm = {} }}]\n[supports]\nbottom = {{ fix = [\"x\", \"y\"] }}\n[loading]\nforce_max_n = {force}\nstress_ratio = 0\n\
             pins = [{{ hole = 0, direction = [0.6, 0.8], pin_diameter_mm = {}, pin_youngs_modulus_gpa = 70 }}]\n{REST}",
            2.0 * radius,
            2.0 * (radius - clearance),
        );
        let case = plate_alone(&text, &[NODES.to_owned()])?;
        let ends = contact(&case, 0)?.ends.map(f64::to_degrees);
        for (side, found) in [("right", -ends[0]), ("left", ends[1])] {
            end(
                table,
                format!("pin in a large plate, clearance {:.2} %: half angle at the {side},", 100.0 * clearance / radius),
                found,
                half_angle,
                SOURCE,
            );
        }
    }
    Ok(())
}

/// C(T) of 50 x 10 mm under 10 kN, E 70 and 210 GPa: crack length in mm, radius of the pin over that of the hole, K in MPa√m, ends of
/// contact at the upper hole in degrees from its direction, towards the tip and towards the mouth of the crack. Pins of E647 have 0.96.
fn compact(table: &mut Table) -> Result<()> {
    let compact = |crack: f64, share: f64| {
        let text = format!(
            "[specimen]\nkind = \"compact_tension\"\nwidth_mm = 50\nthickness_mm = 10\ncrack_length_mm = {crack}\npin_diameter_mm = {}\n\
             [loading]\nforce_max_kn = 10\nstress_ratio = 0\n{REST}",
            12.5 * share
        );
        case(&text, NODES)
    };
    for (crack, share, right, ends) in [
        (20.0, 0.96, 32.480, [-17.2, 18.4]),
        (10.0, 0.96, 19.154, [-17.2, 18.4]),
        (10.0, 1.0, 19.884, [-69.3, 127.9]),
        (10.0, 0.998, 19.690, [-56.4, 99.3]),
    ] {
        let case = compact(crack, share)?;
        let name = format!("C(T) a/W {}, pin {share} of the hole", crack / 50.0);
        table.compare(format!("{name}: K_I on nodes, MPa√m"), k_i(&case)?, right, 0.5, ELEMENTS);
        let found = contact(&case, 0)?.ends.map(f64::to_degrees);
        for (side, (found, wanted)) in ["tip", "mouth"].into_iter().zip(found.into_iter().zip(ends)) {
            end(table, format!("{name}: end of contact towards the {side}"), found, wanted, ELEMENTS);
        }
    }
    for (crack, right) in [(20.0, 32.552), (10.0, 19.113)] {
        let name = format!("C(T) a/W {}, pin 0.96 of the hole: K_I on nodes, MPa√m", crack / 50.0);
        table.compare(name, k_i(&compact(crack, 0.96)?)?, right, 0.5, "ASTM E647 (0.5 %)");
    }
    Ok(())
}

/// A lug of 50 x 5 mm with a round head and a hole of 20 mm, E 70 and 210 GPa, 10 kN, a crack at its right: diameter of the pin and length of the
/// crack in mm, K_I in MPa√m. The pin bears on the rim right up to the mouth of the crack.
fn lugs(table: &mut Table) -> Result<()> {
    for (diameter, crack, right) in [
        (19.95, 3.0, 14.390),
        (19.95, 7.5, 15.951),
        (19.95, 12.0, 21.075),
        (20.0, 3.0, 11.753),
        (20.0, 7.5, 14.306),
        (20.0, 12.0, 20.458),
    ] {
        let text = format!(
            "[specimen]\nkind = \"lug\"\nhead = \"round\"\nwidth_mm = 50\nlength_mm = 100\nthickness_mm = 5\nhole_diameter_mm = 20\n\
             crack_length_mm = {crack}\npin_diameter_mm = {diameter}\n\
             [loading]\nforce_max_kn = 10\nstress_ratio = 0\n{REST}"
        );
        let name = format!("lug, pin of {diameter} in 20 mm, crack of {crack} mm");
        table.compare(format!("{name}: K_I on nodes, MPa√m"), k_i(&case(&text, NODES)?)?, right, 0.5, ELEMENTS);
    }
    Ok(())
}
