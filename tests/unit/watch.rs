//! Work marks what it does from the first point of a plate on, and ends when it is asked to, whatever drives the crack.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use perilife_base::input::Folder;
use perilife_base::parallel::in_pool;
use perilife_base::watch::{self, Stage, Watch};
use perilife_growth::case::Case;
use perilife_growth::predict::{Observer, Progress, predict};
use perilife_points::solver::SolverKind;
use perilife_points::state::Bonds;
use perilife_scenes::{Scene, SceneObserver, SceneProgress};

use crate::support::statics::{body, loaded_with};

/// Hands out a watch; counts rows.
#[derive(Default)]
struct Eyes {
    watch: Arc<Watch>,
    rows: AtomicUsize,
    /// Row after which the run is asked to end, by its watch alone.
    last: Option<usize>,
}

impl Observer for Eyes {
    fn block_done(&self, _: &Progress) -> bool {
        if self.last == Some(self.rows.fetch_add(1, Ordering::Relaxed)) {
            self.watch.cancel();
        }
        self.last.is_some() || !self.watch.is_cancelled()
    }
    fn watch(&self) -> Option<Arc<Watch>> {
        Some(self.watch.clone())
    }
}

impl SceneObserver for Eyes {
    fn step_done(&self, _: &SceneProgress) -> bool {
        !self.watch.is_cancelled()
    }
    fn watch(&self) -> Option<Arc<Watch>> {
        Some(self.watch.clone())
    }
}

const PLATE: &str = "specimen = { kind = \"middle_tension\", width_mm = 60.0, length_mm = 120.0, thickness_mm = 2.0, crack_length_mm = 9.0 }\n\
    material = { name = \"al2024-t3\" }\nloading = { stress_range_mpa = 60.0, stress_ratio = 0.1 }\nstop = { crack_length_mm = 12.0 }\n";

const DRIVERS: [&str; 4] = [
    "model = { method = \"element_free_galerkin\" }\nfatigue = { paris_c_mm_per_cycle = 8.95e-8, paris_m = 2.874 }",
    "model = { spacing_mm = 1.5 }\nfatigue = { a = 6450.0, p = 2.86, horizon_mm = 3.015 }",
    "model = { spacing_mm = 1.5 }\nfatigue = { a = 6450.0, p = 2.86, horizon_mm = 3.015, driver = \"bond_strain\" }",
    "model = { method = \"handbook\" }\nfatigue = { paris_c_mm_per_cycle = 8.95e-8, paris_m = 2.874 }",
];

const SCENE: &str = "specimen = { kind = \"plate\", width_mm = 20.0, length_mm = 20.0, thickness_mm = 1.0, cracks = [{ from_mm = [-3, 0], \
    to_mm = [3, 0] }] }\nmaterial = { youngs_modulus_gpa = 192.0, poisson_ratio = 0.3 }\nmodel = { spacing_mm = 1.0 }\n\
    loading = { kind = \"traction\", stress_mpa = 10.0, edges = [\"top\", \"bottom\"] }\n";

#[test]
fn a_run_that_is_asked_to_end_ends_before_its_first_row() {
    for law in DRIVERS {
        let case = Case::from_toml(&format!("{PLATE}{law}"), "case", Folder::none(), &[]).unwrap();
        let eyes = Eyes::default();
        let whole = predict(&case, &eyes).unwrap();
        if !law.contains("handbook") {
            assert_eq!(eyes.watch.now().map(|(stage, _)| stage), Some(Stage::Equilibrium), "{law}");
        }
        // Nobody's eyes change a digit.
        // As text: what a hand calculation does not know is no number.
        let unwatched = predict(&case, &perilife_growth::predict::Silent).unwrap();
        assert!(format!("{:?}", unwatched.curve) == format!("{:?}", whole.curve), "{law}");
        let eyes = Eyes::default();
        eyes.watch.cancel();
        let error = predict(&case, &eyes).unwrap_err().to_string();
        assert_eq!(error, "case: the run was canceled", "{law}");
        assert_eq!(eyes.watch.now(), None, "it has not begun");
    }
    let scene = Scene::from_toml(SCENE, "scene", Folder::none(), &[]).unwrap();
    let eyes = Eyes::default();
    perilife_scenes::run(&scene, &eyes).unwrap();
    assert!(eyes.watch.now().is_some());
    eyes.watch.cancel();
    assert_eq!(perilife_scenes::run(&scene, &eyes).unwrap_err().to_string(), "scene: the run was canceled");
}

/// An equilibrium that was asked to end is none, whatever solver it is sought by: what an iteration has not solved for that is not factorised.
#[test]
fn an_equilibrium_that_is_asked_to_end_is_none() {
    let case = Case::from_toml(&format!("{PLATE}{}", DRIVERS[1]), "case", Folder::none(), &[]).unwrap();
    let body = body(&case);
    for solver in [Some(SolverKind::Window), Some(SolverKind::Multigrid), None] {
        let solved = |watch: Arc<Watch>| {
            let (body, bonds) = (body.clone(), Bonds::new(&body));
            in_pool(|| watch::with(Some(watch), || loaded_with(body, bonds, case.loading.maximum, solver)))
        };
        assert!(solved(Arc::default()).is_ok());
        let cancelled = Arc::new(Watch::default());
        cancelled.cancel();
        let Err(error) = solved(cancelled) else { panic!("{solver:?}: solved all the same") };
        assert_eq!(error.to_string(), "the run was canceled", "{solver:?}");
    }
}

/// A watch alone ends a run within a row: no solver takes what was asked to end for what it could not solve.
#[test]
fn a_run_ends_within_a_row() {
    for law in DRIVERS.iter().filter(|law| !law.contains("handbook")) {
        for solver in ["window", "multigrid"] {
            let case = format!("{PLATE}{}", law.replace("spacing_mm = 1.5", &format!("spacing_mm = 1.5, solver = \"{solver}\"")));
            let case = Case::from_toml(&case, "case", Folder::none(), &[]).unwrap();
            let eyes = Eyes { last: Some(2), ..Eyes::default() };
            let error = predict(&case, &eyes).unwrap_err().to_string();
            // A row whose K is known already is told still.
            let rows = eyes.rows.into_inner();
            assert!(error == "case: the run was canceled" && (3..=4).contains(&rows), "{solver} {law}: {error}, {rows} rows");
        }
    }
}

#[test]
fn who_watched_before_does_so_again() {
    let [outer, inner] = [(); 2].map(|()| Arc::new(Watch::default()));
    watch::with(Some(outer.clone()), || {
        for stage in Stage::ALL {
            watch::at(stage, 0.25).unwrap();
            assert_eq!(outer.now(), Some((stage, 0.25)));
        }
        let panicked = std::panic::catch_unwind(|| {
            watch::with(Some(inner.clone()), || {
                watch::at(Stage::Points, 0.5).unwrap();
                std::panic::resume_unwind(Box::new("in the middle"));
            })
        });
        assert!(panicked.is_err());
        inner.cancel();
        assert_eq!(inner.now(), Some((Stage::Points, 0.5)));
        assert!(!watch::is_cancelled() && watch::at(Stage::Solver, 1.0).is_ok());
        assert_eq!(outer.now(), Some((Stage::Solver, 1.0)));
        outer.cancel();
        assert!(watch::is_cancelled() && watch::at(Stage::Solver, 1.0).is_err());
    });
    assert!(!watch::is_cancelled() && watch::at(Stage::Solver, 1.0).is_ok());
}
