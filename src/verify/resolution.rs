//! Does the answer depend on how the plate is divided into points?

use super::references::{Curve, REFERENCES};
use super::scene::{life, pulled_plate};
use super::standard::{ELEMENTS, standard_specimens};
use super::table::Table;
use crate::error::Result;
use crate::units::MM;

/// Spacings of W/50 to W/200 and horizons of three to six spacings, cracks of three horizons at the least.
pub fn spacing(table: &mut Table) -> Result<()> {
    let [panel, compact, ..] = standard_specimens();
    // W 100 mm, a 20 to 32 mm, and W 50 mm, from the load line.
    for (specimen, range, width) in [(panel, [20.0, 32.0], 100.0), (compact, [18.0, 26.0], 50.0)] {
        let specimen = specimen.from_to(range);
        let name = specimen.name;
        let mut row = |parts: f64, ratio: f64| -> Result<()> {
            let set = [format!("model.spacing_mm={}", width / parts), format!("model.horizon_ratio={ratio}")];
            let computed = specimen.over_quadrature(&[&set[0], &set[1]])?;
            table.compare(
                format!("{name}, m 3, spacing W/{parts}, ratio {ratio}: life over quadrature"),
                computed,
                1.0,
                1.0,
                ELEMENTS,
            );
            Ok(())
        };
        [50.0, 100.0, 200.0].into_iter().try_for_each(|parts| row(parts, 3.015))?;
        [4.015, 5.015, 6.015].into_iter().try_for_each(|ratio| row(100.0, ratio))?;
    }
    Ok(())
}

/// Lives and paths on turned lattices.
pub fn orientation(table: &mut Table) -> Result<()> {
    for specimen in standard_specimens() {
        for lattice in [10.0, 22.5, 37.0, 45.0] {
            let ratio = specimen.over_quadrature(&[&format!("model.lattice_angle_deg={lattice}")])?;
            let what = format!("{}, m 3, lattice turned by {lattice}°: life over quadrature", specimen.name);
            table.compare(what, ratio, 1.0, 1.0, ELEMENTS);
        }
    }
    for reference in REFERENCES.iter().filter(|reference| ["slant_severance", "hole_attracts"].contains(&reference.name)) {
        let path = |lattice: f64| -> Result<Vec<Curve>> {
            let (run, tips) = reference.run(&[&format!("model.lattice_angle_deg={lattice}")])?;
            Ok((0..tips.len()).map(|tip| Curve::of_tip(&run, tip)).collect())
        };
        let upright = path(0.0)?;
        for lattice in [22.5, 45.0] {
            let turned = path(lattice)?;
            let off = upright.iter().zip(&turned).map(|(a, b)| b.rms_off(a)).fold(0.0, f64::max) / MM;
            let what = format!(
                "{}, lattice turned by {lattice}°: path beside that on the upright lattice, % of 0.15 mm",
                reference.about
            );
            table.error(what, 100.0 * off / 0.15, 100.0, "mechanics knows no lattice");
        }
    }
    Ok(())
}

/// One plate drawn, turned over, and scaled: the same life.
pub fn same_plate(table: &mut Table) -> Result<()> {
    let [panel, ..] = standard_specimens();
    let drawn = |scale: f64, mirror: f64, slope: f64| {
        pulled_plate(&format!(
            "width_mm = {}\nlength_mm = {}\ncracks = [{{ from_mm = [{}, {}], to_mm = [{}, {}] }}]",
            100.0 * scale,
            300.0 * scale,
            -10.0 * scale,
            -10.0 * slope * mirror * scale,
            10.0 * scale,
            10.0 * slope * mirror * scale,
        ))
    };
    // Growth of 10 mm at both tips.
    let as_drawn = life(&drawn(1.0, 1.0, 0.0), &["stop.crack_length_mm=40"])?;
    let kind = panel.from_to([10.0, 20.0]).life(&[])?;
    table.compare("M(T) drawn as a plate: life over that of the kind", as_drawn / kind, 1.0, 0.1, "the same plate");
    let slant = life(&drawn(1.0, 1.0, 0.6), &["stop.crack_length_mm=40"])?;
    let mirrored = life(&drawn(1.0, -1.0, 0.6), &["stop.crack_length_mm=40"])?;
    table.compare("slant crack, plate mirrored: life over that of the plate", mirrored / slant, 1.0, 0.1, "the same plate");
    for scale in [0.1_f64, 10.0] {
        // σ √a and so K as before; da/dN in proportion to the plate.
        let set = [
            format!("stop.crack_length_mm={}", 40.0 * scale),
            format!("loading.stress_max_mpa={}", 60.0 / scale.sqrt()),
            format!("fatigue.paris_c_mm_per_cycle={}", 1e-8 * scale),
        ];
        let scaled = life(&drawn(scale, 1.0, 0.6), &set.each_ref().map(String::as_str))?;
        table.compare(
            format!("slant crack, plate scaled by {scale}: life over that of the plate"),
            scaled / slant,
            1.0,
            1e-7,
            "the same plate",
        );
    }
    Ok(())
}
