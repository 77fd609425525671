//! The load at which a crack of a scene grows beside Griffith's, and a crack in motion that has to branch.

use std::path::Path;
use std::sync::Mutex;

use super::table::Table;
use perilife_base::error::Result;
use perilife_base::units::MM;
use perilife_growth::predict::Silent;
use perilife_scenes::fronts::CRACKED;
use perilife_scenes::outcome::HistoryRow;
use perilife_scenes::{Fracture, Scene, SceneObserver, SceneProgress};

/// The square in tension of phase-field articles (Miehe, Welschinger and Hofacker 2010), cracked to its middle, its ends held: E 210 GPa, plane
/// strain, G_c 2.7 N/mm.
pub const SQUARE: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 1.0\nlength_mm = 1.0\nthickness_mm = 1.0\n\
                      cracks = [{ from_mm = [-0.5, 0.0], to_mm = [0.0, 0.0] }]\n\
                      [material]\nyoungs_modulus_gpa = 210.0\npoisson_ratio = 0.25\nplane = \"strain\"\nfracture_energy_j_m2 = 2700.0\n\
                      [model]\nspacing_mm = 0.01\n\
                      [loading]\nkind = \"displacement\"\nedges = [\"top\"]\ntransverse = \"held\"\ndisplacement_mm = 0.008\nsteps = 40\n\
                      [supports]\nbottom = { rows_mm = 0.01, fix = [\"x\", \"y\"] }\n[damage]\nlaw = \"critical_energy\"\n";
/// Griffith's load on it at Poisson's ratios of 0.25 and 0.3, N.
pub const GRIFFITH: [f64; 2] = [637.2, 645.9];
const GRIFFITH_SOURCE: &str = "Griffith 1921, energies of finite elements (tests/reference/held_square.py)";
/// Growth over which the largest load is looked for, spacings of G_c: the load of a longer crack is less by 4 % a spacing at 25
/// spacings a crack, by 2 % at 50.
const GROWTH: f64 = 5.0;

/// The plate of Borden, Verhoosel, Scott, Hughes and Landis 2012, Comput. Methods Appl. Mech. Eng. 217-220:77, section 5.1: 1 MPa, 3 J/m².
const BRANCHING: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 100.0\nlength_mm = 40.0\nthickness_mm = 1.0\n\
                         cracks = [{ from_mm = [-50.0, 0.0], to_mm = [0.0, 0.0] }]\n\
                         [material]\nyoungs_modulus_gpa = 32.0\npoisson_ratio = 0.2\ndensity_kg_m3 = 2450.0\nplane = \"strain\"\n\
                         fracture_energy_j_m2 = 3.0\n[model]\nspacing_mm = 0.5\n\
                         [loading]\nkind = \"traction\"\nedges = [\"top\", \"bottom\"]\nstress_mpa = 1.0\nduration_s = 80e-6\n\
                         [damage]\nlaw = \"critical_energy\"\n";

/// Rows of the topic.
pub fn rows(table: &mut Table) -> Result<()> {
    let cases = [
        ("two_parameter, 50 spacings a crack", "model.bond_law=two_parameter", 6.0),
        ("bond_based, 50 spacings a crack", "model.bond_law=bond_based", 6.0),
        // The tip is on its way to its full resistance.
        ("two_parameter, 25 spacings a crack", "model.spacing_mm=0.02 supports.bottom.rows_mm=0.02", 10.0),
    ];
    for (name, keys, bound) in cases {
        for angle in [0, 20, 45] {
            let peak = growth_load(&format!("{keys} model.lattice_angle_deg={angle}"))?;
            let quantity = format!("held square in tension, {name}, lattice at {angle}°: largest load, N");
            table.compare(quantity, peak, GRIFFITH[0], bound, GRIFFITH_SOURCE);
        }
    }
    let keys = "model.bond_law=correspondence material.poisson_ratio=0.3 damage.law=critical_stretch model.spacing_mm=0.02 \
                supports.bottom.rows_mm=0.02 loading.displacement_mm=0.005 loading.steps=25";
    let name = "held square in tension, nu 0.3, correspondence, 25 spacings a crack: largest load, N";
    table.compare(name, growth_load(keys)?, GRIFFITH[1], 10.0, GRIFFITH_SOURCE);
    let found = perilife_scenes::run(&Scene::from_toml(BRANCHING, "branching", Path::new("."), &[])?, &Silent)?;
    // Well beyond the published split at 21 mm.
    let heights = cracked_rows(&found, 40.0 * MM);
    let branches = usize::from(!heights.is_empty()) + heights.windows(2).filter(|pair| pair[1] - pair[0] > 3.0 * MM).count();
    table.compare("plate under 1 MPa: branches at x = 40 mm", branches as f64, 2.0, 0.1, "Borden et al. 2012, figure 12");
    Ok(())
}

/// Largest load of the square with these keys while its crack begins to grow, N.
/// Errors: those of the scene and its run.
pub fn growth_load(keys: &str) -> Result<f64> {
    let scene = Scene::from_toml(SQUARE, "square", Path::new("."), &super::cases::overrides(keys))?;
    let energy = scene.material.fracture_energy.unwrap_or(f64::INFINITY) * scene.specimen.thickness * scene.model.spacing;
    let growing = Growing { energy: GROWTH * energy, so_far: Mutex::default() };
    let run = perilife_scenes::run(&scene, &growing);
    let HistoryRow { load, fracture, .. } = growing.look();
    // Stopped by its observer it has ended well.
    if fracture < growing.energy {
        run?;
    }
    Ok(load)
}

/// Stops a run where damage has taken an energy, J.
struct Growing {
    energy: f64,
    /// The last row with the largest load so far.
    so_far: Mutex<HistoryRow>,
}

impl Growing {
    fn look(&self) -> HistoryRow {
        *self.so_far.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl SceneObserver for Growing {
    fn step_done(&self, _: &SceneProgress) -> bool {
        self.look().fracture < self.energy
    }

    fn row(&self, row: &HistoryRow) {
        let load = row.load.max(self.look().load);
        *self.so_far.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = HistoryRow { load, ..*row };
    }
}

/// Heights of the points in the column at x that are cracked at the end, m, from below.
pub fn cracked_rows(run: &Fracture, x: f64) -> Vec<f64> {
    let (grid, last) = (&run.grid, run.snapshots.last());
    let column = ((x - grid.origin[0]) / grid.spacing).round() as usize;
    let damage = |row: usize| grid.point_at[row * grid.columns + column].zip(last).map(|(p, last)| last.damage[p as usize]);
    let is_cracked = |row: &usize| damage(*row).is_some_and(|damage| damage >= CRACKED);
    (0..grid.rows).filter(is_cracked).map(|row| grid.origin[1] + row as f64 * grid.spacing).collect()
}
