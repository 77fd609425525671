//! Scenes without time against closed forms: uniform tension by traction, Poisson's ratio read back from it, uniform shear by
//! displacement of the rim.

use std::path::Path;

use super::table::Table;
use super::uniform_tension::{rest_within_rim, steel, strip, without_rigid_motion};
use perilife_base::error::Result;
use perilife_base::units::{GPA, MPA};
use perilife_growth::predict::Silent;
use perilife_plate::material::{Material, Plane};
use perilife_plate::specimen::Point;
use perilife_points::body::Body;
use perilife_points::bond_law::stencil::{plane_stiffness, poisson_limit};
use perilife_points::bond_law::{BondLaw, BondLawKind, Kernel, Rotation, SurfaceCorrection};
use perilife_points::net::Net;
use perilife_scenes::Scene;

/// The article of which this repeats examples 1 and 2: Huang, Li, Jin, He and Wang, Guangxi University, on a one-bond two-parameter
/// law with the stiffness of Zhu and Ni 2017, Int. J. Eng. Sci. 121:118.
const HUANG: &str = "Huang, Li, Jin, He and Wang (after Zhu and Ni 2017)";
/// Poisson's ratio; largest error along the load that the stretch form has with the classical corrections, percent: at 1/3
/// published, below by an independent program; the error of Poisson's ratio read back that is known, percent, where it misses its
/// bound.
const STRETCH_FORM: [(f64, f64, Option<f64>); 3] = [(0.1, 1.78, None), (0.3, 2.48, Some(0.930)), (1.0 / 3.0, 3.25, Some(1.482))];
/// Rows of the rim that are held in shear, and the known error, percent.
const SHEAR_ROWS: [(usize, f64); 2] = [(1, 573.0), (3, 278.0)];
/// Poisson's ratios that the bond-based law cannot have.
const FOREIGN: [f64; 6] = [0.3, 0.25, 0.2, 0.15, 0.1, 0.0];
/// Stress of the plate, Pa.
const STRESS: f64 = 200e6;

/// Why Poisson's ratio read back misses the source's figure.
const READ_BACK: &str = "the lattice sum of 28 bonds with volume weights gives 0.3356 at c_t = 0, about half of the miss; the other half are the \
     layers at sides and ends, and goes with the spacing (0.3377 right in the middle, 0.3367 at 5 mm); where the source reads is not said";

/// Why the classical correction misses the source's figure in shear.
const SHEARED: &str = "the classical correction asks of points at the rim the energy of uniaxial strain, and errs in shear: 1.36, 1.99 and 0.76 % \
     with one, two and three rows held; how the source holds its plate is lost";

/// Rows of the topic.
pub fn rows(table: &mut Table) -> Result<()> {
    for (nu, published, known) in STRETCH_FORM {
        let plate = Tension::of("one_bond_two_parameter", &steel(nu), nu)?;
        let name = format!("static scene, one_bond_two_parameter, nu {nu:.3}: max |e_x| in percent");
        let source = match nu > 0.3 {
            true => format!("{HUANG}, example 1"),
            false => "independent program, same plate and corrections".to_owned(),
        };
        table.compare(name, plate.error, published, 100.0 * 0.1 / published, &source);
        let name = format!("static scene, one_bond_two_parameter, nu {nu:.3}: Poisson's ratio read back");
        table.compare(name, plate.poisson_ratio, nu, 0.7, &format!("{HUANG}, table 2: within 0.16 to 0.70 %"));
        if let Some(known) = known {
            table.known_miss(READ_BACK, known);
        }
    }
    bond_based(table)?;
    for (rows, known) in SHEAR_ROWS {
        let name = format!("uniform shear by {rows} rows of the rim, nu 0.3: max |e_x| in percent");
        let [error, across] = shear(0.3, rows)?;
        table.compare(name, error.max(across), 0.202, 10.0, &format!("{HUANG}, example 2; its boundary data are lost"));
        table.known_miss(SHEARED, known);
    }
    Ok(())
}

/// The bond-based law on materials whose Poisson's ratio it cannot have.
///
/// Its springs stand for some E and for ν = 1/3. With the material's E they have the right displacement along the load whatever ν is, and
/// fail across it alone. The source's fail along the load: the classical surface correction asks of every point the energy of the
/// material in uniaxial strain, `E ε²/(2(1-ν²))`, so that the springs stand for `E* = E (1 - 1/9)/(1 - ν²)` and the plate is longer by
/// `E/E* = 9 (1 - ν²)/8`: by 12.5, 11.4, 10.0, 8.0, 5.5 and 2.4 % at ν = 0, 0.1, 0.15, 0.2, 0.25 and 0.3 (derived here; the source
/// does not say with what ν it corrects, and its single figures are lost: only that all errors at ν ≤ 0.20 are above 5 %, which
/// holds here, at 0.25 too).
fn bond_based(table: &mut Table) -> Result<()> {
    let third = poisson_limit(Plane::Stress);
    let plate = Tension::of("bond_based", &steel(third), third)?;
    let name = "static scene, bond_based: Poisson's ratio read back";
    table.compare(name, plate.poisson_ratio, third, 0.7, &format!("{HUANG}, table 2: 0.3328 whatever the material's"));
    table.known_miss(READ_BACK, 1.482);
    let (name, published) = ("static scene, bond_based with the material's E, any nu: max |e_x| in percent", STRETCH_FORM[2].1);
    let source = format!("{HUANG}, example 1: 3.25 % of the one-bond law, which is this one at 1/3");
    table.compare(name, plate.error, published, 100.0 * 0.1 / published, &source);
    for nu in FOREIGN {
        let stiffness = |nu: f64| plane_stiffness(&steel(nu))[0];
        let mut springs = steel(third);
        springs.youngs_modulus *= stiffness(nu) / stiffness(third);
        let wrong = Tension::of("bond_based", &springs, nu)?;
        let about = format!("static scene, bond_based with the energy of nu {nu:.3}");
        let source = format!("{HUANG}, table 2: one figure whatever the material's ν");
        table.compare(format!("{about}: Poisson's ratio read back"), wrong.poisson_ratio, plate.poisson_ratio, 1e-3, &source);
        let (longer, stretched) = (1.125 * (1.0 - nu * nu), wrong.strain * steel(nu).youngs_modulus / STRESS);
        table.compare(format!("{about}: strain inside over p/E"), stretched, longer, 0.5, "9 (1 - ν²)/8");
        // At 0.3 the corners have more than that.
        if nu < 0.3 {
            let source = format!("9 (1 - ν²)/8 - 1; {HUANG}, table 3: above 5 % at ν ≤ 0.20, the more the smaller ν");
            table.compare(format!("{about}: max |e_x| in percent"), wrong.error, 100.0 * (longer - 1.0), 5.0, &source);
        }
    }
    Ok(())
}

/// What a plate in tension shows: 500 mm across, 1 m along the load.
pub struct Tension {
    /// Largest error of displacement along the load over all points, percent of its own.
    pub error: f64,
    /// ε along the load, by least squares over the middle quarter of the plate.
    pub strain: f64,
    /// -ε across / ε along, likewise.
    pub poisson_ratio: f64,
}

impl Tension {
    /// The plate of a law whose springs stand for some elastic constants, solved as a scene and compared with what the steel of
    /// [`steel`] does that has this Poisson's ratio.
    pub fn of(law: &str, springs: &Material, poisson_ratio: f64) -> Result<Tension> {
        let strain = STRESS / steel(poisson_ratio).youngs_modulus;
        // As the article prints it; a bond-based law has no rotation to resist.
        let rotation = if law == "one_bond_two_parameter" { "rotation = \"resisted\"\n" } else { "" };
        let text = format!(
            "[specimen]\nkind = \"plate\"\nwidth_mm = 500.0\nlength_mm = 1000.0\nthickness_mm = 1000.0\n[material]\n\
             youngs_modulus_gpa = {:?}\npoisson_ratio = {:?}\n[model]\nbond_law = \"{law}\"\n{rotation}kernel = \"constant\"\n\
             spacing_mm = 10.0\n[loading]\nkind = \"traction\"\nedges = [\"top\", \"bottom\"]\nstress_mpa = {:?}\n",
            springs.youngs_modulus / GPA,
            springs.poisson_ratio,
            STRESS / MPA
        );
        let scene = Scene::from_toml(&text, "tension", Path::new("."), &[])?;
        let found = perilife_scenes::run(&scene, &Silent)?;
        let grid = &found.grid;
        let mut seats = vec![[0.0; 2]; found.figures.points];
        for (place, point) in grid.point_at.iter().enumerate() {
            let Some(point) = point else { continue };
            let (column, row) = ((place % grid.columns) as f64, (place / grid.columns) as f64);
            seats[*point as usize] = [grid.origin[0] + column * grid.spacing, grid.origin[1] + row * grid.spacing];
        }
        let u = found.snapshots.last().map(|last| last.displacement.clone()).unwrap_or_default();
        let exact = |[x, y]: Point| [-poisson_ratio * strain * x, strain * y];
        let differences = seats.iter().zip(&u).map(|(&seat, u)| [u[0] - exact(seat)[0], u[1] - exact(seat)[1]]).collect();
        let differences = without_rigid_motion(&seats, differences);
        let relative = |(seat, d): (&Point, &Point)| 100.0 * (d[1] / exact(*seat)[1]).abs();
        let inside = |p: &Point| p[0].abs() < 0.125 && p[1].abs() < 0.25;
        let slope = |axis: usize| {
            let points = || seats.iter().zip(&differences).filter(|(seat, _)| inside(seat));
            let along: f64 = points().map(|(s, d)| s[axis] * (d[axis] + exact(*s)[axis])).sum();
            along / points().map(|(s, _)| s[axis] * s[axis]).sum::<f64>()
        };
        Ok(Tension {
            error: seats.iter().zip(&differences).map(relative).fold(0.0, f64::max),
            strain: slope(1),
            poisson_ratio: -slope(0) / slope(1),
        })
    }
}

/// Strain g of the sheared square.
const SHEAR: f64 = 1e-3;

/// Largest errors along x and y, percent of the point's own displacement, of a square of 50 x 50 points whose outermost rows have
/// the displacement of pure shear, `u = g y/2, v = g x/2`.
fn shear(poisson_ratio: f64, rows: usize) -> Result<[f64; 2]> {
    let law = BondLaw {
        kind: BondLawKind::OneBondTwoParameter,
        kernel: Kernel::Constant,
        rotation: Rotation::Resisted,
        surface_correction: SurfaceCorrection::VolumeAndSurface,
    };
    let body = Body::build(&strip(0.5, 0.5), &steel(poisson_ratio), &law, 0.01, 3.015, 0.0)?;
    let net = Net::of_body(&body);
    let exact: Vec<f64> = net.positions.iter().flat_map(|p| [0.5 * SHEAR * p[1], 0.5 * SHEAR * p[0]]).collect();
    let on_rim = |p: &Point| p[0].abs().max(p[1].abs()) > 0.25 - 0.01 * rows as f64;
    let held: Vec<bool> = net.positions.iter().flat_map(|p| [on_rim(p); 2]).collect();
    let u = rest_within_rim(&net, &exact, held)?;
    let error = |axis: usize| {
        let points = u.iter().zip(&exact).skip(axis).step_by(2);
        points.map(|(u, exact)| 100.0 * (u / exact - 1.0).abs()).fold(0.0, f64::max)
    };
    Ok([error(0), error(1)])
}
