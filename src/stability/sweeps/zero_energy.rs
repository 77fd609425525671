//! How strong the control of zero-energy modes of a correspondence law is.
//!
//! Two ordinates: what uniform the strain is from point to point (nodal), and how far the whole body deforms (global). Too weak a control
//! leaves the first, too strong a one stiffens the second.

use super::super::exact::percent;
use super::super::{Method, Run, Sweep};
use crate::error::Result;
use crate::fracture::scene::ZeroEnergyControl;
use crate::verify::disc::{DIAMETER, ElasticDisc, TRAVEL, elastic, hondros_displacement};

/// Points across the disc: one on each axis.
const POINTS: f64 = 51.0;
const ABOUT: &str = "Brazilian disc between platens, 51 points across, against Hondros 1959: global, displacement of the end of the \
                     horizontal diameter; nodal, largest departure of its second difference, over that displacement";

/// Springs on the whole relative displacement (Breitenfeld et al. 2014).
pub const SPRING: Sweep = Sweep {
    name: "zero_energy_spring",
    about: ABOUT,
    parameter: "spring constant c_I (model.zero_energy_factor)",
    unit: "N/m^7",
    values: &[1e18, 1e19, 1e20, 3e20, 1e21, 3e21, 1e22, 3e22, 1e23],
    usual: 3e20,
    is_continuous: true,
    bound_percent: 5.0,
    methods: &[
        Method { name: "correspondence, spring: global", measure: |c, _: &Run| global((ZeroEnergyControl::Spring, c)) },
        Method { name: "correspondence, spring: nodal", measure: |c, _: &Run| nodal((ZeroEnergyControl::Spring, c)) },
    ],
};

/// Springs on the part that is not uniform (Silling 2017).
pub const SILLING: Sweep = Sweep {
    name: "zero_energy_silling",
    parameter: "factor H (model.zero_energy_factor)",
    unit: "",
    values: &[0.0, 0.001, 0.01, 0.05, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0],
    usual: 0.3,
    methods: &[
        Method { name: "correspondence, silling: global", measure: |h, _: &Run| global((ZeroEnergyControl::Silling, h)) },
        Method { name: "correspondence, silling: nodal", measure: |h, _: &Run| nodal((ZeroEnergyControl::Silling, h)) },
    ],
    ..SPRING
};

fn disc(control: (ZeroEnergyControl, f64)) -> Result<ElasticDisc> {
    elastic(control, DIAMETER / POINTS, TRAVEL)
}

fn global(control: (ZeroEnergyControl, f64)) -> Result<f64> {
    let disc = disc(control)?;
    let (x, u) = disc.row.last().copied().unwrap_or((f64::NAN, f64::NAN));
    Ok(percent(u, hondros_displacement(x, disc.load, disc.half_angle)))
}

fn nodal(control: (ZeroEnergyControl, f64)) -> Result<f64> {
    let disc = disc(control)?;
    let exact = |x: f64| hondros_displacement(x, disc.load, disc.half_angle);
    let departs = |three: &[(f64, f64)]| {
        let second = |u: [f64; 3]| u[0] - 2.0 * u[1] + u[2];
        let [a, b, c] = [three[0], three[1], three[2]];
        (second([a.1, b.1, c.1]) - second([exact(a.0), exact(b.0), exact(c.0)])).abs()
    };
    let largest = disc.row.windows(3).map(departs).fold(0.0, f64::max);
    Ok(100.0 * largest / exact(disc.row.last().map_or(f64::NAN, |last| last.0)).abs())
}
