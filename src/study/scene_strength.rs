//! The load at which a crack of a scene grows beside Griffith's, and a crack in motion that has to branch.

use std::path::Path;
use std::sync::Mutex;

use super::figures::Figures;
use perilife_base::error::Result;
use perilife_base::units::MM;
use perilife_growth::predict::Silent;
use perilife_scenes::fronts::CRACKED;
use perilife_scenes::outcome::HistoryRow;
use perilife_scenes::{Fracture, Scene, SceneObserver, SceneProgress};

/// Growth over which the largest load is looked for, spacings of G_c: the load of a longer crack is less by 4 % a spacing at 25
/// spacings a crack, by 2 % at 50.
const GROWTH: f64 = 5.0;

/// Branches at x, mm, of a plate in motion, by gaps of 3 mm.
pub fn branches(text: &str, x: f64) -> Result<Figures> {
    let found = perilife_scenes::run(&Scene::from_toml(text, "branching", Path::new("."), &[])?, &Silent)?;
    let heights = cracked_rows(&found, x * MM);
    let branches = usize::from(!heights.is_empty()) + heights.windows(2).filter(|pair| pair[1] - pair[0] > 3.0 * MM).count();
    Ok(vec![("branches", branches as f64)])
}

/// Largest load of a scene with these keys while its crack begins to grow, N.
/// Errors: those of the scene and its run.
pub fn growth_load(text: &str, set: &[String]) -> Result<f64> {
    let scene = Scene::from_toml(text, "square", Path::new("."), set)?;
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
