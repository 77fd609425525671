//! Computations by name that are no case: fields, scenes and fits, each a few figures from a text and keys `name=value`.
//!
//! The disc of PBX 9501 between rigid platens is that of Li, Hao, Liu and Zhen (China Academy of Engineering Physics), with the springs of
//! Breitenfeld, Geubelle, Weckner and Silling 2014, CMAME 272:233.

use std::f64::consts::{PI, TAU};

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::cases::case;
use super::dual_horizon::{counts, momentum, patch_of};
use super::moving::{self, branches, growth_load, shear, tension};
use super::subject::Watcher;
use super::uniform_tension::{self, strip};
use super::values::{Figures, Keys};
use perilife_base::error::{Error, Result, fail_if};
use perilife_base::input::Folder;
use perilife_base::monotone::Monotone;
use perilife_base::quadrature;
use perilife_base::units::{MM, MM_PER_CYCLE};
use perilife_calibration::calibrate::calibrate;
use perilife_calibration::case::CalibrationCase;
use perilife_calibration::median::cycles_at;
use perilife_calibration::rates::{RateMethod, rates};
use perilife_calibration::results::record;
use perilife_growth::case::Case;
use perilife_growth::predict::{Silent, StopReason, predict};
use perilife_measured::MeasuredCurve;
use perilife_plate::material::{Material, Plane};
use perilife_plate::specimen::{Edge, Point};
use perilife_points::body::Body;
use perilife_points::net::Net;
use perilife_scenes::Scene;
use perilife_scenes::bonds::BondState;
use perilife_scenes::correspondence::{Correspondence, NET_LAW};
use perilife_scenes::interaction::{Damaging, Interaction};
use perilife_scenes::platens::{Platen, Pressed};
use perilife_scenes::quasi_static::relaxation::{Breaking, Loads, Relaxation, RestEnd};
use perilife_scenes::scene::{Action, Damage, DamageLaw, SceneLaw, SceneLoad, ZeroEnergyControl};

type Computation = fn(&str, &Keys<'_>, &dyn Watcher) -> Result<Figures>;

const ALL: [(&str, Computation); 17] = [
    ("plate_in_tension", |_, keys, _| uniform_tension::plate(keys)),
    ("worst_in_tension", |_, _, _| uniform_tension::worst()),
    ("shape_in_tension", |_, keys, _| uniform_tension::shape(keys)),
    ("scene_in_tension", |text, keys, _| tension(text, keys.get("nu")?)),
    ("sheared_square", |_, keys, _| shear(keys.get("nu")?, keys.get("rows")?)),
    ("disc", |_, keys, _| figures(keys)),
    ("three_levels", |_, _, _| momentum()),
    ("patch", |_, keys, _| patch_of(&keys.get::<String>("law")?)),
    ("mixed_mode_points", |_, _, _| counts()),
    ("growing_scene", |text, keys, _| Ok(vec![("load", growth_load(text, keys.0)?)])),
    ("branching_scene", |text, keys, _| branches(text, keys.get("x_mm")?)),
    ("moving_scene", |text, keys, observer| moving::energy_lost(text, keys.get("share")?, observer)),
    ("loaded_scene", |text, _, observer| moving::largest_load(text, observer)),
    ("relaxed_plate", |_, keys, _| moving::relaxed(keys.get("factor")?)),
    ("rates", |text, keys, _| rates_of_readings(text, keys.get("method")?, keys.get("length_mm")?)),
    ("virkler_fit", |text, _, _| fit(text)),
    ("noisy_fit", |text, keys, observer| exponent_error(text, keys.get("noise")?, keys.get("count")?, observer)),
];

/// Figures of a computation by its name.
/// Errors: those of the computation; a name that is none.
pub fn computed(name: &str, text: &str, set: &[String], observer: &dyn Watcher) -> Result<Figures> {
    let found = ALL.iter().find(|(known, _)| *known == name);
    let (_, computation) = found.ok_or_else(|| Error::Mechanics(format!("data/studies: by = \"{name}\": no computation")))?;
    computation(text, &Keys(set), observer)
}

/// Rate at a crack length, mm, of readings in lines of cycles and crack length in mm; whether the length of its step is flagged, 0 or 1.
pub fn rates_of_readings(text: &str, method: RateMethod, length: f64) -> Result<Figures> {
    let number = |field: &str| field.trim().parse::<f64>().map_err(|_| Error::Mechanics(format!("no such reading: {field}")));
    let rows = text.lines().filter_map(|line| line.split_once(',')).map(|(n, a)| Ok((number(n)?, number(a)? * MM)));
    let (cycles, lengths) = rows.collect::<Result<Vec<_>>>()?.into_iter().unzip();
    let points = rates(&MeasuredCurve::new("readings", cycles, lengths), method);
    let point = points.iter().find(|point| (point.crack_length / MM - length).abs() < 1e-3);
    let rate = point.map_or(f64::NAN, |point| point.rate / MM_PER_CYCLE);
    Ok(vec![("rate", rate), ("is_flagged", f64::from(point.is_some_and(|point| point.flags.short_step)))])
}

/// Calibration of 2024-T3, and the median of 34 panels that it is fitted to (Virkler, Hillberry and Goel 1979).
const CALIBRATION: &str = include_str!("../../calibration/al2024-t3/case.toml");
const READINGS: &[u8] = include_bytes!("../../calibration/al2024-t3/measured/virkler_median.csv");

/// That fit: its life beside the measured one, cycles that remain from 20, 30 and 35 mm, C and m; and lives with the fitted law of a specimen
/// that nobody tested, by hand calculation with C and m, as anybody would, and by peridynamics.
pub fn fit(text: &str) -> Result<Figures> {
    let readings = Folder::at_hand([("measured/virkler_median.csv".to_owned(), READINGS.to_vec())]);
    let calibration = CalibrationCase::from_text(CALIBRATION, "al2024-t3", readings)?;
    let fit = calibrate(&calibration, &Silent)?;
    let found = &fit.record;
    let remaining = |cycles: &[f64], from: f64| {
        let curve = MeasuredCurve::new(found.name.clone(), cycles.to_vec(), found.crack_length.clone());
        cycles_at(&curve, from * MM).map_or(f64::NAN, |n| curve.life() - n)
    };
    let [fitted, measured] = [&found.cycles_fitted, &found.cycles_measured];
    let mut figures = vec![
        ("life_fitted", found.life_fitted()),
        ("life_measured", found.life_measured()),
        ("fitted_from_20", remaining(fitted, 20.0)),
        ("fitted_from_30", remaining(fitted, 30.0)),
        ("fitted_from_35", remaining(fitted, 35.0)),
        ("measured_from_20", remaining(measured, 20.0)),
        ("measured_from_30", remaining(measured, 30.0)),
        ("measured_from_35", remaining(measured, 35.0)),
        ("c", fit.paris.c),
        ("m", fit.paris.m),
    ];
    for (name, method) in [("by_hand", "handbook"), ("on_points", "peridynamics")] {
        if text.is_empty() {
            continue;
        }
        let text = format!("model = {{ method = '{method}', spacing_mm = 1.0 }}\n{text}");
        let case = Case::from_toml_with_law(&text, "verification", Folder::none(), record(&calibration, &fit))?;
        let run = predict(&case, &Silent)?;
        fail_if!(run.stop != StopReason::CrackLengthReached, Error::Mechanics(format!("{}: stopped by {}", case.name, run.stop)));
        figures.push((name, run.life_cycles()));
    }
    Ok(figures)
}

/// Exponent that noisy readings were made with.
const M: f64 = 3.0;
const RANGE: [f64; 2] = [9.0, 40.0];
/// Series of noise over which the error is the root mean square.
const SERIES: u64 = 8;

/// Root mean square error of the exponent fitted to so many readings with normal noise, mm, of a panel that the law of `text` has grown.
pub fn exponent_error(text: &str, noise: f64, count: f64, observer: &dyn Watcher) -> Result<Figures> {
    let (panel, _) = text.split_once("[fatigue]").unwrap_or((text, ""));
    let curve = predict(&case(text, "")?, observer)?.curve;
    let cycles = Monotone::new(curve.iter().map(|row| [row.crack_length / MM, row.cycles]));
    let mut squares = 0.0;
    for seed in 0..SERIES {
        let mut normal = Normal(ChaCha8Rng::seed_from_u64(seed));
        let mut table = "cycles,crack_length_mm\n".to_owned();
        for reading in 0..count as usize {
            let length = RANGE[0] + (RANGE[1] - RANGE[0]) * reading as f64 / (count - 1.0);
            table += &format!("{:.3},{:.6}\n", cycles.at(length), length + noise * normal.next());
        }
        let folder = Folder::at_hand([("readings.csv".to_owned(), table.into_bytes())]);
        let test = CalibrationCase::from_text(&format!("{panel}[measured]\nfiles = [\"readings.csv\"]\n"), "readings", folder)?;
        let fitted = calibrate(&test, observer)?.record.constants.p;
        squares += (fitted / M - 1.0).powi(2);
    }
    Ok(vec![("error", 100.0 * (squares / SERIES as f64).sqrt())])
}

/// Standard normal numbers by the transform of Box and Muller.
struct Normal(ChaCha8Rng);

impl Normal {
    fn next(&mut self) -> f64 {
        let mut uniform = || (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let (u, v) = (1.0 - uniform(), uniform());
        (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
    }
}

/// Diameter, m. The source prints 25.4 mm as the radius; its 8273 points of 0.25 mm fill a disc of this diameter.
pub const DIAMETER: f64 = 25.4 * MM;
pub const THICKNESS: f64 = 6.35 * MM;
/// Tensile strength of PBX 9501, Pa: cohesive strength of its interfaces, 1.66 MPa (Tan, Liu, Huang and Geubelle 2005, J. Mech.
/// Phys. Solids 53:1892).
pub const TENSILE_STRENGTH: f64 = 1.66e6;
/// Lattice spacing that puts 101 points across, one of them on each axis, m. The crack can then run in one column.
pub const SPACING: f64 = DIAMETER / 101.0;
/// Factor of `silling` on this lattice. With 1 the control carries 3 % of the stress at the centre, with 0.5 it is 1 %.
pub const CONTROL: (ZeroEnergyControl, f64) = (ZeroEnergyControl::Silling, 0.5);
/// Way of each platen, m: short of failure.
pub const TRAVEL: f64 = 0.12 * MM;
const CORNERS: usize = 360;

/// The disc between platens that each move by `travel`, m.
pub fn scene((control, factor): (ZeroEnergyControl, f64), spacing: f64, travel: f64) -> Scene {
    let mut specimen = strip(DIAMETER, DIAMETER);
    specimen.thickness = THICKNESS;
    specimen.crack_plane_y = None;
    specimen.loads.clear();
    let corner = |i: usize| {
        let (sin, cos) = (TAU * (i as f64 + 0.5) / CORNERS as f64).sin_cos();
        [0.5 * DIAMETER * cos, 0.5 * DIAMETER * sin]
    };
    specimen.outline = (0..CORNERS).map(corner).collect();
    let platen = |edge, y: f64| SceneLoad::on_side(edge, Action::Platen([0.0, y]));
    Scene {
        drives: vec![platen(Edge::Top, -travel), platen(Edge::Bottom, travel)],
        damage: Damage { law: DamageLaw::PrincipalStress, ..Damage::NONE },
        ..Scene::bare("pbx_disc", specimen, material(), SceneLaw::Correspondence { control, factor }, spacing)
    }
}

/// PBX 9501 at room temperature and 0.05/s: E = 1013 MPa, ν = 0.35 (Wetzel 1999, quoted by Banerjee and Adams 2004).
fn material() -> Material {
    let elastic = Material::elastic(1.013e9, 0.35, Plane::Stress);
    Material { name: "pbx9501".to_owned(), density: Some(1830.0), tensile_strength: Some(TENSILE_STRENGTH), ..elastic }
}

#[derive(Debug, Clone)]
pub struct ElasticDisc {
    pub load: f64,
    /// σ_x and σ_y at the centre, Pa.
    pub centre: [f64; 2],
    /// (x, u_x) along the horizontal diameter, m.
    pub row: Vec<(f64, f64)>,
    /// Half angle over which the platens press, rad: that of an even pressure with the second moment of the contact forces.
    pub half_angle: f64,
    /// Largest depth by which a point has passed a platen, m.
    pub penetration: f64,
}

/// Equilibrium of the undamaged disc.
pub fn elastic(control: (ZeroEnergyControl, f64), spacing: f64, travel: f64) -> Result<ElasticDisc> {
    let scene = scene(control, spacing, travel);
    let model = &scene.model;
    let body = Body::build(&scene.specimen, &scene.material, &NET_LAW, model.spacing, model.horizon_ratio, 0.0)?;
    let net = Net::of_body(&body);
    let mut bonds = BondState::new(&net, &vec![false; net.len()]);
    let law = || Correspondence::new(&scene, &net, control.0, control.1);
    let mut pressed = Pressed::new(Box::new(law()?), &net, Platen::all(&scene, &net));
    pressed.load_to(1.0);
    let size = 2 * net.len();
    let (mut u, held, external) = (vec![0.0; size], vec![false; size], vec![0.0; size]);
    let relaxation = Relaxation { breaking: Breaking::Never, least_load: 1.0, ..Relaxation::default() };
    let rested = relaxation.relax(&mut pressed, &mut bonds, Loads { held: &held, external: &external }, &mut u);
    fail_if!(rested.end != RestEnd::AtRest, Error::Mechanics(format!("the disc did not converge: {rested:?}")));
    let driven = pressed.driven().unwrap_or_default();
    // The law alone shows the forces that the platens balance, and the stresses.
    let (mut law, mut force) = (law()?, vec![0.0; size]);
    law.internal_force(&u, &mut bonds, Damaging::Frozen, &mut force);
    let from_centre = |&i: &usize| net.positions[i][0].hypot(net.positions[i][1]);
    let centre = (0..net.len()).min_by(|a, b| from_centre(a).total_cmp(&from_centre(b))).unwrap_or(0);
    let stress = law.stresses().nth(centre).unwrap_or_default();
    let on_top = |&&(_, i): &&(&Point, usize)| net.positions[i][1] > 0.4 * DIAMETER && force[2 * i + 1] > 1e-4 * driven.load;
    let points: Vec<(&Point, usize)> = net.positions.iter().zip(0..).collect();
    let moments = points.iter().filter(on_top).fold([0.0; 2], |[sum, second], (x, i)| {
        let f = force[2 * i + 1];
        [sum + f, second + f * x[0] * x[0]]
    });
    let on_axis = points.iter().filter(|(x, _)| x[1].abs() < 0.25 * net.spacings[0]);
    Ok(ElasticDisc {
        load: driven.load,
        centre: [stress[(0, 0)], stress[(1, 1)]],
        row: on_axis.map(|(x, i)| (x[0], u[2 * i])).collect(),
        half_angle: (3.0 * moments[1] / moments[0]).sqrt() / (0.5 * DIAMETER),
        penetration: driven.penetration,
    })
}

/// σ_x and σ_y on the horizontal diameter of a disc pressed evenly over ±α at top and bottom (Hondros 1959, Austral. J. Appl.
/// Sci. 10:243), Pa, with load P, N:
///
/// `σ_x = 2p/π (A - B)`, `σ_y = -2p/π (A + B)`, `A = (1-ρ²) sin 2α / (1 + 2ρ² cos 2α + ρ⁴)`,
/// `B = atan((1-ρ²)/(1+ρ²) tan α)`, `ρ = 2x/D`, `p = P/(D t α)`; at the centre `2P/(π D t)` and `-6P/(π D t)` for small α.
pub fn hondros(x: f64, load: f64, half_angle: f64) -> [f64; 2] {
    let square = (2.0 * x / DIAMETER).powi(2);
    let a = (1.0 - square) * (2.0 * half_angle).sin() / (1.0 + 2.0 * square * (2.0 * half_angle).cos() + square * square);
    let b = ((1.0 - square) / (1.0 + square) * half_angle.tan()).atan();
    let scale = 2.0 * load / (PI * DIAMETER * THICKNESS * half_angle);
    [scale * (a - b), -scale * (a + b)]
}

/// u_x on the horizontal diameter from [`hondros`], m: the integral of `(σ_x - ν σ_y)/E` from the centre.
pub fn hondros_displacement(x: f64, load: f64, half_angle: f64) -> f64 {
    let material = material();
    let strain = |x: f64| {
        let [along, across] = hondros(x, load, half_angle);
        (along - material.poisson_ratio * across) / material.youngs_modulus
    };
    quadrature::integrate(strain, 0.0, x, 1e-10).value
}

impl ElasticDisc {
    /// Displacement at a place of the horizontal diameter, m, linear between points.
    pub fn displacement(&self, x: f64) -> f64 {
        let after = self.row.partition_point(|(at, _)| *at < x).clamp(1, self.row.len() - 1);
        let ((a, u), (b, v)) = (self.row[after - 1], self.row[after]);
        u + (v - u) * (x - a) / (b - a)
    }
}

/// Figures of the disc with springs or the control of Silling, so many points across: stresses at the centre and what the load means there,
/// displacement of the end of the horizontal diameter and Hondros', that at the end of a lattice of [`SPACING`], depth that points have
/// passed the platens over the way, largest departure of the second difference of displacements from Hondros'.
pub fn figures(keys: &Keys<'_>) -> Result<Figures> {
    let control: ZeroEnergyControl = keys.get("control")?;
    let disc = elastic((control, keys.get("factor")?), DIAMETER / keys.get::<f64>("points")?, TRAVEL)?;
    let (end, u) = disc.row.last().copied().unwrap_or((f64::NAN, f64::NAN));
    let exact = |x: f64| hondros_displacement(x, disc.load, disc.half_angle);
    let departs = |three: &[(f64, f64)]| {
        let second = |u: [f64; 3]| u[0] - 2.0 * u[1] + u[2];
        let [a, b, c] = [three[0], three[1], three[2]];
        (second([a.1, b.1, c.1]) - second([exact(a.0), exact(b.0), exact(c.0)])).abs()
    };
    Ok(vec![
        ("stress_x", disc.centre[0]),
        ("stress_y", disc.centre[1]),
        ("nominal", 2.0 * disc.load / (PI * DIAMETER * THICKNESS)),
        ("u", u),
        ("hondros", exact(end)),
        ("u_common", disc.displacement(50.0 * SPACING)),
        ("passed", disc.penetration / TRAVEL),
        ("departs", disc.row.windows(3).map(departs).fold(0.0, f64::max)),
    ])
}
